//! The threads of a command.

use std::num::NonZero;
use std::thread::available_parallelism;

use super::CliError;

/// Largest number of threads that is not taken for a typing mistake; each has a stack and the memory of a
/// contact.
pub(super) const MOST: usize = 1024;

/// The number of threads that was asked for, if it is plausible.
///
/// # Errors
/// [`CliError::Input`] for zero and for more than [`MOST`].
pub(super) fn checked(asked: Option<usize>) -> Result<Option<usize>, CliError> {
    match asked {
        Some(0) => Err(CliError::input("--threads is 0: give at least 1")),
        Some(threads) if threads > MOST => Err(CliError::input(format!(
            "--threads is {threads}: this machine has {}; give 1 to {MOST}",
            cores()
        ))),
        asked => Ok(asked),
    }
}

/// Starts the threads of the process, one for each core if no number is given, and returns their number.
///
/// # Errors
/// Those of [`checked`]; [`CliError::Failure`] if the operating system starts no more threads.
pub(super) fn start(asked: Option<usize>) -> Result<usize, CliError> {
    let asked = checked(asked)?;
    rayon::ThreadPoolBuilder::new().num_threads(asked.unwrap_or(0)).build_global().map_err(
        |error| {
            let wanted = match asked {
                Some(1) => "1 thread".to_owned(),
                Some(threads) => format!("{threads} threads"),
                None => format!("a thread for each core ({})", cores()),
            };
            CliError::failure(format!(
                "cannot start {wanted}: {error}; give fewer --threads, or raise the limit of processes \
                 (ulimit -u)"
            ))
        },
    )?;
    Ok(rayon::current_num_threads())
}

fn cores() -> String {
    match available_parallelism().map(NonZero::get) {
        Ok(1) => "1 core".to_owned(),
        Ok(cores) => format!("{cores} cores"),
        Err(_) => "an unknown number of cores".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_number_is_refused_with_the_cores_that_there_are() {
        assert_eq!(checked(Some(1024)).unwrap(), Some(1024));
        assert_eq!(checked(None).unwrap(), None);
        let text = checked(Some(10_000)).unwrap_err().to_string();
        assert!(text.contains("--threads is 10000") && text.contains("core"), "{text}");
        assert!(checked(Some(0)).unwrap_err().to_string().contains("at least 1"));
    }
}
