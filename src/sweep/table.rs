//! The tables of all cases in one, keyed by what the sweep lists.

use crate::artifact::{Row, Table};
use crate::recipe::Case;
use crate::stages::tables::FrictionRow;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The tables of all cases: `friction.arrow`.
pub const FRICTION: Table<SweepFrictionRow> = Table::new("sweep", "friction.arrow");

/// Averaged friction of one case at one contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepFrictionRow {
    /// Name of the specimen; absent where the recipe lists none.
    pub specimen: Option<String>,
    /// Name of the rubber's file, without extension.
    pub rubber: String,
    /// Temperature to which the rubber is shifted; absent where it is not.
    #[schemars(extend("unit" = "°C"))]
    pub temperature_c: Option<f64>,
    /// Seed of the random phases.
    pub seed: u64,
    /// The row of the case's own table.
    #[serde(flatten)]
    pub friction: FrictionRow,
}

impl Row for SweepFrictionRow {
    const SCHEMA: &'static str = "asperity.sweep.friction";
    const VERSION: u32 = 3;
}

impl SweepFrictionRow {
    /// A row of the table of a case.
    pub fn new(case: &Case, friction: FrictionRow) -> Self {
        Self {
            specimen: case.specimen.clone(),
            rubber: case.rubber.clone(),
            temperature_c: case.temperature_c,
            seed: case.seed,
            friction,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::{Metadata, columns, read_table, write_table};
    use crate::stages::bem::Given;
    use crate::stages::realise::SurfaceKind;
    use crate::stages::tables::Model;

    #[test]
    fn the_columns_are_the_keys_and_those_of_a_case() {
        let names = |columns: Vec<crate::artifact::Column>| -> Vec<String> {
            columns.into_iter().map(|column| column.name).collect()
        };
        let own = names(columns::<SweepFrictionRow>().unwrap());
        let case = names(columns::<FrictionRow>().unwrap());
        assert_eq!(own[..4], ["specimen", "rubber", "temperature_c", "seed"]);
        assert_eq!(own[4..], case[..]);
    }

    #[test]
    fn a_row_reads_back() {
        let friction = FrictionRow {
            model: Model::Bem,
            kind: SurfaceKind::sines(8),
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            shortest_wavelength_mm: 0.06,
            windows: 9,
            realisations: vec![0.1 + 0.2, 0.7],
            half_space_realisations: None,
            mean: 0.5,
            standard_deviation: Some(0.2),
            confidence_95: None,
            scan_error: None,
            interpolation_error: 1e-4,
            discretisation_error: None,
            left_out_error: 0.0,
            microscale_error: None,
            model_error: None,
            error_estimate: None,
            pressure_mpa: 1.5,
            shortest_reliable_wavelength_mm: Some(0.1),
        };
        let row = SweepFrictionRow {
            specimen: Some("A".into()),
            rubber: "tread".into(),
            temperature_c: None,
            seed: 3,
            friction,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FRICTION.name());
        write_table(&path, std::slice::from_ref(&row), &Metadata::new()).unwrap();
        assert_eq!(read_table::<SweepFrictionRow>(&path).unwrap().0, [row]);
    }
}
