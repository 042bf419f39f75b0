//! Depths at which fields below the surface are known, and the two integrals over depth that heat needs.
//!
//! The depths are panels from the surface on, each as thick as all above it, with the nodes of a Gauss-Legendre rule in
//! each: composite Gauss quadrature on a logarithmic scale, without a part that is left out at the surface. A field
//! `z^n e^(-a z)`, `|arg a| <= π/4`, is known between the nodes to 1e-12 of its maximum, its integral to round-off.

use crate::numerics::legendre::Legendre;
use rustfft::num_complex::Complex64;

/// Nodes of a panel.
pub(super) const NODES: usize = 20;
/// Decay `q z` beyond which a wave is left out.
const NEGLIGIBLE: f64 = 42.0;
/// Depth of the last panel over the longest length of decay.
const DEEPEST: f64 = 24.0;

/// One panel, from `top` to `top + 2 half`, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Panel {
    pub top: f64,
    pub half: f64,
}

/// Panels of depths with their rule.
#[derive(Debug, Clone)]
pub(super) struct Depths {
    pub rule: Legendre<NODES>,
    pub panels: Vec<Panel>,
}

impl Depths {
    /// Depths for decays `e^(-a z)` with `a` from `slowest` to `fastest`, in 1/m.
    pub fn new(slowest: f64, fastest: f64) -> Self {
        let first = 1.0 / fastest;
        let mut panels = vec![Panel { top: 0.0, half: 0.5 * first }];
        let mut top = first;
        while top < DEEPEST / slowest {
            panels.push(Panel { top, half: 0.5 * top });
            top *= 2.0;
        }
        Self { rule: Legendre::new(), panels }
    }

    /// Depth in m of node `j` of panel `p`.
    pub fn depth(&self, p: usize, j: usize) -> f64 {
        let Panel { top, half } = self.panels[p];
        top + half * (1.0 + self.rule.nodes[j])
    }

    /// Weight in m of node `j` of panel `p`.
    pub fn weight(&self, p: usize, j: usize) -> f64 {
        self.panels[p].half * self.rule.weights[j]
    }

    /// Depths and weights of all nodes, from the surface on.
    pub fn nodes(&self) -> Vec<(f64, f64)> {
        let of_panel = |p| (0..NODES).map(move |j| (self.depth(p, j), self.weight(p, j)));
        (0..self.panels.len()).flat_map(of_panel).collect()
    }

    /// How many of `waves` waves `q_1, 2 q_1, ...` reach panel `p`.
    pub fn waves_in(&self, p: usize, waves: usize, longest: f64) -> usize {
        let top = self.panels[p].top;
        if top == 0.0 { waves } else { waves.min((NEGLIGIBLE / (top * longest)) as usize + 1) }
    }

    /// Coefficients of the Legendre polynomials of values at the nodes of a panel.
    pub fn coefficients(&self, values: &[Complex64]) -> [Complex64; NODES] {
        let mut result = [Complex64::ZERO; NODES];
        for (c, row) in result.iter_mut().zip(&self.rule.to_coefficients) {
            *c = values.iter().zip(row).map(|(f, r)| f * r).sum();
        }
        result
    }

    /// Values at the nodes of coefficients.
    fn values(&self, coefficients: &[Complex64; NODES]) -> [Complex64; NODES] {
        let mut result = [Complex64::ZERO; NODES];
        for (f, row) in result.iter_mut().zip(&self.rule.values) {
            *f = coefficients.iter().zip(row).map(|(c, p)| c * p).sum();
        }
        result
    }

    /// What comes up from below: `∫_z^∞ f(z') e^(-s (z' - z)) dz'` at all nodes and at the surface, for the values of `f` at
    /// the nodes of the first panels, below which it vanishes. The values are replaced by the result.
    pub fn sweep_up(&self, s: Complex64, values: &mut [Complex64]) -> Complex64 {
        let mut carried = Complex64::ZERO;
        for (panel, values) in self.panels.iter().zip(values.chunks_exact_mut(NODES)).rev() {
            let mut f = self.coefficients(values);
            flip(&mut f);
            let (mut u, end) = decay(s * panel.half, panel.half, &f, carried);
            flip(&mut u);
            values.copy_from_slice(&self.values(&u));
            carried = end;
        }
        carried
    }

    /// What comes down from above: `e^(-s z) at_surface + ∫_0^z f(z') e^(-s (z - z')) dz'` at the nodes, added to `result`.
    pub fn sweep_down(
        &self,
        s: Complex64,
        values: &[Complex64],
        at_surface: Complex64,
        result: &mut [Complex64],
    ) {
        let mut carried = at_surface;
        let blocks = values.chunks_exact(NODES).zip(result.chunks_exact_mut(NODES));
        for (panel, (values, result)) in self.panels.iter().zip(blocks) {
            let f = self.coefficients(values);
            let (u, end) = decay(s * panel.half, panel.half, &f, carried);
            for (r, u) in result.iter_mut().zip(self.values(&u)) {
                *r += u;
            }
            carried = end;
        }
    }
}

