//! Errors with their exit codes.

use std::error::Error;
use std::io;
use std::path::Path;

use asperity::error_kind::{ErrorKind, HasKind};
use asperity::text::{cut, visible};

type Cause = Box<dyn Error + Send + Sync>;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The user gave something that cannot be used; exit code 2.
    #[error(transparent)]
    Input(Cause),
    /// The computation failed or its result could not be written; exit code 1.
    #[error(transparent)]
    Failure(Cause),
    /// The user pressed Ctrl-C; exit code 130, that of a command ended by the interrupt signal.
    #[error("interrupted")]
    Interrupted,
}

impl CliError {
    /// Bad input, from an error or a text.
    pub fn input(cause: impl Into<Cause>) -> Self {
        Self::Input(cause.into())
    }

    /// A failed computation, from an error or a text.
    pub fn failure(cause: impl Into<Cause>) -> Self {
        Self::Failure(cause.into())
    }

    /// An error of a kind, from an error or a text that says more than it.
    pub fn of(kind: ErrorKind, cause: impl Into<Cause>) -> Self {
        match kind {
            ErrorKind::Input => Self::input(cause),
            ErrorKind::Failure => Self::failure(cause),
            ErrorKind::Interrupted => Self::Interrupted,
        }
    }

    /// A folder that cannot be made: bad input if a file has its name.
    pub fn no_folder(path: &Path, error: &io::Error) -> Self {
        let path = path.display();
        match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
                Self::input(format!("{path} is a file, not a folder: choose another place"))
            }
            _ => Self::failure(format!("cannot create the folder {path}: {error}")),
        }
    }

    /// The exit code of the process.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Failure(_) => 1,
            Self::Input(_) => 2,
            Self::Interrupted => 130,
        }
    }

    /// The message and, a line each, its causes. A cause that stands in the message before it has
    /// been said. Control characters of names are printed visibly, lines behind the first of a message
    /// are indented, and what is longer than a screen or two is cut.
    pub fn report(&self) -> String {
        let mut last = self.to_string();
        let shown = |text: &str| visible(&cut(text.trim_end())).replace('\n', "\n    ");
        let mut report = format!("error: {}", shown(&last));
        let mut source = self.source();
        while let Some(cause) = source {
            let text = cause.to_string();
            if !last.contains(&text) {
                report.push_str("\n  caused by: ");
                report.push_str(&shown(&text));
                last = text;
            }
            source = cause.source();
        }
        report
    }
}

/// The error itself says what it is ([`HasKind`]).
impl<E: HasKind + Send + Sync + 'static> From<E> for CliError {
    fn from(error: E) -> Self {
        Self::of(error.kind(), error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::contact::ContactError;
    use asperity::pipeline::PipelineError;
    use asperity::scans::{FileError, FileProblem};
    use asperity::stages::{self, SolveError, StageError};

    #[derive(Debug, thiserror::Error)]
    #[error("{text}")]
    struct Layer {
        text: &'static str,
        source: Option<Box<Layer>>,
    }

    #[test]
    fn a_report_has_every_cause_once() {
        let bottom = Layer { text: "no such\nfile", source: None };
        let middle = Layer { text: "cannot read b", source: Some(Box::new(bottom)) };
        let top = Layer { text: "a: cannot read b", source: Some(Box::new(middle)) };
        let report = CliError::input(top).report();
        assert_eq!(report, "error: a: cannot read b\n  caused by: no such\n    file");
    }

    #[test]
    fn exit_codes_tell_bad_input_from_failure() {
        let unconverged = ContactError::NotConverged {
            pressure: 1e6,
            speed: 0.01,
            points: 64,
            residual: 1e-3,
            iterations: 100,
            changes: 2,
        };
        assert_eq!(CliError::from(unconverged.clone()).exit_code(), 1);
        let height = ContactError::BadHeight { index: 3, value: f64::NAN };
        assert_eq!(CliError::from(height).exit_code(), 2);
        assert_eq!(CliError::Interrupted.exit_code(), 130);
        // The same through any number of layers.
        let in_stage =
            |source| PipelineError::Stage { stage: stages::bem::STAGE, source: Box::new(source) };
        let solve = |source| StageError::Solve { problem: "p".into(), source: Box::new(source) };
        let unconverged = in_stage(solve(SolveError::Contact(unconverged)));
        assert_eq!(CliError::from(unconverged).exit_code(), 1);
        let stopped = in_stage(solve(SolveError::Interrupted));
        assert_eq!(CliError::from(stopped).exit_code(), 130);
        let problem = FileProblem::AllMissing { points: 4 };
        let scan = FileError { file: "scan.sdf".into(), problem };
        assert_eq!(CliError::from(in_stage(StageError::File(Box::new(scan)))).exit_code(), 2);
    }
}
