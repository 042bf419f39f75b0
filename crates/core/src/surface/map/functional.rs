//! Functional parameters of a surface from its material ratio curve (Abbott and Firestone).
//!
//! The curve `c(p)` is the height in m above which the share `p` of the area lies: from the highest point at `p = 0` to
//! the lowest at `p = 1`. Of `n` heights in falling order the i-th (from 0) stands at `(i + 1/2) / n`; the curve is
//! straight in between and level beyond the first and the last, so that its integral is the mean height.
//!
//! Nothing here knows of areas: the heights of a profile give Rk, Rpk, Rvk, Mr1 and Mr2 of ISO 13565-2 in the same way.

use rayon::prelude::*;

/// Width of the central region of ISO 25178-2 and ISO 13565-2, share of the area.
const CENTRAL_REGION: f64 = 0.4;
/// Material ratio between peaks and core in volume parameters.
const PEAK_RATIO: f64 = 0.1;
/// Material ratio between core and valleys in volume parameters.
const VALLEY_RATIO: f64 = 0.8;

/// Parameters from the material ratio curve, ISO 25178-2; heights in m, volumes in m³/m², ratios as shares.
///
/// The equivalent line is the least-squares line, in height, through the 40 % of the points over which the curve falls
/// least (the first such region of equals).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FunctionalParameters {
    /// Sk, height of the core: fall of the equivalent line from `p = 0` to `p = 1`.
    pub sk: f64,
    /// Spk, height of the triangle on the base Smr1 with the area of the peaks above the core.
    pub spk: f64,
    /// Svk, height of the triangle on the base `1 - Smr2` with the area of the valleys below the core.
    pub svk: f64,
    /// Smr1, material ratio at the top of the core, share (the standard gives it in %).
    pub smr1: f64,
    /// Smr2, material ratio at the bottom of the core, share.
    pub smr2: f64,
    /// Vmp, material above the height of 10 % material ratio, m³/m².
    pub vmp: f64,
    /// Vmc, material between the heights of 10 % and 80 %.
    pub vmc: f64,
    /// Vvc, void between the heights of 10 % and 80 %.
    pub vvc: f64,
    /// Vvv, void below the height of 80 %.
    pub vvv: f64,
}

/// Material ratio curve of some heights.
#[derive(Debug, Clone, PartialEq)]
pub struct AbbottCurve {
    /// Heights in m, falling.
    heights: Vec<f64>,
}

impl AbbottCurve {
    /// Curve of heights in m, in any order; missing ones (NaN) do not count. None without heights.
    pub fn of(mut heights: Vec<f64>) -> Option<Self> {
        heights.retain(|z| !z.is_nan());
        heights.par_sort_unstable_by(|a, b| b.total_cmp(a));
        (!heights.is_empty()).then_some(Self { heights })
    }

    /// Height in m at a material ratio from 0 to 1.
    pub fn height(&self, ratio: f64) -> f64 {
        let (i, rest) = self.position(ratio);
        let next = self.heights[(i + 1).min(self.heights.len() - 1)];
        self.heights[i] + rest * (next - self.heights[i])
    }

    /// Material ratio at a height: 0 above all points, 1 below all; of a level part that of its upper end.
    pub fn ratio(&self, height: f64) -> f64 {
        self.ratio_after(self.heights.partition_point(|&z| z > height), height)
    }

    /// Material ratio at a height between the points before and after a number of them.
    fn ratio_after(&self, above: usize, height: f64) -> f64 {
        if above == 0 {
            return 0.0;
        }
        let Some(next) = self.heights.get(above) else { return 1.0 };
        let last = self.heights[above - 1];
        ((above - 1) as f64 + (last - height) / (last - next) + 0.5) / self.heights.len() as f64
    }

    /// Material in m³/m² above the height at a material ratio.
    pub fn material_volume(&self, ratio: f64) -> f64 {
        self.integral(ratio) - ratio * self.height(ratio)
    }

