//! ingest: from scan files to windows of equal spacing.

mod cleaning;
mod faults;
mod picture;
mod warnings;

pub use cleaning::{CLEANING_FILE, cleaning_markdown};
pub use faults::{FAULTS_FILE, FaultRow};
pub use picture::fault_figure;

use super::characterise::AVERAGE;
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::{Stage, StageError, schema_of};
use crate::artifact::{
    ArrayDataset, ArraysSchema, Attribute, AttributeSchema, DatasetSchema, Digest, Digesting,
    Input, Metadata, ResultFile, Row, RunView, SchemaVersion, Storage,
};
use crate::requirement::{InvalidRecipe, require};
use crate::scans::file::{CHANNELS, Format, Grid, MapLines, is_instrument, open_channel};
use crate::scans::spreadsheet::is_workbook;
use crate::scans::text_shape::TextShape;
use crate::scans::{
    Described, FileError, FileProblem, Source, TextFormat, admit_source, read_source,
};
use crate::surface::{Conditioning, ConditioningReport, LineScan, RawScan, condition};
use faults::fault_rows;
use picture::write_pictures;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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
    /// Lines of height maps that are taken as line scans, `rows` or `columns`. Required for maps.
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
}

impl Ingest {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        self.text.as_ref().map_or(Ok(()), TextFormat::validate)?;
        require(self.map_line_step > 0, "ingest.map_line_step", self.map_line_step, "1 or more")?;
        let channel = self.erd_channel;
        let shown = channel.unwrap_or_default();
        require(channel != Some(0), "ingest.erd_channel", shown, "1 or more, the first is 1")?;
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

/// Windows of equal spacing: `scans.h5`, one dataset each, heights in m, NaN where missing.
pub const SCANS_FILE: &str = "scans.h5";
/// The windows, which other stages read.
pub(crate) const SCANS: ResultFile = ResultFile { stage: "ingest", file: SCANS_FILE };
/// Schema name of [`SCANS_FILE`].
pub const SCANS_SCHEMA: &str = "asperity.ingest.scans";
/// Schema version of [`SCANS_FILE`].
pub const SCANS_VERSION: u32 = 1;
const SCANS_DESCRIPTION: &str =
    "line scans on equal spacing, form removed; NaN where a height is missing";
/// What conditioning did to each scan file: `report.arrow`.
pub const REPORT_FILE: &str = "report.arrow";
/// What became of each window: `windows.arrow`.
pub const WINDOWS_FILE: &str = "windows.arrow";

/// What conditioning did to one scan file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScanReportRow {
    /// Name of the scan, from its file.
    pub scan: String,
    /// Points in the file.
    pub points_read: u64,
    /// Points without a height in the file.
    pub points_missing: u64,
    /// Points that the spacing asks for and the file does not have.
    pub points_absent: u64,
    /// Points outside the valid range.
    pub points_out_of_range: u64,
    /// Points removed as spikes.
    pub spikes: u64,
    /// Spacing in the file.
    #[schemars(extend("unit" = "um"))]
    pub raw_spacing_um: f64,
    /// Largest distance of a position from equal spacing.
    #[schemars(extend("unit" = "um"))]
    pub largest_deviation_um: f64,
    /// Raw points averaged into one.
    pub points_per_cell: u64,
    /// Spacing after resampling.
    #[schemars(extend("unit" = "um"))]
    pub spacing_um: f64,
    /// Windows kept.
    pub windows_kept: u64,
    /// Windows rejected.
    pub windows_rejected: u64,
}

impl Row for ScanReportRow {
    const SCHEMA: &'static str = "asperity.ingest.report";
    const VERSION: u32 = 1;
}

/// What became of one window of a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WindowRow {
    /// Name of the window.
    pub window: String,
    /// Position of its first point on the track.
    #[schemars(extend("unit" = "mm"))]
    pub origin_mm: f64,
    /// Share of missing points.
    #[schemars(extend("unit" = "1"))]
    pub missing_share: f64,
    /// Root mean square of the form removed; absent for rejected windows.
    #[schemars(extend("unit" = "mm"))]
    pub form_rms_mm: Option<f64>,
    /// Why the window was rejected; absent for one that was kept.
    pub rejected: Option<String>,
}

