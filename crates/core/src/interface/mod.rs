//! Shear in the area of contact: the friction that an interface adds to hysteresis.
//!
//! Where rubber touches the road it carries a shear stress τ_f, which depends on the speed v and the temperature T. With
//! the contact area fraction A/A_0 and the mean pressure p,
//!
//! ```text
//! μ = μ_h(p, v, T) + τ_f(v, T) A / (p A_0)
//! ```
//!
//! The sum is exact on a half-space with ν = 1/2, whose surface does not move up or down under shear (Johnson, Contact
//! Mechanics, 1985, sections 2.2 to 2.4); [`shear_coupling`] has what other Poisson ratios add.
//! A is the area with all waves down to the shortest one, so that a measured τ_f belongs to the shortest wavelength at
//! which the area was computed.
//!
//! | item | what it holds |
//! |---|---|
//! | [`ShearLaw`] | τ_f over speed and temperature |
//! | [`fit_shear`] | its constants from measured friction, hysteresis and contact area |
//! | [`shear_coupling`] | contact under shear for any Poisson ratio |
//! | [`LocalFriction`] | shear traction over the normal pressure, for contacts at finite deformation and laws of a finer scale |

mod coupling;
mod error;
mod fit;
mod law;
mod local;

pub use coupling::{ShearCoupling, shear_coupling};
pub use error::ShearError;
pub use fit::{FittedShear, Fixed, Interval, MeasuredFriction, PredictedFriction, fit_shear};
pub use law::{Activation, GaussianShear, ShearLaw, ShearTable};
pub use local::{FrictionOverPressure, LocalFriction, Traction};
