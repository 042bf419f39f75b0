//! Text scans, described by options.

use asperity::units::Units;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::foreign;
use crate::cli::output::{aligned, significant};
use crate::cli::{CliError, values};
use asperity::scans::description::{Column, DecimalMark, LengthUnit, Separator};
use asperity::scans::spreadsheet::is_workbook;
use asperity::scans::text_shape::TextShape;
use asperity::scans::{Described, TextFormat, read_bytes, read_described};
use asperity::surface::RawScan;
use asperity::surface::faults::merge_repeated;
use asperity::surface::resample::place_on_grid;
use statrs::statistics::{Data, OrderStatistics};

const FIRST_POINTS: usize = 5;

/// Enough for the names of the columns and some points.
const START: u64 = 1 << 16;

/// How a text scan is to be read; the keys `[ingest.format]` of a recipe as options.
#[derive(Debug, Args)]
#[command(next_help_heading = "Text scans")]
pub(in crate::cli) struct ScanOptions {
    /// Sheet of a workbook (.xlsx), by name or number (the first is 1); the first if not given.
    #[arg(long, value_name = "SHEET", value_parser = values::column)]
    sheet: Option<Column>,
    /// Separator of the cells: tab, comma, semicolon, whitespace or one character.
    #[arg(long, value_parser = values::separator)]
    separator: Option<Separator>,
    /// Column of the positions, by name or number (the first is 1).
    #[arg(long, value_name = "COLUMN", value_parser = values::column)]
    x_column: Option<Column>,
    /// Unit of the positions: nm, um, mm or m.
    #[arg(long, value_name = "UNIT", value_parser = values::length_unit)]
    x_unit: Option<LengthUnit>,
    /// Distance of neighbouring points in um, for a file of heights only, instead of --x-column; of a --matrix along its rows.
    #[arg(long, value_name = "UM", value_parser = values::positive, allow_negative_numbers = true)]
    x_spacing_um: Option<f64>,
    /// Each line is a row of a height map: heights alone, at the distance --x-spacing-um, rows at --y-spacing-um.
    #[arg(long)]
    matrix: bool,
    /// Distance of the rows of a --matrix in um; --x-spacing-um if not given.
    #[arg(long, value_name = "UM", value_parser = values::positive, allow_negative_numbers = true)]
    y_spacing_um: Option<f64>,
    /// Column of the positions across the lines of a height map, by name or number (the first is 1).
    #[arg(long, value_name = "COLUMN", value_parser = values::column)]
    y_column: Option<Column>,
    /// Unit of the positions across the lines: nm, um, mm or m.
    #[arg(long, value_name = "UNIT", value_parser = values::length_unit)]
    y_unit: Option<LengthUnit>,
    /// Column of the heights, by name or number (the first is 1).
    #[arg(long, value_name = "COLUMN", value_parser = values::column)]
    z_column: Option<Column>,
    /// Unit of the heights: nm, um, mm or m.
    #[arg(long, value_name = "UNIT", value_parser = values::length_unit)]
    z_unit: Option<LengthUnit>,
    /// The file holds depths, which grow away from the rubber.
    #[arg(long)]
    invert_z: bool,
    /// There is no line of column names before the first point.
    #[arg(long)]
    no_header: bool,
    /// Decimal mark, `.` or `,`.
    #[arg(long, value_name = "MARK", default_value = ".", value_parser = values::decimal_mark)]
    decimal_mark: DecimalMark,
    /// Character that starts a comment line, such as '#'.
    #[arg(long, value_name = "CHARACTER")]
    comment: Option<char>,
    /// Number of lines to skip at the start.
    #[arg(long, value_name = "N", default_value = "0", value_parser = values::count::<usize>)]
    skip_lines: usize,
    /// Skip all lines up to and with the first that starts with this text.
    #[arg(long, value_name = "TEXT")]
    skip_until: Option<String>,
    /// The points end before the first line that starts with this text.
    #[arg(long, value_name = "TEXT")]
    stop_at: Option<String>,
    /// A cell that marks a missing height, such as -25400; repeat it for more. Replaces the default:
    /// empty cells, NaN and BAD.
    #[arg(long, value_name = "TEXT", default_values = ["", "NaN", "BAD"], allow_hyphen_values = true)]
    missing: Vec<String>,
    /// Encoding of the text, such as utf-8, windows-1252 or utf-16le.
    #[arg(long, value_name = "LABEL", default_value = "utf-8")]
    encoding: String,
    /// Length in mm to leave out at the start of the track.
    #[arg(long, value_name = "MM", default_value = "0", value_parser = values::finite, allow_negative_numbers = true)]
    cut_start_mm: f64,
    /// Length in mm to leave out at the end of the track.
    #[arg(long, value_name = "MM", default_value = "0", value_parser = values::finite, allow_negative_numbers = true)]
    cut_end_mm: f64,
}

