//! How densely a curve over pressure must be sampled.

use crate::numerics::interpolation::CubicHermite;

/// Leaving every second point out makes the error of a cubic with parabola slopes, of third order,
/// eight times as large.
const LEFT_OUT_OVER_LEFT_IN: f64 = 8.0;

/// Estimated interpolation error, in units of the values, of the cubic in `ln p` through samples at
/// ascending pressures, at each of them: how far the cubic through the others misses it, over eight.
/// Zero at the two ends and for fewer than four samples, where nothing can be said.
pub fn interpolation_errors(pressures: &[f64], values: &[f64]) -> Vec<f64> {
    let n = pressures.len();
    let mut errors = vec![0.0; n];
    if n < 4 {
        return errors;
    }
    for k in 1..n - 1 {
        let others = |of: &[f64]| [&of[..k], &of[k + 1..]].concat();
        let x = others(pressures).iter().map(|p| p.ln()).collect();
        let cubic = CubicHermite::smooth(x, others(values));
        errors[k] = (cubic.at(pressures[k].ln()) - values[k]).abs() / LEFT_OUT_OVER_LEFT_IN;
    }
    errors
}

/// Pressures between neighbouring samples that bring the interpolation error of every one of the
/// curves below its `tolerance` (in units of its values): the geometric middles of the intervals
/// beside samples where it is above. None where all is well.
pub fn refinement(pressures: &[f64], curves: &[(&[f64], f64)]) -> Vec<f64> {
    let mut wanted = vec![false; pressures.len().saturating_sub(1)];
    for (values, tolerance) in curves {
        for (k, error) in interpolation_errors(pressures, values).into_iter().enumerate() {
            if error > *tolerance {
                wanted[k - 1] = true;
                wanted[k] = true;
            }
        }
    }
    let middle = |pair: &[f64]| (pair[0] * pair[1]).sqrt();
    pressures.windows(2).zip(wanted).filter(|(_, wanted)| *wanted).map(|(p, _)| middle(p)).collect()
}

/// Pressures from `first` to `last` at equal ratios of at most `ratio`.
pub fn geometric(first: f64, last: f64, ratio: f64) -> Vec<f64> {
    let steps = ((last / first).ln() / ratio.ln()).ceil().max(1.0);
    let count = steps as usize;
    (0..=count).map(|k| first * (last / first).powf(k as f64 / steps)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Refines until nothing is asked for and compares with the function everywhere.
    #[test]
    fn refined_curves_are_as_near_as_asked() {
        let function = |p: f64| (p.ln() * 1.3).sin() * 0.1 + 0.02 * (p - 3.0).tanh();
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let mut pressures = geometric(0.05, 9.0, 1.6);
            loop {
                let values: Vec<f64> = pressures.iter().map(|p| function(*p)).collect();
                let more = refinement(&pressures, &[(&values, tolerance)]);
                if more.is_empty() {
                    break;
                }
                pressures.extend(more);
                pressures.sort_by(f64::total_cmp);
            }
            let x: Vec<f64> = pressures.iter().map(|p| p.ln()).collect();
            let values = pressures.iter().map(|p| function(*p)).collect();
            let cubic = CubicHermite::smooth(x, values);
            let worst = geometric(0.05, 9.0, 1.001)
                .into_iter()
                .map(|p| (cubic.at(p.ln()) - function(p)).abs())
                .fold(0.0, f64::max);
            // The ends are not checked by a neighbour beyond them.
            assert!(worst < 3.0 * tolerance, "{tolerance}: {worst} with {}", pressures.len());
            assert!(pressures.len() < 400);
        }
    }

    #[test]
    fn geometric_pressures_end_where_they_should() {
        let pressures = geometric(0.1, 1.0, 1.5);
        assert_eq!((pressures[0], pressures.len()), (0.1, 7));
        approx::assert_relative_eq!(pressures[6], 1.0, max_relative = 1e-14);
        assert_eq!(geometric(2.0, 2.0, 1.5).len(), 2);
    }
}
