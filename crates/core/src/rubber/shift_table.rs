//! Measured shift factors.

use super::fit::GivenShift;
use super::{TemperatureError, ZERO_CELSIUS};
use crate::numerics::interpolation::CubicHermite;
use serde::{Serialize, Serializer};

/// Largest logarithm in decades, as of a law.
const MOST_DECADES: f64 = 60.0;
/// A factor of 1, by its logarithm: factors are written with six digits.
const ONE: f64 = 1e-5;

/// Shift factors measured at several temperatures, between which `ln a_T` is a monotone cubic in `1/T`
/// ([`CubicHermite::monotone_parabolas`]), T absolute.
///
/// Over `1/T` an Arrhenius law is a straight line, so its factors come back to round-off from any table; those of a WLF law
/// (c1 = 8.86, c2 = 101.6 K about 20 °C) come back from a table with steps of 10 K from -30 to 80 °C within 0.017 decades, over
/// T itself within 0.028. Only differences of logarithms count, so the table may be about any reference temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct ShiftTable {
    factors: Vec<GivenShift>,
    curve: CubicHermite,
}

impl ShiftTable {
    /// The table of factors in any order.
    ///
    /// # Errors
    /// [`TemperatureError::TooFewFactors`] for fewer than two; [`TemperatureError::NoTemperature`],
    /// [`TemperatureError::BadFactor`] for a number that is none; [`TemperatureError::NotFalling`] where the factor does not
    /// fall with temperature, or a temperature occurs twice.
    pub fn new(factors: &[GivenShift]) -> Result<Self, TemperatureError> {
        if factors.len() < 2 {
            return Err(TemperatureError::TooFewFactors { factors: factors.len() });
        }
        for &GivenShift { temperature_c, log10_shift } in factors {
            if !(temperature_c > -ZERO_CELSIUS && temperature_c.is_finite()) {
                return Err(TemperatureError::NoTemperature { temperature_c });
            }
            if !(-MOST_DECADES..=MOST_DECADES).contains(&log10_shift) {
                return Err(TemperatureError::BadFactor { temperature_c, log10_shift });
            }
        }
        let mut factors = factors.to_vec();
        factors.sort_by(|a, b| a.temperature_c.total_cmp(&b.temperature_c));
        let falls = |pair: &[GivenShift]| {
            pair[0].temperature_c < pair[1].temperature_c
                && pair[1].log10_shift < pair[0].log10_shift
        };
        if let Some(pair) = factors.windows(2).find(|pair| !falls(pair)) {
            let [colder_c, hotter_c] = [pair[0].temperature_c, pair[1].temperature_c];
            return Err(TemperatureError::NotFalling { colder_c, hotter_c });
        }
        let curve = CubicHermite::monotone_parabolas(
            factors.iter().map(|factor| abscissa(factor.temperature_c)).collect(),
            factors.iter().map(|factor| factor.log10_shift).collect(),
        );
        Ok(Self { factors, curve })
    }

    /// The factors by ascending temperature.
    pub fn factors(&self) -> &[GivenShift] {
        &self.factors
    }

    /// Lowest and highest temperature in °C.
    pub fn measured_c(&self) -> [f64; 2] {
        [self.factors[0].temperature_c, self.factors[self.factors.len() - 1].temperature_c]
    }

    /// The temperature in °C at which the factor is 1, if a row states it.
    pub fn reference_c(&self) -> Option<f64> {
        let one = |factor: &&GivenShift| factor.log10_shift.abs() < ONE;
        self.factors.iter().find(one).map(|factor| factor.temperature_c)
    }

    /// `log10 a_T` at a temperature for a reference temperature, both in °C; beyond the table that of its nearer end.
    pub fn log10_shift(&self, temperature_c: f64, reference_c: f64) -> f64 {
        let at = |celsius: f64| self.curve.at(abscissa(celsius));
        at(temperature_c) - at(reference_c)
    }

