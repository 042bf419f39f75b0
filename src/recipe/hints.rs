//! Where a mistake stands in a recipe, and what was typed there.

use crate::requirement::InvalidRecipe;
use crate::scans::ScanProblem;
use crate::surface::ConditioningError;
use crate::surface::map::condition::MapConditioningError;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longer values are shown up to here.
const LONGEST_VALUE: usize = 80;

/// Number of the line that a violation speaks of, from 1, and the value there as it was typed; none where the
/// recipe has no such key and the value is that of a default.
pub(super) fn place(text: &str, violation: &InvalidRecipe) -> (Option<usize>, Option<String>) {
    let found = DeTable::parse(text).ok().and_then(|document| {
        let key = key(violation)?;
        let start = start(document.get_ref(), &key)?;
        let typed = value(document.get_ref(), &key).and_then(|span| text.get(span));
        Some((1 + text[..start].matches('\n').count(), typed.map(shortened)))
    });
    found.map_or((None, None), |(line, typed)| (Some(line), typed))
}

/// The key of a violation with its section.
fn key(violation: &InvalidRecipe) -> Option<String> {
    let key = match violation {
        InvalidRecipe::Value { key, .. } => *key,
        InvalidRecipe::SectionBesideSinusoid { section } => *section,
        InvalidRecipe::HybridWithoutMicro => "hybrid",
        InvalidRecipe::Text(ScanProblem::Description { key, .. }) => {
            return Some(format!("ingest.text.{key}"));
        }
        InvalidRecipe::Text(_) => "ingest.text",
        InvalidRecipe::Conditioning(ConditioningError::Parameter { key, .. }) => {
            return Some(format!("ingest.conditioning.{key}"));
        }
        InvalidRecipe::Conditioning(_) => "ingest.conditioning",
        InvalidRecipe::MapConditioning(MapConditioningError::Parameter { key, .. }) => {
            return Some(format!("ingest.maps.{key}"));
        }
        InvalidRecipe::MapConditioning(_) => "ingest.maps",
        InvalidRecipe::SeveralCases { .. } | InvalidRecipe::SweepOfSinusoid => "sweep",
        InvalidRecipe::Missing { key, .. } => *key,
        InvalidRecipe::MissingSection { .. } | InvalidRecipe::SpectrumAlone => return None,
    };
    Some(key.to_owned())
}

/// A value on one line, cut where it is long.
fn shortened(value: &str) -> String {
    let words = value.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(LONGEST_VALUE) {
        Some((end, _)) => format!("{} ...", &words[..end]),
        None => words,
    }
}

/// The bytes of the value of a dotted key; none for several keys and for sections.
fn value(table: &DeTable, key: &str) -> Option<std::ops::Range<usize>> {
    let (first, rest) =
        key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let value = table.get(first)?;
    match (rest, value.get_ref()) {
        (Some(rest), DeValue::Table(inner)) => self::value(inner, rest),
        (Some(_), _) | (None, DeValue::Table(_)) => None,
        (None, _) => Some(value.span()),
    }
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
        // A key that is missing is missed in its section.
        (Some(rest), DeValue::Table(inner)) => {
            Some(start(inner, rest).unwrap_or(name.span().start))
        }
        (Some(_), _) => Some(name.span().start),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECIPE: &str = "title = 'x'\n\n[bem]\nrubber = 'r'\nspeeds_mm_s = [\n    1.0,\n]\n\n\
                          [ingest]\nconditioning.form = 'mean'\ntext = { x_unit = 'mm' }\n";

    fn line(violation: &InvalidRecipe) -> Option<usize> {
        place(RECIPE, violation).0
    }

    fn line_of(key: &'static str) -> Option<usize> {
        line(&InvalidRecipe::Value { key, value: String::new(), required: "" })
    }

    #[test]
    fn keys_are_found_however_they_are_written() {
        assert_eq!(line_of("title"), Some(1));
        assert_eq!(line_of("bem"), Some(3));
        assert_eq!(line_of("bem.speeds_mm_s"), Some(5));
        assert_eq!(line_of("ingest.conditioning.form"), Some(10));
        assert_eq!(line_of("ingest.text.x_unit"), Some(11));
        assert_eq!(line_of("bem.(tolerance, speeds_mm_s, rubber)"), Some(4));
        // Keys that are not there are missed in their section.
        assert_eq!(line_of("bem.tolerance"), Some(3));
        assert_eq!(line_of("realise.seed"), None);
        let typed = |key| {
            place(RECIPE, &InvalidRecipe::Value { key, value: String::new(), required: "" }).1
        };
        assert_eq!(typed("bem.speeds_mm_s").as_deref(), Some("[ 1.0, ]"));
        assert_eq!(typed("ingest.text.x_unit").as_deref(), Some("'mm'"));
        assert_eq!(typed("bem"), None);
        assert_eq!(line(&InvalidRecipe::MissingSection { section: "realise" }), None);
        let beside = InvalidRecipe::SectionBesideSinusoid { section: "bem" };
        assert_eq!(line(&beside), Some(3));
    }
}
