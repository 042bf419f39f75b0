//! Synthetic line scans and maps of asphalt, as a profilometer would give them.
//!
//! A stationary random surface is prescribed by its height-difference correlation (HDC) and its
//! skewness. Over a period much longer than a scan, so that a scan is a window with the natural
//! scatter of a window, a Gaussian field is drawn by circulant embedding (`field`) and mapped to
//! heights by a translation (`translation`) whose autocorrelation is known in closed form: the HDC of
//! the surface is the prescribed one exactly, not only before the map. The instrument (`instrument`)
//! then averages over its spot, tilts, adds noise and loses points.
//!
//! Such a surface has the heights of a rolled road at every point, but the map acts on each point by itself: its pits
//! lie anywhere. [`SyntheticAsphalt::rolled`] has stones (`stones`), and the random surface is their texture.
//!
//! | module | what it holds |
//! |---|---|
//! | `parameters` | the parameters of a synthetic surface and their ranges |
//! | `map` | height maps of a random surface |
//! | `field` | Gaussian fields of prescribed autocorrelation by circulant embedding |
//! | `stones` | stones pressed to a level, with pits between them |
//! | `translation` | heights with skewness from a Gaussian field |
//! | `instrument` | spot, tilt, noise and drop-outs of a profilometer |
//! | `text` | the text file that it would write |
//! | `random` | random numbers that are the same on every machine |

mod field;
mod instrument;
mod map;
mod parameters;
mod random;
mod stones;
mod text;
mod translation;

pub use map::SyntheticMap;
pub use parameters::{HeightMoments, OuterRegime, Stones, SynthesisError, SyntheticAsphalt};
pub use text::write_text;

use crate::surface::scan::RawScan;
use field::GaussianField;
use rand_pcg::Pcg64;
use std::f64::consts::SQRT_2;
use translation::{Cumulants, Translation};

/// Sharpness of the crossover between two self-affine regimes: within a tenth of the local exponents'
/// difference at half and at twice the crossover lag, and a positive spectrum at all usual exponents.
const CROSSOVER_SHARPNESS: f64 = 4.0;
/// The period of the surface in lengths of a scan, parallel correlation lengths and stones, at least.
const PERIOD_SCANS: f64 = 4.0;
const PERIOD_CORRELATION_LENGTHS: f64 = 16.0;
const PERIOD_STONES: f64 = 16.0;
/// Largest number of points of a period, 0.5 GB per array.
const MAX_POINTS: usize = 1 << 26;

impl SyntheticAsphalt {
    /// Prescribed HDC in m² at a lag `s >= 0` in metres, before spot, tilt and noise; stones add theirs.
    ///
    /// ```text
    /// C(s) = ξ⊥² h (1 + h^p)^(-1/p)
    /// h(s) = (s/ξ∥)^(2H)                                            one regime (thesis 3.3.2-3)
    /// h(s) = (s/ξ∥)^(2Ho) (1 + (x/s)^4)^(-(2H - 2Ho)/4)             crossover lag x, outer exponent Ho
    /// ```
    ///
    /// Power laws and plateau are the asymptotes; p (`plateau_sharpness`) rounds the corner at ξ∥.
    pub fn height_difference_correlation(&self, lag: f64) -> f64 {
        self.perpendicular_correlation_length.powi(2) * self.relative_correlation(lag)
    }

    fn relative_correlation(&self, lag: f64) -> f64 {
        if lag == 0.0 {
            return 0.0;
        }
        let relative = lag / self.parallel_correlation_length;
        let growth = match self.outer_regime {
            None => relative.powf(2.0 * self.hurst_exponent),
            Some(outer) => {
                let bend = 1.0 + (outer.crossover_lag / lag).powf(CROSSOVER_SHARPNESS);
                let excess = 2.0 * (self.hurst_exponent - outer.hurst_exponent);
                relative.powf(2.0 * outer.hurst_exponent) * bend.powf(-excess / CROSSOVER_SHARPNESS)
            }
        };
        // The plateau side is written with 1/h so that nothing overflows at long lags.
        let p = self.plateau_sharpness;
        if growth < 1.0 {
            growth * (1.0 + growth.powf(p)).powf(-1.0 / p)
        } else {
            (1.0 + growth.powf(-p)).powf(-1.0 / p)
        }
    }

