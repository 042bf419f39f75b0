//! The pressure that gives a contact area.

use super::super::error::FemError;
use super::SteadyContact;
use super::solution::SteadySolution;
use crate::numerics::bracket::{self, End};

/// Most contacts solved in one search; it needs five to ten.
const MOST_SOLVES: usize = 40;
/// Power of the area with which the pressure of a Hertz contact grows.
const HERTZ: f64 = 2.0;
/// Largest step up in ln p.
const LARGEST_STEP: f64 = 1.0;

impl SteadyContact {
    /// The contact at the pressure that gives the contact area `fraction`, to a relative
    /// `tolerance` of the area.
    ///
    /// # Errors
    /// [`FemError::OutOfRange`] for a fraction or tolerance outside `(0, 1)`;
    /// [`FemError::AreaNotReached`] with the nearest area, where nodes come into contact in jumps;
    /// [`FemError::PathEnded`] as in [`Self::solve`].
    pub fn solve_for_area(
        &mut self,
        fraction: f64,
        tolerance: f64,
    ) -> Result<SteadySolution, FemError> {
        for (quantity, value) in
            [("the contact area fraction", fraction), ("the tolerance of the area", tolerance)]
        {
            if !(value > 0.0 && value < 1.0) {
                return Err(FemError::OutOfRange { quantity, value, range: "between 0 and 1" });
            }
        }
        let mut guess = self.setting.first_pressure(&self.profile).ln();
        let (mut lower, mut upper): (Option<End>, Option<End>) = (None, None);
        let error_of = |solution: &SteadySolution| (solution.contact_area_fraction / fraction).ln();
        let mut best = self.solve(guess.exp())?;
        let mut error = error_of(&best);
        let mut previous = 0.0;
        for _ in 1..MOST_SOLVES {
            let new = End { place: guess, error };
            match (&mut lower, &mut upper) {
                (Some(low), Some(up)) => bracket::narrow(low, up, new, previous * error > 0.0),
                (_, up) if error > 0.0 => *up = Some(new),
                (low, _) => *low = Some(new),
            }
            previous = error;
            guess = match (&lower, &upper) {
                _ if error.abs() <= tolerance.ln_1p() => break,
                (Some(low), Some(up)) if up.place - low.place < 1e-10 => break,
                (Some(low), Some(up)) => bracket::secant(low, up),
                _ => guess - (HERTZ * error + 0.1 * error.signum()).clamp(-LARGEST_STEP, 3.0),
            };
            let solution = self.solve(guess.exp())?;
            error = error_of(&solution);
            if error.abs() < error_of(&best).abs() {
                best = solution;
            }
        }
        if error_of(&best).abs() <= tolerance.ln_1p() {
            return Ok(best);
        }
        Err(FemError::AreaNotReached {
            wanted: fraction,
            found: best.contact_area_fraction,
            pressure: best.mean_pressure,
            columns: self.options.columns,
        })
    }
}
