//! `asperity rubber`: a rubber file from measured moduli, and its law at finite strain from a measured curve.

mod hyperelastic;
mod payne;
mod show;
mod summary;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};

use super::output::{already_exists, json, note, print, refuse_existing, write_file};
use super::{CliError, values};
use asperity::report::rubber_fit_figure;
use asperity::rubber::fit::{
    DescribedColumn, FitError, FitOptions, LeftOut, MasterCurve, ModulusKind, ReducedPoint,
    SweepTable, TableOptions, VerticalChoice, doubts, fit_sweeps, read_shift_factors, read_sweeps,
};
use asperity::rubber::to_toml;
use asperity::scans::description::{DecimalMark, Separator};
use summary::Summary;

const EXAMPLES: &str = "\
Examples:
  A sweep of Young's modulus with the columns frequency_hz, storage_mpa and loss_mpa:
    asperity rubber fit sweep.csv --kind youngs --to tread.toml
  Shear moduli at several temperatures (column temperature_c), shifted to 20 °C, with a plot:
    asperity rubber fit sweeps.csv --kind shear --reference-temperature-c 20 --to tread.toml --plot tread.svg
  The export of an instrument, or a workbook, as it is:
    asperity rubber fit frequency_sweep.xlsx --kind youngs --sheet Data --to tread.toml
  A master curve without header whose shift factors are known:
    asperity rubber fit master.txt --kind youngs --columns frequency_hz=1,storage_pa=2,loss_pa=3 \
      --shift-factors shifts.txt --to tread.toml
  Moduli that grow with density times temperature:
    asperity rubber fit sweeps.csv --kind shear --vertical-shift rho-t --to tread.toml
  Moduli that change with temperature in a way that is not known:
    asperity rubber fit sweeps.csv --kind shear --vertical-shift free --to tread.toml
  Friction of that rubber at 40 °C:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3 --rubber tread.toml --temperature-c 40

Exit codes: 0 fitted, 1 no fit or not written, 2 bad input.";

/// Volume expansion of natural rubber in 1/K (Brandrup, Immergut & Grulke, Polymer Handbook, 4th
/// edition, Wiley 1999); other rubbers differ by a tenth, which is 0.3 % of a modulus over 50 K.
const VOLUME_EXPANSION_PER_K: f64 = 6.6e-4;

/// Relative misfit (root mean square) above which the fit is called poor.
const POOR: f64 = 0.1;

/// Ratio of a limit of the fitted storage modulus to what was measured next to it, above which that
/// limit is no measured plateau.
const NO_PLATEAU: f64 = 1.2;

#[derive(Debug, Subcommand)]
pub(super) enum Rubber {
    Fit(Fit),
    Hyperelastic(hyperelastic::Hyperelastic),
    Payne(payne::PayneFit),
    Summary(show::Show),
}

/// Which modulus was measured.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// Young's modulus E: tension, compression, bending.
    Youngs,
    /// Shear modulus G: torsion, shear; becomes `E = 2 (1 + ν) G`.
    Shear,
}

impl From<Kind> for ModulusKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Youngs => Self::Youngs,
            Kind::Shear => Self::Shear,
        }
    }
}

