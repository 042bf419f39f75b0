//! Section `[validation]`: measured friction that the recipe is held against.

use crate::files::name;
use crate::interface::Fixed;
use crate::measurement::{Conventions, LARGEST_MPA, Sides, density_unit, wavenumber_unit};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::HOTTEST_C;
use crate::theory::Diffusion;
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Section `[validation]` of a recipe: measured friction that `asperity validate` compares with the computed one.
///
/// The stages do not read it. What dry friction has beside hysteresis is a shear stress of the contact area, whose constants are
/// fitted to the measurement unless they stand here (`docs/validation.md`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Validation {
    /// File of the measured friction: text with columns of the speed (`speed_mm_s`, `speed_m_s` or `log10_speed_m_s`) and of
    /// `friction`, optionally `temperature_c` and `pressure_mpa`.
    #[serde(with = "name::path")]
    #[schemars(with = "String")]
    pub measured: PathBuf,
    /// Names of the columns in their order, for a file without a header; any other name for a column that is not read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<String>,
    /// Temperature in °C of the measurement, if its file has none. Not set: `bem.temperature_c`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_c: Option<f64>,
    /// Mean pressure in MPa of the measurement, if its file has none. Not set: that of `bem.pressures_mpa`, if it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_mpa: Option<f64>,
    /// Speed in mm/s of the largest shear stress, at `reference_c`. Not set: fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mm_s: Option<f64>,
    /// Width of the bell of the shear stress over the decadic logarithm of the speed. Not set: fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Activation energy in eV of the shear stress. Not set: fitted if the measurement has several temperatures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub activation_ev: Option<f64>,
    /// Temperature in °C at which the speed of the shear stress holds, where measurements have several temperatures or
    /// `activation_ev` is set. Not set: the lowest temperature of the sets that are judged together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_c: Option<f64>,
    /// A power spectrum of the road, for Persson's theory beside the contacts of the recipe, or, where the recipe has neither
    /// scans nor waves, alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<Spectrum>,
}

/// A measured power spectrum, and what the theory makes of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spectrum {
    /// Text of two columns, wavenumber and density.
    #[serde(with = "name::path")]
    #[schemars(with = "String")]
    pub file: PathBuf,
    /// Unit of the wavenumbers: `rad/m`, `rad/mm` or `rad/um` for 2 π / wavelength, `1/m`, `1/mm` or `1/um` for 1 / wavelength.
    pub wavenumber_unit: String,
    /// Unit of the densities: `m4`, `mm4`, `um4` or `nm4` for the spectrum of a surface, `m3`, `mm3`, `um3` or `nm3` for that of
    /// a line across it.
    pub density_unit: String,
    /// Whether the mean square height of a line is the integral of its density over positive wavenumbers (`one`, the default),
    /// or twice that (`two`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides: Option<Sides>,
    /// Whether both columns are decadic logarithms.
    #[serde(default)]
    pub logarithms: bool,
    /// Shortest wavelength in mm that is taken; that of the file if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_wavelength_mm: Option<f64>,
    /// Share of the strain of full contact that is left in vanishing contact.
    #[serde(default = "half")]
    pub gamma: f64,
    /// What the diffusion of the pressure takes for the stress of the waves: `full`, that of full contact; `reduced`, as the
    /// strain is reduced.
    #[serde(default)]
    pub diffusion: Stress,
}

/// What spreads the pressure in Persson's theory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Stress {
    /// The stress of full contact.
    #[default]
    Full,
    /// Reduced as the strain is.
    Reduced,
}

impl From<Stress> for Diffusion {
    fn from(stress: Stress) -> Self {
        match stress {
            Stress::Full => Self::Full,
            Stress::Reduced => Self::Reduced,
        }
    }
}

fn half() -> f64 {
    0.5
}

