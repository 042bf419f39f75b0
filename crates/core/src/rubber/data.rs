//! A rubber with the range of its measurement.

use super::{FrequencyRange, Rubber, TemperatureDependence, TemperatureError};

/// A rubber with the range of its measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct RubberData {
    /// The rubber at the reference temperature, or at the one it was shifted to.
    pub rubber: Rubber,
    /// Frequencies at which it was measured, at the same temperature.
    pub measured: Option<FrequencyRange>,
    /// How it shifts with temperature.
    pub temperature: Option<TemperatureDependence>,
}

impl From<Rubber> for RubberData {
    fn from(rubber: Rubber) -> Self {
        Self { rubber, measured: None, temperature: None }
    }
}

impl RubberData {
    /// Warnings where the moduli at the frequencies excited by a surface, or the shift to the temperature, are
    /// extrapolated from the measurement.
    pub fn extrapolations(&self, excited: Option<FrequencyRange>) -> Vec<String> {
        let temperature = self.temperature.and_then(|dependence| dependence.extrapolation());
        let range = self.measured.zip(excited);
        let frequencies = range.and_then(|(measured, excited)| measured.extrapolation(excited));
        temperature.into_iter().chain(frequencies).collect()
    }

    /// The rubber at another temperature in °C, the new reference: relaxation times multiplied by the
    /// shift factor, measured frequencies divided by it, moduli multiplied by the vertical factor
    /// where the file has one.
    ///
    /// # Errors
    /// [`TemperatureError`] without a law, or where it has no shift factor.
    pub fn at_temperature(&self, temperature_c: f64) -> Result<Self, TemperatureError> {
        let law = self
            .temperature
            .ok_or_else(|| TemperatureError::NoLaw { rubber: self.rubber.name.clone() })?;
        let factor = law.shift_factor(temperature_c)?;
        let measured = self.measured.map(|range| range.shifted(factor));
        let temperature = Some(law.about(temperature_c));
        let shifted = self.rubber.shifted(factor);
        let rubber = match law.vertical {
            None => shifted,
            Some(_) => shifted.scaled(law.vertical_factor(temperature_c)),
        };
        Ok(Self { rubber, measured, temperature })
    }
}
