//! Laws of the first invariant that stiffen with it: Yeoh and Arruda-Boyce.
//!
//! The shear part of neo-Hooke is linear in an invariant of the elastic part of the deformation,
//!
//! ```text
//! y = C : C_i⁻¹ - 2 - ln V = I1 - 3 - 2 ln J      (I1 of the elastic part, in plane strain; J² = V)
//! ```
//!
//! and these laws are other functions of the same invariant, with the volumetric part of neo-Hooke:
//!
//! ```text
//! ψ = μ/2 Φ(y) + Λ/4 (V - 1 - ln V),   Φ' = 1 + b1 y + b2 y² + b3 y³ + b4 y⁴
//! T = μ Φ'(y) (C_i⁻¹ - C⁻¹) + Λ/2 (V - 1) C⁻¹
//! ```
//!
//! | law | Φ' |
//! |---|---|
//! | Yeoh | `1 + 2 (c2/c1) y + 3 (c3/c1) y²` |
//! | Arruda-Boyce | `f'(3 + y) / f'(3)`, `f'(I) = Σ i a_i I^(i-1) / λ^(2i-2)`, a = 1/2, 1/20, 11/1050, 19/7000, 519/673750 |
//!
//! **Why this invariant.** `y` is `I1 - 3` without change of volume and of second order in any strain, so the moduli at
//! small strain are μ and Λ whatever the constants, `Φ' = 1` is neo-Hooke to the last bit, and the heat is that of
//! neo-Hooke times `Φ'`. With `f(I1) - 2 f'(3) ln J` instead, which also contains neo-Hooke, the modulus of compression
//! at small strain is higher by `4 f''(3)` (by `4 μ c2/c1` under Yeoh), so that the Poisson ratio of a spring depends on
//! its constants. `f(J^(-2/3) I1)` has no neo-Hooke of this program as its limit. At ν = 0.49 the three differ by what
//! the volume changes (a test below).
//!
//! **Range.** Five terms of Arruda and Boyce's series do not lock. The law is taken to end at `I1 = 3 λ²`, where the
//! chains are straight; at a chain stretch of 0.8 of that their force is 10 % below that of the inverse Langevin
//! function. Yeoh's law ends where the shear stress `μ Φ'(γ²) γ` of simple shear has its maximum, at the first root of
//! `Φ' + 2 y Φ'' = 1 + 6 (c2/c1) y + 15 (c3/c1) y²`: in plane strain equilibrium loses its ellipticity there (Abeyaratne
//! 1980, J. Elasticity 10, 255). There is no root for `(c2/c1)² < 5/3 c3/c1`. Beyond it Φ' is held constant, so that
//! the iterations of a solver may pass through, but no solution may lie there.

use super::law::{Hardening, Law};
use super::measure::Measure;
use super::neo_hookean::NeoHookean;
use super::symmetric::{
    Symmetric, contract, difference, dilatation, dilatation_difference, inverse, one_plus, sandwich,
};
use super::{Spring, Tangent, UNITS};

/// `i a_i` of the series of Arruda and Boyce (1993).
const CHAIN: [f64; 5] =
    [1.0 / 2.0, 2.0 / 20.0, 3.0 * 11.0 / 1050.0, 4.0 * 19.0 / 7000.0, 5.0 * 519.0 / 673_750.0];

/// The factor Φ' of a shear stress over that of neo-Hooke, as a function of `y = I1 - 3 - 2 ln J`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffening {
    /// `b1` to `b4`.
    coefficients: [f64; 4],
    /// Largest `y` at which the law holds.
    limit: f64,
    /// Where Φ' is held.
    held_from: f64,
}

impl Stiffening {
    /// Neo-Hooke.
    pub const NONE: Self =
        Self { coefficients: [0.0; 4], limit: f64::INFINITY, held_from: f64::INFINITY };

    /// Of Yeoh's law.
    pub(super) fn yeoh(c2_over_c1: f64, c3_over_c1: f64) -> Self {
        // Twice the reciprocal of -b + √(b² - 4 a) for a y² + b y + 1.
        let (a, b) = (15.0 * c3_over_c1, 6.0 * c2_over_c1);
        let denominator = (b * b - 4.0 * a).sqrt() - b;
        let limit = if denominator > 0.0 { 2.0 / denominator } else { f64::INFINITY };
        let coefficients = [2.0 * c2_over_c1, 3.0 * c3_over_c1, 0.0, 0.0];
        Self { coefficients, limit, held_from: limit }
    }

