//! ingest: from scan files to windows of equal spacing.
//!
//! | module | what it holds |
//! |---|---|
//! | `cleaning` | what was cleaned from the scans, for the people who decide on it |
//! | `faults` | the table of the faults of the scans |
//! | `files` | the scan files of a recipe: what is at its paths, with digests |
//! | `maps` | maps that are kept beside their lines |
//! | `picture` | pictures of the faults of a scan, in SVG |
//! | `read` | from a scan file to its windows |
//! | `rows` | the tables of the stage |
//! | `warnings` | what a user is told of the scans |

mod cleaning;
mod faults;
mod files;
mod maps;
mod picture;
mod read;
mod rows;
mod warnings;

pub use cleaning::{CLEANING_FILE, cleaning_markdown};
pub use faults::{FAULTS, FaultRow};
pub use files::{ScanFile, find_scans, inputs};
pub use maps::{MAP_WINDOWS, MAPS, MapRow, maps_schema, read_maps};
pub use picture::fault_figure;

use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::{Stage, StageError};
use crate::artifact::{ArrayDataset, Attribute, RunView, Storage};
use crate::requirement::{InvalidRecipe, require};
use crate::scans::TextFormat;
use crate::scans::file::MapLines;
use crate::surface::map::condition::MapConditioning;
use crate::surface::{Conditioning, ConditioningReport, LineScan};
use crate::units::Units;
use faults::fault_rows;
use maps::KeptMap;
use picture::write_pictures;
use rayon::prelude::*;
use read::{ReadFile, read_and_condition};
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
    let lines = if request.chain()?.has_lines() { Lines::Taken } else { Lines::None };
    if lines == Lines::None {
        parameters["lines"] = json!("none");
    }
    let run = move |_: &Inputs, context: &mut Context| run(ingest, lines, &request.scans, context);
    Some(Planned::new(parameters, run).with_inputs(inputs(&request.scans)))
}

/// Whether line scans are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lines {
    /// As everywhere but where maps stand alone.
    Taken,
    /// Maps stand alone ([`Chain::has_lines`](super::Chain::has_lines)): lines are looked at for faults that a user should
    /// be told of, and no windows are made of them.
    None,
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

/// Reads and conditions the scan files and writes the results; returns warnings. Lines of maps that are kept which cannot be
/// conditioned, and maps without a window, are left out with a warning.
///
/// # Errors
/// The first file, in their order, that cannot be read or conditioned; [`StageError::NoMapLeft`].
pub fn run(
    ingest: &Ingest,
    lines: Lines,
    files: &[ScanFile],
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let mut read = read_all(ingest, lines, files, context)?;
    check_equal_grids(read.iter().flat_map(|file| &file.scans).flat_map(|(windows, _)| windows))?;
    let scans = read.iter_mut().flat_map(|file| &mut file.scans);
    share_spacing(&mut scans.flat_map(|(windows, _)| windows).collect::<Vec<_>>());
    let mut warnings = warnings::of_description(ingest, files, &read);
    warnings.extend(warnings::of_lines(ingest, lines, files, &read));
    require_lines(lines, &mut read)?;
    let mut found = Found::default();
    for (file, read) in files.iter().zip(read) {
        found.add(file, read);
    }
    warnings.extend(found.write(ingest, lines, context)?);
    Ok(warnings)
}

/// Reads and conditions the files side by side.
fn read_all(
    ingest: &Ingest,
    lines: Lines,
    files: &[ScanFile],
    context: &Context,
) -> Result<Vec<ReadFile>, StageError> {
    let done = std::sync::atomic::AtomicU64::new(0);
    let watch = context.watch;
    // Collected first and judged then: a parallel search for an error finds any.
    let read: Vec<Result<ReadFile, StageError>> = files
        .par_iter()
        .map(|file| {
            watch.check_interrupt()?;
            let read = read_and_condition(ingest, lines, file)?;
            let count = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            (watch.progress)(count, files.len() as u64);
            Ok(read)
        })
        .collect();
    read.into_iter().collect()
}

/// Fails where lines are needed and all of them were left out.
fn require_lines(lines: Lines, read: &mut [ReadFile]) -> Result<(), StageError> {
    let none = read.iter().all(|file| file.scans.is_empty());
    let first = read.iter_mut().find(|file| !file.left_out.is_empty());
    match first {
        Some(file) if none && lines == Lines::Taken => Err(file.left_out.remove(0).reason.into()),
        _ => Ok(()),
    }
}

/// What all files hold.
#[derive(Default)]
struct Found {
    scans: Vec<ArrayDataset>,
    reports: Vec<ConditioningReport>,
    maps: Vec<ArrayDataset>,
    map_windows: Vec<MapRow>,
    map_faults: Vec<FaultRow>,
    /// The rows of maps without a window.
    maps_left_out: Vec<MapRow>,
}

impl Found {
    fn add(&mut self, file: &ScanFile, read: ReadFile) {
        match read.map {
            Some(KeptMap::Windows(windows, report)) => {
                self.maps.extend(windows.into_iter().map(|window| maps::dataset(window, file)));
                self.map_windows.extend(maps::map_rows(&report));
                self.map_faults.extend(fault_rows(&report.map, &report.faults));
            }
            Some(KeptMap::LeftOut(row)) => self.maps_left_out.push(*row),
            None => {}
        }
        for (windows, report) in read.scans {
            self.scans.extend(windows.into_iter().map(|window| dataset(window, file)));
            self.reports.push(report);
        }
    }

    /// Writes the results; returns warnings.
    fn write(
        self,
        ingest: &Ingest,
        lines: Lines,
        context: &mut Context,
    ) -> Result<Vec<String>, StageError> {
        if ingest.maps.is_some() && self.maps.is_empty() {
            let reasons = self.maps_left_out.into_iter().filter_map(|row| row.rejected).collect();
            return Err(StageError::NoMapLeft { reasons });
        }
        let reports: Vec<&ConditioningReport> = self.reports.iter().collect();
        let pending = &mut context.pending;
        if lines == Lines::Taken {
            pending.write_arrays(SCANS, Storage::Plain, &self.scans)?;
        }
        let scans: Vec<_> = reports.iter().map(|report| report_row(report)).collect();
        pending.write_rows(REPORT, &scans)?;
        let of_lines = reports.iter().flat_map(|report| fault_rows(&report.scan, &report.faults));
        let faults: Vec<_> = of_lines.chain(self.map_faults).collect();
        pending.write_rows(FAULTS, &faults)?;
        let windows: Vec<_> = reports.iter().flat_map(|report| window_rows(report)).collect();
        pending.write_rows(WINDOWS, &windows)?;
        let all_maps = [&self.map_windows[..], &self.maps_left_out].concat();
        if ingest.maps.is_some() {
            pending.write_arrays(MAPS, Storage::Plain, &self.maps)?;
            pending.write_rows(MAP_WINDOWS, &all_maps)?;
        }
        let pictures = write_pictures(&reports, ingest.fault_pictures, pending)?;
        let document = cleaning_markdown(&scans, &faults, &windows, &all_maps, &pictures);
        pending.write_document(CLEANING_FILE, &document)?;
        let mut warnings = warnings::of_scans(&reports);
        if let Some(conditioning) = &ingest.maps {
            warnings.extend(warnings::of_maps(&self.map_windows, conditioning.form));
            warnings.extend(warnings::maps_left_out(&self.maps_left_out, &self.map_windows));
        }
        Ok(warnings)
    }
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
