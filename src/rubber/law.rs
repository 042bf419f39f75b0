//! The section `[finite_strain]` of a rubber file.

use asperity_core::rubber::Rheology;
use serde::Deserialize;

/// The section as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiniteStrainEntry {
    law: LawName,
    c2_over_c1: Option<f64>,
    c3_over_c1: Option<f64>,
    locking_stretch: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum LawName {
    NeoHookean,
    Yeoh,
    ArrudaBoyce,
}

/// Why the keys of the section do not make a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LawProblem {
    /// A constant that the law has is not there.
    #[error("[finite_strain] has law = \"{law}\" and no {key}, which that law needs")]
    Missing {
        /// The law.
        law: &'static str,
        /// The key.
        key: &'static str,
    },
    /// A constant that the law has not.
    #[error("[finite_strain] has law = \"{law}\" and {key}, which is of another law: leave it out")]
    OfAnotherLaw {
        /// The law.
        law: &'static str,
        /// The key.
        key: &'static str,
    },
}

impl FiniteStrainEntry {
    /// The law with its constants.
    pub fn law(&self) -> Result<Rheology, LawProblem> {
        let (c2, c3, stretch) = (
            ("c2_over_c1", self.c2_over_c1),
            ("c3_over_c1", self.c3_over_c1),
            ("locking_stretch", self.locking_stretch),
        );
        let law = self.law.name();
        let needed = |(key, value): (&'static str, Option<f64>)| {
            value.ok_or(LawProblem::Missing { law, key })
        };
        let none_of = |keys: &[(&'static str, Option<f64>)]| {
            let given = keys.iter().find(|(_, value)| value.is_some());
            given.map_or(Ok(()), |(key, _)| Err(LawProblem::OfAnotherLaw { law, key }))
        };
        match self.law {
            LawName::NeoHookean => {
                none_of(&[c2, c3, stretch])?;
                Ok(Rheology::NeoHookean)
            }
            LawName::Yeoh => {
                none_of(&[stretch])?;
                Ok(Rheology::Yeoh { c2_over_c1: needed(c2)?, c3_over_c1: needed(c3)? })
            }
            LawName::ArrudaBoyce => {
                none_of(&[c2, c3])?;
                Ok(Rheology::ArrudaBoyce { locking_stretch: needed(stretch)? })
            }
        }
    }
}

impl LawName {
    fn name(self) -> &'static str {
        match self {
            Self::NeoHookean => "neo-hookean",
            Self::Yeoh => "yeoh",
            Self::ArrudaBoyce => "arruda-boyce",
        }
    }
}

/// The section as text, for a law other than neo-Hooke.
pub(super) fn to_lines(law: Rheology) -> Vec<String> {
    let lines: &[String] = match law {
        // No file names the linear law, which is for comparison.
        Rheology::NeoHookean | Rheology::Linear => &[],
        Rheology::Yeoh { c2_over_c1, c3_over_c1 } => &[
            "law = \"yeoh\"".into(),
            format!("c2_over_c1 = {c2_over_c1:?}"),
            format!("c3_over_c1 = {c3_over_c1:?}"),
        ],
        Rheology::ArrudaBoyce { locking_stretch } => {
            &["law = \"arruda-boyce\"".into(), format!("locking_stretch = {locking_stretch:?}")]
        }
    };
    let header = (!lines.is_empty()).then(|| "\n[finite_strain]".to_owned());
    header.into_iter().chain(lines.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Rheology, Rubber, RubberData, parse_rubber, to_toml};
    use std::path::Path;

    const RUBBER: &str = "name = 'tread'\nequilibrium_modulus_mpa = 4.0\npoisson_ratio = 0.49\n";

    fn parse(section: &str) -> Result<Rheology, String> {
        let text = format!("{RUBBER}[finite_strain]\n{section}");
        let parsed = parse_rubber(Path::new("tread.toml"), &text);
        parsed.map(|rubber| rubber.finite_strain).map_err(|error| {
            let source = std::error::Error::source(&error).map(ToString::to_string);
            format!("{error}: {}", source.unwrap_or_default())
        })
    }

    #[test]
    fn laws_are_read_and_written() {
        let plain = parse_rubber(Path::new("tread.toml"), RUBBER).unwrap();
        assert_eq!(plain.finite_strain, Rheology::NeoHookean);
        assert_eq!(parse("law = 'neo-hookean'"), Ok(Rheology::NeoHookean));
        let yeoh = Rheology::Yeoh { c2_over_c1: -0.125, c3_over_c1: 2e-2 };
        assert_eq!(parse("law = 'yeoh'\nc2_over_c1 = -0.125\nc3_over_c1 = 2e-2"), Ok(yeoh));
        let chains = Rheology::ArrudaBoyce { locking_stretch: 2.5 };
        assert_eq!(parse("law = 'arruda-boyce'\nlocking_stretch = 2.5"), Ok(chains));
        for finite_strain in [yeoh, chains, Rheology::NeoHookean] {
            let rubber = Rubber { finite_strain, ..Rubber::elastic(4e6, 0.49) };
            let text = to_toml(&RubberData::from(rubber.clone()), "curve.csv");
            assert_eq!(parse_rubber(Path::new("tread.toml"), &text).unwrap(), rubber);
        }
    }

    /// What results depend on says nothing of the law of a rubber that names none: old results stay valid.
    #[test]
    fn only_a_law_that_is_named_is_part_of_an_identity() {
        let value = |law| {
            let rubber = Rubber { finite_strain: law, ..Rubber::elastic(4e6, 0.49) };
            serde_json::to_value(rubber).unwrap()
        };
        assert!(value(Rheology::NeoHookean).get("finite_strain").is_none());
        let named = value(Rheology::ArrudaBoyce { locking_stretch: 2.5 });
        let expected = serde_json::json!({ "law": "arruda-boyce", "locking_stretch": 2.5 });
        assert_eq!(named["finite_strain"], expected);
    }

    #[test]
    fn keys_of_no_law_and_of_another_one_are_named() {
        let refused = |section: &str, text: &str| {
            let error = parse(section).unwrap_err();
            assert!(error.contains(text) && error.contains("tread.toml"), "{error}");
        };
        refused("law = 'yeoh'\nc2_over_c1 = 0.1", "no c3_over_c1");
        refused("law = 'arruda-boyce'", "no locking_stretch");
        refused(
            "law = 'arruda-boyce'\nlocking_stretch = 2.0\nc2_over_c1 = 0.1",
            "c2_over_c1, which is of another law",
        );
        refused(
            "law = 'neo-hookean'\nlocking_stretch = 2.0",
            "locking_stretch, which is of another",
        );
        refused("law = 'arruda-boyce'\nlocking_stretch = 0.5", "locking_stretch is 0.5");
        refused("law = 'arruda-boyce'\nlocking_stretch = nan", "locking_stretch is NaN");
        refused("law = 'ogden'", "ogden");
        refused("law = 'yeoh'\nc4 = 1", "c4");
    }
}
