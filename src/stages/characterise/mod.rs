//! characterise: roughness parameters, height-difference correlation, spectrum, self-affine fit,
//! parameters of the standards.
//!
//! | module | what it holds |
//! |---|---|
//! | `maps` | maps over the plane: parameters of ISO 25178-2, correlation over direction, spectrum, anisotropy |
//! | `map_rows` | the tables of maps |
//! | `rows` | the tables of lines |
//! | `spectrum` | the spectrum and what follows from it: bins, the isotropic spectrum, Hurst exponents, the check against the correlation |
//! | `standards` | parameters of the standards: profile parameters, mean profile depth, texture levels |
//! | `warnings` | what a user is told where numbers are left out |

mod map_rows;
mod maps;
mod rows;
mod spectrum;
mod standards;
mod warnings;

pub use map_rows::{
    AREAL_AVERAGES, AREAL_CORRELATION, AREAL_DIRECTIONS, AREAL_PARAMETERS, AREAL_SPECTRUM,
    ArealCorrelationRow, ArealDirectionRow, ArealParametersRow, ArealSpectrumRow,
};
pub use spectrum::{
    AGREEMENT, AgreementRow, HURST, HurstMethod, HurstRow, ISOTROPIC, IsotropicRow,
    LARGEST_DIFFERENCE_KEY, SPECTRUM, SpectrumRow,
};
pub use standards::{DEPTH, DepthRow, PROFILE, ProfileDepth, ProfileRow, TEXTURE, TextureRow};

use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::ingest::{MAPS, SCANS, read_maps, read_windows};
use super::{Stage, StageError, keys};
use crate::artifact::{Metadata, RunView};
use crate::requirement::{InvalidRecipe, require};
use crate::surface::LineScan;
use crate::surface::correlation::{HeightDifferenceCorrelation, correlate_scans};
use crate::surface::filter::ProfileFilter;
use crate::surface::parameters::{ParameterError, RoughnessParameters};
use crate::surface::probe::Probe;
use crate::surface::profile::ProfileStandard;
use crate::surface::self_affine::{LagRange, fit_self_affine};
use crate::surface::spectrum::{PowerSpectrum, Window, power_spectra};
use crate::units::Units;
use rayon::prelude::*;
pub use rows::{
    AVERAGE, AVERAGES, AverageRow, CORRELATION, CorrelationRow, PARAMETERS, ParametersRow,
    SELF_AFFINE, SelfAffineRow, schemas,
};
use rows::{
    NamedParameters, average_rows, correlation_rows, finite, parameters_row, self_affine_row,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 7;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "characterise",
    summary: "Roughness of the windows",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    chain.ingest?;
    let (lines, maps) = (chain.has_lines(), chain.has_maps());
    let run = move |inputs: &Inputs, context: &mut Context| {
        let (parameters, results) = (chain.characterise, &inputs.results);
        let mut warnings = Vec::new();
        if lines {
            warnings.extend(of_lines(parameters, results, context)?);
        }
        if maps {
            context.check_interrupt()?;
            warnings.extend(of_maps(parameters, results, context)?);
        }
        Ok(warnings)
    };
    let planned = Planned::new(json!(chain.characterise), run).reading_if(lines, SCANS);
    Some(planned.reading_if(maps, MAPS))
}

/// Section `[characterise]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Characterise {
    /// Lags a decade at which the correlation is kept.
    pub lags_per_decade: usize,
    /// Longest lag in millimetres; half a window if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_lag_mm: Option<f64>,
    /// Bins a decade of the averaged spectrum.
    pub spectrum_bins_per_decade: usize,
    /// Window of the spectrum where a scan has no gaps: `none`, `hann` or `welch`.
    pub spectrum_window: Window,
    /// 1/e² diameter of the light spot in micrometres; waves shorter than twice of it are not
    /// reliable. Not known by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot_diameter_um: Option<f64>,
    /// Radius of the tip of a stylus in micrometres; waves are not reliable at scales at which the
    /// sharpest peak has more than half the curvature of the tip. Not known by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip_radius_um: Option<f64>,
    /// Shortest wavelength in millimetres of the Hurst exponent of the spectrum; the shortest
    /// reliable one if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hurst_shortest_wavelength_mm: Option<f64>,
    /// Longest wavelength in millimetres of the Hurst exponent of the spectrum; the lateral
    /// correlation length if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hurst_longest_wavelength_mm: Option<f64>,
    /// Shortest lag of the self-affine fit in millimetres; one spacing if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_affine_shortest_lag_mm: Option<f64>,
    /// Longest lag of the self-affine fit in millimetres; that of the correlation if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_affine_longest_lag_mm: Option<f64>,
    /// Cut-off λs of the profile parameters in millimetres: shorter waves do not count. None by
    /// default. Correlation and spectrum are those of the unfiltered windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda_s_mm: Option<f64>,
    /// Cut-off λc of the profile parameters in millimetres: longer waves are waviness. None by
    /// default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda_c_mm: Option<f64>,
    /// Filter of both cut-offs: `gaussian`, `gaussian_regression` or `robust_gaussian`.
    pub profile_filter: ProfileFilter,
    /// Section (sampling) length of the profile parameters in millimetres; λc if not set, a fifth
    /// of the window without λc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub section_length_mm: Option<f64>,
    /// Which parameters are means over sections: `iso21920` or `iso4287`.
    pub profile_standard: ProfileStandard,
    /// The mean profile depth of ISO 13473-1.
    pub profile_depth: ProfileDepth,
}

