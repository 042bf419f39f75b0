//! Ways to split the lines of a text, and the lines of points that they find.

use super::missing;
use crate::description::{DecimalMark, Separator};
use crate::thousands::thousands_mark;
use csv::ReaderBuilder;

/// A way to split lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) separator: Separator,
    pub(super) mark: DecimalMark,
}

/// Lines of points.
pub(super) struct Body {
    /// Place of the first, from 0.
    pub(super) start: usize,
    /// Cells of each line.
    pub(super) width: usize,
    /// Numbers line by line, NaN where missing.
    pub(super) numbers: Vec<f64>,
    /// Whether thousands are separated in one of them.
    pub(super) thousands: bool,
}

impl Body {
    fn at(start: usize) -> Self {
        Self { start, width: 0, numbers: Vec::new(), thousands: false }
    }

    /// Number of lines.
    pub(super) fn rows(&self) -> usize {
        self.numbers.len().checked_div(self.width).unwrap_or(0)
    }

    /// The numbers of a column.
    pub(super) fn column(&self, number: usize) -> impl Iterator<Item = f64> {
        self.numbers.iter().skip(number).step_by(self.width.max(1)).copied()
    }
}

impl Layout {
    pub(super) fn is_possible(self) -> bool {
        (self.separator, self.mark) != (Separator::Comma, DecimalMark::Comma)
    }

    pub(super) fn cells(self, line: &str) -> Vec<String> {
        let Some(separator) = self.separator.character() else {
            return line.split_whitespace().map(str::to_owned).collect();
        };
        if !line.contains('"') {
            return line.split(separator).map(|cell| cell.trim().to_owned()).collect();
        }
        let mut reader = ReaderBuilder::new()
            .delimiter(separator as u8)
            .has_headers(false)
            .from_reader(line.as_bytes());
        let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
        record.iter().map(|cell| cell.trim().to_owned()).collect()
    }

    pub(super) fn numbers(self, line: &str) -> Option<Vec<f64>> {
        let cells = self.cells(line);
        let numbers: Vec<f64> =
            cells.iter().map(|cell| self.number(cell)).collect::<Option<_>>()?;
        // A line of heights only may hold a word for a missing one; elsewhere words are names.
        let is_point = numbers.iter().any(|number| number.is_finite())
            || (cells.len() == 1 && !cells[0].is_empty());
        is_point.then_some(numbers)
    }

    /// The numbers of a line beside others of `width` cells: at least half of its cells are
    /// numbers, the first among them, and the others are marks that are not known. Footers and
    /// names begin with a word.
    fn marked_numbers(self, line: &str, width: usize) -> Option<Vec<f64>> {
        let cells = self.cells(line);
        let numbers: Vec<Option<f64>> = cells.iter().map(|cell| self.number(cell)).collect();
        let known = numbers.iter().flatten().filter(|number| number.is_finite()).count();
        let is_point = cells.len() == width
            && numbers.first().is_some_and(Option::is_some)
            && known > 0
            && 2 * known >= width;
        is_point.then(|| numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }

    fn has_thousands(self, line: &str) -> bool {
        self.cells(line).iter().any(|cell| thousands_mark(cell, self.mark).is_some())
    }

    pub(super) fn number(self, cell: &str) -> Option<f64> {
        if missing::is_word(cell) {
            return Some(f64::NAN);
        }
        let parsed: Option<f64> = match self.mark {
            DecimalMark::Point => cell.parse().ok(),
            DecimalMark::Comma if cell.contains('.') => None,
            DecimalMark::Comma => cell.replacen(',', ".", 1).parse().ok(),
        };
        let number = parsed.or_else(|| {
            let mark = thousands_mark(cell, self.mark)?;
            self.number(&cell.replace(mark, ""))
        });
        number.filter(|number| number.is_finite())
    }

    /// Goes on with the points where the first lines end; `lines` are all lines of the text.
    pub(super) fn extend<'a>(self, body: &mut Body, lines: impl Iterator<Item = &'a str>) {
        let width = body.width;
        for line in lines.skip(body.start + body.rows()) {
            match self.numbers(line).or_else(|| self.marked_numbers(line, width)) {
                Some(row) if row.len() == width => body.numbers.extend(row),
                _ => return,
            }
        }
    }

    /// Takes in lines right before the points whose height is marked by a word that is not known.
    pub(super) fn go_back(self, body: &mut Body, lines: &[&str]) {
        let before = lines[..body.start].iter().rev();
        let marked: Vec<_> =
            before.map_while(|line| self.marked_numbers(line, body.width)).collect();
        body.start -= marked.len();
        body.numbers.splice(..0, marked.into_iter().rev().flatten());
    }

    /// The longest run of lines of equally many numbers.
    pub(super) fn body(self, lines: &[&str]) -> Option<Body> {
        let (mut longest, mut current) = (Body::at(0), Body::at(0));
        for (index, line) in lines.iter().enumerate() {
            let width = Some(current.width).filter(|width| *width > 0);
            let marked = || width.and_then(|width| self.marked_numbers(line, width));
            match self.numbers(line).or_else(marked) {
                Some(row) if width == Some(row.len()) => current.numbers.extend(row),
                Some(row) if row.iter().any(|number| number.is_finite()) => {
                    let next = Body { width: row.len(), numbers: row, ..Body::at(index) };
                    longest = longer(longest, std::mem::replace(&mut current, next));
                }
                _ => {
                    let none = Body::at(index);
                    longest = longer(longest, std::mem::replace(&mut current, none));
                }
            }
            current.thousands |= current.rows() > 0 && self.has_thousands(line);
        }
        Some(longer(longest, current)).filter(|body| body.rows() > 1)
    }
}

fn longer(first: Body, second: Body) -> Body {
    if second.rows() > first.rows() { second } else { first }
}
