//! Hard sliders: cylinders and triangles that press a line into the rubber.

use crate::error_kind::{ErrorKind, HasKind};
use std::f64::consts::SQRT_2;

/// Section of a hard slider, symmetric about its lowest line. Heights are those of a road: the rubber comes from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slider {
    /// A parabola `-x² / (2 R)`: a cylinder as Hertz' theory has it, for contacts much narrower than R. From the depth R on,
    /// which no contact reaches, it goes on straight.
    Cylinder {
        /// R in m.
        radius: f64,
    },
    /// Two flanks of the slope ± m: the slope times the width is small in the linear theory, m = tan(angle).
    Triangle {
        /// m, height over length.
        slope: f64,
        /// Radius in m of the parabola that rounds the tip and meets the flanks with their slope; 0 for a sharp tip.
        tip_radius: f64,
    },
}

/// A number that no slider has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{quantity} is {value}, it must be {range}")]
pub struct SliderError {
    /// Which, with its unit.
    pub quantity: &'static str,
    /// Its value in that unit.
    pub value: f64,
    /// What it must be.
    pub range: &'static str,
}

impl HasKind for SliderError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl Slider {
    /// Checks its numbers.
    ///
    /// # Errors
    /// [`SliderError`] with the first number that no slider has.
    pub fn validate(&self) -> Result<(), SliderError> {
        match *self {
            Self::Cylinder { radius } => positive("the radius in m", radius),
            Self::Triangle { slope, tip_radius } => {
                positive("the slope", slope)?;
                if tip_radius >= 0.0 && tip_radius.is_finite() {
                    return Ok(());
                }
                let (quantity, range) = ("the tip radius in m", "0 or positive, and finite");
                Err(SliderError { quantity, value: tip_radius, range })
            }
        }
    }

    /// Height in m at the distance `x` in m from its highest line, which has the height 0.
    pub fn height(&self, x: f64) -> f64 {
        match *self {
            Self::Cylinder { radius } if x * x < 2.0 * radius * radius => -x * x / (2.0 * radius),
            Self::Cylinder { radius } => radius - SQRT_2 * x.abs(),
            Self::Triangle { slope, tip_radius } => {
                let from_tip = x.abs() - slope * tip_radius;
                if from_tip < 0.0 {
                    -x * x / (2.0 * tip_radius)
                } else {
                    -slope * (from_tip + 0.5 * slope * tip_radius)
                }
            }
        }
    }

    /// One period of equal sliders: heights in m at `points` equidistant points of the `period` in m, the tip at the
    /// point `points / 2`.
    ///
    /// The contact is that of one slider where the period is long beside the contact and beside the way that the
    /// rubber slides while it recovers.
    pub fn sample(&self, period: f64, points: usize) -> Vec<f64> {
        let spacing = period / points as f64;
        let tip = points / 2;
        (0..points).map(|i| self.height(spacing * (i as f64 - tip as f64))).collect()
    }
}

/// # Errors
/// [`SliderError`] for a number that is not positive.
fn positive(quantity: &'static str, value: f64) -> Result<(), SliderError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(SliderError { quantity, value, range: "positive and finite" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_tip_meets_its_flanks_with_height_and_slope() {
        let (slope, tip_radius) = (0.3, 2e-4);
        let slider = Slider::Triangle { slope, tip_radius };
        let edge = slope * tip_radius;
        let step = 1e-9;
        let height = |x: f64| slider.height(x);
        // Both sides of the joint differ by the curvature alone: step² / R.
        approx::assert_abs_diff_eq!(
            height(edge + step) - height(edge),
            height(edge) - height(edge - step),
            epsilon = 2.0 * step * step / tip_radius
        );
        approx::assert_relative_eq!(height(1.0) - height(2.0), slope, max_relative = 1e-12);
        assert_eq!(height(-edge), height(edge));
    }

    #[test]
    fn a_sharp_tip_is_a_corner_and_the_largest_height_is_in_the_middle() {
        let sharp = Slider::Triangle { slope: 0.5, tip_radius: 0.0 };
        assert_eq!((sharp.height(0.0), sharp.height(-2.0)), (0.0, -1.0));
        let cylinder = Slider::Cylinder { radius: 0.01 };
        approx::assert_relative_eq!(cylinder.height(2e-3), -2e-4, max_relative = 1e-15);
        let joint = 0.01 * SQRT_2;
        approx::assert_relative_eq!(cylinder.height(joint * 1.0001), -0.01, max_relative = 3e-4);
        approx::assert_relative_eq!(
            cylinder.height(0.1) - cylinder.height(0.2),
            0.1 * SQRT_2,
            max_relative = 1e-12
        );
        for points in [8, 9] {
            let heights = Slider::Cylinder { radius: 0.01 }.sample(1e-3, points);
            assert_eq!(heights[points / 2], 0.0);
            assert!(heights.iter().enumerate().all(|(i, z)| i == points / 2 || *z < 0.0));
        }
    }

    #[test]
    fn numbers_that_no_slider_has_are_refused() {
        let message = |slider: Slider| slider.validate().unwrap_err().to_string();
        let flat = Slider::Cylinder { radius: f64::INFINITY };
        assert_eq!(message(flat), "the radius in m is inf, it must be positive and finite");
        let plane = Slider::Triangle { slope: 0.0, tip_radius: 0.0 };
        assert_eq!(message(plane), "the slope is 0, it must be positive and finite");
        let hollow = Slider::Triangle { slope: 0.1, tip_radius: -1.0 };
        assert_eq!(
            message(hollow),
            "the tip radius in m is -1, it must be 0 or positive, and finite"
        );
    }
}