impl Default for Characterise {
    fn default() -> Self {
        Self {
            lags_per_decade: 20,
            longest_lag_mm: None,
            spectrum_bins_per_decade: 10,
            spectrum_window: Window::Hann,
            spot_diameter_um: None,
            tip_radius_um: None,
            hurst_shortest_wavelength_mm: None,
            hurst_longest_wavelength_mm: None,
            self_affine_shortest_lag_mm: None,
            self_affine_longest_lag_mm: None,
            lambda_s_mm: None,
            lambda_c_mm: None,
            profile_filter: ProfileFilter::Gaussian,
            section_length_mm: None,
            profile_standard: ProfileStandard::Iso21920,
            profile_depth: ProfileDepth::default(),
        }
    }
}

impl Characterise {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let count = "a whole number from 2 to 1000";
        let lags = self.lags_per_decade;
        require((2..=1000).contains(&lags), "characterise.lags_per_decade", lags, count)?;
        let bins = self.spectrum_bins_per_decade;
        require((2..=1000).contains(&bins), "characterise.spectrum_bins_per_decade", bins, count)?;
        for (key, value) in [
            ("characterise.longest_lag_mm", self.longest_lag_mm),
            ("characterise.self_affine_shortest_lag_mm", self.self_affine_shortest_lag_mm),
            ("characterise.self_affine_longest_lag_mm", self.self_affine_longest_lag_mm),
            ("characterise.lambda_s_mm", self.lambda_s_mm),
            ("characterise.lambda_c_mm", self.lambda_c_mm),
            ("characterise.section_length_mm", self.section_length_mm),
            ("characterise.spot_diameter_um", self.spot_diameter_um),
            ("characterise.tip_radius_um", self.tip_radius_um),
            ("characterise.hurst_shortest_wavelength_mm", self.hurst_shortest_wavelength_mm),
            ("characterise.hurst_longest_wavelength_mm", self.hurst_longest_wavelength_mm),
        ] {
            let positive = value.is_none_or(|mm| mm > 0.0 && mm.is_finite());
            require(positive, key, value.unwrap_or_default(), "positive and finite")?;
        }
        for (keys, lower, upper) in [
            ("characterise.(lambda_s_mm, lambda_c_mm)", self.lambda_s_mm, self.lambda_c_mm),
            (
                "characterise.(lambda_s_mm, section_length_mm)",
                self.lambda_s_mm,
                self.section_length_mm,
            ),
            (
                "characterise.(self_affine_shortest_lag_mm, self_affine_longest_lag_mm)",
                self.self_affine_shortest_lag_mm,
                self.self_affine_longest_lag_mm,
            ),
            (
                "characterise.(hurst_shortest_wavelength_mm, hurst_longest_wavelength_mm)",
                self.hurst_shortest_wavelength_mm,
                self.hurst_longest_wavelength_mm,
            ),
        ] {
            require_ascending(keys, lower, upper)?;
        }
        self.profile_depth.check()
    }

    fn probe(&self) -> Probe {
        let metres = |um: f64| um.um_to_m();
        Probe {
            spot_diameter: self.spot_diameter_um.map(metres),
            tip_radius: self.tip_radius_um.map(metres),
        }
    }
}

/// Of two lengths that are both given the first is the shorter.
fn require_ascending(
    keys: &'static str,
    lower: Option<f64>,
    upper: Option<f64>,
) -> Result<(), InvalidRecipe> {
    match (lower, upper) {
        (Some(lower), Some(upper)) => {
            require(lower < upper, keys, (lower, upper), "in ascending order")
        }
        _ => Ok(()),
    }
}

