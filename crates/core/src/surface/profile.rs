//! Profile parameters of ISO 21920-2 and ISO 4287 on a roughness profile, by section lengths.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Height discrimination of profile elements: share of Rz.
const HEIGHT_DISCRIMINATION: f64 = 0.1;
/// Spacing discrimination of profile elements: share of a section length.
const SPACING_DISCRIMINATION: f64 = 0.01;

/// The standard that says which parameters are means over the sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ProfileStandard {
    /// ISO 21920-2: Rp, Rv, Rz are means over sections, all others over the evaluation length.
    #[default]
    Iso21920,
    /// ISO 4287: all but Rt are means over the sampling lengths.
    Iso4287,
}

/// Profile parameters; lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileParameters {
    /// Ra, mean of `|z|`.
    pub ra: f64,
    /// Rq, root of the mean of `z²`.
    pub rq: f64,
    /// Rp, mean over the sections of the largest `z`.
    pub rp: f64,
    /// Rv, mean over the sections of the largest depth, positive as in the standards.
    pub rv: f64,
    /// Rz = Rp + Rv.
    pub rz: f64,
    /// Rt, largest minus smallest `z` of all sections.
    pub rt: f64,
    /// Rsk, skewness.
    pub rsk: f64,
    /// Rku, kurtosis.
    pub rku: f64,
    /// RSm, mean spacing of profile elements that exceed a tenth of Rz on either side of the mean
    /// line; none where no complete element was found.
    pub rsm: Option<f64>,
    /// Rdq, root mean square of the slope by the seven-point formula of the standards; none where
    /// no seven neighbours have heights.
    pub rdq: Option<f64>,
    /// Number of sections.
    pub sections: usize,
}

/// Moments of some heights.
struct Moments {
    ra: f64,
    rq: f64,
    rsk: f64,
    rku: f64,
}

/// Parameters of a roughness profile (mean line 0, NaN where missing) over its whole sections of
/// `section` points; points beyond the last one are left out. None where there is no whole section,
/// or a section without a height, or a profile that is flat.
pub fn profile_parameters(
    heights: &[f64],
    spacing: f64,
    section: usize,
    standard: ProfileStandard,
) -> Option<ProfileParameters> {
    let sections: Vec<&[f64]> = heights.chunks_exact(section.max(1)).collect();
    if sections.is_empty() || sections.iter().any(|z| z.iter().all(|z| z.is_nan())) {
        return None;
    }
    let whole = &heights[..sections.len() * section.max(1)];
    let largest = |z: &[f64]| z.iter().copied().fold(f64::NAN, f64::max);
    let deepest = |z: &[f64]| -z.iter().copied().fold(f64::NAN, f64::min);
    let over = |f: &dyn Fn(&[f64]) -> f64| {
        sections.iter().map(|z| f(z)).sum::<f64>() / sections.len() as f64
    };
    let (rp, rv) = (over(&largest), over(&deepest));
    let rz = rp + rv;
    let parts: &[&[f64]] = match standard {
        ProfileStandard::Iso21920 => &[whole],
        ProfileStandard::Iso4287 => &sections,
    };
    let moments: Vec<Moments> = parts.iter().map(|z| moments_of(z)).collect();
    let mean = |f: fn(&Moments) -> f64| moments.iter().map(f).sum::<f64>() / moments.len() as f64;
    let least_width = SPACING_DISCRIMINATION * section as f64;
    let spacing_of = |z: &&[f64]| element_spacing(z, HEIGHT_DISCRIMINATION * rz, least_width);
    let parameters = ProfileParameters {
        ra: mean(|m| m.ra),
        rq: mean(|m| m.rq),
        rp,
        rv,
        rz,
        rt: largest(whole) + deepest(whole),
        rsk: mean(|m| m.rsk),
        rku: mean(|m| m.rku),
        rsm: mean_of_some(parts.iter().map(spacing_of)).map(|points| points * spacing),
        rdq: mean_of_some(parts.iter().map(|z| rms_slope(z, spacing))),
        sections: sections.len(),
    };
    // A flat section has a skewness of 0 / 0.
    parameters.rsk.is_finite().then_some(parameters)
}

fn moments_of(heights: &[f64]) -> Moments {
    let valid = || heights.iter().filter(|z| !z.is_nan());
    let count = valid().count() as f64;
    let mean = |power: i32| valid().map(|z| z.powi(power)).sum::<f64>() / count;
    let rq = mean(2).sqrt();
    Moments {
        ra: valid().map(|z| z.abs()).sum::<f64>() / count,
        rq,
        rsk: mean(3) / rq.powi(3),
        rku: mean(4) / rq.powi(4),
    }
}