/// Turns a function of ξ into one of -ξ.
fn flip(coefficients: &mut [Complex64; NODES]) {
    coefficients.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
}

/// Solves `u' + σ u = h f` on `[-1, 1]` from `u(-1) = start`, with `Re σ >= 0`; returns the coefficients of `u` and its value at
/// 1.
///
/// The discontinuous Galerkin method in its Legendre form (Radau IIA): damped for any σ, so that a decay that is much
/// faster than the panel is followed exactly. Integrated over ξ, `∫P_n = (P_{n+1} - P_{n-1}) / (2n+1)`, the equations
/// are tridiagonal,
///
/// ```text
/// u_n + σ (u_{n-1}/(2n-1) - u_{n+1}/(2n+3)) = h (f_{n-1}/(2n-1) - f_{n+1}/(2n+3)),   n >= 1
/// ```
///
/// but for the last one, which takes up the jump at the start, and for `n = 0`, the value at the start.
fn decay(
    sigma: Complex64,
    half: f64,
    f: &[Complex64; NODES],
    start: Complex64,
) -> ([Complex64; NODES], Complex64) {
    let odd = |k: usize| (2 * k + 1) as f64;
    let last = NODES - 1;
    let forcing = |n: usize| {
        let above = f.get(n + 1).map_or(Complex64::ZERO, |f| f / odd(n + 1));
        half * (f[n - 1] / odd(n - 1) - above)
    };
    // u_n = constant[n] + ratio[n] u_{n-1}, from the last one on.
    let (mut constant, mut ratio) = ([Complex64::ZERO; NODES], [Complex64::ZERO; NODES]);
    let jump = half * f[last] / odd(last);
    let inverse = (1.0 + sigma / odd(last)).inv();
    constant[last] = (forcing(last) + jump) * inverse;
    ratio[last] = -sigma / odd(last - 1) * inverse;
    for n in (1..last).rev() {
        let inverse = (1.0 - sigma * ratio[n + 1] / odd(n + 1)).inv();
        constant[n] = (forcing(n) + sigma * constant[n + 1] / odd(n + 1)) * inverse;
        ratio[n] = -sigma / odd(n - 1) * inverse;
    }
    // u_n = particular + homogeneous u_0, then the value at the start gives u_0.
    let mut homogeneous = [Complex64::ONE; NODES];
    for n in 1..NODES {
        constant[n] += ratio[n] * constant[n - 1];
        homogeneous[n] = ratio[n] * homogeneous[n - 1];
    }
    let sign = |n: usize| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
    let at_start = |u: &[Complex64; NODES]| -> Complex64 {
        u.iter().enumerate().map(|(n, u)| sign(n) * u).sum()
    };
    let two = 2.0 * sign(NODES);
    let known = at_start(&constant) + two * (jump - sigma * constant[last] / odd(last));
    let unknown = at_start(&homogeneous) - two * sigma * homogeneous[last] / odd(last);
    let first = (start - known) / unknown;
    let mut u = constant;
    u.iter_mut().zip(&homogeneous).for_each(|(u, h)| *u += h * first);
    (u, u.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both sweeps of `z² e^(-a z)` against their closed forms.
    fn largest_error(a: f64, s: Complex64) -> f64 {
        let depths = Depths::new(0.5 * a, a + s.norm());
        let nodes = depths.nodes();
        let source: Vec<Complex64> =
            nodes.iter().map(|(z, _)| Complex64::from(z * z * (-a * z).exp())).collect();
        let mut up = source.clone();
        let surface = depths.sweep_up(s, &mut up);
        let mut down = vec![Complex64::ZERO; up.len()];
        depths.sweep_down(s, &source, Complex64::ZERO, &mut down);
        let sum = a + s;
        let exact_up =
            |z: f64| (-a * z).exp() * (z * z / sum + 2.0 * z / sum.powi(2) + 2.0 / sum.powi(3));
        let scale = nodes.iter().map(|(z, _)| exact_up(*z).norm()).fold(0.0, f64::max);
        let mut worst = (surface - 2.0 / sum.powi(3)).norm() / scale;
        for (k, (z, _)) in nodes.iter().enumerate() {
            worst = worst.max((up[k] - exact_up(*z)).norm() / scale);
            let gap = s - a;
            if gap.norm() > 0.3 * s.norm() {
                let slow =
                    (-a * z).exp() * (z * z / gap - 2.0 * z / gap.powi(2) + 2.0 / gap.powi(3));
                let exact = slow - 2.0 * (-s * z).exp() / gap.powi(3);
                worst = worst.max((down[k] - exact).norm() / scale);
            }
        }
        worst
    }

    #[test]
    fn sweeps_meet_their_closed_forms_for_slow_and_fast_decays() {
        for s in [0.01, 0.5, 1.0, 3.0, 40.0, 1e3, 1e5] {
            for turn in [0.0, 0.3, 0.78] {
                let error = largest_error(1.0, Complex64::from_polar(s, turn));
                // Interpolation within a panel, see the module.
                assert!(error < 1e-12, "{s} {turn}: {error:e}");
            }
        }
    }
}
