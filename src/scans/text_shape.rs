//! What a text file looks like, and the description that would read it.
//!
//! Encoding, separator, decimal mark, header and columns are found from the content, units only
//! where the file states them. Nothing is read by this: it is a proposal for the recipe.

pub(crate) mod encoding;
mod missing;
#[cfg(test)]
mod tests;

use crate::scans::TextFormat;
use crate::scans::description::{Column, DecimalMark, LengthUnit, Separator, default_missing};
use crate::scans::thousands::thousands_mark;
use csv::ReaderBuilder;
pub use missing::{RepeatedHeight, repeated_inside};
use std::fmt::Write;

/// Lines by which separator, decimal mark and columns are found; more say nothing new.
const MOST_LINES: usize = 2000;

/// What a text file looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct TextShape {
    /// Label of the encoding, for `encoding`.
    pub encoding: &'static str,
    /// What stands between the cells.
    pub separator: Separator,
    /// The decimal mark.
    pub decimal_mark: DecimalMark,
    /// Character that starts the lines before the points, if one does.
    pub comment: Option<char>,
    /// Lines before the names of the columns, or before the points where there are none.
    pub skip_lines: usize,
    /// The line before the names of the columns, if it marks the start of the data.
    pub skip_until: Option<String>,
    /// Whether the columns have names.
    pub header: bool,
    /// The columns.
    pub columns: Vec<TextColumn>,
    /// Lines of points.
    pub rows: usize,
    /// Cells that seem to mark a missing height, beyond those that do without being listed: words,
    /// numbers that repeat at the end of the range and far from all other heights, and numbers within
    /// the range that repeat much more often than all others.
    pub missing: Vec<String>,
    /// Lines before the points that state a unit, as they stand.
    pub stated: Vec<String>,
    /// A cell whose thousands are separated, which the reader refuses.
    pub thousands: Option<String>,
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
}

