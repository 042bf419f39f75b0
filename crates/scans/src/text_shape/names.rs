//! What the lines before the points say: names of columns, units, the mark where data begin.

use super::layout::{Body, Layout};
use crate::decode::lines;
use crate::description::LengthUnit;

/// Character that starts the lines before the points.
pub(super) fn comment_of(preamble: &[&str]) -> Option<char> {
    let first = preamble.iter().find_map(|line| line.trim_start().chars().next())?;
    ['#', '%', '!', ';'].contains(&first).then_some(first)
}

pub(super) fn is_comment(line: &str, comment: Option<char>) -> bool {
    line.trim().is_empty() || comment.is_some_and(|comment| line.trim_start().starts_with(comment))
}

/// The last line before the columns where it marks the start of the data, such as
/// `*****DATA*****`, `[Data]` or `Scan Data`, and no line before it begins alike.
pub(super) fn marker(preamble: &[&str], cells: impl Fn(&str) -> Vec<String>) -> Option<String> {
    let (line, before) = preamble.split_last()?;
    let written: Vec<String> = cells(line).into_iter().filter(|cell| !cell.is_empty()).collect();
    let line = line.trim();
    let text = match written.as_slice() {
        _ if is_framed(line) => line,
        [cell] if says_data(cell) && line.starts_with(cell.as_str()) => cell.as_str(),
        // Between blanks every word is a cell.
        _ if says_data(line) && line.split_whitespace().count() <= 3 => line,
        _ => return None,
    };
    let alone = before.iter().all(|line| !line.trim_start().starts_with(text));
    alone.then(|| text.to_owned())
}

/// The beginning of the first line after the points that is not blank, up to its first digit. `None` if that line is a
/// comment or begins with a number, or if more points follow: a line between points is a fault for the reader to report.
pub(super) fn footer(
    text: &str,
    layout: Layout,
    body: &Body,
    comment: Option<char>,
) -> Option<String> {
    /// The start of a sentence is enough.
    const LONGEST: usize = 40;
    let behind = || lines(text).skip(body.start + body.rows());
    let line = behind().map(str::trim).find(|line| line.chars().any(char::is_alphanumeric))?;
    let is_point =
        |line: &str| layout.numbers(line).is_some_and(|numbers| numbers.len() == body.width);
    if is_comment(line, comment) || behind().any(is_point) {
        return None;
    }
    let words: String = line.chars().take(LONGEST).take_while(|c| !c.is_ascii_digit()).collect();
    let start = words.trim_end_matches(|c: char| !c.is_alphabetic() && !"*[]-=<>#".contains(c));
    start.chars().any(char::is_alphabetic).then(|| start.to_owned())
}

fn is_framed(line: &str) -> bool {
    let ends = |c: char| "*[]-=<>#:".contains(c);
    line.starts_with(ends) && line.ends_with(ends) && line.chars().any(char::is_alphabetic)
}

fn says_data(line: &str) -> bool {
    const WORDS: [&str; 8] =
        ["data", "daten", "messdaten", "messwerte", "donn\u{e9}es", "dati", "datos", "values"];
    let mut words = line.split(|c: char| !c.is_alphabetic()).map(str::to_lowercase);
    line.chars().all(|c| !c.is_ascii_digit()) && words.any(|word| WORDS.contains(&word.as_str()))
}

/// Words of a line between blanks, of which units in brackets go with the word before them.
pub(super) fn regrouped(words: Vec<String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for word in words {
        match names.last_mut() {
            Some(name) if word.starts_with(['(', '[', '/']) => {
                name.push(' ');
                name.push_str(&word);
            }
            _ => names.push(word),
        }
    }
    names
}

/// The unit in a name: `x (mm)`, `z [\u{b5}m] raw`, `x_mm`, `Depth mm`, `Raw Micrometer`.
pub(super) fn unit_in(name: &str) -> Option<LengthUnit> {
    let parts = |text: &str| -> Vec<String> {
        text.split(|c: char| "()[]{}/_, \u{a0}".contains(c))
            .filter(|part| !part.is_empty())
            .map(str::to_lowercase)
            .collect()
    };
    let bracketed = name.split(['(', '[', '{']).skip(1);
    let bracketed = bracketed.filter_map(|text| text.split([')', ']', '}']).next());
    if let Some(unit) = bracketed.filter_map(|text| unit_of(parts(text).last()?)).last() {
        return Some(unit);
    }
    let parts = parts(name);
    // A lone letter is the name of a quantity more often than the metre.
    if parts.len() < 2 {
        return None;
    }
    unit_of(parts.last()?)
}

fn unit_of(word: &str) -> Option<LengthUnit> {
    match word {
        "nm" | "nanometer" | "nanometers" | "nanometre" | "nanometres" => Some(LengthUnit::Nm),
        // The micro sign, the Greek letter, and what a wrong encoding makes of them.
        "um" | "\u{b5}m" | "\u{3bc}m" | "\u{e6}m" | "\u{fffd}m" => Some(LengthUnit::Um),
        "micron" | "microns" | "micrometer" | "micrometers" | "micrometre" | "micrometres" => {
            Some(LengthUnit::Um)
        }
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Some(LengthUnit::Mm),
        "m" | "meter" | "meters" | "metre" | "metres" => Some(LengthUnit::M),
        _ => None,
    }
}

/// The unit in two lines of names, of which either may hold it: `x` above `mm`, `x (mm)` above `1`.
pub(super) fn unit_of_two(above: &str, name: &str) -> Option<LengthUnit> {
    if above.is_empty() {
        return None;
    }
    unit_in(&format!("{above} {name}")).or_else(|| unit_in(above))
}

pub(super) fn states_unit(line: &str) -> bool {
    let words = line.split(|c: char| c.is_whitespace() || "()[],;=".contains(c));
    let lower = line.to_lowercase();
    words
        .map(str::to_lowercase)
        .any(|word| ["nm", "um", "\u{b5}m", "\u{3bc}m", "mm"].contains(&&*word))
        || (lower.contains("unit") && lower.trim_end().ends_with('m'))
}
