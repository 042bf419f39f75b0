//! `asperity export`: friction tables for people and other programs.
//!
//! | module | what it holds |
//! |---|---|
//! | `study` | export of the study of one sine wave |
//! | `sweep` | the tables of all cases of a sweep |

mod study;
mod sweep;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::CliError;
use super::last_run::LastRun;
use super::output::{note, print, refuse_existing, write_file};
use super::run_folder;
use asperity::artifact::{ArtifactError, ExportTable, RunView};
use asperity::report::{
    About, FrictionTable, comparison_markdown, friction_figure, friction_tables, latex, long_table,
    markdown, values_table, workbook,
};
use asperity::stages::Stage;
use asperity::stages::ingest::{FAULTS, MAP_WINDOWS, REPORT, WINDOWS, cleaning_markdown};
use asperity::stages::realise::{Method, SurfaceKind};
use asperity::stages::tables::{
    COMPARISON, CORRECTIONS, EFFECTS, EffectRow, FRICTION, FrictionRow, Model, NOTE_KEY, TOTAL,
    TotalRow,
};
use asperity::sweep::STAGE;

const EXAMPLES: &str = "\
Examples:
  Every value of every realisation as one table, for statistics elsewhere:
    asperity export runs/asphalt --format csv --layout long --to values.csv
  All tables of a run, one CSV file each:
    asperity export runs/asphalt --format csv --to tables
  One table on standard output, in the layout of the published ones:
    asperity export runs/asphalt --format markdown --waves 8 --speed 10
  All tables for a paper, as one Parquet table, and as a figure:
    asperity export runs/asphalt --format latex --to friction.tex
    asperity export runs/asphalt --format parquet --to friction.parquet
    asperity export runs/asphalt --format xlsx --to friction.xlsx
    asperity export runs/asphalt --format svg --to friction.svg
  The local corrections of the hybrid method, one by one:
    asperity export runs/asphalt --table hybrid/local --format csv --to local.csv
  What was cleaned from the scans, and what that means for their slope:
    asperity export runs/captif --format markdown --cleaning --to cleaning.md
  All cases of a sweep as one table with the specimen, rubber, temperature and seed of each row:
    asperity export runs/sweep --format csv --to sweep.csv
  The study of one sine wave as a document, a figure and one CSV file for each table:
    asperity export runs/sinusoid --format markdown --to study.md
    asperity export runs/sinusoid --format svg --to study.svg
    asperity export runs/sinusoid --format csv --to study";

/// Export the averaged friction tables of a run.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Export {
    /// Run folder.
    run: PathBuf,
    /// Format: csv and markdown and latex in the layout of the published tables, parquet as one
    /// long table, xlsx as a workbook with a sheet for each and for total friction and friction with heat and softening,
    /// svg as the figure of `asperity plot friction`.
    #[arg(long, value_enum)]
    format: Format,
    /// The computed tables beside the published ones that the recipe names, as a Markdown document.
    #[arg(long)]
    comparison: bool,
    /// What was found wrong in the scans and what was done with it, as a Markdown document.
    #[arg(long, conflicts_with_all = ["comparison", "table", "model", "method", "waves", "speed"])]
    cleaning: bool,
    /// Any one table of the run, such as hybrid/local, as csv or parquet.
    #[arg(long, value_name = "STAGE/TABLE", conflicts_with_all = ["comparison", "model", "method", "waves", "speed"])]
    table: Option<String>,
    /// File to write, or for several CSV tables the folder; standard output if not given.
    #[arg(long, value_name = "PATH")]
    to: Option<PathBuf>,
    /// Only surfaces that are made of the road in this way.
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Only this number of sines.
    #[arg(long, value_name = "N", value_parser = super::values::count::<u32>, allow_negative_numbers = true)]
    waves: Option<u32>,
    /// Only this speed in mm/s.
    #[arg(long, value_name = "MM_S", value_parser = super::values::positive, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Only this contact model.
    #[arg(long, value_enum)]
    model: Option<Model>,
    /// Layout of csv and parquet: wide has a column for each realisation, long a row for each value of each realisation.
    #[arg(long, value_enum, default_value_t = Layout::Wide)]
    layout: Layout,
    /// Overwrite files that are there already.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Layout {
    Wide,
    Long,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Csv,
    Markdown,
    Latex,
    Parquet,
    Xlsx,
    Svg,
}

