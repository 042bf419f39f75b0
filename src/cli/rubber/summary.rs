//! What a fit prints: a table, or JSON.

use crate::cli::output::{aligned, significant};
use asperity::rubber::fit::{
    Candidate, Estimate, FittedLaw, FittedTerm, FittedVertical, LeftOut, MasterCurve, Misfit,
    ShiftFactor,
};
use asperity::rubber::{FrequencyRange, ShiftLaw, VerticalShift};
use asperity::units::Units;
use serde::Serialize;

/// What is printed; the names are the keys of the JSON object, in SI but for units in names.
#[derive(Debug, Serialize)]
pub(super) struct Summary<'a> {
    equilibrium_modulus: Estimate,
    terms: &'a [FittedTerm],
    misfit: Misfit,
    points: usize,
    measured: FrequencyRange,
    reference_c: Option<f64>,
    shifts: &'a [ShiftFactor],
    laws: &'a [FittedLaw],
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical: Option<FittedVertical>,
    #[serde(skip_serializing_if = "<[LeftOut]>::is_empty")]
    left_out: &'a [LeftOut],
    #[serde(skip_serializing_if = "<[[f64; 2]]>::is_empty")]
    joined_by_loss_c: &'a [[f64; 2]],
    candidates: &'a [Candidate],
}

impl<'a> Summary<'a> {
    pub(super) fn new(fit: &'a MasterCurve) -> Self {
        Self {
            equilibrium_modulus: fit.equilibrium_modulus,
            terms: &fit.terms,
            misfit: fit.misfit,
            points: fit.points.len(),
            measured: fit.measured,
            reference_c: fit.reference_c,
            shifts: &fit.shifts,
            laws: &fit.laws,
            vertical: fit.vertical,
            left_out: &fit.left_out,
            joined_by_loss_c: &fit.joined_by_loss_c,
            candidates: &fit.candidates,
        }
    }

    pub(super) fn table(&self) -> String {
        let mut text = format!(
            "{:<12}  {:<34}  relaxation time / s\n",
            "term", "modulus / MPa (95 % interval)"
        );
        let equilibrium = interval(&self.equilibrium_modulus, Units::pa_to_mpa);
        text += &format!("{:<12}  {equilibrium}\n", "equilibrium");
        for (k, term) in self.terms.iter().enumerate() {
            let (modulus, time) = (
                interval(&term.modulus, Units::pa_to_mpa),
                interval(&term.relaxation_time, |time| time),
            );
            text += &format!("{:<12}  {modulus:<34}  {time}\n", k + 1);
        }
        text += "\n";
        let percent = |value: f64| format!("{} %", significant(100.0 * value));
        let of = |d: &asperity::rubber::fit::Deviation| {
            format!("{} rms, {} at most", percent(d.rms), percent(d.largest))
        };
        let range = self.measured;
        let at = self.reference_c.map_or(String::new(), |reference| format!(" at {reference} °C"));
        text += &aligned(&[
            ("terms", format!("{} ({} numbers tried)", self.terms.len(), self.candidates.len())),
            ("points", self.points.to_string()),
            ("measured", format!("{:.3e} to {:.3e} Hz{at}", range.lowest_hz, range.highest_hz)),
            ("error of E'", of(&self.misfit.storage_modulus)),
            ("error of E''", of(&self.misfit.loss_modulus)),
            ("error of tan delta", of(&self.misfit.loss_factor)),
        ]);
        if !self.shifts.is_empty() {
            text += "\ntemperature / °C  log10 of the shift factor";
            text += if self.vertical.is_some() { "    vertical factor\n" } else { "\n" };
            text += &self.shifts.iter().map(|shift| self.shift(shift)).collect::<String>();
            text += "\n";
            text += &self.laws.iter().map(law).collect::<String>();
            text += &self.vertical.iter().map(vertical_law).collect::<String>();
        }
        text
    }

    fn shift(&self, shift: &ShiftFactor) -> String {
        let half = match shift.confidence_95 {
            Some(half) => format!("± {half:.1e}"),
            None if Some(shift.temperature_c) == self.reference_c => "reference".into(),
            None => "given".into(),
        };
        let half = if shift.uncertain { half + ", not determined" } else { half };
        let vertical = shift.vertical.map_or(String::new(), |vertical| {
            let interval = vertical.confidence_95;
            let interval = interval.map(|[low, high]| format!(" ({low:.4} to {high:.4})"));
            format!(
                "{:w$}  {:.4}{}",
                "",
                vertical.factor,
                interval.unwrap_or_default(),
                w = 9_usize.saturating_sub(half.chars().count())
            )
        });
        format!("{:>16}  {:>9.4} {half}{vertical}\n", shift.temperature_c, shift.log10_shift)
    }
}

fn interval(estimate: &Estimate, unit: fn(f64) -> f64) -> String {
    let number = |value: f64| significant(unit(value));
    match estimate.confidence_95 {
        Some([low, high]) => {
            format!("{} ({} to {})", number(estimate.value), number(low), number(high))
        }
        None => format!("{} (at the limit)", number(estimate.value)),
    }
}

fn law(fitted: &FittedLaw) -> String {
    let half = |k: usize| {
        let half_widths = fitted.confidence_95.as_ref();
        half_widths.map_or(String::new(), |half| format!(" ± {}", significant(half[k])))
    };
    let coefficients = match &fitted.law {
        &ShiftLaw::Wlf { c1, c2_k } => {
            format!(
                "WLF        c1 {}{}, c2 {}{} K",
                significant(c1),
                half(0),
                significant(c2_k),
                half(1)
            )
        }
        &ShiftLaw::Arrhenius { activation_energy_kj_mol: energy } => {
            format!("Arrhenius  activation energy {}{} kJ/mol", significant(energy), half(0))
        }
        ShiftLaw::Table(table) => format!("table of {} factors", table.factors().len()),
    };
    format!("{coefficients}; residual {} decades\n", significant(fitted.residual_decades))
}

fn vertical_law(fitted: &FittedVertical) -> String {
    let half =
        fitted.confidence_95.map_or(String::new(), |half| format!(" ± {}", significant(half)));
    let residual = fitted.residual.map_or(String::new(), |residual| {
        format!("; residual {} %", significant(100.0 * residual))
    });
    match fitted.law {
        VerticalShift::RhoT { expansion_per_k } => {
            format!(
                "vertical   density times temperature, expansion {} 1/K\n",
                significant(expansion_per_k)
            )
        }
        VerticalShift::Power { exponent } => {
            format!("vertical   (T / T_r)^m with m {}{half}{residual}\n", significant(exponent))
        }
    }
}
