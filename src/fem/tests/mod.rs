//! The steady block against exact results.

use super::block::Block;
use super::filter::Filter;
use super::mesh::{Grading, Mesh};
use super::row::Material;
use super::unknowns::Unknowns;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

mod manufactured;

const SPEED: f64 = 0.01;

fn block(rubber: &Rubber, rheology: Rheology, mesh: Mesh) -> Block {
    let rubber = FiniteStrainRubber::new(rubber, rheology).unwrap();
    let length = |time: f64| Filter::new(mesh.spacing(), SPEED * time);
    let filters = rubber.branches.iter().map(|b| length(b.relaxation_time)).collect();
    Block::new(mesh, Material { rubber, filters })
}

fn skewed(columns: usize) -> Mesh {
    let grading = Grading { first: 0.8, growth: 1.3 };
    Mesh { skew: -0.4, ..Mesh::graded(columns, 1e-4, 7.5e-5, grading) }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

#[test]
fn homogeneous_deformation_is_in_equilibrium() {
    for law in [Rheology::NeoHookean, Rheology::Linear] {
        let mesh = skewed(12);
        let heights = mesh.node_heights();
        let mut block = block(&Rubber::table_2_1(), law, mesh.clone());
        // Shear and compression of the rows: u = (0.5 Z, -0.1 Z).
        let displacements: Vec<f64> =
            heights.iter().flat_map(|z| [0.5 * z, -0.1 * z].repeat(mesh.columns)).collect();
        let forces = block.deform(&displacements).unwrap();
        let row_len = block.row_len();
        let inner = &forces[row_len..forces.len() - row_len];
        let outer = largest(&forces[..row_len]);
        // Forces of the outer rows are 1e-6 of the glassy stiffness, whose round-off remains.
        assert!(largest(inner) < 1e-9 * outer, "{law:?}: {} of {outer}", largest(inner));
        assert!(block.dissipation(&displacements).abs() < 1e-12, "nothing flows at rest");
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_forces() {
    for law in [Rheology::NeoHookean, Rheology::Linear] {
        let mesh = skewed(10);
        let scale = mesh.spacing();
        let mut block = block(&Rubber::table_2_1(), law, mesh);
        let mut generator = Pcg64::seed_from_u64(3);
        let count = block.row_len() * (block.rows().len() + 1);
        let mut random = |size: f64| -> Vec<f64> {
            (0..count).map(|_| size * scale * (generator.random::<f64>() - 0.5)).collect()
        };
        let (at, direction) = (random(0.2), random(1.0));
        let step = 1e-5;
        let mut shifted = |by: f64| {
            let displacements: Vec<f64> =
                at.iter().zip(&direction).map(|(u, d)| u + by * d).collect();
            block.deform(&displacements).unwrap()
        };
        let (after, before) = (shifted(step), shifted(-step));
        block.deform(&at).unwrap();
        let tangent = block.tangent(&direction);
        let difference: Vec<f64> = after
            .iter()
            .zip(&before)
            .zip(&tangent)
            .map(|((a, b), t)| (a - b) / (2.0 * step) - t)
            .collect();
        // Second order of the step, 1e-10, times third derivatives over first.
        assert!(largest(&difference) < 1e-7 * largest(&tangent), "{law:?}");
    }
}

/// The tangent of some entries as a dense matrix.
fn dense_tangent(block: &Block, count: usize, free: &[usize]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(free.len(), free.len());
    for (column, entry) in free.iter().enumerate() {
        let mut unit = vec![0.0; count];
        unit[*entry] = 1.0;
        let forces = block.tangent(&unit);
        for (row, entry) in free.iter().enumerate() {
            matrix[(row, column)] = forces[*entry];
        }
    }
    matrix
}

/// A thin strip under a sinusoidal load bends like a plate: `w = 12 p / (E_r t³ q⁴)`, plus the
/// shear deflection `w = 6/5 p / (μ t q²)`. Elements that lock at ν = 0.49 are several times stiffer.
#[test]
fn bending_does_not_lock() {
    let (columns, rows, period, modulus, nu) = (40, 4, 1.0, 1.0, 0.49);
    let thickness = rows as f64 * period / columns as f64;
    let mesh =
        Mesh { columns, period, row_heights: vec![thickness / rows as f64; rows], skew: 0.0 };
    let mut block = block(&Rubber::elastic(modulus, nu), Rheology::NeoHookean, mesh.clone());
    let count = block.row_len() * (rows + 1);
    block.deform(&vec![0.0; count]).unwrap();
    // Three entries hold the strip as a rigid body; the load is in equilibrium without them.
    let held = [0, 1, 2 * (columns / 2) + 1];
    let free: Vec<usize> = (0..count).filter(|entry| !held.contains(entry)).collect();
    let q = TAU / period;
    let load = |entry: usize| {
        let below = entry < block.row_len() && entry % 2 == 1;
        if below { mesh.spacing() * (q * (entry / 2) as f64 * mesh.spacing()).sin() } else { 0.0 }
    };
    let right = DVector::from_iterator(free.len(), free.iter().map(|entry| load(*entry)));
    let solution = dense_tangent(&block, count, &free).lu().solve(&right).unwrap();
    let at = |entry: usize| solution[free.iter().position(|free| *free == entry).unwrap()];
    let deflection = at(2 * (columns / 4) + 1);
    let bending = 12.0 * (1.0 - nu * nu) / (modulus * thickness.powi(3) * q.powi(4));
    let shear = 1.2 * 2.0 * (1.0 + nu) / (modulus * thickness * q * q);
    let ratio = deflection / (bending + shear);
    // Four bilinear elements over the thickness are a few percent too stiff.
    assert!((0.9..1.05).contains(&ratio), "{ratio}");
}

#[test]
fn unknowns_leave_out_the_x_displacements_of_the_upper_edge() {
    let unknowns = Unknowns { columns: 3, rows: 2 };
    assert_eq!((unknowns.own(), unknowns.count()), (15, 16));
    let values: Vec<f64> = (0..16).map(f64::from).collect();
    let nodes = unknowns.expand(&values);
    assert_eq!(nodes[12..], [15.0, 12.0, 15.0, 13.0, 15.0, 14.0]);
    for (entry, value) in nodes.iter().enumerate() {
        assert_eq!(unknowns.of(entry).map_or(15.0, |of| of as f64), *value);
    }
    assert_eq!(unknowns.mean_contact_displacement(&nodes), 2.0);
}
