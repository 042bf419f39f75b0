//! Time-temperature superposition: moduli at another temperature by a shift of the frequency.

use crate::error_kind::{ErrorKind, HasKind};
use std::f64::consts::LN_10;

use super::{ShiftTable, VerticalShift};
use serde::Serialize;

/// Molar gas constant in J/(mol K), exact since the SI of 2019.
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;
/// 0 °C in K.
pub const ZERO_CELSIUS: f64 = 273.15;
/// Highest temperature in °C at which rubber is measured or used; larger numbers are likely in K.
pub const HOTTEST_C: f64 = 150.0;

/// How the shift factor depends on temperature; 1 at the reference temperature T_r.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShiftLaw {
    /// Williams, Landel & Ferry (J. Am. Chem. Soc. 77, 3701, 1955, doi:10.1021/ja01619a008):
    /// `log10 a_T = -c1 (T - T_r) / (c2 + T - T_r)`.
    Wlf {
        /// Dimensionless.
        c1: f64,
        /// In K.
        c2_k: f64,
    },
    /// Arrhenius: `ln a_T = E_a / R (1/T - 1/T_r)` with absolute temperatures.
    Arrhenius {
        /// Activation energy E_a in kJ/mol.
        activation_energy_kj_mol: f64,
    },
    /// Measured factors, interpolated and never extrapolated.
    Table(ShiftTable),
}

/// A shift law with its reference temperature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TemperatureDependence {
    /// Temperature of the stated moduli in °C.
    pub reference_c: f64,
    /// The law.
    pub law: ShiftLaw,
    /// Lowest and highest temperature in °C that the law was fitted to.
    pub measured_c: Option<[f64; 2]>,
    /// How the moduli themselves change with temperature; not at all if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical: Option<VerticalShift>,
}

/// Errors of moduli at a temperature.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TemperatureError {
    /// The rubber has no law.
    #[error(
        "rubber {rubber} has no [temperature] section and is known at one temperature only: leave the \
         temperature out, or add the section (`asperity rubber fit` writes it from sweeps at several \
         temperatures)"
    )]
    NoLaw {
        /// Name of the rubber.
        rubber: String,
    },
    /// Below absolute zero, or not a number.
    #[error("the temperature {temperature_c} °C is not above absolute zero, -273.15 °C")]
    NoTemperature {
        /// The temperature in °C.
        temperature_c: f64,
    },
    /// At or below the pole of the WLF equation.
    #[error(
        "the WLF equation has no shift factor at {temperature_c} °C: it holds above {pole_c} °C, its reference \
         temperature less c2"
    )]
    BelowPole {
        /// The temperature in °C.
        temperature_c: f64,
        /// The pole in °C.
        pole_c: f64,
    },
    /// A shift that no floating-point number holds with the relaxation times.
    #[error(
        "the shift from {reference_c} °C to {temperature_c} °C is 10^{log10_shift:.1}, beyond any use: stay \
         closer to the reference temperature"
    )]
    TooFar {
        /// The reference temperature in °C.
        reference_c: f64,
        /// The temperature in °C.
        temperature_c: f64,
        /// Decades.
        log10_shift: f64,
    },
    /// A temperature outside a table of measured factors.
    #[error(
        "there is no shift factor at {temperature_c} °C: factors were measured from {} to {} °C and a table is not \
         extrapolated; choose a temperature within it, or a law (wlf or arrhenius) in place of the table",
        .measured_c[0], .measured_c[1]
    )]
    OutsideTable {
        /// The temperature in °C.
        temperature_c: f64,
        /// Lowest and highest temperature of the table in °C.
        measured_c: [f64; 2],
    },
    /// Fewer than two measured factors.
    #[error(
        "temperature.shift_factors has {factors} row(s), a table needs at least two temperatures"
    )]
    TooFewFactors {
        /// How many there are.
        factors: usize,
    },
    /// A measured factor that is not a number.
    #[error(
        "the shift factor at {temperature_c} °C has the logarithm {log10_shift} to base 10, it must be a finite number \
         of at most 60 decades"
    )]
    BadFactor {
        /// The temperature in °C.
        temperature_c: f64,
        /// The logarithm.
        log10_shift: f64,
    },
    /// Measured factors that do not fall with temperature.
    #[error(
        "the shift factor does not fall from {colder_c} to {hotter_c} °C, and rubber relaxes faster where it is hotter: \
         check these two rows, are they inverse factors or doubled?"
    )]
    NotFalling {
        /// The colder temperature in °C.
        colder_c: f64,
        /// The hotter one in °C.
        hotter_c: f64,
    },
    /// A coefficient of a law that is not positive and finite.
    #[error("temperature.{coefficient} is {value}, it must be positive and finite")]
    Coefficient {
        /// Its key.
        coefficient: &'static str,
        /// Its value.
        value: f64,
    },
    /// A coefficient of the vertical shift that no material has.
    #[error("temperature.{coefficient} is {value}, it must lie {range}")]
    Vertical {
        /// Its key.
        coefficient: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A measured range whose lowest temperature is not below the highest.
    #[error(
        "temperature.measured_c is [{}, {}], it must be the lowest and the highest temperature",
        .range[0],
        .range[1]
    )]
    Range {
        /// The range in °C.
        range: [f64; 2],
    },
}

