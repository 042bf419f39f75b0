//! Workbooks (.xlsx, .xlsm): a sheet as text, which a description goes with as with any other.
//!
//! Each row of the sheet is a line and tabulators separate the cells, so that the numbers of
//! lines and columns in messages are those of the sheet. Numbers have all their digits; what a
//! program turned into a date is not a number. Before the reader of workbooks sees the file, its
//! members are unpacked piece by piece to see that they stay within limits.

use crate::description::{Column, DecimalMark};
use crate::{ScanProblem, packed};
use calamine::{DataRef, Reader, Xlsx, XlsxError};
use std::fmt::Write;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Room for shared texts, styles and the like, and for the text of the sheet: this and so many
/// times the size of the file.
const ROOM: u64 = 1 << 22;
const ROOM_PER_BYTE: u64 = 2;
const TEXT_PER_BYTE: u64 = 5;
/// Largest piece between two tags: more than six times what a cell holds (32767 characters).
const LONGEST_PIECE: usize = 1 << 18;
/// Columns that are read.
const MOST_COLUMNS: u32 = 1024;
/// More members than any workbook has.
const MOST_MEMBERS: usize = 10_000;

/// Whether the bytes are those of a workbook.
pub fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
        && ZipArchive::new(Cursor::new(bytes))
            .is_ok_and(|zip| zip.index_for_name("xl/workbook.xml").is_some())
}

/// A workbook whose members stay within limits.
pub struct Book<'a> {
    workbook: Xlsx<Cursor<&'a [u8]>>,
    /// Largest text of a sheet.
    limit: u64,
}

impl<'a> Book<'a> {
    /// Opens the bytes of a workbook.
    ///
    /// # Errors
    /// [`ScanProblem::Workbook`].
    pub fn open(bytes: &'a [u8]) -> Result<Self, ScanProblem> {
        check_members(bytes)?;
        let workbook = Xlsx::new(Cursor::new(bytes)).map_err(|error| unreadable(&error))?;
        Ok(Self { workbook, limit: ROOM + TEXT_PER_BYTE * bytes.len() as u64 })
    }

    /// The names of the sheets, in their order.
    pub fn sheets(&self) -> Vec<String> {
        self.workbook.sheet_names()
    }

    /// A sheet as text, the first if none is named; numbers have the decimal mark `mark`.
    ///
    /// # Errors
    /// [`ScanProblem::Workbook`], [`ScanProblem::NoSheet`].
    pub fn text(
        &mut self,
        sheet: Option<&Column>,
        mark: DecimalMark,
    ) -> Result<String, ScanProblem> {
        /// Names that a message shows.
        const SHOWN: usize = 20;
        let names = self.sheets();
        let found = match sheet {
            None => names.first(),
            Some(Column::Number(number)) => {
                number.checked_sub(1).and_then(|place| names.get(place))
            }
            Some(Column::Name(wanted)) => names.iter().find(|name| name.trim() == wanted.trim()),
        };
        let name = found.ok_or_else(|| ScanProblem::NoSheet {
            wanted: match sheet {
                Some(Column::Name(name)) => name.clone(),
                Some(Column::Number(number)) => number.to_string(),
                None => "1".into(),
            },
            present: names
                .iter()
                .take(SHOWN)
                .map(|name| format!("`{name}`"))
                .collect::<Vec<_>>()
                .join(", "),
        })?;
        cells(&mut self.workbook, name, mark, self.limit)
    }
}

fn workbook_problem(reason: impl Into<String>) -> ScanProblem {
    ScanProblem::Workbook { reason: reason.into() }
}

fn unreadable(error: &XlsxError) -> ScanProblem {
    workbook_problem(format!("the workbook cannot be read ({error})"))
}

/// The cells of a sheet, in the order of the file.
fn cells(
    workbook: &mut Xlsx<Cursor<&[u8]>>,
    name: &str,
    mark: DecimalMark,
    limit: u64,
) -> Result<String, ScanProblem> {
    let failed = |error: XlsxError| unreadable(&error);
    let mut reader = workbook.worksheet_cells_reader(name).map_err(failed)?;
    let mut text = String::new();
    let (mut row, mut column) = (0, 0);
    while let Some(cell) = reader.next_cell().map_err(failed)? {
        let (cell_row, cell_column) = cell.get_position();
        if matches!(cell.get_value(), DataRef::Empty) {
            continue;
        }
        if cell_row < row || (cell_row == row && cell_column < column) {
            return Err(workbook_problem(format!(
                "row {} of the sheet `{name}` occurs twice",
                cell_row + 1
            )));
        }
        if cell_column >= MOST_COLUMNS {
            return Err(workbook_problem(format!(
                "the sheet `{name}` has more than {MOST_COLUMNS} columns"
            )));
        }
        let padding = u64::from(cell_row - row) + u64::from(cell_column);
        if text.len() as u64 + padding > limit {
            return Err(workbook_problem(format!(
                "the sheet `{name}` is much larger than the file"
            )));
        }
        if cell_row > row {
            text.extend(std::iter::repeat_n('\n', (cell_row - row) as usize));
            (row, column) = (cell_row, 0);
        }
        text.extend(std::iter::repeat_n('\t', (cell_column - column) as usize));
        column = cell_column;
        push(&mut text, cell.get_value(), mark);
    }
    text.push('\n');
    padded(text, limit)
        .ok_or_else(|| workbook_problem(format!("the sheet `{name}` is much larger than the file")))
}

