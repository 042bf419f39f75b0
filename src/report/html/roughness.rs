//! Sections on correlation, spectrum and waves.

use super::Report;
use super::page::{absent, number, optional, table};
use crate::report::ReportError;
use crate::report::figures::microscale_slope;
use crate::report::read::rows;
use crate::stages;
use crate::stages::approximate::{FITS, FitRow, ScaleRow, WAVES};
use crate::stages::characterise::{AVERAGE, HURST, SELF_AFFINE, SelfAffineRow};
use crate::units::Units;
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn correlation(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::characterise::STAGE)? {
            return Ok(absent("No scans were characterised in this run: the waves are given."));
        }
        let fits = rows(self.run, FITS)?.unwrap_or_default();
        let affine = rows(self.run, SELF_AFFINE)?.unwrap_or_default();
        let average: Vec<_> = affine.iter().filter(|row| row.scan == AVERAGE).collect();
        Ok(html! {
            (self.warnings(&[stages::characterise::STAGE, stages::approximate::STAGE, stages::realise::STAGE])?)
            (self.figure("correlation")?)
            @if !fits.is_empty() { (fit_table(&fits)) }
            @if !average.is_empty() { (affine_table(&average)) }
        })
    }

    pub(super) fn spectrum(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::characterise::STAGE)? {
            return Ok(absent("No scans were characterised in this run: the waves are given."));
        }
        let hurst = rows(self.run, HURST)?.unwrap_or_default();
        let average: Vec<_> = hurst.into_iter().filter(|row| row.scan == AVERAGE).collect();
        Ok(html! {
            (self.figure("spectrum")?)
            @if !average.is_empty() {
                (table("Hurst exponent H by two routes",
                    &["route", "H", "95 % from", "95 % to", "from / mm", "to / mm", "residual of log10"], 1,
                    average.iter().map(|row| vec![
                        row.method.to_string(), number(row.hurst_exponent, 3),
                        optional(row.hurst_exponent_lower, 3), optional(row.hurst_exponent_upper, 3),
                        number(row.shortest_mm, 3), number(row.longest_mm, 3),
                        number(row.rms_residual_log10, 2),
                    ])))
            }
        })
    }

    pub(super) fn waves(&self) -> Result<Markup, ReportError> {
        let Some(scales) = rows(self.run, WAVES)? else {
            return Ok(absent("No waves were fitted or given in this run."));
        };
        let limit = microscale_slope(self.run)?;
        let finite = self.has(stages::fem::STAGE)? || self.has(stages::multilevel::STAGE)?;
        Ok(html! {
            (self.doubt(&[stages::approximate::STAGE, stages::micro::STAGE]))
            p { (sentence(limit, finite)) }
            (self.figure("waves")?)
            @for rows in scales.chunk_by(|a, b| a.waves == b.waves) {
                (wave_table(rows, limit))
            }
        })
    }
}

/// Which model the waves get, in a sentence.
fn sentence(limit: Option<f64>, finite: bool) -> String {
    let all = if finite {
        " All waves together are also solved at finite deformation (fem)."
    } else {
        ""
    };
    match limit {
        Some(limit) => format!(
            "Waves with a root mean square slope above {limit} are the microscale: their friction is \
             computed at finite deformation and corrects that of the half-space.{all}"
        ),
        None => format!(
            "Every wave is on the half-space: the recipe has no section [micro], which corrects steep \
             waves by finite deformation.{all}"
        ),
    }
}

fn wave_table(rows: &[ScaleRow], limit: Option<f64>) -> Markup {
    let model = |row: &ScaleRow| match limit {
        _ if row.amplitude_mm == 0.0 => "none: amplitude 0",
        Some(limit) if row.rms_slope > limit => "half-space, corrected at finite deformation",
        _ => "half-space",
    };
    table(
        &format!("{} waves", rows[0].waves),
        &["wave", "model", "wavelength / mm", "amplitude / µm", "± 95 % / µm", "rms slope"],
        2,
        rows.iter().map(|row| {
            vec![
                row.scale.to_string(),
                model(row).into(),
                number(row.wavelength_mm, 4),
                number(row.amplitude_mm.mm_to_um(), 4),
                optional(row.amplitude_confidence_95_mm.map(crate::units::Units::mm_to_um), 2),
                number(row.rms_slope, 3),
            ]
        }),
    )
}

fn fit_table(fits: &[FitRow]) -> Markup {
    table(
        "Fits of superposed sines to the correlation",
        &[
            "waves",
            "what the scans do not determine",
            "fitted",
            "rms residual of log10 C",
            "rms height of the waves / mm",
            "of the scans / mm",
            "ratio",
            "condition number",
            "lags",
            "iterations",
        ],
        2,
        fits.iter().map(|fit| {
            vec![
                fit.waves.to_string(),
                fit.warnings.clone(),
                fit.waves_fitted.to_string(),
                number(fit.rms_residual_log10, 3),
                number(fit.rms_height_mm, 3),
                number(fit.scans_rms_height_mm, 3),
                number(fit.rms_height_ratio, 3),
                number(fit.condition_number, 3),
                fit.lags.to_string(),
                fit.iterations.to_string(),
            ]
        }),
    )
}

fn affine_table(rows: &[&SelfAffineRow]) -> Markup {
    let row = |name: &str, value: f64, from: Option<f64>, to: Option<f64>| {
        vec![name.to_owned(), number(value, 3), optional(from, 3), optional(to, 3)]
    };
    let fit = rows[0];
    let note = if fit.plateau_found { "" } else { "; no plateau within the lags: lower bounds" };
    table(
        &format!("Self-affine fit of the average{note}"),
        &["quantity", "value", "95 % from", "95 % to"],
        1,
        [
            row(
                "Hurst exponent H",
                fit.hurst_exponent,
                fit.hurst_exponent_lower,
                fit.hurst_exponent_upper,
            ),
            row(
                "lateral correlation length / mm",
                fit.parallel_length_mm,
                fit.parallel_length_lower_mm,
                fit.parallel_length_upper_mm,
            ),
            row(
                "vertical correlation length / mm",
                fit.perpendicular_length_mm,
                fit.perpendicular_length_lower_mm,
                fit.perpendicular_length_upper_mm,
            ),
        ],
    )
}
