//! What the name of a column says: quantity and unit.
//!
//! Names as instruments write them: `Storage modulus`, `E'`, `G"`, `E_stor`, `M''`, `Temp./°C`,
//! `Angular frequency [rad/s]`; and as this program does: `storage_mpa`. A unit is in the
//! name, in brackets, after a slash, or in the row below.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Quantity {
    Frequency,
    Storage,
    Loss,
    /// tan δ, from which the loss modulus follows.
    LossFactor,
    Temperature,
    ShiftFactor,
    Log10Shift,
    Strain,
}

impl Quantity {
    /// As messages call it.
    pub fn what(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Storage => "storage modulus",
            Self::Loss => "loss modulus",
            Self::LossFactor => "loss factor",
            Self::Temperature => "temperature",
            Self::ShiftFactor => "shift factor",
            Self::Log10Shift => "logarithm of the shift factor",
            Self::Strain => "strain",
        }
    }

    /// Whether it has a unit that a header must state; a strain may have one.
    pub fn has_unit(self) -> bool {
        matches!(self, Self::Frequency | Self::Storage | Self::Loss | Self::Temperature)
    }
}

/// The unit of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unit {
    Hertz,
    RadPerSecond,
    /// A modulus, by its size in Pa.
    Pascal(f64),
    Celsius,
    Kelvin,
    Percent,
    Fraction,
}

impl Unit {
    pub fn name(self) -> &'static str {
        match self {
            Self::Hertz => "Hz",
            Self::RadPerSecond => "rad/s",
            Self::Pascal(1e9) => "GPa",
            Self::Pascal(1e6) => "MPa",
            Self::Pascal(1e3) => "kPa",
            Self::Pascal(_) => "Pa",
            Self::Celsius => "°C",
            Self::Kelvin => "K",
            Self::Percent => "%",
            Self::Fraction => "parts of one",
        }
    }

    /// Whether a quantity is measured in it.
    fn fits(self, quantity: Quantity) -> bool {
        match self {
            Self::Hertz | Self::RadPerSecond => quantity == Quantity::Frequency,
            Self::Pascal(_) => matches!(quantity, Quantity::Storage | Quantity::Loss),
            Self::Celsius | Self::Kelvin => quantity == Quantity::Temperature,
            Self::Percent | Self::Fraction => quantity == Quantity::Strain,
        }
    }
}

/// A name that was understood.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Named {
    pub quantity: Quantity,
    pub unit: Option<Unit>,
    /// `E` or `G`, where the name has the symbol of the modulus.
    pub symbol: Option<char>,
    /// Less likely meanings give way: `T` to `Temperature`.
    pub rank: u8,
}

/// Quantity, unit, symbol and rank of a name; `None` for a column of something else.
pub(super) fn named(cell: &str) -> Option<Named> {
    let cell = cell.trim().trim_start_matches('#').trim();
    let (name, unit_text) = split_unit(cell);
    let name = normal(name);
    let (quantity, symbol, rank) = quantity(&name)?;
    let unit = unit_text.and_then(|text| unit(text, quantity));
    // `t` with seconds is the time.
    let other_unit = unit_text.is_some() && unit.is_none() && quantity.has_unit();
    if other_unit && rank > 0 {
        return None;
    }
    let unit = match quantity {
        Quantity::Frequency if unit.is_none() && name == "angular frequency rad s" => {
            Some(Unit::RadPerSecond)
        }
        _ => unit,
    };
    Some(Named { quantity, unit, symbol, rank })
}

/// The unit that a text names for a quantity.
pub(super) fn unit(text: &str, quantity: Quantity) -> Option<Unit> {
    let text = text.trim().trim_matches(['[', ']', '(', ')']).trim();
    let lower = text.to_lowercase().replace(' ', "");
    let found = match lower.as_str() {
        "hz" | "hertz" => Unit::Hertz,
        "rad/s" | "rads" | "rads-1" | "rads^-1" | "rad/sec" | "rad_s" | "rad·s⁻¹" => {
            Unit::RadPerSecond
        }
        "pa" => Unit::Pascal(1.0),
        "kpa" => Unit::Pascal(1e3),
        // Millipascal of a modulus are never meant, and never guessed to be something else.
        "mpa" if text != "mPa" => Unit::Pascal(1e6),
        "n/mm2" | "n/mm²" | "n/mm^2" => Unit::Pascal(1e6),
        "gpa" => Unit::Pascal(1e9),
        "°c" | "c" | "ºc" | "degc" | "celsius" => Unit::Celsius,
        "k" | "kelvin" => Unit::Kelvin,
        "%" | "percent" => Unit::Percent,
        "fraction" | "m/m" | "mm/mm" | "1" => Unit::Fraction,
        _ => return None,
    };
    found.fits(quantity).then_some(found)
}

/// Name and unit of `name (unit)`, `name [unit]`, `name/unit`, `name_unit`.
fn split_unit(cell: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let parts = cell.rsplit_once(open);
        let parts =
            parts.and_then(|(name, rest)| Some((name, rest.trim_end().strip_suffix(close)?)));
        match parts {
            // tan(delta) has no unit.
            Some((_, "delta" | "Delta" | "δ" | "d")) | None => {}
            Some((name, unit)) => return (name, Some(unit)),
        }
    }
    if let Some((name, unit)) = cell.split_once('/') {
        return (name, Some(unit));
    }
    let suffixes =
        ["_rad_s", "_hz", "_mpa", "_kpa", "_gpa", "_pa", "_c", "_k", "_percent", "_fraction"];
    let suffix = suffixes.iter().find(|suffix| cell.to_lowercase().ends_with(*suffix));
    match suffix {
        Some(suffix) => {
            let (name, unit) = cell.split_at(cell.len() - suffix.len());
            (name, Some(&unit[1..]))
        }
        None => (cell, None),
    }
}

