//! The path of solutions of growing pressure and of finer meshes.
//!
//! A large contact is reached through smaller ones: on a coarse mesh the pressure grows in steps
//! that adapt to what converges; at the wanted pressure the mesh is refined; at the end the
//! barrier is lowered and the contact set closed. On the way the barrier stays at a thousandth of
//! the height of the profile, where a step in pressure converges best. Rows are shifted against
//! the shear of the block as it grows.

use super::super::filter::Filter;
use super::super::local::LocalPattern;
use super::super::mesh::Mesh;
use super::super::profile::RigidProfile;
use super::super::row::Material;
use super::super::unknowns::Unknowns;
use super::newton::{Complementarity, Cost, Goal, Level, Problem, Stuck};
use super::state::{Heights, State};
use super::transfer::transfer;
use crate::fem::block::Block;
use crate::numerics::Interrupt;
use crate::rubber::FiniteStrainRubber;
use std::sync::Arc;

/// What does not change along a path of growing pressure.
#[derive(Clone)]
pub(super) struct Scene {
    pub rubber: FiniteStrainRubber,
    /// Relaxation lengths `v τ` in m.
    pub relaxation_lengths: Vec<f64>,
    pub profile: RigidProfile,
    pub heights: Heights,
    pub interrupt: Interrupt,
    /// A mean pressure in Pa at which only the tips of some of the shortest waves are touched.
    pub first_pressure: f64,
    /// Modulus in Pa at the shortest wave of the mesh.
    pub stiff_modulus: f64,
}

/// A point of a path: a mesh and the state on it at one pressure, behind the barrier.
pub(super) struct Path {
    scene: Arc<Scene>,
    level: Level,
    state: State,
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Ratio of the next pressure to this one.
    step: f64,
    /// All that was spent so far.
    pub cost: Cost,
    /// The points passed on this mesh, of growing pressure.
    passed: Vec<Waypoint>,
    /// The exact state found last.
    closed: Option<Waypoint>,
}

/// A point of a path that was passed.
#[derive(Clone)]
struct Waypoint {
    pressure: f64,
    state: State,
    mesh: Mesh,
}

/// Barrier over the roughness on the way.
const BARRIER: f64 = 1e-3;
/// Barrier while the profile grows: a higher one lets contacts open in longer steps.
const GROWTH_BARRIER: f64 = 3e-3;
/// Barriers from which the contact set is closed: the first is the cheapest, the next ones tell contact
/// from gap more sharply where the iteration does not settle.
const LOW_BARRIERS: [f64; 3] = [1e-4, 1e-5, 1e-6];
/// Barrier with which a path begins, and the ratio by which it is lowered then.
const FIRST_BARRIER: f64 = 0.1;
const LOWER_BARRIER: f64 = 0.3;
/// First and largest ratio of two pressures, and the ratio at which a path ends.
const FIRST_STEP: f64 = 1.6;
const LARGEST_STEP: f64 = 2.5;
const SMALLEST_STEP: f64 = 1.02;
/// Pressures passed on the way to one after which a path that creeps is given up.
const MOST_PRESSURES: usize = 40;
/// A finer mesh that cannot be entered at a pressure is tried again at this share of it.
const NEXT_ENTRY: f64 = 0.7;
/// Shear of the elements beyond which rows are shifted anew.
const MOST_SHEAR: f64 = 0.2;
/// Shear at which it is worth while where the path is stuck, and at its end.
const LEAST_SHEAR: f64 = 0.05;
/// Shear with which a solution counts; a shear of 1 would change friction by some percent, this one
/// by less than a thousandth.
const MOST_FINAL_SHEAR: f64 = 0.1;
/// Change of the shear of the elements below which a shift is given up.
const SMALLEST_SHIFT: f64 = 0.01;
/// Shifts after which rows that will not stand upright are left as they are.
const MOST_SHIFTS: usize = 30;
/// After a shift that took no more Newton steps than this the next one may be longer, by this ratio.
const EASY_SHIFT: usize = 3;
const LONGER_SHIFT: f64 = 1.5;
/// On the way the path need not be met exactly.
const ON_THE_WAY: Goal =
    Goal { residual: 1e-3, acceptable: 1e-3, most_steps: 25, highest: f64::INFINITY };
