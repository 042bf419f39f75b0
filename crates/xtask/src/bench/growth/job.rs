//! One job of one size.

use super::GrowthError;
use super::memory::peak;
use crate::bench::Failure;
use crate::bench::campaign::Campaign;
use crate::bench::half_space::{contact, surface};
use crate::bench::measure::{Effort, Measured, measure};
use asperity::rubber::Rubber;
use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::hint::black_box;
use std::str::FromStr;

/// Mean pressure in Pa of the single contacts.
const PRESSURE: f64 = 3e5;
/// Waves of the contacts over the points and of the campaign.
const WAVES: usize = 8;
/// Grid points on the shortest wave where waves grow.
const POINTS_ON_SHORTEST: u32 = 64;
/// Section `[bem]` of the campaign.
const SECTIONS: &str = "speeds_mm_s = [10.0]\narea_fractions = [0.02, 0.05, 0.1]\n\
    points_per_shortest_wavelength = 128";

/// What is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job {
    /// A half-space contact of eight waves on a number of points.
    Points(u32),
    /// A half-space contact of 1 to 9 waves, 64 points on the shortest.
    Waves(u32),
    /// All stages from waves to tables.
    Campaign {
        /// Number of realisations.
        realisations: u32,
        /// Number of threads.
        threads: u32,
    },
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Median time in s.
    pub seconds: f64,
    /// Peak resident memory in bytes above that of the process before the job; none where the
    /// operating system does not tell.
    pub memory_bytes: Option<u64>,
    /// Of a single solve: what it is made of.
    pub solve: Option<SolveCost>,
}

/// A solve of the half-space beside the transforms that it cannot do without.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolveCost {
    /// Number of grid points.
    pub points: u64,
    /// Median time in s of the solve alone, the grids being set up.
    pub seconds: f64,
    /// Applications of the operator in units of the finest grid, one pair of transforms each.
    pub operator_applications: f64,
    /// Median time in s of one pair of transforms, real to complex and back.
    pub transform_pair_seconds: f64,
}

impl SolveCost {
    /// Time in s of the pairs of transforms alone.
    pub fn floor_seconds(&self) -> f64 {
        self.operator_applications * self.transform_pair_seconds
    }
}

impl Job {
    /// Runs the job in this process, whose peak memory it reads: once a process.
    ///
    /// # Errors
    /// What the solvers or the stages say.
    pub fn run(self) -> Result<Sample, Failure> {
        match self {
            Self::Points(points) => solve(WAVES, points),
            Self::Waves(waves @ 1..=9) => solve(waves as usize, POINTS_ON_SHORTEST << (waves - 1)),
            Self::Waves(waves) => Err(format!("{waves} waves: choose 1 to 9").into()),
            Self::Campaign { realisations, threads } => campaign(realisations, threads),
        }
    }
}

fn solve(waves: usize, points: u32) -> Result<Sample, Failure> {
    let (rubber, waves) = (Rubber::table_2_1(), surface(waves));
    let before = peak();
    let Measured { seconds, .. } = measure(Effort::Full, &mut || {
        Ok(contact(&rubber, &waves, points)?.solve(PRESSURE)?.friction_coefficient)
    })?;
    let memory_bytes = above(before);
    let mut contact = contact(&rubber, &waves, points)?;
    let solved = measure(Effort::Full, &mut || Ok(contact.solve(PRESSURE)?.operator_applications))?;
    let solve = SolveCost {
        points: u64::from(points),
        seconds: solved.seconds,
        operator_applications: solved.result,
        transform_pair_seconds: transform_pair(points as usize)?,
    };
    Ok(Sample { seconds, memory_bytes, solve: Some(solve) })
}

/// Median time in s of one real transform forth and back, with its scratch and buffers at hand.
fn transform_pair(points: usize) -> Result<f64, Failure> {
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(points), planner.plan_fft_inverse(points));
    let (mut values, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
    let mut scratch = forward.make_scratch_vec();
    let mut inverse_scratch = inverse.make_scratch_vec();
    values.iter_mut().enumerate().for_each(|(i, value)| *value = (i % 7) as f64);
    // Many pairs a repeat: one alone is shorter than the clock tells.
    let pairs = ((1 << 20) / points).max(1);
    let measured = measure(Effort::Full, &mut || {
        for _ in 0..pairs {
            forward.process_with_scratch(&mut values, &mut spectrum, &mut scratch)?;
            inverse.process_with_scratch(&mut spectrum, &mut values, &mut inverse_scratch)?;
            // Left as they are, repeated pairs would overflow.
            values.iter_mut().for_each(|value| *value /= points as f64);
        }
        Ok(black_box(values[0]))
    })?;
    Ok(measured.seconds / pairs as f64)
}

fn campaign(realisations: u32, threads: u32) -> Result<Sample, Failure> {
    let campaign = Campaign::new(&surface(WAVES), realisations, SECTIONS)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build()?;
    let before = peak();
    let measured = measure(Effort::Full, &mut || pool.install(|| campaign.run(|_| Ok(()))))?;
    Ok(Sample { seconds: measured.seconds, memory_bytes: above(before), solve: None })
}

/// Peak memory in bytes above an earlier one; at least a page, which a process takes at once.
fn above(before: Option<u64>) -> Option<u64> {
    Some(peak()?.saturating_sub(before?).max(4096))
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Points(points) => write!(f, "points:{points}"),
            Self::Waves(waves) => write!(f, "waves:{waves}"),
            Self::Campaign { realisations, threads } => {
                write!(f, "campaign:{realisations}:{threads}")
            }
        }
    }
}

impl FromStr for Job {
    type Err = GrowthError;

    fn from_str(text: &str) -> Result<Self, GrowthError> {
        let no_job = || GrowthError::NoJob { text: text.to_owned() };
        let (name, numbers) = text.split_once(':').ok_or_else(no_job)?;
        let numbers: Vec<u32> = numbers
            .split(':')
            .map(|number| number.parse().map_err(|_| no_job()))
            .collect::<Result<_, GrowthError>>()?;
        match (name, &numbers[..]) {
            ("points", [points]) => Ok(Self::Points(*points)),
            ("waves", [waves]) => Ok(Self::Waves(*waves)),
            ("campaign", [realisations, threads]) if *threads > 0 => {
                Ok(Self::Campaign { realisations: *realisations, threads: *threads })
            }
            _ => Err(no_job()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_read_as_it_is_written() {
        let campaign = Job::Campaign { realisations: 8, threads: 2 };
        for job in [Job::Points(1024), Job::Waves(9), campaign] {
            assert_eq!(job.to_string().parse::<Job>().unwrap(), job);
        }
        for text in ["points", "points:", "points:-1", "waves:1:2", "campaign:3:0", "other:1"] {
            assert!(text.parse::<Job>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_solve_tells_what_it_is_made_of() {
        let sample = Job::Points(1024).run().unwrap();
        let solve = sample.solve.unwrap();
        assert_eq!(solve.points, 1024);
        assert!(solve.operator_applications > 1.0 && solve.transform_pair_seconds > 0.0);
        assert!(Job::Waves(10).run().unwrap_err().to_string().contains("choose 1 to 9"));
    }
}
