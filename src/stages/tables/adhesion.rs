//! Section `[adhesion]`: the shear stress of the contact area.

use crate::interface::{Activation, GaussianShear, ShearError, ShearLaw, ShearTable};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::HOTTEST_C;
use crate::units::Units;
use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// Section `[adhesion]` of a recipe: a shear stress τ_f of the contact area, which adds `τ_f A / (p A_0)` to friction.
///
/// It has no defaults: measured stresses differ by compound, road and, above all, by the shortest wavelength at which the
/// contact area was computed. `asperity adhesion fit` finds it from measured friction and writes this section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adhesion {
    /// How the stress depends on the speed: `gaussian`, `shear_mpa exp(-width log10(v a / speed_mm_s)^2)`; `table`, the
    /// `points`, interpolated in the logarithms of both.
    pub law: Law,
    /// Largest shear stress in MPa; for `gaussian`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_mpa: Option<f64>,
    /// Speed in mm/s of the largest shear stress, at `reference_c`; for `gaussian`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mm_s: Option<f64>,
    /// Width of the bell: its full width at half maximum is `2 sqrt(ln 2 / width)` decades; for `gaussian`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Pairs of a speed in mm/s and a shear stress in MPa, speeds ascending; for `table`.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "pairs")]
    pub points: Vec<[f64; 2]>,
    /// Activation energy in eV by which the speed shifts with temperature; without it, temperature has no effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub activation_ev: Option<f64>,
    /// Temperature in °C of the law; beside `activation_ev`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_c: Option<f64>,
    /// Shortest wavelength in mm of the surfaces whose contact area the stress was fitted to. Tables of another shortest wavelength warn:
    /// the contact area grows with every wave that is left out.
    pub shortest_wavelength_mm: f64,
}

/// Pairs of numbers; a third number in one is a mistake, and must not be dropped.
fn pairs<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[f64; 2]>, D::Error> {
    let rows = Vec::<Vec<f64>>::deserialize(deserializer)?;
    let pair = |row: Vec<f64>| {
        <[f64; 2]>::try_from(row).map_err(|row| {
            let problem = "a point is a pair [speed in mm/s, stress in MPa]";
            D::Error::custom(format!("{problem}, and {row:?} has {} numbers", row.len()))
        })
    };
    rows.into_iter().map(pair).collect()
}

/// Largest shear stress in MPa that a recipe may state; glassy rubber has less.
const MOST_MPA: f64 = 1e3;

/// A dependence of the shear stress on the speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// A bell over the logarithm of the speed.
    Gaussian,
    /// Measured points.
    Table,
}

impl Adhesion {
    /// Checks the section; the temperature in °C is that of the recipe.
    pub(crate) fn check(
        &self,
        temperature_c: Option<f64>,
        speeds_mm_s: &[f64],
    ) -> Result<(), InvalidRecipe> {
        let shortest = self.shortest_wavelength_mm;
        let usable = shortest > 0.0 && shortest.is_finite();
        require(usable, "adhesion.shortest_wavelength_mm", shortest, "positive and finite")?;
        self.check_shape()?;
        self.check_shift(temperature_c)?;
        let Ok(law) = self.shear_law() else {
            let required = "two pairs or more of a positive speed in mm/s and a positive stress in MPa, speeds ascending";
            return require(false, "adhesion.points", &self.points, required);
        };
        // A table that ends too early is told before anything is solved.
        let temperature_c = temperature_c.unwrap_or(20.0);
        for speed_mm_s in speeds_mm_s {
            let covered = law.stress(speed_mm_s.mm_to_m(), temperature_c).is_ok();
            let required = "within the speeds of adhesion.points (at the reference temperature, where the law shifts): extend the table, \
                 or leave the speed out";
            require(covered, "bem.speeds_mm_s", speed_mm_s, required)?;
        }
        Ok(())
    }

    /// Checks that the keys are those of the law.
    fn check_shape(&self) -> Result<(), InvalidRecipe> {
        let of_a_bell = [
            ("adhesion.shear_mpa", self.shear_mpa),
            ("adhesion.speed_mm_s", self.speed_mm_s),
            ("adhesion.width", self.width),
        ];
        for (key, value) in of_a_bell {
            match (self.law, value) {
                (Law::Gaussian, None) => {
                    let advice = "the law gaussian needs it (`asperity adhesion fit` finds it from measured friction)";
                    return Err(InvalidRecipe::Missing { key, advice });
                }
                (Law::Table, Some(value)) => {
                    require(
                        false,
                        key,
                        value,
                        "left out beside law = \"table\", whose points have it",
                    )?;
                }
                (Law::Gaussian, Some(value)) => {
                    require(value > 0.0 && value.is_finite(), key, value, "positive and finite")?;
                    let stress = key == "adhesion.shear_mpa";
                    require(
                        !stress || value <= MOST_MPA,
                        key,
                        value,
                        "at most 1000 MPa; was it given in Pa?",
                    )?;
                }
                (Law::Table, None) => {}
            }
        }
        let gaussian = self.law == Law::Gaussian && !self.points.is_empty();
        require(!gaussian, "adhesion.points", &self.points, "left out beside law = \"gaussian\"")
    }