    /// Void in m³/m² below the height at a material ratio.
    pub fn void_volume(&self, ratio: f64) -> f64 {
        (1.0 - ratio) * self.height(ratio) - (self.integral(1.0) - self.integral(ratio))
    }

    /// Parameters of the curve; none for fewer than four heights.
    pub fn parameters(&self) -> Option<FunctionalParameters> {
        let [top, bottom] = self.core()?;
        let smr1 = self.ratio(top);
        // A level part belongs to the core: its lower end.
        let smr2 = self.ratio_after(self.heights.partition_point(|&z| z >= bottom), bottom);
        let peaks = self.integral(smr1) - smr1 * top;
        let valleys = (1.0 - smr2) * bottom - (self.integral(1.0) - self.integral(smr2));
        let triangle = |area: f64, base: f64| if base > 0.0 { 2.0 * area / base } else { 0.0 };
        let [material, void] = [Self::material_volume, Self::void_volume]
            .map(|volume| [PEAK_RATIO, VALLEY_RATIO].map(|ratio| volume(self, ratio)));
        Some(FunctionalParameters {
            sk: top - bottom,
            spk: triangle(peaks, smr1).max(0.0),
            svk: triangle(valleys, 1.0 - smr2).max(0.0),
            smr1,
            smr2,
            vmp: material[0],
            vmc: material[1] - material[0],
            vvc: void[0] - void[1],
            vvv: void[1],
        })
    }

    /// Heights of the equivalent line at the material ratios 0 and 1.
    fn core(&self) -> Option<[f64; 2]> {
        let count = self.heights.len();
        let width = (CENTRAL_REGION * count as f64).round() as usize;
        if width < 2 {
            return None;
        }
        let lows = self.heights[width - 1..].iter();
        let (mut start, mut least) = (0, f64::INFINITY);
        for (i, fall) in self.heights.iter().zip(lows).map(|(high, low)| high - low).enumerate() {
            if fall < least {
                (start, least) = (i, fall);
            }
        }
        let region = &self.heights[start..start + width];
        if least == 0.0 {
            // Of a level region the mean would be off by round-off, on either side of all its points.
            return Some([region[0]; 2]);
        }
        let middle = (width - 1) as f64 / 2.0;
        let mean = region.iter().sum::<f64>() / width as f64;
        let (mut products, mut squares) = (0.0, 0.0);
        for (i, z) in region.iter().enumerate() {
            let x = i as f64 - middle;
            products += x * (z - mean);
            squares += x * x;
        }
        let slope = products / squares;
        let at = |ratio: f64| mean + slope * (ratio * count as f64 - 0.5 - start as f64 - middle);
        Some([at(0.0), at(1.0)])
    }

    /// Integral of the curve from 0 to a ratio, in m.
    fn integral(&self, ratio: f64) -> f64 {
        let (count, first) = (self.heights.len() as f64, self.heights[0]);
        if ratio * count <= 0.5 {
            return ratio * first;
        }
        let (i, rest) = self.position(ratio);
        let half = f64::midpoint(self.height(ratio), self.heights[i]);
        (self.heights[..=i].iter().sum::<f64>() - self.heights[i] / 2.0 + rest * half) / count
    }

