//! Good files and real files; those that cannot be read are in `bad_files`.

mod bad_files;
mod matrix;

use super::*;
use crate::description::{Column, DecimalMark, LengthUnit, Separator};
use asperity_core::surface::{Conditioning, condition};
use std::path::PathBuf;

fn format(toml: &str) -> TextFormat {
    toml::from_str(toml).unwrap()
}

/// Positions in column 1, heights in column 2, in millimetres, under a header.
fn simple(extra: &str) -> TextFormat {
    format(&format!(
        "separator = 'comma'\nx_column = 1\nx_unit = 'mm'\nz_column = 2\nz_unit = 'mm'\n{extra}"
    ))
}

fn message(text: impl AsRef<[u8]>, format: &TextFormat) -> String {
    parse_text("scan", text.as_ref(), format).unwrap_err().to_string()
}

#[track_caller]
fn assert_fails(text: impl AsRef<[u8]>, format: &TextFormat, start: &str) {
    let message = message(text, format);
    assert!(message.starts_with(start), "{message}");
}

#[test]
fn the_description_reads_from_a_recipe_and_back() {
    let full = format(
        "separator = ';'\ndecimal_mark = ','\ncomment = '#'\nskip_lines = 2\nskip_until = '[data]'\n\
         header = false\nx_spacing_um = 0.1\nz_column = 3\nz_unit = 'nm'\ninvert_z = true\n\
         missing = ['-1']\nencoding = 'latin1'\ncut_start_mm = 1.0\ncut_end_mm = 2.0",
    );
    assert_eq!(full.separator.character(), Some(';'));
    assert_eq!(full.decimal_mark, DecimalMark::Comma);
    assert_eq!(full.z_column, Some(Column::Number(3)));
    assert_eq!(format(&toml::to_string(&full).unwrap()), full);

    let schema = serde_json::to_value(schemars::schema_for!(TextFormat)).unwrap();
    assert_eq!(schema["required"], serde_json::json!(["separator", "z_unit"]));

    let named = simple("");
    assert_eq!((named.header, named.x_unit), (Some(true), Some(LengthUnit::Mm)));
    assert_eq!(format("separator = 'whitespace'\nz_column = 'z'").separator, Separator::Whitespace);
    assert!(
        toml::from_str::<TextFormat>("separator = 'comma'\nz_column = 1\nz_units = 'mm'").is_err()
    );
}

#[test]
fn units_come_out_in_metres_and_are_the_nearest_doubles() {
    let text = "x,z\n1.000,0.003\n1.001,NaN\n1.002,-25400.000\n1.003,0.3\n";
    let scan = parse_text("a", text.as_bytes(), &simple("missing = ['nan', '-25400']")).unwrap();
    assert_eq!(scan.positions, [1.000e-3, 1.001e-3, 1.002e-3, 1.003e-3]);
    assert_eq!((scan.heights[0], scan.heights[3]), (3e-6, 3e-4));
    assert!(scan.heights[1].is_nan() && scan.heights[2].is_nan());
}

#[test]
fn depths_are_turned_round() {
    let scan = parse_text("a", b"x,z\n0,1\n1,2\n", &simple("invert_z = true")).unwrap();
    assert_eq!(scan.heights, [-1e-3, -2e-3]);
}

#[test]
fn layouts_of_one_scan_agree() {
    let expected = parse_text("a", b"x,z\n0.5,1.25\n1.5,\n2.5,-2\n", &simple("")).unwrap();
    let same = |bytes: &[u8], format: &TextFormat| {
        let scan = parse_text("a", bytes, format).unwrap();
        assert_eq!(scan.positions, expected.positions, "{format:?}");
        assert_eq!(format!("{:?}", scan.heights), format!("{:?}", expected.heights), "{format:?}");
    };
    let units = "x_unit = 'mm'\nz_unit = 'mm'\n";
    same(b"x,z\r\n0.5,1.25\r\n1.5,BAD\r\n2.5,-2\r\n\r\n\r\n", &simple(""));
    same(b"x,z\r0.5,1.25\r1.5,\r2.5,-2", &simple(""));
    same(b"x,z,\n0.5,1.25,\n1.5,,\n2.5,-2,,,\n,,\n", &simple(""));
    same(b"\"x, mm\",z\n\"0.5\",1.25\n1.5,\"\"\n2.5,-2\n", &simple(""));
    same(b"\xEF\xBB\xBFx,z\n0.5,1.25\n1.5,\n2.5,-2\n", &simple("encoding = 'latin1'"));
    let german = format!(
        "separator = 'semicolon'\ndecimal_mark = ','\nx_column = 'H\u{f6}he'\nz_column = 1\n{units}"
    );
    same(b"z;H\xF6he\n1,25;0,5\n;1,5\n-2;2,5\n", &format(&(german + "encoding = 'latin1'")));
    let blanks = format!(
        "separator = 'whitespace'\nheader = false\ncomment = '%'\nx_column = 2\nz_column = 3\n{units}"
    );
    same(b"% made by\n 1  0.5\t1.25 \n\n2  1.5  NaN\n%\n3  2.5  -2", &format(&blanks));
    let utf16: Vec<u8> =
        "\u{FEFF}x,z\n0.5,1.25\n1.5,\n2.5,-2\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    same(&utf16, &simple(""));
    same(&utf16[2..], &simple("encoding = 'utf-16le'"));
}

