//! Maps that are kept beside their lines.

use super::{Ingest, ScanFile};
use crate::artifact::{
    ArrayDataset, ArrayFile, ArraysSchema, Attribute, AttributeSchema, DatasetSchema, ResultFile,
    Row, RunView, Table,
};
use crate::scans::file::{Grid, ScanFile as Heights};
use crate::stages::StageError;
use crate::surface::HeightMap;
use crate::surface::map::condition::{
    MapConditioningError, MapReport, MapWindowReport, condition_map,
};
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The windows of the maps: `maps.h5`, where maps are kept.
pub const MAPS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "ingest", name: "maps.h5" },
    schema: "asperity.ingest.maps",
    version: 1,
    description: "windows of height maps on equal spacing, without form",
};
/// What became of every window of a map: `maps.arrow`, where maps are kept.
pub const MAP_WINDOWS: Table<MapRow> = Table::new("ingest", "maps.arrow");

/// What became of one window of a map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapRow {
    /// Name of the window.
    pub window: String,
    /// Name of the map, that of its file.
    pub map: String,
    /// Points of the map along x.
    pub points_x: u64,
    /// Points of the map along y.
    pub points_y: u64,
    /// Points of the map without a height in the file.
    pub points_missing: u64,
    /// Points of the map removed as spikes.
    pub spikes: u64,
    /// Rows of the map that jumped as a whole.
    pub jumped_rows: u64,
    /// Columns of the map that jumped as a whole.
    pub jumped_columns: u64,
    /// Spacing along x after resampling.
    #[schemars(extend("unit" = "um"))]
    pub spacing_x_um: f64,
    /// Spacing along y after resampling.
    #[schemars(extend("unit" = "um"))]
    pub spacing_y_um: f64,
    /// Slope of the map as a whole along x; absent where its points lie on one line.
    #[schemars(extend("unit" = "1"))]
    pub tilt_x: Option<f64>,
    /// Slope of the map as a whole along y.
    #[schemars(extend("unit" = "1"))]
    pub tilt_y: Option<f64>,
    /// Position of the first point of the window along x.
    #[schemars(extend("unit" = "mm"))]
    pub origin_x_mm: f64,
    /// Position of the first point of the window along y.
    #[schemars(extend("unit" = "mm"))]
    pub origin_y_mm: f64,
    /// Share of missing points of the window.
    #[schemars(extend("unit" = "1"))]
    pub missing_share: f64,
    /// Root mean square of the form removed; absent for rejected windows.
    #[schemars(extend("unit" = "mm"))]
    pub form_rms_mm: Option<f64>,
    /// Why the window was rejected; absent for one that was kept.
    pub rejected: Option<String>,
}

impl Row for MapRow {
    const SCHEMA: &'static str = "asperity.ingest.map_windows";
    const VERSION: u32 = 1;
}

/// What [`MAPS`] holds.
pub fn maps_schema() -> ArraysSchema {
    let attribute = |name, kind, description| AttributeSchema { name, kind, description };
    ArraysSchema {
        schema: MAPS.schema,
        version: MAPS.version,
        description: MAPS.description,
        datasets: vec![DatasetSchema {
            path: "{window}",
            unit: "m",
            description: "heights of a window row by row, x fastest, growing towards the rubber, NaN where missing; the name is \
                          that of the map file, followed by a slash and a number where it was cut",
            attributes: vec![
                attribute("points_x", "i64", "points along x"),
                attribute("points_y", "i64", "points along y"),
                attribute("spacing_x_m", "f64", "distance between neighbouring points along x"),
                attribute("spacing_y_m", "f64", "distance between neighbouring points along y"),
                attribute("source", "string", "name of the map file without its extension"),
                attribute("source_digest", "string", "BLAKE3 digest of the map file"),
            ],
        }],
    }
}

/// What became of a map that is kept.
pub(super) enum KeptMap {
    /// Its windows, and what was done to it.
    Windows(Vec<HeightMap>, Box<MapReport>),
    /// It is smaller than a window, or has none that is kept: the other maps do without it. Its row says why.
    LeftOut(Box<MapRow>),
}

/// The map that a file holds, if the recipe keeps maps and the file is one.
pub(super) fn kept(
    ingest: &Ingest,
    file: &ScanFile,
    scan: &Heights,
) -> Result<Option<KeptMap>, StageError> {
    let (Some(conditioning), Grid::Map { columns, rows, spacing_x, spacing_y }) =
        (&ingest.maps, scan.grid)
    else {
        return Ok(None);
    };
    let map = HeightMap {
        name: file.name.clone(),
        points: [columns, rows],
        spacing: [spacing_x, spacing_y],
        heights: scan.heights.clone(),
    };
    match condition_map(&map, conditioning) {
        Ok((windows, report)) => Ok(Some(KeptMap::Windows(windows, Box::new(report)))),
        Err(
            reason @ (MapConditioningError::TooSmall { .. }
            | MapConditioningError::NothingLeft { .. }),
        ) => Ok(Some(KeptMap::LeftOut(Box::new(left_out_row(&map, &reason))))),
        Err(error) => Err(error.into()),
    }
}

