//! What helps to find a mistake in a recipe: its line, and the key that was meant.

use super::Violation;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Names less alike than this are no misspellings of each other (Jaro and Winkler, 1 being equal).
const ALIKE: f64 = 0.8;

/// The known key that an unknown one looks like most, from the message of the parser, which quotes the unknown
/// one first and then the known ones.
pub(super) fn nearest_key(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    let (true, Some(unknown)) = (message.starts_with("unknown "), quoted.next()) else {
        return String::new();
    };
    let alike = |known: &&str| strsim::jaro_winkler(unknown, known);
    quoted
        .filter(|known| alike(known) >= ALIKE)
        .max_by(|a, b| alike(a).total_cmp(&alike(b)))
        .map_or_else(String::new, |known| format!("\ndid you mean `{known}`?"))
}

/// Number of the line that a violation speaks of, from 1; none where the recipe has no such key and the
/// value is that of a default.
pub(super) fn line(text: &str, violation: &Violation) -> Option<usize> {
    let key = match violation {
        Violation::Demand { key, .. } => *key,
        Violation::SectionBesideSinusoid { section } => *section,
        Violation::HybridWithoutMicro => "hybrid",
        Violation::Text(_) => "ingest.text",
        Violation::Conditioning(_) => "ingest.conditioning",
        Violation::SeveralCases { .. } | Violation::SweepOfSinusoid => "sweep",
        Violation::MissingSection { .. } => return None,
    };
    let document = DeTable::parse(text).ok()?;
    let start = start(document.get_ref(), key)?;
    Some(1 + text[..start].matches('\n').count())
}

/// Where a dotted key begins, in bytes; of several in parentheses, the first in the text.
fn start(table: &DeTable, key: &str) -> Option<usize> {
    if let Some(several) = key.strip_prefix('(').and_then(|keys| keys.strip_suffix(')')) {
        return several.split(", ").filter_map(|key| start(table, key)).min();
    }
    let (first, rest) =
        key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let (name, value): (&Spanned<_>, &Spanned<DeValue>) = table.get_key_value(first)?;
    match (rest, value.get_ref()) {
        (None, _) => Some(name.span().start),
        (Some(rest), DeValue::Table(inner)) => start(inner, rest),
        (Some(_), _) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECIPE: &str = "title = 'x'\n\n[bem]\nrubber = 'r'\nspeeds_mm_s = [\n    1.0,\n]\n\n\
                          [ingest]\nconditioning.form = 'mean'\ntext = { x_unit = 'mm' }\n";

    fn demand(key: &'static str) -> Option<usize> {
        line(RECIPE, &Violation::Demand { key, value: String::new(), demand: "" })
    }

    #[test]
    fn keys_are_found_however_they_are_written() {
        assert_eq!(demand("title"), Some(1));
        assert_eq!(demand("bem"), Some(3));
        assert_eq!(demand("bem.speeds_mm_s"), Some(5));
        assert_eq!(demand("ingest.conditioning.form"), Some(10));
        assert_eq!(demand("ingest.text.x_unit"), Some(11));
        assert_eq!(demand("bem.(tolerance, speeds_mm_s, rubber)"), Some(4));
        assert_eq!(demand("bem.tolerance"), None);
        assert_eq!(demand("bem.rubber.name"), None);
        assert_eq!(line(RECIPE, &Violation::MissingSection { section: "realise" }), None);
        let beside = Violation::SectionBesideSinusoid { section: "bem" };
        assert_eq!(line(RECIPE, &beside), Some(3));
    }

    #[test]
    fn only_names_that_are_alike_are_proposed() {
        let message = |unknown: &str| {
            nearest_key(&format!(
                "unknown field `{unknown}`, expected one of `rubber`, `tolerance`"
            ))
        };
        assert_eq!(message("tolerence"), "\ndid you mean `tolerance`?");
        assert_eq!(message("friction"), "");
        assert_eq!(nearest_key("invalid type: `rubbe`, expected `rubber`"), "");
    }
}
