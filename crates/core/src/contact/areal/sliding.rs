//! The areal contact on nested grids.

use super::super::ContactError;
use super::super::sliding::{INNER_TOLERANCE, RESIDUAL_TOLERANCE, check_interrupt};
use super::super::solution::displacement_scale;
use super::active_set::{Contact, Goal, Outcome};
use super::edges::ArealEdges;
use super::half_space::{ArealHalfSpace, Body, Sliding, mean};
use super::linear::kept;
use super::solution::{ArealSolution, Fields};
use super::surface::{ArealSurface, coarser, prolong, resample};
use crate::numerics::Interrupt;
use crate::rubber::{FrequencyRange, Viscoelastic};

/// A rubber that slides at constant velocity over a rigid surface.
#[derive(Clone, Copy)]
pub struct ArealSetup<'a> {
    /// The rubber. Elastic without branches, or at speed zero.
    pub rubber: &'a dyn Viscoelastic,
    /// Speed and direction.
    pub sliding: Sliding,
    /// The rigid surface.
    pub surface: ArealSurface<'a>,
    /// Thickness in m of a rubber layer that is bonded to a rigid base; a half-space if `None`.
    pub thickness: Option<f64>,
    /// Most memory in bytes that [`memory_bytes`] may estimate; no limit if `None`.
    pub memory_limit: Option<u64>,
}

/// Numbers of eight bytes per grid point that a solve holds beside the directions of the linear solver: four of spectra and
/// symbol, nine of fields, five on the contact set, and two for the coarser grids.
const NUMBERS_PER_POINT: u64 = 20;

/// Estimated most memory in bytes of a solve on a grid of `nx` by `ny` points, for contact everywhere: 240 bytes a point,
/// 4.0e9 for 4096 by 4096, on large grids; up to 640 bytes a point on those below 1000 by 1000.
pub fn memory_bytes(nx: usize, ny: usize) -> u64 {
    let points = nx.saturating_mul(ny);
    let fields = NUMBERS_PER_POINT.saturating_mul(points as u64);
    fields.saturating_add(kept(points) as u64).saturating_mul(8)
}

/// Largest step in the logarithm of the pressure where it falls from that of full contact.
const PRESSURE_STEP: f64 = 0.15;

/// One of the nested grids.
struct Grid {
    space: ArealHalfSpace,
    heights: Vec<f64>,
}

/// What a solve on a grid starts from.
struct Start {
    /// Pressures in Pa that are positive on a guess of the contact set.
    pressure: Vec<f64>,
    /// Guess of the root mean square displacement in m; that of the heights if `None`.
    scale: Option<f64>,
    /// What the guess has cost, in pairs of transforms of the finest grid.
    cost: f64,
}

/// A rubber half-space, or layer, sliding at constant velocity over a rigid surface that is periodic in both directions.
///
/// Operators and transforms are kept, so that further pressures cost no set-up. Every [`Self::solve`] starts from scratch
/// on the coarsest grid: its result does not depend on what was solved before.
pub struct ArealContact {
    speed: f64,
    /// Grids that a solve starts on, the coarsest first.
    coarser: Vec<Grid>,
    finest: Grid,
    edges: ArealEdges,
    mean_compliance: f64,
    interrupt: Interrupt,
}

impl ArealContact {
    /// Sets up the contact.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a speed, angle, thickness, period or number of points out of range, or too
    /// much memory; [`ContactError::BadHeightOfSurface`]; [`ContactError::Rubber`] for numbers that no rubber has, or if
    /// the modulus is not known at the frequencies that the waves along both directions of the grid excite. Waves
    /// across the sliding direction excite none: they take the modulus at the lowest frequency that is known.
    pub fn new(setup: &ArealSetup) -> Result<Self, ContactError> {
        Self::new_interruptible(setup, &Interrupt::default())
    }

    /// As [`Self::new`], with an interrupt that ends the set-up between two grids, and later a solve between two
    /// Krylov iterations.
    ///
    /// # Errors
    /// As [`Self::new`]; [`ContactError::Interrupted`].
    pub fn new_interruptible(
        setup: &ArealSetup,
        interrupt: &Interrupt,
    ) -> Result<Self, ContactError> {
        setup.check()?;
        let body = Body {
            rubber: setup.rubber,
            sliding: setup.sliding,
            periods: setup.surface.periods,
            thickness: setup.thickness,
        };
        let points = setup.surface.points;
        let mut finest = Grid::new(body, points, setup.surface.centred(), interrupt)?;
        let mut grids = Vec::new();
        while let Some(next) = coarser(finest.space.points()) {
            let heights = resample(&finest.heights, finest.space.points(), next);
            let coarse = Grid::new(body, next, heights, interrupt)?;
            grids.push(std::mem::replace(&mut finest, coarse));
        }
        // The finest grid was put first, the coarsest is held.
        grids.push(finest);
        grids.reverse();
        let finest = grids.pop().expect("one grid at least");
        Ok(Self {
            speed: setup.sliding.speed,
            coarser: grids,
            finest,
            edges: ArealEdges::new(&body, points),
            mean_compliance: body.mean_compliance(),
            interrupt: interrupt.clone(),
        })
    }