fn mean_of_some(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let (sum, count) = values.flatten().fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Mean distance, in spacings, of the upward crossings of the mean line between a valley below
/// `-height` and the next peak above `height`, each at least `width` spacings long. A gap breaks
/// the element that it lies in.
fn element_spacing(heights: &[f64], height: f64, width: f64) -> Option<f64> {
    let (mut in_valley, mut crossing, mut previous) = (false, None, None);
    let (mut start, mut sum, mut count) = (0, 0.0, 0_usize);
    for (i, &z) in heights.iter().enumerate() {
        if z.is_nan() {
            (in_valley, crossing, previous) = (false, None, None);
            continue;
        }
        let sign_changed = i > 0 && (heights[i - 1] < 0.0) != (z < 0.0);
        if sign_changed || i == 0 || heights[i - 1].is_nan() {
            start = i;
            if z >= 0.0 && i > 0 && heights[i - 1] < 0.0 {
                crossing = Some((i - 1) as f64 + heights[i - 1] / (heights[i - 1] - z));
            }
        }
        if ((i - start + 1) as f64) < width {
            continue;
        }
        if z < -height {
            in_valley = true;
        } else if z > height && in_valley {
            in_valley = false;
            if let (Some(before), Some(here)) = (previous, crossing) {
                sum += here - before;
                count += 1;
            }
            previous = crossing;
        }
    }
    (count > 0).then(|| sum / count as f64)
}

fn rms_slope(heights: &[f64], spacing: f64) -> Option<f64> {
    let slope = |z: &[f64]| {
        let odd = [z[4] - z[2], z[5] - z[1], z[6] - z[0]];
        (45.0 * odd[0] - 9.0 * odd[1] + odd[2]) / (60.0 * spacing)
    };
    // The point in the middle has no weight but must be there, too.
    let valid = heights.windows(7).filter(|z| z.iter().all(|z| !z.is_nan())).map(slope);
    let (sum, count) = valid.fold((0.0, 0_usize), |(sum, n), slope| (sum + slope * slope, n + 1));
    (count > 0).then(|| (sum / count as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn of(heights: &[f64], section: usize, standard: ProfileStandard) -> ProfileParameters {
        profile_parameters(heights, 0.5, section, standard).unwrap()
    }

    #[test]
    fn a_sine_has_its_exact_parameters_by_both_standards() {
        let a = TAU / 40.0;
        let heights: Vec<f64> = (0..4000).map(|i| 3.0 * (a * (f64::from(i) + 0.3)).sin()).collect();
        for standard in [ProfileStandard::Iso21920, ProfileStandard::Iso4287] {
            let p = of(&heights, 800, standard);
            assert_eq!(p.sections, 5);
            approx::assert_relative_eq!(p.rq, 3.0 / 2_f64.sqrt(), max_relative = 1e-12);
            approx::assert_relative_eq!(p.rku, 1.5, max_relative = 1e-12);
            approx::assert_abs_diff_eq!(p.rsk, 0.0, epsilon = 1e-12);
            // Crossings are all interpolated on the same chord of each wave: exact spacing.
            approx::assert_relative_eq!(p.rsm.unwrap(), 20.0, max_relative = 1e-12);
            let factor = (90.0 * a.sin() - 18.0 * (2.0 * a).sin() + 2.0 * (3.0 * a).sin()) / 60.0;
            let exact = 3.0 / 2_f64.sqrt() * factor / 0.5;
            // Six points of a section have no slope, less than 1 % of them.
            approx::assert_relative_eq!(p.rdq.unwrap(), exact, max_relative = 5e-3);
        }
    }

    #[test]
    fn a_sawtooth_has_its_exact_parameters() {
        // Heights -4.5 to 4.5 in ten steps: mean square 8.25, mean of absolute heights 2.5.
        let heights: Vec<f64> = (0..200).map(|i| f64::from(i % 10) - 4.5).collect();
        let p = of(&heights, 40, ProfileStandard::Iso21920);
        approx::assert_relative_eq!(p.ra, 2.5, max_relative = 1e-14);
        approx::assert_relative_eq!(p.rq, 8.25_f64.sqrt(), max_relative = 1e-14);
        assert_eq!((p.rp, p.rv, p.rz, p.rt), (4.5, 4.5, 9.0, 9.0));
        approx::assert_relative_eq!(p.rsm.unwrap(), 5.0, max_relative = 1e-14);
    }

    #[test]
    fn peaks_are_means_over_sections_and_the_total_height_is_not() {
        let mut heights = [1.0, -1.0].repeat(20);
        heights[10] = 5.0;
        heights[35] = -7.0;
        let p = of(&heights, 20, ProfileStandard::Iso4287);
        assert_eq!((p.rp, p.rv, p.rz, p.rt), (3.0, 4.0, 7.0, 12.0));
    }

    #[test]
    fn ripples_below_a_tenth_of_the_height_are_no_elements() {
        let ripple = |i: i32| if i % 2 == 0 { 0.3 } else { -0.3 };
        let wave = |i: i32| 5.0 * (TAU * f64::from(i) / 50.0).sin();
        let heights: Vec<f64> = (0..500).map(|i| wave(i) + ripple(i)).collect();
        let spacing = of(&heights, 500, ProfileStandard::Iso21920).rsm.unwrap();
        // 25 units; the ripple moves each of the crossings by less than a point, or 0.5 units.
        approx::assert_abs_diff_eq!(spacing, 25.0, epsilon = 0.1);
    }

    #[test]
    fn what_is_not_defined_is_none() {
        let parameters = |z: &[f64], n| profile_parameters(z, 1.0, n, ProfileStandard::Iso21920);
        assert_eq!(parameters(&[1.0, -1.0], 3), None);
        assert_eq!(parameters(&[0.0; 10], 5), None);
        assert_eq!(parameters(&[f64::NAN; 10], 5), None);
        assert_eq!(parameters(&[], 0), None);
        let short = parameters(&[1.0, -1.0, 1.0, f64::NAN], 4).unwrap();
        assert_eq!((short.rsm, short.rdq), (None, None));
    }
}
