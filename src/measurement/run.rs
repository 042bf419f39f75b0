//! Hysteretic friction and contact area of a run, over the speed at one pressure.

use crate::artifact::{ArtifactError, RunView};
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::interpolation::CubicHermite;
use crate::numerics::statistics::MeanEstimate;
use crate::stages::areal::AREAL_CURVES;
use crate::stages::bem::{CURVES, Given};
use crate::stages::feedback::{CONTACTS, Effect};
use crate::stages::friction::FrictionAt;
use crate::stages::realise::{PROFILES, SurfaceKind};
use crate::stages::tables::{EFFECTS, FRICTION, Model};
use std::collections::BTreeMap;

/// Pressures that differ by less, relative, are the same: tables state them with all digits, people with two.
const SAME_PRESSURE: f64 = 1e-3;

/// Which rows of a run are meant, where it has several.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choice {
    /// Contact model; the half-space if `None`.
    pub model: Option<Model>,
    /// Kind of surfaces; needed where the run has several.
    pub kind: Option<SurfaceKind>,
    /// Mean pressure in MPa; needed where the run has several.
    pub pressure_mpa: Option<f64>,
    /// What the contact does to its rubber, from the tables of `[feedback]`; `None` for those without.
    pub effect: Option<Effect>,
}

/// Friction and area of a run over the speed.
#[derive(Debug, Clone)]
pub struct Computed {
    /// Contact model.
    pub model: Model,
    /// Kind of surfaces.
    pub kind: SurfaceKind,
    /// Mean pressure in MPa.
    pub pressure_mpa: f64,
    /// Shortest wavelength of the surfaces in mm.
    pub shortest_wavelength_mm: f64,
    /// Lowest and highest speed in mm/s.
    pub speeds_mm_s: [f64; 2],
    friction: CubicHermite,
    ln_area: CubicHermite,
    error: Option<CubicHermite>,
    relative_area_error: Option<CubicHermite>,
}

/// What a run has at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComputedAt {
    /// Hysteretic friction coefficient.
    pub hysteretic: f64,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
    /// Estimated error of the hysteretic friction; `None` if that of one row is not known.
    pub error: Option<f64>,
    /// Relative error of the contact area: its 95 % interval by the windows, or by the realisations of sines, and its error by the grid;
    /// `None` where one of them is not known.
    pub relative_area_error: Option<f64>,
}

/// What a run has: a model, a kind of surfaces and a pressure, of which [`Computed::read`] takes one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Available {
    /// Contact model.
    pub model: Model,
    /// Kind of surfaces.
    pub kind: SurfaceKind,
    /// Mean pressure in MPa.
    pub pressure_mpa: f64,
    /// What the contact does to its rubber; `None` for the tables without `[feedback]`.
    pub effect: Option<Effect>,
}

/// An average of a run at a given pressure.
#[derive(Debug, Clone)]
struct Average {
    model: Model,
    kind: SurfaceKind,
    pressure_mpa: f64,
    effect: Option<Effect>,
    speed_mm_s: f64,
    shortest_wavelength_mm: f64,
    hysteretic: f64,
    contact_area_fraction: f64,
    error: Option<f64>,
}

/// All averages of a run at given pressures, those of `[feedback]` behind those without.
fn averages(run: &RunView) -> Result<Vec<Average>, ArtifactError> {
    let friction = run.rows(FRICTION)?.into_iter().filter(|row| row.given == Given::Pressure);
    let mut all: Vec<Average> = friction
        .map(|row| Average {
            model: row.model,
            kind: row.kind,
            pressure_mpa: row.pressure_mpa,
            effect: None,
            speed_mm_s: row.speed_mm_s,
            shortest_wavelength_mm: row.shortest_wavelength_mm,
            hysteretic: row.mean,
            contact_area_fraction: row.contact_area_fraction,
            error: row.error_estimate,
        })
        .collect();
    if run.has(EFFECTS)? {
        all.extend(run.rows(EFFECTS)?.into_iter().map(|row| Average {
            model: Model::Bem,
            kind: row.kind,
            pressure_mpa: row.pressure_mpa,
            effect: Some(row.effect),
            speed_mm_s: row.speed_mm_s,
            shortest_wavelength_mm: row.shortest_wavelength_mm,
            hysteretic: row.hysteretic,
            contact_area_fraction: row.contact_area_fraction,
            // Beside [adhesion], `error_estimate` is that of the total.
            error: row.confidence_95.zip(row.discretisation_error).map(|(a, b)| a + b),
        }));
    }
    Ok(all)
}

