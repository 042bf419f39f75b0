//! Ctrl-C, and the signal by which a scheduler ends a job, for commands that have something to clean up; the
//! others simply end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::CliError;

/// Whether the user has pressed Ctrl-C, or SIGTERM has come, since the installation.
#[derive(Debug, Clone)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Takes both over for the rest of the process; once for each process.
    ///
    /// # Errors
    /// [`CliError::Failure`] if the operating system refuses.
    pub(super) fn install() -> Result<Self, CliError> {
        let flag = Arc::new(AtomicBool::new(false));
        let handler = Arc::clone(&flag);
        ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed))
            .map_err(CliError::failure)?;
        Ok(Self(flag))
    }

    /// The flag itself, for computations that look at it.
    pub(super) fn flag(&self) -> &AtomicBool {
        &self.0
    }

    /// # Errors
    /// [`CliError::Interrupted`] after Ctrl-C.
    pub(super) fn check(&self) -> Result<(), CliError> {
        if self.0.load(Ordering::Relaxed) { Err(CliError::Interrupted) } else { Ok(()) }
    }
}
