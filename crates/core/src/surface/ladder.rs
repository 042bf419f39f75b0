//! The ladder of wavelengths that represent a surface: each twice the one before.

use crate::error_kind::{ErrorKind, HasKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use thiserror::Error;

/// Positions read from text carry round-off; a wavelength on a limit counts as inside.
const ROUND_OFF: f64 = 1e-9;

/// Wavelengths `lambda_i = 2^(i - 1) lambda_1`, `i = 1 ... waves`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ladder {
    /// λ_1 in metres.
    pub shortest_wavelength: f64,
    /// Number of waves.
    pub waves: usize,
}

/// What to do with a wavelength that a scan does not determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Undetermined {
    /// Leave it out of the fit.
    #[default]
    Drop,
    /// Fit it all the same.
    Keep,
}

/// A warning: a wavelength of the ladder that the scan does not determine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UndeterminedWavelength {
    /// The wavelength in metres.
    pub wavelength: f64,
    /// The limit it is beyond.
    pub limit: WavelengthLimit,
    /// Whether it was dropped or kept.
    pub policy: Undetermined,
}

/// What a scan determines, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WavelengthLimit {
    /// Not below two sample spacings.
    TwoSamples(f64),
    /// Not below what the spot or tip of the instrument shows as it is.
    Instrument(f64),
    /// Not above half a window.
    HalfWindow(f64),
}

impl fmt::Display for UndeterminedWavelength {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wavelength_mm = self.wavelength * 1e3;
        write!(
            formatter,
            "wavelength {wavelength_mm:.6} mm is not determined by the scan: it is "
        )?;
        match self.limit {
            WavelengthLimit::TwoSamples(limit) => {
                write!(formatter, "below two sample spacings ({:.6} mm)", limit * 1e3)?;
            }
            WavelengthLimit::Instrument(limit) => {
                let limit_mm = limit * 1e3;
                write!(
                    formatter,
                    "below the shortest reliable wavelength of the instrument ({limit_mm:.6} mm)"
                )?;
            }
            WavelengthLimit::HalfWindow(limit) => {
                write!(formatter, "above half the window ({:.6} mm)", limit * 1e3)?;
            }
        }
        match self.policy {
            Undetermined::Drop => write!(formatter, "; left out"),
            Undetermined::Keep => write!(formatter, "; kept"),
        }
    }
}

/// A ladder that cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LadderError {
    /// No waves.
    #[error("a ladder of 0 waves; ask for at least 1, usually 8 or 9")]
    NoWaves,
    /// A wavelength that is not positive.
    #[error("shortest wavelength {wavelength} m; give a positive length")]
    NotPositive {
        /// The wavelength in metres.
        wavelength: f64,
    },
    /// Every wave is beyond the limits.
    #[error(
        "none of the {waves} wavelengths from {shortest} m lies between the shortest reliable one ({shortest_reliable} m) and half a window ({half_window} m); move the ladder or keep undetermined waves"
    )]
    NothingDetermined {
        /// Number of waves.
        waves: usize,
        /// The shortest wavelength in metres.
        shortest: f64,
        /// The shortest reliable wavelength in metres, two spacings or more.
        shortest_reliable: f64,
        /// Half the window in metres.
        half_window: f64,
    },
}

impl HasKind for LadderError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoWaves | Self::NotPositive { .. } | Self::NothingDetermined { .. } => {
                ErrorKind::Input
            }
        }
    }
}

impl Ladder {
    /// Ladder of `waves` waves; it starts at two sample spacings (metres) if no
    /// `shortest_wavelength` (metres) is given.
    ///
    /// # Errors
    /// No waves, or a wavelength that is not positive and finite.
    pub fn new(
        shortest_wavelength: Option<f64>,
        spacing: f64,
        waves: usize,
    ) -> Result<Self, LadderError> {
        let shortest_wavelength = shortest_wavelength.unwrap_or(2.0 * spacing);
        if waves == 0 {
            return Err(LadderError::NoWaves);
        }
        if !(shortest_wavelength > 0.0 && shortest_wavelength.is_finite()) {
            return Err(LadderError::NotPositive { wavelength: shortest_wavelength });
        }
        Ok(Self { shortest_wavelength, waves })
    }

    /// All wavelengths in metres, ascending.
    pub fn wavelengths(&self) -> Vec<f64> {
        (0..self.waves).map(|i| self.shortest_wavelength * 2_f64.powi(i as i32)).collect()
    }

