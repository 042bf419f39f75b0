//! The operator of the areal half-space, or layer, in Fourier space.

use super::super::half_space::compliance;
use super::layer;
use crate::numerics::plane::Transform;
use crate::rubber::Viscoelastic;
use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Sliding in the plane of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Speed of the rubber in m/s; zero for an elastic contact with the relaxed modulus.
    pub speed: f64,
    /// Angle of the velocity from `x` towards `y` in rad.
    pub angle: f64,
}

impl Sliding {
    /// Velocity along `x` and `y` in m/s. It is exactly along the grid where the angle is a multiple of a right one.
    pub(super) fn velocity(self) -> [f64; 2] {
        self.direction().map(|component| component * self.speed)
    }

    /// Unit vector of the velocity.
    pub(super) fn direction(self) -> [f64; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        // A quarter turn in double precision leaves 6e-17, which is not meant.
        let clean = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
        [clean(cosine), clean(sine)]
    }
}

/// Body and motion that make an operator on grids of one period.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    pub rubber: &'a dyn Viscoelastic,
    pub sliding: Sliding,
    pub periods: [f64; 2],
    pub thickness: Option<f64>,
}

impl Body<'_> {
    /// Complex compliance in m/Pa of the wave `k` of a grid, not that of the mean.
    ///
    /// As on the line the phase is tapered towards the highest waves of the grid, here along both directions, since those
    /// have no direction of motion; they have the mean modulus of both.
    fn compliance(&self, k: [i64; 2], points: [usize; 2]) -> Complex64 {
        let relative = [0, 1].map(|a| 2.0 * k[a].unsigned_abs() as f64 / points[a] as f64);
        let [qx, qy] = [0, 1].map(|a| TAU * k[a] as f64 / self.periods[a]);
        let wavenumber = qx.hypot(qy);
        let [vx, vy] = self.sliding.velocity();
        let body = self.thickness.map_or(1.0, |h| {
            layer::relative_compliance(wavenumber * h, self.rubber.poisson_ratio())
        });
        let of_frequency = |frequency: f64| {
            // The line's function for a wave that excites this frequency.
            compliance(self.rubber, frequency / wavenumber, wavenumber, 0.0)
        };
        if relative.contains(&1.0) {
            let both =
                of_frequency(qx * vx + qy * vy).norm() + of_frequency(qx * vx - qy * vy).norm();
            return Complex64::new(0.5 * body * both, 0.0);
        }
        let (modulus, phase) = of_frequency(qx * vx + qy * vy).to_polar();
        let taper = |r: f64| (FRAC_PI_2 * r.powi(2)).cos().powi(2);
        Complex64::from_polar(body * modulus, phase * taper(relative[0]) * taper(relative[1]))
    }

    /// Mean compression per mean pressure, in m/Pa; zero for a half-space, whose is not defined.
    pub fn mean_compliance(&self) -> f64 {
        let (nu, modulus) = (self.rubber.poisson_ratio(), self.rubber.reduced_modulus(0.0).re);
        self.thickness.map_or(0.0, |h| layer::mean_compliance(h, nu, modulus))
    }
}

/// Reduced moduli in Pa that the operator of a half-space has for the waves of a grid, with the tapered phase: those with `k_x` from 0
/// to `nx / 2`, in this order the `ny` waves along `y` of each; zero for the mean.
pub fn wave_moduli(
    rubber: &dyn Viscoelastic,
    sliding: Sliding,
    periods: [f64; 2],
    points: [usize; 2],
) -> Vec<Complex64> {
    let body = Body { rubber, sliding, periods, thickness: None };
    let modulus = |bin: usize, row: usize| {
        if bin + row == 0 {
            return Complex64::ZERO;
        }
        let k = [bin as i64, signed(row, points[1])];
        let [qx, qy] = [0, 1].map(|a| TAU * k[a] as f64 / periods[a]);
        2.0 / (qx.hypot(qy) * body.compliance(k, points))
    };
    (0..=points[0] / 2).flat_map(|bin| (0..points[1]).map(move |row| modulus(bin, row))).collect()
}

