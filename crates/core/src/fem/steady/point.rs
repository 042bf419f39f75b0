//! Deformation, stress and linearised law at one integration point.
//!
//! With the labels `(s, Z)` of the module, `q` and `w` the displacements along x and z,
//!
//! ```text
//! A = 1 - q_s,  B = -q_Z,  P = w_s,  Q = 1 + w_Z
//! F = [[1/A, -B/A], [P/A, Q - P B/A]],   det F = Q/A
//! ```
//!
//! so an element is valid where `A > 0` and `Q > 0`, two linear conditions.

use super::super::kinematics::{Tensor, green_strain, strain_change};
use super::Inverted;
use super::lanes::{Lanes, lane, set_lane};
use crate::rubber::finite_strain::{
    FiniteStrainRubber, Hardening, Measure, Scalar, Spring, Symmetric, contract, sandwich,
};

/// Smallest `A` and `Q` of a valid element.
const LEAST: f64 = 1e-3;

/// Deformation and stress at a point, and the coefficients of its own measure in the linearised law:
///
/// ```text
/// shear       δT = μ G δm G - Σ_k μ_k G_k δm_k G_k
/// volumetric  δT = (c G:δm - Σ_k c_k G_k:δm_k) G - σ G δm G
/// ```
///
/// with `G`, `c_k = Λ_k/2 V/V_k` and `σ = Σ_k (c_k - Λ_k/2)` of the law ([`metric`](crate::rubber::Rheology::metric)). For a
/// law that stiffens `μ_k` is that times its `Φ'`, and the rest is in `hardening`.
/// Forces follow in double precision; what a row keeps for its tangent is in single precision, since it determines
/// directions, not solutions.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Point<T = f64> {
    /// A and B.
    pub label: [T; 2],
    pub deformation: [T; 4],
    /// S.
    pub stress: [T; 3],
    /// G.
    pub metric: [T; 3],
    /// μ or c.
    pub modulus: T,
    /// σ.
    pub pressure: T,
}

/// A branch at a point: its part in the linearised law and the flow rule up to the point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct History<T = f64> {
    /// `√μ_k G_k` or `c_k G_k`: scaled by its modulus, which saves space.
    pub metric: [T; 3],
    /// `1 - e^{-a}`: the fraction by which the branch relaxes from the point before.
    pub relaxed: T,
    /// Weights of the measures at `n-2` to `n+1`.
    pub weights: [T; 4],
    /// Change of the internal measure by that of the distance from the point before, in 1/m.
    pub source: [T; 3],
}

impl Point {
    /// Sets the gradient `(q_s, q_Z, w_s, w_Z)`; returns the strain `C - 1`, which keeps the
    /// digits of small strains.
    #[inline]
    pub fn deform(&mut self, gradient: &Tensor) -> Result<Symmetric, Inverted> {
        let [q_s, q_z, w_s, w_z] = *gradient;
        let (a, height) = (1.0 - q_s, 1.0 + w_z);
        if !(a > LEAST && height > LEAST) {
            return Err(Inverted);
        }
        let h = [q_s / a, q_z / a, w_s / a, w_z + w_s * q_z / a];
        self.label = [a, -q_z];
        self.deformation = [1.0 + h[0], h[1], h[2], 1.0 + h[3]];
        Ok(green_strain(&h))
    }

    /// det F.
    #[inline]
    pub fn volume(&self) -> f64 {
        let f = &self.deformation;
        f[0] * f[3] - f[1] * f[2]
    }
}

impl<T: Scalar> Point<T> {
    /// Change of the deformation gradient by that of the gradient `(q_s, q_Z, w_s, w_Z)`.
    #[inline]
    pub fn deformation_change(&self, gradient: &[T; 4]) -> [T; 4] {
        let [_, b] = self.label;
        let f = &self.deformation;
        let [q_s, q_z, w_s, w_z] = *gradient;
        // 1/A is the first component of F.
        let along = [f[0] * q_s * f[0], (w_s + f[2] * q_s) * f[0]];
        [along[0], f[0] * q_z - along[0] * b, along[1], w_z + f[2] * q_z - along[1] * b]
    }

