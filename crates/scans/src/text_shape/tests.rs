//! Shapes of texts from laboratories.

use super::*;
use crate::{TextFormat, parse_text};
use std::path::PathBuf;

fn shape(bytes: &[u8]) -> TextShape {
    TextShape::of(bytes).unwrap()
}

/// The description that the proposed section of a recipe is.
fn description(shape: &TextShape) -> TextFormat {
    #[derive(serde::Deserialize)]
    struct Recipe {
        ingest: Ingest,
    }
    #[derive(serde::Deserialize)]
    struct Ingest {
        text: TextFormat,
    }
    let format = toml::from_str::<Recipe>(&shape.recipe_section()).unwrap().ingest.text;
    assert_eq!(shape.format().as_ref(), Ok(&format));
    format
}

#[test]
fn a_preamble_with_a_marker_and_a_counter_is_seen_through() {
    let text = "Road Name\tCAPTIF\t\nStart Pos (m)\t0\t\n*****DATA*****\t\t\n\
                Data Point No:\tDistance (mm)\tDepth (mm)\n1.000\t0.000\t-3.015\n2.000\t0.037\t-3.004\n\
                2.000\t0.075\tNaN\n3.000\t0.112\t-2.9\n";
    let found = shape(text.as_bytes());
    assert_eq!((found.separator, found.decimal_mark), (Separator::Tab, DecimalMark::Point));
    assert_eq!((found.skip_until.as_deref(), found.rows), (Some("*****DATA*****"), 4));
    let format = description(&found);
    let scan = parse_text("captif", text.as_bytes(), &format).unwrap();
    assert_eq!(scan.heights[..2], [-3.015 / 1e3, -3.004 / 1e3]);
    assert!(scan.heights[2].is_nan());
}

#[test]
fn a_footer_is_proposed_where_points_end_and_a_fault_between_points_is_not_one() {
    let points = |from: usize| -> String {
        (from..from + 4).map(|k| format!("{k},{}.5\n", k % 3)).collect()
    };
    let text = format!("x (mm),z (um)\n{}\nRa (um),1.25\n\"Signed\",A. Nobody\n", points(0));
    let found = shape(text.as_bytes());
    assert_eq!((found.stop_at.as_deref(), found.rows), (Some("Ra (um"), 4));
    let scan = parse_text("a", text.as_bytes(), &description(&found)).unwrap();
    assert_eq!(scan.heights.len(), 4);
    let fault = format!("x (mm),z (um)\n{}error in line\n{}", points(0), points(4));
    let found = shape(fault.as_bytes());
    assert_eq!(found.stop_at, None);
    let error = parse_text("a", fault.as_bytes(), &description(&found)).unwrap_err();
    assert_eq!(error.line, Some(6), "{error}");
    let whole = format!("x (mm),z (um)\n{}\n  \n", points(0));
    assert_eq!(shape(whole.as_bytes()).stop_at, None);
}

#[test]
fn decimal_commas_latin1_and_quoted_cells() {
    let text = b"Pr\xfcfer;M\xfcller\n\"Weg [mm]\";\"H\xf6he [\xb5m]\"\n\"0,0\";\"12,5\"\n\"0,1\";\"-3,25\"\n";
    let found = shape(text);
    assert_eq!((found.encoding, found.decimal_mark), ("windows-1252", DecimalMark::Comma));
    let units: Vec<_> = found.columns.iter().map(|column| column.unit).collect();
    assert_eq!(units, [Some(LengthUnit::Mm), Some(LengthUnit::Um)]);
    let scan = parse_text("a", text, &description(&found)).unwrap();
    assert_eq!(scan.heights, [12.5 / 1e6, -3.25 / 1e6]);
}

#[test]
fn korean_text_is_told_by_its_hangul() {
    let (bytes, ..) =
        encoding_rs::EUC_KR.encode("측정 결과,\n거리(mm),높이(um)\n0.0,1.5\n0.1,2.5\n0.2,1.0\n");
    let found = shape(&bytes);
    assert_eq!((found.encoding, found.separator), ("euc-kr", Separator::Comma));
    let scan = parse_text("a", &bytes, &description(&found)).unwrap();
    assert_eq!(scan.heights, [1.5 / 1e6, 2.5 / 1e6, 1.0 / 1e6]);
}