    /// The wavelengths to fit, and a warning for each one that scans of this spacing and window
    /// length (metres) do not determine: below two spacings nothing is sampled, below the
    /// `shortest_reliable` wavelength (metres) the spot or tip of the instrument shows it changed,
    /// above half a window the lag of half a wave has fewer than three independent pairs.
    ///
    /// # Errors
    /// No wavelength is left.
    pub fn for_scans(
        &self,
        spacing: f64,
        window_length: f64,
        shortest_reliable: f64,
        policy: Undetermined,
    ) -> Result<(Vec<f64>, Vec<UndeterminedWavelength>), LadderError> {
        let (two_samples, half_window) = (2.0 * spacing, window_length / 2.0);
        let limit = |wavelength: f64| {
            if wavelength < two_samples * (1.0 - ROUND_OFF) {
                Some(WavelengthLimit::TwoSamples(two_samples))
            } else if wavelength < shortest_reliable * (1.0 - ROUND_OFF) {
                Some(WavelengthLimit::Instrument(shortest_reliable))
            } else if wavelength > half_window * (1.0 + ROUND_OFF) {
                Some(WavelengthLimit::HalfWindow(half_window))
            } else {
                None
            }
        };
        let all = self.wavelengths();
        let warn = |&wavelength: &f64| {
            Some(UndeterminedWavelength { wavelength, limit: limit(wavelength)?, policy })
        };
        let warnings = all.iter().filter_map(warn).collect();
        let kept = |&wavelength: &f64| policy == Undetermined::Keep || limit(wavelength).is_none();
        let wavelengths: Vec<f64> = all.into_iter().filter(kept).collect();
        if wavelengths.is_empty() {
            let (waves, shortest) = (self.waves, self.shortest_wavelength);
            return Err(LadderError::NothingDetermined {
                waves,
                shortest,
                shortest_reliable: shortest_reliable.max(two_samples),
                half_window,
            });
        }
        Ok((wavelengths, warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_waves_from_a_sixteenth_of_a_millimetre_end_at_eight() {
        let ladder = Ladder::new(Some(6.25e-5), 1e-5, 8).unwrap();
        assert_eq!(ladder.wavelengths().last(), Some(&(6.25e-5 * 128.0)));
        assert_eq!(Ladder::new(None, 1e-5, 3).unwrap().wavelengths(), [2e-5, 4e-5, 8e-5]);
    }

    #[test]
    fn undetermined_waves_are_dropped_or_kept_and_always_named() {
        let ladder = Ladder::new(Some(1e-5), 1e-5, 5).unwrap();
        let (wavelengths, warnings) =
            ladder.for_scans(1e-5, 1.6e-4, 0.0, Undetermined::Drop).unwrap();
        assert_eq!(wavelengths, [2e-5, 4e-5, 8e-5]);
        let messages: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            messages,
            [
                "wavelength 0.010000 mm is not determined by the scan: it is below two sample \
                 spacings (0.020000 mm); left out",
                "wavelength 0.160000 mm is not determined by the scan: it is above half the window \
                 (0.080000 mm); left out"
            ]
        );
        let (wavelengths, warnings) =
            ladder.for_scans(1e-5, 1.6e-4, 0.0, Undetermined::Keep).unwrap();
        assert_eq!((wavelengths.len(), warnings.len()), (5, 2));
    }

    #[test]
    fn waves_that_the_instrument_blurs_are_left_out() {
        let ladder = Ladder::new(Some(2e-5), 1e-5, 4).unwrap();
        let (wavelengths, warnings) =
            ladder.for_scans(1e-5, 1e-3, 8e-5, Undetermined::Drop).unwrap();
        assert_eq!(wavelengths, [8e-5, 16e-5]);
        assert_eq!(warnings[1].limit, WavelengthLimit::Instrument(8e-5));
        assert_eq!(
            warnings[1].to_string(),
            "wavelength 0.040000 mm is not determined by the scan: it is below the shortest \
             reliable wavelength of the instrument (0.080000 mm); left out"
        );
    }

    #[test]
    fn impossible_ladders_are_errors() {
        assert_eq!(Ladder::new(None, 1e-5, 0), Err(LadderError::NoWaves));
        assert!(matches!(Ladder::new(Some(-1.0), 1e-5, 8), Err(LadderError::NotPositive { .. })));
        assert!(Ladder::new(Some(f64::NAN), 1e-5, 8).is_err());
        let short = Ladder::new(Some(1e-6), 1e-5, 2).unwrap();
        let none = short.for_scans(1e-5, 1.0, 0.0, Undetermined::Drop).unwrap_err();
        assert!(matches!(none, LadderError::NothingDetermined { waves: 2, .. }));
    }
}
