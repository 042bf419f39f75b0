//! A file as rows of cells: text with one of several separators, or a sheet of a workbook.

use super::{TableOptions, read_limited};
use crate::cells::{lines, split_cells};
use crate::description::Separator;
use crate::text_shape::encoding::decode;
use calamine::{Data, Reader, Xlsx};
use std::io::Cursor;
use std::path::Path;

/// What a workbook may hold uncompressed, in bytes.
const LARGEST_SHEETS: u64 = 256 << 20;
/// Separators in the order in which they are tried.
const SEPARATORS: [Separator; 4] =
    [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Whitespace];

/// A line of text or a row of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// The first is 1.
    pub line: u64,
    /// Whether it starts with `#`.
    pub comment: bool,
    pub cells: Vec<String>,
}

/// One way to see a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// The separator of a text, the name of a sheet.
    pub seen_as: String,
    /// Whether any run of blanks separates cells, so that names may be split.
    pub blanks: bool,
    pub rows: Vec<Row>,
}

/// The ways in which a file may be seen, the likelier first.
///
/// # Errors
/// What cannot be read and what to do.
pub(super) fn grids(path: &Path, options: &TableOptions) -> Result<Vec<Grid>, GridError> {
    let bytes = read_limited(path).map_err(GridError::Unreadable)?;
    if bytes.starts_with(b"PK\x03\x04") {
        return sheets(bytes, options.sheet.as_deref()).map_err(GridError::Problem);
    }
    if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) {
        return Err(GridError::Problem(
            "it is a workbook of the old kind (.xls): save it as .xlsx or as CSV".into(),
        ));
    }
    if let Some(sheet) = &options.sheet {
        return Err(GridError::Problem(format!(
            "--sheet is `{sheet}`, but the file is text and has no sheets: leave it out"
        )));
    }
    let (_, text) = decode(&bytes);
    if text.contains('\0') {
        let problem =
            "it is neither text nor an .xlsx workbook: export the sweeps as text or .xlsx";
        return Err(GridError::Problem(problem.into()));
    }
    Ok(of_text(&text, options.separator))
}

/// Why a file has no rows.
pub(super) enum GridError {
    Unreadable(std::io::Error),
    Problem(String),
}

/// A text by the separator, or by each that may be meant.
pub(super) fn of_text(text: &str, separator: Option<Separator>) -> Vec<Grid> {
    let grid = |separator: Separator| {
        let rows = lines(text.trim_start_matches('\u{feff}')).into_iter().zip(1_u64..);
        let rows = rows.filter(|(line, _)| !line.trim().is_empty());
        Grid {
            seen_as: match separator {
                Separator::Tab => "tab".into(),
                Separator::Comma => "comma".into(),
                Separator::Semicolon => "semicolon".into(),
                Separator::Whitespace => "blanks".into(),
                Separator::Character(character) => format!("`{character}`"),
            },
            blanks: separator == Separator::Whitespace,
            rows: rows.map(|(text, line)| row(text, line, separator)).collect(),
        }
    };
    match separator {
        Some(separator) => vec![grid(separator)],
        None => SEPARATORS.map(grid).into(),
    }
}

fn row(text: &str, line: u64, separator: Separator) -> Row {
    let comment = text.trim_start().starts_with('#');
    let cells = match separator.character() {
        None => {
            let text = if comment { without_remark(text) } else { text };
            text.trim_start_matches([' ', '#']).split_whitespace().map(str::to_owned).collect()
        }
        Some(character) => split_cells(text.trim_end_matches('\r'), character),
    };
    Row { line, comment, cells }
}

/// A header without the remark in parentheses at its end, whose words are not names of columns; a unit has at
/// most two words.
fn without_remark(text: &str) -> &str {
    let inner = text.trim_end().strip_suffix(')').and_then(|text| text.rsplit_once(" ("));
    match inner {
        Some((names, remark)) if remark.split_whitespace().count() > 2 => names,
        _ => text,
    }
}

/// The sheets of a workbook, or the one of a name.
fn sheets(bytes: Vec<u8>, wanted: Option<&str>) -> Result<Vec<Grid>, String> {
    let broken = |error: &dyn std::fmt::Display| {
        format!("it cannot be read as an .xlsx workbook ({error}): save it again, or as CSV")
    };
    let mut archive = zip::ZipArchive::new(Cursor::new(&bytes)).map_err(|error| broken(&error))?;
    let mut size = 0_u64;
    for k in 0..archive.len() {
        size += archive.by_index_raw(k).map_err(|error| broken(&error))?.size();
    }
    if size > LARGEST_SHEETS {
        let mega = size / 1_000_000;
        return Err(format!(
            "the workbook holds {mega} MB uncompressed: save the sheet of the sweeps alone"
        ));
    }
    let mut workbook: Xlsx<_> = calamine::open_workbook_from_rs(Cursor::new(bytes))
        .map_err(|error: calamine::XlsxError| broken(&error))?;
    let names = workbook.sheet_names();
    let chosen: Vec<String> =
        names.iter().filter(|name| wanted.is_none_or(|wanted| wanted == *name)).cloned().collect();
    if chosen.is_empty() {
        let wanted = wanted.unwrap_or_default();
        return Err(format!("there is no sheet `{wanted}`; the sheets are {}", names.join(", ")));
    }
    chosen
        .into_iter()
        .map(|name| {
            let range = workbook.worksheet_range(&name).map_err(|error| broken(&error))?;
            let first = range.start().map_or(0, |(row, _)| u64::from(row));
            let rows = range.rows().zip(first + 1..).map(|(cells, line)| Row {
                line,
                comment: false,
                cells: cells.iter().map(cell_text).collect(),
            });
            let rows = rows.filter(|row| row.cells.iter().any(|cell| !cell.is_empty())).collect();
            Ok(Grid { seen_as: name, blanks: false, rows })
        })
        .collect()
}

/// The text of a cell; numbers with all their digits.
fn cell_text(cell: &Data) -> String {
    match cell {
        Data::Empty => String::new(),
        Data::Float(value) => value.to_string(),
        Data::Int(value) => value.to_string(),
        Data::String(text) => text.trim().to_owned(),
        Data::DateTime(_) | Data::DateTimeIso(_) | Data::DurationIso(_) => "(a date)".into(),
        other => other.to_string(),
    }
}
