//! Frictionless contact of the lower edge with the rigid profile, surface to surface.
//!
//! The gap `g = z - z_profile(x)` is taken at the Gauss points of the lower edge and weighted with
//! the shape functions: one gap and one nominal pressure `t_j` for each node j,
//!
//! ```text
//! g_j = ∫ N_j g dX / ∫ N_j dX,    t_j = max(0, λ_j - ε g_j)       (thesis 2.3.63-64)
//! ```
//!
//! with the penalty ε and the multiplier λ of the augmented Lagrange method. The pressure between
//! the nodes is `t = Σ_j N_j t_j`, and its force on the rubber is `t (-z', 1)` per reference
//! length, which does exactly the work of the gaps. Pressures at the Gauss points instead would
//! be twice as many as the displacements of the nodes, and would not converge with the multipliers.

use crate::fem::mesh::Mesh;
use crate::fem::profile::{Height, RigidProfile};

/// Gauss points of an edge on the unit interval; each has the weight one half.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Pressures of the multipliers and the penalty.
#[derive(Debug, Clone, PartialEq)]
pub struct Multipliers {
    /// λ in Pa for each node of the lower edge.
    pub values: Vec<f64>,
    /// ε in Pa/m.
    pub penalty: f64,
}

/// The contact at given displacements.
#[derive(Debug, Clone)]
pub struct Contact {
    spacing: f64,
    penalty: f64,
    /// Profile under the Gauss points of each edge.
    under: Vec<[Height; 2]>,
    /// Weighted gap in m of each node.
    pub gaps: Vec<f64>,
    /// Nominal pressure in Pa at each node.
    pub pressures: Vec<f64>,
    /// Nodes whose pressure changes with the gap.
    pub active: Vec<bool>,
    /// Mean of the gap in m over the current length.
    pub mean_separation: f64,
    /// Projected current length of the nodes in contact over the period.
    pub area_fraction: f64,
}

/// Derivative of the weighted gap of a node, times the spacing, by `(x, z)` of the node before
/// it, of itself and of the node after it.
pub type GapGradient = [f64; 6];

impl Contact {
    /// The contact at `edge`, the displacements `(x, z)` in m of the nodes of the lower edge.
    pub fn at(
        mesh: &Mesh,
        profile: &RigidProfile,
        edge: &[f64],
        multipliers: &Multipliers,
    ) -> Self {
        let (n, spacing) = (mesh.columns, mesh.spacing());
        let mut under = Vec::with_capacity(n);
        let mut gaps = vec![0.0; n];
        let mut separation = 0.0;
        for left in 0..n {
            let right = (left + 1) % n;
            let stretch = 1.0 + (edge[2 * right] - edge[2 * left]) / spacing;
            under.push(GAUSS.map(|s| {
                let between = |i: usize| (1.0 - s) * edge[2 * left + i] + s * edge[2 * right + i];
                let at = profile.at((left as f64 + s) * spacing + between(0));
                let gap = between(1) - at.height;
                gaps[left] += 0.5 * (1.0 - s) * gap;
                gaps[right] += 0.5 * s * gap;
                separation += 0.5 * stretch * gap;
                at
            }));
        }
        let penalty = multipliers.penalty;
        let trial: Vec<f64> =
            multipliers.values.iter().zip(&gaps).map(|(l, g)| l - penalty * g).collect();
        let mut active: Vec<bool> = trial.iter().map(|t| *t > 0.0).collect();
        if !active.contains(&true) {
            // At least one node carries the block while the iteration looks for its contact.
            let lowest = (0..n).max_by(|a, b| trial[*a].total_cmp(&trial[*b]));
            lowest.into_iter().for_each(|node| active[node] = true);
        }
        let pressures =
            trial.iter().zip(&active).map(|(t, active)| if *active { *t } else { 0.0 }).collect();
        let length = |node: usize| {
            let (before, after) = ((node + n - 1) % n, (node + 1) % n);
            spacing + 0.5 * (edge[2 * after] - edge[2 * before])
        };
        let area: f64 = (0..n).filter(|node| active[*node]).map(length).sum();
        Self {
            spacing,
            penalty,
            under,
            gaps,
            pressures,
            active,
            mean_separation: separation / n as f64,
            area_fraction: area / mesh.period,
        }
    }

