//! The memory's share in the tangent, in Fourier space: it turns the local tangent into a
//! preconditioner of the whole one.
//!
//! Linearised about the mean deformation of each row, the block is homogeneous along the rows,
//! and each wavenumber becomes a system of its own, tridiagonal over the rows of nodes. With `F`
//! such a block with its full memory, `F_0` one with the local stiffness of
//! [`super::local`] and `B` the stiffness of the contact, the preconditioner is
//!
//! ```text
//! P⁻¹ = K_local⁻¹ (F_0 + B) (F + B)⁻¹ = K_local⁻¹ (1 + (F_0 - F) (F + B)⁻¹)
//! ```
//!
//! It is exact for small deformations, where `K_local = F_0 + B`, and for rubber without memory,
//! where `F = F_0`. The contact enters `(F + B)⁻¹` through the displacements of the contact nodes
//! alone, a dense system of two unknowns for each node that is in contact or nearly so.

mod contact;
mod homogeneous;

pub use contact::MemoryContact;

use super::block::Block;
use super::unknowns::Unknowns;
use homogeneous::{MeanState, RowStiffness};
use nalgebra::{Matrix2, Vector2};
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

type Block2 = Matrix2<Complex64>;
type Pair2 = Vector2<Complex64>;

/// The homogeneous block at all wavenumbers, with its memory, and factorised.
pub struct Memory {
    unknowns: Unknowns,
    waves: usize,
    forward: Arc<dyn Fft<f64>>,
    backward: Arc<dyn Fft<f64>>,
    /// `F_0 - F` of each row of elements and wavenumber.
    difference: Vec<RowStiffness>,
    /// Inverse pivots of each row of nodes and wavenumber, eliminated from the upper edge.
    pivots: Vec<Block2>,
    /// Couplings of a row of nodes with the one above, and back.
    couplings: Vec<[Block2; 2]>,
    /// Stiffness in Pa of the surface against the shortest waves.
    modulus: f64,
    /// Compliance of the contact nodes: displacement at node `j` by a force at node 0.
    compliance: Vec<[[f64; 2]; 2]>,
    /// Forces by the displacement of the upper edge on the row below it, and on itself.
    edge: [Pair2; 2],
}

impl Memory {
    /// Linearises the block about the row means of displacements.
    pub fn new(block: &Block, displacements: &[f64], follows: &[Vec<f64>], modulus: f64) -> Self {
        let mesh = block.mesh();
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let waves = mesh.columns / 2 + 1;
        let mut planner = FftPlanner::new();
        let material = block.material();
        let rubber = &material.rubber;
        let means: Vec<f64> = displacements
            .chunks_exact(block.row_len())
            .map(|row| row.iter().step_by(2).sum::<f64>() / mesh.columns as f64)
            .collect();
        let mut difference = Vec::with_capacity(mesh.rows() * waves);
        let mut stiffness = Vec::with_capacity(mesh.rows() * waves);
        for row in 0..mesh.rows() {
            let element = mesh.element(row);
            let height = mesh.row_heights[row];
            let state = MeanState::new(block, (means[row + 1] - means[row]) / height);
            for wave in 0..waves {
                let angle = TAU * wave as f64 / mesh.columns as f64;
                let mut full = [
                    Complex64::from(rubber.equilibrium.shear),
                    Complex64::from(0.5 * rubber.equilibrium.volumetric),
                ];
                let mut local = full;
                for ((spring, filter), follows) in
                    rubber.branches.iter().zip(&material.filters).zip(&follows[row])
                {
                    let response = filter.response(angle);
                    let moduli = [spring.shear, 0.5 * spring.volumetric];
                    for (i, modulus) in moduli.into_iter().enumerate() {
                        full[i] += modulus * (1.0 - response);
                        local[i] += modulus * (1.0 - follows);
                    }
                }
                let with = state.stiffness(&element, angle, full);
                let without = state.stiffness(&element, angle, local);
                let mut change = without;
                for i in 0..2 {
                    for j in 0..2 {
                        change.0[i][j] -= with.0[i][j];
                    }
                }
                difference.push(change);
                stiffness.push(with);
            }
        }
        let mut memory = Self {
            unknowns,
            waves,
            forward: planner.plan_fft_forward(mesh.columns),
            backward: planner.plan_fft_inverse(mesh.columns),
            difference,
            pivots: Vec::new(),
            couplings: Vec::new(),
            modulus,
            compliance: Vec::new(),
            edge: [Pair2::zeros(); 2],
        };
        memory.factorise(&stiffness);
        memory.compliance = memory.contact_compliance();
        memory
    }

