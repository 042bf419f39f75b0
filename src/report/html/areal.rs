//! The section on surfaces that are rough in both directions.

use super::Report;
use super::page::{number, optional, percent, table};
use super::scans::average_table;
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages;
use crate::stages::characterise::AREAL_AVERAGES;
use crate::stages::realise::{AREAL_SURFACES, ArealRow};
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn has_areal_surfaces(&self) -> Result<bool, ReportError> {
        Ok(self.run.has(AREAL_SURFACES)?)
    }

    pub(super) fn areal(&self) -> Result<Markup, ReportError> {
        let surfaces = rows(self.run, AREAL_SURFACES)?.unwrap_or_default();
        let averages = rows(self.run, AREAL_AVERAGES)?.unwrap_or_default();
        let sliding = About::of(self.run)?.sliding();
        Ok(html! {
            (self.doubt(&[stages::realise::STAGE, stages::areal::STAGE]))
            @if let Some(sliding) = sliding { p { (sliding) " The friction tables have this direction." } }
            (self.figure("direction")?)
            (self.figure("pressure-map")?)
            @if !averages.is_empty() {
                (average_table("Areal parameters of the maps, averages over the windows", &averages))
            }
            (surface_table(&surfaces))
        })
    }
}

fn surface_table(surfaces: &[ArealRow]) -> Markup {
    table(
        "Areal surfaces, made periodic",
        &[
            "surfaces",
            "window",
            "realisation",
            "period x / mm",
            "period y / mm",
            "shortest wave / mm",
            "filled",
            "rms height / mm",
            "rms gradient",
            "skewness",
            "kurtosis",
            "left out, rms height / mm",
            "mismatch of heights",
        ],
        2,
        surfaces.iter().map(|row| {
            vec![
                row.kind.to_string(),
                row.window.clone(),
                row.realisation.to_string(),
                number(row.period_x_mm, 4),
                number(row.period_y_mm, 4),
                number(row.shortest_wavelength_mm, 4),
                percent(row.filled),
                number(row.rms_height_mm, 3),
                number(row.rms_gradient, 3),
                number(row.skewness, 3),
                number(row.kurtosis, 3),
                number(row.left_out_rms_height_mm, 2),
                optional(row.mismatch, 2),
            ]
        }),
    )
}
