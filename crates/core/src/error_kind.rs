//! Who can mend an error: one answer for every error type of the crate.
//!
//! Each error type states it beside its definition, by a `match` without a wildcard, so that a new variant has
//! to be decided on. The command line makes its exit codes of it and keeps no list of its own.

use std::error::Error;

/// Who can mend an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The user gave something that cannot be used: a file, a value, a combination of options.
    Input,
    /// The computation failed, or its result could not be written.
    Failure,
    /// The user interrupted.
    Interrupted,
}

/// An error that states its [`ErrorKind`].
pub trait HasKind: Error {
    /// Who can mend it.
    fn kind(&self) -> ErrorKind;
}

impl<E: HasKind + ?Sized> HasKind for Box<E>
where
    Box<E>: Error,
{
    fn kind(&self) -> ErrorKind {
        (**self).kind()
    }
}
