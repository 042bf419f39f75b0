//! A scanned surface: line scans, their roughness, and superposed sines that represent them.
//!
//! | module | what it holds |
//! |---|---|
//! | [`scan`] | line scans, as read and on equal spacing |
//! | [`mod@condition`] | faults, resampling, windows and form of a scan, in one call |
//! | [`faults`], [`resample`], [`window`], [`form`] | the steps of that |
//! | [`parameters`], [`profile`], [`texture`] | roughness parameters, those of ISO 21920, road texture by ISO 13473 |
//! | [`filter`] | Gaussian profile filter |
//! | [`correlation`], [`self_affine`] | height-difference correlation and its self-affine fit |
//! | [`spectrum`] | power spectrum by Welch's method, and that of the isotropic surface |
//! | [`probe`] | the shortest wavelength that an instrument shows as it is |
//! | [`ladder`], [`sine_fit`] | wavelengths of superposed sines, and their amplitudes |
//! | [`wave`], [`realisation`] | sines, and surfaces of them with random phases |
//! | [`map`] | heights over a plane: maps of instruments |
//! | [`periodic`] | a scanned window as a periodic profile, and profiles with its spectrum |
//! | [`synthesis`] | scans of a surface with known parameters |
//! | [`slider`] | hard cylinders and triangles |
//! | `table_3_1` | the sines of the published tables |

pub mod condition;
pub mod correlation;
pub mod faults;
pub mod filter;
pub mod form;
pub mod ladder;
pub mod map;
pub mod parameters;
pub mod periodic;
pub mod probe;
pub mod profile;
pub mod realisation;
pub mod resample;
pub mod scan;
pub mod self_affine;
pub mod sine_fit;
pub mod slider;
pub mod spectrum;
pub mod synthesis;
pub mod texture;
pub mod wave;
pub mod window;

mod table_3_1;

pub use condition::{Conditioning, ConditioningError, ConditioningReport, condition};
pub use correlation::{CorrelationSample, HeightDifferenceCorrelation};
pub use ladder::Ladder;
pub use map::{HeightMap, PeriodicMap, PeriodicMapError};
pub use parameters::RoughnessParameters;
pub use periodic::{Closure, PeriodicError, PeriodicProfile};
pub use scan::{LineScan, RawScan};
pub use self_affine::SelfAffineFit;
pub use sine_fit::SineFit;
pub use slider::{Slider, SliderError};
pub use spectrum::PowerSpectrum;
pub use synthesis::SyntheticAsphalt;
pub use table_3_1::TABLE_3_1_MM;
pub use wave::{SineScale, Wave};
