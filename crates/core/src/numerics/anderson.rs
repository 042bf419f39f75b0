//! Fixed points `x = g(x)` of functions that are expensive, by Anderson's acceleration (Anderson 1965,
//! doi:10.1145/321296.321305; Walker & Ni 2011, doi:10.1137/10078356X) with a damping that adapts.

use nalgebra::{DMatrix, DVector};

/// Steps that are remembered.
const DEPTH: usize = 3;
/// Damping of the first step, and the least and the largest one.
const FIRST: f64 = 0.5;
const LEAST: f64 = 0.1;
/// Growth of the residual over the least one from which on a step is taken back.
const GROWTH: f64 = 4.0;
/// Singular values below this part of the largest one are left out.
const SINGULAR: f64 = 1e-8;

/// The state of an iteration.
#[derive(Debug, Clone)]
pub struct Anderson {
    /// Weights of the squared residuals, one for each unknown.
    weights: Vec<f64>,
    damping: f64,
    points: Vec<Vec<f64>>,
    residuals: Vec<Vec<f64>>,
    norms: Vec<f64>,
}

impl Anderson {
    /// An iteration whose residuals are weighed with `weights`, one for each unknown.
    pub fn new(weights: Vec<f64>) -> Self {
        Self { weights, damping: FIRST, points: vec![], residuals: vec![], norms: vec![] }
    }

    /// The next point, for the present `point` and the value of the function there.
    ///
    /// A point that is much worse than the best one so far is not remembered: the next one lies halfway back.
    pub fn next(&mut self, point: &[f64], value: &[f64]) -> Vec<f64> {
        let residual: Vec<f64> = value.iter().zip(point).map(|(g, x)| g - x).collect();
        let norm = self.norm(&residual);
        let best = (0..self.norms.len()).min_by(|a, b| self.norms[*a].total_cmp(&self.norms[*b]));
        if let Some(best) = best
            && (norm.is_nan() || norm > GROWTH * self.norms[best])
        {
            self.damping = (0.5 * self.damping).max(LEAST);
            return self.points[best].iter().zip(point).map(|(a, b)| 0.5 * (a + b)).collect();
        }
        self.damping = (1.5 * self.damping).min(1.0);
        self.points.push(point.to_vec());
        self.residuals.push(residual);
        self.norms.push(norm);
        if self.points.len() > DEPTH + 1 {
            self.points.remove(0);
            self.residuals.remove(0);
            self.norms.remove(0);
        }
        self.combined()
    }

    fn norm(&self, residual: &[f64]) -> f64 {
        residual.iter().zip(&self.weights).map(|(r, w)| w * r * r).sum::<f64>().sqrt()
    }

    /// The damped step from where the residual would be least if it were linear.
    fn combined(&self) -> Vec<f64> {
        let last = self.points.len() - 1;
        let rows = self.weights.len();
        let root = |i: usize| self.weights[i].sqrt();
        let steps = DMatrix::from_fn(rows, last, |i, j| {
            root(i) * (self.residuals[last][i] - self.residuals[j][i])
        });
        let present = DVector::from_fn(rows, |i, _| root(i) * self.residuals[last][i]);
        let shares = if last == 0 {
            DVector::zeros(0)
        } else {
            let svd = steps.svd(true, true);
            let cut = SINGULAR * svd.singular_values.max();
            svd.solve(&present, cut).unwrap_or_else(|_| DVector::zeros(last))
        };
        (0..rows)
            .map(|i| {
                let mut x = self.points[last][i];
                let mut r = self.residuals[last][i];
                for (j, share) in shares.iter().enumerate() {
                    x -= share * (self.points[last][i] - self.points[j][i]);
                    r -= share * (self.residuals[last][i] - self.residuals[j][i]);
                }
                x + self.damping * r
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps until the residual is below 1e-10.
    fn steps(g: impl Fn(&[f64]) -> Vec<f64>, start: &[f64]) -> usize {
        let mut anderson = Anderson::new(vec![1.0; start.len()]);
        let mut x = start.to_vec();
        for step in 1..100 {
            let value = g(&x);
            let largest = value.iter().zip(&x).map(|(g, x)| (g - x).abs()).fold(0.0, f64::max);
            if largest < 1e-10 {
                return step;
            }
            x = anderson.next(&x, &value);
        }
        100
    }

    #[test]
    fn functions_that_plain_iteration_leaves_or_hardly_approaches_are_solved() {
        // Slopes of -4 and 0.95: plain iteration diverges, or takes 450 steps.
        let linear = |x: &[f64]| vec![1.0 - 4.0 * x[0], 0.5 + 0.95 * x[1]];
        assert!(steps(linear, &[0.0, 0.0]) < 12, "{}", steps(linear, &[0.0, 0.0]));
        let bent = |x: &[f64]| vec![2.0 * (-1.5 * x[0]).exp() + 0.1 * x[1], (0.3 * x[0]).cos()];
        assert!(steps(bent, &[0.0, 0.0]) < 25, "{}", steps(bent, &[0.0, 0.0]));
        // A slope of -200 behind a kink, where no fixed damping that is worth having settles.
        let kinked = |x: &[f64]| {
            let fall = (x[0] - 0.3).max(0.0);
            vec![1.0 - 0.2 * x[0] - 200.0 * fall, 0.4 * x[1] + x[0]]
        };
        assert!(steps(kinked, &[0.0, 0.0]) < 60, "{}", steps(kinked, &[0.0, 0.0]));
    }
}
