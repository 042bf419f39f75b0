//! X3P: a zip archive with `main.xml`, its checksum and, unless the heights are in the XML
//! document, a binary matrix `bindata/data.bin` and a mask `bindata/valid.bin` of the points that
//! are valid, one bit each, the lowest first.
//!
//! | module | what it holds |
//! |---|---|
//! | `archive` | members of the zip archive, within limits |
//! | `document` | the texts and heights of the XML document |
//! | `write` | X3P files from scans |

mod archive;
mod document;
mod write;

pub use write::write;

use super::bytes::{Number, count};
use super::error::{FileProblem, Place, unexpected};
use super::heights::Checked;
use super::{Grid, OpenScan, admit_points, grid, spacing};
use crate::Source;
use archive::Archive;
use document::Document;
use std::io::Read;

const MAIN: &str = "main.xml";
/// What is read of the record of the measurement: name and element.
const FIELDS: [(&str, &str); 9] = [
    ("manufacturer", "Record2/Instrument/Manufacturer"),
    ("model", "Record2/Instrument/Model"),
    ("serial", "Record2/Instrument/Serial"),
    ("version", "Record2/Instrument/Version"),
    ("probing system", "Record2/ProbingSystem/Type"),
    ("probing system identification", "Record2/ProbingSystem/Identification"),
    ("created", "Record2/Date"),
    ("creator", "Record2/Creator"),
    ("comment", "Record2/Comment"),
];

