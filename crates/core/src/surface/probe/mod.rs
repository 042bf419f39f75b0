//! The shortest wavelength that an instrument shows as it is.

use super::LineScan;
use rayon::prelude::*;

/// A light spot is reliable from this many of its diameters on: a Gaussian spot of 1/e² diameter d
/// damps a wave of wavelength 2 d to `exp(-π²/32) = 0.73` of its amplitude, one of d to 0.29.
pub const WAVELENGTHS_PER_SPOT: f64 = 2.0;

/// A tip is reliable at scales where the sharpest peak has less than this share of the curvature of
/// the tip: the factor that Sanner et al. (2022) find on synthetic surfaces.
pub const SHARE_OF_TIP_CURVATURE: f64 = 0.5;

/// What probed a scan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Probe {
    /// 1/e² diameter of the light spot in metres.
    pub spot_diameter: Option<f64>,
    /// Radius of the tip of a stylus in metres.
    pub tip_radius: Option<f64>,
}

impl Probe {
    /// Shortest wavelength in metres that scans of one spacing made with the probe show as it is: the
    /// largest of two spacings, two spot diameters and the scale at which tip artefacts set in.
    ///
    /// The curvature at the scale `l = 2 s` is that of second differences with a lag s. A tip of
    /// radius R rounds peaks to its own curvature 1/R, and artefacts are to be expected below the
    /// scale at which the smallest (most negative) curvature of all points reaches half of it:
    ///
    /// ```text
    /// min over x of (z(x + s) - 2 z(x) + z(x - s)) / s^2 = -1 / (2 R),   l = 2 s
    /// ```
    ///
    /// after A. Sanner, W.G. Nöhring, L.A. Thimons, T.D.B. Jacobs, L. Pastewka, Appl. Surf. Sci.
    /// Adv. 7 (2022) 100190, doi:10.1016/j.apsadv.2021.100190. The sharpest peak of all scans
    /// decides, not the root mean square curvature: a tip that is too blunt for the peaks alone
    /// leaves most of a scan as it is. Valleys are not used, since a tip leaves cusps in them.
    /// Heights must grow towards the tip. If the condition holds at no lag, the wavelength is as
    /// long as the longest scan.
    pub fn shortest_reliable_wavelength(&self, scans: &[LineScan]) -> f64 {
        let samples = scans.iter().map(|scan| 2.0 * scan.spacing).fold(0.0, f64::max);
        let spot = self.spot_diameter.map_or(0.0, |diameter| WAVELENGTHS_PER_SPOT * diameter);
        let tip = self.tip_radius.map_or(0.0, |radius| {
            // The largest does not depend on the order of the threads.
            scans.par_iter().map(|scan| 2.0 * tip_lag(scan, radius)).reduce(|| 0.0, f64::max)
        });
        samples.max(spot).max(tip)
    }
}

/// The lag in metres from which on every peak of a scan is blunter than
/// [`SHARE_OF_TIP_CURVATURE`] of a tip of some radius (metres).
fn tip_lag(scan: &LineScan, radius: f64) -> f64 {
    let (heights, spacing) = (&scan.heights, scan.spacing);
    let lag = |k: usize| k as f64 * spacing;
    let limit = SHARE_OF_TIP_CURVATURE / radius;
    // NaN, where a point is missing, is not sharper than anything.
    let too_sharp = |&k: &usize| {
        let fall = limit * lag(k).powi(2);
        (k..heights.len() - k).any(|i| 2.0 * heights[i] - heights[i - k] - heights[i + k] > fall)
    };
    // A peak rises above its neighbours by the range of the heights at most, so that longer lags
    // than this one cannot be too sharp.
    let longest = ((2.0 * range(heights) / limit).sqrt() / spacing).floor() as usize;
    let longest = longest.min(heights.len().saturating_sub(1) / 2);
    let last = (1..=longest).rev().find(too_sharp);
    last.map_or(0.0, |k| lag(k + 1))
}

/// Largest less smallest of the valid heights; 0 without any.
fn range(heights: &[f64]) -> f64 {
    let largest = heights.iter().copied().fold(f64::NAN, f64::max);
    let smallest = heights.iter().copied().fold(f64::NAN, f64::min);
    if largest > smallest { largest - smallest } else { 0.0 }
}

#[cfg(test)]
mod tests;
