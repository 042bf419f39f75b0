//! Section `[methods]` of a recipe.

use crate::homogenisation::Mechanics;
use crate::requirement::{InvalidRecipe, require};
use crate::stages::bem::no_repeats;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Section `[methods]` of a recipe: the older multiscale methods beside the models of the run, on surfaces of sines, at the
/// speeds, areas and pressures of `[bem]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Methods {
    /// Which methods: `recursive` (Wriggers & Reinelt), `split` (Wagner & Wriggers), `particles` (Temizer & Wriggers),
    /// `projection` (Nitsche); all of them if not set.
    pub methods: Vec<OlderMethod>,
    /// How each scale is solved: `half-space`, for small slopes, or `finite-deformation`; both if not set.
    pub mechanics: Vec<ScaleMechanics>,
    /// Numbers of the shortest waves below a split, for `split` and `projection`: each is a row of its own; every
    /// possible number if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub split_waves: Vec<u32>,
    /// Numbers of waves whose surfaces are solved, among those of `[realise]`; all of them if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub waves: Vec<u32>,
    /// Grid points on the shortest wave of each scale, on the half-space.
    pub points_per_shortest_wavelength: u32,
    /// Elements on the shortest wave of each scale, at finite deformation.
    pub columns_per_shortest_wavelength: u32,
    /// Ratio of neighbouring pressures of every law and of the curve.
    pub pressure_ratio: f64,
}

impl Default for Methods {
    fn default() -> Self {
        Self {
            methods: OlderMethod::ALL.to_vec(),
            mechanics: vec![ScaleMechanics::HalfSpace, ScaleMechanics::FiniteDeformation],
            split_waves: Vec::new(),
            waves: Vec::new(),
            points_per_shortest_wavelength: 256,
            columns_per_shortest_wavelength: 64,
            pressure_ratio: 1.4,
        }
    }
}

/// A multiscale method that solves scales one after the other.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum OlderMethod {
    /// Wave by wave, from the shortest to the longest: Wriggers & Reinelt.
    Recursive,
    /// Short waves together and long waves together: Wagner & Wriggers.
    Split,
    /// The crests of the shortest wave as bumps on a flat, under all other waves: Temizer & Wriggers.
    Particles,
    /// As `split`, and long waves stand on the mean separation of the short ones: Nitsche.
    Projection,
}

impl OlderMethod {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Recursive, Self::Split, Self::Particles, Self::Projection];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Recursive => "recursive",
            Self::Split => "split",
            Self::Particles => "particles",
            Self::Projection => "projection",
        }
    }
}

impl std::fmt::Display for OlderMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// How a scale is solved.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum ScaleMechanics {
    /// The viscoelastic half-space.
    HalfSpace,
    /// Finite deformation.
    FiniteDeformation,
}

impl ScaleMechanics {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::FiniteDeformation => "finite-deformation",
        }
    }
}

impl std::fmt::Display for ScaleMechanics {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl From<ScaleMechanics> for Mechanics {
    fn from(mechanics: ScaleMechanics) -> Self {
        match mechanics {
            ScaleMechanics::HalfSpace => Self::HalfSpace,
            ScaleMechanics::FiniteDeformation => Self::FiniteDeformation,
        }
    }
}

impl Methods {
    /// Whether any scale is solved at finite deformation.
    pub fn has_finite_deformation(&self) -> bool {
        self.mechanics.contains(&ScaleMechanics::FiniteDeformation)
    }

    /// Whether surfaces of that many sines are solved.
    pub fn takes(&self, waves: u32) -> bool {
        self.waves.is_empty() || self.waves.contains(&waves)
    }

    /// Points or elements on the shortest wave of a scale.
    pub(super) fn resolution(&self, mechanics: ScaleMechanics) -> usize {
        match mechanics {
            ScaleMechanics::HalfSpace => self.points_per_shortest_wavelength as usize,
            ScaleMechanics::FiniteDeformation => self.columns_per_shortest_wavelength as usize,
        }
    }

    /// Checks the section beside the numbers of waves of `[realise]`.
    pub(crate) fn check(&self, realised: &[u32]) -> Result<(), InvalidRecipe> {
        let names: Vec<&str> = self.methods.iter().map(|method| method.name()).collect();
        let wanted = "one method or more, each once: recursive, split, particles, projection";
        require(!names.is_empty() && no_repeats(&names), "methods.methods", &names, wanted)?;
        let names: Vec<&str> = self.mechanics.iter().map(|mechanics| mechanics.name()).collect();
        let wanted = "half-space, finite-deformation or both, each once";
        require(!names.is_empty() && no_repeats(&names), "methods.mechanics", &names, wanted)?;
        let known = self.waves.iter().all(|waves| realised.contains(waves));
        let wanted = "numbers of waves that also stand in realise.waves";
        require(known && no_repeats(&self.waves), "methods.waves", &self.waves, wanted)?;
        let most = realised.iter().filter(|waves| self.takes(**waves)).max().copied();
        let wanted =
            "left out where realise.waves has no surfaces of sines: the methods split waves";
        require(most.is_some(), "methods", "a section", wanted)?;
        let most = most.unwrap_or(0);
        let splits = &self.split_waves;
        let possible = splits.iter().all(|waves| (1..most).contains(waves));
        let wanted = "numbers of short waves, each once, from 1 to one less than the surface has";
        require(possible && no_repeats(splits), "methods.split_waves", splits, wanted)?;
        let points = self.points_per_shortest_wavelength;
        let key = "methods.points_per_shortest_wavelength";
        require((32..=65536).contains(&points), key, points, "32 to 65536")?;
        let columns = self.columns_per_shortest_wavelength;
        let key = "methods.columns_per_shortest_wavelength";
        let wanted = "32 to 1024, and even";
        require((32..=1024).contains(&columns) && columns.is_multiple_of(2), key, columns, wanted)?;
        let ratio = self.pressure_ratio;
        require(
            (1.01..=2.0).contains(&ratio),
            "methods.pressure_ratio",
            ratio,
            "between 1.01 and 2",
        )
    }
}
