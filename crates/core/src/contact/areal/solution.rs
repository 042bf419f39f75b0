//! A solved areal contact and what is read from it.

use super::super::solution::displacement_scale;
use super::edges::{Area, ArealEdges};
use super::half_space::{ArealHalfSpace, mean};

/// The steady contact of a surface at one mean pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct ArealSolution {
    /// Mean pressure p in Pa.
    pub mean_pressure: f64,
    /// Friction coefficient `mean(t dz/ds) / p` along the sliding direction `s`; positive where it opposes the motion.
    pub friction_coefficient: f64,
    /// Lateral force over load, `mean(t dz/dn) / p`, with `n` to the left of the sliding direction; positive where the
    /// surface pushes the rubber to the right. Zero for surfaces that are mirrored across the direction.
    pub lateral_coefficient: f64,
    /// Friction coefficient from the hysteretic power of the pressure spectrum. On the converged grid it equals
    /// [`Self::friction_coefficient`]; the difference measures the grid.
    pub hysteretic_friction: f64,
    /// Contact area fraction A_c/A_0, edges read between grid points.
    pub contact_area_fraction: f64,
    /// Estimated error of [`Self::contact_area_fraction`] by the grid: its distance to the points in contact less a
    /// correction proportional to the length of the edges (Yastrebov, Anciaux & Molinari 2017,
    /// arXiv:1701.02727), or a fiftieth of a step along all edges, whichever is larger.
    pub contact_area_error: f64,
    /// Part of the points that is in contact; it jumps with pressure, and is too large by about a quarter of a grid step
    /// along all edges.
    pub points_in_contact: f64,
    /// Mean separation in m: of the mean planes of the surface of the rubber and of the rigid surface.
    pub mean_separation: f64,
    /// Mean compression in m of a layer; zero for a half-space, whose is not defined.
    pub mean_compression: f64,
    /// Largest violation, relative: of `u = 0` in contact and `u >= 0` outside by the root mean square displacement
    /// (within 1e-4 and 1 of that of the heights), of the load and `t >= 0` by the mean pressure.
    pub residual: f64,
    /// Active-set iterations on the finest grid.
    pub iterations: usize,
    /// Applications of the operator or of the preconditioner, each a transform forth and back, on all grids in units of
    /// the finest one.
    pub operator_applications: f64,
    /// Pressure t in Pa, ordered like the heights.
    pub pressure: Vec<f64>,
    /// Separation u in m, ordered like the heights.
    pub separation: Vec<f64>,
}

/// Fields of a contact, to be evaluated.
pub(super) struct Fields<'a> {
    pub mean_pressure: f64,
    pub mean_separation: f64,
    pub mean_compliance: f64,
    pub pressure: Vec<f64>,
    pub heights: &'a [f64],
    pub edges: &'a ArealEdges,
}

impl Fields<'_> {
    /// Evaluates the fields afresh: of the iteration only the pressures and the mean separation are used.
    pub fn evaluate(self, space: &mut ArealHalfSpace) -> ArealSolution {
        let mut separation = vec![0.0; self.pressure.len()];
        space.displacement(&self.pressure, &mut separation);
        let scale = displacement_scale(&separation, self.heights);
        let points = space.points();
        for (u, z) in separation.iter_mut().zip(self.heights) {
            *u += self.mean_separation - z;
        }
        let violation = |(t, u): (&f64, &f64)| if *t > 0.0 { u.abs() } else { (-u).max(0.0) };
        let gap = self.pressure.iter().zip(&separation).map(violation).fold(0.0_f64, nan_max);
        let load = mean(&self.pressure);
        let tension = self.pressure.iter().fold(0.0_f64, |worst, t| worst.max(-t));
        let load_error = tension.max((load - self.mean_pressure).abs()) / self.mean_pressure;
        let area = self.edges.area(points, &self.pressure, &separation, self.heights);
        let mut traction = |across| {
            let slope = space.slope(self.heights, across);
            let product: f64 = self.pressure.iter().zip(&slope).map(|(t, s)| t * s).sum();
            product / self.pressure.len() as f64
        };
        let (along, across) = (traction(false), traction(true));
        let Area { fraction, error, points } = area;
        ArealSolution {
            mean_pressure: self.mean_pressure,
            friction_coefficient: along / load,
            lateral_coefficient: across / load,
            hysteretic_friction: space.hysteretic_traction(&self.pressure) / load,
            contact_area_fraction: fraction,
            contact_area_error: error,
            points_in_contact: points,
            mean_separation: self.mean_separation,
            mean_compression: self.mean_compliance * self.mean_pressure,
            residual: nan_max(gap / scale, load_error),
            iterations: 0,
            operator_applications: 0.0,
            pressure: self.pressure,
            separation,
        }
    }
}

/// The larger number; not a number if one of both is none.
fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
