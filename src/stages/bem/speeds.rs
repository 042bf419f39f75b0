//! Sliding speeds of a recipe: a list, or a range.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::fmt;

/// Speeds in equal steps of their logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct SpeedRange {
    /// Smallest speed in mm/s.
    from: f64,
    /// Largest speed in mm/s.
    to: f64,
    /// Speeds in every decade.
    per_decade: u32,
}

/// More speeds in a decade than this are a mistake: friction is smooth over speed.
const MOST_PER_DECADE: u32 = 100;
/// Digits of the speeds of a range, which name tables and files.
const DIGITS: i32 = 4;

impl SpeedRange {
    /// The speeds, rounded to four digits; both ends are there as they are typed.
    fn speeds(self) -> Result<Vec<f64>, String> {
        let Self { from, to, per_decade } = self;
        if !(from > 0.0 && from < to && to.is_finite()) {
            return Err(format!(
                "a range of speeds from {from} to {to} mm/s; `from` must be positive and below `to`"
            ));
        }
        if !(1..=MOST_PER_DECADE).contains(&per_decade) {
            return Err(format!(
                "per_decade = {per_decade}; 1 to {MOST_PER_DECADE} speeds in a decade"
            ));
        }
        let step = f64::from(per_decade).recip();
        let inside = (1..)
            .map(|k| rounded(from * 10.0_f64.powf(f64::from(k) * step)))
            .take_while(|speed| *speed < to * (1.0 - 0.1 * step));
        Ok([from].into_iter().chain(inside).chain([to]).collect())
    }
}

fn rounded(speed: f64) -> f64 {
    let unit = 10.0_f64.powi(speed.log10().floor() as i32 + 1 - DIGITS);
    // By text, so that 2.154 is the number that is typed as 2.154.
    let digits = (DIGITS - 1 - speed.log10().floor() as i32).max(0) as usize;
    format!("{:.digits$}", (speed / unit).round() * unit).parse().unwrap_or(speed)
}

/// As [`deserialize`], of a key that may be left out.
pub(crate) fn deserialize_some<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<f64>>, D::Error> {
    deserialize(deserializer).map(Some)
}

/// Reads a list of speeds, or a range of them, as a list.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<f64>, D::Error> {
    deserializer.deserialize_any(Written)
}

struct Written;

impl<'de> Visitor<'de> for Written {
    type Value = Vec<f64>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of speeds in mm/s, or { from = 0.001, to = 10000, per_decade = 3 }")
    }

    // What is typed in place of a list is answered as where only a list is possible: put it in brackets.
    fn visit_i64<E: Error>(self, number: i64) -> Result<Vec<f64>, E> {
        Err(E::invalid_type(Unexpected::Signed(number), &"a sequence"))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Vec<f64>, E> {
        Err(E::invalid_type(Unexpected::Float(number), &"a sequence"))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Vec<f64>, E> {
        Err(E::invalid_type(Unexpected::Str(text), &"a sequence"))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec<f64>, A::Error> {
        Vec::deserialize(value::SeqAccessDeserializer::new(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<f64>, A::Error> {
        let range = SpeedRange::deserialize(value::MapAccessDeserializer::new(map))?;
        range.speeds().map_err(A::Error::custom)
    }
}

/// How speeds are written, for the schema of recipes.
pub(crate) struct Speeds;

impl JsonSchema for Speeds {
    fn schema_name() -> Cow<'static, str> {
        "Speeds".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let number = json_schema!({ "type": "number" });
        json_schema!({
            "anyOf": [
                { "type": "array", "items": number },
                {
                    "type": "object",
                    "description": "Speeds in equal steps of their logarithm, rounded to four digits.",
                    "properties": {
                        "from": { "type": "number", "description": "Smallest speed in mm/s." },
                        "to": { "type": "number", "description": "Largest speed in mm/s." },
                        "per_decade": {
                            "type": "integer", "minimum": 1, "maximum": MOST_PER_DECADE,
                            "description": "Speeds in every decade."
                        }
                    },
                    "required": ["from", "to", "per_decade"],
                    "additionalProperties": false
                }
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Section {
        #[serde(deserialize_with = "deserialize")]
        speeds: Vec<f64>,
    }

    fn read(speeds: &str) -> Result<Vec<f64>, String> {
        let section = toml::from_str(&format!("speeds = {speeds}"));
        section.map(|section: Section| section.speeds).map_err(|error| error.to_string())
    }

    #[test]
    fn a_range_is_its_speeds_with_both_ends() {
        let three = read("{ from = 0.001, to = 1, per_decade = 3 }").unwrap();
        let expected =
            [0.001, 0.002154, 0.004642, 0.01, 0.02154, 0.04642, 0.1, 0.2154, 0.4642, 1.0];
        assert_eq!(three, expected);
        assert_eq!(
            read("{ from = 10, to = 2800, per_decade = 1 }").unwrap(),
            [10.0, 100.0, 1000.0, 2800.0]
        );
        assert_eq!(
            read("{ from = 500.0, to = 5e4, per_decade = 1 }").unwrap(),
            [500.0, 5000.0, 5e4]
        );
        assert_eq!(read("[10, 50.0]").unwrap(), [10.0, 50.0]);
    }

    #[test]
    fn what_is_no_range_is_refused_in_words() {
        let refused = |text: &str| read(text).unwrap_err();
        assert!(refused("{ from = 5, to = 1, per_decade = 3 }").contains("from 5 to 1 mm/s"));
        assert!(refused("{ from = 1, to = 5, per_decade = 0 }").contains("per_decade = 0"));
        assert!(refused("{ from = 1, to = 5 }").contains("per_decade"));
        assert!(refused("{ from = 1, to = 5, per_decade = 2, faster = 1 }").contains("faster"));
        assert!(refused("\"fast\"").contains("a sequence"));
        assert!(refused("10").contains("a sequence"));
        assert!(refused("true").contains("a list of speeds"));
        assert!(refused("{ from = nan, to = 5, per_decade = 2 }").contains("positive"));
    }
}
