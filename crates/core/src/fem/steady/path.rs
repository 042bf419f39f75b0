//! From a slight contact to a pressure, and from the barrier to the exact contact.

use super::NotConverged;
use super::level::{Cost, Level};
use super::newton::Target;
use super::state::State;
use super::transfer::transfer;

/// Barrier of a path, as a share of mean force times roughness.
pub(super) const BARRIER: f64 = 3e-2;

/// Barrier with which a block is put above the profile.
const FIRST_BARRIER: f64 = 0.3;
/// Residual of a point with the barrier, and of a solution.
const LOOSE: f64 = 1e-2;
pub(super) const EXACT: f64 = 1e-9;
/// Residual of an exact contact that a finer grid starts from.
pub(super) const EXACT_ENOUGH: f64 = 1e-5;
/// Most Newton steps for a point of a path, for the first one, on a new grid, and to the exact contact.
const MOST_STEPS: usize = 14;
const MOST_FIRST_STEPS: usize = 20;
const MOST_STEPS_ON_NEW_GRID: usize = 25;
const MOST_STEPS_TO_EXACT: usize = 25;
/// What the first pressure is divided by, one after the other, until it converges.
const FIRST_DIVISORS: [f64; 4] = [1.0, 6.0, 36.0, 216.0];
/// Ratio of the first pressures, and the largest one.
const FIRST_RATIO: f64 = 2.0;
const LARGEST_RATIO: f64 = 4.0;
/// Newton steps below which the next ratio of pressures is larger.
const EASY: usize = 8;
/// Ratio of pressures at which a path is given up.
const SMALLEST_RATIO: f64 = 1.02;
/// Factors of the barrier: the first one, the smallest, and the one at which it is given up.
const LESS_BARRIER: f64 = 0.1;
const LITTLE_LESS_BARRIER: f64 = 0.93;
/// States kept on a level.
const MOST_KEPT: usize = 16;
/// Logarithm of the ratio of pressures up to which an exact contact is found from another, and the barrier
/// on the way.
const NEARBY: f64 = 0.35;
const NEARBY_BARRIER: f64 = 1e-3;
/// Step in ln p at which that is given up.
const SMALLEST_NEARBY: f64 = 5e-3;
/// Newton steps below which the next step in ln p is longer, and how much.
const EASY_NEARBY: usize = 5;
const LONGER: f64 = 1.5;
/// Attempts at the exact contact, each from a smaller barrier.
const MOST_CLOSINGS: usize = 6;

/// A level with a state under the barrier.
pub(super) struct Path {
    pub level: Level,
    pub state: State,
    ratio: f64,
    /// States passed before, of other pressures.
    passed: Vec<State>,
    /// The exact contact found last.
    exact: Option<State>,
    /// The last successful step in ln p from one exact contact to the next.
    step: f64,
}

/// Where a path is, on its grid.
pub(super) struct Place {
    state: State,
    ratio: f64,
    passed: Vec<State>,
    exact: Option<State>,
    step: f64,
}

impl Path {
    /// The first contact, at a small pressure, or where that fails at a smaller one.
    pub fn start(mut level: Level, pressure: f64) -> Result<Self, NotConverged> {
        for divisor in FIRST_DIVISORS {
            if let Ok(state) = first_contact(&mut level, pressure / divisor) {
                return Ok(Self {
                    level,
                    state,
                    ratio: FIRST_RATIO,
                    passed: Vec::new(),
                    exact: None,
                    step: NEARBY,
                });
            }
        }
        Err(NotConverged)
    }

    /// Takes the state to a pressure, in as few steps as it allows.
    pub fn advance_to(&mut self, pressure: f64) -> Result<(), NotConverged> {
        while self.state.pressure != pressure {
            let at = self.state.pressure;
            let next = if pressure > at {
                if at * self.ratio < pressure * 0.999 { at * self.ratio } else { pressure }
            } else if at / self.ratio > pressure * 1.001 {
                at / self.ratio
            } else {
                pressure
            };
            let before = self.state.clone();
            match self.level.solve(&mut self.state, behind(next, BARRIER)) {
                Ok((steps, _)) => {
                    self.passed.push(before);
                    if steps < EASY {
                        self.ratio = self.ratio.powf(1.5).min(LARGEST_RATIO);
                    }
                }
                Err(NotConverged) => {
                    // Half of the step that failed, which the pressure may have shortened.
                    self.ratio = (next / at).max(at / next).sqrt();
                    if self.ratio < SMALLEST_RATIO || self.level.interrupt.is_set() {
                        self.ratio = self.ratio.max(SMALLEST_RATIO);
                        return Err(NotConverged);
                    }
                }
            }
        }
        Ok(())
    }

