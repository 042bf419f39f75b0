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
//!
//! | module | what it holds |
//! |---|---|
//! | `array_reader` | reading of the files of arrays |
//! | `arrays` | named one-dimensional arrays as HDF5 files |
//! | `columns` | from a row type to the columns of its table |
//! | `content` | digest of the content of a table, independent of the bytes of its file |
//! | `digest` | BLAKE3 digests of bytes, files and JSON values |
//! | `error` | what can go wrong with a file, and what to do about it |
//! | `export` | tables for other programs |
//! | `handle` | handles: where a file of a result is and what it holds, stated once, beside the type of its rows |
//! | `layout` | checks of the layout of an Arrow IPC file, before the reader trusts it |
//! | `lock` | the lock of a run folder: a file `.lock` that says which process has it |
//! | `manifest` | provenance of a result: what went in, what came out, and the key that decides whether a result is still that of the recipe |
//! | `own` | which files of a run folder asperity wrote: nothing else is removed, renamed or changed |
//! | `schema` | the committed JSON documents that describe the artifacts |
//! | `solves` | store of single results, so that a stopped run or sweep continues where it stopped |
//! | `store` | the output folder of a run: one subfolder per stage with its current result |
//! | `table` | tables as Arrow IPC files |
//! | `view` | the results in an output folder, for reading |

mod array_reader;
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
pub use arrays::{arrays_info, read_arrays, visit_arrays, write_arrays};
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
