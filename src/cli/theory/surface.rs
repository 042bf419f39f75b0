//! The isotropic surface of a theory: a spectrum in a file, or that of a scan or a map.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::units::Units;
use clap::{ArgGroup, Args};
use serde::Serialize;

use crate::cli::inspect::{ScanOptions, read_instrument};
use crate::cli::solve::read_map;
use crate::cli::{CliError, values};
use asperity::measurement::{
    Conventions, DensityUnit, Sides, WavenumberUnit, density_unit, read_spectrum, wavenumber_unit,
};
use asperity::scans::Described;
use asperity::scans::description::LengthUnit;
use asperity::scans::file::{Grid, ScanFile};
use asperity::surface::condition::condition;
use asperity::surface::correlation::correlate_scans;
use asperity::surface::map::form::{FormOfMap, remove_form};
use asperity::surface::map::spectrum::ArealSpectrum;
use asperity::surface::spectrum::{IsotropicSpectrum, Window, power_spectra};
use asperity::surface::{Conditioning, HeightMap, LineScan, PowerSpectrum, RawScan};

/// Bins of the spectrum of a scan or map in a decade, as `[characterise]` has them.
const BINS_PER_DECADE: usize = 20;
/// Waves that a scan or map holds at least; longer ones are blurred by the window of the spectrum.
const LEAST_WAVES: f64 = 2.0;
/// Height over the longest wavelength, and gradient, from which on a spectrum is likely in another unit.
const LARGEST_HEIGHT: f64 = 0.2;
const LARGEST_GRADIENT: f64 = 10.0;
const SMALLEST_GRADIENT: f64 = 1e-3;

/// What the rubber slides over.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("surface").required(true).args(["spectrum", "scan", "map"])))]
pub(super) struct SurfaceOptions {
    /// Power spectrum as text of two columns, wavenumber and density: separated by blanks, tabulators, commas or
    /// semicolons, comments after `#`, wavenumbers ascending.
    #[arg(long, value_name = "FILE", requires_all = ["wavenumber_unit", "density_unit"])]
    spectrum: Option<PathBuf>,
    /// Unit of the wavenumbers of --spectrum; never guessed. rad/m, rad/mm or rad/um is q = 2 pi / wavelength; 1/m, 1/mm or
    /// 1/um is 1 / wavelength, with densities over that.
    #[arg(long, value_name = "UNIT", requires = "spectrum", value_parser = wavenumber_unit)]
    wavenumber_unit: Option<WavenumberUnit>,
    /// Unit of the densities of --spectrum; never guessed. m4, mm4, um4 or nm4: the spectrum of an isotropic surface, whose
    /// integral over the whole plane of wavenumbers is the mean square height. m3, mm3, um3 or nm3: that of a line across
    /// it (see --sides), of which the surface is made by the Abel inverse.
    #[arg(long, value_name = "UNIT", requires = "spectrum", value_parser = density_unit)]
    density_unit: Option<DensityUnit>,
    /// Whether the mean square height of a line is the integral of its density over positive wavenumbers (one), or twice
    /// that (two) [default: one].
    #[arg(long, value_name = "one|two", requires = "spectrum", value_parser = sides)]
    sides: Option<Sides>,
    /// Both columns of --spectrum are decadic logarithms.
    #[arg(long, requires = "spectrum")]
    logarithms: bool,
    /// Line scan: a file of an instrument, or text described by the options under "Text scans". Spikes, the mean line and
    /// gaps are treated as a recipe does by default; the spectrum of the line
    /// becomes that of an isotropic surface; whether the surface is isotropic, a line cannot tell.
    #[arg(long, value_name = "FILE")]
    scan: Option<PathBuf>,
    /// Height map: a file of an instrument, or text as for `solve areal`. Its mean plane is removed, and its spectrum
    /// averaged over directions.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Unit of a --map of text: nm, um, mm or m; never guessed.
    #[arg(long, value_name = "UNIT", requires = "map", value_parser = values::length_unit)]
    map_unit: Option<LengthUnit>,
    /// Length in mm of a row of a --map that is text of heights alone.
    #[arg(long, value_name = "MM", requires = "map", value_parser = values::positive, allow_negative_numbers = true)]
    size_mm: Option<f64>,
    /// Shortest wavelength in mm that is taken [default: the shortest there is]. Friction grows with shorter waves: state it
    /// with every result.
    #[arg(long, value_name = "MM", value_parser = values::positive, allow_negative_numbers = true)]
    shortest_wavelength_mm: Option<f64>,
    /// Longest wavelength in mm that is taken [default: the longest there is].
    #[arg(long, value_name = "MM", value_parser = values::positive, allow_negative_numbers = true)]
    longest_wavelength_mm: Option<f64>,
    /// How the text of a scan or map is to be read.
    #[command(flatten)]
    text: ScanOptions,
}

fn sides(text: &str) -> Result<Sides, String> {
    match text {
        "one" => Ok(Sides::One),
        "two" => Ok(Sides::Two),
        _ => Err("choose one or two".into()),
    }
}

