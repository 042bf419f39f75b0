//! The integrals over the wavenumber.

use super::angle::AngularMeans;
use super::diffusion::{Contact, KNEE};
use crate::surface::spectrum::IsotropicSpectrum;
use std::f64::consts::{FRAC_PI_2, PI};

/// Gauss' rule of three points on [0, 1], the basis of the collocation method of sixth order (Butcher, Math. Comp. 18, 50,
/// 1964, doi:10.1090/S0025-5718-1964-0159424-9).
const PLACES: [f64; 3] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];
const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
/// `INNER[i][j]`: weight of point j in the integral from 0 to point i.
const INNER: [[f64; 3]; 3] = [
    [5.0 / 36.0, -0.035_976_667_524_938_9, 0.009_789_444_015_308_326],
    [0.300_263_194_980_864_6, 2.0 / 9.0, -0.022_485_417_203_086_815],
    [0.267_988_333_762_469_45, 0.480_421_111_969_383_35, 5.0 / 36.0],
];
/// Widest panel of the coarsest level in `ln q`, and in `ln V` where contact falls; halved from level to level.
const WIDEST: f64 = 0.5;
/// Step of the angular means on the coarsest level, where a Maxwell model has ten digits, and what it is multiplied by from
/// level to level: measured moduli have corners, whose error falls with a power of the step.
const ANGULAR_STEP: f64 = 0.4;
const ANGULAR_REFINEMENT: f64 = 0.75;

/// What is integrated.
pub(super) struct Integrand<'a> {
    pub spectrum: &'a IsotropicSpectrum,
    pub contact: &'a Contact,
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Angular means at a wavenumber in rad/m, by a step.
    pub means: &'a dyn Fn(f64, f64) -> AngularMeans,
}

/// Integrals from the longest wave to a wavenumber.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sums {
    /// Variance of the pressure of full contact in Pa².
    pub variance: f64,
    /// The part of it at frequencies that were not measured.
    pub unmeasured_variance: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// The part of it at frequencies that were not measured.
    pub unmeasured_friction: f64,
    /// Friction coefficient of full contact.
    pub full_friction: f64,
    /// Mean gap in m.
    pub gap: f64,
}

/// The integrand at a wavenumber, over `ln q`.
#[derive(Clone, Copy, Default)]
struct Node {
    /// Of the variance.
    variance: f64,
    unmeasured_variance: f64,
    /// Of the friction of full contact.
    friction: f64,
    unmeasured_friction: f64,
    /// Of the gap but for `V^(-1/2) K`.
    gap: f64,
}

impl Integrand<'_> {
    /// The integrals from the first of some ascending wavenumbers in rad/m to each of the others, on a level of refinement.
    pub(super) fn sums(&self, marks: &[f64], level: i32) -> Vec<Sums> {
        let mut sums = Sums::default();
        let mut found = Vec::with_capacity(marks.len());
        let knots = self.spectrum.wavenumbers();
        for pair in marks.windows(2) {
            let inside = knots.iter().copied().filter(|q| pair[0] < *q && *q < pair[1]);
            let ends: Vec<f64> = [pair[0]].into_iter().chain(inside).chain([pair[1]]).collect();
            for ends in ends.windows(2) {
                self.add_segment([ends[0].ln(), ends[1].ln()], level, &mut sums);
            }
            found.push(sums);
        }
        found
    }

    /// Adds a segment in `ln q` without a corner.
    fn add_segment(&self, [start, end]: [f64; 2], level: i32, sums: &mut Sums) {
        let widest = WIDEST * 0.5_f64.powi(level);
        // Every level halves the panels, also of segments that are narrower than the widest.
        let panels = ((end - start) / WIDEST).ceil().max(1.0) as usize * (1 << level);
        let width = (end - start) / panels as f64;
        for panel in 0..panels {
            let from = start + panel as f64 * width;
            // A stack of halves, the nearest last: only a rise of the variance from next to nothing is halved often.
            let mut stack = vec![(from, width)];
            while let Some((from, width)) = stack.pop() {
                let nodes = PLACES.map(|place| self.node((from + place * width).exp(), level));
                let rise = width * weighted(&WEIGHTS, &nodes, |node| node.variance);
                let still = (KNEE * self.pressure).powi(2);
                let (before, after) = (sums.variance, sums.variance + rise);
                let grows = after > still && (after / before.max(still)).ln() > widest;
                // Halves that round-off no longer tells apart stay.
                let divisible = width > 1e-14 * from.abs().max(1.0);
                if grows && divisible {
                    stack.push((from + width / 2.0, width / 2.0));
                    stack.push((from, width / 2.0));
                } else {
                    self.add_panel(&nodes, width, sums);
                }
            }
        }
    }

    fn add_panel(&self, nodes: &[Node; 3], width: f64, sums: &mut Sums) {
        for ((node, weight), inner) in nodes.iter().zip(WEIGHTS).zip(&INNER) {
            let share = width * weight;
            let variance = sums.variance + width * weighted(inner, nodes, |node| node.variance);
            let pressure = variance.max(0.0).sqrt();
            let contact = self.contact.at(pressure / self.pressure);
            sums.full_friction += share * node.friction;
            sums.friction += share * node.friction * contact.strain;
            sums.unmeasured_friction += share * node.unmeasured_friction * contact.strain;
            if contact.gap > 0.0 {
                sums.gap += share * node.gap * contact.gap / pressure;
            }
        }
        sums.variance += width * weighted(&WEIGHTS, nodes, |node| node.variance);
        sums.unmeasured_variance +=
            width * weighted(&WEIGHTS, nodes, |node| node.unmeasured_variance);
    }

    fn node(&self, wavenumber: f64, level: i32) -> Node {
        let means = (self.means)(wavenumber, ANGULAR_STEP * ANGULAR_REFINEMENT.powi(level));
        let density = self.spectrum.density(wavenumber);
        let slope = wavenumber.powi(4) * density;
        Node {
            variance: FRAC_PI_2 * slope * means.square,
            unmeasured_variance: FRAC_PI_2 * slope * means.unmeasured_square,
            friction: PI * slope * means.loss / self.pressure,
            unmeasured_friction: PI * slope * means.unmeasured_loss / self.pressure,
            gap: FRAC_PI_2 * wavenumber.powi(3) * density * means.square.sqrt(),
        }
    }
}

fn weighted(weights: &[f64; 3], nodes: &[Node; 3], of: fn(&Node) -> f64) -> f64 {
    weights.iter().zip(nodes).map(|(weight, node)| weight * of(node)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_gauss_collocation() {
        // It integrates 1, x and x² exactly from 0 to each of its points and to 1.
        for power in 0..3 {
            let values = PLACES.map(|x| x.powi(power));
            let sum = |weights: &[f64; 3]| -> f64 {
                weights.iter().zip(values).map(|(w, v)| w * v).sum()
            };
            let exact = |x: f64| x.powi(power + 1) / f64::from(power + 1);
            for (row, place) in INNER.iter().zip(PLACES) {
                approx::assert_abs_diff_eq!(sum(row), exact(place), epsilon = 1e-15);
            }
            approx::assert_abs_diff_eq!(sum(&WEIGHTS), exact(1.0), epsilon = 1e-15);
        }
    }
}
