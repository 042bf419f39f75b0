//! Tables that a rubber takes as they were measured: a master curve as points, and strain sweeps.

use super::layout::{Layout, Wanted};
use super::names::{Quantity, Unit};
use super::rows::Record;
use super::{Located, SAME_SWEEP_K, TableError, TableOptions, problem, read_grids, records};
use asperity_core::rubber::fit::{ModulusKind, SweepPoint};
use asperity_core::rubber::payne::{StrainPoint, StrainSweep};
use std::f64::consts::TAU;
use std::path::Path;

/// Frequencies of one strain sweep differ by no more, relative.
const SAME_FREQUENCY: f64 = 0.02;

/// Largest strain that is stated in parts of one: beyond it the numbers are per cent.
const LARGEST_FRACTION: f64 = 2.0;

/// Unit of strains whose header does not say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrainUnit {
    /// Per cent.
    Percent,
    /// Parts of one.
    Fraction,
}

impl StrainUnit {
    fn name(self) -> &'static str {
        match self {
            Self::Percent => "percent",
            Self::Fraction => "fraction",
        }
    }
}

/// Reads a master curve as its points of Young's modulus in the order of the file, in SI: frequencies may repeat and be out of
/// order. Shear moduli are multiplied by `2 (1 + ν)`.
///
/// # Errors
/// [`TableError`] with the line and what to do; of rows at several temperatures too, which are no master curve, and of a header
/// that names the other modulus.
pub fn read_master_curve(
    path: &Path,
    options: &TableOptions,
    kind: ModulusKind,
    poisson_ratio: f64,
) -> Result<Vec<SweepPoint>, TableError> {
    let grids = read_grids(path, options)?;
    let factor = kind.factor(poisson_ratio);
    let read = || -> Result<Vec<SweepPoint>, Located> {
        let (records, layout, ..) = records(&grids, Wanted::Sweeps, options)?;
        refuse_other_modulus(&layout, kind)?;
        let mut ends: Option<[f64; 2]> = None;
        let mut points = Vec::new();
        for record in &records {
            if let Some(celsius) = record.temperature_c()? {
                let [low, high] = ends.unwrap_or([celsius; 2]);
                let [low, high] = [low.min(celsius), high.max(celsius)];
                if high - low > SAME_SWEEP_K {
                    let text = record.text(Quantity::Temperature);
                    let problem = format!(
                        "the temperature {text} is another one than before: sweeps at several temperatures are no master \
                         curve yet; `asperity rubber fit` shifts them"
                    );
                    return Err((Some(record.line), problem));
                }
                ends = Some([low, high]);
            }
            points.push(record.point(factor)?);
        }
        Ok(points)
    };
    read().map_err(|located| problem(path, located))
}

/// A header with the symbol of the other modulus is off by a factor of three.
fn refuse_other_modulus(layout: &Layout, kind: ModulusKind) -> Result<(), Located> {
    let other = match kind {
        ModulusKind::Youngs => 'G',
        ModulusKind::Shear => 'E',
    };
    let Some(column) = layout.columns.iter().find(|column| column.symbol == Some(other)) else {
        return Ok(());
    };
    let (named, own, right) = match kind {
        ModulusKind::Youngs => {
            ("a shear modulus", "youngs", "\"shear\", E = 2 (1 + nu) G with nu the poisson_ratio")
        }
        ModulusKind::Shear => ("Young's modulus", "shear", "\"youngs\""),
    };
    let name = &column.name;
    Err((
        None,
        format!(
            "the column `{name}` names {named}, and modulus_kind is \"{own}\": write modulus_kind = {right}; if the header is \
             wrong, rename the column to one without a symbol, such as storage_mpa"
        ),
    ))
}

