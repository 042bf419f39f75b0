//! approximate: amplitudes of superposed sines with the correlation of the scans.

mod rows;

use super::characterise::{
    AVERAGE, CORRELATION, CorrelationRow, RELIABLE_KEY, WINDOW_LENGTH_KEY, length_in,
};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::{Stage, StageError};
use crate::artifact::{Metadata, RunView};
use crate::numerics::statistics::{balanced_halves, jackknife_95};
use crate::requirement::{InvalidRecipe, require};
use crate::surface::SineScale;
use crate::surface::correlation::CorrelationSample;
use crate::surface::ladder::{Ladder, Undetermined};
use crate::surface::sine_fit::{FitRule, SineFit, SineFitError, fit_sines_by};
use crate::units::Units;
use rayon::prelude::*;
pub use rows::{
    FITS, FITTED, FitRow, FittedRow, REPLICATES, ReplicateRow, ScaleRow, WAVES, schemas,
};
use rows::{fit_row, fitted_rows, scale_rows};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 5;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "approximate",
    summary: "Superposed sines in place of the scans",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let run =
        |inputs: &Inputs, context: &mut Context| run(chain.approximate, &inputs.results, context);
    // A chain that states its waves needs no scans, and maps that stand alone have no lines to fit.
    let scanned = chain.ingest.is_some();
    if scanned && !chain.has_lines() {
        return None;
    }
    let planned = Planned::new(json!(chain.approximate), run);
    Some(planned.reading_if(scanned, super::characterise::CORRELATION))
}

/// Metadata key of the rule of the fit and what it does to the rms height.
pub const RULE_KEY: &str = "rule";

/// Section `[approximate]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Approximate {
    /// Numbers of waves to fit; each wavelength is twice the one before.
    #[serde(default)]
    pub waves: Vec<u32>,
    /// Waves taken from elsewhere, in place of scans and a fit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub given: Vec<GivenWaves>,
    /// Shortest wavelength in millimetres; two sample spacings if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_wavelength_mm: Option<f64>,
    /// What to do with waves that the scans do not determine, shorter than two samples or
    /// than what the instrument shows (`characterise.spot_diameter_um`), or longer than half a window: `drop` them or `keep` them with a warning.
    #[serde(default)]
    pub undetermined: Undetermined,
    /// What the fit takes for the correlation of a wave: `thesis` holds it at its first maximum, which makes the rms
    /// height of the waves 1/sqrt(2) of that of the fitted correlation; `sines` gives known sines back.
    #[serde(default, skip_serializing_if = "FitRule::is_default")]
    pub rule: FitRule,
    /// Longest lag of the fit in millimetres; that of the correlation if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_lag_mm: Option<f64>,
}

/// Waves that a recipe states itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenWaves {
    /// Where the waves come from.
    pub source: String,
    /// The waves, by ascending wavelength; their number names the approximation.
    pub scales: Vec<GivenScale>,
}

/// One wave that a recipe states itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenScale {
    /// Wavelength in millimetres.
    pub wavelength_mm: f64,
    /// Amplitude in millimetres.
    pub amplitude_mm: f64,
}

impl GivenWaves {
    fn number(&self) -> u32 {
        self.scales.len() as u32
    }

    /// The period must hold every wave a whole number of times, and waves must not repeat.
    fn holds(&self) -> bool {
        let longest = self.scales.last().map_or(0.0, |scale| scale.wavelength_mm);
        let ascends = self.scales.windows(2).all(|w| w[0].wavelength_mm < w[1].wavelength_mm);
        let valid = |scale: &GivenScale| {
            let fits = longest / scale.wavelength_mm;
            scale.wavelength_mm > 0.0
                && scale.amplitude_mm >= 0.0
                && (scale.wavelength_mm * scale.amplitude_mm).is_finite()
                && (fits - fits.round()).abs() < 1e-9 * fits
        };
        !self.scales.is_empty() && ascends && self.scales.iter().all(valid)
    }
}