impl TextShape {
    /// Looks at the bytes of a file; `None` where no two lines of numbers follow each other.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let (encoding, text) = encoding::decode(bytes);
        let lines: Vec<&str> = text.lines().collect();
        let start = &lines[..lines.len().min(MOST_LINES)];
        const SEPARATORS: [Separator; 4] =
            [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Whitespace];
        let layouts = SEPARATORS.iter().flat_map(|separator| {
            [DecimalMark::Point, DecimalMark::Comma]
                .map(|mark| Layout { separator: *separator, mark })
        });
        // The first of equals: more lines of points, then more columns.
        let (layout, mut body) = layouts
            .filter(|layout| layout.is_possible())
            .filter_map(|layout| Some((layout, layout.body(start)?)))
            .rev_max_by_key(|(_, body)| (body.rows.len(), body.rows[0].len(), !body.thousands))?;
        layout.go_back(&mut body, start);
        layout.extend(&mut body, &lines);
        Some(describe(encoding, layout, &body, &lines))
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
        let contradiction = |key, named: &Column, unit: Option<LengthUnit>| {
            let (column, unit) = (column(named)?, unit?);
            let stated = column.unit.filter(|stated| *stated != unit)?;
            let (stated, unit) = (unit_name(stated), unit_name(unit));
            Some(format!(
                "the column `{}` states {stated}, the description {key} = \"{unit}\"",
                column.name
            ))
        };
        let x = format.x_column.as_ref();
        let x = x.and_then(|column| contradiction("x_unit", column, format.x_unit));
        x.into_iter().chain(contradiction("z_unit", &format.z_column, format.z_unit)).collect()
    }

    /// The proposed description.
    ///
    /// # Errors
    /// The keys that the file does not state a value of.
    pub fn format(&self) -> Result<TextFormat, Vec<&'static str>> {
        let (x, z) = self.proposed_columns();
        let unit = |number: usize| self.columns[number].unit;
        let unstated: Vec<&str> = [
            ("x_spacing_um", x.is_none()),
            ("x_unit", x.is_some_and(|x| unit(x).is_none())),
            ("z_unit", unit(z).is_none()),
        ]
        .into_iter()
        .filter_map(|(key, absent)| absent.then_some(key))
        .collect();
        if !unstated.is_empty() {
            return Err(unstated);
        }
        Ok(TextFormat {
            separator: self.separator,
            decimal_mark: self.decimal_mark,
            comment: self.comment,
            skip_lines: if self.skip_until.is_some() { 0 } else { self.skip_lines },
            skip_until: self.skip_until.clone(),
            header: self.header,
            x_column: x.map(|x| self.column(x)),
            x_spacing_um: None,
            x_unit: x.and_then(unit),
            z_column: self.column(z),
            z_unit: unit(z),
            invert_z: false,
            missing: default_missing().into_iter().chain(self.missing.clone()).collect(),
            encoding: self.encoding.into(),
            cut_start_mm: 0.0,
            cut_end_mm: 0.0,
        })
    }

    /// The section `[ingest.text]` of a recipe that would read the file; what the file does not
    /// say stands there as a comment that asks for it.
    pub fn recipe_section(&self) -> String {
        let mut text = String::from("[ingest.text]\n");
        let mut line = |line: String| {
            // Writing to a text does not fail.
            let _ = writeln!(text, "{line}");
        };
        line(format!("separator = {}", separator_text(self.separator)));
        if self.decimal_mark == DecimalMark::Comma {
            line("decimal_mark = \",\"".into());
        }
        if let Some(comment) = self.comment {
            line(format!("comment = {:?}", comment.to_string()));
        }
        match &self.skip_until {
            Some(marker) => line(format!("skip_until = {}", quoted(marker))),
            None if self.skip_lines > 0 => line(format!("skip_lines = {}", self.skip_lines)),
            None => {}
        }
        if !self.header {
            line("header = false".into());
        }
        let (x, z) = self.proposed_columns();
        match x {
            Some(x) => {
                line(format!("x_column = {}", self.column_text(x)));
                line(unit_text("x_unit", self.columns[x].unit));
            }
            None => {
                line("# x_spacing_um = ?            # the file does not say it by column".into())
            }
        }
        line(format!("z_column = {}", self.column_text(z)));
        line(unit_text("z_unit", self.columns[z].unit));
        if !self.missing.is_empty() {
            let marks = default_missing().into_iter().chain(self.missing.clone());
            let marks: Vec<String> = marks.map(|mark| quoted(&mark)).collect();
            line(format!("missing = [{}]", marks.join(", ")));
        }
        if self.encoding != "utf-8" {
            line(format!("encoding = \"{}\"", self.encoding));
        }
        text
    }

    /// Numbers, from 0, of the columns of positions and heights: positions grow, heights are the
    /// last column that does not, and columns with a unit come before those without.
    pub fn proposed_columns(&self) -> (Option<usize>, usize) {
        let growing: Vec<usize> =
            (0..self.columns.len()).filter(|&i| self.columns[i].grows).collect();
        let with_unit = |i: &&usize| self.columns[**i].unit.is_some();
        let x = match self.columns.len() {
            1 => None,
            _ => growing.iter().find(with_unit).or(growing.first()).copied(),
        };
        let others: Vec<usize> =
            (0..self.columns.len()).filter(|i| Some(*i) != x && !growing.contains(i)).collect();
        let z = others.iter().rev().find(with_unit).or(others.last()).copied();
        let last = self.columns.len() - 1;
        (x, z.unwrap_or(if x == Some(last) { 0 } else { last }))
    }

    /// A column by its name, by its number where that tells it better.
    fn column(&self, number: usize) -> Column {
        let name = &self.columns[number].name;
        let unique = self.columns.iter().filter(|column| column.name == *name).count() == 1;
        if self.header && unique && !name.is_empty() {
            Column::Name(name.clone())
        } else {
            Column::Number(number + 1)
        }
    }

    fn column_text(&self, number: usize) -> String {
        match self.column(number) {
            Column::Name(name) => quoted(&name),
            Column::Number(number) => number.to_string(),
        }
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A unit as the recipe writes it.
pub fn unit_name(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Nm => "nm",
        LengthUnit::Um => "um",
        LengthUnit::Mm => "mm",
        LengthUnit::M => "m",
    }
}

fn unit_text(key: &str, unit: Option<LengthUnit>) -> String {
    match unit {
        Some(unit) => format!("{key} = \"{}\"", unit_name(unit)),
        None => {
            format!("# {key} = ?                  # the column does not state it: nm, um, mm or m")
        }
    }
}

/// A separator as the recipe writes it.
pub fn separator_text(separator: Separator) -> &'static str {
    match separator {
        Separator::Tab => "\"tab\"",
        Separator::Comma => "\"comma\"",
        Separator::Semicolon => "\"semicolon\"",
        Separator::Whitespace | Separator::Character(_) => "\"whitespace\"",
    }
}

