//! realise: the surfaces that stand for the road: its windows as they are, windows with other phases, and the fitted
//! sines with random phases.
//!
//! | module | what it holds |
//! |---|---|
//! | `areal` | areal surfaces: of maps, and isotropic ones of lines |
//! | `kind` | how surfaces are made of a road, and what tables call them |
//! | `profiles` | surfaces of the windows of the scans |

mod areal;
mod kind;
mod profiles;

use super::approximate::{ScaleRow, WAVES};
use super::characterise::ISOTROPIC;
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::ingest::{MAPS, SCANS, read_maps, read_windows};
use super::{Stage, StageError};
use crate::artifact::{Row, RunView, SchemaVersion, Storage, Table};
use crate::requirement::{InvalidRecipe, require};
use crate::surface::realisation::random_phases;
use crate::surface::{Closure, SineScale, Wave};
use crate::units::Units;
pub use areal::{AREAL, AREAL_SURFACES, ArealRow, ArealSurface, areal_schema, read_areal_surfaces};
pub use kind::{Method, SurfaceKind};
pub(crate) use profiles::LONGEST_GAP;
#[cfg(test)]
pub(crate) use profiles::rms_slope;
pub use profiles::{PROFILES, ProfileRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

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
    let run =
        move |inputs: &Inputs, context: &mut Context| run(realise, maps, &inputs.results, context);
    let planned = Planned::new(json!(realise), run).reading(WAVES);
    let isotropic = realise.is_isotropic();
    Some(
        planned
            .reading_if(realise.has_windows() || isotropic, SCANS)
            .reading_if(maps && realise.names_windows(), MAPS)
            .reading_if(isotropic, ISOTROPIC),
    )
}

/// Section `[realise]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Realise {
    /// How surfaces are made of the road, in one way or several: `measured`, every window of the scans made periodic;
    /// `matched`, the spectrum and the heights of a window with other phases; `random-phase`, its spectrum with random
    /// phases; `sines`, the fitted sines with random phases; `isotropic`, areal surfaces of random phases whose lines have the
    /// averaged spectrum of the scans. Where maps are kept (`[ingest.maps]`), the first three make areal surfaces of them too.
    #[serde(default = "sines_alone", skip_serializing_if = "is_sines_alone")]
    pub methods: Vec<Method>,
    /// Whether the line scans make surfaces too where maps are kept.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub profiles: bool,
    /// Number of areal surfaces that are drawn of each method; that of `realisations`, at most 8, if not set: an areal surface
    /// has far less scatter than a profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub areal_realisations: Option<u32>,
    /// Period in mm of isotropic surfaces; the length of a window of the scans if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub isotropic_period_mm: Option<f64>,
    /// Directions in which the rubber slides over `measured` windows: a road is not the same in both.
    #[serde(default = "forward_alone", skip_serializing_if = "is_forward_alone")]
    pub directions: Vec<Direction>,
    /// How a window is made periodic; `mirror` if not set, which makes both directions the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Closure>,
    /// Shortest wavelength in mm of the surfaces of windows; that of the fitted sines if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_wavelength_mm: Option<f64>,
    /// Longest gap in mm that is filled by a straight line; windows with longer ones are left out. Eight shortest
    /// wavelengths if not set. What was filled stands in the table of the profiles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_gap_mm: Option<f64>,
    /// Most windows that are taken, the first ones; all if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_windows: Option<u32>,
    /// Numbers of waves of the approximations to realise, out of `approximate.waves`; for `sines`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waves: Vec<u32>,
    /// Number of realisations; the average is over them. `measured` has as many as there are windows. Where the recipe
    /// has a `tolerance`, their number follows from it and not from this key, which may then be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub realisations: Option<u32>,
    /// Most realisations that a `tolerance` may take, 1000 if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_realisations: Option<u32>,
    /// Seed of the phases: same seed, same surfaces, on every machine. Left out beside `sweep.seeds`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

