//! Which surfaces: what stands for the road.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How surfaces are made of a road.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    Serialize,
    Deserialize,
    JsonSchema,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The windows of the scans themselves, made periodic.
    Measured,
    /// The same windows, over which the rubber slides the other way.
    MeasuredBackward,
    /// The spectrum and the heights of a window, other phases.
    Matched,
    /// The spectrum of a window, random phases.
    RandomPhase,
    /// The fitted sines with random phases, the method of the thesis.
    #[default]
    Sines,
    /// Areal: the windows of the maps themselves, made periodic in both directions.
    ArealMeasured,
    /// Areal: the spectrum and the heights of a map, other phases.
    ArealMatched,
    /// Areal: the spectrum of a map, random phases.
    ArealRandomPhase,
    /// Areal: the isotropic spectrum of the line scans, random phases.
    Isotropic,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 9] = [
        Self::Measured,
        Self::MeasuredBackward,
        Self::Matched,
        Self::RandomPhase,
        Self::Sines,
        Self::ArealMeasured,
        Self::ArealMatched,
        Self::ArealRandomPhase,
        Self::Isotropic,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::MeasuredBackward => "measured-backward",
            Self::Matched => "matched",
            Self::RandomPhase => "random-phase",
            Self::Sines => "sines",
            Self::ArealMeasured => "areal-measured",
            Self::ArealMatched => "areal-matched",
            Self::ArealRandomPhase => "areal-random-phase",
            Self::Isotropic => "isotropic",
        }
    }

    /// Whether the surfaces are the windows themselves, of which there are as many as were scanned.
    pub fn is_measured(self) -> bool {
        matches!(self, Self::Measured | Self::MeasuredBackward | Self::ArealMeasured)
    }

    /// Whether a surface is that of one window of the scans, at its own phases or at others.
    pub fn of_a_window(self) -> bool {
        !matches!(self, Self::Sines | Self::Isotropic)
    }

    /// Whether the surfaces are rough in both directions.
    pub fn is_areal(self) -> bool {
        use Method::{ArealMatched, ArealMeasured, ArealRandomPhase, Isotropic};
        matches!(self, ArealMeasured | ArealMatched | ArealRandomPhase | Isotropic)
    }

    /// Whether a recipe may name it in `realise.methods`; the others follow from its other keys.
    pub(super) fn is_a_choice(self) -> bool {
        self == Self::Isotropic || !self.is_areal() && self != Self::MeasuredBackward
    }

    /// What a method of windows of line scans is called where the windows are maps.
    pub fn areal(self) -> Option<Self> {
        match self {
            Self::Measured => Some(Self::ArealMeasured),
            Self::Matched => Some(Self::ArealMatched),
            Self::RandomPhase => Some(Self::ArealRandomPhase),
            _ => None,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Surfaces that stand for one road in one way, and over which friction is averaged.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    Serialize,
    Deserialize,
    JsonSchema,
)]
pub struct SurfaceKind {
    /// How the surfaces are made of the road.
    pub method: Method,
    /// Number of sines of the approximation, which is its name; 0 for the other methods, whose surfaces have thousands of
    /// waves.
    pub waves: u32,
}

impl SurfaceKind {
    /// The approximation by so many sines.
    pub fn sines(waves: u32) -> Self {
        Self { method: Method::Sines, waves }
    }

    /// The surfaces of a method that has but one kind of them.
    pub fn of(method: Method) -> Self {
        Self { method, waves: 0 }
    }

    /// Whether it is the approximation by so many sines.
    pub fn is_sines(self, waves: u32) -> bool {
        self == Self::sines(waves)
    }

    /// Name for files and groups of arrays: `8_waves`, `measured`.
    pub fn file_name(self) -> String {
        match self.method {
            Method::Sines => format!("{}_waves", self.waves),
            method => method.name().replace('-', "_"),
        }
    }
}

/// What a reader calls them: `8 waves`, `measured profiles`.
impl fmt::Display for SurfaceKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.method {
            Method::Measured => f.pad("measured profiles"),
            Method::MeasuredBackward => f.pad("measured profiles, backward"),
            Method::Matched => f.pad("matched phases"),
            Method::RandomPhase => f.pad("random phases"),
            Method::Sines => f.pad(&format!("{} waves", self.waves)),
            Method::ArealMeasured => f.pad("measured maps"),
            Method::ArealMatched => f.pad("maps, matched phases"),
            Method::ArealRandomPhase => f.pad("maps, random phases"),
            Method::Isotropic => f.pad("isotropic surfaces"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_one_name_everywhere() {
        for method in Method::ALL {
            let text = serde_json::to_string(&method).unwrap();
            assert_eq!(text, format!("\"{method}\""));
            let typed = <Method as clap::ValueEnum>::from_str(method.name(), false);
            assert_eq!(typed, Ok(method));
        }
        assert_eq!(SurfaceKind::sines(8).to_string(), "8 waves");
        assert_eq!(SurfaceKind::sines(8).file_name(), "8_waves");
    }
}
