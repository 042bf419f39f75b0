//! A rubber with what is known of its measurement.

use super::payne::{Payne, PayneLaw};
use super::{
    Extrapolation, FrequencyRange, Rubber, RubberModel, TemperatureDependence, TemperatureError,
    Viscoelastic,
};

/// A rubber with what is known of its measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct RubberData {
    /// The rubber at the reference temperature, or at the one it was shifted to.
    pub rubber: RubberModel,
    /// Frequencies at which it was measured, at the same temperature.
    pub measured: Option<FrequencyRange>,
    /// How it shifts with temperature.
    pub temperature: Option<TemperatureDependence>,
    /// How it softens with strain.
    pub payne: Option<Payne>,
    /// What reading the measured rows changed, in words.
    pub notes: Vec<String>,
}

impl From<Rubber> for RubberData {
    fn from(rubber: Rubber) -> Self {
        RubberModel::from(rubber).into()
    }
}

impl From<RubberModel> for RubberData {
    fn from(rubber: RubberModel) -> Self {
        let measured = rubber.measured();
        Self { rubber, measured, temperature: None, payne: None, notes: Vec::new() }
    }
}

impl RubberData {
    /// Warnings where the moduli at the frequencies excited by a surface, or the shift to the temperature, are
    /// extrapolated from the measurement.
    pub fn extrapolations(&self, excited: Option<FrequencyRange>) -> Vec<String> {
        let temperature = self.temperature.as_ref().and_then(TemperatureDependence::extrapolation);
        let range = self.measured.zip(excited);
        let frequencies = range.and_then(|(measured, excited)| measured.extrapolation(excited));
        let held = self.rubber.table().map(super::MeasuredModuli::extrapolation);
        let frequencies = frequencies.map(|warning| match held {
            Some(Extrapolation::Hold) => format!("{warning}, held at the values of the nearer end"),
            _ => warning,
        });
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
            .as_ref()
            .ok_or_else(|| TemperatureError::NoLaw { rubber: self.rubber.name().into() })?;
        let factor = law.shift_factor(temperature_c)?;
        let shifted = self.rubber.shifted(factor);
        let rubber = match law.vertical {
            None => shifted,
            Some(_) => shifted.scaled(law.vertical_factor(temperature_c)),
        };
        Ok(Self {
            rubber,
            measured: self.measured.map(|range| range.shifted(factor)),
            temperature: Some(law.about(temperature_c)),
            payne: self.payne.clone(),
            notes: self.notes.clone(),
        })
    }

    /// Temperature of the moduli in °C, if the rubber knows it.
    pub fn temperature_c(&self) -> Option<f64> {
        self.temperature.as_ref().map(|dependence| dependence.reference_c)
    }

    /// How the rubber softens with strain at its temperature; `None` if it was not measured. A rubber without a
    /// temperature has the law of its only sweep.
    pub fn payne_law(&self) -> Option<PayneLaw> {
        self.payne.as_ref().map(|payne| payne.at(self.temperature_c()))
    }
}
