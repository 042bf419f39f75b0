//! Cells of a text file as numbers.

use crate::cells::number as parse;
use crate::description::DecimalMark;
use crate::thousands::thousands_mark;
use crate::{ScanProblem, TextFormat};

/// What the cells of a file mean: its decimal mark and its markers of missing heights.
pub(super) struct Cells {
    mark: DecimalMark,
    missing_words: Vec<String>,
    missing_numbers: Vec<f64>,
}

impl Cells {
    pub(super) fn new(format: &TextFormat) -> Self {
        let mark = format.decimal_mark;
        let words = || format.missing.iter().map(|marker| marker.trim());
        Self {
            mark,
            missing_words: words().map(str::to_owned).collect(),
            missing_numbers: words()
                .filter_map(|word| word.parse().ok().or_else(|| parse(word, mark)))
                .filter(|number: &f64| number.is_finite())
                .collect(),
        }
    }

    /// The height in a cell, in units of the file; NaN where it is marked as missing.
    pub(super) fn height(&self, cell: &str) -> Result<f64, ScanProblem> {
        let cell = cell.trim();
        if let Some(number) = parse(cell, self.mark).filter(|number| number.is_finite()) {
            let missing = self.missing_numbers.contains(&number);
            return Ok(if missing { f64::NAN } else { number });
        }
        if self.missing_words.iter().any(|word| word.eq_ignore_ascii_case(cell)) {
            return Ok(f64::NAN);
        }
        Err(self.explain(cell, " and not listed in `missing`"))
    }

    /// The position in a cell, in units of the file; it may not be missing.
    pub(super) fn position(&self, cell: &str) -> Result<f64, ScanProblem> {
        let cell = cell.trim();
        parse(cell, self.mark)
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.explain(cell, "; every point needs a position"))
    }

    /// Whether a cell holds a number, by the decimal mark of the file.
    pub(super) fn is_number(&self, cell: &str) -> bool {
        parse(cell.trim(), self.mark).is_some_and(f64::is_finite)
    }

    fn explain(&self, cell: &str, hint: &'static str) -> ScanProblem {
        let (other, mark) = match self.mark {
            DecimalMark::Point => (DecimalMark::Comma, ','),
            DecimalMark::Comma => (DecimalMark::Point, '.'),
        };
        let text = shorten(cell);
        if parse(cell, self.mark).is_some_and(f64::is_infinite) {
            ScanProblem::Infinite { text }
        } else if parse(cell, other).is_some_and(f64::is_finite) {
            let hint = match thousands_mark(cell, self.mark) {
                Some(_) => "; if it separates thousands, export the file without",
                None => "",
            };
            ScanProblem::DecimalMark { text, mark, hint }
        } else if let Some(mark) = thousands_mark(cell, self.mark) {
            ScanProblem::Thousands { text, mark }
        } else {
            ScanProblem::NotANumber { text, hint }
        }
    }
}

/// The start of a cell, enough to find it again.
pub(super) fn shorten(cell: &str) -> String {
    const LONGEST: usize = 40;
    match cell.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", cell[..end].escape_debug()),
        None => cell.escape_debug().to_string(),
    }
}
