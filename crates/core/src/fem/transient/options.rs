//! Parameters of the transient contact.

use super::error::TransientError;
use super::flow::FlowRule;

/// How a block is pressed in and dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct TransientOptions {
    /// Integration of the flow rule.
    pub flow: FlowRule,
    /// Time `T1` in s of pressing in. By default the longer of one period of sliding `L / v` and
    /// five times the longest relaxation time, after which less than 1 % of any branch's stress
    /// is left: the drag starts from nearly the relaxed contact.
    pub press_time: Option<f64>,
    /// Least number of steps for pressing in.
    pub press_steps: usize,
    /// Length of the drag in periods; the thesis takes twelve.
    pub drag_periods: usize,
    /// Periods at the end of the drag over which results are averaged.
    pub averaged_periods: usize,
    /// Least number of steps for sliding one period. By default the columns of the mesh: it is
    /// the cheapest, because the contact nodes then move on by one a step, but the oscillation is
    /// sampled at one position of the nodes on the profile only. Several steps a column show it.
    pub steps_per_period: Option<usize>,
    /// Largest violation of the contact conditions over the range of the profile's heights (over
    /// the width of an element for a flat profile).
    pub penetration_tolerance: f64,
    /// Penalty ε over the stiffness `|E_r(π v / h)| / h` of an element at the frequency of the
    /// shortest wave.
    pub penalty_factor: f64,
}

impl Default for TransientOptions {
    fn default() -> Self {
        Self {
            flow: FlowRule::default(),
            press_time: None,
            press_steps: 20,
            drag_periods: 12,
            averaged_periods: 4,
            steps_per_period: None,
            penetration_tolerance: 1e-4,
            penalty_factor: 10.0,
        }
    }
}

impl TransientOptions {
    /// Checks that every number is in range.
    ///
    /// # Errors
    /// [`TransientError::OutOfRange`] for the first one that is not.
    pub fn validate(&self) -> Result<(), TransientError> {
        positive("the time of pressing in, in s,", self.press_time.unwrap_or(1.0))?;
        positive("the tolerance of the penetration", self.penetration_tolerance)?;
        positive("the factor of the penalty", self.penalty_factor)?;
        at_least_one("the number of steps for pressing in", self.press_steps)?;
        at_least_one("the number of averaged periods", self.averaged_periods)?;
        at_least_one("the number of steps a period", self.steps_per_period.unwrap_or(1))?;
        if self.drag_periods < self.averaged_periods {
            return Err(TransientError::OutOfRange {
                quantity: "the length of the drag in periods",
                value: self.drag_periods as f64,
                range: "at least the number of averaged periods",
            });
        }
        Ok(())
    }
}

/// Checks that a number is positive and finite.
pub(super) fn positive(quantity: &'static str, value: f64) -> Result<(), TransientError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(TransientError::OutOfRange { quantity, value, range: "positive and finite" })
    }
}

fn at_least_one(quantity: &'static str, value: usize) -> Result<(), TransientError> {
    if value > 0 {
        Ok(())
    } else {
        Err(TransientError::OutOfRange { quantity, value: 0.0, range: "at least 1" })
    }
}
