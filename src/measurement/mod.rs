//! Measured friction, and what a run has beside it.
//!
//! | module | what it holds |
//! |---|---|
//! | `file` | measured friction over speed as a table of text |
//! | `run` | hysteretic friction and contact area of a run, over the speed at one pressure |

mod file;
mod run;

pub use file::{MeasuredFile, MeasuredFileError, MeasuredPoint, read_measured};
pub use run::{Choice, Computed, ComputedAt, ComputedError};
