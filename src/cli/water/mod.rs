//! `asperity water`: the pools that a rubber seals on a map, and the film under a block.
//!
//! | module | what it holds |
//! |---|---|
//! | `film` | the time that a film needs to leave, as options and as lines |
//! | `surface` | one period of a map, from a file and into one |

mod film;
mod surface;

use super::CliError;
use super::output::{aligned, json, note, print, refuse_existing, significant};
use super::solve::refuse_to_overwrite;
use asperity::units::Units;
use asperity::water::{Neighbours, Pools};
use clap::{Args, ValueEnum};
use film::{Film, FilmOptions};
use serde::Serialize;
use std::path::PathBuf;
use surface::{Surface, SurfaceOptions, write};

const EXAMPLES: &str = "\
Examples:
  The bundled map without its plane and its gaps, and both surfaces for `solve areal`:
    asperity water --map data/scans/map/road.x3p --fill-gaps-mm 0.3 --remove-plane --mirror --dry dry.x3p --filled filled.x3p
    asperity solve areal --map filled.x3p --speed 1000 --pressure 0.3
  The time that water needs to leave a block of 20 mm by a long side until a film of 0.05 mm is left:
    asperity water --map dry.x3p --block-width-mm 20 --pressure 0.3 --film-um 50

Exit codes: 0 found, 1 not written, 2 bad input.";

/// Find the pools of water that a rubber seals on a map of a road.
///
/// Rubber that covers a road closes the valleys that have no way out of the period; full to the brim they are part of the surface that it
/// slides over (Persson et al. 2004, doi:10.1038/nmat1255). The water is at rest and does not yield: what flows, and a film that carries
/// part of the load, are not computed; docs/water.md.
#[derive(Debug, Args)]
#[command(name = "water", after_help = EXAMPLES, allow_negative_numbers = true)]
pub(super) struct WaterCommand {
    #[command(flatten)]
    surface: SurfaceOptions,
    /// Points between which water passes in what is printed and written; the volume is given for both kinds.
    #[arg(long, value_enum, value_name = "N", default_value_t = Passage::Four)]
    neighbours: Passage,
    /// Write the map with its pools full to this file, *.x3p or *.sdf.
    #[arg(long, value_name = "FILE")]
    filled: Option<PathBuf>,
    /// Write the same map without water, *.x3p or *.sdf.
    #[arg(long, value_name = "FILE")]
    dry: Option<PathBuf>,
    /// Overwrite files that are there already.
    #[arg(long)]
    force: bool,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    film: FilmOptions,
}

/// [`Neighbours`] by their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Passage {
    /// Along x and y: more water.
    #[value(name = "4")]
    Four,
    /// Across corners as well: less water.
    #[value(name = "8")]
    Eight,
}

/// What is printed; the names are the keys of JSON.
#[derive(Debug, Serialize)]
struct Summary {
    points_x: usize,
    points_y: usize,
    period_x_mm: f64,
    period_y_mm: f64,
    filled_gap_points: usize,
    rms_height_mm: f64,
    neighbours: u8,
    filled_fraction: f64,
    volume_per_area_mm: f64,
    volume_per_area_4_mm: f64,
    volume_per_area_8_mm: f64,
    deepest_mm: f64,
    deepest_at_mm: Option<[f64; 2]>,
    film: Option<Film>,
}

impl WaterCommand {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let film = self.film.film()?;
        for (path, option) in [(&self.filled, "--filled"), (&self.dry, "--dry")] {
            refuse_to_overwrite(path.as_deref(), option, &[Some(self.surface.map())])?;
            refuse_existing(path.as_deref(), self.force)?;
            path.as_deref().map(surface::format_of).transpose()?;
        }
        if self.filled.is_some() && self.filled == self.dry {
            return Err(CliError::input("--filled and --dry are the same file: choose two"));
        }
        let surface = self.surface.read()?;
        if let Some(warning) = &surface.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        let fill = |neighbours| {
            let map = &surface.map;
            Pools::new(&map.heights, map.points, neighbours).map_err(|error| {
                CliError::input(format!("{}: {error}", self.surface.map().display()))
            })
        };
        let both = [fill(Neighbours::Four)?, fill(Neighbours::Eight)?];
        let pools = &both[usize::from(self.neighbours == Passage::Eight)];
        if let Some(path) = &self.dry {
            write(path, self.force, &surface.map, &surface.map.heights)?;
        }
        if let Some(path) = &self.filled {
            write(path, self.force, &surface.map, &pools.heights)?;
        }
        let volumes = [both[0].mean_depth, both[1].mean_depth];
        let summary = self.summary(&surface, pools, volumes, film);
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    fn summary(
        &self,
        surface: &Surface,
        pools: &Pools,
        [four, eight]: [f64; 2],
        film: Option<Film>,
    ) -> Summary {
        let map = &surface.map;
        let [period_x_mm, period_y_mm] = map.periods.map(Units::m_to_mm);
        let place = |[i, j]: [usize; 2]| {
            [
                i as f64 / map.points[0] as f64 * period_x_mm,
                j as f64 / map.points[1] as f64 * period_y_mm,
            ]
        };
        Summary {
            points_x: map.points[0],
            points_y: map.points[1],
            period_x_mm,
            period_y_mm,
            filled_gap_points: surface.filled_gap_points,
            rms_height_mm: surface.rms_height().m_to_mm(),
            neighbours: if self.neighbours == Passage::Four { 4 } else { 8 },
            filled_fraction: pools.filled_fraction,
            volume_per_area_mm: pools.mean_depth.m_to_mm(),
            volume_per_area_4_mm: four.m_to_mm(),
            volume_per_area_8_mm: eight.m_to_mm(),
            deepest_mm: pools.deepest.m_to_mm(),
            deepest_at_mm: pools.deepest_point.map(place),
            film,
        }
    }
}

impl Summary {
    fn table(&self) -> String {
        let millimetres = |value: f64| significant(value) + " mm";
        let mut lines = vec![
            ("points", format!("{} by {}", self.points_x, self.points_y)),
            (
                "period",
                format!(
                    "{} by {} mm",
                    significant(self.period_x_mm),
                    significant(self.period_y_mm)
                ),
            ),
            ("points of gaps, filled", self.filled_gap_points.to_string()),
            ("rms height", millimetres(self.rms_height_mm)),
            ("share under water", significant(self.filled_fraction)),
            ("sealed volume per area", millimetres(self.volume_per_area_mm)),
            ("with 4 neighbours", millimetres(self.volume_per_area_4_mm)),
            ("with 8 neighbours", millimetres(self.volume_per_area_8_mm)),
            ("deepest pool", millimetres(self.deepest_mm)),
        ];
        if let Some([x, y]) = self.deepest_at_mm {
            lines.push(("at x, y", format!("{}, {} mm", significant(x), significant(y))));
        }
        if let Some(film) = &self.film {
            lines.extend(film.lines());
        }
        aligned(&lines)
    }
}
