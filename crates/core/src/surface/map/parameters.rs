//! Areal roughness parameters of ISO 25178-2 of a map, with missing points.

use super::HeightMap;
use super::error::{ArealError, mean_height};
use super::functional::{AbbottCurve, FunctionalParameters};
use super::gradient::Gradients;
use super::lags::{LagPlane, PairMean};
use super::spectrum::ArealSpectrum;
use crate::surface::spectrum::Window;

/// Autocorrelation at which Sal and Str are read, the default of ISO 25178-3.
const AUTOCORRELATION: f64 = 0.2;
/// Points needed in each direction: fewer have no lags to speak of.
const LEAST: usize = 4;

/// Areal parameters of a map; lengths in m, heights `z` about the mean of the valid ones.
///
/// Form and filters are the caller's: remove at least the mean plane before. Missing points do not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArealParameters {
    /// Sa, mean of `|z|`.
    pub sa: f64,
    /// Sq, root of the mean of `z²`.
    pub sq: f64,
    /// Ssk, mean of `z³` over Sq³; negative for few deep valleys below a flattened top.
    pub ssk: f64,
    /// Sku, mean of `z⁴` over Sq⁴; 3 for Gaussian heights, 3/2 for a sine.
    pub sku: f64,
    /// Sp, the largest `z`.
    pub sp: f64,
    /// Sv, the depth of the deepest valley, `-min z`.
    pub sv: f64,
    /// Sz = Sp + Sv.
    pub sz: f64,
    /// Sdq, rms gradient: root of the mean of `zx² + zy²`, with first differences of neighbouring valid points over the
    /// spacing, as in a profile (see [`crate::surface::RoughnessParameters::rms_slope`] for their damping). It grows with
    /// resolution on a self-affine surface.
    pub sdq: f64,
    /// Sdr, developed interfacial area over the projected one, less 1 (the standard gives it in %): the mean of
    /// `sqrt(1 + zx² + zy²) - 1` over the four corner triangles of each cell. That is the area of the triangulation of
    /// ISO 25178-2:2021 D.3, the mean of those by either diagonal.
    pub sdr: f64,
    /// Sal, the shortest distance in any direction after which the autocorrelation falls to 0.2. `None` if it does not
    /// within half the lengths of the map.
    pub sal: Option<f64>,
    /// Str, Sal over the longest such distance: 0 for ridges, 1 for an isotropic map.
    pub str: Option<f64>,
    /// Str is an upper bound: in some direction the autocorrelation stays above 0.2 within half the lengths of the map.
    pub str_is_upper_bound: bool,
    /// Std, texture direction: degrees from `x` towards `y`, 0 to 180, of the waves with the most power (see
    /// [`ArealSpectrum::texture_direction`]). Grooves run at right angles to it. On an isotropic map it means nothing.
    pub std: f64,
    /// Parameters of the material ratio curve.
    pub functional: FunctionalParameters,
}

impl ArealParameters {
    /// Parameters of a map.
    ///
    /// The autocorrelation is the mean product of heights over all pairs of valid points at a lag, over Sq²: no window,
    /// nothing periodic. ISO's integral over the whole area without regard to the number of pairs is lower at long lags. For
    /// Std missing points have the mean height and the map is weighted by Hann's window along each direction.
    ///
    /// # Errors
    /// Fewer than 4 points in a direction, fewer than four heights, all heights equal, no neighbours with heights.
    pub fn of(map: &HeightMap) -> Result<Self, ArealError> {
        let mean = mean_height(map, LEAST)?;
        let gradients = Gradients::of(map)?;
        let heights: Vec<f64> =
            map.heights.iter().filter(|z| !z.is_nan()).map(|z| z - mean).collect();
        let moments = Moments::of(&heights);
        let too_few = || ArealError::TooFewHeights {
            map: map.name.clone(),
            valid: map.heights.len() - map.missing(),
            points: map.heights.len(),
            least: 4,
        };
        let functional =
            AbbottCurve::of(heights).and_then(|c| c.parameters()).ok_or_else(too_few)?;
        let half = map.points.map(|points| points / 2);
        let plane = LagPlane::of(map, mean, half, PairMean::Product);
        let decay = plane.crossings(AUTOCORRELATION * moments.sq.powi(2));
        drop(plane);
        Ok(Self {
            sa: moments.sa,
            sq: moments.sq,
            ssk: moments.ssk,
            sku: moments.sku,
            sp: moments.sp,
            sv: moments.sv,
            sz: moments.sp + moments.sv,
            sdq: gradients.rms,
            sdr: gradients.developed,
            sal: decay.map(|(shortest, ..)| shortest),
            str: decay.map(|(shortest, longest, _)| shortest / longest),
            str_is_upper_bound: decay.is_some_and(|(_, _, complete)| !complete),
            std: ArealSpectrum::about(map, mean, Window::Hann).texture_direction(),
            functional,
        })
    }
}

/// Moments and extremes of heights about their mean.
struct Moments {
    sa: f64,
    sq: f64,
    ssk: f64,
    sku: f64,
    sp: f64,
    sv: f64,
}

impl Moments {
    fn of(heights: &[f64]) -> Self {
        let count = heights.len() as f64;
        let mean = |f: fn(f64) -> f64| heights.iter().map(|&z| f(z)).sum::<f64>() / count;
        let sq = mean(|z| z * z).sqrt();
        Self {
            sa: mean(f64::abs),
            sq,
            ssk: mean(|z| z * z * z) / sq.powi(3),
            sku: mean(|z| (z * z) * (z * z)) / sq.powi(4),
            sp: heights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            sv: -heights.iter().copied().fold(f64::INFINITY, f64::min),
        }
    }
}

#[cfg(test)]
mod tests;
