//! Numbers at the points of an element side by side.
//!
//! The four Gauss points of an element have the same law and pass the same steps, so the tangent
//! treats them as the four lanes of a vector register. The centre has a law of its own and is alone.

use super::super::mesh::{Element, PLACES};
use crate::rubber::finite_strain::Scalar;
use wide::f64x4;

/// One number, or several side by side.
pub(super) trait Lanes: Scalar + Default {
    const COUNT: usize;

    /// The same number in all lanes.
    fn splat(value: f64) -> Self;

    fn lane(&self, at: usize) -> f64;

    fn set_lane(&mut self, at: usize, value: f64);

    fn sum(self) -> f64;

    fn from_lanes(value: impl Fn(usize) -> f64) -> Self {
        let mut lanes = Self::default();
        (0..Self::COUNT).for_each(|at| lanes.set_lane(at, value(at)));
        lanes
    }
}

impl Lanes for f64 {
    const COUNT: usize = 1;

    #[inline]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline]
    fn lane(&self, _: usize) -> f64 {
        *self
    }

    #[inline]
    fn set_lane(&mut self, _: usize, value: f64) {
        *self = value;
    }

    #[inline]
    fn sum(self) -> f64 {
        self
    }
}

impl Lanes for f64x4 {
    const COUNT: usize = 4;

    #[inline]
    fn splat(value: f64) -> Self {
        Self::from(value)
    }

    #[inline]
    fn lane(&self, at: usize) -> f64 {
        self.as_array_ref()[at]
    }

    #[inline]
    fn set_lane(&mut self, at: usize, value: f64) {
        self.as_array_mut()[at] = value;
    }

    #[inline]
    fn sum(self) -> f64 {
        let [a, b, c, d] = self.to_array();
        (a + b) + (c + d)
    }
}

#[inline]
pub(super) fn lane<T: Lanes, const N: usize>(values: &[T; N], at: usize) -> [f64; N] {
    values.map(|value| value.lane(at))
}

#[inline]
pub(super) fn set_lane<T: Lanes, const N: usize>(to: &mut [T; N], at: usize, values: &[f64; N]) {
    to.iter_mut().zip(values).for_each(|(to, value)| to.set_lane(at, *value));
}

/// What is the same in all elements of a row: how points lie in them and are integrated.
pub(super) struct Rule<T> {
    /// `1 - a` and `a` of a point `(a, b)` of the unit square: weights of the left and the right nodes.
    pub x: [T; 2],
    /// `1 - b` and `b`: weights of the lower and the upper nodes.
    pub z: [T; 2],
    /// Gradient (1/m) of the shape function of each node.
    pub gradients: [[T; 2]; 4],
    /// In m².
    pub weight: T,
}

impl<T: Lanes> Rule<T> {
    /// Of the points from kind `first` on, as many as there are lanes.
    pub fn new(element: &Element, first: usize) -> Self {
        let a = |at: usize| PLACES[first + at].0;
        let b = |at: usize| PLACES[first + at].1;
        let gradient =
            |node: usize, i: usize| T::from_lanes(|at| element.gradients[first + at][node][i]);
        Self {
            x: [T::from_lanes(|at| 1.0 - a(at)), T::from_lanes(a)],
            z: [T::from_lanes(|at| 1.0 - b(at)), T::from_lanes(b)],
            gradients: [0, 1, 2, 3].map(|node| [gradient(node, 0), gradient(node, 1)]),
            weight: T::from_lanes(|at| element.weights[first + at]),
        }
    }
}
