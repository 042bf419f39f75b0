//! Height maps whose lines are rows of heights.

use super::*;
use crate::file::Grid;

/// Heights in um separated by semicolons, 2 um apart in a row.
fn matrix(extra: &str) -> TextFormat {
    let base = "matrix = true\nz_unit = 'um'\nx_spacing_um = 2\n";
    let separator = if extra.contains("separator") { "" } else { "separator = ';'\n" };
    format(&format!("{base}{separator}{extra}"))
}

fn read(text: impl AsRef<[u8]>, format: &TextFormat) -> ScanFile {
    match parse_described("map", text.as_ref(), format).unwrap() {
        Described::Map(map) => map,
        Described::Line(scan) => panic!("{scan:?}"),
    }
}

/// Heights in um, rounded to 1e-9, NaN as -1.
fn um(map: &ScanFile) -> Vec<f64> {
    let um = |z: &f64| if z.is_nan() { -1.0 } else { (z * 1e15).round() / 1e9 };
    map.heights.iter().map(um).collect()
}

#[track_caller]
fn fails(text: impl AsRef<[u8]>, format: &TextFormat, start: &str) {
    let error = parse_described("map", text.as_ref(), format).unwrap_err().to_string();
    assert!(error.starts_with(start), "{error}");
}

#[test]
fn a_matrix_is_the_map_of_its_points() {
    let rows = read("1;2;3\n4;5.5;6\n", &matrix("y_spacing_um = 5"));
    assert_eq!(rows.grid, Grid::Map { columns: 3, rows: 2, spacing_x: 2e-6, spacing_y: 5e-6 });
    assert_eq!(rows.heights, [1e-6, 2e-6, 3e-6, 4e-6, 5.5e-6, 6e-6]);
    let points = format(
        "separator = ';'\nheader = false\nx_column = 1\nx_unit = 'um'\ny_column = 2\ny_unit = 'um'\nz_column = 3\nz_unit = 'um'",
    );
    let listed = read("0;0;1\n2;0;2\n4;0;3\n0;5;4\n2;5;5.5\n4;5;6\n", &points);
    assert_eq!((listed.grid, &listed.heights), (rows.grid, &rows.heights));
    // Rows are as far apart as heights where nothing else is said.
    let square = Grid::Map { columns: 3, rows: 2, spacing_x: 2e-6, spacing_y: 2e-6 };
    assert_eq!(read("1;2;3\n4;5;6\n", &matrix("header = false")).grid, square);
    let depths = read("1;2;3\n4;5.5;6\n", &matrix("invert_z = true"));
    assert!(depths.heights.iter().zip(&rows.heights).all(|(depth, z)| *depth == -z));
}

#[test]
fn layouts_of_one_matrix_agree() {
    let same = |text: &[u8], extra: &str| {
        assert_eq!(um(&read(text, &matrix(extra))), [1.5, 2.0, -1.0, 4.0, 5.0, 6.0], "{extra}");
    };
    same(b"1.5;2;\n4;5;6\n", "");
    same(b"1.5;2;NaN\n4;5;6\n\n\n", "");
    same(b"1.5;2;nan\r\n4;5;6", "");
    same(b"1,5\t2\tBAD\n4\t5\t6\n", "separator = 'tab'\ndecimal_mark = ','");
    same(b"  1.5 2\t***\n4 5  6 \n\n", "separator = 'whitespace'\nmissing = ['***']");
    same(b"\"1.5\";2;\"\"\n4;5;\"6\"\n", "");
}

