//! The rubber and its speed, without a profile.

use super::super::profile::RigidProfile;
use super::flow::Relaxation;
use super::row::Material;
use crate::interface::LocalFriction;
use crate::multiscale::LocalLaw;
use crate::numerics::Interrupt;
use crate::rubber::{FiniteStrainRubber, Rubber};
use std::f64::consts::TAU;

/// Pressure of the first contact over the modulus at the shortest wave.
const FIRST_PRESSURE: f64 = 3e-2;

/// The rubber and its speed, without a profile.
pub(super) struct Setting {
    pub rubber: Rubber,
    pub finite: FiniteStrainRubber,
    /// Speed in m/s.
    pub speed: f64,
    /// Shear traction of the contact.
    pub interface: LocalFriction,
    /// Short waves between profile and rubber.
    pub layer: Option<LocalLaw>,
    pub interrupt: Interrupt,
}

impl Setting {
    /// The rubber on a row of one period in m.
    pub fn material(&self, period: f64) -> Material {
        let length = |time: f64| Relaxation { length: self.speed * time, period };
        let branches = self.finite.branches.iter();
        let relaxations = branches.map(|branch| length(branch.relaxation_time)).collect();
        Material { rubber: self.finite.clone(), relaxations }
    }

    /// A mean pressure in Pa at which the highest tip of a profile carries all, in a contact of a few
    /// percent of the shortest wave.
    pub fn first_pressure(&self, profile: &RigidProfile) -> f64 {
        let waves = profile.shortest_waves();
        let frequency = TAU * waves / profile.period() * self.speed;
        FIRST_PRESSURE * self.rubber.reduced_modulus(frequency).norm() / waves
    }
}
