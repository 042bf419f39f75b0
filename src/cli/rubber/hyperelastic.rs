//! `asperity rubber hyperelastic`: the law at finite strain from a curve of stress over stretch.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::cli::CliError;
use crate::cli::output::{aligned, json, note, print, significant};
use asperity::error_kind::HasKind;
use asperity::rubber::Rheology;
use asperity::rubber::hyperelastic::{HyperelasticFit, UniaxialPoint, fit_uniaxial};
use asperity::units::Units;

const EXAMPLES: &str = "\
Examples:
  A curve with the columns stretch and stress_mpa, tension and compression:
    asperity rubber hyperelastic curve.csv

Exit codes: 0 fitted, 1 not written, 2 bad input.";

/// Fit the laws at finite strain to a measured curve of stress over stretch.
///
/// The file is comma-separated with a header: stretch (length over undeformed length) or strain (that less 1), and
/// stress_mpa, stress_kpa or stress_pa (force over undeformed area, negative in compression) of a uniaxial test. The
/// ratios go to the section [finite_strain] of a rubber file; its moduli stay those of its series.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Hyperelastic {
    /// Measured points.
    #[arg(value_name = "CURVE.CSV")]
    curve: PathBuf,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
}

/// What is printed of a law.
#[derive(Debug, Serialize)]
struct Fitted {
    finite_strain: Rheology,
    shear_modulus_mpa: f64,
    misfit: f64,
    largest_invariant: f64,
    /// `I1 - 3` up to which the law holds; none without an end.
    holds_up_to: Option<f64>,
}

impl Fitted {
    fn new(fit: &HyperelasticFit) -> Self {
        let limit = fit.law.limit();
        Self {
            finite_strain: fit.law,
            shear_modulus_mpa: fit.shear_modulus.pa_to_mpa(),
            misfit: fit.misfit,
            largest_invariant: fit.largest_invariant,
            holds_up_to: limit.is_finite().then_some(limit),
        }
    }

    fn lines(&self) -> String {
        let mut lines = vec![("law", self.finite_strain.name().to_owned())];
        match self.finite_strain {
            Rheology::NeoHookean | Rheology::Linear => {}
            Rheology::Yeoh { c2_over_c1, c3_over_c1 } => {
                lines.push(("c2_over_c1", significant(c2_over_c1)));
                lines.push(("c3_over_c1", significant(c3_over_c1)));
            }
            Rheology::ArrudaBoyce { locking_stretch } => {
                lines.push(("locking_stretch", significant(locking_stretch)));
            }
        }
        lines.push(("shear modulus of the curve", significant(self.shear_modulus_mpa) + " MPa"));
        lines.push(("error of the stress", format!("{:.2} % rms", 100.0 * self.misfit)));
        if let Some(limit) = self.holds_up_to {
            lines.push(("holds up to I1 - 3 =", significant(limit)));
        }
        aligned(&lines)
    }
}

impl Hyperelastic {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let named = |text: String| CliError::input(format!("{}: {text}", self.curve.display()));
        let points = read(&self.curve).map_err(named)?;
        let fits = fit_uniaxial(&points).map_err(|error| {
            CliError::of(error.kind(), format!("{}: {error}", self.curve.display()))
        })?;
        let fitted = fits.each_ref().map(Fitted::new);
        for fit in &fitted {
            if let Some(limit) = fit.holds_up_to.filter(|limit| *limit < fit.largest_invariant) {
                note(
                    quiet,
                    format_args!(
                        "warning: the fitted law of {} holds up to I1 - 3 = {limit:.3} and the curve goes to {:.3}: its \
                         shear stress has a maximum in between; take another law or leave the softest points out",
                        fit.finite_strain.name(),
                        fit.largest_invariant
                    ),
                );
            }
        }
        if self.json {
            return print(&json(&fitted)?);
        }
        let tables: Vec<String> = fitted.iter().map(Fitted::lines).collect();
        print(&tables.join("\n"))
    }
}

/// The points of a file.
fn read(path: &Path) -> Result<Vec<UniaxialPoint>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|error| error.to_string())?;
    let headers = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |names: &[(&str, f64)]| {
        names.iter().find_map(|(name, factor)| {
            headers.iter().position(|header| header == *name).map(|at| (at, *factor))
        })
    };
    let stretch = column(&[("stretch", 0.0), ("strain", 1.0)])
        .ok_or("no column stretch or strain in the first line, which must name the columns")?;
    let stress = column(&[("stress_mpa", 1e6), ("stress_kpa", 1e3), ("stress_pa", 1.0)])
        .ok_or("no column stress_mpa, stress_kpa or stress_pa in the first line")?;
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |at: usize| {
            let text = record.get(at).unwrap_or_default();
            text.parse::<f64>().map_err(|_| format!("line {line}: {text:?} is not a number"))
        };
        points.push(UniaxialPoint {
            stretch: number(stretch.0)? + stretch.1,
            nominal_stress: number(stress.0)? * stress.1,
        });
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Vec<UniaxialPoint>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn columns_are_found_by_name_and_unit() {
        let points =
            read_text("time_s, strain, stress_kpa\n0, 0.5, 700\n1, -0.25, -400\n").unwrap();
        let expected = [(1.5, 7e5), (0.75, -4e5)];
        let expected =
            expected.map(|(stretch, nominal_stress)| UniaxialPoint { stretch, nominal_stress });
        assert_eq!(points, expected);
        let points = read_text("stress_mpa,stretch\n0.7,1.5\n").unwrap();
        assert_eq!(points, [UniaxialPoint { stretch: 1.5, nominal_stress: 7e5 }]);
    }

    #[test]
    fn what_is_missing_is_named() {
        assert!(read_text("a,b\n1,2\n").unwrap_err().contains("no column stretch"));
        assert!(read_text("stretch,stress\n1,2\n").unwrap_err().contains("no column stress_mpa"));
        let error = read_text("stretch,stress_pa\n1.5,1\n2,much\n").unwrap_err();
        assert!(error.contains("line 3") && error.contains("much"), "{error}");
        assert!(read(Path::new("no/such.csv")).is_err());
    }
}
