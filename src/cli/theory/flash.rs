//! The heat of the rubber, as options.

use asperity::rubber::{TemperatureDependence, Viscoelastic, ZERO_CELSIUS};
use asperity::theory::{Heating, IsotropicPersson};
use asperity::units::Units;
use clap::Args;
use serde::Serialize;

use crate::cli::solve::Material;
use crate::cli::{CliError, values};

/// The heat of the rubber.
#[derive(Debug, Args)]
#[command(next_help_heading = "Flash temperature")]
pub(super) struct FlashOptions {
    /// Also give area and friction with Persson's flash temperature (2006), for a rubber whose file has a [temperature]
    /// section; the rubber is at its temperature before it is heated.
    #[arg(long, requires = "contact_diameter_mm")]
    flash: bool,
    /// Diameter in mm of the large contact regions: a point of the rubber is heated while it crosses one, and all heat is
    /// made in the contact of the waves longer than it.
    #[arg(long, value_name = "MM", requires = "flash", value_parser = values::positive, allow_negative_numbers = true)]
    contact_diameter_mm: Option<f64>,
    /// Thermal conductivity of the rubber in W/(m K); 0.2 to 0.3 are usual for filled rubber.
    #[arg(long, value_name = "W_MK", default_value_t = 0.3, requires = "flash", value_parser = values::positive, allow_negative_numbers = true)]
    conductivity_w_mk: f64,
    /// Density of the rubber in kg/m3.
    #[arg(long, value_name = "KG_M3", default_value_t = 1150.0, requires = "flash", value_parser = values::positive, allow_negative_numbers = true)]
    density_kg_m3: f64,
    /// Specific heat of the rubber in J/(kg K).
    #[arg(long, value_name = "J_KGK", default_value_t = 1500.0, requires = "flash", value_parser = values::positive, allow_negative_numbers = true)]
    specific_heat_j_kgk: f64,
}

/// A heated prediction beside the one without heat.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct FlashRow {
    pub(super) speed_mm_s: f64,
    pub(super) pressure_mpa: f64,
    pub(super) contact_area_fraction: f64,
    pub(super) contact_area_fraction_error: f64,
    pub(super) friction_coefficient: f64,
    pub(super) friction_coefficient_error: f64,
    pub(super) mean_gap_mm: f64,
    pub(super) rise_k: f64,
    pub(super) steps: usize,
}

impl FlashRow {
    /// The values in the order of the columns of CSV.
    pub(super) fn values(&self) -> [f64; 7] {
        [
            self.contact_area_fraction,
            self.contact_area_fraction_error,
            self.friction_coefficient,
            self.friction_coefficient_error,
            self.mean_gap_mm,
            self.rise_k,
            self.steps as f64,
        ]
    }
}

impl FlashOptions {
    /// The law of the rubber and the diameter of its contact regions in m, if heat is asked for.
    ///
    /// # Errors
    /// [`CliError::Input`] for a rubber without a law.
    pub(super) fn asked(
        &self,
        material: &Material,
    ) -> Result<Option<(TemperatureDependence, f64)>, CliError> {
        let (true, Some(diameter)) = (self.flash, self.contact_diameter_mm) else {
            return Ok(None);
        };
        let law = material.temperature_dependence().ok_or_else(|| {
            CliError::input(format!(
                "--flash: the rubber {} has no [temperature] section, so heat does not change it; leave --flash out, or give \
                 a --rubber with one (`asperity rubber fit` writes it)",
                material.rubber().name()
            ))
        })?;
        Ok(Some((law, diameter.mm_to_m())))
    }

    /// The heated prediction.
    ///
    /// # Errors
    /// Those of the theory.
    pub(super) fn row(
        &self,
        theory: &IsotropicPersson,
        (law, contact_diameter): &(TemperatureDependence, f64),
        speed_mm_s: f64,
        pressure_mpa: f64,
    ) -> Result<FlashRow, CliError> {
        // The law has been moved to the temperature of the rubber, where its factors are 1.
        let shift = |rise: f64| {
            let temperature_c = law.reference_c + rise;
            if temperature_c <= -ZERO_CELSIUS {
                return [f64::NAN; 2];
            }
            let shift = law.shift_factor(temperature_c).map_or(f64::NAN, f64::ln);
            [shift, law.vertical_factor(temperature_c).ln()]
        };
        let heating = Heating {
            conductivity: self.conductivity_w_mk,
            volumetric_heat: self.density_kg_m3 * self.specific_heat_j_kgk,
            contact_diameter: *contact_diameter,
            shift: &shift,
        };
        let hot = theory.heated(speed_mm_s.mm_to_m(), pressure_mpa.mpa_to_pa(), &heating)?;
        let at = hot.prediction;
        Ok(FlashRow {
            speed_mm_s,
            pressure_mpa,
            contact_area_fraction: at.contact_area_fraction,
            contact_area_fraction_error: at.errors.contact_area_fraction,
            friction_coefficient: at.friction_coefficient,
            friction_coefficient_error: at.errors.friction_coefficient,
            mean_gap_mm: at.mean_gap.m_to_mm(),
            rise_k: hot.rise,
            steps: hot.steps,
        })
    }
}