    /// Takes the state to a pressure in one solve.
    pub fn jump_to(&mut self, pressure: f64) -> Result<(), NotConverged> {
        self.level.solve(&mut self.state, behind(pressure, BARRIER)).map(|_| ())
    }

    /// Goes back to the state passed before.
    pub fn step_back(&mut self) -> Option<()> {
        self.state = self.passed.pop()?;
        Some(())
    }

    /// Takes the state passed nearest to a pressure for the next one.
    pub fn return_towards(&mut self, pressure: f64) {
        let distance = |state: &State| (state.pressure / pressure).ln().abs();
        let nearest = (0..self.passed.len())
            .min_by(|a, b| distance(&self.passed[*a]).total_cmp(&distance(&self.passed[*b])));
        if let Some(nearest) = nearest
            && distance(&self.passed[nearest]) < distance(&self.state)
        {
            std::mem::swap(&mut self.passed[nearest], &mut self.state);
        }
        self.passed.truncate(MOST_KEPT);
    }

    /// Takes the state to another level of the same profile.
    pub fn refine(&mut self, mut level: Level) -> Result<(), NotConverged> {
        level.cost = self.level.cost;
        let mut state = transfer(&self.state, BARRIER, &self.level, &level);
        let target =
            Target { most_steps: MOST_STEPS_ON_NEW_GRID, ..behind(state.pressure, BARRIER) };
        let solved = level.solve(&mut state, target);
        if solved.is_err() {
            self.level.cost = level.cost;
            return Err(NotConverged);
        }
        *self =
            Self { level, state, ratio: self.ratio, passed: Vec::new(), exact: None, step: NEARBY };
        Ok(())
    }

    /// Solves again at the same pressure, after a change of the profile; returns the Newton steps.
    pub fn resolve(&mut self) -> Result<usize, NotConverged> {
        let target = behind(self.state.pressure, BARRIER);
        Ok(self.level.solve(&mut self.state, target)?.0)
    }

    /// The exact contact at the pressure of the path, and its residual.
    pub fn finish(&mut self, tolerance: f64) -> Result<(State, f64), NotConverged> {
        let (state, residual) = close(&mut self.level, self.state.clone(), tolerance)?;
        self.exact = Some(state.clone());
        Ok((state, residual))
    }

    /// The exact contact at a pressure near that of the one found last, in as few steps from it as the
    /// contact allows, and its residual.
    pub fn finish_nearby(&mut self, pressure: f64, tolerance: f64) -> Option<(State, f64)> {
        let mut state = self.exact.clone()?;
        let whole = (pressure / state.pressure).ln();
        if whole.abs() > NEARBY {
            return None;
        }
        let mut step = whole.signum() * self.step;
        while state.pressure != pressure {
            let left = (pressure / state.pressure).ln();
            let next = if left.abs() > 1.001 * step.abs() {
                state.pressure * step.exp()
            } else {
                pressure
            };
            if let Ok((steps, _)) = self.level.solve(&mut state, behind(next, NEARBY_BARRIER)) {
                if steps < EASY_NEARBY {
                    step *= LONGER;
                }
            } else {
                step = 0.5 * left.abs().min(step.abs()).copysign(left);
                if step.abs() < SMALLEST_NEARBY || self.level.interrupt.is_set() {
                    self.keep_behind_barrier(state);
                    return None;
                }
            }
        }
        self.step = (LONGER * step.abs()).min(NEARBY);
        let (state, residual) =
            close_from(&mut self.level, state, NEARBY_BARRIER, tolerance).ok()?;
        self.exact = Some(state.clone());
        Some((state, residual))
    }

