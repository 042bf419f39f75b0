//! The pressure for a wanted contact area, by bracketing in the logarithm of the pressure.

use crate::contact::{ContactError, ContactSolution, SlidingContact};

/// Where the search starts, and the factor by which it looks for the other side.
const FIRST_PRESSURE: f64 = 1e6;
const FACTOR: f64 = 4.0;
/// `FACTOR` to this power is 1e18 either way of the start: beyond any road and rubber.
const MAX_FACTORS: i32 = 30;
/// Halvings of `ln FACTOR` down to rounding.
const MAX_SOLVES: usize = 50;

/// The contact whose area fraction is `fraction` up to `tolerance`, relative.
///
/// # Errors
/// Those of [`SlidingContact::solve`]; [`ContactError::AreaNotReached`].
pub(super) fn solve_for_area(
    contact: &mut SlidingContact,
    fraction: f64,
    tolerance: f64,
) -> Result<ContactSolution, ContactError> {
    let miss = |solution: &ContactSolution| solution.contact_area_fraction - fraction;
    let mut nearest = contact.solve(FIRST_PRESSURE)?;
    let mut low = (nearest.mean_pressure.ln(), miss(&nearest));
    let mut high = low;
    for _ in 0..MAX_FACTORS {
        let side = if low.1 > 0.0 {
            &mut low
        } else if high.1 < 0.0 {
            &mut high
        } else {
            break;
        };
        side.0 += if side.1 > 0.0 { -FACTOR.ln() } else { FACTOR.ln() };
        nearest = contact.solve(side.0.exp())?;
        side.1 = miss(&nearest);
    }
    for _ in 0..MAX_SOLVES {
        if miss(&nearest).abs() <= tolerance * fraction {
            return Ok(nearest);
        }
        if low.1 > 0.0 || high.1 < 0.0 {
            break;
        }
        let middle = 0.5 * (low.0 + high.0);
        nearest = contact.solve(middle.exp())?;
        let side = if miss(&nearest) < 0.0 { &mut low } else { &mut high };
        *side = (middle, miss(&nearest));
    }
    Err(ContactError::AreaNotReached {
        wanted: fraction,
        found: nearest.contact_area_fraction,
        pressure: nearest.mean_pressure,
        points: contact.points(),
    })
}