    /// Checks how the law shifts to the temperature in °C of the recipe.
    fn check_shift(&self, temperature_c: Option<f64>) -> Result<(), InvalidRecipe> {
        let energy = self.activation_ev.unwrap_or(0.5);
        let physical = (0.0..=10.0).contains(&energy);
        require(
            physical,
            "adhesion.activation_ev",
            energy,
            "from 0 to 10 eV (1 eV is 96.5 kJ/mol)",
        )?;
        if self.activation_ev.is_some() && self.reference_c.is_none() {
            let advice =
                "the temperature at which adhesion.speed_mm_s holds, beside adhesion.activation_ev";
            return Err(InvalidRecipe::Missing { key: "adhesion.reference_c", advice });
        }
        if self.activation_ev.is_some() && temperature_c.is_none() {
            let advice = "the shear stress shifts with temperature (adhesion.activation_ev): state the temperature of the rubber";
            return Err(InvalidRecipe::Missing { key: "bem.temperature_c", advice });
        }
        let celsius = self.reference_c.unwrap_or(20.0);
        let plausible = (-100.0..=HOTTEST_C).contains(&celsius);
        require(
            plausible,
            "adhesion.reference_c",
            celsius,
            "between -100 and 150 °C; is it in K?",
        )?;
        if let (None, Some(reference_c)) = (self.activation_ev, self.reference_c) {
            let required = "left out without adhesion.activation_ev: it has no effect";
            require(false, "adhesion.reference_c", reference_c, required)?;
        }
        Ok(())
    }

    /// The law in SI.
    ///
    /// # Errors
    /// [`ShearError`] for numbers that no law has.
    pub fn shear_law(&self) -> Result<ShearLaw, ShearError> {
        let shift = self
            .activation_ev
            .zip(self.reference_c)
            .map(|(energy_ev, reference_c)| Activation { energy_ev, reference_c });
        let law = match self.law {
            Law::Gaussian => ShearLaw::Gaussian(GaussianShear {
                peak_stress: self.shear_mpa.unwrap_or(f64::NAN).mpa_to_pa(),
                peak_speed: self.speed_mm_s.unwrap_or(f64::NAN).mm_to_m(),
                width: self.width.unwrap_or(f64::NAN),
                shift,
            }),
            Law::Table => {
                let points: Vec<[f64; 2]> = self
                    .points
                    .iter()
                    .map(|[speed, stress]| [speed.mm_to_m(), stress.mpa_to_pa()])
                    .collect();
                ShearLaw::Table(ShearTable::new(&points, shift)?)
            }
        };
        law.validate()?;
        Ok(law)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Adhesion {
        toml::from_str(text).unwrap()
    }

    const BELL: &str = "law = 'gaussian'\nshear_mpa = 6.5\nspeed_mm_s = 6.0\nwidth = 0.1\nshortest_wavelength_mm = 0.06\n";

    #[test]
    fn a_law_that_shifts_needs_the_temperature() {
        parse(BELL).check(None, &[10.0]).unwrap();
        let shifted = parse(&format!("{BELL}activation_ev = 0.97\nreference_c = 20.0\n"));
        shifted.check(Some(5.0), &[10.0]).unwrap();
        let error = shifted.check(None, &[10.0]).unwrap_err().to_string();
        assert!(error.starts_with("bem.temperature_c is missing"), "{error}");
        let alone =
            parse(&format!("{BELL}reference_c = 20.0\n")).check(Some(5.0), &[10.0]).unwrap_err();
        assert!(alone.to_string().contains("adhesion.reference_c = 20"), "{alone}");
    }

    #[test]
    fn keys_of_the_other_law_and_bad_numbers_are_refused() {
        let error = |text: &str| parse(text).check(None, &[10.0]).unwrap_err().to_string();
        let table = "law = 'table'\nshortest_wavelength_mm = 0.06\n";
        assert!(error(table).contains("adhesion.points"));
        assert!(error(&format!("{table}points = [[1.0, 2.0], [0.5, 3.0]]")).contains("ascending"));
        let three: Result<Adhesion, _> =
            toml::from_str(&format!("{table}points = [[1.0, 2.0], [2.0, 3.0, 4.0]]"));
        assert!(three.unwrap_err().to_string().contains("has 3 numbers"));
        let both = format!("{table}points = [[1.0, 2.0], [2.0, 3.0]]\nshear_mpa = 2.0");
        assert!(error(&both).contains("adhesion.shear_mpa = 2"));
        assert!(error(&BELL.replace("0.1", "-0.1")).contains("adhesion.width = -0.1"));
        let missing =
            "law = 'gaussian'\nshear_mpa = 6.5\nwidth = 0.1\nshortest_wavelength_mm = 0.06\n";
        assert!(error(missing).starts_with("adhesion.speed_mm_s is missing"));
        let narrow = parse(&format!("{table}points = [[1.0, 2.0], [2.0, 3.0]]"));
        narrow.check(None, &[1.5]).unwrap();
        let beyond = narrow.check(None, &[1.5, 3.0]).unwrap_err().to_string();
        assert!(beyond.contains("bem.speeds_mm_s = 3"), "{beyond}");
        assert!(error(&BELL.replace("6.5", "6.5e6")).contains("in Pa?"));
    }
}
