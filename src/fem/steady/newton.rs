//! Newton's method at one pressure on one mesh.
//!
//! Unknown are the displacements, and at every contact node the force λ and the gap `w`, which
//! obey `w = g(u)`, `λ >= 0`, `w >= 0` and
//!
//! ```text
//! barrier     λ w = σ p h            (interior point; σ is a length that goes to zero)
//! active set  λ = 0  or  w = 0       (the end of the path, exact)
//! ```
//!
//! Forces and gaps are eliminated node by node. What remains is solved by GMRES on the exact
//! tangent, preconditioned by the local tangent and the memory of the homogeneous block.

use super::super::block::Block;
use super::super::local::{LocalPattern, LocalTangent, NodeStiffness};
use super::super::memory::{Memory, MemoryContact};
use super::super::profile::{Height, RigidProfile};
use super::super::unknowns::Unknowns;
use super::state::{Heights, State};
use crate::numerics::Interrupt;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};

/// The law between force and gap of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Complementarity {
    /// Product of force and gap, as a length: force over the mean nodal force.
    Barrier(f64),
    /// One of them vanishes.
    ActiveSet,
}

/// When an iteration ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// Residual to reach.
    pub residual: f64,
    /// Residual that will do where round-off keeps it from falling any further.
    pub acceptable: f64,
    /// Newton steps after which it is given up.
    pub most_steps: usize,
    /// Residual above which it is given up.
    pub highest: f64,
}

/// What an iteration cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Cost {
    pub newton_steps: usize,
    pub krylov_iterations: usize,
    /// The residual reached.
    pub residual: f64,
}

/// The iteration came to nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stuck;

/// One mesh with all that is made once for it.
pub(super) struct Level {
    pub block: Block,
    pub pattern: LocalPattern,
    pub unknowns: Unknowns,
}

/// The problem at one pressure.
pub(super) struct Problem<'a> {
    pub level: &'a mut Level,
    pub profile: &'a RigidProfile,
    pub heights: Heights,
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Stiffness in Pa of the surface against the shortest waves; scales the contact stiffness.
    pub modulus: f64,
    /// Ends the iteration early, as stuck.
    pub interrupt: &'a Interrupt,
}

/// Unbalanced forces and gaps at a state.
struct Imbalance {
    /// Reduced forces: internal less applied ones, and the mean displacement.
    reduced: Vec<f64>,
    /// The profile under each contact node.
    places: Vec<Height>,
    /// Gap of the displacements less that of the state.
    gap_errors: Vec<f64>,
    /// Euclidean norm of the forces over that of the contact forces.
    norm: f64,
}

/// What a contact node contributes to a Newton step: force change
/// `push - stiffness (change of its gap)`.
#[derive(Clone, Copy)]
struct NodeLaw {
    stiffness: f64,
    push: f64,
    active: bool,
}

/// Accuracy of the linear solves behind the barrier, where steps are cut short anyway, and of those
/// that close the contact.
const FORCING: f64 = 3e-3;
const CLOSING_FORCING: f64 = 1e-3;
const MOST_KRYLOV: usize = 400;
/// A step goes this far towards a vanishing force or gap.
const TO_BOUNDARY: f64 = 0.98;
/// Largest displacement of a step in periods.
const LONGEST_STEP: f64 = 0.1;
/// Shorter steps lead nowhere.
const SHORTEST_STEP: f64 = 1e-3;
/// Residuals below this may grow up to it: far from the solution they say little.
const HARMLESS: f64 = 0.1;
/// A node is in contact where its force exceeds this many times its gap, both relative.
const FORCE_OVER_GAP: f64 = 1e3;
/// Stiffness of a closed contact in units of the rubber's. What a step leaves of the gaps is the ratio
/// of the stiffness of the block and this one; thin elements above a tip are stiff.
const CONTACT_STIFFNESS: f64 = 1e3;

