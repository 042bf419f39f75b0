//! Where the files of a sweep are.
//!
//! ```text
//! OUT/
//!   plans/0123456789abcdef/   a plan: plan.json and a list of tasks for each shard
//!   surfaces/specimen=A/      ingest to realise, for each specimen and seed
//!   solves/ab/….pack          the solves of a task, written by its shard
//!   cases/specimen=A/rubber=b/    a run folder for each case, linked to its surfaces and the solves
//!   sweep/friction.arrow      the tables of all cases
//! ```

use super::prepare::SURFACE_STAGES;
use super::{STAGE, SweepError};
use crate::artifact::{ArtifactError, Manifest, RunView, SOLVES_FOLDER};
pub use crate::artifact::{CASES_FOLDER, SURFACES_FOLDER};
use crate::pipeline;
use crate::recipe::Case;
use crate::stages::Stage;
use std::io;
use std::path::{Path, PathBuf};

const PLANS: &str = "plans";
/// File of a plan in its folder.
pub(super) const PLAN_FILE: &str = "plan.json";
/// The recipe of a case, in its folder.
pub const RECIPE_FILE: &str = "recipe.toml";

/// The folder of a sweep.
#[derive(Debug, Clone)]
pub struct Layout {
    out: PathBuf,
}

impl Layout {
    /// The sweep in the folder `out`.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self { out: out.into() }
    }

    /// The sweep that the plan at `path` is part of.
    ///
    /// # Errors
    /// [`SweepError::NoPlan`] for a path that is none of a plan in its sweep.
    pub fn of_plan(path: &Path) -> Result<Self, SweepError> {
        let mut folders = path.ancestors().skip(1);
        let found = (folders.next(), folders.next(), folders.next());
        let name = |folder: &Path| folder.file_name().unwrap_or_default().to_owned();
        match found {
            (Some(_), Some(plans), Some(out)) if name(plans) == PLANS => Ok(Self::new(out)),
            _ => Err(SweepError::NoPlan { path: path.to_owned() }),
        }
    }

    /// The folder itself.
    pub fn out(&self) -> &Path {
        &self.out
    }

    /// The solves of all cases.
    pub fn solves(&self) -> PathBuf {
        self.out.join(SOLVES_FOLDER)
    }

    /// What the jobs of a plan print.
    pub fn logs(&self) -> PathBuf {
        self.out.join("logs")
    }

    /// The plans, each in a folder that is named by its digest.
    pub(super) fn plans(&self) -> PathBuf {
        self.out.join(PLANS)
    }

    pub(super) fn surfaces(&self, case: &Case) -> PathBuf {
        self.out.join(SURFACES_FOLDER).join(&case.surfaces)
    }

    /// The run folder of a case.
    pub fn case(&self, case: &Case) -> PathBuf {
        self.out.join(CASES_FOLDER).join(&case.folder)
    }

    /// Fails for what asperity did not write where results of the sweep or of these cases would go, before
    /// anything is computed.
    ///
    /// # Errors
    /// [`ArtifactError::Foreign`].
    pub fn check(&self, cases: &[Case]) -> Result<(), SweepError> {
        let view = RunView::of(&self.out);
        view.check_place(STAGE)?;
        view.check_solves()?;
        for folder in [self.plans(), self.logs()] {
            self.check_links(&folder)?;
        }
        for case in cases {
            let stages = pipeline::stages(&case.recipe)?;
            for (folder, stages) in
                [(self.surfaces(case), &SURFACE_STAGES[..]), (self.case(case), &stages)]
            {
                self.check_links(&folder)?;
                let view = RunView::of(folder);
                view.check_solves()?;
                // Another result is looked at when it must give way.
                let none = |stage: &&Stage| !view.file(stage.name(), Manifest::FILE).exists();
                stages.iter().filter(none).try_for_each(|stage| view.check_place(stage.name()))?;
            }
            super::collect::check_recipe(&self.case(case))?;
        }
        Ok(())
    }

    /// Fails for a folder on the way from that of the sweep that is a link to elsewhere.
    pub(super) fn check_links(&self, folder: &Path) -> Result<(), SweepError> {
        let inside = folder.ancestors().take_while(|folder| *folder != self.out);
        for folder in inside {
            if folder.is_symlink() {
                return Err(ArtifactError::foreign_link(folder).into());
            }
        }
        Ok(())
    }

    /// Makes `link` lead to `target`, both below the folder of the sweep, which may be moved as a whole. What
    /// is there already stays.
    pub(super) fn link(&self, target: &Path, link: &Path) -> Result<(), SweepError> {
        let failed = |source| SweepError::Io { action: "link", path: link.to_owned(), source };
        let below = |path: &Path| path.strip_prefix(&self.out).unwrap_or(path).to_owned();
        let (target, inner) = (below(target), below(link));
        let up = inner.components().skip(1).map(|_| "..");
        let relative: PathBuf = up.collect::<PathBuf>().join(target);
        let folder = link.parent().unwrap_or(&self.out);
        self.check_links(folder)?;
        std::fs::create_dir_all(folder).map_err(failed)?;
        match crate::files::os::link(relative, link) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(failed(error)),
            _ => Ok(()),
        }
    }
}
