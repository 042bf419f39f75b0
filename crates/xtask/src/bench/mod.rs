//! Work against precision: every solver over its accuracy knob on fixed cases, error against
//! seconds; and how the cost grows with the size of a job.
//!
//! A [`Case`] is one problem with a reference; each of its [`Method`]s is a solver with a knob. The
//! error is relative, `|result - reference| / |reference|` in the Euclidean norm, for friction of
//! a single number. Seconds are the median of repeats after one warm-up, with the set-up of grids,
//! meshes and plans and without that of the input, see [`measure()`].
//!
//! | module | what it holds |
//! |---|---|
//! | [`mod@measure`] | repeats and their median |
//! | `half_space`, `finite_deformation`, `hybrid`, `scans` | the cases |
//! | `campaign` | small recipes run through the pipeline |
//! | [`growth`] | time and memory over the size of a job, with exponents |
//! | [`report`], [`figure`] | tables and the plot |
//! | [`command`] | the task and its options |

mod campaign;
pub mod command;
pub mod figure;
mod finite_deformation;
pub mod growth;
mod half_space;
mod hybrid;
pub mod measure;
pub mod report;
mod scans;

use asperity::error_kind::{ErrorKind, HasKind};
use asperity::numerics::krylov::euclidean_norm;
use measure::{Effort, Measured, measure};
use serde::Serialize;
use std::error::Error;

/// An error of a solver or of the operating system.
pub type Failure = Box<dyn Error + Send + Sync>;

/// A solver that is ready to be timed: from its set-up to its result.
pub type Prepared = Box<dyn FnMut() -> Result<Vec<f64>, Failure>>;

/// Makes the input of a solver for a value of its knob.
pub type Prepare = fn(u32) -> Result<Prepared, Failure>;

/// One solver and its accuracy knob.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Name, unique within its case.
    pub name: &'static str,
    /// What the knob counts.
    pub knob: &'static str,
    /// Its values, ascending.
    pub values: &'static [u32],
    /// The solver at a value of the knob.
    pub prepare: Prepare,
}

/// What results are compared with.
#[derive(Debug, Clone, Copy)]
pub enum Reference {
    /// The answer of a solver beyond any value of the knobs.
    OverResolved {
        /// The solver.
        prepare: Prepare,
        /// The value of its knob.
        value: u32,
        /// The value for [`Effort::Quick`].
        quick: u32,
    },
    /// The exact answer to the problem of each value of the knob.
    Exact(Prepare),
}

/// One problem, its reference and the solvers that are tried on it.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Name by which it is asked for.
    pub name: &'static str,
    /// The problem, in one line.
    pub problem: &'static str,
    /// What the reference is, in words.
    pub reference_text: &'static str,
    /// The reference.
    pub reference: Reference,
    /// The solvers.
    pub methods: &'static [Method],
}

/// One solver at one value of its knob.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Value of the knob.
    pub value: u32,
    /// The result, where it is a single number.
    pub result: Option<f64>,
    /// Error relative to the reference.
    pub relative_error: f64,
    /// Median time in s.
    pub seconds: f64,
    /// Number of repeats behind the median.
    pub repeats: usize,
}

/// One solver over its knob.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Name of the method.
    pub method: &'static str,
    /// What its knob counts.
    pub knob: &'static str,
    /// By ascending value of the knob.
    pub points: Vec<Point>,
}

/// A case that was run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseResult {
    /// Name of the case.
    pub case: &'static str,
    /// The problem, in one line.
    pub problem: &'static str,
    /// What the reference is, in words.
    pub reference: &'static str,
    /// A line for each method.
    pub lines: Vec<Line>,
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// There is no case of that name.
    #[error("there is no case {name}: choose from {}", known.join(", "))]
    UnknownCase {
        /// The name that was asked for.
        name: String,
        /// All names.
        known: Vec<&'static str>,
    },
    /// A solver failed.
    #[error("case {case}, {method} at {value}: {source}")]
    Solver {
        /// The case.
        case: &'static str,
        /// The method, or "reference".
        method: &'static str,
        /// Value of the knob.
        value: u32,
        /// Why.
        source: Failure,
    },
}