/// Surface displacement under a pressure that is steady in the frame of the surface:
/// `w_hat(q) = 2 F(|q| h) / (|q| E_r(q · v)) t_hat(q)` for `q != 0`, `w_hat(0) = 0`.
pub(super) struct ArealHalfSpace {
    points: [usize; 2],
    periods: [f64; 2],
    direction: [f64; 2],
    /// Compliances in m/Pa, ordered like the spectrum.
    symbol: Vec<Complex64>,
    /// Stiffness in Pa/m that stands for that of the mean where a set of points is filtered.
    mean_stiffness: f64,
    transform: Transform,
    /// Displacement by a unit pressure at point 0, once it was asked for.
    kernel: Option<Vec<f64>>,
}

/// Displacements in m/Pa by unit pressures.
#[derive(Clone, Copy)]
pub(super) struct Kernel<'a> {
    points: [usize; 2],
    values: &'a [f64],
}

impl Kernel<'_> {
    /// Displacement of the point under the pressure.
    pub fn at_origin(self) -> f64 {
        self.values[0]
    }

    /// Displacement of the point `i` by a pressure at the point `j`.
    pub fn between(self, i: u32, j: u32) -> f64 {
        let [nx, ny] = self.points;
        let (i, j) = (i as usize, j as usize);
        let across = (i % nx + nx - j % nx) % nx;
        let along = (i / nx + ny - j / nx) % ny;
        self.values[along * nx + across]
    }
}

/// Direction of an application of the operator.
#[derive(Clone, Copy)]
enum Direction {
    PressureToDisplacement,
    DisplacementToPressure,
}

impl ArealHalfSpace {
    pub fn new(body: Body, points: [usize; 2]) -> Self {
        let transform = Transform::new(points);
        let ny = points[1];
        let mut symbol = vec![Complex64::ZERO; transform.bins() * ny];
        // The trait promises no thread safety; a set-up costs as much as a few transforms.
        for (bin, column) in symbol.chunks_exact_mut(ny).enumerate() {
            for (row, c) in column.iter_mut().enumerate() {
                if bin + row > 0 {
                    *c = body.compliance([bin as i64, signed(row, ny)], points);
                }
            }
        }
        let longest = [symbol[1 % symbol.len()], symbol[ny % symbol.len()]];
        let softest = longest.iter().map(|c| c.norm()).fold(0.0, f64::max);
        let (periods, direction) = (body.periods, body.sliding.direction());
        Self {
            points,
            periods,
            direction,
            symbol,
            mean_stiffness: softest.recip(),
            transform,
            kernel: None,
        }
    }

    pub fn points(&self) -> [usize; 2] {
        self.points
    }

