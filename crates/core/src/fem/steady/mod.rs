//! Steady sliding of a block of rubber over a rigid profile, at finite deformation.
//!
//! In the frame of the profile the field stands still, and the flow rule of a branch becomes
//! `v dC_i/dξ = (C - C_i) / τ` along each material line, with the label `ξ = X + v t` of the rubber. One
//! Newton solve replaces the some thousand time steps after which a transient solution is steady.
//!
//! The grid is fixed to the profile: its columns stand at equidistant `x = s`, its rows are material
//! lines `Z`, and what is unknown is which rubber is there, `ξ = s - q(s, Z)`, and how high it lies,
//! `z = Z + w(s, Z)`. This is the bilinear element with nodes that are moved in the undeformed block in
//! place of in space. So contact nodes stay above their points of the profile, gaps and slopes are
//! linear and constant, resolution follows the surface in space, and no shear, however large, slants an
//! element. It needs a surface that is a graph over x.
//!
//! Elements are bilinear; their volumetric part is integrated at the centre alone (selective
//! reduced integration), which keeps them from locking at ν = 0.49.
//!
//! | module | what it does |
//! |---|---|
//! | `grid` | rows of nodes and elements; fewer columns away from the contact |
//! | `flow` | the flow rule along a row of unequally spaced labels |
//! | `point`, `row`, `tangent`, `block` | internal forces and their tangent with relaxation history |
//! | `lanes` | points of an element side by side in vector registers |
//! | `long` | displacements with the digits that double precision rounds off |
//! | `contact` | force and gap of a node from one smooth unknown |
//! | `local`, `stiffness` | the preconditioner: sparse factors of tangents with a short memory |
//! | `level`, `newton` | the equations on one grid, and Newton's method with GMRES |
//! | `path`, `transfer` | growing pressure, finer grids, from the barrier to the exact contact |
//! | `growth`, `lift` | profiles of many scales: octaves that grow at constant pressure |
//! | `ladder` | their exact contact, from coarse grids to fine ones |
//! | [`solution`] | friction, area, separation, dissipation and fields of a solved contact |
//! | `area` | the pressure that gives a wanted contact area |

mod area;
mod block;
mod contact;
mod flow;
mod grid;
mod growth;
mod ladder;
mod lanes;
mod level;
mod lift;
mod local;
mod long;
mod newton;
mod path;
mod point;
mod row;
pub mod solution;
mod state;
mod stiffness;
mod tangent;
#[cfg(test)]
mod tests;
mod transfer;

use super::error::{FemError, PathEnd};
use super::mesh::{Grading, Mesh};
use super::profile::RigidProfile;
use crate::numerics::Interrupt;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use flow::Relaxation;
use ladder::Ladder;
use level::Level;
use path::Path;
use row::Material;
use solution::SteadySolution;
use state::State;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// An element is inverted, or an internal tensor is not positive: forces do not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Inverted;

/// Newton's method or a path did not get there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NotConverged;

/// The block and its mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockOptions {
    /// Elements over the period.
    pub columns: usize,
    /// Height of the block over the period.
    pub height_ratio: f64,
    /// Growth of the rows away from the contact.
    pub grading: Grading,
    /// Whether rows that are flat against their height have half as many columns as those below.
    pub coarsening: bool,
}