impl Approximate {
    /// The numbers of waves that name the approximations.
    pub fn numbers(&self) -> Vec<u32> {
        let given = self.given.iter().map(GivenWaves::number);
        self.waves.iter().copied().chain(given).collect()
    }

    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let waves = self.numbers();
        let distinct = waves.iter().enumerate().all(|(i, a)| waves[..i].iter().all(|b| a != b));
        let valid = !waves.is_empty() && distinct && waves.iter().all(|m| (1..=20).contains(m));
        let demanded = "a list of numbers of waves, each once and 1 to 20; the number of waves of a list in [[approximate.given]] counts too";
        require(valid, "approximate.waves", &waves, demanded)?;
        let demanded = "positive wavelengths, ascending, of which the longest is a multiple, \
                        and amplitudes of 0 or more";
        for given in &self.given {
            let scale = |scale: &GivenScale| (scale.wavelength_mm, scale.amplitude_mm);
            let scales: Vec<(f64, f64)> = given.scales.iter().map(scale).collect();
            let key = "approximate.given.scales (wavelength_mm, amplitude_mm)";
            require(given.holds(), key, scales, demanded)?;
        }
        for (key, value) in [
            ("approximate.shortest_wavelength_mm", self.shortest_wavelength_mm),
            ("approximate.longest_lag_mm", self.longest_lag_mm),
        ] {
            let positive = value.is_none_or(|mm| mm > 0.0 && mm.is_finite());
            require(positive, key, value.unwrap_or_default(), "positive and finite")?;
        }
        Ok(())
    }
}

/// Fits the waves and writes the results; returns warnings.
///
/// # Errors
/// [`StageError`]: a ladder of which nothing is determined, a fit that does not converge.
pub fn run(
    parameters: &Approximate,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    if !parameters.given.is_empty() {
        return write_given(parameters, context);
    }
    let (rows, metadata) = run.read_table(CORRELATION)?;
    let window_length = length_in(&metadata, WINDOW_LENGTH_KEY)?;
    let reliable_mm = metadata.get(RELIABLE_KEY).cloned().unwrap_or_default();
    // The schema of the correlation has had it from revision 4 on.
    let reliable = length_in(&metadata, RELIABLE_KEY)?.unwrap_or(0.0).mm_to_m();
    let correlations = Correlations::of(rows, parameters.longest_lag_mm, window_length);
    let (mut scales, mut fits, mut fitted, mut warnings) = (vec![], vec![], vec![], vec![]);
    let mut replicates = Vec::new();
    for &waves in &parameters.waves {
        context.check_interrupt()?;
        let in_this = |source| StageError::SineFit { waves, source };
        let base = parameters.shortest_wavelength_mm.map(super::super::units::Units::mm_to_m);
        let (spacing, window) = (correlations.spacing, correlations.window_length);
        let (wavelengths, beyond) = Ladder::new(base, spacing, waves as usize)?.for_scans(
            spacing,
            window,
            reliable,
            parameters.undetermined,
        )?;
        let rule = parameters.rule;
        let fit = fit_sines_by(rule, &correlations.average, &wavelengths).map_err(in_this)?;
        let intervals = correlations.jackknife(rule, &fit, &wavelengths).map_err(in_this)?;
        replicates.extend(correlations.replicates(rule, waves, &wavelengths).map_err(in_this)?);
        let beyond: Vec<String> = beyond.iter().map(ToString::to_string).collect();
        warnings.extend(beyond.iter().map(|warning| format!("{waves} waves: {warning}")));
        warnings.extend(finer_than(waves, spacing, wavelengths[0]));
        warnings.extend(fit.sine_scales().iter().filter(|scale| scale.amplitude == 0.0).map(
            |scale| {
                let wavelength_mm = scale.wavelength.m_to_mm();
                format!("{waves} waves: the fit gives the wave of {wavelength_mm:.4} mm zero amplitude: the scans show no roughness of its own there")
            },
        ));
        warnings.extend(mostly_absent(waves, &fit.sine_scales()));
        scales.extend(scale_rows(waves, &fit, &intervals));
        fits.push(fit_row(waves, &fit, &correlations.average, beyond.join("; ")));
        fitted.extend(fitted_rows(waves, rule, &fit, &correlations.average));
    }
    let metadata: Metadata = warnings
        .iter()
        .enumerate()
        .map(|(i, w)| (format!("warning {}", i + 1), w.clone()))
        .chain([
            (RELIABLE_KEY.to_owned(), reliable_mm),
            (RULE_KEY.to_owned(), parameters.rule.statement().to_owned()),
        ])
        .collect();
    context.pending.write_table(WAVES, &scales, &metadata)?;
    context.pending.write_rows(REPLICATES, &replicates)?;
    context.pending.write_table(FITS, &fits, &metadata)?;
    context.pending.write_table(FITTED, &fitted, &metadata)?;
    Ok(warnings)
}