    /// `log10 a_T` as the table has it, about its own reference.
    pub fn own_log10_shift(&self, temperature_c: f64) -> f64 {
        self.curve.at(abscissa(temperature_c))
    }

    /// Checks that a temperature in °C lies within the table.
    ///
    /// # Errors
    /// [`TemperatureError::OutsideTable`].
    pub fn require(&self, temperature_c: f64) -> Result<(), TemperatureError> {
        let measured_c = self.measured_c();
        if (measured_c[0]..=measured_c[1]).contains(&temperature_c) {
            return Ok(());
        }
        Err(TemperatureError::OutsideTable { temperature_c, measured_c })
    }
}

/// `-1/T`, which ascends with temperature.
fn abscissa(temperature_c: f64) -> f64 {
    -1.0 / (temperature_c + ZERO_CELSIUS)
}

impl Serialize for ShiftTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = self.factors.iter().map(|factor| [factor.temperature_c, factor.log10_shift]);
        serializer.collect_seq(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{ShiftLaw, TemperatureDependence};

    fn table(law: &ShiftLaw, temperatures: &[f64]) -> ShiftTable {
        let factor = |&temperature_c: &f64| GivenShift {
            temperature_c,
            log10_shift: law.log10_shift(temperature_c, 20.0),
        };
        ShiftTable::new(&temperatures.iter().map(factor).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn factors_of_a_law_come_back() {
        let temperatures: Vec<f64> = (-3..=8).map(|k| 10.0 * f64::from(k)).collect();
        let arrhenius = ShiftLaw::Arrhenius { activation_energy_kj_mol: 90.0 };
        let wlf = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
        // Round-off for a straight line; the stated accuracy for WLF.
        for (law, accuracy) in [(arrhenius, 1e-12), (wlf, 0.017)] {
            let table = table(&law, &temperatures);
            for k in -60..=160 {
                let (t, r) = (0.5 * f64::from(k), 31.7);
                // The coefficients of WLF are about 20 °C.
                let exact = law.log10_shift(t, 20.0) - law.log10_shift(r, 20.0);
                let miss = table.log10_shift(t, r) - exact;
                assert!(miss.abs() < accuracy, "{}: {t} °C {miss}", law.name());
            }
        }
    }

    #[test]
    fn a_table_is_a_law_that_is_not_extrapolated() {
        let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
        let table = table(&law, &[0.0, 10.0, 20.0, 30.0]);
        assert_eq!(table.reference_c(), Some(20.0));
        let dependence = TemperatureDependence {
            reference_c: 20.0,
            measured_c: Some(table.measured_c()),
            law: ShiftLaw::Table(table),
            vertical: None,
        };
        dependence.validate().unwrap();
        let step = dependence.shift_factor(3.0).unwrap();
        let rest = dependence.about(3.0).shift_factor(27.0).unwrap();
        approx::assert_relative_eq!(
            step * rest,
            dependence.shift_factor(27.0).unwrap(),
            max_relative = 1e-13
        );
        let error = dependence.shift_factor(31.0).unwrap_err().to_string();
        assert!(error.contains("at 31 °C") && error.contains("from 0 to 30 °C"), "{error}");
    }

    #[test]
    fn rows_that_are_no_factors_are_named() {
        let message = |rows: &[[f64; 2]]| {
            let factor = |&[temperature_c, log10_shift]: &[f64; 2]| GivenShift {
                temperature_c,
                log10_shift,
            };
            ShiftTable::new(&rows.iter().map(factor).collect::<Vec<_>>()).unwrap_err().to_string()
        };
        assert!(message(&[[20.0, 0.0]]).contains("1 row(s)"));
        assert!(message(&[[20.0, 0.0], [30.0, 1.0]]).contains("from 20 to 30 °C"));
        assert!(message(&[[20.0, 0.0], [20.0, -1.0]]).contains("from 20 to 20 °C"));
        assert!(message(&[[20.0, 0.0], [30.0, f64::NAN]]).contains("NaN"));
        assert!(message(&[[-300.0, 0.0], [30.0, -1.0]]).contains("absolute zero"));
    }
}