impl Problem<'_> {
    /// Iterates until the residual is reached.
    ///
    /// # Errors
    /// [`Stuck`], with the state somewhere on the way.
    pub fn converge(
        &mut self,
        state: &mut State,
        law: Complementarity,
        goal: Goal,
    ) -> Result<Cost, Stuck> {
        let mut cost = Cost::default();
        let mut imbalance = self.imbalance(state).ok_or(Stuck)?;
        let memory = {
            let level = &*self.level;
            let follows = level.pattern.follows();
            Memory::new(&level.block, &state.displacements, follows, self.modulus)
        };
        let mut active: Option<Vec<bool>> = None;
        for step in 0..goal.most_steps {
            if imbalance.norm > goal.highest || self.interrupt.is_set() {
                return Err(Stuck);
            }
            let nodes = self.node_laws(state, &imbalance, law);
            let now: Vec<bool> = nodes.iter().map(|node| node.active).collect();
            let settled = match law {
                Complementarity::ActiveSet => active.as_ref() == Some(&now),
                Complementarity::Barrier(length) => self.balanced(state, length),
            };
            active = Some(now);
            let gap_error = self.largest_violation(state, &imbalance, &nodes, law);
            let before = std::mem::replace(&mut cost.residual, imbalance.norm.max(gap_error));
            let stalls = step > 0 && cost.residual > 0.5 * before;
            let enough = if stalls { goal.acceptable } else { goal.residual };
            if settled && cost.residual <= enough {
                return Ok(cost);
            }
            let (change, iterations) =
                self.direction(state, &imbalance, &nodes, &memory, law).ok_or(Stuck)?;
            cost.newton_steps += 1;
            cost.krylov_iterations += iterations;
            let growth = if step < 5 { 10.0 } else { 2.0 };
            let allowed = growth * imbalance.norm.max(HARMLESS);
            imbalance = self.advance(state, &imbalance, &nodes, &change, law, allowed)?;
        }
        Err(Stuck)
    }

    fn mean_force(&self) -> f64 {
        self.pressure * self.level.block.mesh().spacing()
    }

    fn imbalance(&mut self, state: &State) -> Option<Imbalance> {
        let level = &mut *self.level;
        let columns = level.unknowns.columns;
        let spacing = level.block.mesh().spacing();
        let mut forces = level.block.deform(&state.displacements).ok()?;
        let dead_load = self.pressure * spacing;
        forces[level.unknowns.upper_edge()..]
            .iter_mut()
            .skip(1)
            .step_by(2)
            .for_each(|z| *z += dead_load);
        let mut places = Vec::with_capacity(columns);
        let mut gap_errors = Vec::with_capacity(columns);
        for (j, (force, gap)) in state.forces.iter().zip(&state.gaps).enumerate() {
            let [x, z] = [state.displacements[2 * j], state.displacements[2 * j + 1]];
            let place = self.profile.at(j as f64 * spacing + x);
            forces[2 * j] += force * place.slope;
            forces[2 * j + 1] -= force;
            gap_errors.push(z - place.height - gap);
            places.push(place);
        }
        let unknowns = level.unknowns;
        let mean = unknowns.mean_contact_displacement(&state.displacements);
        let reduced = unknowns.reduce(&forces, mean);
        let applied = euclidean_norm(&state.forces).max(dead_load * (columns as f64).sqrt());
        let norm = euclidean_norm(&reduced[..unknowns.own()]) / applied;
        norm.is_finite().then_some(Imbalance { reduced, places, gap_errors, norm })
    }

    fn node_laws(
        &self,
        state: &State,
        imbalance: &Imbalance,
        law: Complementarity,
    ) -> Vec<NodeLaw> {
        let mean_force = self.mean_force();
        let nodes = state.forces.iter().zip(&state.gaps).zip(&imbalance.gap_errors);
        nodes
            .map(|((&force, &gap), &error)| match law {
                Complementarity::Barrier(length) => {
                    let stiffness = force / gap;
                    let push = length * mean_force / gap - force - stiffness * error;
                    NodeLaw { stiffness, push, active: true }
                }
                Complementarity::ActiveSet => {
                    let gap = gap + error;
                    let relative = FORCE_OVER_GAP * mean_force / self.heights.roughness;
                    if force > relative * gap {
                        let stiffness = CONTACT_STIFFNESS * self.modulus;
                        NodeLaw { stiffness, push: -stiffness * gap, active: true }
                    } else {
                        NodeLaw { stiffness: 0.0, push: -force, active: false }
                    }
                }
            })
            .collect()
    }

    /// Whether all products of force and gap are near that of the barrier.
    fn balanced(&self, state: &State, length: f64) -> bool {
        let wanted = length * self.mean_force();
        let products = state.forces.iter().zip(&state.gaps).map(|(force, gap)| force * gap);
        products.into_iter().all(|product| (product - wanted).abs() < 0.9 * wanted)
    }

    /// Largest violation of the contact: of the gaps over the roughness, and of vanishing forces at
    /// open nodes over the mean force. Behind the barrier only the gaps themselves can be wrong.
    fn largest_violation(
        &self,
        state: &State,
        imbalance: &Imbalance,
        nodes: &[NodeLaw],
        law: Complementarity,
    ) -> f64 {
        let contact = state.gaps.iter().zip(&imbalance.gap_errors);
        contact
            .zip(nodes.iter().zip(&state.forces))
            .map(|((gap, error), (node, force))| {
                let open = gap + error;
                let (gap, force) = match law {
                    Complementarity::Barrier(_) => (error.abs(), 0.0),
                    Complementarity::ActiveSet if node.active => (open.abs(), 0.0),
                    Complementarity::ActiveSet => ((-open).max(0.0), force.abs()),
                };
                (gap / self.heights.roughness).max(force / self.mean_force())
            })
            .fold(0.0, f64::max)
    }

    /// Change of the displacements by one Newton step.
    fn direction(
        &self,
        state: &State,
        imbalance: &Imbalance,
        nodes: &[NodeLaw],
        memory: &Memory,
        law: Complementarity,
    ) -> Option<(Vec<f64>, usize)> {
        let level = &*self.level;
        let unknowns = level.unknowns;
        let mut right: Vec<f64> = imbalance.reduced.iter().map(|r| -r).collect();
        let mut contact: Vec<NodeStiffness> = Vec::with_capacity(nodes.len());
        for (j, (node, place)) in nodes.iter().zip(&imbalance.places).enumerate() {
            let normal = [-place.slope, 1.0];
            let k = node.stiffness;
            // The force turns with the slope under a node that moves along the profile.
            let turn = state.forces[j] * place.curvature;
            contact.push([[k * normal[0] * normal[0] + turn, k * normal[0]], [k * normal[0], k]]);
            right[2 * j] += normal[0] * node.push;
            right[2 * j + 1] += node.push;
        }
        let local = level.pattern.factorise(&level.block, &contact)?;
        let memory = memory.with_contact(&contact);
        // Preconditioned from the right, so that the norm is that of the unbalanced forces: in
        // displacements the stiff resistance to changes of volume would not be seen.
        right[unknowns.own()] *= self.modulus;
        let forcing = match law {
            Complementarity::Barrier(_) => FORCING,
            Complementarity::ActiveSet => CLOSING_FORCING,
        };
        let tolerance = forcing * euclidean_norm(&right);
        let limits = KrylovLimits { tolerance, max_iterations: MOST_KRYLOV };
        let mut scratch = vec![0.0; unknowns.count()];
        let operator = |x: &[f64], out: &mut [f64]| {
            scratch.copy_from_slice(x);
            scratch[unknowns.own()] /= self.modulus;
            precondition(&memory, &local, &mut scratch);
            let changes = unknowns.expand(&scratch);
            let mut forces = level.block.tangent(&changes);
            for (j, k) in contact.iter().enumerate() {
                let [x, z] = [changes[2 * j], changes[2 * j + 1]];
                forces[2 * j] += k[0][0] * x + k[0][1] * z;
                forces[2 * j + 1] += k[1][0] * x + k[1][1] * z;
            }
            let mean = unknowns.mean_contact_displacement(&changes);
            out.copy_from_slice(&unknowns.reduce(&forces, mean));
            out[unknowns.own()] *= self.modulus;
        };
        let report = gmres(operator, &mut right, limits, self.interrupt);
        right[unknowns.own()] /= self.modulus;
        precondition(&memory, &local, &mut right);
        let finite = right.iter().all(|x| x.is_finite());
        finite.then(|| (unknowns.expand(&right), report.iterations))
    }

    /// Goes along the direction as far as forces and gaps stay positive, elements upright and the
    /// residual below what is allowed.
    fn advance(
        &mut self,
        state: &mut State,
        imbalance: &Imbalance,
        nodes: &[NodeLaw],
        change: &[f64],
        law: Complementarity,
        allowed: f64,
    ) -> Result<Imbalance, Stuck> {
        let contact = imbalance.places.iter().zip(&imbalance.gap_errors).enumerate();
        let gaps: Vec<f64> = contact
            .map(|(j, (place, error))| error - place.slope * change[2 * j] + change[2 * j + 1])
            .collect();
        let forces: Vec<f64> = nodes
            .iter()
            .zip(gaps.iter().zip(&imbalance.gap_errors))
            .map(|(node, (gap, error))| node.push - node.stiffness * (gap - error))
            .collect();
        let longest = change[..self.level.unknowns.upper_edge()]
            .iter()
            .fold(0.0_f64, |longest, x| longest.max(x.abs()));
        let mut length = (LONGEST_STEP * self.profile.period() / longest).min(1.0);
        if matches!(law, Complementarity::Barrier(_)) {
            length = length
                .min(to_boundary(&state.gaps, &gaps))
                .min(to_boundary(&state.forces, &forces));
        }
        if length < SHORTEST_STEP {
            return Err(Stuck);
        }
        let from = state.clone();
        for _ in 0..12 {
            let along = |to: &mut [f64], from: &[f64], change: &[f64]| {
                for ((to, from), change) in to.iter_mut().zip(from).zip(change) {
                    *to = from + length * change;
                }
            };
            along(&mut state.displacements, &from.displacements, change);
            along(&mut state.forces, &from.forces, &forces);
            along(&mut state.gaps, &from.gaps, &gaps);
            if let Some(imbalance) = self.imbalance(state)
                && imbalance.norm < allowed
            {
                return Ok(imbalance);
            }
            length *= 0.5;
        }
        Err(Stuck)
    }
}

/// `P⁻¹` in place.
fn precondition(memory: &MemoryContact, local: &LocalTangent, reduced: &mut [f64]) {
    memory.correct(reduced);
    local.solve(reduced);
}

/// Largest step, at most 1, that leaves a share of every positive value.
fn to_boundary(values: &[f64], changes: &[f64]) -> f64 {
    values
        .iter()
        .zip(changes)
        .filter(|(_, change)| **change < 0.0)
        .map(|(value, change)| -TO_BOUNDARY * value / change)
        .fold(1.0, f64::min)
}