#[test]
fn heights_alone_get_positions_from_the_spacing() {
    let heights_only = format(
        "separator = 'tab'\nheader = false\nx_spacing_um = 0.1\nz_column = 1\nz_unit = 'um'",
    );
    let scan = parse_text("a", b"1\n\"\"\n3\n", &heights_only).unwrap();
    // 0.1 is no double; a multiple of it over 1e6 errs by two roundings.
    for (position, expected) in scan.positions.iter().zip([0.0, 1e-7, 2e-7]) {
        approx::assert_relative_eq!(*position, expected, max_relative = 2.0 * f64::EPSILON);
    }
    assert_eq!(scan.heights[2], 3e-6);
    assert!(scan.heights[1].is_nan());
    // A blank line may stand for a missing height or for nothing; the track would shift.
    assert_fails("1\r\n2\r\n\r\n3\r\n", &heights_only, "scan, line 4: a blank line");
    assert_fails("1\n2\n \n3\n", &heights_only, "scan, line 3: a blank line");
}

#[test]
fn the_points_end_at_the_footer_which_has_to_come() {
    let text = "x,z\n0,1\n1,2\n\n  Ra,12.5\nend of file\n";
    let scan = parse_text("a", text.as_bytes(), &simple("stop_at = 'Ra'")).unwrap();
    assert_eq!(scan.heights, [1e-3, 2e-3]);
    let cut =
        "scan: no line after the points starts with `Rq` (stop_at): the file may have been cut";
    assert_fails("x,z\n0,1\n1,2\n", &simple("stop_at = 'Rq'"), cut);
    assert_fails(text, &simple("stop_at = 'Rq'"), "scan, line 5, column 1 (`x`): `Ra` is not");
    assert_fails(
        text,
        &simple("stop_at = ' '"),
        "scan: the key `stop_at` of its description is empty",
    );
    assert_fails("x,z\nRa,1\n", &simple("stop_at = 'Ra'"), "scan: too few points: 0");
}

#[test]
fn the_preamble_is_skipped_by_count_and_by_marker() {
    let text = "data 1,2\nname,\"x\n*DATA*,,\nx,z\n0,1\n1,2\n";
    let scan = parse_text("a", text.as_bytes(), &simple("skip_until = '*DATA*'")).unwrap();
    assert_eq!(scan.heights.len(), 2);
    let counted = parse_text("a", text.as_bytes(), &simple("skip_lines = 3")).unwrap();
    assert_eq!(counted, scan);
    assert_fails(text, &simple("skip_until = 'END'"), "scan: no line starts with the marker `END`");
    assert_fails(text, &simple("skip_lines = 7"), "scan: has 6 lines, fewer than skip_lines = 7");
    assert_fails(text, &simple("skip_lines = 6"), "scan: too few points: 0");
}

/// Positions in mm with one decimal, heights in um with two, and a note in the third column.
fn track(points: usize) -> String {
    let line = |i: usize| format!("{}.{};{:.2};\"fine\"\n", i / 10, i % 10, (i % 7) as f64 + 0.11);
    "x;z;note\n".to_owned() + &(0..points).map(line).collect::<String>()
}

