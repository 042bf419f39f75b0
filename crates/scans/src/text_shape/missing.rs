//! Marks of missing heights: words, and numbers that no height comes near.

use crate::description::default_missing;

/// Words for a missing height.
const WORDS: [&str; 8] = ["", "nan", "bad", "na", "n/a", "null", "---", "*"];

/// More words for a gap than any instrument has.
const MOST_WORDS: usize = 20;

/// Whether a cell is a word for a missing height.
pub(super) fn is_word(cell: &str) -> bool {
    WORDS.iter().any(|word| word.eq_ignore_ascii_case(cell))
}

/// The words that a description has to list, each once, [`MOST_WORDS`] at most.
pub(super) fn words(words: impl Iterator<Item = String>) -> Vec<String> {
    let known = default_missing();
    let mut found: Vec<String> = Vec::new();
    for cell in words {
        if found.len() == MOST_WORDS {
            break;
        }
        if !known.iter().chain(&found).any(|word| word.eq_ignore_ascii_case(&cell)) {
            found.push(cell);
        }
    }
    found
}

/// The smallest and the largest number if they occur more than once, further from the
/// numbers between them than three times the range of these. A clipped height repeats as well, but
/// close to the others.
pub(super) fn numbers(heights: &[f64]) -> Vec<f64> {
    const RANGES: f64 = 3.0;
    let mut rest: Vec<f64> = heights.iter().copied().filter(|height| height.is_finite()).collect();
    rest.sort_by(f64::total_cmp);
    let mut rest = rest.as_slice();
    let mut marks = Vec::new();
    // Some instruments mark points out of range and points without light by different numbers.
    for _ in 0..4 {
        let (Some(&lowest), Some(&highest)) = (rest.first(), rest.last()) else { break };
        let above = rest.partition_point(|height| *height <= lowest);
        let below = rest.partition_point(|height| *height < highest);
        let Some([first, .., last]) = rest.get(above..below) else { break };
        let far = RANGES * (last - first);
        if above > 1 && first - lowest > far {
            marks.push(lowest);
            rest = &rest[above..];
        } else if rest.len() - below > 1 && highest - last > far {
            marks.push(highest);
            rest = &rest[..below];
        } else {
            break;
        }
    }
    marks
}

/// A height that is written for missing ones, inside the range of all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RepeatedHeight {
    /// The height, in the unit of the others.
    pub height: f64,
    /// How often it is there.
    pub count: usize,
    /// How often the most frequent height that is not a mark occurs.
    pub others: usize,
}

/// Heights between the smallest and the largest that are there much more often than any other: six
/// times and more, five times as often as the most frequent of the others, in three places and more.
/// Laser sensors write 0 where no light came back. A clipped height is at the end of the range, a
/// plate or a stylus at rest makes one run of equal heights, and coarse steps repeat all heights.
pub fn repeated_inside(heights: &[f64]) -> Vec<RepeatedHeight> {
    const FEWEST: usize = 6;
    const TIMES_OTHERS: usize = 5;
    const FEWEST_RUNS: usize = 3;
    /// Points out of range and points without light may have a number each.
    const MOST_MARKS: usize = 4;
    // Adding 0 makes -0 the same as 0.
    let mut sorted: Vec<f64> = heights.iter().filter(|z| z.is_finite()).map(|z| z + 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(&lowest), Some(&highest)) = (sorted.first(), sorted.last()) else {
        return Vec::new();
    };
    let mut counts: Vec<(usize, f64)> =
        sorted.chunk_by(|a, b| a == b).map(|equal| (equal.len(), equal[0])).collect();
    counts.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let ends_at = |&marks: &usize| {
        let others = counts.get(marks).map_or(0, |next| next.0);
        others > 0 && counts[marks - 1].0 >= FEWEST.max(TIMES_OTHERS * others)
    };
    let Some(marks) = (1..=MOST_MARKS.min(counts.len())).find(ends_at) else { return Vec::new() };
    let others = counts[marks].0;
    let runs = |height: f64| {
        let starts = |pair: &&[f64]| pair[0] != height && pair[1] == height;
        heights.windows(2).filter(starts).count() + usize::from(heights[0] == height)
    };
    let found =
        counts[..marks].iter().map(|&(count, height)| RepeatedHeight { height, count, others });
    found
        .filter(|mark| lowest < mark.height && mark.height < highest)
        .filter(|mark| runs(mark.height) >= FEWEST_RUNS)
        .collect()
}

/// A mark as a cell; the reader compares by value.
pub(super) fn mark_text(mark: f64) -> String {
    if mark.abs() < 1e15 { mark.to_string() } else { format!("{mark:e}") }
}