/// The row of a map that has no window.
fn left_out_row(map: &HeightMap, reason: &MapConditioningError) -> MapRow {
    MapRow {
        window: map.name.clone(),
        map: map.name.clone(),
        points_x: map.points[0] as u64,
        points_y: map.points[1] as u64,
        points_missing: map.missing() as u64,
        spikes: 0,
        jumped_rows: 0,
        jumped_columns: 0,
        spacing_x_um: map.spacing[0].m_to_um(),
        spacing_y_um: map.spacing[1].m_to_um(),
        tilt_x: None,
        tilt_y: None,
        origin_x_mm: 0.0,
        origin_y_mm: 0.0,
        missing_share: map.missing() as f64 / map.heights.len() as f64,
        form_rms_mm: None,
        rejected: Some(reason.to_string()),
    }
}

pub(super) fn map_rows(report: &MapReport) -> Vec<MapRow> {
    let row = |window: &MapWindowReport| MapRow {
        window: window.name.clone(),
        map: report.map.clone(),
        points_x: report.points[0] as u64,
        points_y: report.points[1] as u64,
        points_missing: report.points_missing_in_file as u64,
        spikes: report.spikes as u64,
        jumped_rows: report.jumped_rows as u64,
        jumped_columns: report.jumped_columns as u64,
        spacing_x_um: report.spacing_um[0],
        spacing_y_um: report.spacing_um[1],
        tilt_x: report.tilt.map(|tilt| tilt[0]),
        tilt_y: report.tilt.map(|tilt| tilt[1]),
        origin_x_mm: window.origin_mm[0],
        origin_y_mm: window.origin_mm[1],
        missing_share: window.missing_share,
        form_rms_mm: window.form.as_ref().map(|form| form.rms_mm),
        rejected: window.rejected.clone(),
    };
    report.windows.iter().map(row).collect()
}

pub(super) fn dataset(window: HeightMap, file: &ScanFile) -> ArrayDataset {
    let attributes = BTreeMap::from([
        ("points_x".to_owned(), Attribute::Integer(window.points[0] as i64)),
        ("points_y".to_owned(), Attribute::Integer(window.points[1] as i64)),
        ("spacing_x_m".to_owned(), Attribute::Float(window.spacing[0])),
        ("spacing_y_m".to_owned(), Attribute::Float(window.spacing[1])),
        ("source".to_owned(), Attribute::Text(file.name.clone())),
        ("source_digest".to_owned(), Attribute::Text(file.digest.to_string())),
    ]);
    ArrayDataset { name: window.name, unit: "m".into(), attributes, values: window.heights }
}

/// Reads the windows of the maps of a run.
///
/// # Errors
/// Those of the store; [`StageError::MapWindow`] for one that is not as it was written.
pub fn read_maps(run: &RunView) -> Result<Vec<HeightMap>, StageError> {
    run.read_arrays(MAPS)?.into_iter().map(map_of).collect()
}

fn map_of(dataset: ArrayDataset) -> Result<HeightMap, StageError> {
    let ArrayDataset { name, attributes, values, .. } = dataset;
    let damaged = |key: &str| StageError::MapWindow { name: name.clone(), key: key.to_owned() };
    let points = |key: &str| match attributes.get(key) {
        Some(Attribute::Integer(value)) => usize::try_from(*value).map_err(|_| damaged(key)),
        _ => Err(damaged(key)),
    };
    let spacing = |key: &str| match attributes.get(key) {
        Some(Attribute::Float(value)) if *value > 0.0 => Ok(*value),
        _ => Err(damaged(key)),
    };
    let points = [points("points_x")?, points("points_y")?];
    let spacing = [spacing("spacing_x_m")?, spacing("spacing_y_m")?];
    if points[0].checked_mul(points[1]) != Some(values.len()) {
        return Err(damaged("points_x, points_y"));
    }
    Ok(HeightMap { points, spacing, name, heights: values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_reads_back_as_it_was_written_or_is_refused() {
        let map = HeightMap {
            name: "map/000".into(),
            points: [3, 2],
            spacing: [5e-5, 1e-4],
            heights: (0..6).map(f64::from).collect(),
        };
        let digest = crate::artifact::Digest::of_bytes(b"a map");
        let file = ScanFile { path: "map.sdf".into(), name: "map".into(), digest };
        let written = dataset(map.clone(), &file);
        assert_eq!(map_of(written.clone()).unwrap(), map);
        for key in ["points_x", "points_y", "spacing_x_m", "spacing_y_m"] {
            let mut without = written.clone();
            without.attributes.remove(key);
            let message = map_of(without).unwrap_err().to_string();
            assert!(message.contains("map/000") && message.contains(key), "{message}");
        }
        let short = ArrayDataset { values: vec![0.0; 5], ..written };
        assert!(map_of(short).unwrap_err().to_string().contains("points_x, points_y"));
    }
}