impl ScanOptions {
    /// The options that are given and differ from their defaults.
    pub(in crate::cli) fn given(&self) -> Vec<&'static str> {
        let default_missing = ["", "NaN", "BAD"];
        [
            ("--sheet", self.sheet.is_some()),
            ("--separator", self.separator.is_some()),
            ("--x-column", self.x_column.is_some()),
            ("--x-unit", self.x_unit.is_some()),
            ("--x-spacing-um", self.x_spacing_um.is_some()),
            ("--matrix", self.matrix),
            ("--y-spacing-um", self.y_spacing_um.is_some()),
            ("--y-column", self.y_column.is_some()),
            ("--y-unit", self.y_unit.is_some()),
            ("--z-column", self.z_column.is_some()),
            ("--z-unit", self.z_unit.is_some()),
            ("--invert-z", self.invert_z),
            ("--no-header", self.no_header),
            ("--decimal-mark", self.decimal_mark != DecimalMark::Point),
            ("--comment", self.comment.is_some()),
            ("--skip-lines", self.skip_lines > 0),
            ("--skip-until", self.skip_until.is_some()),
            ("--stop-at", self.stop_at.is_some()),
            ("--missing", self.missing != default_missing),
            ("--encoding", self.encoding != "utf-8"),
            ("--cut-start-mm", self.cut_start_mm != 0.0),
            ("--cut-end-mm", self.cut_end_mm != 0.0),
        ]
        .into_iter()
        .filter_map(|(option, given)| given.then_some(option))
        .collect()
    }

    /// Whether any of the options that describe a text is given.
    pub(super) fn are_given(&self) -> bool {
        !self.given().is_empty()
    }

    /// Refuses options of texts for the file at `path`, which is `what`.
    ///
    /// # Errors
    /// [`CliError::Input`] that names them.
    pub(in crate::cli) fn refuse(&self, path: &Path, what: &str) -> Result<(), CliError> {
        let given = self.given();
        if given.is_empty() {
            return Ok(());
        }
        let turn = match self.invert_z {
            true => {
                "; in a recipe, ingest.invert_instrument_heights turns the heights of instrument files"
            }
            false => "",
        };
        let given = given.join(", ");
        let problem = format!("is {what}, not text: leave out {given}{turn}");
        Err(foreign(path, &problem))
    }

    /// Reads the text file or the sheet of a workbook at `path`.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(in crate::cli) fn read(&self, path: &Path) -> Result<Described, CliError> {
        let format = self.format().map_err(|needed| {
            let problem = format!(
                "is text, not an artifact; to read it as a scan, give {needed} as well (units are never \
                 guessed); without options, inspect tells what it looks like"
            );
            foreign(path, &problem)
        })?;
        Ok(read_described(path, &format)?)
    }

    /// The scan, and contradictions between the options and the names of the columns.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn summary(&self, path: &Path, scan: RawScan) -> Result<Scan, CliError> {
        Ok(Scan { contradictions: self.contradictions(path)?, ..Scan::of(path, scan) })
    }

    /// Contradictions between the options and the names of the columns.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(in crate::cli) fn contradictions(&self, path: &Path) -> Result<Vec<String>, CliError> {
        let format = self.format().map_err(|needed| foreign(path, &format!("needs {needed}")))?;
        let failed = |error| CliError::input(format!("{} cannot be read: {error}", path.display()));
        let mut start = Vec::new();
        let file = std::fs::File::open(path).map_err(failed)?;
        file.take(START).read_to_end(&mut start).map_err(failed)?;
        // The directory of a workbook is at its end.
        if is_workbook(&start) {
            start = read_bytes(path).map_err(CliError::input)?;
        }
        let shape = TextShape::of(&start);
        Ok(shape.map(|shape| shape.contradictions(&format)).unwrap_or_default())
    }

    /// # Errors
    /// The required options that are not given.
    pub(in crate::cli) fn format(&self) -> Result<TextFormat, String> {
        let (spaced, matrix) = (self.x_spacing_um.is_some(), self.matrix);
        let needed: Vec<&str> = [
            ("--separator", self.separator.is_none()),
            ("--y-unit", !matrix && self.y_column.is_some() && self.y_unit.is_none()),
            ("--x-spacing-um", matrix && !spaced),
            ("--x-column (or --x-spacing-um)", !matrix && self.x_column.is_none() && !spaced),
            ("--x-unit", !matrix && self.x_unit.is_none() && !spaced),
            ("--z-column", !matrix && self.z_column.is_none()),
            ("--z-unit", self.z_unit.is_none()),
        ]
        .into_iter()
        .filter_map(|(option, absent)| absent.then_some(option))
        .collect();
        let (Some(separator), true) = (self.separator, needed.is_empty()) else {
            return Err(needed.join(", "));
        };
        Ok(TextFormat {
            sheet: self.sheet.clone(),
            separator,
            decimal_mark: self.decimal_mark,
            comment: self.comment,
            skip_lines: self.skip_lines,
            skip_until: self.skip_until.clone(),
            stop_at: self.stop_at.clone(),
            matrix,
            header: (!matrix || self.no_header).then_some(!self.no_header),
            x_column: self.x_column.clone(),
            x_spacing_um: self.x_spacing_um,
            y_spacing_um: self.y_spacing_um,
            x_unit: self.x_unit,
            y_column: self.y_column.clone(),
            y_unit: self.y_unit,
            z_column: self.z_column.clone(),
            z_unit: self.z_unit,
            invert_z: self.invert_z,
            missing: self.missing.clone(),
            encoding: self.encoding.clone(),
            cut_start_mm: self.cut_start_mm,
            cut_end_mm: self.cut_end_mm,
        })
    }
}

