//! Waves that matter less than the accuracy that is asked for are left out, and what that changes is
//! bounded.
//!
//! The longest wave sets the period and the shortest one the grid: half the points are enough without
//! either. On the realisations that are solved first friction is computed with and without them, and a wave is left out of all
//! others where the mean of the differences and the half width of its 95 % interval together stay below a share
//! of the tolerance, at every area. Both have the same phases, so that their difference varies much less than either
//! friction, and few realisations tell.
//!
//! A short wave that is pressed flat leaves its friction behind: within the contacts its pressure is that
//! of full contact, whose friction is known in closed form ([`LeftOut::closed_form`]).

use super::CurveRow;
use super::ensemble::FIRST_REALISATIONS;
use crate::numerics::statistics::MeanEstimate;
use crate::rubber::{RubberModel, Viscoelastic};
use crate::stages::realise::Surface;
use crate::units::Units;
use std::f64::consts::TAU;

/// Of the tolerance that left-out waves may take.
const SHARE: f64 = 0.125;
/// A single difference this many times the share is not going to average out.
const HOPELESS: f64 = 4.0;
/// The trial costs as much as some of the first realisations: there have to be more than that left.
const LEAST_SAVED: usize = 2 * FIRST_REALISATIONS;

/// Waves that are left out, by their number in the surface from the shortest.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LeftOut {
    /// Long ones, without trace.
    long: Vec<usize>,
    /// Short ones, in full contact within the contacts.
    short: Vec<usize>,
    /// Bound of the change of the mean friction, at each of the wanted areas.
    errors: Vec<f64>,
}

impl LeftOut {
    /// Whether it pays to look for waves that may be left out.
    pub fn pays(solved: usize, wanted: usize) -> bool {
        solved <= FIRST_REALISATIONS && wanted - solved >= LEAST_SAVED
    }

    /// Tries longest and shortest waves of the `surfaces`, whose curves with all waves are `full`; `solve`
    /// makes the curve of a surface. If there is none, the wave stays.
    ///
    /// # Errors
    /// Those of `solve`.
    pub fn find<E>(
        rubber: &RubberModel,
        surfaces: &[Surface],
        full: &[&[CurveRow]],
        tolerance: f64,
        mut solve: impl FnMut(&Surface) -> Result<Option<Vec<CurveRow>>, E>,
    ) -> Result<Self, E> {
        let mut found = Self::default();
        for grow in [Self::without_longest, Self::without_shortest] {
            while let Some(candidate) = surfaces.first().and_then(|surface| grow(&found, surface)) {
                let solve = &mut solve;
                let bound = candidate.bound(rubber, surfaces, full, tolerance, solve)?;
                let Some(errors) = bound else { break };
                found = Self { errors, ..candidate };
            }
        }
        Ok(found)
    }

    /// The surface without them.
    pub fn reduce(&self, surface: &Surface) -> Surface {
        let mut reduced = surface.clone();
        for &wave in self.long.iter().chain(&self.short) {
            reduced.profile[wave].amplitude = 0.0;
        }
        reduced
    }

    /// A curve of a reduced surface with the friction that is known without solving, and the bound
    /// of what is missing.
    pub fn complete(&self, rubber: &RubberModel, surface: &Surface, curve: &mut [CurveRow]) {
        for (k, row) in curve.iter_mut().enumerate() {
            row.friction_coefficient += self.closed_form(rubber, surface, row);
            row.left_out_error = self.errors.get(k).copied().unwrap_or(0.0);
        }
    }

    /// Wavelengths in m.
    pub fn wavelengths(&self, surface: &Surface) -> Vec<f64> {
        let waves = self.short.iter().chain(self.long.iter().rev());
        waves.map(|wave| surface.profile[*wave].wavelength).collect()
    }

    /// Friction of the short waves where all contacts follow them to their valleys. A wave of wavenumber
    /// `q` and amplitude `D` under full contact has the mean shear stress `q^2 D^2 Im E_r(q v) / 4`, which is that of
    /// its pressure wave `E_r q D / 2` on its slope; friction is this on the area over the mean pressure.
    fn closed_form(&self, rubber: &RubberModel, surface: &Surface, row: &CurveRow) -> f64 {
        let shear = |wave: &usize| {
            let wave = surface.profile[*wave];
            let q = TAU / wave.wavelength;
            let loss = rubber.reduced_modulus((q * row.speed_mm_s).mm_to_m()).im;
            (q * wave.amplitude).powi(2) * loss / 4.0
        };
        let in_full_contact: f64 = self.short.iter().map(shear).sum();
        in_full_contact * row.contact_area_fraction / row.pressure_mpa.mpa_to_pa()
    }

    fn without_longest(&self, surface: &Surface) -> Option<Self> {
        let mut grown = self.clone();
        grown.long.push(self.present(surface)?.last().copied()?);
        Some(grown)
    }

    fn without_shortest(&self, surface: &Surface) -> Option<Self> {
        let mut grown = self.clone();
        grown.short.push(self.present(surface)?.first().copied()?);
        Some(grown)
    }

    /// Waves with an amplitude that are still there; none if there is but one.
    fn present(&self, surface: &Surface) -> Option<Vec<usize>> {
        let there = |wave: &usize| {
            surface.profile[*wave].amplitude != 0.0
                && !self.long.contains(wave)
                && !self.short.contains(wave)
        };
        let waves: Vec<usize> = (0..surface.profile.len()).filter(there).collect();
        (waves.len() > 1).then_some(waves)
    }

    /// Bound of the change of the mean friction at each area; none if it is too much at any.
    fn bound<E>(
        &self,
        rubber: &RubberModel,
        surfaces: &[Surface],
        full: &[&[CurveRow]],
        tolerance: f64,
        solve: &mut impl FnMut(&Surface) -> Result<Option<Vec<CurveRow>>, E>,
    ) -> Result<Option<Vec<f64>>, E> {
        let Some(areas) = full.first().map(|curve| curve.len()) else { return Ok(None) };
        let mean = |k: usize| {
            full.iter().map(|curve| curve[k].friction_coefficient).sum::<f64>() / full.len() as f64
        };
        let most: Vec<f64> = (0..areas).map(|k| SHARE * tolerance * mean(k).abs()).collect();
        let mut differences = vec![Vec::new(); areas];
        for (surface, full) in surfaces.iter().zip(full) {
            let Some(mut curve) = solve(&self.reduce(surface))? else { return Ok(None) };
            self.complete(rubber, surface, &mut curve);
            for (k, (reduced, full)) in curve.iter().zip(*full).enumerate() {
                let difference = reduced.friction_coefficient - full.friction_coefficient;
                if difference.abs() > HOPELESS * most[k] {
                    return Ok(None);
                }
                differences[k].push(difference);
            }
        }
        let estimates = differences.iter().map(|differences| MeanEstimate::of(differences));
        let errors: Vec<f64> = estimates.map(|e| e.mean.abs() + e.confidence_95).collect();
        // Not a number, of one realisation, is too much.
        Ok(errors.iter().zip(&most).all(|(error, most)| error <= most).then_some(errors))
    }
}