    /// Of Arruda and Boyce's law.
    pub(super) fn arruda_boyce(locking_stretch: f64) -> Self {
        let share = locking_stretch.powi(-2);
        let term = |i: usize| CHAIN[i] * share.powi(i as i32);
        let at_rest: f64 = (0..5).map(|i| term(i) * 3_f64.powi(i as i32)).sum();
        // (3 + y)^i in powers of y.
        let coefficient = |j: usize| {
            let of = |i: usize| term(i) * binomial(i, j) * 3_f64.powi((i - j) as i32);
            (j..5).map(of).sum::<f64>() / at_rest
        };
        Self {
            coefficients: [1, 2, 3, 4].map(coefficient),
            limit: 3.0 * (locking_stretch.powi(2) - 1.0),
            held_from: f64::INFINITY,
        }
    }

    /// Largest `y` at which the law holds.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// `Φ'` at `y`, held where the law of Yeoh ends.
    pub fn slope_at(&self, y: f64) -> f64 {
        self.slope(y)
    }

    /// `Φ`.
    fn energy(&self, y: f64) -> f64 {
        let [b1, b2, b3, b4] = self.coefficients;
        let at = y.min(self.held_from);
        let sum = at * (1.0 + at * (b1 / 2.0 + at * (b2 / 3.0 + at * (b3 / 4.0 + at * b4 / 5.0))));
        if y > at { sum + self.slope(at) * (y - at) } else { sum }
    }

    /// `Φ'`.
    #[inline]
    fn slope(&self, y: f64) -> f64 {
        let [b1, b2, b3, b4] = self.coefficients;
        let y = y.min(self.held_from);
        1.0 + y * (b1 + y * (b2 + y * (b3 + y * b4)))
    }

    /// `Φ''`.
    #[inline]
    fn curvature(&self, y: f64) -> f64 {
        let [b1, b2, b3, b4] = self.coefficients;
        if y > self.held_from {
            return 0.0;
        }
        b1 + y * (2.0 * b2 + y * (3.0 * b3 + y * 4.0 * b4))
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// `y` of the elastic part of a deformation, as accurate as the lag.
#[inline]
pub(super) fn invariant([strain, internal, lag]: [&Symmetric; 3]) -> f64 {
    let past = 1.0 + dilatation(internal);
    let adjugate = [1.0 + internal[1], 1.0 + internal[0], -internal[2]];
    let growth = contract(&adjugate, lag) / past;
    growth - (dilatation_difference(strain, internal, lag) / past).ln_1p()
}

impl Law for Stiffening {
    const IN_GREEN_STRAIN: bool = true;

    fn measure(strain: &Symmetric) -> Option<Measure> {
        NeoHookean::measure(strain)
    }

    fn energy(&self, spring: &Spring, strain: &Symmetric, internal: &Symmetric) -> f64 {
        let y = invariant([strain, internal, &difference(strain, internal)]);
        let volumetric = Spring { shear: 0.0, ..*spring };
        0.5 * spring.shear * self.energy(y) + NeoHookean.energy(&volumetric, strain, internal)
    }

    #[inline]
    fn shear_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric {
        let slope = self.slope(invariant(tensors));
        NeoHookean.shear_stress(spring, tensors).map(|t| slope * t)
    }

    #[inline]
    fn volumetric_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric {
        NeoHookean.volumetric_stress(spring, tensors)
    }

    fn shear_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        let mut tangent = NeoHookean.shear_tangent(spring, strain, internal, fraction)?;
        let Hardening { slope, curvature, by_strain, by_internal } =
            self.hardening([strain, internal, &difference(strain, internal)]);
        for (j, unit) in UNITS.iter().enumerate() {
            let change = contract(&by_strain, unit) - fraction * contract(&by_internal, unit);
            for i in 0..3 {
                tangent[i][j] =
                    slope * tangent[i][j] + spring.shear * curvature * by_strain[i] * change;
            }
        }
        Some(tangent)
    }

    fn volumetric_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        NeoHookean.volumetric_tangent(spring, strain, internal, fraction)
    }

