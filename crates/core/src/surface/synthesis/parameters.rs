//! What is to be made: the parameters of a synthetic specimen and their ranges.

use crate::error_kind::{ErrorKind, HasKind};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Parameters of a set of synthetic line scans, in SI.
///
/// The keys of a recipe carry the units. What is left out of a recipe is absent from the surface: one
/// regime, no skewness, a point instrument without tilt, noise and drop-outs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SyntheticAsphalt {
    /// Number of scans, independent of each other; at least 1.
    pub scans: usize,
    /// Length of a scan in metres.
    #[serde(rename = "length_m")]
    pub length: f64,
    /// Distance between raw points in metres.
    #[serde(rename = "spacing_m")]
    pub spacing: f64,
    /// Hurst exponent H of the (inner) self-affine regime, between 0 and 1: HDC ~ s^(2H).
    pub hurst_exponent: f64,
    /// A second self-affine regime between a crossover lag and the parallel correlation length.
    #[serde(default)]
    pub outer_regime: Option<OuterRegime>,
    /// Stones pressed to a common level, with the self-affine surface as the texture of their faces; `None` for
    /// that surface alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stones: Option<Stones>,
    /// Correlation length along the track ξ∥ in metres, where the power law meets the plateau.
    #[serde(rename = "parallel_correlation_length_m")]
    pub parallel_correlation_length: f64,
    /// Correlation length across the surface ξ⊥ in metres: the plateau of the HDC is ξ⊥² = 2 Rq².
    #[serde(rename = "perpendicular_correlation_length_m")]
    pub perpendicular_correlation_length: f64,
    /// Sharpness p of the bend from power law to plateau, from 1 (gradual) to 32 (a corner).
    #[serde(default = "default_plateau_sharpness")]
    pub plateau_sharpness: f64,
    /// Skewness of the surface, -4 to 4; negative for few deep valleys below a flattened top.
    #[serde(default)]
    pub skewness: f64,
    /// 1/e² diameter in metres of the spot over which the instrument averages; 0 for a point.
    #[serde(rename = "spot_diameter_m", default)]
    pub spot_diameter: f64,
    /// Standard deviation of the slope of the plane on which a specimen lies, drawn per scan.
    #[serde(default)]
    pub tilt: f64,
    /// Standard deviation in metres of the noise of a raw point, white and Gaussian.
    #[serde(rename = "noise_m", default)]
    pub noise: f64,
    /// Share of the raw points that are missing, 0 to 0.5.
    #[serde(default)]
    pub missing_fraction: f64,
    /// Mean length of a run of missing points in metres, at most the length; at least the spacing if
    /// any are missing.
    #[serde(rename = "missing_run_length_m", default)]
    pub missing_run_length: f64,
    /// Seed of the random numbers; scan i uses stream i.
    #[serde(default)]
    pub seed: u64,
}

/// The self-affine regime of the longer lags.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OuterRegime {
    /// Hurst exponent, between 0 and 1.
    pub hurst_exponent: f64,
    /// Lag in metres where the inner and the outer power law meet, below ξ∥.
    #[serde(rename = "crossover_lag_m")]
    pub crossover_lag: f64,
}

/// The stones of a rolled road along a line: pits at random distances, and between two of them a face that falls
/// off towards either as `depth |u|^flatness`, u from its middle (0) to the pit (1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stones {
    /// Mean distance between pits in metres, the size of a stone along a line; coefficient of variation 1/3.
    #[serde(rename = "mean_distance_m")]
    pub mean_distance: f64,
    /// Mean depth of the pits below the faces in metres; coefficient of variation 1/3.
    #[serde(rename = "mean_depth_m")]
    pub mean_depth: f64,
    /// Exponent of the fall towards a pit, from 1 (a ridge) to 32 (a plate with slits).
    pub flatness: f64,
}

/// Moments of the heights of a surface about their mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightMoments {
    /// Root mean square height Rq in metres.
    pub rms_height: f64,
    /// Skewness Rsk; negative for few deep valleys below a flattened top.
    pub skewness: f64,
    /// Kurtosis Rku; 3 for Gaussian heights.
    pub kurtosis: f64,
}

