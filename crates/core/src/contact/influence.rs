//! What pressures at single points do to each other.

/// Displacements by unit pressures in units of that at the point of pressure itself.
pub(super) struct Influence<'a> {
    kernel: &'a [f64],
    /// The unit in m/Pa, and one over it.
    pub softness: f64,
    per_softness: f64,
    /// What the mean of the pressures is made to add everywhere: as much as if it were a wave as long as the period.
    ///
    /// It displaces all points alike, so pressures of sum zero do not show it; but without it the matrix of a set of
    /// nearly all points is nearly singular.
    pub mean: f64,
}

impl<'a> Influence<'a> {
    /// For the `kernel` in m/Pa, the displacement by a unit pressure at point 0.
    pub fn new(kernel: &'a [f64]) -> Self {
        let softness = kernel[0].abs();
        // The kernel at 0 is the sum over all waves, of which the longest of n has the part 1 / (2 ln n).
        let mean = 0.5 / (kernel.len() as f64).ln();
        Self { kernel, softness, per_softness: 1.0 / softness, mean }
    }

    /// Displacement of the point `to` by a unit pressure at `from`.
    pub fn at(&self, to: u32, from: u32) -> f64 {
        let (to, from) = (to as usize, from as usize);
        let distance = if to >= from { to - from } else { to + self.kernel.len() - from };
        self.kernel[distance] * self.per_softness + self.mean
    }
}
