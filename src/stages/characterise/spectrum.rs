//! The spectrum and what follows from it: bins, the isotropic spectrum, Hurst exponents, the check
//! against the correlation.

use super::{AVERAGE, Characterise, SelfAffineRow, finite, warnings};
use crate::artifact::{Metadata, Row, Table};
use crate::surface::spectrum::{
    Agreement, PowerSpectrum, Route, SpectrumBin, abel_inverse, agreement, fit_hurst_exponent,
    self_affine_isotropic,
};
use crate::surface::{HeightDifferenceCorrelation, spectrum::SpectrumError};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Spectrum in log-spaced bins, per window and averaged: `spectrum.arrow`.
pub const SPECTRUM: Table<SpectrumRow> = Table::new("characterise", "spectrum.arrow");
/// Spectrum of an isotropic surface with the averaged line spectrum: `isotropic_spectrum.arrow`.
pub const ISOTROPIC: Table<IsotropicRow> = Table::new("characterise", "isotropic_spectrum.arrow");
/// Hurst exponents of correlation and spectrum, per window and averaged: `hurst.arrow`.
pub const HURST: Table<HurstRow> = Table::new("characterise", "hurst.arrow");
/// The averaged correlation beside that of the averaged spectrum: `agreement.arrow`.
pub const AGREEMENT: Table<AgreementRow> = Table::new("characterise", "agreement.arrow");
/// Metadata of [`AGREEMENT`]: the largest relative difference.
pub const LARGEST_DIFFERENCE_KEY: &str = "largest_relative_difference";

/// Relative difference of correlation and spectrum beyond which a run warns: some per cent are what
/// windows that weigh the parts of a scan differently leave of some tens of scans.
const LARGEST_DIFFERENCE: f64 = 0.1;

/// One-sided power spectral density: its integral over positive wavenumbers (rad/mm) is the mean
/// square height. Half of it is the two-sided density. Window and normalisation stand in the
/// metadata.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectrumRow {
    /// Name of the window, or `average` over all windows.
    pub scan: String,
    /// Mean wavenumber q = 2 π / λ of the bin.
    #[schemars(extend("unit" = "rad/mm"))]
    pub wavenumber_rad_mm: f64,
    /// Arithmetic mean of the density in the bin; from gappy scans single values can be negative.
    #[schemars(extend("unit" = "mm^3"))]
    pub density_mm3: f64,
    /// Standard error of the arithmetic mean: of the average from the spread over the windows, of
    /// one window what Gaussian heights have.
    #[schemars(extend("unit" = "mm^3"))]
    pub standard_error_mm3: f64,
    /// Geometric mean of the density in the bin over `geometric_bias`; absent where a density is
    /// not positive.
    #[schemars(extend("unit" = "mm^3"))]
    pub geometric_density_mm3: Option<f64>,
    /// What the geometric mean of Gaussian heights is of the arithmetic one: exp(-0.5772) = 0.5615
    /// of periodograms.
    #[schemars(extend("unit" = "1"))]
    pub geometric_bias: f64,
    /// Frequencies in the bin.
    pub frequencies: u64,
    /// `periodogram none`, `periodogram hann`, `periodogram welch`, `blackman-tukey`, or a list
    /// where windows differ.
    pub route: String,
}

impl Row for SpectrumRow {
    const SCHEMA: &'static str = "asperity.characterise.spectrum";
    const VERSION: u32 = 2;
}

/// Two-dimensional power spectral density of an isotropic surface whose line spectrum is the
/// average: its integral over the whole plane of wavenumbers is the mean square height.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IsotropicRow {
    /// Wavenumber q = 2 π / λ.
    #[schemars(extend("unit" = "rad/mm"))]
    pub wavenumber_rad_mm: f64,
    /// Density by the Abel inverse of the averaged line spectrum; it enlarges scatter, and may be
    /// negative where the line spectrum rises; absent where bins that are too narrow leave no
    /// finite slope between them.
    #[schemars(extend("unit" = "mm^4"))]
    pub abel_density_mm4: Option<f64>,
    /// Density by the self-affine form with the Hurst exponent of the averaged spectrum; absent
    /// where that has none above -1/2. It holds between roll-off and cut-off.
    #[schemars(extend("unit" = "mm^4"))]
    pub self_affine_density_mm4: Option<f64>,
}

