//! Files that state their units: Wyko ASCII, OpenCRG, XML, and those that are named.
use super::*;

fn near(scan: &ScanFile, mean: f64, rms: f64, digits: f64) {
    assert_relative_eq!(scan.mean(), mean, max_relative = digits);
    assert_relative_eq!(scan.standard_deviation(), rms, max_relative = digits);
}

#[test]
fn a_wyko_map_is_read_in_wavelengths() {
    let Some(bytes) = case("04_wyko_ascii/map.asc") else { return };
    let scan = native(&bytes);
    assert_eq!(scan.missing(), 3);
    near(&scan, -1.77152e-9, 158.755e-9, 1e-5);
    let Grid::Map { columns, rows, spacing_x, spacing_y } = scan.grid else { panic!() };
    assert_eq!((columns, rows), (40, 30));
    assert_relative_eq!(spacing_x, 1.9e-6, max_relative = 1e-12);
    assert_relative_eq!(spacing_y, 1.9e-6, max_relative = 1e-12);
}

const WYKO: &str = "Wyko ASCII Data File Format 0\t0\t1\nX Size\t3\nY Size\t2\n\
    Block Name\tType\tLength\tValue\nPixel_size\t7\t4\t0.002\nWavelength\t7\t4\t600.0\nMult\t7\t4\t2\n\
    Aspect\t7\t4\t1.5\nTitle\t5\t20\ta plate\nIntensity\t3\t24\t\n7\t8\n9\t9\n9\t9\nRAW_DATA\t3\t24\t\n\
    1\t-2\n3\tBad\n5\t6\n";

#[test]
fn lines_of_a_wyko_file_run_along_y() {
    let scan = native(WYKO.as_bytes());
    assert_eq!(scan.grid, Grid::Map { columns: 3, rows: 2, spacing_x: 2e-6, spacing_y: 3e-6 });
    let expected = [300e-9, 900e-9, 1500e-9, -600e-9, f64::NAN, 1800e-9];
    for (found, expected) in scan.heights.iter().zip(expected) {
        assert!(
            (found - expected).abs() < 1e-20 || found.is_nan() == expected.is_nan(),
            "{scan:?}"
        );
    }
    assert_eq!(scan.instrument, [("title".to_owned(), "a plate".to_owned())]);
    let in_nm = WYKO.replacen("0\t0\t1", "0\t1\t1", 1);
    assert_relative_eq!(native(in_nm.as_bytes()).heights[1], 3e-9);
    let crlf = WYKO.replace('\n', "\r\n").replace("0.002", "0,002");
    assert_eq!(native(crlf.as_bytes()).heights[0], scan.heights[0]);
    for (from, to, words) in [
        ("0\t0\t1", "3\t0\t1", "line 1: the flags"),
        ("Y Size\t2", "Y Size\t3", "line 15: the number of heights"),
        ("X Size\t3", "X Size\t9", "the number of lines"),
        ("X Size\t3\n", "", "X Size"),
        ("Wavelength\t7\t4\t600.0\n", "", "Wavelength"),
        ("RAW_DATA", "Other", "RAW_DATA"),
        ("X Size\t3", "X Size\t99999999999", "the number of lines"),
        ("-2", "1e999", "`1e999`"),
    ] {
        let error = refused(WYKO.replacen(from, to, 1).as_bytes());
        assert!(error.contains(words), "{from:?}: {error}");
    }
}

#[test]
fn an_opencrg_grid_is_read() {
    let Some(bytes) = case("05_opencrg_text/road.crg") else { return };
    let scan = native(&bytes);
    assert_eq!(scan.missing(), 2);
    near(&scan, 1.21109e-3, 13.89591e-3, 1e-5);
    let grid = Grid::Map { columns: 7, rows: 30, spacing_x: 0.05, spacing_y: 0.05 };
    assert_eq!(scan.grid, grid);
}

/// A grid with a channel before the long sections, as text or binary.
fn crg(code: &str, sections: usize, data: &[u8]) -> Vec<u8> {
    let mut text = format!(
        "$CT\na road\n$\n$ROAD_CRG   ! section\nreference_line_increment = 0.5 ! m\n\
         LONG_SECTION_V_RIGHT = -0.75\nLONG_SECTION_V_LEFT = 0.75\n$\n$KD_Definition\n#:{code}\n\
         D:reference line phi,rad\n"
    );
    for section in 0..sections {
        text += &format!("D:long section {},mm\n", section + 1);
    }
    [text.as_bytes(), b"$\n* a comment\n$$!***\n", data].concat()
}

