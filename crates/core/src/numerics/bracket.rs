//! Root of a growing function in a bracket (Anderson & Björck 1973, doi:10.1007/BF01951936).

/// One end of the bracket.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Where the function was evaluated.
    pub place: f64,
    /// Its value there: negative at the lower end, positive at the upper one.
    pub error: f64,
}

/// Replaces the end of the bracket on the side of `new`. If the same end is replaced twice in succession (`again`), the
/// error of the other end is scaled down, so that it moves too.
pub fn narrow(lower: &mut End, upper: &mut End, new: End, again: bool) {
    let (near, far) = if new.error > 0.0 { (upper, lower) } else { (lower, upper) };
    if again {
        let scale = 1.0 - new.error / near.error;
        far.error *= if scale > 0.0 { scale } else { 0.5 };
    }
    *near = new;
}

/// Zero of the line through the ends, at least a thousandth of the bracket away from them.
pub fn secant(lower: &End, upper: &End) -> f64 {
    let share = lower.error / (lower.error - upper.error);
    let share = if share.is_finite() { share.clamp(1e-3, 1.0 - 1e-3) } else { 0.5 };
    lower.place + share * (upper.place - lower.place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_found_in_few_steps() {
        let function = |x: f64| x.exp() - 3.0;
        let end = |place: f64| End { place, error: function(place) };
        let (mut lower, mut upper) = (end(-1.0), end(3.0));
        let mut previous = 0.0;
        for _ in 0..16 {
            let new = end(secant(&lower, &upper));
            narrow(&mut lower, &mut upper, new, previous * new.error > 0.0);
            previous = new.error;
        }
        assert!(previous.abs() < 1e-6, "{previous}");
    }
}
