//! The measured rows of a rubber file, in it or in files beside it.

use super::entry::{
    KindEntry, LawEntry, PayneEntry, RubberFile, StrainEntry, StrainUnitEntry, TemperatureEntry,
};
use super::error::RubberFileError;
use super::payne::{Kraus, Payne, PayneCurve, PayneError, PayneTable, elongation_of_shear};
use super::{Cleaned, MeasuredModuli, RubberError, ShiftLaw, ShiftTable, TemperatureDependence};
use crate::units::Units;
use asperity_core::rubber::fit::{GivenShift, ModulusKind, SweepPoint};
use asperity_scans::sweeps::{
    DescribedColumn, StrainUnit, TableOptions, read_master_curve, read_shift_factors,
    read_strain_sweeps, strain_doubts,
};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// A reference temperature may differ from that of a table of shift factors by so many decades: some 0.5 K.
const SAME_REFERENCE: f64 = 0.05;

/// A file named by a rubber file: beside it unless its path is absolute.
fn beside(path: &Path, named: &str) -> PathBuf {
    path.parent().map_or_else(|| PathBuf::from(named), |folder| folder.join(named))
}

fn keys(path: &Path, problem: impl Into<String>) -> RubberFileError {
    RubberFileError::Keys { path: path.to_path_buf(), problem: problem.into() }
}

/// The table of moduli, and what reading it changed.
pub(super) fn moduli(
    path: &Path,
    file: &RubberFile,
) -> Result<(MeasuredModuli, Vec<String>), RubberFileError> {
    let kind = match file.modulus_kind {
        Some(KindEntry::Youngs) => ModulusKind::Youngs,
        Some(KindEntry::Shear) => ModulusKind::Shear,
        None => {
            return Err(keys(
                path,
                "modulus_kind is missing: write \"youngs\" or \"shear\", whichever the table holds; it is never guessed, \
                 a mistake is a factor of three",
            ));
        }
    };
    let ratio = file.poisson_ratio;
    let factor = kind.factor(ratio);
    let rows = match &file.master_curve {
        Some(named) => {
            let options = TableOptions { columns: columns(path, file)?, ..TableOptions::default() };
            read_master_curve(&beside(path, named), &options, kind, ratio).map_err(|source| {
                RubberFileError::Table { path: path.to_path_buf(), key: "master_curve", source }
            })?
        }
        None => {
            let point = |row: &super::entry::ModuliEntry| SweepPoint {
                angular_frequency: TAU * row.frequency_hz,
                storage_modulus: row.storage_mpa.mpa_to_pa() * factor,
                loss_modulus: row.loss_mpa.mpa_to_pa() * factor,
            };
            file.moduli.iter().map(point).collect()
        }
    };
    let Cleaned { points, notes } = Cleaned::new(&rows, file.points_per_decade);
    let table = MeasuredModuli::new(&file.name, file.poisson_ratio, &points)
        .map_err(|source| invalid(path, source))?;
    Ok((table.with_extrapolation(file.extrapolate.unwrap_or_default()), notes))
}

pub(super) fn invalid(path: &Path, source: RubberError) -> RubberFileError {
    RubberFileError::Invalid { path: path.to_path_buf(), source }
}

fn columns(path: &Path, file: &RubberFile) -> Result<Vec<DescribedColumn>, RubberFileError> {
    let described = file.columns.as_deref().unwrap_or_default();
    let entries = described.split(',').filter(|entry| !entry.trim().is_empty());
    let parsed = entries.map(|entry| entry.trim().parse::<DescribedColumn>());
    parsed.collect::<Result<_, _>>().map_err(|problem| keys(path, format!("columns: {problem}")))
}

