//! Friction tables for other programs: all digits, every realisation.

use crate::artifact::{ArtifactError, ExportTable, Values};
use crate::stages::tables::FrictionRow;

/// Rows as one long table with all digits, a column per realisation.
///
/// # Errors
/// [`ArtifactError::NotRepresentable`] if Arrow refuses the columns.
pub fn long_table(rows: &[FrictionRow]) -> Result<ExportTable, ArtifactError> {
    let optional = |name: &str, value: &dyn Fn(&FrictionRow) -> Option<f64>| {
        (name.to_owned(), Values::Float(rows.iter().map(value).collect()))
    };
    let column =
        |name: &str, value: fn(&FrictionRow) -> f64| optional(name, &|row| Some(value(row)));
    let count = |name: &str, value: fn(&FrictionRow) -> Option<u32>| {
        (name.to_owned(), Values::Count(rows.iter().map(value).collect()))
    };
    let models = rows.iter().map(|row| row.model.to_string()).collect();
    let methods = rows.iter().map(|row| row.kind.method.to_string()).collect();
    let given = rows.iter().map(|row| row.given.name().to_owned()).collect();
    let mut columns = vec![
        ("model".to_owned(), Values::Text(models)),
        ("method".to_owned(), Values::Text(methods)),
        count("waves", |row| Some(row.kind.waves)),
        column("speed_mm_s", |row| row.speed_mm_s),
        ("given".to_owned(), Values::Text(given)),
        column("contact_area_fraction", |row| row.contact_area_fraction),
        column("pressure_mpa", |row| row.pressure_mpa),
        column("shortest_wavelength_mm", |row| row.shortest_wavelength_mm),
        count("windows", |row| Some(row.windows)),
    ];
    let most = rows.iter().map(|row| row.realisations.len()).max().unwrap_or(0);
    for k in 0..most {
        let name = format!("realisation_{}", k + 1);
        columns.push(optional(&name, &|row| row.realisations.get(k).copied()));
    }
    columns.extend([
        count("half_space_realisations", |row| row.half_space_realisations),
        column("mean", |row| row.mean),
        optional("standard_deviation", &|row| row.standard_deviation),
        optional("confidence_95", &|row| row.confidence_95),
        optional("scan_error", &|row| row.scan_error),
        column("interpolation_error", |row| row.interpolation_error),
        optional("discretisation_error", &|row| row.discretisation_error),
        column("left_out_error", |row| row.left_out_error),
        optional("microscale_error", &|row| row.microscale_error),
        optional("model_error", &|row| row.model_error),
        optional("error_estimate", &|row| row.error_estimate),
    ]);
    ExportTable::new(columns)
}

/// Rows as a table with one value of one realisation in each row.
///
/// # Errors
/// [`ArtifactError::NotRepresentable`] if Arrow refuses the columns.
pub fn values_table(rows: &[FrictionRow]) -> Result<ExportTable, ArtifactError> {
    let values: Vec<(&FrictionRow, u32, f64)> = rows
        .iter()
        .flat_map(|row| (1..).zip(&row.realisations).map(move |(k, friction)| (row, k, *friction)))
        .collect();
    let text = |value: fn(&FrictionRow) -> String| {
        Values::Text(values.iter().map(|(row, ..)| value(row)).collect())
    };
    let number = |value: fn(&FrictionRow) -> f64| {
        Values::Float(values.iter().map(|(row, ..)| Some(value(row))).collect())
    };
    ExportTable::new(vec![
        ("model".to_owned(), text(|row| row.model.to_string())),
        ("method".to_owned(), text(|row| row.kind.method.to_string())),
        (
            "waves".to_owned(),
            Values::Count(values.iter().map(|(row, ..)| Some(row.kind.waves)).collect()),
        ),
        ("speed_mm_s".to_owned(), number(|row| row.speed_mm_s)),
        ("given".to_owned(), text(|row| row.given.name().to_owned())),
        ("contact_area_fraction".to_owned(), number(|row| row.contact_area_fraction)),
        ("pressure_mpa".to_owned(), number(|row| row.pressure_mpa)),
        ("shortest_wavelength_mm".to_owned(), number(|row| row.shortest_wavelength_mm)),
        (
            "realisation".to_owned(),
            Values::Count(values.iter().map(|(_, k, _)| Some(*k)).collect()),
        ),
        (
            "friction_coefficient".to_owned(),
            Values::Float(values.iter().map(|(.., f)| Some(*f)).collect()),
        ),
    ])
}