#[test]
fn points_are_not_swallowed_by_a_quotation_mark() {
    let format = TextFormat { separator: Separator::Semicolon, ..simple("") };
    let whole = track(4000);
    assert_eq!(parse_text("a", whole.as_bytes(), &format).unwrap().heights.len(), 4000);
    // Two stray marks 300 lines apart: all between them was one cell, and 3700 points were read.
    let lines: Vec<&str> = whole.lines().collect();
    let mut swallowed: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    swallowed[1000] = swallowed[1000].replace("\"fine\"", "\"fine");
    swallowed[1300] = swallowed[1300].replace("\"fine\"", "fine\"");
    let text = swallowed.join("\n") + "\n";
    assert_fails(
        &text,
        &format,
        "scan, line 1001: a cell opens a quotation mark that its line does",
    );
    // A mark within a cell is a letter: inches.
    let inches = whole.replace("\"fine\"", "5\"");
    assert_eq!(parse_text("a", inches.as_bytes(), &format).unwrap().heights.len(), 4000);
    // Names over several lines are those of a spreadsheet; lines of numbers are no names.
    let names = whole.replacen("x;z;note", "\"x\nmm\";z;\"a\nnote\"", 1);
    assert_eq!(parse_text("a", names.as_bytes(), &format).unwrap().heights.len(), 4000);
    assert_fails(
        whole.replacen("x;z;note", "x;z;\"note", 1),
        &format,
        "scan, line 1: a cell opens",
    );
    assert_fails("\"x;z\n0;1\n1;2\n\"\n2;3\n", &format, "scan, line 1: a cell opens");
}

#[test]
fn a_last_number_that_was_cut_is_no_number() {
    let format = TextFormat { separator: Separator::Semicolon, ..simple("") };
    let whole = track(400).replace(";\"fine\"", "");
    let whole = whole.trim_end();
    // Without its last line end the file is complete.
    assert_eq!(parse_text("a", whole.as_bytes(), &format).unwrap().heights.len(), 400);
    for cut in 1..3 {
        let text = &whole[..whole.len() - cut];
        assert_fails(text, &format, "scan, line 401: the file ends here without a line end");
        // Whoever knows better ends the line.
        let ended = format!("{text}\n");
        assert_eq!(parse_text("a", ended.as_bytes(), &format).unwrap().heights.len(), 400);
    }
    // Cut before the mark there are fewer cells; a cut note leaves the point whole.
    let with_note = track(400);
    let z = with_note.trim_end().rfind(';').unwrap();
    assert_fails(&with_note[..z], &format, "scan, line 401: the file breaks off in the middle");
    let noted = with_note.replace("\"fine\"", "fine");
    let noted = &noted.trim_end()[..noted.trim_end().len() - 2];
    assert_eq!(parse_text("a", noted.as_bytes(), &format).unwrap().heights.len(), 400);
}

#[test]
fn what_is_no_text_is_told_by_its_line() {
    let plain = simple("");
    let long = format!("x,z\n0,1\n1,{}", "1".repeat(5 << 20));
    assert_fails(long, &plain, "scan, line 3: a line of more than 4194304 bytes");
    let many = format!("x,z\n0,1\n1,{}\n", ",".repeat(70_000));
    assert_fails(many, &plain, "scan, line 3: more than 65536 cells; check `separator`");
    assert_fails(b"x,z\n0,1\n1,\xff\n2,3\n", &plain, "scan, line 3: bytes that are not UTF-8");
    let shift_jis = simple("encoding = 'shift_jis'");
    assert_fails(
        b"x,z\n0,1\n1,\x81\n2,3\n",
        &shift_jis,
        "scan, line 3: bytes that are not Shift_JIS",
    );
    // A mark of the encoding beyond what is looked at first, and a letter on the seam of two reads.
    let points: String = (0..100_000).map(|i| format!("{i},2\n")).collect();
    let long = format!("x,\u{e9}\n{points}");
    assert_eq!(parse_text("a", long.as_bytes(), &plain).unwrap().heights.len(), 100_000);
    let wide: Vec<u8> = long.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let wide_format = simple("encoding = 'utf-16le'");
    assert_eq!(parse_text("a", &wide, &wide_format).unwrap().heights.len(), 100_000);
}

