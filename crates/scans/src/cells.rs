//! Lines, cells and decimal mark of a table of text, for every reader of one.

use crate::description::DecimalMark;
use crate::thousands::thousands_mark;

/// The lines of a text, which end with `\n`, `\r\n`, or, where there is no `\n`, with `\r`, as some instruments end them.
pub fn lines(text: &str) -> Vec<&str> {
    if text.contains('\n') {
        return text.lines().collect();
    }
    text.split_terminator('\r').collect()
}

/// Cells of a line. A quote counts only where it opens a cell, for it also stands for the loss
/// modulus E".
pub fn split_cells(text: &str, separator: char) -> Vec<String> {
    let mut cells = Vec::new();
    let mut rest = text;
    loop {
        let start = rest.trim_start_matches(|c: char| c == ' ' || c == '\t' && c != separator);
        let quoted = start.strip_prefix('"').and_then(|inner| {
            let end = inner.find('"')?;
            let after = inner[end + 1..].trim_start_matches(' ');
            (after.is_empty() || after.starts_with(separator)).then_some((&inner[..end], after))
        });
        let (cell, after) = match quoted {
            Some((cell, after)) => (cell, after),
            None => rest.split_at(rest.find(separator).unwrap_or(rest.len())),
        };
        cells.push(cell.trim().to_owned());
        match after.strip_prefix(separator) {
            Some(next) => rest = next,
            None => return cells,
        }
    }
}

/// A number as a file writes it; `None` if the cell is not a number with that decimal mark.
pub fn number(cell: &str, mark: DecimalMark) -> Option<f64> {
    match mark {
        DecimalMark::Point => cell.parse().ok(),
        DecimalMark::Comma if cell.contains('.') => None,
        DecimalMark::Comma => cell.replacen(',', ".", 1).parse().ok(),
    }
}

/// Why cells do not say which decimal mark they have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnclearMark {
    /// Some have a comma, others a point.
    #[error(
        "`{text}` has a comma and other numbers have a point: write numbers without marks between thousands and with one decimal mark"
    )]
    Mixed {
        /// Line of the first comma.
        line: u64,
        /// Its cell.
        text: String,
    },
    /// Every comma may separate thousands.
    #[error("`{text}` may have a decimal comma or a comma between thousands")]
    Thousands {
        /// Line of the first comma.
        line: u64,
        /// Its cell.
        text: String,
    },
}

/// The only decimal mark that cells, each with its line, allow.
///
/// # Errors
/// [`UnclearMark`].
pub fn decimal_mark<'a>(
    cells: impl Iterator<Item = (u64, &'a str)> + Clone,
) -> Result<DecimalMark, UnclearMark> {
    let mut with_comma = cells.clone().filter(|(_, text)| text.contains(',')).peekable();
    let Some((line, text)) = with_comma.peek().map(|(line, text)| (*line, (*text).to_owned()))
    else {
        return Ok(DecimalMark::Point);
    };
    if cells.clone().any(|(_, text)| text.contains('.')) {
        return Err(UnclearMark::Mixed { line, text });
    }
    if with_comma.all(|(_, text)| thousands_mark(text, DecimalMark::Point) == Some(',')) {
        return Err(UnclearMark::Thousands { line, text });
    }
    Ok(DecimalMark::Comma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_instruments_end_them() {
        for text in ["a\nb\n", "a\r\nb", "a\rb\r", "a\rb"] {
            assert_eq!(lines(text), ["a", "b"], "{text:?}");
        }
    }

    #[test]
    fn quotes_hold_cells_together_only_where_they_open_one() {
        assert_eq!(split_cells("f/Hz,\"1,5\", 2 ", ','), ["f/Hz", "1,5", "2"]);
        assert_eq!(split_cells("f;E\";T", ';'), ["f", "E\"", "T"]);
        assert_eq!(split_cells("\t1\t\t2", '\t'), ["", "1", "", "2"]);
    }

    #[test]
    fn a_mark_that_is_not_the_only_one_is_refused() {
        let of = |cells: &[&str]| decimal_mark((1..).zip(cells.iter().copied()));
        assert_eq!(of(&["1.5", "2"]), Ok(DecimalMark::Point));
        assert_eq!(of(&["1,234", "0,5"]), Ok(DecimalMark::Comma));
        let text = || "1,234".to_owned();
        assert_eq!(of(&["7", "1,234"]), Err(UnclearMark::Thousands { line: 2, text: text() }));
        assert_eq!(of(&["1,234", "0.5"]), Err(UnclearMark::Mixed { line: 1, text: text() }));
    }
}
