//! The XML document of an X3P file as the texts of its elements.

use super::super::LARGEST_POINTS;
use super::super::error::{FileProblem, Place, unexpected};
use quick_xml::Reader;
use quick_xml::events::{BytesRef, Event};
use std::collections::BTreeMap;

/// Deeper than any document of the standard.
const DEEPEST: usize = 32;
/// More elements, data apart, than any document of the standard.
const MOST_ELEMENTS: usize = 100_000;
const DATUM: &str = "Record3/DataList/Datum";

/// Text of each element by its path below the root, and the data in their order.
#[derive(Default)]
pub(super) struct Document {
    texts: BTreeMap<String, String>,
    pub(super) data: Vec<String>,
}

impl Document {
    /// Reads a document. Entities other than the five of XML and document types are refused:
    /// the format needs none, and they can grow without bound or name other files.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, FileProblem> {
        let mut reader = Reader::from_reader(bytes);
        let mut state = State::default();
        loop {
            let at = usize::try_from(reader.buffer_position()).unwrap_or(usize::MAX);
            let damaged = |reason: String| FileProblem::Damaged {
                place: Place::Member(super::MAIN.into()),
                reason: format!("byte {at}: {reason}"),
            };
            match reader.read_event().map_err(|error| damaged(error.to_string()))? {
                Event::Eof if state.path.is_empty() => return Ok(state.document),
                Event::Eof => return Err(damaged(format!("ends within {}", state.name()))),
                Event::Start(element) => {
                    state.open(element.local_name().as_ref())?;
                }
                Event::Empty(element) => {
                    state.open(element.local_name().as_ref())?;
                    state.close()?;
                }
                Event::End(_) => state.close()?,
                Event::Text(text) => {
                    state
                        .text
                        .push_str(&text.decode().map_err(|error| damaged(error.to_string()))?);
                }
                Event::CData(text) => {
                    state
                        .text
                        .push_str(&text.decode().map_err(|error| damaged(error.to_string()))?);
                }
                Event::GeneralRef(entity) => state.text.push(character(&entity)?),
                Event::DocType(_) => {
                    return Err(FileProblem::Unsupported {
                        place: Place::Member(super::MAIN.into()),
                        what: format!("a document type (byte {at})"),
                        advice: "an X3P file has none; ask where it comes from",
                    });
                }
                Event::Decl(_) | Event::PI(_) | Event::Comment(_) => {}
            }
        }
    }

    pub(super) fn contains(&self, path: &str) -> bool {
        let inside = format!("{path}/");
        self.texts.keys().any(|key| key == path || key.starts_with(&inside))
    }

    /// The text of an element, without the blanks around it.
    pub(super) fn text(&self, path: &str) -> Option<&str> {
        self.texts.get(path).map(|text| text.trim())
    }

    pub(super) fn required(&self, path: &str) -> Result<&str, FileProblem> {
        self.text(path).ok_or_else(|| {
            unexpected(Place::Element(path.to_owned()), "the element", "absent", "a text")
        })
    }

    /// The number in an element, `None` where it is absent or empty.
    pub(super) fn number(&self, path: &str) -> Result<Option<f64>, FileProblem> {
        match self.text(path) {
            None | Some("") => Ok(None),
            Some(text) => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(number)),
                _ => {
                    let place = Place::Element(path.to_owned());
                    Err(unexpected(place, "its text", text, "a finite number"))
                }
            },
        }
    }
}

#[derive(Default)]
struct State {
    document: Document,
    /// Names from the root to the open element.
    path: Vec<String>,
    text: String,
}

impl State {
    /// Path of the open element below the root.
    fn name(&self) -> String {
        self.path.get(1..).unwrap_or_default().join("/")
    }

    fn open(&mut self, name: &[u8]) -> Result<(), FileProblem> {
        if self.path.len() == DEEPEST {
            return Err(FileProblem::TooLarge {
                place: Place::Element(self.name()),
                what: "the depth of elements",
                size: DEEPEST as u64 + 1,
                limit: DEEPEST as u64,
            });
        }
        self.path.push(String::from_utf8_lossy(name).into_owned());
        self.text.clear();
        Ok(())
    }

    fn close(&mut self) -> Result<(), FileProblem> {
        let name = self.name();
        let text = std::mem::take(&mut self.text);
        self.path.pop();
        let (found, limit) = if name == DATUM {
            self.document.data.push(text);
            (self.document.data.len(), LARGEST_POINTS as usize)
        } else {
            // The first of several layers or channels counts.
            self.document.texts.entry(name.clone()).or_insert(text);
            (self.document.texts.len(), MOST_ELEMENTS)
        };
        if found > limit {
            let (size, limit) = (found as u64, limit as u64);
            let place = Place::Element(name);
            return Err(FileProblem::TooLarge {
                place,
                what: "the number of elements",
                size,
                limit,
            });
        }
        Ok(())
    }
}

/// The character of a numeric reference or of one of the five entities of XML.
fn character(entity: &BytesRef<'_>) -> Result<char, FileProblem> {
    if let Ok(Some(character)) = entity.resolve_char_ref() {
        return Ok(character);
    }
    let name = String::from_utf8_lossy(entity).into_owned();
    match name.as_str() {
        "amp" => Ok('&'),
        "lt" => Ok('<'),
        "gt" => Ok('>'),
        "quot" => Ok('"'),
        "apos" => Ok('\''),
        _ => Err(FileProblem::Unsupported {
            place: Place::Member(super::MAIN.into()),
            what: format!("the entity `{}`", name.chars().take(20).collect::<String>()),
            advice: "an X3P file has none of its own; ask where it comes from",
        }),
    }
}