/// Why a run has nothing to compare with.
#[derive(Debug, thiserror::Error)]
pub enum ComputedError {
    /// The run folder.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// No row at a given pressure.
    #[error(
        "the run has no friction at a given pressure: set bem.pressures_mpa in its recipe to the pressure of the measurement, and run it again"
    )]
    NoPressure,
    /// Rows of several kinds.
    #[error("the run has several {what}: {found}; choose one with {option}")]
    Several {
        /// What there are several of.
        what: &'static str,
        /// Their names.
        found: String,
        /// The option that chooses.
        option: &'static str,
    },
    /// None of the kind asked for.
    #[error("the run has no {what} {asked}; it has {found}")]
    Missing {
        /// What is missing.
        what: &'static str,
        /// What was asked for.
        asked: String,
        /// What there is.
        found: String,
    },
    /// Fewer than two speeds.
    #[error(
        "the run has {count} speed(s), two are needed to interpolate: set bem.speeds_mm_s to cover the measured speeds"
    )]
    TooFewSpeeds {
        /// How many.
        count: usize,
    },
    /// A speed that the run does not cover.
    #[error(
        "the run covers {} to {} mm/s and has no friction at {speed_mm_s} mm/s{}: add speeds to bem.speeds_mm_s, and run it again",
        .range[0],
        .range[1],
        if *.shifted { " (the measured speed, shifted with the temperature)" } else { "" }
    )]
    OutsideSpeeds {
        /// The speed in mm/s.
        speed_mm_s: f64,
        /// Those of the run in mm/s.
        range: [f64; 2],
        /// Whether it was shifted with the temperature.
        shifted: bool,
    },
}

impl HasKind for ComputedError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Artifact(error) => error.kind(),
            Self::NoPressure
            | Self::Several { .. }
            | Self::Missing { .. }
            | Self::TooFewSpeeds { .. }
            | Self::OutsideSpeeds { .. } => ErrorKind::Input,
        }
    }
}

impl Computed {
    /// Reads the averages of a run.
    ///
    /// # Errors
    /// [`ComputedError`], which names the options that choose between several.
    pub fn read(run: &RunView, choice: Choice) -> Result<Self, ComputedError> {
        let mut rows = averages(run)?;
        rows.retain(|row| row.effect == choice.effect);
        if rows.is_empty() {
            return Err(ComputedError::NoPressure);
        }
        let model = choice.model.unwrap_or(Model::Bem);
        let rows = of(rows, "model", "--model", Some(model), |row| row.model, |a, b| a == b)?;
        let rows = of(
            rows,
            "kinds of surfaces",
            "--method and --waves",
            choice.kind,
            |row| row.kind,
            |a, b| a == b,
        )?;
        let same = |a: &f64, b: &f64| (a / b - 1.0).abs() < SAME_PRESSURE;
        let mut rows = of(
            rows,
            "pressures in MPa",
            "--pressure",
            choice.pressure_mpa,
            |row| row.pressure_mpa,
            same,
        )?;
        rows.sort_by(|a, b| a.speed_mm_s.total_cmp(&b.speed_mm_s));
        let [first, .., last] = &rows[..] else {
            return Err(ComputedError::TooFewSpeeds { count: rows.len() });
        };
        let over_speed = |values: Vec<f64>| {
            let speeds = rows.iter().map(|row| row.speed_mm_s.ln()).collect();
            CubicHermite::monotone_parabolas(speeds, values)
        };
        let curve = |value: fn(&Average) -> f64| over_speed(rows.iter().map(value).collect());
        let errors: Option<Vec<f64>> = rows.iter().map(|row| row.error).collect();
        let areas = Areas::read(run, first)?;
        let area_errors: Option<Vec<f64>> =
            rows.iter().map(|row| areas.relative_error(row)).collect();
        Ok(Self {
            model,
            kind: first.kind,
            pressure_mpa: first.pressure_mpa,
            shortest_wavelength_mm: first.shortest_wavelength_mm,
            speeds_mm_s: [first.speed_mm_s, last.speed_mm_s],
            friction: curve(|row| row.hysteretic),
            ln_area: curve(|row| row.contact_area_fraction.ln()),
            error: errors.map(over_speed),
            relative_area_error: area_errors.map(over_speed),
        })
    }

    /// What a run has at given pressures, in the order of its table.
    ///
    /// # Errors
    /// [`ComputedError::Artifact`].
    pub fn available(run: &RunView) -> Result<Vec<Available>, ComputedError> {
        let mut found: Vec<Available> = Vec::new();
        for row in averages(run)? {
            let Average { model, kind, pressure_mpa, effect, .. } = row;
            let new = Available { model, kind, pressure_mpa, effect };
            if !found.contains(&new) {
                found.push(new);
            }
        }
        Ok(found)
    }

