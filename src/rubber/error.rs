//! Why a file is no rubber.

use super::law::LawProblem;
use super::payne::PayneError;
use crate::files::{self, TomlError};
use asperity_core::error_kind::{ErrorKind, HasKind};
use asperity_core::rubber::{RubberError, TemperatureError};
use asperity_scans::sweeps::TableError;
use std::path::PathBuf;

/// Why a file is no rubber.
#[derive(Debug, thiserror::Error)]
pub enum RubberFileError {
    /// It cannot be read.
    #[error("cannot read the rubber {}: {source}{}", .path.display(), files::advice(.source))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system answered.
        source: std::io::Error,
    },
    /// The text is not the TOML of a rubber.
    #[error(
        "rubber {}{problem}{}",
        .path.display(),
        if *.is_recipe { "\n  this is a recipe: give the file of the rubber" } else { "" }
    )]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, key and what to write.
        problem: TomlError,
        /// Whether it is a recipe.
        is_recipe: bool,
    },
    /// A number that no rubber has, as it stands in the file.
    #[error("{}: {key} is {value}, it must be positive and finite", .path.display())]
    Number {
        /// The file.
        path: PathBuf,
        /// Its key, and the branch.
        key: String,
        /// Its value, in the unit of the key.
        value: f64,
    },
    /// The numbers are not those of a rubber.
    #[error("{} does not describe a rubber", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The first bad number.
        source: RubberError,
    },
    /// The temperature section, or a temperature that was asked for.
    #[error("{}", .path.display())]
    Temperature {
        /// The file.
        path: PathBuf,
        /// Why.
        source: TemperatureError,
    },
    /// A table of moduli where a model of relaxation is asked for.
    #[error("{}", .path.display())]
    NoRelaxationTimes {
        /// The file.
        path: PathBuf,
        /// What it lacks.
        source: RubberError,
    },
    /// Keys that do not go together, or are missing.
    #[error("{}: {problem}", .path.display())]
    Keys {
        /// The file.
        path: PathBuf,
        /// Which, and what to do.
        problem: String,
    },
    /// A file of measured rows that it names.
    #[error("{}: {key}", .path.display())]
    Table {
        /// The file of the rubber.
        path: PathBuf,
        /// The key that names the file.
        key: &'static str,
        /// What is wrong with the rows.
        source: TableError,
    },
    /// The section of softening with strain.
    #[error("{}: [payne]", .path.display())]
    Payne {
        /// The file.
        path: PathBuf,
        /// Why.
        source: PayneError,
    },
    /// Not exactly one law.
    #[error(
        "{}: [temperature] has {found} laws, it must have one: wlf, arrhenius, shift_factors or [[temperature.shift]]",
        .path.display()
    )]
    Laws {
        /// The file.
        path: PathBuf,
        /// How many there are.
        found: usize,
    },
    /// The section of the law at finite strain.
    #[error("{}: {problem}", .path.display())]
    FiniteStrain {
        /// The file.
        path: PathBuf,
        /// Which key is missing or has no business there.
        problem: LawProblem,
    },
    /// A measured range that is none.
    #[error(
        "{}: measured_hz is [{}, {}], wanted are the lowest and the highest measured frequency, positive",
        .path.display(), .range[0], .range[1]
    )]
    MeasuredRange {
        /// The file.
        path: PathBuf,
        /// The range in Hz.
        range: [f64; 2],
    },
}

impl HasKind for RubberFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable { .. }
            | Self::Syntax { .. }
            | Self::Number { .. }
            | Self::Invalid { .. }
            | Self::Temperature { .. }
            | Self::Laws { .. }
            | Self::FiniteStrain { .. }
            | Self::NoRelaxationTimes { .. }
            | Self::Keys { .. }
            | Self::Table { .. }
            | Self::MeasuredRange { .. } => ErrorKind::Input,
            Self::Payne { source, .. } => source.kind(),
        }
    }
}
