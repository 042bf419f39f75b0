//! Reads a set: the measured friction and, for every point, the predictions of the run and of the spectrum.

use crate::artifact::RunView;
use crate::error_kind::{ErrorKind, HasKind};
use crate::interface::{Fixed, MeasuredFriction, ShearLaw};
use crate::measurement::{
    Available, Beside, BesideError, Choice, Computed, ComputedError, MeasuredFile,
    MeasuredFileError, TemperatureError, Temperatures, beside, read_measured, read_spectrum,
};
use crate::recipe::{Recipe, Spectrum, Validation};
use crate::rubber::{FrequencyRange, RubberFileError, read_rubber_at};
use crate::stages::bem::Bem;
use crate::stages::feedback::Effect;
use crate::surface::spectrum::IsotropicSpectrum;
use crate::theory::{IsotropicPersson, PerssonError, PerssonOptions};
use crate::units::Units;
use serde::Serialize;
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Pressures that differ by less, relative, are the same.
const SAME_PRESSURE: f64 = 1e-3;

/// What makes a prediction, in words of the tables.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Label {
    /// Contact model.
    pub model: String,
    /// Surfaces.
    pub surfaces: String,
    /// What the contact does to the rubber: `none` for moduli at small strain and the temperature before sliding.
    pub effect: String,
}

/// One prediction for every measurement of a set.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// What makes it.
    pub label: Label,
    /// Shortest wavelength in mm of its surfaces, to which a shear stress belongs.
    pub shortest_wavelength_mm: f64,
    /// Hysteresis and contact area beside each measurement.
    pub values: Vec<Beside>,
}

/// Measured friction and every prediction beside it.
#[derive(Debug, Clone)]
pub struct Set {
    /// Title of its recipe.
    pub title: String,
    /// File of the measurement.
    pub measured: PathBuf,
    /// Lines of the measurements in it.
    pub lines: Vec<usize>,
    /// Temperature in °C of the computation.
    pub temperature_c: Option<f64>,
    /// Whether its measurements differ in temperature.
    pub several_temperatures: bool,
    /// Constants of the shear stress that are not fitted.
    pub fixed: Fixed,
    /// Temperature in °C at which the speed of the shear stress holds, if the recipe states it.
    pub reference_c: Option<f64>,
    /// The law of the section `[adhesion]` with its shortest wavelength in mm.
    pub given: Option<(ShearLaw, f64)>,
    /// The predictions.
    pub predictions: Vec<Prediction>,
    /// Predictions that could not be made, and why.
    pub left_out: Vec<String>,
    /// What a reader should know of the predictions by the spectrum, which no stage has warned of.
    pub warnings: Vec<String>,
}

/// Why a set cannot be judged.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A recipe without a measurement.
    #[error(
        "the recipe has no section [validation]: it names the measured friction (docs/validation.md)"
    )]
    NoSection,
    /// A recipe without a rubber.
    #[error("the recipe has no section [bem], whose rubber, temperature and pressures a set needs")]
    NoBem,
    /// Its measured friction.
    #[error(transparent)]
    Measured(#[from] MeasuredFileError),
    /// Its temperatures.
    #[error("{}: {source}", .path.display())]
    Temperature {
        /// File of the measurement.
        path: PathBuf,
        /// What is wrong.
        source: Box<TemperatureError>,
    },
    /// A measurement that the run does not cover.
    #[error("{}, line {line}: {source}", .path.display())]
    Beside {
        /// File of the measurement.
        path: PathBuf,
        /// Line of the measurement.
        line: usize,
        /// What is wrong.
        source: Box<BesideError>,
    },
    /// A pressure that is not known, or that the run does not have.
    #[error("{}, line {line}: {problem}", .path.display())]
    Pressure {
        /// File of the measurement.
        path: PathBuf,
        /// Line of the measurement.
        line: usize,
        /// What is wrong and what to do.
        problem: String,
    },
    /// What the run has.
    #[error(transparent)]
    Computed(#[from] ComputedError),
    /// The rubber.
    #[error(transparent)]
    Rubber(#[from] RubberFileError),
    /// The spectrum.
    #[error("{0}")]
    Spectrum(String),
    /// Persson's theory.
    #[error("Persson's theory on the spectrum {}: {source}", .path.display())]
    Theory {
        /// File of the spectrum.
        path: PathBuf,
        /// What is wrong.
        source: Box<PerssonError>,
    },
    /// A law that is none.
    #[error("section [adhesion]: {0}")]
    Adhesion(crate::interface::ShearError),
    /// Sets that cannot be told apart.
    #[error("two sets have the title `{title}`: give each recipe a title of its own")]
    SameTitle {
        /// The title.
        title: String,
    },
    /// Sets that cannot have a law in common.
    #[error(
        "the sets state different {key} in [validation]: give all of them the same, or judge them one by one"
    )]
    DifferentConstants {
        /// The key.
        key: &'static str,
    },
}