/// Metadata of [`CORRELATION`]: length of the shortest window in millimetres.
pub const WINDOW_LENGTH_KEY: &str = "window_length_mm";
/// Metadata of [`CORRELATION`], [`SPECTRUM`] and, of maps, [`AREAL_PARAMETERS`]: shortest wavelength in millimetres that the
/// instrument and its spacing show as it is.
pub const RELIABLE_KEY: &str = "shortest_reliable_wavelength_mm";

/// A length in the metadata of a table; none if the table has none.
///
/// # Errors
/// [`StageError::Metadata`] for a text that is not a number.
pub fn length_in(metadata: &Metadata, key: &'static str) -> Result<Option<f64>, StageError> {
    let text = metadata.get(key).filter(|text| !text.is_empty());
    let number =
        |text: &String| text.parse().map_err(|_| StageError::Metadata { key, value: text.clone() });
    text.map(number).transpose()
}

/// Characterises the windows of maps and writes the results; returns warnings.
///
/// # Errors
/// [`StageError::Gap`]. A map that cannot be characterised is left out with a warning.
fn of_maps(
    parameters: &Characterise,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let maps = read_maps(run)?;
    let reliable = maps::shortest_reliable_wavelength(parameters.probe(), &maps);
    let tables = maps::tables(parameters, maps)?;
    let metadata = Metadata::from([(RELIABLE_KEY.to_owned(), reliable.m_to_mm().to_string())]);
    let pending = &mut context.pending;
    pending.write_table(AREAL_PARAMETERS, &tables.parameters, &metadata)?;
    pending.write_rows(AREAL_AVERAGES, &tables.averages)?;
    pending.write_rows(AREAL_CORRELATION, &tables.correlation)?;
    pending.write_rows(AREAL_SPECTRUM, &tables.spectrum)?;
    pending.write_rows(AREAL_DIRECTIONS, &tables.directions)?;
    Ok(tables.warnings)
}

/// Characterises the windows of lines and writes the results; returns warnings.
///
/// # Errors
/// [`StageError`]: a window without heights. What cannot be fitted is left out with a warning.
fn of_lines(
    parameters: &Characterise,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let windows = read_windows(run)?;
    context.check_interrupt()?;
    let (roughness, mut warnings) = roughness_parameters(&windows)?;
    let longest_lag = parameters.longest_lag_mm.map(super::super::units::Units::mm_to_m);
    let correlations = correlate_scans(&windows, longest_lag)?;
    let average = HeightDifferenceCorrelation::average(&correlations)?;
    context.check_interrupt()?;
    let spectra = power_spectra(&windows, &correlations, parameters.spectrum_window)?;
    let mean_spectrum = PowerSpectrum::average(&spectra)?;

    let names: Vec<&str> = windows.iter().map(|window| window.name.as_str()).collect();
    let rows: Vec<_> = roughness.iter().map(parameters_row).collect();
    context.pending.write_rows(PARAMETERS, &rows)?;
    context.pending.write_rows(AVERAGES, &average_rows(&roughness)?)?;

    let with_average = || names.iter().copied().chain([AVERAGE]);
    let rows: Vec<_> = with_average()
        .zip(correlations.iter().chain([&average]))
        .flat_map(|(name, c)| correlation_rows(name, c, parameters.lags_per_decade))
        .collect();
    let reliable = parameters.probe().shortest_reliable_wavelength(&windows);
    let cut_off = (RELIABLE_KEY.to_owned(), reliable.m_to_mm().to_string());
    let window_length = (WINDOW_LENGTH_KEY.to_owned(), shortest_window_mm(&windows));
    let metadata = Metadata::from([window_length, cut_off.clone()]);
    context.pending.write_table(CORRELATION, &rows, &metadata)?;
    let spectrum_rows = spectrum::spectrum_rows(parameters, &names, &spectra)?;
    let mut metadata = spectrum::conventions(parameters);
    metadata.extend([cut_off]);
    context.pending.write_table(SPECTRUM, &spectrum_rows, &metadata)?;
    context.check_interrupt()?;
    let (rows, told) = standards::profile_rows(parameters, &windows);
    warnings.extend(told);
    context.pending.write_rows(PROFILE, &rows)?;
    let (rows, told) = standards::depth_rows(parameters, &windows);
    warnings.extend(told);
    context.pending.write_rows(DEPTH, &rows)?;
    let rows = standards::texture_rows(&names, &spectra, &mean_spectrum);
    context.pending.write_rows(TEXTURE, &rows)?;
    let (rows, told) = self_affine(parameters, &names, &correlations);
    warnings.extend(told);
    context.pending.write_rows(SELF_AFFINE, &rows)?;
    let shortest_lag_mm =
        parameters.self_affine_shortest_lag_mm.unwrap_or(average.spacing.m_to_mm());
    let (hurst, missing) =
        spectrum::hurst_rows(parameters, &names, &spectra, &rows, reliable, shortest_lag_mm);
    context.pending.write_rows(HURST, &hurst)?;
    let rows = spectrum::isotropic_rows(&spectrum_rows, &hurst);
    context.pending.write_rows(ISOTROPIC, &rows)?;
    let (rows, metadata, apart) =
        spectrum::agreement_rows(&mean_spectrum, &average, reliable, parameters.lags_per_decade);
    context.pending.write_table(AGREEMENT, &rows, &metadata)?;
    warnings.extend(missing.into_iter().chain(apart));
    Ok(warnings)
}