impl HasKind for TemperatureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoLaw { .. }
            | Self::NoTemperature { .. }
            | Self::BelowPole { .. }
            | Self::TooFar { .. }
            | Self::OutsideTable { .. }
            | Self::TooFewFactors { .. }
            | Self::BadFactor { .. }
            | Self::NotFalling { .. }
            | Self::Coefficient { .. }
            | Self::Range { .. }
            | Self::Vertical { .. } => ErrorKind::Input,
        }
    }
}

/// Largest shift in decades: more than from creep over years to vibrations of molecules.
const MOST_DECADES: f64 = 60.0;

impl ShiftLaw {
    /// `log10 a_T` at a temperature for a reference temperature, both in °C; not finite at the pole
    /// of WLF. Beyond a table it is the factor at the nearer end, which [`TemperatureDependence::shift_factor`] refuses.
    pub fn log10_shift(&self, temperature_c: f64, reference_c: f64) -> f64 {
        match self {
            Self::Wlf { c1, c2_k } => {
                let difference = temperature_c - reference_c;
                -c1 * difference / (c2_k + difference)
            }
            Self::Arrhenius { activation_energy_kj_mol } => {
                let inverse = |celsius: f64| 1.0 / (celsius + ZERO_CELSIUS);
                let energy = 1e3 * activation_energy_kj_mol / (GAS_CONSTANT * LN_10);
                energy * (inverse(temperature_c) - inverse(reference_c))
            }
            Self::Table(table) => table.log10_shift(temperature_c, reference_c),
        }
    }

    /// The key of the law in a rubber file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Wlf { .. } => "wlf",
            Self::Arrhenius { .. } => "arrhenius",
            Self::Table(_) => "shift_factors",
        }
    }
}

impl TemperatureDependence {
    /// Checks temperatures and coefficients.
    ///
    /// # Errors
    /// The first number that is out of range.
    pub fn validate(&self) -> Result<(), TemperatureError> {
        above_zero(self.reference_c)?;
        let coefficients = match self.law {
            // Its constructor has checked it.
            ShiftLaw::Table(_) => vec![],
            ShiftLaw::Wlf { c1, c2_k } => vec![("wlf.c1", c1), ("wlf.c2_k", c2_k)],
            ShiftLaw::Arrhenius { activation_energy_kj_mol } => {
                vec![("arrhenius.activation_energy_kj_mol", activation_energy_kj_mol)]
            }
        };
        for (coefficient, value) in coefficients {
            if !(value > 0.0 && value.is_finite()) {
                return Err(TemperatureError::Coefficient { coefficient, value });
            }
        }
        if let Some((coefficient, value, range)) = self.vertical.and_then(|v| v.mistake()) {
            return Err(TemperatureError::Vertical { coefficient, value, range });
        }
        match self.measured_c {
            Some(range) if !(range[0] < range[1] && range.iter().all(|t| t.is_finite())) => {
                Err(TemperatureError::Range { range })
            }
            _ => Ok(()),
        }
    }

    /// Shift factor `a_T`, by which relaxation times are longer at the temperature (°C) than at the
    /// reference: `E(ω, T) = E(a_T ω, T_r)`.
    ///
    /// # Errors
    /// A temperature at which the law has no shift factor.
    pub fn shift_factor(&self, temperature_c: f64) -> Result<f64, TemperatureError> {
        above_zero(temperature_c)?;
        let reference_c = self.reference_c;
        if let ShiftLaw::Table(table) = &self.law {
            table.require(reference_c)?;
            table.require(temperature_c)?;
        }
        if let ShiftLaw::Wlf { c2_k, .. } = self.law
            && temperature_c <= reference_c - c2_k
        {
            let pole_c = reference_c - c2_k;
            return Err(TemperatureError::BelowPole { temperature_c, pole_c });
        }
        let log10_shift = self.law.log10_shift(temperature_c, reference_c);
        if log10_shift.abs() > MOST_DECADES {
            return Err(TemperatureError::TooFar { reference_c, temperature_c, log10_shift });
        }
        Ok(10_f64.powf(log10_shift))
    }

