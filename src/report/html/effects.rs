//! Sections on total friction and on the heat and softening of the contact.

use super::Report;
use super::page::{absent, number, optional, table};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages;
use crate::stages::tables::{EFFECTS, EffectRow, TOTAL, TotalRow};
use maud::{Markup, html};

impl Report<'_> {
    /// Whether the run has adhesion beside its hysteresis.
    pub(super) fn has_totals(&self) -> Result<bool, ReportError> {
        Ok(self.run.has(TOTAL)?)
    }

    /// Whether contacts were solved with their heat or softening.
    pub(super) fn has_effects(&self) -> Result<bool, ReportError> {
        Ok(self.run.has(EFFECTS)?)
    }

    pub(super) fn total(&self) -> Result<Markup, ReportError> {
        let totals = rows(self.run, TOTAL)?.unwrap_or_default();
        let Some(first) = totals.first() else {
            return Ok(absent(
                "This run has no total friction: none of its models has a contact area.",
            ));
        };
        let temperature = first.temperature_c.map(|celsius| format!(" at {celsius} °C"));
        Ok(html! {
            (self.doubt(&[stages::tables::STAGE]))
            p { "Hysteresis and the shear of the contact area" (temperature.unwrap_or_default()) ". The law of the shear \
                stress is one for waves down to " (number(first.fitted_wavelength_mm, 4)) " mm. The errors hold those of \
                hysteresis and contact area, not that of the stress."
                @if self.has_effects()? { " Heat and softening of the contact are in the next section." } }
            (self.figure("total")?)
            (total_table(&totals))
        })
    }

    pub(super) fn effects(&self) -> Result<Markup, ReportError> {
        let effects = rows(self.run, EFFECTS)?.unwrap_or_default();
        let warnings = self.warnings(&[stages::feedback::STAGE])?;
        if effects.is_empty() {
            let none = absent("No average has a solution on all of its surfaces.");
            return Ok(html! { (warnings) (none) });
        }
        let totals = effects.iter().any(|row| row.total.is_some());
        Ok(html! {
            (warnings)
            p { "Friction of the half-space with the moduli of the temperature before sliding and of small strain (cold), of \
                the strain of each wave (soft), of the temperature that each wave meets (hot), and of both (soft-hot)."
                @if totals { " The shear stress is that at the temperature before sliding, under every effect." } }
            (self.figure("effects")?)
            (effect_table(&effects, totals))
        })
    }
}

fn total_table(totals: &[TotalRow]) -> Markup {
    table(
        "Hysteretic, adhesive and total friction, with the errors of the total",
        &[
            "model",
            "surfaces",
            "speed / (mm/s)",
            "Ac/A0",
            "pressure / MPa",
            "shear stress / MPa",
            "hysteretic µ",
            "adhesive µ",
            "total µ",
            "± 95 %",
            "error, all parts",
        ],
        2,
        totals.iter().map(|row| {
            vec![
                row.model.to_string(),
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                number(row.contact_area_fraction, 4),
                number(row.pressure_mpa, 4),
                number(row.shear_mpa, 4),
                number(row.hysteretic, 4),
                number(row.adhesive, 4),
                number(row.total, 4),
                optional(row.confidence_95, 2),
                optional(row.error_estimate, 2),
            ]
        }),
    )
}

fn effect_table(effects: &[EffectRow], totals: bool) -> Markup {
    let (caption, sums): (_, &[&str]) = if totals {
        (
            "Friction under every effect; all parts of the error are those of the total",
            &["adhesive µ", "total µ"],
        )
    } else {
        ("Friction under every effect", &[])
    };
    let before = [
        "surfaces",
        "effect",
        "speed / (mm/s)",
        "pressure / MPa",
        "Ac/A0",
        "hysteretic µ",
        "± 95 %",
    ];
    let header = [&before, sums, &["error, all parts", "rise of the contact / K"]].concat();
    table(
        caption,
        &header,
        2,
        effects.iter().map(|row| {
            let mut cells = vec![
                row.kind.to_string(),
                row.effect.to_string(),
                row.speed_mm_s.to_string(),
                number(row.pressure_mpa, 4),
                number(row.contact_area_fraction, 4),
                number(row.hysteretic, 4),
                optional(row.confidence_95, 2),
            ];
            if totals {
                cells.extend([row.adhesive, row.total].map(|friction| optional(friction, 4)));
            }
            cells.push(optional(row.error_estimate, 2));
            cells.push(optional(row.contact_rise_k, 3));
            cells
        }),
    )
}