impl Validation {
    /// Checks the section beside the pressures in MPa that the recipe solves.
    pub(super) fn check(&self, pressures_mpa: &[f64]) -> Result<(), InvalidRecipe> {
        let positive = [
            ("validation.pressure_mpa", self.pressure_mpa),
            ("validation.speed_mm_s", self.speed_mm_s),
            ("validation.width", self.width),
        ];
        for (key, value) in positive.into_iter().filter_map(|(key, value)| Some((key, value?))) {
            require(value > 0.0 && value.is_finite(), key, value, "positive and finite")?;
        }
        let energy = self.activation_ev.unwrap_or(0.5);
        let physical = (0.0..=10.0).contains(&energy);
        require(
            physical,
            "validation.activation_ev",
            energy,
            "from 0 to 10 eV (1 eV is 96.5 kJ/mol)",
        )?;
        let pressure = self.pressure_mpa.unwrap_or(1.0);
        let possible = pressure <= LARGEST_MPA;
        let range = "at most 100 MPa; is it in Pa or kPa?";
        require(possible, "validation.pressure_mpa", pressure, range)?;
        let temperatures = [
            ("validation.temperature_c", self.temperature_c),
            ("validation.reference_c", self.reference_c),
        ];
        for (key, celsius) in temperatures.into_iter().filter_map(|(key, c)| Some((key, c?))) {
            let plausible = (-100.0..=HOTTEST_C).contains(&celsius);
            require(plausible, key, celsius, "between -100 and 150 °C; is it in K?")?;
        }
        if pressures_mpa.is_empty() {
            let advice = "the mean pressure of the measurement; contacts at given areas have no speed in common with it";
            return Err(InvalidRecipe::Missing { key: "bem.pressures_mpa", advice });
        }
        self.spectrum.as_ref().map_or(Ok(()), Spectrum::check)
    }

    /// Every file that the section names.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let spectrum = self.spectrum.iter_mut().map(|spectrum| &mut spectrum.file);
        std::iter::once(&mut self.measured).chain(spectrum)
    }

    /// The constants of the shear stress that are not fitted.
    pub fn fixed(&self) -> Fixed {
        Fixed {
            peak_speed: self.speed_mm_s.map(Units::mm_to_m),
            width: self.width,
            energy_ev: self.activation_ev,
        }
    }
}

impl Spectrum {
    fn check(&self) -> Result<(), InvalidRecipe> {
        let units = "rad/m, rad/mm or rad/um for 2 pi / wavelength, or 1/m, 1/mm or 1/um for 1 / wavelength";
        let known = wavenumber_unit(&self.wavenumber_unit).is_ok();
        require(known, "validation.spectrum.wavenumber_unit", &self.wavenumber_unit, units)?;
        let units = "m4, mm4, um4 or nm4 for the spectrum of a surface, or m3, mm3, um3 or nm3 for that of a line across it";
        let density = density_unit(&self.density_unit);
        require(density.is_ok(), "validation.spectrum.density_unit", &self.density_unit, units)?;
        let of_line = density.is_ok_and(crate::measurement::DensityUnit::of_line);
        let without = of_line || self.sides.is_none();
        let key = "validation.spectrum.sides";
        require(without, key, "given", "left out beside the density_unit of a surface")?;
        require(
            (0.0..=1.0).contains(&self.gamma),
            "validation.spectrum.gamma",
            self.gamma,
            "between 0 and 1",
        )?;
        let shortest = self.shortest_wavelength_mm.unwrap_or(1.0);
        let usable = shortest > 0.0 && shortest.is_finite();
        require(
            usable,
            "validation.spectrum.shortest_wavelength_mm",
            shortest,
            "positive and finite",
        )
    }

    /// How the columns are to be understood.
    ///
    /// # Errors
    /// What there is to choose from, for a unit that is none.
    pub fn conventions(&self) -> Result<Conventions, String> {
        Ok(Conventions {
            wavenumber: wavenumber_unit(&self.wavenumber_unit)?,
            density: density_unit(&self.density_unit)?,
            sides: self.sides.unwrap_or(Sides::One),
            logarithms: self.logarithms,
        })
    }
}
