//! A solved contact and what is read from it.

use super::edges::EdgeReader;
use super::half_space::HalfSpace;
use crate::numerics::krylov::euclidean_norm;

/// The steady contact at one mean pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSolution {
    /// Mean pressure p in Pa.
    pub mean_pressure: f64,
    /// Friction coefficient `mean(t z') / p`; positive where it opposes the motion.
    pub friction_coefficient: f64,
    /// Friction coefficient from the hysteretic power of the pressure spectrum. On the converged
    /// grid it equals [`Self::friction_coefficient`]; the difference measures the grid.
    pub hysteretic_friction: f64,
    /// Contact area fraction A_c/A_0, edges read between grid points.
    pub contact_area_fraction: f64,
    /// Mean separation in m: of the mean planes of rubber and profile.
    pub mean_separation: f64,
    /// Largest violation, relative: of `u = 0` in contact and `u >= 0` outside by the root mean
    /// square displacement (within 1e-4 and 1 of that of the heights, whose round-off counts where
    /// the displacement is small), of the load and `t >= 0` by the mean pressure.
    pub residual: f64,
    /// Active-set iterations on the finest grid.
    pub iterations: usize,
    /// Applications of the operator by the linear solver, all grids, in units of the finest one.
    pub operator_applications: f64,
    /// Pressure t in Pa at the grid points.
    pub pressure: Vec<f64>,
    /// Separation u in m at the grid points.
    pub separation: Vec<f64>,
}

/// Root mean square displacement, the scale of violated gaps; not below 1e-4 of that of the
/// heights, since their round-off keeps a gap from being any smaller than 1e-15 of them, and not
/// above it: under a pressure whose round-off exceeds all displacements the residual would otherwise look small.
pub(crate) fn displacement_scale(displacement: &[f64], heights: &[f64]) -> f64 {
    let root_mean_square = |x: &[f64]| euclidean_norm(x) / (x.len() as f64).sqrt();
    let height = root_mean_square(heights);
    // On a flat profile displacements are round-off.
    if height > 0.0 { root_mean_square(displacement).clamp(1e-4 * height, height) } else { 1.0 }
}

/// Fields of a contact, to be evaluated.
pub(super) struct Fields<'a> {
    pub mean_pressure: f64,
    pub mean_separation: f64,
    pub pressure: Vec<f64>,
    pub heights: &'a [f64],
    pub slopes: &'a [f64],
    pub edges: &'a EdgeReader,
}

impl Fields<'_> {
    /// Evaluates the fields afresh: of the iteration only the pressures and the mean separation are used.
    pub fn evaluate(self, space: &mut HalfSpace) -> ContactSolution {
        let n = self.pressure.len();
        let mut displacement = vec![0.0; n];
        space.displacement(&self.pressure, &mut displacement);
        let separation: Vec<f64> = displacement
            .iter()
            .zip(self.heights)
            .map(|(w, z)| self.mean_separation + w - z)
            .collect();
        let mean = self.pressure.iter().sum::<f64>() / n as f64;
        let traction =
            self.pressure.iter().zip(self.slopes).map(|(t, s)| t * s).sum::<f64>() / n as f64;
        let scale = displacement_scale(&displacement, self.heights);
        let gap_violation = self
            .pressure
            .iter()
            .zip(&separation)
            .map(|(t, u)| if *t > 0.0 { u.abs() } else { (-u).max(0.0) })
            .fold(0.0_f64, f64::max)
            / scale;
        let tension = self.pressure.iter().fold(0.0_f64, |worst, t| worst.max(-t));
        let load_error = (mean - self.mean_pressure).abs();
        ContactSolution {
            mean_pressure: self.mean_pressure,
            friction_coefficient: traction / mean,
            hysteretic_friction: space.hysteretic_traction(&self.pressure) / mean,
            contact_area_fraction: self.edges.contact_area_fraction(
                &self.pressure,
                &displacement,
                &separation,
            ),
            mean_separation: self.mean_separation,
            residual: gap_violation.max(tension.max(load_error) / self.mean_pressure),
            iterations: 0,
            operator_applications: 0.0,
            pressure: self.pressure,
            separation,
        }
    }
}
