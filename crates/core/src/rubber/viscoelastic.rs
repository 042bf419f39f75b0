//! What a linear model asks of a rubber.

use super::{FrequencyRange, RubberError};
use rustfft::num_complex::Complex64;

/// A linear viscoelastic solid, known by its complex modulus and a Poisson ratio that is the same at all frequencies.
///
/// This is all that the half-space and the theories ask of a rubber, so a model of relaxation ([`super::Rubber`]) and a
/// table of measured moduli ([`super::MeasuredModuli`]) serve alike.
pub trait Viscoelastic {
    /// Name under which messages quote it.
    fn name(&self) -> &str;

    /// Complex modulus `E(ω) = E'(ω) + i E''(ω)` in Pa at the angular frequency ω in rad/s, with `E(-ω)` the conjugate of
    /// `E(ω)`: storage modulus and loss modulus.
    ///
    /// Outside the [measured](Self::measured) frequencies it is the modulus at their nearer end. Who needs a true value
    /// there calls [`Self::require`] first.
    fn complex_modulus(&self, angular_frequency: f64) -> Complex64;

    /// Poisson ratio ν.
    fn poisson_ratio(&self) -> f64;

    /// Checks that the numbers are those of a solid.
    ///
    /// # Errors
    /// Names the first number that is not.
    fn validate(&self) -> Result<(), RubberError>;

    /// Frequencies at which the modulus is known; all of them if `None`.
    fn measured(&self) -> Option<FrequencyRange> {
        None
    }

    /// Complex reduced modulus `E_r(ω) = E(ω) / (1 - ν²)` of plane strain, in Pa.
    fn reduced_modulus(&self, angular_frequency: f64) -> Complex64 {
        self.complex_modulus(angular_frequency) / (1.0 - self.poisson_ratio().powi(2))
    }

    /// Reduced modulus in Pa that a wave of the `wavenumber` in rad/m meets at the frequency ω in rad/s. It is
    /// [`Self::reduced_modulus`] in a rubber that is the same everywhere; one that is warmer or softer where its short waves
    /// work (`contact::effective::EffectiveRubber`) has a modulus of its own for each wave. The half-spaces ask this.
    fn reduced_modulus_of_wave(&self, wavenumber: f64, angular_frequency: f64) -> Complex64 {
        let _ = wavenumber;
        self.reduced_modulus(angular_frequency)
    }

    /// Checks that the modulus is known at all frequencies of a range.
    ///
    /// # Errors
    /// [`RubberError::NotMeasured`] with the end of `asked` that lies outside.
    fn require(&self, asked: FrequencyRange) -> Result<(), RubberError> {
        let Some(measured) = self.measured() else { return Ok(()) };
        let Some(frequency_hz) = measured.first_outside(asked) else { return Ok(()) };
        Err(RubberError::NotMeasured { rubber: self.name().into(), frequency_hz, measured })
    }
}
