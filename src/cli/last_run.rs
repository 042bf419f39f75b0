//! The note of the last run: the recipe from which the results of a run folder were computed, so that
//! `export` can tell whether they are up to date.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::CliError;
use super::output::{json, note};
use super::recipe_options::{with_scans, with_tolerance};
use asperity::artifact::{Digest, NOTE_FILE, NOTE_HEAD, RunView, TOOL_VERSION, write_note};
use asperity::pipeline::{self, State};
use asperity::recipe::{Recipe, RecipeError};
use asperity::report::html::Origin;
use asperity::stages::Stage;
use asperity::sweep::slurm::shell_path;

const SCHEMA: &str = "asperity.last_run";

/// What `asperity run` was given, as absolute paths.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LastRun {
    /// Always [`SCHEMA`]; empty in notes of earlier versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    schema: String,
    #[serde(with = "asperity::files::name::path")]
    recipe: PathBuf,
    /// The recipe as seen from the run folder, which stays when both are moved.
    #[serde(
        default,
        with = "asperity::files::name::optional_path",
        skip_serializing_if = "Option::is_none"
    )]
    recipe_from_here: Option<PathBuf>,
    /// Scans given on the command line.
    #[serde(with = "asperity::files::name::paths")]
    scans: Vec<PathBuf>,
    /// Tolerance given on the command line.
    #[serde(default)]
    tolerance: Option<f64>,
    /// Text of the recipe, which may be edited later.
    #[serde(default)]
    text: Option<String>,
    #[serde(default)]
    tool_version: Option<String>,
    /// Number of threads.
    #[serde(default)]
    threads: Option<usize>,
    /// Digest of all other fields, to detect damage.
    digest: Digest,
}

impl LastRun {
    /// Name of the note, a file beside the folders of the stages.
    pub(super) const FILE: &str = NOTE_FILE;

    /// # Errors
    /// [`CliError::Failure`] if the working folder is not known.
    pub(super) fn new(
        recipe: &Path,
        text: String,
        scans: &[PathBuf],
        tolerance: Option<f64>,
    ) -> Result<Self, CliError> {
        let absolute = |path: &Path| std::path::absolute(path).map_err(CliError::failure);
        let scans = scans.iter().map(|path| absolute(path)).collect::<Result<_, _>>()?;
        Ok(Self {
            schema: SCHEMA.to_owned(),
            recipe: absolute(recipe)?,
            recipe_from_here: None,
            scans,
            tolerance,
            text: Some(text),
            tool_version: Some(TOOL_VERSION.to_owned()),
            threads: None,
            digest: Digest::of_bytes(&[]),
        })
    }