/// Fit a rubber to storage and loss moduli over frequency, at one or several temperatures.
///
/// The file is text or an .xlsx workbook with a header that names quantities and units, such as
/// frequency_hz (or angular_frequency_rad_s), storage_mpa, loss_mpa (or _pa, _kpa, _gpa) and,
/// optionally, temperature_c, or as instruments write it; --columns describes any other. Sweeps at
/// several temperatures become a master curve; the rubber file then holds the law of the shift, so
/// that the rubber is known at other temperatures. docs/rubber_data.md explains the method.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Fit {
    /// Measured points: CSV, text of an instrument, or .xlsx.
    #[arg(value_name = "SWEEP.CSV")]
    sweep: PathBuf,
    /// Which modulus was measured; never guessed.
    #[arg(long, value_name = "KIND")]
    kind: Kind,
    /// Poisson ratio of the rubber, 0 to 0.5; also makes Young's modulus of shear: E = 2 (1 + nu) G.
    #[arg(long, value_name = "NU", default_value = "0.49", value_parser = values::finite, allow_negative_numbers = true)]
    poisson_ratio: f64,
    /// Number of terms [default: the one with the lowest Bayesian information criterion (Schwarz)].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    terms: Option<usize>,
    /// Reference temperature in °C, one of those measured [default: the middle one].
    #[arg(long, value_name = "C", value_parser = values::finite, allow_negative_numbers = true)]
    reference_temperature_c: Option<f64>,
    /// How moduli change with temperature beside the shift of the frequency: not at all, with density
    /// times absolute temperature, or by a factor that is fitted for every temperature. Fitted factors
    /// are taken to lie between half and twice density times temperature at 100 K from the reference
    /// (95 %), nearer at less; shift factors that the moduli then leave open are named.
    #[arg(long, value_enum, value_name = "HOW", default_value = "none")]
    vertical_shift: VerticalKind,
    /// Volume expansion of the rubber in 1/K, for --vertical-shift rho-t and free [default: 6.6e-4].
    #[arg(long, value_name = "PER_K", value_parser = values::finite, allow_negative_numbers = true)]
    expansion_per_k: Option<f64>,
    /// Shift factors to take as they are: a file with temperature_c and log10_shift or shift_factor.
    #[arg(long, value_name = "FILE")]
    shift_factors: Option<PathBuf>,
    /// Where the columns are, by number or by name: frequency_hz=1,storage_mpa=2,loss_mpa=3.
    #[arg(long, value_name = "QUANTITY=COLUMN", value_delimiter = ',')]
    columns: Vec<DescribedColumn>,
    /// Separator of the columns of a text [default: found from the content].
    #[arg(long, value_enum, value_name = "WHAT")]
    separator: Option<TextSeparator>,
    /// Decimal mark, `.` or `,` [default: found from the content].
    #[arg(long, value_name = "MARK", value_parser = decimal_mark)]
    decimal_mark: Option<DecimalMark>,
    /// Sheet of the workbook [default: the only one with sweeps].
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Name of the rubber in tables [default: that of the file].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Rubber file to write.
    #[arg(long, value_name = "RUBBER.TOML")]
    to: PathBuf,
    /// Also draw moduli and shift factors, measured and fitted, to this SVG file.
    #[arg(long, value_name = "PLOT.SVG")]
    plot: Option<PathBuf>,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Overwrite files that are there already.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum VerticalKind {
    None,
    RhoT,
    Free,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TextSeparator {
    Tab,
    Comma,
    Semicolon,
    Blanks,
}

fn decimal_mark(text: &str) -> Result<DecimalMark, String> {
    match text {
        "." => Ok(DecimalMark::Point),
        "," => Ok(DecimalMark::Comma),
        _ => Err("give a point or a comma".into()),
    }
}

impl Rubber {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Fit(fit) => fit.run(quiet),
            Self::Hyperelastic(curve) => curve.run(quiet),
            Self::Payne(payne) => payne.run(quiet),
            Self::Summary(show) => show.run(quiet),
        }
    }
}

