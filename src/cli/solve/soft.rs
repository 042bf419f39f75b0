//! `asperity solve soft`: the steady sliding contact on the half-space, with the softening of the rubber by its strain.

use super::error_estimate::{ErrorEstimate, printed, require_finite};
use super::heat::{Side, view};
use super::material::{Material, MaterialOptions};
use super::shape::{Shape, ShapeOptions};
use crate::cli::output::{aligned, json, note, print, significant};
use crate::cli::{CliError, values};
use asperity::contact::effective::{Feedback, FeedbackContact, FeedbackSetup};
use asperity::contact::refine::{HALF_SPACE, Refined, on_grid};
use asperity::contact::sliding::POINTS_RANGE;
use asperity::rubber::payne::{PayneLaw, elongation_of_tensor_shear};
use asperity::units::Units;
use clap::Args;
use serde::Serialize;
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  Two sines and a rubber whose file has a section [payne] (`asperity rubber payne` makes one of strain sweeps):
    asperity solve soft --wave 0.25:0.012 --wave 1:0.02:1 --speed 10 --pressure 0.3 --rubber tread.toml
  The same as JSON, with the strain and the factors of every wave:
    asperity solve soft --wave 0.25:0.012 --wave 1:0.02:1 --speed 10 --pressure 0.3 --rubber tread.toml --json

Exit codes: 0 solved, 1 not converged or not written, 2 bad input.";

/// Solve the steady sliding contact of a rubber half-space with a periodic profile, at small strain and softened.
///
/// Filled rubber softens with strain (Payne). Each wave of the profile meets the storage and loss modulus of the strain that it works at,
/// E' f(strain) and E'' g(strain), by the strain sweeps of --rubber: a harmonic linearisation. Printed are friction and contact area
/// without and with this.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Soft {
    #[command(flatten)]
    shape: ShapeOptions,
    /// Sliding speed in mm/s.
    #[arg(long, value_name = "MM_S", value_parser = values::positive, allow_negative_numbers = true)]
    speed: f64,
    /// Mean pressure in MPa.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    pressure: f64,
    #[command(flatten)]
    material: MaterialOptions,
    /// Largest relative change of friction, contact area and factors of the moduli in the last step.
    #[arg(long, value_name = "RELATIVE", default_value = "1e-6", value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
}

/// What is printed; the names are the keys of the JSON object. Strains are amplitudes of elongation.
#[derive(Debug, Serialize)]
struct Summary {
    small_strain: Side,
    softened: Side,
    /// Wavelengths, and the strain and the factors of storage and loss modulus that each meets.
    wavelength_mm: Vec<f64>,
    wave_strain: Vec<f64>,
    wave_storage_factor: Vec<f64>,
    wave_loss_factor: Vec<f64>,
    largest_strain: f64,
    pressure_mpa: f64,
    residual: f64,
    steps: usize,
    grid_points: usize,
    seconds: f64,
}

impl Soft {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let material = self.material.material()?;
        let law = material.payne_law().ok_or_else(|| {
            CliError::input(
                "softening needs a rubber whose strain sweeps are known: give --rubber a file with a section [payne] \
                 (`asperity rubber payne` makes one)",
            )
        })?;
        let shape = self.shape.build()?;
        let of_shape = shape.warning.clone();
        let of_material = material.warnings(shape.excited_wavelengths(), self.speed.mm_to_m());
        for warning in of_shape.into_iter().chain(of_material) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let start = Instant::now();
        let solve = |points: usize| self.solve_on(&material, &law, &shape, points);
        let points = self.shape.points.unwrap_or(shape.heights.len());
        let no_solution = |error: &CliError| matches!(error, CliError::Failure(_));
        let soft = on_grid(points, *POINTS_RANGE.start(), HALF_SPACE, solve, no_solution, view)?;
        let summary = self.summary(&soft, &shape, start);
        require_finite(&[
            summary.softened.friction_coefficient,
            summary.softened.contact_area_fraction,
            summary.largest_strain,
        ])?;
        if let Some(warning) = law.extrapolation(summary.largest_strain) {
            note(quiet, format_args!("warning: {warning}"));
        }
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    fn solve_on(
        &self,
        material: &Material,
        law: &PayneLaw,
        shape: &Shape,
        points: usize,
    ) -> Result<Feedback, CliError> {
        let heights = shape.heights_on(points);
        let setup = FeedbackSetup {
            strain: Some(law),
            tolerance: self.tolerance,
            ..FeedbackSetup::new(material.rubber(), self.speed.mm_to_m(), shape.period, &heights)
        };
        Ok(FeedbackContact::new(setup)?.solve(self.pressure.mpa_to_pa())?)
    }

    fn summary(&self, refined: &Refined<Feedback>, shape: &Shape, start: Instant) -> Summary {
        let found = &refined.solution;
        let strain: Vec<f64> =
            found.strain.iter().map(|strain| elongation_of_tensor_shear(*strain)).collect();
        Summary {
            small_strain: Side::new(&found.without, None),
            softened: Side::new(&found.with, refined.error.map(ErrorEstimate::of_grid)),
            wavelength_mm: (1..=strain.len()).map(|k| shape.period.m_to_mm() / k as f64).collect(),
            largest_strain: strain.iter().copied().fold(0.0, f64::max),
            wave_strain: strain,
            wave_storage_factor: found.factors.storage.clone(),
            wave_loss_factor: found.factors.loss.clone(),
            pressure_mpa: self.pressure,
            residual: found.with.residual,
            steps: found.steps,
            grid_points: found.with.pressure.len(),
            seconds: start.elapsed().as_secs_f64(),
        }
    }
}

impl Summary {
    fn table(&self) -> String {
        let Self { small_strain, softened, .. } = self;
        let error =
            |value: fn(&ErrorEstimate) -> f64| printed(softened.error_estimate.as_ref(), value);
        aligned(&[
            ("friction at small strain", significant(small_strain.friction_coefficient)),
            ("friction, softened", significant(softened.friction_coefficient)),
            ("its estimated error", error(|estimate| estimate.total)),
            ("area at small strain", significant(small_strain.contact_area_fraction)),
            ("area, softened", significant(softened.contact_area_fraction)),
            ("its estimated error", error(|estimate| estimate.contact_area_fraction)),
            ("largest strain", significant(self.largest_strain)),
            ("mean pressure", significant(self.pressure_mpa) + " MPa"),
            ("contacts solved", self.steps.to_string()),
            ("grid points", self.grid_points.to_string()),
            ("time", significant(self.seconds) + " s"),
        ])
    }
}
