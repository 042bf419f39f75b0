//! From measured positions to equal spacing, without interpolation.

use crate::numerics::statistics::least_squares_line;
use crate::surface::RawScan;
use statrs::statistics::{Data, OrderStatistics};

/// The points of a scan in cells of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Centre of the first cell on the track, in metres.
    pub origin: f64,
    /// Width of a cell, in metres.
    pub spacing: f64,
    /// Height of each cell in metres; NaN where missing.
    pub heights: Vec<f64>,
}

/// How the measured positions lie on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridFit {
    /// Largest distance of a point from the centre of its cell, in metres.
    pub largest_deviation: f64,
    /// Points beyond the first in a cell; their heights are averaged.
    pub points_sharing: usize,
    /// Cells between the first and the last point that hold no point.
    pub empty_cells: usize,
}

/// Positions that make no grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Fewer than two points, or positions that do not grow.
    #[error("a scan needs two points or more, and positions that grow from point to point")]
    Positions,
    /// Nine tenths of the track hold no point.
    #[error(
        "{points} points {spacing_mm} mm apart on a track of {length_mm} mm leave nine tenths of it empty; \
         check the unit of the positions, or split the file into its tracks"
    )]
    Sparse {
        /// Points of the scan.
        points: usize,
        /// Their median distance in mm.
        spacing_mm: f64,
        /// Length of the track in mm.
        length_mm: f64,
    },
}

/// Puts each point of a scan into the nearest cell of the equidistant grid that fits its positions
/// best. Gaps between positions become missing cells; the mean of the valid heights counts where
/// points share a cell.
///
/// The spacing is not the median step itself: positions printed with three decimals, such as
/// 0.037, 0.075, 0.112 mm, have a median step 1.3 % short of the true one, 25 mm over 1.9 m.
///
/// # Errors
/// [`GridError`] when the positions do not grow or leave most of the track empty.
pub fn place_on_grid(scan: &RawScan) -> Result<(Grid, GridFit), GridError> {
    let positions = &scan.positions;
    let grows = positions.windows(2).all(|pair| pair[0] < pair[1]);
    if positions.len() < 2 || !grows || positions.len() != scan.heights.len() {
        return Err(GridError::Positions);
    }
    let (origin, spacing) = fit_grid(positions);
    let cell_of = |position: f64| ((position - origin) / spacing).round();
    let first = cell_of(positions[0]);
    let cells = cell_of(positions[positions.len() - 1]) - first + 1.0;
    if cells > 10.0 * positions.len() as f64 {
        let length_mm = (positions[positions.len() - 1] - positions[0]) * 1e3;
        return Err(GridError::Sparse {
            points: positions.len(),
            spacing_mm: spacing * 1e3,
            length_mm,
        });
    }
    let cells = cells as usize;
    let origin = origin + first * spacing;

    let mut sums = vec![0.0; cells];
    let mut valid = vec![0_u32; cells];
    let mut occupied = 0;
    let mut previous = None;
    let mut largest_deviation = 0.0_f64;
    for (&position, &height) in positions.iter().zip(&scan.heights) {
        let cell = (((position - origin) / spacing).round() as usize).min(cells - 1);
        largest_deviation =
            largest_deviation.max((position - origin - cell as f64 * spacing).abs());
        occupied += usize::from(previous != Some(cell));
        previous = Some(cell);
        if !height.is_nan() {
            sums[cell] += height;
            valid[cell] += 1;
        }
    }
    // An empty cell is 0 / 0, which is the NaN that marks it as missing.
    let heights = sums.iter().zip(&valid).map(|(sum, &count)| sum / f64::from(count)).collect();
    let points_sharing = positions.len() - occupied;
    let fit = GridFit { largest_deviation, points_sharing, empty_cells: cells - occupied };
    Ok((Grid { origin, spacing, heights }, fit))
}