/// Groups of windows of which halves are left out in turn, for the error of friction by the choice of scans: enough for an
/// interval, and few enough to be solved.
pub(crate) const GROUPS: usize = 6;

/// Lags below this share of the shortest wave tell of roughness that no wave stands for.
const SHORTEST_LAG: f64 = 1.0 / 16.0;
/// Lateral resolution that suits a shortest wave: two points on it leave lags of 0.4 waves.
const RESOLUTION: f64 = 0.8;

/// What a fit makes of a correlation that begins far below its shortest wave, all in m.
fn finer_than(waves: u32, shortest_lag: f64, shortest_wave: f64) -> Option<String> {
    // Round-off of a spacing that is just the share.
    (shortest_lag < SHORTEST_LAG * shortest_wave * (1.0 - 1e-6)).then(|| {
        format!(
            "{waves} waves: the correlation begins at a lag of {:.4} mm, far below the shortest wave ({:.4} mm), \
             which then stands for all finer roughness and is too steep; average that away with \
             ingest.conditioning.lateral_resolution_um = {:.1}, or begin with shorter waves",
            shortest_lag.m_to_mm(),
            shortest_wave.m_to_mm(),
            (RESOLUTION * shortest_wave).m_to_um()
        )
    })
}

/// What a fit is that has found an amplitude for fewer than half of its waves: no ladder of octaves.
fn mostly_absent(waves: u32, scales: &[SineScale]) -> Option<String> {
    let present = scales.iter().filter(|scale| scale.amplitude != 0.0).count();
    (2 * present < scales.len()).then(|| {
        format!(
            "{waves} waves: only {present} of {} have an amplitude, so the surfaces are far from the road, whose roughness is in \
             all octaves: fit fewer waves, begin with longer ones (approximate.shortest_wavelength_mm), or take measured \
             profiles (realise.methods)",
            scales.len()
        )
    })
}

/// Writes the waves that the recipe states itself; there is no fit to report.
fn write_given(parameters: &Approximate, context: &mut Context) -> Result<Vec<String>, StageError> {
    let rows = parameters.given.iter().flat_map(|given| {
        (1..).zip(&given.scales).map(|(number, scale)| {
            let sine = SineScale {
                wavelength: scale.wavelength_mm.mm_to_m(),
                amplitude: scale.amplitude_mm.mm_to_m(),
            };
            ScaleRow {
                waves: given.number(),
                scale: number,
                wavelength_mm: scale.wavelength_mm,
                amplitude_mm: scale.amplitude_mm,
                amplitude_confidence_95_mm: None,
                rms_slope: sine.rms_slope(),
            }
        })
    });
    let rows: Vec<_> = rows.collect();
    let source = |given: &GivenWaves| (format!("source {}", given.number()), given.source.clone());
    let metadata: Metadata = parameters.given.iter().map(source).collect();
    context.pending.write_table(WAVES, &rows, &metadata)?;
    Ok(Vec::new())
}

/// The correlations of the run, average and per window, at the same lags.
struct Correlations {
    average: Vec<CorrelationSample>,
    windows: Vec<Vec<CorrelationSample>>,
    /// Sample spacing in m: the shortest lag.
    spacing: f64,
    /// Length of a window in m.
    window_length: f64,
}

impl Correlations {
    fn of(
        rows: Vec<CorrelationRow>,
        longest_lag_mm: Option<f64>,
        window_length_mm: Option<f64>,
    ) -> Self {
        let mut by_scan: BTreeMap<String, Vec<CorrelationSample>> = BTreeMap::new();
        for row in rows {
            // Log-spaced lags must be positive, and so must a correlation whose log is fitted.
            let within = longest_lag_mm.is_none_or(|limit| row.lag_mm <= limit * (1.0 + 1e-9));
            if within && row.lag_mm > 0.0 {
                by_scan.entry(row.scan).or_default().push(CorrelationSample {
                    lag: row.lag_mm.mm_to_m(),
                    value: row.correlation_mm2.mm2_to_m2(),
                    pairs: row.pairs,
                });
            }
        }
        let average = by_scan.remove(AVERAGE).unwrap_or_default();
        let spacing = average.first().map_or(0.0, |sample| sample.lag);
        let windows: Vec<_> = by_scan.into_values().collect();
        // The schema version promises the length; without it nothing is determined.
        let window_length = window_length_mm.unwrap_or(0.0).mm_to_m();
        Self { average, windows, spacing, window_length }
    }

