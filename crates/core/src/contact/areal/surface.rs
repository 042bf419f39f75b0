//! The rigid surface on its grid.

use super::super::ContactError;
use super::super::sliding::remove_mean;

/// Fewest points along each direction.
pub(super) const FEWEST_POINTS: usize = 2;
/// Most points in all: their indices fit 32 bits.
pub(super) const MOST_POINTS: usize = 1 << 31;

/// Heights of one period of a surface that is periodic in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArealSurface<'a> {
    /// Heights in m, growing towards the rubber, row by row: that of the point `(i, j)` at `x = i period_x / nx`,
    /// `y = j period_y / ny` is `heights[j * nx + i]`. Their mean does not matter.
    pub heights: &'a [f64],
    /// Points `[nx, ny]` along `x` and `y`: any numbers from two on, equal or not.
    pub points: [usize; 2],
    /// Periods `[period_x, period_y]` along `x` and `y` in m; the spacings may differ.
    pub periods: [f64; 2],
}

impl ArealSurface<'_> {
    /// # Errors
    /// [`ContactError::OutOfRange`] for periods, numbers of points or a number of heights that do not fit;
    /// [`ContactError::BadHeightOfSurface`] with the first height that is not finite.
    pub(super) fn check(&self) -> Result<(), ContactError> {
        let out_of_range =
            |quantity, value, range| Err(ContactError::OutOfRange { quantity, value, range });
        for period in self.periods {
            if !(period > 0.0 && period.is_finite()) {
                return out_of_range("the period in m", period, "positive and finite");
            }
        }
        let [nx, ny] = self.points;
        for points in self.points {
            if !(FEWEST_POINTS..=MOST_POINTS).contains(&points) {
                let range = "2 to 2147483648";
                return out_of_range(
                    "the number of points of a row or column",
                    points as f64,
                    range,
                );
            }
        }
        match nx.checked_mul(ny) {
            Some(product) if product == self.heights.len() && product <= MOST_POINTS => {}
            _ => {
                let heights = self.heights.len() as f64;
                let range = "the product of the points along both directions, at most 2147483648";
                return out_of_range("the number of heights", heights, range);
            }
        }
        match self.heights.iter().position(|z| !z.is_finite()) {
            Some(index) => Err(ContactError::BadHeightOfSurface {
                column: index % nx,
                row: index / nx,
                value: self.heights[index],
            }),
            None => Ok(()),
        }
    }

    /// Heights about their mean.
    pub(super) fn centred(&self) -> Vec<f64> {
        remove_mean(self.heights)
    }
}

/// Fewest points to which a direction is halved.
const COARSEST: usize = 32;

/// Points of the next coarser grid: half of them along each direction that has enough. `None` if neither has.
pub(super) fn coarser([nx, ny]: [usize; 2]) -> Option<[usize; 2]> {
    let halve = |n: usize| if n >= 2 * COARSEST { n / 2 } else { n };
    let next = [halve(nx), halve(ny)];
    (next != [nx, ny]).then_some(next)
}

/// Values on another grid of the same periods, linear between points; where the number of points is halved they are
/// every second value.
pub(super) fn resample(values: &[f64], from: [usize; 2], to: [usize; 2]) -> Vec<f64> {
    let mut result = Vec::with_capacity(to[0] * to[1]);
    let position = |i: usize, axis: usize| {
        let numerator = i * from[axis];
        let left = numerator / to[axis];
        let weight = (numerator % to[axis]) as f64 / to[axis] as f64;
        (left, (left + 1) % from[axis], weight)
    };
    let columns: Vec<_> = (0..to[0]).map(|i| position(i, 0)).collect();
    for j in 0..to[1] {
        let (below, above, up) = position(j, 1);
        let below = &values[below * from[0]..][..from[0]];
        let above = &values[above * from[0]..][..from[0]];
        for &(left, right, across) in &columns {
            let along = |row: &[f64]| (1.0 - across) * row[left] + across * row[right];
            result.push((1.0 - up) * along(below) + up * along(above));
        }
    }
    result
}

/// Pressures on a finer grid, linear between points, where more than half of the points around them, by their weight in the
/// interpolation, are in contact: contacts on coarse grids are rather too large.
pub(super) fn prolong(pressure: &[f64], from: [usize; 2], to: [usize; 2]) -> Vec<f64> {
    let mut fine = resample(pressure, from, to);
    let inside: Vec<f64> = pressure.iter().map(|t| f64::from(u8::from(*t > 0.0))).collect();
    for (t, part) in fine.iter_mut().zip(resample(&inside, from, to)) {
        if part <= 0.5 {
            *t = 0.0;
        }
    }
    fine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_grid_has_every_second_value_and_twice_a_grid_keeps_them() {
        let fine: Vec<f64> = (0..96).map(|i| f64::from(i * i % 17)).collect();
        let coarse = resample(&fine, [12, 8], [6, 4]);
        for j in 0..4 {
            for i in 0..6 {
                assert_eq!(coarse[j * 6 + i], fine[2 * j * 12 + 2 * i]);
            }
        }
        let back = resample(&coarse, [6, 4], [12, 8]);
        assert_eq!(resample(&back, [12, 8], [6, 4]), coarse);
        assert_eq!(back[1], 0.5 * (coarse[0] + coarse[1]));
        // Across the end of the period.
        assert_eq!(back[11], 0.5 * (coarse[5] + coarse[0]));
    }

    #[test]
    fn grids_are_halved_where_they_have_points_enough() {
        assert_eq!(coarser([1024, 8]), Some([512, 8]));
        assert_eq!(coarser([129, 64]), Some([64, 32]));
        assert_eq!(coarser([63, 40]), None);
    }
}
