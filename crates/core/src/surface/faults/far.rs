//! Heights so far from all others that no road has them.

use crate::surface::resample::Grid;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statrs::statistics::{Data, OrderStatistics};

/// Interquartile ranges outside the quartiles of the scan from which a height is far. The deepest
/// pores of real and synthetic asphalt are at one to three; the reference plates of the CAPTIF
/// profilometer, 50 mm above the road, at twelve.
const RANGES: f64 = 10.0;

/// Heights that lie further than ten interquartile ranges outside the quartiles of their scan:
/// a plate, a mark of missing points, a wrong column.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FarHeights {
    /// Number of cells.
    pub count: usize,
    /// Position of the first on the track in millimetres.
    pub first_mm: f64,
    /// Position of the last on the track in millimetres.
    pub last_mm: f64,
}

impl FarHeights {
    /// Which of the heights are far; none of a scan whose quartiles are equal.
    pub fn cells(heights: &[f64]) -> Vec<bool> {
        let valid: Vec<f64> = heights.iter().copied().filter(|z| !z.is_nan()).collect();
        if valid.is_empty() {
            return vec![false; heights.len()];
        }
        let mut valid = Data::new(valid);
        let (lower, upper) = (valid.lower_quartile(), valid.upper_quartile());
        let reach = RANGES * (upper - lower);
        let is_far = |z: &f64| reach > 0.0 && (*z < lower - reach || *z > upper + reach);
        heights.iter().map(is_far).collect()
    }

    /// What the far ones among the cells of a grid are, ascending; `None` for none.
    pub fn new(grid: &Grid, cells: impl Iterator<Item = usize>) -> Option<Self> {
        let position_mm = |cell: usize| (grid.origin + cell as f64 * grid.spacing) * 1e3;
        cells.fold(None, |found: Option<Self>, cell| {
            let (first_mm, count) =
                found.map_or((position_mm(cell), 1), |found| (found.first_mm, found.count + 1));
            Some(Self { count, first_mm, last_mm: position_mm(cell) })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_is_far_and_a_deep_pore_is_not() {
        let mut heights: Vec<f64> = (0..1001).map(|i| f64::from(i % 101) / 100.0).collect();
        heights[3] = f64::NAN;
        assert!(FarHeights::cells(&heights).iter().all(|far| !far));
        // Quartiles 0.25 and 0.75: ten ranges end at -4.75 and 5.75.
        (heights[10], heights[11], heights[12], heights[700]) = (-4.7, 5.7, 5.8, -4.8);
        let far = FarHeights::cells(&heights);
        let cells: Vec<usize> = (0..far.len()).filter(|&i| far[i]).collect();
        assert_eq!(cells, [12, 700]);
        let grid = Grid { origin: 1.0, spacing: 1e-3, heights };
        let found = FarHeights::new(&grid, cells.into_iter()).unwrap();
        assert_eq!(found.count, 2);
        // Sums of a few decimal fractions.
        approx::assert_relative_eq!(found.first_mm, 1012.0, max_relative = 1e-12);
        approx::assert_relative_eq!(found.last_mm, 1700.0, max_relative = 1e-12);
        assert_eq!(FarHeights::new(&grid, std::iter::empty()), None);
    }

    #[test]
    fn scans_without_spread_or_heights_have_none() {
        assert_eq!(FarHeights::cells(&[1.0, 1.0, 1.0, 1.0, 9.0]), [false; 5]);
        assert_eq!(FarHeights::cells(&[f64::NAN; 2]), [false; 2]);
    }
}