    /// Fails if the run folder is that of another recipe and must not be taken over, or if a file that asperity did
    /// not write has the name of the note.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn check(&self, out: &Path, take_over: bool) -> Result<(), CliError> {
        let there = Self::refuse_foreign(out)?;
        match there {
            Some(there) if !take_over && !there.is_of(&self.recipe, out) => {
                Err(CliError::input(format!(
                    "{} is the run folder of another recipe, {}: choose another --out, or give --take-over to make it that of {}",
                    out.display(),
                    there.recipe_for(out).display(),
                    self.recipe.display()
                )))
            }
            _ => Ok(()),
        }
    }

    /// The note of a folder, `None` if it is missing or damaged; fails if a file that asperity did not write has its
    /// name.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn refuse_foreign(out: &Path) -> Result<Option<Self>, CliError> {
        let path = out.join(Self::FILE);
        if !path.exists() && !path.is_symlink() {
            return Ok(None);
        }
        let bytes = std::fs::read(&path).unwrap_or_default();
        let there = Self::whole(&bytes).ok();
        if path.is_symlink() || there.is_none() && !bytes.starts_with(NOTE_HEAD.as_bytes()) {
            return Err(CliError::input(format!(
                "{} was not written by asperity, which would have to replace it: move it away, or choose another --out",
                path.display()
            )));
        }
        Ok(there)
    }

    /// Whether the note in the folder `out` is of the recipe at that path.
    fn is_of(&self, recipe: &Path, out: &Path) -> bool {
        same_file(&self.recipe_for(out), recipe)
    }

    /// Present path of the recipe: relative to the run folder if it exists there, since both may have been moved
    /// together, else the path at the time of the run.
    fn recipe_for(&self, out: &Path) -> PathBuf {
        let from_here = self.recipe_from_here.as_ref();
        let from_here = from_here.and_then(|path| out.join(path).canonicalize().ok());
        from_here.filter(|path| path.is_file()).unwrap_or_else(|| self.recipe.clone())
    }

    /// # Errors
    /// As [`Self::check`]; [`CliError::Failure`] if it cannot be written.
    pub(super) fn write(&self, out: &Path, take_over: bool) -> Result<(), CliError> {
        self.check(out, take_over)?;
        let mut note = self.clone();
        note.recipe_from_here = relative(out, &self.recipe);
        // Known once the pool of threads is.
        note.threads = Some(rayon::current_num_threads());
        note.digest = Digest::seal_of(&note).map_err(CliError::failure)?;
        let text = json(&note)?;
        write_note(out, text.as_bytes()).map_err(CliError::failure)
    }

    /// `None` if there is no note, or a damaged one, about which there is a warning.
    pub(super) fn read(out: &Path, quiet: bool) -> Option<Self> {
        let path = out.join(Self::FILE);
        let read = match std::fs::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
            read => read.map_err(|error| error.to_string()).and_then(|bytes| Self::whole(&bytes)),
        };
        match read {
            Ok(last_run) => Some(last_run),
            Err(reason) => {
                let path = path.display();
                note(
                    quiet,
                    format_args!(
                        "warning: {path}: {reason}; whether the results still are those of their recipe \
                         cannot be told (asperity run writes it anew)"
                    ),
                );
                None
            }
        }
    }

    /// Whether the note of a folder is intact, or what is wrong with it; `None` if there is no note.
    pub(super) fn state(out: &Path) -> Option<Result<(), String>> {
        let path = out.join(Self::FILE);
        if !path.exists() {
            return None;
        }
        let whole = std::fs::read(&path)
            .map_err(|error| error.to_string())
            .and_then(|bytes| Self::whole(&bytes));
        Some(whole.map(drop).map_err(|reason| format!("{}: {reason}", path.display())))
    }

    fn whole(bytes: &[u8]) -> Result<Self, String> {
        let read: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        let digest = Digest::seal_of(&read).map_err(|error| error.to_string())?;
        if digest == read.digest { Ok(read) } else { Err("damaged".into()) }
    }

    /// Where the results of a run come from, for its report.
    pub(super) fn origin(self, view: &RunView) -> Origin {
        Origin {
            doubts: self.doubts(view),
            command: Some(self.command(view.path())),
            recipe: self.text,
            tool_version: self.tool_version,
            threads: self.threads,
        }
    }

    /// The recipe of the last run of a folder, as its text stood then; `None` if this version cannot read it.
    pub(super) fn recipe_of(&self, out: &Path) -> Option<Recipe> {
        Recipe::parse(self.text.as_ref()?, &self.recipe_for(out)).ok()
    }

    /// Why results are not what the recipe asks for, by stage; stages without a result are left out.
    pub(super) fn doubts(&self, view: &RunView) -> BTreeMap<Stage, String> {
        let stages = Stage::ALL.into_iter();
        let there = stages.filter(|stage| view.path().join(stage.name()).exists());
        there.filter_map(|stage| Some((stage, self.doubt(view.path(), stage.name())?))).collect()
    }

    /// The command that brings the folder up to date, for a shell.
    fn command(&self, out: &Path) -> String {
        let mut words = vec!["asperity".to_owned(), "run".into(), quoted(&self.recipe_for(out))];
        if !self.scans.is_empty() {
            words.push("--scans".into());
            words.extend(self.scans.iter().map(|path| quoted(path)));
        }
        if let Some(tolerance) = self.tolerance {
            words.extend(["--tolerance".into(), tolerance.to_string()]);
        }
        words.extend(["--out".into(), quoted(out)]);
        words.join(" ")
    }

    /// Why the result of a stage in the folder `out` is not what the recipe asks for, the present one or the text that
    /// the last run read; `None` if it is.
    pub(super) fn doubt(&self, out: &Path, stage: &str) -> Option<String> {
        self.doubt_by_recipe(out, stage).or_else(|| self.doubt_by_note(out, stage))
    }

    /// What a recipe in place of that of the last run asks for, stage by stage.
    fn states(
        &self,
        recipe: Result<Recipe, RecipeError>,
        out: &Path,
    ) -> Result<Vec<(Stage, State)>, CliError> {
        let recipe = with_scans(recipe?, &self.recipe_for(out), &self.scans)?;
        Ok(pipeline::status(&with_tolerance(recipe, self.tolerance)?, out)?)
    }

    /// A note that was copied from another run folder, or that a run of other stages has left.
    fn doubt_by_note(&self, out: &Path, stage: &str) -> Option<String> {
        let path = self.recipe_for(out);
        let text = self.text.as_ref()?;
        if asperity::files::read_settings(&path).is_ok_and(|now| now == *text) {
            return None;
        }
        // A text that this version cannot read any more tells nothing; the recipe has had its say.
        let states = self.states(Recipe::parse(text, &path), out).ok()?;
        let stale = states.iter().find_map(|(known, state)| match state {
            State::Stale(reasons) if known.name() == stage => Some(reasons),
            _ => None,
        })?;
        Some(format!(
            "{stage} is not what the text of the last run in {} asks for ({}): `asperity run` writes it anew",
            out.join(Self::FILE).display(),
            first_cause(&states, stale)
        ))
    }

    fn doubt_by_recipe(&self, out: &Path, stage: &str) -> Option<String> {
        let path = self.recipe_for(out);
        let recipe = path.display();
        let states = match self.states(Recipe::read(&path), out) {
            Ok(states) => states,
            Err(error) => {
                return Some(format!(
                    "whether {stage} is up to date cannot be told from the recipe of its last run: \
                     {error}"
                ));
            }
        };
        let Some((_, state)) = states.iter().find(|(known, _)| known.name() == stage) else {
            return Some(format!(
                "{stage} is left over from an earlier run: {recipe} has no such stage any more"
            ));
        };
        let State::Stale(reasons) = state else { return None };
        Some(format!(
            "{stage} is not what {recipe} asks for ({}): `asperity run` brings it up to date",
            first_cause(&states, reasons)
        ))
    }
}