impl HasKind for BenchError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::UnknownCase { .. } => ErrorKind::Input,
            Self::Solver { .. } => ErrorKind::Failure,
        }
    }
}

/// All cases, in the order of the tables.
pub fn cases() -> Vec<Case> {
    [half_space::CASES, finite_deformation::CASES, hybrid::CASES, scans::CASES].concat()
}

/// The cases of some names, in the order of [`cases`]; all of them without a name.
///
/// # Errors
/// [`BenchError::UnknownCase`].
pub fn select(names: &[String]) -> Result<Vec<Case>, BenchError> {
    let all = cases();
    let known: Vec<&'static str> = all.iter().map(|case| case.name).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(BenchError::UnknownCase { name: name.clone(), known });
    }
    let wanted = |case: &Case| names.is_empty() || names.iter().any(|name| name == case.name);
    Ok(all.into_iter().filter(wanted).collect())
}

impl Case {
    /// Runs every method over its knob; `progress` sees the name of each before it runs.
    ///
    /// # Errors
    /// [`BenchError::Solver`].
    pub fn run(&self, effort: Effort, progress: &dyn Fn(&str)) -> Result<CaseResult, BenchError> {
        progress("reference");
        let fixed = match self.reference {
            Reference::OverResolved { prepare, value, quick } => {
                let value = if effort == Effort::Quick { quick } else { value };
                Some(self.once("reference", prepare, value)?)
            }
            Reference::Exact(_) => None,
        };
        let line = |method: &Method| {
            progress(method.name);
            let points = effort.of(method.values).iter();
            let points = points.map(|value| self.point(method, *value, fixed.as_deref(), effort));
            let points = points.collect::<Result<_, BenchError>>()?;
            Ok(Line { method: method.name, knob: method.knob, points })
        };
        let lines = self.methods.iter().map(line).collect::<Result<_, BenchError>>()?;
        let Self { name: case, problem, reference_text: reference, .. } = *self;
        Ok(CaseResult { case, problem, reference, lines })
    }

    fn point(
        &self,
        method: &Method,
        value: u32,
        fixed: Option<&[f64]>,
        effort: Effort,
    ) -> Result<Point, BenchError> {
        let Measured { result, seconds, repeats } = (method.prepare)(value)
            .and_then(|mut solver| measure(effort, &mut solver))
            .map_err(|source| self.failed(method.name, value, source))?;
        let exact;
        let reference = match (fixed, self.reference) {
            (Some(reference), _) => reference,
            (None, Reference::Exact(prepare) | Reference::OverResolved { prepare, .. }) => {
                exact = self.once("reference", prepare, value)?;
                &exact
            }
        };
        let relative_error = relative_error(&result, reference);
        let result = if let [number] = result[..] { Some(number) } else { None };
        Ok(Point { value, result, relative_error, seconds, repeats })
    }

    fn once(
        &self,
        method: &'static str,
        prepare: Prepare,
        value: u32,
    ) -> Result<Vec<f64>, BenchError> {
        let result = prepare(value).and_then(|mut solver| solver());
        result.map_err(|source| self.failed(method, value, source))
    }

    fn failed(&self, method: &'static str, value: u32, source: Failure) -> BenchError {
        BenchError::Solver { case: self.name, method, value, source }
    }
}

/// `|result - reference| / |reference|` in the Euclidean norm.
fn relative_error(result: &[f64], reference: &[f64]) -> f64 {
    let difference: Vec<f64> = result.iter().zip(reference).map(|(a, b)| a - b).collect();
    euclidean_norm(&difference) / euclidean_norm(reference)
}

#[cfg(test)]
mod tests;
