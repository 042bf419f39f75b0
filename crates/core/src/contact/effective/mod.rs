//! Contacts whose rubber is warmer, or softer, where its waves work.
//!
//! Heat and large strain change the moduli below the contact. In the half-space each wave `q` works at a depth of about `1/q`,
//! so each gets effective moduli of its own,
//!
//! ```text
//! E_q = b_q [f_q E'(a_q q v) + i g_q E''(a_q q v)]
//! ```
//!
//! with the factors `a_q` (frequency) and `b_q` (moduli) of the temperature, and `f_q` and `g_q` of the strain, that the wave meets below the contact. The
//! contact determines temperature and strain, and they determine its moduli: a fixed point.
//!
//! Two approximations are in this. A wave has one modulus along the whole period, that of where the pressure is. And strain
//! enters as the amplitude of a harmonic deformation would (**harmonic linearisation**): storage and loss modulus are those that
//! a strain sweep has at this amplitude; harmonics, and the memory of softening, are left out.
//!
//! | module | what it holds |
//! |---|---|
//! | `laws` | [`TemperatureLaw`], [`StrainLaw`]: what a caller knows of the rubber |
//! | `rubber` | [`EffectiveRubber`]: a rubber with factors for each wave |
//! | `strain` | the strain that waves meet below a contact |
//! | `setup`, `line` | [`FeedbackContact`]: the fixed point for a line |
//! | `error` | why there is none |

mod error;
mod laws;
mod line;
mod rubber;
mod setup;
mod strain;

#[cfg(test)]
mod tests;

pub use error::EffectiveError;
pub use laws::{StrainLaw, TemperatureLaw};
pub use line::{EffectiveContact, Feedback, FeedbackContact, HeatReport};
pub use rubber::{EffectiveRubber, WaveFactors};
pub use setup::{FeedbackSetup, HeatFeedback};
pub use strain::strain_of_waves;
