//! Friction over the shortest wavelength: how much of it each further octave of the road makes.
//!
//! Every octave of roughness that a model takes in adds friction, on a self-affine road without end. Where to stop is a
//! choice of the user (what the instrument shows, what the rubber feels, a film of dirt), and this study shows what it does.
//! The half-space is solved alone: it tells the trend, the steepest octaves are a matter of finite deformation.

use crate::artifact::{ArtifactError, RunView};
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::Interrupt;
use crate::pipeline::{self, Event, PipelineError, Selection};
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::recipe::Recipe;
use crate::report::About;
use crate::requirement::InvalidRecipe;
use crate::stages::approximate::WAVES;
use crate::stages::bem::Given;
use crate::stages::ingest::{MAPS, SCANS, read_maps, read_windows};
use crate::stages::realise::{AREAL_SURFACES, LONGEST_GAP, Method, SurfaceKind};
use crate::stages::tables::{FRICTION, FrictionRow};
use crate::stages::{Job, StageError};
use crate::surface::{HeightMap, LineScan};
use crate::units::Units;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Friction down to one shortest wavelength.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CutoffRow {
    /// Which surfaces; of sines the number of the recipe, of which longer shortest wavelengths leave some.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// What friction is given for.
    pub given: Given,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
    /// Mean pressure in MPa.
    pub pressure_mpa: f64,
    /// Shortest wavelength in mm.
    pub shortest_wavelength_mm: f64,
    /// Mean friction coefficient.
    pub mean: f64,
    /// Half width of the 95 % confidence interval of the mean over realisations; absent for a single one.
    pub confidence_95: Option<f64>,
    /// What the last octave adds, over the friction without it; absent for the longest of the shortest wavelengths.
    pub growth: Option<f64>,
}

/// Why a study has no result.
#[derive(Debug, thiserror::Error)]
pub enum CutoffError {
    /// A run.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// Its results.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// The windows of a run.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] InvalidRecipe),
    /// A recipe without a road of its own, or with many.
    #[error(
        "the study of the shortest wavelength needs a recipe with [ingest], and without [sweep]"
    )]
    NoScans,
}

impl HasKind for CutoffError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Pipeline(source) => source.kind(),
            Self::Artifact(source) => source.kind(),
            Self::Stage(source) => source.kind(),
            Self::Recipe(source) => source.kind(),
            Self::NoScans => ErrorKind::Input,
        }
    }
}

/// The rubber of a study and its rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cutoff {
    /// Rubber and temperature.
    pub material: String,
    /// Rows by surfaces, speed, area or pressure, and descending shortest wavelength.
    pub rows: Vec<CutoffRow>,
}

/// Runs a recipe down to its own shortest wavelength, and with so many octaves less, one by one, each in a folder of its own
/// in `out`: what is there is not computed again.
///
/// # Errors
/// [`CutoffError`].
pub fn study(
    recipe: &Recipe,
    octaves: u32,
    out: &Path,
    interrupted: &Interrupt,
    observer: &(dyn Fn(u32, Event) + Sync),
) -> Result<Cutoff, CutoffError> {
    if recipe.ingest.is_none() || recipe.sweep.is_some() {
        return Err(CutoffError::NoScans);
    }
    let mut rows: Vec<CutoffRow> = Vec::new();
    let (mut material, mut window_mm) = (String::new(), f64::INFINITY);
    let mut base_mm = recipe.approximate.as_ref().and_then(|a| a.shortest_wavelength_mm);
    for octave in 0..=octaves {
        let Some(variant) = longer(recipe, octave, base_mm) else { break };
        let shortest = variant.realise.as_ref().and_then(|realise| realise.shortest_wavelength_mm);
        if octave > 0 && shortest.is_some_and(|shortest| WAVES_IN_WINDOW * shortest > window_mm) {
            break;
        }
        let folder = folder(out, octave);
        pipeline::run(&variant, &folder, Selection::default(), interrupted, &|event| {
            observer(octave, event);
        })?;
        let view = RunView::of(&folder);
        if base_mm.is_none() {
            // The recipe leaves it to the scans: what they gave is the shortest of all.
            base_mm = shortest_wavelength_mm(&variant, &view)?;
        }
        if octave == 0 {
            window_mm = shortest_window_mm(&view)?;
        }
        material = About::of(&view)?.material();
        rows.extend(view.rows(FRICTION)?.iter().map(|row| cutoff_row(row, octave)));
    }
    let key = |row: &CutoffRow| {
        let value = match row.given {
            Given::Area => row.contact_area_fraction,
            Given::Pressure => row.pressure_mpa,
        };
        (row.kind, row.speed_mm_s.to_bits(), row.given, value.to_bits())
    };
    rows.sort_by(|a, b| {
        key(a).cmp(&key(b)).then(b.shortest_wavelength_mm.total_cmp(&a.shortest_wavelength_mm))
    });
    for k in 1..rows.len() {
        if key(&rows[k]) == key(&rows[k - 1]) {
            rows[k].growth = Some(rows[k].mean / rows[k - 1].mean - 1.0);
        }
    }
    Ok(Cutoff { material, rows })
}

