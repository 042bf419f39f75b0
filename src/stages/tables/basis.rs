//! What the averages rest on: windows of the scans, the shortest wavelength, and the statistical errors by both.

use super::{FrictionRow, Model};
use crate::artifact::RunView;
use crate::numerics::statistics::{MeanEstimate, combined_95};
use crate::stages::StageError;
use crate::stages::approximate::GROUPS;
use crate::stages::bem::{SCAN_ERRORS, ScanErrorRow};
use crate::stages::friction::Condition;
use crate::stages::ingest::WINDOWS;
use crate::stages::realise::{ArealRow, PROFILES, Surface, SurfaceKind};
use crate::units::Units;
use std::collections::BTreeMap;

/// What is known of the surfaces behind the averages.
pub(super) struct Basis {
    /// Number of windows of the scans; `None` if the recipe gives the waves itself.
    windows: Option<u32>,
    /// The window of every surface of one.
    window_of: BTreeMap<(SurfaceKind, u32), String>,
    /// Shortest wavelength in mm of every kind.
    shortest_mm: BTreeMap<SurfaceKind, f64>,
    /// Errors of sines by the choice of scans.
    scan_errors: Vec<ScanErrorRow>,
}

impl Basis {
    /// Reads it from a run; `has_scans` where the recipe has.
    pub fn read(
        run: &RunView,
        surfaces: &[Surface],
        areal: &[ArealRow],
        has_scans: bool,
    ) -> Result<Self, StageError> {
        let windows = if has_scans {
            let kept = run.rows(WINDOWS)?.iter().filter(|row| row.rejected.is_none()).count();
            Some(kept as u32)
        } else {
            None
        };
        let of_windows = surfaces.iter().any(|surface| surface.kind.method.of_a_window());
        let profiles = if of_windows { run.rows(PROFILES)? } else { Vec::new() };
        let mut shortest_mm = BTreeMap::new();
        for surface in surfaces {
            let present = surface.profile.iter().filter(|wave| wave.amplitude != 0.0);
            let shortest = present.map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
            let known = shortest_mm.entry(surface.kind).or_insert(f64::INFINITY);
            *known = known.min(shortest.m_to_mm());
        }
        for row in areal {
            shortest_mm.insert(row.kind, row.shortest_wavelength_mm);
        }
        let of_profiles = profiles.into_iter().map(|row| ((row.kind, row.realisation), row.window));
        let of_maps = areal.iter().map(|row| ((row.kind, row.realisation), row.window.clone()));
        Ok(Self {
            windows,
            window_of: of_profiles.chain(of_maps).collect(),
            shortest_mm,
            scan_errors: run.rows(SCAN_ERRORS)?,
        })
    }

    /// Completes averages with what they rest on, and sums up their errors.
    pub fn complete(&self, rows: &mut [FrictionRow]) {
        for row in rows {
            row.shortest_wavelength_mm = self.shortest_mm.get(&row.kind).copied().unwrap_or(0.0);
            row.windows = self.windows_of(row.kind);
            if row.kind.method.of_a_window() && !row.kind.method.is_measured() {
                self.average_by_window(row);
            }
            row.scan_error = self.scan_error(row);
            row.error_estimate = sum_of_errors(row);
        }
    }

    fn windows_of(&self, kind: SurfaceKind) -> u32 {
        if !kind.method.of_a_window() {
            return self.windows.unwrap_or(0);
        }
        let own = self.window_of.iter().filter(|((of, _), _)| *of == kind);
        own.map(|(_, window)| window).collect::<std::collections::BTreeSet<_>>().len() as u32
    }

    /// Several draws of one window share its spectrum: the scatter that counts is that between the windows.
    fn average_by_window(&self, row: &mut FrictionRow) {
        let mut by_window: BTreeMap<&String, Vec<f64>> = BTreeMap::new();
        for (realisation, friction) in (1..).zip(&row.realisations) {
            if let Some(window) = self.window_of.get(&(row.kind, realisation)) {
                by_window.entry(window).or_default().push(*friction);
            }
        }
        let means: Vec<f64> = by_window.values().map(|own| MeanEstimate::of(own).mean).collect();
        let confidence = MeanEstimate::of(&means).confidence_95;
        row.confidence_95 = confidence.is_finite().then_some(confidence);
    }