/// Length of the shortest window as text. The part of a scan that fills no further point counts:
/// a scan cut to whole points is up to one spacing longer than its points.
fn shortest_window_mm(windows: &[LineScan]) -> String {
    let length = |window: &LineScan| window.length() + window.spacing;
    let shortest = windows.iter().map(length).fold(f64::INFINITY, f64::min);
    shortest.m_to_mm().to_string()
}

/// Parameters of the windows with their names, and a warning of those that are flat: they have no
/// skewness and no row.
fn roughness_parameters(
    windows: &[LineScan],
) -> Result<(Vec<NamedParameters>, Vec<String>), StageError> {
    let (mut found, mut flat) = (Vec::new(), Vec::new());
    let all: Vec<_> =
        windows.par_iter().map(|window| RoughnessParameters::of(window, 0.0)).collect();
    for (window, parameters) in windows.iter().zip(all) {
        match parameters {
            Ok(parameters) => found.push((window.name.clone(), parameters)),
            Err(ParameterError::Flat { .. }) => {
                flat.push((window.name.clone(), "all of its heights are the same".to_owned()));
            }
            Err(error) => return Err(error.into()),
        }
    }
    let warning = warnings::left_out("windows", windows.len(), "roughness parameters", &flat);
    Ok((found, warning.into_iter().collect()))
}

/// Fits of the windows and of the average; one that cannot be made has a warning and no row.
fn self_affine(
    parameters: &Characterise,
    names: &[&str],
    correlations: &[HeightDifferenceCorrelation],
) -> (Vec<SelfAffineRow>, Vec<String>) {
    let spacing = correlations.first().map_or(0.0, |c| c.spacing);
    let most = correlations
        .iter()
        .map(asperity_core::surface::HeightDifferenceCorrelation::maximum_lag)
        .min()
        .unwrap_or(0);
    let range = LagRange {
        shortest: parameters
            .self_affine_shortest_lag_mm
            .map_or(spacing, super::super::units::Units::mm_to_m),
        longest: parameters
            .self_affine_longest_lag_mm
            .map_or(most as f64 * spacing, super::super::units::Units::mm_to_m),
        per_decade: parameters.lags_per_decade,
    };
    let fits: Vec<_> = correlations
        .par_iter()
        .map(|c| fit_self_affine(std::slice::from_ref(c), Some(range)))
        .collect();
    let (mut rows, mut failed) = (Vec::new(), Vec::new());
    for (name, fit) in names.iter().zip(fits) {
        match fit {
            Ok(fit) => rows.push(self_affine_row(name, &fit)),
            Err(error) => {
                let reason = format!("{error}{}", keys::of_self_affine(&error));
                failed.push(((*name).to_owned(), reason));
            }
        }
    }
    let told = warnings::left_out("windows", names.len(), "self-affine fit", &failed);
    let mut warnings: Vec<String> = told.into_iter().collect();
    match fit_self_affine(correlations, Some(range)) {
        Ok(fit) => {
            rows.push(self_affine_row(AVERAGE, &fit));
            if !fit.plateau_found {
                warnings.push(
                    "the averaged correlation reaches no plateau: both correlation lengths are \
                     lower bounds; use longer windows"
                        .to_owned(),
                );
            }
        }
        Err(error) => {
            let keys = keys::of_self_affine(&error);
            warnings.push(format!("no self-affine fit of the average: {error}{keys}"));
        }
    }
    (rows, warnings)
}
