//! From a scan file to its windows: those of its lines, and of the map that it is.

use super::{Ingest, Lines, ScanFile, maps, warnings};
use crate::artifact::Digesting;
use crate::scans::file::{CHANNELS, Format, Grid, MapLines, is_instrument, open_channel};
use crate::scans::spreadsheet::is_workbook;
use crate::scans::text_shape::TextShape;
use crate::scans::{Described, FileError, FileProblem, Source, TextFormat, read_source};
use crate::stages::StageError;
use crate::surface::condition::ConditioningError;
use crate::surface::{ConditioningReport, LineScan, RawScan, condition};

/// Windows of a scan, and what became of it.
pub(super) type Conditioned = (Vec<LineScan>, ConditioningReport);

/// A line of a map that cannot be conditioned.
#[derive(Debug)]
pub(super) struct LeftOutLine {
    /// Name of the line.
    pub line: String,
    /// Why.
    pub reason: ConditioningError,
}

/// The line scans of a file, and what is to be told of it.
#[derive(Default)]
pub(super) struct ReadFile {
    pub scans: Vec<Conditioned>,
    /// Lines of a map that is kept which cannot be conditioned: the map and the other lines do without them.
    pub left_out: Vec<LeftOutLine>,
    /// The map that the file holds, where maps are kept.
    pub map: Option<maps::KeptMap>,
    /// Whether it is text and not the file of an instrument.
    pub is_text: bool,
    /// Where the description contradicts the file.
    pub contradictions: Vec<String>,
    /// The channels of heights of an ERD file that has several.
    pub channels: Option<String>,
    /// Whether it is an ERD file.
    pub is_erd: bool,
    /// A height that seems to stand for missing ones, in words.
    pub repeated: Option<String>,
    /// A stretch on which the sensor seems to have stood still, in words.
    pub stuck: Option<String>,
    /// Heights that are smoother than those of a road, in words.
    pub smooth: Option<String>,
}

impl ReadFile {
    /// Looks at a line for what a user should be told of, and conditions it where line scans are taken. A line of a map that
    /// is kept is left out if it cannot be conditioned: the corner of a map may be missing.
    fn take(
        &mut self,
        (ingest, lines): (&Ingest, Lines),
        line: &RawScan,
        format: Option<&TextFormat>,
        of_map: bool,
    ) -> Result<(), StageError> {
        if self.repeated.is_none() {
            self.repeated = warnings::repeated(line, format);
        }
        if self.stuck.is_none() {
            self.stuck = warnings::stuck(line);
        }
        if self.smooth.is_none() {
            self.smooth = warnings::smooth(line);
        }
        if lines == Lines::None {
            return Ok(());
        }
        match condition(line, &ingest.conditioning) {
            Ok(conditioned) => self.scans.push(conditioned),
            Err(reason) if of_map && ingest.maps.is_some() && !is_of_recipe(&reason) => {
                self.left_out.push(LeftOutLine { line: line.name.clone(), reason });
            }
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }
}

/// Whether the recipe is wrong, and not the line.
fn is_of_recipe(error: &ConditioningError) -> bool {
    matches!(error, ConditioningError::Parameter { .. })
}

/// Conditions the line scans of a file while it is read; nothing of it counts unless all that was
/// read is what was digested before.
pub(super) fn read_and_condition(
    ingest: &Ingest,
    lines: Lines,
    file: &ScanFile,
) -> Result<ReadFile, StageError> {
    let io = |source| StageError::ScanIo { path: file.path.clone(), source };
    let opened = std::fs::File::open(&file.path).map_err(io)?;
    let length = opened.metadata().map_err(io)?.len();
    let mut reader = Digesting::new(opened);
    let source = Source::new(&mut reader, length).map_err(io)?;
    let read = read_scans(ingest, lines, file, source);
    if reader.finish().map_err(io)? != file.digest {
        return Err(StageError::ScanChanged { path: file.path.clone() });
    }
    read
}

/// The line scans of a file: one, or the chosen lines of a height map, each conditioned as soon
/// as it is complete.
fn read_scans(
    ingest: &Ingest,
    lines: Lines,
    file: &ScanFile,
    source: Source<'_>,
) -> Result<ReadFile, StageError> {
    /// Enough for the names of the columns and some points.
    const START: usize = 1 << 16;
    let name = file.path.display().to_string();
    let file_error = |problem| Box::new(FileError { file: name.clone(), problem }).into();
    let source = source
        .with_directory()
        .map_err(|source| StageError::ScanIo { path: file.path.clone(), source })?;
    if is_instrument(source.start()) {
        return read_instrument(ingest, lines, file, source).map_err(|failure| match failure {
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
    let mut read = ReadFile { is_text: true, contradictions, ..ReadFile::default() };
    let taken = (ingest, lines);
    match read_source(&name, source, format)? {
        Described::Line(scan) => {
            let scan = RawScan { name: file.name.clone(), ..scan };
            read.take(taken, &scan, Some(format), false)?;
        }
        Described::Map(heights) => {
            let chosen = chosen_lines(ingest, file, heights.grid)?;
            read.map = maps::kept(ingest, file, &heights)?;
            let scans = heights.line_scans(&file.name, chosen, ingest.map_line_step);
            for scan in scans.map_err(file_error)? {
                read.take(taken, &scan, Some(format), true)?;
            }
        }
    }
    Ok(read)
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
    lines: Lines,
    file: &ScanFile,
    source: Source<'_>,
) -> Result<ReadFile, Failure> {
    let is_erd = Format::detect(source.start()) == Some(Format::Erd);
    let mut read = ReadFile { is_erd, ..ReadFile::default() };
    let Some(scan) = open_channel(source, ingest.erd_channel)? else { return Ok(read) };
    let said = |name: &str| scan.instrument.iter().find(|(key, _)| key == name);
    read.channels = said(CHANNELS).map(|(_, channels)| channels.clone());
    let chosen = chosen_lines(ingest, file, scan.grid).map_err(Box::new)?;
    let of_map = matches!(scan.grid, Grid::Map { .. });
    let turn = |heights: &mut [f64]| {
        if ingest.invert_instrument_heights {
            heights.iter_mut().for_each(|height| *height = -*height);
        }
    };
    let mut each = |mut line: RawScan| {
        turn(&mut line.heights);
        read.take((ingest, lines), &line, None, of_map).map_err(Box::new)?;
        Ok::<(), Failure>(())
    };
    if ingest.maps.is_none() {
        scan.lines(&file.name, chosen, ingest.map_line_step, &mut each)?;
        return Ok(read);
    }
    let mut whole = scan.whole()?;
    for line in whole.line_scans(&file.name, chosen, ingest.map_line_step)? {
        each(line)?;
    }
    turn(&mut whole.heights);
    read.map = maps::kept(ingest, file, &whole).map_err(Box::new)?;
    Ok(read)
}