/// Whether two paths lead to one file; if there is no file, whether they are equal.
fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// The path of a file relative to a folder; `None` if one of them does not exist.
fn relative(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (folder, file) = (folder.canonicalize().ok()?, file.canonicalize().ok()?);
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    Some(up.chain(file.components().skip(common)).collect())
}

/// A path as one word of a shell.
fn quoted(path: &Path) -> String {
    shell_path(path)
}

/// The reasons, or those of the stage before that they refer to.
fn first_cause(states: &[(Stage, State)], reasons: &[String]) -> String {
    let inherited = states.iter().find_map(|(stage, state)| match state {
        State::Stale(why) if reasons == [format!("{stage} is stale")] => {
            Some(format!("{stage}: {}", why.join("; ")))
        }
        _ => None,
    });
    inherited.unwrap_or_else(|| reasons.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(recipe: &Path) -> LastRun {
        LastRun::new(recipe, "title = 'one'".into(), &[], None).unwrap()
    }

    /// Files in the folders of two projects, of one name.
    fn projects() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for project in ["a", "b"] {
            std::fs::create_dir_all(folder.path().join(project).join("out")).unwrap();
            std::fs::write(folder.path().join(project).join("recipe.toml"), "").unwrap();
        }
        folder
    }

    #[test]
    fn a_run_folder_is_that_of_one_recipe() {
        let folder = projects();
        let (a, b) = (folder.path().join("a/recipe.toml"), folder.path().join("b/recipe.toml"));
        let out = folder.path().join("a/out");
        note(&a).write(&out, false).unwrap();
        let text = std::fs::read_to_string(out.join(LastRun::FILE)).unwrap();
        assert!(text.starts_with(NOTE_HEAD), "{text}");
        note(&a).check(&out, false).unwrap();
        let refused = note(&b).check(&out, false).unwrap_err().to_string();
        assert!(refused.contains("a/recipe.toml") && refused.contains("--take-over"), "{refused}");
        note(&b).check(&out, true).unwrap();
    }

    #[test]
    fn a_project_may_be_moved_or_copied_as_a_whole_and_a_run_folder_alone() {
        let folder = projects();
        let at = |name: &str| folder.path().join(name);
        note(&at("a/recipe.toml")).write(&at("a/out"), false).unwrap();
        // A copy of the project is a project of its own.
        std::fs::copy(at("a/out/last_run.json"), at("b/out/last_run.json")).unwrap();
        note(&at("b/recipe.toml")).check(&at("b/out"), false).unwrap();
        assert!(note(&at("a/recipe.toml")).check(&at("b/out"), false).is_err());
        std::fs::rename(at("a"), at("moved")).unwrap();
        note(&at("moved/recipe.toml")).check(&at("moved/out"), false).unwrap();
        // The run folder alone is known by where its recipe was.
        note(&at("moved/recipe.toml")).write(&at("moved/out"), false).unwrap();
        std::fs::create_dir_all(at("far/away")).unwrap();
        std::fs::rename(at("moved/out"), at("far/away/out")).unwrap();
        note(&at("moved/recipe.toml")).check(&at("far/away/out"), false).unwrap();
        assert!(note(&at("b/recipe.toml")).check(&at("far/away/out"), true).is_ok());
        assert!(note(&at("b/recipe.toml")).check(&at("far/away/out"), false).is_err());
    }

    #[test]
    fn a_file_of_the_same_name_stays() {
        let folder = projects();
        let (recipe, out) = (folder.path().join("a/recipe.toml"), folder.path().join("a/out"));
        for text in ["", "{\"runs\": 7}", "notes"] {
            std::fs::write(out.join(LastRun::FILE), text).unwrap();
            let refused = note(&recipe).write(&out, true).unwrap_err();
            assert_eq!(refused.exit_code(), 2);
            assert_eq!(std::fs::read_to_string(out.join(LastRun::FILE)).unwrap(), text);
        }
    }
}