/// Why synthetic scans could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SynthesisError {
    /// A parameter is outside its range.
    #[error("{parameter} is {value}; it must be {allowed}")]
    OutOfRange {
        /// Name of the parameter, with its unit.
        parameter: &'static str,
        /// Its value, in SI.
        value: f64,
        /// The range in words, in SI.
        allowed: String,
    },
    /// The scans are too finely resolved for their length.
    #[error(
        "a scan needs {points:.3e} points with its surroundings, the limit is {limit}: raise \
         the spacing or the spot diameter, or lower the length or the parallel correlation length"
    )]
    TooManyPoints {
        /// Points of one period of the surface.
        points: f64,
        /// The most that are made.
        limit: usize,
    },
    /// No random surface has the asked height-difference correlation.
    #[error(
        "no surface has this height-difference correlation: {:.2} % of its power spectrum would be \
         negative; lower the plateau sharpness, {plateau_sharpness}, or bring the Hurst exponents closer",
        negative_share * 100.0
    )]
    NotRealisable {
        /// Share of the spectrum that would be negative.
        negative_share: f64,
        /// The sharpness asked for.
        plateau_sharpness: f64,
    },
}

impl HasKind for SynthesisError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::OutOfRange { .. } | Self::TooManyPoints { .. } | Self::NotRealisable { .. } => {
                ErrorKind::Input
            }
        }
    }
}

impl SyntheticAsphalt {
    /// The bundled specimen: thirty scans of 16 mm after the description of the measured specimen of
    /// the thesis (chapter 3): HDC of slope 1.3 between 0.04 and 0.6 mm, about 1 up to 2.5 mm, and a
    /// plateau of 0.64-0.66 mm² near 5 mm.
    ///
    /// | parameter | from |
    /// |---|---|
    /// | H = 0.65 and 0.5, crossover 0.6 mm | the slopes 2H of the description |
    /// | ξ∥ = 3.5 mm | geometric mean of the end of slope 1 (2.5 mm) and the plateau (5 mm) |
    /// | ξ⊥ = 0.883 mm | expected HDC at 5 mm of 16 mm windows without their slope is 0.65 mm²: the windows see 0.834 ξ⊥² (a test computes it from the covariance) |
    /// | sharpness 4 | slope still 0.97 on 0.6-2.5 mm in such windows; the spectrum stays positive |
    /// | skewness -1 | our choice: rolled asphalt is flattened, windows of 16 mm show about half of it |
    /// | 2 µm spacing, 10 µm spot, 1 µm noise | our choice, usual for a chromatic confocal sensor |
    /// | tilt 0.02, 3 % missing in runs of 40 µm | our choice, so that levelling and drop-outs are exercised |
    ///
    /// | seed 35 | first of 1, 2, 3, ... whose scans, brought to 25 µm, meet the description: plateau at 5 mm within 0.64-0.66 mm², slopes within 0.05 of 1.3 (0.05-0.6 mm) and 1 (0.6-2.5 mm) |
    ///
    /// Thirty scans of 16 mm determine little of the longest waves: over the seeds 1-60 the plateau is
    /// 0.645 mm² with standard deviation 0.10, the slopes 1.32 (0.02) and 0.97 (0.05), and the drop-outs,
    /// which prefer steep and deep places, take about 1 % off the HDC. The mean HDC of the specimen is
    /// selected, therefore; the scatter among its scans is not.
    /// The description stops at 0.04 mm; below, the first power law goes on down to the spot.
    pub fn specimen() -> Self {
        Self {
            scans: 30,
            length: 16e-3,
            spacing: 2e-6,
            hurst_exponent: 0.65,
            outer_regime: Some(OuterRegime { hurst_exponent: 0.5, crossover_lag: 0.6e-3 }),
            stones: None,
            parallel_correlation_length: 3.5e-3,
            perpendicular_correlation_length: 0.883e-3,
            plateau_sharpness: 4.0,
            skewness: -1.0,
            spot_diameter: 10e-6,
            tilt: 0.02,
            noise: 1e-6,
            missing_fraction: 0.03,
            missing_run_length: 40e-6,
            seed: 35,
        }
    }

