//! Pressing in and dragging, with steps as long as they converge.

use super::block::TransientBlock;
use super::contact::Contact;
use super::error::{StepFailure, TransientError};
use super::options::{TransientOptions, positive};
use super::predictor::carried;
use super::setup::{check_mesh, first_touch, height_range};
use super::solution::{Counts, Energy, Sample, TransientSolution};
use super::step::{Load, State, Stepper};
use super::tangent::Tangent;
use crate::fem::error::BeyondLaw;
use crate::fem::mesh::Mesh;
use crate::fem::profile::RigidProfile;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use std::f64::consts::PI;

/// A failed step is halved down to this fraction of the longest one.
const SMALLEST_STEP: f64 = 1.0 / 4096.0;

/// A step with no more Newton iterations than this is followed by one twice as long.
const EASY_NEWTON: usize = 15;

/// A rubber block that is pressed onto a rigid periodic profile and dragged over it.
pub struct TransientContact {
    speed: f64,
    options: TransientOptions,
    press_time: f64,
    block: TransientBlock,
    stepper: Stepper,
    untouched: State,
}

/// A part of the motion with one limit for its steps; ends are hit exactly.
struct Phase {
    end: f64,
    longest_step: f64,
}

/// The run up to the last step.
struct Course {
    block: TransientBlock,
    state: State,
    samples: Vec<Sample>,
    counts: Counts,
    /// Motion of the lower edge over that of the upper one in the last step of the drag.
    following: f64,
    /// Distance in m, a multiple of the period, that is subtracted from the displacements of the state: after many
    /// periods the strains would be lost in the round-off of the displacements.
    left_out: f64,
}

impl Course {
    /// Subtracts the largest multiple of the period from a displacement; the profile is the same there.
    fn leave_out_periods(&mut self, displacement: f64) {
        let period = self.block.mesh().period;
        let distance = (displacement / period).floor() * period;
        if distance > 0.0 {
            self.state.nodes.iter_mut().step_by(2).for_each(|x| *x -= distance);
            self.left_out += distance;
        }
    }

    /// Adds the sample of a step from the state `old` to the present one.
    fn record(
        &mut self,
        old: &State,
        contact: &Contact,
        time: f64,
        load: Load,
        heat: f64,
    ) -> Sample {
        let last = self.samples[self.samples.len() - 1];
        let mesh = self.block.mesh();
        let row = 2 * mesh.columns;
        let distance = load.displacement - last.displacement;
        if distance > 0.0 {
            let moved = mean_along(&self.state.nodes[..row], 0) - mean_along(&old.nodes[..row], 0);
            self.following = (moved / distance).clamp(0.0, 1.0);
        }
        let upper = old.nodes.len() - row;
        let lowered =
            mean_along(&old.nodes[upper..], 1) - mean_along(&self.state.nodes[upper..], 1);
        let (force, _) = contact.resultants();
        let last_force = last.friction_coefficient * last.pressure * mesh.period;
        let mean_load = 0.5 * (last.pressure + load.pressure) * mesh.period;
        let sample = Sample {
            time,
            pressure: load.pressure,
            displacement: load.displacement,
            friction_coefficient: force / (load.pressure * mesh.period),
            contact_area_fraction: contact.area_fraction,
            mean_separation: contact.mean_separation,
            energy: Energy {
                drag_work: last.energy.drag_work + 0.5 * (last_force + force) * distance,
                load_work: last.energy.load_work + mean_load * lowered,
                dissipated: last.energy.dissipated + heat,
                stored: self.block.stored_energy(),
            },
        };
        self.samples.push(sample);
        self.counts.steps += 1;
        sample
    }
}

impl TransientContact {
    /// A block of `rubber` that slides at `speed` in m/s.
    ///
    /// At high pressure the block shears by about `μ p / G_inf`; a negative skew of the mesh, half
    /// to all of that, keeps its elements upright.
    ///
    /// # Errors
    /// [`TransientError::Rubber`], [`TransientError::OutOfRange`] and
    /// [`TransientError::PeriodMismatch`]; [`TransientError::TooLarge`].
    pub fn new(
        rubber: &Rubber,
        rheology: Rheology,
        speed: f64,
        profile: RigidProfile,
        mesh: Mesh,
        options: TransientOptions,
    ) -> Result<Self, TransientError> {
        options.validate()?;
        positive("the sliding speed in m/s", speed)?;
        let finite_strain = FiniteStrainRubber::new(rubber, rheology)?;
        check_mesh(&mesh, &profile)?;
        let press_time = options.press_time.unwrap_or_else(|| {
            let times = rubber.branches.iter().map(|branch| 5.0 * branch.relaxation_time);
            times.fold(mesh.period / speed, f64::max)
        });
        let spacing = mesh.spacing();
        let stiffness = rubber.reduced_modulus(PI * speed / spacing).norm() / spacing;
        let penalty = options.penalty_factor * stiffness;
        let untouched = first_touch(&mesh, &profile, penalty);
        let range = height_range(&profile, mesh.columns);
        let block = TransientBlock::new(mesh, finite_strain);
        let stepper = Stepper {
            profile,
            tangent: Tangent::new(&block)?,
            flow: options.flow,
            largest_violation: options.penetration_tolerance * range,
        };
        Ok(Self { speed, options, press_time, block, stepper, untouched })
    }