    /// Factor `b_T` of all moduli at a temperature in °C; 1 without a vertical shift.
    pub fn vertical_factor(&self, temperature_c: f64) -> f64 {
        let ln = |shift: VerticalShift| shift.ln_factor(temperature_c, self.reference_c);
        self.vertical.map_or(1.0, |shift| ln(shift).exp())
    }

    /// The same dependence about another reference temperature in °C; one that has a shift factor.
    pub fn about(&self, reference_c: f64) -> Self {
        let law = match &self.law {
            ShiftLaw::Wlf { c1, c2_k } => {
                let new = c2_k + reference_c - self.reference_c;
                ShiftLaw::Wlf { c1: c1 * c2_k / new, c2_k: new }
            }
            // Both state differences between any two temperatures.
            same @ (ShiftLaw::Arrhenius { .. } | ShiftLaw::Table(_)) => same.clone(),
        };
        let vertical = self.vertical.map(|shift| shift.about(reference_c, self.reference_c));
        Self { reference_c, law, vertical, measured_c: self.measured_c }
    }

    /// A warning where the reference temperature lies outside those that the law was fitted to, or seems to be in K.
    pub fn extrapolation(&self) -> Option<String> {
        let temperature_c = self.reference_c;
        let outside =
            self.measured_c.filter(|[low, high]| !(*low..=*high).contains(&temperature_c));
        let in_kelvin = || {
            let celsius = temperature_c - ZERO_CELSIUS;
            format!("is it in K? Then write {celsius:.2}")
        };
        match outside {
            Some([lowest, highest]) => {
                let mut warning = format!(
                    "{temperature_c} °C is outside the {lowest} to {highest} °C at which the rubber was measured: \
                     its shift factor is extrapolated"
                );
                if temperature_c > HOTTEST_C.max(highest) {
                    warning = format!("{warning}; {}", in_kelvin());
                }
                Some(warning)
            }
            None if self.measured_c.is_none() && temperature_c > HOTTEST_C => {
                Some(format!("{temperature_c} °C is hotter than rubber is used: {}", in_kelvin()))
            }
            None => None,
        }
    }
}

fn above_zero(temperature_c: f64) -> Result<(), TemperatureError> {
    if temperature_c > -ZERO_CELSIUS && temperature_c.is_finite() {
        return Ok(());
    }
    Err(TemperatureError::NoTemperature { temperature_c })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wlf() -> TemperatureDependence {
        let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
        TemperatureDependence {
            reference_c: 20.0,
            law,
            measured_c: Some([-10.0, 60.0]),
            vertical: None,
        }
    }

    #[test]
    fn shift_factors_are_those_by_hand() {
        let at = |temperature_c| wlf().shift_factor(temperature_c).unwrap();
        assert_eq!(at(20.0), 1.0);
        // 8.86 * 20 / 121.6 and 8.86 * 20 / 81.6 on a pocket calculator.
        approx::assert_relative_eq!(at(40.0).log10(), -1.457_237, max_relative = 1e-6);
        approx::assert_relative_eq!(at(0.0).log10(), 2.171_569, max_relative = 1e-6);
        let law = ShiftLaw::Arrhenius { activation_energy_kj_mol: 50.0 };
        let arrhenius = TemperatureDependence { law, ..wlf() };
        // 50000 / 8.314463 (1/313.15 - 1/293.15) = -1.310157.
        let ln = arrhenius.shift_factor(40.0).unwrap().ln();
        approx::assert_relative_eq!(ln, -1.310_157, max_relative = 1e-6);
    }

    #[test]
    fn temperatures_without_a_shift_are_refused() {
        let message = |t| wlf().shift_factor(t).unwrap_err().to_string();
        assert!(message(-81.6).contains("holds above -81.6 °C"), "{}", message(-81.6));
        assert!(message(f64::NAN).contains("absolute zero"));
        assert!(message(-300.0).contains("absolute zero"));
        assert!(message(-81.0).contains("stay closer"), "{}", message(-81.0));
        assert!(wlf().about(60.0).extrapolation().is_none());
        assert!(wlf().about(60.5).extrapolation().unwrap().contains("outside the -10 to 60 °C"));
    }

    #[test]
    fn shifts_about_another_reference_add_up() {
        let law = ShiftLaw::Arrhenius { activation_energy_kj_mol: 50.0 };
        for dependence in [wlf(), TemperatureDependence { law, ..wlf() }] {
            let step = dependence.shift_factor(45.0).unwrap();
            let rest = dependence.about(45.0).shift_factor(-5.0).unwrap();
            let all = dependence.shift_factor(-5.0).unwrap();
            // Exponents of some 5 decades, rounded at 1e-16.
            approx::assert_relative_eq!(step * rest, all, max_relative = 1e-13);
        }
    }
}
