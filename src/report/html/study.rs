//! The study of one sine wave.

use super::Report;
use super::page::{number, optional, table};
use crate::report::{ReportError, Study};
use crate::stages;
use crate::stages::sinusoid::PointRow;
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn study(&self) -> Result<Markup, ReportError> {
        let study = Study::read(self.run)?;
        Ok(html! {
            (self.warnings(&[stages::sinusoid::STAGE])?)
            (self.figure("study")?)
            @for rows in study.points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio) {
                (point_table(rows))
            }
        })
    }
}

fn point_table(rows: &[PointRow]) -> Markup {
    table(
        &format!("Root mean square slope {:.2}, {} MPa", rows[0].rms_slope, rows[0].pressure_mpa),
        &["model", "speed / (mm/s)", "De", "µ", "± mesh", "Ac/A0", "± mesh"],
        1,
        rows.iter().map(|row| {
            vec![
                row.model.to_string(),
                number(row.speed_mm_s, 3),
                number(row.deborah_number, 3),
                optional(row.friction_coefficient, 4),
                optional(row.friction_mesh_error, 2),
                optional(row.contact_area_fraction, 4),
                optional(row.area_mesh_error, 2),
            ]
        }),
    )
}
