//! The steady block against exact results.

use super::block::Block;
use super::filter::Filter;
use super::mesh::{Grading, Mesh};
use super::row::Material;
use super::unknowns::Unknowns;
use crate::rubber::finite_strain::{Measure, Spring, Symmetric};
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

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

/// A smooth periodic deformation and its gradient.
struct Manufactured {
    period: f64,
    height: f64,
}

impl Manufactured {
    fn displacement(&self, x: f64, z: f64) -> [f64; 2] {
        let (a, b) = (TAU * x / self.period, PI * z / self.height);
        let size = 0.01 * self.period;
        [
            size * (a.sin() * b.cos() + 2.0 * z / self.height),
            size * (a + 0.4).cos() * (0.5 * b).cos(),
        ]
    }

    fn deformation(&self, x: f64, z: f64) -> [f64; 4] {
        let (a, b) = (TAU * x / self.period, PI * z / self.height);
        let size = 0.01 * self.period;
        let (q, k) = (TAU / self.period, PI / self.height);
        [
            1.0 + size * q * a.cos() * b.cos(),
            size * (-k * a.sin() * b.sin() + 2.0 / self.height),
            -size * q * (a + 0.4).sin() * (0.5 * b).cos(),
            1.0 - size * 0.5 * k * (a + 0.4).cos() * (0.5 * b).sin(),
        ]
    }

    /// First Piola-Kirchhoff stress at equidistant points of a row from `x` on: the internal
    /// tensors by the transfer function `1 / (1 + i q v τ)`, exact for the few waves of `C` and to
    /// 1e-5 for those of `ln C` at strains of a few percent.
    fn stress(&self, rubber: &FiniteStrainRubber, x: f64, z: f64, points: usize) -> Vec<[f64; 4]> {
        let place = |i: usize| x + i as f64 * self.period / points as f64;
        let deformations: Vec<[f64; 4]> =
            (0..points).map(|i| self.deformation(place(i), z)).collect();
        let measures: Vec<Measure> = deformations
            .iter()
            .map(|f| {
                let strain = [
                    f[0] * f[0] + f[2] * f[2] - 1.0,
                    f[1] * f[1] + f[3] * f[3] - 1.0,
                    f[0] * f[1] + f[2] * f[3],
                ];
                rubber.rheology.measure(&strain).unwrap()
            })
            .collect();
        let strains: Vec<Symmetric> = measures.iter().map(Measure::value).collect();
        let mut stresses: Vec<Symmetric> =
            measures.iter().map(|m| total(rubber, &rubber.equilibrium, m, &[0.0; 3])).collect();
        for spring in &rubber.branches {
            let internal = self.relaxed(&strains, SPEED * spring.relaxation_time);
            for ((stress, measure), m_i) in stresses.iter_mut().zip(&measures).zip(&internal) {
                let part = total(rubber, spring, measure, m_i);
                (0..3).for_each(|i| stress[i] += part[i]);
            }
        }
        deformations
            .iter()
            .zip(&stresses)
            .map(|(f, s)| {
                [
                    f[0] * s[0] + f[1] * s[2],
                    f[0] * s[2] + f[1] * s[1],
                    f[2] * s[0] + f[3] * s[2],
                    f[2] * s[2] + f[3] * s[1],
                ]
            })
            .collect()
    }

    fn relaxed(&self, strains: &[Symmetric], length: f64) -> Vec<Symmetric> {
        let n = strains.len();
        let mut planner = FftPlanner::new();
        let mut internal = strains.to_vec();
        for component in 0..3 {
            let mut field: Vec<Complex64> =
                strains.iter().map(|c| Complex64::new(c[component], 0.0)).collect();
            planner.plan_fft_forward(n).process(&mut field);
            for (k, value) in field.iter_mut().enumerate() {
                let wave = if 2 * k < n { k as f64 } else { k as f64 - n as f64 };
                *value /= Complex64::new(1.0, TAU * wave / self.period * length) * n as f64;
            }
            planner.plan_fft_inverse(n).process(&mut field);
            for (c, value) in internal.iter_mut().zip(&field) {
                c[component] = value.re;
            }
        }
        internal
    }
}

