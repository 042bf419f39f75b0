//! Text of columns: encodings, line ends, headers.
use super::*;

#[test]
fn the_micro_sign_alone_is_western_european() {
    let Some(bytes) = case("01_micro_sign_latin1/scan.csv") else { return };
    assert_eq!(shape(&bytes).encoding, "windows-1252");
    let scan = line(&bytes);
    let (mean, rms) = mean_and_rms(&scan.heights);
    assert_eq!(scan.heights.len(), 60);
    assert_relative_eq!(spacing(&scan), 10e-6, max_relative = 1e-9);
    assert_relative_eq!(mean, 1.0e-6, max_relative = 1e-4);
    assert_relative_eq!(rms, 2.8284e-6, max_relative = 1e-4);
}

#[test]
fn lone_signs_of_western_european_are_not_korean() {
    // Micro, degree, superscript and no-break space before letters that CP949 has pairs with.
    for (header, unit) in [
        ("x [mm];z [\u{b5}m]", Some(LengthUnit::Um)),
        ("x_mm;z_\u{b5}m", Some(LengthUnit::Um)),
        ("T [\u{b0}C];z [\u{b5}m]", Some(LengthUnit::Um)),
        ("A [\u{b2}A];z\u{a0}mm", Some(LengthUnit::Mm)),
        ("\u{b0}Brix;z\u{a0}mm", Some(LengthUnit::Mm)),
        ("Stra\u{df}e;H\u{f6}he (mm)", Some(LengthUnit::Mm)),
    ] {
        let text = format!("{header}\n0,1;1,5\n0,2;2,5\n0,3;1,5\n");
        let (bytes, _, lossy) = encoding_rs::WINDOWS_1252.encode(&text);
        assert!(!lossy);
        let found = shape(&bytes);
        assert_eq!((found.encoding, found.columns[1].unit), ("windows-1252", unit), "{header}");
    }
    for header in ["\u{ac70}\u{b9ac}(mm);\u{b192}\u{c774}(um)", "X\u{cd95}(mm);Z\u{cd95}(um)"] {
        let text = format!("{header}\n0.1;1.5\n0.2;2.5\n0.3;1.5\n");
        let (bytes, ..) = encoding_rs::EUC_KR.encode(&text);
        assert_eq!(shape(&bytes).encoding, "euc-kr", "{header}");
    }
}

#[test]
fn a_stylus_table_with_doubled_returns_and_empty_columns_is_read_by_its_proposal() {
    let Some(bytes) = case("02_stylus_csv_crcrlf/scan.csv") else { return };
    let found = shape(&bytes);
    assert_eq!((found.encoding, found.header, found.columns.len()), ("windows-1252", true, 2));
    assert_eq!(found.skip_until.as_deref(), Some("Scan Data"));
    assert_eq!(found.proposed_columns(), (Some(0), 1));
    let scan = line(&bytes);
    let (mean, rms) = mean_and_rms(&scan.heights);
    assert_eq!(scan.heights.len(), 240);
    assert_relative_eq!(spacing(&scan), 0.15624e-6, max_relative = 2e-3);
    assert_relative_eq!(mean, 0.056361e-6, max_relative = 1e-5);
    assert_relative_eq!(rms, 0.033521e-6, max_relative = 1e-4);
}

