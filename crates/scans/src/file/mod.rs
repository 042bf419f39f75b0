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
//! The format is recognised by the content; the name of the file does not matter. Every size that a
//! file declares is compared with what the file holds before memory is asked for: to read n bytes
//! takes at most 32 MB, 24 n and 8 bytes a declared point. SDF, ERD and Digital Surf are read as
//! streams, of which some thousand points at a time are in memory ([`open`]).

mod bytes;
mod digital_surf;
mod erd;
pub mod error;
mod foreign;
mod gwyddion;
mod heights;
mod lines;
mod opencrg;
mod sdf;
mod sdf_write;
mod smats;
mod statistics;
#[cfg(test)]
mod tests;
mod wyko_ascii;
mod x3p;

pub use erd::CHANNELS;
pub use error::{FileError, FileProblem, Place};
pub use foreign::foreign;
pub use lines::MapLines;
pub use sdf_write::write as write_sdf;
pub use statistics::Statistics;
pub use x3p::write as write_x3p;

use super::Source;
use crate::spreadsheet::is_workbook;
use asperity_core::surface::RawScan;
use error::unexpected;
use heights::Checked;
use lines::LineCollector;
use std::path::Path;

/// Largest number of points that are held in memory, 2 GB of heights. A larger map is read row
/// by row, and its chosen lines may have as many.
pub const LARGEST_POINTS: u64 = 1 << 28;

/// First bytes by which a format is recognised.
pub const DETECTED_BY: usize = 1 << 16;

/// Format of instrument files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
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

impl Format {
    /// The format by the first bytes, `None` for all else.
    pub fn detect(start: &[u8]) -> Option<Self> {
        /// Longer than any header, of which the first lines are decisive.
        const ENOUGH: usize = 1 << 16;
        let start = &start[..start.len().min(ENOUGH)];
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

/// An instrument file whose heights are still to be read, row after row.
pub struct OpenScan<'a> {
    /// Name of the format with its variant, such as `SDF bISO-1.0`.
    pub format: String,
    /// How it was recognised, in words, with the deciding part of the file.
    pub detected: String,
    /// Spacing and shape.
    pub grid: Grid,
    /// Statements of the file on the instrument and the measurement: name and value.
    pub instrument: Vec<(String, String)>,
    /// Number of points that the file declares, and where.
    declared: Option<(u64, Place)>,
    heights: Checked<'a>,
}

impl OpenScan<'_> {
    /// Reads all heights into memory.
    ///
    /// # Errors
    /// [`FileProblem::TooLarge`] beyond [`LARGEST_POINTS`]; what is found in the heights.
    pub fn whole(mut self) -> Result<ScanFile, FileProblem> {
        let mut heights = Vec::new();
        let mut part = Vec::new();
        let points = match &self.declared {
            Some((points, place)) => {
                admit_points(*points, place.clone())?;
                *points as usize
            }
            None => 0,
        };
        while self.heights.read(&mut part)? {
            // Formats that are read at once give all of it: it need not be copied.
            if heights.is_empty() && self.declared.is_none() {
                heights = std::mem::take(&mut part);
            } else {
                // Not before the first of them are there: a stream may be none.
                if heights.is_empty() {
                    heights.reserve_exact(points);
                }
                heights.append(&mut part);
            }
            admit_points(heights.len() as u64, Place::Height(heights.len()))?;
        }
        let Self { format, detected, grid, instrument, .. } = self;
        Ok(ScanFile { format, detected, grid, heights, instrument })
    }

    /// Gives the profile, or every `step`-th row or column of a map that holds a height, to
    /// `each` as line scans, each as soon as it is complete; others are not kept. Those
    /// of a map are named `name_row_0000` and so on, by their number in the file.
    ///
    /// # Errors
    /// [`FileProblem::TooManyLines`], what is found in the heights, and those of `each`.
    pub fn lines<E: From<FileProblem>>(
        mut self,
        name: &str,
        lines: MapLines,
        step: usize,
        each: &mut dyn FnMut(RawScan) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut collector = LineCollector::new(name, self.grid, lines, step)?;
        let mut part = Vec::new();
        while self.heights.read(&mut part)? {
            collector.take(&part, each)?;
        }
        collector.finish(each)
    }

    /// Reads the heights and keeps their number, mean and standard deviation alone.
    ///
    /// # Errors
    /// What is found in the heights.
    pub fn statistics(&mut self) -> Result<Statistics, FileProblem> {
        let mut statistics = Statistics::default();
        let mut part = Vec::new();
        while self.heights.read(&mut part)? {
            statistics.take(&part);
        }
        Ok(statistics)
    }
}

/// What an instrument file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanFile {
    /// Name of the format with its variant, such as `SDF bISO-1.0`.
    pub format: String,
    /// How it was recognised, in words, with the deciding part of the file.
    pub detected: String,
    /// Spacing and shape.
    pub grid: Grid,
    /// Heights in metres, row after row; NaN where missing.
    pub heights: Vec<f64>,
    /// Statements of the file on the instrument and the measurement: name and value.
    pub instrument: Vec<(String, String)>,
}