    /// Adds a state that is nearly in exact contact to those passed, since the path continues from the nearest one.
    fn keep_behind_barrier(&mut self, state: State) {
        if let Ok(opened) = open(&mut self.level, state) {
            self.passed.push(opened);
        }
    }

    /// Where the path is, to return to.
    pub fn place(&self) -> Place {
        Place {
            state: self.state.clone(),
            ratio: self.ratio,
            passed: self.passed.clone(),
            exact: self.exact.clone(),
            step: self.step,
        }
    }

    /// Goes back to where the path was on the same grid; the work spent since is not counted.
    pub fn return_to(&mut self, place: Place) {
        let Place { state, ratio, passed, exact, step } = place;
        (self.state, self.ratio, self.passed, self.exact, self.step) =
            (state, ratio, passed, exact, step);
        self.level.cost = Cost::default();
    }

    /// The work spent since the last call.
    pub fn take_cost(&mut self) -> Cost {
        std::mem::take(&mut self.level.cost)
    }
}

fn behind(pressure: f64, barrier: f64) -> Target {
    Target { pressure, barrier, tolerance: LOOSE, most_steps: MOST_STEPS }
}

/// A block above the profile, let down on it at a pressure.
fn first_contact(level: &mut Level, pressure: f64) -> Result<State, NotConverged> {
    let mut state = level.above(pressure, FIRST_BARRIER);
    let target =
        Target { pressure, barrier: FIRST_BARRIER, tolerance: LOOSE, most_steps: MOST_FIRST_STEPS };
    level.solve(&mut state, target)?;
    reduce(level, &mut state, FIRST_BARRIER, BARRIER)?;
    Ok(state)
}

/// The exact contact and its residual, from a state behind the barrier of a path.
pub(super) fn close(
    level: &mut Level,
    mut state: State,
    tolerance: f64,
) -> Result<(State, f64), NotConverged> {
    let barrier = BARRIER * LESS_BARRIER;
    reduce(level, &mut state, BARRIER, barrier)?;
    close_from(level, state, barrier, tolerance)
}

/// The exact contact and its residual, from a state that is nearly it.
pub(super) fn close_nearby(
    level: &mut Level,
    mut state: State,
    tolerance: f64,
) -> Result<(State, f64), NotConverged> {
    let target = behind(state.pressure, NEARBY_BARRIER);
    level.solve(&mut state, target)?;
    close_from(level, state, NEARBY_BARRIER, tolerance)
}

/// The state behind the barrier of a path, from an exact contact.
pub(super) fn open(level: &mut Level, mut state: State) -> Result<State, NotConverged> {
    let target = behind(state.pressure, BARRIER);
    level.solve(&mut state, target)?;
    Ok(state)
}

/// The exact contact and its residual, from a state behind a small barrier.
fn close_from(
    level: &mut Level,
    mut state: State,
    mut barrier: f64,
    tolerance: f64,
) -> Result<(State, f64), NotConverged> {
    let (pressure, most_steps) = (state.pressure, MOST_STEPS_TO_EXACT);
    let target = Target { pressure, barrier: 0.0, tolerance, most_steps };
    for _ in 0..MOST_CLOSINGS {
        reduce(level, &mut state, barrier, barrier * LESS_BARRIER)?;
        barrier *= LESS_BARRIER;
        if let Ok((_, residual)) = level.solve(&mut state, target) {
            return Ok((state, residual));
        }
    }
    Err(NotConverged)
}

/// Takes a state from one barrier to a smaller one.
fn reduce(level: &mut Level, state: &mut State, from: f64, to: f64) -> Result<(), NotConverged> {
    let (mut barrier, mut factor) = (from, LESS_BARRIER);
    while barrier > to * 1.0001 {
        let next = (barrier * factor).max(to);
        if level.solve(state, behind(state.pressure, next)).is_ok() {
            barrier = next;
            factor = (factor * factor).max(LESS_BARRIER);
        } else {
            // The end may have shortened the step that failed.
            factor = (next / barrier).sqrt();
            if factor > LITTLE_LESS_BARRIER || level.interrupt.is_set() {
                return Err(NotConverged);
            }
        }
    }
    Ok(())
}