/// An isotropic surface with the waves that are taken.
pub(super) struct Surface {
    pub(super) spectrum: IsotropicSpectrum,
    /// Wavenumbers in rad/m of the longest and the shortest wave.
    pub(super) band: [f64; 2],
    /// Where the spectrum is from, in words.
    pub(super) source: String,
    pub(super) warnings: Vec<String>,
}

/// Its roughness, as it is printed.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Roughness {
    source: String,
    longest_wavelength_mm: f64,
    shortest_wavelength_mm: f64,
    rms_height_mm: f64,
    rms_gradient: f64,
}

impl SurfaceOptions {
    /// The surface.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn surface(&self) -> Result<Surface, CliError> {
        let mut surface = match (&self.spectrum, &self.scan, &self.map) {
            (Some(path), ..) => self.of_spectrum(path)?,
            (_, Some(path), _) => self.of_scan(path)?,
            (.., Some(path)) => self.of_map(path)?,
            _ => return Err(CliError::input("give --spectrum, --scan or --map")),
        };
        let [first, last] = surface.spectrum.band();
        let cut = |given: Option<f64>, own: f64, option: &str| match given {
            None => Ok(own),
            Some(mm) => {
                let wavenumber = TAU / mm.mm_to_m();
                // A wavelength that was typed from the printed one is that one.
                let near = |end: f64| (wavenumber / end - 1.0).abs() < 1e-5;
                match [first, last].into_iter().find(|end| near(*end)) {
                    Some(end) => Ok(end),
                    None if first < wavenumber && wavenumber < last => Ok(wavenumber),
                    None => Err(CliError::input(format!(
                        "{option} is {mm} mm, but the spectrum has waves from {:.6} to {:.6} mm: stay within them",
                        (TAU / last).m_to_mm(),
                        (TAU / first).m_to_mm()
                    ))),
                }
            }
        };
        surface.band = [
            cut(self.longest_wavelength_mm, first, "--longest-wavelength-mm")?,
            cut(self.shortest_wavelength_mm, last, "--shortest-wavelength-mm")?,
        ];
        if surface.band[0] >= surface.band[1] {
            return Err(CliError::input(
                "--longest-wavelength-mm is not above --shortest-wavelength-mm: exchange them",
            ));
        }
        surface.doubt();
        Ok(surface)
    }

    /// Files that the command reads.
    pub(super) fn inputs(&self) -> [Option<&Path>; 3] {
        [self.spectrum.as_deref(), self.scan.as_deref(), self.map.as_deref()]
    }

    fn of_spectrum(&self, path: &Path) -> Result<Surface, CliError> {
        if let Some(option) = self.text.given().first() {
            return Err(CliError::input(format!(
                "{option} describes the text of a scan or map, and {} is a spectrum of two columns: leave it out",
                path.display()
            )));
        }
        let (Some(wavenumber), Some(density)) = (self.wavenumber_unit, self.density_unit) else {
            return Err(CliError::input("--spectrum needs --wavenumber-unit and --density-unit"));
        };
        if self.sides.is_some() && !density.of_line() {
            return Err(CliError::input(
                "--sides is for the spectrum of a line; the unit of --density-unit is that of a surface: leave --sides out",
            ));
        }
        let sides = self.sides.unwrap_or(Sides::One);
        let conventions = Conventions { wavenumber, density, sides, logarithms: self.logarithms };
        let (spectrum, left_out) = read_spectrum(path, conventions).map_err(CliError::input)?;
        let kind = match (density.of_line(), sides) {
            (false, _) => "two-dimensional spectrum",
            (_, Sides::One) => "one-sided line spectrum",
            (_, Sides::Two) => "two-sided line spectrum",
        };
        let source = format!("{kind} in {}", path.display());
        Ok(Surface::new(spectrum, source, negative(left_out)))
    }

    fn of_scan(&self, path: &Path) -> Result<Surface, CliError> {
        let in_file = |problem: String| CliError::input(format!("{}: {problem}", path.display()));
        let raw = match read_instrument(path, None)? {
            Some(file) => {
                self.text.refuse(path, "the file of an instrument, which states its units")?;
                profile(file, path).map_err(in_file)?
            }
            None => match self.text.read(path)? {
                Described::Line(scan) => scan,
                Described::Map(_) => return Err(in_file("is a map: give it as --map".into())),
            },
        };
        let (scans, report) = condition(&raw, &Conditioning::default()).map_err(in_error(path))?;
        let correlations = correlate_scans(&scans, None).map_err(in_error(path))?;
        let spectra = power_spectra(&scans, &correlations, Window::Hann).map_err(in_error(path))?;
        let bins =
            PowerSpectrum::log_binned_over(&spectra, BINS_PER_DECADE).map_err(in_error(path))?;
        let longest = scans.iter().map(LineScan::length).fold(f64::INFINITY, f64::min);
        let kept = bins.iter().filter(|bin| bin.wavenumber >= LEAST_WAVES * TAU / longest);
        let (wavenumbers, densities): (Vec<f64>, Vec<f64>) =
            kept.filter(|bin| bin.density > 0.0).map(|bin| (bin.wavenumber, bin.density)).unzip();
        let (spectrum, left_out) =
            IsotropicSpectrum::from_line(&wavenumbers, &densities).map_err(in_error(path))?;
        let mut warnings = negative(left_out);
        if report.spikes > 0 {
            warnings.push(format!("{} points were taken for spikes and left out", report.spikes));
        }
        let source = format!("line scan {}, Abel inverse of its spectrum", path.display());
        Ok(Surface::new(spectrum, source, warnings))
    }

    fn of_map(&self, path: &Path) -> Result<Surface, CliError> {
        let size = self.size_mm.map(|mm| [Some(mm.mm_to_m()), None]);
        let map = read_map(path, self.map_unit, size, &self.text)?;
        let spacing = [0, 1].map(|axis| map.periods[axis] / map.points[axis] as f64);
        let name = path.display().to_string();
        let mut map = HeightMap { name, points: map.points, spacing, heights: map.heights };
        remove_form(&mut map, FormOfMap::Plane).map_err(in_error(path))?;
        let areal = ArealSpectrum::of(&map, Window::Hann).map_err(in_error(path))?;
        let longest = map.lengths().into_iter().fold(f64::INFINITY, f64::min);
        let rings = areal.radial(BINS_PER_DECADE);
        let kept = rings
            .iter()
            .filter(|ring| ring.wavenumber >= LEAST_WAVES * TAU / longest && ring.density > 0.0);
        let (wavenumbers, densities): (Vec<f64>, Vec<f64>) =
            kept.map(|ring| (ring.wavenumber, ring.density)).unzip();
        let spectrum = IsotropicSpectrum::new(wavenumbers, densities).map_err(in_error(path))?;
        let source = format!("map {}, its spectrum averaged over directions", path.display());
        Ok(Surface::new(spectrum, source, Vec::new()))
    }
}

