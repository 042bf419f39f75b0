//! Instrument files: bytes in, a [`RawScan`](crate::surface::RawScan) or an error out.
//!
//! Nothing is guessed: units, columns and markers of missing points come from a description in
//! the recipe, and what does not fit it is an error that names the line and the key to change.

mod decode;
pub mod description;
pub mod error;
pub mod file;
mod text;

pub use description::TextFormat;
pub use error::{ScanError, ScanProblem};
pub use text::{parse_text, read_text};
