//! Vertical factors that are fitted together with the shift factors.
//!
//! Along a power law of the moduli a vertical factor and a shift are the same change, so that moduli of some noise
//! determine no more than a combination of both. A prior decides the rest: the factors are those of density times
//! temperature up to a random walk over temperature ([`WALK_PER_ROOT_K`]), which enters the fit, and so the intervals,
//! as residuals ([`FreeVerticals`]).
//!
//! The misfit has a minimum for about every branch by which a sweep can be moved along the curve. The
//! fit therefore starts from several laws of the factors; the result with the least criterion is taken:
//!
//! ```text
//! n ln(mean r^2) + p ln n + sum over neighbours ((ln b_{k+1} - ln b_k) / step_k)^2
//! ```
//!
//! with the n residuals r of moduli and p parameters.
//!
//! Where a spectrum has no features, a few terms have some and the shifts follow them: fits of other numbers of terms,
//! as good as the chosen one, then have other shifts, and so have fits with fixed factors: none, ρT or the ends of the
//! interval about it. The largest difference between the chosen fit and one that is as good is added to the interval.

use super::model::{FreeVerticals, Prony, Series};
use super::terms::{self, Fitted, judge};
use super::{Candidate, FitError};
use crate::numerics::least_squares::{ROUND_OFF, minimise};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Standard deviation of the change of `ln(b / ρT)` over a kelvin; it grows with the root of the
/// difference. Over 100 K 95 % of the factors lie between half and twice that of density times
/// temperature: ln 2 / (1.96 √100).
pub(super) const WALK_PER_ROOT_K: f64 = 0.035;
/// Rounds of terms and factors; two are usual.
const MOST_ROUNDS: usize = 4;
/// Rounds of the noise that weights the prior; three are usual.
const MOST_UPDATES: usize = 12;
/// Quantiles (95 %) of chi square for two degrees of freedom a term: one, two and three terms more or
/// less.
const NEIGHBOURS: [f64; 3] = [5.991, 9.488, 12.592];
/// Difference of criteria below which two results are the same to round-off.
const CLEARLY_BETTER: f64 = 0.1;
/// Relative change of the noise that has no effect on intervals.
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

/// The best fit of all starts, the number of terms by criterion or as given. The factors that are
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
            // Other factors may need another number of terms.
            let Series { ln_shifts, ln_verticals, .. } = end.1.series;
            best = from_start(data, wanted, &Start { ln_shifts, ln_verticals }).unwrap_or(best);
        }
    }
    let (_, mut fitted, candidates) = best;
    let held: Vec<Fitted> =
        starts.iter().filter_map(|start| held_at(data, &fitted, start)).collect();
    let as_good = held.into_iter().filter(|held| as_good(held, &fitted)).map(|held| held.series);
    let as_good: Vec<Series> = as_good.collect();
    fitted.alternatives.extend(as_good);
    Ok((fitted, candidates))
}

/// Whether a fit with factors held is as good by the likelihood ratio (95 %) as one with them fitted.
fn as_good(held: &Fitted, fitted: &Fitted) -> bool {
    let n = 2.0 * fitted.problem.data.len() as f64;
    let free = |k: usize| fitted.problem.vertical_index(k).is_some();
    let factors = (0..fitted.problem.sweeps).filter(|k| free(*k)).count();
    let quantile = ChiSquared::new(factors as f64).map_or(0.0, |chi| chi.inverse_cdf(0.95));
    n * (held.rms.max(ROUND_OFF).powi(2) / mean_square(fitted)).ln() < quantile
}

/// The terms of a fit with the vertical factors of a start, not fitted, shifts from there.
fn held_at(data: &Prony, fitted: &Fitted, start: &Start) -> Option<Fitted> {
    let terms = fitted.problem.terms;
    let problem = Prony { terms, ..with_verticals_held(data, &start.ln_verticals) };
    let mut series = Series { ln_shifts: start.ln_shifts.clone(), ..fitted.series.clone() };
    series.ln_verticals.fill(0.0);
    let minimum = minimise(&problem, problem.pack(&series))?;
    let mut series = problem.unpack(&minimum.parameters);
    series.ln_verticals.clone_from(&start.ln_verticals);
    Some(Fitted { problem, series, rms: minimum.rms, alternatives: Vec::new() })
}

