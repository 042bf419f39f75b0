//! Filling the missing points of a map where a method needs all of them.

use super::HeightMap;
use crate::error_kind::{ErrorKind, HasKind};

mod laplace;

/// A limit that is met but for round-off is met.
const ROUNDING: f64 = 1e-9;
/// Mark of a point that is in no gap found so far.
const NONE: u32 = u32::MAX;

/// Missing points that cannot be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GapError {
    /// The limit is no length.
    #[error("the longest gap to fill is {limit_mm} mm; it must be 0 or positive")]
    Limit {
        /// The limit in mm.
        limit_mm: f64,
    },
    /// A gap is larger than the limit.
    #[error(
        "map {map}: the gap at column {column}, row {row} is {size_mm:.4} mm wide, and only gaps up to \
         {limit_mm:.4} mm are filled; raise the limit or leave this map out"
    )]
    TooWide {
        /// Name of the map.
        map: String,
        /// Column, from 0, of the missing point furthest from all heights.
        column: usize,
        /// Row of that point, from 0.
        row: usize,
        /// Twice its distance to the nearest height, in mm.
        size_mm: f64,
        /// The limit in mm.
        limit_mm: f64,
    },
    /// No point has a height.
    #[error("map {map}: all {points} points are missing, so there is nothing to fill them from")]
    NoHeights {
        /// Name of the map.
        map: String,
        /// Number of points.
        points: usize,
    },
    /// The equations of a gap were not solved.
    #[error(
        "map {map}: the heights of the gap of {points} points at column {column}, row {row} did not converge"
    )]
    NotConverged {
        /// Name of the map.
        map: String,
        /// Points of the gap.
        points: usize,
        /// Column, from 0, of one of them.
        column: usize,
        /// Its row, from 0.
        row: usize,
    },
}

impl HasKind for GapError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Limit { .. } | Self::TooWide { .. } | Self::NoHeights { .. } => ErrorKind::Input,
            Self::NotConverged { .. } => ErrorKind::Failure,
        }
    }
}

/// Fills missing points with the solution of Laplace's equation whose boundary values are the heights around, and returns
/// their number. Every filled height is the mean of its four neighbours, weighted with the squares of their inverse
/// distances, so that it lies between the lowest and the highest height around its gap; a plane is continued exactly.
/// At an edge of the map the normal derivative is zero: there the surface is continued level.
///
/// The size of a gap is twice the largest distance of one of its points to the nearest height: the diameter of the
/// largest circle in it. Where one is larger than `longest_gap`, in metres, nothing is filled.
///
/// Each gap, missing points that are neighbours along x or y, is solved by itself: at once up to 32 points, otherwise by
/// conjugate gradients to a residual of 1e-12. Cost is linear in the points of the map, plus for each missing point its
/// distance to the nearest height in points.
///
/// # Errors
/// [`GapError`] for a gap above the limit, a map without heights and a limit that is no length. The map is unchanged
/// then.
pub fn fill_gaps(map: &mut HeightMap, longest_gap: f64) -> Result<usize, GapError> {
    if longest_gap.is_nan() || longest_gap < 0.0 {
        return Err(GapError::Limit { limit_mm: longest_gap * 1e3 });
    }
    match map.missing() {
        0 => return Ok(0),
        missing if missing == map.heights.len() => {
            return Err(GapError::NoHeights { map: map.name.clone(), points: missing });
        }
        _ => {}
    }
    let ([column, row], size) = widest_gap(map);
    if size > longest_gap * (1.0 + ROUNDING) {
        return Err(GapError::TooWide {
            map: map.name.clone(),
            column,
            row,
            size_mm: size * 1e3,
            limit_mm: longest_gap * 1e3,
        });
    }
    let mut places = vec![NONE; map.heights.len()];
    let mut filled = Vec::new();
    for start in 0..map.heights.len() {
        if map.heights[start].is_nan() && places[start] == NONE {
            let gap = connected(map, start, &mut places);
            let heights =
                laplace::solve(map, &gap, &places).ok_or_else(|| GapError::NotConverged {
                    map: map.name.clone(),
                    points: gap.len(),
                    column: start % map.points[0],
                    row: start / map.points[0],
                })?;
            filled.extend(gap.into_iter().zip(heights));
        }
    }
    for &(point, height) in &filled {
        map.heights[point] = height;
    }
    Ok(filled.len())
}

/// Indices of the up to four neighbours of a point, left, right, below and above; those at the edges are missing.
fn neighbours(points: [usize; 2], point: usize) -> [Option<usize>; 4] {
    let [columns, rows] = points;
    let (column, row) = (point % columns, point / columns);
    [
        (column > 0).then(|| point - 1),
        (column + 1 < columns).then(|| point + 1),
        (row > 0).then(|| point - columns),
        (row + 1 < rows).then(|| point + columns),
    ]
}

/// The missing points connected to one of them; writes the place of each in this list to `places`.
fn connected(map: &HeightMap, start: usize, places: &mut [u32]) -> Vec<usize> {
    let mut gap = vec![start];
    places[start] = 0;
    let mut next = 0;
    while let Some(&point) = gap.get(next) {
        next += 1;
        for neighbour in neighbours(map.points, point).into_iter().flatten() {
            if map.heights[neighbour].is_nan() && places[neighbour] == NONE {
                places[neighbour] = gap.len() as u32;
                gap.push(neighbour);
            }
        }
    }
    gap
}

/// Column, row and twice the distance in metres to the nearest height, of the missing point where that is largest.
fn widest_gap(map: &HeightMap) -> ([usize; 2], f64) {
    let [columns, _] = map.points;
    let [dx, _] = map.spacing;
    let vertical = distances_along_columns(map);
    let mut widest = (0, 0.0);
    for (point, _) in map.heights.iter().enumerate().filter(|(_, z)| z.is_nan()) {
        let column = point % columns;
        let mut nearest = vertical[point] * vertical[point];
        // Columns ever further away, until none of them can be nearer.
        for step in 1..columns {
            let across = (step as f64 * dx).powi(2);
            if across >= nearest {
                break;
            }
            let left = column.checked_sub(step).map(|_| point - step);
            let right = (column + step < columns).then_some(point + step);
            for other in [left, right].into_iter().flatten() {
                nearest = nearest.min(across + vertical[other] * vertical[other]);
            }
        }
        if nearest > widest.1 {
            widest = (point, nearest);
        }
    }
    ([widest.0 % columns, widest.0 / columns], 2.0 * widest.1.sqrt())
}

/// Distance in metres of every point to the nearest height in its column, 0 where it has one itself.
fn distances_along_columns(map: &HeightMap) -> Vec<f64> {
    let [columns, rows] = map.points;
    let dy = map.spacing[1];
    let mut distances: Vec<f64> =
        map.heights.iter().map(|z| if z.is_nan() { f64::INFINITY } else { 0.0 }).collect();
    for point in columns..columns * rows {
        distances[point] = distances[point].min(distances[point - columns] + dy);
    }
    for point in (0..columns * (rows - 1)).rev() {
        distances[point] = distances[point].min(distances[point + columns] + dy);
    }
    distances
}

#[cfg(test)]
mod tests;
