//! Whether storage and loss modulus of a table belong together: the Kramers-Kronig relation.
//!
//! Of a passive linear solid the storage modulus determines the loss modulus. With `u = ln(x/ω)`
//!
//! ```text
//! E''(ω) = (1/π) ∫ [E'(x) - E'(ω)] / sinh u  du = (1/π) ∫ dE'/du  ln coth|u/2|  du
//! ```
//!
//! over all frequencies x. The weight `ln coth|u/2|` has its peak at x = ω and the area π²/2, so that where E' is straight
//! over a decade `E'' ≈ (π/2) dE'/d ln ω` (Booij & Thoone, Rheol. Acta 21, 15, 1982, doi:10.1007/BF01535390). Here the
//! integral itself is taken over the measured range, and the part beyond its ends is bounded: below and above, E' is
//! continued by the power law of its outermost half decade for one limit and kept constant for the other.
//!
//! **What is compared.** The storage modulus of a solid whose relaxation spectrum is positive never falls with frequency. So
//! E' is replaced by the ascending sequence nearest to it (isotonic regression, least squares of ln E'; Barlow et al.,
//! Statistical Inference under Order Restrictions, Wiley 1972): moduli that ascend stay as they are, scatter is averaged.
//! The loss modulus of each point is then compared with the integral.

use super::MeasuredModuli;
use super::fit::SweepPoint;
use crate::numerics::interpolation::CubicHermite;
use serde::Serialize;
use std::f64::consts::{LN_10, PI, TAU};

/// Loss moduli are compared where at most this share of the integral may come from beyond the measured range.
const LARGEST_TRUNCATION: f64 = 0.25;
/// Relative difference of a loss modulus that is named: the integral over scattered moduli is no better.
const TOLERANCE: f64 = 0.3;
/// Root mean square difference above which a table is called acausal as a whole.
const POOR: f64 = 0.2;
/// Points that a warning names.
const NAMED: usize = 5;
/// Steps of the integral in ln ω; halving them changes the integral by less than 1e-3.
const STEP: f64 = 0.05;
/// Terms of a series whose argument is not small.
const TERMS: u32 = 4000;
/// Largest exponent of the power law beyond the measurement; moduli of solids grow by less.
const STEEPEST: f64 = 0.95;

/// The loss modulus of a point beside that which the storage moduli of the table imply.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CausalPoint {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Measured loss modulus in Pa.
    pub loss_modulus: f64,
    /// Loss modulus in Pa by the integral over the measured range: a lower limit.
    pub implied: f64,
    /// What the range beyond may add in Pa, as a power law.
    pub truncated: f64,
    /// Loss modulus in Pa by the local relation `(π/2) dE'/d ln ω`.
    pub local: f64,
}

impl CausalPoint {
    /// Measured loss modulus over the nearest one that is allowed, less one: zero between the integral over the measured
    /// range and that with the power laws beyond.
    pub fn excess(&self) -> f64 {
        let most = self.implied + self.truncated;
        self.loss_modulus / self.loss_modulus.clamp(self.implied, most) - 1.0
    }

    /// Share of the integral that may come from beyond the measured range.
    pub fn truncation(&self) -> f64 {
        self.truncated / (self.implied + self.truncated)
    }

    /// Whether enough of the integral is measured to judge the loss modulus.
    pub fn is_judged(&self) -> bool {
        self.truncation() <= LARGEST_TRUNCATION
    }
}

/// Storage and loss modulus of a table held against each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Causality {
    /// All points of the table by ascending frequency.
    pub points: Vec<CausalPoint>,
    /// How often the storage modulus falls from one point to the next, which it cannot but for scatter.
    pub falls: usize,
    /// The largest of these falls, relative.
    pub largest_fall: f64,
}

impl Causality {
    /// Checks a table.
    pub fn of(table: &MeasuredModuli) -> Self {
        Self::of_points(table.points())
    }

