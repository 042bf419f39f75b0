//! Thermal constants of rubber and road.

use super::HeatError;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Thermal constants of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Thermal {
    /// Conductivity κ in W/(m K).
    pub conductivity: f64,
    /// Density ρ in kg/m³.
    pub density: f64,
    /// Specific heat capacity c in J/(kg K).
    pub heat_capacity: f64,
}

impl Thermal {
    /// Diffusivity `D = κ / (ρ c)` in m²/s.
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / (self.density * self.heat_capacity)
    }

    /// Rise in K of the surface of a half-space after a uniform heat flux of 1 W/m² for a `duration` in s:
    /// `2 sqrt(D t / π) / κ`.
    pub fn uniform_rise(&self, duration: f64) -> f64 {
        2.0 * (self.diffusivity() * duration / PI).sqrt() / self.conductivity
    }

    pub(super) fn check(&self, body: Body) -> Result<(), HeatError> {
        let [conductivity, density, capacity] = match body {
            Body::Rubber => [
                "the conductivity of the rubber in W/(m K)",
                "the density of the rubber in kg/m³",
                "the heat capacity of the rubber in J/(kg K)",
            ],
            Body::Road => [
                "the conductivity of the road in W/(m K)",
                "the density of the road in kg/m³",
                "the heat capacity of the road in J/(kg K)",
            ],
        };
        positive(conductivity, self.conductivity)?;
        positive(density, self.density)?;
        positive(capacity, self.heat_capacity)
    }
}

/// Which body a number belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) enum Body {
    Rubber,
    Road,
}

/// How heat leaves the rubber where it touches the road: through a resistance into a half-space at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Road {
    /// The road as a conductor; `None` for a road whose surface keeps its temperature.
    pub body: Option<Thermal>,
    /// Heat-transfer coefficient of the interface in W/(m² K); `None` for equal temperatures of both surfaces.
    pub transfer: Option<f64>,
}

impl Road {
    /// A road in perfect thermal contact.
    pub fn perfect(body: Thermal) -> Self {
        Self { body: Some(body), transfer: None }
    }

    pub(super) fn check(&self) -> Result<(), HeatError> {
        if let Some(body) = self.body {
            body.check(Body::Road)?;
        }
        if let Some(transfer) = self.transfer {
            positive("the heat-transfer coefficient in W/(m² K)", transfer)?;
        }
        Ok(())
    }
}

/// The thermal side of a sliding contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalSetting {
    /// The rubber.
    pub rubber: Thermal,
    /// Time of sliding t_0 in s, after which the temperature is read; of a sliding distance it is that over the speed.
    pub duration: f64,
    /// Shear stress τ_f in Pa of the contact, whose power `τ_f |v|` heats its surface; zero without adhesion.
    pub shear_stress: f64,
    /// What the contact conducts to; an insulated surface if `None`.
    pub road: Option<Road>,
}

impl ThermalSetting {
    /// # Errors
    /// [`HeatError::OutOfRange`] with the first number out of range.
    pub fn check(&self) -> Result<(), HeatError> {
        self.rubber.check(Body::Rubber)?;
        positive("the time of sliding in s", self.duration)?;
        if !(self.shear_stress >= 0.0 && self.shear_stress.is_finite()) {
            let (quantity, value) = ("the shear stress of the contact in Pa", self.shear_stress);
            return Err(HeatError::OutOfRange { quantity, value, range: "zero or positive" });
        }
        self.road.map_or(Ok(()), |road| road.check())
    }
}

pub(super) fn positive(quantity: &'static str, value: f64) -> Result<(), HeatError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(HeatError::OutOfRange { quantity, value, range: "positive and finite" })
}
