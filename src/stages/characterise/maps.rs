//! Maps over the plane: parameters of ISO 25178-2, correlation over direction, spectrum, anisotropy.

use super::rows::finite;
use super::warnings::left_out;
use super::{
    AVERAGE, ArealCorrelationRow, ArealDirectionRow, ArealParametersRow, ArealSpectrumRow,
    AverageRow, Characterise,
};
use crate::numerics::statistics::MeanEstimate;
use crate::stages::StageError;
use crate::surface::map::correlation::{Anisotropy, DirectionalCorrelation};
use crate::surface::map::gaps::fill_gaps;
use crate::surface::map::spectrum::{RadialBin, Sector};
use crate::surface::map::{ArealCorrelation, ArealError, ArealParameters, ArealSpectrum};
use crate::surface::probe::Probe;
use crate::surface::{HeightMap, LineScan};
use crate::units::Units;
use rayon::prelude::*;

/// Directions in degrees of the correlation.
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 90.0, 120.0, 150.0];
/// Sectors count waves from so many steps of the spectrum on: longer ones have few directions.
const FIRST_WAVE: f64 = 10.0;

/// The tables of the maps of a run.
#[derive(Debug, Default)]
pub(super) struct MapTables {
    pub parameters: Vec<ArealParametersRow>,
    pub averages: Vec<AverageRow>,
    pub correlation: Vec<ArealCorrelationRow>,
    pub spectrum: Vec<ArealSpectrumRow>,
    pub directions: Vec<ArealDirectionRow>,
    pub warnings: Vec<String>,
}

/// What is read from one map.
struct Read {
    parameters: ArealParameters,
    anisotropy: Option<Anisotropy>,
    correlation: Vec<DirectionalCorrelation>,
    radial: Vec<RadialBin>,
    sectors: Vec<Sector>,
}

/// Shortest wavelength in m that all lines of all maps, along both directions, show as it is.
pub(super) fn shortest_reliable_wavelength(probe: Probe, maps: &[HeightMap]) -> f64 {
    let line = |spacing: f64, heights: Vec<f64>| LineScan {
        name: String::new(),
        origin: 0.0,
        spacing,
        heights,
    };
    let of_map = |map: &HeightMap| {
        let (columns, [dx, dy]) = (map.points[0], map.spacing);
        let rows = map.heights.chunks_exact(columns).map(|row| line(dx, row.to_vec()));
        let column = |k: usize| map.heights[k..].iter().step_by(columns).copied().collect();
        let lines: Vec<LineScan> = rows.chain((0..columns).map(|k| line(dy, column(k)))).collect();
        probe.shortest_reliable_wavelength(&lines)
    };
    maps.iter().map(of_map).fold(0.0, f64::max)
}

/// Characterises all maps; one that cannot be has a warning and no row.
///
/// # Errors
/// [`StageError::Gap`] for a map whose gaps cannot be filled for its spectrum.
pub(super) fn tables(
    parameters: &Characterise,
    maps: Vec<HeightMap>,
) -> Result<MapTables, StageError> {
    let total = maps.len();
    let read: Vec<(String, Result<Read, StageError>)> =
        maps.into_par_iter().map(|map| (map.name.clone(), read(parameters, map))).collect();
    let (mut tables, mut failed) = (MapTables::default(), Vec::new());
    let mut radial = Vec::new();
    for (name, read) in read {
        match read {
            Ok(read) => {
                tables.add(&name, &read);
                radial.push(read.radial);
            }
            Err(StageError::Areal(error)) => failed.push((name, error.to_string())),
            Err(error) => return Err(error),
        }
    }
    tables.averages = average_rows(&tables.parameters);
    tables.spectrum.extend(average_of_rings(&radial));
    tables.warnings.extend(left_out("maps", total, "areal parameters", &failed));
    Ok(tables)
}

fn read(parameters: &Characterise, mut map: HeightMap) -> Result<Read, StageError> {
    let of_map = |error: ArealError| StageError::Areal(error);
    let of_parameters = ArealParameters::of(&map).map_err(of_map)?;
    let longest = parameters.longest_lag_mm.map(Units::mm_to_m);
    let correlation = ArealCorrelation::of(&map, longest).map_err(of_map)?;
    let directions = correlation.directions(&ANGLES, parameters.lags_per_decade);
    let anisotropy = correlation.anisotropy();
    drop(correlation);
    // Filled with the smoothest heights there are: a few per cent of gaps take little of the shortest waves.
    let largest = map.lengths().into_iter().fold(0.0, f64::max);
    fill_gaps(&mut map, 2.0 * largest)?;
    let spectrum = ArealSpectrum::of(&map, parameters.spectrum_window).map_err(of_map)?;
    let first = FIRST_WAVE * spectrum.step.into_iter().fold(0.0, f64::max);
    Ok(Read {
        parameters: of_parameters,
        anisotropy,
        correlation: directions,
        radial: spectrum.radial(parameters.spectrum_bins_per_decade),
        sectors: spectrum.sectors([first, spectrum.largest_wavenumber()]),
    })
}

