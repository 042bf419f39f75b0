//! The block and its mesh.

use super::super::error::FemError;
use super::super::mesh::{Grading, Mesh};
use super::super::profile::RigidProfile;
use std::ops::RangeInclusive;

/// Growth of the rows at so many columns a wave, and the largest multiple of it at fewer.
const GROWTH: f64 = 0.2;
const COLUMNS_OF_GROWTH: f64 = 64.0;
const MOST_GROWTH: f64 = 2.0;
/// Columns from which on rows coarsen by default.
const MANY_COLUMNS: usize = 256;
/// Numbers of columns for which a contact can be set up.
pub const COLUMNS_RANGE: RangeInclusive<usize> = 8..=1 << 16;
/// Block heights, in periods, for which a contact can be set up.
pub const HEIGHT_RANGE: RangeInclusive<f64> = 0.1..=10.0;

/// The block and its mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockOptions {
    /// Elements over the period.
    pub columns: usize,
    /// Height of the block over the period.
    pub height_ratio: f64,
    /// Growth of the rows away from the contact.
    pub grading: Grading,
    /// Whether rows whose elements are higher than wide have half as many columns as those below.
    pub coarsening: bool,
    /// What holds the block from above.
    pub upper_edge: UpperEdge,
}

/// What holds the block from above; neither lets the edge move along x against itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UpperEdge {
    /// An even pressure: nodes move up and down each by itself. Traction is given.
    #[default]
    Pressure,
    /// A rigid plate that carries the mean pressure: nodes move up and down together. Displacement is given.
    Plate,
}

impl BlockOptions {
    /// The block of the thesis, of height 0.75 L, with square elements at the contact and rows that grow by a fifth.
    /// From 256 columns on rows coarsen, which changes friction by up to 0.1 % and saves more than half of the
    /// elements.
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            height_ratio: 0.75,
            grading: Grading { first: 1.0, growth: 1.0 + GROWTH },
            coarsening: columns >= MANY_COLUMNS,
            upper_edge: UpperEdge::Pressure,
        }
    }

    /// The same for a profile: the more columns its shortest wave has, the less rows grow, so that more columns refine
    /// the mesh at every depth. With one growth for all, friction converges to a value that is up to 0.2 % off.
    pub fn of_profile(columns: usize, profile: &RigidProfile) -> Self {
        let mut options = Self::new(columns);
        let per_wave = columns as f64 / profile.shortest_waves();
        options.grading.growth = 1.0 + GROWTH * (COLUMNS_OF_GROWTH / per_wave).min(MOST_GROWTH);
        options
    }

    /// The mesh of a block of one `period` in m, not skewed.
    pub fn mesh(&self, period: f64) -> Mesh {
        Mesh::graded(self.columns, period, self.height_ratio * period, self.grading)
    }

    /// Checks that every number is in range.
    ///
    /// # Errors
    /// [`FemError::OutOfRange`] for the first one that is not.
    pub fn check(&self, period: f64) -> Result<(), FemError> {
        let out_of_range =
            |quantity, value, range| Err(FemError::OutOfRange { quantity, value, range });
        if !(period > 0.0 && period.is_finite()) {
            return out_of_range("the period in m", period, "positive and finite");
        }
        if !COLUMNS_RANGE.contains(&self.columns) {
            return out_of_range("the number of columns", self.columns as f64, "8 to 65536");
        }
        if !HEIGHT_RANGE.contains(&self.height_ratio) {
            let height = self.height_ratio;
            return out_of_range("the height of the block in periods", height, "0.1 to 10");
        }
        let Grading { first, growth } = self.grading;
        if !(0.1..=10.0).contains(&first) {
            return out_of_range("the height of the first row in columns", first, "0.1 to 10");
        }
        if !(1.0..=3.0).contains(&growth) {
            return out_of_range("the growth of the rows", growth, "1 to 3");
        }
        Ok(())
    }
}
