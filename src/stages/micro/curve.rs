//! One microscale at one speed, sampled as densely as the tolerance needs.

use super::{COLUMNS_KEY, LawRow, Micro, Owner, SampleRow, Task};
use crate::artifact::{ArtifactError, Digest, SolveStore};
use crate::contact::{ContactSolution, SlidingContact};
use crate::fem::error::{FemError, PathEnd};
use crate::fem::profile::RigidProfile;
use crate::fem::steady::{BlockOptions, COLUMNS_RANGE, SteadyContact};
use crate::multiscale::sampling::{geometric, interpolation_errors, refinement};
use crate::multiscale::{LawEnd, LocalLaw};
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;
use crate::stages::SolveError;
use crate::stages::kept::{self, Kept, KeptPath};
use crate::surface::wave;
use crate::units::Units;
use serde_json::{Value, json};

/// Revision of the solvers: part of the key of every stored solve.
const SOLVER_REVISION: u32 = 6;
/// Grid points of the half-space on the shortest wave.
const POINTS_PER_WAVE: f64 = 1024.0;
/// Samples of the repulsive law up to full contact, at `p* (0.1 + 0.9 t)^4`: see [`LocalLaw`].
const LAW_SAMPLES: usize = 40;
/// Elements in contact at the smallest pressure that is sampled: fewer give no friction worth the
/// name.
const FEWEST_CONTACT_ELEMENTS: f64 = 4.0;
/// Ratio of the first samples.
const FIRST_RATIO: f64 = 1.6;
/// Rounds of refinement; each halves the steps where it is needed.
const MOST_ROUNDS: usize = 4;
/// Sampled beyond the largest local pressure, so that no macro contact misses it by round-off.
const MARGIN: f64 = 1.02;

pub(super) struct MicroCurve<'a> {
    parameters: &'a Micro,
    rubber: &'a RubberModel,
    task: &'a Task,
    store: &'a SolveStore,
    interrupted: &'a Interrupt,
    columns: usize,
    half_space: HalfSpace<'a>,
    path: KeptPath<'a, SetUp<'a>>,
}

/// Sets up the contact at finite deformation.
type SetUp<'a> = Box<dyn Fn() -> Result<SteadyContact, FemError> + 'a>;

/// The microscale on the half-space.
struct HalfSpace<'a> {
    rubber: &'a RubberModel,
    task: &'a Task,
    period: f64,
    interrupted: &'a Interrupt,
    /// Set up when first needed.
    contact: Option<SlidingContact>,
}

impl<'a> MicroCurve<'a> {
    pub fn new(
        parameters: &'a Micro,
        rubber: &'a RubberModel,
        task: &'a Task,
        store: &'a SolveStore,
        interrupted: &'a Interrupt,
    ) -> Result<Self, ArtifactError> {
        let columns = task.columns(parameters);
        Self::on(columns, parameters, rubber, task, store, interrupted)
    }

    fn on(
        columns: usize,
        parameters: &'a Micro,
        rubber: &'a RubberModel,
        task: &'a Task,
        store: &'a SolveStore,
        interrupted: &'a Interrupt,
    ) -> Result<Self, ArtifactError> {
        let period = task.period();
        let kept = Kept::open(store, problem(parameters, rubber, task, columns), interrupted)?;
        let set_up: SetUp = Box::new(move || {
            let profile = RigidProfile::from_waves(&task.micro, period);
            let options = BlockOptions::of_profile(columns, &profile);
            let rubber = rubber.maxwell()?;
            let (law, speed) = (rubber.finite_strain, task.speed_mm_s.mm_to_m());
            let contact = SteadyContact::new(rubber, law, speed, profile, options)?;
            let contact = match parameters.contact_length_mm {
                Some(length) => contact.lasting(length.mm_to_m()),
                None => contact,
            };
            Ok(contact.interruptible(interrupted))
        });
        Ok(Self {
            parameters,
            rubber,
            task,
            store,
            interrupted,
            columns,
            half_space: HalfSpace { rubber, task, period, interrupted, contact: None },
            path: KeptPath::new(kept, columns, set_up),
        })
    }

