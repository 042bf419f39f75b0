//! Contact area with the edges read between grid points.
//!
//! The two or three pressures next to a contact edge have discretisation errors of order one, so their shape does not
//! locate the edge. An exact statement does: next to an edge the discrete problem is one of a half-line, and its
//! solutions for smooth heights are, with `z` the shift by one grid point away from the edge (Wiener-Hopf),
//!
//! ```text
//! Σ_j t_j z^j = (c_0 / (1-z) + c_1 / (1-z)² + ...) / A_+(z),    A(z) = A_+(z) A_-(1/z)
//! ```
//!
//! where `A` is the operator's symbol, `C(θ) = 2 / (|q| E_r(q v))` with `θ = q h`. The pressures
//! filtered by the coefficients of `A_+` are therefore values of a polynomial, and where it
//! vanishes a pressure of the continuous problem begins, up to a fixed offset: the one by which
//! `A_+` and the factor of the continuous symbol differ for long waves. The exponents with which
//! the pressure grows (a half for an elastic body, others for a lossy one, different at the
//! leading and the trailing edge) never appear.
//!
//! The integrals run over waves that the grid does not hold. There a measured rubber has the modulus at the nearer end
//! of its measurement: this moves the offset by some hundredths of a grid step, and no pressure.

use super::half_space::compliance;
use crate::rubber::Viscoelastic;
use std::f64::consts::PI;

/// Pressures next to an edge that are read: their polynomial is a cubic.
const MOST_PRESSURES: usize = 4;
/// Abscissae of the integrals over the symbol; they are then exact to 1e-9 of a grid step.
const ABSCISSAE: usize = 1024;

/// Reads contact edges on one grid for one rubber and speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EdgeReader {
    /// First coefficients of `A_+` where the contact lies on the side of growing `x`.
    towards_growing: [f64; MOST_PRESSURES],
    /// The same where it lies on the side of falling `x`.
    towards_falling: [f64; MOST_PRESSURES],
    /// Steps from the zero of the polynomial to the edge, away from the contact.
    offset: f64,
}

impl EdgeReader {
    /// Reader for a sliding `speed` in m/s and a grid `spacing` in m.
    pub fn new(rubber: &dyn Viscoelastic, speed: f64, spacing: f64) -> Self {
        let symbol = |angle: f64| compliance(rubber, speed, angle / spacing, angle / PI);
        let unit = symbol(PI).norm();
        let mut even = [0.0; MOST_PRESSURES];
        let mut odd = [0.0; MOST_PRESSURES];
        let mut offset = 0.0;
        for i in 0..ABSCISSAE {
            let (s, weight) = abscissa(i);
            let angle = PI * s;
            let c = symbol(angle) / unit;
            let (log_modulus, phase) = (c.norm().ln(), c.arg());
            for n in 1..MOST_PRESSURES {
                let (sine, cosine) = (n as f64 * angle).sin_cos();
                even[n] += weight * log_modulus * cosine;
                odd[n] += weight * phase * sine;
            }
            // Slopes at the longest wave of the logarithms of the two factors, grid less
            // continuum; the waves that the grid does not hold are those beyond the angle π.
            let lattice = 0.25 / (0.5 * angle).sin().powi(2) - angle.powi(-2);
            let beyond = compliance(rubber, speed, PI / s / spacing, 0.0).norm() / unit;
            offset += weight * (beyond.ln() / (PI * PI) - log_modulus * lattice);
        }
        let coefficients = |sign: f64| {
            let logarithm: Vec<f64> = even.iter().zip(&odd).map(|(e, o)| e + sign * o).collect();
            exponential(&logarithm)
        };
        Self { towards_growing: coefficients(-1.0), towards_falling: coefficients(1.0), offset }
    }

