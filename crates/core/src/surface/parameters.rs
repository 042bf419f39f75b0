//! Roughness parameters of line scans (thesis 3.2.1-7) and the root mean square slope.

use super::LineScan;
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::statistics::MeanEstimate;
use thiserror::Error;

/// Roughness parameters of one line scan; lengths in metres.
///
/// The means run over the valid points only, heights `z` are taken about the mean line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughnessParameters {
    /// Ra, mean of `|z|` (3.2.1).
    pub mean_absolute_height: f64,
    /// Rq, root of the mean of `z^2` (3.2.2).
    pub rms_height: f64,
    /// Rp, the largest `z` (3.2.3).
    pub highest_peak: f64,
    /// Rv, the depth of the deepest valley, `-min z`: positive below the mean line as in ISO 21920-2.
    ///
    /// The thesis (3.2.4) takes the smallest `z` itself, so its Rv has the other sign.
    pub deepest_valley: f64,
    /// Rt = Rp + Rv, the same total height as that of the thesis, Rp - Rv with its negative Rv (3.2.5).
    pub total_height: f64,
    /// Rsk, mean of `z^3` over `Rq^3` (3.2.6); negative for few deep valleys below a flattened top.
    pub skewness: f64,
    /// Rku, mean of `z^4` over `Rq^4` (3.2.7); 3 for Gaussian heights, 3/2 for a sine.
    pub kurtosis: f64,
    /// Root of the mean of `z'^2`, with `z'` the first difference of neighbouring valid points
    /// over the spacing.
    ///
    /// The first difference needs no point beyond its pair, so gaps cost only the pairs they
    /// touch. It damps a sine of wavelength λ by `sin(a) / a`, `a = π spacing / λ`: 10 % low at
    /// 4 points per wavelength, 0.6 % low at 16. It grows with resolution on a self-affine scan;
    /// compare scans of equal spacing only.
    pub rms_slope: f64,
}

/// A scan whose roughness parameters are not defined.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ParameterError {
    /// No height at all.
    #[error("scan {scan}: none of its {points} points has a height; leave the scan out")]
    NoHeights {
        /// Name of the scan.
        scan: String,
        /// Number of points, all missing.
        points: usize,
    },
    /// No two neighbours with a height, so no slope.
    #[error("scan {scan}: no two neighbouring points have heights; interpolate or leave it out")]
    NoNeighbours {
        /// Name of the scan.
        scan: String,
    },
    /// All heights on the mean line: skewness and kurtosis would be 0/0.
    #[error("scan {scan}: every height is {height} m, it has no roughness; leave the scan out")]
    Flat {
        /// Name of the scan.
        scan: String,
        /// The one height in metres.
        height: f64,
    },
    /// An average over nothing.
    #[error("no scans to average; give at least one")]
    NoScans,
}

impl HasKind for ParameterError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoHeights { .. }
            | Self::NoNeighbours { .. }
            | Self::Flat { .. }
            | Self::NoScans => ErrorKind::Input,
        }
    }
}

impl RoughnessParameters {
    /// Parameters of a scan about a horizontal mean line at height `mean_line` (metres).
    ///
    /// After form removal the mean line is 0; the line is an argument because a window cut from a
    /// levelled scan may be judged about the scan's line or about its own.
    ///
    /// # Errors
    /// No valid point, no valid neighbouring pair, or all heights on the mean line.
    pub fn of(scan: &LineScan, mean_line: f64) -> Result<Self, ParameterError> {
        let heights: Vec<f64> =
            scan.heights.iter().filter(|z| !z.is_nan()).map(|z| z - mean_line).collect();
        if heights.is_empty() {
            let (scan, points) = (scan.name.clone(), scan.heights.len());
            return Err(ParameterError::NoHeights { scan, points });
        }
        let count = heights.len() as f64;
        let mean = |power: i32| heights.iter().map(|z| z.powi(power)).sum::<f64>() / count;
        let rms_height = mean(2).sqrt();
        if rms_height == 0.0 {
            return Err(ParameterError::Flat { scan: scan.name.clone(), height: mean_line });
        }
        let highest_peak = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let deepest_valley = -heights.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Self {
            mean_absolute_height: heights.iter().map(|z| z.abs()).sum::<f64>() / count,
            rms_height,
            highest_peak,
            deepest_valley,
            total_height: highest_peak + deepest_valley,
            skewness: mean(3) / rms_height.powi(3),
            kurtosis: mean(4) / rms_height.powi(4),
            rms_slope: rms_slope(scan)
                .ok_or_else(|| ParameterError::NoNeighbours { scan: scan.name.clone() })?,
        })
    }
}

fn rms_slope(scan: &LineScan) -> Option<f64> {
    let steps = scan.heights.windows(2).map(|pair| pair[1] - pair[0]).filter(|dz| !dz.is_nan());
    let (sum, count) = steps.fold((0.0, 0_usize), |(sum, count), dz| (sum + dz * dz, count + 1));
    (count > 0).then(|| (sum / count as f64).sqrt() / scan.spacing)
}

/// Roughness parameters averaged over scans, each with its spread and confidence interval.
///
/// The scans are taken as independent and weigh the same. Fields as in [`RoughnessParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AverageRoughness {
    /// Ra in metres.
    pub mean_absolute_height: MeanEstimate,
    /// Rq in metres.
    pub rms_height: MeanEstimate,
    /// Rp in metres.
    pub highest_peak: MeanEstimate,
    /// Rv in metres, positive.
    pub deepest_valley: MeanEstimate,
    /// Rt in metres.
    pub total_height: MeanEstimate,
    /// Rsk.
    pub skewness: MeanEstimate,
    /// Rku.
    pub kurtosis: MeanEstimate,
    /// Root mean square slope.
    pub rms_slope: MeanEstimate,
}

