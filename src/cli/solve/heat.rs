//! `asperity solve heat`: the steady sliding contact on the half-space, with the heat that it makes.

use asperity::units::Units;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::error_estimate::{ErrorEstimate, printed, require_finite};
use super::material::{Material, MaterialOptions};
use super::shape::{Shape, ShapeOptions};
use super::thermal::ThermalOptions;
use crate::cli::output::{aligned, json, note, print, significant};
use crate::cli::{CliError, values};
use asperity::contact::ContactSolution;
use asperity::contact::effective::{Feedback, FeedbackContact, FeedbackSetup, HeatFeedback};
use asperity::contact::refine::{HALF_SPACE, OnGrid, Refined, on_grid};
use asperity::contact::sliding::POINTS_RANGE;
use asperity::rubber::{HOTTEST_C, TemperatureDependence};

const EXAMPLES: &str = "\
Examples:
  Two sines at 1 m/s, after 20 ms of sliding:
    asperity solve heat --wave 0.25:0.012 --wave 1:0.02:1 --speed 1000 --pressure 0.3 --rubber tread.toml \\
      --conductivity 0.3 --density 1150 --heat-capacity 1500 --sliding-time 0.02
  The same after a block of 20 mm has slid over the place, with adhesion, on a road that conducts, as JSON:
    asperity solve heat --wave 0.25:0.012 --wave 1:0.02:1 --speed 1000 --pressure 0.3 --rubber tread.toml \\
      --conductivity 0.3 --density 1150 --heat-capacity 1500 --sliding-distance-mm 20 --shear-mpa 1 \\
      --road-conductivity 2.5 --road-density 2700 --road-heat-capacity 850 --json

Exit codes: 0 solved, 1 not converged or not written, 2 bad input.";

/// Solve the steady sliding contact of a rubber half-space with a periodic profile, cold and hot.
///
/// The contact heats the rubber, and each wave of the profile then meets the moduli of the temperature that it
/// works at, by the shift with temperature of --rubber. Printed are friction and contact area without and with this.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Heat {
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
    #[command(flatten)]
    thermal: ThermalOptions,
    /// Largest relative change of friction, contact area and shift factors in the last step.
    #[arg(long, value_name = "RELATIVE", default_value = "1e-6", value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
}

/// Friction and contact area.
#[derive(Debug, Serialize)]
pub(super) struct Side {
    pub friction_coefficient: f64,
    pub contact_area_fraction: f64,
    pub error_estimate: Option<ErrorEstimate>,
}

impl Side {
    pub fn new(solution: &ContactSolution, error_estimate: Option<ErrorEstimate>) -> Self {
        Self {
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
            error_estimate,
        }
    }
}

/// What is printed; the names are the keys of the JSON object. Temperatures are rises over that before sliding.
#[derive(Debug, Serialize)]
struct Summary {
    cold: Side,
    hot: Side,
    temperature_c: f64,
    contact_rise_k: f64,
    background_rise_k: f64,
    highest_rise_k: f64,
    highest_depth_mm: f64,
    power_w_m2: f64,
    heat_w_m2: f64,
    shear_power_w_m2: f64,
    road_flux_w_m2: f64,
    sliding_time_s: f64,
    sliding_distance_mm: f64,
    /// Wavelengths, and the rise and the shift factor that each meets.
    wavelength_mm: Vec<f64>,
    wave_rise_k: Vec<f64>,
    wave_shift_factor: Vec<f64>,
    pressure_mpa: f64,
    residual: f64,
    steps: usize,
    grid_points: usize,
    seconds: f64,
}