#[test]
fn plates_at_the_ends_are_cut() {
    let text: String = (0..=10).map(|i| format!("{i},{i}\n")).collect();
    let cut = |extra: &str| parse_text("a", text.as_bytes(), &simple(extra));
    let scan = cut("header = false\ncut_start_mm = 1.5\ncut_end_mm = 3").unwrap();
    assert_eq!(scan.heights, [2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3]);
    let error = cut("header = false\ncut_start_mm = 6\ncut_end_mm = 6").unwrap_err().to_string();
    assert!(error.contains("10 mm long, cut_start_mm + cut_end_mm is 12 mm"), "{error}");
}

#[test]
fn descriptions_that_cannot_work_say_which_key_to_change() {
    let text = "x,z\n0,1\n1,2\n";
    let base = "separator = 'comma'\n";
    let fails =
        |toml: &str, start: &str| assert_fails(text, &format(&format!("{base}{toml}")), start);
    fails(
        "x_column = 1\nx_unit = 'mm'\nz_column = 2",
        "scan: the key `z_unit` of its description is not set; units are never guessed: choose one of nm, um, mm, m",
    );
    fails("x_column = 1\nz_unit = 'mm'\nz_column = 2", "scan: the key `x_unit`");
    fails("z_unit = 'mm'\nz_column = 2", "scan: the key `x_column`");
    fails(
        "z_unit = 'mm'\nz_column = 2\nx_column = 1\nx_unit = 'mm'\nx_spacing_um = 1",
        "scan: the key `x_spacing_um`",
    );
    fails("z_unit = 'mm'\nz_column = 2\nx_spacing_um = 0", "scan: the key `x_spacing_um`");
    fails("z_unit = 'mm'\nz_column = 0\nx_spacing_um = 1", "scan: the key `z_column`");
    fails(
        "z_unit = 'mm'\nz_column = 'z'\nx_spacing_um = 1\nheader = false",
        "scan: the key `z_column`",
    );
    fails(
        "z_unit = 'mm'\nz_column = 2\nx_spacing_um = 1\ndecimal_mark = ','",
        "scan: the key `separator`",
    );
    fails(
        "z_unit = 'mm'\nz_column = 2\nx_spacing_um = 1\nencoding = 'klingon'",
        "scan: the key `encoding`",
    );
    fails(
        "z_unit = 'mm'\nz_column = 2\nx_spacing_um = 1\ncut_end_mm = nan",
        "scan: the key `cut_end_mm`",
    );
}

#[test]
fn words_among_blanks_do_not_shift_named_columns() {
    let blanks = format(
        "separator = 'whitespace'\nx_column = 'x'\nx_unit = 'mm'\nz_column = 'z'\nz_unit = 'mm'",
    );
    assert_fails(
        "Point No x z\n1 0.5 1\n2 1.5 1\n",
        &blanks,
        "scan, line 2: 3 cells under 4 column names",
    );
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    assert_fails(b"x,z\n0,1\n1,\xFF\n", &simple(""), "scan, line 3: bytes that are not UTF-8");
    assert_fails(b"x,z\n0,\x00\n", &simple(""), "scan: holds binary data");
    assert_fails(b"\x89PNG\r\n\x1a\n\x00\x00", &simple(""), "scan: holds binary data");
    assert_fails(b"x,z\n0,1\n1", &simple("encoding = 'utf-16le'"), "scan");
}

#[test]
fn files_that_cannot_be_opened_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_text(folder.path(), &simple("")).unwrap_err();
    assert!(matches!(error.problem, ScanProblem::Directory));
    let path = folder.path().join("a.csv");
    let error = read_text(&path, &simple("")).unwrap_err();
    assert!(matches!(error.problem, ScanProblem::Io(_)));
    std::fs::write(&path, "x,z\n0,1\n1,b\n").unwrap();
    let message = read_text(&path, &simple("")).unwrap_err().to_string();
    assert!(message.starts_with(&format!("{}, line 3", path.display())), "{message}");
    std::fs::write(&path, "x,z\n0,1\n1,2\n").unwrap();
    assert_eq!(read_text(&path, &simple("")).unwrap().name, "a");
}

proptest::proptest! {
    #[test]
    fn any_bytes_give_a_scan_or_an_error(bytes: Vec<u8>, text in "[0-9,.\n\r\"xzNa-]{0,60}") {
        for format in [simple(""), simple("header = false\ncomment = 'x'\nencoding = 'utf-16be'")] {
            for input in [&bytes[..], text.as_bytes()] {
                if let Ok(scan) = parse_text("a", input, &format) {
                    proptest::prop_assert_eq!(scan.positions.len(), scan.heights.len());
                    proptest::prop_assert!(scan.positions.windows(2).all(|pair| pair[0] < pair[1]));
                }
            }
        }
    }
}

