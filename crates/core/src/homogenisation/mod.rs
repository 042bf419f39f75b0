//! Friction scale by scale: short waves as a law of friction for longer ones.
//!
//! The older multiscale methods split a surface into groups of waves that are solved one after the other. Each group is
//! solved over the mean pressure; what it answers, friction, contact area and mean separation, becomes a local law of the
//! next longer group, at the local pressures there. The methods differ in how they group the waves and in what they pass on:
//!
//! | method | groups | passes on |
//! |---|---|---|
//! | Wriggers & Reinelt, Comput. Methods Appl. Mech. Eng. 198, 1996 (2009), doi:10.1016/j.cma.2008.12.021 | every wave one | friction |
//! | Wagner, Wriggers et al. | two, split at a wavelength | friction |
//! | Temizer & Wriggers, Comput. Methods Appl. Mech. Eng. 198, 377 (2008), doi:10.1016/j.cma.2008.08.008 | bumps on a flat below, waves above | friction |
//! | Nitsche | two | friction and separation |
//!
//! All of them assume that a group sees a constant pressure over its period. Where wavelengths double from wave to wave the
//! next group is only twice as long, and the assumption fails.
//!
//! | module | what it does |
//! |---|---|
//! | [`scale`] | the contact of one group under the law of the group below |
//! | [`law`] | friction, area and separation over the mean pressure |
//! | [`recursion`] | from the shortest group to the longest |
//! | `error` | what can go wrong |

mod error;
pub mod law;
pub mod recursion;
pub mod scale;

pub use error::HomogenisationError;
pub use law::ScaleLaw;
pub use recursion::{Homogenised, Passed, homogenise};
pub use scale::{Mechanics, Scale, ScalePoint, Setting};

#[cfg(test)]
mod tests;