    /// Displacements by unit pressures.
    pub fn kernel(&mut self) -> Kernel<'_> {
        if self.kernel.is_none() {
            self.transform.real.fill(0.0);
            self.transform.real[0] = 1.0;
            self.apply(Direction::PressureToDisplacement);
            self.kernel = Some(self.transform.real.clone());
        }
        Kernel { points: self.points, values: self.kernel.as_deref().unwrap_or_default() }
    }

    /// Displacement in m (mean zero) under a pressure in Pa.
    pub fn displacement(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.transform.real.copy_from_slice(pressure);
        self.apply(Direction::PressureToDisplacement);
        displacement.copy_from_slice(&self.transform.real);
    }

    /// Pressure in Pa (mean zero) that makes a displacement in m.
    pub fn pressure(&mut self, displacement: &[f64]) -> Vec<f64> {
        self.transform.real.copy_from_slice(displacement);
        self.apply(Direction::DisplacementToPressure);
        let mean = mean(&self.transform.real);
        self.transform.real.iter().map(|t| t - mean).collect()
    }

    /// [`Self::displacement`] from and to a set of points only.
    pub fn displacement_on(&mut self, set: &[u32], pressure: &[f64], out: &mut [f64]) {
        self.restricted(set, pressure, out, Direction::PressureToDisplacement);
    }

    /// Approximate inverse of [`Self::displacement_on`]: the inverse filter, restricted.
    pub fn pressure_on(&mut self, set: &[u32], displacement: &[f64], out: &mut [f64]) {
        self.restricted(set, displacement, out, Direction::DisplacementToPressure);
    }

    /// Slope of a field along the sliding direction, or across it (to its left), by trigonometric interpolation.
    pub fn slope(&mut self, field: &[f64], across: bool) -> Vec<f64> {
        let [ex, ey] = self.direction;
        let [ex, ey] = if across { [-ey, ex] } else { [ex, ey] };
        self.transform.real.copy_from_slice(field);
        let waves = Waves { points: self.points, periods: self.periods };
        let norm = 1.0 / field.len() as f64;
        self.transform.filter(|bin, column| {
            for (row, c) in column.iter_mut().enumerate() {
                let [qx, qy] = waves.with_direction(bin, row);
                *c *= Complex64::new(0.0, (ex * qx + ey * qy) * norm);
            }
        });
        self.transform.real.clone()
    }

    /// Mean hysteretic power per area and speed `Σ_q q_s Im(-C(q)) |t_hat|²` in Pa, from the pressure spectrum alone.
    pub fn hysteretic_traction(&mut self, pressure: &[f64]) -> f64 {
        self.transform.real.copy_from_slice(pressure);
        self.transform.forward();
        let waves = Waves { points: self.points, periods: self.periods };
        let ([ex, ey], ny) = (self.direction, self.points[1]);
        let norm = (pressure.len() as f64).powi(-2);
        let spectrum = self.transform.spectrum.par_chunks(ny);
        let columns: Vec<f64> = spectrum
            .zip(self.symbol.par_chunks(ny))
            .enumerate()
            .map(|(bin, (spectrum, symbol))| {
                // Waves and their conjugates; those with k_x = 0 are all there.
                let both = if bin == 0 { 1.0 } else { 2.0 };
                let wave = |(row, (t, c)): (usize, (&Complex64, &Complex64))| {
                    let [qx, qy] = waves.with_direction(bin, row);
                    -both * (ex * qx + ey * qy) * c.im * t.norm_sqr()
                };
                spectrum.iter().zip(symbol).enumerate().map(wave).sum::<f64>() * norm
            })
            .collect();
        columns.iter().sum()
    }

    fn restricted(&mut self, set: &[u32], input: &[f64], out: &mut [f64], direction: Direction) {
        let real = &mut self.transform.real;
        real.fill(0.0);
        for (i, x) in set.iter().zip(input) {
            real[*i as usize] = *x;
        }
        self.apply(direction);
        for (i, y) in set.iter().zip(out) {
            *y = self.transform.real[*i as usize];
        }
    }

    fn apply(&mut self, direction: Direction) {
        let (symbol, ny) = (&self.symbol, self.points[1]);
        let norm = 1.0 / (self.points[0] * ny) as f64;
        let mean_stiffness = self.mean_stiffness;
        self.transform.filter(|bin, column| {
            let symbol = &symbol[bin * ny..][..ny];
            match direction {
                Direction::PressureToDisplacement => {
                    column.iter_mut().zip(symbol).for_each(|(x, c)| *x *= c * norm);
                }
                Direction::DisplacementToPressure => {
                    let mean = column[0] * mean_stiffness * norm;
                    column
                        .iter_mut()
                        .zip(symbol)
                        .for_each(|(x, c)| *x *= c.conj() * (norm / c.norm_sqr()));
                    if bin == 0 {
                        column[0] = mean;
                    }
                }
            }
        });
    }
}

/// Wavenumbers of a grid.
#[derive(Clone, Copy)]
struct Waves {
    points: [usize; 2],
    periods: [f64; 2],
}

impl Waves {
    /// Wavenumbers in rad/m, zero along a direction in which the wave is the highest of an even grid: it has no slope at
    /// the points.
    fn with_direction(self, bin: usize, row: usize) -> [f64; 2] {
        let k = [bin as i64, signed(row, self.points[1])];
        [0, 1].map(|a| {
            let highest = 2 * k[a].unsigned_abs() as usize == self.points[a];
            if highest { 0.0 } else { TAU * k[a] as f64 / self.periods[a] }
        })
    }
}

/// Wave number of an index of a transform of `n` points.
fn signed(index: usize, n: usize) -> i64 {
    if 2 * index > n { index as i64 - n as i64 } else { index as i64 }
}

