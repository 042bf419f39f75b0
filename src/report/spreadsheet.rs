//! Friction tables as a workbook.

use super::{About, FrictionTable};
use crate::stages::tables::{EffectRow, TotalRow};
use crate::text::visible_line;
use rust_xlsxwriter::{Format, Workbook, Worksheet, XlsxError};

/// Longest name of a sheet.
const LONGEST_NAME: usize = 31;
/// Most characters of a cell.
const LONGEST_CELL: usize = 32_000;
const FRICTION_COLUMNS: [&str; 12] = [
    "contact area fraction",
    "average",
    "standard deviation",
    "95 % of the mean",
    "scan error",
    "interpolation error",
    "grid error",
    "left-out error",
    "microscale error",
    "model error",
    "sum of errors",
    "mean pressure / MPa",
];
const TOTAL_COLUMNS: [&str; 14] = [
    "model",
    "surfaces",
    "speed / (mm/s)",
    "given",
    "contact area fraction",
    "mean pressure / MPa",
    "shortest wavelength / mm",
    "temperature / °C",
    "shear stress / MPa",
    "hysteretic",
    "adhesive",
    "total",
    "95 % of the total",
    "sum of errors of the total",
];
const EFFECT_COLUMNS: [&str; 14] = [
    "surfaces",
    "effect",
    "speed / (mm/s)",
    "mean pressure / MPa",
    "shortest wavelength / mm",
    "contact area fraction",
    "hysteretic",
    "95 % of the hysteretic",
    "grid error of the hysteretic",
    "grid error of the area, relative",
    "adhesive",
    "total",
    "sum of errors",
    "rise of the contact / K",
];

/// A table before it is written.
struct Sheet {
    name: String,
    caption: String,
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

enum Cell {
    Text(String),
    Number(f64),
    Empty,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Empty, Self::Number)
    }
}

/// A workbook with a sheet for each table: the caption, the names of the columns, and all digits of the
/// numbers, every realisation in a column of its own. Missing numbers are empty cells. Total friction, and
/// friction with heat and softening, have a sheet each where there are rows.
///
/// # Errors
/// [`XlsxError`] if the tables do not fit into a workbook.
pub fn workbook(
    tables: &[FrictionTable],
    totals: &[TotalRow],
    effects: &[EffectRow],
    about: &About,
) -> Result<Vec<u8>, XlsxError> {
    let friction = (1..).zip(tables).map(|(number, table)| friction_sheet(number, table, about));
    let total = (!totals.is_empty()).then(|| total_sheet(totals, about));
    let effect = (!effects.is_empty()).then(|| effect_sheet(effects, about));
    let mut workbook = Workbook::new();
    for sheet in friction.chain(total).chain(effect) {
        fill(workbook.add_worksheet().set_name(&sheet.name)?, &sheet)?;
    }
    workbook.save_to_buffer()
}

fn friction_sheet(number: usize, table: &FrictionTable, about: &About) -> Sheet {
    // Names must differ within their length and have no slash.
    let (model, kind, speed) = (&table.model, table.kind, table.speed_mm_s);
    let name = format!("{number} {model} {kind} {speed} mm per s");
    let rows = table.rows.iter().map(|row| {
        let numbers: [Cell; FRICTION_COLUMNS.len()] = [
            row.contact_area_fraction.into(),
            row.mean.into(),
            row.standard_deviation.into(),
            row.confidence_95.into(),
            row.scan_error.into(),
            row.interpolation_error.into(),
            row.discretisation_error.into(),
            row.left_out_error.into(),
            row.microscale_error.into(),
            row.model_error.into(),
            row.error_estimate.into(),
            row.pressure_mpa.into(),
        ];
        numbers.into_iter().chain(row.realisations.iter().map(|friction| (*friction).into()))
    });
    let realisations = table.rows.first().map_or(0, |row| row.realisations.len());
    Sheet {
        name: name.chars().take(LONGEST_NAME).collect(),
        caption: table.caption(about),
        columns: with_realisations(&FRICTION_COLUMNS, realisations),
        rows: rows.map(Iterator::collect).collect(),
    }
}

