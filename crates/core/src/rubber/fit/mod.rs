//! A rubber from measured storage and loss moduli: master curve, Prony series, shift law.
//!
//! All sweeps are fitted at once: one Prony series (a generalised Maxwell model) at the reference
//! temperature, and a shift factor for every other temperature,
//!
//! ```text
//! E*(ω, T) = b_T E*(a_T ω, T_r),   E*(ω) = E_inf + sum_i E_i i ω τ_i / (1 + i ω τ_i)
//! ```
//!
//! They minimise the sum of squares of `ln E'` and `ln E''` against the measured ones: relative
//! deviations, every point and both moduli with the same weight. Relaxation times are free within
//! a decade of the measured range, the number of terms follows from a criterion. The vertical
//! factor b_T is 1 unless a choice says otherwise ([`VerticalChoice`]).
//!
//! | module | what it holds |
//! |---|---|
//! | `sweep` | measured sweeps, options, and what may be wrong with them |
//! | `chain`, `shift`, `join` | the order of the sweeps and first shift factors, by storage modulus, loss modulus or loss factor |
//! | `model` | residuals of a Prony series and their derivatives |
//! | `terms`, `verticals` | the number of terms; vertical factors fitted with the shifts |
//! | `law` | WLF and Arrhenius through shift factors |
//! | `covariance`, `result` | intervals; what a fit gives |

mod chain;
mod covariance;
mod join;
mod law;
mod model;
mod result;
mod shift;
mod sweep;
mod terms;
mod verticals;

#[cfg(test)]
mod shift_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vertical_tests;

pub use result::{
    Candidate, Deviation, Estimate, FittedLaw, FittedTerm, FittedVertical, LeftOut, MasterCurve,
    Misfit, ReducedPoint, ShiftFactor, VerticalFactor,
};
pub use sweep::{FitError, FitOptions, GivenShift, ModulusKind, Sweep, SweepPoint, VerticalChoice};

use chain::Chain;
use model::{Datum, Prony};
use terms::Fitted;

/// Decades by which relaxation times may lie outside the measured range.
const MARGIN_DECADES: f64 = 1.0;

/// Largest difference in K between a reference temperature and the sweep it means.
const SAME_TEMPERATURE_K: f64 = 0.5;

/// Fits a rubber to sweeps (Young's modulus) at one or several temperatures.
///
/// # Errors
/// [`FitError`]: bad numbers, too few points, temperatures without overlap, a reference
/// temperature that was not measured, no fit.
///
/// ```
/// use asperity_core::rubber::Rubber;
/// use asperity_core::rubber::fit::{FitOptions, Sweep, SweepPoint, fit_sweeps};
///
/// let rubber = Rubber::table_2_1();
/// let point = |k: i32| {
///     let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
///     let modulus = rubber.complex_modulus(angular_frequency);
///     SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
/// };
/// let sweep = Sweep { temperature_c: None, points: (0..44).map(point).collect() };
/// let fit = fit_sweeps(&[sweep], &FitOptions::default())?;
/// assert_eq!(fit.terms.len(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_sweeps(sweeps: &[Sweep], options: &FitOptions) -> Result<MasterCurve, FitError> {
    let sweeps = sweep::checked(sweeps)?;
    if options.vertical != VerticalChoice::None && sweeps.len() < 2 {
        return Err(FitError::VerticalWithoutTemperature);
    }
    let chain = match &options.shift_factors {
        Some(given) => chain::given(sweeps, given, options)?,
        None => chain::joined(sweeps, options)?,
    };
    let data = problem(&chain);
    let (fitted, candidates) = fitted(&chain, &data, options)?;
    Ok(MasterCurve::new(&chain, &fitted, candidates))
}

fn fitted(
    chain: &Chain,
    data: &Prony,
    options: &FitOptions,
) -> Result<(Fitted, Vec<Candidate>), FitError> {
    if matches!(chain.vertical, VerticalChoice::Free { .. }) {
        return verticals::choose(data, options.terms, &chain.starts());
    }
    terms::choose(data, options.terms, chain.start())
}

fn problem(chain: &Chain) -> Prony {
    let Chain { sweeps, reference, ln_shifts, .. } = chain;
    let datum = |(sweep, point): (usize, &SweepPoint)| Datum {
        ln_frequency: point.angular_frequency.ln(),
        sweep,
        ln_storage: point.storage_modulus.ln() - chain.ln_known_vertical(sweep),
        ln_loss: point.loss_modulus.ln() - chain.ln_known_vertical(sweep),
    };
    let points = sweeps.iter().enumerate();
    let data: Vec<Datum> =
        points.flat_map(|(k, sweep)| sweep.points.iter().map(move |p| (k, p))).map(datum).collect();
    let reduced = || data.iter().map(|datum| datum.ln_frequency + ln_shifts[datum.sweep]);
    let margin = MARGIN_DECADES * std::f64::consts::LN_10;
    let limits = [
        -reduced().fold(f64::NEG_INFINITY, f64::max) - margin,
        -reduced().fold(f64::INFINITY, f64::min) + margin,
    ];
    Prony {
        data,
        terms: 0,
        sweeps: sweeps.len(),
        reference: *reference,
        limits,
        given_shifts: chain.given.then(|| ln_shifts.clone()),
        verticals: chain.free_verticals(),
    }
}
