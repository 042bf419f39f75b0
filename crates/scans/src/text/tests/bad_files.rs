//! Files that cannot be read, and what their messages say.

use super::*;

/// Tabs, columns by name.
fn tabs() -> TextFormat {
    format("separator = 'tab'\nx_column = 'x'\nx_unit = 'mm'\nz_column = 'z'\nz_unit = 'mm'")
}

/// Semicolons, columns by number, no marks of missing heights.
fn semicolons() -> TextFormat {
    format(
        "separator = ';'\nx_column = 1\nx_unit = 'mm'\nz_column = 2\nz_unit = 'mm'\nmissing = []",
    )
}

#[test]
fn files_without_points_or_cut_off_are_refused() {
    let plain = simple("");
    assert_fails("", &plain, "scan: the file is empty");
    assert_fails("\r\n \n", &plain, "scan: the file is empty");
    assert_fails("x,z\n", &plain, "scan: too few points: 0 where at least 2 are needed");
    assert_fails("x,z\n0,1\n", &plain, "scan: too few points: 1");
    assert_fails("x,z\n0,NaN\n1,\n", &plain, "scan: all 2 heights are missing");
    assert_fails("x,z\n0,1\n1\n2,3\n", &plain, "scan, line 3: ends after 1 cells, 2 are needed");
    assert_fails("x,z\n0,1\n1,2\n2", &plain, "scan, line 4: the file breaks off in the middle");
}

#[test]
fn cells_that_are_no_numbers_are_named_with_their_place() {
    let plain = simple("");
    assert_fails(
        "x,z\n0,1\n1,a b\n",
        &plain,
        "scan, line 3, column 2 (`z`): `a b` is not a number and not listed in `missing`",
    );
    assert_fails(
        "x,z\r\n0,1\r\n\r\nNaN,2\r\n",
        &plain,
        "scan, line 4, column 1 (`x`): `NaN` is not a number; every point needs a position",
    );
    assert_fails(
        "mm,mm\n0,1\n",
        &simple("header = false"),
        "scan, line 1, column 1: `mm` is not a number; set `header`",
    );
    assert_fails(
        "x,z\n0,1\n1,1e999\n",
        &plain,
        "scan, line 3, column 2 (`z`): `1e999` is infinite",
    );
    assert_fails("x,z\n0,1\n1,inf\n", &plain, "scan, line 3, column 2 (`z`): `inf` is infinite");
}

#[test]
fn columns_that_a_header_does_not_have_are_named() {
    assert_fails(
        "x\ty\n0\t1\n",
        &tabs(),
        "scan, line 1: there is no column `z`; the columns are `x`, `y`",
    );
    assert_fails(
        "x,z\n0,1\n",
        &tabs(),
        "scan, line 1: there is no column `x`; the columns are `x,z`",
    );
    assert_fails("x\tz\tz\n0\t1\n", &tabs(), "scan, line 1: 2 columns are named `z`");
    assert_fails(
        "0,1\n1,2\n2,3\n",
        &simple(""),
        "scan, line 1: holds numbers where the column names should be",
    );
    // A decimal comma in a file of commas shows in the number of cells.
    assert_fails("x,z\n0,0,1,5\n", &simple(""), "scan, line 2: 4 cells under 2 column names");
}

#[test]
fn a_wrong_decimal_mark_and_separated_thousands_are_told() {
    assert_fails(
        "x\tz\n0\t1\n1\t1,5\n",
        &tabs(),
        "scan, line 3, column 2 (`z`): `1,5` has the wrong decimal mark; set `decimal_mark = \",\"`",
    );
    assert_fails(
        "x;z\n0;1\n1;1,234.5\n",
        &semicolons(),
        "scan, line 3, column 2 (`z`): `1,234.5` separates thousands by `,`",
    );
    let german = TextFormat { decimal_mark: DecimalMark::Comma, ..semicolons() };
    assert_fails(
        "x;z\n0,5;1\n1,5;12.345\n",
        &german,
        "scan, line 3, column 2 (`z`): `12.345` has the wrong decimal mark; set `decimal_mark = \".\"`; \
         if it separates thousands, export the file without",
    );
}

#[test]
fn positions_that_are_no_track_are_refused() {
    let plain = simple("");
    assert_fails(
        "x,z\n0,1\n1,2\n0.5,2\n",
        &plain,
        "scan, line 4, column 1 (`x`): the position 0.5 comes after 1",
    );
    // Repeated positions are left to conditioning, but one position alone is no track.
    let repeated = parse_text("a", b"x,z\n0,1\n1,2\n1.0,4\n2,4\n", &plain).unwrap();
    assert_eq!(repeated.positions, [0.0, 1e-3, 1e-3, 2e-3]);
    assert_fails("x,z\n1,1\n1,2\n", &plain, "scan: all 2 points have the same position; choose");
    // Each three times: the median step is 0.
    let thrice = "x,z\n0,1\n0,1\n0,1\n1,2\n1,2\n1,2\n";
    assert_eq!(parse_text("a", thrice.as_bytes(), &plain).unwrap().heights.len(), 6);
    assert_fails("x,z\n0,1\n1000,2\n", &plain, "scan: points 1000 mm apart");
}

#[test]
fn heights_that_no_road_has_are_refused() {
    let plain = simple("");
    let huge = format!("x,z\n0,-1{0}\n1,1{0}\n", "0".repeat(300));
    assert_fails(
        huge,
        &plain,
        "scan: heights from -1.000e297 m to 1.000e297 m are not those of a road",
    );
    assert_fails(
        "x,z\n0,1\n1,-25400\n",
        &plain,
        "scan: heights from -25.4 m to 0.001 m are not those of a road",
    );
}
