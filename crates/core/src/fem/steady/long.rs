//! Sums that keep their rounding error.
//!
//! Displacements reach a thousand element widths. Rounded to double precision they leave nodal forces of the
//! glassy modulus unbalanced by `E u ε`, which on 4096 columns is 2e-9 of the mean contact force and grows with
//! the columns. With the rounding error of each sum kept, differences of neighbours have all their digits.

use std::ops::AddAssign;

/// The unevaluated sum of a number and its rounding error (Knuth's two-sum, The Art of Computer
/// Programming 2, section 4.2.2, theorem B).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Long {
    value: f64,
    rest: f64,
}

/// What rows of elements take differences of: displacements, or changes of them.
pub(super) trait Value: Copy + Send + Sync {
    /// The difference to another one.
    fn minus(self, other: Self) -> f64;
    /// The sum with a number.
    fn plus(self, number: f64) -> Self;
}

impl Long {
    /// The sum, rounded.
    pub fn value(self) -> f64 {
        self.value
    }

    /// The rounding error of the sum.
    pub fn rest(self) -> f64 {
        self.rest
    }

    pub fn values(numbers: &[Self]) -> Vec<f64> {
        numbers.iter().map(|number| number.value).collect()
    }
}

impl From<f64> for Long {
    fn from(value: f64) -> Self {
        Self { value, rest: 0.0 }
    }
}

impl AddAssign<f64> for Long {
    fn add_assign(&mut self, number: f64) {
        let (value, rounded) = two_sum(self.value, number);
        (self.value, self.rest) = two_sum(value, rounded + self.rest);
    }
}

impl Value for Long {
    #[inline]
    fn minus(self, other: Self) -> f64 {
        (self.value - other.value) + (self.rest - other.rest)
    }

    fn plus(mut self, number: f64) -> Self {
        self += number;
        self
    }
}

impl Value for f64 {
    #[inline]
    fn minus(self, other: Self) -> f64 {
        self - other
    }

    fn plus(self, number: f64) -> Self {
        self + number
    }
}

/// A sum and its rounding error.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_updates_of_large_numbers_are_kept() {
        let (mut a, b) = (Long::from(1e-3), Long::from(1e-3));
        (0..1000).for_each(|_| a += 1e-23);
        assert_eq!(a.value(), 1e-3);
        assert!((a.minus(b) / 1e-20 - 1.0).abs() < 1e-12);
        assert!((a.plus(-1e-3).value() / 1e-20 - 1.0).abs() < 1e-12);
        assert_eq!(1.5.minus(0.5), 1.0);
    }
}
