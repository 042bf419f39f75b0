//! The stones of a rolled road: flat faces at a common level, deep pits between them.
//!
//! A line across rolled asphalt meets stone after stone. The roller has pressed their faces to one level; what is
//! left between two of them is a pit, as deep as the binder left it. Along the line the pits follow each
//! other at random distances about the size of a stone, and the face between two pits falls off towards
//! either as a power of the distance u from its middle (u = ±1 at the pits):
//!
//! ```text
//! z(u) = m/(n + 1) - D |u|^n        D the depth of the pit on that side, m the mean depth
//! ```
//!
//! so the mean is zero. Distances and depths are independent Erlang numbers of shape 9, which have a coefficient
//! of variation of 1/3: stones do not overlap, and no pit is alone for long. u is uniform along the line,
//! so the moments of the heights are known in closed form: `E (D |u|^n)^j = E D^j / (n j + 1)`.
//!
//! Both the asymmetry of the heights and the order of the pits are in the phases of the profile: a
//! surface of the same spectrum with random phases has neither.

use super::parameters::Stones;
use super::random::erlang;
use super::translation::Cumulants;
use rand::Rng;

/// Shape of the laws of distances and depths: coefficient of variation 1/3.
const SHAPE: u32 = 9;

impl Stones {
    /// Heights in metres on a ring of `points` points, `step` metres apart.
    ///
    /// The number of stones is the nearest to the mean distance, and their distances are scaled to
    /// fill the ring; where the first begins is random.
    pub(super) fn heights(&self, points: usize, step: f64, rng: &mut impl Rng) -> Vec<f64> {
        let period = points as f64 * step;
        let count = (period / self.mean_distance).round().max(1.0) as usize;
        let mut draw = || -> Vec<f64> { (0..count).map(|_| erlang(SHAPE, rng)).collect() };
        let (distances, depths) = (draw(), draw());
        let scale = points as f64 / distances.iter().sum::<f64>();
        let origin = (super::random::uniform(rng) * points as f64) as usize;
        let level = self.mean_depth / (self.flatness + 1.0);
        let mut heights = vec![0.0; points];
        let (mut stone, mut start, mut end) = (0, 0.0, distances[0] * scale);
        for i in 0..points {
            while i as f64 > end && stone + 1 < count {
                stone += 1;
                start = end;
                end += distances[stone] * scale;
            }
            let half = 0.5 * (end - start);
            let from_middle = (i as f64 - start - half) / half;
            let pit = if from_middle < 0.0 { stone } else { (stone + 1) % count };
            let depth = self.mean_depth * depths[pit];
            heights[(origin + i) % points] = level - depth * from_middle.abs().powf(self.flatness);
        }
        heights
    }

    /// Cumulants of the heights, in powers of metres.
    pub(super) fn cumulants(&self) -> Cumulants {
        let shape = f64::from(SHAPE);
        let mut power = 1.0;
        let mut raw = |j: u32| {
            // E D^j of the Erlang law, one factor after the other.
            power *= self.mean_depth * (shape + f64::from(j - 1)) / shape;
            power / (self.flatness * f64::from(j) + 1.0)
        };
        // Of the depth below the faces, which is -z up to the level.
        let [a, b, c, d] = [1, 2, 3, 4].map(&mut raw);
        Cumulants {
            second: b - a * a,
            third: -(c - 3.0 * a * b + 2.0 * a.powi(3)),
            fourth: d - 4.0 * a * c - 3.0 * b * b + 12.0 * a * a * b - 6.0 * a.powi(4),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg64;

    fn stones() -> Stones {
        Stones { mean_distance: 8e-3, mean_depth: 2e-3, flatness: 4.0 }
    }

    #[test]
    fn faces_are_level_and_pits_lie_between_them() {
        let (points, step) = (20_000, 20e-6);
        let heights = stones().heights(points, step, &mut Pcg64::new(1, 2));
        let level = 2e-3 / 5.0;
        assert!(heights.iter().all(|z| *z <= level));
        // |u| < (1/10)^(1/4) of a face lies within a tenth of the depth of its pit: 56 %.
        let flat = heights.iter().filter(|z| **z > level - 0.2e-3).count();
        assert!((0.5..0.62).contains(&(flat as f64 / points as f64)), "{flat}");
        // One lowest point per stone, 400 mm / 8 mm; the ring closes.
        let lowest = |i: usize| {
            let z = |shift: usize| heights[(i + shift) % points];
            z(1) < z(0) && z(1) <= z(2)
        };
        assert_eq!((0..points).filter(|&i| lowest(i)).count(), 50);
    }

    #[test]
    fn cumulants_are_those_of_the_heights() {
        let expected = stones().cumulants();
        let mut rng = Pcg64::new(5, 6);
        // 20 000 stones: a standard error of the fourth cumulant of some 2 %.
        let heights = stones().heights(4_000_000, 40e-6, &mut rng);
        let moment =
            |power: i32| heights.iter().map(|z| z.powi(power)).sum::<f64>() / heights.len() as f64;
        // The mean is zero but for the draw of the depths, whose standard error is 1/3/sqrt(20 000).
        assert!(moment(1).abs() < 4.0 * 0.4e-3 / 424.0);
        let (second, third, fourth) = (moment(2), moment(3), moment(4));
        assert!((second / expected.second - 1.0).abs() < 0.03);
        assert!((third / expected.third - 1.0).abs() < 0.06);
        let found = fourth - 3.0 * second * second;
        assert!((found / expected.fourth - 1.0).abs() < 0.1);
    }

    #[test]
    fn a_single_stone_fills_the_ring() {
        let lone = Stones { mean_distance: 1.0, ..stones() };
        let heights = lone.heights(100, 1e-5, &mut Pcg64::new(1, 1));
        assert!(heights.iter().all(|z| z.is_finite()));
    }
}