#[test]
fn lines_around_a_matrix_are_passed_over() {
    let same = |text: &[u8], extra: &str| {
        assert_eq!(um(&read(text, &matrix(extra))), [1.0, 2.0, 3.0, 4.0], "{extra}");
    };
    same(b"# um\n1;2\n# and\n3;4\n", "comment = '#'");
    same(
        b"Width;3\n[Data]\n1;2\n3;4\nEnd of data\n9;9\n",
        "skip_until = '[Data]'\nstop_at = 'End'",
    );
    same(b"a;b\n1;2\n3;4\n  \n", "skip_lines = 1");
    same(b"H\xf6he;\n1;2\n3;4\n", "encoding = 'latin1'\nskip_lines = 1");
    // A separator that ends every line is no column, in some lines it is a gap.
    same(b"1;2;\n3;4;\n", "missing = []");
    same(b"1;2;;;\n3;4;;;\n", "");
    assert_eq!(um(&read("1;2;\n3;4;5\n", &matrix(""))), [1.0, 2.0, -1.0, 3.0, 4.0, 5.0]);
    fails("1;2;\n3;4;5\n", &matrix("missing = []"), "map, line 1, column 3: `` is not a number");
    // A row without heights is a row.
    let gap = read("1\t2\n\t\n3\t4\n", &matrix("separator = 'tab'"));
    assert_eq!(um(&gap), [1.0, 2.0, -1.0, -1.0, 3.0, 4.0]);
}

#[test]
fn rows_of_unequal_length_are_told_with_both_numbers() {
    fails(
        "# um\n1;2;3\n4;5\n6;7;8\n",
        &matrix("comment = '#'"),
        "map, line 3: holds 2 numbers, and 3 were expected, as on line 2",
    );
    fails("1;2;\n4;5;6;7\n", &matrix(""), "map, line 2: holds 4 numbers, and 2 were expected");
    fails("1;2;\n4;5\n7;8\n", &matrix(""), "map, line 2: holds 2 numbers, and 3 were expected");
    fails("1;2;3\n4;5\n", &matrix(""), "map, line 2: holds 2 numbers, and 3 were expected");
    fails("1;2;3\n4;5", &matrix(""), "map, line 2: the file breaks off in the middle");
    let whole = "1.25;2.25\n".repeat(40);
    fails(
        &whole[..whole.len() - 2],
        &matrix(""),
        "map, line 40: the file ends here without a line end",
    );
    fails("1;2\n3;4\n\n5;6\n", &matrix(""), "map, line 4: a blank line between rows");
    fails("1;2\n3;4\n  \n5;6\n", &matrix(""), "map, line 4: a blank line between rows");
}

#[test]
fn cells_that_are_no_heights_are_told_with_their_place() {
    fails("1;2\n3;x\n", &matrix(""), "map, line 2, column 2: `x` is not a number and not listed");
    fails(
        "a;b\n3;4\n",
        &matrix(""),
        "map, line 1, column 1: `a` is not a number; set `skip_lines`",
    );
    let blanks = matrix("separator = 'whitespace'");
    fails("0,5 1,5\n1 2\n", &blanks, "map, line 1, column 1: `0,5` has the wrong decimal mark");
    let thousands = "1;2,345,678.5\n3;4\n";
    fails(thousands, &matrix(""), "map, line 1, column 2: `2,345,678.5` separates thousands");
}

#[test]
fn a_matrix_that_is_no_map_says_why() {
    fails(
        "1;2;3\n",
        &matrix(""),
        "map: holds 1 rows of 3 numbers, and a map has 2 of each or more",
    );
    fails("1 2\n3 4\n", &matrix(""), "map, line 1, column 1: `1 2` is not a number");
    fails("1\n3\n", &matrix(""), "map: holds 2 rows of 1 numbers");
    fails("# um\n", &matrix("comment = '#'"), "map: holds 0 rows");
    fails("", &matrix(""), "map: the file is empty");
    fails("BAD;BAD\nBAD;BAD\n", &matrix(""), "map: all 4 heights are missing");
    let absurd = "1;2\n3;-9999999\n";
    fails(absurd, &matrix(""), "map: heights from -9.999999 m to 0.000003 m are not");
    assert_eq!(um(&read(absurd, &matrix("missing = ['-9999999']"))), [1.0, 2.0, 3.0, -1.0]);
    fails("1;2\n3;4\n", &matrix("y_spacing_um = 1e6"), "map: points 1000 mm apart are not a scan");
    let wide = TextFormat { x_spacing_um: Some(1e-4), ..matrix("y_spacing_um = 1") };
    fails("1;2\n3;4\n", &wide, "map: points 1.000e-7 mm apart are not a scan");
    let error = parse_text("map", b"1;2\n3;4\n", &matrix("")).unwrap_err().to_string();
    assert!(error.contains("`matrix` of its description describes a height map"), "{error}");
    let many = "1;".repeat(70_000) + "1\n";
    fails(many, &matrix(""), "map, line 1: more than 65536 cells");
}

