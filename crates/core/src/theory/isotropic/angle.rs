//! Means of the moduli over the angle between a wave and the direction of sliding.

use crate::rubber::{FrequencyRange, Viscoelastic};
use std::f64::consts::{FRAC_2_PI, TAU};

/// Means over all directions of the waves of one wavenumber, of which those at the angle φ to the sliding have the
/// frequency `ω cos φ`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct AngularMeans {
    /// `<|E_r|²>` in Pa².
    pub square: f64,
    /// `<cos φ Im E_r>` in Pa.
    pub loss: f64,
    /// The part of `square` at frequencies at which the rubber was not measured.
    pub unmeasured_square: f64,
    /// The part of `loss` at frequencies at which the rubber was not measured.
    pub unmeasured_loss: f64,
}

/// Where what is left of the weights, `4/π exp(-t)`, is below 1e-13.
const LAST: f64 = 31.0;

impl AngularMeans {
    /// The means at an angular frequency `ω` in rad/s of the waves along the sliding, by the trapezoidal rule with the step
    /// `step` in `t`, where `cos φ = 1 / cosh t`.
    ///
    /// `ln ω` falls nearly linearly with `t`, so that a relaxation at any frequency is smooth in it: the rule converges as
    /// `exp(-π² / step)` with a Maxwell model, whose poles in `ln ω` are `π/2` away from the real axis.
    pub(super) fn of(rubber: &dyn Viscoelastic, angular_frequency: f64, step: f64) -> Self {
        let measured = rubber.measured();
        let mut means = Self::default();
        for k in 0..=(LAST / step) as usize {
            let cosine = 1.0 / (k as f64 * step).cosh();
            // dφ = dt / cosh t; the point at t = 0 belongs to both halves of the axis.
            let weight = FRAC_2_PI * step * cosine * if k == 0 { 0.5 } else { 1.0 };
            let frequency = angular_frequency * cosine;
            let modulus = rubber.reduced_modulus(frequency);
            let (square, loss) = (weight * modulus.norm_sqr(), weight * cosine * modulus.im);
            means.square += square;
            means.loss += loss;
            if is_outside(measured, frequency) {
                means.unmeasured_square += square;
                means.unmeasured_loss += loss;
            }
        }
        means
    }

    /// Means of moduli that are all multiplied by a factor.
    pub(super) fn scaled(self, factor: f64) -> Self {
        let square = factor * factor;
        Self {
            square: square * self.square,
            loss: factor * self.loss,
            unmeasured_square: square * self.unmeasured_square,
            unmeasured_loss: factor * self.unmeasured_loss,
        }
    }
}

fn is_outside(measured: Option<FrequencyRange>, angular_frequency: f64) -> bool {
    let frequency_hz = angular_frequency / TAU;
    let at = FrequencyRange { lowest_hz: frequency_hz, highest_hz: frequency_hz };
    measured.is_some_and(|range| range.first_outside(at).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};

    /// One Maxwell branch has both means in closed form.
    #[test]
    fn one_branch_is_exact_at_all_frequencies() {
        let (spring, branch, time) = (3e6, 4e8, 2e-5);
        let rubber = Rubber {
            name: "one branch".into(),
            equilibrium_modulus: spring,
            branches: vec![MaxwellBranch { modulus: branch, relaxation_time: time }],
            poisson_ratio: 0.0,
            finite_strain: Default::default(),
        };
        for decade in -8..=12 {
            let x = 10_f64.powi(decade);
            let means = AngularMeans::of(&rubber, x / time, 0.25);
            // The mean of x² cos² / (1 + x² cos²), without cancellation.
            let root = (1.0 + x * x).sqrt();
            let share = x * x / (root * (root + 1.0));
            let square = spring * spring + (2.0 * spring * branch + branch * branch) * share;
            approx::assert_relative_eq!(means.square, square, max_relative = 1e-13);
            approx::assert_relative_eq!(means.loss, branch * share / x, max_relative = 1e-13);
            assert_eq!((means.unmeasured_square, means.unmeasured_loss), (0.0, 0.0));
        }
    }

    #[test]
    fn the_error_falls_as_stated_with_the_step() {
        let rubber = Rubber::elastic(3e6, 0.5);
        let exact = (3e6_f64 / 0.75).powi(2);
        for step in [1.0_f64, 0.7, 0.5] {
            let error = AngularMeans::of(&rubber, 1.0, step).square / exact - 1.0;
            // 2 / cosh(π²/step), by Poisson's sum.
            let expected = 4.0 * (-std::f64::consts::PI.powi(2) / step).exp();
            approx::assert_relative_eq!(error, expected, max_relative = 1e-3);
        }
    }
}
