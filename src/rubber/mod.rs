//! The files of a rubber: its TOML, and tables of measured sweeps.
//!
//! The rubber itself is that of [`asperity_core::rubber`], under the same names.
//!
//! | module | what it holds |
//! |---|---|
//! | `document` | a rubber as the text of its file |
//! | `file`, `error` | rubbers as TOML files, and why a file is none |
//! | `entry`, `tables` | the file as it is written; the measured rows in it and in files beside it |
//! | `law` | their section of the law at finite strain |

mod document;
mod entry;
mod error;
mod file;
mod law;
mod tables;

pub use asperity_core::rubber::*;
pub use document::{payne_section, to_toml};
pub use error::RubberFileError;
pub use file::{parse_rubber, parse_rubber_data, read_rubber, read_rubber_at, read_rubber_data};
pub use law::LawProblem;

/// A rubber from measured storage and loss moduli: the fit of [`asperity_core::rubber::fit`], and the tables that it
/// reads.
pub mod fit {
    pub use asperity_core::rubber::fit::*;
    pub use asperity_scans::sweeps::{
        DescribedColumn, StrainUnit, SweepTable, TableError, TableOptions, doubts, parse_sweeps,
        read_master_curve, read_shift_factors, read_strain_sweeps, read_sweeps, strain_doubts,
    };
}
