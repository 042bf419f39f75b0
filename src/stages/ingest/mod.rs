//! ingest: from scan files to windows of equal spacing.
//!
//! | module | what it holds |
//! |---|---|
//! | `cleaning` | what was cleaned from the scans, for the people who decide on it |
//! | `faults` | the table of the faults of the scans |
//! | `files` | the scan files of a recipe: what is at its paths, with digests |
//! | `maps` | maps that are kept beside their lines |
//! | `picture` | pictures of the faults of a scan, in SVG |
//! | `rows` | the tables of the stage |
//! | `warnings` | what a user is told of the scans |

mod cleaning;
mod faults;
mod files;
mod maps;
mod picture;
mod rows;
mod warnings;

pub use cleaning::{CLEANING_FILE, cleaning_markdown};
pub use faults::{FAULTS, FaultRow};
pub use files::{ScanFile, find_scans, inputs};
pub use maps::{MAP_WINDOWS, MAPS, MapRow, maps_schema, read_maps};
pub use picture::fault_figure;

use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::{Stage, StageError};
use crate::artifact::{ArrayDataset, Attribute, Digesting, RunView, Storage};
use crate::requirement::{InvalidRecipe, require};
use crate::scans::file::{CHANNELS, Format, Grid, MapLines, is_instrument, open_channel};
use crate::scans::spreadsheet::is_workbook;
use crate::scans::text_shape::TextShape;
use crate::scans::{Described, FileError, FileProblem, Source, TextFormat, read_source};
use crate::surface::map::condition::MapConditioning;
use crate::surface::{Conditioning, ConditioningReport, LineScan, RawScan, condition};
use crate::units::Units;
use faults::fault_rows;
use picture::write_pictures;
use rayon::prelude::*;
pub use rows::{REPORT, SCANS, ScanReportRow, WINDOWS, WindowRow, scans_schema, schemas};
use rows::{report_row, window_rows};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 5;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "ingest",
    summary: "Scan files to windows of equal spacing",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let ingest = request.chain()?.ingest?;
    let mut parameters = json!(ingest);
    // Where the scans are is no parameter: their names and digests are inputs.
    if let Value::Object(keys) = &mut parameters {
        keys.remove("scans");
    }
    let run = move |_: &Inputs, context: &mut Context| run(ingest, &request.scans, context);
    Some(Planned::new(parameters, run).with_inputs(inputs(&request.scans)))
}

/// Section `[ingest]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ingest {
    /// Scan files, and folders of which every file is a scan. Left out beside `sweep.specimens`.
    #[serde(default, skip_serializing_if = "Vec::is_empty", with = "crate::files::name::paths")]
    #[schemars(with = "Vec<String>")]
    pub scans: Vec<PathBuf>,
    /// How the text files are to be read; instrument files (SDF, X3P, Digital Surf, ERD ...) are told
    /// by their content and need no description.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<TextFormat>,
    /// True where the heights of instrument files grow away from the road's rubber, as depths do;
    /// they are turned then. Texts have `invert_z` in their description.
    #[serde(default, skip_serializing_if = "is_false")]
    pub invert_instrument_heights: bool,
    /// Lines of height maps that are taken as line scans, `rows` or `columns`. Required for maps, unless `maps` keeps them:
    /// then rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_lines: Option<MapLines>,
    /// Every how many lines of a height map one is taken; 1 takes all.
    #[serde(default = "every_line", skip_serializing_if = "is_every_line")]
    pub map_line_step: usize,
    /// Channel of ERD files that is taken, by its number from 1; the first of heights if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub erd_channel: Option<usize>,
    /// Largest number of scans that get a picture of their faults beside `cleaning.md`; those whose
    /// shortest waves the faults make most of come first.
    #[serde(default = "twelve_pictures", skip_serializing_if = "is_twelve")]
    pub fault_pictures: usize,
    /// How the scans are brought to equal spacing and freed of faults and form.
    #[serde(default)]
    pub conditioning: Conditioning,
    /// Keeps the maps themselves beside their lines, for areal surfaces, and says how they are freed of faults and form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maps: Option<MapConditioning>,
}

impl Ingest {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        self.text.as_ref().map_or(Ok(()), TextFormat::validate)?;
        require(self.map_line_step > 0, "ingest.map_line_step", self.map_line_step, "1 or more")?;
        let channel = self.erd_channel;
        let shown = channel.unwrap_or_default();
        require(channel != Some(0), "ingest.erd_channel", shown, "1 or more, the first is 1")?;
        self.maps.as_ref().map_or(Ok(()), MapConditioning::validate)?;
        Ok(self.conditioning.validate()?)
    }
}

