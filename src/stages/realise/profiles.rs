//! Surfaces of the windows of the scans: the windows themselves, and profiles with their spectrum.

use super::{Direction, Method, Realise, Surface, SurfaceKind};
use crate::artifact::{Row, Table};
use crate::stages::StageError;
use crate::surface::periodic::matched;
use crate::surface::realisation::random_phases;
use crate::surface::{LineScan, PeriodicError, PeriodicProfile, SineScale, Wave, wave};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Which window each surface is of, and its roughness: `profiles.arrow`, where there are surfaces of windows.
pub const PROFILES: Table<ProfileRow> = Table::new("realise", "profiles.arrow");

/// Gaps that are filled unless the recipe says otherwise, in shortest wavelengths: what optical instruments leave out at
/// the flank of a stone.
pub(crate) const LONGEST_GAP: f64 = 8.0;

/// Points on the shortest wave from which the roughness of a profile is taken.
const POINTS_PER_WAVE: f64 = 8.0;

/// One surface of a window, and its roughness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Name of the window.
    pub window: String,
    /// Period of the profile: twice the window if mirrored, less than the window if blended.
    #[schemars(extend("unit" = "mm"))]
    pub period_mm: f64,
    /// Shortest wavelength.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_wavelength_mm: f64,
    /// Share of the points of the window that had no height and were filled by straight lines.
    #[schemars(extend("unit" = "1"))]
    pub filled: f64,
    /// Root mean square height of the waves that are shorter than the shortest wavelength, and left out.
    #[schemars(extend("unit" = "mm"))]
    pub left_out_rms_height_mm: f64,
    /// Root mean square height.
    #[schemars(extend("unit" = "mm"))]
    pub rms_height_mm: f64,
    /// Root mean square slope.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Mean cube of the heights over that of the root mean square: negative for plateaus with pits.
    #[schemars(extend("unit" = "1"))]
    pub skewness: f64,
    /// Mean fourth power of the heights over that of the root mean square: 3 for Gaussian heights.
    #[schemars(extend("unit" = "1"))]
    pub kurtosis: f64,
    /// Root mean square difference of the sorted heights to those of the window, over their root mean square; absent
    /// where the heights are not matched.
    #[schemars(extend("unit" = "1"))]
    pub mismatch: Option<f64>,
}

impl Row for ProfileRow {
    const SCHEMA: &'static str = "asperity.realise.profiles";
    const VERSION: u32 = 1;
}

/// Surfaces, what each of them is of, and warnings.
type OfWindows = (Vec<Surface>, Vec<ProfileRow>, Vec<String>);

/// The surfaces of all methods of windows, what they are of, and warnings. Windows with a gap that is not filled are
/// left out.
///
/// # Errors
/// [`StageError::Periodic`] where no window is left, or a window is not resolved.
pub(super) fn of_windows(
    parameters: &Realise,
    windows: &[LineScan],
    shortest: f64,
) -> Result<OfWindows, StageError> {
    let most = parameters.most_windows.map_or(usize::MAX, |most| most as usize);
    let longest_gap = parameters.longest_gap_mm.map_or(LONGEST_GAP * shortest, Units::mm_to_m);
    let periodic = parameters.periodic.unwrap_or_default();
    let (mut profiles, mut gaps, mut flat) = (Vec::new(), Vec::new(), Vec::new());
    for window in windows {
        if profiles.len() == most {
            break;
        }
        match PeriodicProfile::new(window, periodic, shortest, longest_gap) {
            Ok(profile) if is_flat(&profile) => flat.push(window.name.as_str()),
            Ok(profile) => profiles.push((window.name.as_str(), window.heights.len(), profile)),
            Err(gap @ PeriodicError::Gap { .. }) => gaps.push(gap),
            Err(error) => return Err(error.into()),
        }
    }
    if profiles.is_empty() {
        let gap = gaps.into_iter().next().map(StageError::Periodic);
        let flat = flat.first().map(|window| StageError::FlatWindow { window: (*window).into() });
        return Err(gap.or(flat).unwrap_or(StageError::NoScans { paths: Vec::new() }));
    }
    let mut warnings = Vec::new();
    if let Some(first) = gaps.first() {
        warnings.push(format!(
            "{} of {} windows are no surfaces, because of missing heights: {first} \
             (realise.longest_gap_mm)",
            gaps.len(),
            gaps.len() + profiles.len()
        ));
    }
    if let Some(first) = flat.first() {
        warnings.push(format!(
            "{} of {} windows are flat, and no surfaces: the first is {first}",
            flat.len(),
            flat.len() + profiles.len() + gaps.len()
        ));
    }
    if profiles.len() == 1 {
        warnings.push(
            "one window alone tells nothing of the scatter of the road: friction of it has no \
             interval; scan more"
                .into(),
        );
    }
    let made: Vec<(Surface, ProfileRow)> = surfaces_to_make(parameters, profiles.len())
        .par_iter()
        .map(|&(method, k)| {
            let (window, points, profile) = &profiles[k % profiles.len()];
            let seed = parameters.seed.unwrap_or_default();
            let (surface, mismatch) = surface(method, profile, seed, k as u32 + 1);
            let row = row(&surface, window, *points, profile, mismatch);
            (surface, row)
        })
        .collect();
    let worst = made.iter().filter_map(|(_, row)| row.mismatch).fold(0.0, f64::max);
    if worst > MUCH_MISMATCH {
        warnings.push(format!(
            "matched phases: the heights differ by up to {:.0} % of their root mean square from \
             those of the window (mismatch in {PROFILES})",
            100.0 * worst
        ));
    }
    let (surfaces, rows) = made.into_iter().unzip();
    Ok((surfaces, rows, warnings))
}

