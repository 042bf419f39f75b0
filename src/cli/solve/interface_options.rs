//! Options of the shear traction of the contact.

use crate::cli::values;
use asperity::interface::LocalFriction;
use asperity::units::Units;
use clap::Args;

/// Local friction coefficient at vanishing pressure of a shear stress, at the edges of the contact.
const LARGEST_COEFFICIENT: f64 = 5.0;

/// Shear traction in the contact, along the deformed surface.
#[derive(Debug, Args)]
pub(super) struct InterfaceOptions {
    /// Local friction coefficient: the contact carries a shear traction of this times the pressure, along the surface;
    /// steady route only.
    #[arg(long, value_name = "MU", conflicts_with = "shear_mpa", value_parser = values::positive, allow_negative_numbers = true)]
    local_friction: Option<f64>,
    /// Shear stress in MPa of the contact, along the surface, instead of --local-friction; at the edges of the contact it
    /// rises from nothing as 5 times the pressure. Steady route only.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    shear_mpa: Option<f64>,
}

impl InterfaceOptions {
    /// The option that is given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let shear = self.shear_mpa.map(|_| "--shear-mpa");
        self.local_friction.map(|_| "--local-friction").or(shear)
    }

    /// The law of the options; none without them.
    pub(super) fn law(&self) -> LocalFriction {
        match (self.local_friction, self.shear_mpa) {
            (Some(coefficient), _) => LocalFriction::Coulomb { coefficient },
            (None, Some(shear_mpa)) => LocalFriction::Stress {
                stress: shear_mpa.mpa_to_pa(),
                largest_coefficient: LARGEST_COEFFICIENT,
            },
            (None, None) => LocalFriction::None,
        }
    }
}