impl Heat {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let material = self.material.material()?;
        let law = material.temperature_dependence().ok_or_else(|| {
            CliError::input("heat needs a rubber whose shift with temperature is known: give --rubber a file with a section [temperature]")
        })?;
        let shape = self.shape.build()?;
        if let Some(warning) = &shape.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        for warning in material.warnings(shape.excited_wavelengths(), self.speed.mm_to_m()) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let start = Instant::now();
        let solve = |points: usize| self.solve_on(&material, &law, &shape, points);
        let points = self.shape.points.unwrap_or(shape.heights.len());
        let no_solution = |error: &CliError| matches!(error, CliError::Failure(_));
        let least = *POINTS_RANGE.start();
        let hot = on_grid(points, least, HALF_SPACE, solve, no_solution, view)?;
        let summary = self.summary(&hot, &law, &shape, start);
        require_finite(&[
            summary.hot.friction_coefficient,
            summary.hot.contact_area_fraction,
            summary.contact_rise_k,
        ])?;
        let hottest = law.reference_c + summary.highest_rise_k;
        let known = law.measured_c.map_or(HOTTEST_C, |[_, highest]| highest);
        if hottest > known {
            note(
                quiet,
                format_args!(
                    "warning: the rubber becomes up to {hottest:.1} °C warm, and its shift with temperature is known up to {known} °C: \
                     beyond that it is extrapolated"
                ),
            );
        }
        if summary.sliding_distance_mm < shape.period.m_to_mm() {
            note(
                quiet,
                format_args!(
                    "warning: the sliding distance of {} mm is shorter than the period of {} mm: its temperatures are \
                     overestimated, since waves along it are taken as steady",
                    significant(summary.sliding_distance_mm),
                    significant(shape.period.m_to_mm())
                ),
            );
        }
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    fn solve_on(
        &self,
        material: &Material,
        law: &TemperatureDependence,
        shape: &Shape,
        points: usize,
    ) -> Result<Feedback, CliError> {
        let heights = shape.heights_on(points);
        let speed = self.speed.mm_to_m();
        let heat = HeatFeedback {
            thermal: self.thermal.setting(speed),
            law,
            temperature_c: law.reference_c,
        };
        let setup = FeedbackSetup {
            heat: Some(heat),
            tolerance: self.tolerance,
            ..FeedbackSetup::new(material.rubber(), speed, shape.period, &heights)
        };
        Ok(FeedbackContact::new(setup)?.solve(self.pressure.mpa_to_pa())?)
    }

    fn summary(
        &self,
        refined: &Refined<Feedback>,
        law: &TemperatureDependence,
        shape: &Shape,
        start: Instant,
    ) -> Summary {
        let found = &refined.solution;
        let heat = found.heat.as_ref().expect("heat is part of the set-up");
        let per_period = |k: usize| shape.period.m_to_mm() / (k + 1) as f64;
        Summary {
            cold: Side::new(&found.without, None),
            hot: Side::new(&found.with, refined.error.map(ErrorEstimate::of_grid)),
            temperature_c: law.reference_c,
            contact_rise_k: heat.contact_mean,
            background_rise_k: heat.background,
            highest_rise_k: heat.highest,
            highest_depth_mm: heat.highest_depth.m_to_mm(),
            power_w_m2: heat.power,
            heat_w_m2: heat.heat,
            shear_power_w_m2: heat.shear_power,
            road_flux_w_m2: heat.road_flux,
            sliding_time_s: heat.sliding_distance / self.speed.mm_to_m(),
            sliding_distance_mm: heat.sliding_distance.m_to_mm(),
            wavelength_mm: (0..found.rise.len()).map(per_period).collect(),
            wave_rise_k: found.rise.clone(),
            wave_shift_factor: found.factors.ln_shift.iter().map(|a| a.exp()).collect(),
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
        let error =
            |value: fn(&ErrorEstimate) -> f64| printed(self.hot.error_estimate.as_ref(), value);
        let kelvin = |rise: f64| significant(rise) + " K";
        aligned(&[
            ("cold friction coefficient", significant(self.cold.friction_coefficient)),
            ("hot friction coefficient", significant(self.hot.friction_coefficient)),
            ("its estimated error", error(|estimate| estimate.total)),
            ("cold contact area fraction", significant(self.cold.contact_area_fraction)),
            ("hot contact area fraction", significant(self.hot.contact_area_fraction)),
            ("its estimated error", error(|estimate| estimate.contact_area_fraction)),
            ("rise of the contact", kelvin(self.contact_rise_k)),
            ("rise of the surface", kelvin(self.background_rise_k)),
            ("highest rise", kelvin(self.highest_rise_k)),
            ("at the depth", significant(self.highest_depth_mm) + " mm"),
            ("temperature before", significant(self.temperature_c) + " °C"),
            ("frictional power", significant(self.power_w_m2) + " W/m²"),
            ("power of shear", significant(self.shear_power_w_m2) + " W/m²"),
            ("heat to the road", significant(self.road_flux_w_m2) + " W/m²"),
            ("sliding distance", significant(self.sliding_distance_mm) + " mm"),
            ("mean pressure", significant(self.pressure_mpa) + " MPa"),
            ("contacts solved", self.steps.to_string()),
            ("grid points", self.grid_points.to_string()),
            ("time", significant(self.seconds) + " s"),
        ])
    }
}

pub(super) fn view(found: &Feedback) -> OnGrid {
    OnGrid {
        points: found.with.pressure.len(),
        friction_coefficient: found.with.friction_coefficient,
        contact_area_fraction: found.with.contact_area_fraction,
    }
}
