//! Numbers that a file was cut in.

/// Number of values needed to know how a file writes them.
pub(super) const ENOUGH: usize = 8;

/// The shortest numbers of a file, to detect a last one that was cut.
///
/// A file that was copied in part may end within a number, and what is left of `-12.345` is a
/// number as well: `-12.3`. Instruments write all numbers of a column with the same decimals, so
/// that a last number shorter than all before it, without a line end, was cut.
#[derive(Debug, Default)]
pub(super) struct LastNumber {
    seen: usize,
    shortest: Option<Lengths>,
}

#[derive(Debug, Clone, Copy)]
struct Lengths {
    cell: usize,
    decimals: usize,
    exponent: usize,
}

impl Lengths {
    fn of(cell: &[u8]) -> Self {
        let exponent_at = cell.iter().position(|byte| matches!(byte, b'e' | b'E'));
        let (mantissa, exponent) = cell.split_at(exponent_at.unwrap_or(cell.len()));
        let mark = mantissa.iter().rposition(|byte| matches!(byte, b'.' | b','));
        Self {
            cell: cell.len(),
            decimals: mark.map_or(0, |mark| mantissa.len() - mark - 1),
            exponent: exponent.iter().filter(|byte| byte.is_ascii_digit()).count(),
        }
    }
}

impl LastNumber {
    /// Takes note of a number that is followed by another.
    pub(super) fn note(&mut self, cell: &str) {
        let cell = cell.trim().as_bytes();
        // Words such as NaN mark missing heights.
        if !cell.last().is_some_and(u8::is_ascii_digit) {
            return;
        }
        self.seen += 1;
        let found = Lengths::of(cell);
        self.shortest = Some(self.shortest.map_or(found, |shortest| Lengths {
            cell: shortest.cell.min(found.cell),
            decimals: shortest.decimals.min(found.decimals),
            exponent: shortest.exponent.min(found.exponent),
        }));
    }

    /// Whether a number that ends a file was most likely cut.
    pub(super) fn is_cut(&self, cell: &str) -> bool {
        let cell = cell.trim().as_bytes();
        let found = Lengths::of(cell);
        self.seen >= ENOUGH
            && self.shortest.is_some_and(|shortest| {
                let is_whole = shortest.decimals == 0 && shortest.exponent == 0;
                found.decimals < shortest.decimals
                    || found.exponent < shortest.exponent
                    // Digits before the decimal mark come and go with the size of a number; where
                    // there are no others, they are all that tells.
                    || (is_whole && found.cell < shortest.cell)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_shorter_than_all_others_is_cut() {
        let cases: [(&[&str], &str, bool); 9] = [
            (&["12.345", "-1.200"], "3.4", true),
            (&["12.345", "-1.200"], "3.456", false),
            (&["12,345", "-1,200"], "13,45", true),
            (&["1.5e-05", "-1.5e-05"], "-1.5e-0", true),
            (&["1.5e-05", "1.5e-04"], "-1.5e-05", false),
            // Without trailing zeros a shorter number may be complete.
            (&["1.25", "3", "1.5"], "2", false),
            (&["100", "123"], "12", true),
            (&["1", "123"], "12", false),
            (&["1.25", "NaN"], "1.2", true),
        ];
        for (before, last, cut) in cases {
            let mut numbers = LastNumber::default();
            for cell in before.iter().cycle().take(20) {
                numbers.note(cell);
            }
            assert_eq!(numbers.is_cut(last), cut, "{before:?} {last}");
        }
        assert!(!LastNumber::default().is_cut("1"));
    }
}
