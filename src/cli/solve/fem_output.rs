//! What `asperity solve fem` prints and writes.

use asperity::units::Units;
use std::io::Write;

use serde::Serialize;

use super::error_estimate::ErrorEstimate;
use crate::cli::output::{aligned, significant};
use asperity::contact::refine::Refined;
use asperity::fem::steady::solution::SteadySolution;
use asperity::fem::transient::{Sample, TransientSolution};

/// What is printed; the names are the keys of the JSON object, those of `solve bem` first.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    friction_coefficient: f64,
    contact_area_fraction: f64,
    mean_separation_mm: f64,
    pressure_mpa: f64,
    /// `None` for the transient route, where each time step has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    residual: Option<f64>,
    iterations: usize,
    grid_points: usize,
    seconds: f64,
    rows: usize,
    /// Friction from the heat of the branches (steady), or from the work minus the stored energy.
    hysteretic_friction: f64,
    /// Friction from the power of the shear traction; none without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    interface_friction: Option<f64>,
    /// Largest less smallest friction of the averaged periods; transient route only.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_oscillation: Option<f64>,
    /// Largest I1 - 3 of a spring; none under the linear law and for the transient route.
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_invariant: Option<f64>,
    /// `None` if coarser meshes do not resolve the contact, and for the transient route.
    error_estimate: Option<ErrorEstimate>,
}

impl Summary {
    pub(super) fn steady(refined: &Refined<SteadySolution>, sheared: bool, seconds: f64) -> Self {
        let solution = &refined.solution;
        Self {
            error_estimate: refined.error.map(ErrorEstimate::of_grid),
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            pressure_mpa: solution.mean_pressure.pa_to_mpa(),
            residual: Some(solution.residual),
            iterations: solution.newton_steps,
            grid_points: solution.elements[0],
            seconds,
            rows: solution.elements[1],
            hysteretic_friction: solution.hysteretic_friction,
            interface_friction: sheared.then_some(solution.interface_friction),
            friction_oscillation: None,
            largest_invariant: solution.largest_invariant,
        }
    }

    pub(super) fn transient(
        solution: &TransientSolution,
        pressure: f64,
        elements: [usize; 2],
        seconds: f64,
    ) -> Self {
        let friction = solution.friction_coefficient;
        let heat = solution.energy.dissipated / solution.energy.drag_work;
        Self {
            friction_coefficient: friction.mean,
            contact_area_fraction: solution.contact_area_fraction.mean,
            mean_separation_mm: solution.mean_separation.mean.m_to_mm(),
            pressure_mpa: pressure.pa_to_mpa(),
            residual: None,
            largest_invariant: None,
            iterations: solution.counts.iterations.newton,
            grid_points: elements[0],
            seconds,
            rows: elements[1],
            hysteretic_friction: friction.mean * heat,
            interface_friction: None,
            friction_oscillation: Some(friction.range),
            error_estimate: None,
        }
    }

    /// Friction by the work of the drag and by the heat of the branches.
    pub(super) fn friction_and_heat(&self) -> (f64, f64) {
        (self.friction_coefficient, self.hysteretic_friction)
    }

    pub(super) fn table(&self) -> String {
        let mut lines = vec![
            ("friction coefficient", significant(self.friction_coefficient)),
            ("from the heat", significant(self.hysteretic_friction)),
            ("contact area fraction", significant(self.contact_area_fraction)),
            ("mean separation", significant(self.mean_separation_mm) + " mm"),
            ("mean pressure", significant(self.pressure_mpa) + " MPa"),
        ];
        if let Some(interface) = self.interface_friction {
            lines.insert(2, ("from the shear of the contact", significant(interface)));
        }
        if let Some(error) = &self.error_estimate {
            lines.insert(1, ("estimated error", format!("{:.1e}", error.total)));
        }
        if let Some(oscillation) = self.friction_oscillation {
            lines.insert(1, ("its oscillation", significant(oscillation)));
        }
        if let Some(residual) = self.residual {
            lines.push(("residual", significant(residual)));
        }
        lines.extend([
            ("iterations", self.iterations.to_string()),
            ("columns x rows", format!("{} x {}", self.grid_points, self.rows)),
            ("time", significant(self.seconds) + " s"),
        ]);
        if let Some(invariant) = self.largest_invariant {
            lines.push(("largest I1 - 3", significant(invariant)));
        }
        aligned(&lines)
    }
}

pub(super) fn write_fields(out: &mut dyn Write, solution: &SteadySolution) -> std::io::Result<()> {
    writeln!(out, "x_mm,height_mm,pressure_mpa,separation_mm")?;
    for node in &solution.nodes {
        let [x_mm, height_mm] = [node.x.m_to_mm(), node.profile_height.m_to_mm()];
        let [pressure_mpa, separation_mm] = [node.pressure.pa_to_mpa(), node.separation.m_to_mm()];
        writeln!(out, "{x_mm},{height_mm:e},{pressure_mpa:e},{separation_mm:e}")?;
    }
    Ok(())
}

pub(super) fn write_series(out: &mut dyn Write, samples: &[Sample]) -> std::io::Result<()> {
    writeln!(
        out,
        "time_s,pressure_mpa,displacement_mm,friction_coefficient,contact_area_fraction,mean_separation_mm"
    )?;
    for sample in samples {
        writeln!(
            out,
            "{:e},{},{},{},{},{}",
            sample.time,
            sample.pressure.pa_to_mpa(),
            sample.displacement.m_to_mm(),
            sample.friction_coefficient,
            sample.contact_area_fraction,
            sample.mean_separation.m_to_mm()
        )?;
    }
    Ok(())
}
