//! How the pressure spreads, and with it the share of the area that is left in contact.
//!
//! All follows from one number, `r = sqrt(V) / p`: the root mean square pressure of full contact over the mean pressure.

use statrs::function::erf::erf;
use std::f64::consts::{SQRT_2, TAU};

/// What the diffusion of the pressure takes for the stress of the waves in partial contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Diffusion {
    /// That of full contact (Persson, J. Chem. Phys. 115, 3840, 2001, doi:10.1063/1.1388626): γ reduces friction alone.
    #[default]
    Full,
    /// Reduced by `S = γ + (1 - γ) P²` as the strain is (Yang & Persson, J. Phys.: Condens. Matter 20, 215214, 2008,
    /// doi:10.1088/0953-8984/20/21/215214): γ reduces friction and the spread of the pressure, so the area is larger.
    Reduced,
}

/// `erf(x)` differs from 1 by less than round-off beyond: up to here all is in contact.
const SATURATION: f64 = 6.0;
/// `r` up to which `P` is 1 to round-off.
pub(super) const KNEE: f64 = 1.0 / (SATURATION * SQRT_2);
/// Largest `r` of the table: a mean pressure of a billionth of the pressures of full contact is none.
pub(super) const LARGEST: f64 = 1e9;
/// Step of the table in `ln r`: 4th-order rules then have eleven digits.
const STEP: f64 = 1.0 / 128.0;

/// Contact over `r`, from `dg/d(r²) = S(P)`, `P = erf(1 / sqrt(2 g))` with `g(0) = 0`: `p² g` is the variance of the
/// pressure. [`Diffusion::Full`] has `S = 1` here, `g = r²`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contact {
    gamma: f64,
    diffusion: Diffusion,
    /// `ln g` and `K` at `ln KNEE + k STEP`.
    table: Vec<[f64; 2]>,
}

/// The contact at one `r`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct At {
    /// Share `P` of the area in contact.
    pub area: f64,
    /// `W = S P`: what is left of the strain of full contact.
    pub strain: f64,
    /// `K = ∫_0^r (W(r') - W(r)) dr'`: the mean gap is `π/2 ∫ q² C M V^(-1/2) K dq`.
    pub gap: f64,
}

impl Contact {
    pub(super) fn new(gamma: f64, diffusion: Diffusion) -> Self {
        let mut contact = Self { gamma, diffusion, table: Vec::new() };
        let steps = ((LARGEST / KNEE).ln() / STEP).ceil() as usize;
        let (mut ln_g, mut gap) = (2.0 * KNEE.ln(), 0.0);
        for k in 0..=steps {
            contact.table.push([ln_g, gap]);
            let ln_r = KNEE.ln() + k as f64 * STEP;
            let next = contact.runge_kutta(ln_r, ln_g, STEP);
            gap += contact.rise_of_gap(ln_r, STEP, [ln_g, next]);
            ln_g = next;
        }
        contact
    }

    /// The contact at an `r` of up to [`LARGEST`].
    pub(super) fn at(&self, r: f64) -> At {
        if r <= KNEE {
            return At { area: 1.0, strain: 1.0, gap: 0.0 };
        }
        let place = (r.min(LARGEST) / KNEE).ln() / STEP;
        let k = (place as usize).min(self.table.len() - 2);
        let (ln_r, step) = (KNEE.ln() + k as f64 * STEP, (place - k as f64) * STEP);
        let ends = [self.table[k][0], self.table[k + 1][0]];
        let ln_g = self.between(ln_r, ends, step);
        let gap = self.table[k][1] + self.rise_of_gap(ln_r, step, [ends[0], ln_g]);
        let area = area_of(ln_g.exp());
        At { area, strain: area * self.reduction(area), gap }
    }

    /// `S`, the strain in contact over that of full contact.
    fn reduction(&self, area: f64) -> f64 {
        self.gamma + (1.0 - self.gamma) * area * area
    }

    /// What the diffusion takes for it.
    fn spread(&self, area: f64) -> f64 {
        match self.diffusion {
            Diffusion::Full => 1.0,
            Diffusion::Reduced => self.reduction(area),
        }
    }

    /// `d ln g / d ln r`.
    fn slope(&self, ln_r: f64, ln_g: f64) -> f64 {
        2.0 * (2.0 * ln_r - ln_g).exp() * self.spread(area_of(ln_g.exp()))
    }

    fn runge_kutta(&self, ln_r: f64, ln_g: f64, step: f64) -> f64 {
        let middle = ln_r + step / 2.0;
        let first = self.slope(ln_r, ln_g);
        let second = self.slope(middle, ln_g + step / 2.0 * first);
        let third = self.slope(middle, ln_g + step / 2.0 * second);
        let fourth = self.slope(ln_r + step, ln_g + step * third);
        ln_g + step / 6.0 * (first + 2.0 * (second + third) + fourth)
    }

    /// `ln g` at `step` beyond an entry of the table, cubic with the slopes at both ends.
    fn between(&self, ln_r: f64, ends: [f64; 2], step: f64) -> f64 {
        let t = step / STEP;
        let slopes = [self.slope(ln_r, ends[0]), self.slope(ln_r + STEP, ends[1])];
        let rise = ends[1] - ends[0];
        let bend = (1.0 - t) * (STEP * slopes[0] - rise) + t * (rise - STEP * slopes[1]);
        ends[0] + t * rise + t * (1.0 - t) * bend
    }

