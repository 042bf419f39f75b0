//! The transient contact: a block is pressed onto the profile and dragged over it.
//!
//! This is the procedure of the thesis (chapter 4.3), and the check of the steady solver: the only assumption about the
//! state is the start from rest. The mesh moves with the rubber; steps are implicit; contact is frictionless. Pressing
//! in takes the time `T1`, with the pressure growing linearly; then the upper edge moves at constant speed under
//! constant pressure.
//!
//! The thesis determines `T1` by a condition (4.3.5). Here it is a parameter whose default lets all branches relax. It
//! does not influence the steady part of a drag that is long compared with the creep times of the rubber; with the
//! trapezoidal rule some ringing from it remains.
//!
//! # Time steps
//! Branches with relaxation times far below the step act through the rate of strain alone. The
//! trapezoidal rule takes that rate at the middle of the step but rings; the exponential rule takes
//! it one half step late, which lowers the friction in first order of the step where such
//! branches dissipate. Both tend to the same friction; their difference measures the error.
//!
//! # The linear law
//! Under [`Rheology::Linear`](crate::rubber::Rheology::Linear) the shear stress has a maximum, at a logarithmic stretch
//! of 1.2 in a relaxed, incompressible rubber: elements sheared beyond it collapse, and the run ends with
//! [`TransientError::Stopped`].
//!
//! | module | what it does |
//! |---|---|
//! | `drag` | pressing in and dragging, with steps as long as they converge |
//! | `step` | one implicit step: Newton on the equilibrium, Uzawa on the contact pressures |
//! | `predictor` | the state from which a step is iterated |
//! | `block`, `point`, `flow` | internal forces and their tangent; the law at a point; the flow rule over a step |
//! | `contact` | forces between the lower edge and the profile |
//! | `tangent` | the sparse matrix of block and contact, and its factors |
//! | `setup` | the mesh and the block at rest |
//! | `options`, `solution`, `error` | parameters, the time series of a drag, what can go wrong |

mod block;
mod contact;
mod drag;
mod error;
mod flow;
mod options;
mod point;
mod predictor;
mod setup;
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