    fn metric(measure: &Symmetric) -> Option<(Symmetric, f64)> {
        NeoHookean::metric(measure)
    }

    fn volume(measure: &Symmetric) -> f64 {
        NeoHookean::volume(measure)
    }

    #[inline]
    fn hardening(&self, tensors: [&Symmetric; 3]) -> Hardening {
        const UNIT: Spring = Spring { shear: 1.0, volumetric: 0.0, relaxation_time: 1.0 };
        let y = invariant(tensors);
        Hardening {
            slope: self.slope(y),
            curvature: self.curvature(y),
            by_strain: NeoHookean.shear_stress(&UNIT, tensors),
            by_internal: sandwich(&inverse(&one_plus(tensors[1])), tensors[2]),
        }
    }

    fn invariant(tensors: [&Symmetric; 3]) -> Option<f64> {
        Some(invariant(tensors))
    }

    /// Those of neo-Hooke, the shear part times Φ'.
    fn driving_force(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [Symmetric; 2] {
        let slope = self.slope(invariant([strain, internal, &difference(strain, internal)]));
        let [shear, volumetric] = NeoHookean.driving_force(branch, strain, internal);
        [shear.map(|force| slope * force), volumetric]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FiniteStrainRubber, Rheology};
    use super::*;
    use crate::rubber::Rubber;
    use approx::assert_relative_eq;

    const YEOH: Rheology = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 };
    const ARRUDA_BOYCE: Rheology = Rheology::ArrudaBoyce { locking_stretch: 2.5 };

    /// `2 f'(I1) / μ` as the papers have it.
    fn published(law: Rheology, i1: f64) -> f64 {
        match law {
            Rheology::Yeoh { c2_over_c1, c3_over_c1 } => {
                1.0 + 2.0 * c2_over_c1 * (i1 - 3.0) + 3.0 * c3_over_c1 * (i1 - 3.0).powi(2)
            }
            Rheology::ArrudaBoyce { locking_stretch } => {
                let n = locking_stretch.powi(2);
                let of = |i1: f64| {
                    0.5 + i1 / (10.0 * n)
                        + 11.0 * i1.powi(2) / (350.0 * n.powi(2))
                        + 19.0 * i1.powi(3) / (1750.0 * n.powi(3))
                        + 519.0 * i1.powi(4) / (134_750.0 * n.powi(4))
                };
                // The modulus of the series at small strain.
                let modulus = 1.0
                    + 3.0 / (5.0 * n)
                    + 99.0 / (175.0 * n.powi(2))
                    + 513.0 / (875.0 * n.powi(3))
                    + 42_039.0 / (67_375.0 * n.powi(4));
                2.0 * of(i1) / modulus
            }
            _ => 1.0,
        }
    }

    /// Simple shear keeps the volume: `σ_xz = 2 f'(3 + γ²) γ`.
    #[test]
    fn simple_shear_has_the_published_stress() {
        for law in [YEOH, ARRUDA_BOYCE, Rheology::NeoHookean] {
            let rubber = FiniteStrainRubber::new(&Rubber::table_2_1(), law).unwrap();
            let spring = rubber.equilibrium;
            for gamma in [1e-3, 0.3, 1.5, 3.0] {
                let strain = [0.0, gamma * gamma, gamma];
                let stress = rubber.shear_stress(&spring, [&strain, &[0.0; 3], &strain]);
                let expected = spring.shear * published(law, 3.0 + gamma * gamma) * gamma;
                assert_relative_eq!(stress[2] + gamma * stress[1], expected, max_relative = 1e-12);
            }
        }
    }

