//! Sections on the correction, the fields and the rubber.

use super::Report;
use super::page::{absent, number, percent, table};
use crate::report::ReportError;
use crate::report::figures::{Material, material};
use crate::report::read::rows;
use crate::rubber::{RubberModel, Viscoelastic};
use crate::stages;
use crate::stages::micro::{SAMPLES, SampleRow};
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn material(&self) -> Result<Option<Material>, ReportError> {
        material(self.run)
    }

    pub(super) fn correction(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::micro::STAGE)? {
            return Ok(absent(
                "Friction of the half-space is not corrected in this run: its recipe has no section [micro].",
            ));
        }
        let samples = rows(self.run, SAMPLES)?.unwrap_or_default();
        Ok(html! {
            (self.warnings(&[stages::micro::STAGE, stages::hybrid::STAGE])?)
            (self.figure("correction")?)
            @if !samples.is_empty() { (sample_table(&samples)) }
        })
    }

    pub(super) fn fields(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::bem::STAGE)? {
            return Ok(absent("No contacts were solved in this run."));
        }
        Ok(html! {
            (self.doubt(&[stages::realise::STAGE, stages::bem::STAGE]))
            (self.figure("pressure")?)
            (self.figure("deformation")?)
        })
    }

    pub(super) fn rubber(&self) -> Result<Markup, ReportError> {
        let Some(material) = self.material()? else {
            return Ok(absent("No rubber was used in this run: no contacts were solved."));
        };
        let rubber = &material.rubber;
        let branches = match rubber {
            RubberModel::Maxwell(rubber) => rubber.branches.as_slice(),
            RubberModel::Table(_) => &[],
        };
        let branches = branches.iter().enumerate().map(|(k, branch)| {
            vec![
                (k + 1).to_string(),
                number(1e-6 * branch.modulus, 5),
                number(branch.relaxation_time, 4),
            ]
        });
        let excited = material.excited.iter().map(|(speed, range)| {
            vec![speed.to_string(), number(range.lowest_hz, 4), number(range.highest_hz, 4)]
        });
        Ok(html! {
            (self.doubt(&[stages::bem::STAGE]))
            p { "Rubber " (rubber.name())
                @match material.temperature_c { Some(celsius) => { " at " (celsius) " °C" } None => {} }
                ": " (what_is_known(rubber)) ", Poisson ratio " (rubber.poisson_ratio()) "."
                @if let Ok(maxwell) = rubber.maxwell() && !maxwell.finite_strain.is_default() {
                    " Law at finite strain: " (maxwell.finite_strain.name()) "."
                }
                @match material.measured {
                    Some([low, high]) => { " It was measured from " (number(low, 3)) " to " (number(high, 3)) " Hz at this temperature." }
                    None => { " Its file does not say at which frequencies it was measured." }
                }
            }
            (self.figure("rubber")?)
            (table("Frequencies v/λ that the waves excite",
                &["speed / (mm/s)", "longest wave / Hz", "shortest wave / Hz"], 1, excited))
            @if rubber.table().is_none() {
                (table("Maxwell branches", &["branch", "modulus / MPa", "relaxation time / s"], 1, branches))
            }
        })
    }
}

/// Limits and size of the model, in words.
fn what_is_known(rubber: &RubberModel) -> String {
    match rubber {
        RubberModel::Maxwell(rubber) => format!(
            "relaxed modulus {} MPa, glassy modulus {} MPa, {} Maxwell branches",
            number(1e-6 * rubber.equilibrium_modulus, 4),
            number(1e-6 * rubber.glassy_modulus(), 4),
            rubber.branches.len()
        ),
        RubberModel::Table(table) => {
            let storage = table.points().iter().map(|point| 1e-6 * point.storage_modulus);
            format!(
                "a table of {} moduli, storage modulus {} to {} MPa",
                table.points().len(),
                number(storage.clone().fold(f64::INFINITY, f64::min), 4),
                number(storage.fold(0.0, f64::max), 4)
            )
        }
    }
}

fn sample_table(samples: &[SampleRow]) -> Markup {
    table(
        "Samples of the microscale",
        &[
            "surfaces",
            "realisation",
            "speed / (mm/s)",
            "pressure / MPa",
            "µ finite deformation",
            "µ half-space",
            "correction Δµ",
            "± interpolation",
            "force against heat",
            "Ac/A0 finite deformation",
            "Ac/A0 half-space",
            "time / s",
        ],
        1,
        samples.iter().map(|row| {
            let finite = row.friction_finite_deformation;
            let realisation =
                if row.realisation == 0 { "all".into() } else { row.realisation.to_string() };
            vec![
                row.kind.to_string(),
                realisation,
                row.speed_mm_s.to_string(),
                number(row.pressure_mpa, 4),
                number(finite, 4),
                number(row.friction_half_space, 4),
                number(finite - row.friction_half_space, 3),
                number(row.interpolation_error, 2),
                percent((finite - row.friction_from_heat) / finite),
                number(row.area_finite_deformation, 3),
                number(row.area_half_space, 3),
                number(row.seconds, 2),
            ]
        }),
    )
}