/// Origin and spacing of the grid by least squares of the positions over their counted steps.
fn fit_grid(positions: &[f64]) -> (f64, f64) {
    // Without absent points the count of a position is its index in the list.
    let (origin, spacing) =
        least_squares_line((0..positions.len()).map(|i| i as f64), positions.iter().copied());
    let on_grid = |(i, &position): (usize, &f64)| {
        (position - origin - i as f64 * spacing).abs() <= 0.5 * spacing
    };
    if positions.iter().enumerate().all(on_grid) {
        return (origin, spacing);
    }
    let steps: Vec<f64> = positions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let median = Data::new(steps.clone()).median();
    let regular = |step: &f64| (0.5 * median..1.5 * median).contains(step);
    // The mean over steps without a gap averages the rounding of printed positions away.
    let (sum, count) = steps
        .iter()
        .filter(|step| regular(step))
        .fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
    let single = if count > 0.0 { sum / count } else { median };
    // Steps too short to count by themselves add up until they do.
    let counts = positions.iter().scan((0.0, positions[0]), |(count, counted), &position| {
        let steps = ((position - *counted) / single).round();
        if steps > 0.0 {
            *count += steps;
            *counted = position;
        }
        Some(*count)
    });
    least_squares_line(counts, positions.iter().copied())
}

/// Number of neighbouring points to average for a spacing of at most `target` metres: the whole
/// number of raw steps in it, at least 1, so that no scan is ever made denser than it was measured.
pub fn points_per_cell(raw_spacing: f64, target: f64) -> usize {
    // A spacing fitted to printed positions may miss a round ratio by round-off.
    const ROUNDING: f64 = 1e-3;
    ((target / raw_spacing * (1.0 + ROUNDING)).floor() as usize).max(1)
}

