//! A result of one's own from those of a run: the heat that friction puts into the contact, as a table with
//! units, a schema and a digest like those of the stages, and then in polars.
//!
//!     cargo run --release --example stage_results RUN OUT.arrow

use asperity::artifact::{Metadata, Row, RunView, write_table};
use asperity::stages::tables::{FRICTION, Model};
use polars::prelude::{IpcReader, SerReader, SortMultipleOptions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::fs::File;
use std::path::Path;

/// Frictional heat at one contact area.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
struct HeatRow {
    /// Contact model.
    model: Model,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    speed_mm_s: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    contact_area_fraction: f64,
    /// Frictional power over the nominal area, friction times pressure times speed.
    #[schemars(extend("unit" = "kW/m^2"))]
    heat_kw_m2: f64,
    /// Its half-width of 95 % confidence, if there is more than one realisation.
    #[schemars(extend("unit" = "kW/m^2"))]
    confidence_95_kw_m2: Option<f64>,
}

impl Row for HeatRow {
    const SCHEMA: &'static str = "example.heat";
    const VERSION: u32 = 1;
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, out] = &arguments[..] else { return Err("wanted: RUN OUT.arrow".into()) };
    // Read by its schema, its digest compared.
    let friction = RunView::of(run).rows(FRICTION)?;
    let heat: Vec<HeatRow> = friction
        .iter()
        .map(|row| {
            // 1 MPa mm/s is 1 kW/m².
            let power = row.pressure_mpa * row.speed_mm_s;
            HeatRow {
                model: row.model,
                speed_mm_s: row.speed_mm_s,
                contact_area_fraction: row.contact_area_fraction,
                heat_kw_m2: power * row.mean,
                confidence_95_kw_m2: row.confidence_95.map(|half_width| power * half_width),
            }
        })
        .collect();
    write_table(Path::new(out), &heat, &Metadata::new())?;
    let hottest = SortMultipleOptions::default().with_order_descending(true);
    let frame = IpcReader::new(File::open(out)?).finish()?.sort(["heat_kw_m2"], hottest)?;
    println!("{}", frame.head(Some(5)));
    Ok(())
}
