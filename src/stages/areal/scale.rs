//! The friction beside which errors are judged where friction vanishes.
//!
//! Friction of a surface is zero by symmetry where the rubber slides along ridges, and next to zero where it hardly loses
//! energy. An error relative to it says nothing then, so that relative errors refer to a least friction:
//!
//! ```text
//! least = max(1e-4, 0.01 h' sin δ)
//! ```
//!
//! with the root mean square gradient h' and the largest sine of the loss angle `sin δ = Im E / |E|` at the frequencies
//! from that of the longest period to that of the shortest wave, whatever the direction of sliding: `h' sin δ` is the order of
//! the friction of a surface of that roughness, from theory and in tables alike.

use crate::contact::refine::LEAST_FRICTION;
use crate::rubber::Viscoelastic;
use crate::surface::PeriodicMap;
use std::f64::consts::TAU;

/// Of the friction that the roughness and the loss of the rubber would give.
const SHARE: f64 = 0.01;
/// Frequencies that are looked at, in equal steps of their logarithm: a branch of a Maxwell model is wider than a decade.
const FREQUENCIES: usize = 33;

/// Friction to which relative errors refer where friction is less, of a surface at a speed in m/s.
pub(crate) fn least_friction(map: &PeriodicMap, rubber: &dyn Viscoelastic, speed: f64) -> f64 {
    let longest = map.periods[0].max(map.periods[1]);
    let (low, high) = ((TAU / longest * speed).ln(), (TAU / map.shortest * speed).ln());
    let loss = |k: usize| {
        let frequency = (low + (high - low) * k as f64 / (FREQUENCIES - 1) as f64).exp();
        let modulus = rubber.reduced_modulus(frequency);
        modulus.im / modulus.norm()
    };
    let largest = (0..FREQUENCIES).map(loss).fold(0.0, f64::max);
    LEAST_FRICTION.max(SHARE * map.roughness().rms_gradient * largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;

    #[test]
    fn the_least_friction_follows_gradient_and_loss() {
        let height = |k: usize| 1e-5 * (TAU * (k % 32) as f64 / 32.0).sin();
        let map = PeriodicMap {
            heights: (0..32 * 32).map(height).collect(),
            points: [32, 32],
            periods: [1e-3; 2],
            shortest: 5e-4,
        };
        let rubber = Rubber::table_2_1();
        let gradient = TAU * 1e-2 / 2.0_f64.sqrt();
        let found = least_friction(&map, &rubber, 0.01);
        let loss = (0..200).map(|k| {
            let modulus = rubber.reduced_modulus(TAU * 10.0 * (1.0 + f64::from(k) / 199.0));
            modulus.im / modulus.norm()
        });
        let expected = SHARE * gradient * loss.fold(0.0, f64::max);
        approx::assert_relative_eq!(found, expected, max_relative = 1e-3);
        // An elastic body has no friction but that of the grid.
        assert_eq!(least_friction(&map, &Rubber::elastic(1e6, 0.49), 0.01), LEAST_FRICTION);
    }
}
