//! Maps as text of one point per line.
use super::*;

const COLUMNS: usize = 40;
const ROWS: usize = 24;

/// Heights in um: waves along x and y, and one mean.
fn height(column: usize, row: usize) -> f64 {
    4.0 * (0.5 * column as f64).sin() + 1.5 * (0.9 * row as f64).cos() + 2.0
}

/// The map by rows, or by columns, with what is not `kept` left out.
fn text(by_rows: bool, jitter: f64, kept: impl Fn(usize) -> bool) -> String {
    let point = |i: usize| match by_rows {
        true => (i % COLUMNS, i / COLUMNS),
        false => (i / ROWS, i % ROWS),
    };
    let row = |i: usize| {
        let (column, row) = point(i);
        let shift = |k: usize| jitter * (((i * 7919 + k) % 101) as f64 / 101.0 - 0.5);
        let (x, y) = (0.01 * (column as f64 + shift(0)), 0.025 * (row as f64 + shift(31)));
        format!("{x:.5};{y:.5};{:.6}\n", height(column, row))
    };
    let rows = (0..COLUMNS * ROWS).filter(|i| kept(*i)).map(row);
    String::from("X [mm];Y [mm];Z [um]\n") + &rows.collect::<String>()
}

fn check(found: &ScanFile, missing: usize) {
    let Grid::Map { columns, rows, spacing_x, spacing_y } = found.grid else { panic!() };
    assert_eq!((columns, rows, found.missing()), (COLUMNS, ROWS, missing));
    assert_relative_eq!(spacing_x, 10e-6, max_relative = 1e-3);
    assert_relative_eq!(spacing_y, 25e-6, max_relative = 1e-3);
    for (place, found) in found.heights.iter().enumerate().filter(|(_, z)| !z.is_nan()) {
        let expected = height(place % COLUMNS, place / COLUMNS) * 1e-6;
        assert!((found - expected).abs() < 1e-12, "{place}: {found} {expected}");
    }
}

#[test]
fn maps_are_read_by_rows_and_by_columns_with_gaps_and_jitter() {
    for by_rows in [true, false] {
        for jitter in [0.0, 0.15] {
            check(&map(text(by_rows, jitter, |_| true).as_bytes()), 0);
            check(
                &map(text(by_rows, jitter, |i| i % 11 != 4).as_bytes()),
                COLUMNS * ROWS / 11 + 1 - 1 + usize::from(COLUMNS * ROWS % 11 > 4),
            );
        }
    }
    let marked = text(true, 0.0, |_| true).replace(";5.500000\n", ";NaN\n");
    let gaps = marked.matches("NaN").count();
    check(&map(marked.as_bytes()), gaps);
}

#[test]
fn a_map_described_as_a_line_is_refused_in_words() {
    let format = "separator = ';'\nx_column = 1\nx_unit = 'mm'\nz_column = 3\nz_unit = 'um'";
    let format: TextFormat = toml::from_str(format).unwrap();
    for (by_rows, words) in [(false, "height map"), (true, "y_column")] {
        let error = parse_text("a", text(by_rows, 0.0, |_| true).as_bytes(), &format).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    // A stop now and then is none.
    let mut row = (0..100).map(|i| format!("{};0;{}\n", i / 2 * usize::from(i < 4) + i, i % 7));
    let stops = String::from("x;y;z\n") + &row.by_ref().collect::<String>();
    assert!(parse_text("a", stops.as_bytes(), &format).is_ok());
}

#[test]
fn what_is_no_grid_is_said() {
    let format = "separator = ';'\nheader = false\nx_column = 1\nx_unit = 'mm'\ny_column = 2\ny_unit = 'mm'\n\
                  z_column = 3\nz_unit = 'um'";
    let format: TextFormat = toml::from_str(format).unwrap();
    let error =
        |text: &str| parse_described("a", text.as_bytes(), &format).unwrap_err().to_string();
    let grid = |twice: &str| {
        let row = |i: usize| format!("{};{};1\n", i % 5, i / 5);
        (0..25).map(row).collect::<String>() + twice
    };
    assert!(error(&grid("4;4;2\n")).contains("two points are at x = 4, y = 4"));
    assert!(error(&grid("5.5;4;2\n")).contains("off the grid"), "{}", error(&grid("5.5;4;2\n")));
    assert!(error(&grid("900;4;2\n")).contains("most of which is empty"));
    let diagonal: String = (0..6).map(|i| format!("{i};{i};1\n")).collect();
    assert!(error(&diagonal).contains("sort the file"));
    let few = error("0;0;1\n1;0;2\n0;1;1\n1;1;1\n");
    assert!(few.contains("2 lines of 3 points, 6 in all, and these are 4"), "{few}");
    assert!(error(&grid("").replace(";1\n", ";NaN\n")).contains("missing"));
}
