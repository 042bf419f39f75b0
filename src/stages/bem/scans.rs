//! What the choice of scans does to friction of sines: their amplitudes are those of a road of which only some windows were
//! seen.
//!
//! The windows are parted into groups, `approximate` fits the sines without half of them, in up to ten ways, and the first
//! realisations are solved with these amplitudes and their own phases. What friction changes by is the delete-d jackknife of
//! the scans, without the scatter of phases. Halves change the amplitudes by as much as their error is. Single groups change
//! them by less, and miss that an amplitude which is zero in the fit is not known to be zero. Surfaces of windows need none of
//! it: the scatter of the road is that between them.

use super::work::Work;
use super::worth::Worth;
use super::{Bem, CurveRow, Given, Task};
use crate::artifact::{Row, RunView, SolveStore, Table};
use crate::numerics::statistics::delete_d_jackknife_95;
use crate::rubber::RubberModel;
use crate::stages::StageError;
use crate::stages::approximate::{REPLICATES, ReplicateRow};
use crate::stages::kept::SolveTask;
use crate::stages::realise::{Method, PROFILES, Surface, SurfaceKind};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Realisations that are solved with the amplitudes without half of the groups: what that changes is much the same in all.
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
    /// Groups of windows of which halves were left out in turn.
    pub groups: u32,
    /// Realisations that were solved without each.
    pub realisations: u32,
    /// Half width of the 95 % confidence interval of the mean friction by the choice of scans: delete-d jackknife over
    /// halves of the groups, relative to the friction of these realisations.
    #[schemars(extend("unit" = "1"))]
    pub relative_confidence_95: f64,
}

impl Row for ScanErrorRow {
    const SCHEMA: &'static str = "asperity.bem.scans";
    const VERSION: u32 = 2;
}

/// The first realisations of an approximation, with the amplitudes that the scans have without half of the windows.
#[derive(Debug, Clone, PartialEq)]
struct Replicate {
    /// Groups that the windows are divided into.
    groups: usize,
    surfaces: Vec<Surface>,
}

/// What is known of the choice of scans before anything is solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scans {
    /// For all approximations; empty if the recipe has no scans or sets `bem.estimate_scan_error` to false.
    replicates: Vec<Replicate>,
    /// Windows that the surfaces of a kind are drawn of, where an accuracy of the averages is asked for.
    windows: BTreeMap<SurfaceKind, usize>,
}

impl Scans {
    /// Reads it from a run.
    ///
    /// # Errors
    /// Those of the files.
    pub fn read(parameters: &Bem, surfaces: &[Surface], run: &RunView) -> Result<Self, StageError> {
        let sines = surfaces.iter().any(|surface| surface.kind.method == Method::Sines);
        let replicates = if sines && parameters.estimate_scan_error && run.has(REPLICATES)? {
            replicates(surfaces, &run.rows(REPLICATES)?)
        } else {
            Vec::new()
        };
        let mut names: BTreeMap<SurfaceKind, BTreeSet<String>> = BTreeMap::new();
        if parameters.average_tolerance.is_some()
            && surfaces.iter().any(|surface| surface.kind.method.of_a_window())
        {
            for row in run.rows(PROFILES)? {
                names.entry(row.kind).or_default().insert(row.window);
            }
        }
        let windows = names.into_iter().map(|(kind, own)| (kind, own.len())).collect();
        Ok(Self { replicates, windows })
    }

    /// What more realisations of a kind cannot mend at one speed.
    pub(super) fn worth(
        &self,
        kind: SurfaceKind,
        speed_mm_s: f64,
        errors: &[ScanErrorRow],
    ) -> Worth {
        if let Some(&windows) = self.windows.get(&kind) {
            return Worth::Windows(windows);
        }
        let own = errors.iter().filter(|row| row.kind == kind && row.speed_mm_s == speed_mm_s);
        Worth::Errors(own.map(|row| row.relative_confidence_95).collect())
    }
}

fn replicates(surfaces: &[Surface], rows: &[ReplicateRow]) -> Vec<Replicate> {
    let of_sines = surfaces.chunk_by(|a, b| a.kind == b.kind);
    let of_sines = of_sines.filter(|own| own[0].kind.method == Method::Sines);
    let replicate = |own: &[Surface], half: &[ReplicateRow]| {
        let surface = |surface: &Surface| {
            let mut surface = surface.clone();
            for (wave, row) in surface.profile.iter_mut().zip(half) {
                wave.amplitude = row.amplitude_mm.mm_to_m();
            }
            surface
        };
        Replicate {
            groups: half[0].groups as usize,
            surfaces: own.iter().take(REALISATIONS).map(surface).collect(),
        }
    };
    let of_kind = |own: &[Surface]| -> Vec<Replicate> {
        let halves = rows.chunk_by(|a, b| (a.waves, a.replicate) == (b.waves, b.replicate));
        halves
            .filter(|half| half[0].waves == own[0].kind.waves)
            .map(|half| replicate(own, half))
            .collect()
    };
    of_sines.flat_map(of_kind).collect()
}

/// The curves of all replicates.
fn tasks(parameters: &Bem, scans: &Scans) -> Vec<Task> {
    let surfaces = scans.replicates.iter().flat_map(|replicate| &replicate.surfaces);
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
    scans: &Scans,
    work: &Work,
) -> Result<Vec<ScanErrorRow>, StageError> {
    let mut rows = Vec::new();
    for of_kind in scans.replicates.chunk_by(|a, b| a.surfaces[0].kind == b.surfaces[0].kind) {
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
    let (groups, each) = (replicates[0].groups, replicates[0].surfaces.len());
    let row = |(k, first): (usize, &CurveRow)| {
        let friction = |group: &[Vec<CurveRow>]| {
            group.iter().map(|curve| curve[k].friction_coefficient).sum::<f64>() / each as f64
        };
        let estimates: Vec<f64> = curves.chunks(each).map(friction).collect();
        let mean = estimates.iter().sum::<f64>() / estimates.len() as f64;
        ScanErrorRow {
            kind: first.kind,
            speed_mm_s: first.speed_mm_s,
            given: first.given,
            contact_area_fraction: first.contact_area_fraction,
            pressure_mpa: first.pressure_mpa,
            groups: groups as u32,
            realisations: each as u32,
            relative_confidence_95: delete_d_jackknife_95(&estimates, groups, groups / 2)
                / mean.abs(),
        }
    };
    curves[0].iter().enumerate().map(row).collect()
}

/// Those that a packed store does not have.
pub(super) fn missing(
    parameters: &Bem,
    rubber: &RubberModel,
    scans: &Scans,
    store: &SolveStore,
) -> Result<Vec<Task>, StageError> {
    let mut missing = Vec::new();
    for task in tasks(parameters, scans) {
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
        let replicate = Replicate { groups: 3, surfaces: vec![surface(1), surface(2)] };
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
                relative_area_error: None,
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
