//! Which approximate inverse preconditions a linear solve.
//!
//! The filter of the [`Preconditioner`] costs two pairs of transforms of the grid in each iteration and takes twenty
//! iterations or more than a hundred, the more the more loss the rubber has and the smaller the patches are. The factors
//! of the [`Inverse`] leave two or three iterations of one pair each, but take time and memory for each point in contact.
//! Small parts of the grid are factorised at once; others are tried with the filter for as long as the factors would
//! have taken, unless it is known to take longer.

use super::half_space::HalfSpace;
use super::inverse::Inverse;
use super::preconditioner::Preconditioner;

/// Iterations with the filter that cost as much as factors if all points of a grid are in contact: as measured from 2^14
/// to 2^16 points.
const WORTH: f64 = 150.0;
/// Iterations that the filter takes nearly always.
const FEWEST: f64 = 12.0;
/// Where the filter has failed it is tried again only for so many times as many iterations.
const PATIENCE: f64 = 1.5;
/// Most iterations with the filter, which keep as many vectors.
const MOST: usize = 120;
/// Points of the largest set that is factorised, at some 1500 bytes each.
const LARGEST: usize = 1 << 18;

/// An approximate inverse on a contact set.
pub(super) enum Approximate {
    /// By a filter, and forces between patches.
    Filter(Preconditioner),
    /// By factors of the matrix on the set.
    Factors(Box<Inverse>),
}

/// The inverses for the solves on one grid after another.
pub(super) struct Inverses {
    /// Factors on this grid, for sets that differ by few points.
    kept: Option<Box<Inverse>>,
    /// Iterations that the filter is known to exceed.
    fruitless: f64,
}

impl Default for Inverses {
    fn default() -> Self {
        Self { kept: None, fruitless: FEWEST }
    }
}

impl Approximate {
    pub fn filter(space: &mut HalfSpace, kernel: &[f64], set: &[u32]) -> Self {
        Self::Filter(Preconditioner::new(space, kernel, set))
    }

    /// Adds `force` (a sum over grid points) to the pressures on the set.
    pub fn add_force(&self, force: f64, pressure: &mut [f64]) {
        match self {
            Self::Filter(filter) => filter.add_force(force, pressure),
            Self::Factors(inverse) => inverse.add_force(force, pressure),
        }
    }

    /// Pressures (sum zero) for the displacements `r` on the set.
    pub fn apply(&self, space: &mut HalfSpace, set: &[u32], r: &[f64], pressure: &mut [f64]) {
        match self {
            Self::Filter(filter) => filter.apply(space, set, r, pressure),
            Self::Factors(inverse) => inverse.apply(r, pressure),
        }
    }
}

impl Inverses {
    /// The same for another grid: where the filter was slow it will be again.
    pub fn on_the_next_grid(self) -> Self {
        Self { kept: None, ..self }
    }

    /// Iterations that the filter may take for a set of `contact` points on a grid of `points`; `None` if the set is to
    /// be factorised at once.
    pub fn most_with_the_filter(&self, contact: usize, points: usize) -> Option<usize> {
        if contact > LARGEST {
            return Some(MOST);
        }
        let alike = WORTH * contact as f64 / points as f64;
        (alike > self.fruitless).then_some(MOST.min(alike as usize))
    }

    /// Notes that the filter has taken as many iterations without success; whether factors for the `contact` points are
    /// to follow.
    pub fn give_up_the_filter(&mut self, iterations: usize, contact: usize) -> bool {
        let known = if iterations < MOST { PATIENCE * iterations as f64 } else { f64::INFINITY };
        self.fruitless = self.fruitless.max(known);
        contact <= LARGEST
    }

    /// Factors for a set: the kept ones if it differs by few points from theirs. The kept ones are released first, so
    /// that there are never two.
    pub fn factors(&mut self, kernel: &[f64], set: &[u32]) -> Approximate {
        let kept = self.kept.take().and_then(|mut kept| kept.adapt(kernel, set).then_some(kept));
        Approximate::Factors(kept.unwrap_or_else(|| Box::new(Inverse::new(kernel, set))))
    }

    /// Keeps factors for the next set.
    pub fn keep(&mut self, inverse: Approximate) {
        if let Approximate::Factors(inverse) = inverse {
            self.kept = Some(inverse);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_sets_are_factorised_and_others_once_the_filter_has_taken_as_long() {
        let mut inverses = Inverses::default();
        assert_eq!(inverses.most_with_the_filter(1 << 12, 1 << 16), None);
        assert_eq!(inverses.most_with_the_filter(1 << 14, 1 << 16), Some(37));
        assert!(inverses.give_up_the_filter(37, 1 << 14));
        let mut inverses = inverses.on_the_next_grid();
        assert_eq!(inverses.most_with_the_filter(1 << 15, 1 << 17), None);
        // Factors of more points cost more: the filter has another chance, and then no more.
        assert_eq!(inverses.most_with_the_filter(1 << 17, 1 << 17), Some(MOST));
        assert!(inverses.give_up_the_filter(MOST, 1 << 17));
        assert_eq!(inverses.most_with_the_filter(1 << 17, 1 << 17), None);
        // Too large to factorise at any price.
        assert_eq!(inverses.most_with_the_filter(LARGEST + 1, 1 << 20), Some(MOST));
        assert!(!inverses.give_up_the_filter(MOST, LARGEST + 1));
    }
}