/// Reads an X3P file: profiles (`PRF`) and surfaces (`SUR`) on equal spacing. The archive is
/// packed with its directory at the end, so that all of it is in memory.
pub(super) fn open(source: Source<'_>) -> Result<OpenScan<'_>, FileProblem> {
    let bytes = source.whole()?;
    let mut archive = Archive::open(&bytes)?;
    let mut main = archive.member(MAIN)?;
    let size = main.size;
    let document = Document::parse(&mut main, size)?;
    let checksum = main.finish()?;
    let checked = archive.check_document(checksum, document.text("Record4/ChecksumFile"))?;
    let feature = document.required("Record1/FeatureType")?;
    if !["PRF", "SUR"].contains(&feature) {
        return Err(FileProblem::Unsupported {
            place: Place::Element("Record1/FeatureType".into()),
            what: format!(
                "a file of type `{}`",
                feature.escape_debug().take(40).collect::<String>()
            ),
            advice: "profiles (PRF) and surfaces (SUR) are read, point clouds are not",
        });
    }
    let (columns, rows) = self::size(&document)?;
    if feature == "PRF" && rows != 1 {
        let place = Place::Element("Record3/MatrixDimension/SizeY".into());
        return Err(unexpected(place, "the number of rows of a profile", rows, 1));
    }
    let number = height_type(&document)?;
    let (x, y) = spacings(&document, rows)?;
    let scale = document.number("Record1/Axes/CZ/Increment")?.unwrap_or(1.0);
    let offset = document.number("Record1/Axes/CZ/Offset")?.unwrap_or(0.0);
    let points = columns * rows;
    let source = if document.data.is_empty() { "binary data" } else { "XML data" };
    let detected = format!(
        "a zip archive with {MAIN}, feature type {feature}: {source}, heights as {number:?}, {}",
        if checked { "checksum verified" } else { "without a checksum" }
    );
    let format = format!("X3P {feature}");
    let grid = match feature {
        "PRF" => Grid::Profile { spacing: x },
        _ => grid(columns, rows, x, y),
    };
    let instrument = instrument(&document);
    let mut heights = match document.text("Record3/DataLink/PointDataLink") {
        Some(member) => binary(&mut archive, &document, member, number, points)?,
        None if document.data.len() == points => document.data,
        None => {
            let place = Place::Element("Record3/DataList".into());
            return Err(unexpected(place, "the number of data", document.data.len(), points));
        }
    };
    heights.iter_mut().for_each(|raw| *raw = *raw * scale + offset);
    let heights = Checked::new(heights);
    Ok(OpenScan { format, detected, grid, instrument, declared: None, heights })
}

fn size(document: &Document) -> Result<(usize, usize), FileProblem> {
    if document.has_list_of_points() {
        return Err(FileProblem::Unsupported {
            place: Place::Element("Record3/ListDimension".into()),
            what: "a list of points without a grid".into(),
            advice: "save the scan as a matrix (MatrixDimension)",
        });
    }
    let whole = |name| {
        let path = format!("Record3/MatrixDimension/{name}");
        let text = document.required(&path)?;
        text.parse::<u64>().map_err(|_| {
            unexpected(Place::Element(path), "a size", text, "a whole number of 1 or more")
        })
    };
    let (columns, rows, layers) = (whole("SizeX")?, whole("SizeY")?, whole("SizeZ")?);
    if layers != 1 {
        return Err(FileProblem::Unsupported {
            place: Place::Element("Record3/MatrixDimension/SizeZ".into()),
            what: format!("a scan of {layers} layers"),
            advice: "save one layer",
        });
    }
    let place = Place::Element("Record3/MatrixDimension".into());
    let (columns, rows) = count(place.clone(), columns, rows)?;
    admit_points(columns as u64 * rows as u64, place)?;
    Ok((columns, rows))
}

fn height_type(document: &Document) -> Result<Number, FileProblem> {
    let axis = document.required("Record1/Axes/CZ/AxisType")?;
    if axis != "A" {
        let place = Place::Element("Record1/Axes/CZ/AxisType".into());
        return Err(unexpected(place, "the type of the axis of heights", axis, "A (absolute)"));
    }
    match document.text("Record1/Axes/CZ/DataType").unwrap_or("D") {
        "I" => Ok(Number::I16),
        "L" => Ok(Number::I32),
        "F" => Ok(Number::F32),
        "D" => Ok(Number::F64),
        other => {
            let place = Place::Element("Record1/Axes/CZ/DataType".into());
            Err(unexpected(place, "the type of the heights", other, "I, L, F or D"))
        }
    }
}

fn spacings(document: &Document, rows: usize) -> Result<(f64, f64), FileProblem> {
    let increment = |name: &str| {
        let path = format!("Record1/Axes/{name}/AxisType");
        match document.required(&path)? {
            "I" => {}
            "A" => {
                return Err(FileProblem::Unsupported {
                    place: Place::Element(path),
                    what: "an absolute axis of positions".into(),
                    advice: "export the positions and heights as text and describe it",
                });
            }
            other => {
                return Err(unexpected(Place::Element(path), "the type of an axis", other, "I"));
            }
        }
        let path = format!("Record1/Axes/{name}/Increment");
        let place = Place::Element(path.clone());
        match document.number(&path)? {
            Some(metres) => spacing(place, metres),
            None => Err(unexpected(place, "the increment", "absent", "a length in m")),
        }
    };
    let x = increment("CX")?;
    Ok((x, if rows == 1 { x } else { increment("CY")? }))
}

/// Heights of the binary matrix in units of the document, NaN where they are not valid.
fn binary(
    archive: &mut Archive<'_>,
    document: &Document,
    member: &str,
    number: Number,
    points: usize,
) -> Result<Vec<f64>, FileProblem> {
    const CHUNK: usize = 1 << 13;
    let mut buffer = vec![0; CHUNK * number.bytes()];
    let mut data = archive.binary(member, points as u64 * number.bytes() as u64)?;
    let mut heights = Vec::with_capacity(points);
    while heights.len() < points {
        let part = &mut buffer[..CHUNK.min(points - heights.len()) * number.bytes()];
        data.read_exact(part).map_err(|error| data.damaged(&error))?;
        number.decode(part, &mut heights);
    }
    data.check(document.text("Record3/DataLink/MD5ChecksumPointData"))?;
    let Some(mask) = document.text("Record3/DataLink/ValidPointsLink") else { return Ok(heights) };
    let mut mask = archive.binary(mask, points.div_ceil(8) as u64)?;
    for block in heights.chunks_mut(8 * CHUNK) {
        let part = &mut buffer[..block.len().div_ceil(8)];
        mask.read_exact(part).map_err(|error| mask.damaged(&error))?;
        for (index, height) in block.iter_mut().enumerate() {
            if part[index / 8] & (1 << (index % 8)) == 0 {
                *height = f64::NAN;
            }
        }
    }
    mask.check(document.text("Record3/DataLink/MD5ChecksumValidPoints"))?;
    Ok(heights)
}

fn instrument(document: &Document) -> Vec<(String, String)> {
    FIELDS
        .into_iter()
        .filter_map(|(name, path)| Some((name.to_owned(), document.text(path)?.to_owned())))
        .filter(|(_, text)| !text.is_empty())
        .collect()
}
