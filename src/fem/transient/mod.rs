//! The transient contact: a block is pressed onto the profile and dragged over it.
//!
//! This is the procedure of the thesis (chapter 4.3), and the check of the steady solver: nothing
//! is assumed about the state but the start from rest. The mesh moves with the rubber; steps are
//! implicit; contact is frictionless. Pressing in takes the time `T1`, with the pressure growing
//! linearly; then the upper edge moves at constant speed under constant pressure.
//!
//! The thesis takes `T1` from a condition of its own (4.3.5). Here it is a parameter whose default
//! lets all branches relax. It does not influence the steady part of a drag that is long against
//! all relaxation times.

mod block;
mod contact;
mod drag;
mod error;
mod flow;
mod options;
mod point;
mod predictor;
mod solution;
mod step;
mod tangent;
#[cfg(test)]
mod tests;

pub use drag::TransientContact;
pub use error::{StepFailure, TransientError};
pub use flow::FlowRule;
pub use options::TransientOptions;
pub use solution::{Averaged, Counts, Energy, Sample, TransientSolution};
pub use step::Iterations;