    /// Moments of the heights of the surface, before spot, tilt and noise.
    ///
    /// Field and stones are independent, so their cumulants κ add: `Rq² = κ2`, skewness `κ3/κ2^(3/2)`, kurtosis
    /// `3 + κ4/κ2²`. Finite windows without their slope show less of all three.
    pub fn height_moments(&self) -> HeightMoments {
        let field = Translation::with_skewness(self.skewness)
            .cumulants(self.perpendicular_correlation_length / SQRT_2);
        let stones = self.stones.as_ref().map(Stones::cumulants);
        let sum = |of: fn(&Cumulants) -> f64| of(&field) + stones.as_ref().map_or(0.0, of);
        let [second, third, fourth] = [sum(|c| c.second), sum(|c| c.third), sum(|c| c.fourth)];
        HeightMoments {
            rms_height: second.sqrt(),
            skewness: third / second.powf(1.5),
            kurtosis: 3.0 + fourth / (second * second),
        }
    }

    /// Make the scans, named `scan_01`, `scan_02`, ...
    ///
    /// Scan i depends on the seed, on i and on the surface and instrument, not on the number of scans.
    ///
    /// # Errors
    /// [`SynthesisError`]: a parameter outside its range, too many points, or an HDC that no surface has.
    pub fn generate(&self) -> Result<Vec<RawScan>, SynthesisError> {
        let surface = Surface::new(self)?;
        Ok((0..self.scans).map(|index| self.scan(&surface, index)).collect())
    }

    fn scan(&self, surface: &Surface, index: usize) -> RawScan {
        let mut rng = Pcg64::new(u128::from(self.seed), index as u128);
        let points = (self.length / self.spacing).round() as usize;
        let profile = surface.realise(&mut rng);
        let diameter = self.spot_diameter / self.spacing * surface.refinement as f64;
        let seen = instrument::spot_average(&profile, points, surface.refinement, diameter);
        let positions: Vec<f64> = (0..points).map(|i| i as f64 * self.spacing).collect();
        let slope = self.tilt * random::normal_pair(&mut rng).0;
        let tilted = |(x, z): (&f64, &f64)| z + slope * (x - self.length / 2.0);
        let mut heights: Vec<f64> = positions.iter().zip(&seen).map(tilted).collect();
        instrument::add_noise(&mut heights, self.noise, &mut rng);
        let count = (self.missing_fraction * points as f64).round() as usize;
        let run_length = self.missing_run_length / self.spacing;
        for i in instrument::drop_outs(&seen, count, run_length, &mut rng) {
            heights[i] = f64::NAN;
        }
        RawScan { name: format!("scan_{:02}", index + 1), positions, heights }
    }
}

/// The random surface, prepared once for all scans.
struct Surface {
    field: GaussianField,
    translation: Translation,
    /// Root mean square height Rq = ξ⊥/√2 of the field in metres.
    rms_height: f64,
    stones: Option<Stones>,
    /// Distance between the points of the surface in metres.
    step: f64,
    /// Points of the surface per raw point.
    refinement: usize,
}

impl Surface {
    fn new(parameters: &SyntheticAsphalt) -> Result<Self, SynthesisError> {
        parameters.validate()?;
        let refinement = match parameters.spot_diameter {
            0.0 => 1.0,
            // At most one standard deviation of the spot per step: the sum over a Gaussian is then
            // its integral to 5e-9 (Poisson summation).
            diameter => (4.0 * parameters.spacing / diameter).ceil().max(1.0),
        };
        let step = parameters.spacing / refinement;
        let period = (PERIOD_SCANS * parameters.length)
            .max(PERIOD_CORRELATION_LENGTHS * parameters.parallel_correlation_length)
            .max(PERIOD_STONES * parameters.stones.map_or(0.0, |stones| stones.mean_distance));
        let needed = period / step;
        if needed > MAX_POINTS as f64 {
            return Err(SynthesisError::TooManyPoints { points: needed, limit: MAX_POINTS });
        }
        let points = (needed.ceil() as usize).next_power_of_two();
        let translation = Translation::with_skewness(parameters.skewness);
        let field = GaussianField::new(points, |lag| {
            let heights = 1.0 - parameters.relative_correlation(lag as f64 * step);
            translation.gaussian_autocorrelation(heights)
        })
        .map_err(|negative_share| SynthesisError::NotRealisable {
            negative_share,
            plateau_sharpness: parameters.plateau_sharpness,
        })?;
        let rms_height = parameters.perpendicular_correlation_length / SQRT_2;
        let (stones, refinement) = (parameters.stones, refinement as usize);
        Ok(Self { field, translation, rms_height, stones, step, refinement })
    }

    /// Heights in metres over one period.
    fn realise(&self, rng: &mut Pcg64) -> Vec<f64> {
        let mut profile = self.field.realise(rng);
        for value in &mut profile {
            *value = self.rms_height * self.translation.height(*value);
        }
        if let Some(stones) = &self.stones {
            let added = stones.heights(profile.len(), self.step, rng);
            profile.iter_mut().zip(added).for_each(|(height, stone)| *height += stone);
        }
        profile
    }
}

#[cfg(test)]
mod tests;