    /// The bundled rolled road: nine scans of 48 mm across stones whose faces the roller has levelled.
    ///
    /// | parameter | from |
    /// |---|---|
    /// | stones of 8 mm | rolled asphalt of 8 to 11 mm aggregate; with the texture, the octaves of 2 to 8 mm are within a third of those of a measured road |
    /// | pits 2.2 mm deep, flatness 4 | Rq 0.70 mm, skewness -1.4 and kurtosis 5.6 of the surface ([`Self::height_moments`]), measured: below |
    /// | ξ⊥ = 0.424 mm (Rq 0.3 mm), ξ∥ = 2 mm | rms slope 1.5 at 20 µm; 1.3 is that of a measured road without its level jumps |
    /// | H = 0.65 and 0.5, crossover 0.6 mm | the specimen |
    /// | 20 µm spacing and spot, 1 µm noise, tilt 0.02, 3 % missing in runs of 100 µm | our choice: a line laser, with small files |
    /// | seed 1 | the first; nothing is selected |
    ///
    /// What the moments were chosen by (no measured data are in the result): sixteen sections of 24 mm of a rolled test
    /// track less their slope have skewnesses of 0.2 to -2.0, mean -0.9, and kurtoses of 1.5 to 6.9; those of the seven below
    /// -1 are 3.4 to 6.9. Sections of 24 mm of this surface have a skewness of -1.2 ± 0.4 and a kurtosis of 4.4.
    pub fn rolled() -> Self {
        Self {
            scans: 9,
            length: 48e-3,
            spacing: 20e-6,
            stones: Some(Stones { mean_distance: 8e-3, mean_depth: 2.2e-3, flatness: 4.0 }),
            parallel_correlation_length: 2e-3,
            perpendicular_correlation_length: 0.424e-3,
            skewness: 0.0,
            spot_diameter: 20e-6,
            missing_run_length: 100e-6,
            seed: 1,
            ..Self::specimen()
        }
    }

    /// Check every parameter against its range.
    ///
    /// # Errors
    /// [`SynthesisError::OutOfRange`] for the first parameter outside.
    pub fn validate(&self) -> Result<(), SynthesisError> {
        let xi = self.parallel_correlation_length;
        positive("length_m", self.length)?;
        positive("spacing_m", self.spacing)?;
        positive("parallel_correlation_length_m", xi)?;
        positive("perpendicular_correlation_length_m", self.perpendicular_correlation_length)?;
        within("scans", self.scans as f64, 1.0, f64::MAX)?;
        within("length_m", self.length, 2.0 * self.spacing, f64::MAX)?;
        between("hurst_exponent", self.hurst_exponent, 0.0, 1.0)?;
        if let Some(outer) = self.outer_regime {
            between("outer_regime.hurst_exponent", outer.hurst_exponent, 0.0, 1.0)?;
            between("outer_regime.crossover_lag_m", outer.crossover_lag, 0.0, xi)?;
        }
        if let Some(stones) = self.stones {
            within("stones.mean_distance_m", stones.mean_distance, 2.0 * self.spacing, f64::MAX)?;
            within("stones.mean_depth_m", stones.mean_depth, 0.0, f64::MAX)?;
            within("stones.flatness", stones.flatness, 1.0, 32.0)?;
        }
        within("plateau_sharpness", self.plateau_sharpness, 1.0, 32.0)?;
        within("skewness", self.skewness, -4.0, 4.0)?;
        within("spot_diameter_m", self.spot_diameter, 0.0, self.length)?;
        within("tilt", self.tilt, 0.0, 1.0)?;
        within("noise_m", self.noise, 0.0, f64::MAX)?;
        within("missing_fraction", self.missing_fraction, 0.0, 0.5)?;
        let shortest = if self.missing_fraction > 0.0 { self.spacing } else { 0.0 };
        within("missing_run_length_m", self.missing_run_length, shortest, self.length)
    }
}

