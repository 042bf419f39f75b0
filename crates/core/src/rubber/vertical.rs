//! Vertical shift: how all moduli grow with temperature, beside the shift of the frequency.

use super::ZERO_CELSIUS;
use serde::{Deserialize, Serialize};

/// The factor `b_T` of all moduli at a temperature; 1 at the reference temperature T_r:
/// `E*(ω, T) = b_T E*(a_T ω, T_r)`. tan δ does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VerticalShift {
    /// Entropic elasticity, density times absolute temperature (Ferry, Viscoelastic Properties of
    /// Polymers, 3rd edition, Wiley 1980, chapter 11): `b_T = ρ T / (ρ_r T_r)` with
    /// `ρ_r / ρ = 1 + α (T - T_r)`.
    RhoT {
        /// Volume expansion α in 1/K.
        expansion_per_k: f64,
    },
    /// Fitted factors: `b_T = (T / T_r)^m`. An exponent of 1 is entropic elasticity at constant
    /// density.
    Power {
        /// The exponent m.
        exponent: f64,
    },
}

impl VerticalShift {
    /// `ln b_T` at a temperature for a reference temperature, both in °C and above absolute zero.
    pub fn ln_factor(&self, temperature_c: f64, reference_c: f64) -> f64 {
        let ln_ratio = ((temperature_c + ZERO_CELSIUS) / (reference_c + ZERO_CELSIUS)).ln();
        match *self {
            Self::RhoT { expansion_per_k } => {
                ln_ratio - (expansion_per_k * (temperature_c - reference_c)).ln_1p()
            }
            Self::Power { exponent } => exponent * ln_ratio,
        }
    }

    /// The same factors relative to those at another reference temperature in °C.
    pub fn about(&self, reference_c: f64, old_reference_c: f64) -> Self {
        match *self {
            Self::RhoT { expansion_per_k } => {
                let growth = 1.0 + expansion_per_k * (reference_c - old_reference_c);
                Self::RhoT { expansion_per_k: expansion_per_k / growth }
            }
            power @ Self::Power { .. } => power,
        }
    }

    /// The first coefficient that no material has, with its key and what it must be.
    pub(super) fn mistake(&self) -> Option<(&'static str, f64, &'static str)> {
        match *self {
            Self::RhoT { expansion_per_k } if !(0.0..=0.003).contains(&expansion_per_k) => {
                Some(("vertical.rho_t.expansion_per_k", expansion_per_k, "between 0 and 0.003"))
            }
            Self::Power { exponent } if !(-100.0..=100.0).contains(&exponent) => {
                Some(("vertical.power.exponent", exponent, "between -100 and 100"))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_by_hand() {
        let rho_t = VerticalShift::RhoT { expansion_per_k: 6e-4 };
        // 313.15 / 293.15 / 1.012 on a pocket calculator.
        approx::assert_relative_eq!(rho_t.ln_factor(40.0, 20.0).exp(), 1.055_558, epsilon = 1e-6);
        let power = VerticalShift::Power { exponent: 2.0 };
        approx::assert_relative_eq!(power.ln_factor(40.0, 20.0).exp(), 1.141_103_5, epsilon = 1e-6);
    }

    #[test]
    fn factors_about_another_reference_multiply() {
        for vertical in
            [VerticalShift::RhoT { expansion_per_k: 6e-4 }, VerticalShift::Power { exponent: 1.3 }]
        {
            let step = vertical.ln_factor(60.0, 20.0);
            let rest = vertical.about(60.0, 20.0).ln_factor(-10.0, 60.0);
            approx::assert_relative_eq!(
                step + rest,
                vertical.ln_factor(-10.0, 20.0),
                max_relative = 1e-13
            );
        }
    }
}
