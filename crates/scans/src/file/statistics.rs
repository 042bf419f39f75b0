//! Mean and standard deviation of heights that are read once.

/// Sums of heights, of which NaN counts as missing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Statistics {
    points: u64,
    valid: u64,
    sum: f64,
    /// First height, from which squares are measured: those of texture would drown in that of an
    /// offset.
    origin: f64,
    deviations: f64,
    squares: f64,
}

impl Statistics {
    /// Of the heights of a file.
    pub fn of(heights: &[f64]) -> Self {
        let mut statistics = Self::default();
        statistics.take(heights);
        statistics
    }

    /// Takes more heights.
    pub fn take(&mut self, heights: &[f64]) {
        self.points += heights.len() as u64;
        for height in heights.iter().filter(|height| !height.is_nan()) {
            if self.valid == 0 {
                self.origin = *height;
            }
            self.valid += 1;
            self.sum += height;
            let deviation = height - self.origin;
            self.deviations += deviation;
            self.squares += deviation * deviation;
        }
    }

    /// Number of points, those without a height included.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Number of points without a height.
    pub fn missing(&self) -> u64 {
        self.points - self.valid
    }

    /// Mean of the heights that are there, in their unit.
    pub fn mean(&self) -> f64 {
        self.sum / self.valid as f64
    }

    /// Standard deviation of the heights that are there about their mean, of the population, in
    /// their unit.
    pub fn standard_deviation(&self) -> f64 {
        let valid = self.valid as f64;
        let mean = self.deviations / valid;
        (self.squares / valid - mean * mean).max(0.0).sqrt()
    }
}
