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
//!
//! Optional, and written by `asperity rubber fit`: the frequencies at which the moduli were
//! measured, and how they shift with temperature (one of the two laws of [`ShiftLaw`]).
//!
//! ```toml
//! measured_hz = [0.1, 1e6]                 # at the reference temperature
//!
//! [temperature]
//! reference_c = 20.0
//! measured_c = [-30.0, 60.0]               # optional
//! wlf = { c1 = 8.86, c2_k = 101.6 }        # or: arrhenius = { activation_energy_kj_mol = 90.0 }
//! vertical = { rho_t = { expansion_per_k = 6.6e-4 } }   # optional; or: { power = { exponent = 1.1 } }
//! ```
//!
//! Optional: the law of the springs at finite strain, neo-Hooke if absent ([`Rheology`]).
//!
//! ```toml
//! [finite_strain]
//! law = "yeoh"                             # or: "arruda-boyce" with locking_stretch = 2.5; "neo-hookean"
//! c2_over_c1 = -0.1
//! c3_over_c1 = 0.01
//! ```

use super::law::{FiniteStrainEntry, LawProblem};
use crate::files::{self, TomlError};
use crate::units::Units;
use asperity_core::error_kind::{ErrorKind, HasKind};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use asperity_core::rubber::{
    FrequencyRange, MaxwellBranch, Rheology, Rubber, RubberData, RubberError, ShiftLaw,
    TemperatureDependence, TemperatureError, VerticalShift,
};

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
    /// Not exactly one law.
    #[error(
        "{}: [temperature] has {found} laws, it must have one: either wlf or arrhenius", .path.display()
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
            | Self::MeasuredRange { .. } => ErrorKind::Input,
        }
    }
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
    measured_hz: Option<[f64; 2]>,
    temperature: Option<TemperatureEntry>,
    finite_strain: Option<FiniteStrainEntry>,
    #[serde(default)]
    branches: Vec<BranchEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TemperatureEntry {
    reference_c: f64,
    measured_c: Option<[f64; 2]>,
    wlf: Option<WlfEntry>,
    arrhenius: Option<ArrheniusEntry>,
    vertical: Option<VerticalShift>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WlfEntry {
    c1: f64,
    c2_k: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArrheniusEntry {
    activation_energy_kj_mol: f64,
}

impl TemperatureEntry {
    /// The dependence, or the number of laws.
    fn dependence(&self) -> Result<TemperatureDependence, usize> {
        let law = match (&self.wlf, &self.arrhenius) {
            (Some(wlf), None) => ShiftLaw::Wlf { c1: wlf.c1, c2_k: wlf.c2_k },
            (None, Some(arrhenius)) => {
                ShiftLaw::Arrhenius { activation_energy_kj_mol: arrhenius.activation_energy_kj_mol }
            }
            (None, None) => return Err(0),
            (Some(_), Some(_)) => return Err(2),
        };
        let (reference_c, measured_c) = (self.reference_c, self.measured_c);
        let vertical = self.vertical;
        Ok(TemperatureDependence { reference_c, law, measured_c, vertical })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BranchEntry {
    modulus_mpa: f64,
    relaxation_time_s: f64,
}

impl RubberFile {
    /// The first modulus or relaxation time that is none, with its key.
    fn bad_number(&self) -> Option<(String, f64)> {
        let usable = |value: f64| value > 0.0 && value.mpa_to_pa().is_finite();
        let equilibrium = ("equilibrium_modulus_mpa".to_owned(), self.equilibrium_modulus_mpa);
        let branches = self.branches.iter().enumerate().flat_map(|(k, branch)| {
            let named = |key: &str| format!("{key} of branch {}", k + 1);
            [
                (named("modulus_mpa"), branch.modulus_mpa),
                (named("relaxation_time_s"), branch.relaxation_time_s),
            ]
        });
        std::iter::once(equilibrium).chain(branches).find(|(_, value)| !usable(*value))
    }
}

impl From<RubberFile> for Rubber {
    fn from(file: RubberFile) -> Self {
        let branch = |entry: &BranchEntry| MaxwellBranch {
            modulus: entry.modulus_mpa.mpa_to_pa(),
            relaxation_time: entry.relaxation_time_s,
        };
        Self {
            name: file.name,
            equilibrium_modulus: file.equilibrium_modulus_mpa.mpa_to_pa(),
            branches: file.branches.iter().map(branch).collect(),
            poisson_ratio: file.poisson_ratio,
            finite_strain: Rheology::default(),
        }
    }
}

/// Reads and validates the rubber in a TOML file.
///
/// # Errors
/// [`RubberFileError`] with the path; the source has line and key, or the bad number.
pub fn read_rubber(path: impl AsRef<Path>) -> Result<Rubber, RubberFileError> {
    Ok(read_rubber_data(path)?.rubber)
}

/// Reads and validates the rubber in a TOML file with what is known of its measurement.
///
/// # Errors
/// As [`read_rubber`].
pub fn read_rubber_data(path: impl AsRef<Path>) -> Result<RubberData, RubberFileError> {
    let path = path.as_ref();
    let text = files::read_settings(path)
        .map_err(|source| RubberFileError::Unreadable { path: path.to_path_buf(), source })?;
    parse_rubber_data(path, &text)
}

/// Reads a rubber and, if a temperature in °C is given, shifts it there.
///
/// # Errors
/// As [`read_rubber`]; [`RubberFileError::Temperature`] for a temperature without moduli.
pub fn read_rubber_at(
    path: impl AsRef<Path>,
    temperature_c: Option<f64>,
) -> Result<RubberData, RubberFileError> {
    let path = path.as_ref();
    let data = read_rubber_data(path)?;
    match temperature_c {
        None => Ok(data),
        Some(temperature_c) => data
            .at_temperature(temperature_c)
            .map_err(|source| RubberFileError::Temperature { path: path.to_path_buf(), source }),
    }
}

/// [`read_rubber`] of a text in memory; the path serves the messages.
///
/// # Errors
/// Those of [`read_rubber`] but [`RubberFileError::Unreadable`].
pub fn parse_rubber(path: &Path, text: &str) -> Result<Rubber, RubberFileError> {
    Ok(parse_rubber_data(path, text)?.rubber)
}

/// [`read_rubber_data`] of a text in memory; the path serves the messages.
///
/// # Errors
/// Those of [`read_rubber`] but [`RubberFileError::Unreadable`].
pub fn parse_rubber_data(path: &Path, text: &str) -> Result<RubberData, RubberFileError> {
    let file: RubberFile = toml::from_str(text).map_err(|error| RubberFileError::Syntax {
        path: path.to_path_buf(),
        problem: TomlError::new(text, &error),
        is_recipe: ["[approximate]", "[realise]", "[bem]", "[sinusoid]"]
            .iter()
            .any(|section| text.contains(section)),
    })?;
    let measured = file.measured_hz.map(|range| measured_range(path, range)).transpose()?;
    let temperature = file.temperature.as_ref().map(|entry| dependence(path, entry)).transpose()?;
    if let Some((key, value)) = file.bad_number() {
        return Err(RubberFileError::Number { path: path.to_path_buf(), key, value });
    }
    let law = file.finite_strain.as_ref().map(FiniteStrainEntry::law).transpose();
    let finite_strain = law
        .map_err(|problem| RubberFileError::FiniteStrain { path: path.to_path_buf(), problem })?
        .unwrap_or_default();
    let rubber = Rubber { finite_strain, ..Rubber::from(file) };
    rubber
        .validate()
        .map_err(|source| RubberFileError::Invalid { path: path.to_path_buf(), source })?;
    Ok(RubberData { rubber, measured, temperature })
}

fn measured_range(path: &Path, range: [f64; 2]) -> Result<FrequencyRange, RubberFileError> {
    let [lowest_hz, highest_hz] = range;
    if lowest_hz > 0.0 && lowest_hz < highest_hz && highest_hz.is_finite() {
        return Ok(FrequencyRange { lowest_hz, highest_hz });
    }
    Err(RubberFileError::MeasuredRange { path: path.to_path_buf(), range })
}

fn dependence(
    path: &Path,
    entry: &TemperatureEntry,
) -> Result<TemperatureDependence, RubberFileError> {
    let path = || path.to_path_buf();
    let found =
        entry.dependence().map_err(|found| RubberFileError::Laws { path: path(), found })?;
    found.validate().map_err(|source| RubberFileError::Temperature { path: path(), source })?;
    Ok(found)
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
        let source = std::error::Error::source(&error).map(ToString::to_string);
        format!("{error}: {}", source.unwrap_or_default())
    }

    #[test]
    fn the_bundled_rubber_is_the_one_built_in() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/rubber/table_2_1.toml");
        assert_eq!(read_rubber(path).unwrap(), Rubber::table_2_1());
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
        assert!(unknown.contains("rubber tread.toml, line 6"), "{unknown}");
        let meant = "unknown key `relaxation_time_ms`; did you mean `relaxation_time_s`?";
        assert!(unknown.contains(meant), "{unknown}");
        let absent = failure(&VALID.replace("poisson_ratio = 0.5\n", ""));
        assert!(absent.contains("the key `poisson_ratio` is missing"), "{absent}");
        let text = failure(&VALID.replace("= 4.0", "= '4.0'"));
        assert!(text.contains("line 2") && text.contains("write 4.0, without quotes"), "{text}");
    }

    #[test]
    fn numbers_of_no_rubber_are_named() {
        let negative = failure(&VALID.replace("= 2.0", "= -2.0"));
        assert!(negative.contains("modulus_mpa of branch 1 is -2,"), "{negative}");
        let nan = failure(&VALID.replace("= 1e-3", "= nan"));
        assert!(nan.contains("relaxation_time_s of branch 1 is NaN"), "{nan}");
        let poisson = failure(&VALID.replace("= 0.5", "= 0.6"));
        assert!(poisson.contains("poisson_ratio is 0.6"), "{poisson}");
    }

    const TEMPERATURE: &str = "measured_hz = [0.1, 1e4]\n[temperature]\nreference_c = 20.0\n\
        wlf = { c1 = 8.0, c2_k = 100.0 }\n";

    fn with_temperature() -> String {
        VALID.replace("[[branches]]", &format!("{TEMPERATURE}[[branches]]"))
    }

    #[test]
    fn a_rubber_is_shifted_to_a_temperature() {
        let data = parse_rubber_data(Path::new("tread.toml"), &with_temperature()).unwrap();
        assert_eq!(data.rubber, parse(VALID).unwrap());
        // log10 a = -8 * 60 / 160 = -3.
        let hot = data.at_temperature(80.0).unwrap();
        approx::assert_relative_eq!(
            hot.rubber.branches[0].relaxation_time,
            1e-6,
            max_relative = 1e-12
        );
        assert_eq!(hot.rubber.branches[0].modulus, 2e6);
        approx::assert_relative_eq!(hot.measured.unwrap().highest_hz, 1e7, max_relative = 1e-12);
        let back = hot.at_temperature(20.0).unwrap().rubber.branches[0].relaxation_time;
        approx::assert_relative_eq!(back, 1e-3, max_relative = 1e-12);
        let without = RubberData { temperature: None, ..hot };
        assert!(matches!(without.at_temperature(20.0), Err(TemperatureError::NoLaw { .. })));
        assert_eq!(data.at_temperature(20.0).unwrap().rubber, data.rubber);
    }

    #[test]
    fn mistaken_temperature_sections_are_explained() {
        let law = "wlf = { c1 = 8.0, c2_k = 100.0 }";
        let arrhenius = "arrhenius = { activation_energy_kj_mol = 90.0 }";
        let both = format!("{law}\n{arrhenius}");
        let cases = [
            (law, "", "has 0 laws"),
            (law, both.as_str(), "has 2 laws"),
            ("c1 = 8.0", "c1 = -8.0", "temperature.wlf.c1 is -8"),
            ("c2_k = 100.0", "c2_k = nan", "temperature.wlf.c2_k is NaN"),
            ("reference_c = 20.0", "reference_c = -280.0", "absolute zero"),
            ("[0.1, 1e4]", "[1e4, 0.1]", "measured_hz is [10000, 0.1]"),
            ("[0.1, 1e4]", "[0.0, 1e4]", "measured_hz is [0, 10000]"),
            (law, "measured_c = [9.0, 1.0]\nwlf = { c1 = 8.0, c2_k = 100.0 }", "is [9, 1]"),
        ];
        for (old, new, part) in cases {
            let text = with_temperature().replace(old, new);
            let error = parse(&text).unwrap_err();
            let source = std::error::Error::source(&error).map(ToString::to_string);
            let message = format!("{error}: {}", source.unwrap_or_default());
            assert!(message.contains("tread.toml") && message.contains(part), "{new}: {message}");
        }
        let other = arrhenius.replace("90.0", "8.314462618");
        let text = with_temperature().replace(law, &other);
        let data = parse_rubber_data(Path::new("tread.toml"), &text).unwrap();
        assert!(matches!(data.temperature.unwrap().law, ShiftLaw::Arrhenius { .. }));
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read_rubber("no/such/rubber.toml").unwrap_err();
        assert!(error.to_string().contains("no/such/rubber.toml"), "{error}");
    }
}
