//! Compliance of a layer of finite thickness.

/// Compliance of a layer that is bonded to a rigid base over that of a half-space, for a frictionless surface:
///
/// ```text
/// F(x) = [(3-4ν) sinh 2x - 2x] / [(3-4ν) cosh 2x + 2x² + 5 - 12ν + 8ν²],   x = |q| h
/// ```
///
/// (Johnson, Contact Mechanics, 1985, section 5.8; Bentall & Johnson 1968, doi:10.1016/0020-7403(68)90070-8.) For thin
/// incompressible layers it tends to `2/3 x³`, otherwise to `x (1-2ν)/(2 (1-ν)²)`; for thick ones to 1.
pub(super) fn relative_compliance(x: f64, poisson_ratio: f64) -> f64 {
    let k = 3.0 - 4.0 * poisson_ratio;
    let rest = 5.0 - 12.0 * poisson_ratio + 8.0 * poisson_ratio.powi(2);
    if x > 20.0 {
        // Both hyperbolic functions are half of e^(2x), to beyond double precision.
        let small = (-2.0 * x).exp();
        return (k - 4.0 * x * small) / (k + 2.0 * (2.0 * x * x + rest) * small);
    }
    let denominator = k * (2.0 * x).cosh() + 2.0 * x * x + rest;
    (k * sinh_beyond_first(2.0 * x) + (k - 1.0) * 2.0 * x) / denominator
}

/// Mean compression of a layer per mean pressure, in m/Pa: `h (1-2ν) / ((1-ν)² E_r)`, the limit of
/// `2 F(|q| h) / (|q| E_r)` for long waves, for a `reduced_modulus` in Pa at rest.
pub(super) fn mean_compliance(thickness: f64, poisson_ratio: f64, reduced_modulus: f64) -> f64 {
    thickness * (1.0 - 2.0 * poisson_ratio) / ((1.0 - poisson_ratio).powi(2) * reduced_modulus)
}

/// `sinh y - y`, without the cancellation for small `y`.
fn sinh_beyond_first(y: f64) -> f64 {
    if y > 1.0 {
        return y.sinh() - y;
    }
    let (mut term, mut sum) = (y, 0.0);
    for n in 1..12 {
        term *= y * y / f64::from(2 * n * (2 * n + 1));
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_a_direct_solution_of_the_layer() {
        // Displacement of the four equations of each wave, solved directly, nu = 1/2.
        for (x, value, digits) in [
            (0.5, 0.057573628, 5e-10),
            (1.0, 0.240581681, 5e-10),
            (2.0, 0.641450, 5e-7),
            (5.0, 0.994487, 5e-7),
        ] {
            approx::assert_abs_diff_eq!(relative_compliance(x, 0.5), value, epsilon = digits);
        }
    }

    #[test]
    fn thin_and_thick_layers_have_their_limits() {
        for x in [1e-4_f64, 1e-6] {
            let incompressible = 2.0 / 3.0 * x.powi(3);
            // The next term is of relative order x².
            let found = relative_compliance(x, 0.5);
            approx::assert_relative_eq!(found, incompressible, max_relative = 10.0 * x * x);
            for nu in [0.0, 0.3, 0.45] {
                let long_wave = 0.5 * mean_compliance(x, nu, 1.0);
                let found = relative_compliance(x, nu);
                approx::assert_relative_eq!(found, long_wave, max_relative = 100.0 * x * x);
            }
        }
        for nu in [0.0, 0.3, 0.5] {
            assert_eq!(relative_compliance(30.0, nu), 1.0);
            assert_eq!(relative_compliance(1e6, nu), 1.0);
            // Both ways of evaluation meet.
            let jump = relative_compliance(20.0, nu) - relative_compliance(20.0 + 1e-9, nu);
            assert!(jump.abs() < 1e-15, "{jump:e}");
        }
    }

    #[test]
    fn series_and_function_of_the_hyperbolic_sine_meet() {
        let y: f64 = 1.0;
        approx::assert_relative_eq!(sinh_beyond_first(y), y.sinh() - y, max_relative = 1e-14);
    }
}
