//! X3P files from scans.

use super::super::{Grid, ScanFile};
use super::MAIN;
use super::archive::checksum;
use quick_xml::escape::escape;
use std::io::{self, Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const DATA: &str = "bindata/data.bin";
const VALID: &str = "bindata/valid.bin";
const CHECKSUM: &str = "md5checksum.hex";

/// The bytes of an X3P file: binary 64-bit heights, MD5 checksums and, where points are missing,
/// the mask of the valid ones beside NaN. What the scan says of its instrument becomes `Record2`;
/// what that has no element for joins its comment. The same scan gives the same bytes.
///
/// # Errors
/// Those of the packing.
pub fn write(scan: &ScanFile) -> io::Result<Vec<u8>> {
    let data: Vec<u8> = scan.heights.iter().flat_map(|height| height.to_le_bytes()).collect();
    let valid = (scan.missing() > 0).then(|| mask(&scan.heights));
    let document = document(scan, &checksum(&data), valid.as_deref().map(checksum).as_deref());
    let line = format!("{} *{MAIN}\n", checksum(document.as_bytes()));
    let mut members: Vec<(&str, &[u8])> =
        vec![(MAIN, document.as_bytes()), (CHECKSUM, line.as_bytes()), (DATA, &data)];
    members.extend(valid.as_deref().map(|mask| (VALID, mask)));

    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // The default time is a constant; that of the clock would make each file another one.
    let options = SimpleFileOptions::default();
    for (name, bytes) in members {
        archive.start_file(name, options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

fn mask(heights: &[f64]) -> Vec<u8> {
    let byte = |heights: &[f64]| {
        let bits = heights.iter().enumerate();
        bits.map(|(bit, height)| u8::from(!height.is_nan()) << bit).sum()
    };
    heights.chunks(8).map(byte).collect()
}

/// The record of the measurement, empty where nothing is known of it.
fn record_2(instrument: &[(String, String)]) -> String {
    if instrument.is_empty() {
        return String::new();
    }
    let known = |wanted: &str| instrument.iter().find(|(name, _)| name == wanted);
    let element = |indent: &str, name: &str, text: &str| match printable(text) {
        text if text.is_empty() => String::new(),
        text => format!("{indent}<{name}>{}</{name}>\n", escape(&text)),
    };
    let group = |name: &str, members: &[(&str, &str)]| {
        let text = |key| known(key).map_or("", |(_, value)| value.as_str());
        let inside: String =
            members.iter().map(|(key, name)| element("      ", name, text(key))).collect();
        if inside.is_empty() { inside } else { format!("    <{name}>\n{inside}    </{name}>\n") }
    };
    let date = known("created").filter(|(_, date)| is_date_time(date));
    let rest = |(name, _): &&(String, String)| match name.as_str() {
        "created" => date.is_none(),
        "comment" => false,
        name => !super::FIELDS.iter().any(|(field, _)| *field == name),
    };
    let mut comment: Vec<String> =
        known("comment").map(|(_, text)| text.clone()).into_iter().collect();
    comment.extend(instrument.iter().filter(rest).map(|(name, value)| format!("{name}: {value}")));
    let simple = |name: &str, field: Option<&(String, String)>| {
        element("    ", name, field.map_or("", |(_, value)| value))
    };
    // In the order of the schema.
    let parts = [
        simple("Date", date),
        simple("Creator", known("creator")),
        group(
            "Instrument",
            &[
                ("manufacturer", "Manufacturer"),
                ("model", "Model"),
                ("serial", "Serial"),
                ("version", "Version"),
            ],
        ),
        group(
            "ProbingSystem",
            &[("probing system", "Type"), ("probing system identification", "Identification")],
        ),
        element("    ", "Comment", &comment.join("; ")),
    ];
    format!("  <Record2>\n{}  </Record2>\n", parts.concat())
}

/// Whether a date is one of XML, `2021-10-11T09:30:00` with or without a zone.
fn is_date_time(text: &str) -> bool {
    const PATTERN: &[u8] = b"0000-00-00T00:00:00";
    let start = text.as_bytes().get(..PATTERN.len()).unwrap_or_default();
    let matches = |(byte, pattern): (&u8, &u8)| match pattern {
        b'0' => byte.is_ascii_digit(),
        other => byte == other,
    };
    start.len() == PATTERN.len() && start.iter().zip(PATTERN).all(matches)
}

/// A text on one line, without the characters that XML cannot hold.
fn printable(text: &str) -> String {
    let printable: String = text
        .chars()
        .map(|c| if c.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&c) { ' ' } else { c })
        .collect();
    printable.trim().to_owned()
}

fn document(scan: &ScanFile, data: &str, valid: Option<&str>) -> String {
    let (feature, columns, rows, x, y) = match scan.grid {
        Grid::Profile { spacing } => ("PRF", scan.heights.len(), 1, spacing, spacing),
        Grid::Map { columns, rows, spacing_x, spacing_y } => {
            ("SUR", columns, rows, spacing_x, spacing_y)
        }
    };
    let axis = |name: &str, kind: &str, increment: f64| {
        format!(
            "      <{name}>\n        <AxisType>{kind}</AxisType>\n        <DataType>D</DataType>\n        \
             <Increment>{increment:e}</Increment>\n        <Offset>0</Offset>\n      </{name}>\n"
        )
    };
    let axes = [axis("CX", "I", x), axis("CY", "I", y), axis("CZ", "A", 1.0)].concat();
    let instrument = record_2(&scan.instrument);
    let mask = valid.map_or(String::new(), |valid| {
        format!(
            "      <ValidPointsLink>{VALID}</ValidPointsLink>\n      \
             <MD5ChecksumValidPoints>{valid}</MD5ChecksumValidPoints>\n"
        )
    });
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">
  <Record1>
    <Revision>ISO5436 - 2000</Revision>
    <FeatureType>{feature}</FeatureType>
    <Axes>
{axes}    </Axes>
  </Record1>
{instrument}  <Record3>
    <MatrixDimension>
      <SizeX>{columns}</SizeX>
      <SizeY>{rows}</SizeY>
      <SizeZ>1</SizeZ>
    </MatrixDimension>
    <DataLink>
      <PointDataLink>{DATA}</PointDataLink>
      <MD5ChecksumPointData>{data}</MD5ChecksumPointData>
{mask}    </DataLink>
  </Record3>
  <Record4>
    <ChecksumFile>{CHECKSUM}</ChecksumFile>
  </Record4>
</p:ISO5436_2>
"#
    )
}
