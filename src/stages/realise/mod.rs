//! realise: the surfaces that stand for the road: its windows as they are, windows with other phases, and the fitted
//! sines with random phases.
//!
//! | module | what it holds |
//! |---|---|
//! | `areal` | areal surfaces of maps |
//! | `isotropic` | isotropic areal surfaces with the spectrum of lines |
//! | `kind` | how surfaces are made of a road, and what tables call them |
//! | `profiles` | surfaces of the windows of the scans |
//! | `section` | the section `[realise]` of a recipe |
//! | `shortest` | the shortest wavelength of the surfaces of windows |

mod areal;
mod isotropic;
mod kind;
mod profiles;
mod section;
mod shortest;

use super::approximate::{ScaleRow, WAVES};
use super::characterise::{AREAL_PARAMETERS, ISOTROPIC};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::ingest::{MAPS, SCANS, read_maps, read_windows};
use super::{Stage, StageError};
use crate::artifact::{Row, RunView, SchemaVersion, Storage, Table};
use crate::surface::realisation::random_phases;
use crate::surface::{SineScale, Wave};
use crate::units::Units;
pub use areal::{AREAL, AREAL_SURFACES, ArealRow, ArealSurface, areal_schema, read_areal_surfaces};
pub use kind::{Method, SurfaceKind};
pub(crate) use profiles::LONGEST_GAP;
#[cfg(test)]
pub(crate) use profiles::rms_slope;
pub use profiles::{PROFILES, ProfileRow};
use schemars::JsonSchema;
pub use section::{Direction, Realise};
use serde::{Deserialize, Serialize};
use serde_json::json;
use shortest::MapLimit;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 3;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "realise",
    summary: "Surfaces that stand for the road",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (realise, maps) = (chain.realise, chain.has_maps());
    let mut parameters = json!(realise);
    let alone = maps && !chain.has_lines();
    let limit = alone.then_some(MapLimit {
        shortest_wavelength_mm: chain.approximate.shortest_wavelength_mm,
        undetermined: chain.approximate.undetermined,
    });
    if let Some(limit) = &limit {
        parameters["approximate"] = json!(limit);
    }
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(realise, maps, limit.as_ref(), &inputs.results, context)
    };
    let planned = Planned::new(parameters, run);
    let isotropic = realise.is_isotropic();
    Some(
        planned
            .reading_if(!alone, WAVES)
            .reading_if(alone, AREAL_PARAMETERS)
            .reading_if(realise.has_windows() || isotropic, SCANS)
            .reading_if(maps && realise.names_windows(), MAPS)
            .reading_if(isotropic, ISOTROPIC),
    )
}

/// Most realisations for a `tolerance`, unless the recipe says otherwise.
pub(crate) const MOST_REALISATIONS: u32 = 1000;

/// The realised waves: `surfaces.arrow`.
pub const SURFACES: Table<SurfaceRow> = Table::new("realise", "surfaces.arrow");

/// One wave `D sin(2 π x / λ + φ)` of a realised surface. SI units, so that the surface reads back
/// to the last bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurfaceRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Number of this wave, from the shortest, starting at 1.
    pub scale: u32,
    /// Wavelength λ.
    #[schemars(extend("unit" = "m"))]
    pub wavelength_m: f64,
    /// Amplitude D.
    #[schemars(extend("unit" = "m"))]
    pub amplitude_m: f64,
    /// Phase φ.
    #[schemars(extend("unit" = "rad"))]
    pub phase_rad: f64,
}

impl Row for SurfaceRow {
    const SCHEMA: &'static str = "asperity.realise.surfaces";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![SURFACES.schema(), PROFILES.schema(), AREAL_SURFACES.schema(), AREAL.schema()]
}

