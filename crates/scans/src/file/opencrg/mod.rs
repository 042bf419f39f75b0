//! OpenCRG (ASAM), the curved regular grid of a road for simulations of tyres and vehicles.
//!
//! A header in sections of text (`$ROAD_CRG` with the steps of the grid, `$KD_Definition` with one
//! line `D:name,unit` for each channel) up to a line that begins with `$$`, then the heights: text
//! in fields of 10 (real) or 20 characters (double), 80 characters a line at most, `*...` where
//! missing; or big-endian numbers in records of 80 bytes, of which the last is filled with NaN.
//! Channels named `long section` are lines along the road, of heights over the reference line;
//! slope and banking of that line are not added.

mod header;

use super::bytes::count;
use super::error::{FileProblem, Place, unexpected};
use super::{Grid, ScanFile, grid, spacing};
use header::{Header, Layout};

/// Characters or bytes of a record.
const RECORD: usize = 80;

pub(super) fn is_header(start: &[u8]) -> bool {
    /// A description may come before the section of the road.
    const ENOUGH: usize = 1 << 16;
    let start = &start[..start.len().min(ENOUGH)];
    start.first().is_some_and(|first| b"$*!".contains(first))
        && start
            .split(|byte| *byte == b'\n')
            .any(|line| line.get(..9).is_some_and(|key| key.eq_ignore_ascii_case(b"$ROAD_CRG")))
}

/// Reads an OpenCRG file: one row of the map for each step along the road.
pub(super) fn read(bytes: &[u8]) -> Result<ScanFile, FileProblem> {
    let (header, data, first_line) = Header::read(bytes)?;
    let sections = header.sections()?;
    let raw = match header.layout {
        Layout::Text { width } => {
            text_rows(data, first_line, width, header.channels.len(), &sections.places)?
        }
        Layout::Binary { bytes } => {
            binary_rows(data, bytes, header.channels.len(), &sections.places)
        }
    };
    let columns = sections.places.len();
    let place = Place::Line(first_line);
    let (columns, rows) = count(place.clone(), columns as u64, (raw.len() / columns) as u64)?;
    let along = spacing(place.clone(), header.step_along(rows)?)?;
    let grid = if columns == 1 {
        Grid::Profile { spacing: along }
    } else {
        grid(columns, rows, spacing(place, header.step_across(&sections)?)?, along)
    };
    let heights = raw.into_iter().map(|raw| raw * sections.metres).collect();
    Ok(ScanFile {
        format: format!("OpenCRG {}", header.code),
        detected: format!(
            "the header has a section $ROAD_CRG: {columns} long sections of {rows} points, rows of the map run \
             across the road; heights over the reference line"
        ),
        grid,
        heights,
        instrument: header.description(),
    })
}

/// Heights of the chosen channels, row after row, from fields of fixed width.
fn text_rows(
    data: &[u8],
    first_line: usize,
    width: usize,
    channels: usize,
    chosen: &[usize],
) -> Result<Vec<f64>, FileProblem> {
    let mut heights = Vec::new();
    let mut row: Vec<f64> = Vec::new();
    let mut last_line = first_line;
    for (index, line) in data.split(|byte| *byte == b'\n').enumerate() {
        let place = || Place::Line(first_line + index);
        let line = line.trim_ascii_end();
        if line.is_empty() {
            continue;
        }
        last_line = first_line + index;
        let expected = (channels - row.len()).min(RECORD / width);
        let fields = line.chunks(width);
        if fields.len() != expected {
            let expected = format!("{expected} fields of {width} characters; copy the file again");
            return Err(unexpected(place(), "the number of fields", fields.len(), expected));
        }
        for field in fields {
            let text = String::from_utf8_lossy(field.trim_ascii());
            let value = if text.starts_with('*') { Some(f64::NAN) } else { text.parse().ok() };
            let value = value.filter(|value: &f64| !value.is_infinite());
            let expected = "a number or `*missing*`";
            row.push(value.ok_or_else(|| unexpected(place(), "a field", &text, expected))?);
        }
        if row.len() == channels {
            heights.extend(chosen.iter().map(|channel| row[*channel]));
            row.clear();
        }
    }
    if row.is_empty() {
        return Ok(heights);
    }
    let expected = format!("{channels}, one for each channel; copy the file again");
    Err(unexpected(
        Place::Line(last_line),
        "the number of fields of the last row",
        row.len(),
        expected,
    ))
}

/// Heights of the chosen channels from big-endian numbers.
fn binary_rows(data: &[u8], bytes: usize, channels: usize, chosen: &[usize]) -> Vec<f64> {
    let number = |channel: usize, row: &[u8]| {
        let at = &row[channel * bytes..][..bytes];
        match <[u8; 8]>::try_from(at) {
            Ok(double) => f64::from_be_bytes(double),
            Err(_) => f64::from(f32::from_be_bytes([at[0], at[1], at[2], at[3]])),
        }
    };
    let rows = data.chunks_exact(channels * bytes);
    let mut heights: Vec<f64> =
        rows.flat_map(|row| chosen.iter().map(move |channel| number(*channel, row))).collect();
    // What fills the last record: every row of the road has a height.
    while heights.len() >= chosen.len()
        && heights[heights.len() - chosen.len()..].iter().all(|height| height.is_nan())
    {
        heights.truncate(heights.len() - chosen.len());
    }
    heights
}
