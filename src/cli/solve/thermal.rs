//! The thermal side of a single problem.

use asperity::units::Units;

use clap::{ArgGroup, Args};

use crate::cli::values;
use asperity::heat::{Road, Thermal, ThermalSetting};

/// Thermal constants.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("sliding").required(true).args(["sliding_time", "sliding_distance_mm"])))]
pub(super) struct ThermalOptions {
    /// Conductivity of the rubber in W/(m K).
    #[arg(long, value_name = "W_MK", value_parser = values::positive, allow_negative_numbers = true)]
    conductivity: f64,
    /// Density of the rubber in kg/m³.
    #[arg(long, value_name = "KG_M3", value_parser = values::positive, allow_negative_numbers = true)]
    density: f64,
    /// Heat capacity of the rubber in J/(kg K).
    #[arg(long, value_name = "J_KGK", value_parser = values::positive, allow_negative_numbers = true)]
    heat_capacity: f64,
    /// Time of sliding in s after which the temperature is read.
    #[arg(long, value_name = "S", value_parser = values::positive, allow_negative_numbers = true)]
    sliding_time: Option<f64>,
    /// Sliding distance in mm instead, such as the length of a block.
    #[arg(long, value_name = "MM", value_parser = values::positive, allow_negative_numbers = true)]
    sliding_distance_mm: Option<f64>,
    /// Shear stress in MPa in contact (adhesion), whose power heats the surface.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    shear_mpa: Option<f64>,
    /// Conductivity of the road in W/(m K) [default: it takes no heat].
    #[arg(long, value_name = "W_MK", requires_all = ["road_density", "road_heat_capacity"], value_parser = values::positive, allow_negative_numbers = true)]
    road_conductivity: Option<f64>,
    /// Density of the road in kg/m³.
    #[arg(long, value_name = "KG_M3", requires = "road_conductivity", value_parser = values::positive, allow_negative_numbers = true)]
    road_density: Option<f64>,
    /// Heat capacity of the road in J/(kg K).
    #[arg(long, value_name = "J_KGK", requires = "road_conductivity", value_parser = values::positive, allow_negative_numbers = true)]
    road_heat_capacity: Option<f64>,
    /// Heat-transfer coefficient of the contact in W/(m² K) [default: both surfaces have one temperature].
    #[arg(long, value_name = "W_M2K", requires = "road_conductivity", value_parser = values::positive, allow_negative_numbers = true)]
    heat_transfer: Option<f64>,
}

impl ThermalOptions {
    /// The setting for a sliding speed in m/s.
    pub(super) fn setting(&self, speed: f64) -> ThermalSetting {
        let of_distance = self.sliding_distance_mm.map(|mm| mm.mm_to_m() / speed);
        let road = [self.road_conductivity, self.road_density, self.road_heat_capacity];
        let road = match road {
            [Some(conductivity), Some(density), Some(heat_capacity)] => Some(Road {
                body: Some(Thermal { conductivity, density, heat_capacity }),
                transfer: self.heat_transfer,
            }),
            _ => None,
        };
        ThermalSetting {
            rubber: Thermal {
                conductivity: self.conductivity,
                density: self.density,
                heat_capacity: self.heat_capacity,
            },
            // One of both is there.
            duration: self.sliding_time.or(of_distance).unwrap_or_default(),
            shear_stress: self.shear_mpa.unwrap_or(0.0).mpa_to_pa(),
            road,
        }
    }
}
