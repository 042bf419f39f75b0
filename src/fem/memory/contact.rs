//! The contact in the homogeneous block.

use super::{Memory, Pair2};
use crate::fem::local::NodeStiffness;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatMut};
use rustfft::num_complex::Complex64;

/// Stiffness of a contact node, over that of the surface, from which the correction heeds it.
const FELT: f64 = 1e-3;
/// More nodes would make the dense system cost more than it saves; the stiffest are kept.
const MOST_NODES: usize = 1024;
/// The contact at one Newton step.
pub struct MemoryContact<'a> {
    memory: &'a Memory,
    /// The contact nodes that are stiff, and their stiffness.
    nodes: Vec<usize>,
    stiffness: Vec<NodeStiffness>,
    system: PartialPivLu<f64>,
    edge_response: Vec<Pair2>,
}

impl Memory {
    /// Adds the contact of one Newton step: the stiffness of each contact node.
    pub fn with_contact(&self, contact: &[NodeStiffness]) -> MemoryContact<'_> {
        let n = self.unknowns.columns;
        let mut nodes: Vec<usize> =
            (0..n).filter(|j| contact[*j][1][1] > FELT * self.modulus).collect();
        if nodes.len() > MOST_NODES {
            nodes.sort_by(|a, b| contact[*b][1][1].total_cmp(&contact[*a][1][1]));
            nodes.truncate(MOST_NODES);
        }
        let entry = |i: usize, j: usize| {
            let s = &self.compliance[(nodes[i / 2] + n - nodes[j / 2]) % n][i % 2];
            let k = &contact[nodes[j / 2]];
            let product = s[0] * k[0][j % 2] + s[1] * k[1][j % 2];
            if i == j { product + 1.0 } else { product }
        };
        let size = 2 * nodes.len();
        let system = Mat::from_fn(size, size, entry).partial_piv_lu();
        let stiffness = nodes.iter().map(|j| contact[*j]).collect();
        let mut contact =
            MemoryContact { memory: self, nodes, stiffness, system, edge_response: Vec::new() };
        let mut edge = vec![Pair2::zeros(); self.waves * (self.unknowns.rows + 1)];
        let top = self.unknowns.rows * self.waves;
        edge[top - self.waves] = -self.edge[0] * Complex64::from(n as f64);
        edge[top] = -self.edge[1] * Complex64::from(n as f64);
        edge[top][0] = Complex64::ZERO;
        contact.solve_own(&mut edge);
        edge[top][0] = Complex64::from(n as f64);
        contact.edge_response = edge;
        contact
    }
}

impl MemoryContact<'_> {
    fn solve_own(&self, field: &mut [Pair2]) {
        let memory = self.memory;
        let n = memory.unknowns.columns;
        memory.solve(field);
        let mut surface = vec![0.0; 2 * n];
        memory.to_nodes(&field[..memory.waves], &mut surface);
        let mut touching: Vec<f64> =
            self.nodes.iter().flat_map(|j| [surface[2 * j], surface[2 * j + 1]]).collect();
        let size = touching.len();
        self.system.solve_in_place(MatMut::from_column_major_slice_mut(&mut touching, size, 1));
        surface.fill(0.0);
        for ((node, k), j) in touching.chunks_exact(2).zip(&self.stiffness).zip(&self.nodes) {
            surface[2 * j] = k[0][0] * node[0] + k[0][1] * node[1];
            surface[2 * j + 1] = k[1][0] * node[0] + k[1][1] * node[1];
        }
        let mut correction = vec![Pair2::zeros(); field.len()];
        memory.to_waves(&surface, &mut correction[..memory.waves]);
        memory.solve(&mut correction);
        for (wave, correction) in field.iter_mut().zip(&correction) {
            *wave -= correction;
        }
    }

    /// Adds `(F_0 - F) (F + B)⁻¹` of reduced forces to them.
    pub fn correct(&self, reduced: &mut [f64]) {
        let memory = self.memory;
        let (unknowns, waves) = (memory.unknowns, memory.waves);
        let own = unknowns.own();
        let mut nodes = unknowns.expand(reduced);
        let top = unknowns.upper_edge();
        nodes[top..].iter_mut().step_by(2).for_each(|x| *x = 0.0);
        let row_len = 2 * unknowns.columns;
        let mut field = vec![Pair2::zeros(); waves * (unknowns.rows + 1)];
        for (nodes, waves) in nodes.chunks_exact(row_len).zip(field.chunks_exact_mut(waves)) {
            memory.to_waves(nodes, waves);
        }
        self.solve_own(&mut field);
        let missing = Complex64::from(reduced[own] * unknowns.columns as f64) - field[0][0];
        let common = missing / self.edge_response[0][0];
        for (wave, response) in field.iter_mut().zip(&self.edge_response) {
            *wave += response * common;
        }
        let forces = memory.local_less_full(&field);
        for (nodes, waves) in nodes.chunks_exact_mut(row_len).zip(forces.chunks_exact(waves)) {
            memory.to_nodes(waves, nodes);
        }
        for (reduced, force) in reduced.iter_mut().zip(unknowns.reduce(&nodes, 0.0)) {
            *reduced += force;
        }
    }
}