impl Row for IsotropicRow {
    const SCHEMA: &'static str = "asperity.characterise.isotropic_spectrum";
    const VERSION: u32 = 2;
}

/// What a Hurst exponent is read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HurstMethod {
    /// The slope of the height-difference correlation.
    Correlation,
    /// The slope of the power spectral density.
    Spectrum,
}

impl std::fmt::Display for HurstMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(match self {
            Self::Correlation => "correlation",
            Self::Spectrum => "spectrum",
        })
    }
}

/// Hurst exponent by one of two methods, with the range it was fitted on. The methods differ: the correlation at one lag
/// contains waves of all lengths and bends over a decade of lags towards its plateau, the spectrum separates them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HurstRow {
    /// Name of the window, or `average`.
    pub scan: String,
    /// `correlation`: half the slope of log C below the bend of the self-affine fit; `spectrum`: the
    /// slope -(1 + 2 H) of the logarithm of the binned density.
    pub method: HurstMethod,
    /// Hurst exponent H.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent: f64,
    /// Lower limit of the 95 % interval of H, jackknife over windows; absent for fewer than three.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent_lower: Option<f64>,
    /// Upper limit of the 95 % interval of H.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent_upper: Option<f64>,
    /// Shortest lag or wavelength of the fit.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_mm: f64,
    /// Longest lag or wavelength on the slope.
    #[schemars(extend("unit" = "mm"))]
    pub longest_mm: f64,
    /// Root mean square residual of the decadic logarithm.
    #[schemars(extend("unit" = "1"))]
    pub rms_residual_log10: f64,
}

impl Row for HurstRow {
    const SCHEMA: &'static str = "asperity.characterise.hurst";
    const VERSION: u32 = 1;
}

/// The averaged correlation at one lag, from pairs of points and by the cosine transform of the
/// averaged spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgreementRow {
    /// Lag.
    #[schemars(extend("unit" = "mm"))]
    pub lag_mm: f64,
    /// Correlation from pairs.
    #[schemars(extend("unit" = "mm^2"))]
    pub correlation_mm2: f64,
    /// Correlation from the spectrum.
    #[schemars(extend("unit" = "mm^2"))]
    pub from_spectrum_mm2: f64,
    /// The latter over the former, less 1.
    #[schemars(extend("unit" = "1"))]
    pub relative_difference: f64,
}

impl Row for AgreementRow {
    const SCHEMA: &'static str = "asperity.characterise.agreement";
    const VERSION: u32 = 1;
}

/// The conventions of [`SpectrumRow`] and the window asked for.
pub(super) fn conventions(parameters: &Characterise) -> Metadata {
    let text = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    Metadata::from([
        text(
            "sides",
            "one-sided over q = 2 pi / wavelength > 0 in rad/mm; two-sided is half of it",
        ),
        text("normalisation", "sum of density dq = mean((w z)^2) / mean(w^2), to round-off"),
        text("window", parameters.spectrum_window.name()),
        text("bins", "equal in log q, edges at 10^(j/n) rad/m; wavenumber is the geometric mean"),
    ])
}

pub(super) fn spectrum_rows(
    parameters: &Characterise,
    names: &[&str],
    spectra: &[PowerSpectrum],
) -> Result<Vec<SpectrumRow>, SpectrumError> {
    let per_decade = parameters.spectrum_bins_per_decade;
    let rows = |name: &str, spectra: &[PowerSpectrum]| -> Result<Vec<SpectrumRow>, SpectrumError> {
        let route = route_names(spectra);
        let bins = PowerSpectrum::log_binned_over(spectra, per_decade)?;
        Ok(bins.iter().map(|bin| spectrum_row(name, &route, bin)).collect())
    };
    let mut each = names
        .par_iter()
        .zip(spectra)
        .map(|(name, spectrum)| rows(name, std::slice::from_ref(spectrum)))
        .collect::<Result<Vec<_>, _>>()?;
    each.push(rows(AVERAGE, spectra)?);
    Ok(each.concat())
}

