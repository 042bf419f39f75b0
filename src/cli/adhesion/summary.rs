//! What a fit of the shear stress is printed as.

use crate::cli::output::significant;
use asperity::interface::{FittedShear, Interval, MeasuredFriction};
use asperity::measurement::Computed;
use asperity::units::Units;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// A fit in the units of the recipe.
#[derive(Serialize)]
pub(super) struct Summary {
    model: &'static str,
    surfaces: String,
    pressure_mpa: f64,
    shortest_wavelength_mm: f64,
    /// Temperature in °C at which `speed_mm_s` holds; none for a law that does not shift.
    reference_c: Option<f64>,
    constants: Vec<Constant>,
    rms: f64,
    degrees_of_freedom: usize,
    points: Vec<Point>,
}

/// A constant with its interval.
#[derive(Serialize)]
struct Constant {
    key: &'static str,
    value: f64,
    low_95: Option<f64>,
    high_95: Option<f64>,
}

/// A measurement beside the fit.
#[derive(Serialize)]
struct Point {
    speed_mm_s: f64,
    temperature_c: f64,
    contact_area_fraction: f64,
    hysteretic: f64,
    adhesive: f64,
    total: f64,
    measured: f64,
}

impl Summary {
    pub fn new(fit: &FittedShear, computed: &Computed, measured: &[MeasuredFriction]) -> Self {
        let constant = |key, interval: Interval, unit: fn(f64) -> f64| Constant {
            key,
            value: unit(interval.value),
            low_95: interval.ends.map(|[low, _]| unit(low)),
            high_95: interval.ends.map(|[_, high]| unit(high)),
        };
        let mut constants = vec![
            constant("shear_mpa", fit.peak_stress, f64::pa_to_mpa),
            constant("speed_mm_s", fit.peak_speed, f64::m_to_mm),
            constant("width", fit.width, |c| c),
        ];
        constants.extend(fit.energy_ev.map(|energy| constant("activation_ev", energy, |c| c)));
        let point = |(m, residual): (&MeasuredFriction, &f64)| Point {
            speed_mm_s: m.speed.m_to_mm(),
            temperature_c: m.temperature_c,
            contact_area_fraction: m.contact_area_fraction,
            hysteretic: m.hysteretic,
            adhesive: m.friction + residual - m.hysteretic,
            total: m.friction + residual,
            measured: m.friction,
        };
        Self {
            model: computed.model.name(),
            surfaces: computed.kind.to_string(),
            pressure_mpa: computed.pressure_mpa,
            shortest_wavelength_mm: computed.shortest_wavelength_mm,
            reference_c: fit.law.shift.map(|shift| shift.reference_c),
            constants,
            rms: fit.rms,
            degrees_of_freedom: fit.degrees_of_freedom,
            points: measured.iter().zip(&fit.residuals).map(point).collect(),
        }
    }

    pub fn table(&self) -> String {
        let mut text = format!(
            "shear stress of the contact area: {}, {}, {} MPa, shortest wavelength {} mm\n\n",
            self.model,
            self.surfaces,
            significant(self.pressure_mpa),
            significant(self.shortest_wavelength_mm)
        );
        // Writing to a string cannot fail.
        for Constant { key, value, low_95, high_95 } in &self.constants {
            let interval = low_95.zip(*high_95).map_or_else(
                || "fixed".to_owned(),
                |(low, high)| format!("95 %: {} to {}", significant(low), significant(high)),
            );
            let _ = writeln!(text, "{key:<14} {:>12}  {interval}", significant(*value));
        }
        if let Some(celsius) = self.reference_c {
            let _ = writeln!(
                text,
                "{:<14} {celsius:>12}  °C, at which speed_mm_s holds",
                "reference_c"
            );
        }
        let _ = writeln!(
            text,
            "{:<14} {:>12}  {} degrees of freedom\n",
            "rms misfit",
            significant(self.rms),
            self.degrees_of_freedom
        );
        let _ = writeln!(
            text,
            "{:>14} {:>8} {:>10} {:>11} {:>9} {:>8} {:>9}",
            "mm/s", "°C", "Ac/A0", "hysteretic", "adhesive", "total", "measured"
        );
        for p in &self.points {
            let _ = writeln!(
                text,
                "{:>14} {:>8} {:>10.5} {:>11.4} {:>9.4} {:>8.4} {:>9.4}",
                significant(p.speed_mm_s),
                p.temperature_c,
                p.contact_area_fraction,
                p.hysteretic,
                p.adhesive,
                p.total,
                p.measured
            );
        }
        text
    }
}

/// The section `[adhesion]` of a recipe.
pub(super) fn section(
    fit: &FittedShear,
    computed: &Computed,
    file: &Path,
    measured: &[MeasuredFriction],
) -> String {
    let law = &fit.law;
    let mut lines = vec![
        "# The contact area of these tables belongs to their shortest wavelength, and so does the stress.".into(),
        format!(
            "# Fitted to {}: {}, {}, {} MPa, rms misfit {:.4}.",
            asperity::text::visible_line(&asperity::files::name::text(
                file.file_name().unwrap_or(file.as_os_str())
            )),
            computed.model,
            computed.kind,
            significant(computed.pressure_mpa),
            fit.rms
        ),
        temperature(fit, measured),
        "[adhesion]".into(),
        "law = \"gaussian\"".into(),
        format!("shear_mpa = {:?}", law.peak_stress.pa_to_mpa()),
        format!("speed_mm_s = {:?}", law.peak_speed.m_to_mm()),
        format!("width = {:?}", law.width),
    ];
    if let Some(shift) = law.shift {
        lines.push(format!("activation_ev = {:?}", shift.energy_ev));
        lines.push(format!("reference_c = {:?}", shift.reference_c));
    }
    // Windows have waves that are fractions of their length; six digits tell them apart.
    lines
        .push(format!("shortest_wavelength_mm = {}", significant(computed.shortest_wavelength_mm)));
    lines.join("\n") + "\n"
}

/// At which temperatures the law was fitted, and whether it knows others.
fn temperature(fit: &FittedShear, measured: &[MeasuredFriction]) -> String {
    let celsius = || measured.iter().map(|m| m.temperature_c);
    let (low, high) =
        (celsius().fold(f64::INFINITY, f64::min), celsius().fold(-f64::INFINITY, f64::max));
    let range = if low == high { format!("{low} °C") } else { format!("{low} to {high} °C") };
    match fit.law.shift {
        Some(_) => format!("# Measured at {range}."),
        None => format!(
            "# Measured at {range}; without activation_ev the law is that of this temperature at all others."
        ),
    }
}
