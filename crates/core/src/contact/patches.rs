//! Contact patches: runs of neighbouring contact points.

/// Runs of neighbouring contact points on a periodic grid.
pub(super) struct Patches {
    /// Patch of each contact point, in the order of the contact set.
    pub of_point: Vec<u32>,
    /// Number of patches.
    pub count: usize,
    /// Whether the first patch reaches over the end of the grid.
    wraps: bool,
}

impl Patches {
    /// Patches of an ascending list of grid points out of `points`.
    pub fn new(set: &[u32], points: usize) -> Self {
        let mut of_point = Vec::with_capacity(set.len());
        let mut patch = 0;
        for (j, i) in set.iter().enumerate() {
            if j > 0 && *i != set[j - 1] + 1 {
                patch += 1;
            }
            of_point.push(patch);
        }
        let mut count = if set.is_empty() { 0 } else { patch as usize + 1 };
        let touches_both_ends =
            set.first() == Some(&0) && set.last().is_some_and(|i| *i as usize + 1 == points);
        let wraps = count > 1 && touches_both_ends;
        if wraps {
            for id in of_point.iter_mut().rev().take_while(|id| **id == patch) {
                *id = 0;
            }
            count -= 1;
        }
        Self { of_point, count, wraps }
    }

    /// Sums of `values` (one for each contact point) over each patch.
    pub fn sums(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        for (id, value) in self.of_point.iter().zip(values) {
            sums[*id as usize] += value;
        }
        sums
    }

    /// Centre of each patch in grid steps under `weights` that sum to one on each patch.
    pub fn centres(&self, set: &[u32], points: usize, weights: &[f64]) -> Vec<f64> {
        let unwrapped = set.iter().zip(&self.of_point).map(|(i, id)| {
            let beyond = self.wraps && *id == 0 && 2 * *i as usize > points;
            f64::from(*i) - if beyond { points as f64 } else { 0.0 }
        });
        self.sums(unwrapped.zip(weights).map(|(x, weight)| x * weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_found_across_the_end_of_the_grid() {
        let set = [0, 1, 4, 5, 6, 9];
        let patches = Patches::new(&set, 10);
        assert_eq!(patches.of_point, [0, 0, 1, 1, 1, 0]);
        assert_eq!(patches.count, 2);
        let third = 1.0 / 3.0;
        let centres = patches.centres(&set, 10, &[third; 6]);
        approx::assert_abs_diff_eq!(centres[0], 0.0, epsilon = 1e-14);
        approx::assert_abs_diff_eq!(centres[1], 5.0, epsilon = 1e-14);
    }

    #[test]
    fn all_points_or_none_are_one_patch_or_none() {
        assert_eq!(Patches::new(&[0, 1, 2], 3).count, 1);
        assert_eq!(Patches::new(&[], 3).count, 0);
    }
}