impl AverageRoughness {
    /// Average over the parameters of scans.
    ///
    /// # Errors
    /// No scans.
    pub fn of(scans: &[RoughnessParameters]) -> Result<Self, ParameterError> {
        if scans.is_empty() {
            return Err(ParameterError::NoScans);
        }
        let average = |parameter: fn(&RoughnessParameters) -> f64| {
            MeanEstimate::of(&scans.iter().map(parameter).collect::<Vec<_>>())
        };
        Ok(Self {
            mean_absolute_height: average(|p| p.mean_absolute_height),
            rms_height: average(|p| p.rms_height),
            highest_peak: average(|p| p.highest_peak),
            deepest_valley: average(|p| p.deepest_valley),
            total_height: average(|p| p.total_height),
            skewness: average(|p| p.skewness),
            kurtosis: average(|p| p.kurtosis),
            rms_slope: average(|p| p.rms_slope),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::{PI, TAU};

    fn scan(spacing: f64, heights: Vec<f64>) -> LineScan {
        LineScan { name: "07".into(), origin: 0.0, spacing, heights }
    }

    fn sine(points: usize, periods: usize, amplitude: f64) -> Vec<f64> {
        let step = TAU * periods as f64 / points as f64;
        (0..points).map(|i| amplitude * (step * i as f64).sin()).collect()
    }

    #[test]
    fn five_heights_by_hand() {
        let p = RoughnessParameters::of(&scan(0.5, vec![1.0, -2.0, 3.0, -3.0, 1.0]), 0.0).unwrap();
        assert_eq!(p.mean_absolute_height, 2.0);
        assert_relative_eq!(p.rms_height, 4.8_f64.sqrt(), max_relative = 1e-15);
        assert_eq!((p.highest_peak, p.deepest_valley, p.total_height), (3.0, 3.0, 6.0));
        assert_relative_eq!(p.skewness, -1.2 / 4.8_f64.powf(1.5), max_relative = 1e-14);
        assert_relative_eq!(p.kurtosis, 36.0 / 4.8_f64.powi(2), max_relative = 1e-14);
        // Steps -3, 5, -6, 4: mean square 21.5.
        assert_relative_eq!(p.rms_slope, 21.5_f64.sqrt() / 0.5, max_relative = 1e-14);
    }

    #[test]
    fn a_sine_has_its_exact_moments_and_the_stated_slope_bias() {
        let (points, periods, amplitude, spacing) = (4096, 64, 2e-5, 1e-6);
        let p = RoughnessParameters::of(&scan(spacing, sine(points, periods, amplitude)), 0.0);
        let p = p.unwrap();
        // Round-off of sums over 4096 points.
        assert_relative_eq!(p.rms_height, amplitude / 2_f64.sqrt(), max_relative = 1e-13);
        assert_relative_eq!(p.kurtosis, 1.5, max_relative = 1e-13);
        let wavelength = spacing * (points / periods) as f64;
        let a = PI * spacing / wavelength;
        let exact = 2_f64.sqrt() * PI * amplitude / wavelength;
        // The open end of the scan lacks one of 4096 differences.
        assert_relative_eq!(p.rms_slope, exact * a.sin() / a, max_relative = 1.0 / points as f64);
    }

    #[test]
    fn missing_points_and_the_pairs_they_touch_are_left_out() {
        let gappy = scan(1.0, vec![5.0, f64::NAN, 1.0, 3.0, f64::NAN]);
        let p = RoughnessParameters::of(&gappy, 3.0).unwrap();
        assert_relative_eq!(p.mean_absolute_height, 4.0 / 3.0, max_relative = 1e-15);
        assert_eq!(p.rms_slope, 2.0);
    }

    #[test]
    fn a_depth_is_positive_below_the_mean_line_and_total_height_does_not_depend_on_the_line() {
        let of = |line| {
            let scan = scan(1.0, vec![1.0, -4.0, 2.0]);
            let p = RoughnessParameters::of(&scan, line).unwrap();
            (p.highest_peak, p.deepest_valley, p.total_height)
        };
        assert_eq!(of(0.0), (2.0, 4.0, 6.0));
        assert_eq!(of(3.0), (-1.0, 7.0, 6.0));
        // All of the scan lies above this line: no valley, but a ground 1 m above it.
        assert_eq!(of(-5.0), (7.0, -1.0, 6.0));
    }

    #[test]
    fn undefined_parameters_are_errors() {
        let of = |heights| RoughnessParameters::of(&scan(1.0, heights), 0.0).unwrap_err();
        assert!(matches!(of(vec![f64::NAN; 3]), ParameterError::NoHeights { points: 3, .. }));
        assert!(matches!(of(vec![]), ParameterError::NoHeights { points: 0, .. }));
        assert!(matches!(of(vec![0.0; 3]), ParameterError::Flat { .. }));
        assert!(matches!(of(vec![1.0, f64::NAN, 2.0]), ParameterError::NoNeighbours { .. }));
        assert_eq!(AverageRoughness::of(&[]), Err(ParameterError::NoScans));
    }

    #[test]
    fn the_average_carries_the_spread_of_each_parameter() {
        let of = |scale: f64| {
            RoughnessParameters::of(&scan(1.0, vec![scale, -scale, 2.0 * scale]), 0.0).unwrap()
        };
        let average = AverageRoughness::of(&[of(1.0), of(2.0), of(3.0)]).unwrap();
        assert_relative_eq!(average.total_height.mean, 6.0, max_relative = 1e-15);
        assert_relative_eq!(average.total_height.standard_deviation, 3.0, max_relative = 1e-15);
        assert!(average.skewness.standard_deviation < 1e-15);
    }
}