/// Where the terms of a fit end with the shifts and factors of another start, held at first, then
/// free, the prior weighed by the noise of that fit.
fn from_terms_of(data: &Prony, end: &End, start: &Start) -> Option<End> {
    let problem = &end.1.problem;
    let mut series = held_at(data, &end.1, start)?.series;
    let found = minimise(problem, problem.pack(&series));
    let fitted = judge(problem.clone(), found, &mut series).1?;
    Some((criterion(&fitted), fitted, end.2.clone()))
}

/// With few terms, free factors move sweeps away from the others for good. So the
/// number of terms is chosen with the factors held, then they are freed, as long as the number grows:
/// fewer terms bend the shifts until their own bumps fit.
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
        let held = with_verticals_held(data, &start.ln_verticals);
        let (mut chosen, candidates, mut all) = terms::choose_of_all(&held, wanted, without_terms)?;
        if chosen.problem.terms <= terms {
            break;
        }
        terms = chosen.problem.terms;
        for fit in all.iter_mut().chain([&mut chosen]) {
            fit.series.ln_verticals.clone_from(&start.ln_verticals);
        }
        // With free factors a superfluous term may vanish: then the next number of terms is taken.
        let fewer = all.iter().rev().filter(|fit| fit.problem.terms < terms);
        let mut fits = std::iter::once(&chosen).chain(fewer).filter_map(|fit| freed(data, fit));
        let Some((mut fitted, _)) = fits.find(|(_, usable)| *usable) else { break };
        fitted.alternatives = alternatives(data, &fitted, &all);
        // The number of terms may differ.
        if as_good(&chosen, &fitted) {
            fitted.alternatives.push(chosen.series.clone());
        }
        let Series { ln_shifts, ln_verticals, .. } = fitted.series.clone();
        start = Start { ln_shifts, ln_verticals };
        best = Some((criterion(&fitted), fitted, candidates));
    }
    let reason = "with free vertical factors it did not converge";
    best.ok_or(FitError::NoFit { terms: wanted, reason })
}

/// The fits of neighbouring numbers of terms, freed, whose misfit is as good as that of the chosen
/// one by the likelihood ratio (95 %).
fn alternatives(data: &Prony, chosen: &Fitted, all: &[Fitted]) -> Vec<Series> {
    let near = |fit: &&Fitted| {
        (1..=NEIGHBOURS.len()).contains(&fit.problem.terms.abs_diff(chosen.problem.terms))
    };
    let indistinct = |fit: &Fitted| {
        let difference = fit.problem.terms.abs_diff(chosen.problem.terms);
        let n = 2.0 * data.data.len() as f64;
        n * (mean_square(fit) / mean_square(chosen)).ln() < NEIGHBOURS[difference - 1]
    };
    // Even fits that may not be used, because a term is negligible, show which shifts are possible.
    let freed = all.iter().filter(near).filter_map(|fit| freed(data, fit));
    freed.map(|(fit, _)| fit).filter(indistinct).map(|fit| fit.series).collect()
}

/// A fit with its vertical factors freed, from those of its series, and whether it may be used. The
/// noise that weighs the prior is that of the fit itself.
fn freed(data: &Prony, held: &Fitted) -> Option<(Fitted, bool)> {
    let mut noise = held.noise();
    let mut series = held.series.clone();
    for round in 1.. {
        let verticals = data.verticals.clone().map(|free| FreeVerticals { noise, ..free });
        let problem = Prony { terms: held.problem.terms, verticals, ..data.clone() };
        let found = minimise(&problem, problem.pack(&series));
        let candidate = judge(problem.clone(), found, &mut series).0;
        let rms = candidate.rms_misfit?;
        let fit = Fitted { problem, series: series.clone(), rms, alternatives: Vec::new() };
        let next = fit.noise();
        let settled = next < ROUND_OFF || (next / noise - 1.0).abs() < SAME_NOISE;
        if settled || round == MOST_UPDATES {
            return Some((fit, candidate.rejected.is_none()));
        }
        noise = next;
    }
    None
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

/// Of the residuals of moduli.
fn mean_square(fitted: &Fitted) -> f64 {
    let n = 2 * fitted.problem.data.len();
    let residuals = fitted.problem.residuals_of(&fitted.series);
    (residuals.rows(0, n).norm_squared() / n as f64).max(ROUND_OFF * ROUND_OFF)
}

fn criterion(fitted: &Fitted) -> f64 {
    let n = 2.0 * fitted.problem.data.len() as f64;
    let parameters = fitted.problem.parameters() as f64 + 1.0;
    let verticals = fitted.problem.verticals.iter();
    let prior: f64 = verticals.map(|free| free.improbability(&fitted.series)).sum();
    n * mean_square(fitted).ln() + parameters * n.ln() + prior
}
