//! SDF as text and binary.

use super::*;

#[test]
fn every_integer_type_of_sdf_has_its_mark_of_missing_points() {
    // Raw values 1, mark, 3 in each type; the mark of ISO is the smallest of signed types.
    let of_iso: [(u8, Vec<u8>); 6] = [
        (0, vec![1, 255, 3]),
        (1, [1_u16, u16::MAX, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (2, [1_u32, u32::MAX, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (4, vec![1, 128, 3]),
        (5, [1_i16, i16::MIN, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (6, [1_i32, i32::MIN, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
    ];
    for (code, heights) in of_iso {
        for version in ["bISO-1.0", "bISO-2.0"] {
            let scan = parse(&sdf(version, 3, 1, code, &heights)).unwrap();
            assert!(same(&scan.heights, &[1e-6, f64::NAN, 3.0 * 1e-6]), "{code}: {scan:?}");
        }
    }
    let of_bcr: Vec<u8> =
        [1_i16, i16::MAX, i16::MIN].iter().flat_map(|v| v.to_le_bytes()).collect();
    let scan = parse(&sdf("bBCR-1.0", 3, 1, 5, &of_bcr)).unwrap();
    assert!(same(&scan.heights, &[1e-6, f64::NAN, -32768.0 * 1e-6]), "{scan:?}");
}

#[test]
fn floating_point_marks_of_sdf_never_become_heights() {
    for mark in [f64::NAN, f64::MAX, -f64::MAX, 1.7e308, -1.7e308, f64::INFINITY, f64::NEG_INFINITY]
    {
        let heights: Vec<u8> = [1.0, mark, 3.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        let scan = parse(&sdf("bISO-1.0", 3, 1, 7, &heights)).unwrap();
        assert_eq!((scan.missing(), scan.mean()), (1, 2.0 * 1e-6));
    }
    let heights: Vec<u8> = [1.0, f32::MAX, 3.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(parse(&sdf("bBCR-1.0", 3, 1, 3, &heights)).unwrap().missing(), 1);
}

#[test]
fn a_text_sdf_is_read_and_its_faults_are_named() {
    let text = "aISO-1.0\r\nManufacID = me\r\nNumPoints = 2\r\nNumProfiles = 2\r\nXscale = 1e-6\r\n\
                Yscale = 2e-6\r\nZscale = 1e-9\r\nDataType = 5\r\n*\r\n1 BAD\r\n-3 4\r\n*\r\nnote\r\n";
    let scan = parse(text.as_bytes()).unwrap();
    let grid = Grid::Map { columns: 2, rows: 2, spacing_x: 1e-6, spacing_y: 2e-6 };
    assert_eq!((scan.grid, scan.missing()), (grid, 1));
    assert!(same(&scan.heights, &[1e-9, f64::NAN, -3.0 * 1e-9, 4.0 * 1e-9]));
    let changed = |from, to| error(text.replace(from, to).as_bytes());
    contains_all(&changed("-3 4", "-3 x"), &["file: line 11", "`x`", "a number or BAD"]);
    contains_all(&changed("-3 4", "-3"), &["the number of heights is `3`", "expected 4 (Num"]);
    let many = changed("NumPoints = 2", "NumPoints = 2147483648");
    contains_all(&many, &["the heights must have 8589934591 bytes"]);
    contains_all(&changed("NumPoints = 2", "NumPoints = 2147483648000"), &["line 3", "limit"]);
    contains_all(&changed("DataType = 5", "DataType = 9"), &["line 8", "0 to 7"]);
    contains_all(&changed("Xscale", "Xskale"), &["Xscale"]);
    contains_all(&changed("*\r\n1", "1"), &["`key = value` or `*`"]);
    let again = |second: &str| text.replace("Yscale", &format!("Xscale = {second}\r\nYscale"));
    contains_all(&error(again("4e-6").as_bytes()), &["line 6", "Xscale = 4e-6 beside 1e-6"]);
    assert!(parse(again("1e-6").as_bytes()).is_ok());
}