#[test]
fn units_that_are_not_stated_are_asked_for() {
    let found = shape(b"   1.0e+00   2.0\n   2.0e+00   1.0\n   3.5e+00   4.0\n");
    let section = found.recipe_section();
    assert!(section.contains("# x_unit = ?") && section.contains("# z_unit = ?"), "{section}");
    assert_eq!(found.format(), Err(vec!["x_unit", "z_unit"]));
    assert!(section.contains("header = false") && section.contains("x_column = 1"), "{section}");
}

#[test]
fn rows_of_heights_are_proposed_as_a_matrix_with_its_spacing_left_open() {
    let rough = |i: usize, j: usize| ((i * 7 + j * 5) % 11) as f64 / 2.0;
    let rising = |i: usize, j: usize| (i + j) as f64;
    for (columns, height) in [(8, rough as fn(usize, usize) -> f64), (8, rising), (30, rough)] {
        let mut text = String::from("% exported\n");
        for j in 0..20 {
            let cell = |i: usize| match (i, j) {
                (3, 4) | (5, 6) => "***".to_owned(),
                (2, 2 | 9) => "-9999".to_owned(),
                _ => height(i, j).to_string(),
            };
            text += &((0..columns).map(cell).collect::<Vec<_>>().join("\t") + "\n");
        }
        let found = shape(text.as_bytes());
        assert!(found.is_matrix() && found.is_map(), "{found:?}");
        assert_eq!(found.missing, ["***", "-9999"]);
        assert_eq!(found.format(), Err(vec!["x_spacing_um", "z_unit"]));
        let section = found.recipe_section();
        let part = "matrix = true\n# x_spacing_um = ?";
        assert!(section.contains(part) && !section.contains("column ="), "{section}");
        // With what was left open it is a description that reads the file.
        let section = section
            .replace("# x_spacing_um = ?", "x_spacing_um = 5")
            .replace("# z_unit = ?", "z_unit = 'um'");
        let format: TextFormat = toml::from_str(section.split_once('\n').unwrap().1).unwrap();
        let crate::Described::Map(map) =
            crate::parse_described("a", text.as_bytes(), &format).unwrap()
        else {
            panic!("{section}")
        };
        assert_eq!((map.heights.len(), map.missing()), (20 * columns, 4));
    }
}

#[test]
fn text_without_numbers_has_no_shape() {
    for bytes in [b"".as_slice(), b"no numbers\nat all\n", b"1\n", &[0xff, 0, 1], b"\xff\xfe"] {
        assert_eq!(TextShape::of(bytes), None, "{bytes:?}");
    }
}

#[test]
fn utf_16_without_a_mark_is_told() {
    let bytes: Vec<u8> = "0;1\n1;2\n2;1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(shape(&bytes).encoding, "utf-16le");
}

#[test]
fn marks_of_missing_heights_are_proposed() {
    let height = |i: usize| match i {
        7 | 9 | 2500 => "-9999.0".into(),
        11 | 13 => "1e30".into(),
        20 => "n/a".into(),
        _ => format!("{}", (i % 10) as f64 - 4.5),
    };
    let line = |i: usize| format!("{:.2},{}\n", i as f64 / 100.0, height(i));
    let text = String::from("x_mm,z_um\n") + &(0..3000).map(line).collect::<String>();
    let found = shape(text.as_bytes());
    assert_eq!((found.missing.join(" "), found.rows), ("n/a -9999 1e30".into(), 3000));
    let scan = parse_text("a", text.as_bytes(), &description(&found)).unwrap();
    assert_eq!(scan.heights.iter().filter(|z| z.is_nan()).count(), 6);
    // Clipped heights, a single outlier and a flat file mark nothing.
    for heights in ["5 5 1 2 3 4", "-900 1 2 3 2 1", "2 2 2 2 2 2", "0 0 9 9"] {
        let text = heights.split(' ').enumerate().map(|(i, z)| format!("{i},{z}\n"));
        let found = shape(text.collect::<String>().as_bytes());
        assert_eq!(found.missing, Vec::<String>::new(), "{heights}");
    }
}