    /// Contact area fraction: the measure of the set where the pressure is positive.
    ///
    /// It changes continuously as points come into contact; counting points would make it jump.
    /// `displacement` and `separation` are read around patches of one point only.
    pub fn contact_area_fraction(
        &self,
        pressure: &[f64],
        displacement: &[f64],
        separation: &[f64],
    ) -> f64 {
        let n = pressure.len();
        let in_contact = |i: usize| pressure[i % n] > 0.0;
        let mut steps = 0.0;
        for i in 0..n {
            if in_contact(i) && !in_contact(i + 1) && !in_contact(i + n - 1) {
                steps += self.width_of_single_point(i, displacement, separation);
                continue;
            }
            if in_contact(i + 1) && !in_contact(i) && !in_contact(i + 2) {
                continue;
            }
            match (in_contact(i), in_contact(i + 1)) {
                (true, true) => steps += 1.0,
                (true, false) => steps += self.overhang_after(pressure, i),
                (false, true) => steps += self.overhang_before(pressure, (i + 1) % n),
                (false, false) => {}
            }
        }
        steps / n as f64
    }

    /// Distance in grid steps from `first`, the first contact point of a patch, back to its
    /// edge.
    pub fn overhang_before(&self, pressure: &[f64], first: usize) -> f64 {
        let n = pressure.len();
        self.overhang(|j| pressure[(first + j) % n], &self.towards_growing)
    }

    /// Distance in grid steps from `last`, the last contact point of a patch, on to its edge.
    pub fn overhang_after(&self, pressure: &[f64], last: usize) -> f64 {
        let n = pressure.len();
        // The grid has more points than are ever read.
        self.overhang(|j| pressure[(last + n - j) % n], &self.towards_falling)
    }

    /// Distance in grid steps from the contact point `pressure(0)` out to its edge, for the pressures from there into the
    /// contact, which lies on the side of growing `x` or of falling `x`.
    pub fn overhang_into(&self, pressure: impl Fn(usize) -> f64, growing: bool) -> f64 {
        self.overhang(pressure, if growing { &self.towards_growing } else { &self.towards_falling })
    }

    /// Overhang for the pressures from the edge on. Of a small patch no more than half of the
    /// points are read, since beyond its middle they belong to the other edge.
    fn overhang(&self, pressure: impl Fn(usize) -> f64, filter: &[f64; MOST_PRESSURES]) -> f64 {
        let length = (0..2 * MOST_PRESSURES - 1).take_while(|j| pressure(*j) > 0.0).count();
        let read = length.div_ceil(2).max(length.min(2));
        let mut filtered = [0.0; MOST_PRESSURES];
        for (j, filtered) in filtered[..read].iter_mut().enumerate() {
            *filtered = (0..=j).map(|k| filter[k] * pressure(j - k)).sum();
        }
        self.offset + zero_before(&filtered[..read])
    }

    /// Width in grid steps of a patch of one point: that of two points of which one just
    /// touches, reduced like the contact of a parabola by the root of the indentation.
    pub fn width_of_single_point(&self, i: usize, displacement: &[f64], separation: &[f64]) -> f64 {
        let n = displacement.len();
        let width = |neighbour: usize, filter: &[f64; MOST_PRESSURES]| {
            let fall = displacement[i] - displacement[neighbour];
            let drop = fall + separation[neighbour] - separation[i];
            let indentation = if fall > 0.0 && drop > 0.0 { (fall / drop).min(1.0) } else { 0.0 };
            let touching = 1.0 + 2.0 * self.offset + zero_before(&[1.0, filter[1]]);
            touching * indentation.sqrt()
        };
        let before = width((i + n - 1) % n, &self.towards_falling);
        let after = width((i + 1) % n, &self.towards_growing);
        before.max(after)
    }
}

/// Abscissa in `(0, 1)` and weight of a midpoint rule that is refined towards both ends, where
/// the integrands have logarithms.
fn abscissa(i: usize) -> (f64, f64) {
    let s = (i as f64 + 0.5) / ABSCISSAE as f64;
    let (sine, cosine) = (2.0 * PI * s).sin_cos();
    (s - sine / (2.0 * PI), (1.0 - cosine) / ABSCISSAE as f64)
}

/// First coefficients of the exponential of a power series without constant term.
fn exponential(series: &[f64]) -> [f64; MOST_PRESSURES] {
    let mut result = [0.0; MOST_PRESSURES];
    result[0] = 1.0;
    for n in 1..MOST_PRESSURES {
        result[n] = (1..=n).map(|k| k as f64 * series[k] * result[n - k]).sum::<f64>() / n as f64;
    }
    result
}