/// See [`super::solution::SteadySolution::residual`].
const AT_THE_END: Goal =
    Goal { residual: 1e-9, acceptable: 1e-8, most_steps: 30, highest: f64::INFINITY };
/// Where a solution is nearby. It converges at once or not at all.
const NEARBY: Goal = Goal { most_steps: 12, highest: 1.5, ..AT_THE_END };
/// Ratio of two pressures whose solutions are nearby.
const NEARBY_PRESSURE: f64 = 1.25;

impl Scene {
    fn level(&self, mesh: Mesh) -> Level {
        let lengths = &self.relaxation_lengths;
        let filters = lengths.iter().map(|length| Filter::new(mesh.spacing(), *length)).collect();
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let block = Block::new(mesh, Material { rubber: self.rubber.clone(), filters });
        let pattern = LocalPattern::new(&block, lengths);
        Level { block, pattern, unknowns }
    }
}

impl Path {
    /// A slight contact, at most at the wanted pressure.
    pub fn start(scene: &Arc<Scene>, mesh: Mesh, wanted: f64) -> Result<Self, Stuck> {
        let pressure = wanted.min(scene.first_pressure);
        let mut barrier = FIRST_BARRIER;
        let state =
            State::above(&mesh, &scene.profile, pressure, barrier * scene.heights.roughness);
        let level = scene.level(mesh);
        let cost = Cost::default();
        let scene = Arc::clone(scene);
        let (passed, closed) = (Vec::new(), None);
        let mut path =
            Self { scene, level, state, pressure, step: FIRST_STEP, cost, passed, closed };
        loop {
            path.converge(pressure, barrier, ON_THE_WAY)?;
            if barrier <= BARRIER {
                break;
            }
            barrier = (LOWER_BARRIER * barrier).max(BARRIER);
        }
        path.pass();
        Ok(path)
    }

    /// Goes on to the wanted pressure.
    pub fn advance_to(&mut self, wanted: f64) -> Result<(), Stuck> {
        let mut steps_taken = 0;
        while self.pressure != wanted {
            if steps_taken == MOST_PRESSURES {
                return Err(Stuck);
            }
            let next = if wanted > self.pressure {
                wanted.min(self.step * self.pressure)
            } else {
                wanted.max(self.pressure / self.step)
            };
            // Two equal steps where one is all but enough.
            let before = self.cost;
            self.stand_upright(MOST_SHEAR);
            match self.converge(next, BARRIER, ON_THE_WAY) {
                Ok(()) => {
                    steps_taken += 1;
                    self.pressure = next;
                    self.pass();
                    let steps = self.cost.newton_steps - before.newton_steps;
                    let factor = if steps < 7 {
                        1.5
                    } else if steps > 12 {
                        0.7
                    } else {
                        1.0
                    };
                    self.step = self.step.powf(factor).min(LARGEST_STEP);
                }
                Err(Stuck) => {
                    self.stand_upright(LEAST_SHEAR);
                    self.step = self.step.sqrt();
                    if self.step < SMALLEST_STEP {
                        return Err(Stuck);
                    }
                }
            }
        }
        Ok(())
    }

    /// Goes on with another mesh of the same block, from the highest pressure from which it can be
    /// entered; coarse solutions of large contacts are too far from fine ones.
    pub fn refine(&mut self, mesh: &Mesh) -> Result<(), Stuck> {
        self.closed = None;
        let mut passed = std::mem::take(&mut self.passed);
        let mut highest = f64::INFINITY;
        while let Some(waypoint) = passed.pop() {
            if waypoint.pressure > highest && !passed.is_empty() {
                continue;
            }
            let mesh = Mesh { skew: waypoint.mesh.skew, ..mesh.clone() };
            self.state = transfer(&waypoint.state, &waypoint.mesh, &mesh);
            self.level = self.scene.level(mesh);
            self.pressure = waypoint.pressure;
            self.centre();
            if self.converge(self.pressure, BARRIER, ON_THE_WAY).is_ok() {
                self.pass();
                return Ok(());
            }
            highest = NEXT_ENTRY * waypoint.pressure;
        }
        Err(Stuck)
    }