/// A way to take lines apart.
#[derive(Debug, Clone, Copy)]
struct Layout {
    separator: Separator,
    mark: DecimalMark,
}

/// Lines of points.
struct Body {
    /// Place of the first, from 0.
    start: usize,
    /// Numbers of each line, NaN where missing.
    rows: Vec<Vec<f64>>,
    /// Whether thousands are separated in one of them.
    thousands: bool,
}

impl Body {
    fn at(start: usize) -> Self {
        Self { start, rows: Vec::new(), thousands: false }
    }
}

impl Layout {
    fn is_possible(self) -> bool {
        (self.separator, self.mark) != (Separator::Comma, DecimalMark::Comma)
    }

    fn cells(self, line: &str) -> Vec<String> {
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

    fn numbers(self, line: &str) -> Option<Vec<f64>> {
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

    fn number(self, cell: &str) -> Option<f64> {
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

    /// Goes on with the points where the first lines end.
    fn extend(self, body: &mut Body, lines: &[&str]) {
        let width = body.rows[0].len();
        let next = body.start + body.rows.len();
        let points = |line: &&str| self.numbers(line).or_else(|| self.marked_numbers(line, width));
        let further = lines.iter().skip(next).map_while(points);
        body.rows.extend(further.take_while(|row| row.len() == width));
    }

    /// Takes in lines right before the points whose height is marked by a word that is not known.
    fn go_back(self, body: &mut Body, lines: &[&str]) {
        let width = body.rows[0].len();
        let before = lines[..body.start].iter().rev();
        let marked: Vec<_> = before.map_while(|line| self.marked_numbers(line, width)).collect();
        body.start -= marked.len();
        body.rows.splice(..0, marked.into_iter().rev());
    }

    /// The longest run of lines of equally many numbers.
    fn body(self, lines: &[&str]) -> Option<Body> {
        let (mut longest, mut current) = (Body::at(0), Body::at(0));
        for (index, line) in lines.iter().enumerate() {
            let width = current.rows.first().map(Vec::len);
            let marked = || width.and_then(|width| self.marked_numbers(line, width));
            match self.numbers(line).or_else(marked) {
                Some(row) if width == Some(row.len()) => {
                    current.rows.push(row);
                }
                Some(row) if row.iter().any(|number| number.is_finite()) => {
                    let next = Body { rows: vec![row], ..Body::at(index) };
                    longest = longer(longest, std::mem::replace(&mut current, next));
                }
                _ => {
                    let none = Body::at(index);
                    longest = longer(longest, std::mem::replace(&mut current, none));
                }
            }
            current.thousands |= !current.rows.is_empty() && self.has_thousands(line);
        }
        Some(longer(longest, current)).filter(|body| body.rows.len() > 1)
    }
}

fn longer(first: Body, second: Body) -> Body {
    if second.rows.len() > first.rows.len() { second } else { first }
}

/// The first of the greatest elements; that of the standard library is the last.
trait FirstMax: Iterator + Sized {
    fn rev_max_by_key<K: Ord>(self, key: impl Fn(&Self::Item) -> K) -> Option<Self::Item> {
        self.reduce(|best, next| if key(&next) > key(&best) { next } else { best })
    }
}

impl<I: Iterator> FirstMax for I {}

fn describe(encoding: &'static str, layout: Layout, body: &Body, lines: &[&str]) -> TextShape {
    let width = body.rows[0].len();
    let before = &lines[..body.start];
    let names = before.last().filter(|line| !line.trim().is_empty()).map(|line| layout.cells(line));
    let comment = comment_of(before);
    let named = names.filter(|names| {
        names.len() >= width && !before.last().is_some_and(|l| is_comment(l, comment))
    });
    // A separator at the end of the line makes an empty column.
    let header = named.is_some();
    let names = named.unwrap_or_default();
    let preamble = &before[..before.len() - usize::from(header)];
    let commented = comment.is_some() && preamble.iter().all(|line| is_comment(line, comment));
    let marker = preamble.last().map(|line| line.trim());
    let skip_until = marker.filter(|line| !commented && is_marker(line)).map(str::to_owned);
    let above = preamble.last().filter(|line| header && !is_comment(line, comment));
    let above = above
        .map(|line| layout.cells(line))
        .filter(|cells| cells.len() >= width)
        .unwrap_or_default();
    let column = |number: usize| {
        let name = names.get(number).cloned().unwrap_or_default();
        let values: Vec<f64> = body.rows.iter().map(|row| row[number]).collect();
        TextColumn {
            unit: unit_in(&name)
                .or_else(|| unit_of_two(above.get(number).map_or("", String::as_str), &name)),
            grows: grows(&values),
            name,
        }
    };
    let shape = TextShape {
        encoding,
        separator: layout.separator,
        decimal_mark: layout.mark,
        comment: comment.filter(|_| commented),
        skip_lines: if commented { 0 } else { preamble.len() },
        skip_until,
        header,
        columns: (0..width).map(column).collect(),
        rows: body.rows.len(),
        stated: preamble
            .iter()
            .filter(|line| states_unit(line))
            .map(|l| l.trim().to_owned())
            .collect(),
        missing: Vec::new(),
        thousands: None,
    };
    let (_, z) = shape.proposed_columns();
    let numbers: Vec<f64> = body.rows.iter().map(|row| row[z]).collect();
    let points = &lines[body.start..body.start + body.rows.len()];
    let heights = || points.iter().filter_map(|line| layout.cells(line).into_iter().nth(z));
    let is_word = |cell: &String| layout.number(cell).is_none_or(f64::is_nan);
    let mut missing = missing::words(heights().filter(is_word));
    let far = missing::numbers(&numbers);
    let inside = repeated_inside(&numbers).into_iter().map(|mark| mark.height);
    let inside: Vec<f64> = inside.filter(|mark| !far.contains(mark)).collect();
    missing.extend(far.into_iter().chain(inside).map(missing::mark_text));
    let mut cells = points.iter().take(MOST_LINES).flat_map(|line| layout.cells(line));
    let thousands = cells.find(|cell| thousands_mark(cell, layout.mark).is_some());
    TextShape { missing, thousands, ..shape }
}

/// Whether numbers are positions, of which some may be there two or three times.
fn grows(values: &[f64]) -> bool {
    let steps = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    3 * steps >= values.len() - 1 && values.windows(2).all(|pair| pair[1] >= pair[0])
}

fn comment_of(preamble: &[&str]) -> Option<char> {
    let first = preamble.iter().find_map(|line| line.trim_start().chars().next())?;
    ['#', '%', '!', ';'].contains(&first).then_some(first)
}

fn is_comment(line: &str, comment: Option<char>) -> bool {
    line.trim().is_empty() || comment.is_some_and(|comment| line.trim_start().starts_with(comment))
}

/// Whether a line before the data is a mark such as `*****DATA*****` or `[Data]`.
fn is_marker(line: &str) -> bool {
    let ends = |c: char| "*[]-=<>#:".contains(c);
    line.starts_with(ends) && line.ends_with(ends) && line.chars().any(char::is_alphabetic)
}

/// The unit in a name: `x (mm)`, `z [µm]`, `x_mm`, `Depth mm`.
fn unit_in(name: &str) -> Option<LengthUnit> {
    let parts: Vec<&str> =
        name.split(|c: char| "()[]{}/_, ".contains(c)).filter(|part| !part.is_empty()).collect();
    // A lone letter is the name of a quantity more often than the metre.
    if parts.len() < 2 {
        return None;
    }
    match parts.last()?.to_lowercase().as_str() {
        "nm" => Some(LengthUnit::Nm),
        "um" | "\u{b5}m" | "\u{3bc}m" => Some(LengthUnit::Um),
        "mm" => Some(LengthUnit::Mm),
        "m" => Some(LengthUnit::M),
        _ => None,
    }
}

/// The unit in two lines of names, of which either may hold it: `x` above `mm`, `x (mm)` above `1`.
fn unit_of_two(above: &str, name: &str) -> Option<LengthUnit> {
    if above.is_empty() {
        return None;
    }
    unit_in(&format!("{above} {name}")).or_else(|| unit_in(above))
}

fn states_unit(line: &str) -> bool {
    let words = line.split(|c: char| c.is_whitespace() || "()[],;=".contains(c));
    let lower = line.to_lowercase();
    words
        .map(str::to_lowercase)
        .any(|word| ["nm", "um", "\u{b5}m", "\u{3bc}m", "mm"].contains(&&*word))
        || (lower.contains("unit") && lower.trim_end().ends_with('m'))
}