    /// The point before a ratio and the distance from it in points.
    fn position(&self, ratio: f64) -> (usize, f64) {
        let x = (ratio * self.heights.len() as f64 - 0.5).max(0.0);
        let i = (x.floor() as usize).min(self.heights.len() - 1);
        (i, x - i as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Heights of the curve `c(p)`, in an order that is not sorted.
    fn curve(points: usize, c: impl Fn(f64) -> f64) -> AbbottCurve {
        let at = |i: usize| c(((i * 7919) % points) as f64 / points as f64 + 0.5 / points as f64);
        AbbottCurve::of((0..points).map(at).collect()).unwrap()
    }

    #[test]
    fn a_plane_is_all_core_and_has_parabolic_volumes() {
        // c(p) = 2 - 4 p: Vm(p) = 2 p^2, Vv(p) = 2 (1 - p)^2.
        let p = curve(10_000, |p| 2.0 - 4.0 * p).parameters().unwrap();
        assert_relative_eq!(p.sk, 4.0, max_relative = 1e-12);
        assert_eq!((p.spk, p.svk, p.smr1, p.smr2), (0.0, 0.0, 0.0, 1.0));
        // The flat ends of half a point cost 1/(2 n)^2 of the volumes.
        assert_relative_eq!(p.vmp, 0.02, epsilon = 1e-7);
        assert_relative_eq!(p.vmc, 1.28 - 0.02, epsilon = 1e-7);
        assert_relative_eq!(p.vvv, 0.08, epsilon = 1e-7);
        assert_relative_eq!(p.vvc, 1.62 - 0.08, epsilon = 1e-7);
    }

    #[test]
    fn a_core_with_peaks_and_valleys_cut_from_planes_has_its_exact_parameters() {
        // Core 1 - 2 p between 0.15 and 0.75; above it a slope of -20, below it one of -10.
        let c = |p: f64| 1.0 - 2.0 * p + 18.0 * (0.15 - p).max(0.0) - 8.0 * (p - 0.75).max(0.0);
        let p = curve(100_000, c).parameters().unwrap();
        assert_relative_eq!(p.sk, 2.0, max_relative = 1e-9);
        // The top 1 of the core: 1 - 2 p + 18 (0.15 - p) = 1 at p = 0.135; bottom -1: 2 (1 - p) = 8 (p - 0.75).
        assert_relative_eq!(p.smr1, 0.135, max_relative = 1e-9);
        assert_relative_eq!(p.smr2, 0.8, max_relative = 1e-9);
        // The area above the core is a triangle, and so is that below: 1 to 3.7, and -1 to -3.
        assert_relative_eq!(p.spk, 2.7, max_relative = 1e-5);
        assert_relative_eq!(p.svk, 2.0, max_relative = 1e-5);
        // Vmp: slope 20 over 0.1; Vvv: slope 10 over 0.2.
        assert_relative_eq!(p.vmp, 0.1, max_relative = 1e-5);
        assert_relative_eq!(p.vvv, 0.2, max_relative = 1e-5);
        // Integral of c from 0.1 to 0.8, term by term.
        let middle = 1.0 * 0.7 - (0.64 - 0.01) + 9.0 * 0.05_f64.powi(2) - 4.0 * 0.05_f64.powi(2);
        let (high, low) = (c(0.1), c(0.8));
        assert_relative_eq!(p.vmc, 0.1 * high + middle - 0.8 * low, max_relative = 1e-5);
        assert_relative_eq!(p.vvc, 0.9 * high - middle - 0.2 * low, max_relative = 1e-5);
    }

    #[test]
    fn heights_and_ratios_invert_each_other_and_the_integral_is_the_mean() {
        let curve = curve(101, |p| (1.0 - p).powi(3));
        for ratio in [0.01, 0.1, 0.5, 0.77, 0.99] {
            assert_relative_eq!(curve.ratio(curve.height(ratio)), ratio, max_relative = 1e-12);
        }
        let mean = curve.heights.iter().sum::<f64>() / 101.0;
        assert_relative_eq!(curve.integral(1.0), mean, max_relative = 1e-14);
        assert_eq!((curve.ratio(2.0), curve.ratio(-1.0)), (0.0, 1.0));
    }

    #[test]
    fn missing_heights_do_not_count_and_few_have_no_core() {
        let all: Vec<f64> = (0..50).map(|i| f64::from(i).sqrt()).collect();
        let mut gappy = vec![f64::NAN; 9];
        gappy.extend(&all);
        let parameters = |z| AbbottCurve::of(z).unwrap().parameters();
        assert_eq!(parameters(all), parameters(gappy));
        assert_eq!(AbbottCurve::of(vec![f64::NAN]), None);
        assert_eq!(parameters(vec![1.0, 2.0]), None);
    }
}