    /// Puts another profile, or the scales of another mesh, in the place of those there are; the
    /// state stays what it is.
    pub fn enter(&mut self, scene: Scene) {
        self.scene = Arc::new(scene);
    }

    /// Goes over to a nearby profile at the same pressure. Returns the Newton steps that it took.
    pub fn reshape(&mut self, scene: Scene) -> Result<usize, Stuck> {
        self.closed = None;
        self.stand_upright(MOST_SHEAR);
        let before = std::mem::replace(&mut self.scene, Arc::new(scene));
        let spent = self.cost.newton_steps;
        // The step of Newton's method from the state of the profile before is the tangent of
        // the path; forces and gaps stay a pair of the barrier.
        if let Err(Stuck) = self.converge(self.pressure, GROWTH_BARRIER, ON_THE_WAY) {
            self.scene = before;
            return Err(Stuck);
        }
        self.passed.clear();
        self.pass();
        Ok(self.cost.newton_steps - spent)
    }

    fn pass(&mut self) {
        self.passed.push(Waypoint {
            pressure: self.pressure,
            state: self.state.clone(),
            mesh: self.level.block.mesh().clone(),
        });
    }

    /// Back to the point passed on this mesh that is nearest to a pressure.
    pub fn return_towards(&mut self, pressure: f64) {
        let distance = |waypoint: &Waypoint| (waypoint.pressure / pressure).ln().abs();
        let nearest = self.passed.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(waypoint) = nearest.cloned() {
            self.go_back_to(waypoint);
        }
    }

    /// Back to the point before this one; none if this is the first.
    pub fn step_back(&mut self) -> Option<()> {
        self.passed.retain(|waypoint| waypoint.pressure < self.pressure);
        self.go_back_to(self.passed.last()?.clone());
        Some(())
    }

    fn go_back_to(&mut self, waypoint: Waypoint) {
        let material = self.level.block.material().clone();
        self.level.block = Block::new(waypoint.mesh, material);
        self.state = waypoint.state;
        self.pressure = waypoint.pressure;
        self.step = FIRST_STEP;
    }

    /// The exact state at this pressure and its residual; the path itself stays behind the barrier.
    pub fn finish(&mut self) -> Result<(State, f64), Stuck> {
        self.stand_upright(LEAST_SHEAR);
        if self.slant().abs() > MOST_FINAL_SHEAR {
            return Err(Stuck);
        }
        let pressure = self.pressure;
        let mut state = self.state.clone();
        for barrier in LOW_BARRIERS {
            let low = Complementarity::Barrier(barrier * self.scene.heights.roughness);
            let cost = self.problem(pressure).converge(&mut state, low, ON_THE_WAY)?;
            self.spend(cost);
            let mut closed = state.clone();
            let mut problem = self.problem(pressure);
            if let Ok(cost) = problem.converge(&mut closed, Complementarity::ActiveSet, AT_THE_END)
            {
                self.spend(cost);
                self.keep_closed(pressure, &closed);
                return Ok((closed, cost.residual));
            }
        }
        Err(Stuck)
    }

    /// The exact state at a pressure near the one finished last, straight from that state: half
    /// the work of a step of the path, which stays where it is.
    pub fn finish_nearby(&mut self, pressure: f64) -> Option<(State, f64)> {
        let Waypoint { pressure: from, mut state, mesh } = self.closed.clone()?;
        let ratio = pressure / from;
        if ratio.max(1.0 / ratio) > NEARBY_PRESSURE {
            return None;
        }
        // Nearly in proportion to the pressure.
        let shear = ratio * state.shear(&mesh);
        let upright = Mesh { skew: -shear, ..mesh.clone() };
        let stands = (mesh.skew + shear).abs() <= LEAST_SHEAR;
        let material = self.level.block.material().clone();
        self.level.block = Block::new(
            if stands {
                mesh
            } else {
                state = transfer(&state, &mesh, &upright);
                upright
            },
            material,
        );
        let law = Complementarity::ActiveSet;
        let cost = self.problem(pressure).converge(&mut state, law, NEARBY).ok()?;
        self.spend(cost);
        self.keep_closed(pressure, &state);
        Some((state, cost.residual))
    }