    fn of_points(points: &[SweepPoint]) -> Self {
        let falls = points.windows(2).map(|w| 1.0 - w[1].storage_modulus / w[0].storage_modulus);
        let falls: Vec<f64> = falls.filter(|fall| *fall > 0.0).collect();
        let storage = Storage::new(points);
        let judged = points.iter().map(|point| {
            let [implied, truncated] = storage.implied_loss(point.angular_frequency.ln());
            CausalPoint {
                frequency_hz: point.angular_frequency / TAU,
                loss_modulus: point.loss_modulus,
                implied,
                truncated,
                local: 0.5 * PI * storage.slope(point.angular_frequency.ln()),
            }
        });
        Self {
            points: judged.collect(),
            falls: falls.len(),
            largest_fall: falls.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The points of which enough of the integral is measured.
    pub fn judged(&self) -> impl Iterator<Item = &CausalPoint> {
        self.points.iter().filter(|point| point.is_judged())
    }

    /// Root mean square of [`CausalPoint::excess`] over the judged points; `None` if there is none.
    pub fn rms(&self) -> Option<f64> {
        let squares: Vec<f64> = self.judged().map(|point| point.excess().powi(2)).collect();
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    }

    /// The judged points whose loss modulus is more than 30 % off, the worst first.
    pub fn violations(&self) -> Vec<CausalPoint> {
        let mut found: Vec<CausalPoint> =
            self.judged().filter(|point| point.excess().abs() > TOLERANCE).copied().collect();
        found.sort_by(|a, b| b.excess().abs().total_cmp(&a.excess().abs()));
        found
    }

    /// The check in one sentence.
    pub fn summary(&self) -> String {
        let (judged, all) = (self.judged().count(), self.points.len());
        let Some(rms) = self.rms() else {
            return format!(
                "Kramers-Kronig: none of {all} points can be judged, more than {:.0} % of each integral may lie beyond the \
                 measured frequencies",
                100.0 * LARGEST_TRUNCATION
            );
        };
        let violations = self.violations();
        let named: Vec<String> = violations.iter().take(NAMED).map(named).collect();
        let more = violations.len().saturating_sub(NAMED);
        format!(
            "Kramers-Kronig: loss moduli differ from those that the storage moduli imply by {:.1} % (root mean square of \
             {judged} of {all} points), by more than {:.0} % at {}{}{}",
            100.0 * rms,
            100.0 * TOLERANCE,
            violations.len(),
            if named.is_empty() { String::new() } else { format!(": {}", named.join(", ")) },
            if more > 0 { format!(" and {more} more") } else { String::new() },
        )
    }

    /// A warning where the table is not causal, for the rubber of a name.
    pub fn warning(&self, rubber: &str) -> Option<String> {
        let poor = self.rms().is_some_and(|rms| rms > POOR);
        (poor || !self.violations().is_empty())
            .then(|| format!("rubber {rubber}: {}; check these rows", self.summary()))
    }
}

fn named(point: &CausalPoint) -> String {
    format!("{:.3e} Hz ({:+.0} %)", point.frequency_hz, 100.0 * point.excess())
}

/// The storage modulus as an ascending curve over ln ω.
struct Storage {
    /// ln ω from the lowest to the highest frequency in small steps.
    at: Vec<f64>,
    /// Storage modulus there in Pa.
    modulus: Vec<f64>,
    /// Exponents of the power laws below and above.
    exponents: [f64; 2],
}

impl Storage {
    fn new(points: &[SweepPoint]) -> Self {
        let (x, y) = ascending(points);
        let ends = [points[0], points[points.len() - 1]].map(|p| p.angular_frequency.ln());
        let curve = CubicHermite::monotone_parabolas(x, y);
        let steps = ((ends[1] - ends[0]) / STEP).ceil().max(1.0) as usize;
        let at = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / steps as f64;
        let at: Vec<f64> = (0..=steps).map(at).collect();
        let half_decade = (0.5 * LN_10).min(ends[1] - ends[0]);
        let slope = |from: f64| (curve.at(from + half_decade) - curve.at(from)) / half_decade;
        let exponents = [slope(ends[0]), slope(ends[1] - half_decade)].map(|s| s.min(STEEPEST));
        let modulus = at.iter().map(|at| curve.at(*at).exp()).collect();
        Self { at, modulus, exponents }
    }

    /// `dE'/d ln ω` in Pa over a third of a decade.
    fn slope(&self, ln_frequency: f64) -> f64 {
        let half = LN_10 / 6.0;
        let [low, high] = [ln_frequency - half, ln_frequency + half]
            .map(|at| at.clamp(self.at[0], self.at[self.at.len() - 1]));
        (self.modulus_at(high) - self.modulus_at(low)) / (high - low)
    }

    fn modulus_at(&self, ln_frequency: f64) -> f64 {
        let last = self.at.len() - 1;
        let step = self.at[1] - self.at[0];
        let place = ((ln_frequency - self.at[0]) / step).clamp(0.0, last as f64);
        let below = (place.floor() as usize).min(last - 1);
        let part = place - below as f64;
        (1.0 - part) * self.modulus[below] + part * self.modulus[below + 1]
    }

    /// Loss modulus in Pa by the measured range, and what power laws beyond it add.
    fn implied_loss(&self, ln_frequency: f64) -> [f64; 2] {
        let area: Vec<f64> = self
            .at
            .iter()
            .map(|at| (at - ln_frequency).signum() * weight_area((at - ln_frequency).abs()))
            .collect();
        let step = self.at[1] - self.at[0];
        let pieces = self.modulus.windows(2).zip(area.windows(2));
        let within: f64 = pieces
            .map(|(modulus, area)| (modulus[1] - modulus[0]) / step * (area[1] - area[0]))
            .sum();
        let last = self.at.len() - 1;
        let below = tail(ln_frequency - self.at[0], -self.exponents[0]) * self.modulus[0];
        let above = tail(self.at[last] - ln_frequency, self.exponents[1]) * self.modulus[last];
        [within / PI, (below + above) / PI]
    }
}

/// Points of an ascending sequence nearest to `ln E'` over `ln ω`, each block of equal values at its mean frequency: pool
/// adjacent violators.
fn ascending(points: &[SweepPoint]) -> (Vec<f64>, Vec<f64>) {
    let mut blocks: Vec<(f64, f64, f64)> = Vec::new();
    for point in points {
        blocks.push((1.0, point.angular_frequency.ln(), point.storage_modulus.ln()));
        while let [.., before, last] = blocks[..]
            && before.2 >= last.2
        {
            let count = before.0 + last.0;
            let mean = |a: f64, b: f64| (before.0 * a + last.0 * b) / count;
            blocks.pop();
            blocks.pop();
            blocks.push((count, mean(before.1, last.1), mean(before.2, last.2)));
        }
    }
    blocks.into_iter().map(|(_, x, y)| (x, y)).unzip()
}

/// `∫_0^u ln coth(v/2) dv` for u ≥ 0; π²/4 at infinity. By powers of v for small u, otherwise by
/// `ln coth(v/2) = 2 Σ e^{-kv}/k` over odd k.
fn weight_area(u: f64) -> f64 {
    if u == 0.0 {
        return 0.0;
    }
    if u < 0.3 {
        return u * (1.0 - (0.5 * u).ln()) + u.powi(3) / 36.0 - 7.0 * u.powi(5) / 7200.0
            + 31.0 * u.powi(7) / 635_040.0;
    }
    let mut rest = 0.0;
    for k in (1..TERMS).step_by(2).map(f64::from) {
        let term = (-k * u).exp() / (k * k);
        rest += term;
        if term < 1e-16 {
            break;
        }
    }
    0.25 * PI * PI - 2.0 * rest
}

/// `∫_0^∞ |s| e^{s v} ln coth((v + d)/2) dv` of a modulus of 1 that is continued by the exponent s: `2 |s| Σ e^{-kd}/(k (k -
/// s))` over odd k.
fn tail(distance: f64, exponent: f64) -> f64 {
    let mut sum = 0.0;
    for k in (1..TERMS).step_by(2).map(f64::from) {
        let term = (-k * distance).exp() / (k * (k - exponent));
        sum += term;
        if term < 1e-9 {
            break;
        }
    }
    2.0 * exponent.abs() * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};

    fn sampled(rubber: &Rubber, per_decade: i32, decades: i32) -> Vec<SweepPoint> {
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / f64::from(per_decade));
            let modulus = rubber.complex_modulus(angular_frequency);
            SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
        };
        (0..=per_decade * decades).map(point).collect()
    }

    #[test]
    fn the_area_of_the_weight_is_that_by_quadrature() {
        assert_eq!(weight_area(0.0), 0.0);
        // Both forms at the change between them, and the limit.
        for u in [0.1, 0.2999999, 0.3, 1.0, 5.0] {
            let n = 200_000;
            // v = u s^2 takes the logarithm out of the corner.
            let sum: f64 = (0..n)
                .map(|k| (f64::from(k) + 0.5) / f64::from(n))
                .map(|s| -2.0 * u * s * (0.5 * u * s * s).tanh().ln() / f64::from(n))
                .sum();
            approx::assert_relative_eq!(weight_area(u), sum, max_relative = 1e-8);
        }
        approx::assert_relative_eq!(weight_area(60.0), 0.25 * PI * PI, max_relative = 1e-14);
    }

    #[test]
    fn the_table_of_a_maxwell_model_is_causal() {
        // Ten points a decade: the cubic between them is some 1e-3 off where one branch alone relaxes.
        let found = Causality::of_points(&sampled(&Rubber::table_2_1(), 10, 12));
        assert_eq!((found.falls, found.violations().len()), (0, 0));
        assert!(found.judged().count() > 90, "{}", found.judged().count());
        let rms = found.rms().unwrap();
        assert!(rms < 0.005, "{rms}");
        assert_eq!(found.warning("x"), None);
        // Three points a decade are no reason to warn.
        let coarse = Causality::of_points(&sampled(&Rubber::table_2_1(), 3, 12));
        assert_eq!(coarse.warning("x"), None, "{}", coarse.summary());
    }

    #[test]
    fn a_power_law_is_met_where_the_range_is_long_and_its_truncation_is_stated() {
        // E = (iω)^n: E''/E' = tan(nπ/2) at all frequencies.
        let n = 0.3_f64;
        let (sine, cosine) = (0.5 * n * PI).sin_cos();
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
            let modulus = 1e6 * angular_frequency.powf(n);
            SweepPoint {
                angular_frequency,
                storage_modulus: modulus * cosine,
                loss_modulus: modulus * sine,
            }
        };
        let points: Vec<SweepPoint> = (0..=32).map(point).collect();
        for point in Causality::of_points(&points).points {
            // With the continuation by power laws the integral is exact up to its steps, 0.05² n²/24 and an edge.
            let whole = point.implied + point.truncated;
            approx::assert_relative_eq!(whole, point.loss_modulus, max_relative = 2e-3);
            assert!(point.excess().abs() < 2e-3, "{point:?}");
        }
        let middle = Causality::of_points(&points).points[16];
        // (π/2) n against tan(nπ/2): the local relation is 8 % off for n = 0.3.
        approx::assert_relative_eq!(
            middle.local / middle.loss_modulus,
            0.5 * n * PI / (sine / cosine),
            max_relative = 5e-3
        );
        assert!(
            middle.truncation() < 0.06
                && Causality::of_points(&points).points[0].truncation() > 0.3
        );
    }

    #[test]
    fn loss_moduli_in_another_order_and_outliers_are_caught() {
        let good = sampled(&Rubber::table_2_1(), 4, 12);
        let mut turned = good.clone();
        for (point, other) in turned.iter_mut().zip(good.iter().rev()) {
            point.loss_modulus = other.loss_modulus;
        }
        let found = Causality::of_points(&turned);
        assert!(
            found.warning("x").is_some() && found.violations().len() > 10,
            "{}",
            found.summary()
        );
        let mut outlier = good;
        outlier[20].loss_modulus *= 0.4;
        let found = Causality::of_points(&outlier);
        let violations = found.violations();
        assert_eq!(violations.len(), 1, "{}", found.summary());
        approx::assert_relative_eq!(violations[0].frequency_hz, 1e5 / TAU, max_relative = 1e-12);
        // 60 % less, by an integral that is a few per cent off.
        approx::assert_relative_eq!(violations[0].excess(), -0.6, epsilon = 0.03);
        assert!(found.warning("tread").unwrap().contains("rubber tread: Kramers-Kronig"));
    }

    #[test]
    fn scatter_of_the_storage_modulus_is_averaged() {
        // A broad spectrum whose storage modulus grows by less from point to point than it scatters.
        let branch = |k: i32| MaxwellBranch { modulus: 3e5, relaxation_time: 10_f64.powi(-k) };
        let rubber =
            Rubber { branches: (-2..12).map(branch).collect(), ..Rubber::elastic(4e6, 0.5) };
        let mut points = sampled(&rubber, 8, 10);
        for (k, point) in points.iter_mut().enumerate() {
            point.storage_modulus *= 1.0 + 0.03 * (k as f64 * 2.4).sin();
        }
        let found = Causality::of_points(&points);
        assert!(found.falls > 20 && found.largest_fall > 0.02, "{found:?}");
        assert!(found.rms().unwrap() < 0.3, "{}", found.summary());
    }
}
