//! A rubber from measured storage and loss moduli: master curve, Prony series, shift law.
//!
//! All sweeps are fitted at once: one Prony series (a generalised Maxwell model) at the reference
//! temperature, and a shift factor for every other temperature,
//!
//! ```text
//! E*(ω, T) = E*(a_T ω, T_r),   E*(ω) = E_inf + sum_i E_i i ω τ_i / (1 + i ω τ_i)
//! ```
//!
//! They minimise the sum of squares of `ln E'` and `ln E''` against the measured ones: relative
//! deviations, every point and both moduli with the same weight. Relaxation times are free within
//! a decade of the measured range, the number of terms follows from a criterion. Shifts are
//! horizontal only: the moduli themselves are taken to be the same at all temperatures.

mod law;
mod least_squares;
mod model;
mod result;
mod shift;
mod sweep;
mod table;
mod terms;

#[cfg(test)]
mod tests;

pub use result::{
    Candidate, Deviation, Estimate, FittedLaw, FittedTerm, MasterCurve, Misfit, ReducedPoint,
    ShiftFactor,
};
pub use sweep::{FitError, FitOptions, ModulusKind, Sweep, SweepPoint};
pub use table::{TableError, parse_sweeps, read_sweeps};

use model::{Datum, Prony};

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
/// use asperity::rubber::Rubber;
/// use asperity::rubber::fit::{FitOptions, Sweep, SweepPoint, fit_sweeps};
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
    let reference = reference(&sweeps, options.reference_c)?;
    let first = shift::first_shifts(&sweeps, reference)?;
    let data = problem(&sweeps, reference, &first);
    let (fitted, candidates) = terms::choose(&data, options.terms, first)?;
    Ok(MasterCurve::new(&sweeps, &fitted, candidates))
}

/// Number of the sweep at the reference temperature: the wanted one, else the middle one.
fn reference(sweeps: &[Sweep], wanted: Option<f64>) -> Result<usize, FitError> {
    let Some(wanted_c) = wanted else { return Ok((sweeps.len() - 1) / 2) };
    let distance = |sweep: &Sweep| (sweep.temperature_c.unwrap_or(f64::NAN) - wanted_c).abs();
    let nearest =
        (0..sweeps.len()).min_by(|a, b| distance(&sweeps[*a]).total_cmp(&distance(&sweeps[*b])));
    nearest.filter(|k| distance(&sweeps[*k]) <= SAME_TEMPERATURE_K).ok_or_else(|| {
        let measured_c = sweeps.iter().filter_map(|sweep| sweep.temperature_c).collect();
        FitError::Reference { wanted_c, measured_c }
    })
}

fn problem(sweeps: &[Sweep], reference: usize, shifts: &[f64]) -> Prony {
    let datum = |(sweep, point): (usize, &SweepPoint)| Datum {
        ln_frequency: point.angular_frequency.ln(),
        sweep,
        ln_storage: point.storage_modulus.ln(),
        ln_loss: point.loss_modulus.ln(),
    };
    let points = sweeps.iter().enumerate();
    let data: Vec<Datum> =
        points.flat_map(|(k, sweep)| sweep.points.iter().map(move |p| (k, p))).map(datum).collect();
    let reduced = || data.iter().map(|datum| datum.ln_frequency + shifts[datum.sweep]);
    let margin = MARGIN_DECADES * std::f64::consts::LN_10;
    let limits = [
        -reduced().fold(f64::NEG_INFINITY, f64::max) - margin,
        -reduced().fold(f64::INFINITY, f64::min) + margin,
    ];
    Prony { data, terms: 0, sweeps: sweeps.len(), reference, limits }
}