    /// Change of C by that of the deformation gradient.
    #[inline]
    pub fn strain_change(&self, df: &[T; 4]) -> [T; 3] {
        strain_change(&self.deformation, df)
    }

    /// Change of the stress with the measure at the point if no branch relaxed.
    #[inline]
    pub fn own_stress(&self, volumetric: bool, measure: &[T; 3]) -> [T; 3] {
        let congruent = sandwich(&self.metric, measure);
        if volumetric {
            let pressure = self.modulus * contract(&self.metric, measure);
            [0, 1, 2].map(|i| pressure * self.metric[i] - self.pressure * congruent[i])
        } else {
            congruent.map(|s| self.modulus * s)
        }
    }

    /// `P = F S` in xX, xZ, zX, zZ.
    #[inline]
    pub fn first_stress(f: &[T; 4], s: &[T; 3]) -> [T; 4] {
        [
            f[0] * s[0] + f[1] * s[2],
            f[0] * s[2] + f[1] * s[1],
            f[2] * s[0] + f[3] * s[2],
            f[2] * s[2] + f[3] * s[1],
        ]
    }
}

impl<T: Lanes> Point<T> {
    pub fn lane(&self, at: usize) -> Point {
        Point {
            label: lane(&self.label, at),
            deformation: lane(&self.deformation, at),
            stress: lane(&self.stress, at),
            metric: lane(&self.metric, at),
            modulus: self.modulus.lane(at),
            pressure: self.pressure.lane(at),
        }
    }

    pub fn set_lane(&mut self, at: usize, point: &Point) {
        set_lane(&mut self.label, at, &point.label);
        set_lane(&mut self.deformation, at, &point.deformation);
        set_lane(&mut self.stress, at, &point.stress);
        set_lane(&mut self.metric, at, &point.metric);
        self.modulus.set_lane(at, point.modulus);
        self.pressure.set_lane(at, point.pressure);
    }
}

impl<T: Scalar> History<T> {
    /// What the measures at `n-2` to `n+1` and the distance from the point before, which is shorter
    /// by `shift`, add to the internal measure.
    #[inline]
    pub fn input(&self, measures: &[[T; 3]; 4], shift: T) -> [T; 3] {
        let ([w0, w1, w2, w3], [m0, m1, m2, m3]) = (&self.weights, measures);
        let of = |i: usize| {
            let measured = (*w0 * m0[i] + *w1 * m1[i]) + (*w2 * m2[i] + *w3 * m3[i]);
            measured - self.source[i] * shift
        };
        // An array's `map` does not inline this.
        [of(0), of(1), of(2)]
    }

    /// The internal measure after that of the point before.
    #[inline]
    pub fn step(&self, before: &[T; 3], input: &[T; 3]) -> [T; 3] {
        [0, 1, 2].map(|i| before[i] + (input[i] - self.relaxed * before[i]))
    }

    /// The stress that a change of the internal measure takes away.
    #[inline]
    pub fn relief(&self, volumetric: bool, point: &Point<T>, change: &[T; 3]) -> [T; 3] {
        if volumetric {
            let pressure = contract(&self.metric, change);
            point.metric.map(|g| pressure * g)
        } else {
            sandwich(&self.metric, change)
        }
    }
}

impl<T: Lanes> History<T> {
    pub fn lane(&self, at: usize) -> History {
        History {
            metric: lane(&self.metric, at),
            relaxed: self.relaxed.lane(at),
            weights: lane(&self.weights, at),
            source: lane(&self.source, at),
        }
    }

    pub fn set_lane(&mut self, at: usize, history: &History) {
        set_lane(&mut self.metric, at, &history.metric);
        self.relaxed.set_lane(at, history.relaxed);
        set_lane(&mut self.weights, at, &history.weights);
        set_lane(&mut self.source, at, &history.source);
    }
}

