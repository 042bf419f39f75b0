//! `asperity inspect`: what is in a file or folder.
//!
//! | module | what it holds |
//! |---|---|
//! | `artifact` | tables and arrays |
//! | `child` | files of arrays are read in a process of their own, since the HDF5 library may crash on a damaged file |
//! | `folder` | manifests, folders of stages, folders of runs |
//! | `instrument` | instrument files, which state their own units |
//! | `provenance` | where a file comes from: the manifest beside it |
//! | `scan` | text scans, described by options |
//! | `solve` | stored single solves |
//! | `text_shape` | text without a description: what it looks like, and a proposal for a description |

mod artifact;
mod child;
mod folder;
mod instrument;
mod provenance;
mod scan;
mod solve;
mod text_shape;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::output::{json, print};
use artifact::{Arrays, Table};
use asperity::scans::file::{
    DETECTED_BY, Format as InstrumentFormat, Grid, OpenScan, ScanFile, foreign as named,
    open_channel, read_channel,
};
use asperity::scans::spreadsheet::is_workbook;
use asperity::scans::text_shape::TextShape as Shape;
use asperity::scans::{Described, FileError, Source, read_bytes};
use folder::{ManifestFile, Run, Stage};
use instrument::InstrumentFile;
use scan::Scan;
pub(super) use scan::ScanOptions;
use solve::Solve;
use text_shape::TextShape;

const EXAMPLES: &str = "\
Examples:
  A table, arrays, a manifest, the folder of a stage or of a whole run:
    asperity inspect runs/asphalt/bem/solves.arrow
    asperity inspect runs/asphalt
  A file of an instrument (SDF, X3P, Digital Surf, ERD, OpenCRG, Wyko ASCII, Gwyddion text):
    asperity inspect specimen.x3p --json
  A text scan: first what it looks like, then with its units, which are never guessed:
    asperity inspect data/scans/specimen/scan_01.txt
    asperity inspect data/scans/specimen/scan_01.txt --separator semicolon --comment '#' --x-column x_mm --x-unit mm --z-column z_um --z-unit um
  A sheet of a workbook (.xlsx), which is described like text:
    asperity inspect scan.xlsx";

/// Show what a file or folder holds: schema, units, shape, provenance, first rows.
///
/// PATH is an Arrow table, an HDF5 file of arrays, a manifest, a stored solve, the folder of a stage
/// or of a run, a file of an instrument, a text scan, or a workbook (.xlsx) with one. The content decides on the kind, not the name.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Inspect {
    /// File or folder.
    path: PathBuf,
    /// Print JSON instead of text.
    #[arg(long)]
    json: bool,
    /// Channel of an ERD file that is read, by its number from 1; the first of heights if not given.
    #[arg(long, value_name = "N", value_parser = super::values::channel)]
    erd_channel: Option<usize>,
    /// Read a file of arrays here: for the process that `inspect` starts for it.
    #[arg(long, hide = true)]
    in_this_process: bool,
    #[command(flatten)]
    scan: ScanOptions,
}

/// What was found at a path.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Finding {
    Table(Table),
    Arrays(Arrays),
    Manifest(ManifestFile),
    Stage(Stage),
    Run(Run),
    /// Instrument file of one line.
    Profile(InstrumentFile),
    /// Instrument file of a height map.
    Map(InstrumentFile),
    Scan(Scan),
    /// Text without a description.
    Text(TextShape),
    Solve(Solve),
}

impl Inspect {
    pub(super) fn run(&self) -> Result<(), CliError> {
        if !self.in_this_process && self.is_hdf5()? {
            self.scan.refuse(&self.path, "a file of arrays")?;
            return print(&child::inspect(&self.path, self.json)?);
        }
        let finding = self.find()?;
        print(&if self.json { json(&finding)? } else { finding.text() })
    }

    fn is_hdf5(&self) -> Result<bool, CliError> {
        Ok(!self.path.is_dir() && Format::of(&self.start()?) == Format::Hdf5)
    }