/// The dependence on temperature.
pub(super) fn dependence(
    path: &Path,
    entry: &TemperatureEntry,
) -> Result<TemperatureDependence, RubberFileError> {
    let temperature = |source| RubberFileError::Temperature { path: path.to_path_buf(), source };
    let measured = measured_factors(path, entry)?;
    let wlf = entry.wlf.as_ref().map(|wlf| ShiftLaw::Wlf { c1: wlf.c1, c2_k: wlf.c2_k });
    let arrhenius = entry
        .arrhenius
        .as_ref()
        .map(|law| ShiftLaw::Arrhenius { activation_energy_kj_mol: law.activation_energy_kj_mol });
    let tables = measured.len();
    let measured: Vec<ShiftTable> = measured
        .iter()
        .map(|rows| ShiftTable::new(rows))
        .collect::<Result<_, _>>()
        .map_err(temperature)?;
    let found = usize::from(wlf.is_some()) + usize::from(arrhenius.is_some()) + tables;
    let table = measured.into_iter().next();
    let laws = RubberFileError::Laws { path: path.to_path_buf(), found };
    if found != 1 {
        return Err(laws);
    }
    let reference_c = reference(path, entry, table.as_ref())?;
    let mut measured_c = entry.measured_c;
    if let (None, Some(table)) = (measured_c, &table) {
        measured_c = Some(table.measured_c());
    }
    let law = wlf.or(arrhenius).or(table.map(ShiftLaw::Table)).ok_or(laws)?;
    let dependence =
        TemperatureDependence { reference_c, law, measured_c, vertical: entry.vertical };
    dependence.validate().map_err(temperature)?;
    Ok(dependence)
}

/// Tables of measured factors: the one of a file, the one in the section.
fn measured_factors(
    path: &Path,
    entry: &TemperatureEntry,
) -> Result<Vec<Vec<GivenShift>>, RubberFileError> {
    let mut tables = Vec::new();
    if let Some(named) = &entry.shift_factors {
        tables.push(read_shift_factors(&beside(path, named)).map_err(|source| {
            let key = "temperature.shift_factors";
            RubberFileError::Table { path: path.to_path_buf(), key, source }
        })?);
    }
    if !entry.shift.is_empty() {
        let rows = entry.shift.iter().map(|row| GivenShift {
            temperature_c: row.temperature_c,
            log10_shift: row.log10_shift,
        });
        tables.push(rows.collect());
    }
    Ok(tables)
}

/// The reference temperature: as stated, or that at which a table has the factor 1.
fn reference(
    path: &Path,
    entry: &TemperatureEntry,
    table: Option<&ShiftTable>,
) -> Result<f64, RubberFileError> {
    match (entry.reference_c, table) {
        (Some(reference_c), Some(table)) => {
            table.require(reference_c).map_err(|source| RubberFileError::Temperature {
                path: path.to_path_buf(),
                source,
            })?;
            let off = table.own_log10_shift(reference_c);
            if off.abs() > SAME_REFERENCE {
                let one = table.reference_c().map_or(String::new(), |at| format!(", it is 1 at {at} °C"));
                return Err(keys(
                    path,
                    format!(
                        "temperature.reference_c is {reference_c}, where the table of shift factors has 10^{off:.3} and not \
                         1{one}: moduli and factors need one reference"
                    ),
                ));
            }
            Ok(reference_c)
        }
        (Some(reference_c), None) => Ok(reference_c),
        (None, Some(table)) => table.reference_c().ok_or_else(|| {
            keys(
                path,
                "temperature.reference_c is missing and no shift factor is 1: give the temperature of the moduli in °C",
            )
        }),
        (None, None) => Err(keys(
            path,
            "temperature.reference_c is missing: give the temperature of the moduli in °C",
        )),
    }
}

