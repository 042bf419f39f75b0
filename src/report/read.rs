//! What figures and reports read of a run.

use crate::artifact::{ArtifactError, Metadata, Row, RunView, Table};
use crate::error_kind::{ErrorKind, HasKind};
use crate::plot::FigureError;
use crate::stages::StageError;

/// A figure or a report that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A result cannot be read.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// A result of a stage cannot be read.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// A figure cannot be drawn.
    #[error("figure {name}: {source}")]
    Figure {
        /// Its name.
        name: &'static str,
        /// Why.
        source: FigureError,
    },
    /// The folder has no results.
    #[error("{folder} has no results of a run: `asperity run RECIPE --out {folder}` makes them")]
    Empty {
        /// The run folder.
        folder: String,
    },
}

impl HasKind for ReportError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Artifact(source) => source.kind(),
            Self::Stage(source) => source.kind(),
            Self::Figure { .. } => ErrorKind::Failure,
            Self::Empty { .. } => ErrorKind::Input,
        }
    }
}

/// The rows of a table, or `None` if the run has no such result.
pub(super) fn rows<R: Row>(run: &RunView, wanted: Table<R>) -> Result<Option<Vec<R>>, ReportError> {
    Ok(table(run, wanted)?.map(|(rows, _)| rows))
}

/// The rows of a table and its metadata, or `None` if the run has no such result.
pub(super) fn table<R: Row>(
    run: &RunView,
    wanted: Table<R>,
) -> Result<Option<(Vec<R>, Metadata)>, ReportError> {
    Ok(if run.has(wanted)? { Some(run.read_table(wanted)?) } else { None })
}