impl ScanFile {
    /// Number of points without a height.
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|height| height.is_nan()).count()
    }

    /// Mean of the heights that are there, in metres.
    pub fn mean(&self) -> f64 {
        Statistics::of(&self.heights).mean()
    }

    /// Standard deviation of the heights that are there about their mean, of the population, in
    /// metres.
    pub fn standard_deviation(&self) -> f64 {
        Statistics::of(&self.heights).standard_deviation()
    }

    /// The lines that [`OpenScan::lines`] gives.
    ///
    /// # Errors
    /// [`FileProblem::TooManyLines`].
    pub fn line_scans(
        &self,
        name: &str,
        lines: MapLines,
        step: usize,
    ) -> Result<Vec<RawScan>, FileProblem> {
        let mut scans = Vec::new();
        let mut each = |scan| -> Result<(), FileProblem> {
            scans.push(scan);
            Ok(())
        };
        let mut collector = LineCollector::new(name, self.grid, lines, step)?;
        collector.take(&self.heights, &mut each)?;
        collector.finish(&mut each)?;
        Ok(scans)
    }
}

fn admit_points(size: u64, place: Place) -> Result<(), FileProblem> {
    if size <= LARGEST_POINTS {
        return Ok(());
    }
    Err(FileProblem::TooLarge { place, what: "the number of points", size, limit: LARGEST_POINTS })
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

/// A file that was read at once.
impl From<ScanFile> for OpenScan<'_> {
    fn from(scan: ScanFile) -> Self {
        let ScanFile { format, detected, grid, heights, instrument } = scan;
        let heights = Checked::new(heights);
        Self { format, detected, grid, instrument, declared: None, heights }
    }
}

/// Whether a file, by its first bytes or, of an archive, all of them, is one that [`open`] reads or
/// names; text and workbooks are not.
pub fn is_instrument(start: &[u8]) -> bool {
    !is_workbook(start) && (Format::detect(start).is_some() || foreign(start).is_some())
}

/// Opens an instrument file: its header is read, its heights are still to come. `None` if it is
/// of none of the formats: text, or a workbook, which a description goes with.
///
/// # Errors
/// [`FileProblem`] of the header, or a size that the file cannot hold; files of kinds that are known
/// and not read are named with the way out ([`FileProblem::Foreign`]).
pub fn open(source: Source<'_>) -> Result<Option<OpenScan<'_>>, FileProblem> {
    open_channel(source, None)
}

/// Like [`open`], with the number from 1 of the channel that is read of an ERD file.
///
/// # Errors
/// [`FileProblem`]; also for a channel that the file does not have, or that holds no heights.
pub fn open_channel(
    source: Source<'_>,
    channel: Option<usize>,
) -> Result<Option<OpenScan<'_>>, FileProblem> {
    let Some(format) = Format::detect(source.start()) else {
        return foreign(source.start()).map_or(Ok(None), Err);
    };
    let source = source.with_directory()?;
    if format == Format::X3p {
        if is_workbook(source.start()) {
            return Ok(None);
        }
        if let Some(problem) = foreign::foreign_archive(source.start()) {
            return Err(problem);
        }
    }
    let open = match format {
        Format::Sdf => sdf::open(source),
        Format::X3p => x3p::open(source),
        Format::DigitalSurf => digital_surf::open(source),
        Format::Erd => erd::open(source, channel),
        Format::Gwyddion => gwyddion::open(source),
        Format::WykoAscii => wyko_ascii::read(&source.whole()?).map(OpenScan::from),
        Format::OpenCrg => opencrg::read(&source.whole()?).map(OpenScan::from),
        Format::Smats => smats::read(&source.whole()?).map(OpenScan::from),
    };
    open.map(Some)
}

/// Reads an instrument file; `None` if it is of none of the formats.
///
/// # Errors
/// [`FileError`] with the path, the place and what was expected there.
pub fn read_file(path: &Path) -> Result<Option<ScanFile>, FileError> {
    read_channel(path, None)
}

/// Like [`read_file`], with the number from 1 of the channel that is read of an ERD file.
///
/// # Errors
/// [`FileError`]; also for a channel that the file does not have, or that holds no heights.
pub fn read_channel(path: &Path, channel: Option<usize>) -> Result<Option<ScanFile>, FileError> {
    let file_error = |problem| FileError { file: path.display().to_string(), problem };
    let source = Source::open(path).map_err(|error| file_error(error.into()))?;
    open_channel(source, channel)
        .and_then(|scan| scan.map(OpenScan::whole).transpose())
        .map_err(file_error)
}

/// Reads the bytes of an instrument file; `None` if they are of none of the formats: text, or a
/// workbook, which a description goes with.
///
/// # Errors
/// [`FileError`] that names the file `name`; files of kinds that are known and not read are
/// named with the way out ([`FileProblem::Foreign`]).
pub fn parse_file(name: &str, bytes: &[u8]) -> Result<Option<ScanFile>, FileError> {
    open(Source::of_bytes(bytes))
        .and_then(|scan| scan.map(OpenScan::whole).transpose())
        .map_err(|problem| FileError { file: name.to_owned(), problem })
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
        // The micro sign, the Greek letter and what a wrong encoding makes of them.
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
