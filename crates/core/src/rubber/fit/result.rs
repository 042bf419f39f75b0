//! The result of a fit: a rubber with intervals, its misfit, shift factors and their law.

use super::chain::Chain;
use super::covariance::Covariance;
use super::law::{fit_laws, fit_vertical};
use super::model::{Prony, Series};
use super::terms::Fitted;
use super::{Sweep, SweepPoint, VerticalChoice};
use crate::rubber::{
    FrequencyRange, MaxwellBranch, Rubber, RubberData, ShiftLaw, TemperatureDependence,
    VerticalShift,
};
use serde::Serialize;
use std::f64::consts::{LN_10, TAU};

/// Half width of an interval beyond which a shift factor counts as not determined.
const WIDEST_DECADES: f64 = 0.3;

/// A positive quantity with its 95 % confidence interval.
///
/// From the covariance `s^2 (J^T J)^-1` of the linearised fit in the logarithm, Student's t. It takes
/// the deviations as independent and the number of terms as given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// In SI.
    pub value: f64,
    /// Lower and upper end; `None` for a relaxation time at the limit of what is allowed.
    pub confidence_95: Option<[f64; 2]>,
}

/// A term of the Prony series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittedTerm {
    /// Modulus in Pa.
    pub modulus: Estimate,
    /// Relaxation time in s.
    pub relaxation_time: Estimate,
}

/// The shift factor of a temperature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShiftFactor {
    /// Temperature in °C.
    pub temperature_c: f64,
    /// `log10 a_T`.
    pub log10_shift: f64,
    /// Half width of its 95 % confidence interval in decades; `None` at the reference and where it
    /// was given.
    pub confidence_95: Option<f64>,
    /// Whether the moduli do not determine it: its interval is wider than 0.3 decades on either side,
    /// or storage moduli change by little more than they scatter. It is left out of the law.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub uncertain: bool,
    /// The factor of the moduli, if there is a vertical shift.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical: Option<VerticalFactor>,
}

/// The vertical factor of a temperature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VerticalFactor {
    /// `b_T`, by which moduli are larger than at the reference.
    pub factor: f64,
    /// Lower and upper end of its 95 % confidence interval; `None` where it is not fitted.
    pub confidence_95: Option<[f64; 2]>,
}

/// The vertical shift that goes into the rubber file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittedVertical {
    /// The factor over temperature.
    pub law: VerticalShift,
    /// Half width of the 95 % confidence interval of its coefficient; `None` where that was given.
    pub confidence_95: Option<f64>,
    /// Residual standard deviation of `ln b_T`; `None` where nothing was fitted.
    pub residual: Option<f64>,
}

/// A sweep that cannot be joined to the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeftOut {
    /// Temperature in °C.
    pub temperature_c: f64,
    /// Smallest and largest storage modulus in MPa.
    pub storage_mpa: [f64; 2],
}

/// A law through the shift factors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedLaw {
    /// The law.
    pub law: ShiftLaw,
    /// Half widths of the 95 % confidence intervals of its coefficients in their order; `None` where
    /// the factors leave no freedom.
    pub confidence_95: Option<Vec<f64>>,
    /// Residual standard deviation in decades: root of the sum of squares over the degrees of
    /// freedom.
    pub residual_decades: f64,
}

/// Relative deviation of a fitted from a measured quantity over the points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviation {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub largest: f64,
}

/// Relative deviations over the measured range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Misfit {
    /// Of E'.
    pub storage_modulus: Deviation,
    /// Of E''.
    pub loss_modulus: Deviation,
    /// Of tan δ = E''/E'.
    pub loss_factor: Deviation,
}

/// A number of terms that was tried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Candidate {
    /// Number of terms.
    pub terms: usize,
    /// Root mean square of the deviations in ln E' and ln E''.
    pub rms_misfit: Option<f64>,
    /// Criterion of Schwarz; the smallest is best.
    pub bic: Option<f64>,
    /// Why it cannot be used.
    pub rejected: Option<&'static str>,
}

/// A measured point on the master curve, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedPoint {
    /// Number of its temperature among the shift factors; 0 without temperatures.
    pub sweep: usize,
    /// The point, with its frequency multiplied by the shift factor and its moduli divided by the
    /// vertical one.
    pub point: SweepPoint,
}