/// How the rubber softens with strain, and what reading it changed.
pub(super) fn payne(
    path: &Path,
    entry: &PayneEntry,
) -> Result<(Payne, Vec<String>), RubberFileError> {
    let stated = [entry.strain_sweep.is_some(), !entry.kraus.is_empty(), !entry.table.is_empty()];
    if stated.iter().filter(|stated| **stated).count() != 1 {
        return Err(keys(
            path,
            "[payne] must have one of strain_sweep = \"FILE\", [[payne.kraus]] and [[payne.table]]",
        ));
    }
    let of_file = [("strain_unit", entry.strain_unit.is_some()), ("law", entry.law.is_some())];
    if let (None, Some((key, _))) = (&entry.strain_sweep, of_file.iter().find(|(_, there)| *there))
    {
        return Err(keys(path, format!("payne.{key} is for payne.strain_sweep: leave it out")));
    }
    let mut notes = Vec::new();
    let curves = match &entry.strain_sweep {
        Some(named) => swept(path, named, entry, &mut notes)?,
        None => inline(path, entry)?,
    };
    let payne = Payne::new(curves).map_err(|source| in_payne(path, source))?;
    Ok((payne, notes))
}

fn in_payne(path: &Path, source: PayneError) -> RubberFileError {
    RubberFileError::Payne { path: path.to_path_buf(), source }
}

type Curves = Vec<(Option<f64>, PayneCurve)>;

/// Strains of a kind as elongation.
fn elongation(kind: StrainEntry, strain: f64) -> f64 {
    match kind {
        StrainEntry::Elongation => strain,
        StrainEntry::Shear => elongation_of_shear(strain),
    }
}

fn swept(
    path: &Path,
    named: &str,
    entry: &PayneEntry,
    notes: &mut Vec<String>,
) -> Result<Curves, RubberFileError> {
    let unit = entry.strain_unit.map(|unit| match unit {
        StrainUnitEntry::Percent => StrainUnit::Percent,
        StrainUnitEntry::Fraction => StrainUnit::Fraction,
    });
    let sweeps = read_strain_sweeps(&beside(path, named), &TableOptions::default(), unit);
    let mut sweeps = sweeps.map_err(|source| {
        let key = "payne.strain_sweep";
        RubberFileError::Table { path: path.to_path_buf(), key, source }
    })?;
    notes.extend(strain_doubts(&sweeps).into_iter().map(|doubt| format!("{named}: {doubt}")));
    let mut left_out = 0;
    let mut curves = Vec::new();
    for sweep in &mut sweeps {
        for point in &mut sweep.points {
            point.strain = elongation(entry.strain_kind, point.strain);
        }
        let fitted = match entry.law.unwrap_or(LawEntry::Table) {
            LawEntry::Table => PayneTable::fit(sweep).map(|fit| {
                left_out += fit.left_out.len();
                PayneCurve::Table(fit.table)
            }),
            LawEntry::Kraus => Kraus::fit(sweep).map(|fit| {
                left_out += fit.left_out.len();
                PayneCurve::Kraus(fit.law)
            }),
        };
        let curve = fitted.map_err(|source| in_payne(path, source))?;
        curves.push((sweep.temperature_c, curve));
    }
    if left_out > 0 {
        notes.push(format!(
            "{left_out} points of the strain sweeps lie off their neighbours and are left out"
        ));
    }
    Ok(curves)
}

fn inline(path: &Path, entry: &PayneEntry) -> Result<Curves, RubberFileError> {
    let kind = entry.strain_kind;
    let kraus = entry.kraus.iter().map(|row| {
        let law = Kraus {
            critical_strain: elongation(kind, row.critical_strain),
            exponent: row.exponent,
            storage_limit: row.storage_limit,
            loss_limit: row.loss_limit,
            loss_peak: row.loss_peak,
            highest_strain: elongation(kind, row.highest_strain),
        };
        Ok((row.temperature_c, PayneCurve::Kraus(law)))
    });
    let table = entry.table.iter().map(|row| {
        let strain: Vec<f64> = row.strain.iter().map(|strain| elongation(kind, *strain)).collect();
        PayneTable::new(row.temperature_c, &strain, &row.storage_factor, &row.loss_factor)
            .map(|table| (row.temperature_c, PayneCurve::Table(table)))
            .map_err(|source| in_payne(path, source))
    });
    kraus.chain(table).collect()
}
