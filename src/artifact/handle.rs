//! Handles: where a file of a result is and what it holds, stated once, beside the type of its rows.

use super::columns::Row;
use super::manifest::SchemaVersion;
use std::fmt;
use std::marker::PhantomData;

/// A file of the result of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResultFile {
    /// Name of the stage.
    pub stage: &'static str,
    /// Name of the file in the folder of the stage.
    pub name: &'static str,
}

/// A table of a result, with the type of its rows.
pub struct Table<R> {
    file: ResultFile,
    rows: PhantomData<fn() -> R>,
}

impl<R: Row> Table<R> {
    /// The table of that file name (`*.arrow`) in the result of a stage.
    pub const fn new(stage: &'static str, name: &'static str) -> Self {
        Self { file: ResultFile { stage, name }, rows: PhantomData }
    }

    /// Name of the file.
    pub const fn name(self) -> &'static str {
        self.file.name
    }

    /// The file.
    pub const fn file(self) -> ResultFile {
        self.file
    }

    /// Schema of its rows.
    pub fn schema(self) -> SchemaVersion {
        SchemaVersion { schema: R::SCHEMA.into(), version: R::VERSION }
    }
}

// Derived, these would ask the same of the rows.
impl<R> Clone for Table<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for Table<R> {}

impl<R> fmt::Debug for Table<R> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.file.fmt(f)
    }
}

impl<R> fmt::Display for Table<R> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.file.name)
    }
}

impl<R> From<Table<R>> for ResultFile {
    fn from(table: Table<R>) -> Self {
        table.file
    }
}

/// A file of named arrays (`*.h5`) of a result, with its schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArrayFile {
    /// The file.
    pub file: ResultFile,
    /// Schema name.
    pub schema: &'static str,
    /// Schema version.
    pub version: u32,
    /// What it holds, in a sentence.
    pub description: &'static str,
}

impl ArrayFile {
    /// Name and version of its schema.
    pub fn schema(self) -> SchemaVersion {
        SchemaVersion { schema: self.schema.into(), version: self.version }
    }
}

impl From<ArrayFile> for ResultFile {
    fn from(arrays: ArrayFile) -> Self {
        arrays.file
    }
}
