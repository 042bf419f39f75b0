//! Errors with their exit codes.

use asperity::error_kind::{ErrorKind, HasKind};
use std::error::Error;

type Cause = Box<dyn Error + Send + Sync>;

/// Why a task failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TaskError {
    /// The user gave something that cannot be used; exit code 2.
    #[error("{0}")]
    Input(Cause),
    /// The computation failed or its result could not be written; exit code 1.
    #[error("{0}")]
    Failure(Cause),
}

impl TaskError {
    pub(crate) fn input(cause: impl Into<Cause>) -> Self {
        Self::Input(cause.into())
    }

    pub(crate) fn failure(cause: impl Into<Cause>) -> Self {
        Self::Failure(cause.into())
    }

    /// The exit code of the process.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Failure(_) => 1,
            Self::Input(_) => 2,
        }
    }
}

/// The error itself says whether the user can mend it.
impl<E: HasKind + Send + Sync + 'static> From<E> for TaskError {
    fn from(error: E) -> Self {
        match error.kind() {
            ErrorKind::Input => Self::input(error),
            ErrorKind::Failure | ErrorKind::Interrupted => Self::failure(error),
        }
    }
}