fn every_line() -> usize {
    1
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_every_line(step: &usize) -> bool {
    *step == every_line()
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_false(flag: &bool) -> bool {
    !*flag
}

fn twelve_pictures() -> usize {
    12
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_twelve(pictures: &usize) -> bool {
    *pictures == twelve_pictures()
}

/// Windows of a scan, and what became of it.
type Conditioned = (Vec<LineScan>, ConditioningReport);

/// The line scans of a file, and what is to be told of it.
struct ReadFile<T> {
    scans: Vec<T>,
    /// The map that the file holds, where maps are kept.
    map: Option<maps::ConditionedMap>,
    /// Whether it is text and not the file of an instrument.
    is_text: bool,
    /// Where the description contradicts the file.
    contradictions: Vec<String>,
    /// The channels of heights of an ERD file that has several.
    channels: Option<String>,
    /// Whether it is an ERD file.
    is_erd: bool,
    /// A height that seems to stand for missing ones, in words.
    repeated: Option<String>,
    /// A stretch on which the sensor seems to have stood still, in words.
    stuck: Option<String>,
    /// Heights that are smoother than those of a road, in words.
    smooth: Option<String>,
}

/// Reads and conditions the scan files and writes the results; returns warnings.
///
/// # Errors
/// The first file, in their order, that cannot be read or conditioned.
pub fn run(
    ingest: &Ingest,
    files: &[ScanFile],
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let done = std::sync::atomic::AtomicU64::new(0);
    // Collected first and judged then: a parallel search for an error finds any.
    let read: Vec<Result<ReadFile<Conditioned>, StageError>> = files
        .par_iter()
        .map(|file| {
            context.check_interrupt()?;
            let read = read_and_condition(ingest, file)?;
            let count = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            (context.watch.progress)(count, files.len() as u64);
            Ok(read)
        })
        .collect();
    let mut read: Vec<_> = read.into_iter().collect::<Result<_, _>>()?;
    check_equal_grids(read.iter().flat_map(|file| &file.scans).flat_map(|(windows, _)| windows))?;
    let scans = read.iter_mut().flat_map(|file| &mut file.scans);
    share_spacing(&mut scans.flat_map(|(windows, _)| windows).collect::<Vec<_>>());
    let mut warnings = warnings::of_description(ingest, files, &read);
    let (mut datasets, mut reports) = (Vec::new(), Vec::new());
    let (mut map_datasets, mut map_reports) = (Vec::new(), Vec::new());
    for (file, read) in files.iter().zip(read) {
        if let Some((windows, report)) = read.map {
            map_datasets.extend(windows.into_iter().map(|window| maps::dataset(window, file)));
            map_reports.push(report);
        }
        for (windows, report) in read.scans {
            datasets.extend(windows.into_iter().map(|window| dataset(window, file)));
            reports.push(report);
        }
    }
    let reports: Vec<&ConditioningReport> = reports.iter().collect();
    let pending = &mut context.pending;
    pending.write_arrays(SCANS, Storage::Plain, &datasets)?;
    let scans: Vec<_> = reports.iter().map(|report| report_row(report)).collect();
    pending.write_rows(REPORT, &scans)?;
    let of_lines = reports.iter().flat_map(|report| fault_rows(&report.scan, &report.faults));
    let of_maps = map_reports.iter().flat_map(|report| fault_rows(&report.map, &report.faults));
    let faults: Vec<_> = of_lines.chain(of_maps).collect();
    pending.write_rows(FAULTS, &faults)?;
    let windows: Vec<_> = reports.iter().flat_map(|report| window_rows(report)).collect();
    pending.write_rows(WINDOWS, &windows)?;
    let map_windows: Vec<_> = map_reports.iter().flat_map(maps::map_rows).collect();
    if ingest.maps.is_some() {
        if map_reports.is_empty() {
            return Err(StageError::NoMaps);
        }
        pending.write_arrays(MAPS, Storage::Plain, &map_datasets)?;
        pending.write_rows(MAP_WINDOWS, &map_windows)?;
    }
    let pictures = write_pictures(&reports, ingest.fault_pictures, pending)?;
    let document = cleaning_markdown(&scans, &faults, &windows, &map_windows, &pictures);
    pending.write_document(CLEANING_FILE, &document)?;
    warnings.extend(warnings::of_scans(&reports));
    if let Some(conditioning) = &ingest.maps {
        warnings.extend(warnings::of_maps(&map_windows, conditioning.form));
    }
    Ok(warnings)
}

/// Conditions the line scans of a file while it is read; nothing of it counts unless all that was
/// read is what was digested before.
fn read_and_condition(
    ingest: &Ingest,
    file: &ScanFile,
) -> Result<ReadFile<Conditioned>, StageError> {
    let io = |source| StageError::ScanIo { path: file.path.clone(), source };
    let opened = std::fs::File::open(&file.path).map_err(io)?;
    let length = opened.metadata().map_err(io)?.len();
    let mut reader = Digesting::new(opened);
    let source = Source::new(&mut reader, length).map_err(io)?;
    let read = read_scans(ingest, file, source);
    if reader.finish().map_err(io)? != file.digest {
        return Err(StageError::ScanChanged { path: file.path.clone() });
    }
    read
}

/// The line scans of a file: one, or the chosen lines of a height map, each conditioned as soon
/// as it is complete.
fn read_scans(
    ingest: &Ingest,
    file: &ScanFile,
    source: Source<'_>,
) -> Result<ReadFile<Conditioned>, StageError> {
    /// Enough for the names of the columns and some points.
    const START: usize = 1 << 16;
    let name = file.path.display().to_string();
    let file_error = |problem| Box::new(FileError { file: name.clone(), problem }).into();
    let source = source
        .with_directory()
        .map_err(|source| StageError::ScanIo { path: file.path.clone(), source })?;
    if is_instrument(source.start()) {
        return read_instrument(ingest, file, source).map_err(|failure| match failure {
            Failure::File(problem) => file_error(problem),
            Failure::Stage(error) => *error,
        });
    }
    let Some(format) = &ingest.text else {
        return Err(StageError::NoTextFormat { path: file.path.clone() });
    };
    // The directory of a workbook is at its end.
    let start = source.start();
    let start = if is_workbook(start) { start } else { &start[..start.len().min(START)] };
    let contradictions = TextShape::of(start).map(|shape| shape.contradictions(format));
    let contradictions = contradictions.unwrap_or_default();
    let mut map = None;
    let scans = match read_source(&name, source, format)? {
        Described::Line(scan) => vec![RawScan { name: file.name.clone(), ..scan }],
        Described::Map(heights) => {
            let lines = chosen_lines(ingest, file, heights.grid)?;
            map = maps::kept(ingest, file, &heights)?;
            heights.line_scans(&file.name, lines, ingest.map_line_step).map_err(file_error)?
        }
    };
    let condition = |scan| Ok(condition(scan, &ingest.conditioning)?);
    Ok(ReadFile {
        repeated: scans.iter().find_map(|scan| warnings::repeated(scan, Some(format))),
        stuck: scans.iter().find_map(warnings::stuck),
        smooth: scans.iter().find_map(warnings::smooth),
        scans: scans.iter().map(condition).collect::<Result<_, StageError>>()?,
        map,
        is_text: true,
        contradictions,
        channels: None,
        is_erd: false,
    })
}

/// Which lines of a map become scans; a profile is one.
fn chosen_lines(ingest: &Ingest, file: &ScanFile, grid: Grid) -> Result<MapLines, StageError> {
    match (grid, ingest.map_lines) {
        (_, Some(lines)) => Ok(lines),
        (Grid::Profile { .. }, None) => Ok(MapLines::Rows),
        (Grid::Map { .. }, None) if ingest.maps.is_some() => Ok(MapLines::Rows),
        (Grid::Map { columns, rows, .. }, None) => {
            Err(StageError::MapLines { path: file.path.clone(), rows, columns })
        }
    }
}

/// Why the lines of an instrument file are not there.
enum Failure {
    File(FileProblem),
    Stage(Box<StageError>),
}

impl From<FileProblem> for Failure {
    fn from(problem: FileProblem) -> Self {
        Self::File(problem)
    }
}

impl<E: Into<StageError>> From<Box<E>> for Failure {
    fn from(error: Box<E>) -> Self {
        Self::Stage(Box::new((*error).into()))
    }
}

fn read_instrument(
    ingest: &Ingest,
    file: &ScanFile,
    source: Source<'_>,
) -> Result<ReadFile<Conditioned>, Failure> {
    let mut read = ReadFile {
        scans: Vec::new(),
        map: None,
        is_text: false,
        contradictions: Vec::new(),
        channels: None,
        is_erd: Format::detect(source.start()) == Some(Format::Erd),
        repeated: None,
        stuck: None,
        smooth: None,
    };
    let Some(scan) = open_channel(source, ingest.erd_channel)? else { return Ok(read) };
    let said = |name: &str| scan.instrument.iter().find(|(key, _)| key == name);
    read.channels = said(CHANNELS).map(|(_, channels)| channels.clone());
    let lines = chosen_lines(ingest, file, scan.grid).map_err(Box::new)?;
    let mut each = |mut line: RawScan| {
        if ingest.invert_instrument_heights {
            line.heights.iter_mut().for_each(|height| *height = -*height);
        }
        if read.repeated.is_none() {
            read.repeated = warnings::repeated(&line, None);
        }
        if read.stuck.is_none() {
            read.stuck = warnings::stuck(&line);
        }
        if read.smooth.is_none() {
            read.smooth = warnings::smooth(&line);
        }
        read.scans.push(condition(&line, &ingest.conditioning).map_err(Box::new)?);
        Ok::<(), Failure>(())
    };
    if ingest.maps.is_none() {
        scan.lines(&file.name, lines, ingest.map_line_step, &mut each)?;
        return Ok(read);
    }
    let mut whole = scan.whole()?;
    for line in whole.line_scans(&file.name, lines, ingest.map_line_step)? {
        each(line)?;
    }
    if ingest.invert_instrument_heights {
        whole.heights.iter_mut().for_each(|height| *height = -*height);
    }
    read.map = maps::kept(ingest, file, &whole).map_err(Box::new)?;
    Ok(read)
}

fn check_equal_grids<'a>(
    mut windows: impl Iterator<Item = &'a LineScan>,
) -> Result<(), StageError> {
    let Some(first) = windows.next() else { return Ok(()) };
    // Spacings are fitted to the positions of each file; a difference of a thousandth shifts the
    // largest lag by less than the resolution of any fit made of it.
    let differs = |other: &&LineScan| {
        other.heights.len() != first.heights.len()
            || (other.spacing / first.spacing - 1.0).abs() > 1e-3
    };
    match windows.find(differs) {
        None => Ok(()),
        Some(other) => Err(StageError::UnequalScans {
            scan: first.name.clone(),
            points: first.heights.len(),
            spacing_um: first.spacing.m_to_um(),
            other: other.name.clone(),
            other_points: other.heights.len(),
            other_spacing_um: other.spacing.m_to_um(),
        }),
    }
}

/// Gives all windows the mean of their spacings, so that lags and frequencies are the same numbers
/// in all of them.
fn share_spacing(windows: &mut [&mut LineScan]) {
    let mean = windows.iter().map(|window| window.spacing).sum::<f64>() / windows.len() as f64;
    windows.iter_mut().for_each(|window| window.spacing = mean);
}

fn dataset(window: LineScan, file: &ScanFile) -> ArrayDataset {
    let attributes = BTreeMap::from([
        ("spacing_m".to_owned(), Attribute::Float(window.spacing)),
        ("origin_m".to_owned(), Attribute::Float(window.origin)),
        ("missing_fraction".to_owned(), Attribute::Float(window.missing_fraction())),
        ("source".to_owned(), Attribute::Text(file.name.clone())),
        ("source_digest".to_owned(), Attribute::Text(file.digest.to_string())),
    ]);
    ArrayDataset { name: window.name, unit: "m".into(), attributes, values: window.heights }
}

/// Reads the windows of a run.
///
/// # Errors
/// Those of the store.
pub fn read_windows(run: &RunView) -> Result<Vec<LineScan>, StageError> {
    let datasets = run.read_arrays(SCANS)?;
    let float = |dataset: &ArrayDataset, name: &str| match dataset.attributes.get(name) {
        Some(Attribute::Float(value)) => *value,
        // The schema version promises the attribute.
        _ => f64::NAN,
    };
    Ok(datasets
        .into_iter()
        .map(|dataset| LineScan {
            origin: float(&dataset, "origin_m"),
            spacing: float(&dataset, "spacing_m"),
            name: dataset.name,
            heights: dataset.values,
        })
        .collect())
}
