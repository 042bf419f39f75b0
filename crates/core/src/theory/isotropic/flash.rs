//! Persson's flash temperature.

use super::angle::AngularMeans;
use super::{IsotropicPersson, IsotropicPrediction, PerssonError, positive};
use std::f64::consts::{PI, TAU};

/// What the heating of the rubber depends on.
#[derive(Clone, Copy)]
pub struct Heating<'a> {
    /// Thermal conductivity κ of the rubber in W/(m K).
    pub conductivity: f64,
    /// Density ρ times specific heat c of the rubber in J/(m³ K).
    pub volumetric_heat: f64,
    /// Diameter in m of the large contact regions, which a point of the rubber crosses in `t_0 = diameter / v`. All heat is
    /// made in the share of the area that is in contact with the waves longer than it.
    pub contact_diameter: f64,
    /// `ln` of the shift factor and of the factor of all moduli at a rise of the temperature in K, both 0 without one; NaN where
    /// they are not known.
    pub shift: &'a dyn Fn(f64) -> [f64; 2],
}

impl Heating<'_> {
    /// Whether the rubber shifts to all these rises of the temperature in K.
    fn is_known(&self, rises: &[f64]) -> bool {
        rises.iter().all(|rise| (self.shift)(*rise).iter().all(|factor| factor.is_finite()))
    }
}

/// A prediction with the heat of the rubber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlashPrediction {
    /// Area, friction and gap of the heated rubber. Their errors are the larger of those of the quadrature and of the
    /// temperatures.
    pub prediction: IsotropicPrediction,
    /// Rise of the temperature in K that the waves up to the shortest one see.
    pub rise: f64,
    /// Steps of the fixed point.
    pub steps: usize,
}

/// Temperatures in a decade of wavenumbers, on the coarser of two grids.
const PER_DECADE: f64 = 12.0;
/// Largest step of the temperatures in the end, over the largest rise or 1 K.
const SETTLED: f64 = 1e-6;
/// Steps before the fixed point gives up.
const MOST_STEPS: usize = 200;
/// Smallest share of a step that is taken.
const LEAST_SHARE: f64 = 1.0 / 64.0;

