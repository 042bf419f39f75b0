//! What a contact with effective moduli is made of.

use super::{EffectiveError, StrainLaw, TemperatureLaw};
use crate::contact::ContactError;
use crate::heat::ThermalSetting;
use crate::numerics::Interrupt;
use crate::rubber::{Viscoelastic, ZERO_CELSIUS};

/// Heat of the contact, and how the rubber responds to it.
#[derive(Clone, Copy)]
pub struct HeatFeedback<'a> {
    /// Thermal constants, time of sliding, shear stress in contact, road.
    pub thermal: ThermalSetting,
    /// How the moduli depend on temperature.
    pub law: &'a dyn TemperatureLaw,
    /// Temperature before sliding in °C, at which the moduli of the rubber are given.
    pub temperature_c: f64,
}

/// A rubber that slides over a line, and what changes its moduli.
#[derive(Clone, Copy)]
pub struct FeedbackSetup<'a> {
    /// The rubber at its temperature before sliding and at small strain.
    pub rubber: &'a dyn Viscoelastic,
    /// Sliding speed in m/s.
    pub speed: f64,
    /// Period in m.
    pub period: f64,
    /// Heights in m on equidistant points of the period.
    pub heights: &'a [f64],
    /// Heat, if it is to change the moduli.
    pub heat: Option<HeatFeedback<'a>>,
    /// Strain, if it is to change the moduli.
    pub strain: Option<&'a dyn StrainLaw>,
    /// Largest change in the last step of the logarithm of a shift factor, of a factor of the moduli, of friction and of contact
    /// area (both relative).
    pub tolerance: f64,
    /// Most contacts solved.
    pub most_steps: usize,
    /// Ends a solve between two Krylov iterations, if one is given.
    pub interrupt: Option<&'a Interrupt>,
}

/// Tolerance of the fixed point that suits all but studies of it.
pub const TOLERANCE: f64 = 1e-6;
/// Most contacts solved for it.
pub const MOST_STEPS: usize = 100;

impl<'a> FeedbackSetup<'a> {
    /// A contact whose moduli nothing changes yet, with the tolerance 1e-6.
    pub fn new(rubber: &'a dyn Viscoelastic, speed: f64, period: f64, heights: &'a [f64]) -> Self {
        Self {
            rubber,
            speed,
            period,
            heights,
            heat: None,
            strain: None,
            tolerance: TOLERANCE,
            most_steps: MOST_STEPS,
            interrupt: None,
        }
    }

    pub(super) fn check(&self) -> Result<(), EffectiveError> {
        let out_of_range = |quantity, value, range| {
            Err(ContactError::OutOfRange { quantity, value, range }.into())
        };
        if self.speed == 0.0 {
            return out_of_range("the speed in m/s", self.speed, "not zero where moduli follow it");
        }
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            let quantity = "the tolerance of the effective moduli";
            return out_of_range(quantity, self.tolerance, "between 0 and 1");
        }
        if self.most_steps == 0 {
            return out_of_range("the number of steps", 0.0, "at least 1");
        }
        if let Some(heat) = &self.heat {
            heat.thermal.check()?;
            if !(heat.temperature_c > -ZERO_CELSIUS && heat.temperature_c.is_finite()) {
                let quantity = "the temperature before sliding in °C";
                return out_of_range(quantity, heat.temperature_c, "above -273.15");
            }
        }
        Ok(())
    }
}
