//! A measured power spectrum: a text file of two columns, wavenumber and density.

use crate::files::{Located, cells, read_located};
use crate::surface::spectrum::IsotropicSpectrum;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::Path;

/// Unit of the wavenumbers of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavenumberUnit {
    /// What one of it is in rad/m or 1/m.
    per_m: f64,
    /// Whether it counts waves, 1/λ, instead of 2 π / λ.
    counts_waves: bool,
}

/// Unit of the densities of a file, which tells what they belong to: the plane (m⁴) or a line (m³).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DensityUnit {
    /// What its unit of length is in m.
    metre: f64,
    /// Directions of the wavenumbers: 2 of the plane, 1 of a line.
    dimensions: i32,
}

/// Densities at positive wavenumbers of a line, or at those of both signs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// The mean square height is the integral over positive wavenumbers.
    One,
    /// The mean square height is twice the integral over positive wavenumbers.
    Two,
}

/// `rad/m`, `rad/mm`, `rad/um`, `1/m`, `1/mm` or `1/um`.
///
/// # Errors
/// What there is to choose from.
pub fn wavenumber_unit(text: &str) -> Result<WavenumberUnit, String> {
    let choose = "choose rad/m, rad/mm or rad/um for q = 2 pi / wavelength, 1/m, 1/mm or 1/um for 1 / wavelength";
    let (count, length) = text.split_once('/').ok_or(choose)?;
    let per_m = match length {
        "m" => 1.0,
        "mm" => 1e3,
        "um" => 1e6,
        _ => return Err(choose.into()),
    };
    let counts_waves = match count {
        "rad" => false,
        "1" => true,
        _ => return Err(choose.into()),
    };
    Ok(WavenumberUnit { per_m, counts_waves })
}

/// `m4`, `mm4`, `um4`, `nm4`, `m3`, `mm3`, `um3` or `nm3`.
///
/// # Errors
/// What there is to choose from.
pub fn density_unit(text: &str) -> Result<DensityUnit, String> {
    let choose = "choose m4, mm4, um4 or nm4 for the spectrum of a surface, m3, mm3, um3 or nm3 for that of a line across it";
    let (length, power) = text.split_at_checked(text.len().saturating_sub(1)).ok_or(choose)?;
    let metre = match length {
        "m" => 1.0,
        "mm" => 1e-3,
        "um" => 1e-6,
        "nm" => 1e-9,
        _ => return Err(choose.into()),
    };
    let dimensions = match power {
        "4" => 2,
        "3" => 1,
        _ => return Err(choose.into()),
    };
    Ok(DensityUnit { metre, dimensions })
}

/// How the columns of a file are to be understood.
#[derive(Debug, Clone, Copy)]
pub struct Conventions {
    /// Unit of the wavenumbers.
    pub wavenumber: WavenumberUnit,
    /// Unit of the densities.
    pub density: DensityUnit,
    /// Of the spectrum of a line; without effect on that of the plane.
    pub sides: Sides,
    /// Both columns are decadic logarithms.
    pub logarithms: bool,
}

/// A spectrum, and the number of points that have no density over the plane.
pub type FoundSpectrum = (IsotropicSpectrum, usize);

/// Reads a spectrum.
///
/// # Errors
/// A message with the file and the line.
pub fn read_spectrum(path: &Path, conventions: Conventions) -> Result<FoundSpectrum, String> {
    read_located(path, |text| parse_spectrum(text, conventions))
}

fn parse_spectrum(text: &str, conventions: Conventions) -> Result<FoundSpectrum, Located> {
    let (mut wavenumbers, mut densities) = (Vec::new(), Vec::new());
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let data = line.split('#').next().unwrap_or_default();
        if data.trim().is_empty() {
            continue;
        }
        let here = |problem: String| (Some(index + 1), problem);
        let [wavenumber, density] = parse_point(data, conventions.logarithms).map_err(here)?;
        let wavenumber = conventions.wavenumber.to_rad_per_m(wavenumber);
        if wavenumbers.last().is_some_and(|last| wavenumber <= *last) {
            return Err(here(
                "the wavenumber does not grow from the line before: sort the lines, and leave repeated wavenumbers out"
                    .into(),
            ));
        }
        wavenumbers.push(wavenumber);
        densities.push(conventions.to_si(density));
    }
    if wavenumbers.len() < 2 {
        let points = wavenumbers.len();
        return Err((None, format!("has {points} points, a spectrum needs two or more")));
    }
    match conventions.density.dimensions {
        2 => IsotropicSpectrum::new(wavenumbers, densities).map(|spectrum| (spectrum, 0)),
        _ => IsotropicSpectrum::from_line(&wavenumbers, &densities),
    }
    .map_err(|error| (None, error.to_string()))
}

