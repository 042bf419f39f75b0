//! A solved contact under a local law and the quantities read from it.

use super::error::LawError;
use super::law::LocalLaw;
use super::newton::violation_scale;
use crate::contact::half_space::HalfSpace;

/// The steady contact of the macro surface at one mean pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftContactSolution {
    /// Mean pressure p in Pa.
    pub mean_pressure: f64,
    /// Friction coefficient of the macro slopes, `mean(p z') / mean(p)`; positive where it opposes
    /// the motion. Without the contribution of the microscale.
    pub friction_coefficient: f64,
    /// The same from the hysteretic power of the pressure spectrum. On the converged grid the two
    /// are equal, since a local law that is a function of the pressure stores and returns its
    /// work; the difference measures the error by the grid.
    pub hysteretic_friction: f64,
    /// Mean separation ubar in m: of the mean planes of rubber and profile.
    pub mean_separation: f64,
    /// Number of grid points with `p > 0`.
    pub contact_points: usize,
    /// Largest violation, relative: of `u = g(p)` in contact and `u >= g(0)` outside, with the separation u, by the
    /// root mean square displacement (or 1e-4 of that of the heights, of the largest indentation or
    /// of the displacement by the mean pressure as the longest wave, if that is more: their
    /// round-off counts there), of the load by the mean pressure.
    pub residual: f64,
    /// Newton iterations on the finest grid, all stages of a softened law.
    pub iterations: usize,
    /// Applications of the operator by the linear solver, all grids, in units of the finest one.
    pub operator_applications: f64,
    /// Whether softened laws were needed.
    pub softened: bool,
    /// Local pressures in Pa at the grid points.
    pub pressure: Vec<f64>,
    /// Separations `ubar + w - z` in m at the grid points.
    pub separation: Vec<f64>,
}

/// Fields of a contact, to be evaluated.
pub(super) struct Fields<'a> {
    pub mean_pressure: f64,
    /// Approach of the mean planes from first touch in m: the mean separation would round it off
    /// where first touch is far away.
    pub approach: f64,
    pub pressure: Vec<f64>,
    pub heights: &'a [f64],
    pub slopes: &'a [f64],
    pub law: &'a LocalLaw,
}

impl Fields<'_> {
    /// Evaluates the fields afresh: of the iteration only the pressures and the approach are used.
    ///
    /// # Errors
    /// The law's, where a pressure lies beyond its samples.
    pub fn evaluate(self, space: &mut HalfSpace) -> Result<SoftContactSolution, LawError> {
        let n = self.pressure.len() as f64;
        let largest = self.pressure.iter().copied().fold(0.0_f64, f64::max);
        self.law.admit(largest)?;
        let mut displacement = vec![0.0; self.pressure.len()];
        space.displacement(&self.pressure, &mut displacement);
        let indentation: Vec<f64> =
            self.pressure.iter().map(|p| self.law.indentation(*p)).collect();
        let mean_separation = self.law.touch_separation() - self.approach;
        let beyond_touch =
            displacement.iter().zip(self.heights).map(|(w, z)| w - z - self.approach);
        let violation = beyond_touch.zip(&indentation).zip(&self.pressure).map(|((u, d), p)| {
            let defect = u + d;
            if *p > 0.0 { defect.abs() } else { (-defect).max(0.0) }
        });
        let scale = violation_scale(
            &displacement,
            self.heights,
            &indentation,
            space.compliance_range().0 * self.mean_pressure,
        );
        let gap_violation = violation.fold(0.0_f64, f64::max) / scale;
        let separation =
            displacement.iter().zip(self.heights).map(|(w, z)| mean_separation + w - z).collect();
        let mean = self.pressure.iter().sum::<f64>() / n;
        let traction =
            self.pressure.iter().zip(self.slopes).map(|(p, slope)| p * slope).sum::<f64>() / n;
        let load_error = (mean - self.mean_pressure).abs() / self.mean_pressure;
        Ok(SoftContactSolution {
            mean_pressure: self.mean_pressure,
            friction_coefficient: traction / mean,
            hysteretic_friction: space.hysteretic_traction(&self.pressure) / mean,
            mean_separation,
            contact_points: self.pressure.iter().filter(|p| **p > 0.0).count(),
            residual: gap_violation.max(load_error),
            iterations: 0,
            operator_applications: 0.0,
            softened: false,
            pressure: self.pressure,
            separation,
        })
    }
}