/// The line of an instrument file.
fn profile(file: ScanFile, path: &Path) -> Result<RawScan, String> {
    let Grid::Profile { spacing } = file.grid else {
        return Err("holds a map: give it as --map".into());
    };
    let positions = (0..file.heights.len()).map(|k| k as f64 * spacing).collect();
    Ok(RawScan { name: path.display().to_string(), positions, heights: file.heights })
}

/// Names the file in an error.
fn in_error<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> CliError + '_ {
    move |error| CliError::input(format!("{}: {error}", path.display()))
}

/// A warning for points of a line spectrum without a density over the plane.
fn negative(left_out: usize) -> Vec<String> {
    let warning = format!(
        "{left_out} points of the line spectrum have no density over the plane, because the line spectrum rises beyond them; \
         they are left out"
    );
    (left_out > 0).then_some(warning).into_iter().collect()
}

impl Surface {
    fn new(spectrum: IsotropicSpectrum, source: String, warnings: Vec<String>) -> Self {
        let band = spectrum.band();
        Self { spectrum, band, source, warnings }
    }

    /// Warns where height or gradient are those of no road.
    fn doubt(&mut self) {
        let roughness = self.roughness();
        let (height, gradient) = (roughness.rms_height_mm, roughness.rms_gradient);
        let longest = roughness.longest_wavelength_mm;
        let numbers = format!(
            "an rms height of {height:.3e} mm on waves up to {longest:.3e} mm and an rms gradient of {gradient:.3e}"
        );
        let doubt = |what: &str| {
            format!(
                "the spectrum has {numbers}: {what}; check --wavenumber-unit, --density-unit and --sides, or the unit of the heights"
            )
        };
        if height > LARGEST_HEIGHT * longest || gradient > LARGEST_GRADIENT {
            self.warnings.push(doubt("that is steeper than any road"));
        } else if gradient < SMALLEST_GRADIENT {
            self.warnings.push(doubt("that is smoother than any road"));
        }
    }

    pub(super) fn roughness(&self) -> Roughness {
        Roughness {
            source: self.source.clone(),
            longest_wavelength_mm: (TAU / self.band[0]).m_to_mm(),
            shortest_wavelength_mm: (TAU / self.band[1]).m_to_mm(),
            rms_height_mm: self.spectrum.rms_height(self.band).m_to_mm(),
            rms_gradient: self.spectrum.rms_gradient(self.band),
        }
    }

    /// Wavelengths in m of the longest and the shortest wave.
    pub(super) fn wavelengths(&self) -> Vec<f64> {
        self.band.iter().map(|wavenumber| TAU / wavenumber).collect()
    }
}

impl Roughness {
    pub(super) fn lines(&self) -> Vec<(&'static str, String)> {
        use crate::cli::output::significant;
        vec![
            ("surface", self.source.clone()),
            (
                "waves",
                format!(
                    "{} to {} mm",
                    significant(self.longest_wavelength_mm),
                    significant(self.shortest_wavelength_mm)
                ),
            ),
            ("rms height", significant(self.rms_height_mm) + " mm"),
            ("rms gradient", significant(self.rms_gradient)),
        ]
    }
}