/// Mean by a compensated sum (Neumaier 1974, doi:10.1002/zamm.19740540106): a field with few large values keeps its digits,
/// and so does a uniform one.
pub(super) fn mean(values: &[f64]) -> f64 {
    let (mut sum, mut lost) = (0.0_f64, 0.0);
    for x in values {
        let next = sum + x;
        lost += if sum.abs() >= x.abs() { (sum - next) + x } else { (x - next) + sum };
        sum = next;
    }
    (sum + lost) / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;

    #[test]
    fn the_mean_of_few_large_values_among_many_zeros_has_all_digits() {
        // A peak at the first point, with pressures of thirty times the mean on 3 % of the points.
        let count = 1 << 18;
        let value =
            |k: usize| if k.is_multiple_of(29) { 7.1e5 + 1e3 * (k as f64).sin() } else { 0.0 };
        let field: Vec<f64> = (0..count).map(value).collect();
        let known: f64 = field.iter().filter(|x| **x != 0.0).map(|x| x / count as f64).sum();
        approx::assert_relative_eq!(mean(&field), known, max_relative = 1e-13);
        assert_eq!(mean(&vec![0.1; 1000]), 0.1);
    }

    fn body(rubber: &Rubber, thickness: Option<f64>) -> Body<'_> {
        let sliding = Sliding { speed: 0.2, angle: 0.7 };
        Body { rubber, sliding, periods: [1e-3, 0.6e-3], thickness }
    }

    fn field(n: usize, seed: f64) -> Vec<f64> {
        (0..n).map(|i| ((i * i) as f64 * seed).sin()).collect()
    }

    #[test]
    fn pressure_inverts_displacement_on_all_kinds_of_grids() {
        let rubber = Rubber::table_2_1();
        for points in [[16, 12], [15, 8], [8, 15], [13, 11], [2, 6]] {
            for thickness in [None, Some(5e-5)] {
                let mut space = ArealHalfSpace::new(body(&rubber, thickness), points);
                let t = field(points[0] * points[1], 0.7);
                let mean = mean(&t);
                let mut w = vec![0.0; t.len()];
                space.displacement(&t, &mut w);
                for (back, t) in space.pressure(&w).iter().zip(&t) {
                    approx::assert_abs_diff_eq!(*back, t - mean, epsilon = 1e-12);
                }
            }
        }
    }

    #[test]
    fn the_operator_is_positive_definite_and_not_symmetric() {
        let rubber = Rubber::table_2_1();
        let points = [12, 9];
        let mut space = ArealHalfSpace::new(body(&rubber, None), points);
        let mut product = |a: &[f64], b: &[f64]| {
            let mut w = vec![0.0; a.len()];
            space.displacement(b, &mut w);
            a.iter().zip(&w).map(|(a, w)| a * w).sum::<f64>()
        };
        let mut asymmetry = 0.0_f64;
        for seed in 1..40 {
            let a = field(108, 0.31 * f64::from(seed));
            let b = field(108, 0.47 * f64::from(seed));
            let energy = product(&a, &a);
            assert!(energy > 0.0, "{seed}: {energy:e}");
            asymmetry = asymmetry.max((product(&a, &b) - product(&b, &a)).abs() / energy);
        }
        assert!(asymmetry > 0.05, "{asymmetry}");
    }

    #[test]
    fn the_power_of_the_pressure_is_the_work_on_the_slope_of_the_displacement() {
        let rubber = Rubber::table_2_1();
        for points in [[20, 14], [15, 9], [16, 15]] {
            let n = points[0] * points[1];
            let mut space = ArealHalfSpace::new(body(&rubber, None), points);
            let t: Vec<f64> = field(n, 0.11).iter().map(|t| t.max(0.0)).collect();
            let mut w = vec![0.0; n];
            space.displacement(&t, &mut w);
            let slope = space.slope(&w, false);
            let work = t.iter().zip(&slope).map(|(t, s)| t * s).sum::<f64>() / n as f64;
            let power = space.hysteretic_traction(&t);
            assert!(power > 0.0);
            approx::assert_relative_eq!(work, power, max_relative = 1e-12);
        }
    }

    #[test]
    fn the_kernel_gives_the_displacement_by_a_sum() {
        let rubber = Rubber::table_2_1();
        let points = [7, 6];
        let mut space = ArealHalfSpace::new(body(&rubber, None), points);
        let t = field(42, 0.9);
        let mut w = vec![0.0; 42];
        space.displacement(&t, &mut w);
        let kernel = space.kernel();
        for i in 0..42 {
            let sum: f64 = (0..42).map(|j| kernel.between(i, j) * t[j as usize]).sum();
            approx::assert_abs_diff_eq!(sum, w[i as usize], epsilon = 1e-13 * kernel.at_origin());
        }
    }
}
