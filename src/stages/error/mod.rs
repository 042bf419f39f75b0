//! Why a stage has no result.

mod kind;

use super::{SolveError, keys, realise};
use crate::artifact::ArtifactError;
use std::path::PathBuf;

/// Why a stage has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// A file of the run folder.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// The shear stress of the contact area.
    #[error("[adhesion]: {0}")]
    Shear(#[from] crate::interface::ShearError),
    /// A scan file.
    #[error(transparent)]
    Scan(#[from] crate::scans::ScanError),
    /// An instrument file.
    #[error(transparent)]
    File(#[from] Box<crate::scans::FileError>),
    /// A height map without a word on how to take line scans from it.
    #[error("{} is a height map of {rows} rows of {columns} points: set ingest.map_lines to \"rows\" or \"columns\"", path.display())]
    MapLines {
        /// The file.
        path: PathBuf,
        /// Its rows.
        rows: usize,
        /// Points of a row.
        columns: usize,
    },
    /// A text file without a description.
    #[error("{} is no known file of an instrument; if it is text, describe it in [ingest.text] (`asperity inspect` on it makes a proposal)", path.display())]
    NoTextFormat {
        /// The file.
        path: PathBuf,
    },
    /// A scan that cannot be conditioned.
    #[error("{}{}", .0, keys::of_conditioning(.0))]
    Conditioning(#[from] crate::surface::ConditioningError),
    /// The picture of the faults of a scan cannot be drawn.
    #[error("ingest.fault_pictures: {0}")]
    FaultPicture(#[from] crate::plot::FigureError),
    /// No scan file was found.
    #[error("no scan files in [{}]: give files or folders with files (ingest.scans or --scans)", paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", "))]
    NoScans {
        /// Where was looked.
        paths: Vec<PathBuf>,
    },
    /// A scan file or a folder of scans cannot be read.
    #[error("cannot read the scans {}: {source}; check ingest.scans, or give others with --scans", path.display())]
    ScanIo {
        /// The path.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A scan file is another than at the start of the run.
    #[error("{}: the file changed while the run was reading it; run again", .path.display())]
    ScanChanged {
        /// The file.
        path: PathBuf,
    },
    /// A scan named as the average over the scans is.
    #[error("{}: `average` stands for the average over all scans in the tables; rename the file", path.display())]
    ReservedName {
        /// The file.
        path: PathBuf,
    },
    /// Two scan files of the same name, which could not be told apart.
    #[error("two scans are named {name}: {} and {}; rename one of them", first.display(), second.display())]
    SameName {
        /// The name.
        name: String,
        /// The one file.
        first: PathBuf,
        /// The other file.
        second: PathBuf,
    },
    /// Windows of different spacing or length cannot be averaged.
    #[error(
        "{scan} has {points} points every {spacing_um:.6} µm, {other} has {other_points} every {other_spacing_um:.6} µm: scans of one run must have the same spacing and length; set ingest.conditioning.window_length_mm and lateral_resolution_um, or run them apart"
    )]
    UnequalScans {
        /// A window.
        scan: String,
        /// Its points.
        points: usize,
        /// Its spacing in µm.
        spacing_um: f64,
        /// Another window.
        other: String,
        /// Its points.
        other_points: usize,
        /// Its spacing in µm.
        other_spacing_um: f64,
    },
    /// Metadata of a table that are not a number.
    #[error(
        "{key} of a table of characterise is `{value}`, which is not a number: run with --force characterise"
    )]
    Metadata {
        /// Its key.
        key: &'static str,
        /// Its value.
        value: String,
    },
    /// Roughness parameters.
    #[error(transparent)]
    Parameter(#[from] crate::surface::parameters::ParameterError),
    /// Height-difference correlation.
    #[error(transparent)]
    Correlation(#[from] crate::surface::correlation::CorrelationError),
    /// Power spectrum.
    #[error(transparent)]
    Spectrum(#[from] crate::surface::spectrum::SpectrumError),
    /// Ladder of wavelengths.
    #[error(transparent)]
    Ladder(#[from] crate::surface::ladder::LadderError),
    /// Fit of superposed sines.
    #[error("fit of {waves} waves: {source}")]
    SineFit {
        /// Number of waves.
        waves: u32,
        /// Why.
        source: crate::surface::sine_fit::SineFitError,
    },
    /// All fitted amplitudes are zero, or none was fitted.
    #[error(
        "the fit of {waves} waves has no wave to realise; fit other wavelengths (approximate.shortest_wavelength_mm)"
    )]
    NoWaves {
        /// Number of waves.
        waves: u32,
    },
    /// A window that cannot be made periodic.
    #[error("{0} (realise.longest_gap_mm, realise.shortest_wavelength_mm)")]
    Periodic(#[from] crate::surface::PeriodicError),
    /// A map that cannot be conditioned.
    #[error("{0} (ingest.maps)")]
    MapConditioning(#[from] crate::surface::map::condition::MapConditioningError),
    /// A map that cannot be characterised.
    #[error(transparent)]
    Areal(#[from] crate::surface::map::ArealError),
    /// A map with a gap that is not filled.
    #[error("{0} (realise.longest_gap_mm)")]
    Gap(#[from] crate::surface::map::gaps::GapError),
    /// A map that cannot be made periodic.
    #[error("{0} (realise.shortest_wavelength_mm, ingest.maps.window_length_mm)")]
    PeriodicMap(#[from] crate::surface::PeriodicMapError),
    /// No map of a recipe that keeps maps is left, or no file is one.
    #[error("{}", no_map_left(reasons))]
    NoMapLeft {
        /// Why each map is left out; empty where no file is a map.
        reasons: Vec<String>,
    },
    /// A window of a map that is not as it was written.
    #[error(
        "{name} in maps.h5 of ingest lacks {key}, or has another number of heights: run with --force ingest"
    )]
    MapWindow {
        /// Name of the dataset.
        name: String,
        /// Its attribute.
        key: String,
    },
    /// Windows of lines or maps without a wave.
    #[error(
        "{window} is flat down to realise.shortest_wavelength_mm, and no other window is left: it has no roughness to slide \
         over; check the units of the heights"
    )]
    FlatWindow {
        /// The first of them.
        window: String,
    },
    /// An isotropic surface of too few or too many waves.
    #[error(
        "isotropic surfaces of {period_mm} mm hold {:.1} shortest waves of {shortest_mm} mm along a side, and between {fewest} and {most} \
         can be made: change realise.isotropic_period_mm or realise.shortest_wavelength_mm",
        period_mm / shortest_mm
    )]
    IsotropicPeriod {
        /// Period in mm.
        period_mm: f64,
        /// Shortest wavelength in mm.
        shortest_mm: f64,
        /// Fewest shortest waves in a period.
        fewest: f64,
        /// Most of them.
        most: f64,
    },
    /// A contact of an areal surface.
    #[error("{kind}, realisation {realisation}, {speed_mm_s} mm/s at {angle_deg} degrees: {source}{}", keys::of_areal_curve(.source))]
    ArealContact {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// Realisation.
        realisation: u32,
        /// Speed in mm/s.
        speed_mm_s: f64,
        /// Direction of sliding in degrees from x.
        angle_deg: f64,
        /// Why.
        source: Box<crate::contact::curve::CurveError<SolveError>>,
    },
    /// A dataset of areal surfaces that is not as it was written.
    #[error("{name} in areal.h5 of realise is not an areal surface: run with --force realise")]
    ArealSurface {
        /// Name of the dataset.
        name: String,
    },
    /// Line scans without a spectrum that an isotropic surface could have.
    #[error(
        "the line scans have no isotropic spectrum, so that realise.methods cannot name isotropic: their averaged spectrum has fewer than two bins with power"
    )]
    NoIsotropicSpectrum,
    /// Areal grids that do not fit into the memory that may be taken.
    #[error(
        "{kind}: {at_once} contacts at a time on {} by {} points need about {needed_gb:.1} GB, and areal.memory_gb is {limit_gb}: \
         lower areal.points_per_shortest_wavelength, raise realise.shortest_wavelength_mm, cut smaller windows \
         (ingest.maps.window_length_mm), take fewer threads (--threads), or allow more",
        points[0], points[1]
    )]
    ArealMemory {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// Points along x and y.
        points: [usize; 2],
        /// Contacts that are solved at a time.
        at_once: usize,
        /// Memory that they need in GB.
        needed_gb: f64,
        /// Memory that they may take in GB.
        limit_gb: f64,
    },
    /// A rubber file.
    #[error(transparent)]
    Rubber(#[from] crate::rubber::RubberFileError),
    /// A rubber of which finite elements cannot be made.
    #[error(
        "{}: give a poisson_ratio that finite elements take, such as 0.49, or leave out the stage: {source}", path.display()
    )]
    RubberAtFiniteDeformation {
        /// The file of the rubber.
        path: PathBuf,
        /// Which number.
        source: crate::rubber::RubberError,
    },
    /// A table of moduli, of which finite elements cannot be made.
    #[error("{}: {source}; or leave out the stages at finite deformation", path.display())]
    NoRelaxationTimes {
        /// The file of the rubber.
        path: PathBuf,
        /// What it lacks.
        source: crate::rubber::RubberError,
    },
    /// A contact.
    #[error("{kind}, realisation {realisation}, {speed_mm_s} mm/s: {source}{}", keys::of_curve(.source))]
    Contact {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// Realisation.
        realisation: u32,
        /// Speed in mm/s.
        speed_mm_s: f64,
        /// Why.
        source: Box<crate::contact::curve::CurveError<SolveError>>,
    },
    /// An accuracy of the averages that the realisations are far from giving.
    #[error(
        "the relative accuracy {tolerance:?} asks for about {needed:.0e} realisations of {kind} at {speed_mm_s} \
         mm/s, by the spread of the first: {most} may be drawn (realise.most_realisations), which give about \
         {attainable:.1e}; ask for that with tolerance, or allow more realisations",
        needed = *needed as f64
    )]
    TooFewRealisations {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// Speed in mm/s.
        speed_mm_s: f64,
        /// The wanted relative accuracy.
        tolerance: f64,
        /// Realisations that it asks for.
        needed: usize,
        /// Realisations that may be drawn.
        most: usize,
        /// Relative accuracy that these give.
        attainable: f64,
    },
    /// A surface whose waves are all steeper than the threshold.
    #[error(
        "{kind}: no wave is less steep than {threshold}, nothing is left for the macro surface; raise micro.rms_slope_threshold"
    )]
    NoMacroscale {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// The threshold.
        threshold: f64,
    },
    /// Not one sample of any microscale.
    #[error(
        "no microscale has a solution, so that nothing can be corrected: {reason}, or leave [micro] out"
    )]
    NoMicroscale {
        /// That of the first one.
        reason: String,
    },
    /// Not one contact with its own heat or strain.
    #[error("no contact has a solution with its own heat or strain; the first: {reason}")]
    NoFeedback {
        /// Which one, and why.
        reason: String,
    },
    /// A rubber without the law that the heat of a contact needs.
    #[error(
        "{}: [feedback.heat] needs a rubber whose shift with temperature is known: give the file a section [temperature] \
         (`asperity rubber fit` writes it from sweeps at several temperatures), or leave [feedback.heat] out", path.display()
    )]
    NoTemperatureLaw {
        /// The file of the rubber.
        path: PathBuf,
    },
    /// A rubber without the law that the softening by strain needs.
    #[error(
        "{}: feedback.strain needs a rubber whose softening with strain is known: give the file a section [payne] \
         (`asperity rubber payne` makes it from strain sweeps), or set feedback.strain = false", path.display()
    )]
    NoStrainLaw {
        /// The file of the rubber.
        path: PathBuf,
    },
    /// A contact of the microscale, or of the macro surface under its law.
    #[error("microscale of {owners}, {speed_mm_s} mm/s: {source}")]
    Microscale {
        /// Whose it is, such as `8 waves`.
        owners: String,
        /// Speed in mm/s.
        speed_mm_s: f64,
        /// Why.
        source: Box<SolveError>,
    },
    /// A surface with all waves at finite deformation.
    #[error("{kind}, realisation {realisation}, {speed_mm_s} mm/s: {source}")]
    FiniteDeformation {
        /// Which surfaces.
        kind: realise::SurfaceKind,
        /// Realisation.
        realisation: u32,
        /// Speed in mm/s.
        speed_mm_s: f64,
        /// Why.
        source: Box<SolveError>,
    },
    /// A rubber that has no relaxation time to measure speeds by.
    #[error("rubber {rubber} has no branches: the Deborah number needs a relaxation time")]
    NoRelaxation {
        /// Name of the rubber.
        rubber: String,
    },
    /// A single solve, for another reason than that it has no solution.
    #[error("{problem}: {source}")]
    Solve {
        /// Which one.
        problem: String,
        /// Why.
        source: Box<SolveError>,
    },
    /// No curve of an older multiscale method.
    #[error(
        "[methods]: no method gives friction at any of the areas and pressures of [bem]: {reason}"
    )]
    NoMethods {
        /// Why the first has none.
        reason: String,
    },
    /// A published table.
    #[error("published table {}: {source}; it needs the columns area_fraction and average", path.display())]
    Published {
        /// The file.
        path: PathBuf,
        /// Why.
        source: csv::Error,
    },
    /// The user's interrupt.
    #[error("interrupted; what is done is kept, the same command continues")]
    Interrupted,
}

fn no_map_left(reasons: &[String]) -> String {
    match reasons {
        [] => "none of the scans is a height map, and [ingest.maps] keeps maps: leave the section out, or give maps".into(),
        reasons => format!("no height map is left (ingest.maps): {}", reasons.join("; ")),
    }
}