/// Reads strain sweeps: one for each temperature (rows within 0.5 K, at their mean), by ascending temperature. Strains become
/// parts of one; `unit` is for a header that does not state it.
///
/// # Errors
/// [`TableError`] with the line and what to do: also for strains without a unit, and for one temperature at several
/// frequencies.
pub fn read_strain_sweeps(
    path: &Path,
    options: &TableOptions,
    unit: Option<StrainUnit>,
) -> Result<Vec<StrainSweep>, TableError> {
    let grids = read_grids(path, options)?;
    let read = || -> Result<Vec<StrainSweep>, Located> {
        let (records, ..) = records(&grids, Wanted::Strains, options)?;
        let rows = records.iter().map(|record| row(record, unit));
        let mut rows: Vec<Row> = rows.collect::<Result<_, Located>>()?;
        if rows.is_empty() {
            return Err((None, "there are no rows below the header: export the points".into()));
        }
        let temperature = |row: &Row| row.temperature_c.unwrap_or(0.0);
        rows.sort_by(|a, b| temperature(a).total_cmp(&temperature(b)));
        let same = |a: &Row, b: &Row| temperature(b) - temperature(a) <= SAME_SWEEP_K;
        rows.chunk_by(same).map(sweep).collect()
    };
    read().map_err(|located| problem(path, located))
}

struct Row {
    line: u64,
    temperature_c: Option<f64>,
    frequency_hz: Option<f64>,
    point: StrainPoint,
}

fn row(record: &Record, unit: Option<StrainUnit>) -> Result<Row, Located> {
    let strain = strain(record, unit)?;
    let [storage_modulus, loss_modulus] = record.moduli()?;
    Ok(Row {
        line: record.line,
        temperature_c: record.temperature_c()?,
        frequency_hz: record.angular_frequency()?.map(|frequency| frequency / TAU),
        point: StrainPoint { strain, storage_modulus, loss_modulus },
    })
}

/// The strain of a row in parts of one.
fn strain(record: &Record, stated: Option<StrainUnit>) -> Result<f64, Located> {
    let (in_header, strain) = record.strain()?;
    let in_header = in_header.map(|unit| match unit {
        Unit::Percent => StrainUnit::Percent,
        _ => StrainUnit::Fraction,
    });
    let name = record.name(Quantity::Strain);
    if let (Some(own), Some(stated)) = (in_header, stated)
        && own != stated
    {
        let problem = format!(
            "the column `{name}` is in {}, and strain_unit (--strain-unit) says {}: leave it out, or correct the header",
            own.name(),
            stated.name()
        );
        return Err((None, problem));
    }
    match in_header.or(stated) {
        Some(StrainUnit::Percent) => Ok(0.01 * strain),
        Some(StrainUnit::Fraction) if strain > LARGEST_FRACTION => {
            let text = record.text(Quantity::Strain);
            let problem = format!(
                "the strain {text} as a fraction is {:.0} %: if `{name}` is in per cent, name the column strain_percent, or \
                 say strain_unit = \"percent\" in a rubber file, --strain-unit percent in the command",
                100.0 * strain
            );
            Err((Some(record.line), problem))
        }
        Some(StrainUnit::Fraction) => Ok(strain),
        None => {
            let problem = "the column of the strain has no unit, and units are never guessed: name it strain_percent or \
                           strain_fraction, or say which (strain_unit in a rubber file, --strain-unit)";
            Err((None, problem.into()))
        }
    }
}

