//! Moduli as they were measured, without a model.

use super::fit::SweepPoint;
use super::{FrequencyRange, RubberError, Viscoelastic};
use crate::numerics::interpolation::CubicHermite;
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// What is done where a modulus is asked for outside the measured frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// [`Viscoelastic::require`] fails with [`RubberError::NotMeasured`].
    #[default]
    Refuse,
    /// The moduli keep the values at the nearer end. A held loss modulus is not that of a held storage modulus, so this is
    /// a stopgap for waves that matter little.
    Hold,
}

/// A measured master curve: storage and loss modulus over frequency at one temperature, and a Poisson ratio.
///
/// Between the points `ln E'` and `ln E''` are cubic in `ln ω` and monotone where the points are
/// ([`CubicHermite::monotone_parabolas`]), so that scatter is not amplified. At the points the measured moduli are
/// met to round-off. Outside them nothing is known: models that need a modulus there refuse with
/// [`RubberError::NotMeasured`], unless the moduli are to be held ([`Extrapolation::Hold`]).
///
/// The two moduli are interpolated independently, so the curve is causal only as far as the measurement is:
/// [`Causality`](super::causality::Causality) tells how far. Measured rows that scatter are put in order by
/// [`Cleaned`](super::Cleaned) first. At frequency zero the modulus is the storage modulus at the lowest frequency.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct MeasuredModuli {
    name: String,
    poisson_ratio: f64,
    extrapolation: Extrapolation,
    points: Vec<SweepPoint>,
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
        if points.len() < 2 {
            return Err(RubberError::TooFewPoints { rubber: rubber(), points: points.len() });
        }
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
        Ok(Self::through(rubber(), poisson_ratio, Extrapolation::Refuse, points.to_vec()))
    }

    /// The curves through points that have been checked.
    fn through(
        name: String,
        poisson_ratio: f64,
        extrapolation: Extrapolation,
        points: Vec<SweepPoint>,
    ) -> Self {
        let logarithm = |of: fn(&SweepPoint) -> f64| points.iter().map(|p| of(p).ln()).collect();
        let curve = |of| {
            CubicHermite::monotone_parabolas(logarithm(|p| p.angular_frequency), logarithm(of))
        };
        let [ln_storage, ln_loss] = [curve(|p| p.storage_modulus), curve(|p| p.loss_modulus)];
        Self { name, poisson_ratio, extrapolation, points, ln_storage, ln_loss }
    }

    /// The same table with another answer to frequencies outside it.
    pub fn with_extrapolation(mut self, extrapolation: Extrapolation) -> Self {
        self.extrapolation = extrapolation;
        self
    }

    /// What is done outside the measured frequencies.
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// The points by ascending frequency, in SI.
    pub fn points(&self) -> &[SweepPoint] {
        &self.points
    }

    /// The measured frequencies.
    pub fn range(&self) -> FrequencyRange {
        let hertz =
            |point: Option<&SweepPoint>| point.map_or(f64::NAN, |p| p.angular_frequency / TAU);
        FrequencyRange {
            lowest_hz: hertz(self.points.first()),
            highest_hz: hertz(self.points.last()),
        }
    }

    /// The table at another temperature, `E(a ω)` in place of `E(ω)` for a positive factor a: frequencies divided by it.
    pub fn shifted(&self, factor: f64) -> Self {
        self.mapped(|point| SweepPoint {
            angular_frequency: point.angular_frequency / factor,
            ..*point
        })
    }

    /// The table with all moduli multiplied by a positive factor.
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|point| SweepPoint {
            storage_modulus: point.storage_modulus * factor,
            loss_modulus: point.loss_modulus * factor,
            ..*point
        })
    }

    fn mapped(&self, map: impl Fn(&SweepPoint) -> SweepPoint) -> Self {
        let points = self.points.iter().map(map).collect();
        Self::through(self.name.clone(), self.poisson_ratio, self.extrapolation, points)
    }
}

/// The table as it is stored: its points, from which the curves are made.
#[derive(Clone, Serialize, Deserialize)]
struct Stored {
    name: String,
    poisson_ratio: f64,
    extrapolation: Extrapolation,
    points: Vec<SweepPoint>,
}

impl From<MeasuredModuli> for Stored {
    fn from(table: MeasuredModuli) -> Self {
        let MeasuredModuli { name, poisson_ratio, extrapolation, points, .. } = table;
        Self { name, poisson_ratio, extrapolation, points }
    }
}

impl TryFrom<Stored> for MeasuredModuli {
    type Error = RubberError;

    fn try_from(stored: Stored) -> Result<Self, RubberError> {
        let table = Self::new(&stored.name, stored.poisson_ratio, &stored.points)?;
        Ok(table.with_extrapolation(stored.extrapolation))
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
        if angular_frequency == 0.0 {
            return Complex64::new(storage, 0.0);
        }
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
        Some(self.range())
    }

    fn require(&self, asked: FrequencyRange) -> Result<(), RubberError> {
        let frequency_hz = match self.extrapolation {
            Extrapolation::Hold => return Ok(()),
            Extrapolation::Refuse => self.range().first_outside(asked),
        };
        let Some(frequency_hz) = frequency_hz else { return Ok(()) };
        Err(RubberError::NotMeasured {
            rubber: self.name.clone(),
            frequency_hz,
            measured: self.range(),
        })
    }
}
