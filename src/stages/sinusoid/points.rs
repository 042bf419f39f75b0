//! Solves on two meshes to values with their mesh error.

use super::problem::{Model, Outcome, Problem, Solved};
use super::rows::Limit;
use super::{AsymptoteRow, FieldRow, PointRow, Sinusoid, TwoMeshes};
use crate::reference::{SineCrest, Westergaard};
use crate::rubber::Rubber;
use crate::surface::SineScale;
use crate::units::Units;
use std::f64::consts::TAU;

/// Order of the methods that the extrapolation assumes: the half-space shows 2.1 and 2.2, bilinear
/// elements have it away from contact edges.
const ORDER: i32 = 2;

/// The same problem on both meshes.
pub(super) struct Case {
    pub finer: Problem,
    pub coarser: Problem,
}

impl Case {
    /// All aspect ratios, models and speeds at the pressure of the sweep, by ascending speed.
    pub fn sweep(parameters: &Sinusoid) -> Vec<Self> {
        let mut cases = Vec::new();
        for ratio in &parameters.aspect_ratios {
            for model in Model::ALL {
                for speed in &parameters.speeds_mm_s {
                    let keeps = parameters.keeps_fields(*ratio, *speed);
                    let pressures = [parameters.pressure_mpa];
                    cases.push(Self::new(parameters, model, *ratio, *speed, &pressures, keeps));
                }
            }
        }
        cases
    }

    /// All models and speeds over the pressures of the recipe.
    pub fn pressures(parameters: &Sinusoid) -> Vec<Self> {
        let Some(wanted) = &parameters.pressure_dependence else { return Vec::new() };
        let (ratio, pressures) = (wanted.aspect_ratio, &wanted.pressures_mpa);
        let case = |model, speed| Self::new(parameters, model, ratio, speed, pressures, false);
        let of = |model| wanted.speeds_mm_s.iter().map(move |speed| case(model, *speed));
        Model::ALL.into_iter().flat_map(of).collect()
    }

    fn new(
        parameters: &Sinusoid,
        model: Model,
        aspect_ratio: f64,
        speed_mm_s: f64,
        pressures_mpa: &[f64],
        keeps_fields: bool,
    ) -> Self {
        let columns = match model {
            Model::HalfSpace => parameters.half_space_points,
            Model::Linear | Model::NeoHookean => parameters.columns,
        } as usize;
        let finer = Problem {
            model,
            wavelength_mm: parameters.wavelength_mm,
            aspect_ratio,
            speed_mm_s,
            pressures_mpa: pressures_mpa.to_vec(),
            columns,
            keeps_fields,
        };
        let coarser = Problem { columns: columns / 2, keeps_fields: false, ..finer.clone() };
        Self { finer, coarser }
    }
}

/// The speed by which speeds are measured.
pub(super) struct Scale {
    /// `v* = L / (2 π τ)` in mm/s.
    speed_mm_s: f64,
}

impl Scale {
    /// Scale of a rubber with branches and a wavelength in mm: `τ = Σ E_k τ_k / Σ E_k`.
    pub fn of(rubber: &Rubber, wavelength_mm: f64) -> Self {
        let sum = |value: fn(&crate::rubber::MaxwellBranch) -> f64| {
            rubber.branches.iter().map(value).sum::<f64>()
        };
        let time = sum(|branch| branch.modulus * branch.relaxation_time) / sum(|b| b.modulus);
        Self { speed_mm_s: wavelength_mm / (TAU * time) }
    }

    fn deborah_number(&self, speed_mm_s: f64) -> f64 {
        speed_mm_s / self.speed_mm_s
    }
}

fn rms_slope(aspect_ratio: f64) -> f64 {
    SineScale { wavelength: 1.0, amplitude: aspect_ratio }.rms_slope()
}

/// One row for each case and pressure.
pub(super) fn rows(cases: &[Case], outcomes: &[TwoMeshes], scale: &Scale) -> Vec<PointRow> {
    let mut rows = Vec::new();
    for (case, [finer, coarser]) in cases.iter().zip(outcomes) {
        for (i, pressure) in case.finer.pressures_mpa.iter().enumerate() {
            rows.push(row(&case.finer, *pressure, &finer[i], &coarser[i], scale));
        }
    }
    rows
}

fn row(
    problem: &Problem,
    pressure_mpa: f64,
    finer: &Outcome,
    coarser: &Outcome,
    scale: &Scale,
) -> PointRow {
    let of = |value: fn(&Solved) -> f64| Refined {
        fine: finer.solved().map(value),
        coarse: coarser.solved().map(value),
    };
    let friction = of(|solved| solved.friction_coefficient);
    let area = of(|solved| solved.contact_area_fraction);
    let separation = of(|solved| solved.mean_separation_mm);
    let by_power = finer.solved().map(|s| (s.friction_coefficient - s.hysteretic_friction).abs());
    PointRow {
        aspect_ratio: problem.aspect_ratio,
        rms_slope: rms_slope(problem.aspect_ratio),
        model: problem.model,
        speed_mm_s: problem.speed_mm_s,
        deborah_number: scale.deborah_number(problem.speed_mm_s),
        pressure_mpa,
        columns: problem.columns as u64,
        friction_coefficient: friction.fine,
        friction_coarse: friction.coarse,
        friction_extrapolated: friction.extrapolated(),
        friction_mesh_error: friction.error().zip(by_power).map(|(a, b)| a.max(b)),
        contact_area_fraction: area.fine,
        area_coarse: area.coarse,
        area_extrapolated: area.extrapolated(),
        area_mesh_error: area.error(),
        mean_separation_mm: separation.fine,
        separation_mesh_error_mm: separation.error(),
        residual: finer.solved().map(|solved| solved.residual),
        why_missing: match finer {
            Outcome::Solved(_) => None,
            Outcome::NoSolution { why, .. } => Some(why.clone()),
        },
        path_ended_at_mpa: finer.path_ended_at_mpa(),
        coarse_path_ended_at_mpa: coarser.path_ended_at_mpa(),
    }
}

