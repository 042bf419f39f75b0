//! A scanned surface: line scans, what they say of the roughness, and sines that stand for them.

pub mod condition;
pub mod correlation;
pub mod faults;
pub mod filter;
pub mod form;
pub mod ladder;
pub mod parameters;
pub mod probe;
pub mod profile;
pub mod realisation;
pub mod resample;
pub mod scan;
pub mod self_affine;
pub mod sine_fit;
pub mod spectrum;
pub mod synthesis;
pub mod texture;
pub mod wave;
pub mod window;

pub use condition::{Conditioning, ConditioningError, ConditioningReport, condition};
pub use correlation::{CorrelationSample, HeightDifferenceCorrelation};
pub use ladder::Ladder;
pub use parameters::RoughnessParameters;
pub use scan::{LineScan, RawScan};
pub use self_affine::SelfAffineFit;
pub use sine_fit::SineFit;
pub use spectrum::PowerSpectrum;
pub use synthesis::SyntheticAsphalt;
pub use wave::{SineScale, Wave};