fn total(
    rubber: &FiniteStrainRubber,
    spring: &Spring,
    measure: &Measure,
    internal: &Symmetric,
) -> Symmetric {
    let strain = measure.value();
    let shear = rubber.shear_stress(spring, &strain, internal);
    let volumetric = rubber.volumetric_stress(spring, &strain, internal);
    measure.derivative(&[0, 1, 2].map(|i| shear[i] + volumetric[i]))
}

/// Root mean square error of the nodal displacements of a manufactured solution, over its size:
/// nodal forces from `∫ P : ∇N` of the exact stress by three by three points, outer rows held.
fn manufactured_error(rheology: Rheology, columns: usize) -> f64 {
    let exact = Manufactured { period: 1e-4, height: 7.5e-5 };
    let rows = columns * 3 / 4;
    let mesh = Mesh {
        columns,
        period: exact.period,
        row_heights: vec![exact.height / rows as f64; rows],
        skew: 0.0,
    };
    let mut block = block(&Rubber::table_2_1(), rheology, mesh.clone());
    let count = block.row_len() * (rows + 1);
    let heights = mesh.node_heights();
    let (width, height) = (mesh.spacing(), mesh.row_heights[0]);
    let truth: Vec<f64> = heights
        .iter()
        .flat_map(|z| (0..columns).flat_map(|j| exact.displacement(j as f64 * width, *z)))
        .collect();
    let gauss = [
        (0.5 - 0.15_f64.sqrt(), 5.0 / 18.0),
        (0.5, 4.0 / 9.0),
        (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0),
    ];
    let mut loads = vec![0.0; count];
    let rubber = block.material().rubber.clone();
    for (row, bottom) in heights[..rows].iter().enumerate() {
        for ((a, wa), (b, wb)) in gauss.iter().flat_map(|a| gauss.iter().map(move |b| (a, b))) {
            let stress = exact.stress(&rubber, a * width, bottom + b * height, columns);
            let nodes = [
                (0, 0, 1.0 - a, 1.0 - b),
                (1, 0, *a, 1.0 - b),
                (0, 1, 1.0 - a, *b),
                (1, 1, *a, *b),
            ];
            for (column, p) in stress.iter().enumerate() {
                for (right, up, na, nb) in nodes {
                    let sign = |side: usize| if side == 1 { 1.0 } else { -1.0 };
                    let gradient = [sign(right) * nb / width, sign(up) * na / height];
                    let at = 2 * ((row + up) * columns + (column + right) % columns);
                    let weight = wa * wb * width * height;
                    loads[at] += weight * (p[0] * gradient[0] + p[1] * gradient[1]);
                    loads[at + 1] += weight * (p[2] * gradient[0] + p[3] * gradient[1]);
                }
            }
        }
    }
    let free: Vec<usize> = (block.row_len()..count - block.row_len()).collect();
    let mut displacements = truth.clone();
    for _ in 0..12 {
        let forces = block.deform(&displacements).unwrap();
        let residual =
            DVector::from_iterator(free.len(), free.iter().map(|i| loads[*i] - forces[*i]));
        let change = dense_tangent(&block, count, &free).lu().solve(&residual).unwrap();
        for (entry, change) in free.iter().zip(&change) {
            displacements[*entry] += change;
        }
        if change.amax() < 1e-10 * exact.period {
            let square = |a: &[f64]| a.iter().map(|x| x * x).sum::<f64>();
            let errors: Vec<f64> = displacements.iter().zip(&truth).map(|(u, e)| u - e).collect();
            return (square(&errors) / square(&truth)).sqrt();
        }
    }
    panic!("Newton did not converge on {columns} columns");
}

#[test]
fn a_manufactured_solution_converges_with_second_order() {
    for law in [Rheology::NeoHookean, Rheology::Linear] {
        let errors = [8, 16, 32].map(|columns| manufactured_error(law, columns));
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        assert!((orders[1] - 2.0).abs() < 0.2, "{law:?}: {errors:?}, orders {orders:?}");
    }
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
