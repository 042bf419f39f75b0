//! Moduli as they were measured, without a model.

use super::fit::SweepPoint;
use super::{FrequencyRange, RubberError, Viscoelastic};
use crate::numerics::interpolation::CubicHermite;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// A measured master curve: storage and loss modulus over frequency at one temperature, and a Poisson ratio.
///
/// Between the points `ln E'` and `ln E''` are cubic in `ln ω` and monotone where the points are
/// ([`CubicHermite::monotone_parabolas`]), so that scatter is not amplified. At the points the measured moduli are
/// met to round-off. Outside them nothing is known: models that need a modulus there refuse with
/// [`RubberError::NotMeasured`].
///
/// The two moduli are interpolated independently, so the curve is causal only as far as the measurement is.
///
/// ```
/// use asperity_core::contact::SlidingContact;
/// use asperity_core::rubber::MeasuredModuli;
/// use asperity_core::rubber::fit::SweepPoint;
/// use asperity_core::surface::{Wave, wave};
///
/// // E = 4 MPa (ω s)^(1/4) e^{iπ/8}: a loss factor of tan(π/8) at all frequencies.
/// let (sine, cosine) = (std::f64::consts::PI / 8.0).sin_cos();
/// let point = |decade: i32| {
///     let angular_frequency = 10_f64.powi(decade);
///     let modulus = 4e6 * angular_frequency.powf(0.25);
///     SweepPoint { angular_frequency, storage_modulus: modulus * cosine, loss_modulus: modulus * sine }
/// };
/// let points: Vec<SweepPoint> = (0..8).map(point).collect();
/// let rubber = MeasuredModuli::new("power law", 0.5, &points)?;
/// let period = 1e-3;
/// let profile = wave::sample(&[Wave { wavelength: period, amplitude: 1e-5, phase: 0.0 }], period, 256);
/// let friction = SlidingContact::new(&rubber, 0.01, period, &profile)?.solve(1e5)?.friction_coefficient;
/// assert!(friction > 0.0);
/// // 1 m/s on waves of 1 mm and shorter: up to 128 kHz, measured are 1.6 MHz at most.
/// assert!(SlidingContact::new(&rubber, 1.0, period, &profile).is_ok());
/// let error = SlidingContact::new(&rubber, 100.0, period, &profile).err().unwrap();
/// assert!(error.to_string().contains("not known at 1.280e7 Hz"), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredModuli {
    name: String,
    poisson_ratio: f64,
    measured: FrequencyRange,
    ln_storage: CubicHermite,
    ln_loss: CubicHermite,
}

impl MeasuredModuli {
    /// The rubber through `points` of Young's modulus by ascending frequency.
    ///
    /// # Errors
    /// [`RubberError::TooFewPoints`] for fewer than two; [`RubberError::NotPositive`] for a number of a point that is not
    /// positive and finite, and [`RubberError::NotAscending`] for the first frequency that is not above the one
    /// before; [`RubberError::PoissonRatio`] outside `[0, 0.5]`.
    pub fn new(name: &str, poisson_ratio: f64, points: &[SweepPoint]) -> Result<Self, RubberError> {
        let rubber = || String::from(name);
        if !(0.0..=0.5).contains(&poisson_ratio) {
            return Err(RubberError::PoissonRatio { rubber: rubber(), value: poisson_ratio });
        }
        let [first, .., last] = points else {
            return Err(RubberError::TooFewPoints { rubber: rubber(), points: points.len() });
        };
        for (index, point) in points.iter().enumerate() {
            if let Some((quantity, value)) = first_not_positive(point) {
                let quantity = format!("{quantity} of point {}", index + 1);
                return Err(RubberError::NotPositive { rubber: rubber(), quantity, value });
            }
        }
        let falls = |pair: &[SweepPoint]| pair[1].angular_frequency <= pair[0].angular_frequency;
        if let Some(index) = points.windows(2).position(falls) {
            let [before_hz, frequency_hz] =
                [index, index + 1].map(|k| points[k].angular_frequency / TAU);
            return Err(RubberError::NotAscending { rubber: rubber(), frequency_hz, before_hz });
        }
        let logarithm = |of: fn(&SweepPoint) -> f64| points.iter().map(|p| of(p).ln()).collect();
        let curve = |of| {
            CubicHermite::monotone_parabolas(logarithm(|p| p.angular_frequency), logarithm(of))
        };
        Ok(Self {
            name: rubber(),
            poisson_ratio,
            measured: FrequencyRange {
                lowest_hz: first.angular_frequency / TAU,
                highest_hz: last.angular_frequency / TAU,
            },
            ln_storage: curve(|p| p.storage_modulus),
            ln_loss: curve(|p| p.loss_modulus),
        })
    }
}

/// The first number of a point that is not positive and finite.
fn first_not_positive(point: &SweepPoint) -> Option<(&'static str, f64)> {
    [
        ("the angular frequency", point.angular_frequency),
        ("the storage modulus", point.storage_modulus),
        ("the loss modulus", point.loss_modulus),
    ]
    .into_iter()
    .find(|(_, value)| !(*value > 0.0 && value.is_finite()))
}

impl Viscoelastic for MeasuredModuli {
    fn name(&self) -> &str {
        &self.name
    }

    fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        let at = angular_frequency.abs().ln();
        let [storage, loss] = [&self.ln_storage, &self.ln_loss].map(|curve| curve.at(at).exp());
        Complex64::new(storage, loss.copysign(angular_frequency))
    }

    fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// The constructor has checked it.
    fn validate(&self) -> Result<(), RubberError> {
        Ok(())
    }

    fn measured(&self) -> Option<FrequencyRange> {
        Some(self.measured)
    }
}