impl Format {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl Export {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let view = run_folder::view(&self.run)?;
        self.check_name()?;
        if self.cleaning {
            return self.cleaning(&view, quiet);
        }
        if let Some(table) = &self.table {
            return self.one_table(&view, table, quiet);
        }
        if view.stage_manifest(STAGE)?.is_some() {
            return self.sweep(&view);
        }
        if view.stage_manifest("sinusoid")?.is_some() {
            self.warn_of_doubt("sinusoid", quiet);
            return self.study(&view);
        }
        self.warn_of_doubt("tables", quiet);
        let rows = view.rows(FRICTION)?;
        if self.comparison {
            return self.comparison(&view);
        }
        let rows: Vec<FrictionRow> = rows.into_iter().filter(|row| self.chosen(row)).collect();
        if rows.is_empty() {
            return Err(CliError::input(format!(
                "{} has no table of that model, method, number of waves and speed: leave --model, --method, \
                 --waves or --speed out to see all",
                self.run.display()
            )));
        }
        let tables = friction_tables(&rows);
        let about = About::of(&view)?;
        if self.layout == Layout::Long {
            return self.long(&rows);
        }
        match self.format {
            Format::Csv => self.csv(&tables),
            Format::Markdown => self.text(&markdown(&tables, &about)),
            Format::Latex => self.text(&latex(&tables, &about)),
            Format::Xlsx => {
                let Some(path) = &self.to else {
                    return Err(CliError::input("a workbook is binary: give a file with --to"));
                };
                self.workbook(&view, &tables, &about, path)
            }
            Format::Svg => self.text(&friction_figure(&rows, &about).svg()?),
            Format::Parquet => {
                let Some(path) = &self.to else {
                    return Err(CliError::input("Parquet is binary: give a file with --to"));
                };
                self.bytes(path, long_table(&rows)?.parquet())
            }
        }
    }

    /// The friction tables, with total friction and friction with heat and softening where the run has them.
    fn workbook(
        &self,
        view: &RunView,
        tables: &[FrictionTable],
        about: &About,
        path: &Path,
    ) -> Result<(), CliError> {
        let totals = if view.has(TOTAL)? { view.rows(TOTAL)? } else { Vec::new() };
        let effects = if view.has(EFFECTS)? { view.rows(EFFECTS)? } else { Vec::new() };
        let of_total = |row: &TotalRow| self.is_chosen(row.model, row.kind, row.speed_mm_s);
        // Heat and softening are solved on the half-space.
        let of_effect = |row: &EffectRow| self.is_chosen(Model::Bem, row.kind, row.speed_mm_s);
        let totals: Vec<_> = totals.into_iter().filter(of_total).collect();
        let effects: Vec<_> = effects.into_iter().filter(of_effect).collect();
        let bytes = workbook(tables, &totals, &effects, about).map_err(CliError::failure)?;
        write_file(path, self.force, |out| out.write_all(&bytes))
    }

    /// One row for each value of each realisation.
    fn long(&self, rows: &[FrictionRow]) -> Result<(), CliError> {
        let table = values_table(rows)?;
        match (self.format, &self.to) {
            (Format::Csv, None) => print(&csv_text(&table)?),
            (Format::Csv, Some(path)) => self.bytes(path, table.csv()),
            (Format::Parquet, Some(path)) => self.bytes(path, table.parquet()),
            (Format::Parquet, None) => {
                Err(CliError::input("Parquet is binary: give a file with --to"))
            }
            _ => Err(CliError::input(
                "--layout long is for csv and parquet; the other formats are for people",
            )),
        }
    }

    fn chosen(&self, row: &FrictionRow) -> bool {
        self.is_chosen(row.model, row.kind, row.speed_mm_s)
    }

    /// Whether friction is of the model, surfaces and speed that were asked for.
    fn is_chosen(&self, model: Model, kind: SurfaceKind, speed_mm_s: f64) -> bool {
        self.model.is_none_or(|chosen| chosen == model)
            && self.method.is_none_or(|method| method == kind.method)
            && self.waves.is_none_or(|waves| kind.is_sines(waves))
            && self.speed.is_none_or(|speed| speed == speed_mm_s)
    }

    /// Warns if a result is not what its recipe asks for any more. Missing tables are reported elsewhere.
    fn warn_of_doubt(&self, stage: &str, quiet: bool) {
        let there = self.run.join(stage).exists();
        let last_run = LastRun::read(&self.run, quiet).filter(|_| there && !quiet);
        if let Some(doubt) = last_run.and_then(|last_run| last_run.doubt(&self.run, stage)) {
            note(quiet, format_args!("warning: {doubt}"));
        }
    }

    fn cleaning(&self, view: &RunView, quiet: bool) -> Result<(), CliError> {
        if self.format != Format::Markdown {
            return Err(CliError::input(
                "the report of cleaning is a document: give --format markdown; its numbers are \
                 the table ingest/faults",
            ));
        }
        view.verify("ingest")?;
        self.warn_of_doubt("ingest", quiet);
        let scans = view.rows(REPORT)?;
        let faults = view.rows(FAULTS)?;
        let windows = view.rows(WINDOWS)?;
        let maps = if view.has(MAP_WINDOWS)? { view.rows(MAP_WINDOWS)? } else { Vec::new() };
        self.text(&cleaning_markdown(&scans, &faults, &windows, &maps, &BTreeMap::new()))
    }

