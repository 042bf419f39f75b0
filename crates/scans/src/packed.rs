//! The one rule for all that is compressed: how far it may unpack.

use super::file::{FileProblem, Place};

/// Largest unpacked size over packed size of what is large. Deflate reaches a thousand on zeros,
/// heights of instruments stay below ten.
pub(super) const LARGEST_RATIO: u64 = 200;
/// What unpacks to no more than this may be packed as tightly as it likes.
const SMALL: u64 = 1 << 20;

/// Whether `packed` bytes at `place` may unpack to `unpacked`.
///
/// # Errors
/// [`FileProblem::Ratio`].
pub(super) fn admit(place: Place, packed: u64, unpacked: u64) -> Result<(), FileProblem> {
    if unpacked <= limit(packed) {
        return Ok(());
    }
    Err(FileProblem::Ratio { place, packed, unpacked })
}

/// Most bytes that `packed` bytes may unpack to.
pub(super) fn limit(packed: u64) -> u64 {
    packed.saturating_mul(LARGEST_RATIO).max(SMALL)
}
