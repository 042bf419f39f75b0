//! Lines of a text file, one after the other, as cells.

use super::number::Cells;
use crate::decode::{Located, TextLines};
use crate::description::Separator;
use crate::{ScanProblem, TextFormat};
use csv::StringRecord;
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

/// Most cells of a line.
const MOST_CELLS: usize = 1 << 16;

/// Reader of the non-blank, non-comment lines of a text.
pub(super) struct Rows<'a> {
    lines: TextLines<'a>,
    comment: Option<char>,
    separator: Separator,
    quotes: Quotes,
    /// Start of the first line after the points.
    stop_at: Option<String>,
    /// Whether it has come.
    stopped: bool,
    /// Whether a blank line precedes the record last read, or is that record.
    after_blank_line: bool,
}

impl<'a> Rows<'a> {
    pub(super) fn new(lines: TextLines<'a>, format: &TextFormat) -> Self {
        let separator = format.separator;
        Self {
            lines,
            comment: format.comment,
            separator,
            quotes: Quotes::new(separator),
            stop_at: format.stop_at.as_ref().map(|text| text.trim().to_owned()),
            stopped: false,
            after_blank_line: false,
        }
    }

    /// Reads the next line into `record`; false at the end of the points.
    ///
    /// Every line is a separate record: where a cell opens a quotation mark that is not closed,
    /// the points up to the next such mark would be lost in it.
    pub(super) fn read(&mut self, record: &mut StringRecord) -> Result<bool, Located> {
        self.after_blank_line = false;
        record.clear();
        if self.stopped {
            return Ok(false);
        }
        let Self { lines, separator, comment, stop_at, .. } = self;
        let is_comment = |line: &str| comment.is_some_and(|comment| line.starts_with(comment));
        while let Some(line) = lines.next()? {
            let text = line.trim();
            if stop_at.as_ref().is_some_and(|stop| text.starts_with(stop)) {
                self.stopped = true;
                return Ok(false);
            }
            self.after_blank_line = self.after_blank_line || text.is_empty();
            let complete = match separator.character() {
                None if text.is_empty() || is_comment(text) => continue,
                None => split(text.split_whitespace(), record),
                Some(_) if line.is_empty() || is_comment(line) => continue,
                Some(_) if line.contains('"') => match self.quotes.split(line, record) {
                    Closed::Yes => Ok(()),
                    Closed::No => Err(ScanProblem::QuotedLines),
                    Closed::TooManyCells => Err(ScanProblem::ManyCells { limit: MOST_CELLS }),
                },
                Some(separator) => split(line.split(separator), record),
            };
            return complete.map(|()| true).map_err(|problem| (Some(lines.number()), problem));
        }
        match &self.stop_at {
            None => Ok(false),
            Some(marker) => {
                let marker = marker.clone();
                Err((None, self.ends_with(ScanProblem::NoFooter { marker })))
            }
        }
    }

    /// Reads the column names: as [`Rows::read`], but a name in quotation marks may go on over
    /// some lines, as spreadsheets write it, unless there are numbers.
    pub(super) fn read_names(
        &mut self,
        record: &mut StringRecord,
        cells: &Cells,
    ) -> Result<bool, Located> {
        const MOST_LINES: usize = 8;
        let (line, problem) = loop {
            match self.read(record) {
                // A line of blanks names nothing.
                Ok(true) if record.len() == 1 && record[0].trim().is_empty() => {}
                Err((line, problem @ ScanProblem::QuotedLines)) => break (line, problem),
                other => return other,
            }
        };
        let mut names = self.lines.line().to_owned();
        for _ in 1..MOST_LINES {
            let Some(next) = self.lines.next()? else { break };
            let mut cells_of_line = next
                .split(|c| self.separator.character() == Some(c))
                .map(|cell| cell.trim().trim_matches('"'));
            if cells_of_line.any(|cell| cells.is_number(cell)) {
                break;
            }
            names.push('\n');
            names.push_str(next);
            record.clear();
            match self.quotes.split(&names, record) {
                Closed::Yes => return Ok(true),
                Closed::No => {}
                Closed::TooManyCells => {
                    return Err((line, ScanProblem::ManyCells { limit: MOST_CELLS }));
                }
            }
        }
        Err((line, problem))
    }

    /// Number of the line last read, from 1.
    pub(super) fn line(&self) -> usize {
        self.lines.number()
    }

    /// Whether there is a blank line between the record last read and the one before.
    pub(super) fn follows_blank_line(&self) -> bool {
        self.after_blank_line
    }

    /// Whether the text ends with the record last read and has no line end there.
    pub(super) fn is_unfinished_line(&self) -> bool {
        !self.lines.is_ended()
    }

    /// What a file that ends too early is: `problem`, or without any text.
    pub(super) fn ends_with(&self, problem: ScanProblem) -> ScanProblem {
        self.lines.ends_with(problem)
    }
}

fn split<'a>(
    cells: impl Iterator<Item = &'a str>,
    record: &mut StringRecord,
) -> Result<(), ScanProblem> {
    for cell in cells {
        if record.len() == MOST_CELLS {
            return Err(ScanProblem::ManyCells { limit: MOST_CELLS });
        }
        record.push_field(cell);
    }
    Ok(())
}

/// Splits lines with quotation marks.
struct Quotes {
    reader: Reader,
    cells: Vec<u8>,
    ends: Vec<usize>,
}

/// Whether the last quotation mark of a line is closed.
enum Closed {
    Yes,
    No,
    TooManyCells,
}

impl Quotes {
    fn new(separator: Separator) -> Self {
        let delimiter = separator.character().map_or(b',', |separator| separator as u8);
        Self {
            reader: ReaderBuilder::new().delimiter(delimiter).build(),
            cells: Vec::new(),
            ends: Vec::new(),
        }
    }

    fn split(&mut self, line: &str, record: &mut StringRecord) -> Closed {
        self.reader.reset();
        // Cells are not longer than the line; there is one more than separators.
        self.cells.resize(line.len() + 1, 0);
        self.ends.resize(line.len().min(MOST_CELLS) + 2, 0);
        let (mut written, mut ended) = (0, 0);
        for mut part in [line.as_bytes(), b"\n"] {
            while !part.is_empty() {
                let (result, took, wrote, ends) = self.reader.read_record(
                    part,
                    &mut self.cells[written..],
                    &mut self.ends[ended..],
                );
                (written, ended) = (written + wrote, ended + ends);
                part = &part[took..];
                match result {
                    ReadRecordResult::InputEmpty => {}
                    ReadRecordResult::Record => {
                        let mut start = 0;
                        for end in &self.ends[..ended] {
                            let cell = &self.cells[start..*end];
                            // Separators and quotation marks are ASCII: cells are valid UTF-8.
                            record.push_field(&String::from_utf8_lossy(cell));
                            start = *end;
                        }
                        return Closed::Yes;
                    }
                    _ => return Closed::TooManyCells,
                }
            }
        }
        Closed::No
    }
}