impl Row for WindowRow {
    const SCHEMA: &'static str = "asperity.ingest.windows";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    let scans = SchemaVersion { schema: SCANS_SCHEMA.into(), version: SCANS_VERSION };
    vec![scans, schema_of::<ScanReportRow>(), schema_of::<FaultRow>(), schema_of::<WindowRow>()]
}

/// What [`SCANS_FILE`] holds.
pub fn scans_schema() -> ArraysSchema {
    let attribute = |name, kind, description| AttributeSchema { name, kind, description };
    ArraysSchema {
        schema: SCANS_SCHEMA,
        version: SCANS_VERSION,
        description: SCANS_DESCRIPTION,
        datasets: vec![DatasetSchema {
            path: "{window}",
            unit: "m",
            description: "heights of a window, growing towards the rubber; the name is that of the \
                          scan file, followed by a slash and a number where it was cut",
            attributes: vec![
                attribute("spacing_m", "f64", "distance between neighbouring points"),
                attribute("origin_m", "f64", "position of the first point on the track"),
                attribute("missing_fraction", "f64", "share of the points without a height"),
                attribute("source", "string", "name of the scan file without its extension"),
                attribute("source_digest", "string", "BLAKE3 digest of the scan file"),
            ],
        }],
    }
}

/// A scan file with its digest.
#[derive(Debug, Clone)]
pub struct ScanFile {
    /// Where it is.
    pub path: PathBuf,
    /// Name of the scan, from the file.
    pub name: String,
    /// Digest of its bytes.
    pub digest: Digest,
}

/// Finds the scan files of `paths`, in the order of their names within each folder, and digests
/// them.
///
/// # Errors
/// [`StageError::ScanIo`], [`StageError::NoScans`], [`StageError::SameName`],
/// [`StageError::ReservedName`].
pub fn find_scans(paths: &[PathBuf]) -> Result<Vec<ScanFile>, StageError> {
    let mut files = Vec::new();
    for path in paths {
        files.extend(files_at(path)?);
    }
    if files.is_empty() {
        return Err(StageError::NoScans { paths: paths.to_vec() });
    }
    let mut seen: BTreeMap<String, PathBuf> = BTreeMap::new();
    for path in &files {
        if let Some(first) = seen.insert(scan_name(path), path.clone()) {
            let (name, second) = (scan_name(path), path.clone());
            return Err(StageError::SameName { name, first, second });
        }
        // Tables tell the windows from their average by this name.
        if scan_name(path) == AVERAGE {
            return Err(StageError::ReservedName { path: path.clone() });
        }
    }
    files
        .into_par_iter()
        .map(|path| {
            admit(&path).map_err(|source| StageError::ScanIo { path: path.clone(), source })?;
            let digest = Digest::of_file(&path)?;
            Ok(ScanFile { name: scan_name(&path), digest, path })
        })
        .collect()
}

/// Before anything is read: a device may have no end, a large file takes long to digest.
fn admit(path: &Path) -> std::io::Result<()> {
    crate::files::admit(path, u64::MAX)?;
    let file = std::fs::File::open(path)?;
    let length = file.metadata()?.len();
    admit_source(Source::new(file, length)?)
}

