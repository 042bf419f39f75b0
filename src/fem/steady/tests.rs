//! The steady block against differences and exact results.
