//! The two ways in which the moduli of a rubber are known.

use super::{FrequencyRange, MeasuredModuli, Rubber, RubberError, Viscoelastic};
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A rubber by its relaxation times or by a table of its moduli.
///
/// Models that ask for complex moduli alone take it as it is ([`Viscoelastic`]); those that follow the rubber in time need
/// [`Self::maxwell`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum RubberModel {
    /// A generalised Maxwell model.
    Maxwell(Rubber),
    /// Measured storage and loss moduli.
    Table(MeasuredModuli),
}

impl From<Rubber> for RubberModel {
    fn from(rubber: Rubber) -> Self {
        Self::Maxwell(rubber)
    }
}

impl From<MeasuredModuli> for RubberModel {
    fn from(table: MeasuredModuli) -> Self {
        Self::Table(table)
    }
}

impl RubberModel {
    fn viscoelastic(&self) -> &dyn Viscoelastic {
        match self {
            Self::Maxwell(rubber) => rubber,
            Self::Table(table) => table,
        }
    }

    /// The relaxation times.
    ///
    /// # Errors
    /// [`RubberError::NoRelaxationTimes`] for a table.
    pub fn maxwell(&self) -> Result<&Rubber, RubberError> {
        match self {
            Self::Maxwell(rubber) => Ok(rubber),
            Self::Table(table) => {
                Err(RubberError::NoRelaxationTimes { rubber: table.name().into() })
            }
        }
    }

    /// The table, if it is one.
    pub fn table(&self) -> Option<&MeasuredModuli> {
        match self {
            Self::Maxwell(_) => None,
            Self::Table(table) => Some(table),
        }
    }

    /// Whether it dissipates nothing at any frequency.
    pub fn is_elastic(&self) -> bool {
        matches!(self, Self::Maxwell(rubber) if rubber.branches.is_empty())
    }

    /// The rubber with all relaxation times multiplied by a factor, `E(a ω)` in place of `E(ω)`, as at another temperature.
    pub fn shifted(&self, factor: f64) -> Self {
        match self {
            Self::Maxwell(rubber) => rubber.shifted(factor).into(),
            Self::Table(table) => table.shifted(factor).into(),
        }
    }

    /// The rubber with all moduli multiplied by a factor, as at another temperature.
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Maxwell(rubber) => rubber.scaled(factor).into(),
            Self::Table(table) => table.scaled(factor).into(),
        }
    }
}

impl Viscoelastic for RubberModel {
    fn name(&self) -> &str {
        self.viscoelastic().name()
    }

    fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        self.viscoelastic().complex_modulus(angular_frequency)
    }

    fn poisson_ratio(&self) -> f64 {
        self.viscoelastic().poisson_ratio()
    }

    fn validate(&self) -> Result<(), RubberError> {
        self.viscoelastic().validate()
    }

    fn measured(&self) -> Option<FrequencyRange> {
        self.viscoelastic().measured()
    }

    fn require(&self, asked: FrequencyRange) -> Result<(), RubberError> {
        self.viscoelastic().require(asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::fit::SweepPoint;

    fn table() -> MeasuredModuli {
        let rubber = Rubber::table_2_1();
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
            let modulus = rubber.complex_modulus(angular_frequency);
            SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
        };
        let points: Vec<SweepPoint> = (0..33).map(point).collect();
        MeasuredModuli::new("table", 0.49, &points).unwrap()
    }

    #[test]
    fn both_models_shift_and_scale_alike() {
        let at = 3e3;
        for model in [RubberModel::from(Rubber::table_2_1()), table().into()] {
            let moved = model.shifted(7.0).scaled(1.3).complex_modulus(at);
            let expected = 1.3 * model.complex_modulus(7.0 * at);
            // Through logarithms of frequencies and moduli in tables.
            assert!((moved - expected).norm() < 1e-13 * expected.norm(), "{moved} {expected}");
        }
    }

    #[test]
    fn models_are_stored_and_read_again() {
        let elastic = RubberModel::from(Rubber::elastic(3e6, 0.5));
        for model in [elastic, Rubber::table_2_1().into(), table().into()] {
            let text = toml::to_string(&model).unwrap();
            assert_eq!(toml::from_str::<RubberModel>(&text).unwrap(), model, "{text}");
        }
    }

    #[test]
    fn a_table_has_no_relaxation_times_and_says_what_to_do() {
        let error = RubberModel::from(table()).maxwell().unwrap_err().to_string();
        assert!(error.contains("asperity rubber fit"), "{error}");
        assert!(RubberModel::from(Rubber::table_2_1()).maxwell().is_ok());
    }

    #[test]
    fn outside_a_table_moduli_are_refused_or_held() {
        let asked = FrequencyRange { lowest_hz: 1e-3, highest_hz: 1e5 };
        let refused = RubberModel::from(table());
        let error = refused.require(asked).unwrap_err();
        assert!(matches!(error, RubberError::NotMeasured { frequency_hz: 1e-3, .. }), "{error}");
        let held = RubberModel::from(table().with_extrapolation(super::super::Extrapolation::Hold));
        held.require(asked).unwrap();
        assert_eq!(held.complex_modulus(1e-2), held.complex_modulus(1.0));
        assert_eq!(held.complex_modulus(0.0).im, 0.0);
    }
}