/// The sharpest usual bend: with two regimes or H up to 0.7 the spectrum stays positive.
fn default_plateau_sharpness() -> f64 {
    4.0
}

fn check(
    inside: bool,
    parameter: &'static str,
    value: f64,
    allowed: impl FnOnce() -> String,
) -> Result<(), SynthesisError> {
    // NaN compares false and is refused with the rest.
    if inside && value.is_finite() {
        return Ok(());
    }
    Err(SynthesisError::OutOfRange { parameter, value, allowed: allowed() })
}

pub(super) fn positive(parameter: &'static str, value: f64) -> Result<(), SynthesisError> {
    check(value > 0.0, parameter, value, || "positive and finite".into())
}

pub(super) fn between(
    parameter: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<(), SynthesisError> {
    check(value > low && value < high, parameter, value, || format!("above {low} and below {high}"))
}

pub(super) fn within(
    parameter: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<(), SynthesisError> {
    check(value >= low && value <= high, parameter, value, || match high {
        f64::MAX => format!("at least {low} and finite"),
        _ => format!("from {low} to {high}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_outside_their_range_are_named() {
        type Spoil = fn(&mut SyntheticAsphalt);
        let cases: [(Spoil, &str); 10] = [
            (|p| p.hurst_exponent = 1.0, "hurst_exponent is 1; it must be above 0 and below 1"),
            (|p| p.scans = 0, "scans is 0; it must be at least 1 and finite"),
            (|p| p.length = f64::NAN, "length_m is NaN; it must be positive and finite"),
            (|p| p.spacing = -2e-6, "spacing_m is -0.000002; it must be positive and finite"),
            (|p| p.length = 3e-6, "length_m is 0.000003; it must be at least 0.000004 and finite"),
            (|p| p.skewness = -4.5, "skewness is -4.5; it must be from -4 to 4"),
            (|p| p.missing_fraction = 0.6, "missing_fraction is 0.6; it must be from 0 to 0.5"),
            (
                |p| {
                    p.stones = Some(Stones {
                        flatness: 0.5,
                        ..SyntheticAsphalt::rolled().stones.unwrap()
                    });
                },
                "stones.flatness is 0.5; it must be from 1 to 32",
            ),
            (|p| p.noise = f64::INFINITY, "noise_m is inf; it must be at least 0 and finite"),
            (
                |p| p.outer_regime.as_mut().unwrap().crossover_lag = 0.01,
                "outer_regime.crossover_lag_m is 0.01; it must be above 0 and below 0.0035",
            ),
        ];
        for (spoil, message) in cases {
            let mut parameters = SyntheticAsphalt::specimen();
            spoil(&mut parameters);
            assert_eq!(parameters.validate().unwrap_err().to_string(), message);
        }
        assert_eq!(SyntheticAsphalt::specimen().validate(), Ok(()));
        assert_eq!(SyntheticAsphalt::rolled().validate(), Ok(()));
    }

    #[test]
    fn a_recipe_names_units_and_refuses_unknown_keys() {
        let recipe = "scans = 3\nlength_m = 0.02\nspacing_m = 1e-5\nhurst_exponent = 0.7\n\
            parallel_correlation_length_m = 2e-3\nperpendicular_correlation_length_m = 5e-4\n";
        let parameters: SyntheticAsphalt = toml::from_str(recipe).unwrap();
        assert_eq!(parameters.validate(), Ok(()));
        assert_eq!((parameters.length, parameters.outer_regime), (0.02, None));
        assert!(toml::from_str::<SyntheticAsphalt>(&format!("{recipe}tilt_deg = 1")).is_err());
        for made in [SyntheticAsphalt::specimen(), SyntheticAsphalt::rolled()] {
            let text = toml::to_string(&made).unwrap();
            assert_eq!(toml::from_str::<SyntheticAsphalt>(&text).unwrap(), made);
        }
    }
}