impl Fit {
    fn run(&self, quiet: bool) -> Result<(), CliError> {
        self.check()?;
        refuse_existing(Some(&self.to), self.force)?;
        refuse_existing(self.plot.as_deref(), self.force)?;
        let kind = ModulusKind::from(self.kind);
        let factor = kind.factor(self.poisson_ratio);
        let table = read_sweeps(&self.sweep, &self.table(), factor)?;
        let doubts = doubts(&table, kind);
        let fit = fit_sweeps(&table.sweeps, &self.options()?);
        let fit = fit.map_err(|error| self.refusal(error, &doubts))?;
        self.tell(&table, &doubts, quiet);
        for warning in warnings(&fit) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let source = source(&self.sweep, &fit);
        let text = to_toml(&fit.rubber(&self.name(), self.poisson_ratio), &source);
        let svg = self.plot.as_ref().map(|_| rubber_fit_figure(&fit).svg()).transpose();
        let svg = svg.map_err(CliError::failure)?;
        write_file(&self.to, self.force, |out| out.write_all(text.as_bytes()))?;
        if let (Some(path), Some(svg)) = (&self.plot, svg) {
            write_file(path, self.force, |out| out.write_all(svg.as_bytes()))?;
        }
        let summary = Summary::new(&fit);
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// How the file is to be read.
    fn table(&self) -> TableOptions {
        TableOptions {
            columns: self.columns.clone(),
            separator: self.separator.map(|separator| match separator {
                TextSeparator::Tab => Separator::Tab,
                TextSeparator::Comma => Separator::Comma,
                TextSeparator::Semicolon => Separator::Semicolon,
                TextSeparator::Blanks => Separator::Whitespace,
            }),
            decimal_mark: self.decimal_mark,
            sheet: self.sheet.clone(),
        }
    }

    fn options(&self) -> Result<FitOptions, CliError> {
        let shift_factors = self.shift_factors.as_deref().map(read_shift_factors).transpose();
        let expansion_per_k = self.expansion_per_k.unwrap_or(VOLUME_EXPANSION_PER_K);
        Ok(FitOptions {
            terms: self.terms,
            reference_c: self.reference_temperature_c,
            vertical: match self.vertical_shift {
                VerticalKind::None => VerticalChoice::None,
                VerticalKind::RhoT => VerticalChoice::RhoT { expansion_per_k },
                VerticalKind::Free => VerticalChoice::Free { expansion_per_k },
            },
            shift_factors: shift_factors.map_err(CliError::input)?,
        })
    }

    /// Prints how the file was read, if its header is not in the form of this program, and what looks wrong.
    fn tell(&self, table: &SweepTable, doubts: &[String], quiet: bool) {
        let name = file_name(&self.sweep);
        if table.interpreted {
            let sweeps = table.sweeps.len();
            note(quiet, format_args!("{name}: {}; {sweeps} sweeps", table.read_as));
        }
        for doubt in doubts {
            note(quiet, format_args!("warning: {name}: {doubt}"));
        }
    }

    /// Checks the options before anything is read or written.
    fn check(&self) -> Result<(), CliError> {
        if !(0.0..=0.5).contains(&self.poisson_ratio) {
            let ratio = self.poisson_ratio;
            return Err(CliError::input(format!(
                "--poisson-ratio is {ratio}, it must lie between 0 and 0.5"
            )));
        }
        if let Some(expansion) = self.expansion_per_k {
            if self.vertical_shift == VerticalKind::None {
                return Err(CliError::input(
                    "--expansion-per-k is for --vertical-shift rho-t or free: leave it out, or give one of them",
                ));
            }
            if !(0.0..=0.003).contains(&expansion) {
                return Err(CliError::input(format!(
                    "--expansion-per-k is {expansion}, it must lie between 0 and 0.003: natural rubber has 6.6e-4"
                )));
            }
        }
        if self.terms == Some(0) {
            return Err(CliError::input("--terms is 0: give at least 1, or leave it out"));
        }
        if self.plot.as_ref() == Some(&self.to) {
            return Err(CliError::input("--to and --plot are the same file: choose another one"));
        }
        let outputs = [Some(&self.to), self.plot.as_ref()];
        let same = |output: &Path| match (output.canonicalize(), self.sweep.canonicalize()) {
            (Ok(output), Ok(input)) => output == input,
            _ => false,
        };
        for output in outputs.into_iter().flatten() {
            if same(output) {
                let path = output.display();
                return Err(CliError::input(format!(
                    "{path} is the measured sweep: choose another file for the result"
                )));
            }
            if output.exists() && !self.force {
                return Err(already_exists(output));
            }
        }
        Ok(())
    }

    /// The error with the file, and with what looks wrong in it, which may be the reason.
    fn refusal(&self, error: FitError, doubts: &[String]) -> CliError {
        let doubts: String = doubts.iter().map(|doubt| format!("\n{doubt}")).collect();
        let options = options_of(&error);
        let text = format!("{}: {error}{options}{doubts}", self.sweep.display());
        match error {
            FitError::NoFit { .. } => CliError::failure(text),
            FitError::Reference { measured_c, .. } if measured_c.is_empty() => {
                CliError::input(format!(
                    "{}: there is no column temperature_c: add it, or leave out --reference-temperature-c",
                    self.sweep.display()
                ))
            }
            _ => CliError::input(text),
        }
    }

    fn name(&self) -> String {
        let of_file = || self.to.file_stem().map(asperity::files::name::text);
        self.name.clone().or_else(of_file).unwrap_or_else(|| "rubber".into())
    }
}

/// The options and columns that an error of a fit leads to: the fit itself knows none.
fn options_of(error: &FitError) -> &'static str {
    match error {
        FitError::NoOverlap { .. } => " (--shift-factors)",
        FitError::NoReference => " (--reference-temperature-c)",
        FitError::Duplicate { .. } => " (column temperature_c)",
        FitError::VerticalWithoutTemperature => {
            ": add the column temperature_c, or leave out --vertical-shift"
        }
        _ => "",
    }
}

