//! The sliding contact of the macro surface under a local law, on nested grids.

use super::error::SoftContactError;
use super::law::LocalLaw;
use super::newton::{Newton, Outcome, State};
use super::solution::{Fields, SoftContactSolution};
use crate::contact::ContactError;
use crate::contact::half_space::HalfSpace;
use crate::contact::sliding::{
    COARSEST_POINTS, INNER_TOLERANCE, RESIDUAL_TOLERANCE, check, check_interrupt, coarsen,
    remove_mean, resample,
};
use crate::numerics::Interrupt;
use crate::rubber::{RubberError, Viscoelastic};
use realfft::RealFftPlanner;

/// Residual at which the iteration on a coarser grid ends.
const START_TOLERANCE: f64 = 1e-4;
/// Factor from one softened law to the next harder one, and their number; the last step is to
/// the law itself.
const SOFTENING_FACTOR: f64 = 0.2;
const SOFTENED_LAWS: usize = 12;

/// A rubber half-space that slides at constant speed over the long waves of a rigid profile, whose short waves are
/// represented by a [`LocalLaw`].
///
/// Operators and transforms are kept. Every solve starts from scratch on the coarsest grid: its
/// result does not depend on what was solved before.
///
/// ```
/// use asperity_core::multiscale::{LawEnd, LocalLaw, SoftContact};
/// use asperity_core::rubber::Rubber;
/// use asperity_core::surface::{Wave, wave};
///
/// let period = 1e-3;
/// let profile = wave::sample(&[Wave { wavelength: period, amplitude: 1e-6, phase: 0.0 }], period, 64);
/// let law = LocalLaw::new(2e-5, &[1e6], &[1e-5], LawEnd::PartialContact)?; // 10 µm per MPa
/// let mut contact = SoftContact::new(&Rubber::elastic(3e6, 0.5), 0.01, period, &profile, law)?;
/// let solution = contact.solve(4e5)?;
/// assert_eq!(solution.contact_points, 64);
/// // Full contact under a linear law: ubar = g(0) - c p.
/// assert!((solution.mean_separation - 1.6e-5).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SoftContact {
    speed: f64,
    law: LocalLaw,
    /// Grids that a solve starts on, the coarsest first.
    coarser: Vec<Grid>,
    finest: Grid,
    slopes: Vec<f64>,
    interrupt: Interrupt,
}

struct Grid {
    space: HalfSpace,
    heights: Vec<f64>,
    kernel: Vec<f64>,
}

impl SoftContact {
    /// Sets up the contact for a `speed` in m/s, a `period` in m and macro `heights` in m on
    /// equidistant points of the period; their mean is removed.
    ///
    /// # Errors
    /// As [`crate::contact::SlidingContact::new`].
    pub fn new(
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        heights: &[f64],
        law: LocalLaw,
    ) -> Result<Self, SoftContactError> {
        Self::new_interruptible(rubber, speed, period, heights, law, &Interrupt::default())
    }

    /// As [`Self::new`], with an interrupt that ends the set-up, and later a solve between two Krylov iterations.
    ///
    /// # Errors
    /// As [`crate::contact::SlidingContact::new_interruptible`].
    pub fn new_interruptible(
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        heights: &[f64],
        law: LocalLaw,
        interrupt: &Interrupt,
    ) -> Result<Self, SoftContactError> {
        check(rubber, speed, period, heights)?;
        let mut planner = RealFftPlanner::new();
        let mut grid = |heights| -> Result<Grid, SoftContactError> {
            check_interrupt(interrupt)?;
            Ok(Grid::new(&mut planner, rubber, speed, period, heights)
                .map_err(ContactError::Rubber)?)
        };
        let mut finest = grid(remove_mean(heights))?;
        let mut coarser = Vec::new();
        let mut coarsest = &finest.heights;
        while coarsest.len() >= 2 * COARSEST_POINTS {
            coarser.push(grid(coarsen(coarsest))?);
            coarsest = coarser.last().map_or(&finest.heights, |grid: &Grid| &grid.heights);
        }
        coarser.reverse();
        let slopes = finest.space.slope(&finest.heights);
        Ok(Self { speed, law, coarser, finest, slopes, interrupt: interrupt.clone() })
    }

    /// Number of points of the finest grid.
    pub fn points(&self) -> usize {
        self.slopes.len()
    }