    fn start(&self) -> Result<Vec<u8>, CliError> {
        let path = &self.path;
        first_bytes(path)
            .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))
    }

    fn find(&self) -> Result<Finding, CliError> {
        let path = &self.path;
        if path.is_dir() {
            self.scan.refuse(path, "a folder")?;
            refuse_channel(path, self.erd_channel, None)?;
            return folder::read(path);
        }
        let start = self.start()?;
        let format = Format::of(&start);
        refuse_channel(path, self.erd_channel, InstrumentFormat::detect(&start))?;
        if let Some(what) = format.not_text() {
            self.scan.refuse(path, what)?;
        }
        Ok(match format {
            Format::Arrow => Finding::Table(Table::read(path)?),
            Format::Hdf5 => Finding::Arrays(Arrays::read(path)?),
            Format::Json if Solve::is_in(path) => Finding::Solve(Solve::read(path)?),
            Format::Json => Finding::Manifest(ManifestFile::read(path)?),
            Format::Archive if is_workbook(&read(path)?) => self.text_scan(path)?,
            Format::Archive => {
                self.scan.refuse(path, "the file of an instrument, which states its units")?;
                instrument_file(path, self.erd_channel)?
            }
            Format::Instrument => instrument_file(path, self.erd_channel)?,
            Format::Text => self.text_scan(path)?,
            Format::Binary if self.scan.are_given() || is_utf_16(&start) => self.text_scan(path)?,
            Format::Empty => return Err(foreign(path, "is empty")),
            Format::Binary => {
                return Err(foreign(
                    path,
                    "is not an Arrow table, an HDF5 file, a manifest or text, nor a known file of an instrument (SDF, X3P, Digital Surf, ERD, OpenCRG, Wyko ASCII, Gwyddion text); export it as X3P, SDF or text first if it is a scan",
                ));
            }
        })
    }

    /// A scan if a description is given, else what the text looks like.
    fn text_scan(&self, path: &Path) -> Result<Finding, CliError> {
        if self.scan.are_given() {
            return Ok(match self.scan.read(path)? {
                Described::Line(scan) => Finding::Scan(self.scan.summary(path, scan)?),
                Described::Map(map) => found(path, map.into())?,
            });
        }
        Ok(Finding::Text(TextShape::read(path)?))
    }
}

/// Refuses a channel for a file that is not an ERD file.
fn refuse_channel(
    path: &Path,
    channel: Option<usize>,
    instrument: Option<InstrumentFormat>,
) -> Result<(), CliError> {
    if channel.is_none() || instrument == Some(InstrumentFormat::Erd) {
        return Ok(());
    }
    Err(foreign(
        path,
        "is not an ERD file, for which --erd-channel chooses a channel: leave it out",
    ))
}

/// Reads a file of an instrument, of an ERD file the chosen channel; `None` if it is another file.
pub(super) fn read_instrument(
    path: &Path,
    channel: Option<usize>,
) -> Result<Option<ScanFile>, CliError> {
    if channel.is_some() {
        let start = first_bytes(path)
            .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))?;
        refuse_channel(path, channel, InstrumentFormat::detect(&start))?;
    }
    Ok(read_channel(path, channel)?)
}

/// Reads the instrument file at `path`, with some thousand heights in memory at a time.
fn instrument_file(path: &Path, channel: Option<usize>) -> Result<Finding, CliError> {
    let wrong = |problem| CliError::input(FileError { file: path.display().to_string(), problem });
    let source = Source::open(path).map_err(|error| wrong(error.into()))?;
    let scan = open_channel(source, channel).map_err(wrong)?;
    // The format is known from the first bytes; here the file is read a second time.
    found(path, scan.ok_or_else(|| foreign(path, "changes while it is read"))?)
}

