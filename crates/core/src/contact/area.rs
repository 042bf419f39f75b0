//! The pressure that gives a contact area.

use super::{ContactError, ContactSolution, SlidingContact};
use crate::numerics::bracket::{self, End};

/// Most contacts solved in one search; the secant needs four to eight.
const MOST_SOLVES: usize = 60;

/// Bracket in `ln p` below which two pressures are the same.
const SAME_PRESSURE: f64 = 1e-13;

impl SlidingContact {
    /// The contact at the pressure that gives the contact area `fraction`, to a relative
    /// `tolerance` of the area. For the fraction 1 it is the smallest pressure of full contact.
    ///
    /// The area grows about like a power of the pressure, so the search is a secant in logarithms
    /// inside a bracket (Anderson & Björck 1973, doi:10.1007/BF01951936).
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a fraction outside `(0, 1]` or a tolerance outside `(0, 1)`;
    /// [`ContactError::AreaNotReached`] with the nearest area if no pressure gives it: a flat profile, or a contact too
    /// small for the grid; [`ContactError::NotConverged`] as in [`Self::solve`].
    pub fn solve_for_area(
        &mut self,
        fraction: f64,
        tolerance: f64,
    ) -> Result<ContactSolution, ContactError> {
        let nearest = self.solve_near_area(fraction, tolerance)?;
        let found = nearest.contact_area_fraction;
        if (found / fraction - 1.0).abs() <= tolerance {
            return Ok(nearest);
        }
        Err(ContactError::AreaNotReached {
            wanted: fraction,
            found,
            pressure: nearest.mean_pressure,
            points: self.points(),
        })
    }

    /// The contact whose area is the nearest to `fraction` that was found: to a relative `tolerance` of the
    /// area if the grid has such a contact. On a grid the area jumps where the contact of a lossy rubber
    /// spreads from one point to the next; the caller decides whether the nearest one is near enough.
    ///
    /// # Errors
    /// As [`Self::solve_for_area`]; [`ContactError::AreaNotReached`] for a flat profile only.
    pub fn solve_near_area(
        &mut self,
        fraction: f64,
        tolerance: f64,
    ) -> Result<ContactSolution, ContactError> {
        check(fraction, tolerance)?;
        let full = self.smallest_full_contact_pressure();
        if full <= 0.0 {
            let points = self.points();
            return Err(ContactError::AreaNotReached {
                wanted: fraction,
                found: 1.0,
                pressure: 0.0,
                points,
            });
        }
        if fraction == 1.0 {
            return self.solve(full);
        }
        let upper = End { place: full.ln(), error: -fraction.ln() };
        Search::run(self, fraction, tolerance, upper)
    }
}

struct Search<'a> {
    contact: &'a mut SlidingContact,
    fraction: f64,
    /// The nearest solution found.
    best: ContactSolution,
}

impl<'a> Search<'a> {
    /// Searches below the pressure of full contact.
    fn run(
        contact: &'a mut SlidingContact,
        fraction: f64,
        tolerance: f64,
        mut upper: End,
    ) -> Result<ContactSolution, ContactError> {
        // As an elastic sine would have it (Westergaard 1939).
        let elastic = (0.5 * std::f64::consts::PI * fraction).sin().powi(2);
        let mut guess = upper.place + elastic.ln();
        let best = contact.solve(guess.exp())?;
        let mut search = Self { contact, fraction, best };
        let mut error = search.error_of(&search.best);
        let mut lower: Option<End> = None;
        let mut previous_error = 0.0;
        for _ in 1..MOST_SOLVES {
            let new = End { place: guess, error };
            if error.abs() <= tolerance.ln_1p() {
                break;
            }
            guess = match (&mut lower, error > 0.0) {
                (None, true) => {
                    upper = new;
                    // Hertz: p ~ area²; a little further, to land below.
                    guess - 2.2 * error - 0.1
                }
                (None, false) => {
                    lower = Some(new);
                    // Up by the same rule: the known upper end may be far away.
                    (guess - 2.2 * error + 0.1).min(0.5 * (guess + upper.place))
                }
                (Some(low), _) => {
                    bracket::narrow(low, &mut upper, new, previous_error * error > 0.0);
                    if upper.place - low.place < SAME_PRESSURE {
                        break;
                    }
                    bracket::secant(low, &upper)
                }
            };
            previous_error = error;
            error = search.error_at(guess)?;
        }
        Ok(search.best)
    }

    /// Logarithm of the area at a pressure over the one sought; keeps the nearest solution.
    fn error_at(&mut self, log_pressure: f64) -> Result<f64, ContactError> {
        let solution = self.contact.solve(log_pressure.exp())?;
        let error = self.error_of(&solution);
        if error.abs() < self.error_of(&self.best).abs() {
            self.best = solution;
        }
        Ok(error)
    }

    fn error_of(&self, solution: &ContactSolution) -> f64 {
        (solution.contact_area_fraction / self.fraction).ln()
    }
}

/// Refuses what is no contact area fraction or no relative tolerance of one.
pub(super) fn check(fraction: f64, tolerance: f64) -> Result<(), ContactError> {
    let out_of_range =
        |quantity, value, range| Err(ContactError::OutOfRange { quantity, value, range });
    if !(fraction > 0.0 && fraction <= 1.0) {
        return out_of_range("the contact area fraction", fraction, "above 0 and at most 1");
    }
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return out_of_range("the tolerance of the contact area", tolerance, "between 0 and 1");
    }
    Ok(())
}