/// Heights of four digits of which every thirtieth is `mark`.
fn with_marks(mark: &str, points: usize) -> String {
    // Odd in the last digit, so that none is by chance the mark.
    let odd = |z: f64| f64::from(2 * (5000.0 * z).round() as i32 + 1) / 1e4;
    let height = |i: usize| match i % 30 {
        7 => mark.to_owned(),
        _ => format!("{:.4}", odd(0.9 * (0.37 * i as f64).sin() + 0.05 * (2.3 * i as f64).cos())),
    };
    let line = |i: usize| format!("{:.3},{}\n", i as f64 * 0.05, height(i));
    String::from("X [mm],Z [mm]\n") + &(0..points).map(line).collect::<String>()
}

#[test]
fn a_height_within_the_range_that_repeats_is_proposed_as_a_mark() {
    for (mark, cell) in [("0.0000", "0"), ("-0.0000", "0"), ("0", "0"), ("0.1250", "0.125")] {
        let found = shape(with_marks(mark, 900).as_bytes());
        assert_eq!(found.missing, [cell], "{mark}");
        let text = with_marks(mark, 900);
        let scan = parse_text("a", text.as_bytes(), &description(&found)).unwrap();
        assert_eq!(scan.heights.iter().filter(|z| z.is_nan()).count(), 30, "{mark}");
    }
}

#[test]
fn heights_that_repeat_for_other_reasons_are_no_marks() {
    let none = |heights: Vec<f64>| assert_eq!(repeated_inside(&heights), []);
    let wave = |i: usize| 0.9 * (0.37 * (i + 1) as f64).sin();
    // Clipped at both ends of the range.
    none((0..900).map(|i| wave(i).clamp(-0.5, 0.5)).collect());
    // A plate of one height, once and twice.
    none((0..900).map(|i| if (100..200).contains(&i) { 0.0 } else { wave(i) }).collect());
    none((0..900).map(|i| if (50..=800).contains(&i) { wave(i) } else { 0.0 }).collect());
    // Steps of an instrument: all heights repeat, those at the crests more often.
    none((0..9000).map(|i| (wave(i) * 50.0).round() / 50.0).collect());
    // Five points are no pattern, and all the same height is another fault.
    none((0..150).map(|i| if i % 30 == 7 { 0.0 } else { wave(i) }).collect());
    none(vec![0.0; 100]);
    none(vec![]);
    none(vec![f64::NAN; 10]);
}

#[test]
fn two_marks_within_the_range_are_both_found() {
    let wave = |i: usize| 0.9 * (0.37 * (i + 1) as f64).sin();
    let height = |i: usize| match i % 40 {
        3 | 11 | 19 => 0.0,
        30 => -0.25,
        _ => wave(i),
    };
    let found = repeated_inside(&(0..800).map(height).collect::<Vec<_>>());
    let found: Vec<(f64, usize)> = found.iter().map(|mark| (mark.height, mark.count)).collect();
    assert_eq!(found, [(0.0, 60), (-0.25, 20)]);
}

/// The zeros of `../shared/cases/06_zero_means_no_return`, with the figures of its `case.md`.
#[test]
fn the_zeros_of_a_laser_line_are_proposed() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared"));
    let Ok(bytes) = std::fs::read(folder.join("cases/06_zero_means_no_return/scan.csv")) else {
        println!("skipped: {}/cases/06_zero_means_no_return is not there", folder.display());
        return;
    };
    let found = shape(&bytes);
    assert_eq!(found.missing, ["0"]);
    let scan = parse_text("a", &bytes, &description(&found)).unwrap();
    assert_eq!(scan.heights.len(), 800);
    assert_eq!(scan.heights.iter().filter(|z| z.is_nan()).count(), 23);
}

#[test]
fn two_lines_of_names_and_heights_alone() {
    for text in ["x;z\nmm;um\n0,0;1\n0,5;2\n1,0;1\n", "x (mm);z (um)\na;a\n0,0;1\n0,5;2\n1,0;1\n"] {
        let scan = parse_text("a", text.as_bytes(), &description(&shape(text.as_bytes()))).unwrap();
        assert_eq!(scan.heights, [1e-6, 2e-6, 1e-6]);
    }
    let found = shape(b"z_um\n1\nBAD\n3\n");
    assert_eq!((found.rows, found.format()), (3, Err(vec!["x_spacing_um"])));
}

