//! What a recipe needs to know of the scans: how they are read, their lengths and spacings.

use std::fs;
use std::path::{Path, PathBuf};

use super::ladder::Extent;
use crate::cli::CliError;
use asperity::scans::file::{Grid, MapLines, ScanFile, parse_file};
use asperity::scans::text_shape::TextShape;
use asperity::scans::{Described, TextFormat, parse_described, read_bytes};

/// What was found in the files.
pub(super) struct Look {
    /// The section that describes the texts; empty without texts.
    pub(super) text_section: String,
    /// Which lines of the height maps are longer, where there are maps.
    pub(super) map_lines: Option<MapLines>,
    /// Spacing and length of each scan that can be read.
    pub(super) extents: Vec<Extent>,
    pub(super) notes: Vec<String>,
}

impl Look {
    /// Reads files; the first text shows how texts are read.
    ///
    /// # Errors
    /// [`CliError::Input`] if the first file cannot be read, or holds no scan.
    pub(super) fn at(files: &[PathBuf], name: impl Fn(&Path) -> String) -> Result<Self, CliError> {
        let mut look = Self {
            text_section: String::new(),
            map_lines: None,
            extents: Vec::new(),
            notes: Vec::new(),
        };
        let mut format: Option<Result<TextFormat, Vec<&'static str>>> = None;
        let mut failed: Vec<String> = Vec::new();
        for file in files {
            let bytes = read_bytes(file).map_err(|error| {
                CliError::input(format!("cannot read {}: {error}", file.display()))
            })?;
            let read = match parse_file(&file.display().to_string(), &bytes) {
                Ok(Some(scan)) => {
                    look.take_grid(&scan);
                    Ok(())
                }
                Ok(None) => look.text(file, &bytes, &mut format, &name),
                Err(error) => Err(error.to_string()),
            };
            match read {
                Ok(()) => {}
                Err(error) if look.is_blank(&format) => return Err(CliError::input(error)),
                Err(error) => failed.push(error),
            }
        }
        if let Some(first) = failed.first() {
            let (count, all) = (failed.len(), files.len());
            look.notes.push(format!(
                "{count} of {all} files cannot be read like this, the first: {first}"
            ));
        }
        Ok(look)
    }

    /// Whether no file has shown anything yet.
    fn is_blank(&self, format: &Option<Result<TextFormat, Vec<&'static str>>>) -> bool {
        self.extents.is_empty() && format.is_none()
    }

    fn text(
        &mut self,
        file: &Path,
        bytes: &[u8],
        format: &mut Option<Result<TextFormat, Vec<&'static str>>>,
        name: impl Fn(&Path) -> String,
    ) -> Result<(), String> {
        if format.is_none() {
            let shape = TextShape::of(bytes).ok_or_else(|| {
                format!("{} is text without lines of numbers, not a scan", file.display())
            })?;
            let (name, section) = (name(file), shape.recipe_section());
            self.text_section =
                format!("# Proposed from {name}: check it against the file.\n{section}");
            if shape.is_map() {
                self.map_lines = Some(MapLines::Rows);
            }
            if let Err(keys) = shape.format() {
                self.notes.push(format!(
                    "{name} does not state {}: units are never guessed, set them in [ingest.text]",
                    keys.join(", ")
                ));
            }
            *format = Some(shape.format());
        }
        let Some(Ok(format)) = format else { return Ok(()) };
        let name = file.display().to_string();
        match parse_described(&name, bytes, format).map_err(|error| error.to_string())? {
            Described::Line(scan) => self.extents.extend(Extent::of(&scan.positions)),
            Described::Map(map) => self.take_grid(&map),
        }
        Ok(())
    }

    /// Takes the longer lines of a map, since they show more of the long waves.
    fn take_grid(&mut self, scan: &ScanFile) {
        let line = |points: usize, spacing: f64| Extent { points, spacing };
        match scan.grid {
            Grid::Profile { spacing } => self.extents.push(line(scan.heights.len(), spacing)),
            Grid::Map { columns, rows, spacing_x, spacing_y } => {
                let (along, across) = (line(columns, spacing_x), line(rows, spacing_y));
                let lines = *self.map_lines.get_or_insert(if along.length() >= across.length() {
                    MapLines::Rows
                } else {
                    MapLines::Columns
                });
                self.extents.push(if lines == MapLines::Rows { along } else { across });
            }
        }
    }
}

/// The files of paths, of a folder in the order of their names.
///
/// # Errors
/// [`CliError::Input`] for a path that is not there or a folder without files.
pub(super) fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let failed = |error| CliError::input(format!("cannot read {}: {error}", path.display()));
        let mut within = Vec::new();
        for entry in fs::read_dir(path).map_err(failed)? {
            let file = entry.map_err(failed)?.path();
            let hidden =
                file.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if hidden {
                continue;
            }
            // Without this, a link to a missing drive would be a scan left out silently.
            let found = fs::metadata(&file).map_err(|error| {
                CliError::input(format!("cannot read {}: {error}", file.display()))
            })?;
            if found.is_file() {
                within.push(file);
            }
        }
        if within.is_empty() {
            return Err(CliError::input(format!("{} holds no file", path.display())));
        }
        within.sort();
        files.extend(within);
    }
    Ok(files)
}