/// Distance before the abscissa 0, at most 1, at which the polynomial through `values` at 0, 1, ... vanishes; the first
/// value is positive.
///
/// The next point outwards is open, so the zero is not further away.
fn zero_before(values: &[f64]) -> f64 {
    // Newton's backward differences: value at -s is Σ_k (-1)^k Δ^k (s)(s+1)...(s+k-1)/k!.
    let mut differences = [0.0; MOST_PRESSURES];
    differences[..values.len()].copy_from_slice(values);
    for order in 1..values.len() {
        for k in (order..values.len()).rev() {
            differences[k] -= differences[k - 1];
        }
    }
    let value = |s: f64| {
        let mut sum = 0.0;
        for k in (0..values.len()).rev() {
            sum = if k == 0 {
                differences[0] + sum
            } else {
                (differences[k] + sum) * -(s + k as f64 - 1.0) / k as f64
            };
        }
        sum
    };
    if value(1.0) >= 0.0 {
        return 1.0;
    }
    let (mut inside, mut outside) = (0.0, 1.0);
    while outside - inside > 1e-14 {
        let middle = 0.5 * (inside + outside);
        if value(middle) > 0.0 { inside = middle } else { outside = middle }
    }
    0.5 * (inside + outside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;

    /// Offset for an elastic body: `1/π (∫_0^π ln θ (1/(4 sin²(θ/2)) - 1/θ²) dθ - (1 + ln π)/π)`,
    /// by adaptive quadrature.
    const ELASTIC_OFFSET: f64 = -0.190_009_285_93;

    fn elastic() -> EdgeReader {
        EdgeReader::new(&Rubber::elastic(3e6, 0.5), 1.0, 1e-6)
    }

    fn area(pressure: &[f64]) -> f64 {
        elastic().contact_area_fraction(
            pressure,
            &vec![0.0; pressure.len()],
            &vec![0.0; pressure.len()],
        )
    }

    #[test]
    fn the_offset_of_an_elastic_body_is_a_universal_number() {
        approx::assert_abs_diff_eq!(elastic().offset, ELASTIC_OFFSET, epsilon = 1e-8);
    }

    #[test]
    fn both_edges_of_an_elastic_contact_read_alike() {
        let reader = elastic();
        assert_eq!(reader.towards_growing, reader.towards_falling);
    }

    #[test]
    fn pressures_that_the_filter_makes_linear_begin_at_the_zero_of_the_line() {
        let reader = elastic();
        for beyond in [0.0, 0.4, 0.99] {
            let mut pressure = [0.0; 64];
            for j in 0..8 {
                let known: f64 = (1..=j.min(MOST_PRESSURES - 1))
                    .map(|k| reader.towards_growing[k] * pressure[20 + j - k])
                    .sum();
                pressure[20 + j] = beyond + 1e-9 + j as f64 - known;
            }
            let overhang = reader.overhang_before(&pressure, 20);
            approx::assert_abs_diff_eq!(overhang, beyond + reader.offset, epsilon = 2e-9);
        }
    }

    #[test]
    fn full_contact_no_contact_and_tiny_patches() {
        assert_eq!(area(&[1.0; 8]), 1.0);
        assert_eq!(area(&[0.0; 8]), 0.0);
        // Two points read as more than one step, three as more than two.
        for points in 2..5 {
            let mut pressure = [0.0; 16];
            pressure[3..3 + points].fill(1.0);
            let steps = 16.0 * area(&pressure);
            assert!(steps > points as f64 - 1.0 && steps < points as f64 + 1.0, "{points} {steps}");
        }
    }

    #[test]
    fn a_patch_may_lie_across_the_end_of_the_grid() {
        let patch = [1.0, 2.0, 2.5, 2.2, 1.3];
        let at = |start: usize| {
            let mut pressure = [0.0; 16];
            patch.iter().enumerate().for_each(|(j, t)| pressure[(start + j) % 16] = *t);
            area(&pressure)
        };
        for start in 1..16 {
            approx::assert_relative_eq!(at(start), at(0), max_relative = 1e-14);
        }
    }
}
