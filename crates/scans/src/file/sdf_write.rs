//! SDF files from scans.

use super::{Grid, ScanFile};
use std::fmt::Write;

/// A text SDF file, version `aISO-1.0`: heights in metres as 64-bit numbers with all their digits,
/// `BAD` where missing. Of the instrument it has a place for ten letters of the manufacturer and
/// for dates of twelve digits.
pub fn write(scan: &ScanFile) -> String {
    let (columns, rows, x, y) = match scan.grid {
        Grid::Profile { spacing } => (scan.heights.len(), 1, spacing, 0.0),
        Grid::Map { columns, rows, spacing_x, spacing_y } => (columns, rows, spacing_x, spacing_y),
    };
    let known = |wanted: &str| {
        scan.instrument.iter().find(|(name, _)| name == wanted).map_or("", |(_, value)| value)
    };
    let manufacturer: String = known("manufacturer")
        .chars()
        .filter(|c| c.is_ascii_graphic() && *c != '*')
        .take(10)
        .collect();
    let date = |name| {
        let text = known(name);
        let digits = text.len() == 12 && text.bytes().all(|byte| byte.is_ascii_digit());
        if digits { text } else { "000000000000" }
    };
    // A negative resolution of z is an unknown one; type 7 are 64-bit numbers.
    let mut text = format!(
        "aISO-1.0\r\nManufacID = {}\r\nCreateDate = {}\r\nModDate = {}\r\nNumPoints = {columns}\r\n\
         NumProfiles = {rows}\r\nXscale = {x:e}\r\nYscale = {y:e}\r\nZscale = 1\r\nZresolution = -1\r\n\
         Compression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n",
        if manufacturer.is_empty() { "asperity" } else { &manufacturer },
        date("created"),
        date("modified"),
    );
    for height in &scan.heights {
        // Writing to a text does not fail.
        let _ = match height {
            height if height.is_nan() => text.write_str("BAD\r\n"),
            height => write!(text, "{height:e}\r\n"),
        };
    }
    text + "*\r\n"
}
