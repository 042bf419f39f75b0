//! X3P: types, masks, faults, checksums, bombs.

use super::*;

#[test]
fn x3p_data_of_every_type_and_mask_are_read() {
    // Raw 1, 2, 3, 4, of which the mask takes the second.
    let cases: [(&str, Vec<u8>); 4] = [
        ("I", (1..=4_i16).flat_map(i16::to_le_bytes).collect()),
        ("L", (1..=4_i32).flat_map(i32::to_le_bytes).collect()),
        ("F", (1..=4_i16).flat_map(|v| f32::from(v).to_le_bytes()).collect()),
        ("D", (1..=4_i16).flat_map(|v| f64::from(v).to_le_bytes()).collect()),
    ];
    let link = LINK
        .replace("</DataLink>", "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>");
    for (code, data) in cases {
        let document = x3p_document(code, (2, 2), &link);
        let members = [
            ("main.xml", document.as_bytes()),
            ("bindata/data.bin", &data),
            ("bindata/valid.bin", &[0b1101]),
        ];
        let scan = parse(&archive(&members)).unwrap();
        let expected = [1.0, f64::NAN, 3.0, 4.0].map(|raw| raw * 1e-6 + 1e-3);
        assert!(same(&scan.heights, &expected), "{code}: {scan:?}");
        assert_eq!(scan.instrument, [("manufacturer".to_owned(), "A & B".to_owned())]);
        assert_eq!(scan.format, "X3P SUR");
    }
}

#[test]
fn x3p_faults_are_named() {
    let with = |document: &str| error(&archive(&[("main.xml", document.as_bytes())]));
    let list = "<DataList><Datum>1</Datum><Datum/><Datum>3</Datum></DataList>";
    let good = x3p_document("I", (3, 1), list);
    let scan = parse(&archive(&[("main.xml", good.as_bytes())])).unwrap();
    assert_eq!(scan.missing(), 1);
    let changed = |from: &str, to: &str| with(&good.replacen(from, to, 1));
    contains_all(&changed("<Datum>3", "<Datum>3;4"), &["Datum[3]", "`3;4`"]);
    contains_all(&changed("<Datum/>", ""), &["Record3/DataList", "`2`", "expected 3"]);
    contains_all(&changed("PRF", "PCL"), &["point clouds"]);
    contains_all(&changed("<CX><AxisType>I", "<CX><AxisType>A"), &["CX/AxisType", "absolute"]);
    contains_all(&changed("<Increment>2e-6", "<Increment>NaN"), &["CX/Increment", "finite"]);
    contains_all(&changed("<SizeX>3", "<SizeX>many"), &["SizeX", "`many`"]);
    contains_all(&changed("<p:R", "<!DOCTYPE x [<!ENTITY a \"b\">]><p:R"), &["document type"]);
    contains_all(&changed("A &amp; B", "&bomb;"), &["entity `bomb`"]);
    contains_all(&changed("</Record3>", ""), &["main.xml", "byte"]);
    let deep = format!("{}{}", "<a>".repeat(100), "</a>".repeat(100));
    contains_all(&changed("<Record1>", &format!("{deep}<Record1>")), &["depth", "32"]);
    contains_all(&error(&archive(&[("other", b"")])), &["zip archive", "no main.xml"]);
    contains_all(&error(b"PK\x03\x04 but no more"), &["no zip archive"]);
}

#[test]
fn x3p_checksums_that_differ_are_errors() {
    let document = x3p_document("I", (1, 1), "<DataList><Datum>1</Datum></DataList>");
    let wrong = b"00000000000000000000000000000000 *main.xml\n";
    let members = [("main.xml", document.as_bytes()), ("md5checksum.hex", wrong.as_slice())];
    contains_all(&error(&archive(&members)), &["main.xml", "MD5", "00000000"]);
    let link =
        LINK.replace("</DataLink>", "<MD5ChecksumPointData>abc</MD5ChecksumPointData></DataLink>");
    let document = x3p_document("I", (1, 1), &link);
    let members = [("main.xml", document.as_bytes()), ("bindata/data.bin", &[1, 0])];
    contains_all(&error(&archive(&members)), &["bindata/data.bin", "abc"]);
}

#[test]
fn an_archive_that_is_no_x3p_or_holds_nothing_is_told() {
    contains_all(&error(&archive(&[("main.xml", b"")])), &["main.xml", "empty"]);
    let document = x3p_document("I", (1, 1), LINK);
    let members = [("main.xml", document.as_bytes()), ("bindata/data.bin", b"".as_slice())];
    contains_all(&error(&archive(&members)), &["bindata/data.bin", "`0`", "expected 2"]);
}

#[test]
fn a_zip_bomb_is_refused_by_its_ratio() {
    let zeros = vec![0; 8 << 20];
    let document = x3p_document("D", (1 << 20, 1), LINK);
    let bomb = archive(&[("main.xml", document.as_bytes()), ("bindata/data.bin", &zeros)]);
    assert!(bomb.len() < 20_000);
    contains_all(&error(&bomb), &["bindata/data.bin", "bytes unpack to 8388608", "200 times"]);
}

#[test]
fn names_in_an_archive_are_no_paths() {
    let link = LINK.replace("bindata/data.bin", "../../etc/hostname");
    let document = x3p_document("I", (1, 1), &link);
    contains_all(&error(&archive(&[("main.xml", document.as_bytes())])), &["not there"]);
}
