//! The sliding contact on nested grids.

use super::active_set::{Contact, Goal, Outcome};
use super::edges::EdgeReader;
use super::error::ContactError;
use super::half_space::HalfSpace;
use super::solution::{ContactSolution, Fields};
use crate::numerics::Interrupt;
use crate::rubber::{RubberError, Viscoelastic};
use realfft::RealFftPlanner;

/// Residual below which a contact counts as solved; see [`ContactSolution::residual`].
pub const RESIDUAL_TOLERANCE: f64 = 1e-10;

/// The iteration aims lower, so that what is reported stays below [`RESIDUAL_TOLERANCE`].
pub(crate) const INNER_TOLERANCE: f64 = 2e-11;

/// Grids are halved down to about this many points.
pub(crate) const COARSEST_POINTS: usize = 64;

/// Numbers of grid points for which a contact can be set up.
pub const POINTS_RANGE: std::ops::RangeInclusive<usize> = 8..=1 << 24;

/// A rubber half-space sliding at constant speed over a rigid periodic profile.
///
/// Operators and transforms are kept, so that further pressures cost no set-up. Every solve
/// starts from scratch on the coarsest grid: its result does not depend on what was solved
/// before.
///
/// ```
/// use asperity_core::contact::SlidingContact;
/// use asperity_core::rubber::Rubber;
/// use asperity_core::surface::{Wave, wave};
///
/// let period = 1e-3;
/// let profile = wave::sample(&[Wave { wavelength: period, amplitude: 1e-5, phase: 0.0 }], period, 1024);
/// let rubber = Rubber::elastic(3e6, 0.5);
/// let mut contact = SlidingContact::new(&rubber, 0.01, period, &profile)?;
/// let solution = contact.solve(5e4)?;
/// // Westergaard: A/A0 = 2/π asin(sqrt(p/p*)) with p* = π E_r D / λ.
/// let full = std::f64::consts::PI * 4e6 * 0.01;
/// let exact = 2.0 / std::f64::consts::PI * (5e4_f64 / full).sqrt().asin();
/// assert!((solution.contact_area_fraction - exact).abs() < 1e-3);
/// assert!(solution.friction_coefficient.abs() < 1e-10); // elastic: no loss
/// # Ok::<(), asperity_core::contact::ContactError>(())
/// ```
pub struct SlidingContact {
    speed: f64,
    /// Grids that a solve starts on, the coarsest first.
    coarser: Vec<Grid>,
    finest: Grid,
    slopes: Vec<f64>,
    height_range: f64,
    interrupt: Interrupt,
}

/// One of the nested grids.
struct Grid {
    space: HalfSpace,
    heights: Vec<f64>,
    kernel: Vec<f64>,
    edges: EdgeReader,
}

impl SlidingContact {
    /// Sets up the contact for a `speed` in m/s, a `period` in m and `heights` in m on
    /// equidistant points of the period; their mean is removed.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a period that is not positive, a speed that is not
    /// finite or a number of points outside [`POINTS_RANGE`]; [`ContactError::BadHeight`];
    /// [`ContactError::Rubber`] for numbers that no rubber has, or if the modulus is not known at the
    /// frequency of a wave of the grid.
    pub fn new(
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        heights: &[f64],
    ) -> Result<Self, ContactError> {
        Self::new_interruptible(rubber, speed, period, heights, &Interrupt::default())
    }