#[test]
fn every_line_end_gives_the_same_points() {
    let table = "Results\nRa,1.0 um\nRz,2.0 um\n\nScan Data\nLateral um,Raw Micrometer,\n\
                 0.0,0.5,,\n0.2,1.5,,\n0.4,1.0,,\n0.6,0.25,,\n";
    for end in ["\n", "\r\n", "\r\r\n", "\r"] {
        let text = table.replace('\n', end);
        let scan = line(text.as_bytes());
        assert_eq!(scan.heights, [0.5 / 1e6, 1.5 / 1e6, 1.0 / 1e6, 0.25 / 1e6], "{end:?}");
        // By number of lines as well, without the mark.
        let text = text.replace("Scan Data", "Position 3");
        assert_eq!(shape(text.as_bytes()).skip_lines, 5, "{end:?}");
        assert_eq!(line(text.as_bytes()).heights.len(), 4, "{end:?}");
    }
    let mixed = table.replacen('\n', "\r", 3).replacen('\n', "\r\n", 3);
    assert_eq!(line(mixed.as_bytes()).heights.len(), 4);
    // Heights alone: a doubled return is no blank line, and errors count lines as an editor.
    let format = "separator = 'comma'\nx_spacing_um = 1.0\nz_column = 1\nz_unit = 'um'";
    let format: TextFormat = toml::from_str(format).unwrap();
    let scan = parse_text("a", b"z\r\r\n1\r\r\n2\r\r\n", &format).unwrap();
    assert_eq!(scan.heights.len(), 2);
    let error = parse_text("a", b"z\r\r\n1\r\r\n2\r\r\nx\r\r\n", &format).unwrap_err();
    assert_eq!(error.line, Some(4));
    assert!(parse_text("a", b"z\r\r\n1\r\r\n\r\r\n2\r\r\n", &format).is_err());
}

#[test]
fn headers_that_are_longer_or_shorter_than_the_rows_are_read_by_their_proposal() {
    for text in [
        "x_mm,z_um,,\n0.0,1\n0.1,2\n0.2,1\n",
        "x_mm,z_um\n0.0,1,,\n0.1,2,,\n0.2,1,,\n",
        "x_mm,z_um,note\n0.0,1,\n0.1,2,\n0.2,1,\n",
        "x (mm)   z (um)\n0.0 1\n0.1 2\n0.2 1\n",
        "# x[mm] z[um]\n0.0 1\n0.1 2\n0.2 1\n",
        "time,x_mm,,z_um,\n7,0.0,,1,\n6,0.1,,2,\n8,0.2,,1,\n",
    ] {
        assert_eq!(line(text.as_bytes()).heights, [1e-6, 2e-6, 1e-6], "{text}");
    }
    // Fewer names than numbers name nothing; the proposal then asks.
    let found = shape(b"x_mm,z_um\n0.0,1,5\n0.1,2,7\n0.2,1,6\n");
    assert_eq!((found.header, found.format()), (false, Err(vec!["x_unit", "z_unit"])));
}

#[test]
fn the_longest_of_several_blocks_is_taken_and_a_mark_that_stands_twice_is_none() {
    let text = "Data\nRa;1\nRq;2\n\nData\nx_mm;z_um\n0.0;1\n0.1;2\n0.2;1\n0.3;4\n";
    let found = shape(text.as_bytes());
    assert_eq!((found.rows, found.skip_until, found.skip_lines), (4, None, 5));
    assert_eq!(line(text.as_bytes()).heights.len(), 4);
}

#[test]
fn a_unit_that_is_a_thousand_times_off_is_refused() {
    let row = |i: usize| format!("{:.4};{:.3}\n", 0.0375 * i as f64, (i as f64 * 0.7).sin() * 20.0);
    let text = String::from("x;z\n") + &(0..200).map(row).collect::<String>();
    let format = |x: &str, z: &str| -> TextFormat {
        toml::from_str(&format!(
            "separator = ';'\nx_column = 'x'\nx_unit = '{x}'\nz_column = 'z'\nz_unit = '{z}'"
        ))
        .unwrap()
    };
    assert!(parse_text("a", text.as_bytes(), &format("mm", "um")).is_ok());
    for (x, z) in [("um", "um"), ("mm", "mm")] {
        let error = parse_text("a", text.as_bytes(), &format(x, z)).unwrap_err().to_string();
        for part in ["steeper than", "x_unit", "z_unit"] {
            assert!(error.contains(part), "{error}");
        }
    }
}