fn spectrum_row(scan: &str, route: &str, bin: &SpectrumBin) -> SpectrumRow {
    SpectrumRow {
        scan: scan.to_owned(),
        wavenumber_rad_mm: bin.wavenumber.per_m_to_per_mm(),
        density_mm3: bin.density.m3_to_mm3(),
        standard_error_mm3: bin.standard_error.m3_to_mm3(),
        geometric_density_mm3: bin.geometric_density.map(crate::units::Units::m3_to_mm3),
        geometric_bias: bin.geometric_bias,
        frequencies: bin.count as u64,
        route: route.to_owned(),
    }
}

fn route_names(spectra: &[PowerSpectrum]) -> String {
    let name = |route: &Route| match route {
        Route::Periodogram(window) => format!("periodogram {}", window.name()),
        Route::BlackmanTukey { .. } => "blackman-tukey".to_owned(),
    };
    let mut routes: Vec<String> = spectra.iter().flat_map(|s| &s.routes).map(name).collect();
    routes.sort_unstable();
    routes.dedup();
    routes.join(", ")
}

/// Hurst exponents by both methods, window by window, and a warning where the average has none of its spectrum.
pub(super) fn hurst_rows(
    parameters: &Characterise,
    names: &[&str],
    spectra: &[PowerSpectrum],
    self_affine: &[SelfAffineRow],
    shortest_reliable: f64,
    shortest_lag_mm: f64,
) -> (Vec<HurstRow>, Vec<String>) {
    let average = self_affine.iter().find(|row| row.scan == AVERAGE);
    let bend = average.map_or(0.0, |row| row.parallel_length_mm);
    let shortest = parameters
        .hurst_shortest_wavelength_mm
        .map_or(shortest_reliable, crate::units::Units::mm_to_m);
    let longest = parameters.hurst_longest_wavelength_mm.unwrap_or(bend).mm_to_m();
    let per_decade = parameters.spectrum_bins_per_decade;
    let of_spectrum = |name: &str, spectra: &[PowerSpectrum]| {
        fit_hurst_exponent(spectra, per_decade, shortest, longest).map(|fit| HurstRow {
            scan: name.to_owned(),
            method: HurstMethod::Spectrum,
            hurst_exponent: fit.hurst_exponent,
            hurst_exponent_lower: fit.hurst_exponent_95.map(|interval| interval.lower),
            hurst_exponent_upper: fit.hurst_exponent_95.map(|interval| interval.upper),
            shortest_mm: fit.shortest_wavelength.m_to_mm(),
            longest_mm: fit.longest_wavelength.m_to_mm(),
            rms_residual_log10: fit.rms_residual,
        })
    };
    let of_correlation = |row: &SelfAffineRow| HurstRow {
        scan: row.scan.clone(),
        method: HurstMethod::Correlation,
        hurst_exponent: row.hurst_exponent,
        hurst_exponent_lower: row.hurst_exponent_lower,
        hurst_exponent_upper: row.hurst_exponent_upper,
        shortest_mm: shortest_lag_mm,
        longest_mm: row.parallel_length_mm,
        rms_residual_log10: row.rms_residual_log10,
    };
    let mut rows: Vec<HurstRow> = self_affine.iter().map(of_correlation).collect();
    let each = names.par_iter().zip(spectra);
    let each = each.map(|(name, s)| (*name, of_spectrum(name, std::slice::from_ref(s))));
    let mut missing = Vec::new();
    for (name, row) in each.collect::<Vec<_>>() {
        match row {
            Ok(row) => rows.push(row),
            Err(error) => missing.push((name.to_owned(), error.to_string())),
        }
    }
    let told = match of_spectrum(AVERAGE, spectra) {
        Ok(row) => {
            rows.push(row);
            let what = "Hurst exponent of the spectrum";
            warnings::left_out("windows", names.len(), what, &missing)
        }
        // Then the windows have none either, for the same reason.
        Err(error) => {
            let keys = "characterise.hurst_shortest_wavelength_mm, hurst_longest_wavelength_mm";
            Some(format!("no Hurst exponent of the spectrum: {error} ({keys})"))
        }
    };
    // The exponents of a window beneath each other, those of the average last. The sort is stable.
    let place: HashMap<&str, usize> = names.iter().copied().zip(0..).collect();
    rows.sort_by_key(|row| place.get(row.scan.as_str()).copied().unwrap_or(names.len()));
    (rows, told.into_iter().collect())
}

