//! Small recipes that are run through the pipeline, in a temporary folder.

use super::Failure;
use asperity::artifact::RunView;
use asperity::numerics::Interrupt;
use asperity::pipeline::{self, Selection};
use asperity::recipe::Recipe;
use asperity::surface::Wave;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const RUBBER: &str = include_str!("../../../../data/rubber/table_2_1.toml");

/// A recipe of given waves, in a folder of its own that goes with the value.
pub(super) struct Campaign {
    folder: TempDir,
    recipe: Recipe,
}

impl Campaign {
    /// Waves without their phases, the number of realisations, and sections `[bem]` (after its
    /// rubber) and those after it as text.
    pub fn new(waves: &[Wave], realisations: u32, sections: &str) -> Result<Self, Failure> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("rubber.toml"), RUBBER)?;
        let mut text =
            String::from("title = \"Bench\"\n[[approximate.given]]\nsource = \"bench\"\n");
        text += "scales = [\n";
        for Wave { wavelength, amplitude, .. } in waves {
            let (wavelength, amplitude) = (1e3 * wavelength, 1e3 * amplitude);
            writeln!(text, "{{ wavelength_mm = {wavelength}, amplitude_mm = {amplitude} }},")?;
        }
        let count = waves.len();
        writeln!(text, "]\n[realise]\nwaves = [{count}]\nrealisations = {realisations}\nseed = 1")?;
        writeln!(text, "[bem]\nrubber = \"rubber.toml\"\n{sections}")?;
        let recipe = Recipe::parse(&text, &folder.path().join("recipe.toml"))?;
        Ok(Self { folder, recipe })
    }

    /// Runs every stage into a new folder and hands its results to `read`.
    pub fn run<T>(&self, read: impl FnOnce(&RunView) -> Result<T, Failure>) -> Result<T, Failure> {
        let run = tempfile::tempdir_in(self.path())?;
        let never = Interrupt::default();
        pipeline::run(&self.recipe, run.path(), Selection::default(), &never, &|_| ())?;
        read(&RunView::of(PathBuf::from(run.path())))
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }
}
