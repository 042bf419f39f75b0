//! The contact area fractions and mean pressures at which a recipe asks for friction.

use super::Bem;
use crate::requirement::{InvalidRecipe, require};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a value of friction is given for: the other of the two follows from the contact.
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
pub enum Given {
    /// A contact area fraction, the same for all realisations.
    #[default]
    Area,
    /// A mean pressure, the same for all realisations.
    Pressure,
}

impl Given {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Pressure => "pressure",
        }
    }
}

/// Contact area fractions and mean pressures at which a recipe asks for friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Contact area fractions, ascending.
    pub area_fractions: Vec<f64>,
    /// Mean pressures in MPa, ascending.
    pub pressures_mpa: Vec<f64>,
}

impl Wanted {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.area_fractions.len() + self.pressures_mpa.len()
    }

    /// Those of which there are more: area and pressure are nearly proportional, so that either range tells how far
    /// contacts are pressed.
    pub(crate) fn range(&self) -> &[f64] {
        let longer = self.area_fractions.len() >= self.pressures_mpa.len();
        if longer { &self.area_fractions } else { &self.pressures_mpa }
    }
}

/// Pressures that a recipe may ask for, in MPa: from below the weight of a film to above the strength of any rubber.
const PRESSURES_MPA: std::ops::RangeInclusive<f64> = 1e-9..=1e6;

impl Bem {
    /// Contact area fractions and mean pressures at which a recipe asks for friction.
    pub fn wanted(&self) -> Wanted {
        let Self { area_fractions, pressures_mpa, .. } = self.clone();
        Wanted { area_fractions, pressures_mpa }
    }

    pub(super) fn check_wanted(&self) -> Result<(), InvalidRecipe> {
        for (key, areas) in [
            ("bem.area_fractions", &self.area_fractions),
            ("bem.field_area_fractions", &self.field_area_fractions),
        ] {
            let inside = areas.iter().all(|a| *a > 0.0 && *a < 1.0);
            let wanted = "ascending, between 0 and 1 (5 % is 0.05)";
            require(ascend(areas) && inside, key, areas, wanted)?;
        }
        let (areas, pressures) = (&self.area_fractions, &self.pressures_mpa);
        let inside = pressures.iter().all(|p| PRESSURES_MPA.contains(p));
        let wanted = "ascending, in MPa (3 bar are 0.3), from 1e-9 to 1e6";
        require(ascend(pressures) && inside, "bem.pressures_mpa", pressures, wanted)?;
        let wanted = "at least one fraction, such as [0.05], or pressures in bem.pressures_mpa";
        let any = !areas.is_empty() || !pressures.is_empty();
        require(any, "bem.area_fractions", areas, wanted)?;
        let fields = &self.field_area_fractions;
        let (first, last) = (areas.first(), areas.last());
        let within = fields.iter().all(|a| first <= Some(a) && last >= Some(a));
        let wanted = "within the range of bem.area_fractions";
        require(within, "bem.field_area_fractions", fields, wanted)
    }
}

fn ascend(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] < pair[1])
}
