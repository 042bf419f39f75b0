//! What the choice of scans does to friction of sines: their amplitudes are those of a road of which only some windows were
//! seen.
//!
//! The windows are parted into groups, `approximate` fits the sines without each of them, and the first realisations are
//! solved with these amplitudes and their own phases. What friction changes by is the jackknife of the scans, without the
//! scatter of phases. Surfaces of windows need none of it: the scatter of the road is that between them.

use super::work::Work;
use super::{Bem, CurveRow, Given, Task};
use crate::artifact::{Row, RunView, SolveStore, Table};
use crate::numerics::statistics::jackknife_95;
use crate::rubber::Rubber;
use crate::stages::StageError;
use crate::stages::approximate::{REPLICATES, ReplicateRow};
use crate::stages::kept::SolveTask;
use crate::stages::realise::{Method, Surface, SurfaceKind};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Realisations that are solved with the amplitudes without a group: what a group changes is much the same in all.
const REALISATIONS: usize = 2;

/// Statistical error of friction by the choice of scans: `scans.arrow`.
pub const SCAN_ERRORS: Table<ScanErrorRow> = Table::new("bem", "scans.arrow");

/// What the choice of scans does to the friction of sines at one contact area or pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScanErrorRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction; of the first realisation where the pressure is given.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure; of the first realisation where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Groups of windows that were left out in turn.
    pub groups: u32,
    /// Realisations that were solved without each.
    pub realisations: u32,
    /// Half width of the 95 % confidence interval of the mean friction by the choice of scans: jackknife over the groups,
    /// relative to the friction of these realisations.
    #[schemars(extend("unit" = "1"))]
    pub relative_confidence_95: f64,
}

impl Row for ScanErrorRow {
    const SCHEMA: &'static str = "asperity.bem.scans";
    const VERSION: u32 = 1;
}

/// The first realisations of an approximation, with the amplitudes that the scans have without a group of windows.
#[derive(Debug, Clone, PartialEq)]
pub struct Replicate {
    /// The surfaces.
    pub surfaces: Vec<Surface>,
}

/// The replicates of all approximations. Empty if the recipe has no scans or sets `bem.estimate_scan_error` to false.
///
/// # Errors
/// Those of the store.
pub fn replicates(
    parameters: &Bem,
    surfaces: &[Surface],
    run: &RunView,
) -> Result<Vec<Replicate>, StageError> {
    if !parameters.estimate_scan_error || !run.has(REPLICATES)? {
        return Ok(Vec::new());
    }
    let rows = run.rows(REPLICATES)?;
    let of_sines = surfaces.chunk_by(|a, b| a.kind == b.kind);
    let of_sines = of_sines.filter(|own| own[0].kind.method == Method::Sines);
    let replicate = |own: &[Surface], group: &[ReplicateRow]| {
        let surface = |surface: &Surface| {
            let mut surface = surface.clone();
            for (wave, row) in surface.profile.iter_mut().zip(group) {
                wave.amplitude = row.amplitude_mm.mm_to_m();
            }
            surface
        };
        Replicate { surfaces: own.iter().take(REALISATIONS).map(surface).collect() }
    };
    let of_kind = |own: &[Surface]| -> Vec<Replicate> {
        let kind = own[0].kind;
        let groups = rows.chunk_by(|a, b| (a.waves, a.group) == (b.waves, b.group));
        groups
            .filter(|group| group[0].waves == kind.waves)
            .map(|group| replicate(own, group))
            .filter(|replicate| {
                replicate.surfaces[0].profile.iter().any(|wave| wave.amplitude != 0.0)
            })
            .collect()
    };
    Ok(of_sines.flat_map(of_kind).collect())
}

/// The curves of all replicates.
pub(super) fn tasks(parameters: &Bem, replicates: &[Replicate]) -> Vec<Task> {
    let surfaces = replicates.iter().flat_map(|replicate| &replicate.surfaces);
    surfaces
        .flat_map(|surface| {
            let task = move |speed: &f64| Task { surface: surface.clone(), speed_mm_s: *speed };
            parameters.speeds_mm_s.iter().map(task)
        })
        .collect()
}

