//! Water under a sliding block, as far as it can be told without solving its flow.
//!
//! | item | what it holds |
//! |---|---|
//! | [`Pools`] | a map whose sealed valleys are full of water |
//! | [`SqueezeOut`] | the film that is left under a smooth block after a time |
//!
//! Mixed lubrication is not here: where a film carries part of the load, neither dry nor sealed contact holds.

mod pools;
mod squeeze;

pub use pools::{Neighbours, Pools, PoolsError};
pub use squeeze::{Footprint, SqueezeError, SqueezeOut};
