//! The shortest wavelength of the surfaces of maps that stand alone: nothing was fitted to lines.

use crate::artifact::RunView;
use crate::stages::StageError;
use crate::stages::characterise::{AREAL_PARAMETERS, RELIABLE_KEY, length_in};
use crate::surface::ladder::Undetermined;
use serde::Serialize;

/// Keys of `[approximate]` that count though there is no fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MapLimit {
    /// Shortest wavelength in mm of the ladder; what the maps show as it is if not set.
    pub shortest_wavelength_mm: Option<f64>,
    /// Whether shorter waves than the maps show as they are count.
    pub undetermined: Undetermined,
}

/// Positions carry round-off; a wavelength on a limit counts as inside.
const ROUND_OFF: f64 = 1e-9;

impl MapLimit {
    /// The wavelength in mm at which a ladder of sines would begin: that of the recipe, doubled until the maps show it as it
    /// is unless the recipe keeps shorter ones.
    ///
    /// # Errors
    /// Those of the store; [`StageError::Metadata`].
    pub fn shortest_mm(self, run: &RunView) -> Result<f64, StageError> {
        let (_, metadata) = run.read_table(AREAL_PARAMETERS)?;
        let lacks = || StageError::Metadata { key: RELIABLE_KEY, value: String::new() };
        Ok(self.where_reliable(length_in(&metadata, RELIABLE_KEY)?.ok_or_else(lacks)?))
    }

    fn where_reliable(self, reliable_mm: f64) -> f64 {
        let mut shortest = self.shortest_wavelength_mm.unwrap_or(reliable_mm);
        while self.undetermined == Undetermined::Drop && shortest < reliable_mm * (1.0 - ROUND_OFF)
        {
            shortest *= 2.0;
        }
        shortest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_wave_is_the_first_of_a_ladder_that_the_maps_show() {
        let from = |shortest_wavelength_mm, undetermined| {
            MapLimit { shortest_wavelength_mm, undetermined }.where_reliable(0.1)
        };
        assert_eq!(from(None, Undetermined::Drop), 0.1);
        assert_eq!(from(Some(0.4), Undetermined::Drop), 0.4);
        assert_eq!(from(Some(0.03), Undetermined::Drop), 0.12);
        assert_eq!(from(Some(0.03), Undetermined::Keep), 0.03);
    }
}
