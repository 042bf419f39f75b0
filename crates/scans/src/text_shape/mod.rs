//! What a text file or the sheet of a workbook looks like, and the description that would read it.
//!
//! Encoding, separator, decimal mark, header and columns are found from the content, units only
//! where the file states them. Nothing is read by this: it is a proposal for the recipe.
//!
//! | module | what it holds |
//! |---|---|
//! | `encoding` | the encoding, by the content |
//! | `layout` | ways to split lines into cells, and the lines of points that they find |
//! | `names` | names of columns, units and the mark where data begin |
//! | `missing` | marks of missing heights |
//! | `proposal` | the description that would read the text |

pub(crate) mod encoding;
mod layout;
mod missing;
mod names;
mod proposal;
#[cfg(test)]
mod tests;

pub use proposal::{separator_text, unit_name};

use crate::TextFormat;
use crate::decode::lines;
use crate::description::{Column, DecimalMark, LengthUnit, Separator};
use crate::lattice::Lattice;
use crate::spreadsheet::{Book, is_workbook};
use crate::thousands::thousands_mark;
use layout::{Body, Layout};
pub use missing::{RepeatedHeight, repeated_inside};
use names::{comment_of, footer, is_comment, marker, regrouped, states_unit, unit_in, unit_of_two};

/// Lines by which separator, decimal mark and columns are found; more add nothing.
const MOST_LINES: usize = 2000;
/// Sheets of a workbook that are looked at.
const MOST_SHEETS: usize = 50;
/// Columns that a table of positions and heights has at most where they have no names.
const MOST_NAMELESS: usize = 12;
/// Columns from which on those that grow may be heights.
const FEWEST_OF_ROWS: usize = 8;
/// Heights of a matrix among which marks of missing ones are sought.
const MOST_HEIGHTS: usize = 1 << 22;

/// What a text file looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct TextShape {
    /// Sheet of a workbook, where it is not the first.
    pub sheet: Option<String>,
    /// Label of the encoding, for `encoding`.
    pub encoding: &'static str,
    /// The separator of the cells.
    pub separator: Separator,
    /// The decimal mark.
    pub decimal_mark: DecimalMark,
    /// Character that starts the lines before the points, if one does.
    pub comment: Option<char>,
    /// Lines before the names of the columns, or before the points where there are none.
    pub skip_lines: usize,
    /// The line before the names of the columns, if it marks the start of the data.
    pub skip_until: Option<String>,
    /// The start of the first written line after the points.
    pub stop_at: Option<String>,
    /// Whether a line of names precedes the points.
    pub header: bool,
    /// The columns; empty ones at the end of the lines are left out.
    pub columns: Vec<TextColumn>,
    /// Lines of points.
    pub rows: usize,
    /// Columns of x and y, from 0, where the points are those of a height map.
    pub map: Option<(usize, usize)>,
    /// Cells that seem to mark a missing height, beyond those that do without being listed: words,
    /// numbers that repeat at the end of the range and far from all other heights, and numbers within
    /// the range that repeat much more often than all others.
    pub missing: Vec<String>,
    /// Lines before the points that state a unit, as written.
    pub stated: Vec<String>,
    /// A cell whose thousands are separated, which the reader refuses.
    pub thousands: Option<String>,
    /// Whether the reader splits the names as here: between blanks a name of two
    /// words is two.
    names_are_cells: bool,
}

/// A column of a text file.
#[derive(Debug, Clone, PartialEq)]
pub struct TextColumn {
    /// Its name, empty where there is none.
    pub name: String,
    /// The unit in its name.
    pub unit: Option<LengthUnit>,
    /// Whether its numbers grow from line to line, or stay in no more than two thirds of them.
    pub grows: bool,
    /// Whether it has no number at all.
    pub empty: bool,
}