    /// Notes that every sample of a task is stored.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.path.finish(task)
    }

    /// The repulsive law of the half-space up to full contact.
    pub fn law(&mut self) -> Result<(LocalLaw, Vec<LawRow>), SolveError> {
        let heights = self.half_space.heights();
        let touch_separation_m = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - heights.iter().sum::<f64>() / heights.len() as f64;
        let full = self.half_space.contact()?.smallest_full_contact_pressure();
        let (Owner { kind, realisation, stretch }, speed_mm_s) =
            (self.task.owners[0], self.task.speed_mm_s);
        let mut rows = Vec::with_capacity(LAW_SAMPLES);
        for k in 0..LAW_SAMPLES {
            let t = k as f64 / (LAW_SAMPLES - 1) as f64;
            let pressure_pa = full * (0.1 + 0.9 * t).powi(4);
            let separation_m = if k + 1 < LAW_SAMPLES {
                self.half_space.at(pressure_pa)?.mean_separation
            } else {
                0.0
            };
            rows.push(LawRow {
                kind,
                realisation,
                stretch,
                speed_mm_s,
                touch_separation_m,
                pressure_pa,
                separation_m,
            });
        }
        Ok((law_of(&rows)?, rows))
    }

    /// Samples from the first contact that the mesh resolves up to `largest` in Pa, or as far as
    /// there are solutions, with a warning then; none if there is none at the first.
    pub fn sample(&mut self, largest: f64) -> Result<(Vec<SampleRow>, Option<String>), SolveError> {
        let first = self.first_pressure(largest)?;
        let mut rows: Vec<SampleRow> = Vec::new();
        let mut warning = None;
        for pressure in geometric(first, MARGIN * largest.max(first), FIRST_RATIO) {
            match self.row(pressure) {
                Ok(row) => rows.push(row),
                Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => {
                    rows.extend(self.last_on_path(&error, &rows)?);
                    let (owners, speed_mm_s) = (self.task.owner_names(), self.task.speed_mm_s);
                    let reached = match rows.last() {
                        Some(SampleRow { pressure_mpa, .. }) => {
                            format!(
                                "is sampled up to {pressure_mpa:.3} MPa of {:.3}",
                                largest.pa_to_mpa()
                            )
                        }
                        None => "has not one sample".into(),
                    };
                    warning = Some(format!(
                        "{owners}, {speed_mm_s} mm/s: the microscale {reached}: {error}; try \
                         another {COLUMNS_KEY}"
                    ));
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        for _ in 0..MOST_ROUNDS {
            let more = self.refined(&mut rows);
            if more.is_empty() {
                break;
            }
            for pressure in more {
                // What cannot be solved between two solutions stays the error that it is.
                match self.row(pressure) {
                    Ok(row) => rows.push(row),
                    Err(SolveError::FiniteDeformation(FemError::PathEnded { .. })) => {}
                    Err(error) => return Err(error),
                }
            }
            rows.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        }
        self.refined(&mut rows);
        Ok((rows, warning))
    }

    /// Writes the errors by the mesh into the rows, from the same pressures on half the columns.
    ///
    /// Friction converges with the square of the columns, so that the difference is three times the error;
    /// where contact edges fall between nodes it is small by chance now and then, so the larger ones of the
    /// neighbouring samples count too. Beyond the last solution on the coarser mesh there is none.
    pub fn estimate_mesh_error(&self, rows: &mut [SampleRow]) -> Result<(), SolveError> {
        let Self { parameters, rubber, task, store, interrupted, .. } = *self;
        let columns = (self.columns / 2).max(*COLUMNS_RANGE.start());
        let mut coarser = Self::on(columns, parameters, rubber, task, store, interrupted)?;
        let mut differences = Vec::with_capacity(rows.len());
        for row in rows.iter() {
            match coarser.row(row.pressure_mpa.mpa_to_pa()) {
                Ok(coarse) => differences.push(
                    (row.friction_finite_deformation - coarse.friction_finite_deformation).abs(),
                ),
                Err(SolveError::FiniteDeformation(FemError::PathEnded { .. })) => break,
                Err(error) => return Err(error),
            }
        }
        for (k, row) in rows.iter_mut().enumerate().take(differences.len()) {
            let about = k.saturating_sub(1)..differences.len().min(k + 2);
            row.discretisation_error = differences[about].iter().copied().reduce(f64::max);
        }
        Ok(())
    }

    /// The last point of a path that ended, if it is beyond the samples and is solved again.
    fn last_on_path(
        &mut self,
        error: &FemError,
        rows: &[SampleRow],
    ) -> Result<Option<SampleRow>, SolveError> {
        let FemError::PathEnded { reached: PathEnd::At { pressure, .. }, .. } = error else {
            return Ok(None);
        };
        let Some(last) = rows.last() else { return Ok(None) };
        // A contact below the first sample has too few elements.
        if *pressure <= 1.05e6 * last.pressure_mpa {
            return Ok(None);
        }
        match self.row(*pressure) {
            Ok(row) => Ok(Some(row)),
            Err(error) if error.is_no_solution() => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Writes the errors into the rows and returns the pressures in Pa that should be added.
    fn refined(&self, rows: &mut [SampleRow]) -> Vec<f64> {
        let pressures: Vec<f64> = rows.iter().map(|row| row.pressure_mpa.mpa_to_pa()).collect();
        let corrections: Vec<f64> = rows.iter().map(SampleRow::correction).collect();
        let friction = rows.iter().map(|row| row.friction_half_space).fold(0.0, f64::max);
        for (row, error) in rows.iter_mut().zip(interpolation_errors(&pressures, &corrections)) {
            row.interpolation_error = error;
        }
        refinement(&pressures, &[(&corrections, self.parameters.tolerance * friction)])
    }

    /// The smallest pressure at which enough elements touch, found on the half-space.
    fn first_pressure(&mut self, largest: f64) -> Result<f64, SolveError> {
        let wanted = FEWEST_CONTACT_ELEMENTS / self.columns as f64;
        let (mut low, mut high) = (1e-6 * largest, largest);
        if self.half_space.at(high)?.contact_area_fraction <= wanted {
            return Ok(largest);
        }
        while high > 1.02 * low {
            let middle = (low * high).sqrt();
            if self.half_space.at(middle)?.contact_area_fraction < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(high)
    }

    fn row(&mut self, pressure: f64) -> Result<SampleRow, SolveError> {
        let (Owner { kind, realisation, stretch }, speed_mm_s) =
            (self.task.owners[0], self.task.speed_mm_s);
        let half_space = &mut self.half_space;
        let row = self.path.at(pressure, |finite, seconds| {
            let half_space = half_space.at(pressure)?;
            Ok(SampleRow {
                kind,
                realisation,
                stretch,
                speed_mm_s,
                pressure_mpa: pressure.pa_to_mpa(),
                friction_half_space: half_space.friction_coefficient,
                friction_finite_deformation: finite.friction_coefficient,
                friction_from_heat: finite.hysteretic_friction,
                area_half_space: half_space.contact_area_fraction,
                area_finite_deformation: finite.contact_area_fraction,
                separation_half_space_mm: half_space.mean_separation.m_to_mm(),
                separation_finite_deformation_mm: finite.mean_separation.m_to_mm(),
                interpolation_error: 0.0,
                discretisation_error: None,
                residual: finite.residual,
                newton_steps: finite.newton_steps as u64,
                seconds,
            })
        })?;
        // Another approximation may have the same microscale.
        Ok(SampleRow { kind, realisation, stretch, ..row })
    }
}

impl HalfSpace<'_> {
    fn heights(&self) -> Vec<f64> {
        let shortest = self.task.micro.iter().map(|wave| wave.wavelength);
        let shortest = shortest.fold(self.period, f64::min);
        let points = (POINTS_PER_WAVE * self.period / shortest).round() as usize;
        wave::sample(&self.task.micro, self.period, points.next_power_of_two())
    }

    fn contact(&mut self) -> Result<&mut SlidingContact, SolveError> {
        let contact = match self.contact.take() {
            Some(contact) => contact,
            None => {
                let (speed, heights) = (self.task.speed_mm_s.mm_to_m(), self.heights());
                let Self { rubber, period, interrupted, .. } = *self;
                SlidingContact::new_interruptible(rubber, speed, period, &heights, interrupted)?
            }
        };
        Ok(self.contact.insert(contact))
    }

    fn at(&mut self, pressure: f64) -> Result<ContactSolution, SolveError> {
        Ok(self.contact()?.solve(pressure)?)
    }
}

/// What all samples of a microscale have in common.
pub(super) fn problem(
    parameters: &Micro,
    rubber: &RubberModel,
    task: &Task,
    columns: usize,
) -> Value {
    let mut problem = kept::problem_at_finite_deformation("micro", SOLVER_REVISION, rubber);
    problem["profile"] = json!(task.micro);
    problem["speed_mm_s"] = json!(task.speed_mm_s);
    problem["columns"] = json!(columns);
    if let Some(period) = task.period_m {
        problem["period_m"] = json!(period);
    }
    if let Some(length) = parameters.contact_length_mm {
        problem["contact_length_mm"] = json!(length);
    }
    problem
}

impl SampleRow {
    /// What finite deformation changes of the friction.
    pub fn correction(&self) -> f64 {
        self.friction_finite_deformation - self.friction_half_space
    }
}

/// The law of the rows of one microscale and speed.
pub(crate) fn law_of(rows: &[LawRow]) -> Result<LocalLaw, SolveError> {
    let touch = rows.first().map_or(0.0, |row| row.touch_separation_m);
    let pressures: Vec<f64> = rows.iter().map(|row| row.pressure_pa).collect();
    let separations: Vec<f64> = rows.iter().map(|row| row.separation_m).collect();
    Ok(LocalLaw::new(touch, &pressures, &separations, LawEnd::FullContact)?)
}
