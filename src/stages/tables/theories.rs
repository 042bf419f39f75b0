//! What older theories predict at the areas of the half-space.

use super::Model;
use crate::artifact::{Row, RunView, Table};
use crate::contact::ContactError;
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::{RubberError, RubberModel};
use crate::stages::StageError;
use crate::stages::bem::CurveRow;
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use crate::stages::realise::{Surface, read_surfaces};
use crate::surface::{SineScale, wave};
use crate::theory::{KlueppelHeinrich, Persson};
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the theories predict for each realisation: `theories.arrow`, where the recipe asks for any.
pub const THEORIES: Table<TheoryRow> = Table::new("tables", "theories.arrow");

/// A theory that needs no contact to be solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Theory {
    /// Persson: diffusion of the pressure from the long waves to the short ones.
    Persson,
    /// Klüppel and Heinrich: a layer as thick as the mean penetration.
    KlueppelHeinrich,
}

impl Theory {
    /// Its name among the models of the tables.
    pub fn model(self) -> Model {
        match self {
            Self::Persson => Model::Persson,
            Self::KlueppelHeinrich => Model::KlueppelHeinrich,
        }
    }
}

/// What the theories leave to be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TheoryConstants {
    /// Persson's γ, between 0 and 1: the share of the strain of full contact that is left in
    /// vanishing contact.
    pub persson_gamma: f64,
    /// Klüppel and Heinrich's b: thickness of the strained layer over the mean penetration depth. The
    /// theory does not say it; friction is in proportion to it.
    pub klueppel_heinrich_layer_ratio: f64,
}

impl Default for TheoryConstants {
    fn default() -> Self {
        Self { persson_gamma: 0.5, klueppel_heinrich_layer_ratio: 1.0 }
    }
}

impl TheoryConstants {
    pub(super) fn check(&self) -> Result<(), InvalidRecipe> {
        let gamma = self.persson_gamma;
        let key = "tables.theory_constants.persson_gamma";
        require((0.0..=1.0).contains(&gamma), key, gamma, "between 0 and 1")?;
        let ratio = self.klueppel_heinrich_layer_ratio;
        let key = "tables.theory_constants.klueppel_heinrich_layer_ratio";
        require((1e-6..=1e6).contains(&ratio), key, ratio, "between 1e-6 and 1e6")
    }

    /// A warning where friction stands for a constant that nobody has chosen.
    pub(super) fn warnings(&self, theories: &[Theory]) -> Vec<String> {
        let asked = theories.contains(&Theory::KlueppelHeinrich);
        let ratio = self.klueppel_heinrich_layer_ratio;
        let open = asked && ratio == Self::default().klueppel_heinrich_layer_ratio;
        let warning = format!(
            "klueppel-heinrich: the strained layer is taken {ratio} times as thick as the mean \
             penetration; the theory leaves this ratio to a fit, and its friction is in proportion \
             to it (tables.theory_constants.klueppel_heinrich_layer_ratio)"
        );
        open.then_some(warning).into_iter().collect()
    }

    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// What a theory predicts for one realisation at one contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TheoryRow {
    /// Theory: `persson` or `klueppel-heinrich`.
    pub model: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction of the theory.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure at which the theory has this area.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient of the theory at this pressure.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
}

impl Row for TheoryRow {
    const SCHEMA: &'static str = "asperity.tables.theories";
    const VERSION: u32 = 2;
}