/// The folder of the two road scans, or nothing and a word that the test is skipped.
fn road_scans() -> Option<PathBuf> {
    let folder =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scans/captif"));
    if !folder.exists() {
        println!("skipped: no road scans at {}", folder.display());
    }
    folder.exists().then_some(folder)
}

/// The profilometer of the road scans. Its point counter jumps back, its distance does not; its
/// "depth" grows towards the rubber, as the skewness below shows.
fn captif(cut: &str) -> TextFormat {
    format(&format!(
        "separator = 'tab'\nskip_until = '*****DATA*****'\nx_column = 'Distance (mm)'\n\
         x_unit = 'mm'\nz_column = 'Depth (mm)'\nz_unit = 'mm'\n{cut}"
    ))
}

/// Figures counted independently in the files: lines after the header, and lines with `NaN`.
#[test]
fn real_road_scans_read_by_their_distance() {
    let Some(folder) = road_scans() else { return };
    for (file, points, missing, last_mm) in [
        ("20211011_aylesbury_dec_station_0.dat", 51067, 4373, 1914.413),
        ("20211011_aylesbury_dec_station_1.dat", 51290, 4841, 1922.773),
    ] {
        let scan = read_text(&folder.join(file), &captif("")).unwrap();
        assert_eq!(scan.positions.len(), points);
        assert_eq!(scan.heights.iter().filter(|height| height.is_nan()).count(), missing);
        assert_eq!(scan.positions.last(), Some(&(last_mm / 1e3)));

        let cut =
            read_text(&folder.join(file), &captif("cut_start_mm = 70\ncut_end_mm = 70")).unwrap();
        let span = cut.positions.last().unwrap() - cut.positions[0];
        // The cuts leave the whole steps of 0.0375 mm within the track.
        approx::assert_abs_diff_eq!(span, (last_mm - 140.0) / 1e3, epsilon = 0.0375e-3 * 2.0);
        // The instrument reads 41 mm and more on the plates and nothing of the kind on the road.
        assert!(cut.heights.iter().all(|height| height.is_nan() || height.abs() < 10e-3));
        assert!(scan.heights.iter().any(|&height| height > 40e-3));
    }
}

#[test]
fn real_road_scans_come_out_with_valleys_pointing_down() {
    let Some(folder) = road_scans() else { return };
    let recipe: Conditioning = toml::from_str("window_length_mm = 20").unwrap();
    for station in 0..2 {
        let file = format!("20211011_aylesbury_dec_station_{station}.dat");
        let raw =
            read_text(&folder.join(file), &captif("cut_start_mm = 70\ncut_end_mm = 70")).unwrap();
        let (windows, report) = condition(&raw, &recipe).unwrap();
        // 1.914 m on 51066 steps: the instrument's 0.0375 mm but for its last digit.
        assert!((report.spacing_um - 37.489).abs() < 1e-3, "{}", report.spacing_um);
        assert!(report.largest_deviation_um < 1.0);
        assert_eq!((report.points_absent, report.points_sharing_a_cell), (0, 0));
        assert!(report.spikes < 20, "{}", report.spikes);
        assert!(windows.len() >= 50 && windows.len() < report.windows.len());
        let skews: Vec<f64> = windows.iter().map(|window| skewness(&window.heights)).collect();
        let mean = skews.iter().sum::<f64>() / skews.len() as f64;
        // Valleys between stones are deeper than stones are high: heights grow towards the rubber.
        assert!(mean < -0.2, "{mean}");
        println!(
            "station {station}: missing {:.4}, spikes {}, windows {} of {}, mean skewness {mean:.2}",
            report.points_missing_in_file as f64 / report.points_read as f64,
            report.spikes,
            windows.len(),
            report.windows.len()
        );
    }
}

fn skewness(heights: &[f64]) -> f64 {
    let valid: Vec<f64> = heights.iter().copied().filter(|z| !z.is_nan()).collect();
    let moment = |k: i32| valid.iter().map(|z| z.powi(k)).sum::<f64>() / valid.len() as f64;
    moment(3) / moment(2).powf(1.5)
}
