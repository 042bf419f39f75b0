//! Numbers whose thousands are separated, which no description can read.

use crate::description::DecimalMark;

/// The mark between the thousands of a number such as `12,345.67`, `1'234` or, with a decimal
/// comma, `12.345`: groups of three digits after a first one of one to three that is not a single zero.
pub(crate) fn thousands_mark(cell: &str, mark: DecimalMark) -> Option<char> {
    const MARKS: [char; 6] = [',', '.', '\'', ' ', '\u{a0}', '\u{202f}'];
    let decimal = match mark {
        DecimalMark::Point => '.',
        DecimalMark::Comma => ',',
    };
    let unsigned = cell.strip_prefix(['+', '-']).unwrap_or(cell);
    let (whole, fraction) = unsigned.split_once(decimal).unwrap_or((unsigned, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let found = whole.chars().find(|c| MARKS.contains(c) && *c != decimal)?;
    let mut groups = whole.split(found);
    let first = groups.next()?;
    let grouped = (1..=3).contains(&first.len()) && digits(first) && !first.starts_with('0');
    let rest = groups.all(|group| group.len() == 3 && digits(group));
    (grouped && rest && digits(fraction)).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_three_digits_are_thousands_and_all_else_is_not() {
        use DecimalMark::{Comma, Point};
        for (cell, mark, found) in [
            ("12,345.67", Point, Some(',')),
            ("-1,234,567", Point, Some(',')),
            ("1'234.5", Point, Some('\'')),
            ("12.345", Comma, Some('.')),
            ("1 234,5", Comma, Some(' ')),
            ("0,050", Point, None),
            ("1,5", Point, None),
            ("1,23,456", Point, None),
            ("12.345", Point, None),
            ("1,234.5.6", Point, None),
            (",123", Point, None),
            ("", Point, None),
        ] {
            assert_eq!(thousands_mark(cell, mark), found, "{cell}");
        }
    }
}
