//! Tables in Markdown, and their place in a document.

use super::CaseResult;
use std::fmt::Write;

/// Lines of a document between which results stand.
const BEGIN: &str = "<!-- bench: begin -->";
const END: &str = "<!-- bench: end -->";

/// One Markdown table for each case.
pub fn markdown(results: &[CaseResult]) -> String {
    results.iter().map(case).collect::<Vec<_>>().join("\n")
}

fn case(result: &CaseResult) -> String {
    let mut text = format!("## {}\n\n", result.case);
    let CaseResult { problem, reference, .. } = result;
    let _ = writeln!(text, "{}. Reference: {reference}.\n", capitalised(problem));
    text += "| method | knob | value | result | relative error | seconds | repeats |\n";
    text += "|---|---|---:|---:|---:|---:|---:|\n";
    for line in &result.lines {
        for point in &line.points {
            let number = point.result.map_or_else(|| "-".into(), |number| format!("{number:.6}"));
            let (method, knob, value) = (line.method, line.knob, point.value);
            let (error, seconds) = (point.relative_error, significant(point.seconds));
            let repeats = point.repeats;
            let _ = writeln!(
                text,
                "| {method} | {knob} | {value} | {number} | {error:.1e} | {seconds} | {repeats} |"
            );
        }
    }
    text
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Three significant digits without an exponent, for what lies between 1e-9 and 1e6.
pub(super) fn significant(value: f64) -> String {
    if !(value.is_finite() && value != 0.0) {
        return format!("{value}");
    }
    let decimals = 2 - value.abs().log10().floor() as i32;
    format!("{value:.*}", decimals.clamp(0, 12) as usize)
}

/// A document with new results: those between the lines `<!-- bench: begin -->` and
/// `<!-- bench: end -->` are replaced, all else stays. `None` if the document has no such lines.
pub fn renewed(document: &str, results: &str) -> Option<String> {
    let (before, rest) = document.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}\n\n{}\n\n{END}{after}", results.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_written() {
        for (value, text) in
            [(0.0123456, "0.0123"), (12.3456, "12.3"), (1234.5, "1234"), (0.0, "0")]
        {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn only_the_marked_part_of_a_document_is_renewed() {
        let document = format!("# Title\n\n{BEGIN}\nold\n{END}\n\nThe end.\n");
        let renewed_once = renewed(&document, "new\n").unwrap();
        assert_eq!(renewed_once, format!("# Title\n\n{BEGIN}\n\nnew\n\n{END}\n\nThe end.\n"));
        assert_eq!(renewed(&renewed_once, "new").unwrap(), renewed_once);
        assert_eq!(renewed("# Title\n", "new"), None);
    }
}
