//! What a caller knows of the rubber beyond its moduli at rest temperature and small strain.

use crate::rubber::TemperatureDependence;
use crate::rubber::payne::{PayneLaw, elongation_of_tensor_shear};

/// How moduli depend on temperature: `E(ω, T) = b_T E(a_T ω)`, about any reference.
///
/// A closure from the temperature in °C to `ln a_T` is one.
pub trait TemperatureLaw {
    /// `ln a_T` at a temperature in °C.
    ///
    /// # Errors
    /// Says why the law has no value there: a table ends.
    fn ln_shift(&self, temperature_c: f64) -> Result<f64, String>;

    /// `ln b_T` at a temperature in °C.
    ///
    /// # Errors
    /// As [`Self::ln_shift`].
    fn ln_vertical(&self, temperature_c: f64) -> Result<f64, String> {
        let _ = temperature_c;
        Ok(0.0)
    }
}

impl<F: Fn(f64) -> Result<f64, String>> TemperatureLaw for F {
    fn ln_shift(&self, temperature_c: f64) -> Result<f64, String> {
        self(temperature_c)
    }
}

impl TemperatureLaw for TemperatureDependence {
    fn ln_shift(&self, temperature_c: f64) -> Result<f64, String> {
        let factor = self.shift_factor(temperature_c).map_err(|error| error.to_string())?;
        Ok(factor.ln())
    }

    fn ln_vertical(&self, temperature_c: f64) -> Result<f64, String> {
        Ok(self.vertical_factor(temperature_c).ln())
    }
}

/// How moduli depend on the amplitude of strain (Payne): `E'(ω, e) = f(e) E'(ω)`, `E''(ω, e) = g(e) E''(ω)`.
///
/// The strain is the tensor shear amplitude `|e|` of plane strain, `e = (e_xx - e_zz)/2 + i e_xz`. In simple shear of the amplitude
/// γ it is `γ / 2`; the uniaxial amplitude ε with the same second invariant of the deviator has `|e| = √3/2 ε`.
pub trait StrainLaw {
    /// Storage modulus over that at small strain, `f(e)`.
    ///
    /// # Errors
    /// Says why the law has no value there.
    fn storage_factor(&self, strain: f64) -> Result<f64, String>;

    /// Loss modulus over that at small strain, `g(e)`.
    ///
    /// # Errors
    /// Says why the law has no value there.
    fn loss_factor(&self, strain: f64) -> Result<f64, String>;
}

/// Factors of strain sweeps, at the elongation with the elastic energy of the shear.
impl StrainLaw for PayneLaw {
    fn storage_factor(&self, strain: f64) -> Result<f64, String> {
        Ok(Self::storage_factor(self, elongation_of_tensor_shear(strain)))
    }

    fn loss_factor(&self, strain: f64) -> Result<f64, String> {
        Ok(Self::loss_factor(self, elongation_of_tensor_shear(strain)))
    }
}