/// The predictions of the theories for the surfaces, speeds and areas of the half-space, in its order.
///
/// # Errors
/// Those of the store.
pub(super) fn predictions(
    theories: &[Theory],
    constants: &TheoryConstants,
    rubber: &RubberModel,
    half_space: &[CurveRow],
    run: &RunView,
) -> Result<Vec<TheoryRow>, StageError> {
    let surfaces = read_surfaces(run)?;
    let mut rows = Vec::new();
    for &theory in theories {
        for curve in half_space.chunk_by(CurveRow::same_curve) {
            let first = &curve[0];
            let of_curve = |surface: &&Surface| surface.at(first.speed_mm_s) == first.curve();
            let Some(surface) = surfaces.iter().find(of_curve) else { continue };
            let speed = first.speed_mm_s.mm_to_m();
            let predict = prediction(theory, constants, rubber, surface, speed)
                .map_err(|source| no_modulus(theory, source))?;
            rows.extend(curve.iter().map(|row| {
                let (area, pressure, friction_coefficient) = predict(row);
                TheoryRow {
                    model: theory.model(),
                    kind: row.kind,
                    realisation: row.realisation,
                    speed_mm_s: row.speed_mm_s,
                    given: row.given,
                    contact_area_fraction: area,
                    pressure_mpa: pressure.pa_to_mpa(),
                    friction_coefficient,
                }
            }));
        }
    }
    Ok(rows)
}

/// Contact area fraction, mean pressure in Pa and friction coefficient at what a row is given for.
type Prediction = Box<dyn Fn(&CurveRow) -> (f64, f64, f64)>;

/// What a theory predicts on a surface.
///
/// # Errors
/// If the rubber has no modulus at the frequency of a wave.
fn prediction(
    theory: Theory,
    constants: &TheoryConstants,
    rubber: &RubberModel,
    surface: &Surface,
    speed: f64,
) -> Result<Prediction, RubberError> {
    let scale =
        |w: &crate::surface::Wave| SineScale { wavelength: w.wavelength, amplitude: w.amplitude };
    let scales: Vec<SineScale> = surface.profile.iter().map(scale).collect();
    Ok(match theory {
        Theory::Persson => {
            let theory = Persson::new(&scales, rubber, speed, constants.persson_gamma)?;
            Box::new(move |row| {
                let (area, pressure) = match row.given {
                    Given::Area => {
                        let area = row.contact_area_fraction;
                        (area, theory.mean_pressure(area))
                    }
                    Given::Pressure => {
                        let pressure = row.pressure_mpa.mpa_to_pa();
                        (theory.contact_area_fraction(pressure), pressure)
                    }
                };
                (area, pressure, theory.friction_coefficient(pressure))
            })
        }
        Theory::KlueppelHeinrich => {
            let (heights, ratio) = (heights(surface), constants.klueppel_heinrich_layer_ratio);
            let theory = KlueppelHeinrich::new(&scales, &heights, rubber, speed, ratio)?;
            Box::new(move |row| {
                let (area, pressure) = match row.given {
                    Given::Area => {
                        let area = row.contact_area_fraction;
                        (area, theory.mean_pressure(area))
                    }
                    Given::Pressure => {
                        let pressure = row.pressure_mpa.mpa_to_pa();
                        (theory.contact_area_fraction(pressure), pressure)
                    }
                };
                (area, pressure, theory.friction_coefficient())
            })
        }
    })
}

/// The error of a rubber without a modulus at a frequency that a theory asks for.
fn no_modulus(theory: Theory, source: RubberError) -> StageError {
    let source = Box::new(ContactError::Rubber(source).into());
    StageError::Solve { problem: theory.model().to_string(), source }
}

/// Samples on the shortest wave, for the distribution of heights.
const POINTS_PER_WAVE: f64 = 128.0;
/// Samples beyond which a distribution of heights is known well enough.
const MOST_POINTS: f64 = 1_048_576.0;

/// Heights in m at equal spacing over a period.
fn heights(surface: &Surface) -> Vec<f64> {
    let lengths = || surface.profile.iter().map(|wave| wave.wavelength);
    let period = lengths().fold(0.0, f64::max);
    let shortest = lengths().fold(period, f64::min);
    let points = (POINTS_PER_WAVE * period / shortest).min(MOST_POINTS);
    wave::sample(&surface.profile, period, points as usize)
}
