//! What is wrong with a TOML file, in words for those who write recipes: line and column, what was typed, what
//! to write instead. The parser speaks of types of Rust and repeats itself.

use std::fmt;

/// Names less alike than this are not misspellings of each other (Jaro and Winkler, 1 being equal).
const ALIKE: f64 = 0.8;
/// Longer lines are shown up to here.
const LONGEST_LINE: usize = 100;

/// A mistake in a TOML file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlError {
    /// Line and column from 1; `None` if something is missing from the file.
    place: Option<(usize, usize)>,
    /// The line as it was typed.
    line: String,
    /// What is wrong and what to do.
    problem: String,
}

impl TomlError {
    /// The mistake that the parser found in `text`.
    pub fn new(text: &str, error: &toml::de::Error) -> Self {
        let start = error.span().map_or(0, |span| span.start).min(text.len());
        let before = text.get(..start).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let line: String = text[line_start..].lines().next().unwrap_or_default().to_owned();
        let column = before[line_start..].chars().count() + 1;
        let typed = error.span().and_then(|span| text.get(span)).unwrap_or_default().trim();
        let message = error.message();
        let problem = in_words(message, typed, &line);
        let of_whole_file = message.starts_with("missing field") && start == 0;
        let number = before.matches('\n').count() + 1;
        let place = (!of_whole_file).then_some((number, column));
        Self { place, line: if of_whole_file { String::new() } else { line }, problem }
    }
}

impl fmt::Display for TomlError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((line, column)) = self.place {
            write!(out, ", line {line}, column {column}")?;
        }
        write!(out, ": {}", self.problem)?;
        let line = self.line.trim_end();
        if line.trim().is_empty() {
            return Ok(());
        }
        let shown: String = line.chars().take(LONGEST_LINE).collect();
        let more = if line.chars().nth(LONGEST_LINE).is_some() { "..." } else { "" };
        write!(out, "\n  {shown}{more}")
    }
}

/// The message of the parser in plain words; one that is not known here is passed on.
fn in_words(message: &str, typed: &str, line: &str) -> String {
    let message = message.trim();
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if let Some(name) = quoted.first() {
        if message.starts_with("unknown field") {
            return unknown("key", name, &quoted[1..]);
        }
        if message.starts_with("unknown variant") {
            return unknown("value", name, &quoted[1..]);
        }
        if message.starts_with("missing field") {
            return format!("the key `{name}` is missing here: add it");
        }
    }
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    if let Some((_, expected)) = message.rsplit_once("expected ")
        && message.starts_with("invalid ")
        && let Some(wanted) = wanted(expected)
    {
        return format!("{typed} is not {wanted}{}", advice(expected, typed));
    }
    if message.starts_with("data did not match any variant") {
        let wanted = match message.rsplit(' ').next() {
            Some("Separator") => "tab, comma, semicolon, whitespace or a single character",
            Some("Column") => "the name of a column in quotes, or its number",
            _ => "another value, see the documentation of the key",
        };
        return format!("{typed} is not known here: give {wanted}");
    }
    if message.starts_with("duplicate key") {
        return format!("`{typed}` occurs twice in this section: delete one of the two");
    }
    if message.contains("overflow") {
        return format!("{typed} is too large for a number");
    }
    if message.starts_with("key with no value") {
        return "this line is not of the form `key = value`, as the lines of a TOML file are"
            .into();
    }
    if is_decimal_comma(value) {
        return format!("{value} is not a number: the decimal mark is a point, not a comma");
    }
    if value.ends_with('%') || message.starts_with("string values must be quoted") {
        return format!(
            "{value} is not a value: numbers are written without unit or percent sign (5 % is 0.05), texts in quotes"
        );
    }
    message.replace('\n', ", ")
}

/// An unknown name, with the one that was meant or else all that could have been.
fn unknown(what: &str, name: &str, known: &[&str]) -> String {
    match nearest(name, known) {
        Some(nearest) => format!("unknown {what} `{name}`; did you mean `{nearest}`?"),
        None => format!("unknown {what} `{name}`; known here are {}", known.join(", ")),
    }
}

