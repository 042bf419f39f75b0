//! Functions on an interval by their values at the Gauss-Legendre nodes.

/// A Gauss-Legendre rule with `N` nodes on `[-1, 1]`, with what interpolates, integrates and propagates functions that are
/// known at its nodes. It is exact for polynomials of degree `2N - 1`.
#[derive(Debug, Clone)]
pub(crate) struct Legendre<const N: usize> {
    /// Nodes, ascending.
    pub nodes: [f64; N],
    /// Weights; their sum is 2.
    pub weights: [f64; N],
    /// `values[j][n] = P_n(ξ_j)`.
    pub values: [[f64; N]; N],
    /// `to_coefficients[n][j]`: the coefficient of `P_n` is the sum of these times the values at the nodes.
    pub to_coefficients: [[f64; N]; N],
    /// `beyond[i][j]`: the integral from the node `i` to 1 is the sum of these times the values at the nodes.
    pub beyond: [[f64; N]; N],
}

/// `P_0(x)` to `P_n(x)`.
fn polynomials(n: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..n {
        let degree = k as f64;
        p.push(((2.0 * degree + 1.0) * x * p[k] - degree * p[k - 1]) / (degree + 1.0));
    }
    p
}

/// Zero `j` of `P_n` by Newton's method, with the derivative there.
fn zero(n: usize, j: usize) -> (f64, f64) {
    let degree = n as f64;
    let mut x = -((j as f64 + 0.75) / (degree + 0.5) * std::f64::consts::PI).cos();
    let mut slope = 1.0;
    for _ in 0..20 {
        let p = polynomials(n, x);
        slope = degree * (x * p[n] - p[n - 1]) / (x * x - 1.0);
        x -= p[n] / slope;
    }
    (x, slope)
}

impl<const N: usize> Legendre<N> {
    pub fn new() -> Self {
        let mut rule = Self {
            nodes: [0.0; N],
            weights: [0.0; N],
            values: [[0.0; N]; N],
            to_coefficients: [[0.0; N]; N],
            beyond: [[0.0; N]; N],
        };
        for j in 0..N {
            let (x, slope) = zero(N, j);
            rule.nodes[j] = x;
            rule.weights[j] = 2.0 / ((1.0 - x * x) * slope * slope);
            rule.values[j].copy_from_slice(&polynomials(N, x)[..N]);
        }
        for n in 0..N {
            for j in 0..N {
                rule.to_coefficients[n][j] = (n as f64 + 0.5) * rule.weights[j] * rule.values[j][n];
            }
        }
        for i in 0..N {
            let p = polynomials(N, rule.nodes[i]);
            for j in 0..N {
                // The integral of P_n from x to 1 is (P_{n-1}(x) - P_{n+1}(x)) / (2n + 1).
                let of_wave = |n: usize| match n {
                    0 => 1.0 - p[1],
                    _ => (p[n - 1] - p[n + 1]) / (2 * n + 1) as f64,
                };
                rule.beyond[i][j] = (0..N).map(|n| rule.to_coefficients[n][j] * of_wave(n)).sum();
            }
        }
        rule
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_and_interpolants_of_an_exponential_are_exact() {
        let rule = Legendre::<16>::new();
        let f = rule.nodes.map(|x| (1.5 * x).exp());
        let integral: f64 = f.iter().zip(&rule.weights).map(|(f, w)| f * w).sum();
        let exact = (1.5_f64.exp() - (-1.5_f64).exp()) / 1.5;
        approx::assert_relative_eq!(integral, exact, max_relative = 1e-14);
        for (i, x) in rule.nodes.iter().enumerate() {
            let beyond: f64 = rule.beyond[i].iter().zip(&f).map(|(b, f)| b * f).sum();
            let exact = (1.5_f64.exp() - (1.5 * x).exp()) / 1.5;
            approx::assert_abs_diff_eq!(beyond, exact, epsilon = 1e-13);
        }
        let p = polynomials(16, 0.37);
        let value: f64 = rule
            .to_coefficients
            .iter()
            .zip(&p)
            .map(|(row, p)| p * row.iter().zip(&f).map(|(c, f)| c * f).sum::<f64>())
            .sum();
        approx::assert_relative_eq!(value, 0.555_f64.exp(), max_relative = 1e-14);
    }
}
