//! Marks of missing heights: words, and numbers that no height comes near.

use crate::scans::description::default_missing;

/// Words that stand for a missing height.
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

/// The smallest and the largest number where they stand there more than once, further from the
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

/// A mark as a cell; the reader compares by value.
pub(super) fn mark_text(mark: f64) -> String {
    if mark.abs() < 1e15 { mark.to_string() } else { format!("{mark:e}") }
}
