//! The rubber of a single problem.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::{CliError, values};
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber, read_rubber};

/// The rubber.
#[derive(Debug, Args)]
pub(super) struct MaterialOptions {
    /// Rubber as a TOML file, see data/rubber [default: Table 2.1 of the thesis].
    #[arg(long, value_name = "FILE", conflicts_with_all = ["modulus", "poisson"])]
    rubber: Option<PathBuf>,
    /// Young's modulus in MPa of an elastic half-space in place of a rubber; with --poisson.
    #[arg(long, value_name = "MPA", requires = "poisson", value_parser = values::positive, allow_negative_numbers = true)]
    modulus: Option<f64>,
    /// Poisson ratio of the elastic half-space, 0 to 0.5; with --modulus.
    #[arg(long, value_name = "NU", requires = "modulus", value_parser = values::finite, allow_negative_numbers = true)]
    poisson: Option<f64>,
}

impl MaterialOptions {
    pub(super) fn rubber(&self) -> Result<Rubber, CliError> {
        match (&self.rubber, self.modulus, self.poisson) {
            (Some(path), _, _) => read_rubber(path).map_err(CliError::input),
            (None, Some(modulus_mpa), Some(poisson_ratio)) => {
                Ok(Rubber::elastic(modulus_mpa * 1e6, poisson_ratio))
            }
            _ => Ok(Rubber::table_2_1()),
        }
    }

    /// The rubber, if it can be had at finite deformation.
    pub(super) fn rubber_at_finite_deformation(&self) -> Result<Rubber, CliError> {
        let rubber = self.rubber()?;
        match (FiniteStrainRubber::new(&rubber, Rheology::NeoHookean), &self.rubber) {
            (Ok(_), _) => Ok(rubber),
            (Err(error), None) => Err(CliError::input(error)),
            (Err(error), Some(path)) => {
                Err(CliError::input(format!("{}: {error}", path.display())))
            }
        }
    }

    /// The file of the rubber, if it has one.
    pub(super) fn file(&self) -> Option<&Path> {
        self.rubber.as_deref()
    }
}