#[test]
fn keys_that_do_not_go_with_a_matrix_name_both() {
    let refused = |extra: &str, key: &str| {
        let error = matrix(extra).validate().unwrap_err().to_string();
        assert!(error.starts_with(&format!("the key `{key}` of its description")), "{error}");
        assert!(error.contains("matrix = true"), "{error}");
    };
    for (key, value) in [
        ("x_column", "1"),
        ("x_unit", "'mm'"),
        ("y_column", "'y'"),
        ("y_unit", "'mm'"),
        ("z_column", "1"),
        ("header", "true"),
        ("cut_start_mm", "1.0"),
        ("cut_end_mm", "1.0"),
    ] {
        refused(&format!("{key} = {value}"), key);
    }
    let rows = "separator = ';'\nz_unit = 'um'\n";
    let unspaced = format(&format!("{rows}matrix = true")).validate().unwrap_err().to_string();
    assert!(unspaced.contains("`x_spacing_um` of its description is not set"), "{unspaced}");
    for spacing in ["0", "-1", "inf", "nan"] {
        let error = matrix(&format!("y_spacing_um = {spacing}")).validate().unwrap_err();
        assert!(error.to_string().contains("`y_spacing_um` of its description is"), "{error}");
    }
    let line = format(&format!("{rows}x_spacing_um = 1\ny_spacing_um = 1\nz_column = 1"));
    let error = line.validate().unwrap_err().to_string();
    assert!(error.contains("`y_spacing_um`") && error.contains("matrix = true"), "{error}");
    let unit = TextFormat { z_unit: None, ..matrix("") }.validate().unwrap_err().to_string();
    assert!(unit.contains("`z_unit` of its description is not set"), "{unit}");
}

#[test]
fn columns_are_required_of_all_other_texts() {
    let rows = "separator = ';'\nz_unit = 'um'\nx_spacing_um = 1\n";
    for extra in ["", "matrix = false"] {
        let error = toml::from_str::<TextFormat>(&format!("{rows}{extra}")).unwrap_err();
        assert!(error.to_string().contains("missing field `z_column`"), "{error}");
    }
    // What is written is what was read, without a word of what is not set.
    let written = toml::to_string(&matrix("")).unwrap();
    assert!(!written.contains("header") && !written.contains("z_column"), "{written}");
    assert_eq!(format(&written), matrix(""));
    assert!(!toml::to_string(&simple("")).unwrap().contains("matrix"));
    let unset = TextFormat { z_column: None, ..simple("") }.validate().unwrap_err().to_string();
    assert!(unset.contains("`z_column` of its description is not set"), "{unset}");
}

proptest::proptest! {
    #[test]
    fn any_bytes_give_a_map_or_an_error(bytes: Vec<u8>, text in "[0-9;\t .\n\r\"Na-]{0,60}") {
        for extra in ["", "missing = []", "separator = 'whitespace'", "separator = 'tab'"] {
            for input in [&bytes[..], text.as_bytes()] {
                if let Ok(Described::Map(map)) = parse_described("a", input, &matrix(extra)) {
                    let Grid::Map { columns, rows, .. } = map.grid else { panic!("{:?}", map.grid) };
                    proptest::prop_assert!(columns > 1 && rows > 1);
                    proptest::prop_assert_eq!(map.heights.len(), columns * rows);
                }
            }
        }
    }
}
