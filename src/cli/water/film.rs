//! The time that a film needs to leave, as options and as lines.

use crate::cli::output::significant;
use crate::cli::{CliError, values};
use asperity::units::Units;
use asperity::water::{Footprint, SqueezeOut};
use clap::Args;
use serde::Serialize;

/// A block that squeezes a film out.
#[derive(Debug, Args)]
#[command(next_help_heading = "Squeeze-out")]
pub(super) struct FilmOptions {
    /// Also give the time in which water leaves from under a block of this width in mm, long across it.
    #[arg(long, value_name = "MM", requires_all = ["pressure", "film_um"], conflicts_with = "disc_radius_mm", value_parser = values::positive)]
    block_width_mm: Option<f64>,
    /// The same for a disc of this radius in mm.
    #[arg(long, value_name = "MM", requires_all = ["pressure", "film_um"], value_parser = values::positive)]
    disc_radius_mm: Option<f64>,
    /// Mean pressure in MPa.
    #[arg(long, value_name = "MPA", requires = "film_um", value_parser = values::positive)]
    pressure: Option<f64>,
    /// Thickness in um of the film that is left: well below the roughness, where dry contact is to hold.
    #[arg(long, value_name = "UM", requires = "pressure", value_parser = values::positive)]
    film_um: Option<f64>,
    /// Viscosity in Pa s [default: 1.002e-3, water of 20 °C].
    #[arg(long, value_name = "PA_S", requires = "film_um", value_parser = values::positive)]
    viscosity: Option<f64>,
}

/// Viscosity of water of 20 °C in Pa s.
const WATER: f64 = 1.002e-3;

/// How long a film needs to leave; the names are the keys of JSON.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Film {
    film_left_um: f64,
    pressure_mpa: f64,
    viscosity_pa_s: f64,
    length_mm: f64,
    time_s: f64,
    speed_mm_s: f64,
}

impl FilmOptions {
    /// # Errors
    /// [`CliError::Input`] for half of the options.
    pub(super) fn film(&self) -> Result<Option<Film>, CliError> {
        let (footprint, length_mm) = match (self.block_width_mm, self.disc_radius_mm) {
            (Some(width), _) => (Footprint::Strip { width: width.mm_to_m() }, width),
            (_, Some(radius)) => (Footprint::Disc { radius: radius.mm_to_m() }, 2.0 * radius),
            (None, None) if self.film_um.is_some() => {
                return Err(CliError::input(
                    "--film-um needs --block-width-mm or --disc-radius-mm",
                ));
            }
            (None, None) => return Ok(None),
        };
        let (Some(pressure_mpa), Some(film_left_um)) = (self.pressure, self.film_um) else {
            return Err(CliError::input("a block needs --pressure and --film-um"));
        };
        let viscosity_pa_s = self.viscosity.unwrap_or(WATER);
        let block =
            SqueezeOut { footprint, pressure: pressure_mpa.mpa_to_pa(), viscosity: viscosity_pa_s };
        let time_s = block
            .time_to(film_left_um.um_to_m())
            .map_err(|error| CliError::input(error.to_string()))?;
        let speed_mm_s = length_mm / time_s;
        if !(time_s > 0.0 && speed_mm_s > 0.0 && time_s.is_finite() && speed_mm_s.is_finite()) {
            return Err(CliError::input(
                "the time of squeeze-out overflows double precision: check the units of the block and of the film",
            ));
        }
        Ok(Some(Film { film_left_um, pressure_mpa, viscosity_pa_s, length_mm, time_s, speed_mm_s }))
    }
}

impl Film {
    pub(super) fn lines(&self) -> [(&'static str, String); 3] {
        [
            ("film left", format!("{} um", significant(self.film_left_um))),
            ("time until it is left", format!("{} s", significant(self.time_s))),
            ("dry contact up to", format!("{} mm/s", significant(self.speed_mm_s))),
        ]
    }
}