impl TextShape {
    /// Looks at the bytes of a file; `None` where no two lines of numbers follow each other.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if is_workbook(bytes) {
            return Self::of_workbook(bytes);
        }
        let (encoding, text) = encoding::decode(bytes);
        const SEPARATORS: [Separator; 4] =
            [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Whitespace];
        Self::of_text(encoding, &text, &SEPARATORS)
    }

    fn of_text(encoding: &'static str, text: &str, separators: &[Separator]) -> Option<Self> {
        let start: Vec<&str> = lines(text).take(MOST_LINES).collect();
        let layouts = separators.iter().flat_map(|separator| {
            [DecimalMark::Point, DecimalMark::Comma]
                .map(|mark| Layout { separator: *separator, mark })
        });
        // The first of equals: more lines of points, then more columns.
        let (layout, mut body) = layouts
            .filter(|layout| layout.is_possible())
            .filter_map(|layout| Some((layout, layout.body(&start)?)))
            .rev_max_by_key(|(_, body)| (body.rows(), body.width, !body.thousands))?;
        layout.go_back(&mut body, &start);
        layout.extend(&mut body, lines(text));
        Some(describe(encoding, layout, &body, text, &start[..body.start]))
    }

    /// The sheet of the most points; numbers in cells have whichever decimal mark the texts have.
    fn of_workbook(bytes: &[u8]) -> Option<Self> {
        let mut book = Book::open(bytes).ok()?;
        let mut best: Option<Self> = None;
        for (index, name) in book.sheets().into_iter().enumerate().take(MOST_SHEETS) {
            for mark in [DecimalMark::Point, DecimalMark::Comma] {
                let number = Column::Number(index + 1);
                let text = book.text(Some(&number), mark).unwrap_or_default();
                let shape = Self::of_text("utf-8", &text, &[Separator::Tab]);
                let Some(shape) = shape.filter(|shape| shape.decimal_mark == mark) else {
                    continue;
                };
                if best.as_ref().is_none_or(|best| shape.rows > best.rows) {
                    let sheet = (index > 0).then(|| name.clone());
                    best = Some(Self { sheet, ..shape });
                }
            }
        }
        best
    }

    /// Where the description states another unit than the column it names, in words.
    pub fn contradictions(&self, format: &TextFormat) -> Vec<String> {
        let column = |column: &Column| match column {
            Column::Name(name) => self.columns.iter().find(|found| found.name == name.trim()),
            Column::Number(number) if self.separator == format.separator => {
                self.columns.get(number.checked_sub(1)?)
            }
            Column::Number(_) => None,
        };
        let contradiction = |key, named: Option<&Column>, unit: Option<LengthUnit>| {
            let (column, unit) = (column(named?)?, unit?);
            let stated = column.unit.filter(|stated| *stated != unit)?;
            let (stated, unit) = (proposal::unit_name(stated), proposal::unit_name(unit));
            Some(format!(
                "the column `{}` states {stated}, the description {key} = \"{unit}\"",
                column.name
            ))
        };
        let keys = [
            contradiction("x_unit", format.x_column.as_ref(), format.x_unit),
            contradiction("y_unit", format.y_column.as_ref(), format.y_unit),
            contradiction("z_unit", format.z_column.as_ref(), format.z_unit),
        ];
        keys.into_iter().flatten().collect()
    }

    /// Whether the lines are rows of a height map: many numbers without names, or three and more of
    /// which none is a position. Where most of eight columns and more grow, it is the map that rises.
    pub fn is_matrix(&self) -> bool {
        let columns = self.columns.len();
        let nameless = self.columns.iter().all(|column| column.name.is_empty());
        let growing = self.columns.iter().filter(|column| column.grows).count();
        let rises = columns >= FEWEST_OF_ROWS && 2 * growing > columns;
        let no_positions = self.map.is_none() && (growing == 0 || rises);
        !self.header && nameless && (columns > MOST_NAMELESS || (columns > 2 && no_positions))
    }

    /// Whether the file seems to hold a height map and not a line.
    pub fn is_map(&self) -> bool {
        self.map.is_some() || self.is_matrix()
    }

    /// Numbers, from 0, of the columns of positions and heights: positions grow, heights are the
    /// last column that does not, and columns with a unit come before those without. Of a map both
    /// columns of positions are known, and heights are the last of the others.
    pub fn proposed_columns(&self) -> (Option<usize>, usize) {
        let written = |i: &usize| !self.columns[*i].empty;
        let with_unit = |i: &&usize| self.columns[**i].unit.is_some();
        let last_of =
            |others: &[usize]| others.iter().rev().find(with_unit).or(others.last()).copied();
        if let Some((x, y)) = self.map {
            let others: Vec<usize> =
                (0..self.columns.len()).filter(|i| ![x, y].contains(i)).filter(written).collect();
            return (Some(x), last_of(&others).unwrap_or(self.columns.len() - 1));
        }
        let growing: Vec<usize> =
            (0..self.columns.len()).filter(|&i| self.columns[i].grows).collect();
        let x = match self.columns.len() {
            1 => None,
            _ => growing.iter().find(with_unit).or(growing.first()).copied(),
        };
        let others: Vec<usize> = (0..self.columns.len())
            .filter(|i| Some(*i) != x && !growing.contains(i))
            .filter(written)
            .collect();
        let last = self.columns.len() - 1;
        (x, last_of(&others).unwrap_or(if x == Some(last) { 0 } else { last }))
    }

    /// Number, from 0, of the column of the positions across the lines of a map.
    pub fn proposed_y(&self) -> Option<usize> {
        self.map.map(|(_, y)| y)
    }
}