fn sweep(rows: &[Row]) -> Result<StrainSweep, Located> {
    let first = &rows[0];
    let other = rows.iter().find(|row| {
        let pair = row.frequency_hz.zip(first.frequency_hz);
        pair.is_some_and(|(a, b)| (a / b - 1.0).abs() > SAME_FREQUENCY)
    });
    if let Some(other) = other {
        let [a, b] = [first, other].map(|row| row.frequency_hz.unwrap_or_default());
        let problem = format!(
            "the sweep is at {a} and at {b} Hz: keep the rows of one frequency, softening with strain is taken to be the \
             same at all"
        );
        return Err((Some(other.line), problem));
    }
    let sum: Option<f64> = rows.iter().map(|row| row.temperature_c).sum();
    Ok(StrainSweep {
        temperature_c: sum.map(|sum| (1e3 * sum / rows.len() as f64).round() / 1e3),
        frequency_hz: first.frequency_hz,
        points: rows.iter().map(|row| row.point).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.txt");
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn a_master_curve_is_read_as_it_is() {
        let text = "frequency_hz,storage_mpa,loss_mpa\n10,5,1\n1,4,0.5\n10,6,1.2\n";
        let (_folder, path) = file(text);
        let read = |path: &Path, kind| read_master_curve(path, &TableOptions::default(), kind, 0.5);
        let points = read(&path, ModulusKind::Shear).unwrap();
        assert_eq!(points.len(), 3);
        assert_eq!(points[1].storage_modulus, 12e6);
        assert_eq!(points[2].angular_frequency, 10.0 * TAU);
        let sweeps = "frequency_hz,storage_mpa,loss_mpa,temperature_c\n1,5,1,20\n1,4,0.5,30\n";
        let (_folder, path) = file(sweeps);
        let error = read(&path, ModulusKind::Youngs).unwrap_err();
        assert!(error.to_string().contains("line 3: the temperature 30"), "{error}");
        let (_folder, path) = file("f/Hz,G'/MPa,G''/MPa\n1,5,1\n10,6,1.2\n");
        assert_eq!(read(&path, ModulusKind::Shear).unwrap()[0].storage_modulus, 15e6);
        let error = read(&path, ModulusKind::Youngs).unwrap_err().to_string();
        assert!(error.contains("`G'/MPa` names a shear modulus"), "{error}");
        assert!(error.contains("modulus_kind = \"shear\""), "{error}");
        let (_folder, path) = file("f/Hz,E'/MPa,E''/MPa\n1,5,1\n10,6,1.2\n");
        assert!(read(&path, ModulusKind::Youngs).is_ok());
        assert!(read(&path, ModulusKind::Shear).is_err());
    }

    #[test]
    fn strain_sweeps_are_read_with_their_unit() {
        let read = |text: &str, unit| {
            let (_folder, path) = file(text);
            let sweeps = read_strain_sweeps(&path, &TableOptions::default(), unit);
            sweeps.map_err(|error| error.to_string())
        };
        let rows = "0.1,5,1,20\n1,4,0.9,20.1\n0.1,3,0.5,50\n1,2,0.4,50\n";
        let sweeps =
            read(&format!("strain_percent,storage_mpa,loss_mpa,temperature_c\n{rows}"), None);
        let sweeps = sweeps.unwrap();
        assert_eq!(sweeps.len(), 2);
        assert_eq!((sweeps[0].temperature_c, sweeps[0].points[0].strain), (Some(20.05), 1e-3));
        let bare = format!(
            "# strain storage_mpa loss_mpa temperature_c  (a remark of five words)\n{}",
            rows.replace(',', " ")
        );
        assert!(read(&bare, None).unwrap_err().contains("strain_unit"));
        assert_eq!(read(&bare, Some(StrainUnit::Percent)).unwrap(), sweeps);
        let fraction = read(&bare, Some(StrainUnit::Fraction)).unwrap();
        assert_eq!(fraction[1].points[1].strain, 1.0);
        let two = "strain_percent,storage_mpa,loss_mpa,frequency_hz\n0.1,5,1,1\n1,4,0.9,10\n";
        assert!(read(two, None).unwrap_err().contains("line 3: the sweep is at 1 and at 10 Hz"));
        // 150 % typed as 150 in a column of fractions, and a header that says otherwise than the option.
        let large = "strain_fraction,storage_mpa,loss_mpa\n0.1,5,1\n150,4,0.9\n";
        let refused = read(large, None).unwrap_err();
        assert!(refused.contains("line 3: the strain 150 as a fraction is 15000 %"), "{refused}");
        assert!(refused.contains("strain_percent") && refused.contains("--strain-unit percent"));
        assert!(read("strain,storage_mpa,loss_mpa\n3,5,1\n", Some(StrainUnit::Fraction)).is_err());
        assert!(read(&large.replace("fraction", "percent"), None).is_ok());
        let refused = read(&large.replace("150", "1.5"), Some(StrainUnit::Percent)).unwrap_err();
        assert!(
            refused.contains("is in fraction") && refused.contains("says percent"),
            "{refused}"
        );
        let negative = "strain_percent,storage_mpa,loss_mpa\n-0.1,5,1\n";
        assert!(read(negative, None).unwrap_err().contains("strain_percent is -0.1"));
    }
}
