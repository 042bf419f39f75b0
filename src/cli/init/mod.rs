//! `asperity init`: a folder to start in.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::output::{note, print, write_file};
use crate::recipe::Recipe;
use crate::scans::file::{Family, MapLines, parse_file};
use crate::scans::text_shape::TextShape;
use crate::scans::{parse_text, read_bytes};
use crate::surface::RawScan;

/// The recipe with marks for what depends on the scans.
const RECIPE: &str = include_str!("recipe.toml");
/// The rubber of the thesis, until there is a better one.
const RUBBER: &str = include_str!("../../../data/rubber/table_2_1.toml");
/// Description of text scans where no file shows one.
const TEXT: &str = "\
# How text files are read; `asperity inspect FILE` proposes this section. Files of instruments (SDF, X3P, Digital
# Surf, ERD) need none.
[ingest.text]
separator = \"semicolon\"
comment = \"#\"
x_column = \"x_mm\"
x_unit = \"mm\"
z_column = \"z_um\"
z_unit = \"um\"
missing = [\"BAD\"]
";

/// The ladder of the thesis: its shortest wave in mm and the number of its waves.
const LADDER: (f64, u32) = (0.0625, 8);
/// Points that the shortest wave needs.
const POINTS_ON_SHORTEST: f64 = 8.0;
/// Lateral resolution in shortest waves where the scan is finer: two points of it are 0.8 waves.
const RESOLUTION: f64 = 0.8;
/// A wave is told from a form by scans twice as long.
const LENGTHS_IN_SCAN: f64 = 2.0;

const EXAMPLES: &str = "\
Examples:
  A folder for scans that come later:
    asperity init my_road
  For scans that are there; the first of them shows how they are read:
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

/// What the first scan says of the recipe.
struct FromScan {
    text_section: String,
    shortest_wavelength_mm: f64,
    waves: u32,
    /// Where the scan is finer than the shortest wave needs.
    lateral_resolution_um: Option<f64>,
    notes: Vec<String>,
}

impl FromScan {
    fn resolution_line(&self) -> String {
        match self.lateral_resolution_um {
            Some(resolution) => format!("lateral_resolution_um = {resolution:?}"),
            None => "# lateral_resolution_um = 50.0".into(),
        }
    }
}

impl Init {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError::Input`] for a folder that has something in it, or scans that cannot be read.
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
        let (scans, found) = self.scans()?;
        let recipe = RECIPE
            .replace("@SCANS@", &scans)
            .replace("@TEXT@\n", &format!("{}\n", found.text_section))
            .replace("@WAVES@", &format!("[{}]", found.waves))
            .replace("@RESOLUTION@", &found.resolution_line())
            .replace("@SHORTEST@", &found.shortest_wavelength_mm.to_string());
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
        for line in &found.notes {
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

    /// The list of scans as it stands in the recipe, and what their first one says.
    fn scans(&self) -> Result<(String, FromScan), CliError> {
        let Some(first) = self.scans.first() else {
            let (shortest_wavelength_mm, waves) = LADDER;
            let text_section = TEXT.into();
            let notes = Vec::new();
            let found = FromScan {
                text_section,
                shortest_wavelength_mm,
                waves,
                lateral_resolution_um: None,
                notes,
            };
            return Ok(("[\"scans\"]".into(), found));
        };
        let absolute = |path: &PathBuf| {
            fs::canonicalize(path)
                .map_err(|error| CliError::input(format!("{}: {error}", path.display())))
        };
        let paths: Vec<PathBuf> = self.scans.iter().map(absolute).collect::<Result<_, _>>()?;
        let names: Vec<String> =
            paths.iter().map(|path| format!("{:?}", path.display().to_string())).collect();
        let file = first_file(&absolute(first)?)?;
        Ok((format!("[{}]", names.join(", ")), from_scan(&file)?))
    }
}

/// The file itself, or the first by name in a folder.
fn first_file(path: &Path) -> Result<PathBuf, CliError> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let failed = |error| CliError::input(format!("cannot read {}: {error}", path.display()));
    let mut files = Vec::new();
    for entry in fs::read_dir(path).map_err(failed)? {
        let file = entry.map_err(failed)?.path();
        let hidden = file.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if file.is_file() && !hidden {
            files.push(file);
        }
    }
    files.sort();
    let none = || CliError::input(format!("{} holds no file", path.display()));
    files.into_iter().next().ok_or_else(none)
}

fn from_scan(file: &Path) -> Result<FromScan, CliError> {
    let bytes = read_bytes(file)
        .map_err(|error| CliError::input(format!("cannot read {}: {error}", file.display())))?;
    if Family::detect(&bytes).is_some() {
        let name = file.display().to_string();
        let read = parse_file(&name, &bytes)?;
        let scan = read.map(|file| file.line_scans("scan", MapLines::Rows, 1));
        let scan = scan
            .transpose()
            .map_err(|problem| CliError::input(format!("{}: {problem}", file.display())))?;
        let scan = scan.and_then(|scans| scans.into_iter().next());
        return Ok(ladder(scan, String::new(), Vec::new()));
    }
    let shape = TextShape::of(&bytes).ok_or_else(|| {
        CliError::input(format!("{} is text without lines of numbers: no scan", file.display()))
    })?;
    let name = file.display().to_string();
    let section =
        format!("# Proposed from {name}: check it against the file.\n{}", shape.recipe_section());
    let format = shape.format();
    let (scan, note) = match format.map(|format| parse_text(&name, &bytes, &format)) {
        Ok(Ok(scan)) => (Some(scan), None),
        Ok(Err(error)) => (None, Some(format!("{error}; correct [ingest.text]"))),
        Err(keys) => {
            let keys = keys.join(", ");
            let note = format!(
                "{name} does not state {keys}: units are never guessed, set them in [ingest.text]"
            );
            (None, Some(note))
        }
    };
    Ok(ladder(scan, section, note.into_iter().collect()))
}

/// The ladder of waves between what the spacing of a scan resolves and half its length.
fn ladder(scan: Option<RawScan>, text_section: String, mut notes: Vec<String>) -> FromScan {
    let (mut shortest_wavelength_mm, mut waves) = LADDER;
    let mut lateral_resolution_um = None;
    if let Some((spacing, length)) = scan.as_ref().and_then(extent) {
        while shortest_wavelength_mm < POINTS_ON_SHORTEST * spacing * 1e3 {
            shortest_wavelength_mm *= 2.0;
        }
        // Each point stands for one spacing. Round-off must not cost a wave.
        let longest_mm = 1e3 * (length + spacing) / LENGTHS_IN_SCAN;
        let octaves = ((longest_mm / shortest_wavelength_mm).log2() + 1e-9).floor();
        waves = (octaves + 1.0).clamp(1.0, 12.0) as u32;
        if POINTS_ON_SHORTEST * spacing * 1e3 < shortest_wavelength_mm * (1.0 - 1e-6) {
            lateral_resolution_um = Some(RESOLUTION * shortest_wavelength_mm * 1e3);
        }
        notes.push(format!(
            "the first scan is {:.1} mm long with {:.1} um between points: {waves} waves from {shortest_wavelength_mm} mm",
            length * 1e3,
            spacing * 1e6
        ));
    }
    FromScan { text_section, shortest_wavelength_mm, waves, lateral_resolution_um, notes }
}

/// Mean spacing and length in m.
fn extent(scan: &RawScan) -> Option<(f64, f64)> {
    let [first, .., last] = scan.positions[..] else { return None };
    let length = (last - first).abs();
    Some((length / (scan.positions.len() - 1) as f64, length))
}