    /// Points `[nx, ny]` of the finest grid.
    pub fn points(&self) -> [usize; 2] {
        self.finest.space.points()
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a pressure that is not positive and finite; [`ContactError::NotConverged`] if the
    /// residual stays above [`RESIDUAL_TOLERANCE`]; [`ContactError::Interrupted`].
    pub fn solve(&mut self, mean_pressure: f64) -> Result<ArealSolution, ContactError> {
        if !(mean_pressure > 0.0 && mean_pressure.is_finite()) {
            return Err(ContactError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: mean_pressure,
                range: "positive and finite",
            });
        }
        check_interrupt(&self.interrupt)?;
        let full = self.full_contact_pressure();
        if full.iter().all(|t| mean_pressure + t >= 0.0) {
            let pressure = full.iter().map(|t| mean_pressure + t).collect();
            let mut solution = self.evaluate(mean_pressure, 0.0, pressure);
            // A pressure that just vanishes somewhere leaves no gap there either.
            solution.contact_area_fraction = 1.0;
            solution.contact_area_error = 0.0;
            return self.accept(solution, None);
        }
        drop(full);
        let start = self.start(mean_pressure)?;
        match self.solve_from(mean_pressure, start) {
            Err(ContactError::NotConverged { .. }) => self.solve_from_full_contact(mean_pressure),
            other => other,
        }
    }

    /// As [`Self::solve`], by a fall of the pressure from full contact in steps, whose contact sets are close to each
    /// other. Where nearly all of the modulus is loss, sets from far away do not settle.
    fn solve_from_full_contact(
        &mut self,
        mean_pressure: f64,
    ) -> Result<ArealSolution, ContactError> {
        let full = self.full_contact_pressure();
        let highest = -full.iter().fold(0.0, |a: f64, b| a.min(*b));
        let mut pressure: Vec<f64> = full.iter().map(|t| highest + t).collect();
        drop(full);
        let steps = ((highest / mean_pressure).ln() / PRESSURE_STEP).ceil().max(1.0);
        let (mut cost, mut scale) = (0.0, None);
        for step in 1..steps as usize {
            let p = highest * (mean_pressure / highest).powf(step as f64 / steps);
            let factor = p / mean(&pressure);
            pressure.iter_mut().for_each(|t| *t *= factor);
            let mut contact = self.finest.contact(pressure, p, scale, &self.interrupt);
            cost += contact.solve(Goal::Start).pairs as f64;
            check_interrupt(&self.interrupt)?;
            (pressure, scale) = (contact.pressure, Some(contact.scale));
        }
        self.solve_from(mean_pressure, Start { pressure, scale, cost })
    }

    /// As [`Self::solve`], from pressures at another mean pressure: their contact set is near the one sought.
    pub(super) fn solve_near(
        &mut self,
        mean_pressure: f64,
        pressure: Vec<f64>,
    ) -> Result<ArealSolution, ContactError> {
        let factor = mean_pressure / mean(&pressure);
        let start = pressure.into_iter().map(|t| factor * t).collect();
        self.solve_from(mean_pressure, Start { pressure: start, scale: None, cost: 0.0 })
    }

    /// Mean-free pressures in Pa of full contact.
    pub(super) fn full_contact_pressure(&mut self) -> Vec<f64> {
        self.finest.space.pressure(&self.finest.heights)
    }

    /// Smallest mean pressure in Pa at which the pressure is nowhere a tension in full contact; zero for a flat surface.
    pub fn smallest_full_contact_pressure(&mut self) -> f64 {
        -self.full_contact_pressure().into_iter().fold(0.0, f64::min)
    }

    /// A start on the finest grid from a solve on the coarser ones.
    fn start(&mut self, mean_pressure: f64) -> Result<Start, ContactError> {
        let finest = self.points();
        let mut points = self.coarser.first().map_or(finest, |grid| grid.space.points());
        let mut pressure = vec![mean_pressure; points[0] * points[1]];
        let (mut cost, mut scale) = (0.0, None);
        for grid in &mut self.coarser {
            let next = grid.space.points();
            let start = prolong(&pressure, points, next);
            let mut contact = grid.contact(start, mean_pressure, scale, &self.interrupt);
            let outcome = contact.solve(Goal::Start);
            check_interrupt(&self.interrupt)?;
            (pressure, scale) = (contact.pressure, Some(contact.scale));
            points = next;
            cost += outcome.pairs as f64 * pressure.len() as f64;
        }
        let total = (finest[0] * finest[1]) as f64;
        Ok(Start { pressure: prolong(&pressure, points, finest), scale, cost: cost / total })
    }

