//! The XML document of an X3P file: the texts of the elements that are read, and the heights that
//! stand in it.

use super::super::LARGEST_POINTS;
use super::super::error::{FileProblem, Place, unexpected};
use quick_xml::Reader;
use quick_xml::events::{BytesRef, Event};
use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read};

/// Deeper than any document of the standard.
const DEEPEST: usize = 32;
/// More elements, without the data, than any document of the standard has.
const MOST_ELEMENTS: usize = 100_000;
/// Longest tag, comment or text in bytes; a text may be longer where it is not read.
const LONGEST: usize = 1 << 18;
/// Heights that a document may give before it states their number.
const MOST_UNDECLARED: u64 = 1 << 16;
/// The shortest datum, `<Datum/>`.
const SHORTEST_DATUM: u64 = 8;
const DATUM: &str = "Record3/DataList/Datum";
const LIST: &str = "Record3/ListDimension";

/// Elements whose text is read, by their path below the root. Of all others nothing is kept, so
/// that a document takes no memory but that of these and its heights.
const READ: [&str; 28] = [
    "Record1/FeatureType",
    "Record1/Axes/CX/AxisType",
    "Record1/Axes/CX/Increment",
    "Record1/Axes/CY/AxisType",
    "Record1/Axes/CY/Increment",
    "Record1/Axes/CZ/AxisType",
    "Record1/Axes/CZ/DataType",
    "Record1/Axes/CZ/Increment",
    "Record1/Axes/CZ/Offset",
    "Record2/Instrument/Manufacturer",
    "Record2/Instrument/Model",
    "Record2/Instrument/Serial",
    "Record2/Instrument/Version",
    "Record2/ProbingSystem/Type",
    "Record2/ProbingSystem/Identification",
    "Record2/Date",
    "Record2/Creator",
    "Record2/Comment",
    LIST,
    "Record3/MatrixDimension/SizeX",
    "Record3/MatrixDimension/SizeY",
    "Record3/MatrixDimension/SizeZ",
    "Record3/DataLink/PointDataLink",
    "Record3/DataLink/MD5ChecksumPointData",
    "Record3/DataLink/ValidPointsLink",
    "Record3/DataLink/MD5ChecksumValidPoints",
    DATUM,
    "Record4/ChecksumFile",
];

/// Text of each element that is read by its path below the root, and the data in their order.
#[derive(Default)]
pub(super) struct Document {
    texts: BTreeMap<&'static str, String>,
    /// Heights in units of the document; NaN where a datum is empty.
    pub(super) data: Vec<f64>,
}

impl Document {
    /// Reads a document of at most `size` bytes. Entities other than the five of XML and document
    /// types are refused: the format needs none, and they can grow without bound or name other
    /// files.
    pub(super) fn parse(document: impl Read, size: u64) -> Result<Self, FileProblem> {
        let mut reader = Reader::from_reader(Bounded::new(document));
        let mut state = State { size, ..State::default() };
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            reader.get_mut().left = LONGEST;
            let at = reader.buffer_position();
            let damaged = |reason: String| FileProblem::Damaged {
                place: Place::Member(super::MAIN.into()),
                reason: format!("byte {at}: {reason}"),
            };
            match reader.read_event_into(&mut buffer) {
                Err(error) => return Err(damaged(error.to_string())),
                Ok(Event::Eof) if state.depth() > 0 => {
                    return Err(damaged(format!("ends within {}", shown(state.name()))));
                }
                Ok(Event::Eof) if state.elements == 0 => {
                    let place = Place::Member(super::MAIN.into());
                    let expected = "XML; export the scan again";
                    return Err(unexpected(place, "the document", "empty", expected));
                }
                Ok(Event::Eof) => return Ok(state.document),
                Ok(Event::Start(element)) => state.open(element.local_name().as_ref())?,
                Ok(Event::Empty(element)) => {
                    state.open(element.local_name().as_ref())?;
                    state.close()?;
                }
                Ok(Event::End(_)) => state.close()?,
                Ok(Event::Text(text)) => {
                    state.push(&text.decode().map_err(|error| damaged(error.to_string()))?)?;
                }
                Ok(Event::CData(text)) => {
                    state.push(&text.decode().map_err(|error| damaged(error.to_string()))?)?;
                }
                Ok(Event::GeneralRef(entity)) => {
                    state.push(character(&entity)?.encode_utf8(&mut [0; 4]))?;
                }
                Ok(Event::DocType(_)) => {
                    return Err(FileProblem::Unsupported {
                        place: Place::Member(super::MAIN.into()),
                        what: format!("a document type (byte {at})"),
                        advice: "an X3P file has none; ask where it comes from",
                    });
                }
                Ok(Event::Decl(_) | Event::PI(_) | Event::Comment(_)) => {}
            }
        }
    }

    /// Whether the document gives points without a grid.
    pub(super) fn has_list_of_points(&self) -> bool {
        self.texts.contains_key(LIST)
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

    /// Number of points by the size of the matrix, where it has been read and is one.
    fn points(&self) -> Option<u64> {
        let size = |path| self.text(path)?.parse::<u64>().ok();
        let (x, y) = (size("Record3/MatrixDimension/SizeX"), size("Record3/MatrixDimension/SizeY"));
        x?.checked_mul(y?)
    }
}