/// Makes the surfaces and writes them; returns warnings. `limit` tells the shortest wavelength where maps stand alone.
///
/// Approximations whose surfaces are the same (`same_surfaces`) are realised once, under the number of waves that
/// the recipe names first.
///
/// # Errors
/// [`StageError::NoWaves`] for an approximation without a wave of positive amplitude; [`StageError::Periodic`] where no
/// window can be made periodic; those of maps.
pub fn run(
    parameters: &Realise,
    maps: bool,
    limit: Option<&MapLimit>,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    // Maps that stand alone have no fit.
    let fitted = if limit.is_some() { Vec::new() } else { run.rows(WAVES)? };
    let seed = parameters.seed.unwrap_or_default();
    let (mut rows, mut realised) = (Vec::new(), Vec::<u32>::new());
    let mut warnings = parameters.idle_keys(maps);
    let shortest = match (parameters.shortest_wavelength_mm, limit) {
        (Some(own_mm), _) => own_mm,
        (None, Some(limit)) => limit.shortest_mm(run)?,
        (None, None) => fitted.iter().map(|row| row.wavelength_mm).fold(f64::INFINITY, f64::min),
    }
    .mm_to_m();
    if parameters.has_windows() {
        let windows = read_windows(run)?;
        let (surfaces, profiles, told) = profiles::of_windows(parameters, &windows, shortest)?;
        for surface in surfaces {
            let (kind, realisation) = (surface.kind, surface.realisation);
            rows.extend(surface_rows(kind, realisation, surface.profile));
        }
        context.pending.write_rows(PROFILES, &profiles)?;
        warnings.extend(told);
    }
    // Without the method there are none.
    for &waves in &parameters.waves {
        if let Some(other) = realised.iter().find(|other| same_surfaces(&fitted, **other, waves)) {
            warnings.push(format!(
                "{waves} waves: the surfaces are those of {other} waves, because the other waves have no \
                 amplitude; they are solved and shown once, as {other} waves"
            ));
            continue;
        }
        realised.push(waves);
        let scales = scales_of(&fitted, waves);
        if scales.iter().all(|scale| scale.amplitude == 0.0) {
            return Err(StageError::NoWaves { waves });
        }
        for realisation in 1..=parameters.drawn() {
            let surface = random_phases(&scales, seed, u64::from(realisation));
            rows.extend(surface_rows(SurfaceKind::sines(waves), realisation, surface));
        }
    }
    context.pending.write_rows(SURFACES, &rows)?;
    warnings.extend(write_areal(parameters, maps, shortest, run, context)?);
    Ok(warnings)
}

/// Makes the areal surfaces and writes them; returns warnings.
fn write_areal(
    parameters: &Realise,
    maps: bool,
    shortest: f64,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let (mut surfaces, mut rows, mut warnings) = areal::ArealSurfaces::default();
    if maps && parameters.names_windows() {
        (surfaces, rows, warnings) = areal::of_maps(parameters, read_maps(run)?, shortest)?;
    }
    if parameters.is_isotropic() {
        let (windows, spectrum) = (read_windows(run)?, run.rows(ISOTROPIC)?);
        let (more, their_rows, told) =
            isotropic::isotropic(parameters, &windows, &spectrum, shortest)?;
        surfaces.extend(more);
        rows.extend(their_rows);
        warnings.extend(told);
    }
    if surfaces.is_empty() {
        return Ok(warnings);
    }
    context.pending.write_rows(AREAL_SURFACES, &rows)?;
    let datasets: Vec<_> = surfaces.into_iter().map(areal::dataset).collect();
    context.pending.write_arrays(AREAL, Storage::Plain, &datasets)?;
    Ok(warnings)
}

fn surface_rows(
    kind: SurfaceKind,
    realisation: u32,
    profile: Vec<Wave>,
) -> impl Iterator<Item = SurfaceRow> {
    (1..).zip(profile).map(move |(scale, wave)| SurfaceRow {
        kind,
        realisation,
        scale,
        wavelength_m: wave.wavelength,
        amplitude_m: wave.amplitude,
        phase_rad: wave.phase,
    })
}

fn scales_of(fitted: &[ScaleRow], waves: u32) -> Vec<SineScale> {
    let own = fitted.iter().filter(|row| row.waves == waves);
    own.map(|row| SineScale {
        wavelength: row.wavelength_mm.mm_to_m(),
        amplitude: row.amplitude_mm.mm_to_m(),
    })
    .collect()
}

/// Two fits that end in the same waves differ by round-off.
const ROUND_OFF: f64 = 1e-9;

/// Whether the surfaces of two numbers of waves are the same: the waves of the one are the first ones of the
/// other, to round-off, and the others of it have no amplitude. Phases are drawn from the shortest wave on, so
/// that the same waves have the same phases.
pub(crate) fn same_surfaces(fitted: &[ScaleRow], left: u32, right: u32) -> bool {
    let (left, right) = (scales_of(fitted, left), scales_of(fitted, right));
    let close = |a: f64, b: f64| (a - b).abs() <= ROUND_OFF * a.abs().max(b.abs());
    let same = left
        .iter()
        .zip(&right)
        .all(|(a, b)| close(a.wavelength, b.wavelength) && close(a.amplitude, b.amplitude));
    let shared = left.len().min(right.len());
    let rest = left[shared..].iter().chain(&right[shared..]);
    shared > 0 && same && rest.into_iter().all(|scale| scale.amplitude == 0.0)
}