fn finite(cell: &str) -> Result<f64, String> {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{cell}` is not a finite number")),
        Err(_) => Err(format!("`{cell}` is not a number")),
    }
}

/// Wavenumber and density, both positive.
fn parse_point(data: &str, logarithms: bool) -> Result<[f64; 2], String> {
    let cells = cells(data);
    let [wavenumber, density] = cells[..] else {
        return Err(format!(
            "{} columns instead of the 2 columns wavenumber and density with decimal points; start lines of text with #",
            cells.len()
        ));
    };
    let number = |name: &str, cell: &str| -> Result<f64, String> {
        let value = finite(cell)
            .map_err(|problem| format!("{name}: {problem}; start lines of text with #"))?;
        let value = if logarithms { 10_f64.powf(value) } else { value };
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(format!(
            "{name} is {value}, it must be positive: leave the point out; are the columns decadic logarithms? (--logarithms, or logarithms = true)"
        ))
    };
    Ok([number("wavenumber", wavenumber)?, number("density", density)?])
}

impl DensityUnit {
    /// Whether the densities are those of a line and not of the plane.
    pub fn of_line(self) -> bool {
        self.dimensions == 1
    }
}

impl WavenumberUnit {
    fn to_rad_per_m(self, value: f64) -> f64 {
        value * self.per_m * if self.counts_waves { TAU } else { 1.0 }
    }
}

impl Conventions {
    /// A density in SI over angular wavenumbers: m⁴ of the plane, or one-sided m³ of a line.
    fn to_si(self, density: f64) -> f64 {
        let DensityUnit { metre, dimensions } = self.density;
        let metres = density * metre.powi(dimensions + 2);
        // The same power in an interval that is 2 π times as wide, along every direction.
        let angular =
            if self.wavenumber.counts_waves { metres / TAU.powi(dimensions) } else { metres };
        match (dimensions, self.sides) {
            (1, Sides::Two) => 2.0 * angular,
            _ => angular,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn conventions(wavenumber: &str, density: &str) -> Conventions {
        Conventions {
            wavenumber: wavenumber_unit(wavenumber).unwrap(),
            density: density_unit(density).unwrap(),
            sides: Sides::One,
            logarithms: false,
        }
    }

    #[test]
    fn one_spectrum_in_any_units_is_one_surface() {
        let reference =
            parse_spectrum("1e3 1e-14\n1e4 1e-18", conventions("rad/m", "m4")).unwrap().0;
        for (text, wavenumber, density) in [
            ("1;1e-2\n10;1e-6", "rad/mm", "mm4"),
            ("1e-3,1e10\n1e-2,1e6", "rad/um", "um4"),
            (
                "# q C\n159.15494309189535 3.947841760435743e-13\n1591.5494309189535 3.947841760435743e-17",
                "1/m",
                "m4",
            ),
        ] {
            let found = parse_spectrum(text, conventions(wavenumber, density)).unwrap().0;
            assert_relative_eq!(found.density(3e3), reference.density(3e3), max_relative = 1e-12);
            assert_relative_eq!(
                found.rms_height(found.band()),
                reference.rms_height(reference.band()),
                max_relative = 1e-12
            );
        }
        let logarithms = Conventions { logarithms: true, ..conventions("rad/m", "m4") };
        let found = parse_spectrum("3 -14\n4 -18", logarithms).unwrap().0;
        assert_relative_eq!(found.density(3e3), reference.density(3e3), max_relative = 1e-12);
    }

    #[test]
    fn two_sides_are_twice_one() {
        let text = "1e3 1e-11\n1e4 1e-14\n1e5 1e-17";
        let one = conventions("rad/m", "m3");
        let two = Conventions { sides: Sides::Two, ..one };
        let [one, two] = [one, two].map(|c| parse_spectrum(text, c).unwrap().0.density(5e3));
        assert_relative_eq!(two, 2.0 * one, max_relative = 1e-12);
        // A line counted in waves per metre has 2 π times the density.
        let counted = parse_spectrum("1e3 1e-11\n1e4 1e-14\n1e5 1e-17", conventions("1/m", "m3"));
        let counted = counted.unwrap().0;
        assert!(counted.band()[0] > 6.28e3);
    }

    #[test]
    fn mistakes_are_named_by_line() {
        for (text, line, part) in [
            ("", None, "has 0 points"),
            ("1e3 1e-14", None, "has 1 points"),
            ("q C\n1 2", Some(1), "wavenumber: `q` is not a number"),
            ("1e3 1e-14 7\n", Some(1), "3 columns"),
            ("1e3 1e-14\n1e3 1e-15", Some(2), "does not grow"),
            ("1e3 -1\n", Some(1), "density is -1, it must be positive"),
            ("3 -14\n4 -18", Some(1), "--logarithms"),
            ("1e3 NaN\n", Some(1), "not a finite number"),
        ] {
            let (found, message) = parse_spectrum(text, conventions("rad/m", "m4")).unwrap_err();
            assert_eq!(found, line, "{text}: {message}");
            assert!(message.contains(part), "{text}: {message}");
        }
        for unit in ["m", "rad", "1/cm", "Hz/m", ""] {
            assert!(wavenumber_unit(unit).is_err(), "{unit}");
        }
        for unit in ["m2", "4", "cm4", "", "µ"] {
            assert!(density_unit(unit).is_err(), "{unit}");
        }
    }
}