impl HasKind for ValidationError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoSection
            | Self::NoBem
            | Self::Pressure { .. }
            | Self::Spectrum(_)
            | Self::Adhesion(_)
            | Self::SameTitle { .. }
            | Self::DifferentConstants { .. } => ErrorKind::Input,
            Self::Measured(error) => error.kind(),
            Self::Temperature { source, .. } => source.kind(),
            Self::Beside { source, .. } => source.kind(),
            Self::Computed(error) => error.kind(),
            Self::Rubber(error) => error.kind(),
            Self::Theory { source, .. } => source.kind(),
        }
    }
}

impl Set {
    /// The measurement of a recipe and the predictions of its run, if it has one.
    ///
    /// # Errors
    /// [`ValidationError`], which names the file and the line of a measurement that the run does not cover.
    pub fn read(recipe: &Recipe, run: Option<&RunView>) -> Result<Self, ValidationError> {
        let validation = recipe.validation.as_ref().ok_or(ValidationError::NoSection)?;
        let bem = recipe.bem.as_ref().ok_or(ValidationError::NoBem)?;
        let file = read_measured(&validation.measured, &validation.columns)?;
        let path = validation.measured.clone();
        let stated =
            Temperatures::new(&file, validation.temperature_c, bem.temperature_c, &bem.rubber);
        let temperatures = stated.map_err(|source| ValidationError::Temperature {
            path: path.clone(),
            source: source.into(),
        })?;
        let measurement = Measurement { validation, bem, file, temperatures };
        let pressures = measurement.pressures()?;
        let (mut left_out, mut warnings) = (Vec::new(), Vec::new());
        let mut predictions = match run {
            Some(run) => measurement.of_run(run, &pressures, &mut left_out)?,
            None => Vec::new(),
        };
        if let Some(spectrum) = &validation.spectrum {
            match measurement.of_spectrum(spectrum, &pressures, &mut warnings) {
                Ok(prediction) => predictions.push(prediction),
                // Moduli may end before the waves do; the contacts of the run are not worse for it.
                Err(ValidationError::Theory { path, source })
                    if !predictions.is_empty()
                        && matches!(
                            *source,
                            PerssonError::Rubber(_) | PerssonError::NotConverged { .. }
                        ) =>
                {
                    left_out.push(ValidationError::Theory { path, source }.to_string());
                }
                Err(error) => return Err(error),
            }
        }
        let given = recipe.adhesion.as_ref().map(|section| -> Result<_, ValidationError> {
            let law = section.shear_law().map_err(ValidationError::Adhesion)?;
            Ok((law, section.shortest_wavelength_mm))
        });
        let Measurement { file, temperatures, .. } = measurement;
        Ok(Self {
            title: recipe.title.clone(),
            measured: path,
            lines: file.lines,
            temperature_c: temperatures.computed_c,
            several_temperatures: !temperatures.is_one(),
            fixed: validation.fixed(),
            reference_c: validation.reference_c,
            given: given.transpose()?,
            predictions,
            left_out,
            warnings,
        })
    }
}

