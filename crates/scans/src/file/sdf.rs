//! SDF, the surface data file: ISO 25178-71 (`ISO-1.0`, `ISO-2.0`) and its forerunner of report
//! EUR 15178 (`BCR-1.0`), as text (`a`) or binary (`b`).
//!
//! A header of fixed fields is followed by the heights, a row (profile) after the other, and a
//! trailer of free text. Binary headers count points in 16 bits, those of `ISO-2.0` in 32.

use super::bytes::{Cursor, Number, count, holds};
use super::error::{FileProblem, Place, of_line, shorten, unexpected};
use super::heights::{Binary, Checked, Heights};
use super::{OpenScan, grid, spacing};
use crate::Source;
use crate::last_number::LastNumber;
use crate::lines::Lines;
use encoding_rs::WINDOWS_1252;
use std::io::Read;

/// Dialect and encoding, the first eight bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Version {
    name: &'static str,
    text: bool,
}

impl Version {
    pub(super) fn detect(start: &[u8]) -> Option<Self> {
        const NAMES: [&str; 6] =
            ["aBCR-1.0", "aISO-1.0", "aISO-2.0", "bBCR-1.0", "bISO-1.0", "bISO-2.0"];
        let name = NAMES.into_iter().find(|name| start.starts_with(name.as_bytes()))?;
        Some(Self { name, text: name.starts_with('a') })
    }

    /// Whether a raw number marks a missing point.
    ///
    /// Integers: the largest of the type in BCR and of unsigned types, the smallest in ISO.
    /// Floating point: NaN or a number beyond 1e37, since writers use `±f32::MAX`, `±f64::MAX` or
    /// 1.7e308 and no height comes near.
    fn is_missing(self, value: f64, number: Number) -> bool {
        const LARGEST_HEIGHT: f64 = 1e37;
        match number.range() {
            None => value.is_nan() || value.abs() > LARGEST_HEIGHT,
            Some((smallest, largest)) if smallest == 0.0 || self.name.contains("BCR") => {
                value == largest
            }
            Some((smallest, _)) => value == smallest,
        }
    }
}

struct Header {
    columns: usize,
    rows: usize,
    /// Where the two are declared.
    place: Place,
    scales: [f64; 3],
    number: Number,
    instrument: Vec<(String, String)>,
}

/// Reads the header of an SDF file.
pub(super) fn open(source: Source<'_>) -> Result<OpenScan<'_>, FileProblem> {
    let version = Version::detect(source.start())
        .ok_or_else(|| unexpected(Place::Byte(0), "the version", "unknown", "aISO-1.0 or alike"))?;
    if version.text { open_text(source, version) } else { open_binary(source, version) }
}

impl Header {
    fn scan<'a>(self, version: Version, heights: impl Heights + 'a) -> OpenScan<'a> {
        let Self { columns, rows, place, scales: [x, y, _], number, mut instrument } = self;
        // Dates that are not known are twelve zeros.
        instrument.retain(|(_, value)| value.chars().any(|c| c != '0'));
        OpenScan {
            format: format!("SDF {}", version.name),
            detected: format!(
                "the first bytes are `{}`: surface data file, {}, heights as {number:?}",
                version.name,
                if version.text { "text" } else { "binary" }
            ),
            grid: grid(columns, rows, x, y),
            instrument,
            declared: Some((columns as u64 * rows as u64, place)),
            heights: Checked::new(heights),
        }
    }

    /// Metres of a raw number, NaN where it marks a missing point.
    fn metres(&self, version: Version) -> impl Fn(f64) -> f64 + use<> {
        let (number, z) = (self.number, self.scales[2]);
        move |value| if version.is_missing(value, number) { f64::NAN } else { value * z }
    }
}

fn number(code: u64, place: Place) -> Result<Number, FileProblem> {
    use Number::{F32, F64, I8, I16, I32, U8, U16, U32};
    const NUMBERS: [Number; 8] = [U8, U16, U32, F32, I8, I16, I32, F64];
    usize::try_from(code)
        .ok()
        .and_then(|code| NUMBERS.get(code).copied())
        .ok_or_else(|| unexpected(place, "DataType", code, "0 to 7"))
}

fn refuse_codes(compression: u64, check: u64, place: &Place) -> Result<(), FileProblem> {
    let what = match (compression, check) {
        (0, 0) => return Ok(()),
        (0, check) => format!("a checksum (CheckType {check})"),
        (compression, _) => format!("compression (Compression {compression})"),
    };
    let advice = "the standard defines none; save the file without";
    Err(FileProblem::Unsupported { place: place.clone(), what, advice })
}

