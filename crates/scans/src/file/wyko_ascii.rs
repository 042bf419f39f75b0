//! Wyko ASCII, the height map as text of white-light interferometers (Veeco, Bruker).
//!
//! The first line is `Wyko ASCII Data File Format` with three numbers, of which the second says
//! whether heights are in wavelengths (0) or in nanometres (1). Lines of a name, a type, a length
//! and a value follow, parted by tabulators: `X Size`, `Y Size`, `Pixel_size` (mm), `Wavelength`
//! (nm), `Mult`, `Aspect`. A block of an array has its name (`RAW_DATA`, `OPD`, `SAMPLE_DATA` for
//! heights, others for brightness) and then `X Size` lines of `Y Size` numbers, `Bad` where missing.
//! A height in wavelengths is number * `Wavelength` / `Mult`.

use super::bytes::count;
use super::error::{FileProblem, Place, unexpected};
use super::{ScanFile, grid, spacing};
use crate::decode::lines;

const SIGNATURE: &str = "Wyko ASCII Data File Format";
/// Fields that heights and positions follow from.
const DECIDING: [&str; 6] = ["X Size", "Y Size", "Pixel_size", "Wavelength", "Mult", "Aspect"];
/// Names of arrays of heights.
const HEIGHTS: [&str; 4] = ["RAW_DATA", "RAW DATA", "OPD", "SAMPLE_DATA"];
/// Wavelengths in nm of any light that an interferometer uses.
const LIGHT_NM: std::ops::RangeInclusive<f64> = 100.0..=20_000.0;
/// Lines of names and values that are kept; more than any file has.
const MOST_FIELDS: usize = 1000;

pub(super) fn is_signature(start: &[u8]) -> bool {
    start.starts_with(SIGNATURE.as_bytes())
}

/// Reads a Wyko ASCII file; its first array of heights is the map.
pub(super) fn read(bytes: &[u8]) -> Result<ScanFile, FileProblem> {
    let (text, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes);
    let first = lines(&text).next().unwrap_or_default();
    let in_nanometres = flag(first)?;
    let file = File::read(&text)?;
    let pixel = file.number("Pixel_size")? * 1e-3;
    let aspect = file.optional("Aspect")?.map_or(1.0, |(_, value)| value);
    let spacing_x = spacing(file.place("Pixel_size"), pixel)?;
    let spacing_y = spacing(file.place("Pixel_size"), pixel * aspect)?;
    let (unit, metres) = if in_nanometres {
        ("nanometres".to_owned(), 1e-9)
    } else {
        let wavelength = file.number("Wavelength")?;
        let divisor = file.optional("Mult")?.map_or(1.0, |(_, value)| value);
        if divisor <= 0.0 {
            return Err(unexpected(file.place("Mult"), "Mult", divisor, "a positive number"));
        }
        if !LIGHT_NM.contains(&wavelength) {
            let expected = "nanometres of light, 100 to 20000";
            return Err(unexpected(file.place("Wavelength"), "Wavelength", wavelength, expected));
        }
        (format!("wavelengths of {wavelength} nm"), wavelength / divisor * 1e-9)
    };
    let (columns, rows) = file.size;
    let mut heights = Vec::with_capacity(file.raw.len());
    for row in 0..rows {
        heights.extend(file.raw.iter().skip(row).step_by(rows).map(|raw| raw * metres));
    }
    Ok(ScanFile {
        format: "Wyko ASCII".into(),
        detected: format!(
            "the first line is `{SIGNATURE}`: block {}, heights in {unit}",
            file.block
        ),
        grid: grid(columns, rows, spacing_x, spacing_y),
        heights,
        instrument: file.instrument(),
    })
}

/// Whether the first line states that heights are in nanometres.
fn flag(first: &str) -> Result<bool, FileProblem> {
    let flags: Vec<&str> = first[SIGNATURE.len()..].split_whitespace().collect();
    match flags.as_slice() {
        ["0", "0", ..] => Ok(false),
        ["0", "1", ..] => Ok(true),
        other => {
            let expected = "0 and 0 (heights in wavelengths) or 0 and 1 (in nanometres)";
            Err(unexpected(Place::Line(1), "the flags of the format", other.join(" "), expected))
        }
    }
}

struct Field<'a> {
    line: usize,
    name: &'a str,
    value: &'a str,
}

struct File<'a> {
    fields: Vec<Field<'a>>,
    /// Points along x and along y.
    size: (usize, usize),
    block: &'a str,
    /// Numbers in the order of the file, along y first.
    raw: Vec<f64>,
}