    /// Presses in with the nominal pressure in Pa and drags; `progress` sees every step.
    ///
    /// # Errors
    /// [`TransientError::OutOfRange`] for a pressure that is not positive and finite;
    /// [`TransientError::Stopped`] with all samples up to the step that failed.
    pub fn run(
        &self,
        pressure: f64,
        mut progress: impl FnMut(&Sample),
    ) -> Result<TransientSolution, TransientError> {
        positive("the nominal pressure in Pa", pressure)?;
        let mut course = Course {
            block: self.block.clone(),
            state: self.untouched.clone(),
            samples: vec![self.start()],
            counts: Counts::default(),
            following: 0.0,
            left_out: 0.0,
        };
        progress(&course.samples[0]);
        let mut averaged_from = 0;
        for phase in self.phases() {
            averaged_from = course.samples.len() - 1;
            self.run_phase(&mut course, &phase, pressure, &mut progress)?;
        }
        Ok(TransientSolution::new(course.samples, averaged_from, course.counts))
    }

    /// Pressing in, the drag up to the averaged part, the averaged part.
    fn phases(&self) -> [Phase; 3] {
        let mesh = self.block.mesh();
        let options = &self.options;
        let crossing = mesh.period / self.speed;
        let longest_step = crossing / options.steps_per_period.unwrap_or(mesh.columns) as f64;
        let after = |periods: usize| self.press_time + periods as f64 * crossing;
        [
            Phase {
                end: self.press_time,
                longest_step: self.press_time / options.press_steps as f64,
            },
            Phase { end: after(options.drag_periods - options.averaged_periods), longest_step },
            Phase { end: after(options.drag_periods), longest_step },
        ]
    }

    fn run_phase(
        &self,
        course: &mut Course,
        phase: &Phase,
        pressure: f64,
        progress: &mut impl FnMut(&Sample),
    ) -> Result<(), TransientError> {
        let mut limit = phase.longest_step;
        loop {
            let last = course.samples[course.samples.len() - 1];
            let rest = phase.end - last.time;
            if rest <= 1e-9 * phase.longest_step {
                return Ok(());
            }
            // Equal steps up to the end of the phase, without a tiny last one.
            let time_step = rest / (rest / limit - 1e-6).ceil().max(1.0);
            let before = course.counts.iterations.newton;
            match self.step(course, last.time + time_step, time_step, pressure) {
                Ok(sample) => {
                    progress(&sample);
                    if course.counts.iterations.newton - before <= EASY_NEWTON {
                        limit = (2.0 * limit).min(phase.longest_step);
                    }
                }
                Err(failure) => {
                    course.counts.rejected_steps += 1;
                    limit = 0.5 * time_step;
                    // A shorter step leads to the same strain.
                    let beyond = matches!(failure, StepFailure::BeyondLaw(_));
                    if beyond || limit < SMALLEST_STEP * phase.longest_step {
                        return Err(TransientError::Stopped {
                            time: last.time,
                            pressure: last.pressure,
                            displacement: last.displacement,
                            time_step,
                            failure,
                            samples: std::mem::take(&mut course.samples),
                        });
                    }
                }
            }
        }
    }

    /// One step; the course changes only if it converges.
    fn step(
        &self,
        course: &mut Course,
        time: f64,
        time_step: f64,
        pressure: f64,
    ) -> Result<Sample, StepFailure> {
        let load = self.load(time, pressure);
        let last = course.samples[course.samples.len() - 1];
        let mesh = course.block.mesh();
        let distance = load.displacement - last.displacement;
        let guess = carried(mesh, &course.state, course.following * distance, distance);
        let within = Load { displacement: load.displacement - course.left_out, ..load };
        let (state, contact, history) = self.stepper.advance(
            &course.block,
            guess,
            within,
            time_step,
            &mut course.counts.iterations,
        )?;
        let largest = course.block.largest_invariant(&history, &state.nodes);
        if let Some(beyond) = BeyondLaw::of(course.block.rheology(), largest) {
            return Err(StepFailure::BeyondLaw(beyond));
        }
        let heat = course.block.keep(&history, &state.nodes).map_err(|_| StepFailure::Inverted)?;
        let old = std::mem::replace(&mut course.state, state);
        let sample = course.record(&old, &contact, time, load, heat);
        course.leave_out_periods(within.displacement);
        Ok(sample)
    }

    fn load(&self, time: f64, pressure: f64) -> Load {
        Load {
            pressure: pressure * (time / self.press_time).min(1.0),
            displacement: self.speed * (time - self.press_time).max(0.0),
        }
    }

    fn start(&self) -> Sample {
        let mesh = self.block.mesh();
        let edge = &self.untouched.nodes[..2 * mesh.columns];
        let contact = Contact::at(mesh, &self.stepper.profile, edge, &self.untouched.multipliers);
        Sample { mean_separation: contact.mean_separation, ..Sample::default() }
    }
}

/// Mean x (0) or z (1) of a row of nodes.
fn mean_along(row: &[f64], direction: usize) -> f64 {
    2.0 * row.iter().skip(direction).step_by(2).sum::<f64>() / row.len() as f64
}
