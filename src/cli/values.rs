//! Parsers of single option values.

use std::str::FromStr;

use serde::de::{DeserializeOwned, value::Error};
use serde::de::{IntoDeserializer, value::StrDeserializer};

use crate::scans::description::{Column, DecimalMark, LengthUnit, Separator};

/// A number that is finite; `NaN` and `inf` are no quantities.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim();
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{number}` is no finite number")),
        Err(_) if number.contains(',') => {
            Err(format!("`{number}` is no number; the decimal mark is a point"))
        }
        Err(_) => Err(format!("`{number}` is no number")),
    }
}

/// A finite number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 => Ok(value),
        value => Err(format!("{value} is not positive")),
    }
}

/// A whole number that is not negative.
pub(super) fn count<T: FromStr>(text: &str) -> Result<T, String> {
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    match text.parse() {
        Ok(value) if digits => Ok(value),
        _ if digits => Err(format!("{text} is too large")),
        _ => Err(format!("`{text}` is no whole number of 0 or more")),
    }
}

/// The number of a channel, of which the first is 1.
pub(super) fn channel(text: &str) -> Result<usize, String> {
    match count(text)? {
        0 => Err("0 is no channel; the first is 1".into()),
        number => Ok(number),
    }
}

/// A share above 0 and below 1.
pub(super) fn fraction(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 && value < 1.0 => Ok(value),
        value => Err(format!("{value} is not between 0 and 1 (5 % is 0.05)")),
    }
}

/// A relative accuracy, from that of double precision up to a half.
pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if (1e-8..=0.5).contains(&value) => Ok(value),
        value => Err(format!("{value} is not between 1e-8 and 0.5 (0.1 % is 0.001)")),
    }
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

/// The value that the recipe writes in the same way.
fn one_of<T: DeserializeOwned>(text: &str, choices: &str) -> Result<T, String> {
    let deserializer: StrDeserializer<'_, Error> = text.into_deserializer();
    T::deserialize(deserializer).map_err(|_| format!("choose {choices}"))
}