    /// The local law.
    pub fn law(&self) -> &LocalLaw {
        &self.law
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`SoftContactError::Contact`] for a pressure that is not positive and finite;
    /// [`SoftContactError::Law`] if a local pressure lies beyond the samples of the law;
    /// [`SoftContactError::NotConverged`] if the residual stays above
    /// [`RESIDUAL_TOLERANCE`].
    pub fn solve(&mut self, mean_pressure: f64) -> Result<SoftContactSolution, SoftContactError> {
        if !(mean_pressure > 0.0 && mean_pressure.is_finite()) {
            return Err(SoftContactError::Contact(ContactError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: mean_pressure,
                range: "positive and finite",
            }));
        }
        let points = self.points();
        let mut known: Option<(State, f64)> = None;
        let mut applications = 0.0;
        for grid in &mut self.coarser {
            let n = grid.heights.len();
            let mut newton = grid.newton(&self.law, mean_pressure, &self.interrupt);
            let mut state = start(&newton, known.take());
            let (outcome, _) = solve_grid(&mut newton, &mut state, START_TOLERANCE);
            check_interrupt(&self.interrupt)?;
            applications += (outcome.krylov_iterations * n) as f64 / points as f64;
            known = Some((state, newton.coordinate_compliance()));
        }
        let mut newton = self.finest.newton(&self.law, mean_pressure, &self.interrupt);
        let mut state = start(&newton, known);
        let (outcome, softened) = solve_grid(&mut newton, &mut state, INNER_TOLERANCE);
        check_interrupt(&self.interrupt)?;
        applications += (outcome.krylov_iterations * points) as f64 / points as f64;
        let mut solution = self.judge(mean_pressure, state)?;
        solution.iterations = outcome.iterations;
        solution.operator_applications = applications;
        solution.softened = softened;
        self.accept(solution)
    }

    fn judge(
        &mut self,
        mean_pressure: f64,
        state: State,
    ) -> Result<SoftContactSolution, SoftContactError> {
        let grid = &mut self.finest;
        let fields = Fields {
            mean_pressure,
            approach: state.approach,
            pressure: state.pressure,
            heights: &grid.heights,
            slopes: &self.slopes,
            law: &self.law,
        };
        fields
            .evaluate(&mut grid.space)
            .map_err(|source| SoftContactError::Law { mean_pressure, source })
    }

    fn accept(
        &self,
        solution: SoftContactSolution,
    ) -> Result<SoftContactSolution, SoftContactError> {
        if solution.residual <= RESIDUAL_TOLERANCE {
            return Ok(solution);
        }
        Err(SoftContactError::NotConverged {
            mean_pressure: solution.mean_pressure,
            speed: self.speed,
            points: self.points(),
            residual: solution.residual,
            iterations: solution.iterations,
        })
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
        Ok(Self { space, heights, kernel })
    }

    fn newton<'a>(
        &'a mut self,
        law: &'a LocalLaw,
        mean_pressure: f64,
        interrupt: &'a Interrupt,
    ) -> Newton<'a> {
        Newton {
            space: &mut self.space,
            heights: &self.heights,
            kernel: &self.kernel,
            law,
            mean_pressure,
            softening: 0.0,
            load_length: 0.0,
            interrupt,
        }
    }
}

/// Solves on one grid: directly, or if that does not converge by a sequence of softened laws from one softer than the
/// half-space, each started from the last.
fn solve_grid(newton: &mut Newton, state: &mut State, tolerance: f64) -> (Outcome, bool) {
    let mut total = newton.solve(state, tolerance);
    if total.converged {
        return (total, false);
    }
    *state = flat_start(newton);
    let softest = newton.space.compliance_range().0;
    for law in 0..=SOFTENED_LAWS {
        let last = law == SOFTENED_LAWS;
        let before = newton.softening;
        newton.softening = if last { 0.0 } else { softest * SOFTENING_FACTOR.powi(law as i32) };
        for (s, p) in state.line.iter_mut().zip(&state.pressure) {
            *s += (newton.softening - before) * p;
        }
        let goal = if last { tolerance } else { START_TOLERANCE };
        let outcome = newton.solve(state, goal);
        total.converged = outcome.converged;
        total.iterations += outcome.iterations;
        total.krylov_iterations += outcome.krylov_iterations;
        if newton.interrupt.is_set() {
            break;
        }
    }
    (total, true)
}

/// The state that a grid starts from: that of the coarser grid with its compliance, or the mean pressure.
fn start(newton: &Newton, coarser: Option<(State, f64)>) -> State {
    match coarser {
        Some((state, compliance)) => refine(newton, &state, compliance),
        None => flat_start(newton),
    }
}

/// The mean pressure everywhere.
fn flat_start(newton: &Newton) -> State {
    let p = newton.mean_pressure;
    let indentation = newton.law.indentation(p);
    let line = newton.coordinate_compliance() * p + indentation;
    let n = newton.heights.len();
    State { line: vec![line; n], approach: indentation, pressure: vec![p; n] }
}

/// A state on a finer grid: `s` is interpolated on the line of the coarser grid, where it changes
/// its sign at a contact edge, and the points of the law found there are put on the finer line.
fn refine(newton: &Newton, coarse: &State, coarse_compliance: f64) -> State {
    let n = newton.heights.len();
    let c = newton.coordinate_compliance();
    let guess = resample(&coarse.pressure, n);
    let mut line = resample(&coarse.line, n);
    let mut pressure = vec![0.0; n];
    for i in 0..n {
        let point = newton.law.on_line(coarse_compliance, line[i], guess[i]);
        line[i] = c * point.pressure + point.indentation;
        pressure[i] = point.pressure;
    }
    State { line, approach: coarse.approach, pressure }
}
