//! Parsers of single option values.

use std::str::FromStr;

use serde::de::{DeserializeOwned, value::Error};
use serde::de::{IntoDeserializer, value::StrDeserializer};

use asperity::contact::refine::{TOLERANCES, TOLERANCES_IN_WORDS};
use asperity::files::nearest;
use asperity::scans::description::{Column, DecimalMark, LengthUnit, Separator};

/// A finite number; `NaN` and `inf` are refused.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim();
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{number}` is not a finite number")),
        Err(_) if number.contains(',') => {
            Err(format!("`{number}` is not a number: the decimal mark is a point"))
        }
        Err(_) if number.ends_with('%') => {
            Err(format!("`{number}` is not a number: give a fraction (5 % is 0.05)"))
        }
        Err(_) if number.starts_with(|c: char| c.is_ascii_digit()) => Err(format!(
            "`{number}` is not a number: give it without a unit, in the unit of the option"
        )),
        Err(_) => Err(format!("`{number}` is not a number")),
    }
}

/// A finite number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err(format!("{} is not positive", text.trim())),
    }
}

/// A whole number that is not negative.
pub(super) fn count<T: FromStr>(text: &str) -> Result<T, String> {
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    match text.parse() {
        Ok(value) if digits => Ok(value),
        _ if digits => Err(format!("{text} is too large")),
        _ => Err(format!("`{text}` is not a whole number of 0 or more, such as 1000")),
    }
}

/// A whole number of 1 or more.
pub(super) fn one_or_more<T: FromStr + Default + PartialEq>(text: &str) -> Result<T, String> {
    match count::<T>(text)? {
        zero if zero == T::default() => Err("0 is too few: give 1 or more".into()),
        number => Ok(number),
    }
}

/// One line of text for a job script.
pub(super) fn line(text: &str) -> Result<String, String> {
    match text.chars().any(char::is_control) || text.trim().is_empty() {
        true => Err("it must be one line of text, since it is written into the job script".into()),
        false => Ok(text.to_owned()),
    }
}

/// The number of a channel, of which the first is 1.
pub(super) fn channel(text: &str) -> Result<usize, String> {
    match count(text)? {
        0 => Err("0 is not a channel; the first is 1".into()),
        number => Ok(number),
    }
}

/// A share above 0 and below 1.
pub(super) fn fraction(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err(format!("{} is not between 0 and 1 (5 % is 0.05)", text.trim())),
    }
}

/// A relative accuracy within [`TOLERANCES`].
pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if TOLERANCES.contains(&value) => Ok(value),
        _ => Err(format!("{} is not {TOLERANCES_IN_WORDS}", text.trim())),
    }
}

/// Suggests the most similar of the known names, or lists all of them.
pub(super) fn meant(name: &str, known: &[&str]) -> String {
    nearest(name, known).map_or_else(
        || format!("there are {}", known.join(", ")),
        |nearest| format!("did you mean `{nearest}`?"),
    )
}

/// `nm`, `um`, `mm` or `m`.
pub(super) fn length_unit(text: &str) -> Result<LengthUnit, String> {
    one_of(text, "nm, um, mm or m")
}

/// `tab`, `comma`, `semicolon`, `whitespace` or one character.
pub(super) fn separator(text: &str) -> Result<Separator, String> {
    one_of(text, "tab, comma, semicolon, whitespace or one character")
}

/// `.` or `,`.
pub(super) fn decimal_mark(text: &str) -> Result<DecimalMark, String> {
    one_of(text, "`.` or `,`")
}

/// A column by number, the first is 1, or by name.
pub(super) fn column(text: &str) -> Result<Column, String> {
    Ok(text.parse().map_or_else(|_| Column::Name(text.to_owned()), Column::Number))
}

/// A value in the spelling of the recipe.
fn one_of<T: DeserializeOwned>(text: &str, choices: &str) -> Result<T, String> {
    let deserializer: StrDeserializer<'_, Error> = text.into_deserializer();
    T::deserialize(deserializer).map_err(|_| format!("choose {choices}"))
}
