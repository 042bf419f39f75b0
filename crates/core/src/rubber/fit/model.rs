//! A Prony series against measured moduli: residuals and their derivatives.
//!
//! ```text
//! E'(ω)  = E_inf + sum_i E_i y_i^2 / (1 + y_i^2),   y_i = a ω τ_i
//! E''(ω) =         sum_i E_i y_i   / (1 + y_i^2)
//! r      = ln b E'(ω_j) - ln E'_j,  ln b E''(ω_j) - ln E''_j
//! ```
//!
//! with the shift factor a and the vertical factor b of the temperature, both 1 at the reference.
//! The parameters are `ln E_inf, ln E_i, u_i, ln a_k, ln b_k`, the last two where they are free:
//! moduli cannot become negative, and `ln τ_i = centre + half sin(u_i / half)` keeps a time within
//! its limits (as in MINUIT). Free vertical factors add a residual for each pair of neighbours, see
//! [`FreeVerticals`].

use crate::numerics::least_squares::LeastSquares;
use nalgebra::{DMatrix, DVector};

/// Times nearer to their limit than this, of half the range, are at the limit.
const AT_LIMIT: f64 = 1e-6;

/// One measured point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Datum {
    /// ln of the angular frequency in rad/s.
    pub ln_frequency: f64,
    /// Number of the sweep.
    pub sweep: usize,
    pub ln_storage: f64,
    pub ln_loss: f64,
}

/// All points, the sweep at the reference temperature, and the limits of the relaxation times.
#[derive(Debug, Clone)]
pub(super) struct Prony {
    pub data: Vec<Datum>,
    pub terms: usize,
    pub sweeps: usize,
    pub reference: usize,
    /// ln of the shortest and the longest time in s.
    pub limits: [f64; 2],
    /// ln a of every sweep where shift factors are given; they are fitted otherwise.
    pub given_shifts: Option<Vec<f64>>,
    /// The vertical factors that are fitted; all are 1 otherwise.
    pub verticals: Option<FreeVerticals>,
}

/// Vertical factors that are fitted, and their prior: from one sweep to the
/// next ln b changes by a normal deviate about 0. As a residual with the standard deviation of all
/// others that is
///
/// ```text
/// r = noise (ln b_{k+1} - ln b_k) / step_k
/// ```
#[derive(Debug, Clone)]
pub(super) struct FreeVerticals {
    /// Whether ln b of each sweep is fitted; it is 0 otherwise.
    pub free: Vec<bool>,
    /// Standard deviation of the change of ln b from each sweep to the next.
    pub steps: Vec<f64>,
    /// Standard deviation of the residuals of moduli.
    pub noise: f64,
}

impl FreeVerticals {
    /// The colder sweep of every pair that has a residual, with the factor `noise / step`.
    fn pairs(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let step = |(k, step): (usize, &f64)| {
            (self.free[k] || self.free[k + 1]).then_some((k, self.noise / step))
        };
        self.steps.iter().enumerate().filter_map(step)
    }

    /// Sum of squares of the changes from sweep to sweep, each in standard deviations.
    pub fn improbability(&self, series: &Series) -> f64 {
        let changes = series.ln_verticals.windows(2).zip(&self.steps);
        changes.map(|(ln, step)| ((ln[1] - ln[0]) / step).powi(2)).sum()
    }
}

/// A Prony series in logarithms, with the shift factors of the sweeps.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub ln_equilibrium: f64,
    /// ln of modulus and relaxation time, by descending time.
    pub terms: Vec<[f64; 2]>,
    /// ln a of every sweep.
    pub ln_shifts: Vec<f64>,
    /// ln b of every sweep.
    pub ln_verticals: Vec<f64>,
}

impl Prony {
    fn centre(&self) -> f64 {
        0.5 * (self.limits[0] + self.limits[1])
    }

    fn half(&self) -> f64 {
        0.5 * (self.limits[1] - self.limits[0])
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        let shifts = if self.given_shifts.is_some() { 0 } else { self.sweeps - 1 };
        let free = |verticals: &FreeVerticals| verticals.free.iter().filter(|free| **free).count();
        1 + 2 * self.terms + shifts + self.verticals.as_ref().map_or(0, free)
    }

