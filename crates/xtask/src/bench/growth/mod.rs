//! How time and memory grow: grid points, waves, realisations, threads.
//!
//! Each size runs in a process of its own, so that its peak memory is its own: the executable is
//! started again with the name of a [`Job`], runs it and prints a [`Sample`] as JSON.

mod job;
mod memory;
mod report;

pub use job::{Job, Sample};
pub use report::markdown;

use super::measure::Effort;
use asperity::error_kind::{ErrorKind, HasKind};
use asperity::numerics::statistics::least_squares_line;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Least number of sizes that an exponent is fitted to, where there are so many.
const FITTED: usize = 3;

/// Jobs of growing size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// What grows.
    pub over: &'static str,
    /// What stays the same.
    pub fixed: &'static str,
    /// By ascending size.
    pub rows: Vec<Row>,
    /// Exponent of the time over the size, by least squares of the logarithms, of the larger half
    /// of the sizes (at least three of them): small ones cost what any process costs.
    pub time_exponent: f64,
    /// The same of the memory; none where it was not measured.
    pub memory_exponent: Option<f64>,
}

/// One job.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The number that grows.
    pub size: u32,
    /// What was measured.
    pub sample: Sample,
}

/// Why there are no results.
#[derive(Debug, thiserror::Error)]
pub enum GrowthError {
    /// The process of a job could not be started.
    #[error("{job}: cannot start {}: {source}", executable.display())]
    Start {
        /// The job.
        job: Job,
        /// The executable.
        executable: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The process of a job failed.
    #[error("{job}: its process failed: {message}")]
    Job {
        /// The job.
        job: Job,
        /// What it said.
        message: String,
    },
    /// A text that names no job.
    #[error("{text} is not a job: points:N, waves:N or campaign:REALISATIONS:THREADS")]
    NoJob {
        /// The text.
        text: String,
    },
}

impl HasKind for GrowthError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoJob { .. } => ErrorKind::Input,
            Self::Start { .. } | Self::Job { .. } => ErrorKind::Failure,
        }
    }
}

/// Runs every series; `arguments` before the name of a job make `executable` print its sample.
/// `progress` sees every job before it runs.
///
/// # Errors
/// [`GrowthError`].
pub fn run(
    executable: &Path,
    arguments: &[&str],
    effort: Effort,
    progress: &dyn Fn(&str),
) -> Result<Vec<Series>, GrowthError> {
    let sample = |size: u32, job: Job| {
        progress(&job.to_string());
        Ok(Row { size, sample: in_own_process(executable, arguments, job)? })
    };
    let series = |over, fixed, sizes: &[u32], job: &dyn Fn(u32) -> Job| {
        let rows = effort.of(sizes).iter().map(|size| sample(*size, job(*size)));
        Ok(Series::new(over, fixed, rows.collect::<Result<_, GrowthError>>()?))
    };
    let realisations = |threads| move |realisations| Job::Campaign { realisations, threads };
    let points: Vec<u32> = (10..=20).map(|exponent| 1 << exponent).collect();
    let waves: Vec<u32> = (1..=9).collect();
    Ok(vec![
        series("points", "8 waves, 0.3 MPa, set-up and one solve", &points, &Job::Points)?,
        series(
            "waves",
            "64 points on the shortest, so that each doubles the grid, 0.3 MPa, set-up and one solve",
            &waves,
            &Job::Waves,
        )?,
        series(
            "realisations",
            "8 waves, 3 areas, 1 thread, all stages",
            &[1, 2, 4, 8],
            &realisations(1),
        )?,
        series(
            "realisations",
            "8 waves, 3 areas, 2 threads, all stages",
            &[1, 2, 4, 8],
            &realisations(2),
        )?,
        series("threads", "8 waves, 3 areas, 8 realisations, all stages", &[1, 2], &|threads| {
            Job::Campaign { realisations: 8, threads }
        })?,
    ])
}

fn in_own_process(executable: &Path, arguments: &[&str], job: Job) -> Result<Sample, GrowthError> {
    let output = Command::new(executable).args(arguments).arg(job.to_string()).output();
    let output = output.map_err(|source| GrowthError::Start {
        job,
        executable: executable.to_owned(),
        source,
    })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(GrowthError::Job { job, message });
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| GrowthError::Job { job, message: error.to_string() })
}

impl Series {
    fn new(over: &'static str, fixed: &'static str, rows: Vec<Row>) -> Self {
        let larger = &rows[rows.len().saturating_sub(FITTED.max(rows.len().div_ceil(2)))..];
        let time_exponent = exponent(larger.iter().map(|row| (row.size, row.sample.seconds)));
        let memory: Option<Vec<(u32, f64)>> =
            larger.iter().map(|row| Some((row.size, row.sample.memory_bytes? as f64))).collect();
        let memory_exponent = memory.map(|memory| exponent(memory.into_iter()));
        Self { over, fixed, rows, time_exponent, memory_exponent }
    }
}

/// Slope of the line through the logarithms; NaN for fewer than two different sizes.
fn exponent(values: impl Iterator<Item = (u32, f64)> + Clone) -> f64 {
    let sizes = values.clone().map(|(size, _)| f64::from(size).ln());
    least_squares_line(sizes, values.map(|(_, value)| value.ln())).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_law_is_found() {
        let rows = [1, 10, 100, 1000].map(|size| {
            // The smallest is mostly overhead, which the exponent must not see.
            let overhead = if size == 1 { 1.0 } else { 0.0 };
            let seconds = 3e-6 * f64::from(size).powf(1.25) + overhead;
            let sample = Sample { seconds, memory_bytes: Some(64 * u64::from(size)), solve: None };
            Row { size, sample }
        });
        let series = Series::new("points", "", rows.to_vec());
        approx::assert_relative_eq!(series.time_exponent, 1.25, max_relative = 1e-12);
        approx::assert_relative_eq!(series.memory_exponent.unwrap(), 1.0, max_relative = 1e-12);
    }

    #[test]
    fn what_was_not_measured_has_no_exponent() {
        let row = |size| {
            let sample = Sample { seconds: 1.0, memory_bytes: None, solve: None };
            Row { size, sample }
        };
        assert_eq!(Series::new("points", "", vec![row(1), row(2)]).memory_exponent, None);
    }
}