impl BlockOptions {
    /// The block of the thesis, of height 0.75 L, with square elements at the contact and rows that grow by a fifth.
    /// From 256 columns on rows coarsen, which changes friction by up to 0.1 % and saves more than half of the
    /// elements.
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            height_ratio: 0.75,
            grading: Grading { first: 1.0, growth: 1.0 + GROWTH },
            coarsening: columns >= MANY_COLUMNS,
        }
    }

    /// The same for a profile: the more columns its shortest wave has, the less rows grow, so that more columns refine
    /// the mesh at every depth. With one growth for all, friction converges to a value that is up to 0.2 % off.
    pub fn of_profile(columns: usize, profile: &RigidProfile) -> Self {
        let mut options = Self::new(columns);
        let per_wave = columns as f64 / profile.shortest_waves();
        options.grading.growth = 1.0 + GROWTH * (COLUMNS_OF_GROWTH / per_wave).min(MOST_GROWTH);
        options
    }

    /// The mesh of a block of one `period` in m, not skewed.
    pub fn mesh(&self, period: f64) -> Mesh {
        Mesh::graded(self.columns, period, self.height_ratio * period, self.grading)
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`FemError::OutOfRange`] for the first one that is not.
    pub fn check(&self, period: f64) -> Result<(), FemError> {
        let out_of_range =
            |quantity, value, range| Err(FemError::OutOfRange { quantity, value, range });
        if !(period > 0.0 && period.is_finite()) {
            return out_of_range("the period in m", period, "positive and finite");
        }
        if !COLUMNS_RANGE.contains(&self.columns) {
            return out_of_range("the number of columns", self.columns as f64, "8 to 65536");
        }
        if !HEIGHT_RANGE.contains(&self.height_ratio) {
            let height = self.height_ratio;
            return out_of_range("the height of the block in periods", height, "0.1 to 10");
        }
        let Grading { first, growth } = self.grading;
        if !(0.1..=10.0).contains(&first) {
            return out_of_range("the height of the first row in columns", first, "0.1 to 10");
        }
        if !(1.0..=3.0).contains(&growth) {
            return out_of_range("the growth of the rows", growth, "1 to 3");
        }
        Ok(())
    }
}

/// Growth of the rows on so many columns of a wave, and how many times that on fewer.
const GROWTH: f64 = 0.2;
const COLUMNS_OF_GROWTH: f64 = 64.0;
const MOST_GROWTH: f64 = 2.0;
/// Columns from which on rows coarsen by default.
const MANY_COLUMNS: usize = 256;
/// Columns for which a contact can be asked.
pub const COLUMNS_RANGE: RangeInclusive<usize> = 8..=1 << 16;
/// Block heights, in periods, for which a contact can be asked.
pub const HEIGHT_RANGE: RangeInclusive<f64> = 0.1..=10.0;

/// Points of a path that ended whose contact is closed, from the last one back, before it is given up.
const MOST_CLOSED: usize = 8;
/// Halvings of what lies between the last such point and the next one that is none.
const MOST_HALVINGS: usize = 3;
/// Shortest waves on the period up to which a path sets out from a slight contact of the highest tip.
const MOST_WAVES_FROM_A_TIP: f64 = 4.0;
/// Columns of the coarsest grid of a path on the shortest wave of the profile.
const COARSEST_PER_WAVE: f64 = 40.0;
/// Pressure of the first contact over the modulus at the shortest wave.
const FIRST_PRESSURE: f64 = 3e-2;

/// A block of rubber that slides at constant speed over a rigid periodic profile: plane strain,
/// finite linear viscoelasticity, frictionless contact. The upper edge carries the dead pressure
/// `p` per undeformed length and moves as a whole; lateral edges are periodic.
///
/// Solutions for further pressures go on from those found before, which saves most of the work;
/// they agree with those from scratch within the residual.
///
/// ```
/// use asperity_core::fem::profile::RigidProfile;
/// use asperity_core::fem::steady::{BlockOptions, SteadyContact};
/// use asperity_core::rubber::{Rheology, Rubber};
/// use asperity_core::surface::Wave;
///
/// let wave = Wave { wavelength: 6.25e-5, amplitude: 1.867e-5, phase: 0.0 };
/// let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
/// let rubber = Rubber::table_2_1();
/// let options = BlockOptions::new(64);
/// let mut contact = SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, profile, options)?;
/// let solution = contact.solve(3e5)?;
/// assert!((solution.friction_coefficient - 0.32).abs() < 0.01);
/// # Ok::<(), asperity_core::fem::error::FemError>(())
/// ```
pub struct SteadyContact {
    setting: Setting,
    profile: RigidProfile,
    options: BlockOptions,
    path: Option<Path>,
    ladder: Ladder,
    /// The pressures in Pa that have been solved.
    solved: Vec<(f64, PathEnd)>,
}

