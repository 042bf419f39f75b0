//! The rubber of a single problem.

use asperity::units::Units;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::{CliError, values};
use asperity::rubber::payne::PayneLaw;
use asperity::rubber::{
    FiniteStrainRubber, FrequencyRange, Rubber, RubberData, RubberModel, TemperatureDependence,
    read_rubber_data,
};

/// The rubber.
#[derive(Debug, Args)]
pub(in crate::cli) struct MaterialOptions {
    /// Rubber as a TOML file, see data/rubber [default: Table 2.1 of the thesis].
    #[arg(long, value_name = "FILE", conflicts_with_all = ["modulus", "poisson"])]
    rubber: Option<PathBuf>,
    /// Temperature in °C; --rubber then needs a [temperature] section, see `asperity rubber fit`
    /// [default: that of the moduli in the file].
    #[arg(long, value_name = "C", requires = "rubber", conflicts_with_all = ["modulus", "poisson"], value_parser = values::finite, allow_negative_numbers = true)]
    temperature_c: Option<f64>,
    /// Young's modulus in MPa of an elastic half-space instead of a rubber; with --poisson.
    #[arg(long, value_name = "MPA", requires = "poisson", value_parser = values::positive, allow_negative_numbers = true)]
    modulus: Option<f64>,
    /// Poisson ratio of the elastic half-space, 0 to 0.5; with --modulus.
    #[arg(long, value_name = "NU", requires = "modulus", value_parser = values::finite, allow_negative_numbers = true)]
    poisson: Option<f64>,
}

/// The rubber at its temperature.
pub(in crate::cli) struct Material {
    data: RubberData,
    /// Suspicious values of its file, if it has one.
    oddities: Vec<String>,
}

impl MaterialOptions {
    pub(in crate::cli) fn material(&self) -> Result<Material, CliError> {
        let data = match (&self.rubber, self.modulus, self.poisson) {
            (Some(path), _, _) => read_rubber_data(path)?,
            (None, Some(modulus_mpa), Some(poisson_ratio)) => {
                Rubber::elastic(modulus_mpa.mpa_to_pa(), poisson_ratio).into()
            }
            _ => Rubber::table_2_1().into(),
        };
        let oddities = self.rubber.as_ref().map_or(Vec::new(), |_| data.oddities());
        let data = match self.temperature_c {
            None => data,
            Some(temperature_c) => {
                data.at_temperature(temperature_c).map_err(|error| self.named(error))?
            }
        };
        Ok(Material { data, oddities })
    }

    /// The rubber, if it can be solved at finite deformation.
    pub(super) fn material_at_finite_deformation(&self) -> Result<Material, CliError> {
        let material = self.material()?;
        let rubber = material.rubber().maxwell().map_err(|error| self.named(error))?;
        match FiniteStrainRubber::new(rubber, rubber.finite_strain) {
            Ok(_) => Ok(material),
            Err(error) => Err(self.named(error)),
        }
    }

    /// The error with the file of the rubber, if it has one.
    fn named(&self, error: impl std::error::Error + Send + Sync + 'static) -> CliError {
        match &self.rubber {
            None => CliError::input(error),
            Some(path) => CliError::input(format!("{}: {error}", path.display())),
        }
    }

    /// The temperature asked for in °C; none for that of the moduli.
    pub(in crate::cli) fn temperature_c(&self) -> Option<f64> {
        self.temperature_c
    }

    /// The file of the rubber, if it has one.
    pub(in crate::cli) fn file(&self) -> Option<&Path> {
        self.rubber.as_deref()
    }
}

impl Material {
    pub(in crate::cli) fn rubber(&self) -> &RubberModel {
        &self.data.rubber
    }

    /// How the rubber shifts from its temperature to others, if it is known.
    pub(in crate::cli) fn temperature_dependence(&self) -> Option<TemperatureDependence> {
        self.data.temperature.clone()
    }

    /// How the rubber softens with strain at its temperature, if its file has it.
    pub(super) fn payne_law(&self) -> Option<PayneLaw> {
        self.data.payne_law()
    }

    /// Warnings: what looks like a mistake in its file, and extrapolations beyond the measurement of the rubber, which are
    /// the shift to its temperature and the frequencies that waves of these lengths in m excite at a speed in m/s.
    pub(in crate::cli) fn warnings(&self, wavelengths: Vec<f64>, speed: f64) -> Vec<String> {
        let excited = FrequencyRange::excited(wavelengths, [speed]);
        let extrapolations = self.data.extrapolations(excited);
        self.oddities.iter().cloned().chain(extrapolations).collect()
    }
}