    /// As [`Self::new`], with an interrupt that ends the set-up, which takes seconds on millions of points, and
    /// later a solve between two Krylov iterations.
    ///
    /// # Errors
    /// As [`Self::new`]; [`ContactError::Interrupted`].
    pub fn new_interruptible(
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        heights: &[f64],
        interrupt: &Interrupt,
    ) -> Result<Self, ContactError> {
        check(rubber, speed, period, heights)?;
        let centred = remove_mean(heights);
        let extremes = centred.iter().fold((0.0_f64, 0.0_f64), |(a, b), z| (a.min(*z), b.max(*z)));
        let mut planner = RealFftPlanner::new();
        let mut grid = |heights| -> Result<Grid, ContactError> {
            check_interrupt(interrupt)?;
            Ok(Grid::new(&mut planner, rubber, speed, period, heights)?)
        };
        let mut finest = grid(centred)?;
        let mut coarser = Vec::new();
        let mut coarsest = &finest.heights;
        while coarsest.len() >= 2 * COARSEST_POINTS {
            coarser.push(grid(coarsen(coarsest))?);
            coarsest = coarser.last().map_or(&finest.heights, |grid: &Grid| &grid.heights);
        }
        coarser.reverse();
        let slopes = finest.space.slope(&finest.heights);
        let (height_range, interrupt) = (extremes.1 - extremes.0, interrupt.clone());
        Ok(Self { speed, coarser, finest, slopes, height_range, interrupt })
    }

    /// Number of points of the finest grid.
    pub fn points(&self) -> usize {
        self.slopes.len()
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a pressure that is not positive and finite;
    /// [`ContactError::NotConverged`] if the residual stays above [`RESIDUAL_TOLERANCE`];
    /// [`ContactError::Interrupted`].
    pub fn solve(&mut self, mean_pressure: f64) -> Result<ContactSolution, ContactError> {
        if !(mean_pressure > 0.0 && mean_pressure.is_finite()) {
            return Err(ContactError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: mean_pressure,
                range: "positive and finite",
            });
        }
        check_interrupt(&self.interrupt)?;
        if let Some(solution) = self.full_contact(mean_pressure) {
            return self.accept(solution, None);
        }
        let (solution, outcome) = self.partial_contact(mean_pressure)?;
        self.accept(solution, Some(outcome))
    }

    /// Returns a solution only if its residual, evaluated anew, is small enough: the iteration may have stalled above
    /// the tolerance, and full contact under a pressure beyond the reach of double precision has a large residual too.
    fn accept(
        &self,
        solution: ContactSolution,
        outcome: Option<Outcome>,
    ) -> Result<ContactSolution, ContactError> {
        let rests = outcome.is_none_or(|outcome| outcome.converged);
        if rests && solution.residual <= RESIDUAL_TOLERANCE {
            return Ok(solution);
        }
        Err(ContactError::NotConverged {
            pressure: solution.mean_pressure,
            speed: self.speed,
            points: self.points(),
            residual: solution.residual,
            iterations: solution.iterations,
            changes: outcome.map_or(0, |outcome| outcome.changes),
        })
    }

    /// Peak-to-valley height of the profile in m.
    pub fn height_range(&self) -> f64 {
        self.height_range
    }

    /// Smallest mean pressure in Pa at which the pressure is nowhere a tension in full contact;
    /// zero for a flat profile.
    pub fn smallest_full_contact_pressure(&mut self) -> f64 {
        -self.full_contact_pressure().into_iter().fold(0.0, f64::min)
    }

    /// Full contact, where the pressure follows from the heights directly; `None` if it would be a tension somewhere.
    pub(super) fn full_contact(&mut self, mean_pressure: f64) -> Option<ContactSolution> {
        let pressure = self.full_contact_pressure();
        if pressure.iter().any(|t| mean_pressure + t < 0.0) {
            return None;
        }
        let finest = &mut self.finest;
        let fields = Fields {
            mean_pressure,
            mean_separation: 0.0,
            pressure: pressure.iter().map(|t| mean_pressure + t).collect(),
            heights: &finest.heights,
            slopes: &self.slopes,
            edges: &finest.edges,
        };
        let mut solution = fields.evaluate(&mut finest.space);
        // A pressure that just vanishes somewhere leaves no gap there either.
        solution.contact_area_fraction = 1.0;
        Some(solution)
    }