/// What was measured, and under which conditions.
struct Measurement<'a> {
    validation: &'a Validation,
    bem: &'a Bem,
    file: MeasuredFile,
    temperatures: Temperatures,
}

impl Measurement<'_> {
    fn count(&self) -> usize {
        self.file.points.len()
    }

    /// The mean pressure in MPa of every measurement.
    fn pressures(&self) -> Result<Vec<f64>, ValidationError> {
        let own = match self.bem.pressures_mpa[..] {
            [one] => Some(one),
            _ => None,
        };
        let of = |index: usize| {
            let stated = self.file.points[index].pressure_mpa;
            stated.or(self.validation.pressure_mpa).or(own).ok_or_else(|| {
                self.pressure_problem(
                    index,
                    "its pressure is not stated, and the recipe has several: set validation.pressure_mpa".into(),
                )
            })
        };
        (0..self.count()).map(of).collect()
    }

    fn pressure_problem(&self, index: usize, problem: String) -> ValidationError {
        let (path, line) = (self.validation.measured.clone(), self.file.lines[index]);
        ValidationError::Pressure { path, line, problem }
    }

    /// The predictions of a run, in the order of its tables. Those with an effect may lack a speed at which a contact has no
    /// solution; they are left out then, and the reason is said.
    fn of_run(
        &self,
        run: &RunView,
        pressures: &[f64],
        left_out: &mut Vec<String>,
    ) -> Result<Vec<Prediction>, ValidationError> {
        let available = Computed::available(run)?;
        let mut kinds: Vec<Available> = Vec::new();
        // A cold contact is that of the tables without [feedback].
        for one in available.iter().filter(|one| one.effect != Some(Effect::Cold)) {
            let same = |known: &&Available| {
                (known.model, known.kind, known.effect) == (one.model, one.kind, one.effect)
            };
            if !kinds.iter().any(|known| same(&known)) {
                kinds.push(*one);
            }
        }
        let mut predictions = Vec::new();
        for one in &kinds {
            let label = Label {
                model: one.model.name().into(),
                surfaces: one.kind.to_string(),
                effect: one.effect.map_or("none", Effect::name).into(),
            };
            if one.effect.is_some_and(Effect::has_heat) && self.temperatures.differ() {
                left_out.push(format!(
                    "{label}: measurements are not at the temperature of the run, and heat does not shift with it: make a set of each"
                ));
                continue;
            }
            match self.prediction(run, one, &available, pressures) {
                Ok((shortest_wavelength_mm, values)) => {
                    predictions.push(Prediction { label, shortest_wavelength_mm, values });
                }
                Err(error @ ValidationError::Beside { .. }) if one.effect.is_some() => {
                    left_out.push(format!("{label}: {error}"));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(predictions)
    }

    /// The shortest wavelength in mm of one prediction of a run, and its values.
    fn prediction(
        &self,
        run: &RunView,
        Available { model, kind, effect, .. }: &Available,
        available: &[Available],
        pressures: &[f64],
    ) -> Result<(f64, Vec<Beside>), ValidationError> {
        let mut at_pressure: Vec<Computed> = Vec::new();
        let mut values = Vec::new();
        for (index, pressure) in pressures.iter().enumerate() {
            let same = |own: f64| (own / pressure - 1.0).abs() < SAME_PRESSURE;
            let place = match at_pressure.iter().position(|computed| same(computed.pressure_mpa)) {
                Some(place) => place,
                None if !available.iter().any(|own| same(own.pressure_mpa)) => {
                    return Err(self.pressure_problem(
                        index,
                        format!("the run has no friction at its pressure of {pressure} MPa: add it to bem.pressures_mpa"),
                    ));
                }
                None => {
                    at_pressure.push(Computed::read(
                        run,
                        Choice {
                            model: Some(*model),
                            kind: Some(*kind),
                            pressure_mpa: Some(*pressure),
                            effect: *effect,
                        },
                    )?);
                    at_pressure.len() - 1
                }
            };
            let found = beside(&self.file, index, &self.temperatures, &at_pressure[place]);
            let (path, line) = (self.validation.measured.clone(), self.file.lines[index]);
            let named =
                |source: BesideError| ValidationError::Beside { path, line, source: source.into() };
            values.push(found.map_err(named)?);
        }
        let shortest = at_pressure.iter().map(|computed| computed.shortest_wavelength_mm);
        Ok((shortest.fold(f64::INFINITY, f64::min), values))
    }

    /// The lowest and highest wavenumber in rad/m that the theory takes of a spectrum.
    fn band(section: &Spectrum, spectrum: &IsotropicSpectrum) -> Result<[f64; 2], ValidationError> {
        let [longest, mut shortest] = spectrum.band();
        if let Some(mm) = section.shortest_wavelength_mm {
            let ends = [shortest, longest].map(|wavenumber| (TAU / wavenumber).m_to_mm());
            if !(ends[0] * (1.0 - 1e-5)..ends[1]).contains(&mm) {
                return Err(ValidationError::Spectrum(format!(
                    "{}: validation.spectrum.shortest_wavelength_mm = {mm}, and the spectrum has waves from {:.6} to {:.6} mm: stay \
                     within them; is wavenumber_unit right?",
                    section.file.display(),
                    ends[0],
                    ends[1]
                )));
            }
            shortest = (TAU / mm.mm_to_m()).min(shortest);
        }
        Ok([longest, shortest])
    }

    fn options(section: &Spectrum) -> PerssonOptions {
        PerssonOptions {
            gamma: section.gamma,
            diffusion: section.diffusion.into(),
            ..PerssonOptions::default()
        }
    }

    /// The prediction of Persson's theory on a spectrum. It takes any pressure and, of moduli that are held, any frequency.
    fn of_spectrum(
        &self,
        section: &Spectrum,
        pressures: &[f64],
        warnings: &mut Vec<String>,
    ) -> Result<Prediction, ValidationError> {
        let conventions = section.conventions().map_err(ValidationError::Spectrum)?;
        let (spectrum, _) =
            read_spectrum(&section.file, conventions).map_err(ValidationError::Spectrum)?;
        let [longest, shortest] = Self::band(section, &spectrum)?;
        let options = Self::options(section);
        let named = |source: PerssonError| ValidationError::Theory {
            path: section.file.clone(),
            source: source.into(),
        };
        let mut values = Vec::new();
        for (index, pressure) in pressures.iter().enumerate() {
            let point = &self.file.points[index];
            let temperature_c = self.temperatures.measured_c[index];
            // A rubber at the temperature of its file has no other one, and none is stated anywhere.
            let shifted = self.temperatures.computed_c.map(|_| temperature_c);
            let data = read_rubber_at(&self.bem.rubber, shifted)?;
            let theory =
                IsotropicPersson::new(&spectrum, &data.rubber, [longest, shortest], options)
                    .map_err(named)?;
            let speed = point.speed_mm_s.mm_to_m();
            let waves = [longest, shortest].map(|wavenumber| TAU / wavenumber);
            let line = self.file.lines[index];
            let beyond = data.extrapolations(FrequencyRange::excited(waves, [speed]));
            warnings.extend(beyond.into_iter().map(|warning| {
                format!("{}, line {line}: {warning}", self.validation.measured.display())
            }));
            let at = theory.at(speed, pressure.mpa_to_pa()).map_err(named)?;
            values.push(Beside {
                measured: MeasuredFriction {
                    speed,
                    temperature_c,
                    pressure: pressure.mpa_to_pa(),
                    friction: point.friction,
                    hysteretic: at.friction_coefficient,
                    contact_area_fraction: at.contact_area_fraction,
                },
                hysteretic_error: Some(at.errors.friction_coefficient),
                relative_area_error: Some(
                    at.errors.contact_area_fraction / at.contact_area_fraction,
                ),
            });
        }
        Ok(Prediction {
            label: Label {
                model: "persson".into(),
                surfaces: "isotropic, measured spectrum".into(),
                effect: "none".into(),
            },
            shortest_wavelength_mm: (TAU / shortest).m_to_mm(),
            values,
        })
    }
}