impl Realise {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        self.check_methods()?;
        let keys = [
            ("realise.realisations", self.realisations),
            ("realise.most_realisations", self.most_realisations),
            ("realise.areal_realisations", self.areal_realisations),
        ];
        for (key, count) in keys.into_iter().filter_map(|(key, count)| Some((key, count?))) {
            require((1..=100_000).contains(&count), key, count, "1 to 100000")?;
        }
        let (lines, maps) = (self.drawn() > 0, self.areal_drawn() > 0);
        let is_drawn = |method: &Method| match method {
            Method::Measured => true,
            Method::Sines => lines,
            Method::Isotropic => maps,
            _ => lines || maps && !self.profiles,
        };
        if !self.methods.iter().all(is_drawn) {
            let advice = "give a number of surfaces, or a `tolerance` that it follows from";
            return Err(InvalidRecipe::Missing { key: "realise.realisations", advice });
        }
        // TOML's integers are signed.
        let seed = self.seed.unwrap_or_default();
        require(seed < 1 << 63, "realise.seed", seed, "below 2^63")
    }

    fn check_methods(&self) -> Result<(), InvalidRecipe> {
        let names = |methods: &[Method]| methods.iter().map(|m| m.name()).collect::<Vec<_>>();
        let methods = &self.methods;
        let once = methods.iter().enumerate().all(|(i, a)| !methods[..i].contains(a));
        let known = methods.iter().all(|method| method.is_a_choice());
        let wanted = "one or several of measured, matched, random-phase, sines and isotropic, each once \
                      (directions: realise.directions; areal surfaces of maps: a section [ingest.maps])";
        let valid = !methods.is_empty() && once && known;
        require(valid, "realise.methods", names(methods), wanted)?;
        let sines = methods.contains(&Method::Sines);
        let wanted = "at least one number for the method sines, or none without it";
        require(sines != self.waves.is_empty(), "realise.waves", &self.waves, wanted)?;
        let directions = &self.directions;
        let once = directions.iter().enumerate().all(|(i, a)| !directions[..i].contains(a));
        let wanted = "forward, backward or both, each once";
        require(once && !directions.is_empty(), "realise.directions", directions, wanted)?;
        let mirrored = self.periodic.unwrap_or_default() == Closure::Mirror;
        let wanted = "forward alone where windows are mirrored, which makes both directions the same: set \
                      realise.periodic = \"blend\"";
        let backward = directions.contains(&Direction::Backward);
        require(!backward || !mirrored, "realise.directions", directions, wanted)?;
        let wanted = "left out unless realise.methods names measured";
        let measured = methods.contains(&Method::Measured);
        require(measured || !backward, "realise.directions", directions, wanted)?;
        let lengths = [
            ("realise.shortest_wavelength_mm", self.shortest_wavelength_mm),
            ("realise.longest_gap_mm", self.longest_gap_mm),
        ];
        for (key, length) in lengths.into_iter().filter_map(|(key, mm)| Some((key, mm?))) {
            require(length > 0.0 && length.is_finite(), key, length, "positive and finite")?;
            let wanted = "left out unless realise.methods has surfaces of windows";
            require(self.names_windows() || self.is_isotropic(), key, length, wanted)?;
        }
        if let Some(period) = self.isotropic_period_mm {
            let key = "realise.isotropic_period_mm";
            let wanted = "positive, and left out unless realise.methods names isotropic";
            require(
                period > 0.0 && period.is_finite() && self.is_isotropic(),
                key,
                period,
                wanted,
            )?;
        }
        let windows = self.most_windows.unwrap_or(1);
        require(windows > 0, "realise.most_windows", windows, "1 or more")
    }

    /// Whether there are profiles of windows of the scans.
    pub fn has_windows(&self) -> bool {
        self.profiles && self.names_windows()
    }

    /// Whether a method makes surfaces of windows, of line scans or of maps.
    pub fn names_windows(&self) -> bool {
        self.methods.iter().any(|method| method.of_a_window())
    }

    /// Whether there are isotropic areal surfaces.
    pub fn is_isotropic(&self) -> bool {
        self.methods.contains(&Method::Isotropic)
    }

    /// Whether there are surfaces whose phases are drawn.
    pub(crate) fn draws(&self) -> bool {
        self.methods.iter().any(|method| *method != Method::Measured)
    }

    /// Number of surfaces that are drawn: as many as there may be need of. To draw one costs nothing.
    pub fn drawn(&self) -> u32 {
        self.most_realisations.or(self.realisations).unwrap_or(0)
    }

    /// Number of areal surfaces that are drawn of each method.
    pub fn areal_drawn(&self) -> u32 {
        self.areal_realisations.unwrap_or(self.drawn().min(MOST_AREAL))
    }
}

/// Most areal surfaces that are drawn unless the recipe says otherwise.
const MOST_AREAL: u32 = 8;

fn yes() -> bool {
    true
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_yes(flag: &bool) -> bool {
    *flag
}

fn sines_alone() -> Vec<Method> {
    vec![Method::Sines]
}

fn is_sines_alone(methods: &[Method]) -> bool {
    methods == [Method::Sines]
}

fn forward_alone() -> Vec<Direction> {
    vec![Direction::Forward]
}

fn is_forward_alone(directions: &[Direction]) -> bool {
    directions == [Direction::Forward]
}

/// The direction in which rubber slides over a measured window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// As the positions of the scan ascend.
    Forward,
    /// The other way.
    Backward,
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

/// Makes the surfaces and writes them; returns warnings.
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
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let fitted = run.rows(WAVES)?;
    let seed = parameters.seed.unwrap_or_default();
    let (mut rows, mut realised, mut warnings) = (Vec::new(), Vec::<u32>::new(), Vec::new());
    let fitted_mm = fitted.iter().map(|row| row.wavelength_mm).fold(f64::INFINITY, f64::min);
    let shortest = parameters.shortest_wavelength_mm.unwrap_or(fitted_mm).mm_to_m();
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
        let (more, their_rows, told) = areal::isotropic(parameters, &windows, &spectrum, shortest)?;
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