#[derive(Default)]
struct State {
    document: Document,
    /// Path of the open element below the root.
    path: String,
    /// Lengths of the path above each open element.
    above: Vec<usize>,
    /// Text of the open element, if it is one of those that are read.
    text: String,
    elements: usize,
    /// Bytes of the document.
    size: u64,
}

impl State {
    fn depth(&self) -> usize {
        self.above.len()
    }

    fn name(&self) -> &str {
        &self.path
    }

    fn open(&mut self, name: &[u8]) -> Result<(), FileProblem> {
        if self.depth() == DEEPEST {
            return Err(self.too_large("the depth of elements", DEEPEST as u64));
        }
        let is_root = self.depth() == 0;
        self.above.push(self.path.len());
        if !is_root {
            if !self.path.is_empty() {
                self.path.push('/');
            }
            self.path.push_str(&String::from_utf8_lossy(name));
        }
        if self.path.len() > LONGEST {
            return Err(self.too_large("the length of the names of elements", LONGEST as u64));
        }
        self.text.clear();
        Ok(())
    }

    fn push(&mut self, text: &str) -> Result<(), FileProblem> {
        if self.read().is_none() {
            return Ok(());
        }
        if self.text.len() + text.len() > LONGEST {
            return Err(self.too_large("the length of the text", LONGEST as u64));
        }
        self.text.push_str(text);
        Ok(())
    }

    /// The open element, if it is one of those that are read.
    fn read(&self) -> Option<&'static str> {
        READ.into_iter().find(|path| *path == self.path)
    }

    fn close(&mut self) -> Result<(), FileProblem> {
        match self.read() {
            Some(DATUM) => self.datum()?,
            read => {
                self.elements += 1;
                if self.elements > MOST_ELEMENTS {
                    return Err(self.too_large("the number of elements", MOST_ELEMENTS as u64));
                }
                // The first of several layers or channels counts.
                if let Some(path) = read {
                    let text = std::mem::take(&mut self.text);
                    self.document.texts.entry(path).or_insert(text);
                }
            }
        }
        self.text.clear();
        self.path.truncate(self.above.pop().unwrap_or(0));
        Ok(())
    }

    fn datum(&mut self) -> Result<(), FileProblem> {
        let number = self.document.data.len() as u64 + 1;
        let place = || Place::Element(format!("{DATUM}[{number}]"));
        let value = match self.text.trim() {
            "" => f64::NAN,
            text => text.parse().map_err(|_| unexpected(place(), "a height", text, "a number"))?,
        };
        if number == 1 {
            // The stated number is used as far as the document can hold that many.
            let most = (self.size / SHORTEST_DATUM).min(LARGEST_POINTS);
            let points = self.document.points().unwrap_or(0).min(most);
            self.document.data.reserve_exact(points as usize);
        }
        if number > self.document.points().unwrap_or(MOST_UNDECLARED).min(LARGEST_POINTS) {
            let place = Place::Element("Record3/DataList".into());
            return Err(match self.document.points() {
                Some(points) => {
                    unexpected(place, "the number of data", format!("{number} or more"), points)
                }
                None => {
                    let expected = "stated in MatrixDimension before the data";
                    unexpected(place, "the number of data", number, expected)
                }
            });
        }
        self.document.data.push(value);
        Ok(())
    }

    fn too_large(&self, what: &'static str, limit: u64) -> FileProblem {
        let place = Place::Element(shown(&self.path));
        FileProblem::TooLarge { place, what, size: limit + 1, limit }
    }
}

/// A path for a message.
fn shown(path: &str) -> String {
    const LONGEST_SHOWN: usize = 80;
    path.chars().take(LONGEST_SHOWN).flat_map(char::escape_debug).collect()
}

/// The character of a numeric reference or of one of the five entities of XML.
fn character(entity: &BytesRef<'_>) -> Result<char, FileProblem> {
    if let Ok(Some(character)) = entity.resolve_char_ref() {
        return Ok(character);
    }
    let name: &[u8] = entity;
    match name {
        b"amp" => Ok('&'),
        b"lt" => Ok('<'),
        b"gt" => Ok('>'),
        b"quot" => Ok('"'),
        b"apos" => Ok('\''),
        _ => Err(FileProblem::Unsupported {
            place: Place::Member(super::MAIN.into()),
            what: format!("the entity `{}`", shown(&String::from_utf8_lossy(name))),
            advice: "an X3P file has none of its own; ask where it comes from",
        }),
    }
}

/// A reader that gives no more than [`LONGEST`] bytes to one event: the parser holds a complete event.
struct Bounded<R> {
    reader: BufReader<R>,
    left: usize,
}

impl<R: Read> Bounded<R> {
    fn new(reader: R) -> Self {
        Self { reader: BufReader::new(reader), left: LONGEST }
    }
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reader.read(buffer)
    }
}

impl<R: Read> BufRead for Bounded<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let left = self.left;
        let available = self.reader.fill_buf()?;
        if left == 0 && !available.is_empty() {
            let reason = format!("a tag, text or comment of more than {LONGEST} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        Ok(&available[..available.len().min(left)])
    }

    fn consume(&mut self, amount: usize) {
        self.left = self.left.saturating_sub(amount);
        self.reader.consume(amount);
    }
}