    /// Tension in the plane, free along z: `σ = 2 f'(I1) (λ² - λ⁻²)` without change of volume. What the volume changes
    /// falls with 1/Λ, so that two Poisson ratios lead to the limit.
    #[test]
    fn tension_has_the_published_stress_of_an_incompressible_solid() {
        for law in [YEOH, ARRUDA_BOYCE, Rheology::NeoHookean] {
            for stretch in [0.4_f64, 0.7, 1.3, 2.2] {
                let i1 = 1.0 + stretch.powi(2) + stretch.powi(-2);
                let exact = published(law, i1) * (stretch.powi(2) - stretch.powi(-2));
                let [(soft, a), (stiff, b)] = [0.499, 0.4999].map(|nu: f64| {
                    (2.0 * nu / (1.0 - 2.0 * nu), tension(law, nu, stretch, conjugate))
                });
                let limit = (stiff * b - soft * a) / (stiff - soft);
                // The square of stress over Λ.
                assert_relative_eq!(limit, exact, max_relative = 1e-4);
            }
        }
    }

    /// Stress over shear modulus at stretches `[λ, λ_z]`: `σ_x` and `σ_z`.
    type Stress = fn(Rheology, f64, [f64; 2]) -> [f64; 2];

    /// Cauchy stress over μ in tension to a stretch, free along z.
    fn tension(law: Rheology, nu: f64, stretch: f64, stress: Stress) -> f64 {
        let (mut low, mut high) = (0.5 / stretch, 2.0 / stretch);
        while high - low > 1e-14 * high {
            let middle = 0.5 * (low + high);
            if stress(law, nu, [stretch, middle])[1] < 0.0 { low = middle } else { high = middle }
        }
        stress(law, nu, [stretch, 0.5 * (low + high)])[0]
    }

    fn conjugate(law: Rheology, nu: f64, stretches: [f64; 2]) -> [f64; 2] {
        let rubber = FiniteStrainRubber::new(&Rubber::elastic(1e6, nu), law).unwrap();
        let spring = rubber.equilibrium;
        let strain = [stretches[0].powi(2) - 1.0, stretches[1].powi(2) - 1.0, 0.0];
        let tensors = [&strain, &[0.0; 3], &strain];
        let (shear, volumetric) =
            (rubber.shear_stress(&spring, tensors), rubber.volumetric_stress(&spring, tensors));
        let volume = stretches[0] * stretches[1];
        [0, 1].map(|i| stretches[i].powi(2) * (shear[i] + volumetric[i]) / (volume * spring.shear))
    }

    /// `f(J^(-2/3) I1)` with the volumetric part of this program, by itself.
    fn isochoric(law: Rheology, nu: f64, stretches: [f64; 2]) -> [f64; 2] {
        let volume = stretches[0] * stretches[1];
        let i1 = 1.0 + stretches[0].powi(2) + stretches[1].powi(2);
        let bar = volume.powf(-2.0 / 3.0);
        // K of the same small strains: Λ + 2/3 μ.
        let bulk = 2.0 * nu / (1.0 - 2.0 * nu) + 2.0 / 3.0;
        let pressure = 0.5 * bulk * (volume - 1.0 / volume);
        [0, 1].map(|i| {
            published(law, bar * i1) * bar * (stretches[i].powi(2) - i1 / 3.0) / volume + pressure
        })
    }

    /// `f(I1) - 2 f'(3) ln J` with the volumetric part of this program.
    fn plain(law: Rheology, nu: f64, stretches: [f64; 2]) -> [f64; 2] {
        let volume = stretches[0] * stretches[1];
        let i1 = 1.0 + stretches[0].powi(2) + stretches[1].powi(2);
        let lame = 2.0 * nu / (1.0 - 2.0 * nu);
        [0, 1].map(|i| {
            let shear = published(law, i1) * stretches[i].powi(2) - 1.0;
            (shear + 0.5 * lame * (volume * volume - 1.0)) / volume
        })
    }

    /// What the choice of the invariant is worth: three splits that agree without change of volume.
    #[test]
    fn invariants_differ_by_the_change_of_volume() {
        let mut most = [0.0_f64; 2];
        for law in [YEOH, ARRUDA_BOYCE] {
            for stretch in [0.4_f64, 0.6, 1.5, 2.2] {
                let of = |nu: f64| {
                    [conjugate as Stress, isochoric, plain].map(|s| tension(law, nu, stretch, s))
                };
                let [own, isochoric, plain] = of(0.49);
                let difference = [isochoric / own - 1.0, plain / own - 1.0];
                println!("{law:?}, stretch {stretch}, nu 0.49: {own:.4}, {difference:.4?}");
                (0..2).for_each(|k| most[k] = most[k].max(difference[k].abs()));
                let [own, isochoric, plain] = of(0.4999);
                assert_relative_eq!(own, isochoric, max_relative = 3e-3);
                assert_relative_eq!(own, plain, max_relative = 3e-3);
            }
        }
        assert!(most[0] > 1e-3 && most[0] < 0.3, "{most:?}");
    }

