//! A scanned surface: line scans, what they say of the roughness, and sines that stand for them.

pub mod scan;
pub mod synthesis;
pub mod wave;

pub use scan::{LineScan, RawScan};
pub use synthesis::SyntheticAsphalt;
pub use wave::{SineScale, Wave};