    /// Block elimination from the upper edge down.
    fn factorise(&mut self, stiffness: &[RowStiffness]) {
        let (rows, waves) = (self.unknowns.rows, self.waves);
        let mut pivots = vec![Block2::zeros(); (rows + 1) * waves];
        let mut couplings = vec![[Block2::zeros(); 2]; rows * waves];
        // The upper edge moves as a whole: its waves have no x displacement.
        let last = &stiffness[(rows - 1) * waves];
        self.edge = [last.0[0][1].column(0).into(), last.0[1][1].column(0).into()];
        for wave in 0..waves {
            let at = |row: usize| &stiffness[row * waves + wave].0;
            let mut diagonal = at(rows - 1)[1][1];
            diagonal.set_row(0, &nalgebra::RowVector2::new(Complex64::ONE, Complex64::ZERO));
            diagonal.set_column(0, &Pair2::new(Complex64::ONE, Complex64::ZERO));
            for row in (0..=rows).rev() {
                let inverse = diagonal.try_inverse().unwrap_or_else(Block2::zeros);
                pivots[row * waves + wave] = inverse;
                if row == 0 {
                    break;
                }
                let [mut up, mut down] = [at(row - 1)[0][1], at(row - 1)[1][0]];
                if row == rows {
                    up.set_column(0, &Pair2::zeros());
                    down.set_row(0, &nalgebra::RowVector2::zeros());
                }
                couplings[(row - 1) * waves + wave] = [up, down];
                diagonal = at(row - 1)[0][0] - up * inverse * down;
                if row > 1 {
                    diagonal += at(row - 2)[1][1];
                } else {
                    diagonal[(1, 1)] += AFLOAT * self.modulus;
                }
            }
        }
        (self.pivots, self.couplings) = (pivots, couplings);
    }

    /// Solves with the factors, for all wavenumbers.
    fn solve(&self, right: &mut [Pair2]) {
        let (rows, waves) = (self.unknowns.rows, self.waves);
        for row in (0..rows).rev() {
            let (below, above) = right.split_at_mut((row + 1) * waves);
            let below = &mut below[row * waves..];
            for wave in 0..waves {
                let eliminated = self.pivots[(row + 1) * waves + wave] * above[wave];
                below[wave] -= self.couplings[row * waves + wave][0] * eliminated;
            }
        }
        for (lowest, pivot) in right[..waves].iter_mut().zip(&self.pivots) {
            *lowest = pivot * *lowest;
        }
        for row in 1..=rows {
            let (below, above) = right.split_at_mut(row * waves);
            let below = &below[(row - 1) * waves..];
            for wave in 0..waves {
                let coupled = self.couplings[(row - 1) * waves + wave][1] * below[wave];
                above[wave] = self.pivots[row * waves + wave] * (above[wave] - coupled);
            }
        }
    }

    fn contact_compliance(&self) -> Vec<[[f64; 2]; 2]> {
        let columns = self.unknowns.columns;
        let mut compliance = vec![[[0.0; 2]; 2]; columns];
        for direction in 0..2 {
            let mut spectrum = vec![Pair2::zeros(); self.waves * (self.unknowns.rows + 1)];
            for wave in &mut spectrum[..self.waves] {
                wave[direction] = Complex64::ONE;
            }
            self.solve(&mut spectrum);
            let mut nodes = vec![0.0; 2 * columns];
            self.to_nodes(&spectrum[..self.waves], &mut nodes);
            for (j, entry) in compliance.iter_mut().enumerate() {
                entry[0][direction] = nodes[2 * j];
                entry[1][direction] = nodes[2 * j + 1];
            }
        }
        compliance
    }

    /// Spectrum of a row of nodes, by one complex transform of `x + i z`.
    fn to_waves(&self, nodes: &[f64], spectrum: &mut [Pair2]) {
        let n = self.unknowns.columns;
        let mut packed: Vec<Complex64> =
            nodes.chunks_exact(2).map(|node| Complex64::new(node[0], node[1])).collect();
        self.forward.process(&mut packed);
        for (k, wave) in spectrum.iter_mut().enumerate() {
            let (plus, minus) = (packed[k], packed[(n - k) % n].conj());
            let z = 0.5 * (plus - minus);
            *wave = Pair2::new(0.5 * (plus + minus), Complex64::new(z.im, -z.re));
        }
    }

    /// Row of nodes from its spectrum.
    fn to_nodes(&self, spectrum: &[Pair2], nodes: &mut [f64]) {
        let n = self.unknowns.columns;
        let mut packed = vec![Complex64::ZERO; n];
        for (k, wave) in spectrum.iter().enumerate() {
            let (x, z) = (wave[0], wave[1]);
            packed[k] = x + Complex64::I * z;
            if k > 0 && 2 * k < n {
                packed[n - k] = x.conj() + Complex64::I * z.conj();
            } else {
                packed[k] = Complex64::new(x.re, z.re);
            }
        }
        self.backward.process(&mut packed);
        for (node, value) in nodes.chunks_exact_mut(2).zip(&packed) {
            node[0] = value.re / n as f64;
            node[1] = value.im / n as f64;
        }
    }

    /// `F_0 - F` times a field.
    fn local_less_full(&self, field: &[Pair2]) -> Vec<Pair2> {
        let (rows, waves) = (self.unknowns.rows, self.waves);
        let mut forces = vec![Pair2::zeros(); field.len()];
        for row in 0..rows {
            for wave in 0..waves {
                let (lower, upper) = (row * waves + wave, (row + 1) * waves + wave);
                let blocks = &self.difference[lower].0;
                forces[lower] += blocks[0][0] * field[lower] + blocks[0][1] * field[upper];
                forces[upper] += blocks[1][0] * field[lower] + blocks[1][1] * field[upper];
            }
        }
        forces
    }
}

/// Stiffness on all contact nodes that keeps the block from floating away, over that of the
/// surface.
const AFLOAT: f64 = 1e-4;