impl IsotropicPersson<'_> {
    /// The prediction with Persson's flash temperature (J. Phys.: Condens. Matter 18, 7789, 2006,
    /// doi:10.1088/0953-8984/18/32/025):
    ///
    /// ```text
    /// T_q = ∫ g(q, q') f(q') dq',   f dq = 2 q p v dμ / (ρ c P(q_m)),   q_m = 2 π / diameter
    /// g(q, q') = 1/π ∫_0^∞ (1 - exp(-D k² t_0)) / (D k²) 4 q' / (k² + 4 q'²) 4 q² / (k² + 4 q²) dk,   D = κ / (ρ c)
    /// ```
    ///
    /// The waves at `q'` make their share `dμ` of the friction as heat that falls with depth as `exp(-2 q' z)`, and those
    /// at `q` see the mean of the temperature with the weight `exp(-2 q z)`: moduli at `q` are those at the frequency
    /// `q v a_T(T_q) cos φ`. `dμ` includes S, so that all heat is the work of friction.
    ///
    /// The heat of a single wave is most at the depth `1/q` and zero at the surface, so the source is an approximation.
    /// A damped fixed point finds the temperatures; they are found on two grids, and their difference is part of the
    /// error.
    ///
    /// # Errors
    /// As [`Self::at`]; [`PerssonError::NotPositive`] for a number of the heating, [`PerssonError::NotConverged`] if the
    /// temperatures do not settle, [`PerssonError::NoShift`] if they lead where the shift is not known.
    pub fn heated(
        &self,
        speed: f64,
        pressure: f64,
        heating: &Heating,
    ) -> Result<FlashPrediction, PerssonError> {
        self.require_known(speed)?;
        for (quantity, value) in [
            ("the thermal conductivity in W/(m K)", heating.conductivity),
            ("the volumetric heat in J/(m3 K)", heating.volumetric_heat),
            ("the diameter of the contact regions in m", heating.contact_diameter),
        ] {
            positive(quantity, value)?;
        }
        let coarse = self.settled(speed, pressure, heating, PER_DECADE)?;
        let mut fine = self.settled(speed, pressure, heating, 2.0 * PER_DECADE)?;
        let (before, now) = (&coarse.prediction, &mut fine.prediction);
        let changes = now.changes_from(before);
        let errors = &mut now.errors;
        errors.contact_area_fraction =
            errors.contact_area_fraction.max(changes.contact_area_fraction);
        errors.friction_coefficient = errors.friction_coefficient.max(changes.friction_coefficient);
        errors.mean_gap = errors.mean_gap.max(changes.mean_gap);
        Ok(fine)
    }

    /// The fixed point on a grid of temperatures.
    fn settled(
        &self,
        speed: f64,
        pressure: f64,
        heating: &Heating,
        per_decade: f64,
    ) -> Result<FlashPrediction, PerssonError> {
        let grid = self.grid(per_decade);
        let rises = Rises::new(&grid, speed, pressure, heating);
        let predict = |rise: &[f64]| {
            let means = |wavenumber: f64, step: f64| {
                let [shift, factor] = (heating.shift)(between(&grid, rise, wavenumber));
                AngularMeans::of(self.rubber, wavenumber * speed * shift.exp(), step)
                    .scaled(factor.exp())
            };
            self.predict(pressure, &grid[1..], &means)
        };
        let mut rise = vec![0.0; grid.len()];
        if !heating.is_known(&rise) {
            return Err(PerssonError::NoShift { rise: 0.0 });
        }
        let (mut share, mut last) = (1.0_f64, f64::INFINITY);
        for steps in 1..=MOST_STEPS {
            let rows = predict(&rise)?;
            let next = rises.of(&rows);
            let hottest = next.iter().copied().fold(1.0, f64::max);
            let change =
                next.iter().zip(&rise).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / hottest;
            if !change.is_finite() {
                let quantity = "the flash temperature";
                return Err(PerssonError::NotFinite { quantity, value: change });
            }
            if change <= SETTLED {
                let prediction = rows[rows.len() - 1];
                return Ok(FlashPrediction { prediction, rise: next[next.len() - 1], steps });
            }
            // A step that leads away was too long.
            share = if change > 0.7 * last { (0.5 * share).max(LEAST_SHARE) } else { share };
            let step = |share: f64| -> Vec<f64> {
                rise.iter().zip(&next).map(|(old, new)| old + share * (new - old)).collect()
            };
            // A step may lead to temperatures that only it has, and where the shift is not known.
            let mut moved = step(share);
            while !heating.is_known(&moved) {
                share *= 0.5;
                if share < LEAST_SHARE {
                    return Err(PerssonError::NoShift { rise: hottest });
                }
                moved = step(share);
            }
            (rise, last) = (moved, change);
        }
        let (quantity, tolerance) = ("the flash temperature", SETTLED);
        Err(PerssonError::NotConverged { quantity, change: last, tolerance })
    }

    /// Wavenumbers from the longest wave to the shortest one in equal steps of their logarithm.
    fn grid(&self, per_decade: f64) -> Vec<f64> {
        let [first, last] = self.band;
        let steps = ((last / first).log10() * per_decade).ceil().max(1.0) as i32;
        let at = |k: i32| first * (last / first).powf(f64::from(k) / f64::from(steps));
        (0..steps).map(at).chain([last]).collect()
    }
}

/// The value at a wavenumber, linear in `ln q`.
fn between(grid: &[f64], values: &[f64], wavenumber: f64) -> f64 {
    let k = grid.partition_point(|q| *q <= wavenumber).clamp(1, grid.len() - 1) - 1;
    let share = (wavenumber / grid[k]).ln() / (grid[k + 1] / grid[k]).ln();
    values[k] + share.clamp(0.0, 1.0) * (values[k + 1] - values[k])
}

/// Rises of the temperature at the points of a grid from the friction of its intervals.
struct Rises {
    /// Rise in K at every point by a friction coefficient of 1 in every interval, with the heat on all of the area.
    kernel: Vec<Vec<f64>>,
    /// Points of the grid up to which the waves are longer than the contact regions.
    long: usize,
}

impl Rises {
    fn new(grid: &[f64], speed: f64, pressure: f64, heating: &Heating) -> Self {
        let diffusivity = heating.conductivity / heating.volumetric_heat;
        let time = heating.contact_diameter / speed;
        let power = pressure * speed / heating.volumetric_heat;
        let row = |q: &f64| {
            let interval = |ends: &[f64]| {
                let middle = (ends[0] * ends[1]).sqrt();
                2.0 * middle * power * kernel(*q, middle, diffusivity, time)
            };
            grid.windows(2).map(interval).collect()
        };
        let macroscopic = TAU / heating.contact_diameter;
        Self {
            kernel: grid.iter().map(row).collect(),
            long: grid.partition_point(|q| *q <= macroscopic),
        }
    }

