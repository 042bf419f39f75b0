//! Instrument files: bytes in, a [`RawScan`](crate::surface::RawScan) or an error out.
//!
//! Nothing is guessed. Files that state their units are told by their content and read natively
//! ([`mod@file`]); of text files, units, columns and markers of missing points come from a description
//! in the recipe, and what does not fit it is an error that names the line and the key to change.
//! [`text_shape`] looks at a text and proposes such a description.

mod decode;
pub mod description;
pub mod error;
pub mod file;
mod text;
pub mod text_shape;
mod thousands;

pub use description::TextFormat;
pub use error::{ScanError, ScanProblem};
pub use file::{FileError, FileProblem};
pub use text::{parse_text, read_text};
