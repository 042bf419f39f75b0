//! Errors with their exit codes.

use std::error::Error;

use crate::contact::ContactError;
use crate::fem::error::{FemError, PathEnd};
use crate::fem::transient::TransientError;
use crate::surface::synthesis::SynthesisError;
use crate::text::{cut, visible};

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

    /// The exit code of the process.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Failure(_) => 1,
            Self::Input(_) => 2,
            Self::Interrupted => 130,
        }
    }

    /// The message and, a line each, its causes. A cause that the message before it ends with has
    /// been said. Control characters of names are printed visibly, lines behind the first of a message
    /// are indented, and what is longer than a screen or two is cut.
    pub fn report(&self) -> String {
        let mut last = self.to_string();
        let shown = |text: &str| visible(&cut(text.trim_end())).replace('\n', "\n    ");
        let mut report = format!("error: {}", shown(&last));
        let mut source = self.source();
        while let Some(cause) = source {
            let text = cause.to_string();
            if !last.ends_with(&text) {
                report.push_str("\n  caused by: ");
                report.push_str(&shown(&text));
                last = text;
            }
            source = cause.source();
        }
        report
    }
}

impl From<ContactError> for CliError {
    fn from(error: ContactError) -> Self {
        match error {
            ContactError::Rubber(_)
            | ContactError::OutOfRange { .. }
            | ContactError::BadHeight { .. } => Self::input(error),
            ContactError::NotConverged { .. } | ContactError::AreaNotReached { .. } => {
                Self::failure(error)
            }
        }
    }
}

impl From<FemError> for CliError {
    fn from(error: FemError) -> Self {
        match error {
            FemError::Rubber(_) | FemError::OutOfRange { .. } => Self::input(error),
            FemError::PathEnded { reached: PathEnd::NotStarted, .. } => {
                Self::failure(format!("{error}; try other --columns"))
            }
            FemError::PathEnded { reached: PathEnd::At { .. }, .. } => {
                Self::failure(format!("{error}; try other --columns, or a pressure below that"))
            }
            FemError::AreaNotReached { .. } => {
                Self::failure(format!("{error}; give more --columns for a smaller area"))
            }
        }
    }
}

impl From<TransientError> for CliError {
    fn from(error: TransientError) -> Self {
        match error {
            TransientError::Stopped { .. } => Self::failure(error),
            TransientError::Rubber(_)
            | TransientError::OutOfRange { .. }
            | TransientError::PeriodMismatch { .. } => Self::input(error),
        }
    }
}

impl From<SynthesisError> for CliError {
    fn from(error: SynthesisError) -> Self {
        Self::input(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(CliError::from(unconverged).exit_code(), 1);
        let height = ContactError::BadHeight { index: 3, value: f64::NAN };
        assert_eq!(CliError::from(height).exit_code(), 2);
        assert_eq!(CliError::Interrupted.exit_code(), 130);
    }
}
