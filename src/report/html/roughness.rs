//! Sections on correlation, spectrum and waves.

use super::Report;
use super::page::{absent, number, optional, table};
use crate::report::ReportError;
use crate::report::figures::microscale_slope;
use crate::report::read::rows;
use crate::stages;
use crate::stages::approximate::{FITS, FitRow, ScaleRow, WAVES};
use crate::stages::characterise::{
    AVERAGE, HURST, HurstMethod, HurstRow, SELF_AFFINE, SelfAffineRow,
};
use crate::units::Units;
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn correlation(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::characterise::STAGE)? {
            return Ok(absent("No scans were characterised in this run: the waves are given."));
        }
        let fits = rows(self.run, FITS)?.unwrap_or_default();
        let affine = rows(self.run, SELF_AFFINE)?.unwrap_or_default();
        let average = affine.iter().find(|row| row.scan == AVERAGE);
        Ok(html! {
            (self.warnings(&[stages::characterise::STAGE, stages::approximate::STAGE, stages::realise::STAGE])?)
            (self.figure("correlation")?)
            @if !fits.is_empty() { (fit_table(&fits)) }
            @if let Some(fit) = average {
                (affine_table(fit))
                p { "Its Hurst exponent stands " a href="#spectrum" { "beside that of the spectrum" } "." }
            }
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
                (hurst_table(&average))
                p { (WHY_EXPONENTS_DIFFER) }
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

/// What a reader of two exponents of the same scans asks.
const WHY_EXPONENTS_DIFFER: &str = "The two differ because the correlation at one lag contains waves of all lengths, \
    while the spectrum separates them: towards its plateau the correlation bends over a decade of lags, which lowers \
    its slope, and levelling, which takes away long waves, brings the bend to shorter lags. They agree only for one \
    power law over several decades.";

/// The exponents of the average side by side; a dash for one that could not be fitted.
fn hurst_table(average: &[HurstRow]) -> Markup {
    let of = |method| average.iter().find(|row| row.method == method);
    let methods = [HurstMethod::Correlation, HurstMethod::Spectrum].map(of);
    let row = |name: &str, value: fn(&HurstRow) -> Option<f64>, digits| {
        let cells = methods.map(|row| optional(row.and_then(value), digits));
        [vec![name.to_owned()], cells.to_vec()].concat()
    };
    table(
        "Hurst exponent H of the average, from the correlation and from the spectrum",
        &["quantity", "correlation", "spectrum"],
        1,
        [
            row("Hurst exponent H", |row| Some(row.hurst_exponent), 3),
            row("95 % from", |row| row.hurst_exponent_lower, 3),
            row("95 % to", |row| row.hurst_exponent_upper, 3),
            row("shortest lag, wavelength / mm", |row| Some(row.shortest_mm), 3),
            row("longest lag, wavelength / mm", |row| Some(row.longest_mm), 3),
            row("rms residual of log10", |row| Some(row.rms_residual_log10), 2),
        ],
    )
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

fn affine_table(fit: &SelfAffineRow) -> Markup {
    let row = |name: &str, value: f64, from: Option<f64>, to: Option<f64>| {
        vec![name.to_owned(), number(value, 3), optional(from, 3), optional(to, 3)]
    };
    let note = if fit.plateau_found { "" } else { "; no plateau within the lags: lower bounds" };
    table(
        &format!("Correlation lengths of the self-affine fit of the average{note}"),
        &["quantity", "value", "95 % from", "95 % to"],
        1,
        [
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
