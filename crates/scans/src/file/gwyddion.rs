//! Height maps as text from Gwyddion: four comment lines in the language of the user (channel,
//! width, height, unit of the values) and a line of numbers for each row.
//!
//! Width and height are those of the complete image; each point represents one cell. Words
//! before the colons are translated; the numbers and units after them are read.

use super::bytes::count;
use super::error::{FileProblem, Place, shorten, unexpected};
use super::heights::Checked;
use super::{OpenScan, grid, metres_of, spacing};
use crate::Source;
use crate::last_number::LastNumber;

/// The parts of the first four lines.
struct Header<'a> {
    channel: &'a str,
    width: (f64, &'a str),
    height: (f64, &'a str),
    unit: &'a str,
}

impl<'a> Header<'a> {
    fn read(text: &'a str) -> Option<Self> {
        let mut values = text.lines().map(|line| line.strip_prefix("# ")?.split_once(':'));
        let mut value = || Some(values.next()??.1.trim());
        let channel = value()?;
        let (width, height, unit) = (length(value()?)?, length(value()?)?, value()?);
        // A unit is one word and not a number, and rows of numbers follow instead of more comments.
        let is_unit = !unit.is_empty() && !unit.contains(' ') && number(unit).is_none();
        let followed = text.lines().nth(4).is_some_and(|line| !line.starts_with('#'));
        (is_unit && followed).then_some(Self { channel, width, height, unit })
    }
}

/// A number and the unit after it.
fn length(text: &str) -> Option<(f64, &str)> {
    let (value, unit) = text.split_once(' ')?;
    Some((number(value)?, unit.trim())).filter(|(_, unit)| !unit.is_empty() && !unit.contains(' '))
}

/// A number with either decimal mark; whether thousands are separated is not known, so they are
/// not read.
pub(super) fn number(word: &str) -> Option<f64> {
    let point = if word.contains('.') { word.to_owned() } else { word.replacen(',', ".", 1) };
    point.parse().ok()
}

pub(super) fn is_header(start: &[u8]) -> bool {
    // Nothing but the words, which are not looked at, can be cut in the middle of a character.
    start.starts_with(b"# ") && Header::read(&String::from_utf8_lossy(start)).is_some()
}

/// Reads a text of Gwyddion, all of it: the spacing follows from the number of rows.
pub(super) fn open(source: Source<'_>) -> Result<OpenScan<'_>, FileProblem> {
    let bytes = source.whole()?;
    let text = match std::str::from_utf8(&bytes) {
        Ok(text) => std::borrow::Cow::Borrowed(text),
        Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(&bytes).0,
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let header = Header::read(text).ok_or_else(|| {
        let expected = "`# Width: 12.3 um`, `# Height: 12.3 um` and `# Value units: m`";
        unexpected(Place::Line(1), "the header", "another", expected)
    })?;
    let metres = |line, unit: &str| {
        let expected = "a length, such as um; scale the image in Gwyddion";
        let place = Place::Line(line);
        metres_of(unit).ok_or_else(|| unexpected(place, "the unit", unit, expected))
    };
    let width = header.width.0 * metres(2, header.width.1)?;
    let height = header.height.0 * metres(3, header.height.1)?;
    let z = metres(4, header.unit)?;
    let (columns, mut raw) = matrix(text)?;
    let rows = raw.len() / columns.max(1);
    let (columns, rows) = count(Place::Line(5), columns as u64, rows as u64)?;
    let spacing_x = spacing(Place::Line(2), width / columns as f64)?;
    let spacing_y = spacing(Place::Line(3), height / rows as f64)?;
    let instrument = vec![("channel".to_owned(), header.channel.to_owned())];
    raw.iter_mut().for_each(|raw| *raw *= z);
    Ok(OpenScan {
        format: "Gwyddion text".into(),
        detected: format!(
            "four comment lines state width, height and unit `{}` before rows of numbers: image as \
             text from Gwyddion",
            header.unit
        ),
        grid: grid(columns, rows, spacing_x, spacing_y),
        declared: None,
        heights: Checked::new(raw),
        instrument: instrument.into_iter().filter(|(_, value)| !value.is_empty()).collect(),
    })
}

/// Number of columns, and the numbers row after row; memory grows with the text alone.
fn matrix(text: &str) -> Result<(usize, Vec<f64>), FileProblem> {
    let mut columns = 0;
    let mut raw = Vec::new();
    let mut numbers = LastNumber::default();
    let mut last = "";
    for (index, line) in text.lines().enumerate().skip(4) {
        let before = raw.len();
        for word in line.split_ascii_whitespace() {
            let place = Place::Line(index + 1);
            let value = number(word);
            raw.push(value.ok_or_else(|| unexpected(place, "a height", word, "a number"))?);
            numbers.note(std::mem::replace(&mut last, word));
        }
        match raw.len() - before {
            0 => {}
            cells if before == 0 => columns = cells,
            cells if cells == columns => {}
            cells => {
                let expected = format!("{columns} as in the rows before; copy the file again");
                let place = Place::Line(index + 1);
                return Err(unexpected(place, "the number of heights of a row", cells, expected));
            }
        }
    }
    if text.ends_with(last) && numbers.is_cut(last) {
        let line = text.lines().count();
        return Err(FileProblem::CutNumber { line, text: shorten(last) });
    }
    Ok((columns, raw))
}