/// The first of the greatest elements; that of the standard library is the last.
trait FirstMax: Iterator + Sized {
    fn rev_max_by_key<K: Ord>(self, key: impl Fn(&Self::Item) -> K) -> Option<Self::Item> {
        self.reduce(|best, next| if key(&next) > key(&best) { next } else { best })
    }
}

impl<I: Iterator> FirstMax for I {}

/// Names of the columns, and whether they are a line of their own that the reader reads alike.
struct Names {
    names: Vec<String>,
    header: bool,
    are_cells: bool,
}

impl Names {
    fn of(before: &[&str], layout: Layout, comment: Option<char>, width: usize) -> Self {
        let none = Self { names: Vec::new(), header: false, are_cells: false };
        let Some(line) = before.last().filter(|line| !line.trim().is_empty()) else { return none };
        let blanks = layout.separator == Separator::Whitespace;
        let fits =
            |names: &Vec<String>| if blanks { names.len() == width } else { names.len() >= width };
        if is_comment(line, comment) {
            // Names after a comment mark are not read, but state the units.
            let text = line.trim_start().trim_start_matches(|c| Some(c) == comment);
            let names = Some(regrouped(layout.cells(text))).filter(|names| names.len() == width);
            return Self { names: names.unwrap_or_default(), ..none };
        }
        let cells = layout.cells(line);
        if fits(&cells) {
            return Self { names: cells, header: true, are_cells: true };
        }
        if !blanks || cells.len() < width {
            return none;
        }
        let names = Some(regrouped(cells)).filter(fits).unwrap_or_default();
        Self { names, header: true, are_cells: false }
    }
}