/// The rubber and its speed, without a profile.
struct Setting {
    rubber: Rubber,
    finite: FiniteStrainRubber,
    /// Speed in m/s.
    speed: f64,
    interrupt: Interrupt,
}

impl Setting {
    /// The rubber on a row of one period in m.
    fn material(&self, period: f64) -> Material {
        let length = |time: f64| Relaxation { length: self.speed * time, period };
        let branches = self.finite.branches.iter();
        let relaxations = branches.map(|branch| length(branch.relaxation_time)).collect();
        Material { rubber: self.finite.clone(), relaxations }
    }

    /// A mean pressure in Pa at which the highest tip of a profile carries all, in a contact of a few
    /// percent of the shortest wave.
    fn first_pressure(&self, profile: &RigidProfile) -> f64 {
        let waves = profile.shortest_waves();
        let frequency = TAU * waves / profile.period() * self.speed;
        FIRST_PRESSURE * self.rubber.reduced_modulus(frequency).norm() / waves
    }
}

impl SteadyContact {
    /// Sets up the contact for a positive `speed` in m/s.
    ///
    /// # Errors
    /// [`FemError::Rubber`]; [`FemError::OutOfRange`] for a speed, a number of columns, a height or
    /// a grading outside its range.
    pub fn new(
        rubber: &Rubber,
        rheology: Rheology,
        speed: f64,
        profile: RigidProfile,
        options: BlockOptions,
    ) -> Result<Self, FemError> {
        let finite = FiniteStrainRubber::new(rubber, rheology)?;
        check_speed(speed)?;
        options.check(profile.period())?;
        let interrupt = Interrupt::default();
        let setting = Setting { rubber: rubber.clone(), finite, speed, interrupt };
        let ladder = if has_many_scales(&profile) {
            Ladder::new(options.columns, &profile)
        } else {
            Ladder::none(options.columns)
        };
        Ok(Self { setting, profile, options, path: None, ladder, solved: Vec::new() })
    }

    /// A contact that a longer profile lets last for a `length` in m of sliding only, after which branches still carry a share
    /// of the mean strain of a row: [`FiniteStrainRubber::in_a_contact_that_lasts`].
    #[must_use]
    pub fn lasting(mut self, length: f64) -> Self {
        let Setting { finite, speed, .. } = &mut self.setting;
        let period = self.profile.period() / *speed;
        *finite = finite.clone().in_a_contact_that_lasts(length / *speed, period);
        self
    }

