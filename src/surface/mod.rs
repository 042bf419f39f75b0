//! A scanned surface: line scans, what they say of the roughness, and sines that stand for them.

pub mod scan;
pub mod wave;

pub use scan::{LineScan, RawScan};
pub use wave::{SineScale, Wave};