/// The result of [`fit_sweeps`](super::fit_sweeps).
#[derive(Debug, Clone, PartialEq)]
pub struct MasterCurve {
    /// Relaxed modulus in Pa.
    pub equilibrium_modulus: Estimate,
    /// Terms by descending relaxation time.
    pub terms: Vec<FittedTerm>,
    /// Reference temperature in °C, if temperatures are known.
    pub reference_c: Option<f64>,
    /// Shift factors by ascending temperature, the reference included; empty for one sweep.
    pub shifts: Vec<ShiftFactor>,
    /// Laws through them, the better one first.
    pub laws: Vec<FittedLaw>,
    /// The vertical shift, if there is one.
    pub vertical: Option<FittedVertical>,
    /// Sweeps that nothing joins to the others.
    pub left_out: Vec<LeftOut>,
    /// Temperatures in °C of neighbours that E'' and tan δ have joined for want of common E'.
    pub joined_by_loss_c: Vec<[f64; 2]>,
    /// Deviation from the measured moduli.
    pub misfit: Misfit,
    /// Measured frequencies at the reference temperature.
    pub measured: FrequencyRange,
    /// The numbers of terms that were tried.
    pub candidates: Vec<Candidate>,
    /// The points on the master curve, by sweep and frequency.
    pub points: Vec<ReducedPoint>,
}

impl MasterCurve {
    pub(super) fn new(chain: &Chain, fitted: &Fitted, candidates: Vec<Candidate>) -> Self {
        let Fitted { problem, series, .. } = fitted;
        let Chain { reference_c, .. } = *chain;
        let covariance = Covariance::new(fitted);
        let estimate = |column: usize, logarithm: f64| Estimate {
            value: logarithm.exp(),
            confidence_95: covariance
                .half_width(column)
                .map(|half| [(logarithm - half).exp(), (logarithm + half).exp()]),
        };
        let term = |(i, term): (usize, &[f64; 2])| FittedTerm {
            modulus: estimate(1 + i, term[0]),
            relaxation_time: estimate(1 + problem.terms + i, term[1]),
        };
        let shifts = shift_factors(chain, fitted, &covariance);
        let points = reduced(chain, series);
        let frequencies = || points.iter().map(|reduced| reduced.point.angular_frequency / TAU);
        Self {
            equilibrium_modulus: estimate(0, series.ln_equilibrium),
            terms: series.terms.iter().enumerate().map(term).collect(),
            laws: reference_c.map_or(Vec::new(), |reference| fit_laws(&shifts, reference)),
            vertical: vertical(chain, fitted, &covariance),
            reference_c,
            shifts,
            left_out: chain.left_out.clone(),
            joined_by_loss_c: chain.joined_by_loss_c.clone(),
            misfit: misfit(problem, series),
            measured: FrequencyRange {
                lowest_hz: frequencies().fold(f64::INFINITY, f64::min),
                highest_hz: frequencies().fold(0.0, f64::max),
            },
            candidates,
            points,
        }
    }

    /// The fitted rubber with its measured range and the better shift law.
    pub fn rubber(&self, name: &str, poisson_ratio: f64) -> RubberData {
        let branch = |term: &FittedTerm| MaxwellBranch {
            modulus: term.modulus.value,
            relaxation_time: term.relaxation_time.value,
        };
        let rubber = Rubber {
            name: name.into(),
            equilibrium_modulus: self.equilibrium_modulus.value,
            branches: self.terms.iter().map(branch).collect(),
            poisson_ratio,
            finite_strain: Default::default(),
        };
        let certain = || self.shifts.iter().filter(|shift| !shift.uncertain);
        let temperatures = || certain().map(|shift| shift.temperature_c);
        let measured_c =
            [temperatures().fold(f64::INFINITY, f64::min), temperatures().fold(-300.0, f64::max)];
        let temperature = self.laws.first().zip(self.reference_c).map(|(fitted, reference_c)| {
            let vertical = self.vertical.map(|vertical| vertical.law);
            let law = fitted.law.clone();
            TemperatureDependence { reference_c, law, measured_c: Some(measured_c), vertical }
        });
        RubberData { measured: Some(self.measured), temperature, ..rubber.into() }
    }
}

