//! Profiles as XML of the reference data base of surface metrology (NIST SMATS): units, number of
//! points and spacing in elements of a header, heights as numbers between the tags of
//! `DATA_POINT_VALUES`. Spacing and heights have the same unit.

use super::bytes::count;
use super::error::{FileProblem, Place, unexpected};
use super::{Grid, ScanFile, metres_of, spacing};
use quick_xml::Reader;
use quick_xml::events::Event;

const HEIGHTS: &str = "DATA_POINT_VALUES";
/// Elements that are kept of the header: name, and what inspect calls it.
const FIELDS: [(&str, &str); 4] = [
    ("PART_NAME", "title"),
    ("PART_MANUFACTURER", "manufacturer"),
    ("PART_DESCRIPTION", "comment"),
    ("MEASUREMENT_INSTRUMENT_TYPE", "model"),
];
/// Characters of a value of the header that are kept.
const LONGEST_VALUE: usize = 200;

/// Whether an XML document begins like such a profile.
pub(super) fn is_header(start: &[u8]) -> bool {
    let start = start.trim_ascii_start();
    let has = |tag: &[u8]| start.windows(tag.len()).any(|part| part == tag);
    start.starts_with(b"<")
        && (has(b"<DATA_POINT_VALUES") || (has(b"<DATAFILE>") && has(b"<NUMPOINTS>")))
}

#[derive(Default)]
struct Profile {
    unit: String,
    points: String,
    spacing: String,
    kind: String,
    heights: Vec<f64>,
    instrument: Vec<(String, String)>,
}

/// Reads a profile of the data base.
pub(super) fn read(bytes: &[u8]) -> Result<ScanFile, FileProblem> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => std::borrow::Cow::Borrowed(text),
        Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0,
    };
    let profile = parse(text.strip_prefix('\u{feff}').unwrap_or(&text))?;
    let element = |name: &str| Place::Element(name.into());
    if !["", "2D"].contains(&profile.kind.as_str()) {
        return Err(FileProblem::Unsupported {
            place: element("DATA_TYPE"),
            what: format!("data of type `{}`", profile.kind),
            advice: "profiles (2D) are read; export a map as X3P or SDF",
        });
    }
    let metres = metres_of(&profile.unit).ok_or_else(|| {
        unexpected(element("UNITS"), "the unit", &profile.unit, "a length, such as um")
    })?;
    let points = profile.points.parse::<u64>().map_err(|_| {
        unexpected(element("NUMPOINTS"), "the number of points", &profile.points, "a whole number")
    })?;
    let (points, _) = count(element("NUMPOINTS"), points, 1)?;
    if points != profile.heights.len() {
        let expected = format!("{points} as NUMPOINTS says; copy the file again");
        let found = profile.heights.len();
        return Err(unexpected(element(HEIGHTS), "the number of heights", found, expected));
    }
    let step: f64 = profile
        .spacing
        .parse()
        .map_err(|_| unexpected(element("SPACING"), "the spacing", &profile.spacing, "a number"))?;
    Ok(ScanFile {
        format: "XML profile (SMATS)".into(),
        detected: format!(
            "an XML document with heights between the tags of {HEIGHTS}: spacing and heights in {}",
            profile.unit
        ),
        grid: Grid::Profile { spacing: spacing(element("SPACING"), step * metres)? },
        heights: profile.heights.into_iter().map(|height| height * metres).collect(),
        instrument: profile.instrument,
    })
}

fn parse(text: &str) -> Result<Profile, FileProblem> {
    let mut reader = Reader::from_str(text);
    let mut profile = Profile::default();
    let mut name = String::new();
    loop {
        let offset = reader.buffer_position() as usize;
        let damaged = |reason: String| FileProblem::Damaged { place: Place::Byte(offset), reason };
        match reader.read_event().map_err(|error| damaged(error.to_string()))? {
            Event::Start(tag) => {
                // The last 40 bytes of a name are more than any that is known.
                let tag = tag.name();
                name = String::from_utf8_lossy(&tag.as_ref()[..tag.as_ref().len().min(40)])
                    .into_owned();
            }
            Event::End(_) => name.clear(),
            Event::Text(part) => {
                let part =
                    std::str::from_utf8(&part).map_err(|error| damaged(error.to_string()))?;
                profile.take(&name, part)?;
            }
            Event::Eof => return Ok(profile),
            _ => {}
        }
    }
}

impl Profile {
    /// Takes the text of an element.
    fn take(&mut self, element: &str, text: &str) -> Result<(), FileProblem> {
        if element == HEIGHTS {
            for word in text.split_ascii_whitespace() {
                let number = word.parse().ok().filter(|number: &f64| number.is_finite());
                let place = Place::Height(self.heights.len() + 1);
                self.heights
                    .push(number.ok_or_else(|| unexpected(place, "a height", word, "a number"))?);
            }
            return Ok(());
        }
        let value: String = text.trim().chars().take(LONGEST_VALUE).collect();
        let field = match element {
            "UNITS" => Some(&mut self.unit),
            "NUMPOINTS" => Some(&mut self.points),
            "SPACING" => Some(&mut self.spacing),
            "DATA_TYPE" => Some(&mut self.kind),
            _ => None,
        };
        match field {
            Some(field) if !field.is_empty() && *field != value => {
                let both = format!("{element} {value} beside {field}");
                let what = "a second value of an element";
                return Err(unexpected(
                    Place::Element(element.to_owned()),
                    what,
                    both,
                    "one value",
                ));
            }
            Some(field) => *field = value,
            None => {
                let known = FIELDS.iter().find(|(name, _)| *name == element);
                let is_new = |key: &str| self.instrument.iter().all(|(name, _)| name != key);
                if let Some((_, key)) = known.filter(|(_, key)| is_new(key) && !value.is_empty()) {
                    self.instrument.push(((*key).to_owned(), value));
                }
            }
        }
        Ok(())
    }
}
