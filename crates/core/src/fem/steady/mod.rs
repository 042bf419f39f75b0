//! Steady sliding of a block of rubber over a rigid profile, at finite deformation.
//!
//! In the frame of the profile the field is steady, and the flow rule of a branch becomes `v dC_i/dξ = (C - C_i) / τ`
//! along each material line, with the label `ξ = X + v t` of the rubber. One Newton solve replaces some thousand time
//! steps, after which a transient solution is steady.
//!
//! The grid is fixed to the profile: its columns stand at equidistant `x = s`, its rows are material lines `Z`, and the
//! unknowns are the label of the rubber there, `ξ = s - q(s, Z)`, and its height, `z = Z + w(s, Z)`. This is the
//! bilinear element with nodes that move in the undeformed block instead of in space. So contact nodes stay above their
//! points of the profile, gaps and slopes are linear and constant, resolution follows the surface in space, and no
//! shear, however large, slants an element. It needs a surface that is a graph over x.
//!
//! Elements are bilinear; their volumetric part is integrated at the centre alone (selective
//! reduced integration), which keeps them from locking at ν = 0.49.
//!
//! | module | what it does |
//! |---|---|
//! | `options`, `setting` | the block and its mesh; the rubber and its speed |
//! | `grid` | rows of nodes and elements; fewer columns away from the contact |
//! | `flow`, `passage` | the flow rule along a row of unequally spaced labels, and the internal measures by it |
//! | `point`, `row`, `tangent`, `block` | internal forces and their tangent with relaxation history |
//! | `hardening` | what a law that stiffens adds to that tangent |
//! | `lanes` | points of an element side by side in vector registers |
//! | `long` | displacements with the digits that double precision rounds off |
//! | `contact` | force and gap of a node from one smooth unknown |
//! | `local`, `stiffness` | the preconditioner: sparse factors of tangents with a short relaxation history |
//! | `level`, `newton` | the equations on one grid, and Newton's method with GMRES |
//! | `path`, `transfer` | growing pressure, finer grids, from the barrier to the exact contact |
//! | `growth`, `lift` | profiles of many scales: octaves of waves added at constant pressure |
//! | `plate` | a rigid plate on the upper edge |
//! | `ladder` | their exact contact, from coarse grids to fine ones |
//! | `state` | the unknowns at a point of a path |
//! | `last` | the last solution before a pressure that has none |
//! | [`solution`] | friction, area, separation, dissipation and fields of a solved contact |
//! | `area` | the pressure that gives a contact area |

mod area;
mod block;
mod contact;
mod flow;
mod grid;
mod growth;
mod hardening;
#[cfg(test)]
mod interface_tests;
mod ladder;
mod lanes;
mod last;
mod level;
mod lift;
mod local;
mod long;
mod newton;
mod options;
mod passage;
mod path;
mod plate;
mod point;
mod row;
mod setting;
pub mod solution;
mod state;
mod stiffness;
mod tangent;
#[cfg(test)]
mod tests;
mod transfer;

pub use options::{BlockOptions, COLUMNS_RANGE, HEIGHT_RANGE, UpperEdge};

use super::error::{BeyondLaw, FemError, PathEnd};
use super::profile::RigidProfile;
use crate::interface::{LocalFriction, ShearError};
use crate::multiscale::LocalLaw;
use crate::numerics::Interrupt;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use ladder::Ladder;
use level::Level;
use path::Path;
use setting::Setting;
use solution::SteadySolution;
use state::State;

/// An element is inverted, or an internal tensor is not positive: forces do not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Inverted;

/// Newton's method or a path did not converge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NotConverged;

