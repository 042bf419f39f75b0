//! Friction tables as a workbook.

use super::{About, FrictionTable};
use crate::text::visible_line;
use rust_xlsxwriter::{Format, Workbook, Worksheet, XlsxError};

/// Longest name of a sheet.
const LONGEST_NAME: usize = 31;
/// Most characters of a cell.
const LONGEST_CELL: usize = 32_000;

/// A workbook with a sheet for each table: the caption, the names of the columns, and all digits of the
/// numbers, every realisation in a column of its own. Cells stay empty where there is no number.
///
/// # Errors
/// [`XlsxError`] if the tables do not fit into a workbook.
pub fn workbook(tables: &[FrictionTable], about: &About) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    for (number, table) in (1..).zip(tables) {
        // Names must differ within their length and have no slash.
        let (model, kind, speed) = (&table.model, table.kind, table.speed_mm_s);
        let name = format!("{number} {model} {kind} {speed} mm per s");
        let name: String = name.chars().take(LONGEST_NAME).collect();
        fill(workbook.add_worksheet().set_name(name)?, table, about)?;
    }
    workbook.save_to_buffer()
}

fn fill(sheet: &mut Worksheet, table: &FrictionTable, about: &About) -> Result<(), XlsxError> {
    let bold = Format::new().set_bold();
    // Written as a string, so that no name is a formula.
    let caption =
        visible_line(&table.caption(about)).chars().take(LONGEST_CELL).collect::<String>();
    sheet.write_string_with_format(0, 0, caption, &bold)?;
    let realisations = table.rows.first().map_or(0, |row| row.realisations.len());
    let names = ["contact area fraction", "average", "standard deviation", "95 % of the mean"]
        .into_iter()
        .chain([
            "scan error",
            "interpolation error",
            "grid error",
            "left-out error",
            "microscale error",
            "model error",
        ])
        .chain(["sum of errors"])
        .chain(["mean pressure / MPa"])
        .map(str::to_owned)
        .chain((1..=realisations).map(|k| format!("realisation {k}")));
    for (column, name) in (0..).zip(names) {
        sheet.write_with_format(2, column, name, &bold)?;
    }
    for (line, row) in (3..).zip(&table.rows) {
        let numbers = [
            Some(row.contact_area_fraction),
            Some(row.mean),
            row.standard_deviation,
            row.confidence_95,
            row.scan_error,
            Some(row.interpolation_error),
            row.discretisation_error,
            Some(row.left_out_error),
            row.microscale_error,
            row.model_error,
            row.error_estimate,
            Some(row.pressure_mpa),
        ];
        let all = numbers.into_iter().chain(row.realisations.iter().copied().map(Some));
        for (column, number) in (0..).zip(all) {
            if let Some(number) = number {
                sheet.write_number(line, column, number)?;
            }
        }
    }
    sheet.set_column_width(0, 22)?;
    sheet.set_freeze_panes(3, 1)?;
    Ok(())
}
