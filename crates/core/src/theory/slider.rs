//! The estimate of the friction of a slider from the dissipation under a pressure of known shape.

use crate::rubber::Viscoelastic;
use crate::surface::Slider;
use std::f64::consts::PI;

/// Friction of a hard slider on a lubricated rubber from the dissipation under the pressure of the elastic contact
/// (for rolling: Persson, Eur. Phys. J. E 33, 327, 2010, doi:10.1140/epje/i2010-10678-y), in plane strain:
///
/// ```text
/// μ = 2 F / (π a) ∫_0^∞ Im(-1 / E_r(ξ v / a)) P(ξ)² dξ        F: force per length, ξ = q a
/// cylinder    P = 2 J_1(ξ) / ξ                a² = 4 F R / (π |E_r(v / a)|)
/// triangle    P = 1/ξ ∫_0^ξ J_0(t) dt         a = F / (m |E_r(v / a)|)
/// ```
///
/// `P` is the transform of the pressure of an elastic half-space, so the estimate has neither the shift of the contact
/// nor its narrowing at the trailing edge. The half-width `a` is that of an elastic solid with the modulus at the
/// frequency `v / a`, a choice of this implementation.
pub struct SliderTheory<'a> {
    rubber: &'a dyn Viscoelastic,
    shape: Shape,
    /// Nodes ξ and `P² dξ`.
    nodes: Vec<[f64; 2]>,
}

#[derive(Clone, Copy)]
enum Shape {
    Cylinder { radius: f64 },
    Triangle { slope: f64 },
}

/// What [`SliderTheory`] estimates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliderEstimate {
    /// Half of the width of the contact in m.
    pub half_width: f64,
    /// Friction coefficient.
    pub friction_coefficient: f64,
}

/// Nodes in a decade where the pressure is that of a line force or oscillates too fast to be seen.
const PER_DECADE: i32 = 40;
/// Decades of ξ on both sides of the oscillations.
const DECADES: i32 = 12;
/// From here to [`LAST`] the oscillations of `P` are followed.
const FIRST: f64 = 0.1;
/// Beyond, their mean is off by less than 1 in 1000 of what is left.
const LAST: f64 = 100.0;
/// Steps from [`FIRST`] to [`LAST`], 300 in a turn.
const STEPS: i32 = 5000;

impl<'a> SliderTheory<'a> {
    /// The theory of a slider; `None` for a triangle with a rounded tip, which has no estimate here.
    pub fn new(rubber: &'a dyn Viscoelastic, slider: Slider) -> Option<Self> {
        let shape = match slider {
            Slider::Cylinder { radius } => Shape::Cylinder { radius },
            Slider::Triangle { slope, tip_radius: 0.0 } => Shape::Triangle { slope },
            Slider::Triangle { .. } => return None,
        };
        Some(Self { rubber, shape, nodes: nodes(shape) })
    }

    /// Half-width and friction under the force per length in N/m at the speed in m/s; both positive.
    pub fn estimate(&self, force: f64, speed: f64) -> SliderEstimate {
        let a = self.half_width(force, speed);
        let sum = self.nodes.iter().map(|[xi, weight]| {
            let modulus = self.rubber.reduced_modulus(xi * speed / a);
            weight * modulus.im / modulus.norm_sqr()
        });
        let friction_coefficient = 2.0 * force / (PI * a) * sum.sum::<f64>();
        SliderEstimate { half_width: a, friction_coefficient }
    }

    /// By bisection: with a growing width the elastic contact carries more, though its modulus falls.
    fn half_width(&self, force: f64, speed: f64) -> f64 {
        let with = |modulus: f64| match self.shape {
            Shape::Cylinder { radius } => (4.0 * force * radius / (PI * modulus)).sqrt(),
            Shape::Triangle { slope } => force / (slope * modulus),
        };
        let modulus = |frequency: f64| self.rubber.reduced_modulus(frequency).norm();
        let (mut narrow, mut wide) = (with(modulus(f64::MAX)), with(modulus(0.0)));
        loop {
            let middle = (narrow * wide).sqrt();
            if middle <= narrow || middle >= wide {
                return middle;
            }
            if with(modulus(speed / middle)) > middle {
                narrow = middle;
            } else {
                wide = middle;
            }
        }
    }
}

/// Rules on three stretches of ξ: P = 1, the oscillations, their mean.
fn nodes(shape: Shape) -> Vec<[f64; 2]> {
    let mut nodes = logarithmic(-DECADES, FIRST, |xi| transform(shape, xi).powi(2));
    let step = (LAST - FIRST) / f64::from(STEPS);
    for k in 0..=STEPS {
        let xi = FIRST + f64::from(k) * step;
        nodes.push([xi, simpson(k, STEPS) * step * transform(shape, xi).powi(2)]);
    }
    nodes.extend(logarithmic(DECADES, LAST, |xi| mean_square(shape, xi)));
    nodes
}

/// Weight of Simpson's rule at the step `k` of an even number of them.
fn simpson(k: i32, steps: i32) -> f64 {
    match k {
        _ if k == 0 || k == steps => 1.0 / 3.0,
        _ if k % 2 == 1 => 4.0 / 3.0,
        _ => 2.0 / 3.0,
    }
}

