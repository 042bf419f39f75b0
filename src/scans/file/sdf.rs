//! SDF, the surface data file: ISO 25178-71 (`ISO-1.0`, `ISO-2.0`) and its forerunner of report
//! EUR 15178 (`BCR-1.0`), as text (`a`) or binary (`b`).
//!
//! A header of fixed fields is followed by the heights, a row (profile) after the other, and a
//! trailer of free text. Binary headers count points in 16 bits, those of `ISO-2.0` in 32.

use super::bytes::{Cursor, Number, count};
use super::error::{FileProblem, Place, unexpected};
use super::{ScanFile, grid, spacing};

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
    scales: [f64; 3],
    number: Number,
    instrument: Vec<(String, String)>,
}

/// Reads an SDF file.
pub(super) fn read(bytes: &[u8]) -> Result<ScanFile, FileProblem> {
    let version = Version::detect(bytes)
        .ok_or_else(|| unexpected(Place::Byte(0), "the version", "unknown", "aISO-1.0 or alike"))?;
    let (header, raw) = if version.text { read_text(bytes)? } else { read_binary(bytes, version)? };
    let [x, y, z] = header.scales;
    let number = header.number;
    let heights = raw
        .into_iter()
        .map(|value| if version.is_missing(value, number) { f64::NAN } else { value * z })
        .collect();
    let Header { columns, rows, mut instrument, .. } = header;
    // Dates that are not known are twelve zeros.
    instrument.retain(|(_, value)| value.chars().any(|c| c != '0'));
    Ok(ScanFile {
        format: format!("SDF {}", version.name),
        detected: format!(
            "the first bytes are `{}`: surface data file, {}, heights as {number:?}",
            version.name,
            if version.text { "text" } else { "binary" }
        ),
        grid: grid(columns, rows, x, y),
        heights,
        instrument,
    })
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

fn read_binary(bytes: &[u8], version: Version) -> Result<(Header, Vec<f64>), FileProblem> {
    let mut cursor = Cursor::at(bytes, 8);
    let instrument = vec![
        ("manufacturer".to_owned(), cursor.text(10, "ManufacID")?),
        ("created".to_owned(), cursor.text(12, "CreateDate")?),
        ("modified".to_owned(), cursor.text(12, "ModDate")?),
    ];
    let place = cursor.place();
    let mut length = |what| match version.name {
        "bISO-2.0" => cursor.u32(what).map(u64::from),
        _ => cursor.u16(what).map(u64::from),
    };
    let declared = (length("NumPoints")?, length("NumProfiles")?);
    let (columns, rows) = count(place, declared.0, declared.1)?;
    let scale_places = [0, 8, 16].map(|offset| Place::Byte(cursor.offset() + offset));
    let scales = [cursor.f64("Xscale")?, cursor.f64("Yscale")?, cursor.f64("Zscale")?];
    check_scales(&scales, rows, scale_places)?;
    cursor.f64("Zresolution")?;
    let place = cursor.place();
    let compression = cursor.u8("Compression")?;
    let number = number(u64::from(cursor.u8("DataType")?), Place::Byte(cursor.offset() - 1))?;
    refuse_codes(u64::from(compression), u64::from(cursor.u8("CheckType")?), &place)?;
    let needed = columns as u64 * rows as u64 * number.bytes() as u64;
    // Some writers of ISO-1.0 put two more words between header and heights; then the file has
    // no trailer and is longer by just these.
    let rest = (bytes.len() - cursor.offset()) as u64;
    if version.name == "bISO-1.0" && rest == needed + 8 {
        let words = (cursor.u32("extra word")?, cursor.u32("extra word")?);
        if words != (5, 1) {
            cursor = Cursor::at(bytes, cursor.offset() - 8);
        }
    }
    let raw = number.decode(cursor.take(needed, "the heights")?);
    Ok((Header { columns, rows, scales, number, instrument }, raw))
}

/// Lines of `key = value`, `*`, heights between blanks, `*`, trailer.
fn read_text(bytes: &[u8]) -> Result<(Header, Vec<f64>), FileProblem> {
    let (text, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes);
    let mut fields: Vec<(String, String, usize)> = Vec::new();
    let mut lines = text.lines().enumerate().skip(1);
    let mut ended = false;
    for (index, line) in lines.by_ref() {
        let line = line.trim();
        if line == "*" {
            ended = true;
            break;
        }
        if let Some((key, value)) = line.split_once('=') {
            fields.push((key.trim().to_owned(), value.trim().to_owned(), index + 1));
        } else if !line.is_empty() {
            return Err(unexpected(
                Place::Line(index + 1),
                "the line",
                line,
                "`key = value` or `*`",
            ));
        }
    }
    if !ended {
        let place = Place::Line(text.lines().count());
        return Err(unexpected(place, "the header", "not ended", "a line `*`"));
    }
    let header = text_header(&fields)?;
    let points = header.columns * header.rows;
    let mut raw = Vec::new();
    for (index, line) in lines {
        if line.trim() == "*" {
            break;
        }
        for word in line.split_ascii_whitespace() {
            raw.push(height(word, index + 1)?);
        }
        if raw.len() > points {
            let expected = format!("{points} (NumPoints times NumProfiles); copy the file again");
            return Err(unexpected(
                Place::Line(index + 1),
                "the number of heights",
                "more",
                expected,
            ));
        }
    }
    if raw.len() != points {
        let place = Place::Line(text.lines().count());
        let expected = format!("{points} (NumPoints times NumProfiles); copy the file again");
        return Err(unexpected(place, "the number of heights", raw.len(), expected));
    }
    Ok((header, raw))
}

fn height(word: &str, line: usize) -> Result<f64, FileProblem> {
    if word.eq_ignore_ascii_case("BAD") {
        return Ok(f64::NAN);
    }
    word.parse().map_err(|_| unexpected(Place::Line(line), "a height", word, "a number or BAD"))
}

fn text_header(fields: &[(String, String, usize)]) -> Result<Header, FileProblem> {
    let find = |wanted: &'static str| {
        fields
            .iter()
            .find(|(key, ..)| key.eq_ignore_ascii_case(wanted))
            .map(|(_, value, line)| (value.as_str(), *line))
            .ok_or_else(|| unexpected(Place::Line(1), "the header", "without it", wanted))
    };
    fn value<T: std::str::FromStr>(
        (text, line): (&str, usize),
        what: &'static str,
    ) -> Result<T, FileProblem> {
        text.parse().map_err(|_| unexpected(Place::Line(line), what, text, "a number"))
    }
    let points = find("NumPoints")?;
    let declared = (value(points, "NumPoints")?, value(find("NumProfiles")?, "NumProfiles")?);
    let (columns, rows) = count(Place::Line(points.1), declared.0, declared.1)?;
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
    Ok(Header { columns, rows, scales, number, instrument })
}