fn total_sheet(totals: &[TotalRow], about: &About) -> Sheet {
    let rows = totals.iter().map(|row| {
        let cells: [Cell; TOTAL_COLUMNS.len()] = [
            Cell::Text(row.model.to_string()),
            Cell::Text(row.kind.to_string()),
            row.speed_mm_s.into(),
            Cell::Text(row.given.name().into()),
            row.contact_area_fraction.into(),
            row.pressure_mpa.into(),
            row.shortest_wavelength_mm.into(),
            row.temperature_c.into(),
            row.shear_mpa.into(),
            row.hysteretic.into(),
            row.adhesive.into(),
            row.total.into(),
            row.confidence_95.into(),
            row.error_estimate.into(),
        ];
        Vec::from(cells)
    });
    Sheet {
        name: "total friction".into(),
        caption: format!(
            "Hysteretic, adhesive and total friction coefficient, shear stress for waves down to {} mm, {}, asperity {}",
            totals[0].fitted_wavelength_mm,
            about.material(),
            crate::artifact::TOOL_VERSION
        ),
        columns: with_realisations(&TOTAL_COLUMNS, 0),
        rows: rows.collect(),
    }
}

fn effect_sheet(effects: &[EffectRow], about: &About) -> Sheet {
    let rows = effects.iter().map(|row| {
        let cells: [Cell; EFFECT_COLUMNS.len()] = [
            Cell::Text(row.kind.to_string()),
            Cell::Text(row.effect.to_string()),
            row.speed_mm_s.into(),
            row.pressure_mpa.into(),
            row.shortest_wavelength_mm.into(),
            row.contact_area_fraction.into(),
            row.hysteretic.into(),
            row.confidence_95.into(),
            row.discretisation_error.into(),
            row.relative_area_error.into(),
            row.adhesive.into(),
            row.total.into(),
            row.error_estimate.into(),
            row.contact_rise_k.into(),
        ];
        cells.into_iter().chain(row.realisations.iter().map(|friction| (*friction).into()))
    });
    let realisations = effects.iter().map(|row| row.realisations.len()).max().unwrap_or(0);
    Sheet {
        name: "heat and softening".into(),
        caption: format!(
            "Friction coefficient of the half-space cold, softened by strain (soft), heated (hot) and both, {}, asperity {}",
            about.material(),
            crate::artifact::TOOL_VERSION
        ),
        columns: with_realisations(&EFFECT_COLUMNS, realisations),
        rows: rows.map(Iterator::collect).collect(),
    }
}

fn with_realisations(columns: &[&str], realisations: usize) -> Vec<String> {
    let own = columns.iter().map(|column| (*column).to_owned());
    own.chain((1..=realisations).map(|k| format!("realisation {k}"))).collect()
}

fn fill(page: &mut Worksheet, sheet: &Sheet) -> Result<(), XlsxError> {
    let bold = Format::new().set_bold();
    // Written as a string, so that no name is a formula.
    let caption: String = visible_line(&sheet.caption).chars().take(LONGEST_CELL).collect();
    page.write_string_with_format(0, 0, caption, &bold)?;
    for (column, name) in (0..).zip(&sheet.columns) {
        page.write_string_with_format(2, column, name, &bold)?;
    }
    for (line, row) in (3..).zip(&sheet.rows) {
        for (column, cell) in (0..).zip(row) {
            match cell {
                Cell::Text(text) => page.write_string(line, column, text)?,
                Cell::Number(number) => page.write_number(line, column, *number)?,
                Cell::Empty => page,
            };
        }
    }
    page.set_column_width(0, 22)?;
    page.set_freeze_panes(3, 1)?;
    Ok(())
}
