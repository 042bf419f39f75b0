//! Lines of a text file, one after the other, as cells.

use crate::scans::decode::{line_number, next_line};
use crate::scans::{ScanProblem, TextFormat};
use csv::{Reader, ReaderBuilder, StringRecord};

/// Reader of the non-blank, non-comment lines of a text from a given offset on.
pub(super) struct Rows<'a> {
    text: &'a str,
    body: usize,
    comment: Option<char>,
    /// Where the record last read starts, blank lines and comments before it included.
    start: usize,
    /// Where the record last read ends.
    end: usize,
    /// `None` where the cells stand between runs of blanks.
    delimited: Option<Reader<&'a [u8]>>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(text: &'a str, body: usize, format: &TextFormat) -> Self {
        let delimited = format.separator.character().map(|separator| {
            ReaderBuilder::new()
                .delimiter(separator as u8)
                .comment(format.comment.map(|comment| comment as u8))
                .has_headers(false)
                .flexible(true)
                .from_reader(&text.as_bytes()[body..])
        });
        Self { text, body, comment: format.comment, start: body, end: body, delimited }
    }

    /// Reads the next line into `record`; false at the end of the text.
    pub(super) fn read(&mut self, record: &mut StringRecord) -> Result<bool, ScanProblem> {
        self.start = self.end;
        let Some(reader) = &mut self.delimited else { return Ok(self.read_blanks(record)) };
        let found = reader.read_record(record)?;
        self.end = self.body + reader.position().byte() as usize;
        Ok(found)
    }

    fn read_blanks(&mut self, record: &mut StringRecord) -> bool {
        record.clear();
        while self.end < self.text.len() {
            let line_start = self.end;
            self.end = next_line(self.text, line_start);
            let line = self.text[line_start..self.end].trim();
            if line.is_empty() || self.comment.is_some_and(|comment| line.starts_with(comment)) {
                continue;
            }
            line.split_whitespace().for_each(|cell| record.push_field(cell));
            return true;
        }
        false
    }

    /// Number of the line last read, from 1.
    pub(super) fn line(&self) -> usize {
        line_number(self.text, self.end)
    }

    /// Whether a blank line stands between the record last read and the one before.
    pub(super) fn follows_blank_line(&self) -> bool {
        let (before, record) = self.text.split_at(self.start);
        let record = &record[..self.end - self.start];
        // The reader may have left the rest of `\r\n` or `\r\r\n` to this record.
        let rest = record.strip_prefix("\r\n").or_else(|| record.strip_prefix('\n'));
        let rest = rest.filter(|_| before.ends_with('\r')).unwrap_or(record);
        let mut at = 0;
        while at < rest.len() {
            let next = next_line(rest, at);
            if rest[at..next].trim().is_empty() {
                return true;
            }
            at = next;
        }
        false
    }

    /// Whether the text ends with the record last read and has no line end there.
    pub(super) fn is_unfinished_line(&self) -> bool {
        self.end == self.text.len() && !self.text.ends_with(['\n', '\r'])
    }
}