/// The law of the shear or of the volumetric part at a measure; the sum over springs is in `stress`.
pub(super) struct Law<'a> {
    pub rubber: &'a FiniteStrainRubber,
    pub volumetric: bool,
}

impl Law<'_> {
    /// Stress and coefficients of the equilibrium spring, with its hardening.
    #[inline]
    pub fn equilibrium(
        &self,
        point: &mut Point,
        measure: &Symmetric,
    ) -> Result<(Symmetric, Option<Hardening>), Inverted> {
        let spring = &self.rubber.equilibrium;
        let (metric, volume) = self.rubber.rheology.metric(measure).ok_or(Inverted)?;
        let tensors = [measure, &[0.0; 3], measure];
        let hardening = self.hardening(tensors);
        point.metric = metric;
        point.modulus = self.modulus(spring, volume, hardening.as_ref());
        point.pressure = self.pressure(spring, volume);
        Ok((self.stress(spring, tensors), hardening))
    }

    /// Adds stress and coefficients of a branch with the internal measure `internal` and its difference to
    /// the measure; returns its hardening.
    #[inline]
    pub fn branch(
        &self,
        spring: &Spring,
        point: &mut Point,
        history: &mut History,
        tensors: [&Symmetric; 3],
        stress: &mut Symmetric,
    ) -> Result<Option<Hardening>, Inverted> {
        let [measure, internal, _] = tensors;
        let rheology = self.rubber.rheology;
        let (metric, past) = rheology.metric(internal).ok_or(Inverted)?;
        let volume = rheology.volume(measure) / past;
        let hardening = self.hardening(tensors);
        let modulus = self.modulus(spring, volume, hardening.as_ref());
        let factor = if self.volumetric {
            modulus
        } else {
            if modulus < 0.0 {
                // The metric occurs twice in a relief, so the sign goes to the history.
                history.weights = history.weights.map(|weight| -weight);
                history.source = history.source.map(|source| -source);
            }
            modulus.abs().sqrt()
        };
        history.metric = metric.map(|g| factor * g);
        point.modulus += modulus;
        point.pressure += self.pressure(spring, volume);
        let part = self.stress(spring, tensors);
        (0..3).for_each(|i| stress[i] += part[i]);
        Ok(hardening)
    }

    /// What the stiffening of the law adds, if it stiffens and this is its shear part.
    #[inline]
    fn hardening(&self, tensors: [&Symmetric; 3]) -> Option<Hardening> {
        let stiffens = !self.volumetric && self.rubber.rheology.stiffens();
        stiffens.then(|| self.rubber.hardening(tensors))
    }

    fn stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric {
        if self.volumetric {
            self.rubber.volumetric_stress(spring, tensors)
        } else {
            self.rubber.shear_stress(spring, tensors)
        }
    }

    fn modulus(&self, spring: &Spring, volume: f64, hardening: Option<&Hardening>) -> f64 {
        let factor = hardening.map_or(1.0, |hardening| hardening.slope);
        if self.volumetric { 0.5 * spring.volumetric * volume } else { spring.shear * factor }
    }

    fn pressure(&self, spring: &Spring, volume: f64) -> f64 {
        if self.volumetric { 0.5 * spring.volumetric * (volume - 1.0) } else { 0.0 }
    }
}

/// The measure of the law at a point with the stress conjugate to it, where it is not the strain
/// `C - 1` itself.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Conversion {
    pub measure: Measure,
    pub conjugate: Symmetric,
}

impl Conversion {
    /// Change of the second Piola-Kirchhoff stress by those of the conjugate stress and of C.
    #[inline]
    pub fn stress_change(&self, conjugate: &Symmetric, strain: &Symmetric) -> Symmetric {
        self.measure.stress_change(&self.conjugate, conjugate, strain)
    }
}
