//! The files of a rubber: its TOML, and tables of measured sweeps.
//!
//! The rubber itself is that of [`asperity_core::rubber`], under the same names.
//!
//! | module | what it holds |
//! |---|---|
//! | `document` | a rubber as the text of its file |
//! | `file` | rubbers as TOML files |
//! | `law` | their section of the law at finite strain |

mod document;
mod file;
mod law;

pub use asperity_core::rubber::*;
pub use document::to_toml;
pub use file::{
    RubberFileError, parse_rubber, parse_rubber_data, read_rubber, read_rubber_at, read_rubber_data,
};
pub use law::LawProblem;

/// A rubber from measured storage and loss moduli: the fit of [`asperity_core::rubber::fit`], and the tables that it
/// reads.
pub mod fit {
    pub use asperity_core::rubber::fit::*;
    pub use asperity_scans::sweeps::{
        DescribedColumn, SweepTable, TableError, TableOptions, doubts, parse_sweeps,
        read_shift_factors, read_sweeps,
    };
}