/// The shortest wavelength in mm that a run found: of the sines, or of maps that stand alone.
fn shortest_wavelength_mm(recipe: &Recipe, view: &RunView) -> Result<Option<f64>, CutoffError> {
    let wavelengths: Vec<f64> = if has_lines(recipe) {
        view.rows(WAVES)?.iter().map(|row| row.wavelength_mm).collect()
    } else {
        view.rows(AREAL_SURFACES)?.iter().map(|row| row.shortest_wavelength_mm).collect()
    };
    Ok(wavelengths.into_iter().reduce(f64::min))
}

fn has_lines(recipe: &Recipe) -> bool {
    match recipe.job() {
        Ok(Job::Chain(chain)) => chain.has_lines(),
        _ => false,
    }
}

/// Waves that a window holds at least, to be a profile of them.
const WAVES_IN_WINDOW: f64 = 4.0;

/// Length of the shortest window of a line or side of a map in mm.
fn shortest_window_mm(view: &RunView) -> Result<f64, CutoffError> {
    let windows = if view.has(SCANS)? { read_windows(view)? } else { Vec::new() };
    let maps = if view.has(MAPS)? { read_maps(view)? } else { Vec::new() };
    let sides = maps.iter().flat_map(HeightMap::lengths).fold(f64::INFINITY, f64::min);
    let length = |window: &LineScan| {
        window.heights.iter().filter(|z| !z.is_nan()).count() as f64 * window.spacing
    };
    Ok(windows.iter().map(length).fold(sides, f64::min).m_to_mm())
}

/// The folder of a run.
fn folder(out: &Path, octave: u32) -> PathBuf {
    out.join(format!("octaves_less_{octave}"))
}

fn cutoff_row(row: &FrictionRow, octave: u32) -> CutoffRow {
    let mut kind = row.kind;
    if kind.method == Method::Sines {
        kind.waves += octave;
    }
    CutoffRow {
        kind,
        speed_mm_s: row.speed_mm_s,
        given: row.given,
        contact_area_fraction: row.contact_area_fraction,
        pressure_mpa: row.pressure_mpa,
        shortest_wavelength_mm: row.shortest_wavelength_mm,
        mean: row.mean,
        confidence_95: row.confidence_95,
        growth: None,
    }
}

/// The recipe on the half-space without so many of its shortest octaves; `None` if nothing is left. `base_mm` is the shortest
/// wavelength of its sines, which only the recipe itself may leave open.
fn longer(recipe: &Recipe, octave: u32, base_mm: Option<f64>) -> Option<Recipe> {
    let mut variant = recipe.clone();
    (variant.micro, variant.hybrid, variant.fem, variant.multilevel) = (None, None, None, None);
    (variant.feedback, variant.methods) = (None, None);
    variant.tables.published.clear();
    variant.tables.published_corrections.clear();
    variant.tables.theories.clear();
    if let Some(bem) = &mut variant.bem {
        bem.estimate_scan_error = false;
        bem.field_area_fractions.clear();
    }
    variant.areal.field_area_fractions.clear();
    let factor = 2.0_f64.powi(octave as i32);
    let approximate = variant.approximate.as_mut()?;
    let fewer = |waves: &mut Vec<u32>| {
        waves.retain(|number| *number > octave);
        waves.iter_mut().for_each(|number| *number -= octave);
    };
    let realise = variant.realise.as_mut()?;
    if octave > 0 {
        let base_mm = base_mm?;
        approximate.shortest_wavelength_mm = Some(factor * base_mm);
        fewer(&mut approximate.waves);
        fewer(&mut realise.waves);
        if realise.waves.is_empty() {
            realise.methods.retain(|method| *method != Method::Sines);
        }
        if realise.names_windows() || realise.is_isotropic() {
            let own_mm = realise.shortest_wavelength_mm.unwrap_or(base_mm);
            realise.shortest_wavelength_mm = Some(factor * own_mm);
            // The same windows at all shortest wavelengths.
            realise.longest_gap_mm = Some(realise.longest_gap_mm.unwrap_or(LONGEST_GAP * own_mm));
        }
    }
    (!approximate.waves.is_empty() && !realise.methods.is_empty()).then_some(variant)
}

