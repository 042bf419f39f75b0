//! Why a map has no parameters, no correlation or no spectrum.

use super::HeightMap;
use crate::error_kind::{ErrorKind, HasKind};
use thiserror::Error;

/// A map that cannot be evaluated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ArealError {
    /// Too few points along a direction.
    #[error(
        "map {map}: {nx} x {ny} points, at least {least} are needed in each direction; use a larger map"
    )]
    TooSmall {
        /// Name of the map.
        map: String,
        /// Points along `x`.
        nx: usize,
        /// Points along `y`.
        ny: usize,
        /// Points needed in each direction.
        least: usize,
    },
    /// Too few heights.
    #[error(
        "map {map}: {valid} of its {points} points have heights, at least {least} are needed; leave the map out"
    )]
    TooFewHeights {
        /// Name of the map.
        map: String,
        /// Number of valid points.
        valid: usize,
        /// Number of points.
        points: usize,
        /// Heights needed.
        least: usize,
    },
    /// No gradient: missing points lie between all others.
    #[error(
        "map {map}: no point has neighbours with heights in both directions; fill its gaps or leave it out"
    )]
    NoNeighbours {
        /// Name of the map.
        map: String,
    },
    /// All heights are equal.
    #[error("map {map}: every height is {height} m, it has no roughness; leave the map out")]
    Flat {
        /// Name of the map.
        map: String,
        /// The one height in m.
        height: f64,
    },
    /// A spectrum of a map with gaps.
    #[error("map {map}: {missing} heights are missing; fill the gaps before computing a spectrum")]
    Gaps {
        /// Name of the map.
        map: String,
        /// Number of missing heights.
        missing: usize,
    },
}

impl HasKind for ArealError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooSmall { .. }
            | Self::TooFewHeights { .. }
            | Self::NoNeighbours { .. }
            | Self::Flat { .. } => ErrorKind::Input,
            Self::Gaps { .. } => ErrorKind::Failure,
        }
    }
}

/// Mean in m of the valid heights of a map of at least `least` points in each direction.
///
/// # Errors
/// A smaller map, fewer than two heights, heights that are all equal.
pub(super) fn mean_height(map: &HeightMap, least: usize) -> Result<f64, ArealError> {
    let [nx, ny] = map.points;
    if nx.min(ny) < least {
        return Err(ArealError::TooSmall { map: map.name.clone(), nx, ny, least });
    }
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut sum, mut valid) = (0.0, 0_usize);
    for &z in map.heights.iter().filter(|z| !z.is_nan()) {
        (lowest, highest) = (z.min(lowest), z.max(highest));
        sum += z;
        valid += 1;
    }
    if valid < 2 {
        let (map, points) = (map.name.clone(), nx * ny);
        return Err(ArealError::TooFewHeights { map, valid, points, least: 2 });
    }
    if lowest == highest {
        return Err(ArealError::Flat { map: map.name.clone(), height: lowest });
    }
    Ok(sum / valid as f64)
}
