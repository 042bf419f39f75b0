//! Areal surfaces: the windows of maps, and surfaces with their spectrum.

use super::profiles::LONGEST_GAP;
use super::{Method, Realise, SurfaceKind};
use crate::artifact::{
    ArrayDataset, ArrayFile, ArraysSchema, Attribute, AttributeSchema, DatasetSchema, ResultFile,
    Row, RunView, Table,
};
use crate::stages::StageError;
use crate::surface::map::gaps::{GapError, fill_gaps};
use crate::surface::map::periodic::blended_length;
use crate::surface::map::phases::{matched_map, random_phase_map};
use crate::surface::{Closure, HeightMap, PeriodicMap, PeriodicMapError};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Heights of the areal surfaces: `areal.h5`, where there are any.
pub const AREAL: ArrayFile = ArrayFile {
    file: ResultFile { stage: "realise", name: "areal.h5" },
    schema: "asperity.realise.areal",
    version: 1,
    description: "heights of one period of surfaces that are periodic in both directions",
};
/// What each areal surface is of, and its roughness: `areal.arrow`, where there are any.
pub const AREAL_SURFACES: Table<ArealRow> = Table::new("realise", "areal.arrow");

/// One areal surface, and its roughness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Name of the window of a map; of isotropic surfaces `average`, over all line scans.
    pub window: String,
    /// Period along x: twice the window if mirrored, less than the window if blended.
    #[schemars(extend("unit" = "mm"))]
    pub period_x_mm: f64,
    /// Period along y.
    #[schemars(extend("unit" = "mm"))]
    pub period_y_mm: f64,
    /// Shortest wavelength, in any direction.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_wavelength_mm: f64,
    /// Share of the points of the window that had no height and were filled.
    #[schemars(extend("unit" = "1"))]
    pub filled: f64,
    /// Root mean square height of the waves that are shorter than the shortest wavelength, and left out.
    #[schemars(extend("unit" = "mm"))]
    pub left_out_rms_height_mm: f64,
    /// Root mean square height.
    #[schemars(extend("unit" = "mm"))]
    pub rms_height_mm: f64,
    /// Root mean square of the length of the gradient.
    #[schemars(extend("unit" = "1"))]
    pub rms_gradient: f64,
    /// Mean cube of the heights over that of the root mean square: negative for plateaus with pits.
    #[schemars(extend("unit" = "1"))]
    pub skewness: f64,
    /// Mean fourth power of the heights over that of the root mean square: 3 for Gaussian heights.
    #[schemars(extend("unit" = "1"))]
    pub kurtosis: f64,
    /// Root mean square difference of the sorted heights to those of the window, over their root mean square; absent
    /// where the heights are not matched.
    #[schemars(extend("unit" = "1"))]
    pub mismatch: Option<f64>,
}

impl Row for ArealRow {
    const SCHEMA: &'static str = "asperity.realise.areal_surfaces";
    const VERSION: u32 = 1;
}

/// What [`AREAL`] holds.
pub fn areal_schema() -> ArraysSchema {
    let attribute = |name, kind, description| AttributeSchema { name, kind, description };
    ArraysSchema {
        schema: AREAL.schema,
        version: AREAL.version,
        description: AREAL.description,
        datasets: vec![DatasetSchema {
            path: "{surfaces}/realisation_{realisation}",
            unit: "m",
            description: "heights row by row, x fastest, growing towards the rubber; more than two points on every wave, so \
                          that a discrete Fourier transform gives them on any other grid",
            attributes: vec![
                attribute("points_x", "i64", "points along x"),
                attribute("points_y", "i64", "points along y"),
                attribute("period_x_m", "f64", "period along x"),
                attribute("period_y_m", "f64", "period along y"),
                attribute("shortest_wavelength_m", "f64", "shortest wavelength"),
                attribute("method", "string", "how the surface is made of the road"),
                attribute("realisation", "i64", "number of the realisation"),
            ],
        }],
    }
}