impl Cutoff {
    /// Friction over the shortest wavelength: a panel for each area or pressure, a line for each speed and kind of surfaces.
    pub fn figure(&self) -> Option<Figure> {
        let condition = |row: &CutoffRow| match row.given {
            Given::Area => format!("Ac/A0 = {}", row.contact_area_fraction),
            Given::Pressure => format!("{} MPa", row.pressure_mpa),
        };
        let mut panels: Vec<(String, Vec<&CutoffRow>)> = Vec::new();
        for row in &self.rows {
            let name = condition(row);
            match panels.iter_mut().find(|(known, _)| *known == name) {
                Some((_, rows)) => rows.push(row),
                None => panels.push((name, vec![row])),
            }
        }
        let panel = |(title, rows): &(String, Vec<&CutoffRow>)| {
            let same =
                |a: &&CutoffRow, b: &&CutoffRow| a.kind == b.kind && a.speed_mm_s == b.speed_mm_s;
            let series = rows.chunk_by(same).enumerate().flat_map(|(number, line)| {
                let colour = Colour::Nth(number);
                let points: Vec<(f64, f64)> =
                    line.iter().map(|row| (row.shortest_wavelength_mm, row.mean)).collect();
                let bars = line.iter().filter_map(|row| {
                    let half = row.confidence_95?;
                    Some((row.shortest_wavelength_mm, row.mean - half, row.mean + half))
                });
                let name = format!("{}, {} mm/s", line[0].kind, line[0].speed_mm_s);
                [
                    Series::unnamed(colour, Mark::ErrorBars(bars.collect())),
                    Series::new(name, colour, Mark::Line(points.clone())),
                    Series::unnamed(colour, Mark::FilledCircles(points)),
                ]
            });
            Panel {
                title: format!("{title}, {}", self.material),
                x: Axis::logarithmic("shortest wavelength / mm"),
                y: Axis::from_zero("friction coefficient µ"),
                series: series.collect(),
            }
        };
        let panels: Vec<Panel> = panels.iter().map(panel).collect();
        let caption = "Friction of the half-space over the shortest wavelength of the road, one point per octave, in the \
                       mean over realisations with its 95 % confidence interval."
            .into();
        (!panels.is_empty()).then_some(Figure { caption, panels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe(realise: &str) -> Recipe {
        let text = format!(
            "title = 'x'\n[ingest]\nscans = ['a.txt']\n[approximate]\nwaves = [3, 2]\n\
             shortest_wavelength_mm = 0.1\n[realise]\n{realise}\nseed = 1\nrealisations = 2\n\
             [bem]\nrubber = 'r.toml'\nspeeds_mm_s = [1.0]\n[micro]\n"
        );
        Recipe::parse(&text, Path::new("x.toml")).unwrap()
    }

    #[test]
    fn every_octave_less_has_one_wave_less_and_twice_the_shortest_wavelength() {
        let both = recipe("waves = [3, 2]\nmethods = ['measured', 'sines']");
        let at = |octave| longer(&both, octave, Some(0.1));
        let one = at(1).unwrap();
        assert!(one.micro.is_none());
        assert_eq!(one.approximate.as_ref().unwrap().waves, [2, 1]);
        assert_eq!(one.approximate.as_ref().unwrap().shortest_wavelength_mm, Some(0.2));
        let realise = one.realise.unwrap();
        assert_eq!((realise.waves, realise.shortest_wavelength_mm), (vec![2, 1], Some(0.2)));
        assert_eq!(realise.longest_gap_mm, Some(0.8));
        assert_eq!(at(2).unwrap().approximate.unwrap().waves, [1]);
        assert!(at(3).is_none());
        assert_eq!(at(0).unwrap().realise, both.realise);
    }
}
