//! A scanned surface: line scans, what they say of the roughness, and sines that stand for them.

pub mod correlation;
pub mod ladder;
pub mod parameters;
pub mod scan;
pub mod self_affine;
pub mod sine_fit;
pub mod spectrum;
pub mod wave;

pub use correlation::{CorrelationSample, HeightDifferenceCorrelation};
pub use ladder::Ladder;
pub use parameters::RoughnessParameters;
pub use scan::{LineScan, RawScan};
pub use self_affine::SelfAffineFit;
pub use sine_fit::SineFit;
pub use spectrum::PowerSpectrum;
pub use wave::{SineScale, Wave};
