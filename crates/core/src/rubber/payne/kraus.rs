//! Kraus' law of softening with strain, and its fit.

use super::sweep::Ordered;
use super::{PayneError, StrainPoint, StrainSweep};
use crate::numerics::least_squares::{LeastSquares, Minimum, minimise};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Fewest strains that a fit of seven numbers to two moduli needs.
const FEWEST: usize = 6;
/// Starts of the exponent: many rubbers have some 0.6.
const EXPONENTS: [f64; 3] = [0.4, 0.6, 1.0];

/// Kraus' law at one temperature (J. Appl. Polym. Sci.: Appl. Polym. Symp. 39, 75, 1984; Heinrich & Klüppel,
/// doi:10.1007/3-540-45362-8_1), with `x = ε/ε_c`:
///
/// ```text
/// f(ε) = f_inf + (1 - f_inf) / (1 + x^2m)
/// g(ε) = g_inf + (1 - g_inf) / (1 + x^2m) + 2 g_p x^m / (1 + x^2m)
/// ```
///
/// Contacts of the filler network break at a rate of x^m and heal at x^-m: f is the share that stands, the last term of g the
/// rate at which contacts change. Kraus' own law has `g_inf = 1`: one loss modulus at small and large strains, so that g never
/// is below 1. Measured loss moduli fall far below (to a quarter for tread compounds), because the network takes its own loss
/// with it; the term of `1 - g_inf` lets it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Kraus {
    /// Critical strain ε_c, at which half of the network is broken.
    pub critical_strain: f64,
    /// Exponent m.
    pub exponent: f64,
    /// f_inf, from 0 to 1.
    pub storage_limit: f64,
    /// g_inf; 1 in Kraus' own law.
    pub loss_limit: f64,
    /// g_p, not negative.
    pub loss_peak: f64,
    /// Largest measured strain; beyond it both factors are constant.
    pub highest_strain: f64,
}

/// Kraus' law fitted to a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct KrausFit {
    /// Temperature of the sweep in °C.
    pub temperature_c: Option<f64>,
    /// The law.
    pub law: Kraus,
    /// Storage modulus at vanishing strain, in the unit of the sweep.
    pub storage_modulus: f64,
    /// Loss modulus at vanishing strain, in the unit of the sweep.
    pub loss_modulus: f64,
    /// Root mean square deviation of storage and loss modulus, relative.
    pub rms: [f64; 2],
    /// The same of Kraus' own law, with `g_inf = 1`; `None` where its fit does not converge.
    pub rms_of_own_law: Option<[f64; 2]>,
    /// Points that were left out as outliers.
    pub left_out: Vec<StrainPoint>,
}

impl Kraus {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`PayneError::Number`].
    pub fn validate(&self, temperature_c: Option<f64>) -> Result<(), PayneError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        // The loss of a rubber grows by a factor of a few at most; a fit to a sweep with a wrong row has no bound.
        let factor = |value: f64| (0.0..=100.0).contains(&value);
        let checks = [
            (
                "critical_strain",
                self.critical_strain,
                positive(self.critical_strain),
                "positive and finite",
            ),
            (
                "exponent",
                self.exponent,
                (0.01..=10.0).contains(&self.exponent),
                "between 0.01 and 10",
            ),
            (
                "storage_limit",
                self.storage_limit,
                (0.0..=1.0).contains(&self.storage_limit),
                "between 0 and 1",
            ),
            ("loss_limit", self.loss_limit, factor(self.loss_limit), "between 0 and 100"),
            ("loss_peak", self.loss_peak, factor(self.loss_peak), "between 0 and 100"),
            (
                "highest_strain",
                self.highest_strain,
                positive(self.highest_strain),
                "positive and finite",
            ),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((quantity, value, _, wanted)) => {
                Err(PayneError::Number { temperature_c, quantity, value, wanted })
            }
        }
    }

    pub(super) fn factors(&self, strain: f64) -> [f64; 2] {
        let y = (strain.min(self.highest_strain) / self.critical_strain).powf(self.exponent);
        let stands = 1.0 / (1.0 + y * y);
        let storage = self.storage_limit + (1.0 - self.storage_limit) * stands;
        let loss =
            self.loss_limit + (1.0 - self.loss_limit) * stands + 2.0 * self.loss_peak * y * stands;
        [storage, loss]
    }

    /// Fits the law to the logarithms of both moduli, every point with the same weight; moduli at vanishing strain are
    /// fitted too, so that f(0) and g(0) are exactly 1.
    ///
    /// # Errors
    /// [`PayneError::Number`], [`PayneError::TooFewPoints`]; [`PayneError::NoFit`] if no start converges.
    pub fn fit(sweep: &StrainSweep) -> Result<KrausFit, PayneError> {
        let temperature_c = sweep.temperature_c;
        let ordered = sweep.ordered()?;
        if ordered.points.len() < FEWEST {
            let (points, needed) = (ordered.points.len(), FEWEST);
            return Err(PayneError::TooFewPoints { temperature_c, points, needed });
        }
        let problem = |own| Problem { points: &ordered.points, own };
        let extended = problem(false);
        let found = extended.best(&ordered).ok_or(PayneError::NoFit { temperature_c })?.parameters;
        let own = problem(true);
        let rms_of_own_law = own.best(&ordered).map(|minimum| own.rms(&minimum.parameters));
        let highest_strain = ordered.points[ordered.points.len() - 1].strain;
        let law = extended.law(&found, highest_strain);
        law.validate(temperature_c).map_err(|_| PayneError::NoFit { temperature_c })?;
        Ok(KrausFit {
            temperature_c,
            law,
            storage_modulus: found[0].exp(),
            loss_modulus: found[1].exp(),
            rms: extended.rms(&found),
            rms_of_own_law,
            left_out: ordered.left_out,
        })
    }
}

