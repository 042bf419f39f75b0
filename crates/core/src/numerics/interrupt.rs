//! A flag by which a user stops a long computation.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that long computations check between their iterations; clones share it.
///
/// The default is never set unless a clone of it is.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Asks all computations that have a clone to stop.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether they are to stop.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The flag itself, for a signal handler.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}