/// Lower case, single blanks, one kind of primes.
fn normal(name: &str) -> String {
    let primes = name
        .replace(['’', '′', '´', '`'], "'")
        .replace(['"', '″', '”'], "''")
        .replace(['_', '.', ',', '*'], " ");
    primes.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase()
}

fn quantity(name: &str) -> Option<(Quantity, Option<char>, u8)> {
    use Quantity::{
        Frequency, Log10Shift, Loss, LossFactor, ShiftFactor, Storage, Strain, Temperature,
    };
    let name = name.replace(" '", "'").replace("( ", "(");
    let symbol = match name.as_str() {
        name if name.starts_with("e'") || name.starts_with("e ") => Some('E'),
        name if name.starts_with("g'") || name.starts_with("g ") => Some('G'),
        name if name.ends_with("e'") || name.ends_with("e''") => Some('E'),
        name if name.ends_with("g'") || name.ends_with("g''") => Some('G'),
        _ => None,
    };
    let found = match name.as_str() {
        "frequency" | "freq" | "angular frequency" | "test frequency" | "frequenz"
        | "kreisfrequenz" | "fréquence" | "omega" | "ω" | "ang frequency" => (Frequency, 0),
        "f" | "f set" | "w" => (Frequency, 1),
        "storage modulus" | "storage" | "e'" | "g'" | "e stor" | "g stor" | "e storage"
        | "g storage" | "storage modulus e'" | "storage modulus g'" | "e' storage modulus"
        | "g' storage modulus" | "speichermodul" | "e mod stor" => (Storage, 0),
        "m'" => (Storage, 1),
        "loss modulus" | "loss" | "e''" | "g''" | "e loss" | "g loss" | "loss modulus e''"
        | "loss modulus g''" | "e'' loss modulus" | "g'' loss modulus" | "verlustmodul" => {
            (Loss, 0)
        }
        "m''" => (Loss, 1),
        "tan delta" | "tan(delta)" | "tan d" | "tan δ" | "tan(δ)" | "tan(d)" | "tand"
        | "tandelta" | "loss factor" | "damping factor" | "verlustfaktor" => (LossFactor, 0),
        "temperature" | "temp" | "temperatur" | "température" | "sample temperature" => {
            (Temperature, 0)
        }
        "t" | "ts" | "t sample" => (Temperature, 1),
        "shift factor" | "at" | "a t" | "horizontal shift factor" => (ShiftFactor, 0),
        "log10 shift" | "log10 shift factor" | "log at" | "log a t" | "log10 at" | "log10 a t"
        | "log(at)" | "log shift factor" => (Log10Shift, 0),
        "strain" | "deformation" | "dynamic strain" | "shear strain" | "strain amplitude" => {
            (Strain, 0)
        }
        _ => return None,
    };
    Some((found.0, symbol, found.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_instruments_are_understood() {
        use Quantity::*;
        let cases = [
            ("frequency_hz", Frequency, Some(Unit::Hertz)),
            ("angular_frequency_rad_s", Frequency, Some(Unit::RadPerSecond)),
            ("Angular Frequency [rad/s]", Frequency, Some(Unit::RadPerSecond)),
            ("Frequency", Frequency, None),
            ("f/Hz", Frequency, Some(Unit::Hertz)),
            ("storage_modulus_pa", Storage, Some(Unit::Pascal(1.0))),
            ("Storage modulus (MPa)", Storage, Some(Unit::Pascal(1e6))),
            ("E'/MPa", Storage, Some(Unit::Pascal(1e6))),
            ("E_stor", Storage, None),
            ("G\"", Loss, None),
            ("E''(GPa)", Loss, Some(Unit::Pascal(1e9))),
            ("tan(delta)", LossFactor, None),
            ("Tan(δ)", LossFactor, None),
            ("##Temp./°C", Temperature, Some(Unit::Celsius)),
            ("temperature_k", Temperature, Some(Unit::Kelvin)),
            ("T [K]", Temperature, Some(Unit::Kelvin)),
            ("strain_percent", Strain, Some(Unit::Percent)),
            ("Strain (%)", Strain, Some(Unit::Percent)),
            ("strain", Strain, None),
            ("log10_shift", Log10Shift, None),
            ("shift_factor", ShiftFactor, None),
        ];
        for (cell, quantity, unit) in cases {
            let found = named(cell).unwrap_or_else(|| panic!("{cell}"));
            assert_eq!((found.quantity, found.unit), (quantity, unit), "{cell}");
        }
        for other in ["t [s]", "Point No.", "Time/min", "Normal force", "", "(at", "E* / MPa"] {
            assert_eq!(named(other), None, "{other}");
        }
        assert_eq!(named("E' (MPa)").and_then(|named| named.symbol), Some('E'));
        assert_eq!(unit("mPa", Storage), None);
    }
}