    fn scan_error(&self, row: &FrictionRow) -> Option<f64> {
        if row.kind.method.of_a_window() || self.windows.is_none() {
            return Some(0.0);
        }
        let same = |error: &&ScanErrorRow| {
            let condition =
                Condition::of(error.given, error.contact_area_fraction, error.pressure_mpa);
            error.kind == row.kind
                && error.speed_mm_s == row.speed_mm_s
                && condition == row.condition()
        };
        let error = self.scan_errors.iter().find(same)?;
        Some(error.relative_confidence_95 * row.mean.abs())
    }
}

/// The statistical errors, which are independent of each other, as one interval, and the others as they are.
pub(super) fn sum_of_errors(row: &FrictionRow) -> Option<f64> {
    let microscale = match row.model {
        Model::Hybrid => row.microscale_error?,
        _ => 0.0,
    };
    let freedom = |values: u32| f64::from(values.max(2) - 1);
    let scatter = match row.model {
        // The average of two sorts of realisations states no degrees of freedom: many make the standard error the largest.
        Model::Multilevel => f64::from(u32::MAX),
        _ if !row.kind.method.of_a_window() => freedom(row.realisations.len() as u32),
        _ => freedom(row.windows),
    };
    let groups = row.windows.min(GROUPS as u32);
    let statistical =
        combined_95(&[(row.confidence_95?, scatter), (row.scan_error?, freedom(groups))])
            .hypot(microscale);
    let discretisation = row.discretisation_error?;
    let model = row.model_error.unwrap_or(0.0);
    Some(statistical + row.interpolation_error + discretisation + row.left_out_error + model)
}

#[cfg(test)]
mod tests {
    use super::super::average::average;
    use super::super::average::tests::curve;
    use super::*;
    use crate::stages::realise::Method;

    fn basis(windows: Option<u32>, window_of: BTreeMap<(SurfaceKind, u32), String>) -> Basis {
        let error = ScanErrorRow {
            kind: SurfaceKind::sines(8),
            speed_mm_s: 10.0,
            given: crate::stages::bem::Given::Area,
            contact_area_fraction: 0.05,
            pressure_mpa: 7.0,
            groups: 6,
            realisations: 2,
            relative_confidence_95: 0.3,
        };
        let shortest_mm = [(SurfaceKind::sines(8), 0.06)].into();
        Basis { windows, window_of, shortest_mm, scan_errors: vec![error] }
    }

    #[test]
    fn sines_have_the_error_of_the_scans_beside_that_of_their_phases() {
        let values = || vec![curve(8, 1, 0.05, 0.9), curve(8, 2, 0.05, 1.1)];
        let mut rows = average(Model::Bem, values());
        basis(Some(27), BTreeMap::new()).complete(&mut rows);
        assert_eq!((rows[0].windows, rows[0].shortest_wavelength_mm), (27, 0.06));
        approx::assert_relative_eq!(rows[0].scan_error.unwrap(), 0.3, max_relative = 1e-12);
        // 12.706 x 0.1 of the phases; a thousandth and a two thousandth of interpolation and grid.
        let expected = combined_95(&[(1.270_62, 1.0), (0.3, 5.0)]) + 1.5e-3;
        approx::assert_relative_eq!(rows[0].error_estimate.unwrap(), expected, max_relative = 1e-5);
        // Waves that the recipe states are of no scans; a single window tells nothing.
        let mut given = average(Model::Bem, values());
        basis(None, BTreeMap::new()).complete(&mut given);
        assert_eq!(given[0].scan_error, Some(0.0));
        let mut other = average(Model::Bem, vec![curve(9, 1, 0.05, 1.0), curve(9, 2, 0.05, 1.1)]);
        basis(Some(1), BTreeMap::new()).complete(&mut other);
        assert_eq!((other[0].scan_error, other[0].error_estimate), (None, None));
    }

    #[test]
    fn draws_of_one_window_are_no_more_scans() {
        let kind = SurfaceKind::of(Method::RandomPhase);
        let values = [0.1, 0.5, 0.12, 0.52, 0.08, 0.48];
        let value = |(k, friction): (u32, f64)| {
            let mut value = curve(8, k, 0.05, friction);
            value.curve.kind = kind;
            value
        };
        let mut rows = average(Model::Bem, (1..).zip(values).map(value).collect());
        let window_of = (1..=6).map(|k| ((kind, k), format!("window {}", k % 2))).collect();
        basis(Some(2), window_of).complete(&mut rows);
        assert_eq!(rows[0].windows, 2);
        // Two windows of means 0.1 and 0.5: t(1) 0.2828 / sqrt 2.
        let half = rows[0].confidence_95.unwrap();
        approx::assert_relative_eq!(half, 12.7062 * 0.2, max_relative = 1e-4);
    }
}