    /// The mean-free part of the pressure in full contact, in Pa.
    pub(super) fn full_contact_pressure(&mut self) -> Vec<f64> {
        let mut pressure = vec![0.0; self.points()];
        self.finest.space.pressure(&self.finest.heights, &mut pressure);
        pressure
    }

    /// As [`Self::solve`], from the pressures in Pa of a contact that is near on the same grid, such as that with slightly other
    /// moduli: their contact set is where the iteration begins, in place of the coarser grids. The solution is the same
    /// within [`RESIDUAL_TOLERANCE`]. Where it does not converge, it is solved from scratch.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`ContactError::OutOfRange`] if the number of pressures is not that of the points.
    pub fn solve_near(
        &mut self,
        mean_pressure: f64,
        pressure: &[f64],
    ) -> Result<ContactSolution, ContactError> {
        if pressure.len() != self.points() {
            let (quantity, value) = ("the number of pressures", pressure.len() as f64);
            return Err(ContactError::OutOfRange { quantity, value, range: "that of the points" });
        }
        let usable = mean_pressure > 0.0 && pressure.iter().any(|t| *t > 0.0);
        if !usable || self.full_contact(mean_pressure).is_some() {
            return self.solve(mean_pressure);
        }
        let solved = self.on_finest(mean_pressure, pressure.to_vec(), 0.0);
        match solved.and_then(|(solution, outcome)| self.accept(solution, Some(outcome))) {
            Err(ContactError::NotConverged { .. }) => self.solve(mean_pressure),
            other => other,
        }
    }

    fn partial_contact(
        &mut self,
        mean_pressure: f64,
    ) -> Result<(ContactSolution, Outcome), ContactError> {
        let points = self.points();
        let coarsest = self.coarser.first().unwrap_or(&self.finest);
        let mut pressure = vec![mean_pressure; coarsest.heights.len()];
        let mut coarser_edges = coarsest.edges.clone();
        let mut applications = 0.0;
        for grid in &mut self.coarser {
            let start = refine(&pressure, &coarser_edges, grid.heights.len());
            let mut contact = grid.contact(start, mean_pressure, &self.interrupt);
            let outcome = contact.solve(Goal::Start);
            check_interrupt(&self.interrupt)?;
            pressure = contact.pressure;
            applications += (outcome.applications * grid.heights.len()) as f64 / points as f64;
            coarser_edges.clone_from(&grid.edges);
        }
        let start = refine(&pressure, &coarser_edges, points);
        self.on_finest(mean_pressure, start, applications)
    }

    /// The contact on the finest grid from pressures there that have cost some `applications` of the operator.
    fn on_finest(
        &mut self,
        mean_pressure: f64,
        start: Vec<f64>,
        applications: f64,
    ) -> Result<(ContactSolution, Outcome), ContactError> {
        let mut contact = self.finest.contact(start, mean_pressure, &self.interrupt);
        let outcome = contact.solve(Goal::Solution { tolerance: INNER_TOLERANCE });
        check_interrupt(&self.interrupt)?;
        let (mean_separation, pressure) = (contact.mean_separation, contact.pressure);
        let Self { finest, slopes, .. } = self;
        let Grid { space, heights, edges, .. } = finest;
        let fields = Fields { mean_pressure, mean_separation, pressure, heights, slopes, edges };
        let mut solution = fields.evaluate(space);
        solution.iterations = outcome.iterations;
        solution.operator_applications = applications + outcome.applications as f64;
        Ok((solution, outcome))
    }
}

impl Grid {
    fn new(
        planner: &mut RealFftPlanner<f64>,
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        heights: Vec<f64>,
    ) -> Result<Self, RubberError> {
        let points = heights.len();
        let mut space = HalfSpace::new(planner, rubber, speed, period, points)?;
        let mut unit = vec![0.0; points];
        unit[0] = 1.0;
        let mut kernel = vec![0.0; points];
        space.displacement(&unit, &mut kernel);
        let edges = EdgeReader::new(rubber, speed, period / points as f64);
        Ok(Self { space, heights, kernel, edges })
    }

