//! Rubbers as TOML files.
//!
//! ```toml
//! name = "tread"
//! source = "where the numbers come from"   # optional
//! equilibrium_modulus_mpa = 4.17
//! poisson_ratio = 0.49
//!
//! [[branches]]                             # none for an elastic solid
//! modulus_mpa = 1.72
//! relaxation_time_s = 1.134e-2
//! ```

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{MaxwellBranch, Rubber, RubberError};

const PA_PER_MPA: f64 = 1e6;
const TABLE_2_1: &str = include_str!("../../data/rubber/table_2_1.toml");

/// Why a file is no rubber.
#[derive(Debug, thiserror::Error)]
pub enum RubberFileError {
    /// The operating system refused.
    #[error("cannot read the rubber {}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system answered.
        source: std::io::Error,
    },
    /// The text is not the TOML of a rubber; the source names line and key.
    #[error("{} does not describe a rubber", .path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the TOML reader stumbled over.
        source: toml::de::Error,
    },
    /// The numbers are not those of a rubber.
    #[error("{} does not describe a rubber (values below in Pa and s)", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The first bad number.
        source: RubberError,
    },
}

/// The file as it is written, in the units of its keys.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RubberFile {
    name: String,
    /// For the reader of the file; computing needs it not.
    #[serde(default, rename = "source")]
    _source: Option<String>,
    equilibrium_modulus_mpa: f64,
    poisson_ratio: f64,
    #[serde(default)]
    branches: Vec<BranchEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BranchEntry {
    modulus_mpa: f64,
    relaxation_time_s: f64,
}

impl From<RubberFile> for Rubber {
    fn from(file: RubberFile) -> Self {
        let branch = |entry: &BranchEntry| MaxwellBranch {
            modulus: entry.modulus_mpa * PA_PER_MPA,
            relaxation_time: entry.relaxation_time_s,
        };
        Self {
            name: file.name,
            equilibrium_modulus: file.equilibrium_modulus_mpa * PA_PER_MPA,
            branches: file.branches.iter().map(branch).collect(),
            poisson_ratio: file.poisson_ratio,
        }
    }
}

/// Reads and validates the rubber in a TOML file.
///
/// # Errors
/// [`RubberFileError`] with the path; the source has line and key, or the bad number.
pub fn read_rubber(path: impl AsRef<Path>) -> Result<Rubber, RubberFileError> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path)
        .map_err(|source| RubberFileError::Unreadable { path: path.to_path_buf(), source })?;
    parse_rubber(path, &text)
}

/// [`read_rubber`] of a text in memory; the path serves the messages.
///
/// # Errors
/// Those of [`read_rubber`] but [`RubberFileError::Unreadable`].
pub fn parse_rubber(path: &Path, text: &str) -> Result<Rubber, RubberFileError> {
    let file: RubberFile = toml::from_str(text)
        .map_err(|source| RubberFileError::Syntax { path: path.to_path_buf(), source })?;
    let rubber = Rubber::from(file);
    rubber
        .validate()
        .map_err(|source| RubberFileError::Invalid { path: path.to_path_buf(), source })?;
    Ok(rubber)
}

impl Rubber {
    /// The rubber of the published tables (thesis, Table 2.1) with the constant Poisson ratio 0.49:
    /// the bundled file `data/rubber/table_2_1.toml`.
    pub fn table_2_1() -> Self {
        // The text is compiled in and a test parses it, so this cannot fail at a user's.
        parse_rubber(Path::new("data/rubber/table_2_1.toml"), TABLE_2_1)
            .expect("the bundled file is a rubber")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALID: &str = "name = 'tread'\nequilibrium_modulus_mpa = 4.0\npoisson_ratio = 0.5\n\
        [[branches]]\nmodulus_mpa = 2.0\nrelaxation_time_s = 1e-3\n";

    fn parse(text: &str) -> Result<Rubber, RubberFileError> {
        parse_rubber(Path::new("tread.toml"), text)
    }

    /// Message and source of the error, as a user sees them.
    fn failure(text: &str) -> String {
        let error = parse(text).unwrap_err();
        let source = std::error::Error::source(&error).unwrap();
        format!("{error}: {source}")
    }

    #[test]
    fn the_bundled_rubber_is_the_one_built_in() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/rubber/table_2_1.toml");
        assert_eq!(read_rubber(path).unwrap(), Rubber::table_2_1());
    }

    #[test]
    fn the_bundled_rubber_is_table_2_1() {
        let rubber = Rubber::table_2_1();
        assert_eq!((rubber.equilibrium_modulus, rubber.poisson_ratio), (4.17e6, 0.49));
        // Typed from the thesis a second time; 2901.89 MPa is the sum of its moduli.
        assert!((rubber.glassy_modulus() - 2901.89e6).abs() < 1e-12 * 2901.89e6);
        let times: Vec<f64> = rubber.branches.iter().map(|branch| branch.relaxation_time).collect();
        assert_eq!(times, [1.134e-2, 2.628e-4, 1.316e-5, 1.295e-6, 7.708e-8, 4.2e-10]);
    }

    #[test]
    fn moduli_are_read_in_mpa() {
        let rubber = parse(VALID).unwrap();
        assert_eq!(rubber.equilibrium_modulus, 4e6);
        let branch = MaxwellBranch { modulus: 2e6, relaxation_time: 1e-3 };
        assert_eq!(rubber.branches, [branch]);
        assert!(parse(&VALID[..VALID.find("[[").unwrap()]).unwrap().branches.is_empty());
    }

    #[test]
    fn mistakes_are_named_by_file_line_and_key() {
        let unknown = failure(&VALID.replace("relaxation_time_s", "relaxation_time_ms"));
        assert!(unknown.contains("tread.toml does not describe a rubber"), "{unknown}");
        assert!(unknown.contains("line 6"), "{unknown}");
        assert!(unknown.contains("unknown field `relaxation_time_ms`"), "{unknown}");
        let absent = failure(&VALID.replace("poisson_ratio = 0.5\n", ""));
        assert!(absent.contains("missing field `poisson_ratio`"), "{absent}");
        let text = failure(&VALID.replace("= 4.0", "= '4.0'"));
        assert!(text.contains("line 2") && text.contains("expected f64"), "{text}");
    }

    #[test]
    fn numbers_of_no_rubber_are_named() {
        let negative = failure(&VALID.replace("= 2.0", "= -2.0"));
        assert!(negative.contains("the modulus of branch 1 is -2000000"), "{negative}");
        let nan = failure(&VALID.replace("= 1e-3", "= nan"));
        assert!(nan.contains("the relaxation time of branch 1 is NaN"), "{nan}");
        let poisson = failure(&VALID.replace("= 0.5", "= 0.6"));
        assert!(poisson.contains("poisson_ratio is 0.6"), "{poisson}");
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read_rubber("no/such/rubber.toml").unwrap_err();
        assert!(error.to_string().contains("no/such/rubber.toml"), "{error}");
    }
}
