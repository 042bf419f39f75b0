//! The time series of a drag and the averages over it.

use super::step::Iterations;

/// Energies since the start, in J per metre of width.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Work of the horizontal force on the upper edge.
    pub drag_work: f64,
    /// Work of the dead load on the upper edge.
    pub load_work: f64,
    /// Heat from the branches, by the trapezoidal rule over the flow in a step.
    pub dissipated: f64,
    /// Energy stored in the springs.
    pub stored: f64,
}

impl Energy {
    /// Energies from an earlier state to this one.
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            drag_work: self.drag_work - earlier.drag_work,
            load_work: self.load_work - earlier.load_work,
            dissipated: self.dissipated - earlier.dissipated,
            stored: self.stored - earlier.stored,
        }
    }

    /// Work that is neither stored nor dissipated: the error of the time integration.
    pub fn imbalance(&self) -> f64 {
        self.drag_work + self.load_work - self.dissipated - self.stored
    }
}

/// The block at the end of a time step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Time in s since the first touch.
    pub time: f64,
    /// Nominal pressure in Pa.
    pub pressure: f64,
    /// Distance in m by which the upper edge was dragged.
    pub displacement: f64,
    /// Friction coefficient `F_x / F_z` (thesis 4.3.6); positive where it opposes the motion.
    pub friction_coefficient: f64,
    /// Current projected length in contact over the period: nodes with a contact pressure, each
    /// with half of the edges beside it.
    pub contact_area_fraction: f64,
    /// Mean of the gap in m between rubber and profile.
    pub mean_separation: f64,
    /// Energies since the start.
    pub energy: Energy,
}

/// Mean and oscillation of a quantity over the last part of the drag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averaged {
    /// Mean over the distance.
    pub mean: f64,
    /// Largest minus smallest value.
    pub range: f64,
    /// Standard deviation over the distance.
    pub standard_deviation: f64,
}

/// Time steps and their iterations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Time steps.
    pub steps: usize,
    /// Time steps that failed and were tried again with half the length.
    pub rejected_steps: usize,
    /// Iterations, those of rejected steps included.
    pub iterations: Iterations,
}

/// A block that was pressed in and dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct TransientSolution {
    /// All time steps; the first one is the untouched block.
    pub samples: Vec<Sample>,
    /// Friction coefficient over the last part of the drag.
    pub friction_coefficient: Averaged,
    /// Contact area fraction over the last part of the drag.
    pub contact_area_fraction: Averaged,
    /// Mean separation in m over the last part of the drag.
    pub mean_separation: Averaged,
    /// Energies of the last part of the drag.
    pub energy: Energy,
    /// Effort.
    pub counts: Counts,
}

impl TransientSolution {
    /// Averages over the samples from `first` on.
    pub(super) fn new(samples: Vec<Sample>, first: usize, counts: Counts) -> Self {
        let part = &samples[first..];
        let energy = part[part.len() - 1].energy.since(&part[0].energy);
        Self {
            friction_coefficient: Averaged::over(part, |sample| sample.friction_coefficient),
            contact_area_fraction: Averaged::over(part, |sample| sample.contact_area_fraction),
            mean_separation: Averaged::over(part, |sample| sample.mean_separation),
            energy,
            counts,
            samples,
        }
    }
}

impl Averaged {
    fn over(samples: &[Sample], quantity: impl Fn(&Sample) -> f64) -> Self {
        let integral = |of: &dyn Fn(f64) -> f64| -> f64 {
            samples
                .windows(2)
                .map(|pair| {
                    let distance = pair[1].displacement - pair[0].displacement;
                    0.5 * distance * (of(quantity(&pair[0])) + of(quantity(&pair[1])))
                })
                .sum()
        };
        let distance = samples[samples.len() - 1].displacement - samples[0].displacement;
        let mean = integral(&|value| value) / distance;
        let variance = integral(&|value| (value - mean).powi(2)) / distance;
        let extremes = samples
            .iter()
            .map(&quantity)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
                (least.min(value), most.max(value))
            });
        Self { mean, range: extremes.1 - extremes.0, standard_deviation: variance.sqrt() }
    }
}
