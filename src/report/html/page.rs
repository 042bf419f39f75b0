//! Parts that all sections are made of.

use crate::plot::scientific;
use maud::{Markup, html};

/// A sentence that replaces what a run does not have.
pub(super) fn absent(sentence: &str) -> Markup {
    html! { p.absent { (sentence) } }
}

/// A number with so many significant digits.
pub(crate) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let magnitude = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return scientific(value);
    }
    let decimals = digits as i32 - 1 - magnitude.log10().floor() as i32;
    format!("{value:.*}", decimals.max(0) as usize).replace('-', "\u{2212}")
}

/// A number with so many significant digits, or a dash for an unknown one.
pub(super) fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".into(), |value| number(value, digits))
}

/// A share as percentage.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 2))
}

/// A table with its caption, in a container of its own that scrolls. The first `texts` columns are
/// text, the rest numbers; the first column names the row.
pub(super) fn table<T: AsRef<str>>(
    caption: &str,
    header: &[&str],
    texts: usize,
    rows: impl IntoIterator<Item = Vec<T>>,
) -> Markup {
    let class = |column: usize| if column < texts { "text" } else { "number" };
    html! {
        div.scroll tabindex="0" role="region" aria-label=(caption) {
            table {
                caption { (caption) }
                thead { tr { @for (column, name) in header.iter().enumerate() {
                    th scope="col" class=(class(column)) { (name) }
                } } }
                tbody { @for row in rows {
                    tr { @for (column, cell) in row.iter().enumerate() {
                        @if column == 0 {
                            th scope="row" { (cell.as_ref()) }
                        } @else {
                            td class=(class(column)) { (cell.as_ref()) }
                        }
                    } }
                } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits() {
        let cases =
            [(0.123456, "0.123"), (12345.6, "12346"), (-2.0, "−2.00"), (1.5e-7, "1.5×10⁻⁷")];
        for (value, text) in cases {
            assert_eq!(number(value, 3), text);
        }
        assert_eq!((number(f64::NAN, 3).as_str(), optional(None, 3).as_str()), ("–", "–"));
    }

    #[test]
    fn hostile_cells_stay_text() {
        let text = table("<i>", &["a & b"], 1, [vec!["<script>alert(1)</script>"]]).into_string();
        assert!(text.contains("&lt;script&gt;alert(1)&lt;/script&gt;"), "{text}");
        assert!(!text.contains("<script") && !text.contains("<i>") && text.contains("a &amp; b"));
    }
}
