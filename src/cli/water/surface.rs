//! One period of a map, from a file and into one.

use crate::cli::inspect::ScanOptions;
use crate::cli::output::write_file;
use crate::cli::solve::{
    Map, Pair, cliff, mirrored, parse_size, read_map_with_gaps, require_surface,
};
use crate::cli::{CliError, values};
use asperity::error_kind::HasKind;
use asperity::scans::description::LengthUnit;
use asperity::scans::file::{Grid, ScanFile, write_sdf, write_x3p};
use asperity::surface::HeightMap;
use asperity::surface::map::form::{FormOfMap, remove_form};
use asperity::surface::map::gaps::fill_gaps;
use asperity::units::Units;
use clap::Args;
use std::path::{Path, PathBuf};

/// A map.
#[derive(Debug, Args)]
pub(super) struct SurfaceOptions {
    /// Map of one period: a file of an instrument, or text as for `solve areal`.
    #[arg(long, value_name = "FILE")]
    map: PathBuf,
    /// Unit of a --map of text: nm, um, mm or m; never guessed.
    #[arg(long, value_name = "UNIT", value_parser = values::length_unit)]
    map_unit: Option<LengthUnit>,
    /// Periods in mm along x and y of a --map of heights; one number is the length of a row.
    #[arg(long, value_name = "LX[,LY]", value_parser = parse_size)]
    size_mm: Option<Pair<f64>>,
    /// Fill gaps up to this width in mm, evenly from the heights around, which makes no pools in them; wider ones are refused, as
    /// all are without this option.
    #[arg(long, value_name = "MM", value_parser = values::positive)]
    fill_gaps_mm: Option<f64>,
    /// Remove the mean plane, on which the rubber lies; without this, heights are taken as they are.
    #[arg(long)]
    remove_plane: bool,
    /// Mirror the map along both directions, so that it closes: what flows to an edge is turned back there.
    #[arg(long)]
    mirror: bool,
    /// How the text of a map is to be read.
    #[command(flatten)]
    text: ScanOptions,
}

/// One period of a surface without gaps.
pub(super) struct Surface {
    pub(super) map: Map,
    pub(super) filled_gap_points: usize,
    /// What looks like a mistake.
    pub(super) warning: Option<String>,
}

impl SurfaceOptions {
    pub(super) fn map(&self) -> &Path {
        &self.map
    }

    /// # Errors
    /// [`CliError`] with the file.
    pub(super) fn read(&self) -> Result<Surface, CliError> {
        let size = self.size_mm.map(Pair::metres);
        let read = read_map_with_gaps(&self.map, self.map_unit, size, &self.text)?;
        require_surface(&self.map, &read)?;
        let Map { points, periods, heights } = read;
        let spacing = [0, 1].map(|axis| periods[axis] / points[axis] as f64);
        let mut map = HeightMap { name: self.map.display().to_string(), points, spacing, heights };
        let filled_gap_points = match (self.fill_gaps_mm, map.missing()) {
            (_, 0) => 0,
            (Some(longest), _) => fill_gaps(&mut map, longest.mm_to_m())
                .map_err(|error| CliError::of(error.kind(), error.to_string()))?,
            (None, missing) => {
                return Err(CliError::input(format!(
                    "{}: {missing} of {} heights are missing: give --fill-gaps-mm to fill them from the heights around, or \
                     cut them off",
                    self.map.display(),
                    map.heights.len()
                )));
            }
        };
        if self.remove_plane {
            remove_form(&mut map, FormOfMap::Plane)
                .map_err(|error| CliError::of(error.kind(), error.to_string()))?;
        }
        let mut map = Map { points, periods, heights: map.heights };
        if self.mirror {
            map = mirrored(&map);
        }
        let warning = cliff(&map);
        Ok(Surface { map, filled_gap_points, warning })
    }
}

impl Surface {
    /// Root mean square height in m about the mean.
    pub(super) fn rms_height(&self) -> f64 {
        let heights = &self.map.heights;
        let count = heights.len() as f64;
        let mean = heights.iter().sum::<f64>() / count;
        (heights.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

/// Formats of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MapFormat {
    X3p,
    Sdf,
}

/// By the name of the file.
///
/// # Errors
/// [`CliError::Input`] for another name.
pub(super) fn format_of(path: &Path) -> Result<MapFormat, CliError> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("x3p") => Ok(MapFormat::X3p),
        Some("sdf") => Ok(MapFormat::Sdf),
        _ => Err(CliError::input(format!("{}: call the new file *.x3p or *.sdf", path.display()))),
    }
}

/// Writes heights on the grid of a map.
///
/// # Errors
/// [`CliError`] for a file that cannot be written.
pub(super) fn write(path: &Path, force: bool, map: &Map, heights: &[f64]) -> Result<(), CliError> {
    let ([columns, rows], [spacing_x, spacing_y]) =
        (map.points, [0, 1].map(|axis| map.periods[axis] / map.points[axis] as f64));
    let file = ScanFile {
        format: "computed".into(),
        detected: String::new(),
        grid: Grid::Map { columns, rows, spacing_x, spacing_y },
        heights: heights.to_vec(),
        instrument: Vec::new(),
    };
    let bytes = match format_of(path)? {
        MapFormat::X3p => write_x3p(&file).map_err(CliError::failure)?,
        MapFormat::Sdf => write_sdf(&file).into_bytes(),
    };
    write_file(path, force, |out| out.write_all(&bytes))
}