    /// At a speed in mm/s, interpolated in its logarithm. `shifted` tells the message that the speed is that of another
    /// temperature.
    ///
    /// # Errors
    /// [`ComputedError::OutsideSpeeds`].
    pub fn at(&self, speed_mm_s: f64, shifted: bool) -> Result<ComputedAt, ComputedError> {
        let [lowest, highest] = self.speeds_mm_s;
        // A speed that was typed with fewer digits than the other is still the end of the range.
        let slack = 1.0 + 1e-3;
        if !(speed_mm_s * slack >= lowest && speed_mm_s <= highest * slack) {
            return Err(ComputedError::OutsideSpeeds {
                speed_mm_s,
                range: self.speeds_mm_s,
                shifted,
            });
        }
        let at = speed_mm_s.clamp(lowest, highest).ln();
        Ok(ComputedAt {
            hysteretic: self.friction.at(at),
            contact_area_fraction: self.ln_area.at(at).exp(),
            error: self.error.as_ref().map(|error| error.at(at)),
            relative_area_error: self.relative_area_error.as_ref().map(|error| error.at(at)),
        })
    }
}

/// Contact areas of every surface of one kind at given pressures.
struct Areas {
    values: Vec<FrictionAt>,
    /// The window of every surface of one.
    window_of: BTreeMap<u32, String>,
}

impl Areas {
    /// Reads the contact areas of all surfaces that an average was taken over; empty for models without a half-space solution.
    fn read(run: &RunView, of: &Average) -> Result<Self, ArtifactError> {
        let mut values: Vec<FrictionAt> = if let Some(effect) = of.effect {
            let rows = run.rows(CONTACTS)?;
            rows.iter().filter(|row| row.effect == effect).map(FrictionAt::from).collect()
        } else if !matches!(of.model, Model::Bem | Model::Hybrid) {
            Vec::new()
        } else if of.kind.method.is_areal() {
            let rows = run.rows(AREAL_CURVES)?;
            // One direction is that of the tables: the first.
            let first = rows.first().map(|row| row.angle_deg);
            rows.iter().filter(|row| Some(row.angle_deg) == first).map(FrictionAt::from).collect()
        } else {
            run.rows(CURVES)?.iter().map(FrictionAt::from).collect()
        };
        values.retain(|value| value.curve.kind == of.kind && value.given == Given::Pressure);
        let mut window_of = BTreeMap::new();
        if of.kind.method.of_a_window() && !of.kind.method.is_areal() {
            let rows = run.rows(PROFILES)?.into_iter().filter(|row| row.kind == of.kind);
            window_of = rows.map(|row| (row.realisation, row.window)).collect();
        }
        Ok(Self { values, window_of })
    }

    /// The 95 % interval of the mean area and its mean error by the grid, relative. Draws of one window count once.
    fn relative_error(&self, row: &Average) -> Option<f64> {
        let own = self.values.iter().filter(|value| {
            value.curve.speed_mm_s == row.speed_mm_s
                && (value.pressure_mpa / row.pressure_mpa - 1.0).abs() < SAME_PRESSURE
        });
        let mut by_window: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let (mut grid, mut count) = (0.0, 0.0);
        for value in own {
            let realisation = value.curve.realisation;
            let window = self.window_of.get(&realisation).cloned();
            let window = window.unwrap_or_else(|| realisation.to_string());
            by_window.entry(window).or_default().push(value.contact_area_fraction);
            grid += value.relative_area_error?;
            count += 1.0;
        }
        let means: Vec<f64> = by_window.values().map(|own| MeanEstimate::of(own).mean).collect();
        let estimate = MeanEstimate::of(&means);
        let error = estimate.confidence_95 / estimate.mean + grid / count;
        error.is_finite().then_some(error)
    }
}

/// The rows of one value of a property: the one asked for, or the only one there is.
fn of<T: Copy + PartialEq + std::fmt::Display>(
    rows: Vec<Average>,
    what: &'static str,
    option: &'static str,
    asked: Option<T>,
    property: impl Fn(&Average) -> T,
    same: impl Fn(&T, &T) -> bool,
) -> Result<Vec<Average>, ComputedError> {
    let mut found: Vec<T> = Vec::new();
    for row in &rows {
        let value = property(row);
        if !found.iter().any(|known| same(known, &value)) {
            found.push(value);
        }
    }
    let names = || found.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let chosen = match asked {
        Some(asked) if found.iter().any(|value| same(value, &asked)) => asked,
        Some(asked) => {
            return Err(ComputedError::Missing { what, asked: asked.to_string(), found: names() });
        }
        None if found.len() == 1 => found[0],
        None => return Err(ComputedError::Several { what, found: names(), option }),
    };
    Ok(rows.into_iter().filter(|row| same(&property(row), &chosen)).collect())
}