#[test]
fn wrapped_double_and_binary_rows_of_opencrg_are_the_same_grid() {
    let heights: Vec<f64> = (0..40).map(|i| f64::from(i * 7 % 13) - 6.0).collect();
    let rows: Vec<Vec<f64>> = heights.chunks(10).map(|row| [&[0.25], row].concat()).collect();
    let text = |width: usize| -> Vec<u8> {
        let line = |fields: &[f64]| -> String {
            fields.iter().map(|z| format!("{z:>width$.5}")).collect::<String>() + "\r\n"
        };
        let lines = rows.iter().flat_map(|row| row.chunks(80 / width).map(line));
        lines.collect::<String>().into_bytes()
    };
    let binary = |bytes: usize| -> Vec<u8> {
        let mut numbers: Vec<f64> = rows.concat();
        while !(numbers.len() * bytes).is_multiple_of(80) {
            numbers.push(f64::NAN);
        }
        let each = |z: &f64| match bytes {
            4 => (*z as f32).to_be_bytes().to_vec(),
            _ => z.to_be_bytes().to_vec(),
        };
        numbers.iter().flat_map(each).collect()
    };
    for (code, data) in
        [("LRFI", text(10)), ("LDFI", text(20)), ("KRBI", binary(4)), ("KDBI", binary(8))]
    {
        let scan = native(&crg(code, 10, &data));
        let Grid::Map { columns, rows, spacing_x, spacing_y } = scan.grid else { panic!() };
        assert_eq!((columns, rows, spacing_y), (10, 4, 0.5), "{code}");
        assert_relative_eq!(spacing_x, 1.5 / 9.0, max_relative = 1e-12);
        let found: Vec<f64> = scan.heights.iter().map(|z| (z * 1e3).round()).collect();
        assert_eq!(found, heights, "{code}");
        assert_eq!(scan.instrument, [("comment".to_owned(), "a road".to_owned())]);
    }
    let one = native(&crg("LRFI", 1, b" 0.0000000 1.0000000\n 0.0000000-2.0000000\n"));
    assert_eq!((one.grid, one.heights[1]), (Grid::Profile { spacing: 0.5 }, -2e-3));
    let cut = text(10);
    let error = refused(&crg("LRFI", 10, &cut[..cut.len() - 40]));
    assert!(error.contains("copy the file again"), "{error}");
    let error = refused(&crg("LRFX", 10, &cut));
    assert!(error.contains("line 10: the format of the numbers is `LRFX`"), "{error}");
    assert!(refused(&crg("LRFI", 0, b" 0.0\n")).contains("long section"));
    assert!(refused(b"$ROAD_CRG\n").contains("not ended"));
}

#[test]
fn an_xml_profile_of_the_data_base_is_read_with_its_first_and_last_height() {
    let Some(bytes) = case("08_xml_reference_profile/profile.xml") else { return };
    let scan = native(&bytes);
    assert_eq!((scan.heights.len(), scan.missing()), (120, 0));
    assert_eq!(scan.grid, Grid::Profile { spacing: 0.25 * 1e-6 });
    near(&scan, 0.12e-6, 0.415451e-6, 1e-5);
}

#[test]
fn xml_profiles_are_checked_and_other_xml_is_named() {
    let xml = "<?xml version='1.0'?>\n<!DOCTYPE DATA SYSTEM \"data.dtd\">\n<DATA><PART>\
        <PART_NAME>sine</PART_NAME></PART><DATAFILE>\n<UNITS>um</UNITS><NUMPOINTS>3</NUMPOINTS>\
        <SPACING>0.5</SPACING><DATA_TYPE>2D</DATA_TYPE><DATA_POINT_VALUES>1.5\n-2\n1.0E-1\
        </DATA_POINT_VALUES></DATAFILE></DATA>";
    let scan = native(xml.as_bytes());
    assert_eq!(scan.heights, [1.5 * 1e-6, -2.0 * 1e-6, 0.1 * 1e-6]);
    assert_eq!(scan.instrument, [("title".to_owned(), "sine".to_owned())]);
    for (from, to, words) in [
        (">3<", ">4<", "expected 4 as NUMPOINTS says"),
        ("um", "V", "UNITS"),
        ("-2", "two", "height 2"),
        ("2D", "3D", "profiles (2D) are read"),
        ("0.5", "", "SPACING"),
        ("<DATA_TYPE>", "<DATA", "copy the file again"),
    ] {
        let error = refused(xml.replacen(from, to, 1).as_bytes());
        assert!(error.contains(words), "{from}: {error}");
    }
    let other = refused(b"<?xml version=\"1.0\"?><scan><z>1</z></scan>");
    assert!(other.contains("an XML document of a kind that is not known"), "{other}");
}

fn archive(members: &[&str]) -> Vec<u8> {
    use std::io::{Cursor, Write};
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for name in members {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(b"x").unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn files_that_are_not_read_are_named_with_the_way_out() {
    let word = archive(&["[Content_Types].xml", "word/document.xml"]);
    let plux = archive(&["index.xml", "LAYER_0.raw"]);
    let files = archive(&["a.x3p", "b.x3p"]);
    let other = archive(&["something.bin"]);
    let entry = |name: &str| -> Vec<u8> {
        let name = name.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        [b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".as_slice(), &[0; 600], &name].concat()
    };
    let (mountains, excel) = (entry("ScopedContents"), entry("Workbook"));
    for (bytes, what, way) in [
        (word.as_slice(), "Word document", "plain text"),
        (&plux, "Sensofar PLUX", "SDF"),
        (&files, "zip archive of files", "unpack"),
        (&other, "no main.xml", "export"),
        (&mountains, ".mnt", ".sur"),
        (&excel, ".xls", ".xlsx"),
        (b"\x01\x00Directory\0", "Wyko OPD", "Wyko ASCII"),
        (b"%PDF-1.4", "PDF", "export"),
        (b"VK4_\0\0", "Keyence", "CSV"),
        (b"<!DOCTYPE html><html></html>", "web page", "download"),
    ] {
        let error = refused(bytes);
        assert!(error.contains(what) && error.contains(way), "{error}");
    }
}
