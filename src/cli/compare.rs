//! `asperity compare`: which of two runs has more friction.

use super::output::{json, note, print, significant};
use super::run_folder;
use super::{CliError, figure_file};
use asperity::report::{Compared, Pairing, compare};
use asperity::text::visible_line;
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  Which rubber has more friction on the same road, by how much, and how sure that is:
    asperity compare runs/rubber_a runs/rubber_b
  The same as a figure, and for another program:
    asperity compare runs/rubber_a runs/rubber_b --to difference.svg
    asperity compare runs/rubber_a runs/rubber_b --json";

/// Compare the friction of two runs: which road, rubber or setting has more, with the interval of the difference.
///
/// Every average that both runs have is compared: the same model, surfaces, speed, and contact area or pressure. Runs over
/// the same surfaces are compared realisation by realisation, which tells small differences; other runs by the scatter of
/// both.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Compare {
    /// Run folder.
    first: PathBuf,
    /// Run folder that is compared with it.
    second: PathBuf,
    /// Print JSON with full precision.
    #[arg(long)]
    json: bool,
    /// File for a figure of the differences, .svg or .png.
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

impl Compare {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let first = run_folder::view_of_case(&self.first)?;
        let second = run_folder::view_of_case(&self.second)?;
        let compared = compare(&first, &second)?;
        let names = [name(&self.first), name(&self.second)];
        if compared.rows.is_empty() {
            return Err(CliError::input(format!(
                "{} and {} have no average in common: the same model, surfaces, speed, and contact area or pressure",
                self.first.display(),
                self.second.display()
            )));
        }
        for warning in &compared.warnings {
            note(quiet, format_args!("warning: {warning}"));
        }
        if let Some(path) = &self.to {
            let figure = compared
                .figure([&names[0], &names[1]])
                .ok_or_else(|| CliError::failure("there is nothing to draw".to_owned()))?;
            figure_file::write(path, self.force, &figure)?;
        }
        print(&if self.json { json(&compared)? } else { text(&compared, &names) })
    }
}

/// The last part of a path: what the user calls the run.
fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), asperity::files::name::text)
}

fn text(compared: &Compared, names: &[String; 2]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (letter, (name, material)) in ["A", "B"].iter().zip(names.iter().zip(&compared.materials)) {
        let _ = writeln!(text, "{letter}  {}, {}", visible_line(name), visible_line(material));
    }
    let _ = writeln!(
        text,
        "\n{:<8} {:<28} {:>10} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8}  verdict",
        "model", "surfaces", "mm/s", "Ac/A0", "MPa", "A", "B", "B - A", "± 95 %"
    );
    for row in &compared.rows {
        let half = row.confidence_95.map_or_else(|| "–".into(), |half| format!("{half:.4}"));
        let verdict = match (row.is_told(), row.difference > 0.0) {
            (false, _) => "not told apart".to_owned(),
            (true, true) => format!("B by {:.1} %", 100.0 * row.difference / row.first),
            (true, false) => format!("A by {:.1} %", -100.0 * row.difference / row.second),
        };
        let paired = if row.pairing == Pairing::Paired { ", paired" } else { "" };
        let _ = writeln!(
            text,
            "{:<8} {:<28} {:>10} {:>8.4} {:>9} {:>8.4} {:>8.4} {:>+8.4} {:>8}  {verdict}{paired}",
            row.model.to_string(),
            row.kind.to_string(),
            row.speed_mm_s,
            row.contact_area_fraction,
            significant(row.pressure_mpa),
            row.first,
            row.second,
            row.difference,
            half
        );
    }
    text
}