impl MapTables {
    fn add(&mut self, map: &str, read: &Read) {
        self.parameters.push(parameters_row(map, &read.parameters, read.anisotropy));
        let of_direction = |direction: &DirectionalCorrelation| {
            let angle_deg = direction.angle;
            let row = move |sample: &crate::surface::CorrelationSample| ArealCorrelationRow {
                map: map.to_owned(),
                angle_deg,
                lag_mm: sample.lag.m_to_mm(),
                correlation_mm2: sample.value.m2_to_mm2(),
                pairs: sample.pairs,
            };
            direction.samples.iter().map(row).collect::<Vec<_>>()
        };
        self.correlation.extend(read.correlation.iter().flat_map(of_direction));
        self.spectrum.extend(read.radial.iter().map(|bin| spectrum_row(map, bin)));
        self.directions.extend(read.sectors.iter().map(|sector| ArealDirectionRow {
            map: map.to_owned(),
            angle_deg: sector.angle,
            share: sector.share,
            waves: sector.modes as u64,
        }));
    }
}

fn spectrum_row(map: &str, bin: &RadialBin) -> ArealSpectrumRow {
    ArealSpectrumRow {
        map: map.to_owned(),
        wavenumber_rad_mm: bin.wavenumber.per_m_to_per_mm(),
        density_mm4: bin.density.m4_to_mm4(),
        standard_error_mm4: bin.standard_error.m4_to_mm4(),
        waves: bin.modes as u64,
    }
}

/// Means over the windows, ring by ring; windows are independent. A window that lacks the ring does not count in it.
fn average_of_rings(windows: &[Vec<RadialBin>]) -> Vec<ArealSpectrumRow> {
    let mut rings: Vec<RadialBin> = windows.iter().flatten().copied().collect();
    rings.sort_by(|a, b| a.wavenumber.total_cmp(&b.wavenumber));
    // Windows of one size have equal rings; means of their wavenumbers differ by round-off alone.
    let same = |a: &RadialBin, b: &RadialBin| (b.wavenumber / a.wavenumber - 1.0).abs() < 1e-9;
    let average = |ring: &[RadialBin]| {
        let count = ring.len() as f64;
        let density = ring.iter().map(|bin| bin.density).sum::<f64>() / count;
        let square = ring.iter().map(|bin| bin.standard_error.powi(2)).sum::<f64>();
        let bin = RadialBin {
            wavenumber: ring[0].wavenumber,
            density,
            standard_error: square.sqrt() / count,
            modes: ring.iter().map(|bin| bin.modes).sum(),
        };
        spectrum_row(AVERAGE, &bin)
    };
    rings.chunk_by(same).map(average).collect()
}

fn parameters_row(
    map: &str,
    areal: &ArealParameters,
    anisotropy: Option<Anisotropy>,
) -> ArealParametersRow {
    let functional = areal.functional;
    ArealParametersRow {
        map: map.to_owned(),
        sa_mm: areal.sa.m_to_mm(),
        sq_mm: areal.sq.m_to_mm(),
        ssk: areal.ssk,
        sku: areal.sku,
        sp_mm: areal.sp.m_to_mm(),
        sv_mm: areal.sv.m_to_mm(),
        sz_mm: areal.sz.m_to_mm(),
        sdq: areal.sdq,
        sdr: areal.sdr,
        sal_mm: areal.sal.map(Units::m_to_mm),
        str: areal.str,
        str_is_upper_bound: areal.str_is_upper_bound,
        std_deg: areal.std,
        sk_mm: functional.sk.m_to_mm(),
        spk_mm: functional.spk.m_to_mm(),
        svk_mm: functional.svk.m_to_mm(),
        smr1: functional.smr1,
        smr2: functional.smr2,
        vmp_mm: functional.vmp.m_to_mm(),
        vmc_mm: functional.vmc.m_to_mm(),
        vvc_mm: functional.vvc.m_to_mm(),
        vvv_mm: functional.vvv.m_to_mm(),
        run_deg: anisotropy.map(|found| found.run),
        aspect: anisotropy.map(|found| found.aspect),
        gradient_run_deg: anisotropy.map(|found| found.gradient_run),
        gradient_ratio: anisotropy.map(|found| found.gradient_ratio),
    }
}