/// The known name that is the most like another one, if any is.
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let alike = |known: &&str| strsim::jaro_winkler(name, known);
    let candidates = known.iter().copied().filter(|known| alike(known) >= ALIKE);
    candidates.max_by(|a, b| alike(a).total_cmp(&alike(b)))
}

/// What a type of the parser is called.
fn wanted(expected: &str) -> Option<&'static str> {
    let expected = expected.split(" or ").next().unwrap_or_default().trim();
    Some(match expected {
        "f64" | "f32" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of 0 or more",
        "i32" | "i64" => "a whole number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "path string" => "a path in quotes",
        "a character" => "a single character in quotes",
        "a sequence" => "a list",
        _ if expected.starts_with("an array of length 2") => "a list of two values",
        _ if expected.starts_with("struct ") || expected == "a map" => "a section of keys",
        _ => return None,
    })
}

/// What to write instead of the value.
fn advice(expected: &str, typed: &str) -> String {
    let inner = typed.trim_matches(['"', '\'']);
    match expected {
        "f64" | "f32" if inner != typed && inner.parse::<f64>().is_ok() => {
            format!(": write {inner}, without quotes")
        }
        "f64" | "f32" if inner != typed => {
            ": write it without quotes, with a decimal point and in the unit of its key".into()
        }
        "a sequence" if !typed.is_empty() => format!(": write [{typed}]"),
        "a string" | "path string" => format!(": write \"{typed}\""),
        _ => String::new(),
    }
}

/// Whether a value is a number with a decimal comma.
fn is_decimal_comma(value: &str) -> bool {
    let mut parts = value.split(',');
    let number = |part: Option<&str>| part.is_some_and(|part| part.trim().parse::<f64>().is_ok());
    let (whole, fraction) = (number(parts.next()), number(parts.next()));
    whole && fraction && parts.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Section {
        tolerance: f64,
        #[serde(default)]
        speeds: Vec<f64>,
        #[serde(default)]
        count: u32,
        #[serde(default)]
        rubber: std::path::PathBuf,
    }

    fn told(text: &str) -> String {
        TomlError::new(text, &toml::from_str::<Section>(text).unwrap_err()).to_string()
    }

    #[test]
    fn every_mistake_has_its_line_what_was_typed_and_a_way_out() {
        let cases = [
            (
                "tolerance = '5e-3'",
                ", line 1, column 13: '5e-3' is not a number: write 5e-3, without quotes",
            ),
            (
                "tolerance = 0,005",
                ": 0,005 is not a number: the decimal mark is a point, not a comma",
            ),
            (
                "tolerance = 5%",
                ": 5% is not a value: numbers are written without unit or percent sign",
            ),
            ("tolerance = 1e400", ": 1e400 is too large for a number"),
            (
                "tolerence = 1",
                ": unknown key `tolerence`; did you mean `tolerance`?\n  tolerence = 1",
            ),
            ("xyz = 1", ": unknown key `xyz`; known here are tolerance, speeds, count, rubber"),
            ("tolerance = 1\ntolerance = 2", ", line 2, column 1: `tolerance` occurs twice"),
            ("tolerance = 1\nspeeds = 10", ", line 2, column 10: 10 is not a list: write [10]"),
            (
                "tolerance = 1\nspeeds = ['10 mm/s']",
                ": '10 mm/s' is not a number: write it without quotes",
            ),
            ("tolerance = 1\ncount = -1", ": -1 is not a whole number of 0 or more"),
            ("tolerance = 1\ncount = 2.5", ": 2.5 is not a whole number of 0 or more"),
            ("tolerance = 1\nrubber = 3", ": 3 is not a path in quotes: write \"3\""),
            ("count = 1", ": the key `tolerance` is missing here: add it"),
            ("x_mm;z_um", "this line is not of the form `key = value`"),
        ];
        for (text, part) in cases {
            let told = told(text);
            assert!(told.contains(part), "{text}: {told}");
            let line = text.lines().last().unwrap();
            assert!(told.matches(line).count() <= 1, "twice: {told}");
        }
    }

    #[test]
    fn long_lines_are_cut() {
        let told = told(&format!("tolerance = '{}'", "x".repeat(5000)));
        assert!(told.lines().last().unwrap().ends_with("..."), "{told}");
    }
}