/// Solves the replicates that are not in the store.
pub(super) fn errors(
    parameters: &Bem,
    replicates: &[Replicate],
    work: &Work,
) -> Result<Vec<ScanErrorRow>, StageError> {
    let mut rows = Vec::new();
    for of_kind in replicates.chunk_by(|a, b| a.surfaces[0].kind == b.surfaces[0].kind) {
        for &speed_mm_s in &parameters.speeds_mm_s {
            let tasks: Vec<&Surface> =
                of_kind.iter().flat_map(|replicate| &replicate.surfaces).collect();
            let curves: Vec<Vec<CurveRow>> = tasks
                .par_iter()
                .map(|surface| Ok(work.one_curve(surface, speed_mm_s)?.values))
                .collect::<Result<_, StageError>>()?;
            rows.extend(of_one_speed(of_kind, &curves));
        }
    }
    Ok(rows)
}

/// The rows of one kind at one speed, from the curves of its replicates one after the other.
fn of_one_speed(replicates: &[Replicate], curves: &[Vec<CurveRow>]) -> Vec<ScanErrorRow> {
    let (groups, each) = (replicates.len(), replicates[0].surfaces.len());
    if groups < 2 {
        return Vec::new();
    }
    let row = |(k, first): (usize, &CurveRow)| {
        let friction = |group: &[Vec<CurveRow>]| {
            group.iter().map(|curve| curve[k].friction_coefficient).sum::<f64>() / each as f64
        };
        let estimates: Vec<f64> = curves.chunks(each).map(friction).collect();
        let mean = estimates.iter().sum::<f64>() / groups as f64;
        ScanErrorRow {
            kind: first.kind,
            speed_mm_s: first.speed_mm_s,
            given: first.given,
            contact_area_fraction: first.contact_area_fraction,
            pressure_mpa: first.pressure_mpa,
            groups: groups as u32,
            realisations: each as u32,
            relative_confidence_95: jackknife_95(&estimates) / mean.abs(),
        }
    };
    curves[0].iter().enumerate().map(row).collect()
}

/// Those that a packed store does not have.
pub(super) fn missing(
    parameters: &Bem,
    rubber: &Rubber,
    replicates: &[Replicate],
    store: &SolveStore,
) -> Result<Vec<Task>, StageError> {
    let mut missing = Vec::new();
    for task in tasks(parameters, replicates) {
        if !task.is_finished(parameters, rubber, store)? {
            missing.push(task);
        }
    }
    Ok(missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_the_jackknife_of_the_groups() {
        let surface =
            |realisation| Surface { kind: SurfaceKind::sines(8), realisation, profile: Vec::new() };
        let replicate = Replicate { surfaces: vec![surface(1), surface(2)] };
        let curve = |friction_coefficient| {
            vec![CurveRow {
                kind: SurfaceKind::sines(8),
                realisation: 1,
                speed_mm_s: 10.0,
                given: Given::Area,
                contact_area_fraction: 0.05,
                pressure_mpa: 1.0,
                friction_coefficient,
                interpolation_error: 0.0,
                discretisation_error: None,
                left_out_error: 0.0,
            }]
        };
        // Means of 0.9, 1.0 and 1.1, whatever the two realisations differ by.
        let curves = [0.4, 1.4, 0.5, 1.5, 0.6, 1.6].map(curve);
        let rows = of_one_speed(&vec![replicate; 3], &curves);
        assert_eq!((rows.len(), rows[0].groups, rows[0].realisations), (1, 3, 2));
        // t(2) sqrt(2/3 0.02).
        let expected = 4.302_65 * (2.0 / 3.0 * 0.02_f64).sqrt();
        approx::assert_relative_eq!(rows[0].relative_confidence_95, expected, max_relative = 1e-5);
    }
}
