//! Files made by the tests, and the reference files.
//!
//! | module | what it holds |
//! |---|---|
//! | `sdf` | SDF as text and binary |
//! | `x3p` | X3P: types, masks, faults, checksums, bombs |

mod sdf;
mod x3p;

use super::*;
use proptest::prelude::*;
use std::path::PathBuf;

fn parse(bytes: &[u8]) -> Result<ScanFile, FileError> {
    parse_file("file", bytes).map(|found| found.expect("a known family"))
}

fn error(bytes: &[u8]) -> String {
    parse(bytes).unwrap_err().to_string()
}

fn contains_all(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

/// NaN equals NaN, all else exactly.
fn same(left: &[f64], right: &[f64]) -> bool {
    left.len() == right.len()
        && left.iter().zip(right).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
}

/// A binary SDF file; the heights are the raw bytes.
fn sdf(version: &str, columns: u32, rows: u32, code: u8, heights: &[u8]) -> Vec<u8> {
    let mut bytes = version.as_bytes().to_vec();
    bytes.extend(b"asperity  010120261200010120261200");
    for length in [columns, rows] {
        if version == "bISO-2.0" {
            bytes.extend(length.to_le_bytes());
        } else {
            bytes.extend((length as u16).to_le_bytes());
        }
    }
    for scale in [2e-6_f64, 3e-6, 1e-6, -1.0] {
        bytes.extend(scale.to_le_bytes());
    }
    bytes.extend([0, code, 0]);
    bytes.extend(heights);
    bytes
}

/// A Digital Surf file with step units of um, one of nm for z, and a comment.
fn digital_surf(
    kind: i16,
    bits: i16,
    columns: i32,
    rows: i32,
    data: &[u8],
    packed: bool,
) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    let mut put = |offset: usize, field: &[u8]| {
        bytes[offset..offset + field.len()].copy_from_slice(field);
    };
    put(0, if packed { b"DSCOMPRESSED" } else { b"DIGITAL SURF" });
    put(14, &1_i16.to_le_bytes());
    put(18, &kind.to_le_bytes());
    put(50, b"a laboratory");
    put(86, &1_i16.to_le_bytes());
    put(98, &bits.to_le_bytes());
    put(100, &(-10_i32).to_le_bytes());
    put(108, &columns.to_le_bytes());
    put(112, &rows.to_le_bytes());
    put(120, &[2.0_f32.to_le_bytes(), 3.0_f32.to_le_bytes(), 0.5_f32.to_le_bytes()].concat());
    put(180, b"um              \xb5m              nm");
    put(334, &4_u16.to_le_bytes());
    put(474, &100.0_f32.to_le_bytes());
    bytes.extend(b"note");
    bytes.extend(data);
    bytes
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// An X3P file of the given members.
fn archive(members: &[(&str, &[u8])]) -> Vec<u8> {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in members {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn x3p_document(code: &str, size: (usize, usize), data: &str) -> String {
    let (columns, rows) = size;
    let feature = if rows == 1 { "PRF" } else { "SUR" };
    format!(
        "<?xml version=\"1.0\"?><p:R xmlns:p=\"u\"><Record1><FeatureType>{feature}</FeatureType><Axes>\
         <CX><AxisType>I</AxisType><Increment>2e-6</Increment></CX>\
         <CY><AxisType>I</AxisType><Increment>3e-6</Increment></CY>\
         <CZ><AxisType>A</AxisType><DataType>{code}</DataType><Increment>1e-6</Increment>\
         <Offset>1e-3</Offset></CZ></Axes></Record1>\
         <Record2><Instrument><Manufacturer>A &amp; B</Manufacturer></Instrument></Record2>\
         <Record3><MatrixDimension><SizeX>{columns}</SizeX><SizeY>{rows}</SizeY><SizeZ>1</SizeZ>\
         </MatrixDimension>{data}</Record3></p:R>"
    )
}

const LINK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";

#[test]
fn families_are_told_by_content() {
    for (bytes, family) in [
        (b"aBCR-1.0\r\n".as_slice(), Some(Format::Sdf)),
        (b"bISO-2.0", Some(Format::Sdf)),
        (b"bISO-3.0", None),
        (b"PK\x03\x04", Some(Format::X3p)),
        (b"DSCOMPRESSED", Some(Format::DigitalSurf)),
        (b"ERDFILEV2.00", Some(Format::Erd)),
        (b"1.0;2.0", None),
        (b"", None),
    ] {
        assert_eq!(Format::detect(bytes), family);
    }
}

#[test]
fn a_wyko_header_states_one_wavelength_of_light() {
    let text = "Wyko ASCII Data File Format\t0\t0\t1\nX Size\t2\t4\t2\nY Size\t2\t4\t2\n\
                Pixel_size\t7\t4\t0.001\nWavelength\t7\t4\t530\nMult\t2\t2\t1\n\
                RAW_DATA\t3\t16\t0\n0.1\t0.2\n0.3\t0.4\n";
    assert!(parse(text.as_bytes()).is_ok());
    let changed = |from: &str, to: &str| error(text.replace(from, to).as_bytes());
    for (value, part) in [("0", "`0`"), ("-530", "`-530`"), ("1e12", "`1000000000000`")] {
        contains_all(&changed("\t530", &format!("\t{value}")), &["line 5", part, "100 to 20000"]);
    }
    contains_all(&changed("Mult\t2\t2\t1", "Mult\t2\t2\t-1"), &["line 6", "a positive number"]);
    let twice = changed("Mult", "Wavelength\t7\t4\t633\nMult");
    contains_all(&twice, &["line 6", "Wavelength 633 beside 530"]);
}

#[test]
fn declared_sizes_are_checked_before_memory_is_asked_for() {
    let heights = [0; 100];
    contains_all(&error(&sdf("bISO-2.0", u32::MAX, u32::MAX, 7, &heights)), &["byte 42", "limit"]);
    contains_all(
        &error(&sdf("bISO-2.0", 1 << 20, 1, 7, &heights)),
        &["the heights must have", "185"],
    );
    contains_all(
        &error(&digital_surf(1, 16, i32::MAX, 1, &heights, false)),
        &["the heights must have 4294967294 bytes from byte 516", "the file has 616"],
    );
    contains_all(&error(&digital_surf(1, 16, -4, 1, &heights, false)), &["byte 108", "`-4`"]);
    let document = x3p_document("D", (1 << 31, 1), LINK);
    contains_all(
        &error(&archive(&[("main.xml", document.as_bytes())])),
        &["MatrixDimension", "limit"],
    );
    let document = x3p_document("D", (1 << 20, 1), LINK);
    let members = [("main.xml", document.as_bytes()), ("bindata/data.bin", &heights)];
    contains_all(&error(&archive(&members)), &["bindata/data.bin", "`100`", "8388608"]);
    contains_all(
        &error(b"ERDFILEV2.00\n1,4e9,-1,1,5,0.1,-1\nUNITSNAMmm\nXUNITS  m\nEND\n"),
        &["must have 7999999999", "58"],
    );
}

#[test]
fn digital_surf_heights_have_unit_offset_and_marks() {
    // The smallest height is -10: -12 marks a missing point.
    let raw: Vec<u8> = [-10_i16, 0, -12, 7].iter().flat_map(|v| v.to_le_bytes()).collect();
    let scan = parse(&digital_surf(1, 16, 4, 1, &raw, false)).unwrap();
    assert_eq!(scan.format, "Digital Surf profile");
    let Grid::Profile { spacing } = scan.grid else { panic!("{scan:?}") };
    approx::assert_relative_eq!(spacing, 2e-6, max_relative = 1e-15);
    for (height, expected) in scan.heights.iter().zip([95e-9, 100e-9, f64::NAN, 103.5e-9]) {
        assert!((height - expected).abs() < 1e-22 || (height.is_nan() && expected.is_nan()));
    }
    let named = |name: &str| scan.instrument.iter().find(|(key, _)| key == name).unwrap().1.clone();
    assert_eq!((named("operator"), named("comment")), ("a laboratory".into(), "note".into()));
}

#[test]
fn compressed_digital_surf_streams_are_those_of_the_plain_file() {
    let raw: Vec<u8> = (0..6_i32).flat_map(|v| (v * v).to_le_bytes()).collect();
    let plain = parse(&digital_surf(2, 32, 3, 2, &raw, false)).unwrap();
    let (first, second) = (zlib(&raw[..10]), zlib(&raw[10..]));
    let mut streams = 2_u32.to_le_bytes().to_vec();
    for (plain, packed) in [(10, &first), (14, &second)] {
        streams.extend([u32::to_le_bytes(plain), (packed.len() as u32).to_le_bytes()].concat());
    }
    streams.extend(first.iter().chain(&second));
    let packed = digital_surf(2, 32, 3, 2, &streams, true);
    let scan = parse(&packed).unwrap();
    assert_eq!((scan.grid, &scan.heights), (plain.grid, &plain.heights));
    let mut broken = packed;
    let last = broken.len() - 1;
    broken[last - 6] ^= 0xff;
    assert!(parse(&broken).is_err());
}

#[test]
fn the_record_of_the_instrument_is_written_and_read() {
    let text = |texts: &[(&str, &str)]| -> Vec<(String, String)> {
        texts.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect()
    };
    let mut scan = ScanFile {
        format: "test".into(),
        detected: String::new(),
        grid: Grid::Profile { spacing: 1e-6 },
        heights: vec![1e-6, 2e-6],
        instrument: text(&[
            ("manufacturer", "A & <B>"),
            ("model", "M\u{0}1"),
            ("created", "2021-10-11T09:30:00"),
            ("operator", "me"),
        ]),
    };
    let expected = text(&[
        ("manufacturer", "A & <B>"),
        ("model", "M 1"),
        ("created", "2021-10-11T09:30:00"),
        ("comment", "operator: me"),
    ]);
    assert_eq!(parse(&write_x3p(&scan).unwrap()).unwrap().instrument, expected);
    // A date that XML does not know stays as a text.
    scan.instrument = text(&[("created", "010120261200"), ("comment", "dry")]);
    let expected = text(&[("comment", "dry; created: 010120261200")]);
    assert_eq!(parse(&write_x3p(&scan).unwrap()).unwrap().instrument, expected);
}

const GWYDDION: &str = "# Canal: a\n# Largeur: 1,5 \u{b5}m\n# Hauteur: 20 nm\n# Value units: nm\n1,5\t2\tnan\n4\t5\t6\n";

#[test]
fn a_gwyddion_text_is_a_map_whatever_its_language() {
    let latin1 = encoding_rs::WINDOWS_1252.encode(GWYDDION).0;
    let marked = [b"\xef\xbb\xbf", GWYDDION.as_bytes()].concat();
    for bytes in [GWYDDION.as_bytes(), &latin1, &marked] {
        let scan = parse(bytes).unwrap();
        let Grid::Map { columns, rows, spacing_x, spacing_y } = scan.grid else {
            panic!("{scan:?}")
        };
        assert_eq!((columns, rows, scan.missing()), (3, 2, 1));
        approx::assert_relative_eq!(spacing_x, 0.5e-6, max_relative = 1e-15);
        approx::assert_relative_eq!(spacing_y, 10e-9, max_relative = 1e-15);
        assert!(same(&scan.heights, &[1.5, 2.0, f64::NAN, 4.0, 5.0, 6.0].map(|z| z * 1e-9)));
    }
    let changed = |from, to| error(GWYDDION.replace(from, to).as_bytes());
    contains_all(&changed("units: nm", "units: V"), &["line 4", "`V`", "a length"]);
    contains_all(&changed("5\t6", "5"), &["line 6", "`2`", "3 as in"]);
    contains_all(&changed("5\t6", "5\tx"), &["line 6", "`x`", "a number"]);
    contains_all(&changed("20 nm", "-20 nm"), &["line 3", "spacing"]);
    // Comments of other programmes are no header.
    for other in ["# a\n1 2\n", "# a: 1\n# b: 2 mm\n# c: 3 mm\n# d: 4\n1 2\n"] {
        assert_eq!(Format::detect(other.as_bytes()), None);
    }
}

#[test]
fn spacings_that_no_scan_has_are_named_with_their_place() {
    let mut bytes = sdf("bISO-1.0", 2, 2, 5, &[0; 8]);
    bytes[46..54].copy_from_slice(&5e3_f64.to_le_bytes());
    contains_all(&error(&bytes), &["file: byte 46", "`5e3`", "10 m"]);
    bytes[46..62].copy_from_slice(&[1e-6_f64.to_le_bytes(), 0_f64.to_le_bytes()].concat());
    contains_all(&error(&bytes), &["file: byte 54", "`0e0`"]);
    let mut bytes = digital_surf(2, 16, 2, 2, &[0; 8], false);
    bytes[124..128].copy_from_slice(&f32::NAN.to_le_bytes());
    contains_all(&error(&bytes), &["file: byte 124", "NaN"]);
    let document = x3p_document("I", (1, 1), LINK).replacen("2e-6", "2e6", 1);
    let members = [("main.xml", document.as_bytes()), ("bindata/data.bin", &[1, 0])];
    contains_all(&error(&archive(&members)), &["CX/Increment", "`2e6`"]);
    contains_all(
        &error(b"ERDFILEV2.00\n1,-1,-1,1,5,0,-1\nUNITSNAMmm\nXUNITS  m\nEND\n1\n2\n"),
        &["line 2", "spacing"],
    );
    // A mark that the format does not define: which height it is.
    let raw: Vec<u8> = [1.0, 1e30_f64].iter().flat_map(|z| z.to_le_bytes()).collect();
    contains_all(&error(&sdf("bISO-1.0", 2, 1, 7, &raw)), &["height 2", "mark of missing"]);
}

#[test]
fn an_erd_profile_is_read_in_its_units() {
    let text = "ERDFILEV2.00\n  2,  3,  -1,  1,  5,  0.25,  -1\nTITLE   A road\n\
                SHORTNAMTime    LElev.\nUNITSNAMs       mm\nXUNITS  m\nEND\n0 1.5\n1 -2\n2 3\n";
    let scan = parse(text.as_bytes()).unwrap();
    assert_eq!(scan.grid, Grid::Profile { spacing: 0.25 });
    assert_eq!(scan.heights, [1.5 * 1e-3, -2.0 * 1e-3, 3.0 * 1e-3]);
    assert!(scan.instrument.contains(&("channel".into(), "LElev.".into())), "{scan:?}");
    let changed = |from, to| error(text.replace(from, to).as_bytes());
    contains_all(&changed("1 -2", "1"), &["line 9", "`1`", "expected 2"]);
    contains_all(&changed("2,  3,", "2,  4,"), &["samples", "`3`", "expected 4"]);
    contains_all(&changed("mm\n", "kPa\n"), &["UNITSNAM", "a length"]);
    contains_all(&changed("XUNITS  m", "XUNITS  s"), &["XUNITS", "a length"]);
    contains_all(&changed("  5,", "  1,"), &["kind 1"]);
    contains_all(&changed("END", "LAST"), &["a line END"]);
}

#[test]
fn a_file_that_ends_within_its_last_number_is_refused() {
    let numbers: String = (0..20).map(|i| format!("\n{}.25", 10 + i)).collect();
    let sdf = "aISO-1.0\nNumPoints = 20\nNumProfiles = 1\nXscale = 1e-6\nYscale = 0\n\
               Zscale = 1e-6\nDataType = 7\n*";
    let erd = "ERDFILEV2.00\n1,-1,-1,1,5,0.25,-1\nUNITSNAMmm\nXUNITS  m\nEND";
    let gwyddion = "# a: b\n# c: 1 m\n# d: 1 m\n# e: mm";
    for (header, line) in [(sdf, 28), (erd, 25), (gwyddion, 24)] {
        let text = format!("{header}{numbers}");
        assert_eq!(parse(text.as_bytes()).unwrap().heights.len(), 20);
        let cut = &text[..text.len() - 1];
        let place = format!("file: line {line}: the file ends here without a line end");
        contains_all(&error(cut.as_bytes()), &[&place, "`29.2`", "copy it again"]);
        assert_eq!(parse(format!("{cut}\n").as_bytes()).unwrap().heights.len(), 20);
    }
}

#[test]
fn streams_that_are_longer_shorter_or_damaged_are_no_heights() {
    let raw: Vec<u8> = (0..3000_i32).flat_map(|v| (v * 7919 % 30_011).to_le_bytes()).collect();
    let file = |plain: &[u8], stated: u32| {
        let packed = zlib(plain);
        let mut streams = 1_u32.to_le_bytes().to_vec();
        streams.extend([stated.to_le_bytes(), (packed.len() as u32).to_le_bytes()].concat());
        streams.extend(packed);
        digital_surf(2, 32, 60, 50, &streams, true)
    };
    assert_eq!(parse(&file(&raw, 12_000)).unwrap().heights.len(), 3000);
    contains_all(
        &error(&file(&[&raw[..], &[0]].concat(), 12_000)),
        &["continues after its length"],
    );
    contains_all(&error(&file(&raw[1..], 12_000)), &["ends 1 bytes before its length"]);
    // The checksum of zlib is behind the data.
    let mut damaged = file(&raw, 12_000);
    *damaged.last_mut().unwrap() ^= 1;
    contains_all(&error(&damaged), &["file: byte 516", "copy the file again"]);
}

#[test]
fn rows_and_columns_of_a_map_are_line_scans() {
    let heights = vec![1.0, 2.0, 3.0, f64::NAN, f64::NAN, f64::NAN, 7.0, 8.0, 9.0];
    let map = ScanFile {
        format: "test".into(),
        detected: String::new(),
        grid: Grid::Map { columns: 3, rows: 3, spacing_x: 0.1, spacing_y: 0.2 },
        heights,
        instrument: Vec::new(),
    };
    let rows = map.line_scans("a", MapLines::Rows, 1).unwrap();
    // The second row has no height at all.
    let names: Vec<_> = rows.iter().map(|scan| scan.name.as_str()).collect();
    assert_eq!(names, ["a_row_0000", "a_row_0002"]);
    assert_eq!(
        (&rows[1].heights, &rows[1].positions),
        (&vec![7.0, 8.0, 9.0], &vec![0.0, 0.1, 0.2])
    );
    let columns = map.line_scans("a", MapLines::Columns, 2).unwrap();
    assert_eq!(columns.len(), 2);
    assert!(same(&columns[1].heights, &[3.0, f64::NAN, 9.0]));
    assert_eq!(columns[1].positions, [0.0, 0.2, 0.4]);
}

proptest! {
    #[test]
    fn x3p_files_come_back_bit_for_bit(
        heights in prop::collection::vec(prop::option::weighted(0.9, -1e-2..1e-2_f64), 2..200),
        spacing in 1e-7..1e-3_f64,
    ) {
        let mut heights: Vec<f64> = heights.into_iter().map(|z| z.unwrap_or(f64::NAN)).collect();
        heights[0] = 1e-3;
        let scan = ScanFile {
            format: "X3P PRF".into(),
            detected: String::new(),
            grid: Grid::Profile { spacing },
            heights,
            instrument: Vec::new(),
        };
        let back = parse(&write_x3p(&scan).unwrap()).unwrap();
        prop_assert_eq!(back.grid, scan.grid);
        prop_assert!(same(&back.heights, &scan.heights));
        let back = parse(write_sdf(&scan).as_bytes()).unwrap();
        prop_assert_eq!(back.grid, scan.grid);
        prop_assert!(same(&back.heights, &scan.heights));
    }

    #[test]
    fn any_bytes_behind_a_signature_are_an_answer(
        family in 0..10_usize, bytes in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        let signature: &[u8] = [
            b"bISO-1.0".as_slice(), b"aISO-1.0\n", b"PK\x03\x04", b"DIGITAL SURF", b"DSCOMPRESSED",
            b"ERDFILEV2.00\n", b"# a: b\n# c: 1 m\n# d: 1 m\n# e: m\n",
            b"Wyko ASCII Data File Format 0\t0\t1\nX Size\t2\nY Size\t2\nRAW_DATA\t3\t16\t\n",
            b"$ROAD_CRG\n$KD_Definition\n#:KRBI\nD:long section 1,m\n$\n$$\n", b"<DATA_POINT_VALUES>",
        ][family];
        let _ = parse_file("file", &[signature, &bytes].concat());
    }
}

/// Every file of the reference folder gives the numbers of independent readers.
#[test]
fn reference_files_have_the_expected_numbers() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/formats"));
    let Ok(text) = std::fs::read_to_string(folder.join("expected.json")) else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let expected: serde_json::Value = serde_json::from_str(&text).unwrap();
    let files = expected.as_object().unwrap().iter().filter(|(_, entry)| entry.is_object());
    let mut read = 0;
    for (name, entry) in files {
        let scan = read_file(&folder.join(name)).unwrap().unwrap();
        // Text files hold 15 digits; sums differ by their order.
        let near = |key: &str, value: f64| {
            let expected = entry[key].as_f64();
            assert!(
                expected.is_none_or(|e| (value / e - 1.0).abs() < 1e-10),
                "{name} {key}: {value}"
            );
        };
        assert_eq!(entry["missing"].as_u64(), Some(scan.missing() as u64), "{name}");
        near("mean_m", scan.mean());
        near("std_m", scan.standard_deviation());
        match scan.grid {
            Grid::Profile { spacing } => {
                assert_eq!(entry["points"].as_u64(), Some(scan.heights.len() as u64), "{name}");
                near("step_m", spacing);
            }
            Grid::Map { columns, rows, spacing_x, .. } => {
                assert_eq!(entry["shape"], serde_json::json!([rows, columns]), "{name}");
                near("step_m", spacing_x);
            }
        }
        read += 1;
    }
    assert_eq!(read, 9);
}