/// Mean of the valid heights in each run of `points` neighbouring ones. A cell with fewer than half
/// of its heights valid is missing; points beyond the last whole cell are left out.
///
/// White noise loses its variance as `1 / points`, the longer waves of the surface remain.
pub fn block_means(grid: &Grid, points: usize) -> Grid {
    let mean = |block: &[f64]| {
        let valid = block.iter().filter(|height| !height.is_nan());
        let count = valid.clone().count();
        if 2 * count < points { f64::NAN } else { valid.sum::<f64>() / count as f64 }
    };
    Grid {
        origin: grid.origin + 0.5 * (points - 1) as f64 * grid.spacing,
        spacing: grid.spacing * points as f64,
        heights: grid.heights.chunks_exact(points).map(mean).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scan(positions: Vec<f64>) -> RawScan {
        let heights = (0..positions.len()).map(|i| i as f64).collect();
        RawScan { name: "a".into(), positions, heights }
    }

    #[test]
    fn positions_rounded_to_three_decimals_keep_their_true_spacing() {
        let positions = (0..50_000).map(|i| (f64::from(i) * 37.489).floor() / 1e6).collect();
        let (grid, fit) = place_on_grid(&scan(positions)).unwrap();
        assert_eq!((fit.points_sharing, fit.empty_cells), (0, 0));
        assert_eq!(grid.heights.len(), 50_000);
        // Rounding down errs by 1 um at most, over 50000 steps.
        approx::assert_abs_diff_eq!(grid.spacing, 37.489e-6, epsilon = 1e-6 / 5e4);
        assert!(fit.largest_deviation < 1e-6);
    }

    #[test]
    fn gaps_in_the_positions_become_missing_cells() {
        let indices = [0, 1, 2, 5, 6, 7, 8, 20, 21, 22];
        let positions = indices.iter().map(|&i| 3.0 + f64::from(i) * 0.25).collect();
        let (grid, fit) = place_on_grid(&scan(positions)).unwrap();
        assert_eq!((grid.origin, grid.spacing, fit.empty_cells), (3.0, 0.25, 13));
        for (cell, height) in grid.heights.iter().enumerate() {
            match indices.iter().position(|&i| i == cell as i32) {
                Some(point) => assert_eq!(*height, point as f64),
                None => assert!(height.is_nan()),
            }
        }
    }

    #[test]
    fn points_that_share_a_cell_are_averaged() {
        let extra = [39.3, 39.6];
        let positions = (0..40).map(f64::from).chain(extra).chain((40..80).map(f64::from));
        let (grid, fit) = place_on_grid(&scan(positions.collect())).unwrap();
        assert_eq!((fit.points_sharing, fit.empty_cells), (2, 0));
        assert_eq!(grid.heights.len(), 80);
        // Points 39 to 42 lie at 39, 39.3, 39.6 and 40.
        assert_eq!(grid.heights[38..42], [38.0, 39.5, 41.5, 43.0]);
    }

    #[test]
    fn positions_that_make_no_grid_are_refused() {
        let sparse = (0..20).map(f64::from).chain([1e9]).collect();
        assert!(matches!(place_on_grid(&scan(sparse)), Err(GridError::Sparse { points: 21, .. })));
        for positions in [vec![], vec![1.0], vec![1.0, 1.0], vec![1.0, f64::NAN, 2.0]] {
            assert_eq!(place_on_grid(&scan(positions)), Err(GridError::Positions));
        }
    }

    proptest! {
        /// Jitter of a fifth of a step with gaps; without, close to half a step less what the fit
        /// of 200 points leaves open.
        #[test]
        fn jitter_within_a_cell_keeps_every_point_in_its_own(
            jitter in prop::collection::vec(-0.2..0.2_f64, 200),
            gap in 0..15_usize,
        ) {
            let scale = if gap == 0 { 1.8 } else { 1.0 };
            let index = |i: usize| if i < 100 { i } else { i + gap };
            let positions = (0..200).map(|i| index(i) as f64 + scale * jitter[i]).collect();
            let (grid, fit) = place_on_grid(&scan(positions)).unwrap();
            prop_assert!((fit.points_sharing, fit.empty_cells) == (0, gap), "{fit:?}");
            for i in 0..200 {
                prop_assert_eq!(grid.heights[index(i)], i as f64);
            }
        }

        #[test]
        fn block_means_are_the_means_of_their_valid_points(
            heights in prop::collection::vec(prop_oneof![3 => -1.0..1.0_f64, 1 => Just(f64::NAN)], 30..80),
            points in 1..9_usize,
        ) {
            let grid = Grid { origin: 1.0, spacing: 0.5, heights };
            let means = block_means(&grid, points);
            prop_assert_eq!(means.heights.len(), grid.heights.len() / points);
            prop_assert_eq!(means.spacing, 0.5 * points as f64);
            for (cell, mean) in means.heights.iter().enumerate() {
                let mut valid = vec![];
                for i in cell * points..(cell + 1) * points {
                    if !grid.heights[i].is_nan() { valid.push(grid.heights[i]); }
                }
                if 2 * valid.len() < points {
                    prop_assert!(mean.is_nan());
                } else {
                    // Sums of up to eight numbers below 1 in one order: equal to round-off.
                    prop_assert!((mean - valid.iter().sum::<f64>() / valid.len() as f64).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn a_cell_lies_in_the_middle_of_its_points() {
        let grid =
            Grid { origin: 2.0, spacing: 0.1, heights: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 9.0] };
        let means = block_means(&grid, 3);
        assert_eq!(means.heights, [2.0, 5.0]);
        approx::assert_abs_diff_eq!(means.origin, 2.1, epsilon = 1e-15);
    }

    #[test]
    fn the_grid_is_never_denser_than_asked_for_nor_than_measured() {
        assert_eq!(points_per_cell(0.1e-6, 25e-6), 250);
        assert_eq!(points_per_cell(0.1000001e-6, 25e-6), 250);
        assert_eq!(points_per_cell(10e-6, 25e-6), 2);
        assert_eq!(points_per_cell(37.5e-6, 25e-6), 1);
    }
}
