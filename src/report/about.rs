//! What all tables and figures of a run have in common.

use crate::artifact::{ArtifactError, RunView};

/// What all tables of a run have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// Name of the rubber.
    pub rubber: String,
    /// Temperature in °C to which it was shifted, if it was.
    pub temperature_c: Option<f64>,
    /// Relative accuracy that the recipe asks for, if it does.
    pub tolerance: Option<f64>,
    /// Direction of sliding over areal surfaces in degrees from x towards y, if there are any.
    pub angle_deg: Option<f64>,
    /// Thickness in mm of the layer that slides over areal surfaces; a half-space if there is none.
    pub thickness_mm: Option<f64>,
}

impl About {
    /// From the parameters with which a run solved its contacts.
    ///
    /// # Errors
    /// [`ArtifactError`] if the manifest of the stage is damaged.
    pub fn of(run: &RunView) -> Result<Self, ArtifactError> {
        let parameters = run.stage_manifest("bem")?.map(|manifest| manifest.parameters);
        let parameters = parameters.unwrap_or_default();
        let areal = run.stage_manifest("areal")?.map(|manifest| manifest.parameters);
        let areal = areal.unwrap_or_default();
        Ok(Self {
            rubber: parameters["rubber"]["name"].as_str().unwrap_or("unknown").to_owned(),
            temperature_c: parameters["temperature_c"].as_f64(),
            tolerance: parameters["average_tolerance"].as_f64(),
            // The friction tables have the first direction of the recipe.
            angle_deg: areal["areal"]["angles_deg"][0].as_f64(),
            thickness_mm: areal["areal"]["thickness_mm"].as_f64(),
        })
    }

    /// The rubber and its temperature: `rubber S100 at 20 °C`.
    pub fn material(&self) -> String {
        let temperature = self.temperature_c.map(|celsius| format!(" at {celsius} °C"));
        format!("rubber {}{}", self.rubber, temperature.unwrap_or_default())
    }

    /// In which direction the rubber slides over areal surfaces, in a sentence, if there are any.
    pub(super) fn sliding(&self) -> Option<String> {
        let angle = self.angle_deg?;
        let layer = self
            .thickness_mm
            .map_or_else(String::new, |mm| format!(", as a layer of {mm} mm on a rigid base"));
        Some(format!(
            "Over maps and isotropic surfaces the rubber slides at {angle}° from x, the rows of the maps{layer}."
        ))
    }
}