fn shift_factors(
    chain: &Chain,
    Fitted { problem, series, alternatives, .. }: &Fitted,
    covariance: &Covariance,
) -> Vec<ShiftFactor> {
    if chain.sweeps.len() < 2 {
        let given = chain.curve_factors.iter().map(|given| ShiftFactor {
            temperature_c: given.temperature_c,
            log10_shift: given.log10_shift,
            confidence_95: None,
            uncertain: false,
            vertical: None,
        });
        return given.collect();
    }
    let half_width = |column: Option<usize>, k: usize, of: fn(&Series) -> &[f64]| {
        let spread = |other: &Series| (of(other)[k] - of(series)[k]).abs();
        let spread = alternatives.iter().map(spread).fold(0.0, f64::max);
        column.and_then(|column| covariance.half_width(column)).map(|half| half.hypot(spread))
    };
    let vertical = |k: usize| match chain.vertical {
        VerticalChoice::None => None,
        VerticalChoice::RhoT { .. } => {
            Some(VerticalFactor { factor: chain.ln_known_vertical(k).exp(), confidence_95: None })
        }
        VerticalChoice::Free { .. } => {
            let ln = chain.ln_known_vertical(k) + series.ln_verticals[k];
            let interval = |half: f64| [(ln - half).exp(), (ln + half).exp()];
            let confidence_95 =
                half_width(problem.vertical_index(k), k, |series| &series.ln_verticals)
                    .map(|half| interval(half + chain.vertical_slack(k)));
            Some(VerticalFactor { factor: ln.exp(), confidence_95 })
        }
    };
    let factor = |(k, sweep): (usize, &Sweep)| {
        let half = half_width(problem.shift_index(k), k, |series| &series.ln_shifts);
        let confidence_95 = half.map(|half| (half + chain.slack(k, &series.ln_shifts)) / LN_10);
        let wide = confidence_95.is_some_and(|half| half > WIDEST_DECADES);
        sweep.temperature_c.map(|temperature_c| ShiftFactor {
            temperature_c,
            log10_shift: series.ln_shifts[k] / LN_10,
            confidence_95,
            uncertain: chain.uncertain[k] || wide,
            vertical: vertical(k),
        })
    };
    chain.sweeps.iter().enumerate().filter_map(factor).collect()
}

/// The vertical shift of the rubber file.
fn vertical(chain: &Chain, fitted: &Fitted, covariance: &Covariance) -> Option<FittedVertical> {
    match chain.vertical {
        VerticalChoice::None => None,
        VerticalChoice::RhoT { expansion_per_k } => {
            let law = VerticalShift::RhoT { expansion_per_k };
            Some(FittedVertical { law, confidence_95: None, residual: None })
        }
        VerticalChoice::Free { .. } => {
            let Fitted { problem, series, alternatives, .. } = fitted;
            let free = || (0..chain.sweeps.len()).filter(|k| problem.vertical_index(*k).is_some());
            let columns: Vec<usize> = free().filter_map(|k| problem.vertical_index(k)).collect();
            let factor = |k: usize, series: &Series| {
                let ln = chain.ln_known_vertical(k) + series.ln_verticals[k];
                Some((chain.sweeps[k].temperature_c?, ln))
            };
            let factors = |series: &Series| -> Vec<(f64, f64)> {
                free().filter_map(|k| factor(k, series)).collect()
            };
            let others: Vec<_> = alternatives.iter().map(factors).collect();
            fit_vertical(
                &factors(series),
                &others,
                &covariance.block(&columns)?,
                chain.reference_c?,
            )
        }
    }
}

fn misfit(problem: &Prony, series: &Series) -> Misfit {
    let deviation = |of: &dyn Fn([f64; 2]) -> f64| {
        let deviations = problem.data.iter().map(|datum| {
            let measured = [datum.ln_storage.exp(), datum.ln_loss.exp()];
            of(series.moduli(datum)) / of(measured) - 1.0
        });
        let (squares, largest) = deviations
            .fold((0.0, 0.0_f64), |(squares, largest), d| (squares + d * d, largest.max(d.abs())));
        Deviation { rms: (squares / problem.data.len() as f64).sqrt(), largest }
    };
    Misfit {
        storage_modulus: deviation(&|[storage, _]| storage),
        loss_modulus: deviation(&|[_, loss]| loss),
        loss_factor: deviation(&|[storage, loss]| loss / storage),
    }
}

fn reduced(chain: &Chain, series: &Series) -> Vec<ReducedPoint> {
    let sweeps = chain.sweeps.iter().enumerate();
    let of_sweep = |(sweep, points): (usize, &Sweep)| {
        let factor = series.ln_shifts[sweep].exp();
        let vertical = (series.ln_verticals[sweep] + chain.ln_known_vertical(sweep)).exp();
        let reduced = move |point: &SweepPoint| ReducedPoint {
            sweep,
            point: SweepPoint {
                angular_frequency: point.angular_frequency * factor,
                storage_modulus: point.storage_modulus / vertical,
                loss_modulus: point.loss_modulus / vertical,
            },
        };
        points.points.iter().map(reduced).collect::<Vec<_>>()
    };
    sweeps.flat_map(of_sweep).collect()
}