/// A raw scan, summarised.
#[derive(Debug, Serialize)]
pub(super) struct Scan {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    format: &'static str,
    pub(super) points: usize,
    pub(super) missing: usize,
    /// Of the least-squares line through the positions, which ingest takes as well.
    pub(super) spacing_m: f64,
    pub(super) mean_m: f64,
    /// Of the population of valid points.
    pub(super) std_m: f64,
    start_mm: f64,
    end_mm: f64,
    median_spacing_um: f64,
    smallest_spacing_um: f64,
    largest_spacing_um: f64,
    lowest_um: f64,
    highest_um: f64,
    mean_um: f64,
    /// Root of the mean square about the mean, before form and tilt are removed.
    rms_um: f64,
    /// Number of points at the position of the point before.
    repeated: usize,
    /// Contradictions between the options and the names of the columns.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    contradictions: Vec<String>,
    /// x in mm and z in um; absent where missing.
    first_points: Vec<(f64, Option<f64>)>,
}

impl Scan {
    /// The readers return two points or more and at least one height.
    pub(super) fn of(path: &Path, scan: RawScan) -> Self {
        let (merged, repeated) = merge_repeated(&scan);
        let fitted = place_on_grid(&merged).ok().map(|(grid, _)| grid.spacing);
        let RawScan { positions, heights, .. } = scan;
        let steps: Vec<f64> =
            positions.windows(2).map(|pair| (pair[1] - pair[0]).m_to_um()).collect();
        let present: Vec<f64> = heights
            .iter()
            .filter(|height| !height.is_nan())
            .map(|height| height.m_to_um())
            .collect();
        let mean =
            |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / present.len() as f64;
        let mean_um = mean(&mut present.iter().copied());
        let rms_um = mean(&mut present.iter().map(|z| (z - mean_um).powi(2))).sqrt();
        let lowest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (smallest_spacing_um, largest_spacing_um) = (lowest(&steps), highest(&steps));
        let median_spacing_um = Data::new(steps).median();
        let point = |(x, z): (&f64, &f64)| (x.m_to_mm(), (!z.is_nan()).then_some(z.m_to_um()));
        Self {
            path: path.to_path_buf(),
            format: "text",
            points: heights.len(),
            missing: heights.len() - present.len(),
            start_mm: lowest(&positions).m_to_mm(),
            end_mm: highest(&positions).m_to_mm(),
            smallest_spacing_um,
            largest_spacing_um,
            median_spacing_um,
            // Repeated positions may leave no line through them.
            spacing_m: fitted.unwrap_or(median_spacing_um.um_to_m()),
            mean_m: mean_um.um_to_m(),
            std_m: rms_um.um_to_m(),
            lowest_um: lowest(&present),
            highest_um: highest(&present),
            mean_um,
            rms_um,
            repeated,
            contradictions: Vec::new(),
            first_points: positions.iter().zip(&heights).take(FIRST_POINTS).map(point).collect(),
        }
    }

    pub(super) fn text(&self) -> String {
        let range = |from: f64, to: f64| format!("{} to {}", significant(from), significant(to));
        let share = 100.0 * self.missing as f64 / self.points as f64;
        let mut lines = vec![
            ("scan", self.path.display().to_string()),
            ("shape", format!("{} points, {} missing ({share:.1} %)", self.points, self.missing)),
            ("x", range(self.start_mm, self.end_mm) + " mm"),
            (
                "spacing",
                format!(
                    "{} um by least squares, median {} um, {} um",
                    significant(self.spacing_m.m_to_um()),
                    significant(self.median_spacing_um),
                    range(self.smallest_spacing_um, self.largest_spacing_um)
                ),
            ),
            ("z", range(self.lowest_um, self.highest_um) + " um"),
            ("mean of z", significant(self.mean_um) + " um"),
            ("rms of z", significant(self.rms_um) + " um about the mean, form not removed"),
        ];
        if self.repeated > 0 {
            let repeated = format!("{} points at the position of the one before", self.repeated);
            lines.push(("repeated", repeated));
        }
        lines.extend(self.contradictions.iter().map(|text| ("WARNING", text.clone())));
        let lines = aligned(&lines);
        let point = |(x, z): &(f64, Option<f64>)| {
            let z = z.map_or("missing".into(), significant);
            format!("{:>12}  {z:>12}\n", significant(*x))
        };
        let points: String = self.first_points.iter().map(point).collect();
        format!("{lines}\nfirst points\n{:>12}  {:>12}\n{points}", "x in mm", "z in um")
    }
}
