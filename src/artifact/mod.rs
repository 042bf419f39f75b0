//! Everything that is kept on disk between two stages.
//!
//! ```text
//! OUT/                        RunFolder, one run at a time (lock)
//!   bem/                      the current result of the stage `bem`
//!     manifest.json           Manifest: parameters, inputs, digests; written last
//!     solves.arrow            a table of a Row type
//!   realise/
//!     manifest.json
//!     surfaces.h5             named arrays
//! CACHE/ab/abcd….json         SolveStore, single results
//! CACHE/ab/abcd….pack         SolveStore of a sweep, all results of a problem
//! ```
//!
//! Tables are Arrow IPC files, arrays HDF5 files; both carry units, a schema name, a version and a
//! digest of their content, so pyarrow, polars and h5py read them without this crate. No other
//! module knows either format.

mod arrays;
mod columns;
mod content;
mod digest;
mod error;
mod export;
mod handle;
mod layout;
mod lock;
mod manifest;
mod own;
mod schema;
mod solves;
mod store;
mod table;
#[cfg(test)]
mod tests;
mod view;

pub use arrays::{ArrayDataset, ArraysInfo, Attribute, DatasetInfo, Storage};
pub use arrays::{arrays_info, read_arrays, write_arrays};
pub use columns::{Column, ColumnType, Row, columns};
pub use digest::{Digest, Digesting};
pub use error::ArtifactError;
pub use export::{ExportTable, Values};
pub use handle::{ArrayFile, ResultFile, Table};
pub use manifest::{Identity, Input, Manifest, Output, SchemaVersion};
pub use own::{CASES_FOLDER, NOTE_FILE, NOTE_HEAD, SURFACES_FOLDER, temporary_beside, write_note};
pub use schema::{ArraysSchema, AttributeSchema, DatasetSchema, arrays_schema};
pub use schema::{check_or_write, table_schema};
pub(crate) use solves::write_by_rename;
pub use solves::{PACK_EXTENSION, PACK_SCHEMA, PackInfo, read_pack_info};
pub use solves::{SOLVE_SCHEMA, SolveStore, Solves, StoredSolve, read_stored_solve};
pub use store::{Pending, RunFolder, SOLVES_FOLDER};
pub use table::{Metadata, TableInfo, read_table, table_info, write_table};
pub use view::RunView;

/// Version of the tool that writes an artifact; recorded in every file and no part of any digest.
pub const TOOL_VERSION: &str = env!("CARGO_PKG_VERSION");