    /// Number of residuals.
    pub fn rows(&self) -> usize {
        2 * self.data.len() + self.vertical_pairs().count()
    }

    fn vertical_pairs(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.verticals.iter().flat_map(FreeVerticals::pairs)
    }

    pub fn pack(&self, series: &Series) -> DVector<f64> {
        let (centre, half) = (self.centre(), self.half());
        let moduli = series.terms.iter().map(|term| term[0]);
        let angle = |term: &[f64; 2]| half * ((term[1] - centre) / half).clamp(-0.99, 0.99).asin();
        let times = series.terms.iter().map(angle);
        let free = |index: Option<usize>, value: f64| index.map(|_| value);
        let shifts =
            (0..self.sweeps).filter_map(|k| free(self.shift_index(k), series.ln_shifts[k]));
        let verticals =
            (0..self.sweeps).filter_map(|k| free(self.vertical_index(k), series.ln_verticals[k]));
        let all: Vec<f64> = std::iter::once(series.ln_equilibrium)
            .chain(moduli)
            .chain(times)
            .chain(shifts)
            .chain(verticals)
            .collect();
        DVector::from_vec(all)
    }

    pub fn unpack(&self, parameters: &DVector<f64>) -> Series {
        let (n, half) = (self.terms, self.half());
        let ln_time = |i: usize| self.centre() + half * (parameters[1 + n + i] / half).sin();
        let terms = (0..n).map(|i| [parameters[1 + i], ln_time(i)]).collect();
        let free = |index: Option<usize>| index.map_or(0.0, |index| parameters[index]);
        let ln_shifts = match &self.given_shifts {
            Some(given) => given.clone(),
            None => (0..self.sweeps).map(|k| free(self.shift_index(k))).collect(),
        };
        let ln_verticals = (0..self.sweeps).map(|k| free(self.vertical_index(k))).collect();
        Series { ln_equilibrium: parameters[0], terms, ln_shifts, ln_verticals }
    }

    /// Index of the shift of a sweep among the parameters; `None` for the reference and for given shifts.
    pub fn shift_index(&self, sweep: usize) -> Option<usize> {
        let free = self.given_shifts.is_none();
        free.then(|| self.index(1 + 2 * self.terms, sweep)).flatten()
    }

    /// Index of the vertical factor of a sweep among the parameters, if it is free.
    pub fn vertical_index(&self, sweep: usize) -> Option<usize> {
        let shifts = if self.given_shifts.is_some() { 0 } else { self.sweeps - 1 };
        let free = &self.verticals.as_ref()?.free;
        let before = free[..sweep].iter().filter(|free| **free).count();
        free[sweep].then_some(1 + 2 * self.terms + shifts + before)
    }

    fn index(&self, start: usize, sweep: usize) -> Option<usize> {
        match sweep.cmp(&self.reference) {
            std::cmp::Ordering::Less => Some(start + sweep),
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => Some(start + sweep - 1),
        }
    }

    /// Whether a time is at its limit, where it has no derivative.
    pub fn at_limit(&self, ln_time: f64) -> bool {
        (ln_time - self.centre()).abs() > (1.0 - AT_LIMIT) * self.half()
    }

    /// The parameters that the data may determine: all but the times at their limits.
    pub fn free_columns(&self, series: &Series) -> Vec<usize> {
        let limited = |column: usize| {
            let term = column.checked_sub(1 + self.terms).and_then(|i| series.terms.get(i));
            term.is_some_and(|term| self.at_limit(term[1]))
        };
        (0..self.parameters()).filter(|column| !limited(*column)).collect()
    }

