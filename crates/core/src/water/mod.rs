//! Water under a sliding block, as far as it can be told without solving its flow: the film that is left after a time
//! ([`SqueezeOut`]).
//!
//! Mixed lubrication is not here: where a film carries part of the load, dry contact does not hold.

mod squeeze;

pub use squeeze::{Footprint, SqueezeError, SqueezeOut};