/// An areal surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArealSurface {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Its heights.
    pub map: PeriodicMap,
}

/// Surfaces, what each of them is of, and warnings.
pub(super) type ArealSurfaces = (Vec<ArealSurface>, Vec<ArealRow>, Vec<String>);

/// A window that was made periodic.
struct Window {
    name: String,
    /// Share of points that were filled.
    filled: f64,
    /// Mean square height in m² of the waves that were left out.
    left_out: f64,
    map: PeriodicMap,
}

/// The areal surfaces of all methods of windows. Flat maps, and those with a gap that is not filled or of too few waves, are left out.
///
/// # Errors
/// [`StageError::PeriodicMap`], [`StageError::Gap`] or [`StageError::FlatWindow`] where no map is left.
pub(super) fn of_maps(
    parameters: &Realise,
    maps: Vec<HeightMap>,
    shortest: f64,
) -> Result<ArealSurfaces, StageError> {
    let longest_gap = parameters.longest_gap_mm.map_or(LONGEST_GAP * shortest, Units::mm_to_m);
    let closure = parameters.periodic.unwrap_or_default();
    let most = parameters.most_windows.map_or(usize::MAX, |most| most as usize);
    let (mut windows, mut left_out) = (Vec::new(), LeftOut::default());
    for map in maps {
        if windows.len() == most {
            break;
        }
        match window(map, closure, shortest, longest_gap) {
            Ok(window) if window.map.is_flat() => left_out.flat.push(window.name),
            Ok(window) => windows.push(window),
            Err(StageError::Gap(gap)) => left_out.gaps.push(gap),
            Err(StageError::PeriodicMap(reason)) => left_out.unresolved.push(reason),
            Err(error) => return Err(error),
        }
    }
    let warnings = told(&windows, &left_out, closure, shortest);
    if windows.is_empty() {
        return Err(left_out.into_error());
    }
    let draws = parameters.areal_drawn() as usize;
    let methods = parameters.methods.iter().filter_map(|method| method.areal());
    let to_make: Vec<(Method, usize)> = methods
        .flat_map(|method| {
            let count = if method == Method::ArealMeasured { windows.len() } else { draws };
            (0..count).map(move |k| (method, k))
        })
        .collect();
    let seed = parameters.seed.unwrap_or_default();
    let made: Vec<(ArealSurface, ArealRow)> = to_make
        .par_iter()
        .map(|&(method, k)| {
            let window = &windows[k % windows.len()];
            let (map, mismatch) = drawn(method, &window.map, seed, k as u32 + 1);
            let kind = SurfaceKind::of(method);
            let surface = ArealSurface { kind, realisation: k as u32 + 1, map };
            let row = row(&surface, &window.name, [window.filled, window.left_out], mismatch);
            (surface, row)
        })
        .collect();
    let (surfaces, rows) = made.into_iter().unzip();
    Ok((surfaces, rows, warnings))
}

/// Windows that are no surfaces.
#[derive(Default)]
struct LeftOut {
    gaps: Vec<GapError>,
    /// Names of those without a wave.
    flat: Vec<String>,
    /// Of too few waves or points.
    unresolved: Vec<PeriodicMapError>,
}

impl LeftOut {
    /// Why no window is left.
    fn into_error(self) -> StageError {
        if let Some(reason) = self.unresolved.into_iter().next() {
            return StageError::PeriodicMap(reason);
        }
        match (self.gaps.into_iter().next(), self.flat.into_iter().next()) {
            (Some(gap), _) => StageError::Gap(gap),
            (None, Some(window)) => StageError::FlatWindow { window },
            (None, None) => StageError::NoMapLeft { reasons: Vec::new() },
        }
    }
}

/// Share of filled points that is told of.
const MUCH_FILLED: f64 = 0.1;
/// Shortest waves over which the ends of a window pass into each other, at least: the seam is a steep ridge otherwise.
const WAVES_IN_SEAM: f64 = 4.0;

