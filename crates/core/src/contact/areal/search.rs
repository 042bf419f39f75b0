//! The pressure that gives a contact area.

use super::super::ContactError;
use super::super::area::check;
use super::{ArealContact, ArealSolution};
use crate::numerics::krylov::euclidean_norm;
use statrs::function::erf::erf_inv;

/// Most contacts solved in one search; it needs three to five.
const MOST_SOLVES: usize = 40;
/// Bracket in `ln p` below which two pressures are the same.
const SAME_PRESSURE: f64 = 1e-13;
/// Largest step in `ln p`.
const LARGEST_STEP: f64 = 3.0;

impl ArealContact {
    /// The contact at the pressure that gives the contact area `fraction`, to a relative `tolerance` of the area. For the
    /// fraction 1 it is the smallest pressure of full contact.
    ///
    /// The search is a secant inside a bracket in `ln p` and `ln erf⁻¹(A)`, in which Persson's theory
    /// (2001, doi:10.1063/1.1388626), `A = erf(p / sqrt(2 V))` with `V` the variance of the pressure in full contact, is a
    /// straight line of slope one. Each contact starts from the one before it.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a fraction outside `(0, 1]` or a tolerance outside `(0, 1)`;
    /// [`ContactError::AreaNotReached`] with the nearest area if no pressure gives it: a flat surface, or a contact too
    /// small for the grid; [`ContactError::NotConverged`] as in [`Self::solve`].
    pub fn solve_for_area(
        &mut self,
        fraction: f64,
        tolerance: f64,
    ) -> Result<ArealSolution, ContactError> {
        let nearest = self.solve_near_area(fraction, tolerance)?;
        let found = nearest.contact_area_fraction;
        if (found / fraction - 1.0).abs() <= tolerance {
            return Ok(nearest);
        }
        Err(self.not_reached(fraction, found, nearest.mean_pressure))
    }

    /// As [`Self::solve_for_area`], but the contact with the nearest area that was found: on a grid the area of a lossy rubber
    /// jumps by about a point.
    ///
    /// # Errors
    /// As [`Self::solve_for_area`]; [`ContactError::AreaNotReached`] of a flat surface alone.
    pub fn solve_near_area(
        &mut self,
        fraction: f64,
        tolerance: f64,
    ) -> Result<ArealSolution, ContactError> {
        check(fraction, tolerance)?;
        let full = self.full_contact_pressure();
        let lowest = full.iter().fold(0.0, |a: f64, b| a.min(*b));
        let deviation = euclidean_norm(&full) / (full.len() as f64).sqrt();
        drop(full);
        if lowest == 0.0 {
            return Err(self.not_reached(fraction, 1.0, 0.0));
        }
        if fraction == 1.0 {
            return self.solve(-lowest);
        }
        let guess = deviation.ln() + place(fraction);
        self.search(fraction, tolerance, guess.min((-lowest).ln()))
    }

    fn not_reached(&self, wanted: f64, found: f64, pressure: f64) -> ContactError {
        let points = self.points().iter().product();
        ContactError::AreaNotReached { wanted, found, pressure, points }
    }

    /// The contact whose area is the nearest that was found.
    fn search(
        &mut self,
        fraction: f64,
        tolerance: f64,
        mut guess: f64,
    ) -> Result<ArealSolution, ContactError> {
        let wanted = place(fraction);
        let distance = |area: f64| (area / fraction).ln().abs();
        let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut previous: Option<(f64, f64)> = None;
        let mut best = self.solve(guess.exp())?;
        let mut area = best.contact_area_fraction;
        for solve in 1..MOST_SOLVES {
            if (area / fraction - 1.0).abs() <= tolerance || upper - lower < SAME_PRESSURE {
                break;
            }
            let error = place(area) - wanted;
            if error > 0.0 {
                upper = guess;
            } else {
                lower = guess;
            }
            let slope = previous.map_or(1.0, |(x, e)| (error - e) / (guess - x));
            previous = error.is_finite().then_some((guess, error));
            guess = next(guess, error, slope, lower, upper);
            // A secant that comes from one side only hardly narrows the bracket.
            if solve % 3 == 0 && (upper - lower).is_finite() {
                guess = 0.5 * (lower + upper);
            }
            let near = match self.solve_near(guess.exp(), best.pressure.clone()) {
                // From the coarsest grid it may.
                Err(ContactError::NotConverged { .. }) => self.solve(guess.exp())?,
                solved => solved?,
            };
            area = near.contact_area_fraction;
            if distance(area) < distance(best.contact_area_fraction) {
                best = near;
            }
        }
        Ok(best)
    }
}

/// Logarithm of the pressure over its deviation in full contact at which Persson's theory has an area.
fn place(area: f64) -> f64 {
    (std::f64::consts::SQRT_2 * erf_inv(area.clamp(f64::MIN_POSITIVE, 1.0))).ln()
}

/// The next place: by the slope if it is a sensible one, within the bracket.
fn next(here: f64, error: f64, slope: f64, lower: f64, upper: f64) -> f64 {
    let slope = if slope > 0.1 && slope < 10.0 { slope } else { 1.0 };
    let step = (-error / slope).clamp(-LARGEST_STEP, LARGEST_STEP);
    let there = here + step;
    if there > lower && there < upper { there } else { 0.5 * (lower + upper) }
}