/// The text with as many cells on every line that has some, since empty ones are not cells of the
/// file; `None` if that is too much.
fn padded(text: String, limit: u64) -> Option<String> {
    let marks = |line: &str| line.bytes().filter(|byte| *byte == b'\t').count();
    let written = || text.lines().filter(|line| !line.is_empty());
    let width = written().map(marks).max().unwrap_or(0);
    let absent: usize = written().map(|line| width - marks(line)).sum();
    if absent == 0 {
        return Some(text);
    }
    if (text.len() + absent) as u64 > limit {
        return None;
    }
    let mut padded = String::with_capacity(text.len() + absent);
    for line in text.lines() {
        padded.push_str(line);
        let absent = if line.is_empty() { 0 } else { width - marks(line) };
        padded.extend(std::iter::repeat_n('\t', absent));
        padded.push('\n');
    }
    Some(padded)
}

fn push(text: &mut String, value: &DataRef, mark: DecimalMark) {
    let start = text.len();
    // Writing to a text does not fail.
    let _ = match value {
        DataRef::Float(number) if *number != 0.0 && !(1e-5..1e15).contains(&number.abs()) => {
            write!(text, "{number:e}")
        }
        DataRef::Float(number) => write!(text, "{number}"),
        DataRef::Int(number) => write!(text, "{number}"),
        DataRef::Bool(flag) => write!(text, "{flag}"),
        DataRef::DateTime(date) => write!(text, "date {}", date.as_f64()),
        DataRef::DateTimeIso(date) | DataRef::DurationIso(date) => write!(text, "date {date}"),
        DataRef::Error(error) => write!(text, "{error}"),
        DataRef::String(word) => push_word(text, word),
        DataRef::SharedString(word) => push_word(text, word),
        DataRef::Empty => Ok(()),
    };
    let is_number = matches!(value, DataRef::Float(_) | DataRef::Int(_));
    if mark == DecimalMark::Comma && is_number {
        let number = text[start..].replace('.', ",");
        text.replace_range(start.., &number);
    }
}

/// A text on one line without separators and quotation marks.
fn push_word(text: &mut String, word: &str) -> std::fmt::Result {
    text.extend(word.trim().chars().map(|c| match c {
        '"' => '\'',
        c if c.is_control() => ' ',
        c => c,
    }));
    Ok(())
}

/// Unpacks every member that is read, piece by piece, and refuses what would grow beyond measure.
fn check_members(bytes: &[u8]) -> Result<(), ScanProblem> {
    let damaged = |error: &dyn std::fmt::Display| {
        workbook_problem(format!("the workbook is damaged ({error})"))
    };
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    if zip.len() > MOST_MEMBERS {
        return Err(workbook_problem(format!("the workbook has {} members", zip.len())));
    }
    let mut room = ROOM + ROOM_PER_BYTE * bytes.len() as u64;
    for index in 0..zip.len() {
        let member = zip.by_index(index).map_err(|error| damaged(&error))?;
        let name = member.name().map_err(|error| damaged(&error))?.to_lowercase();
        if !name.ends_with(".xml") && !name.ends_with(".rels") {
            continue;
        }
        let is_sheet = name.contains("worksheets/");
        let by_ratio = packed::limit(member.compressed_size());
        let limit = if is_sheet { by_ratio } else { by_ratio.min(room) };
        let size = unpacked_size(member, limit, is_sheet).map_err(|error| damaged(&error))?;
        if size > limit {
            return Err(workbook_problem(format!(
                "the member {name} of the workbook unpacks to more than {limit} bytes"
            )));
        }
        if !is_sheet {
            room -= size;
        }
    }
    Ok(())
}

/// The unpacked size, or more than `limit` if it is above; of a sheet, pieces between tags are
/// looked at, as the reader holds one of them in memory.
fn unpacked_size(member: impl Read, limit: u64, is_sheet: bool) -> std::io::Result<u64> {
    let mut member = member.take(limit + 1);
    let mut buffer = [0; 1 << 14];
    let (mut size, mut piece, mut opened) = (0, 0, false);
    loop {
        let length = member.read(&mut buffer)?;
        if length == 0 {
            return Ok(size);
        }
        for byte in &buffer[..length] {
            // Comments and the like may hold tags and would be one piece; no sheet has them.
            if is_sheet && opened && *byte == b'!' {
                return Err(std::io::Error::other("a sheet with a comment"));
            }
            opened = *byte == b'<';
            piece = if opened { 0 } else { piece + 1 };
            if is_sheet && piece > LONGEST_PIECE {
                return Err(std::io::Error::other("a cell of more than 32767 characters"));
            }
        }
        size += length as u64;
    }
}
