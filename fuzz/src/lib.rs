//! The readers of scans, compiled from the sources of the project without the rest of it: a
//! fuzzer instruments all that it links, and solvers and tables would take minutes for nothing.

#[path = "../../src/surface/scan.rs"]
mod scan;
#[path = "../../src/scans/mod.rs"]
pub mod scans;

/// What the readers use of `asperity::surface`.
pub mod surface {
    pub use super::scan::{LineScan, RawScan};
}

/// Reads a file that begins with `signature`. Whatever it is, the answer is a scan or an error.
pub fn read_with(signature: &[u8], bytes: &[u8]) {
    read(&[signature, bytes].concat());
}

/// Reads the bytes of a file and uses what they hold.
pub fn read(bytes: &[u8]) {
    match scans::file::parse_file("fuzz", bytes) {
        Ok(Some(scan)) => {
            assert!(scan.mean().is_finite() && scan.missing() < scan.heights.len());
            let lines = scan.line_scans("fuzz", scans::file::MapLines::Columns, 1000);
            assert!(lines.iter().all(|line| line.positions.len() == line.heights.len()));
        }
        Ok(None) => {}
        Err(error) => assert!(error.to_string().starts_with("fuzz: ")),
    }
}