    /// Nodes of the lower edge.
    pub fn nodes(&self) -> usize {
        self.gaps.len()
    }

    /// Derivative of the weighted gap of a node, times the spacing.
    pub fn gap_gradient(&self, node: usize) -> GapGradient {
        let before = (node + self.nodes() - 1) % self.nodes();
        let mut gradient = [0.0; 6];
        for (point, s) in GAUSS.into_iter().enumerate() {
            // In the edge to the left the node is the right end.
            for (slope, own, first) in [
                (self.under[before][point].slope, s, 0),
                (self.under[node][point].slope, 1.0 - s, 2),
            ] {
                let weight = 0.5 * self.spacing * own;
                for (end, shape) in [(first, 1.0 - s), (first + 2, s)] {
                    gradient[end] -= weight * shape * slope;
                    gradient[end + 1] += weight * shape;
                }
            }
        }
        gradient
    }

    /// Positions in an array over the nodes of the entries of [`GapGradient`].
    pub fn dofs(nodes: usize, node: usize) -> [usize; 6] {
        let (before, after) = ((node + nodes - 1) % nodes, (node + 1) % nodes);
        [2 * before, 2 * before + 1, 2 * node, 2 * node + 1, 2 * after, 2 * after + 1]
    }

    /// Adds the forces in N/m on the rubber to an array over the nodes, times `factor`.
    pub fn add_forces(&self, factor: f64, forces: &mut [f64]) {
        for (node, pressure) in self.pressures.iter().enumerate() {
            let gradient = self.gap_gradient(node);
            for (dof, by_dof) in Self::dofs(self.nodes(), node).into_iter().zip(gradient) {
                forces[dof] += factor * pressure * by_dof;
            }
        }
    }

    /// Stiffness of the penalty for one node, by the entries of [`GapGradient`]: zero where the
    /// node is not in contact.
    pub fn penalty_stiffness(&self, node: usize) -> [[f64; 6]; 6] {
        let factor = if self.active[node] { self.penalty / self.spacing } else { 0.0 };
        let gradient = self.gap_gradient(node);
        gradient.map(|a| gradient.map(|b| factor * a * b))
    }

    /// Stiffness from the curvature of the profile under the edge to the right of a node: by the
    /// x displacements of its left and right end.
    pub fn curvature_stiffness(&self, left: usize) -> [[f64; 2]; 2] {
        let right = (left + 1) % self.nodes();
        let mut stiffness = [[0.0; 2]; 2];
        for (s, under) in GAUSS.into_iter().zip(&self.under[left]) {
            let shape = [1.0 - s, s];
            let pressure = shape[0] * self.pressures[left] + shape[1] * self.pressures[right];
            let factor = 0.5 * self.spacing * pressure * under.curvature;
            for (i, row) in stiffness.iter_mut().enumerate() {
                row.iter_mut().zip(shape).for_each(|(k, b)| *k += factor * shape[i] * b);
            }
        }
        stiffness
    }

    /// Horizontal force in N/m against motion along +x, and vertical force, on the rubber.
    pub fn resultants(&self) -> (f64, f64) {
        let mut forces = vec![0.0; 2 * self.nodes()];
        self.add_forces(1.0, &mut forces);
        let sum = |i: usize| forces.iter().skip(i).step_by(2).sum::<f64>();
        (-sum(0), sum(1))
    }

    /// Largest violation in m of the contact conditions: penetration, or a gap under a multiplier.
    pub fn violation(&self, multipliers: &Multipliers) -> f64 {
        self.pressures
            .iter()
            .zip(&multipliers.values)
            .map(|(t, l)| (t - l).abs() / self.penalty)
            .fold(0.0, f64::max)
    }
}
