//! A scanned surface: line scans, what they say of the roughness, and sines that stand for them.

pub mod condition;
pub mod faults;
pub mod form;
pub mod resample;
pub mod scan;
pub mod wave;
pub mod window;

pub use condition::{Conditioning, ConditioningError, ConditioningReport, condition};
pub use scan::{LineScan, RawScan};
pub use wave::{SineScale, Wave};