/// Parameters: ln E'(0), ln E''(0), logit f_inf, ln ε_c, ln m, ln g_p, and ln g_inf unless the law is Kraus' own.
struct Problem<'a> {
    points: &'a [StrainPoint],
    own: bool,
}

impl Problem<'_> {
    /// The best of the minima from several starts.
    fn best(&self, ordered: &Ordered) -> Option<Minimum> {
        let [storage, loss] = ordered.at_rest;
        let lowest = self.points.iter().map(|p| p.storage_modulus / storage).fold(1.0, f64::min);
        let half = self.points.iter().find(|p| p.storage_modulus < 0.5 * (1.0 + lowest) * storage);
        let critical = half.or(self.points.last())?.strain;
        let limit = (0.7 * lowest).clamp(0.02, 0.95);
        let start = |exponent: f64| {
            let mut start = vec![
                storage.ln(),
                loss.ln(),
                (limit / (1.0 - limit)).ln(),
                critical.ln(),
                exponent.ln(),
                0.3_f64.ln(),
            ];
            if !self.own {
                start.push(limit.ln());
            }
            DVector::from_vec(start)
        };
        let minima = EXPONENTS.iter().filter_map(|exponent| minimise(self, start(*exponent)));
        minima.filter(Minimum::converged).min_by(|a, b| a.rms.total_cmp(&b.rms))
    }

    fn law(&self, parameters: &DVector<f64>, highest_strain: f64) -> Kraus {
        Kraus {
            critical_strain: parameters[3].exp(),
            exponent: parameters[4].exp(),
            storage_limit: 1.0 / (1.0 + (-parameters[2]).exp()),
            loss_limit: if self.own { 1.0 } else { parameters[6].exp() },
            loss_peak: parameters[5].exp(),
            highest_strain,
        }
    }

    fn rms(&self, parameters: &DVector<f64>) -> [f64; 2] {
        let residuals = self.residuals(parameters);
        [0, 1].map(|part| {
            let squares: f64 = residuals.iter().skip(part).step_by(2).map(|r| r * r).sum();
            (squares / self.points.len() as f64).sqrt()
        })
    }
}

impl LeastSquares for Problem<'_> {
    fn residuals(&self, parameters: &DVector<f64>) -> DVector<f64> {
        let law = self.law(parameters, f64::INFINITY);
        let residuals = self.points.iter().flat_map(|point| {
            let [storage, loss] = law.factors(point.strain);
            [
                parameters[0] + storage.ln() - point.storage_modulus.ln(),
                parameters[1] + loss.ln() - point.loss_modulus.ln(),
            ]
        });
        DVector::from_iterator(2 * self.points.len(), residuals)
    }

    fn jacobian(&self, parameters: &DVector<f64>) -> DMatrix<f64> {
        let law = self.law(parameters, f64::INFINITY);
        let mut jacobian = DMatrix::zeros(2 * self.points.len(), parameters.len());
        for (k, point) in self.points.iter().enumerate() {
            let [storage, loss] = law.factors(point.strain);
            let ln_x = (point.strain / law.critical_strain).ln();
            let y = (law.exponent * ln_x).exp();
            let stands = 1.0 / (1.0 + y * y);
            // By ln y: of 1/(1 + y²) and of 2y/(1 + y²).
            let breaks = -2.0 * y * y * stands * stands;
            let changes = 2.0 * y * (1.0 - y * y) * stands * stands;
            let by_y = [
                (1.0 - law.storage_limit) * breaks / storage,
                ((1.0 - law.loss_limit) * breaks + law.loss_peak * changes) / loss,
            ];
            let limit = law.storage_limit * (1.0 - law.storage_limit);
            jacobian[(2 * k, 2)] = (1.0 - stands) * limit / storage;
            jacobian[(2 * k + 1, 5)] = 2.0 * law.loss_peak * y * stands / loss;
            if !self.own {
                jacobian[(2 * k + 1, 6)] = law.loss_limit * (1.0 - stands) / loss;
            }
            for part in [0, 1] {
                jacobian[(2 * k + part, part)] = 1.0;
                jacobian[(2 * k + part, 3)] = -law.exponent * by_y[part];
                jacobian[(2 * k + part, 4)] = law.exponent * ln_x * by_y[part];
            }
        }
        jacobian
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_by_differences() {
        let point = |k: i32| StrainPoint {
            strain: 10_f64.powf(f64::from(k) / 4.0 - 4.0),
            storage_modulus: 5.0,
            loss_modulus: 0.7,
        };
        let points: Vec<StrainPoint> = (0..12).map(point).collect();
        for own in [true, false] {
            let problem = Problem { points: &points, own };
            let mut at = vec![1.6, -0.2, -1.0, -4.6, -0.5, -1.3, -0.9];
            at.truncate(if own { 6 } else { 7 });
            let at = DVector::from_vec(at);
            let jacobian = problem.jacobian(&at);
            for column in 0..at.len() {
                let moved = |step: f64| {
                    let mut moved = at.clone();
                    moved[column] += step;
                    problem.residuals(&moved)
                };
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                let miss = (difference - jacobian.column(column)).amax();
                // Central differences: 1e-10 times third derivatives.
                assert!(miss < 1e-8, "{own} {column} {miss}");
            }
        }
    }
}
