//! Cutting a scan into windows of equal length.

use std::ops::Range;

/// Ranges of `points` neighbouring points without overlap, in the middle of `total` points: half of
/// the remainder is left out on each side. None when `points` is 0 or more than `total`.
pub fn windows(total: usize, points: usize) -> Vec<Range<usize>> {
    let count = total.checked_div(points).unwrap_or(0);
    let start = (total - count * points) / 2;
    (0..count).map(|i| start + i * points..start + (i + 1) * points).collect()
}

/// Name of a window of a scan: `name/000`.
pub fn window_name(scan: &str, index: usize) -> String {
    format!("{scan}/{index:03}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_lie_in_the_middle() {
        assert_eq!(windows(10, 3), [0..3, 3..6, 6..9]);
        assert_eq!(windows(11, 3), [1..4, 4..7, 7..10]);
        assert_eq!(windows(7, 3), [0..3, 3..6]);
        assert_eq!(windows(6, 3), [0..3, 3..6]);
        assert!(windows(2, 3).is_empty());
        assert!(windows(2, 0).is_empty());
        assert_eq!(window_name("a", 7), "a/007");
    }
}
