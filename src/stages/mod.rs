//! The stages, one file each: parameters, row types and one function from inputs to results.
//!
//! | stage | reads | writes |
//! |---|---|---|
//! | [`ingest`] | scan files | windows of equal spacing (HDF5), a report |
//! | [`characterise`] | windows | roughness parameters, correlation, spectrum, self-affine fit |
//! | [`approximate`] | correlation | amplitudes of superposed sines |
//! | [`realise`] | windows, maps, amplitudes | surfaces that stand for the road, as waves or heights |
//! | [`bem`] | waves, rubber | solved contacts, friction over area |
//! | [`areal`] | areal surfaces, rubber | solved contacts of areal surfaces, friction over area |
//! | [`feedback`] | waves, rubber | contacts whose moduli follow from their own heat and strain |
//! | [`micro`] | waves, friction over area, rubber | the steepest waves under both models, their local law |
//! | [`hybrid`] | waves, friction over area, microscale | friction over area, corrected |
//! | [`fem`] | waves, rubber | friction over area with all waves at finite deformation |
//! | [`multilevel`] | waves, friction over area, rubber | averages of both models in one |
//! | [`tables`] | friction over area | averages with confidence intervals |
//! | [`methods`] | waves, averages, rubber | the older multiscale methods beside the models |

pub mod approximate;
pub mod areal;
pub mod bem;
mod between_solves;
pub mod characterise;
pub mod contract;
mod error;
pub mod feedback;
pub mod fem;
pub(crate) mod friction;
pub mod hybrid;
pub mod ingest;
pub(crate) mod kept;
mod keys;
pub mod methods;
pub mod micro;
pub mod multilevel;
pub mod realise;
pub mod sinusoid;
mod solve_error;
pub mod tables;

use crate::numerics::Interrupt;
pub use contract::{Chain, Context, Contract, Inputs, Job, Planned, Request};
pub use error::StageError;
pub use solve_error::SolveError;

/// A stage, known by its name.
#[derive(Clone, Copy)]
pub struct Stage(pub &'static Contract);

impl Stage {
    /// All stages in the order of the data, the study of one sine last.
    pub const ALL: [Self; 14] = [
        ingest::STAGE,
        characterise::STAGE,
        approximate::STAGE,
        realise::STAGE,
        bem::STAGE,
        areal::STAGE,
        feedback::STAGE,
        micro::STAGE,
        hybrid::STAGE,
        fem::STAGE,
        multilevel::STAGE,
        tables::STAGE,
        methods::STAGE,
        sinusoid::STAGE,
    ];
}

/// Progress to whoever looks on, and their interrupt.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Called as work is done: pieces done, pieces known so far.
    pub progress: &'a (dyn Fn(u64, u64) + Sync),
    /// Set by the user's interrupt.
    pub interrupted: &'a Interrupt,
}

impl Watch<'_> {
    /// Fails if the user has interrupted.
    ///
    /// # Errors
    /// [`StageError::Interrupted`].
    pub fn check_interrupt(&self) -> Result<(), StageError> {
        if self.interrupted.is_set() {
            return Err(StageError::Interrupted);
        }
        Ok(())
    }
}