impl<'a> File<'a> {
    fn read(text: &'a str) -> Result<Self, FileProblem> {
        let mut fields: Vec<Field> = Vec::new();
        let mut found: Option<(&str, (usize, usize), Vec<f64>)> = None;
        let mut numbered = lines(text).enumerate().skip(1);
        while let Some((index, line)) = numbered.next() {
            let cells: Vec<&str> = line.splitn(5, '\t').map(str::trim).collect();
            let name = cells[0];
            let value = match cells.as_slice() {
                [_, value] | [_, _, _, value, ..] => *value,
                _ => continue,
            };
            // Numbers of a skipped array are not fields.
            if name.starts_with(|c: char| !c.is_alphabetic())
                || name == "Bad"
                || name == "Block Name"
            {
                continue;
            }
            if HEIGHTS.contains(&name) && found.is_none() {
                let size = size(&fields, index + 1)?;
                found = Some((name, size, array(&mut numbered, size)?));
            } else if fields.len() < MOST_FIELDS {
                let decides = DECIDING.contains(&name) && found.is_none();
                let other = fields.iter().find(|field| decides && field.name == name);
                if let Some(other) = other.filter(|other| other.value != value) {
                    let expected = "one value: the header has another before";
                    let what = "a second value of a field of the header";
                    let both = format!("{name} {value} beside {}", other.value);
                    return Err(unexpected(Place::Line(index + 1), what, both, expected));
                }
                fields.push(Field { line: index + 1, name, value });
            }
        }
        let (block, size, raw) = found.ok_or_else(|| {
            let expected = "a block RAW_DATA, OPD or SAMPLE_DATA; export the heights as well";
            unexpected(Place::Line(1), "the array of heights", "not there", expected)
        })?;
        Ok(Self { fields, size, block, raw })
    }

    fn optional(&self, name: &str) -> Result<Option<(usize, f64)>, FileProblem> {
        let Some(field) = self.fields.iter().find(|field| field.name == name) else {
            return Ok(None);
        };
        let number = super::gwyddion::number(field.value).filter(|number| number.is_finite());
        let wrong = || {
            let what = "the value of a field of the header";
            unexpected(Place::Line(field.line), what, field.value, "a number")
        };
        Ok(Some((field.line, number.ok_or_else(wrong)?)))
    }

    fn number(&self, name: &'static str) -> Result<f64, FileProblem> {
        let absent =
            || unexpected(Place::Line(1), name, "not there", "a line of the header with it");
        self.optional(name)?.map(|(_, value)| value).ok_or_else(absent)
    }

    fn place(&self, name: &str) -> Place {
        let field = self.fields.iter().find(|field| field.name == name);
        Place::Line(field.map_or(1, |field| field.line))
    }

    fn instrument(&self) -> Vec<(String, String)> {
        let known =
            [("Title", "title"), ("Note", "comment"), ("Date", "created"), ("Time", "time")];
        let value = |name: &str| self.fields.iter().find(|field| field.name == name);
        known
            .into_iter()
            .filter_map(|(name, key)| Some((key.to_owned(), value(name)?.value.to_owned())))
            .filter(|(_, value)| !value.is_empty())
            .collect()
    }
}

/// Points along x and along y by the header.
fn size(fields: &[Field], line: usize) -> Result<(usize, usize), FileProblem> {
    let whole = |name: &'static str| {
        let field = fields.iter().find(|field| field.name == name);
        let place = Place::Line(field.map_or(line, |field| field.line));
        let value = field.map_or("not there", |field| field.value);
        value
            .parse::<u64>()
            .map_err(|_| unexpected(place, name, value, "a whole number of 1 or more"))
    };
    count(Place::Line(line), whole("X Size")?, whole("Y Size")?)
}

/// The lines of an array; memory grows with the text alone.
fn array<'a>(
    numbered: &mut impl Iterator<Item = (usize, &'a str)>,
    (columns, rows): (usize, usize),
) -> Result<Vec<f64>, FileProblem> {
    let mut raw = Vec::new();
    for line_of_array in 0..columns {
        let (index, line) = numbered.next().ok_or_else(|| {
            let expected = format!("{columns} as X Size says; copy the file again");
            let what = "the number of lines of the array of heights";
            unexpected(Place::Line(1), what, line_of_array, expected)
        })?;
        let place = || Place::Line(index + 1);
        let before = raw.len();
        for word in line.split_whitespace() {
            let number = if word.eq_ignore_ascii_case("bad") {
                Some(f64::NAN)
            } else {
                super::gwyddion::number(word).filter(|number| number.is_finite())
            };
            raw.push(
                number.ok_or_else(|| unexpected(place(), "a height", word, "a number or Bad"))?,
            );
        }
        let cells = raw.len() - before;
        if cells != rows {
            let expected = format!("{rows} as Y Size says; copy the file again");
            return Err(unexpected(place(), "the number of heights of the line", cells, expected));
        }
    }
    Ok(raw)
}
