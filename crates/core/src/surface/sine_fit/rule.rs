//! How the correlation of superposed sines is compared with that of the scans.
//!
//! A sine of amplitude D and wavenumber q with a random phase has the expected correlation
//! `D² (1 - cos q s)`, of mean `D²`. The thesis holds it at its first maximum `2 D²`, so a surface
//! made of the fitted sines has a mean square height `sum D_i²/2` that is half of what the fitted
//! correlation says: its rms height is too low by `sqrt 2`. The second rule fits the correlation
//! that sines have.
//!
//! That correlation itself is no base for a logarithmic cost. A ladder of wavelengths repeats after
//! the longest, λ: at a lag of λ the superposition is zero, whatever the amplitudes, and that of a road is
//! not. Its mean over all lags from 0 to s,
//!
//! ```text
//! M(s) = 1/s ∫_0^s C(u) du,      M_i(s) = D_i² (1 - sin(q_i s)/(q_i s))        of a sine
//! ```
//!
//! is positive, tends to the plateau `2 Rq²` of a road and to `D²` of a sine, and averages what a
//! window does not tell about single long lags. It is linear in C, so known sines come back
//! exactly. The integral is the trapezoidal rule over the lags that are given, of the scans and of the
//! sines alike: what it misses between log-spaced lags is missing on both sides.
//!
//! Lags beyond half the longest wavelength are left out. There the correlation of a road goes on rising with waves
//! that the ladder does not have, while that of the longest sine falls: a fit of both puts the longer waves into
//! the longest sine and takes it from its neighbours. On a self-affine road the amplitudes up to half
//! the longest wavelength are then those of the octaves of its spectrum, `D_i²/2` the mean square height between
//! `λ_i/√2` and `√2 λ_i`, whatever the roughness beyond.

use super::unit_correlation;
use crate::surface::SineScale;
use crate::surface::correlation::CorrelationSample;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A wave of just two of the shortest lags is sampled and a lag of just half a wave is inside, whatever the round-off of
/// positions read from text.
const ROUND_OFF: f64 = 1e-9;

/// What the fit takes for the correlation of a sine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FitRule {
    /// That of the thesis (3.3.12-13): `2 D² sin²(q s/2)` up to half the wavelength, `2 D²` above.
    /// The rms height of the waves is `1/sqrt 2` of that of the fitted correlation.
    #[default]
    Thesis,
    /// That of a sine, `D² (1 - cos q s)`, compared as means over the lags from 0 to s, up to half the longest
    /// wavelength: known sines come back, and the waves have the rms height of the scans in their range of wavelengths.
    Sines,
}

impl FitRule {
    /// Whether this is the rule that a recipe without the key has.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Name of the rule and what it does to the rms height, for the metadata of a result.
    pub fn statement(self) -> &'static str {
        match self {
            Self::Thesis => {
                "thesis: the correlation of a wave stays at 2 D^2 above half its wavelength; surfaces of these waves have \
                 1/sqrt(2) of the rms height of the fitted correlation"
            }
            Self::Sines => {
                "sines: the correlation of a wave is D^2 (1 - cos(q s)), fitted as the mean over the lags from 0 to s, up to half the \
                 longest wavelength; surfaces of these waves have the rms height of the scans in their range of wavelengths"
            }
        }
    }

    /// What a fit of waves up to a longest one (metres) compares at each lag, in m²: the correlation of the scans
    /// ([`FitRule::Thesis`]) or its mean over the lags from 0 to s ([`FitRule::Sines`]), the latter by ascending lag
    /// up to half the longest wave.
    pub fn compared(
        self,
        samples: &[CorrelationSample],
        longest_wave: f64,
    ) -> Vec<CorrelationSample> {
        match self {
            Self::Thesis => samples.to_vec(),
            Self::Sines => {
                let within = |sample: &&CorrelationSample| {
                    sample.lag <= 0.5 * longest_wave * (1.0 + ROUND_OFF)
                };
                let mut sorted: Vec<_> = samples.iter().filter(within).copied().collect();
                sorted.sort_by(|a, b| a.lag.total_cmp(&b.lag));
                let values: Vec<f64> = sorted.iter().map(|sample| sample.value).collect();
                let means = means_from_zero(&lags(&sorted), &values);
                let averaged = |(sample, value): (&CorrelationSample, f64)| CorrelationSample {
                    value,
                    ..*sample
                };
                sorted.iter().zip(means).map(averaged).collect()
            }
        }
    }

    /// The same of superposed sines with independent phases in m², at ascending lags in metres.
    pub fn superposed(self, scales: &[SineScale], lags: &[f64]) -> Vec<f64> {
        let shapes: Vec<Vec<f64>> =
            scales.iter().map(|scale| self.unit_shape(scale.wavelength, lags)).collect();
        let at = |j: usize| {
            let terms = scales.iter().zip(&shapes);
            terms.map(|(scale, shape)| scale.amplitude.powi(2) * shape[j]).sum()
        };
        (0..lags.len()).map(at).collect()
    }

    /// The same of a sine of amplitude 1, at ascending lags.
    pub(super) fn unit_shape(self, wavelength: f64, lags: &[f64]) -> Vec<f64> {
        match self {
            Self::Thesis => lags.iter().map(|&lag| unit_correlation(wavelength, lag)).collect(),
            Self::Sines => {
                // Shorter than two lags it would take the values of a longer wave; its mean is 1.
                let two_lags = 2.0 * lags.first().copied().unwrap_or_default();
                if wavelength < two_lags * (1.0 - ROUND_OFF) {
                    return vec![1.0; lags.len()];
                }
                // 1 - cos without its round-off at short lags.
                let sine = |lag: &f64| 2.0 * (PI * lag / wavelength).sin().powi(2);
                means_from_zero(lags, &lags.iter().map(sine).collect::<Vec<_>>())
            }
        }
    }
}

/// Lags in metres.
pub(super) fn lags(samples: &[CorrelationSample]) -> Vec<f64> {
    samples.iter().map(|sample| sample.lag).collect()
}

/// Means of values over the lags from 0, where the value is 0, to each of the ascending lags, by the trapezoidal rule.
fn means_from_zero(lags: &[f64], values: &[f64]) -> Vec<f64> {
    let (mut before, mut sum) = ((0.0, 0.0), 0.0);
    let mut mean = |(&lag, &value): (&f64, &f64)| {
        sum += 0.5 * (lag - before.0) * (value + before.1);
        before = (lag, value);
        sum / lag
    };
    lags.iter().zip(values).map(&mut mean).collect()
}

/// Root mean square height in metres that a correlation says a surface has: `sqrt(plateau/2)`, with the mean
/// of the correlation over the lags above half the longest for the plateau (trapezoidal rule).
///
/// A correlation that still rises there has no plateau, and the surface is higher over longer distances.
/// Zero without lags.
pub fn rms_height_of_correlation(samples: &[CorrelationSample]) -> f64 {
    let longest = samples.iter().map(|sample| sample.lag).fold(0.0, f64::max);
    let last: Vec<_> = samples.iter().filter(|sample| sample.lag >= 0.5 * longest).collect();
    let pairs = last.windows(2).map(|pair| (pair[1].lag - pair[0].lag, pair));
    let (length, area) = pairs.fold((0.0, 0.0), |(length, area), (step, pair)| {
        (length + step, area + 0.5 * step * (pair[0].value + pair[1].value))
    });
    let single = || last.first().map_or(0.0, |sample| sample.value);
    let plateau = if length > 0.0 { area / length } else { single() };
    (0.5 * plateau).sqrt()
}