/// A profile often states 0 as the distance to a next one.
fn check_scales(scales: &[f64; 3], rows: usize, [x, y, z]: [Place; 3]) -> Result<(), FileProblem> {
    spacing(x, scales[0])?;
    if rows > 1 {
        spacing(y, scales[1])?;
    }
    if scales[2] > 0.0 && scales[2].is_finite() {
        return Ok(());
    }
    let expected = "positive, metres for a unit of the heights; export the file again";
    Err(unexpected(z, "Zscale", scales[2], expected))
}

fn open_binary(source: Source<'_>, version: Version) -> Result<OpenScan<'_>, FileProblem> {
    let (header, offset) = binary_header(source.start(), source.length(), version)?;
    let points = header.columns as u64 * header.rows as u64;
    let (number, length) = (header.number, source.length());
    holds(length, offset, points * number.bytes() as u64, "the heights")?;
    let metres = header.metres(version);
    let heights = Binary::new(source.from(offset), number, points, metres, (offset, length));
    Ok(header.scan(version, heights))
}

/// The header of a binary file of `length` bytes, and where its heights start.
fn binary_header(
    bytes: &[u8],
    length: u64,
    version: Version,
) -> Result<(Header, usize), FileProblem> {
    let mut cursor = Cursor::at(bytes, 8);
    let instrument = vec![
        ("manufacturer".to_owned(), cursor.text(10, "ManufacID")?),
        ("created".to_owned(), cursor.text(12, "CreateDate")?),
        ("modified".to_owned(), cursor.text(12, "ModDate")?),
    ];
    let place = cursor.place();
    let mut size = |what| match version.name {
        "bISO-2.0" => cursor.u32(what).map(u64::from),
        _ => cursor.u16(what).map(u64::from),
    };
    let declared = (size("NumPoints")?, size("NumProfiles")?);
    let (columns, rows) = count(place.clone(), declared.0, declared.1)?;
    let scale_places = [0, 8, 16].map(|offset| Place::Byte(cursor.offset() + offset));
    let scales = [cursor.f64("Xscale")?, cursor.f64("Yscale")?, cursor.f64("Zscale")?];
    check_scales(&scales, rows, scale_places)?;
    cursor.f64("Zresolution")?;
    let code_place = cursor.place();
    let compression = cursor.u8("Compression")?;
    let number = number(u64::from(cursor.u8("DataType")?), Place::Byte(cursor.offset() - 1))?;
    refuse_codes(u64::from(compression), u64::from(cursor.u8("CheckType")?), &code_place)?;
    let mut offset = cursor.offset();
    // Some writers of ISO-1.0 put two more words between header and heights; then the file has
    // no trailer and is longer by just these.
    let needed = columns as u64 * rows as u64 * number.bytes() as u64;
    if version.name == "bISO-1.0"
        && length - offset as u64 == needed + 8
        && (cursor.u32("extra word")?, cursor.u32("extra word")?) == (5, 1)
    {
        offset += 8;
    }
    Ok((Header { columns, rows, place, scales, number, instrument }, offset))
}

/// Lines of `key = value`, `*`, heights between blanks, `*`, trailer.
fn open_text(source: Source<'_>, version: Version) -> Result<OpenScan<'_>, FileProblem> {
    let length = source.length();
    let mut lines = Lines::new(source.from(0));
    let header = text_header(&text_fields(&mut lines)?)?;
    let points = header.columns as u64 * header.rows as u64;
    // A digit each, and a blank between them.
    holds(length, version.name.len(), 2 * points - 1, "the heights")?;
    let metres = header.metres(version);
    let numbers = LastNumber::default();
    Ok(header.scan(version, TextHeights { lines, points, read: 0, numbers, metres }))
}

/// Keys, values and their lines up to the line `*`.
fn text_fields(lines: &mut Lines<impl Read>) -> Result<Vec<(String, String, usize)>, FileProblem> {
    /// The standard has thirteen.
    const MOST_FIELDS: usize = 1000;
    let mut fields: Vec<(String, String, usize)> = Vec::new();
    while lines.advance().map_err(|e| of_line(e, lines.number(), "a line end"))? {
        let line = lines.number();
        if line == 1 {
            continue;
        }
        let (text, _) = WINDOWS_1252.decode_without_bom_handling(lines.line());
        let text = text.trim();
        if text == "*" {
            return Ok(fields);
        }
        if let Some((key, value)) = text.split_once('=') {
            fields.push((start_of(key), start_of(value), line));
        } else if !text.is_empty() {
            return Err(unexpected(Place::Line(line), "the line", text, "`key = value` or `*`"));
        }
        if fields.len() > MOST_FIELDS {
            return Err(FileProblem::TooLarge {
                place: Place::Line(line),
                what: "the number of fields of the header",
                size: fields.len() as u64,
                limit: MOST_FIELDS as u64,
            });
        }
    }
    Err(unexpected(Place::Line(lines.number()), "the header", "not ended", "a line `*`"))
}

/// The start of a key or value, enough for all that the standard defines.
fn start_of(text: &str) -> String {
    const LONGEST: usize = 4096;
    text.trim().chars().take(LONGEST).collect()
}

/// Heights between blanks, as many as the header declares.
struct TextHeights<R, F> {
    lines: Lines<R>,
    points: u64,
    read: u64,
    numbers: LastNumber,
    metres: F,
}

impl<R: Read, F: Fn(f64) -> f64> TextHeights<R, F> {
    /// The next word but the `*` that ends the heights.
    fn word(&mut self) -> Result<bool, FileProblem> {
        let found = self.lines.word();
        let found = found.map_err(|e| of_line(e, self.lines.number(), "a blank"))?;
        Ok(found && self.lines.line() != b"*")
    }

    fn refuse_number(&self, found: impl std::fmt::Display) -> FileProblem {
        let expected =
            format!("{} (NumPoints times NumProfiles); copy the file again", self.points);
        let place = Place::Line(self.lines.number());
        unexpected(place, "the number of heights", found, expected)
    }
}

impl<R: Read, F: Fn(f64) -> f64> Heights for TextHeights<R, F> {
    fn read(&mut self, part: &mut Vec<f64>) -> Result<(), FileProblem> {
        const POINTS: usize = 1 << 13;
        while part.len() < POINTS && self.read < self.points {
            if !self.word()? {
                return Err(self.refuse_number(self.read));
            }
            let line = self.lines.number();
            let word = String::from_utf8_lossy(self.lines.line()).into_owned();
            part.push((self.metres)(height(&word, line)?));
            self.read += 1;
            if self.read < self.points {
                self.numbers.note(&word);
                continue;
            }
            let at_end = self.lines.is_at_end().map_err(|e| of_line(e, line, "a blank"))?;
            if at_end && !self.lines.is_ended() && self.numbers.is_cut(&word) {
                return Err(FileProblem::CutNumber { line, text: shorten(&word) });
            }
            if self.word()? {
                return Err(self.refuse_number(format!("{} or more", self.points + 1)));
            }
        }
        Ok(())
    }
}

fn height(word: &str, line: usize) -> Result<f64, FileProblem> {
    if word.eq_ignore_ascii_case("BAD") {
        return Ok(f64::NAN);
    }
    word.parse().map_err(|_| unexpected(Place::Line(line), "a height", word, "a number or BAD"))
}

fn text_header(fields: &[(String, String, usize)]) -> Result<Header, FileProblem> {
    let find = |wanted: &'static str| {
        let mut all = fields.iter().filter(|(key, ..)| key.eq_ignore_ascii_case(wanted));
        let (_, value, line) = all
            .next()
            .ok_or_else(|| unexpected(Place::Line(1), "the header", "without it", wanted))?;
        if let Some((key, other, line)) = all.find(|(_, other, _)| other != value) {
            let both = format!("{key} = {other} beside {value}");
            let what = "a second value of a key of the header";
            return Err(unexpected(Place::Line(*line), what, both, "one value"));
        }
        Ok((value.as_str(), *line))
    };
    fn value<T: std::str::FromStr>(
        (text, line): (&str, usize),
        what: &'static str,
    ) -> Result<T, FileProblem> {
        text.parse().map_err(|_| unexpected(Place::Line(line), what, text, "a number"))
    }
    let points = find("NumPoints")?;
    let declared = (value(points, "NumPoints")?, value(find("NumProfiles")?, "NumProfiles")?);
    let place = Place::Line(points.1);
    let (columns, rows) = count(place.clone(), declared.0, declared.1)?;
    let scale = |key| find(key).and_then(|field| value::<f64>(field, key));
    let scales = [scale("Xscale")?, scale("Yscale")?, scale("Zscale")?];
    let [x, y, z] = ["Xscale", "Yscale", "Zscale"].map(|key| find(key).map(|field| field.1));
    check_scales(&scales, rows, [x?, y?, z?].map(Place::Line))?;
    let code = |key| match find(key) {
        Ok(field) => value::<u64>(field, key).map(|code| (code, field.1)),
        Err(_) => Ok((0, 1)),
    };
    let (compression, line) = code("Compression")?;
    refuse_codes(compression, code("CheckType")?.0, &Place::Line(line))?;
    let kind = find("DataType")?;
    let number = number(value(kind, "DataType")?, Place::Line(kind.1))?;
    let instrument =
        [("ManufacID", "manufacturer"), ("CreateDate", "created"), ("ModDate", "modified")]
            .into_iter()
            .filter_map(|(key, name)| Some((name.to_owned(), find(key).ok()?.0.to_owned())))
            .collect();
    Ok(Header { columns, rows, place, scales, number, instrument })
}