/// The isotropic spectrum at the bins of the average that have power; none for fewer than two.
pub(super) fn isotropic_rows(spectrum: &[SpectrumRow], hurst: &[HurstRow]) -> Vec<IsotropicRow> {
    let average = spectrum.iter().filter(|row| row.scan == AVERAGE && row.density_mm3 > 0.0);
    let (wavenumbers, densities): (Vec<f64>, Vec<f64>) = average
        .map(|row| (row.wavenumber_rad_mm.per_mm_to_per_m(), row.density_mm3.mm3_to_m3()))
        .unzip();
    let exponent = hurst
        .iter()
        .find(|row| row.scan == AVERAGE && row.method == HurstMethod::Spectrum)
        .map(|row| row.hurst_exponent)
        .filter(|&exponent| exponent > -0.5);
    let Ok(inverse) = abel_inverse(&wavenumbers, &densities) else { return Vec::new() };
    let row = |((&q, &line), density): ((&f64, &f64), f64)| IsotropicRow {
        wavenumber_rad_mm: q.per_m_to_per_mm(),
        abel_density_mm4: finite(density.m4_to_mm4()),
        self_affine_density_mm4: exponent
            .and_then(|exponent| finite(self_affine_isotropic(q, line, exponent).m4_to_mm4())),
    };
    wavenumbers.iter().zip(&densities).zip(inverse).map(row).collect()
}

/// The averaged correlation beside that of the averaged spectrum from half the shortest reliable
/// wavelength (metres) on; the largest difference as metadata, and a warning if it is large.
pub(super) fn agreement_rows(
    spectrum: &PowerSpectrum,
    correlation: &HeightDifferenceCorrelation,
    shortest_reliable: f64,
    per_decade: usize,
) -> (Vec<AgreementRow>, Metadata, Vec<String>) {
    let compared = agreement(spectrum, correlation, shortest_reliable / 2.0, per_decade);
    let row = |compared: &Agreement| AgreementRow {
        lag_mm: compared.lag.m_to_mm(),
        correlation_mm2: compared.correlation.m2_to_mm2(),
        from_spectrum_mm2: compared.from_spectrum.m2_to_mm2(),
        relative_difference: compared.relative_difference(),
    };
    // Flat scans have a correlation of 0, and nothing differs from it in relation.
    let defined = |row: &AgreementRow| row.relative_difference.is_finite();
    let rows: Vec<AgreementRow> = compared.iter().map(row).filter(defined).collect();
    let size = |row: &&AgreementRow| row.relative_difference.abs();
    let Some(worst) = rows.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else {
        return (rows, Metadata::new(), Vec::new());
    };
    let text = |key: &str, value: String| (key.to_owned(), value);
    let metadata = Metadata::from([
        text(LARGEST_DIFFERENCE_KEY, size(&worst).to_string()),
        text("warned_of_beyond", LARGEST_DIFFERENCE.to_string()),
        text("lags", "half the shortest reliable wavelength to a twentieth of a window".into()),
    ]);
    let (percent, lag_mm) = (worst.relative_difference * 100.0, worst.lag_mm);
    let warning = format!(
        "spectrum and correlation differ by {percent:.0} % at a lag of {lag_mm:.4} mm: the scans have \
         a trend, a few high places or many gaps; take away more form \
         (ingest.conditioning.form), or trust the correlation"
    );
    let warnings = (size(&worst) > LARGEST_DIFFERENCE).then_some(warning);
    (rows, metadata, warnings.into_iter().collect())
}