    /// Half widths of the 95 % intervals of the amplitudes: each window is left out in turn.
    fn jackknife(
        &self,
        rule: FitRule,
        fit: &SineFit,
        wavelengths: &[f64],
    ) -> Result<Vec<Option<f64>>, SineFitError> {
        let n = self.windows.len();
        if n < 3 {
            return Ok(vec![None; fit.scales.len()]);
        }
        let replicates: Vec<Vec<f64>> = (0..n)
            .into_par_iter()
            .map(|left_out| {
                let without = self.without(&[left_out]);
                let fit = fit_sines_by(rule, &without, wavelengths)?;
                Ok(fit.sine_scales().iter().map(|scale| scale.amplitude).collect())
            })
            .collect::<Result<_, _>>()?;
        let half_width =
            |i: usize| jackknife_95(&replicates.iter().map(|r| r[i]).collect::<Vec<_>>());
        Ok((0..fit.scales.len()).map(|i| Some(half_width(i))).collect())
    }

    /// The fits without the halves of a few groups of windows in turn; none of a single window. Neighbouring windows,
    /// which are of one scan, are left out together.
    fn replicates(
        &self,
        rule: FitRule,
        waves: u32,
        wavelengths: &[f64],
    ) -> Result<Vec<ReplicateRow>, SineFitError> {
        let count = self.windows.len();
        let groups = count.min(GROUPS);
        if groups < 2 {
            return Ok(Vec::new());
        }
        let fits: Vec<Vec<ReplicateRow>> = balanced_halves(groups)
            .into_par_iter()
            .enumerate()
            .map(|(replicate, half)| {
                let of_half = |window: &usize| half.contains(&(window * groups / count));
                let left_out: Vec<usize> = (0..count).filter(of_half).collect();
                let fit = fit_sines_by(rule, &self.without(&left_out), wavelengths)?;
                let row = |(number, scale): (u32, SineScale)| ReplicateRow {
                    waves,
                    replicate: replicate as u32 + 1,
                    groups: groups as u32,
                    scale: number,
                    amplitude_mm: scale.amplitude.m_to_mm(),
                };
                Ok((1..).zip(fit.sine_scales()).map(row).collect())
            })
            .collect::<Result<_, _>>()?;
        Ok(fits.concat())
    }

    /// The average without some windows: their sums are taken off those of all.
    fn without(&self, left_out: &[usize]) -> Vec<CorrelationSample> {
        let rest = |sample: &CorrelationSample| {
            let of_lag = |window: &Vec<CorrelationSample>| {
                window.iter().find(|other| other.lag == sample.lag).copied()
            };
            let (mut pairs, mut sum) = (sample.pairs, sample.value * sample.pairs as f64);
            let windows = left_out.iter().map(|&window| &self.windows[window]);
            for gone in windows.filter_map(of_lag) {
                pairs = pairs.checked_sub(gone.pairs)?;
                sum -= gone.value * gone.pairs as f64;
            }
            let (lag, value) = (sample.lag, sum / pairs as f64);
            (pairs > 0).then_some(CorrelationSample { lag, value, pairs })
        };
        self.average.iter().filter_map(rest).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ladders_with_fewer_than_half_of_their_waves_are_told() {
        let scales = |amplitudes: &[f64]| -> Vec<SineScale> {
            let scale = |amplitude: &f64| SineScale { wavelength: 1e-3, amplitude: *amplitude };
            amplitudes.iter().map(scale).collect()
        };
        assert_eq!(mostly_absent(4, &scales(&[0.0, 1e-6, 0.0, 2e-6])), None);
        assert_eq!(mostly_absent(1, &scales(&[1e-6])), None);
        let warning = mostly_absent(5, &scales(&[0.0, 1e-6, 0.0, 2e-6, 0.0])).unwrap();
        assert!(warning.starts_with("5 waves: only 2 of 5 have an amplitude"), "{warning}");
    }
}
