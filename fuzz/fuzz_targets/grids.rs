#![no_main]
//! Wyko ASCII, OpenCRG as text and binary, profiles as XML, workbooks.

use asperity_fuzz::scans::description::DecimalMark;
use asperity_fuzz::scans::spreadsheet::Book;
use libfuzzer_sys::fuzz_target;

const WYKO: &[u8] = b"Wyko ASCII Data File Format 0\t0\t1\nX Size\t2\nY Size\t2\nPixel_size\t7\t4\t0.002\n\
Wavelength\t7\t4\t600\nRAW_DATA\t3\t16\t\n";
const CRG: &[u8] = b"$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 1\nLONG_SECTION_V_INCREMENT = 1\n$\n$KD_Definition\n\
D:long section 1,m\nD:long section 2,m\n#:";
const XML: &[u8] = b"<DATA><DATAFILE><UNITS>um</UNITS><NUMPOINTS>2</NUMPOINTS><SPACING>1</SPACING><DATA_POINT_VALUES>";

fuzz_target!(|bytes: &[u8]| {
    for signature in [WYKO, CRG, XML, b"Wyko ASCII Data File Format", b"$ROAD_CRG\n", b"<DATA_POINT_VALUES>"] {
        asperity_fuzz::read_with(signature, bytes);
    }
    asperity_fuzz::read(bytes);
    if let Ok(mut book) = Book::open(bytes) {
        let _ = book.text(None, DecimalMark::Point);
    }
});
