//! The text an instrument would have written.

use crate::surface::scan::RawScan;
use std::io::{self, Write};

/// Write a scan as semicolon-separated text after a preamble of `#` lines.
///
/// Columns `x_mm` (four decimals, 0.1 µm) and `z_um` (one decimal, 0.1 µm); a missing point is `BAD`.
///
/// # Errors
/// Those of the writer.
pub fn write_text(scan: &RawScan, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# instrument: synthetic line profilometer")?;
    writeln!(out, "# scan: {}", scan.name)?;
    writeln!(out, "# units: x in mm, z in um, missing points BAD")?;
    writeln!(out, "x_mm;z_um")?;
    for (x, z) in scan.positions.iter().zip(&scan.heights) {
        if z.is_nan() {
            writeln!(out, "{:.4};BAD", x * 1e3)?;
        } else {
            writeln!(out, "{:.4};{:.1}", x * 1e3, z * 1e6)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_read_as_an_instrument_writes_them() {
        let scan = RawScan {
            name: "scan_07".into(),
            positions: vec![0.0, 2e-6, 4e-6],
            heights: vec![1.234e-4, f64::NAN, -5.6e-6],
        };
        let mut text = Vec::new();
        write_text(&scan, &mut text).unwrap();
        let expected = "# instrument: synthetic line profilometer\n# scan: scan_07\n\
            # units: x in mm, z in um, missing points BAD\nx_mm;z_um\n\
            0.0000;123.4\n0.0020;BAD\n0.0040;-5.6\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
