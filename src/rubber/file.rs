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
//!
//! In place of `equilibrium_modulus_mpa` and `[[branches]]` a table of measured moduli, in place of a law measured shift
//! factors; files are beside the rubber file:
//!
//! ```toml
//! master_curve = "master_curve.csv"        # or [[moduli]] with frequency_hz, storage_mpa, loss_mpa
//! modulus_kind = "youngs"                  # or "shear"
//! extrapolate = "refuse"                   # or "hold": the moduli at the ends of the table beyond them
//! points_per_decade = 5.0                  # optional: averages
//! columns = "frequency_hz=1,storage_pa=2,loss_pa=3"     # optional: for a file without a header
//!
//! [temperature]
//! shift_factors = "shift_factors.csv"      # or [[temperature.shift]] with temperature_c, log10_shift
//! ```
//!
//! With any of them, how the rubber softens with strain ([`payne`](super::payne)); strains of `[[payne.kraus]]` (`critical_strain`,
//! `exponent`, `storage_limit`, `loss_limit`, `loss_peak`, `highest_strain`) and `[[payne.table]]` (lists `strain`,
//! `storage_factor`, `loss_factor`) are parts of one, each with a `temperature_c` if there are several:
//!
//! ```toml
//! [payne]
//! strain_kind = "elongation"               # or "shear"
//! strain_sweep = "strain_sweep.csv"        # or [[payne.kraus]], or [[payne.table]]
//! strain_unit = "percent"                  # or "fraction", where the header does not say
//! law = "table"                            # or "kraus"
//! ```

use super::entry::RubberFile;
use super::error::RubberFileError;
use super::law::FiniteStrainEntry;
use super::tables;
use crate::files::{self, TomlError};
use asperity_core::rubber::{FrequencyRange, Rubber, RubberData, RubberModel, Viscoelastic};
use std::path::Path;

/// Reads and validates the Maxwell model in a TOML file.
///
/// # Errors
/// [`RubberFileError`] with the path; the source has line and key, or the bad number.
/// [`RubberFileError::NoRelaxationTimes`] for a table of moduli.
pub fn read_rubber(path: impl AsRef<Path>) -> Result<Rubber, RubberFileError> {
    maxwell(path.as_ref(), read_rubber_data(path.as_ref())?)
}

fn maxwell(path: &Path, data: RubberData) -> Result<Rubber, RubberFileError> {
    match data.rubber.maxwell() {
        Ok(rubber) => Ok(rubber.clone()),
        Err(source) => Err(RubberFileError::NoRelaxationTimes { path: path.to_path_buf(), source }),
    }
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
    maxwell(path, parse_rubber_data(path, text)?)
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
    if let Some(problem) = file.misplaced() {
        return Err(RubberFileError::Keys { path: path.to_path_buf(), problem });
    }
    let measured = file.measured_hz.map(|range| measured_range(path, range)).transpose()?;
    let temperature =
        file.temperature.as_ref().map(|entry| tables::dependence(path, entry)).transpose()?;
    if let Some((key, value)) = file.bad_number() {
        return Err(RubberFileError::Number { path: path.to_path_buf(), key, value });
    }
    let (rubber, mut notes) = model(path, text, &file)?;
    let payne = file.payne.as_ref().map(|entry| tables::payne(path, entry)).transpose()?;
    let payne = payne.map(|(payne, of_payne)| {
        notes.extend(of_payne);
        payne
    });
    let several = payne.as_ref().is_some_and(|payne| payne.curves().len() > 1);
    if several && temperature.is_none() {
        let problem = "[payne] has sweeps at several temperatures and the moduli have none: add [temperature], or keep one \
                       sweep";
        return Err(RubberFileError::Keys { path: path.to_path_buf(), problem: problem.into() });
    }
    let measured = measured.or_else(|| rubber.measured());
    Ok(RubberData { rubber, measured, temperature, payne, notes })
}

/// The model of the file: a table, or relaxation times; and what reading it changed.
fn model(
    path: &Path,
    text: &str,
    file: &RubberFile,
) -> Result<(RubberModel, Vec<String>), RubberFileError> {
    if file.is_table() {
        let (table, notes) = tables::moduli(path, file)?;
        return Ok((table.into(), notes));
    }
    let Some(rubber) = file.maxwell() else {
        return Err(RubberFileError::Keys {
            path: path.to_path_buf(),
            problem: match text.contains("[[branches]]") {
                true => "the key `equilibrium_modulus_mpa` is missing".into(),
                false => "the key `equilibrium_modulus_mpa` is missing, or a table of moduli in its place: master_curve = \
                          \"FILE\" or [[moduli]]"
                    .into(),
            },
        });
    };
    let law = file.finite_strain.as_ref().map(FiniteStrainEntry::law).transpose();
    let finite_strain = law
        .map_err(|problem| RubberFileError::FiniteStrain { path: path.to_path_buf(), problem })?
        .unwrap_or_default();
    let rubber = Rubber { finite_strain, ..rubber };
    rubber.validate().map_err(|source| tables::invalid(path, source))?;
    Ok((rubber.into(), Vec::new()))
}

fn measured_range(path: &Path, range: [f64; 2]) -> Result<FrequencyRange, RubberFileError> {
    let [lowest_hz, highest_hz] = range;
    if lowest_hz > 0.0 && lowest_hz < highest_hz && highest_hz.is_finite() {
        return Ok(FrequencyRange { lowest_hz, highest_hz });
    }
    Err(RubberFileError::MeasuredRange { path: path.to_path_buf(), range })
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_core::rubber::{MaxwellBranch, ShiftLaw, TemperatureError};

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
        assert_eq!(data.rubber, parse(VALID).unwrap().into());
        // log10 a = -8 * 60 / 160 = -3.
        let hot = data.at_temperature(80.0).unwrap();
        let branch = |data: &RubberData| data.rubber.maxwell().unwrap().branches[0];
        approx::assert_relative_eq!(branch(&hot).relaxation_time, 1e-6, max_relative = 1e-12);
        assert_eq!(branch(&hot).modulus, 2e6);
        approx::assert_relative_eq!(hot.measured.unwrap().highest_hz, 1e7, max_relative = 1e-12);
        let back = branch(&hot.at_temperature(20.0).unwrap()).relaxation_time;
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
