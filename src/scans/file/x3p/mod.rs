//! X3P: a zip archive with `main.xml`, its checksum and, unless the heights stand in the XML
//! document, a binary matrix `bindata/data.bin` and a mask `bindata/valid.bin` of the points that
//! are valid, one bit each, the lowest first.

mod archive;
mod document;
mod write;

pub use write::write;

use super::bytes::{Number, count};
use super::error::{FileProblem, Place, unexpected};
use super::{Grid, ScanFile, grid, spacing};
use archive::Archive;
use document::Document;

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

/// Reads an X3P file: profiles (`PRF`) and surfaces (`SUR`) on equal spacing.
pub(super) fn read(bytes: &[u8]) -> Result<ScanFile, FileProblem> {
    let mut archive = Archive::open(bytes)?;
    let main = archive.member(MAIN)?;
    if main.trim_ascii().is_empty() {
        let place = Place::Member(MAIN.into());
        return Err(unexpected(place, "the document", "empty", "XML; export the scan again"));
    }
    let document = Document::parse(&main)?;
    let checked = archive.check_document(&main, document.text("Record4/ChecksumFile"))?;
    let feature = document.required("Record1/FeatureType")?;
    if !["PRF", "SUR"].contains(&feature) {
        return Err(FileProblem::Unsupported {
            place: Place::Element("Record1/FeatureType".into()),
            what: format!("a file of type `{feature}`"),
            advice: "profiles (PRF) and surfaces (SUR) are read, point clouds are not",
        });
    }
    let (columns, rows) = size(&document)?;
    if feature == "PRF" && rows != 1 {
        let place = Place::Element("Record3/MatrixDimension/SizeY".into());
        return Err(unexpected(place, "the number of rows of a profile", rows, 1));
    }
    let number = height_type(&document)?;
    let raw = match document.text("Record3/DataLink/PointDataLink") {
        Some(member) => binary(&mut archive, &document, member, number, columns * rows)?,
        None => listed(&document, columns * rows)?,
    };
    let scale = document.number("Record1/Axes/CZ/Increment")?.unwrap_or(1.0);
    let offset = document.number("Record1/Axes/CZ/Offset")?.unwrap_or(0.0);
    let heights = raw.into_iter().map(|raw| raw * scale + offset).collect();
    let (x, y) = spacings(&document, rows)?;
    let source = if document.data.is_empty() { "binary data" } else { "XML data" };
    Ok(ScanFile {
        format: format!("X3P {feature}"),
        detected: format!(
            "a zip archive with {MAIN}, feature type {feature}: {source}, heights as {number:?}, {}",
            if checked { "checksum verified" } else { "without a checksum" }
        ),
        grid: match feature {
            "PRF" => Grid::Profile { spacing: x },
            _ => grid(columns, rows, x, y),
        },
        heights,
        instrument: instrument(&document),
    })
}

fn size(document: &Document) -> Result<(usize, usize), FileProblem> {
    if document.contains("Record3/ListDimension") {
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
    count(Place::Element("Record3/MatrixDimension".into()), columns, rows)
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

/// Heights of the binary matrix, NaN where they are not valid.
fn binary(
    archive: &mut Archive<'_>,
    document: &Document,
    member: &str,
    number: Number,
    points: usize,
) -> Result<Vec<f64>, FileProblem> {
    let needed = points as u64 * number.bytes() as u64;
    let stated = document.text("Record3/DataLink/MD5ChecksumPointData");
    let mut raw = number.decode(&archive.binary(member, needed, stated)?);
    if let Some(mask) = document.text("Record3/DataLink/ValidPointsLink") {
        let stated = document.text("Record3/DataLink/MD5ChecksumValidPoints");
        let mask = archive.binary(mask, points.div_ceil(8) as u64, stated)?;
        for (index, height) in raw.iter_mut().enumerate() {
            if mask[index / 8] & (1 << (index % 8)) == 0 {
                *height = f64::NAN;
            }
        }
    }
    Ok(raw)
}

/// Heights of the XML document; an empty datum is a missing point.
fn listed(document: &Document, points: usize) -> Result<Vec<f64>, FileProblem> {
    let place = |index| Place::Element(format!("Record3/DataList/Datum[{}]", index + 1));
    if document.data.len() != points {
        let place = Place::Element("Record3/DataList".into());
        return Err(unexpected(place, "the number of data", document.data.len(), points));
    }
    let datum = |(index, text): (usize, &String)| match text.trim() {
        "" => Ok(f64::NAN),
        text => text.parse().map_err(|_| unexpected(place(index), "a height", text, "a number")),
    };
    document.data.iter().enumerate().map(datum).collect()
}

fn instrument(document: &Document) -> Vec<(String, String)> {
    FIELDS
        .into_iter()
        .filter_map(|(name, path)| Some((name.to_owned(), document.text(path)?.to_owned())))
        .filter(|(_, text)| !text.is_empty())
        .collect()
}
