//! `asperity convert`: scans from one format to another.

use asperity::units::Units;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::inspect::{ScanOptions, read_instrument};
use super::output::{note, print, refuse_existing, write_file};
use super::solve::refuse_to_overwrite;
use asperity::scans::Described;
use asperity::scans::file::{Grid, ScanFile, write_sdf, write_x3p};
use asperity::surface::RawScan;

/// Largest deviation of positions from equal spacing, as a share of the spacing, that may be lost: X3P and
/// SDF store the spacing alone.
const LARGEST_JITTER: f64 = 0.1;

const EXAMPLES: &str = "\
Examples:
  A height map of an instrument as X3P:
    asperity convert surface.sur --to surface.x3p
  A text scan, described as for inspect, as X3P and as plain CSV in metres:
    asperity convert scan_01.txt --to scan_01.x3p --separator semicolon --comment '#' --x-column x_mm --x-unit mm --z-column z_um --z-unit um
    asperity convert scan_01.x3p --to scan_01.csv";

/// Convert a scan to X3P (ISO 25178-72), SDF (ISO 25178-71) or CSV.
///
/// FILE is an instrument file (SDF, X3P, Digital Surf, ERD, OpenCRG, Wyko ASCII, Gwyddion text), told by its content, or
/// text or a sheet of a workbook (.xlsx) described by the options of `inspect`. The new format is told by the name: .x3p (64-bit binary heights, MD5
/// checksums, mask of missing points), .sdf (text, BAD where missing) or .csv (x_m, for maps y_m, and z_m; empty where missing).
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Convert {
    /// The scan.
    file: PathBuf,
    /// New file, *.x3p, *.sdf or *.csv.
    #[arg(long, value_name = "OUT")]
    to: PathBuf,
    /// Overwrite the new file if it is there.
    #[arg(long)]
    force: bool,
    /// Channel of an ERD file that is read, by its number from 1; the first of heights if not given.
    #[arg(long, value_name = "N", value_parser = super::values::channel)]
    erd_channel: Option<usize>,
    #[command(flatten)]
    scan: ScanOptions,
}

impl Convert {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        refuse_to_overwrite(Some(&self.to), "--to", &[Some(&self.file)])?;
        refuse_existing(Some(&self.to), self.force)?;
        let extension = self.to.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("x3p") => {
                let bytes = write_x3p(&self.on_grid(quiet)?).map_err(CliError::failure)?;
                write_file(&self.to, self.force, |out| out.write_all(&bytes))?;
            }
            Some("sdf") => {
                let text = write_sdf(&self.on_grid(quiet)?);
                write_file(&self.to, self.force, |out| out.write_all(text.as_bytes()))?;
            }
            Some("csv") => write_file(&self.to, self.force, self.csv(quiet)?)?,
            _ => {
                let name = self.to.display();
                return Err(CliError::input(format!(
                    "{name}: call the new file *.x3p, *.sdf or *.csv"
                )));
            }
        }
        print(&if quiet { String::new() } else { format!("{}\n", self.to.display()) })
    }

    fn native(&self) -> Result<Option<ScanFile>, CliError> {
        if self.file.is_dir() {
            let problem = "is a folder; give the file of one scan";
            return Err(CliError::input(format!("{} {problem}", self.file.display())));
        }
        let native = read_instrument(&self.file, self.erd_channel)?;
        if native.is_some() {
            let what = "the file of an instrument, which states its units";
            self.scan.refuse(&self.file, what)?;
        }
        Ok(native)
    }

    fn read(&self, quiet: bool) -> Result<Described, CliError> {
        if let Some(scan) = self.native()? {
            return Ok(Described::Map(scan));
        }
        self.scan.format().map_err(|needed| {
            CliError::input(format!(
                "{} is not an instrument file; to read it as text, give {needed} as well",
                self.file.display()
            ))
        })?;
        let read = self.scan.read(&self.file)?;
        for contradiction in self.scan.contradictions(&self.file)? {
            note(quiet, format_args!("warning: {contradiction}; the options are used"));
        }
        Ok(read)
    }

    fn on_grid(&self, quiet: bool) -> Result<ScanFile, CliError> {
        match self.read(quiet)? {
            Described::Map(scan) => Ok(scan),
            Described::Line(scan) => equally_spaced(&self.file, scan),
        }
    }

    /// The writer of the CSV file.
    fn csv(
        &self,
        quiet: bool,
    ) -> Result<impl FnOnce(&mut dyn Write) -> io::Result<()> + use<>, CliError> {
        let read = self.read(quiet)?;
        Ok(move |out: &mut dyn Write| match read {
            Described::Map(scan) => write_grid(&scan, out),
            Described::Line(scan) => write_points(&scan.positions, &scan.heights, out),
        })
    }
}

/// A text scan on the spacing of its first and last point.
fn equally_spaced(path: &Path, scan: RawScan) -> Result<ScanFile, CliError> {
    let (Some(first), Some(last)) = (scan.positions.first(), scan.positions.last()) else {
        return Err(CliError::input(format!("{} holds no points", path.display())));
    };
    // The reader gives two points or more, at growing positions.
    let spacing = (last - first) / (scan.positions.len() - 1) as f64;
    let deviation = |(i, x): (usize, &f64)| (x - first - i as f64 * spacing).abs();
    let largest = scan.positions.iter().enumerate().map(deviation).fold(0.0, f64::max);
    if largest > LARGEST_JITTER * spacing {
        return Err(CliError::input(format!(
            "{}: a position is {:.3} um off equal spacing of {:.3} um, and X3P and SDF store the spacing alone; \
             convert it to .csv",
            path.display(),
            largest.m_to_um(),
            spacing.m_to_um()
        )));
    }
    Ok(ScanFile {
        format: "text".into(),
        detected: "described by options".into(),
        grid: Grid::Profile { spacing },
        heights: scan.heights,
        instrument: Vec::new(),
    })
}

fn write_grid(scan: &ScanFile, out: &mut dyn Write) -> io::Result<()> {
    match scan.grid {
        Grid::Profile { spacing } => {
            let positions: Vec<f64> = (0..scan.heights.len()).map(|i| i as f64 * spacing).collect();
            write_points(&positions, &scan.heights, out)
        }
        Grid::Map { columns, spacing_x, spacing_y, .. } => {
            writeln!(out, "x_m,y_m,z_m")?;
            for (index, height) in scan.heights.iter().enumerate() {
                let (row, column) = (index / columns, index % columns);
                let (x, y) = (column as f64 * spacing_x, row as f64 * spacing_y);
                writeln!(out, "{x:e},{y:e},{}", cell(*height))?;
            }
            Ok(())
        }
    }
}

fn write_points(positions: &[f64], heights: &[f64], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "x_m,z_m")?;
    for (position, height) in positions.iter().zip(heights) {
        writeln!(out, "{position:e},{}", cell(*height))?;
    }
    Ok(())
}

/// The shortest text that is read back as the same number.
fn cell(height: f64) -> String {
    if height.is_nan() { String::new() } else { format!("{height:e}") }
}