    /// A table of the run as it is.
    fn one_table(&self, view: &RunView, table: &str, quiet: bool) -> Result<(), CliError> {
        let tables = all_tables(view);
        let wanted = table.trim_end_matches(".arrow");
        let Some((stage, name)) =
            wanted.split_once('/').filter(|_| tables.iter().any(|t| t == wanted))
        else {
            return Err(CliError::input(format!(
                "{} has no table {table}; it has {}",
                self.run.display(),
                if tables.is_empty() { "none yet".into() } else { tables.join(", ") }
            )));
        };
        view.verify(stage)?;
        self.warn_of_doubt(stage, quiet);
        let file = format!("{name}.arrow");
        let table = ExportTable::read(&view.file(stage, &file))?;
        match (self.format, &self.to) {
            (Format::Csv, None) => print(&csv_text(&table)?),
            (Format::Csv, Some(path)) => self.bytes(path, table.csv()),
            (Format::Parquet, Some(path)) => self.bytes(path, table.parquet()),
            (Format::Parquet, None) => {
                Err(CliError::input("Parquet is binary: give a file with --to"))
            }
            _ => Err(CliError::input("a single table is exported as csv or parquet")),
        }
    }

    fn comparison(&self, view: &RunView) -> Result<(), CliError> {
        if self.format != Format::Markdown {
            return Err(CliError::input("a comparison is a document: give --format markdown"));
        }
        let (compared, metadata) = view.read_table(COMPARISON)?;
        let note = metadata.get(NOTE_KEY).map_or("", String::as_str);
        let corrections = if view.has(CORRECTIONS)? { view.rows(CORRECTIONS)? } else { Vec::new() };
        self.text(&comparison_markdown(note, &compared, &corrections))
    }

    /// Refuses a file name with the extension of another format.
    fn check_name(&self) -> Result<(), CliError> {
        let Some(path) = &self.to else { return Ok(()) };
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let named = match extension.to_str() {
            Some("csv") => Format::Csv,
            Some("md") => Format::Markdown,
            Some("tex") => Format::Latex,
            Some("parquet") => Format::Parquet,
            Some("xlsx") => Format::Xlsx,
            Some("svg") => Format::Svg,
            Some("png" | "pdf" | "json" | "txt" | "html") if self.format == Format::Svg => {
                return Err(CliError::input(format!(
                    "--to {}: --format svg writes an SVG file, call it *.svg; `asperity plot` writes PNG",
                    path.display()
                )));
            }
            _ => return Ok(()),
        };
        let is_text = |format| matches!(format, Format::Csv | Format::Markdown | Format::Latex);
        if named == self.format || is_text(named) && is_text(self.format) {
            return Ok(());
        }
        Err(CliError::input(format!(
            "--to {}: the name is that of another format than --format {}; change one of them",
            path.display(),
            self.format.name()
        )))
    }

    fn text(&self, text: &str) -> Result<(), CliError> {
        match &self.to {
            None => print(text),
            Some(path) => write_file(path, self.force, |out| out.write_all(text.as_bytes())),
        }
    }

    fn csv(&self, tables: &[FrictionTable]) -> Result<(), CliError> {
        match (&self.to, tables) {
            (None, [table]) => print(&csv_text(&published(table)?)?),
            (None, _) => Err(CliError::input(format!(
                "there are {} tables: give a folder with --to, or choose one with --model, \
                 --method, --waves and --speed",
                tables.len()
            ))),
            (Some(path), [table]) if path.extension().is_some() => {
                self.bytes(path, published(table)?.csv())
            }
            (Some(folder), tables) => {
                std::fs::create_dir_all(folder)
                    .map_err(|error| CliError::no_folder(folder, &error))?;
                // Not `with_extension`: a speed of 10.5 mm/s has a point.
                let path =
                    |table: &FrictionTable| folder.join(format!("{}.csv", table.file_stem()));
                for table in tables {
                    refuse_existing(Some(&path(table)), self.force)?;
                }
                for table in tables {
                    self.bytes(&path(table), published(table)?.csv())?;
                }
                Ok(())
            }
        }
    }

    fn bytes(&self, path: &Path, bytes: Result<Vec<u8>, ArtifactError>) -> Result<(), CliError> {
        let bytes = bytes?;
        write_file(path, self.force, |out| out.write_all(&bytes))
    }
}

/// All tables of a run, as `stage/table`.
fn all_tables(view: &RunView) -> Vec<String> {
    let mut tables = Vec::new();
    for stage in Stage::ALL {
        // A damaged manifest hides the tables of its own stage alone.
        let manifest = view.stage_manifest(stage.name()).ok().flatten();
        let outputs = manifest.into_iter().flat_map(|manifest| manifest.outputs);
        let names =
            outputs.filter_map(|output| Some(output.file.strip_suffix(".arrow")?.to_owned()));
        tables.extend(names.map(|name| format!("{stage}/{name}")));
    }
    tables
}

fn csv_text(table: &ExportTable) -> Result<String, CliError> {
    String::from_utf8(table.csv()?).map_err(CliError::failure)
}

/// The table with the columns of the published ones and the interval.
fn published(table: &FrictionTable) -> Result<ExportTable, CliError> {
    let mut other = vec![
        "model",
        "method",
        "waves",
        "speed_mm_s",
        "given",
        "shortest_wavelength_mm",
        "windows",
        "scan_error",
        "interpolation_error",
        "discretisation_error",
        "microscale_error",
    ];
    if table.rows.iter().all(|row| row.half_space_realisations.is_none()) {
        other.extend(["half_space_realisations", "model_error"]);
    }
    Ok(long_table(&table.rows)?.without(&other)?)
}