    /// Rises at the points, from the predictions at all points but the first.
    fn of(&self, rows: &[IsotropicPrediction]) -> Vec<f64> {
        let area = match self.long {
            0 | 1 => 1.0,
            long => rows[long - 2].contact_area_fraction,
        };
        let friction = |k: usize| rows[k].friction_coefficient;
        let shares: Vec<f64> = (0..rows.len())
            .map(|k| friction(k) - if k == 0 { 0.0 } else { friction(k - 1) })
            .collect();
        let sum = |row: &Vec<f64>| row.iter().zip(&shares).map(|(g, mu)| g * mu).sum::<f64>();
        self.kernel.iter().map(|row| sum(row) / area).collect()
    }
}

/// Step in `ln k`: the rule is then exact to some 1e-11, as the integrand has no pole within `π/4` of the real axis.
const STEP: f64 = 0.2;

/// `g(q, q')` in s at a diffusivity in m²/s and a time in s; the trapezoidal rule in `ln k`.
fn kernel(q: f64, source: f64, diffusivity: f64, time: f64) -> f64 {
    let diffused = 1.0 / (diffusivity * time).sqrt();
    let scales = [2.0 * q, 2.0 * source, diffused];
    // The integrand rises as k below the smallest scale and falls as k^-3 or faster beyond the largest.
    let from = scales.into_iter().fold(f64::INFINITY, f64::min).ln() - 30.0;
    let to = scales.into_iter().fold(0.0, f64::max).ln() + 12.0;
    let steps = ((to - from) / STEP).ceil() as i32;
    let at = |j: i32| {
        let k = (from + f64::from(j) * STEP).exp();
        let squared = k * k;
        let x = diffusivity * squared * time;
        let conducted = if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x };
        let weight = |scale: f64| 1.0 / (squared + 4.0 * scale * scale);
        k * time * conducted * 4.0 * source * weight(source) * 4.0 * q * q * weight(q)
    };
    STEP / PI * (0..=steps).map(at).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::{Diffusion, PerssonOptions};
    use super::*;
    use crate::rubber::Rubber;
    use crate::surface::spectrum::IsotropicSpectrum;
    use approx::assert_relative_eq;

    const VOLUMETRIC: f64 = 1150.0 * 1500.0;
    const DIFFUSIVITY: f64 = 0.3 / VOLUMETRIC;

    /// Figures of the trapezoidal rule in numpy with a hundredth of the step.
    #[test]
    fn the_kernel_has_the_values_of_an_independent_quadrature() {
        for (q, source, time, expected) in [
            (1e5, 1e5, 1e-8, 4.999_827_820_80e-9),
            (1e5, 1e5, 1e-5, 4.871_086_734_39e-6),
            (1e5, 1e5, 1e-3, 2.684_161_338_83e-4),
            (1e5, 1e5, 0.1, 4.068_697_610_31e-3),
            (1e5, 3e4, 1e-3, 5.725_334_278_84e-4),
        ] {
            let found = kernel(q, source, DIFFUSIVITY, time);
            assert_relative_eq!(found, expected, max_relative = 1e-10);
        }
        // Before heat is conducted.
        assert_relative_eq!(
            kernel(1e5, 4e4, DIFFUSIVITY, 1e-13),
            1e-13 * 1e5 / 1.4e5,
            max_relative = 1e-6
        );
    }

    fn surface() -> IsotropicSpectrum {
        let end = 1e-15 * 1e2_f64.powf(-3.6);
        IsotropicSpectrum::new(vec![1e3, 1e5], vec![1e-15, end]).unwrap()
    }

    fn heating(shift: &dyn Fn(f64) -> [f64; 2]) -> Heating<'_> {
        let contact_diameter = 2e-3;
        Heating { conductivity: 0.3, volumetric_heat: VOLUMETRIC, contact_diameter, shift }
    }

    #[test]
    fn a_rubber_without_shift_is_heated_and_stays_as_it_is() {
        let (surface, rubber) = (surface(), Rubber::table_2_1());
        let options = PerssonOptions { gamma: 0.5, diffusion: Diffusion::Full, tolerance: 1e-5 };
        let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), options).unwrap();
        let cold = theory.at(1.0, 3e5).unwrap();
        let none = |_: f64| [0.0, 0.0];
        let hot = theory.heated(1.0, 3e5, &heating(&none)).unwrap();
        let friction = hot.prediction.friction_coefficient;
        assert_relative_eq!(friction, cold.friction_coefficient, max_relative = 2e-5);
        assert_eq!(hot.steps, 2);
        // The rise is linear in the heat: by the sum over the waves, on a grid of its own.
        let count = 400;
        let q = |k: f64| 1e3 * 1e2_f64.powf(k / f64::from(count));
        let marks: Vec<f64> = (1..count).map(|k| q(f64::from(k))).chain([1e5]).collect();
        let rows = theory.over_wavenumbers(1.0, 3e5, &marks).unwrap();
        // The first wavenumber at or below 2 pi / 2 mm on the grid of the temperatures, 24 in a decade.
        let macroscopic = 1e3 * 10_f64.powf((PI.log10() * 24.0).floor() / 24.0);
        let area = theory.over_wavenumbers(1.0, 3e5, &[macroscopic]).unwrap()[0];
        let mut before = 0.0;
        let mut rise = 0.0;
        for (k, row) in rows.iter().enumerate() {
            let middle = q(k as f64 + 0.5);
            let heat = 3e5 * (row.friction_coefficient - before) / VOLUMETRIC;
            rise += 2.0 * middle * heat * kernel(1e5, middle, DIFFUSIVITY, 2e-3);
            before = row.friction_coefficient;
        }
        // 48 intervals instead of 400.
        assert_relative_eq!(hot.rise, rise / area.contact_area_fraction, max_relative = 1e-3);
    }

    #[test]
    fn heat_softens_and_the_temperatures_settle() {
        let (surface, rubber) = (surface(), Rubber::table_2_1());
        let options = PerssonOptions { tolerance: 1e-5, ..Default::default() };
        let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), options).unwrap();
        let wlf = |rise: f64| [-8.86 * rise / (101.6 + rise) * std::f64::consts::LN_10, 0.0];
        for speed in [1e-4, 0.1, 1.0, 10.0] {
            let cold = theory.at(speed, 3e5).unwrap();
            let hot = theory.heated(speed, 3e5, &heating(&wlf)).unwrap();
            let found = hot.prediction;
            assert!(found.contact_area_fraction >= cold.contact_area_fraction);
            assert!(hot.rise > 0.0 && hot.rise < 500.0, "{hot:?}");
            if speed < 1e-3 {
                // Slow sliding does not heat.
                assert!(hot.rise < 0.1, "{hot:?}");
            }
            // Two grids of temperatures agree.
            assert!(
                found.errors.friction_coefficient < 1e-2 * found.friction_coefficient,
                "{hot:?}"
            );
        }
    }

    #[test]
    fn numbers_of_no_rubber_are_refused() {
        let (surface, rubber) = (surface(), Rubber::table_2_1());
        let options = PerssonOptions::default();
        let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), options).unwrap();
        let none = |_: f64| [0.0, 0.0];
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for k in 0..3 {
                let mut heating = heating(&none);
                [
                    &mut heating.conductivity,
                    &mut heating.volumetric_heat,
                    &mut heating.contact_diameter,
                ]
                .into_iter()
                .nth(k)
                .into_iter()
                .for_each(|number| *number = value);
                let error = theory.heated(1.0, 3e5, &heating).unwrap_err();
                assert!(matches!(error, PerssonError::NotPositive { .. }), "{error}");
            }
        }
        let nowhere = |_: f64| [f64::NAN, 0.0];
        let error = theory.heated(1.0, 3e5, &heating(&nowhere)).unwrap_err();
        assert!(matches!(error, PerssonError::NoShift { .. }), "{error}");
        // A law that ends below the temperature of the contact.
        let ends = |rise: f64| if rise <= 0.5 { [0.0, 0.0] } else { [f64::NAN; 2] };
        let error = theory.heated(1.0, 3e5, &heating(&ends)).unwrap_err();
        assert!(matches!(error, PerssonError::NoShift { .. }), "{error}");
    }
}