    fn solve_from(
        &mut self,
        mean_pressure: f64,
        start: Start,
    ) -> Result<ArealSolution, ContactError> {
        let Start { pressure, scale, cost } = start;
        let mut contact = self.finest.contact(pressure, mean_pressure, scale, &self.interrupt);
        let outcome = contact.solve(Goal::Solution { tolerance: INNER_TOLERANCE });
        check_interrupt(&self.interrupt)?;
        let (mean_separation, pressure) = (contact.mean_separation, contact.pressure);
        let mut solution = self.evaluate(mean_pressure, mean_separation, pressure);
        solution.iterations = outcome.iterations;
        solution.operator_applications = cost + outcome.pairs as f64;
        self.accept(solution, Some(outcome))
    }

    fn evaluate(
        &mut self,
        mean_pressure: f64,
        mean_separation: f64,
        pressure: Vec<f64>,
    ) -> ArealSolution {
        let Grid { space, heights } = &mut self.finest;
        let (edges, mean_compliance) = (&self.edges, self.mean_compliance);
        let fields =
            Fields { mean_pressure, mean_separation, mean_compliance, pressure, heights, edges };
        fields.evaluate(space)
    }

    /// Returns a solution only if its residual, evaluated anew, is small enough.
    fn accept(
        &self,
        solution: ArealSolution,
        outcome: Option<Outcome>,
    ) -> Result<ArealSolution, ContactError> {
        let settled = outcome.is_none_or(|outcome| outcome.converged);
        if settled && solution.residual <= RESIDUAL_TOLERANCE {
            return Ok(solution);
        }
        Err(ContactError::NotConverged {
            pressure: solution.mean_pressure,
            speed: self.speed,
            points: solution.pressure.len(),
            residual: solution.residual,
            iterations: solution.iterations,
            changes: outcome.map_or(0, |outcome| outcome.changes),
        })
    }
}

impl ArealSetup<'_> {
    fn check(&self) -> Result<(), ContactError> {
        let out_of_range =
            |quantity, value, range| Err(ContactError::OutOfRange { quantity, value, range });
        if let Err(error) = self.rubber.validate() {
            return Err(ContactError::Rubber(error));
        }
        let Sliding { speed, angle } = self.sliding;
        if !speed.is_finite() {
            return out_of_range("the speed in m/s", speed, "finite");
        }
        if !angle.is_finite() {
            return out_of_range("the sliding angle in rad", angle, "finite");
        }
        if let Some(thickness) = self.thickness.filter(|h| !(*h > 0.0 && h.is_finite())) {
            return out_of_range("the thickness in m", thickness, "positive and finite");
        }
        self.surface.check()?;
        let needed = memory_bytes(self.surface.points[0], self.surface.points[1]);
        if let Some(limit) = self.memory_limit.filter(|limit| needed > *limit) {
            return Err(ContactError::TooMuchMemory { needed, limit });
        }
        self.require_modulus()
    }

    /// Checks that the modulus is known at the frequencies of the waves along both directions of the grid.
    fn require_modulus(&self) -> Result<(), ContactError> {
        let velocity = self.sliding.velocity();
        let (mut slowest, mut fastest) = (f64::INFINITY, 0.0);
        for (axis, speed) in velocity.iter().enumerate().filter(|(_, speed)| **speed != 0.0) {
            let (period, points) = (self.surface.periods[axis], self.surface.points[axis]);
            slowest = f64::min(slowest, speed.abs() / period);
            // Waves of the sum of both wavenumbers excite the sum of both frequencies.
            fastest += speed.abs() / (period / (points / 2) as f64);
        }
        if slowest.is_infinite() {
            slowest = 0.0;
        }
        self.rubber.require(FrequencyRange { lowest_hz: slowest, highest_hz: fastest })?;
        Ok(())
    }
}

impl Grid {
    fn new(
        body: Body,
        points: [usize; 2],
        heights: Vec<f64>,
        interrupt: &Interrupt,
    ) -> Result<Self, ContactError> {
        check_interrupt(interrupt)?;
        Ok(Self { space: ArealHalfSpace::new(body, points), heights })
    }

    /// The contact on this grid, to be solved from a `pressure` in Pa.
    fn contact<'a>(
        &'a mut self,
        pressure: Vec<f64>,
        mean_pressure: f64,
        scale: Option<f64>,
        interrupt: &'a Interrupt,
    ) -> Contact<'a> {
        let scale = scale.unwrap_or_else(|| displacement_scale(&self.heights, &self.heights));
        Contact {
            displacement: vec![0.0; self.heights.len()],
            pressure,
            space: &mut self.space,
            heights: &self.heights,
            mean_pressure,
            mean_separation: 0.0,
            scale,
            interrupt,
        }
    }
}
