//! What of a recipe and its rubber changes the moduli of a contact.

use super::{Effect, Feedback, Heat};
use crate::contact::effective::{FeedbackSetup, HeatFeedback, StrainLaw};
use crate::interface::{ShearError, ShearLaw};
use crate::rubber::payne::PayneLaw;
use crate::rubber::{RubberData, TemperatureDependence};
use crate::stages::StageError;
use crate::stages::tables::Adhesion;
use crate::units::Units;
use serde_json::{Value, json};
use std::path::Path;

/// The laws of a rubber at its temperature before sliding, with the section that asks for them.
pub(super) struct Laws<'a> {
    strain: Option<PayneLaw>,
    heat: Option<Heated<'a>>,
}

/// Heat of the contact, and how the rubber responds to it.
struct Heated<'a> {
    section: &'a Heat,
    law: &'a TemperatureDependence,
    /// The law of `[adhesion]`, if there is one.
    shear: Option<ShearLaw>,
}

impl<'a> Laws<'a> {
    /// What the section asks for.
    ///
    /// # Errors
    /// As [`require_laws`]; [`StageError::Shear`].
    pub fn new(
        section: &'a Feedback,
        material: &'a RubberData,
        adhesion: Option<&Adhesion>,
        rubber_file: &Path,
    ) -> Result<Self, StageError> {
        require_laws(section, material, rubber_file)?;
        let shear = adhesion.map(Adhesion::shear_law).transpose()?;
        let heated = |(section, law)| Heated { section, law, shear };
        Ok(Self {
            strain: material.payne_law().filter(|_| section.strain),
            heat: section.heat.as_ref().zip(material.temperature.as_ref()).map(heated),
        })
    }

    /// Shear stress in Pa whose power heats the contact at a speed in m/s and the temperature before sliding; `None` without heat.
    pub fn shear_stress(&self, speed: f64) -> Result<Option<f64>, ShearError> {
        let Some(heated) = &self.heat else { return Ok(None) };
        let stress = |law: &ShearLaw| law.stress(speed, heated.law.reference_c);
        Ok(Some(heated.shear.as_ref().map(stress).transpose()?.unwrap_or(0.0)))
    }

    /// A contact without feedback with that of an effect, at the shear stress in Pa.
    pub fn apply<'b>(
        &'b self,
        setup: FeedbackSetup<'b>,
        effect: Effect,
        shear_stress: f64,
    ) -> FeedbackSetup<'b> {
        let heat = self.heat.as_ref().filter(|_| effect.has_heat());
        let strain = self.strain.as_ref().filter(|_| effect.has_strain());
        let heat = heat.map(|heated| HeatFeedback {
            thermal: heated.section.setting(setup.speed, shear_stress),
            law: heated.law,
            temperature_c: heated.law.reference_c,
        });
        let strain = strain.map(|law| law as &dyn StrainLaw);
        FeedbackSetup { heat, strain, ..setup }
    }

    /// What of the laws determines a contact under an effect.
    pub fn identity(&self, effect: Effect, shear_stress: f64) -> Value {
        let heat = self.heat.as_ref().filter(|_| effect.has_heat());
        let strain = self.strain.as_ref().filter(|_| effect.has_strain());
        json!({
            "strain": strain,
            "heat": heat.map(|heated| (heated.section, heated.law, shear_stress)),
        })
    }

    /// Warnings of contacts that are warmer, or more strained, than the rubber was measured, from the highest rise in K and the
    /// largest amplitude of elongation.
    pub fn extrapolations(&self, highest_rise: f64, largest_strain: f64) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(heated) = &self.heat {
            let hottest = heated.law.reference_c + highest_rise;
            let known = heated.law.measured_c.map_or(crate::rubber::HOTTEST_C, |[_, high]| high);
            if hottest > known {
                warnings.push(format!(
                    "the rubber becomes up to {hottest:.1} °C warm, and its shift with temperature is known up to {known} °C: \
                     beyond that it is extrapolated"
                ));
            }
        }
        let beyond = self.strain.as_ref().and_then(|law| law.extrapolation(largest_strain));
        warnings.extend(beyond);
        warnings
    }

    /// Sliding distance in mm at a speed in mm/s; `None` without heat.
    pub fn sliding_distance_mm(&self, speed_mm_s: f64) -> Option<f64> {
        let heated = self.heat.as_ref()?;
        Some(heated.section.duration(speed_mm_s.mm_to_m()) * speed_mm_s)
    }
}

/// Fails for a rubber that lacks a law that the section asks for, before the half-space is solved for nothing.
///
/// # Errors
/// [`StageError::NoTemperatureLaw`], [`StageError::NoStrainLaw`].
pub(crate) fn require_laws(
    section: &Feedback,
    material: &RubberData,
    rubber_file: &Path,
) -> Result<(), StageError> {
    let path = || rubber_file.to_path_buf();
    if section.heat.is_some() && material.temperature.is_none() {
        return Err(StageError::NoTemperatureLaw { path: path() });
    }
    if section.strain && material.payne.is_none() {
        return Err(StageError::NoStrainLaw { path: path() });
    }
    Ok(())
}