    /// `dK / d ln r = -r dW / d ln r`.
    fn slope_of_gap(&self, ln_r: f64, ln_g: f64) -> f64 {
        let g = ln_g.exp();
        let area = area_of(g);
        // dP/dg = -exp(-1/(2g)) / sqrt(2 π g³).
        let fall = (-0.5 / g).exp() / (TAU * g).sqrt() * self.slope(ln_r, ln_g);
        ln_r.exp() * (self.gamma + 3.0 * (1.0 - self.gamma) * area * area) * fall
    }

    /// What `K` grows by over a step that begins and ends at the given `ln g`: the rule of three points, all of them
    /// positive, so that small gaps keep their digits.
    fn rise_of_gap(&self, ln_r: f64, step: f64, ends: [f64; 2]) -> f64 {
        let middle = self.runge_kutta(ln_r, ends[0], step / 2.0);
        let at = |share: f64, ln_g: f64| self.slope_of_gap(ln_r + share * step, ln_g);
        step / 6.0 * (at(0.0, ends[0]) + 4.0 * at(0.5, middle) + at(1.0, ends[1]))
    }
}

/// `P` at the variance `g` of the pressure over the mean pressure squared.
fn area_of(g: f64) -> f64 {
    erf(1.0 / (2.0 * g).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_full_diffusion_is_the_closed_form() {
        let contact = Contact::new(0.5, Diffusion::Full);
        for k in 0..165 {
            let r = 0.05 * 1.15_f64.powi(k);
            let area = erf(1.0 / (SQRT_2 * r));
            approx::assert_relative_eq!(contact.at(r).area, area, max_relative = 1e-11);
        }
    }

    /// By the exponential integral: without a reduction of strain `K = E_1(1 / (2 r²)) / sqrt(2 π)`.
    #[test]
    fn the_gap_without_reduction_is_the_exponential_integral() {
        let contact = Contact::new(1.0, Diffusion::Full);
        for (x, integral) in [
            // E_1 of Abramowitz & Stegun, tables 5.1 and 5.2, and of (5.1.11) below 1e-4.
            (10.0, 4.156_968_929_685_324e-6),
            (1.0, 0.219_383_934_395_520_3),
            (0.1, 1.822_923_958_419_390_7),
            (1e-10, 22.448_635_265_138_922),
        ] {
            let r = (0.5_f64 / x).sqrt();
            let expected = integral / (2.0 * PI).sqrt();
            // Simpson's rule over a step of ln r, in which exp(-1/(2 r²)) grows by STEP / r² in its logarithm.
            let tolerance = 1e-9 + (STEP / (r * r)).powi(4) / 2880.0;
            approx::assert_relative_eq!(contact.at(r).gap, expected, max_relative = tolerance);
        }
    }

    #[test]
    fn the_reduced_diffusion_solves_its_equation() {
        for gamma in [0.0, 0.45, 0.5, 1.0] {
            let contact = Contact::new(gamma, Diffusion::Reduced);
            for r in [0.2, 0.7, 2.0, 11.3, 400.7, 3e4] {
                let g = |r: f64| {
                    let place = (r / KNEE).ln() / STEP;
                    let k = place as usize;
                    let ends = [contact.table[k][0], contact.table[k + 1][0]];
                    let ln_r = KNEE.ln() + k as f64 * STEP;
                    contact.between(ln_r, ends, (place - k as f64) * STEP).exp()
                };
                // Central differences over 1e-3 of r: 1e-6 of the third derivative.
                let (low, high) = (0.999 * r, 1.001 * r);
                let slope = (g(high) - g(low)) / (high * high - low * low);
                let expected = contact.reduction(contact.at(r).area);
                approx::assert_relative_eq!(slope, expected, max_relative = 1e-5);
            }
        }
        // Without a reduction of strain both are one.
        let [full, reduced] =
            [Diffusion::Full, Diffusion::Reduced].map(|d| Contact::new(1.0, d).at(2.0));
        approx::assert_relative_eq!(full.area, reduced.area, max_relative = 1e-12);
    }

    /// With `S = γ` in next to no contact, `g = γ r²`: the area is `1 / sqrt(γ)` times that of the full diffusion.
    #[test]
    fn small_loads_have_the_limits_of_constant_reduction() {
        let r = 1e6;
        for gamma in [0.3, 0.5, 1.0] {
            let reduced = Contact::new(gamma, Diffusion::Reduced);
            let area = (2.0 / (PI * gamma)).sqrt() / r;
            // What full contact adds at first is of the order r^-1 of it.
            approx::assert_relative_eq!(reduced.at(r).area, area, max_relative = 1e-5);
            approx::assert_relative_eq!(reduced.at(r).strain, gamma * area, max_relative = 1e-5);
            // K grows with ln r by γ P r.
            let growth = reduced.at(2.0 * r).gap - reduced.at(r).gap;
            let expected = gamma * area * r * 2.0_f64.ln();
            approx::assert_relative_eq!(growth, expected, max_relative = 1e-5);
        }
    }

    #[test]
    fn the_gap_is_the_area_between_the_strain_and_its_last_value() {
        for diffusion in [Diffusion::Full, Diffusion::Reduced] {
            let contact = Contact::new(0.5, diffusion);
            for end in [0.5_f64, 3.0, 40.0] {
                // The midpoint rule over r itself.
                let count = 200_000;
                let step = end / f64::from(count);
                let strain = |k: i32| contact.at((f64::from(k) + 0.5) * step).strain;
                let sum: f64 = (0..count).map(strain).sum::<f64>() * step;
                let at = contact.at(end);
                approx::assert_relative_eq!(at.gap, sum - end * at.strain, max_relative = 1e-7);
            }
        }
    }
}
