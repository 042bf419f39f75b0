//! A manufactured solution of the steady block.

use super::{SPEED, block, dense_tangent};
use crate::fem::mesh::Mesh;
use crate::rubber::finite_strain::{Measure, Spring, Symmetric};
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use nalgebra::DVector;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

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