    /// With an interrupt that ends a solve between two Krylov iterations.
    #[must_use]
    pub fn interruptible(mut self, interrupt: &Interrupt) -> Self {
        self.setting.interrupt = interrupt.clone();
        if let Some(path) = &mut self.path {
            path.level.interrupt = interrupt.clone();
        }
        self.ladder.interrupt(interrupt);
        self
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`FemError::OutOfRange`] for a pressure that is not positive and finite;
    /// [`FemError::PathEnded`] with the last point that converged; [`FemError::Interrupted`].
    pub fn solve(&mut self, pressure: f64) -> Result<SteadySolution, FemError> {
        if !(pressure > 0.0 && pressure.is_finite()) {
            return Err(FemError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: pressure,
                range: "positive and finite",
            });
        }
        let before = self.path.as_mut().map(|path| {
            // What a refusal before has spent is not this one's.
            path.take_cost();
            path.place()
        });
        let solved = self.go_on(pressure).or_else(|NotConverged| self.set_out(pressure));
        match solved {
            Ok(solution) => {
                assert_eq!(solution.mean_pressure, pressure, "a solution of another pressure");
                self.solved.push((pressure, PathEnd::at(&solution)));
                Ok(solution)
            }
            // Behind an interrupt every path ends.
            Err(_) if self.setting.interrupt.is_set() => Err(FemError::Interrupted),
            Err(ended) => {
                let reached = if self.refusals_leave_no_trace() {
                    if let (Some(path), Some(before)) = (&mut self.path, before) {
                        path.return_to(before);
                    }
                    self.last_solved(pressure)
                } else {
                    self.last_converged(ended, pressure)
                };
                if self.setting.interrupt.is_set() {
                    return Err(FemError::Interrupted);
                }
                Err(FemError::PathEnded {
                    wanted: pressure,
                    columns: self.options.columns,
                    reached,
                })
            }
        }
    }

    /// Whether a pressure without a solution leaves the contact as it was, so that it need not be tried
    /// again where the same pressures are solved anew: for a profile of many scales. Otherwise the contact is
    /// at the last point that converged then.
    pub fn refusals_leave_no_trace(&self) -> bool {
        has_many_scales(&self.profile)
    }

    /// The solution at a pressure from the points passed before, if there are any.
    fn go_on(&mut self, pressure: f64) -> Result<SteadySolution, NotConverged> {
        let path = self.path.as_mut().ok_or(NotConverged)?;
        if let Some(exact) = path.finish_nearby(pressure, self.ladder.path_tolerance())
            && let Ok(solution) = self.climb(exact)
        {
            return Ok(solution);
        }
        let path = self.path.as_mut().ok_or(NotConverged)?;
        path.return_towards(pressure);
        path.advance_to(pressure)?;
        self.conclude()
    }

    /// The solution on a new path: from a slight contact on the coarsest grid to the finest one, or
    /// for a profile of many scales from its longest waves to the shortest. Where it fails, the path is
    /// where it ended, and what was known before is kept if it went further.
    fn set_out(&mut self, pressure: f64) -> Result<SteadySolution, Option<Box<Path>>> {
        let known = self.path.take();
        let arrived = if has_many_scales(&self.profile) {
            let options = BlockOptions { columns: self.ladder.path_columns(), ..self.options };
            growth::grow(&self.setting, &self.profile, options, pressure)
                .map(|path| self.path = Some(path))
        } else {
            self.press(pressure)
        };
        match arrived.and_then(|()| self.conclude()) {
            Ok(solution) => Ok(solution),
            Err(NotConverged) => {
                let ended = self.path.take().map(Box::new);
                self.path = known;
                Err(ended)
            }
        }
    }

    /// A path in pressure; a grid on which it ends hands on what it has reached to the next one.
    fn press(&mut self, pressure: f64) -> Result<(), NotConverged> {
        let first = self.setting.first_pressure(&self.profile).min(pressure);
        let mut arrived = Err(NotConverged);
        for columns in self.columns() {
            let level = || {
                let options = BlockOptions { columns, ..self.options };
                Level::new(&self.setting, &options, &self.profile)
            };
            let entered = match &mut self.path {
                Some(path) => path.refine(level()),
                None => Err(NotConverged),
            };
            if self.setting.interrupt.is_set() {
                return Err(NotConverged);
            }
            if entered.is_err() {
                match Path::start(level(), first) {
                    Ok(path) => self.path = Some(path),
                    Err(NotConverged) => {
                        // What a coarser grid has reached is no solution on this one.
                        arrived = Err(NotConverged);
                        continue;
                    }
                }
            }
            arrived =
                self.path.as_mut().map_or(Err(NotConverged), |path| path.advance_to(pressure));
        }
        arrived
    }

    /// Columns of the grids of a path, the coarsest first.
    fn columns(&self) -> Vec<usize> {
        let least = COARSEST_PER_WAVE * self.profile.shortest_waves();
        let mut columns = vec![self.options.columns];
        while let Some(finer) = columns.last()
            && *finer as f64 / 2.0 >= least
        {
            columns.push(finer / 2);
        }
        columns.reverse();
        columns
    }

    /// The exact solution at the point the path has reached, with all that was spent since the last
    /// one.
    fn conclude(&mut self) -> Result<SteadySolution, NotConverged> {
        let tolerance = self.ladder.path_tolerance();
        let exact = self.path.as_mut().ok_or(NotConverged)?.finish(tolerance)?;
        self.climb(exact)
    }

    /// The solution on the wanted grid, from the exact contact on that of the path.
    fn climb(&mut self, exact: (State, f64)) -> Result<SteadySolution, NotConverged> {
        let path = self.path.as_mut().ok_or(NotConverged)?;
        let (setting, profile) = (&self.setting, &self.profile);
        self.ladder.climb(path, exact, setting.speed, |columns| {
            Level::new(setting, &BlockOptions { columns, ..self.options }, profile)
        })
    }

    /// The highest pressure below a wanted one that has been solved. A profile of many scales has no other point:
    /// to close contacts behind the barrier one after the other would cost more than a solution.
    fn last_solved(&self, wanted: f64) -> PathEnd {
        let below = self.solved.iter().filter(|(pressure, _)| *pressure < wanted);
        let last = below.max_by(|(one, _), (other, _)| one.total_cmp(other));
        last.map_or(PathEnd::NotGrown, |(_, at)| *at)
    }

    /// The highest point at which the contact converges, of the path that ended or of what was known
    /// before; a coarser grid may have reached the `wanted` one, which says nothing of this one.
    fn last_converged(&mut self, ended: Option<Box<Path>>, wanted: f64) -> PathEnd {
        let known = self.path.take();
        let mut reached: Option<SteadySolution> = None;
        for mut path in ended.map(|path| *path).into_iter().chain(known) {
            path.take_cost();
            let before = self.path.replace(path);
            let solution = self.last_of_path();
            // Only a path on the grid of the ladder can be gone on with.
            let usable = self.path.as_ref().is_some_and(|path| {
                solution.is_some()
                    && path.level.grid().contact_nodes() == self.ladder.path_columns()
            });
            if !usable {
                self.path = before;
            }
            reached = match (reached, solution) {
                (Some(best), Some(new)) if best.mean_pressure >= new.mean_pressure => Some(best),
                (best, new) => new.or(best),
            };
        }
        let before = reached.filter(|solution| solution.mean_pressure < wanted);
        before.map_or(PathEnd::NotStarted, |solution| PathEnd::at(&solution))
    }

    /// The exact solution at the last point of the path at which it converges; the path is there then.
    fn last_of_path(&mut self) -> Option<SteadySolution> {
        let mut beyond = None;
        for _ in 0..MOST_CLOSED {
            if let Ok(solution) = self.conclude() {
                return Some(match beyond {
                    Some(beyond) => self.last_before(solution, beyond),
                    None => solution,
                });
            }
            let path = self.path.as_mut()?;
            beyond = Some(path.state.pressure);
            path.step_back()?;
        }
        None
    }

    /// Looks for a later exact solution than the one at the path, before a pressure at which there is
    /// none.
    fn last_before(&mut self, mut last: SteadySolution, mut beyond: f64) -> SteadySolution {
        for _ in 0..MOST_HALVINGS {
            let Some(path) = self.path.as_mut() else { break };
            let (state, middle) = (path.state.clone(), (last.mean_pressure * beyond).sqrt());
            match path.jump_to(middle).and_then(|()| self.conclude()) {
                Ok(solution) => last = solution,
                Err(NotConverged) => {
                    beyond = middle;
                    if let Some(path) = self.path.as_mut() {
                        path.state = state;
                    }
                }
            }
        }
        last
    }
}

/// Whether a profile has too many scales for a path that sets out from its highest tip.
pub(super) fn has_many_scales(profile: &RigidProfile) -> bool {
    profile.shortest_waves() > MOST_WAVES_FROM_A_TIP
}

fn check_speed(speed: f64) -> Result<(), FemError> {
    if speed > 0.0 && speed.is_finite() {
        return Ok(());
    }
    let (quantity, range) = ("the speed in m/s", "positive and finite");
    Err(FemError::OutOfRange { quantity, value: speed, range })
}
