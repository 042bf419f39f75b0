//! Steady sliding of a block of rubber over a rigid profile, at finite deformation.
//!
//! In the frame of the profile the field stands still: `x = X + v t + u(ξ, Z)` with
//! `ξ = X + v t`, and the flow rule of a branch becomes `v dC_i/dξ = (C - C_i) / τ` along each row
//! of the mesh, which [`super::filter`] solves for all points of a row at once. One Newton solve
//! replaces the some thousand time steps after which a transient solution is steady.
//!
//! | module | what it does |
//! |---|---|
//! | `path` | continuation: growing pressure, finer meshes, shifted rows |
//! | `growth` | profiles of many scales: octaves that grow at constant pressure |
//! | `newton` | one pressure on one mesh: barrier and active set, GMRES |
//! | `state`, `transfer` | the unknown fields, and how they are taken to another mesh |
//! | [`solution`] | friction, area, separation, dissipation and fields of a solved contact |
//! | `area` | the pressure that gives a wanted contact area |

mod area;
mod growth;
mod newton;
mod path;
pub mod solution;
mod state;
mod transfer;

use super::error::{FemError, PathEnd};
use super::mesh::{Grading, Mesh};
use super::profile::RigidProfile;
use crate::numerics::Interrupt;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use newton::Stuck;
use path::{Path, Scene};
use solution::SteadySolution;
use state::{Heights, State};
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The block and its mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockOptions {
    /// Elements over the period.
    pub columns: usize,
    /// Height of the block over the period.
    pub height_ratio: f64,
    /// Growth of the rows away from the contact.
    pub grading: Grading,
}