/// Simpson's rule over the logarithm of ξ, by so many decades from `end`.
fn logarithmic(decades: i32, end: f64, square: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let steps = decades.abs() * PER_DECADE;
    let step = 10_f64.ln() / f64::from(PER_DECADE);
    let node = |k: i32| {
        let xi = end * (f64::from(decades.signum() * k) * step).exp();
        [xi, simpson(k, steps) * step * xi * square(xi)]
    };
    (0..=steps).map(node).collect()
}

/// `P(ξ)` with the integrals of the Bessel functions over an angle, to which the rule of rectangles converges faster than
/// any power once it has more points than ξ.
fn transform(shape: Shape, xi: f64) -> f64 {
    let points = 160;
    let angle = |k: i32| PI * (f64::from(k) + 0.5) / f64::from(points);
    let mean = |value: &dyn Fn(f64) -> f64| {
        (0..points).map(angle).map(value).sum::<f64>() / f64::from(points)
    };
    match shape {
        // J_1 = mean of sin θ sin(ξ sin θ).
        Shape::Cylinder { .. } => 2.0 / xi * mean(&|t| t.sin() * (xi * t.sin()).sin()),
        // ∫ J_0 = mean of sin(ξ sin θ) / sin θ.
        Shape::Triangle { .. } => mean(&|t| (xi * t.sin()).sin() / t.sin()) / xi,
    }
}

/// Mean of `P²` over an oscillation, for large ξ.
fn mean_square(shape: Shape, xi: f64) -> f64 {
    match shape {
        Shape::Cylinder { .. } => 4.0 / (PI * xi.powi(3)),
        Shape::Triangle { .. } => (1.0 + 1.0 / (PI * xi)) / (xi * xi),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::SlidingCylinder;
    use crate::rubber::{MaxwellBranch, Rubber};

    /// One relaxation time of 1 ms, reduced moduli of 4 and `4 ratio` MPa.
    fn solid(ratio: f64) -> Rubber {
        let branch = MaxwellBranch { modulus: 3e6 * (ratio - 1.0), relaxation_time: 1e-3 };
        Rubber { branches: vec![branch], ..Rubber::elastic(3e6, 0.5) }
    }

    const CYLINDER: Slider = Slider::Cylinder { radius: 0.01 };
    const TRIANGLE: Slider = Slider::Triangle { slope: 0.2, tip_radius: 0.0 };

    /// Parseval: `∫ P² dξ = π ∫ p² dx` of the pressure of unit force on the half-width 1, from ξ = 0 and over all x.
    #[test]
    fn the_square_of_the_transform_has_the_integral_of_the_square_of_the_pressure() {
        let sum = |shape: Shape| nodes(shape).iter().map(|node| node[1]).sum::<f64>();
        let cylinder = sum(Shape::Cylinder { radius: 1.0 });
        approx::assert_relative_eq!(cylinder, 16.0 / (3.0 * PI), max_relative = 1e-5);
        // p = arcosh(1/x) / π, and its integral with x = 1 / cosh t.
        let square = |t: f64| t * t * t.sinh() / t.cosh().powi(2);
        let n = 60_000;
        let step = 60.0 / f64::from(n);
        let integral: f64 = (1..n).map(|k| square(f64::from(k) * step) * step).sum();
        let expected = PI * 2.0 * integral / (PI * PI);
        let triangle = sum(Shape::Triangle { slope: 1.0 });
        approx::assert_relative_eq!(triangle, expected, max_relative = 1e-4);
    }

    /// Where little is lost the pressure is that of the elastic solid and the estimate is exact.
    #[test]
    fn the_estimate_of_a_cylinder_is_exact_where_the_rubber_loses_little() {
        let exact = SlidingCylinder {
            radius: 0.01,
            relaxed_modulus: 4e6,
            glassy_modulus: 4e6 * 1.002,
            relaxation_time: 1e-3,
        };
        let rubber = solid(1.002);
        let theory = SliderTheory::new(&rubber, CYLINDER).unwrap();
        for speed in [0.1, 1.0, 10.0] {
            let (found, expected) = (theory.estimate(300.0, speed), exact.under(speed, 300.0));
            // The relative step of the modulus is 2e-3.
            approx::assert_relative_eq!(
                found.friction_coefficient,
                expected.friction_coefficient,
                max_relative = 4e-3
            );
            approx::assert_relative_eq!(found.half_width, expected.half_width, max_relative = 1e-3);
        }
    }

    /// No length of a sharp triangle: the force moves the curve over the speed and leaves its height.
    #[test]
    fn the_peak_of_a_triangle_does_not_depend_on_the_force() {
        let rubber = solid(10.0);
        let theory = SliderTheory::new(&rubber, TRIANGLE).unwrap();
        let (one, seven) = (theory.estimate(100.0, 0.3), theory.estimate(700.0, 2.1));
        approx::assert_relative_eq!(
            seven.friction_coefficient,
            one.friction_coefficient,
            max_relative = 1e-12
        );
        let rounded = Slider::Triangle { slope: 0.2, tip_radius: 1e-6 };
        assert!(SliderTheory::new(&rubber, rounded).is_none());
    }
}