    /// Derivatives of the residuals by `ln E_inf, ln E_i, ln τ_i, ln a_k, ln b_k`.
    pub fn logarithmic_jacobian(&self, series: &Series) -> DMatrix<f64> {
        let n = self.terms;
        let mut jacobian = DMatrix::zeros(self.rows(), self.parameters());
        for (j, datum) in self.data.iter().enumerate() {
            // Without the vertical factor, which the quotients below do not contain.
            let [storage, loss] = series.moduli_at_reference(datum);
            let (row, next) = (2 * j, 2 * j + 1);
            if let Some(column) = self.vertical_index(datum.sweep) {
                jacobian[(row, column)] = 1.0;
                jacobian[(next, column)] = 1.0;
            }
            jacobian[(row, 0)] = series.ln_equilibrium.exp() / storage;
            for (i, term) in series.terms.iter().enumerate() {
                let [s, l] = weights(series.ln_reduced_frequency(datum) + term[1]);
                let modulus = term[0].exp();
                jacobian[(row, 1 + i)] = modulus * s / storage;
                jacobian[(next, 1 + i)] = modulus * l / loss;
                // d s / d ln y = 2 l^2, d l / d ln y = l (1 - 2 s).
                let by_time =
                    [modulus * 2.0 * l * l / storage, modulus * l * (1.0 - 2.0 * s) / loss];
                for (row, value) in [row, next].into_iter().zip(by_time) {
                    jacobian[(row, 1 + n + i)] = value;
                    if let Some(column) = self.shift_index(datum.sweep) {
                        jacobian[(row, column)] += value;
                    }
                }
            }
        }
        for (row, (k, factor)) in self.vertical_pairs().enumerate() {
            for (sweep, sign) in [(k, -1.0), (k + 1, 1.0)] {
                if let Some(column) = self.vertical_index(sweep) {
                    jacobian[(2 * self.data.len() + row, column)] = sign * factor;
                }
            }
        }
        jacobian
    }
}

impl LeastSquares for Prony {
    fn residuals(&self, parameters: &DVector<f64>) -> DVector<f64> {
        self.residuals_of(&self.unpack(parameters))
    }

    fn jacobian(&self, parameters: &DVector<f64>) -> DMatrix<f64> {
        let mut jacobian = self.logarithmic_jacobian(&self.unpack(parameters));
        for i in 0..self.terms {
            let column = 1 + self.terms + i;
            jacobian.column_mut(column).scale_mut((parameters[column] / self.half()).cos());
        }
        jacobian
    }
}

impl Prony {
    pub fn residuals_of(&self, series: &Series) -> DVector<f64> {
        let residuals = self.data.iter().flat_map(|datum| {
            let [storage, loss] = series.moduli(datum);
            [storage.ln() - datum.ln_storage, loss.ln() - datum.ln_loss]
        });
        let ln = &series.ln_verticals;
        let priors = self.vertical_pairs().map(|(k, factor)| factor * (ln[k + 1] - ln[k]));
        DVector::from_iterator(self.rows(), residuals.chain(priors))
    }
}

impl Series {
    /// ln of the reduced angular frequency of a point.
    pub fn ln_reduced_frequency(&self, datum: &Datum) -> f64 {
        datum.ln_frequency + self.ln_shifts[datum.sweep]
    }

    /// Storage and loss modulus in Pa at the frequency and temperature of a point.
    pub fn moduli(&self, datum: &Datum) -> [f64; 2] {
        let vertical = self.ln_verticals[datum.sweep].exp();
        self.moduli_at_reference(datum).map(|modulus| vertical * modulus)
    }

    /// The same without the vertical factor.
    fn moduli_at_reference(&self, datum: &Datum) -> [f64; 2] {
        let ln_frequency = self.ln_reduced_frequency(datum);
        let start = [self.ln_equilibrium.exp(), 0.0];
        self.terms.iter().fold(start, |[storage, loss], term| {
            let [s, l] = weights(ln_frequency + term[1]);
            let modulus = term[0].exp();
            [storage + modulus * s, loss + modulus * l]
        })
    }
}

/// `y^2 / (1 + y^2)` and `y / (1 + y^2)` of ln y.
pub(super) fn weights(ln_y: f64) -> [f64; 2] {
    let (y, inverse) = (ln_y.exp(), (-ln_y).exp());
    [y / (y + inverse), 1.0 / (y + inverse)]
}