fn told(windows: &[Window], left_out: &LeftOut, closure: Closure, shortest: f64) -> Vec<String> {
    let LeftOut { gaps, flat, unresolved } = left_out;
    let total = windows.len() + gaps.len() + flat.len() + unresolved.len();
    let mut warnings = Vec::new();
    let seam = windows.iter().flat_map(|window| window.map.periods).map(blended_length);
    let narrowest = seam.fold(f64::INFINITY, f64::min);
    if closure == Closure::Blend && narrowest < WAVES_IN_SEAM * shortest {
        warnings.push(format!(
            "realise.periodic = \"blend\": the ends of the maps pass into each other over {:.2} mm, less than {WAVES_IN_SEAM} \
             shortest waves of {:.2} mm; the seam is steeper than the road and raises friction (by 17 % on the bundled map); \
             take larger windows, or \"mirror\"",
            narrowest.m_to_mm(),
            shortest.m_to_mm()
        ));
    }
    let filled = windows.iter().map(|window| window.filled).fold(0.0, f64::max);
    if filled > MUCH_FILLED {
        warnings.push(format!(
            "up to {:.0} % of the points of a map had no height and were filled with the smoothest surface, which has no \
             roughness (filled in realise/areal.arrow); lower ingest.maps.max_missing, or scan again",
            100.0 * filled
        ));
    }
    if let Some(first) = flat.first() {
        warnings.push(format!(
            "{} of {total} maps are flat, and no surfaces: the first is {first}",
            flat.len()
        ));
    }
    if let Some(first) = gaps.first() {
        warnings.push(format!(
            "{} of {total} maps are no surfaces, because of missing heights: {first} (realise.longest_gap_mm)",
            gaps.len()
        ));
    }
    if let Some(first) = unresolved.first() {
        warnings.push(format!(
            "{} of {total} maps are no surfaces, the first because {first} (realise.shortest_wavelength_mm, \
             ingest.maps.window_length_mm)",
            unresolved.len()
        ));
    }
    if windows.len() == 1 {
        warnings.push(
            "one map alone tells nothing of the scatter of the road: friction of it has no interval; cut it into windows \
             (ingest.maps.window_length_mm), or scan more"
                .into(),
        );
    }
    warnings
}

fn window(
    mut map: HeightMap,
    closure: Closure,
    shortest: f64,
    longest_gap: f64,
) -> Result<Window, StageError> {
    let filled = fill_gaps(&mut map, longest_gap)? as f64 / map.heights.len() as f64;
    let (periodic, left_out) = PeriodicMap::new(&map, closure, shortest)?;
    Ok(Window { name: map.name, filled, left_out, map: periodic })
}

fn drawn(
    method: Method,
    map: &PeriodicMap,
    seed: u64,
    realisation: u32,
) -> (PeriodicMap, Option<f64>) {
    match method {
        Method::ArealMatched => {
            let (map, mismatch) = matched_map(map, seed, u64::from(realisation));
            (map, Some(mismatch))
        }
        Method::ArealRandomPhase => (random_phase_map(map, seed, u64::from(realisation)), None),
        _ => (map.clone(), None),
    }
}

pub(super) fn row(
    surface: &ArealSurface,
    window: &str,
    [filled, left_out]: [f64; 2],
    mismatch: Option<f64>,
) -> ArealRow {
    let roughness = surface.map.roughness();
    ArealRow {
        kind: surface.kind,
        realisation: surface.realisation,
        window: window.to_owned(),
        period_x_mm: surface.map.periods[0].m_to_mm(),
        period_y_mm: surface.map.periods[1].m_to_mm(),
        shortest_wavelength_mm: surface.map.shortest.m_to_mm(),
        filled,
        left_out_rms_height_mm: left_out.sqrt().m_to_mm(),
        rms_height_mm: roughness.rms_height.m_to_mm(),
        rms_gradient: roughness.rms_gradient,
        skewness: roughness.skewness,
        kurtosis: roughness.kurtosis,
        mismatch,
    }
}