    /// The modulus of compression at small strain is Λ + 2 μ whatever the constants; of `f(I1) - 2 f'(3) ln J` it is
    /// higher by `4 f''(3)`.
    #[test]
    fn only_the_chosen_invariant_keeps_the_linear_moduli() {
        let law = Rheology::Yeoh { c2_over_c1: -0.3, c3_over_c1: 0.1 };
        let strained = [1.0 + 1e-6, 1.0];
        let linear = 2.0 * 0.49 / 0.02 + 2.0;
        assert_relative_eq!(conjugate(law, 0.49, strained)[0], 1e-6 * linear, max_relative = 1e-5);
        // f'' = 2 c2 = μ c2/c1.
        let more = 4.0 * -0.3;
        let expected = 1e-6 * (linear + more);
        assert_relative_eq!(plain(law, 0.49, strained)[0], expected, max_relative = 1e-5);
    }

    #[test]
    fn the_range_ends_where_the_shear_stress_has_its_maximum() {
        let of = |c2_over_c1, c3_over_c1| Rheology::Yeoh { c2_over_c1, c3_over_c1 };
        // Never: no negative constant, and (c2/c1)² below 5/3 c3/c1.
        for law in [of(0.0, 0.0), of(0.2, 0.0), of(0.2, 0.1), of(-0.1, 0.0061)] {
            assert_eq!(law.limit(), f64::INFINITY, "{law:?}");
        }
        for law in [of(-0.1, 0.0), of(-0.1, 0.0059), of(-0.1, -0.01), of(0.1, -0.01)] {
            let stiffening = law.stiffening();
            let stress = |y: f64| stiffening.slope(y) * y.sqrt();
            let end = law.limit();
            assert!(stress(end) > stress(0.99 * end), "{law:?}");
            // Held from there on: the stress grows, without the maximum of the polynomial.
            let polynomial = Stiffening { held_from: f64::INFINITY, ..stiffening };
            let beyond = |s: &Stiffening| s.slope(1.01 * end) * (1.01 * end).sqrt();
            assert!(beyond(&polynomial) < stress(end), "{law:?}");
            assert!(beyond(&stiffening) > stress(end), "{law:?}");
            let step = 1e-6 * end;
            for y in [0.5 * end, 1.5 * end] {
                let slope =
                    (stiffening.energy(y + step) - stiffening.energy(y - step)) / (2.0 * step);
                assert_relative_eq!(slope, stiffening.slope(y), max_relative = 1e-7);
            }
        }
        assert_eq!(ARRUDA_BOYCE.limit(), 3.0 * (2.5 * 2.5 - 1.0));
    }

    /// What the module says of the series: the force of a chain against the inverse Langevin function.
    #[test]
    fn five_terms_are_a_tenth_below_the_inverse_langevin_function_at_four_fifths() {
        let langevin = |x: f64| 1.0 / x.tanh() - 1.0 / x;
        let inverse = |at: f64| {
            let (mut low, mut high) = (1e-6, 1e3);
            while high - low > 1e-12 * high {
                let middle = 0.5 * (low + high);
                if langevin(middle) < at { low = middle } else { high = middle }
            }
            low
        };
        // 2 f'(I) = force(x) / (3 x) with the chain stretch x over its limit, I = 3 n x².
        let series = |x: f64| {
            let sum: f64 = (0..5).map(|i| CHAIN[i] * (3.0 * x * x).powi(i as i32)).sum();
            6.0 * x * sum
        };
        assert_relative_eq!(series(0.3), inverse(0.3), max_relative = 1e-4);
        assert_relative_eq!(series(0.8) / inverse(0.8), 0.9, epsilon = 0.005);
    }
}
