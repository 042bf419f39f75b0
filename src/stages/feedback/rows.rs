//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Every contact: `contacts.arrow`.
pub const CONTACTS: Table<ContactRow> = Table::new("feedback", "contacts.arrow");
/// Contacts without a solution: `unsolved.arrow`.
pub const UNSOLVED: Table<UnsolvedRow> = Table::new("feedback", "unsolved.arrow");

/// What changes the moduli of the rubber in a contact.
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
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Nothing: the temperature before sliding and small strain, as in `bem`.
    #[default]
    Cold,
    /// Strain: each wave has the moduli of its amplitude.
    Soft,
    /// Heat: each wave has the moduli of the temperature that it meets.
    Hot,
    /// Both.
    SoftHot,
}

impl Effect {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::Cold, Self::Soft, Self::Hot, Self::SoftHot];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cold => "cold",
            Self::Soft => "soft",
            Self::Hot => "hot",
            Self::SoftHot => "soft-hot",
        }
    }

    /// Whether strain softens the rubber.
    pub fn has_strain(self) -> bool {
        matches!(self, Self::Soft | Self::SoftHot)
    }

    /// Whether the contact heats the rubber.
    pub fn has_heat(self) -> bool {
        matches!(self, Self::Hot | Self::SoftHot)
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// One surface at one speed and pressure under one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// What changes the moduli: `cold`, nothing; `soft`, strain; `hot`, heat; `soft-hot`, both.
    pub effect: Effect,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient by hysteresis, `mean(p(x) z'(x)) / p`.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Estimated error of the friction coefficient by the grid, absolute, from three coarser grids under the same effect; absent
    /// where these do not resolve the contact.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Estimated error of the contact area fraction by the grid, relative; absent as the one before.
    #[schemars(extend("unit" = "1"))]
    pub relative_area_error: Option<f64>,
    /// Rise of the temperature of the surface in contact over that before sliding, mean over its points; absent without heat.
    #[schemars(extend("unit" = "K"))]
    pub contact_rise_k: Option<f64>,
    /// Highest rise anywhere, at the surface or below it; absent without heat.
    #[schemars(extend("unit" = "K"))]
    pub highest_rise_k: Option<f64>,
    /// Shear stress of the contact area whose power heats it, that of `[adhesion]` at this speed and the temperature before
    /// sliding; absent without heat, 0 without the section.
    #[schemars(extend("unit" = "MPa"))]
    pub shear_mpa: Option<f64>,
    /// Largest amplitude of elongation that a wave meets; absent without strain.
    #[schemars(extend("unit" = "1"))]
    pub largest_strain: Option<f64>,
    /// Contacts solved on the finest grid until the moduli agreed with their contact; 1 of a cold one.
    pub steps: u64,
    /// Points of the finest grid.
    pub grid_points: u64,
    /// Residual of the contact conditions, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Wall time on all grids, of a cold contact on the finest.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for ContactRow {
    const SCHEMA: &'static str = "asperity.feedback.contacts";
    const VERSION: u32 = 1;
}

/// A contact that has no solution, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnsolvedRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// What was to change the moduli.
    pub effect: Effect,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Why there is no value.
    pub reason: String,
}

impl Row for UnsolvedRow {
    const SCHEMA: &'static str = "asperity.feedback.unsolved";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![CONTACTS.schema(), UNSOLVED.schema()]
}
