//! The fit for a number of terms, and the number of terms.
//!
//! The misfit has many local minima in the relaxation times. Each number of terms starts twice:
//! from times spaced evenly in the logarithm, and from the fit with one term less and the new term
//! where it lowers the misfit most; the better minimum is taken.
//!
//! The number of terms minimises the criterion of Schwarz (Ann. Stat. 6, 461, 1978,
//! doi:10.1214/aos/1176344136), for n residuals and p parameters with the variance
//!
//! ```text
//! BIC = n ln(mean r^2) + p ln n
//! ```
//!
//! but a misfit below a thousandth is not reduced further.

use super::model::{Prony, Series, weights};
use super::{Candidate, FitError};
use crate::numerics::least_squares::{Minimum, ROUND_OFF, minimise};
use nalgebra::{DMatrix, DVector};

/// More terms could not be distinguished by data with noise.
const MOST_TERMS_PER_DECADE: f64 = 2.0;
/// Root mean square misfit with which the search ends: no modulus is measured any better.
const ENOUGH: f64 = 1e-3;
/// The search ends when the criterion has not fallen for as many numbers of terms.
const PATIENCE: usize = 3;
/// Where a new term is tried, per decade.
const TRIALS_PER_DECADE: f64 = 4.0;
/// Multiplicative updates of the moduli of a start.
const UPDATES: usize = 100;
/// A term whose relative contribution to both moduli is nowhere larger is left out.
const VANISHING: f64 = 1e-6;
/// Beyond this condition number of the Jacobian the singular values are round-off.
const SINGULAR: f64 = 1e12;

/// A fit that may be used.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub problem: Prony,
    pub series: Series,
    pub rms: f64,
    /// Other numbers of terms that fit as well, for free vertical factors.
    pub alternatives: Vec<Series>,
}

impl Fitted {
    /// Degrees of freedom: residuals less the parameters that they determine.
    pub fn freedom(&self) -> f64 {
        (self.problem.rows() - self.problem.free_columns(&self.series).len()) as f64
    }

    /// Standard deviation of the residuals.
    pub fn noise(&self) -> f64 {
        self.rms * (self.problem.rows() as f64 / self.freedom()).sqrt()
    }
}

/// Fits numbers of terms one after the other from the shifts of a series without terms, up to the given one or until
/// the criterion has its minimum.
///
/// # Errors
/// [`FitError::TooFewPoints`], [`FitError::NoFit`].
pub(super) fn choose(
    data: &Prony,
    wanted: Option<usize>,
    previous: Series,
) -> Result<(Fitted, Vec<Candidate>), FitError> {
    let (fitted, candidates, _) = choose_of_all(data, wanted, previous)?;
    Ok((fitted, candidates))
}

/// [`choose`], with the fits of all numbers of terms that were tried and may be used.
///
/// # Errors
/// As [`choose`].
pub(super) fn choose_of_all(
    data: &Prony,
    wanted: Option<usize>,
    mut previous: Series,
) -> Result<(Fitted, Vec<Candidate>, Vec<Fitted>), FitError> {
    let mut all = Vec::new();
    let most = most_terms(data, &previous.ln_shifts);
    if most == 0 || wanted.is_some_and(|wanted| wanted > most_determined(data)) {
        let needed = (2 * wanted.unwrap_or(1) + without_terms(data) + 2).div_ceil(2);
        return Err(FitError::TooFewPoints { points: data.data.len(), needed });
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut best: Option<(f64, Fitted)> = None;
    let mut since_best = 0;
    for terms in 1..=wanted.unwrap_or(most) {
        let problem = Prony { terms, ..data.clone() };
        let found = best_minimum(&problem, &previous);
        let (candidate, fitted) = judge(problem, found, &mut previous);
        since_best += 1;
        all.extend(fitted.clone());
        if let (Some(fitted), Some(criterion)) = (fitted, candidate.bic) {
            let asked = wanted == Some(terms);
            if asked
                || wanted.is_none() && best.as_ref().is_none_or(|(least, _)| criterion < *least)
            {
                best = Some((criterion, fitted));
                since_best = 0;
            }
        }
        candidates.push(candidate);
        let ended = since_best == PATIENCE
            || since_best == 0 && best.as_ref().is_some_and(|(_, fitted)| fitted.rms < ENOUGH);
        if wanted.is_none() && best.is_some() && ended {
            break;
        }
    }
    match best {
        Some((_, fitted)) => Ok((fitted, candidates, all)),
        None => {
            let last = candidates.iter().rev().find_map(|candidate| candidate.rejected);
            Err(FitError::NoFit { terms: wanted, reason: last.unwrap_or("it did not converge") })
        }
    }
}

/// The largest number that leaves a degree of freedom in addition to the variance.
fn most_determined(data: &Prony) -> usize {
    (2 * data.data.len()).saturating_sub(without_terms(data) + 2) / 2
}

/// Parameters of no term: equilibrium modulus and shifts.
fn without_terms(data: &Prony) -> usize {
    Prony { terms: 0, ..data.clone() }.parameters()
}

fn most_terms(data: &Prony, shifts: &[f64]) -> usize {
    let [low, high] = reduced_range(data, shifts);
    let decades = (high - low) / std::f64::consts::LN_10;
    most_determined(data).min((MOST_TERMS_PER_DECADE * decades).ceil() as usize + 2)
}

/// ln of the lowest and the highest reduced frequency.
fn reduced_range(data: &Prony, shifts: &[f64]) -> [f64; 2] {
    let reduced = || data.data.iter().map(|datum| datum.ln_frequency + shifts[datum.sweep]);
    [reduced().fold(f64::INFINITY, f64::min), reduced().fold(f64::NEG_INFINITY, f64::max)]
}

/// The better of two starts.
fn best_minimum(problem: &Prony, previous: &Series) -> Option<Minimum> {
    let spaced = spaced_start(problem, previous);
    let starts = [Some(spaced), inserted_start(problem, previous)];
    let ends = starts.iter().flatten().filter_map(|start| minimise(problem, problem.pack(start)));
    ends.min_by(|a, b| a.rms.total_cmp(&b.rms))
}

/// The fit of a number of terms, which starts from `previous`.
pub(super) fn judge(
    problem: Prony,
    found: Option<Minimum>,
    previous: &mut Series,
) -> (Candidate, Option<Fitted>) {
    let terms = problem.terms;
    let Some(minimum) = found else {
        let rejected = Some("a residual is not a number");
        return (Candidate { terms, rms_misfit: None, bic: None, rejected }, None);
    };
    let mut series = problem.unpack(&minimum.parameters);
    let rejected = rejection(&problem, &series, &minimum);
    series.terms.sort_by(|a, b| b[1].total_cmp(&a[1]));
    *previous = series.clone();
    let n = 2.0 * problem.data.len() as f64;
    let parameters = problem.parameters() as f64 + 1.0;
    let bic = n * minimum.rms.max(ROUND_OFF).powi(2).ln() + parameters * n.ln();
    let candidate = Candidate { terms, rms_misfit: Some(minimum.rms), bic: Some(bic), rejected };
    let fitted = Fitted { problem, series, rms: minimum.rms, alternatives: Vec::new() };
    (candidate, rejected.is_none().then_some(fitted))
}

/// Why a minimum is not a rubber.
fn rejection(problem: &Prony, series: &Series, minimum: &Minimum) -> Option<&'static str> {
    let jacobian = problem.logarithmic_jacobian(series);
    let vanishes = |column: usize| jacobian.column(column).amax() < VANISHING;
    if vanishes(0) {
        return Some("the equilibrium modulus vanishes: the storage modulus has no plateau");
    }
    if (1..=problem.terms).any(vanishes) {
        return Some("a term vanishes");
    }
    let free = problem.free_columns(series);
    let singular = jacobian.select_columns(&free).singular_values();
    if singular.max() > SINGULAR * singular.min() {
        return Some("two terms coincide");
    }
    (!minimum.converged()).then_some("the fit did not converge")
}