/// Number of shortest waves on the period up to which a path starts from a slight contact of the highest tip.
const MOST_WAVES_FROM_A_TIP: f64 = 4.0;
/// Columns a shortest wave on the coarsest grid of a path.
const COARSEST_PER_WAVE: f64 = 40.0;
/// A block of rubber that slides at constant speed over a rigid periodic profile: plane strain,
/// finite linear viscoelasticity, frictionless contact. The upper edge carries the dead pressure
/// `p` per undeformed length and moves as a whole; lateral edges are periodic.
///
/// Solutions for further pressures start from those found before, which saves most of the work;
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
    /// The first solution of the equations at the pressure asked for in which the law of the rubber does not hold.
    beyond: Option<BeyondLaw>,
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
        let (interface, interrupt) = (LocalFriction::None, Interrupt::default());
        let layer = None;
        let setting =
            Setting { rubber: rubber.clone(), finite, speed, interface, layer, interrupt };
        Ok(Self::of(setting, profile, options))
    }

    fn of(setting: Setting, profile: RigidProfile, options: BlockOptions) -> Self {
        let ladder = if has_many_scales(&profile) {
            Ladder::new(options.columns, &profile)
        } else {
            Ladder::none(options.columns)
        };
        Self { setting, profile, options, path: None, ladder, solved: Vec::new(), beyond: None }
    }

    /// A contact that a longer profile lets last for a `length` in m of sliding only, after which branches still carry
    /// a share of the mean strain of a row: [`FiniteStrainRubber::in_a_contact_that_lasts`].
    #[must_use]
    pub fn lasting(mut self, length: f64) -> Self {
        let Setting { finite, speed, .. } = &mut self.setting;
        let period = self.profile.period() / *speed;
        *finite = finite.clone().in_a_contact_that_lasts(length / *speed, period);
        self
    }

    /// With a shear traction of the contact, which slides everywhere in one direction.
    ///
    /// # Errors
    /// [`ShearError::OutOfRange`] for a constant that no law has.
    pub fn with_interface(self, law: LocalFriction) -> Result<Self, ShearError> {
        law.validate()?;
        let setting = Setting { interface: law, ..self.setting };
        // Nothing that was solved under another interface is kept.
        Ok(Self::of(setting, self.profile, self.options))
    }

    /// With short waves between profile and rubber, as a layer whose height is their mean separation g(p) under the local
    /// pressure. Where a pressure lies beyond the samples of the law, the height is that of the last.
    #[must_use]
    pub fn on_layer(self, law: LocalLaw) -> Self {
        let setting = Setting { layer: Some(law), ..self.setting };
        Self::of(setting, self.profile, self.options)
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
    /// [`FemError::PathEnded`] with the last point that converged, also where the equations have a solution in which the
    /// law of the rubber does not hold; [`FemError::Interrupted`].
    pub fn solve(&mut self, pressure: f64) -> Result<SteadySolution, FemError> {
        if !(pressure > 0.0 && pressure.is_finite()) {
            return Err(FemError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: pressure,
                range: "positive and finite",
            });
        }
        let before = self.path.as_mut().map(|path| {
            // Work spent on an earlier refusal does not count for this pressure.
            path.take_cost();
            path.place()
        });
        self.beyond = None;
        let solved = match self.go_on(pressure) {
            // Another way would lead to the same solution.
            Err(NotConverged) if self.beyond.is_some() => Err(None),
            gone_on => gone_on.or_else(|NotConverged| self.set_out(pressure)),
        };
        match solved {
            Ok(solution) => {
                assert_eq!(solution.mean_pressure, pressure, "a solution of another pressure");
                self.solved.push((pressure, PathEnd::at(&solution)));
                Ok(solution)
            }
            // After an interrupt every path ends.
            Err(_) if self.setting.interrupt.is_set() => Err(FemError::Interrupted),
            Err(ended) => {
                let beyond = self.beyond;
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
                    beyond,
                })
            }
        }
    }

    /// Whether a pressure without a solution leaves the contact as it was, as for a profile of many scales: a replay of
    /// the same pressures may skip it. Otherwise the contact is then at the last point that converged.
    pub fn refusals_leave_no_trace(&self) -> bool {
        has_many_scales(&self.profile)
    }

    /// The solution at a pressure from the points passed before, if there are any.
    fn go_on(&mut self, pressure: f64) -> Result<SteadySolution, NotConverged> {
        let path = self.path.as_mut().ok_or(NotConverged)?;
        if let Some(exact) = path.finish_nearby(pressure, self.ladder.path_tolerance()) {
            let climbed = self.climb(exact);
            if climbed.is_ok() || self.beyond.is_some() {
                return climbed;
            }
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

    /// A path in pressure; a grid on which it ends passes its last state to the next one.
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
                        // The state reached on a coarser grid does not solve this one.
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

    /// The exact solution at the point the path has reached, with the work spent since the last one.
    fn conclude(&mut self) -> Result<SteadySolution, NotConverged> {
        let tolerance = self.ladder.path_tolerance();
        let exact = self.path.as_mut().ok_or(NotConverged)?.finish(tolerance)?;
        self.climb(exact)
    }

    /// The solution on the finest grid, from the exact contact on the grid of the path. One in which the law of the
    /// rubber does not hold is none.
    fn climb(&mut self, exact: (State, f64)) -> Result<SteadySolution, NotConverged> {
        let path = self.path.as_mut().ok_or(NotConverged)?;
        let (setting, profile) = (&self.setting, &self.profile);
        let solution = self.ladder.climb(path, exact, setting.speed, |columns| {
            Level::new(setting, &BlockOptions { columns, ..self.options }, profile)
        })?;
        match BeyondLaw::of(setting.finite.rheology, solution.largest_invariant) {
            None => Ok(solution),
            Some(beyond) => {
                self.beyond.get_or_insert(beyond);
                Err(NotConverged)
            }
        }
    }
}

/// Whether a profile has too many scales for a path that starts from its highest tip.
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
