//! WLF and Arrhenius through shift factors, by least squares on `log10 a_T`.

use super::{FittedLaw, FittedVertical, ShiftFactor};
use crate::numerics::least_squares::{LeastSquares, minimise};
use crate::numerics::statistics::student_t_975;
use crate::rubber::{ShiftLaw, VerticalShift};
use nalgebra::{DMatrix, DVector};

/// Beyond this c2 in K the WLF equation is a straight line over any measured range: the data do not
/// determine it.
const LARGEST_C2_K: f64 = 1e5;

/// Both laws through the factors that are certain, the better one first; without Arrhenius where
/// none has a positive energy, without WLF for fewer than three factors or where they do not
/// determine it.
///
/// The better one has the smaller residual variance, sum of squares over degrees of freedom. All temperatures have the
/// same weight: deviations come from the laws being approximations rather than from noise.
pub(super) fn fit_laws(shifts: &[ShiftFactor], reference_c: f64) -> Vec<FittedLaw> {
    let others: Vec<ShiftFactor> = shifts
        .iter()
        .filter(|shift| shift.temperature_c != reference_c && !shift.uncertain)
        .copied()
        .collect();
    let mut laws: Vec<FittedLaw> = [arrhenius(&others, reference_c), wlf(&others, reference_c)]
        .into_iter()
        .flatten()
        .collect();
    laws.sort_by(|a, b| a.residual_decades.total_cmp(&b.residual_decades));
    laws
}

/// `log10 a = E_a x` with x for 1 kJ/mol: a line through the reference.
fn arrhenius(shifts: &[ShiftFactor], reference_c: f64) -> Option<FittedLaw> {
    let unit = ShiftLaw::Arrhenius { activation_energy_kj_mol: 1.0 };
    let x: Vec<f64> =
        shifts.iter().map(|shift| unit.log10_shift(shift.temperature_c, reference_c)).collect();
    let squares: f64 = x.iter().map(|x| x * x).sum();
    let energy =
        shifts.iter().zip(&x).map(|(shift, x)| shift.log10_shift * x).sum::<f64>() / squares;
    if !(energy > 0.0 && energy.is_finite()) {
        return None;
    }
    let misses: f64 =
        shifts.iter().zip(&x).map(|(shift, x)| (shift.log10_shift - energy * x).powi(2)).sum();
    let law = ShiftLaw::Arrhenius { activation_energy_kj_mol: energy };
    if shifts.len() == 1 {
        return Some(FittedLaw { law, confidence_95: None, residual_decades: 0.0 });
    }
    let freedom = shifts.len() as f64 - 1.0;
    let residual_decades = (misses / freedom).sqrt();
    let half_width = student_t_975(freedom) * residual_decades / squares.sqrt();
    Some(FittedLaw { law, confidence_95: Some(vec![half_width]), residual_decades })
}

/// `ln b = m ln(T / T_r)` through fitted vertical factors, given as temperature in °C and ln b with
/// their covariance: a line through the reference by generalised least squares, since neighbours
/// share most of their error. The interval is wider by the root of the mean square misfit, in
/// standard deviations, where that is above 1, and by the largest difference of alternatives.
pub(super) fn fit_vertical(
    factors: &[(f64, f64)],
    alternatives: &[Vec<(f64, f64)>],
    covariance: &DMatrix<f64>,
    reference_c: f64,
) -> Option<FittedVertical> {
    let unit = VerticalShift::Power { exponent: 1.0 };
    let x = DVector::from_iterator(
        factors.len(),
        factors.iter().map(|(temperature_c, _)| unit.ln_factor(*temperature_c, reference_c)),
    );
    let ln = |factors: &[(f64, f64)]| {
        DVector::from_iterator(factors.len(), factors.iter().map(|(_, ln)| *ln))
    };
    let scale = covariance.diagonal().max();
    let inverse = (covariance / scale).try_inverse()?;
    let weight = x.dot(&(&inverse * &x));
    let through = |ln: &DVector<f64>| x.dot(&(&inverse * ln)) / weight;
    let exponent = through(&ln(factors));
    let others = alternatives.iter().map(|other| (through(&ln(other)) - exponent).abs());
    let spread = others.fold(0.0, f64::max);
    let misses = ln(factors) - &x * exponent;
    if !exponent.is_finite() {
        return None;
    }
    let freedom = factors.len() as f64 - 1.0;
    let confidence = || {
        let squares = misses.dot(&(&inverse * &misses)) / scale / freedom;
        (student_t_975(freedom) * (scale / weight * squares.max(1.0)).sqrt()).hypot(spread)
    };
    Some(FittedVertical {
        law: VerticalShift::Power { exponent },
        confidence_95: (freedom > 0.0).then(confidence),
        residual: (freedom > 0.0).then(|| (misses.norm_squared() / freedom).sqrt()),
    })
}

/// The parameters are `ln c1` and `ln (c2 + T_min - T_r)`: the pole stays below all temperatures.
struct Wlf<'a> {
    shifts: &'a [ShiftFactor],
    reference_c: f64,
    lowest_difference: f64,
}

impl Wlf<'_> {
    fn coefficients(&self, parameters: &DVector<f64>) -> [f64; 2] {
        [parameters[0].exp(), parameters[1].exp() - self.lowest_difference]
    }

    /// Derivatives of `log10 a` by c1 and c2.
    fn derivatives(&self, [c1, c2]: [f64; 2]) -> DMatrix<f64> {
        DMatrix::from_fn(self.shifts.len(), 2, |k, column| {
            let difference = self.shifts[k].temperature_c - self.reference_c;
            match column {
                0 => -difference / (c2 + difference),
                _ => c1 * difference / (c2 + difference).powi(2),
            }
        })
    }
}

