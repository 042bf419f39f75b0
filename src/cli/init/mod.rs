//! `asperity init`: a folder to start in.
//!
//! | module | what it holds |
//! |---|---|
//! | `ladder` | the ladder of waves: from the shortest that the spacing of the scans resolves to half their length |
//! | `look` | what a recipe needs to know of the scans: how they are read, their lengths and spacings |
//! | `relative` | paths of a recipe, relative to its folder |

mod ladder;
mod look;
mod relative;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::output::{note, print, write_file};
use asperity::recipe::Recipe;
use asperity::scans::file::MapLines;
use ladder::Ladder;
use look::Look;
use relative::{quoted, relative};

/// The recipe with placeholders for what depends on the scans.
const RECIPE: &str = include_str!("recipe.toml");
/// The rubber of the thesis, to be replaced by the user's own.
const RUBBER: &str = include_str!("../../../data/rubber/table_2_1.toml");
/// Description of text scans if there are no scans yet.
const TEXT: &str = "\
# How text files and workbooks (.xlsx) are read; `asperity inspect FILE` proposes this section. Files of instruments
# (SDF, X3P, Digital Surf, ERD ...) need none.
[ingest.text]
separator = \"semicolon\"
comment = \"#\"
x_column = \"x_mm\"
x_unit = \"mm\"
z_column = \"z_um\"
z_unit = \"um\"
missing = [\"BAD\"]
";

const EXAMPLES: &str = "\
Examples:
  A folder for scans that come later:
    asperity init my_road
  For scans that are there; all of them are looked at, and the first text shows how texts are read:
    asperity init my_road --scans data/scans/specimen";

/// Make a project folder with a commented recipe and a rubber.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Init {
    /// Folder to make.
    folder: PathBuf,
    /// Scan files or folders of them, which the recipe will name; a folder `scans` is made if not given.
    #[arg(long, value_name = "PATH", num_args = 1..)]
    scans: Vec<PathBuf>,
}

impl Init {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError::Input`] for a folder that is not empty, or scans that cannot be read.
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let folder = &self.folder;
        let occupied = match fs::read_dir(folder) {
            Ok(mut entries) => entries.next().is_some(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
            Err(error) => {
                let folder = folder.display();
                return Err(CliError::input(format!("cannot look into {folder}: {error}")));
            }
        };
        if occupied {
            return Err(CliError::input(format!(
                "{} is not empty: give a new folder",
                folder.display()
            )));
        }
        let (scans, look) = self.scans()?;
        let ladder = Ladder::of(&look.extents);
        let recipe = RECIPE
            .replace("@SCANS@\n", &format!("{scans}\n{}", map_lines(look.map_lines)))
            .replace("@TEXT@\n", &format!("{}\n", look.text_section))
            .replace("@WAVES@", &format!("[{}]", ladder.waves))
            .replace("@RESOLUTION@\n", &lengths(&ladder))
            .replace("@SHORTEST@", &ladder.shortest_wavelength_mm.to_string());
        let path = folder.join("recipe.toml");
        let checked = Recipe::parse(&recipe, &path);
        let make = |path: &Path| {
            fs::create_dir_all(path).map_err(|error| CliError::no_folder(path, &error))
        };
        make(folder)?;
        if self.scans.is_empty() {
            make(&folder.join("scans"))?;
        }
        write_file(&path, false, |file| file.write_all(recipe.as_bytes()))?;
        write_file(&folder.join("rubber.toml"), false, |file| file.write_all(RUBBER.as_bytes()))?;
        for line in look.notes.iter().chain(&ladder.notes) {
            note(quiet, line);
        }
        if let Err(error) = checked {
            note(quiet, format!("to be completed before it runs: {error}"));
        }
        let next = if self.scans.is_empty() {
            format!("put the scans into {}, then ", folder.join("scans").display())
        } else {
            String::new()
        };
        print(&format!(
            "made {}\n{next}read the recipe and try `asperity plan {}`\n",
            folder.display(),
            path.display()
        ))
    }

    /// The list of scans for the recipe, and what was found in them.
    fn scans(&self) -> Result<(String, Look), CliError> {
        if self.scans.is_empty() {
            let (text_section, extents) = (TEXT.into(), Vec::new());
            let look = Look { text_section, map_lines: None, extents, notes: Vec::new() };
            return Ok(("[\"scans\"]".into(), look));
        }
        let way = |path: &Path| relative(&self.folder, path);
        let names: Vec<String> =
            self.scans.iter().map(|path| quoted(&way(path)?)).collect::<Result<_, _>>()?;
        let name =
            |path: &Path| way(path).unwrap_or_else(|_| path.to_owned()).display().to_string();
        let look = Look::at(&look::files(&self.scans)?, name)?;
        Ok((format!("[{}]", names.join(", ")), look))
    }
}

/// The keys for height maps, where there are some.
fn map_lines(lines: Option<MapLines>) -> String {
    let word = match lines {
        None => return String::new(),
        Some(MapLines::Rows) => "rows",
        Some(MapLines::Columns) => "columns",
    };
    format!(
        "map_lines = \"{word}\"                 # lines of the height maps that become scans: \"rows\" or \"columns\"\n\
         # map_line_step = 10               # every tenth line\n"
    )
}

/// The keys for lengths of the scans.
fn lengths(ladder: &Ladder) -> String {
    let resolution = match ladder.lateral_resolution_um {
        Some(resolution) => format!("lateral_resolution_um = {resolution:?}\n"),
        None => "# lateral_resolution_um = 50.0\n".into(),
    };
    let window = ladder.window_length_mm.map(|length| format!("window_length_mm = {length:?}\n"));
    resolution + &window.unwrap_or_default()
}
