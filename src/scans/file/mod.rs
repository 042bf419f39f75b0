//! Files of instruments, which state their own units and spacing.
//!
//! | format | what it is | standard |
//! |---|---|---|
//! | SDF | surface data file, text or binary | ISO 25178-71, EUR 15178 (BCR) |
//! | X3P | zip archive of XML and binary data | ISO 25178-72, ISO 5436-2 |
//! | Digital Surf | `.sur` and `.pro`, compressed or not | manual of the software |
//! | ERD | longitudinal road profile, text | ERD file specification, UMTRI |
//! | Gwyddion text | height map as text with its size and unit | manual of the software |
//! | Wyko ASCII | height map as text with its pixel and wavelength | as Gwyddion reads it |
//! | OpenCRG | grid of a road, text or binary | ASAM OpenCRG 1.2 |
//! | SMATS | profile as XML | NIST surface metrology data base |
//!
//! The format is told by the content; the name of the file does not matter. Every size that a
//! file declares is compared with what the file holds before memory is asked for.

mod bytes;
mod digital_surf;
mod erd;
pub mod error;
mod foreign;
mod gwyddion;
mod opencrg;
mod sdf;
mod sdf_write;
mod smats;
#[cfg(test)]
mod tests;
mod wyko_ascii;
mod x3p;

pub use error::{FileError, FileProblem, Place};
pub use foreign::foreign;
pub use sdf_write::write as write_sdf;
pub use x3p::write as write_x3p;

use crate::scans::spreadsheet::is_workbook;
use crate::surface::RawScan;
use error::unexpected;
use std::path::Path;

/// Largest number of points of a file, 2 GB of heights in memory.
pub const LARGEST_POINTS: u64 = 1 << 28;

/// First bytes by which a family is told.
pub const DETECTED_BY: usize = 1 << 16;

/// Family of instrument files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Surface data file.
    Sdf,
    /// XML 3-D surface profile.
    X3p,
    /// Digital Surf surface or profile.
    DigitalSurf,
    /// Road profile of the Engineering Research Division.
    Erd,
    /// Image as text from Gwyddion.
    Gwyddion,
    /// Height map as text of an interferometer.
    WykoAscii,
    /// Curved regular grid of a road.
    OpenCrg,
    /// Profile as XML of the data base SMATS.
    Smats,
}

impl Family {
    /// The family by the first bytes, `None` for all else.
    pub fn detect(start: &[u8]) -> Option<Self> {
        let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
        if sdf::Version::detect(start).is_some() {
            Some(Self::Sdf)
        } else if start.starts_with(b"PK\x03\x04") {
            Some(Self::X3p)
        } else if digital_surf::is_signature(start) {
            Some(Self::DigitalSurf)
        } else if text.get(..10).is_some_and(|magic| magic.eq_ignore_ascii_case(b"ERDFILEV2.")) {
            Some(Self::Erd)
        } else if gwyddion::is_header(text) {
            Some(Self::Gwyddion)
        } else if wyko_ascii::is_signature(text) {
            Some(Self::WykoAscii)
        } else if opencrg::is_header(text) {
            Some(Self::OpenCrg)
        } else if smats::is_header(&text[..text.len().min(DETECTED_BY)]) {
            Some(Self::Smats)
        } else {
            None
        }
    }
}

/// Points on a line or on a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grid {
    /// A line scan.
    Profile {
        /// Distance between neighbouring points in metres.
        spacing: f64,
    },
    /// A height map of rows along x.
    Map {
        /// Points of a row.
        columns: usize,
        /// Number of rows.
        rows: usize,
        /// Distance between neighbouring points of a row in metres.
        spacing_x: f64,
        /// Distance between neighbouring rows in metres.
        spacing_y: f64,
    },
}

/// What an instrument file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanFile {
    /// Name of the format with its variant, such as `SDF bISO-1.0`.
    pub format: String,
    /// How it was told, in words, with what of the file was decisive.
    pub detected: String,
    /// Spacing and shape.
    pub grid: Grid,
    /// Heights in metres, row after row; NaN where missing.
    pub heights: Vec<f64>,
    /// What the file says of the instrument and the measurement: name and value.
    pub instrument: Vec<(String, String)>,
}

/// Which lines of a height map are taken as line scans.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum MapLines {
    /// The rows, along x.
    Rows,
    /// The columns, along y.
    Columns,
}