/// Name with unit of a parameter and its column. Directions have no mean.
type Column = (&'static str, fn(&ArealParametersRow) -> Option<f64>);

const COLUMNS: [Column; 22] = [
    ("Sa [mm]", |row| Some(row.sa_mm)),
    ("Sq [mm]", |row| Some(row.sq_mm)),
    ("Ssk", |row| Some(row.ssk)),
    ("Sku", |row| Some(row.sku)),
    ("Sp [mm]", |row| Some(row.sp_mm)),
    ("Sv [mm]", |row| Some(row.sv_mm)),
    ("Sz [mm]", |row| Some(row.sz_mm)),
    ("Sdq", |row| Some(row.sdq)),
    ("Sdr", |row| Some(row.sdr)),
    ("Sal [mm]", |row| row.sal_mm),
    ("Str", |row| row.str),
    ("Sk [mm]", |row| Some(row.sk_mm)),
    ("Spk [mm]", |row| Some(row.spk_mm)),
    ("Svk [mm]", |row| Some(row.svk_mm)),
    ("Smr1", |row| Some(row.smr1)),
    ("Smr2", |row| Some(row.smr2)),
    ("Vmp [mm]", |row| Some(row.vmp_mm)),
    ("Vmc [mm]", |row| Some(row.vmc_mm)),
    ("Vvc [mm]", |row| Some(row.vvc_mm)),
    ("Vvv [mm]", |row| Some(row.vvv_mm)),
    ("aspect", |row| row.aspect),
    ("gradient ratio", |row| row.gradient_ratio),
];

fn average_rows(rows: &[ArealParametersRow]) -> Vec<AverageRow> {
    let average = |(parameter, column): &Column| {
        let values: Vec<f64> = rows.iter().filter_map(column).collect();
        if values.is_empty() {
            return None;
        }
        let estimate = MeanEstimate::of(&values);
        Some(AverageRow {
            parameter: (*parameter).to_owned(),
            mean: estimate.mean,
            standard_deviation: finite(estimate.standard_deviation),
            confidence_95: finite(estimate.confidence_95),
            windows: estimate.count as u64,
        })
    };
    COLUMNS.iter().filter_map(average).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Waves of 0.4 mm that run along x, on 64 by 48 points.
    fn ridges(name: &str, amplitude: f64) -> HeightMap {
        let height = |k: usize| amplitude * (TAU * (k % 64) as f64 / 8.0).sin();
        HeightMap {
            name: name.into(),
            points: [64, 48],
            spacing: [5e-5; 2],
            heights: (0..64 * 48).map(height).collect(),
        }
    }

    #[test]
    fn ridges_have_one_direction_in_every_table() {
        let maps = vec![ridges("a", 1e-5), ridges("b", 3e-5), ridges("flat", 0.0)];
        let tables = tables(&Characterise::default(), maps).unwrap();
        assert_eq!(tables.parameters.len(), 2);
        assert!(tables.warnings[0].contains("1 of 3 maps"), "{:?}", tables.warnings);
        let sq: Vec<f64> = tables.parameters.iter().map(|row| row.sq_mm).collect();
        approx::assert_relative_eq!(sq[0], 0.01 / 2.0_f64.sqrt(), max_relative = 1e-12);
        let mean = tables.averages.iter().find(|row| row.parameter == "Sq [mm]").unwrap();
        approx::assert_relative_eq!(mean.mean, 0.02 / 2.0_f64.sqrt(), max_relative = 1e-12);
        assert_eq!(mean.windows, 2);
        let strongest = tables.directions.iter().filter(|row| row.map == "a");
        let strongest = strongest.max_by(|a, b| a.share.total_cmp(&b.share)).unwrap();
        assert_eq!(strongest.angle_deg, 0.0);
        // Along the ridges nothing changes.
        let along = tables.correlation.iter().filter(|row| row.angle_deg == 90.0);
        assert!(along.map(|row| row.correlation_mm2).fold(0.0, f64::max) < 1e-20);
        let average = tables.spectrum.iter().filter(|row| row.map == AVERAGE).count();
        assert_eq!(2 * average, tables.spectrum.len() - average);
    }
}