    fn keep_closed(&mut self, pressure: f64, state: &State) {
        let mesh = self.level.block.mesh().clone();
        self.closed = Some(Waypoint { pressure, state: state.clone(), mesh });
    }

    /// The mesh at this point.
    pub fn level(&self) -> &Level {
        &self.level
    }

    /// What was spent since it was asked last.
    pub fn take_cost(&mut self) -> Cost {
        std::mem::take(&mut self.cost)
    }

    /// Puts forces and gaps of an interpolated state back behind the barrier: the pair with the
    /// product of the barrier that has the same `λ - k g(u)`.
    fn centre(&mut self) {
        let spacing = self.level.block.mesh().spacing();
        let product = BARRIER * self.scene.heights.roughness * self.pressure * spacing;
        let stiffness = self.scene.stiff_modulus;
        for (j, (force, gap)) in self.state.forces.iter_mut().zip(&mut self.state.gaps).enumerate()
        {
            let [x, z] = [self.state.displacements[2 * j], self.state.displacements[2 * j + 1]];
            let open = z - self.scene.profile.at(j as f64 * spacing + x).height;
            let half = 0.5 * (*force - stiffness * open);
            let root = half.hypot((stiffness * product).sqrt());
            // The larger root first: the other one cancels.
            (*force, *gap) = if half > 0.0 {
                (root + half, product / (root + half))
            } else {
                (stiffness * product / (root - half), (root - half) / stiffness)
            };
        }
    }

    fn problem(&mut self, pressure: f64) -> Problem<'_> {
        Problem {
            level: &mut self.level,
            profile: &self.scene.profile,
            heights: self.scene.heights,
            pressure,
            modulus: self.scene.stiff_modulus,
            interrupt: &self.scene.interrupt,
        }
    }

    /// Converges at a pressure; the state stays what it was if that fails.
    fn converge(&mut self, pressure: f64, barrier: f64, goal: Goal) -> Result<(), Stuck> {
        let mut state = self.state.clone();
        let law = Complementarity::Barrier(barrier * self.scene.heights.roughness);
        let cost = self.problem(pressure).converge(&mut state, law, goal)?;
        self.state = state;
        self.spend(cost);
        Ok(())
    }

    fn spend(&mut self, cost: Cost) {
        self.cost.newton_steps += cost.newton_steps;
        self.cost.krylov_iterations += cost.krylov_iterations;
    }

    /// Shear by which the elements miss being upright on average.
    fn slant(&self) -> f64 {
        let mesh = self.level.block.mesh();
        mesh.skew + self.state.shear(mesh)
    }

    /// Shifts the rows until the mean shear leaves the elements upright, if they are slanted by more
    /// than `most_shear`; in shifts as long as the state can follow, since thin elements above a
    /// tip turn inside out if their rows move too far at once.
    fn stand_upright(&mut self, most_shear: f64) {
        if self.slant().abs() <= most_shear {
            return;
        }
        let mut longest = f64::INFINITY;
        for _ in 0..MOST_SHIFTS {
            if self.slant().abs() <= LEAST_SHEAR || longest <= SMALLEST_SHIFT {
                return;
            }
            let mesh = self.level.block.mesh().clone();
            let shift = -self.slant().clamp(-longest, longest);
            let shifted = Mesh { skew: mesh.skew + shift, ..mesh.clone() };
            let moved = transfer(&self.state, &mesh, &shifted);
            let before = std::mem::replace(&mut self.state, moved);
            let material = self.level.block.material().clone();
            self.level.block = Block::new(shifted, material.clone());
            self.centre();
            let spent = self.cost.newton_steps;
            if self.converge(self.pressure, BARRIER, ON_THE_WAY).is_err() {
                self.state = before;
                self.level.block = Block::new(mesh, material);
                longest = 0.5 * shift.abs();
            } else if self.cost.newton_steps - spent <= EASY_SHIFT {
                longest = LONGER_SHIFT * shift.abs();
            }
        }
    }
}