/// A value on both meshes, as far as they have a solution.
struct Refined {
    fine: Option<f64>,
    coarse: Option<f64>,
}

impl Refined {
    fn difference(&self) -> Option<f64> {
        Some(self.fine? - self.coarse?)
    }

    /// Without an assumed order: for any order from the first on it bounds the error.
    fn error(&self) -> Option<f64> {
        self.difference().map(f64::abs)
    }

    fn extrapolated(&self) -> Option<f64> {
        Some(self.fine? + self.difference()? / (2_f64.powi(ORDER) - 1.0))
    }
}

/// Pressure and separation of the cases that keep them and have a solution.
pub(super) fn fields(cases: &[Case], outcomes: &[TwoMeshes], scale: &Scale) -> Vec<FieldRow> {
    let mut rows = Vec::new();
    for (case, [finer, _]) in cases.iter().zip(outcomes) {
        let problem = &case.finer;
        let nodes = finer.iter().filter_map(Outcome::solved).flat_map(|solved| &solved.nodes);
        rows.extend(nodes.map(|node| FieldRow {
            aspect_ratio: problem.aspect_ratio,
            rms_slope: rms_slope(problem.aspect_ratio),
            model: problem.model,
            speed_mm_s: problem.speed_mm_s,
            deborah_number: scale.deborah_number(problem.speed_mm_s),
            x_mm: node.x_mm,
            profile_height_mm: node.profile_height_mm,
            pressure_mpa: node.pressure_mpa,
            separation_mm: node.separation_mm,
        }));
    }
    rows
}

/// The elastic limits of every aspect ratio.
pub(super) fn asymptotes(parameters: &Sinusoid, rubber: &Rubber) -> Vec<AsymptoteRow> {
    let plane_strain = 1.0 - rubber.poisson_ratio.powi(2);
    let limits =
        [(Limit::Slow, rubber.equilibrium_modulus), (Limit::Fast, rubber.glassy_modulus())];
    let pressure = parameters.pressure_mpa.mpa_to_pa();
    let row = |aspect_ratio: f64, limit: Limit, modulus: f64| {
        let reduced_modulus = modulus / plane_strain;
        let wavelength = parameters.wavelength_mm.mm_to_m();
        let wave = SineScale { wavelength, amplitude: aspect_ratio * wavelength };
        let (hertz, sine) =
            (SineCrest { reduced_modulus, wave }, Westergaard { reduced_modulus, wave });
        AsymptoteRow {
            aspect_ratio,
            rms_slope: rms_slope(aspect_ratio),
            limit,
            pressure_mpa: parameters.pressure_mpa,
            reduced_modulus_mpa: reduced_modulus.pa_to_mpa(),
            hertz_area_fraction: hertz.contact_area_fraction(pressure),
            hertz_maximum_pressure_mpa: hertz.maximum_pressure(pressure).pa_to_mpa(),
            full_contact_pressure_mpa: sine.full_contact_pressure().pa_to_mpa(),
            westergaard_area_fraction: sine.contact_area_fraction(pressure),
        }
    };
    let of = |ratio: &f64| limits.map(|(limit, modulus)| row(*ratio, limit, modulus));
    parameters.aspect_ratios.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_relaxation_time_of_one_branch_is_its_own() {
        let mut rubber = Rubber::table_2_1();
        rubber.branches.truncate(1);
        let time = rubber.branches[0].relaxation_time;
        // De = 1 where the wave passes at the frequency 1/τ: 2 π v/L = 1/τ.
        let scale = Scale::of(&rubber, 0.5);
        approx::assert_relative_eq!(
            scale.deborah_number(0.5 / (TAU * time)),
            1.0,
            max_relative = 1e-15
        );
    }

    #[test]
    fn extrapolation_is_exact_for_the_second_order() {
        let at = |columns: f64| 0.3 + 7.0 / columns.powi(2);
        let value = Refined { fine: Some(at(64.0)), coarse: Some(at(32.0)) };
        approx::assert_relative_eq!(value.extrapolated().unwrap(), 0.3, max_relative = 1e-14);
        assert!(value.error().unwrap() > at(64.0) - 0.3);
        let lone = Refined { fine: Some(0.3), coarse: None };
        assert_eq!((lone.extrapolated(), lone.error()), (None, None));
    }

    #[test]
    fn a_missing_solution_is_no_number() {
        let parameters: Sinusoid = toml::from_str(
            "rubber = ''\nwavelength_mm = 1.0\naspect_ratios = [0.1]\nspeeds_mm_s = [1.0]\n\
             pressure_mpa = 2.0",
        )
        .unwrap();
        let case = &Case::sweep(&parameters)[1];
        let missing = |path_ended_at_mpa| Outcome::NoSolution {
            why: "the path ended".into(),
            path_ended_at_mpa,
        };
        let scale = Scale::of(&Rubber::table_2_1(), 1.0);
        let row = row(&case.finer, 2.0, &missing(Some(0.5)), &missing(None), &scale);
        assert_eq!(
            (row.model, row.friction_coefficient, row.residual),
            (Model::Linear, None, None)
        );
        assert_eq!((row.path_ended_at_mpa, row.coarse_path_ended_at_mpa), (Some(0.5), None));
        assert_eq!(row.why_missing.as_deref(), Some("the path ended"));
        // One sine of aspect ratio 0.1: √2 π / 10.
        approx::assert_relative_eq!(row.rms_slope, 0.444_288_293_815_836_6, max_relative = 1e-14);
    }
}