/// Times at the middles of equal parts of the measured range.
fn spaced_start(problem: &Prony, previous: &Series) -> Series {
    let [low, high] = reduced_range(problem, &previous.ln_shifts);
    let step = (high - low) / problem.terms as f64;
    let times: Vec<f64> = (0..problem.terms).map(|i| -low - (i as f64 + 0.5) * step).collect();
    with_moduli(problem, &times, previous)
}

/// The previous terms and the new one that lowers the misfit most.
fn inserted_start(problem: &Prony, previous: &Series) -> Option<Series> {
    let step = std::f64::consts::LN_10 / TRIALS_PER_DECADE;
    let [low, high] = reduced_range(problem, &previous.ln_shifts);
    let trials = ((high - low) / step).ceil() as usize + 1;
    let trial = |k: usize| {
        let time = -high + k as f64 * step;
        let near = |term: &[f64; 2]| (term[1] - time).abs() < 0.5 * step;
        if previous.terms.iter().any(near) {
            return None;
        }
        let times: Vec<f64> =
            previous.terms.iter().map(|term| term[1]).chain(std::iter::once(time)).collect();
        let start = with_moduli(problem, &times, previous);
        Some((problem.residuals_of(&start).norm(), start))
    };
    let best = (0..trials).filter_map(trial).min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, start)| start)
}

/// Positive moduli for given times that bring the relative misfit down: multiplicative updates
/// `x <- x (A^T b) / (A^T A x)`, which never leave the positive numbers (Daube-Witherspoon &
/// Muehllehner, IEEE Trans. Med. Imaging 5, 61, 1986, doi:10.1109/TMI.1986.4307748).
fn with_moduli(problem: &Prony, ln_times: &[f64], previous: &Series) -> Series {
    let Series { ln_shifts, ln_verticals, .. } = previous;
    let points = problem.data.len();
    let mut shares = DMatrix::zeros(2 * points, 1 + ln_times.len());
    for (j, datum) in problem.data.iter().enumerate() {
        let ln_frequency = datum.ln_frequency + ln_shifts[datum.sweep];
        let ln_vertical = ln_verticals[datum.sweep];
        shares[(2 * j, 0)] = (ln_vertical - datum.ln_storage).exp();
        for (i, ln_time) in ln_times.iter().enumerate() {
            let [s, l] = weights(ln_frequency + ln_time);
            shares[(2 * j, 1 + i)] = s * (ln_vertical - datum.ln_storage).exp();
            shares[(2 * j + 1, 1 + i)] = l * (ln_vertical - datum.ln_loss).exp();
        }
    }
    let normal = shares.tr_mul(&shares);
    let wanted = shares.tr_mul(&DVector::from_element(2 * points, 1.0));
    // Scaled so that each column alone fits the data best.
    let mut moduli = DVector::from_fn(wanted.len(), |i, _| wanted[i] / normal[(i, i)]);
    for _ in 0..UPDATES {
        let sums = &normal * &moduli;
        moduli.component_mul_assign(&wanted.component_div(&sums));
    }
    let terms = ln_times.iter().enumerate().map(|(i, time)| [moduli[1 + i].ln(), *time]).collect();
    Series {
        ln_equilibrium: moduli[0].ln(),
        terms,
        ln_shifts: ln_shifts.clone(),
        ln_verticals: ln_verticals.clone(),
    }
}
