//! One implicit time step: Newton on the equilibrium, Uzawa on the contact pressures.

use super::block::{History, Linearised, TransientBlock};
use super::contact::{Contact, Multipliers};
use super::error::StepFailure;
use super::flow::FlowRule;
use super::tangent::Tangent;
use crate::fem::profile::RigidProfile;
use crate::numerics::krylov::euclidean_norm;

/// Residual of the equilibrium, relative to the load on the nodes, at which Newton ends.
const EQUILIBRIUM_TOLERANCE: f64 = 1e-8;

/// Newton iterations for one set of multipliers; the contact rarely needs more than ten.
const MAX_NEWTON: usize = 25;

/// Uzawa updates in a step. Each of them shrinks the violation by about the penalty factor or more.
const MAX_UZAWA: usize = 30;

/// Largest change of a displacement in an iteration, over the period.
const LARGEST_CHANGE: f64 = 0.1;

/// Halvings of a change that inverts an element or overshoots.
const MAX_HALVINGS: usize = 6;

/// Fraction to which the forces along a change must shrink.
const LINE_SEARCH: f64 = 0.8;

/// Load on the block at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Nominal pressure in Pa on the upper edge.
    pub pressure: f64,
    /// x displacement in m of the upper edge.
    pub displacement: f64,
}

/// Work of the iterations of one or more steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Iterations {
    /// Newton iterations, each with one factorisation.
    pub newton: usize,
    /// Uzawa updates of the contact pressures.
    pub uzawa: usize,
}

/// Displacements and contact pressures.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// `(x, z)` in m of each node, row after row from the contact upwards.
    pub nodes: Vec<f64>,
    /// Multipliers of the contact.
    pub multipliers: Multipliers,
}

/// Everything that does not change from step to step.
pub struct Stepper {
    /// The rigid profile.
    pub profile: RigidProfile,
    /// The sparse solver.
    pub tangent: Tangent,
    /// Integration of the flow rule.
    pub flow: FlowRule,
    /// Largest violation in m of the contact conditions.
    pub largest_violation: f64,
}

impl Stepper {
    /// The state after a step of `time_step` s from the one that the block keeps, iterated from
    /// `state`, with its contact and the past that leads to it.
    ///
    /// # Errors
    /// Why the iteration stopped.
    pub fn advance(
        &self,
        block: &TransientBlock,
        mut state: State,
        load: Load,
        time_step: f64,
        iterations: &mut Iterations,
    ) -> Result<(State, Contact, History), StepFailure> {
        let history = block.history(self.flow, time_step);
        let upper = state.nodes.len() - 2 * block.mesh().columns;
        state.nodes[upper..].iter_mut().step_by(2).for_each(|x| *x = load.displacement);
        for _ in 0..MAX_UZAWA {
            let contact = self.equilibrium(block, &history, &mut state, load, iterations)?;
            let violation = contact.violation(&state.multipliers);
            state.multipliers.values.clone_from(&contact.pressures);
            iterations.uzawa += 1;
            if violation <= self.largest_violation {
                return Ok((state, contact, history));
            }
        }
        Err(StepFailure::ContactNotConverged)
    }

    /// Semismooth Newton with fixed multipliers.
    fn equilibrium(
        &self,
        block: &TransientBlock,
        history: &History,
        state: &mut State,
        load: Load,
        iterations: &mut Iterations,
    ) -> Result<Contact, StepFailure> {
        let mut trial = self.residual(block, history, state, load)?;
        for _ in 0..MAX_NEWTON {
            if trial.norm <= EQUILIBRIUM_TOLERANCE {
                return Ok(trial.contact);
            }
            let change = self
                .tangent
                .solve(block, &trial.elements, &trial.contact, &trial.residual)
                .ok_or(StepFailure::Singular)?;
            iterations.newton += 1;
            trial = self.change(block, history, state, load, &trial, &change)?;
        }
        Err(StepFailure::EquilibriumNotConverged { residual: trial.norm })
    }

    /// Goes along `-change` as far as no element is inverted and the forces along it
    /// shrink: where the contact changes, the full change overshoots and the iteration would
    /// cycle between two sets of contact nodes.
    fn change(
        &self,
        block: &TransientBlock,
        history: &History,
        state: &mut State,
        load: Load,
        before: &Trial,
        change: &[f64],
    ) -> Result<Trial, StepFailure> {
        let largest = change.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let mut length = (LARGEST_CHANGE * block.mesh().period / largest).min(1.0);
        let slope = dot(&before.residual, change).abs();
        let old = state.nodes.clone();
        let mut last = Err(StepFailure::Inverted);
        for _ in 0..MAX_HALVINGS {
            for ((node, old), change) in state.nodes.iter_mut().zip(&old).zip(change) {
                *node = old - length * change;
            }
            if let Ok(trial) = self.residual(block, history, state, load) {
                let shrinks = dot(&trial.residual, change).abs() <= LINE_SEARCH * slope;
                if shrinks || trial.norm <= before.norm {
                    return Ok(trial);
                }
                last = Ok(trial);
            }
            length *= 0.5;
        }
        last
    }

    fn residual(
        &self,
        block: &TransientBlock,
        history: &History,
        state: &State,
        load: Load,
    ) -> Result<Trial, StepFailure> {
        let mesh = block.mesh();
        let elements = block.linearise(history, &state.nodes).map_err(|_| StepFailure::Inverted)?;
        let mut residual = vec![0.0; state.nodes.len()];
        for (index, element) in elements.iter().enumerate() {
            for (dof, force) in block.dofs(index).into_iter().zip(element.forces) {
                residual[dof] += force;
            }
        }
        let nodal_load = load.pressure * mesh.spacing();
        let upper = residual.len() - 2 * mesh.columns;
        residual[upper..].iter_mut().skip(1).step_by(2).for_each(|force| *force += nodal_load);
        let edge = &state.nodes[..2 * mesh.columns];
        let contact = Contact::at(mesh, &self.profile, edge, &state.multipliers);
        contact.add_forces(-1.0, &mut residual);
        let norm = euclidean_norm(&self.tangent.free(&residual))
            / (nodal_load * (mesh.columns as f64).sqrt());
        if norm.is_finite() {
            Ok(Trial { elements, contact, residual, norm })
        } else {
            Err(StepFailure::Inverted)
        }
    }
}

/// The forces at one set of displacements.
struct Trial {
    elements: Vec<Linearised>,
    contact: Contact,
    residual: Vec<f64>,
    norm: f64,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
