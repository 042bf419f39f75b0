//! Ctrl-C, and the signal by which a scheduler ends a job, for commands that have something to clean up; the
//! others simply end.

use signal_hook::flag;

use super::CliError;
use asperity::files::os::signals_to_end;
use asperity::numerics;

/// Whether the user has pressed Ctrl-C, or SIGTERM has come, since the installation.
#[derive(Debug, Clone)]
pub(super) struct Interrupt(numerics::Interrupt);

impl Interrupt {
    /// Handles the signals for the rest of the process; may be called once. The first signal asks the computation to
    /// stop, the second ends the process at once, like a kill.
    ///
    /// # Errors
    /// [`CliError::Failure`] if the operating system refuses.
    pub(super) fn install() -> Result<Self, CliError> {
        let interrupt = numerics::Interrupt::default();
        for signal in signals_to_end() {
            // In this order: the flag is looked at before it is set.
            let code = i32::from(CliError::Interrupted.exit_code());
            flag::register_conditional_shutdown(signal, code, interrupt.flag())
                .and_then(|_| flag::register(signal, interrupt.flag()))
                .map_err(|error| {
                    CliError::failure(format!("the signal {signal} cannot be handled: {error}"))
                })?;
        }
        Ok(Self(interrupt))
    }

    /// The flag itself, for computations that look at it.
    pub(super) fn flag(&self) -> &numerics::Interrupt {
        &self.0
    }

    /// # Errors
    /// [`CliError::Interrupted`] after Ctrl-C.
    pub(super) fn check(&self) -> Result<(), CliError> {
        if self.0.is_set() { Err(CliError::Interrupted) } else { Ok(()) }
    }
}