impl BlockOptions {
    /// The block of the thesis, of height 0.75 L, with square elements at the contact and rows
    /// that grow by a fifth: friction then differs by 0.1 % from that of equally high rows.
    pub fn new(columns: usize) -> Self {
        Self { columns, height_ratio: 0.75, grading: Grading { first: 1.0, growth: 1.2 } }
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

/// Columns for which a contact can be asked.
pub const COLUMNS_RANGE: RangeInclusive<usize> = 8..=1 << 16;
/// Block heights, in periods, for which a contact can be asked.
pub const HEIGHT_RANGE: RangeInclusive<f64> = 0.1..=10.0;

/// Points of a path that ended whose contact is closed, from the last one back, before it is given up.
const MOST_CLOSED: usize = 8;
/// Shortest waves on the period up to which a path sets out from a slight contact of the highest tip:
/// with three octaves that takes half the time of growth, with four twice, with more it ends early.
const MOST_WAVES_FROM_A_TIP: f64 = 4.0;
/// Columns of the coarsest mesh on the shortest wave of the profile.
const COARSEST_PER_WAVE: f64 = 24.0;
/// Pressure of the first contact over the modulus at the shortest wave.
const FIRST_PRESSURE: f64 = 5e-3;
/// Ratio of the columns of neighbouring meshes. With twice the columns the small waves that a
/// coarse mesh leaves between its nodes become stresses from which Newton's method does not
/// recover.
const REFINEMENT: f64 = 1.5;

/// A block of rubber that slides at constant speed over a rigid periodic profile: plane strain,
/// finite linear viscoelasticity, frictionless contact. The upper edge carries the dead pressure
/// `p` per undeformed length and moves as a whole; lateral edges are periodic.
///
/// Solutions for further pressures go on from those found before, which saves most of the work;
/// they agree with those from scratch within the residual, and where the rows happen to be shifted
/// differently within the error of the mesh.
///
/// ```
/// use asperity::fem::profile::RigidProfile;
/// use asperity::fem::steady::{BlockOptions, SteadyContact};
/// use asperity::rubber::{Rheology, Rubber};
/// use asperity::surface::Wave;
///
/// let wave = Wave { wavelength: 6.25e-5, amplitude: 1.867e-5, phase: 0.0 };
/// let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
/// let rubber = Rubber::table_2_1();
/// let options = BlockOptions::new(64);
/// let mut contact = SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, profile, options)?;
/// let solution = contact.solve(3e5)?;
/// assert!((solution.friction_coefficient - 0.32).abs() < 0.01);
/// # Ok::<(), asperity::fem::error::FemError>(())
/// ```
pub struct SteadyContact {
    setting: Setting,
    scene: Arc<Scene>,
    options: BlockOptions,
    path: Option<Path>,
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
    fn scene(&self, profile: RigidProfile, columns: usize) -> Scene {
        let period = profile.period();
        let modulus = |q: f64| self.rubber.reduced_modulus(q * self.speed).norm();
        let branches = self.finite.branches.iter();
        // One tip carries all; a contact of a few percent of the shortest wave.
        let waves = profile.shortest_waves();
        Scene {
            rubber: self.finite.clone(),
            relaxation_lengths: branches
                .map(|branch| self.speed * branch.relaxation_time)
                .collect(),
            interrupt: self.interrupt.clone(),
            heights: Heights::of(&profile, 8 * columns),
            first_pressure: FIRST_PRESSURE * modulus(TAU * waves / period) / waves,
            stiff_modulus: modulus(PI * columns as f64 / period),
            profile,
        }
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
        let scene = Arc::new(setting.scene(profile, options.columns));
        Ok(Self { setting, scene, options, path: None })
    }

    /// With an interrupt that ends a solve between two Krylov iterations.
    #[must_use]
    pub fn interruptible(self, interrupt: &Interrupt) -> Self {
        let scene = Scene { interrupt: interrupt.clone(), ..(*self.scene).clone() };
        let setting = Setting { interrupt: interrupt.clone(), ..self.setting };
        Self { setting, scene: Arc::new(scene), ..self }
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`FemError::OutOfRange`] for a pressure that is not positive and finite;
    /// [`FemError::PathEnded`] with the last point that converged; [`FemError::Interrupted`].
    pub fn solve(&mut self, pressure: f64) -> Result<SteadySolution, FemError> {
        let solved = self.solve_on_a_path(pressure);
        // Behind an interrupt every path ends.
        if solved.is_err() && self.setting.interrupt.is_set() {
            return Err(FemError::Interrupted);
        }
        solved
    }

    fn solve_on_a_path(&mut self, pressure: f64) -> Result<SteadySolution, FemError> {
        if !(pressure > 0.0 && pressure.is_finite()) {
            return Err(FemError::OutOfRange {
                quantity: "the mean pressure in Pa",
                value: pressure,
                range: "positive and finite",
            });
        }
        if let Some(path) = &mut self.path
            && let Some(exact) = path.finish_nearby(pressure)
        {
            return Ok(read(path, exact, &self.scene, self.setting.speed, pressure));
        }
        if let Some(solution) = self.go_on(pressure) {
            return Ok(solution);
        }
        // Another path may get there: which one ends depends on its steps.
        let known = self.path.take();
        if let Some(solution) = self.set_out(pressure) {
            return Ok(solution);
        }
        self.path = known.or(self.path.take());
        let ended = |reached| FemError::PathEnded {
            wanted: pressure,
            columns: self.options.columns,
            reached,
        };
        let Some(path) = &mut self.path else { return Err(ended(PathEnd::NotStarted)) };
        match last_converged(path, &self.scene, self.setting.speed) {
            // What failed at first may succeed at the second attempt: rows are shifted on in parts.
            Some(solution) if solution.mean_pressure == pressure => Ok(solution),
            Some(solution) => Err(ended(PathEnd::At {
                pressure: solution.mean_pressure,
                friction_coefficient: solution.friction_coefficient,
                contact_area_fraction: solution.contact_area_fraction,
            })),
            None => Err(ended(PathEnd::NotStarted)),
        }
    }

    /// The solution at a pressure from the points passed before, if there are any.
    fn go_on(&mut self, pressure: f64) -> Option<SteadySolution> {
        let path = self.path.as_mut()?;
        path.return_towards(pressure);
        path.advance_to(pressure).ok()?;
        conclude(path, &self.scene, self.setting.speed).ok()
    }

    /// The solution on a new path, from a slight contact on the coarsest mesh to the finest one, or
    /// for a profile of many scales from its longest waves to the shortest; the path stays where it
    /// ends.
    fn set_out(&mut self, pressure: f64) -> Option<SteadySolution> {
        if self.scene.profile.shortest_waves() > MOST_WAVES_FROM_A_TIP {
            let profile = &self.scene.profile;
            self.path = growth::grow(&self.setting, profile, self.options, pressure).ok();
            return conclude(self.path.as_mut()?, &self.scene, self.setting.speed).ok();
        }
        let mut path: Option<Path> = None;
        let mut arrived = Err(Stuck);
        for mesh in self.meshes() {
            if self.setting.interrupt.is_set() {
                return None;
            }
            let entered = match &mut path {
                Some(path) => path.refine(&mesh),
                None => Err(Stuck),
            };
            if entered.is_err() {
                path = Path::start(&self.scene, mesh, pressure).ok();
            }
            // A coarse mesh may fail where a finer one does not.
            arrived = path.as_mut().map_or(Err(Stuck), |path| path.advance_to(pressure));
        }
        self.path = path;
        arrived.ok()?;
        conclude(self.path.as_mut()?, &self.scene, self.setting.speed).ok()
    }

    /// From the coarsest to the wanted mesh.
    fn meshes(&self) -> Vec<Mesh> {
        let period = self.scene.profile.period();
        let least = COARSEST_PER_WAVE * self.scene.profile.shortest_waves();
        let mut columns = vec![self.options.columns];
        while let Some(finer) = columns.last()
            && *finer as f64 / REFINEMENT >= least
        {
            columns.push((*finer as f64 / REFINEMENT).round() as usize);
        }
        let mesh = |columns| BlockOptions { columns, ..self.options }.mesh(period);
        columns.into_iter().rev().map(mesh).collect()
    }
}

/// The exact solution at the point a path has reached.
fn conclude(path: &mut Path, scene: &Scene, speed: f64) -> Result<SteadySolution, Stuck> {
    let exact = path.finish()?;
    let pressure = path.pressure;
    Ok(read(path, exact, scene, speed, pressure))
}

/// What an exact state and its residual say, with all that was spent since the last one.
fn read(
    path: &mut Path,
    (state, residual): (State, f64),
    scene: &Scene,
    speed: f64,
    pressure: f64,
) -> SteadySolution {
    let solution = SteadySolution::read(&state, path.level(), scene, speed, pressure, residual);
    let cost = path.take_cost();
    SteadySolution {
        newton_steps: cost.newton_steps,
        krylov_iterations: cost.krylov_iterations,
        ..solution
    }
}

/// The exact solution at the highest point of a path at which it converges.
fn last_converged(path: &mut Path, scene: &Scene, speed: f64) -> Option<SteadySolution> {
    for _ in 0..MOST_CLOSED {
        if let Ok(solution) = conclude(path, scene, speed) {
            return Some(solution);
        }
        path.step_back()?;
    }
    None
}

fn check_speed(speed: f64) -> Result<(), FemError> {
    if speed > 0.0 && speed.is_finite() {
        return Ok(());
    }
    let (quantity, range) = ("the speed in m/s", "positive and finite");
    Err(FemError::OutOfRange { quantity, value: speed, range })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Wave;
    use std::time::{Duration, Instant};

    #[test]
    fn an_interrupt_ends_a_solve_and_is_no_end_of_a_path() {
        let wave = Wave { wavelength: 6.25e-5, amplitude: 1.867e-5, phase: 0.0 };
        let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
        let (rubber, law) = (Rubber::table_2_1(), Rheology::NeoHookean);
        let interrupt = Interrupt::default();
        let mut contact = SteadyContact::new(&rubber, law, 0.01, profile, BlockOptions::new(1024))
            .unwrap()
            .interruptible(&interrupt);
        let user = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(500));
            interrupt.set();
            Instant::now()
        });
        assert_eq!(contact.solve(3e6).err(), Some(FemError::Interrupted));
        let heard = user.join().unwrap().elapsed();
        assert!(heard < Duration::from_secs(10), "{heard:?}");
        assert_eq!(contact.solve(3e5).err(), Some(FemError::Interrupted));
    }
}