/// An areal surface as a dataset.
pub(super) fn dataset(surface: ArealSurface) -> ArrayDataset {
    let ArealSurface { kind, realisation, map } = surface;
    let attributes = BTreeMap::from([
        ("points_x".to_owned(), Attribute::Integer(map.points[0] as i64)),
        ("points_y".to_owned(), Attribute::Integer(map.points[1] as i64)),
        ("period_x_m".to_owned(), Attribute::Float(map.periods[0])),
        ("period_y_m".to_owned(), Attribute::Float(map.periods[1])),
        ("shortest_wavelength_m".to_owned(), Attribute::Float(map.shortest)),
        ("method".to_owned(), Attribute::Text(kind.method.name().to_owned())),
        ("realisation".to_owned(), Attribute::Integer(i64::from(realisation))),
    ]);
    let name = format!("{}/realisation_{realisation}", kind.file_name());
    ArrayDataset { name, unit: "m".into(), attributes, values: map.heights }
}

/// Reads the areal surfaces of a run, by kind and realisation.
///
/// # Errors
/// Those of the store; [`StageError::ArealSurface`] for one that is not as it was written.
pub fn read_areal_surfaces(run: &RunView) -> Result<Vec<ArealSurface>, StageError> {
    let mut surfaces: Vec<ArealSurface> =
        run.read_arrays(AREAL)?.into_iter().map(surface_of).collect::<Result<_, _>>()?;
    surfaces.sort_by_key(|surface| (surface.kind, surface.realisation));
    Ok(surfaces)
}

fn surface_of(dataset: ArrayDataset) -> Result<ArealSurface, StageError> {
    let ArrayDataset { name, attributes, values, .. } = dataset;
    let damaged = || StageError::ArealSurface { name: name.clone() };
    let float = |key: &str| match attributes.get(key) {
        Some(Attribute::Float(value)) => Ok(*value),
        _ => Err(damaged()),
    };
    let integer = |key: &str| match attributes.get(key) {
        Some(Attribute::Integer(value)) => u32::try_from(*value).map_err(|_| damaged()),
        _ => Err(damaged()),
    };
    let method = match attributes.get("method") {
        Some(Attribute::Text(text)) => {
            serde_json::from_value(text.as_str().into()).map_err(|_| damaged())?
        }
        _ => return Err(damaged()),
    };
    let points = [integer("points_x")? as usize, integer("points_y")? as usize];
    if points[0] * points[1] != values.len() {
        return Err(damaged());
    }
    Ok(ArealSurface {
        kind: SurfaceKind::of(method),
        realisation: integer("realisation")?,
        map: PeriodicMap {
            heights: values,
            points,
            periods: [float("period_x_m")?, float("period_y_m")?],
            shortest: float("shortest_wavelength_m")?,
        },
    })
}

impl ArealSurface {
    /// What is solved on it, for messages: `areal, measured maps, realisation 3, 10 mm/s`.
    pub(crate) fn name_at(&self, stage: &str, speed_mm_s: f64) -> String {
        let Self { kind, realisation, .. } = self;
        format!("{stage}, {kind}, realisation {realisation}, {speed_mm_s} mm/s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_reads_back_as_it_was_written() {
        let map = PeriodicMap {
            heights: (0..24).map(f64::from).collect(),
            points: [6, 4],
            periods: [0.1, 0.3],
            shortest: 0.05,
        };
        let kind = SurfaceKind::of(Method::ArealMatched);
        let surface = ArealSurface { kind, realisation: 3, map };
        let written = dataset(surface.clone());
        assert_eq!(written.name, "areal_matched/realisation_3");
        assert_eq!(surface_of(written.clone()).unwrap(), surface);
        let short = ArrayDataset { values: vec![0.0; 23], ..written };
        let message = surface_of(short).unwrap_err().to_string();
        assert!(message.contains("areal_matched/realisation_3"), "{message}");
    }
}