fn file_name(path: &Path) -> String {
    asperity::files::name::text(path.file_name().unwrap_or(path.as_os_str()))
}

/// What the rubber file says of its source.
fn source(sweep: &Path, fit: &MasterCurve) -> String {
    let open: Vec<String> = fit
        .shifts
        .iter()
        .filter(|shift| shift.uncertain)
        .map(|shift| format!("{} °C", shift.temperature_c))
        .collect();
    let text = format!("asperity rubber fit to {}", file_name(sweep));
    if open.is_empty() {
        return text;
    }
    format!("{text}; shift factor not determined at {}, left out of the law", open.join(", "))
}

/// What a user should know before using the rubber.
fn warnings(fit: &MasterCurve) -> Vec<String> {
    let mut warnings = Vec::new();
    let equilibrium = fit.equilibrium_modulus.value;
    let glassy = equilibrium + fit.terms.iter().map(|term| term.modulus.value).sum::<f64>();
    let by_frequency = |a: &&ReducedPoint, b: &&ReducedPoint| {
        a.point.angular_frequency.total_cmp(&b.point.angular_frequency)
    };
    let slowest = fit.points.iter().min_by(by_frequency).map(|p| p.point.storage_modulus);
    let fastest = fit.points.iter().max_by(by_frequency).map(|p| p.point.storage_modulus);
    for (end, limit, ratio) in [
        ("lowest", "slow", slowest.map(|storage| storage / equilibrium)),
        ("highest", "fast", fastest.map(|storage| glassy / storage)),
    ] {
        if let Some(ratio) = ratio.filter(|ratio| *ratio > NO_PLATEAU) {
            warnings.push(format!(
                "at the {end} measured frequency the storage modulus is a factor of {ratio:.2} from the fit's \
                 limit of {limit} loading: that limit is extrapolated, its intervals mean little"
            ));
        }
    }
    for left_out in &fit.left_out {
        let LeftOut { temperature_c, storage_mpa: [low, high] } = left_out;
        warnings.push(format!(
            "the sweep at {temperature_c} °C (storage modulus {low:.4} to {high:.4} MPa) is left out: neither storage \
             nor loss moduli join it to the others; measure at a temperature between, or give --shift-factors"
        ));
    }
    for shift in fit.shifts.iter().filter(|shift| shift.uncertain) {
        let half = shift.confidence_95.map_or(String::new(), |half| format!(" ± {half:.1}"));
        warnings.push(format!(
            "the shift factor at {} °C is not determined by the moduli (log10 {:.1}{half}) and is left out of the \
             law: measure over more frequencies, or give factors that you know with --shift-factors",
            shift.temperature_c, shift.log10_shift
        ));
    }
    for [colder, hotter] in &fit.joined_by_loss_c {
        warnings.push(format!(
            "the sweeps at {colder} °C and {hotter} °C have no storage moduli in common and were joined by loss \
             modulus and tan delta"
        ));
    }
    let misfit = &fit.misfit;
    let worst = misfit.storage_modulus.rms.max(misfit.loss_modulus.rms);
    if worst > POOR {
        warnings.push(format!(
            "the fit is {:.0} % off (root mean square): moduli that do not belong together, noise, or \
             temperatures that do not superpose; look at --plot",
            100.0 * worst
        ));
    }
    let open = fit.shifts.iter().filter(|shift| shift.uncertain).count();
    if fit.shifts.len() > 1 && fit.laws.is_empty() && open + 1 == fit.shifts.len() {
        warnings.push(
            "no shift factor is determined: the rubber file has no [temperature] section; give \
             --vertical-shift rho-t if moduli grow with density times temperature"
                .into(),
        );
    } else if fit.shifts.len() > 1 && fit.laws.is_empty() {
        warnings.push(
            "the shift factors follow no law that gets softer with heat: the rubber file has no [temperature] \
             section"
                .into(),
        );
    }
    warnings
}