/// Whether a profile has no wave.
fn is_flat(profile: &PeriodicProfile) -> bool {
    profile.waves.iter().all(|wave| wave.amplitude == 0.0)
}

/// Every surface by its method and its number from 0: one of each window and direction, or as many as are drawn.
fn surfaces_to_make(parameters: &Realise, windows: usize) -> Vec<(Method, usize)> {
    let draws = parameters.drawn() as usize;
    let mut found = Vec::new();
    for method in &parameters.methods {
        match method {
            Method::Sines | Method::MeasuredBackward | Method::Isotropic => {}
            Method::Measured => {
                for direction in &parameters.directions {
                    let method = match direction {
                        Direction::Forward => Method::Measured,
                        Direction::Backward => Method::MeasuredBackward,
                    };
                    found.extend((0..windows).map(|k| (method, k)));
                }
            }
            drawn => found.extend((0..draws).map(|k| (*drawn, k))),
        }
    }
    found
}

/// A surface of a window, and how far its heights are from those of the window where they are matched.
fn surface(
    method: Method,
    profile: &PeriodicProfile,
    seed: u64,
    realisation: u32,
) -> (Surface, Option<f64>) {
    let (waves, mismatch) = match method {
        Method::Matched => {
            let found = matched(&profile.waves, profile.period, seed, u64::from(realisation));
            (found.waves, Some(found.mismatch))
        }
        Method::RandomPhase => {
            let scale =
                |wave: &Wave| SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude };
            let scales: Vec<SineScale> = profile.waves.iter().map(scale).collect();
            (random_phases(&scales, seed, u64::from(realisation)), None)
        }
        Method::MeasuredBackward => (profile.reversed().waves, None),
        _ => (profile.waves.clone(), None),
    };
    (Surface { kind: SurfaceKind::of(method), realisation, profile: waves }, mismatch)
}

/// Heights that differ by more than this share of their root mean square are not those of the window.
const MUCH_MISMATCH: f64 = 0.05;

fn row(
    surface: &Surface,
    window: &str,
    points: usize,
    profile: &PeriodicProfile,
    mismatch: Option<f64>,
) -> ProfileRow {
    let period = profile.period;
    let shortest = surface.profile.first().map_or(period, |wave| wave.wavelength);
    let count = ((POINTS_PER_WAVE * period / shortest).round() as usize).next_power_of_two();
    let heights = wave::sample(&surface.profile, period, count);
    let mean = |power: i32| heights.iter().map(|z| z.powi(power)).sum::<f64>() / count as f64;
    let rms = mean(2).sqrt();
    ProfileRow {
        kind: surface.kind,
        realisation: surface.realisation,
        window: window.to_owned(),
        period_mm: period.m_to_mm(),
        shortest_wavelength_mm: shortest.m_to_mm(),
        filled: profile.filled as f64 / points as f64,
        left_out_rms_height_mm: profile.left_out.sqrt().m_to_mm(),
        rms_height_mm: rms.m_to_mm(),
        rms_slope: rms_slope(&surface.profile),
        skewness: mean(3) / rms.powi(3),
        kurtosis: mean(4) / rms.powi(4),
        mismatch,
    }
}

/// Root mean square slope of waves that all divide one period: `sqrt(sum (q D)² / 2)`.
pub(crate) fn rms_slope(waves: &[Wave]) -> f64 {
    let slope = |wave: &Wave| TAU * wave.amplitude / wave.wavelength;
    (0.5 * waves.iter().map(|wave| slope(wave).powi(2)).sum::<f64>()).sqrt()
}
