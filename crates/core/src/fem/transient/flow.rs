//! The flow rule of the branches over one time step.

use crate::rubber::finite_strain::Symmetric;

/// How `dm_i/dt = (m - m_i) / τ` is integrated over a step, with m the strain in the measure of
/// the law and `m_i` the internal tensor of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FlowRule {
    /// The trapezoidal rule (thesis 2.2.25), of second order:
    /// `m_i' = ((2 τ - Δt) m_i + Δt (m + m')) / (2 τ + Δt)`. For `Δt` well above `τ` it rings:
    /// a deviation changes sign at every step and hardly decays.
    #[default]
    Trapezoidal,
    /// Exact for a strain that is linear over the step, of second order, without ringing for any
    /// `Δt / τ`.
    Exponential,
}

/// Weights of one branch in one step: `m_i' = old_internal m_i + old_strain m + strain m'`. They
/// add up to one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowStep {
    old_internal: f64,
    old_strain: f64,
    /// Weight of the new strain: the fraction by which the internal tensor relaxes to it within the step.
    pub strain: f64,
}

impl FlowRule {
    /// The weights for a step and a relaxation time, both in s and positive.
    pub fn step(self, time_step: f64, relaxation_time: f64) -> FlowStep {
        match self {
            Self::Trapezoidal => {
                let both = 2.0 * relaxation_time + time_step;
                let strain = time_step / both;
                let old_internal = (2.0 * relaxation_time - time_step) / both;
                FlowStep { old_internal, old_strain: strain, strain }
            }
            Self::Exponential => {
                let alpha = time_step / relaxation_time;
                let mean_decay = -(-alpha).exp_m1() / alpha;
                // 1 - (1 - e^{-α}) / α cancels for small α.
                let strain = if alpha < 1e-3 {
                    alpha / 2.0 - alpha * alpha / 6.0 + alpha.powi(3) / 24.0
                } else {
                    1.0 - mean_decay
                };
                let old_internal = (-alpha).exp();
                FlowStep { old_internal, old_strain: 1.0 - strain - old_internal, strain }
            }
        }
    }
}

impl FlowStep {
    /// The part of the new internal tensor that the old state determines.
    #[inline]
    pub fn history(&self, internal: &Symmetric, strain: &Symmetric) -> Symmetric {
        [0, 1, 2].map(|i| self.old_internal * internal[i] + self.old_strain * strain[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Internal value at the time 1 under the strain `t` from rest, relaxation time 0.5.
    fn ramp(rule: FlowRule, steps: u32) -> f64 {
        let dt = 1.0 / f64::from(steps);
        let step = rule.step(dt, 0.5);
        (0..steps).map(f64::from).fold(0.0, |internal, n| {
            step.history(&[internal; 3], &[n * dt; 3])[0] + step.strain * (n + 1.0) * dt
        })
    }

    #[test]
    fn a_ramp_is_exact_or_of_second_order() {
        let exact = 1.0 - 0.5 * (1.0 - (-2.0_f64).exp());
        assert_relative_eq!(ramp(FlowRule::Exponential, 3), exact, max_relative = 1e-14);
        let error = |steps| (ramp(FlowRule::Trapezoidal, steps) - exact).abs();
        // Halving the step quarters the error up to its next order.
        assert_relative_eq!(error(40) / error(80), 4.0, max_relative = 0.01);
    }

    #[test]
    fn a_strain_at_rest_is_kept() {
        for rule in [FlowRule::Trapezoidal, FlowRule::Exponential] {
            for ratio in [1e-9, 9.9e-4, 1.01e-3, 1.0, 1e9] {
                let step = rule.step(ratio, 1.0);
                let kept = step.history(&[1.0; 3], &[1.0; 3])[0] + step.strain;
                assert_relative_eq!(kept, 1.0, max_relative = 1e-14);
            }
        }
    }

    #[test]
    fn only_the_trapezoidal_rule_rings() {
        let after = |rule: FlowRule| rule.step(1.0, 1e-3).history(&[1.0; 3], &[0.0; 3])[0];
        assert!(after(FlowRule::Trapezoidal) < -0.99);
        assert!((0.0..1e-9).contains(&after(FlowRule::Exponential)));
    }
}