fn files_at(path: &Path) -> Result<Vec<PathBuf>, StageError> {
    let io = |source| StageError::ScanIo { path: path.to_owned(), source };
    if !std::fs::metadata(path).map_err(io)?.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(io)? {
        let entry = entry.map_err(io)?;
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        if hidden {
            continue;
        }
        // A link to a drive that is not there is a scan that would be missed in silence.
        let found = std::fs::metadata(entry.path())
            .map_err(|source| StageError::ScanIo { path: entry.path(), source })?;
        if found.is_file() {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

fn scan_name(path: &Path) -> String {
    crate::files::name::text(path.file_stem().unwrap_or(path.as_os_str()))
}

/// The scan files as inputs of the stage.
pub fn inputs(files: &[ScanFile]) -> Vec<Input> {
    files
        .iter()
        .map(|file| Input {
            name: file.name.clone(),
            digest: file.digest,
            origin: Some(file.path.display().to_string()),
        })
        .collect()
}

/// Windows of a scan, and what became of it.
type Conditioned = (Vec<LineScan>, ConditioningReport);

/// The line scans of a file, and what is to be told of it.
struct ReadFile<T> {
    scans: Vec<T>,
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
    for (file, read) in files.iter().zip(read) {
        for (windows, report) in read.scans {
            datasets.extend(windows.into_iter().map(|window| dataset(window, file)));
            reports.push(report);
        }
    }
    let reports: Vec<&ConditioningReport> = reports.iter().collect();
    let pending = &mut context.pending;
    let (schema, description) = (SCANS_SCHEMA, SCANS_DESCRIPTION);
    let storage = Storage::Plain;
    pending.write_arrays(SCANS_FILE, schema, SCANS_VERSION, description, storage, &datasets)?;
    let scans: Vec<_> = reports.iter().map(|report| report_row(report)).collect();
    pending.write_table(REPORT_FILE, &scans, &Metadata::new())?;
    let faults: Vec<_> = reports.iter().flat_map(|report| fault_rows(report)).collect();
    pending.write_table(FAULTS_FILE, &faults, &Metadata::new())?;
    let windows: Vec<_> = reports.iter().flat_map(|report| window_rows(report)).collect();
    pending.write_table(WINDOWS_FILE, &windows, &Metadata::new())?;
    let pictures = write_pictures(&reports, ingest.fault_pictures, pending)?;
    let document = cleaning_markdown(&scans, &faults, &windows, &pictures);
    pending.write_document(CLEANING_FILE, &document)?;
    warnings.extend(warnings::of_scans(&reports));
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
    let scans = match read_source(&name, source, format)? {
        Described::Line(scan) => vec![RawScan { name: file.name.clone(), ..scan }],
        Described::Map(map) => {
            let lines = chosen_lines(ingest, file, map.grid)?;
            map.line_scans(&file.name, lines, ingest.map_line_step).map_err(file_error)?
        }
    };
    let condition = |scan| Ok(condition(scan, &ingest.conditioning)?);
    Ok(ReadFile {
        repeated: scans.iter().find_map(|scan| warnings::repeated(scan, Some(format))),
        stuck: scans.iter().find_map(warnings::stuck),
        smooth: scans.iter().find_map(warnings::smooth),
        scans: scans.iter().map(condition).collect::<Result<_, StageError>>()?,
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
    scan.lines(&file.name, lines, ingest.map_line_step, &mut |mut line: RawScan| {
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
    })?;
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
            spacing_um: first.spacing * 1e6,
            other: other.name.clone(),
            other_points: other.heights.len(),
            other_spacing_um: other.spacing * 1e6,
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
    let datasets = run.read_arrays("ingest", SCANS_FILE, SCANS_SCHEMA, SCANS_VERSION)?;
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

fn report_row(report: &ConditioningReport) -> ScanReportRow {
    let rejected = report.windows.iter().filter(|w| w.rejected.is_some()).count();
    ScanReportRow {
        scan: report.scan.clone(),
        points_read: report.points_read as u64,
        points_missing: report.points_missing_in_file as u64,
        points_absent: report.points_absent as u64,
        points_out_of_range: report.points_out_of_range as u64,
        spikes: report.spikes as u64,
        raw_spacing_um: report.raw_spacing_um,
        largest_deviation_um: report.largest_deviation_um,
        points_per_cell: report.points_per_cell as u64,
        spacing_um: report.spacing_um,
        windows_kept: (report.windows.len() - rejected) as u64,
        windows_rejected: rejected as u64,
    }
}

fn window_rows(report: &ConditioningReport) -> Vec<WindowRow> {
    let row = |window: &crate::surface::condition::WindowReport| WindowRow {
        window: window.name.clone(),
        origin_mm: window.origin_mm,
        missing_share: window.missing_share,
        form_rms_mm: window.form.as_ref().map(|form| form.rms_mm),
        rejected: window.rejected.clone(),
    };
    report.windows.iter().map(row).collect()
}