impl LeastSquares for Wlf<'_> {
    fn residuals(&self, parameters: &DVector<f64>) -> DVector<f64> {
        let [c1, c2_k] = self.coefficients(parameters);
        let law = ShiftLaw::Wlf { c1, c2_k };
        let residuals = self.shifts.iter().map(|shift| {
            law.log10_shift(shift.temperature_c, self.reference_c) - shift.log10_shift
        });
        DVector::from_iterator(self.shifts.len(), residuals)
    }

    fn jacobian(&self, parameters: &DVector<f64>) -> DMatrix<f64> {
        let derivatives = self.derivatives(self.coefficients(parameters));
        derivatives * DMatrix::from_diagonal(&parameters.map(f64::exp))
    }
}

fn wlf(shifts: &[ShiftFactor], reference_c: f64) -> Option<FittedLaw> {
    if shifts.len() < 3 {
        return None;
    }
    let differences = shifts.iter().map(|shift| shift.temperature_c - reference_c);
    let lowest_difference = differences.fold(0.0, f64::min);
    let problem = Wlf { shifts, reference_c, lowest_difference };
    // The constants that Williams, Landel & Ferry found to suit many polymers.
    let start = DVector::from_vec(vec![8.86_f64.ln(), 101.6_f64.ln()]);
    let minimum =
        minimise(&problem, start).filter(crate::numerics::least_squares::Minimum::converged)?;
    let coefficients = problem.coefficients(&minimum.parameters);
    let [c1, c2_k] = coefficients;
    if !(c2_k > 0.0 && c2_k < LARGEST_C2_K) {
        return None;
    }
    let freedom = shifts.len() as f64 - 2.0;
    let misses = problem.residuals(&minimum.parameters).norm_squared();
    let residual_decades = (misses / freedom).sqrt();
    let jacobian = problem.derivatives(coefficients);
    let covariance = jacobian.tr_mul(&jacobian).try_inverse()?;
    let spread = student_t_975(freedom) * residual_decades;
    let half_widths = (0..2).map(|k| spread * covariance[(k, k)].sqrt()).collect();
    let law = ShiftLaw::Wlf { c1, c2_k };
    Some(FittedLaw { law, confidence_95: Some(half_widths), residual_decades })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factors(law: &ShiftLaw, temperatures: &[f64]) -> Vec<ShiftFactor> {
        let factor = |&temperature_c: &f64| ShiftFactor {
            temperature_c,
            log10_shift: law.log10_shift(temperature_c, 20.0),
            confidence_95: None,
            uncertain: false,
            vertical: None,
        };
        temperatures.iter().map(factor).collect()
    }

    #[test]
    fn exact_factors_give_their_law() {
        let temperatures = [-40.0, -20.0, 0.0, 20.0, 40.0, 60.0];
        for (c1, c2_k) in [(8.86, 101.6), (17.44, 70.0), (3.0, 250.0)] {
            let laws = fit_laws(&factors(&ShiftLaw::Wlf { c1, c2_k }, &temperatures), 20.0);
            let ShiftLaw::Wlf { c1: found1, c2_k: found2 } = laws[0].law else {
                panic!("{:?}", laws[0])
            };
            approx::assert_relative_eq!(found1, c1, max_relative = 1e-8);
            approx::assert_relative_eq!(found2, c2_k, max_relative = 1e-8);
            assert!(laws[1].residual_decades > 0.01, "{:?}", laws[1]);
        }
        let law = ShiftLaw::Arrhenius { activation_energy_kj_mol: 120.0 };
        let laws = fit_laws(&factors(&law, &temperatures), 20.0);
        let ShiftLaw::Arrhenius { activation_energy_kj_mol } = laws[0].law else {
            panic!("{:?}", laws[0])
        };
        approx::assert_relative_eq!(activation_energy_kj_mol, 120.0, max_relative = 1e-12);
    }

    #[test]
    fn vertical_factors_weigh_by_their_covariance() {
        let power = VerticalShift::Power { exponent: 1.5 };
        let factor = |celsius: f64| (celsius, power.ln_factor(celsius, 20.0));
        let mut factors: Vec<_> = [-20.0, 0.0, 40.0, 60.0].map(factor).to_vec();
        let mut covariance = DMatrix::identity(4, 4) * 1e-4;
        let exponent = |factors: &[(f64, f64)], covariance: &DMatrix<f64>| {
            let fitted = fit_vertical(factors, &[], covariance, 20.0).unwrap();
            let VerticalShift::Power { exponent } = fitted.law else { panic!("{fitted:?}") };
            exponent
        };
        approx::assert_relative_eq!(exponent(&factors, &covariance), 1.5, max_relative = 1e-12);
        // One factor with a large error and a wide interval has little effect.
        factors[3].1 += 1.0;
        assert!((exponent(&factors, &covariance) - 1.5).abs() > 1.0);
        covariance[(3, 3)] = 1e4;
        assert!((exponent(&factors, &covariance) - 1.5).abs() < 1e-3);
    }

    #[test]
    fn few_factors_give_arrhenius_alone() {
        let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
        let laws = fit_laws(&factors(&law, &[0.0, 20.0, 40.0]), 20.0);
        assert_eq!(laws.len(), 1);
        assert!(laws[0].confidence_95.is_some());
        let laws = fit_laws(&factors(&law, &[20.0, 40.0]), 20.0);
        assert_eq!((laws.len(), &laws[0].confidence_95), (1, &None));
        assert!(fit_laws(&factors(&law, &[20.0]), 20.0).is_empty());
    }
}