    /// The contact on this grid, to be solved from a `pressure` in Pa.
    fn contact<'a>(
        &'a mut self,
        pressure: Vec<f64>,
        mean_pressure: f64,
        interrupt: &'a Interrupt,
    ) -> Contact<'a> {
        Contact {
            displacement: vec![0.0; self.heights.len()],
            pressure,
            space: &mut self.space,
            heights: &self.heights,
            kernel: &self.kernel,
            mean_pressure,
            mean_separation: 0.0,
            interrupt,
        }
    }
}

/// # Errors
/// [`ContactError::Interrupted`] after an interrupt.
pub(crate) fn check_interrupt(interrupt: &Interrupt) -> Result<(), ContactError> {
    if interrupt.is_set() { Err(ContactError::Interrupted) } else { Ok(()) }
}

pub(crate) fn check(
    rubber: &dyn Viscoelastic,
    speed: f64,
    period: f64,
    heights: &[f64],
) -> Result<(), ContactError> {
    let out_of_range =
        |quantity, value, range| Err(ContactError::OutOfRange { quantity, value, range });
    if let Err(error) = rubber.validate() {
        return Err(ContactError::Rubber(error));
    }
    if !(period > 0.0 && period.is_finite()) {
        return out_of_range("the period in m", period, "positive and finite");
    }
    if !speed.is_finite() {
        return out_of_range("the speed in m/s", speed, "finite");
    }
    if !POINTS_RANGE.contains(&heights.len()) {
        return out_of_range("the number of points", heights.len() as f64, "8 to 16777216");
    }
    match heights.iter().position(|z| !z.is_finite()) {
        Some(index) => Err(ContactError::BadHeight { index, value: heights[index] }),
        None => Ok(()),
    }
}

/// Heights about their mean. One height is subtracted first, so that a flat profile becomes zero
/// and not the round-off of its mean.
pub(crate) fn remove_mean(heights: &[f64]) -> Vec<f64> {
    let first = heights[0];
    let mean = heights.iter().map(|z| z - first).sum::<f64>() / heights.len() as f64;
    heights.iter().map(|z| z - first - mean).collect()
}

/// The profile on half as many points: every second one of an even grid, between two points of an
/// odd one.
pub(crate) fn coarsen(heights: &[f64]) -> Vec<f64> {
    resample(heights, heights.len() / 2)
}

/// The pressure on a finer grid of the same period, linear between points and without those new
/// points that lie beyond the contact edge as read on the coarse grid.
fn refine(pressure: &[f64], edges: &EdgeReader, points: usize) -> Vec<f64> {
    let n = pressure.len();
    let mut fine = resample(pressure, points);
    if points == n {
        return fine;
    }
    for (i, t) in fine.iter_mut().enumerate() {
        let position = (i * n) as f64 / points as f64;
        let left = position as usize;
        let from_left = position - left as f64;
        let at = |k: usize| pressure[k % n];
        let beyond = match (at(left) > 0.0, at(left + 1) > 0.0) {
            (true, false) => from_left > edges.overhang_after(pressure, left),
            (false, true) => 1.0 - from_left > edges.overhang_before(pressure, (left + 1) % n),
            _ => false,
        };
        if beyond {
            *t = 0.0;
        }
    }
    fine
}

/// Values on another number of points of the same period, linear between points.
pub fn resample(values: &[f64], points: usize) -> Vec<f64> {
    let n = values.len();
    (0..points)
        .map(|i| {
            let position = (i * n) as f64 / points as f64;
            let left = position as usize;
            let weight = position - left as f64;
            (1.0 - weight) * values[left] + weight * values[(left + 1) % n]
        })
        .collect()
}

#[cfg(test)]
mod tests;
