//! Sheets of workbooks.
use super::*;
use rust_xlsxwriter::{ExcelDateTime, Format, Workbook};

#[test]
fn a_workbook_is_read_like_text() {
    let Some(bytes) = case("09_spreadsheet/scan.xlsx") else { return };
    let scan = line(&bytes);
    let (mean, rms) = mean_and_rms(&scan.heights);
    assert_eq!(scan.heights.len(), 40);
    assert_relative_eq!(spacing(&scan), 5e-6, max_relative = 1e-9);
    assert_relative_eq!(mean, 0.012135e-6, max_relative = 1e-4);
    assert_relative_eq!(rms, 0.689782e-6, max_relative = 1e-5);
}

/// A sheet of results, and one of the scan below a heading; `None` leaves a cell empty.
fn workbook(cell: impl Fn(usize) -> Option<f64>) -> Vec<u8> {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet().set_name("Results").unwrap();
    sheet.write(0, 0, "Ra").unwrap().write(0, 1, 1.25).unwrap();
    let sheet = book.add_worksheet().set_name("Scan \u{b5}").unwrap();
    sheet.write(1, 1, "a heading").unwrap();
    sheet.write(3, 1, "Weg (mm)").unwrap().write(3, 2, "H\u{f6}he (\u{b5}m)").unwrap();
    for i in 0..50_u32 {
        sheet.write(4 + i, 1, f64::from(i) * 0.005).unwrap();
        if let Some(height) = cell(i as usize) {
            sheet.write(4 + i, 2, height).unwrap();
        }
    }
    book.save_to_buffer().unwrap()
}

#[test]
fn the_sheet_of_the_scan_is_found_with_its_names_and_gaps() {
    let height = |i: usize| (i % 10 != 3).then(|| (i as f64 * 0.7).sin() / 3.0);
    let bytes = workbook(height);
    let found = shape(&bytes);
    assert_eq!((found.sheet.as_deref(), found.rows), (Some("Scan \u{b5}"), 50));
    let scan = line(&bytes);
    for (i, found) in scan.heights.iter().enumerate() {
        match height(i) {
            Some(height) => assert_eq!(*found, height / 1e6),
            None => assert!(found.is_nan()),
        }
    }
    let format = found.format().unwrap();
    let with = |sheet: Column| TextFormat { sheet: Some(sheet), ..format.clone() };
    assert!(parse_text("a", &bytes, &with(Column::Number(2))).is_ok());
    let error = parse_text("a", &bytes, &with(Column::Name("Data".into()))).unwrap_err();
    assert!(error.to_string().contains("`Results`, `Scan \u{b5}`"), "{error}");
    let error = parse_text("a", b"x,z\n0,1\n1,2\n", &with(Column::Number(1))).unwrap_err();
    assert!(error.to_string().contains("not a workbook"), "{error}");
    // Rows in messages are those of the sheet.
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    for i in 0..9 {
        sheet.write(i + 5, 0, i).unwrap();
    }
    sheet.write(11, 0, "oops").unwrap();
    let format = TextFormat {
        sheet: None,
        header: Some(false),
        x_column: None,
        x_unit: None,
        x_spacing_um: Some(1.0),
        z_column: Some(Column::Number(1)),
        separator: Separator::Comma,
        skip_until: None,
        skip_lines: 0,
        ..format
    };
    let error = parse_text("a", &book.save_to_buffer().unwrap(), &format).unwrap_err();
    assert_eq!(error.line, Some(12), "{error}");
}

#[test]
fn numbers_as_text_with_commas_are_read_and_dates_are_no_numbers() {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    sheet.write(0, 0, "x_mm").unwrap().write(0, 1, "z_um").unwrap();
    for i in 0..20 {
        sheet.write(i + 1, 0, f64::from(i) / 8.0).unwrap();
        sheet.write(i + 1, 1, format!("{},5", i % 4)).unwrap();
    }
    let bytes = book.save_to_buffer().unwrap();
    assert_eq!(shape(&bytes).decimal_mark, DecimalMark::Comma);
    let scan = line(&bytes);
    assert_eq!((scan.positions[1], scan.heights[1]), (0.125 / 1e3, 1.5 / 1e6));

    let day = ExcelDateTime::from_ymd(2026, 5, 1).unwrap();
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    sheet.write(0, 0, "x_mm").unwrap().write(0, 1, "z_um").unwrap();
    for i in 0..20 {
        sheet.write(i + 1, 0, f64::from(i) / 8.0).unwrap();
        sheet.write(i + 1, 1, 1.0 + f64::from(i % 3)).unwrap();
    }
    let as_date = Format::new().set_num_format("d mmm");
    sheet.write_datetime_with_format(9, 1, &day, &as_date).unwrap();
    let format =
        "separator = 'tab'\nx_column = 'x_mm'\nx_unit = 'mm'\nz_column = 'z_um'\nz_unit = 'um'";
    let format: TextFormat = toml::from_str(format).unwrap();
    let error = parse_text("a", &book.save_to_buffer().unwrap(), &format).unwrap_err();
    assert!(error.line == Some(10) && error.to_string().contains("`date "), "{error}");
}

/// A workbook whose first sheet is the given XML.
fn raw(sheet: &str) -> Vec<u8> {
    use std::io::{Cursor, Read, Write};
    let mut book = Workbook::new();
    book.add_worksheet().write(0, 0, 1).unwrap();
    let bytes = book.save_to_buffer().unwrap();
    let mut from = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut to = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..from.len() {
        let mut member = from.by_index(index).unwrap();
        let name = member.name().unwrap().into_owned();
        let mut bytes = Vec::new();
        member.read_to_end(&mut bytes).unwrap();
        if name.contains("worksheets/sheet1.xml") {
            bytes = sheet.as_bytes().to_vec();
        }
        to.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        to.write_all(&bytes).unwrap();
    }
    to.finish().unwrap().into_inner()
}

#[test]
fn small_workbooks_that_want_much_memory_are_refused() {
    let format: TextFormat = toml::from_str(
        "separator = 'tab'\nheader = false\nx_spacing_um = 1.0\nz_column = 1\nz_unit = 'um'",
    )
    .unwrap();
    let error = |rows: &str| {
        let sheet = format!(
            "<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData>{rows}\
             </sheetData></worksheet>"
        );
        parse_text("a", &raw(&sheet), &format)
            .map(|scan| scan.heights.len())
            .unwrap_err()
            .to_string()
    };
    let far =
        "<row r=\"1\"><c r=\"A1\"><v>1</v></c></row><row r=\"2\"><c r=\"XFD2\"><v>1</v></c></row>";
    assert!(error(far).contains("columns"), "{}", error(far));
    let zeros = format!("<row r=\"1\"><c r=\"A1\"><v>{}</v></c></row>", "0".repeat(1 << 20));
    assert!(error(&zeros).contains("32767"), "{}", error(&zeros));
    let many = "<row/>".repeat(1 << 20);
    assert!(error(&many).contains("unpacks to more"), "{}", error(&many));
    let back =
        "<row r=\"9\"><c r=\"A9\"><v>1</v></c></row><row r=\"2\"><c r=\"A2\"><v>1</v></c></row>";
    assert!(error(back).contains("occurs twice"), "{}", error(back));
    assert!(error("<!-- a --><row r=\"1\"/>").contains("comment"));
}
