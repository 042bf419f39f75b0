//! The film that is left under a smooth block.

use crate::error_kind::{ErrorKind, HasKind};

/// Shape of a block or of a tread element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Footprint {
    /// A long strip of this width in m, from which water leaves to both sides.
    Strip {
        /// In m.
        width: f64,
    },
    /// A disc of this radius in m.
    Disc {
        /// In m.
        radius: f64,
    },
}

/// Squeeze-out of a viscous film between a smooth rigid plane and a smooth block that keeps its shape, under constant
/// pressure (Stefan 1874; Reynolds' equation, Hamrock, Schmid & Jacobson, Fundamentals of Fluid Film Lubrication, 2004,
/// section 10):
///
/// ```text
/// strip of width w    1/h² = 1/h_0² + 2 p t / (η w²)
/// disc of radius R    1/h² = 1/h_0² + 4 p t / (3 η R²)
/// ```
///
/// Where the film is thinner than the roughness, tips touch through it; dry friction needs that the film is thinner than
/// the valleys of the waves in question. A rubber that bends keeps more water in its middle than this says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SqueezeOut {
    /// Shape.
    pub footprint: Footprint,
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Viscosity in Pa s; water of 20 °C has 1.002e-3.
    pub viscosity: f64,
}

/// A number that no squeeze-out has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{quantity} is {value}, it must be positive and finite")]
pub struct SqueezeError {
    /// Which, with its unit.
    pub quantity: &'static str,
    /// Its value in that unit.
    pub value: f64,
}

impl HasKind for SqueezeError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl SqueezeOut {
    /// Thickness in m after a time in s of a film that was `start` m thick; infinite thickness is allowed.
    ///
    /// # Errors
    /// [`SqueezeError`] for a number that is not positive.
    pub fn thickness(&self, start: f64, time: f64) -> Result<f64, SqueezeError> {
        let rate = self.rate()?;
        check("the time in s", time)?;
        if start.is_nan() || start <= 0.0 {
            return Err(SqueezeError { quantity: "the first thickness in m", value: start });
        }
        // In units of the start, so that a film of any thickness keeps its digits.
        let drained = rate * time;
        Ok(if start.is_infinite() {
            drained.sqrt().recip()
        } else {
            start / (1.0 + drained * start * start).sqrt()
        })
    }

    /// Time in s until a film of any first thickness is `thickness` m thin.
    ///
    /// # Errors
    /// As [`Self::thickness`].
    pub fn time_to(&self, thickness: f64) -> Result<f64, SqueezeError> {
        let rate = self.rate()?;
        check("the thickness in m", thickness)?;
        Ok(1.0 / (rate * thickness * thickness))
    }

    /// `d(1/h²)/dt` in 1/(m² s).
    fn rate(&self) -> Result<f64, SqueezeError> {
        check("the pressure in Pa", self.pressure)?;
        check("the viscosity in Pa s", self.viscosity)?;
        let ratio = self.pressure / self.viscosity;
        Ok(match self.footprint {
            Footprint::Strip { width } => {
                check("the width in m", width)?;
                2.0 * ratio / (width * width)
            }
            Footprint::Disc { radius } => {
                check("the radius in m", radius)?;
                4.0 * ratio / (3.0 * radius * radius)
            }
        })
    }
}

fn check(quantity: &'static str, value: f64) -> Result<(), SqueezeError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SqueezeError { quantity, value }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip() -> SqueezeOut {
        SqueezeOut { footprint: Footprint::Strip { width: 0.01 }, pressure: 3e5, viscosity: 1e-3 }
    }

    /// 10 mm, 0.3 MPa, water, 5 ms: the value of `../shared/design/extensions.md`, section 5.
    #[test]
    fn a_tread_block_leaves_micrometres_in_milliseconds() {
        let left = strip().thickness(f64::INFINITY, 5e-3).unwrap();
        approx::assert_relative_eq!(left, 5.8e-6, max_relative = 0.01);
        approx::assert_relative_eq!(strip().time_to(left).unwrap(), 5e-3, max_relative = 1e-14);
        let from_one_mm = strip().thickness(1e-3, 5e-3).unwrap();
        assert!(from_one_mm < left && from_one_mm > 0.9999 * left);
    }

    /// The closed form solves Reynolds' equation dh/dt = -h³ p / (η w²): steps of Runge and Kutta beside it.
    #[test]
    fn the_film_obeys_the_equation_of_reynolds() {
        for footprint in [Footprint::Strip { width: 0.01 }, Footprint::Disc { radius: 0.004 }] {
            let film = SqueezeOut { footprint, ..strip() };
            let rate = match footprint {
                Footprint::Strip { width } => film.pressure / (film.viscosity * width * width),
                Footprint::Disc { radius } => {
                    2.0 * film.pressure / (3.0 * film.viscosity * radius * radius)
                }
            };
            let slope = |h: f64| -rate * h.powi(3);
            let (mut h, steps, time) = (2e-5, 2000, 1e-3);
            let dt = time / f64::from(steps);
            for _ in 0..steps {
                let a = slope(h);
                let b = slope(h + 0.5 * dt * a);
                let c = slope(h + 0.5 * dt * b);
                let d = slope(h + dt * c);
                h += dt / 6.0 * (a + 2.0 * b + 2.0 * c + d);
            }
            approx::assert_relative_eq!(
                film.thickness(2e-5, time).unwrap(),
                h,
                max_relative = 1e-9
            );
        }
    }

    #[test]
    fn numbers_that_no_film_has_are_refused() {
        let error = SqueezeOut { viscosity: 0.0, ..strip() }.time_to(1e-6).unwrap_err();
        assert_eq!(error.to_string(), "the viscosity in Pa s is 0, it must be positive and finite");
        assert!(
            strip().thickness(f64::NAN, 1.0).is_err() && strip().thickness(1e-3, -1.0).is_err()
        );
    }
}
