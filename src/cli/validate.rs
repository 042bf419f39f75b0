//! `asperity validate`: measured friction beside what is computed for it.

use super::last_run::LastRun;
use super::output::{json, note, print, refuse_existing};
use super::recipe_options::{TakeOver, default_out, recipe_and_origin};
use super::run::bring_up_to_date;
use super::solve::refuse_to_overwrite;
use super::{CliError, figure_file, threads, values};
use asperity::artifact::RunView;
use asperity::error_kind::HasKind;
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::validation::{Judged, JudgedPoint, Set, Validated, judge};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  Measured friction of one compound beside what its recipe computes, with a figure:
    asperity validate set.toml --figure set.svg
  Two compounds on one road: a law of its own for each, one for both, and each predicted by the other, as JSON:
    asperity validate compound_1.toml compound_2.toml --json
  A set is a recipe with a section [validation], which names the measured friction:
    [validation]
    measured = \"friction.csv\"
    width = 0.1

Exit codes: 0 compared, 1 a stage failed or a result could not be written, 2 bad input.";

/// Hold computed friction against measured friction.
///
/// Each SET.toml is a recipe with a section [validation]. Its stages are brought up to date, as `asperity run` does, and each
/// model and kind of surfaces of its tables is put beside the measurement: hysteresis alone, with the shear stress of [adhesion], and
/// with one that is fitted: to each set, to all sets together, and to all other sets, which is a prediction. docs/validation.md
/// explains the bands.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Validate {
    /// Recipes with a section [validation].
    #[arg(value_name = "SET.TOML", required = true)]
    sets: Vec<PathBuf>,
    /// Folder for the run folders, each with the name of its recipe [default: as `asperity run` chooses them].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    folder: TakeOver,
    /// Number of threads; all cores if not given. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print JSON with full precision instead of tables.
    #[arg(long)]
    json: bool,
    /// Also draw friction over speed to this file, .svg or .png.
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    /// Overwrite a figure that is there already.
    #[arg(long)]
    force: bool,
}

/// What is printed as JSON: the headline, and everything.
#[derive(Serialize)]
struct Summary<'a> {
    /// Root mean square misfit of the headline.
    rms: f64,
    /// Its measurements that are inside their 95 % band.
    inside_band: usize,
    /// The same over the number of measurements.
    inside_band_share: f64,
    /// Its measurements.
    points: &'a [JudgedPoint],
    headline: &'a Judged,
    #[serde(flatten)]
    all: &'a Validated,
}

impl Validate {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        if let Some(path) = &self.figure {
            figure_file::is_png(path)?;
            refuse_existing(Some(path), self.force)?;
            if path.is_dir() {
                return Err(CliError::input(format!(
                    "--figure {} is a folder: give a file",
                    path.display()
                )));
            }
        }
        let outs: Vec<PathBuf> = self.sets.iter().map(|set| self.out_of(set)).collect();
        self.refuse_one_folder(&outs)?;
        let recipes = self.sets.iter().map(|path| recipe_and_origin(path, &[], None));
        let recipes = recipes.collect::<Result<Vec<_>, _>>()?;
        self.refuse_over_an_input(recipes.iter().map(|(recipe, _)| recipe))?;
        threads::start(self.threads)?;
        let mut sets = Vec::new();
        for ((path, out), read) in self.sets.iter().zip(&outs).zip(&recipes) {
            sets.push(self.set(path, out, read, quiet)?);
        }
        for warning in sets.iter().flat_map(|set| &set.warnings) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let validated = judge(&sets)?;
        // The table says it itself.
        for reason in validated.left_out.iter().filter(|_| self.json) {
            note(quiet, format_args!("warning: {reason}"));
        }
        let headline = validated.headline().ok_or_else(|| {
            CliError::input(
                "there is nothing to hold against the measurement: the sets have no model and kind of surfaces in common",
            )
        })?;
        if let Some(path) = &self.figure
            && let Some(figure) = validated.figure()
        {
            figure_file::write(path, self.force, &figure)?;
        }
        let summary = Summary {
            rms: headline.rms,
            inside_band: headline.inside_band,
            inside_band_share: headline.inside_band as f64 / headline.points.len() as f64,
            points: &headline.points,
            headline,
            all: &validated,
        };
        print(&if self.json { json(&summary)? } else { validated.text() })
    }

    /// The run folder of a set.
    fn out_of(&self, set: &Path) -> PathBuf {
        match &self.out {
            None => default_out(set),
            Some(out) => out.join(set.file_stem().unwrap_or("set".as_ref())),
        }
    }

    /// Two sets in one folder would overwrite each other.
    fn refuse_one_folder(&self, outs: &[PathBuf]) -> Result<(), CliError> {
        let real = |path: &PathBuf| path.canonicalize().or_else(|_| std::path::absolute(path));
        let same = |a: &PathBuf, b: &PathBuf| match (real(a), real(b)) {
            (Ok(a), Ok(b)) => a == b,
            _ => a == b,
        };
        for (k, out) in outs.iter().enumerate() {
            let one =
                |other: usize| same(&outs[other], out) || same(&self.sets[other], &self.sets[k]);
            if let Some(first) = (0..k).find(|other| one(*other)) {
                return Err(CliError::input(format!(
                    "{} and {} would both be run in {}: rename one of them, or give each set once",
                    self.sets[first].display(),
                    self.sets[k].display(),
                    out.display()
                )));
            }
        }
        Ok(())
    }

    /// A figure never replaces what it is drawn from.
    fn refuse_over_an_input<'a>(
        &self,
        recipes: impl Iterator<Item = &'a Recipe>,
    ) -> Result<(), CliError> {
        let files: Vec<PathBuf> = recipes.flat_map(Recipe::files).collect();
        let inputs: Vec<Option<&Path>> = files.iter().map(|path| Some(path.as_path())).collect();
        refuse_to_overwrite(self.figure.as_deref(), "--figure", &inputs)
    }

    /// A set with its run up to date.
    fn set(
        &self,
        path: &Path,
        out: &Path,
        (recipe, last_run): &(Recipe, LastRun),
        quiet: bool,
    ) -> Result<Set, CliError> {
        let named = |error: asperity::validation::ValidationError| {
            CliError::of(error.kind(), format!("set {}: {error}", path.display()))
        };
        if recipe.validation.is_none() {
            return Err(named(asperity::validation::ValidationError::NoSection));
        }
        if recipe.is_spectrum_alone() {
            return Set::read(recipe, None).map_err(named);
        }
        note(quiet, format_args!("{}", path.display()));
        let selection = Selection::default();
        bring_up_to_date(recipe, last_run, out, selection, self.folder.take_over, quiet)?;
        Set::read(recipe, Some(&RunView::of(out))).map_err(named)
    }
}
