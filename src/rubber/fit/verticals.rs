//! Vertical factors that are fitted together with the shift factors.
//!
//! Along a power law of the moduli a vertical factor and a shift are the same change, so that moduli
//! of some noise determine no more than a combination of both. What is known beforehand decides the
//! rest: the factors are those of density times temperature but for a random walk over temperature
//! ([`WALK_PER_ROOT_K`]), which enters the fit as residuals of its own ([`FreeVerticals`]) and so the
//! intervals too.
//!
//! The misfit has a minimum for about every branch by which a sweep can be moved along the curve. The
//! fit therefore starts from several laws of the factors; the end with the least criterion counts:
//!
//! ```text
//! n ln(mean r^2) + p ln n + sum over neighbours ((ln b_{k+1} - ln b_k) / step_k)^2
//! ```
//!
//! with the n residuals r of moduli and p parameters.

use super::least_squares::{ROUND_OFF, minimise};
use super::model::{FreeVerticals, Prony, Series};
use super::terms::{self, Fitted, judge};
use super::{Candidate, FitError};

/// Standard deviation of the change of `ln(b / ρT)` over a kelvin; it grows with the root of the
/// difference. Over 100 K 95 % of the factors lie between half and twice that of density times
/// temperature: ln 2 / (1.96 √100).
pub(super) const WALK_PER_ROOT_K: f64 = 0.035;
/// Rounds of terms and factors; two are usual.
const MOST_ROUNDS: usize = 4;
/// Rounds of the noise, by which the prior is weighed; three are usual.
const MOST_UPDATES: usize = 12;
/// Difference of criteria below which two ends are the same but for round-off.
const CLEARLY_BETTER: f64 = 0.1;
/// Relative change of the noise that no interval shows.
const SAME_NOISE: f64 = 0.02;

/// Where a fit starts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Start {
    /// ln a of every sweep.
    pub ln_shifts: Vec<f64>,
    /// ln b of every sweep.
    pub ln_verticals: Vec<f64>,
}

/// A fit with the criterion by which starts are compared.
type End = (f64, Fitted, Vec<Candidate>);

/// The best fit of all starts, the number of terms by criterion or as wanted. The factors that are
/// free are those of `data.verticals`, its noise is not used.
///
/// # Errors
/// As [`terms::choose`], of the first start if none has a fit.
pub(super) fn choose(
    data: &Prony,
    wanted: Option<usize>,
    starts: &[Start],
) -> Result<(Fitted, Vec<Candidate>), FitError> {
    let (first, others) = starts.split_first().ok_or(FitError::Empty)?;
    let mut best = from_start(data, wanted, first)?;
    for start in others {
        let Some(end) = from_terms_of(data, &best, start) else { continue };
        if end.0 < best.0 - CLEARLY_BETTER {
            let Series { ln_shifts, ln_verticals, .. } = end.1.series.clone();
            best = end;
            // Other factors may need another number of terms.
            let start = Start { ln_shifts, ln_verticals };
            if let Ok(end) = from_start(data, wanted, &start)
                && end.0 < best.0
            {
                best = end;
            }
        }
    }
    let (_, fitted, candidates) = best;
    Ok((fitted, candidates))
}

/// Where the terms of a fit end with the shifts and factors of another start, held at first, then
/// free, the prior weighed by the noise of that fit.
fn from_terms_of(data: &Prony, end: &End, start: &Start) -> Option<End> {
    let Fitted { problem, series, .. } = &end.1;
    let held = Prony { terms: problem.terms, ..with_verticals_held(data, &start.ln_verticals) };
    let mut series = Series { ln_shifts: start.ln_shifts.clone(), ..series.clone() };
    series.ln_verticals.fill(0.0);
    let minimum = minimise(&held, held.pack(&series))?;
    let mut series = held.unpack(&minimum.parameters);
    series.ln_verticals.clone_from(&start.ln_verticals);
    let found = minimise(problem, problem.pack(&series));
    let fitted = judge(problem.clone(), found, &mut series).1?;
    Some((criterion(&fitted), fitted, end.2.clone()))
}

/// Few terms with free factors move whole sweeps away from the others and never find back. So the
/// number of terms is chosen with the factors held, then they are freed, until the number stays.
fn from_start(data: &Prony, wanted: Option<usize>, start: &Start) -> Result<End, FitError> {
    let mut start = start.clone();
    let mut best: Option<End> = None;
    let mut terms = 0;
    for _ in 0..MOST_ROUNDS {
        let without_terms = Series {
            ln_equilibrium: 0.0,
            terms: Vec::new(),
            ln_shifts: start.ln_shifts,
            ln_verticals: vec![0.0; data.sweeps],
        };
        let (mut held, candidates) =
            terms::choose(&with_verticals_held(data, &start.ln_verticals), wanted, without_terms)?;
        held.series.ln_verticals = start.ln_verticals;
        let (series, fitted) = freed(data, &held);
        if let Some(fitted) = fitted {
            let criterion = criterion(&fitted);
            if best.as_ref().is_none_or(|best| criterion < best.0) {
                best = Some((criterion, fitted, candidates));
            }
        }
        if held.problem.terms == terms {
            break;
        }
        terms = held.problem.terms;
        start = Start { ln_shifts: series.ln_shifts, ln_verticals: series.ln_verticals };
    }
    let reason = "with free vertical factors it did not converge";
    best.ok_or(FitError::NoFit { terms: wanted, reason })
}

/// A fit with its vertical factors freed, from those of its series: where it ends, and the fit if it
/// is one. The noise that weighs the prior is that of the fit itself.
pub(super) fn freed(data: &Prony, held: &Fitted) -> (Series, Option<Fitted>) {
    let mut noise = held.noise();
    let mut series = held.series.clone();
    let mut fitted = None;
    for _ in 0..MOST_UPDATES {
        let verticals = data.verticals.clone().map(|free| FreeVerticals { noise, ..free });
        let problem = Prony { terms: held.problem.terms, verticals, ..data.clone() };
        let found = minimise(&problem, problem.pack(&series));
        fitted = judge(problem, found, &mut series).1;
        let Some(fit) = &fitted else { break };
        let next = fit.noise();
        let settled = next < ROUND_OFF || (next / noise - 1.0).abs() < SAME_NOISE;
        noise = next;
        if settled {
            break;
        }
    }
    (series, fitted)
}

/// The problem with given vertical factors that are not fitted.
fn with_verticals_held(data: &Prony, ln_verticals: &[f64]) -> Prony {
    let mut held = Prony { verticals: None, ..data.clone() };
    for datum in &mut held.data {
        datum.ln_storage -= ln_verticals[datum.sweep];
        datum.ln_loss -= ln_verticals[datum.sweep];
    }
    held
}

fn criterion(fitted: &Fitted) -> f64 {
    let residuals = fitted.problem.residuals_of(&fitted.series);
    let n = 2 * fitted.problem.data.len();
    let mean_square = residuals.rows(0, n).norm_squared() / n as f64;
    let parameters = fitted.problem.parameters() as f64 + 1.0;
    let prior: f64 =
        fitted.problem.verticals.iter().map(|free| free.improbability(&fitted.series)).sum();
    let n = n as f64;
    n * mean_square.max(ROUND_OFF * ROUND_OFF).ln() + parameters * n.ln() + prior
}