fn describe(
    encoding: &'static str,
    layout: Layout,
    body: &Body,
    text: &str,
    before: &[&str],
) -> TextShape {
    // A separator at the end of the lines makes a column without a number.
    let written = |number: &usize| body.column(*number).any(f64::is_finite);
    let width = (0..body.width).rev().find(written).map_or(body.width, |last| last + 1);
    let comment = comment_of(before);
    let Names { names, header, are_cells } = Names::of(before, layout, comment, width);
    let preamble = &before[..before.len() - usize::from(header)];
    let commented = comment.is_some() && preamble.iter().all(|line| is_comment(line, comment));
    let skip_until =
        if commented { None } else { marker(preamble, |line: &str| layout.cells(line)) };
    let above = preamble.last().filter(|line| header && !is_comment(line, comment));
    let above = above
        .map(|line| layout.cells(line))
        .filter(|cells| cells.len() >= width)
        .unwrap_or_default();
    let column = |number: usize| {
        let name = names.get(number).cloned().unwrap_or_default();
        let values: Vec<f64> = body.column(number).collect();
        TextColumn {
            unit: unit_in(&name)
                .or_else(|| unit_of_two(above.get(number).map_or("", String::as_str), &name)),
            grows: grows(&values),
            empty: !values.iter().any(|value| value.is_finite()),
            name,
        }
    };
    let shape = TextShape {
        sheet: None,
        encoding,
        separator: layout.separator,
        decimal_mark: layout.mark,
        comment: comment.filter(|_| commented),
        skip_lines: if commented { 0 } else { preamble.len() },
        skip_until,
        stop_at: footer(text, layout, body, comment),
        header,
        columns: (0..width).map(column).collect(),
        rows: body.rows(),
        map: map_columns(body, width),
        stated: preamble
            .iter()
            .filter(|line| states_unit(line))
            .map(|l| l.trim().to_owned())
            .collect(),
        missing: Vec::new(),
        thousands: None,
        names_are_cells: are_cells,
    };
    with_marks(shape, layout, body, text)
}

/// Adds what the cells of the points say: marks of missing heights, separated thousands.
fn with_marks(shape: TextShape, layout: Layout, body: &Body, text: &str) -> TextShape {
    let points = || lines(text).skip(body.start).take(body.rows());
    let is_word = |cell: &String| layout.number(cell).is_none_or(f64::is_nan);
    let (mut missing, numbers): (_, Vec<f64>) = if shape.is_matrix() {
        let heights = points().flat_map(|line| layout.cells(line)).take(MOST_HEIGHTS);
        (
            missing::words(heights.filter(is_word)),
            body.numbers.iter().copied().take(MOST_HEIGHTS).collect(),
        )
    } else {
        let (_, z) = shape.proposed_columns();
        let heights = points().filter_map(|line| layout.cells(line).into_iter().nth(z));
        (missing::words(heights.filter(is_word)), body.column(z).collect())
    };
    let far = missing::numbers(&numbers);
    let inside = repeated_inside(&numbers).into_iter().map(|mark| mark.height);
    let inside: Vec<f64> = inside.filter(|mark| !far.contains(mark)).collect();
    missing.extend(far.into_iter().chain(inside).map(missing::mark_text));
    let mut cells = points().take(MOST_LINES).flat_map(|line| layout.cells(line));
    let thousands = cells.find(|cell| thousands_mark(cell, layout.mark).is_some());
    TextShape { missing, thousands, ..shape }
}

/// The first two columns that are the positions of a map, where a third is left for its heights.
fn map_columns(body: &Body, width: usize) -> Option<(usize, usize)> {
    /// Positions are among the first columns.
    const LAST: usize = 4;
    if width < 3 {
        return None;
    }
    let columns: Vec<Vec<f64>> =
        (0..width.min(LAST)).map(|number| body.column(number).collect()).collect();
    let mut pairs = (0..columns.len()).flat_map(|x| (x + 1..columns.len()).map(move |y| (x, y)));
    let is_map = |(x, y): &(usize, usize)| {
        let lattice = Lattice::of(&columns[*x], &columns[*y]);
        lattice.is_ok_and(|lattice| lattice.columns.saturating_mul(lattice.rows) <= 4 * body.rows())
    };
    pairs.find(is_map)
}

/// Whether numbers are positions, of which some may be there two or three times.
fn grows(values: &[f64]) -> bool {
    let steps = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    3 * steps >= values.len() - 1 && values.windows(2).all(|pair| pair[1] >= pair[0])
}