impl ScanFile {
    /// Number of points without a height.
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|height| height.is_nan()).count()
    }

    /// Mean of the heights that are there, in metres.
    pub fn mean(&self) -> f64 {
        let valid = (self.heights.len() - self.missing()) as f64;
        self.heights.iter().filter(|height| !height.is_nan()).sum::<f64>() / valid
    }

    /// Standard deviation of the heights that are there about their mean, of the population, in
    /// metres.
    pub fn standard_deviation(&self) -> f64 {
        let mean = self.mean();
        let valid = (self.heights.len() - self.missing()) as f64;
        let squares =
            self.heights.iter().filter(|height| !height.is_nan()).map(|z| (z - mean).powi(2));
        (squares.sum::<f64>() / valid).sqrt()
    }

    /// The profile, or every `step`-th row or column of a map that holds a height, as line scans;
    /// those of a map are named `name_row_0000` and so on, by their number in the file.
    pub fn line_scans(&self, name: &str, lines: MapLines, step: usize) -> Vec<RawScan> {
        let line = |name: String, spacing: f64, heights: Vec<f64>| RawScan {
            name,
            positions: (0..heights.len()).map(|i| i as f64 * spacing).collect(),
            heights,
        };
        let (columns, rows, spacing_x, spacing_y) = match self.grid {
            Grid::Profile { spacing } => {
                return vec![line(name.to_owned(), spacing, self.heights.clone())];
            }
            Grid::Map { columns, rows, spacing_x, spacing_y } => {
                (columns, rows, spacing_x, spacing_y)
            }
        };
        let (word, count, spacing) = match lines {
            MapLines::Rows => ("row", rows, spacing_x),
            MapLines::Columns => ("column", columns, spacing_y),
        };
        let heights = |number: usize| -> Vec<f64> {
            match lines {
                MapLines::Rows => self.heights[number * columns..(number + 1) * columns].to_vec(),
                MapLines::Columns => {
                    self.heights.iter().skip(number).step_by(columns).copied().collect()
                }
            }
        };
        (0..count)
            .step_by(step.max(1))
            .map(|number| line(format!("{name}_{word}_{number:04}"), spacing, heights(number)))
            .filter(|scan| scan.heights.iter().any(|height| !height.is_nan()))
            .collect()
    }

    /// Checks what all formats have in common.
    fn checked(self) -> Result<Self, FileProblem> {
        // Absolute elevations of roads are heights as well; all beyond is a mark or a wrong unit.
        const LARGEST_HEIGHT_M: f64 = 1e4;
        let absurd = |height: &f64| height.abs() > LARGEST_HEIGHT_M;
        if let Some(index) = self.heights.iter().position(absurd) {
            let found = format!("{:e} m", self.heights[index]);
            let expected = "a height below 10 km or a mark of missing points of the format";
            return Err(unexpected(Place::Height(index + 1), "the value", found, expected));
        }
        match self.heights.len() {
            points if points == self.missing() => Err(FileProblem::AllMissing { points }),
            _ => Ok(self),
        }
    }
}

/// A spacing in metres, if it is one of a scan: from an atomic force microscope to a survey of
/// longitudinal evenness.
fn spacing(place: Place, metres: f64) -> Result<f64, FileProblem> {
    if (1e-12..=10.0).contains(&metres) {
        return Ok(metres);
    }
    let expected = "between 1e-12 m and 10 m; check spacing and unit in the instrument's software";
    Err(unexpected(place, "the spacing of the points in m", format!("{metres:e}"), expected))
}

/// Reads an instrument file; `None` if it is of none of the families.
///
/// # Errors
/// [`FileError`] with the path, the place and what was expected there.
pub fn read_file(path: &Path) -> Result<Option<ScanFile>, FileError> {
    let bytes = super::read_bytes(path)
        .map_err(|error| FileError { file: path.display().to_string(), problem: error.into() })?;
    parse_file("", &bytes).map_err(|error| error.in_file(path))
}

/// Reads the bytes of an instrument file; `None` if they are of none of the families: text, or a
/// workbook, which a description goes with.
///
/// # Errors
/// [`FileError`] that tells of the file as `name`; files of kinds that are known and not read are
/// named with the way out ([`FileProblem::Foreign`]).
pub fn parse_file(name: &str, bytes: &[u8]) -> Result<Option<ScanFile>, FileError> {
    let failed = |problem| FileError { file: name.to_owned(), problem };
    let Some(family) = Family::detect(bytes) else {
        return foreign(bytes).map_or(Ok(None), |problem| Err(failed(problem)));
    };
    if family == Family::X3p {
        if is_workbook(bytes) {
            return Ok(None);
        }
        if let Some(problem) = foreign::foreign_archive(bytes) {
            return Err(failed(problem));
        }
    }
    let read = match family {
        Family::Sdf => sdf::read(bytes),
        Family::X3p => x3p::read(bytes),
        Family::DigitalSurf => digital_surf::read(bytes),
        Family::Erd => erd::read(bytes),
        Family::Gwyddion => gwyddion::read(bytes),
        Family::WykoAscii => wyko_ascii::read(bytes),
        Family::OpenCrg => opencrg::read(bytes),
        Family::Smats => smats::read(bytes),
    };
    read.and_then(ScanFile::checked).map(Some).map_err(failed)
}

/// Shape of `rows` times `columns` points: one row is a profile.
fn grid(columns: usize, rows: usize, spacing_x: f64, spacing_y: f64) -> Grid {
    match rows {
        1 => Grid::Profile { spacing: spacing_x },
        _ => Grid::Map { columns, rows, spacing_x, spacing_y },
    }
}

/// Metres of a unit of length as instruments write it.
fn metres_of(unit: &str) -> Option<f64> {
    let unit = unit.trim();
    Some(match unit.to_lowercase().as_str() {
        "m" => 1.0,
        "cm" => 1e-2,
        "mm" => 1e-3,
        // The micro sign, the Greek letter and what is left of them where an encoding was lost.
        "um" | "\u{b5}m" | "\u{3bc}m" | "~m" => 1e-6,
        "nm" => 1e-9,
        "pm" => 1e-12,
        "km" => 1e3,
        "in" | "inch" | "inches" => 0.0254,
        "mil" | "mils" => 2.54e-5,
        "ft" | "feet" => 0.3048,
        _ => return None,
    })
}