/// A realised surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Its waves, by ascending wavelength.
    pub profile: Vec<Wave>,
}

impl Surface {
    /// What is solved on it, for messages: `bem, 8 waves, realisation 3, 10 mm/s`.
    pub(crate) fn name_at(&self, stage: &str, speed_mm_s: f64) -> String {
        let Self { kind, realisation, .. } = self;
        format!("{stage}, {kind}, realisation {realisation}, {speed_mm_s} mm/s")
    }

    /// The period in m: the longest wavelength with an amplitude if it is a multiple of all others that
    /// have one, else the longest of all, which always is. A wave without amplitude needs no room.
    pub fn period(&self) -> f64 {
        let longest = |waves: &mut dyn Iterator<Item = &Wave>| {
            waves.map(|wave| wave.wavelength).fold(0.0, f64::max)
        };
        let present = || self.profile.iter().filter(|wave| wave.amplitude != 0.0);
        let candidate = longest(&mut present());
        let divides = |wave: &Wave| {
            let count = candidate / wave.wavelength;
            (count - count.round()).abs() <= 1e-9 * count
        };
        if candidate > 0.0 && present().all(divides) {
            return candidate;
        }
        longest(&mut self.profile.iter())
    }
}

/// Reads the surfaces of a run.
///
/// # Errors
/// Those of the store.
pub fn read_surfaces(run: &RunView) -> Result<Vec<Surface>, StageError> {
    let rows = run.rows(SURFACES)?;
    let same = |a: &SurfaceRow, b: &SurfaceRow| (a.kind, a.realisation) == (b.kind, b.realisation);
    let surface = |rows: &[SurfaceRow]| Surface {
        kind: rows[0].kind,
        realisation: rows[0].realisation,
        profile: rows
            .iter()
            .map(|row| Wave {
                wavelength: row.wavelength_m,
                amplitude: row.amplitude_m,
                phase: row.phase_rad,
            })
            .collect(),
    };
    Ok(rows.chunk_by(same).map(surface).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_without_amplitude_at_the_end_makes_no_other_surface() {
        let row = |waves: u32, scale: u32, amplitude_mm: f64| ScaleRow {
            waves,
            scale,
            wavelength_mm: f64::from(1 << scale),
            amplitude_mm,
            amplitude_confidence_95_mm: None,
            rms_slope: 0.0,
        };
        let fitted = [
            row(2, 1, 0.1),
            row(2, 2, 0.2),
            row(3, 1, 0.1 * (1.0 + 1e-14)),
            row(3, 2, 0.2),
            row(3, 3, 0.0),
            row(4, 1, 0.1),
            row(4, 2, 0.0),
            row(4, 3, 0.2),
        ];
        assert!(same_surfaces(&fitted, 2, 3) && same_surfaces(&fitted, 3, 2));
        assert!(!same_surfaces(&fitted, 2, 4) && !same_surfaces(&fitted, 3, 4));
        assert!(!same_surfaces(&fitted, 2, 5), "no such fit");
    }

    #[test]
    fn the_period_is_that_of_the_waves_that_are_there() {
        let period = |waves: &[(f64, f64)]| {
            let wave = |&(wavelength, amplitude)| Wave { wavelength, amplitude, phase: 0.3 };
            Surface {
                kind: SurfaceKind::sines(3),
                realisation: 1,
                profile: waves.iter().map(wave).collect(),
            }
            .period()
        };
        assert_eq!(period(&[(1.0, 0.1), (2.0, 0.1), (4.0, 0.1)]), 4.0);
        assert_eq!(period(&[(1.0, 0.1), (2.0, 0.1), (4.0, 0.0)]), 2.0);
        // Two and three have only six in common.
        assert_eq!(period(&[(2.0, 0.1), (3.0, 0.1), (6.0, 0.0)]), 6.0);
        assert_eq!(period(&[(1.0, 0.0), (2.0, 0.0)]), 2.0);
    }
}
