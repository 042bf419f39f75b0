//! Stored single solves.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::cli::CliError;
use crate::cli::output::aligned;
use asperity::artifact::{SOLVE_SCHEMA, StoredSolve, read_stored_solve};

/// A stored solve, from which an interrupted run continues.
#[derive(Debug, Serialize)]
pub(super) struct Solve {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    #[serde(flatten)]
    stored: StoredSolve,
}

impl Solve {
    /// Whether a JSON file states that it is a stored solve.
    pub(super) fn is_in(path: &Path) -> bool {
        #[derive(Deserialize)]
        struct Header {
            schema: String,
        }
        let header =
            std::fs::read(path).ok().and_then(|b| serde_json::from_slice::<Header>(&b).ok());
        header.is_some_and(|header| header.schema == SOLVE_SCHEMA)
    }

    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        let stored = read_stored_solve(path)?;
        Ok(Self { path: path.to_path_buf(), stored })
    }

    pub(super) fn text(&self) -> String {
        let StoredSolve { version, key, intact, payload } = &self.stored;
        let state = if *intact { "intact" } else { "CHANGED since it was written" };
        let lines = [
            ("stored solve", self.path.display().to_string()),
            ("schema", format!("{SOLVE_SCHEMA} version {version}")),
            ("key", format!("{key:#}")),
            ("content", state.to_owned()),
        ];
        format!("{}result\n{payload:#}\n", aligned(&lines))
    }
}