#[test]
fn marks_that_are_not_known_are_proposed_and_keep_the_header() {
    for mark in ["***", "#N/A", "Saturated", "-nan(ind)", "-1.#IND", "inf"] {
        let height = |i: usize| match i {
            0 | 7 | 8 => mark.to_owned(),
            _ => format!("{}", (i % 10) as f64 - 4.5),
        };
        let line = |i: usize| format!("{:.2};{}\n", i as f64 / 100.0, height(i));
        let text = String::from("x_mm;z_um\n") + &(0..3000).map(line).collect::<String>();
        let found = shape(text.as_bytes());
        assert_eq!(
            (&found.missing, found.rows, found.header),
            (&vec![mark.to_owned()], 3000, true)
        );
        let scan = parse_text("a", text.as_bytes(), &description(&found)).unwrap();
        assert_eq!(scan.heights.iter().filter(|z| z.is_nan()).count(), 3, "{mark}");
    }
    // What stands before and after the points begins with a word.
    let found = shape(b"Speed;50\nx_mm;z_um\n0;1\n1;2\n2;1\nMean;5\n");
    assert_eq!((found.rows, found.skip_lines, found.missing.len()), (3, 1, 0));
}

#[test]
fn positions_may_be_there_twice_and_may_not_turn_back() {
    let grows = |text: &str| shape(text.as_bytes()).columns[0].grows;
    assert!(grows("0;5\n0;4\n1;5\n1;4\n2;5\n2;4\n"));
    assert!(!grows("0;5\n1;4\n0.5;5\n2;4\n"));
    assert!(!grows("0;5\n0;4\n0;5\n0;4\n1;4\n"));
}

#[test]
fn separated_thousands_are_seen_and_are_no_marks_of_gaps() {
    let line = |i: usize| format!("{:.4};{},{:03}.25\n", i as f64 * 0.05, 1 + i, 7 * i);
    let text = String::from("x_mm;z_um\n") + &(0..100).map(line).collect::<String>();
    let found = shape(text.as_bytes());
    assert_eq!((found.thousands.as_deref(), found.rows), (Some("1,000.25"), 100));
    assert_eq!(found.missing, Vec::<String>::new());
    let german = shape(b"x_mm;z_um\n0,05;1.234\n0,10;345\n0,15;2.345\n");
    assert_eq!(
        (german.decimal_mark, german.thousands.as_deref()),
        (DecimalMark::Comma, Some("1.234"))
    );
    // Three decimals behind a comma are no thousands.
    let decimals = shape(b"x_mm;z_um\n1,000;1,234\n1,050;2,345\n1,100;1,345\n");
    assert_eq!((decimals.decimal_mark, decimals.thousands), (DecimalMark::Comma, None));
}

#[test]
fn a_description_that_contradicts_the_names_of_the_columns_is_told() {
    let found = shape(b"Distance (mm);Depth (mm)\n0;1\n0.1;2\n0.2;1\n");
    let format = found.format().unwrap();
    assert_eq!(found.contradictions(&format), Vec::<String>::new());
    let wrong = TextFormat { x_unit: Some(LengthUnit::Um), ..format.clone() };
    assert_eq!(
        found.contradictions(&wrong),
        ["the column `Distance (mm)` states mm, the description x_unit = \"um\""]
    );
    let by_number =
        TextFormat { z_column: Some(Column::Number(2)), z_unit: Some(LengthUnit::M), ..format };
    assert_eq!(found.contradictions(&by_number).len(), 1);
    // A number among columns that another separator makes is another column.
    let other = TextFormat { separator: Separator::Comma, ..by_number };
    assert_eq!(found.contradictions(&other), Vec::<String>::new());
}

/// The texts beside the reference files.
#[test]
fn reference_texts_have_their_shapes() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared"));
    let read = |name: &str| std::fs::read(folder.join(name));
    let Ok(german) = read("formats/text/gwyddion-export-german.txt") else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let german = shape(&german);
    assert_eq!((german.comment, german.columns.len(), german.rows), (Some('#'), 3, 4));
    assert_eq!(german.stated.len(), 3, "{german:?}");
    let nonuniform = shape(&read("formats/text/nonuniform.asc").unwrap());
    assert_eq!((nonuniform.header, nonuniform.columns.len()), (false, 2));
    assert_eq!(nonuniform.proposed_columns(), (Some(0), 1));
    let captif = read("scans/captif/20211011_aylesbury_dec_station_0.dat").unwrap();
    let scan = parse_text("captif", &captif, &description(&shape(&captif))).unwrap();
    assert_eq!(scan.heights.len(), 51067);
}