/// What an opened scan is, and its statistics.
fn found(path: &Path, mut scan: OpenScan<'_>) -> Result<Finding, CliError> {
    let wrong = |problem| CliError::input(FileError { file: path.display().to_string(), problem });
    let statistics = scan.statistics().map_err(wrong)?;
    let file = InstrumentFile::of(path, &scan, &statistics);
    Ok(match scan.grid {
        Grid::Profile { .. } => Finding::Profile(file),
        Grid::Map { .. } => Finding::Map(file),
    })
}

impl Finding {
    fn text(&self) -> String {
        match self {
            Self::Table(table) => table.text(),
            Self::Arrays(arrays) => arrays.text(),
            Self::Manifest(manifest) => manifest.text(),
            Self::Stage(stage) => stage.text(),
            Self::Run(run) => run.text(),
            Self::Profile(file) | Self::Map(file) => file.text(),
            Self::Scan(scan) => scan.text(),
            Self::Text(shape) => shape.text(),
            Self::Solve(solve) => solve.text(),
        }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, CliError> {
    read_bytes(path)
        .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))
}

fn foreign(path: &Path, problem: &str) -> CliError {
    CliError::input(format!("{} {problem}", path.display()))
}

/// Format of a file by its content.
#[derive(Debug, PartialEq)]
enum Format {
    Arrow,
    Hdf5,
    Json,
    /// A zip archive: X3P, a workbook, or something else.
    Archive,
    Instrument,
    Text,
    Binary,
    Empty,
}

impl Format {
    fn of(start: &[u8]) -> Self {
        const UTF_16_MARKS: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];
        if start.starts_with(b"ARROW1") {
            Self::Arrow
        } else if start.starts_with(b"\x89HDF\r\n\x1a\n") {
            Self::Hdf5
        } else if InstrumentFormat::detect(start) == Some(InstrumentFormat::X3p) {
            Self::Archive
        } else if InstrumentFormat::detect(start).is_some() || named(start).is_some() {
            Self::Instrument
        } else if start.is_empty() {
            Self::Empty
        } else if start.trim_ascii_start().starts_with(b"{") {
            Self::Json
        } else if start.contains(&0) && !UTF_16_MARKS.iter().any(|mark| start.starts_with(mark)) {
            Self::Binary
        } else {
            Self::Text
        }
    }
}

impl Format {
    /// What a file of the format is, if it is certainly not text.
    fn not_text(&self) -> Option<&'static str> {
        match self {
            Self::Arrow => Some("a table"),
            Self::Hdf5 => Some("a file of arrays"),
            Self::Json => Some("JSON"),
            Self::Instrument => Some("the file of an instrument, which states its units"),
            Self::Archive | Self::Text | Self::Binary | Self::Empty => None,
        }
    }
}

/// UTF-16 without a byte order mark has zeros, like binary data.
fn is_utf_16(start: &[u8]) -> bool {
    Shape::of(start).is_some_and(|shape| shape.encoding.starts_with("utf-16"))
}

fn first_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Opening a named pipe waits for a writer.
    asperity::files::admit(path, u64::MAX)?;
    File::open(path)?.take(DETECTED_BY as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_content() {
        let cases: [(&[u8], Format); 11] = [
            (b"ARROW1\0\0", Format::Arrow),
            (b"\x89HDF\r\n\x1a\n\0", Format::Hdf5),
            (b"\n {\"schema\": 1}", Format::Json),
            (b"# x z\n0 1\n", Format::Text),
            (b"x_\xb5m;z_\xb5m\n", Format::Text),
            (b"\xff\xfe1\0;\0", Format::Text),
            (b"PK\x03\x04\x14\0\0", Format::Archive),
            (b"\x01\0Directory\0\0", Format::Instrument),
            (b"<?xml version=\"1.0\"?><a/>", Format::Instrument),
            (b"\x7fELF\0\0", Format::Binary),
            (b"", Format::Empty),
        ];
        for (bytes, format) in cases {
            assert_eq!(Format::of(bytes), format, "{bytes:?}");
        }
    }
}
