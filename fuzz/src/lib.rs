//! What the fuzz targets share: bytes read as a scan, within the memory that the readers promise.

pub use asperity_scans as scans;

/// Counts what is allocated: a reader is to take no more than the promise of its module.
#[global_allocator]
static MEMORY: peak_alloc::PeakAlloc = peak_alloc::PeakAlloc;

/// Bytes that reading a file may take beside 24 times its size and 8 bytes a point.
const BASE: usize = 32 << 20;

/// Does `read` and compares what it takes at its highest with the promise for a file of `length`
/// bytes; `read` gives the number of points.
///
/// # Panics
/// If it takes more.
pub fn within_memory(length: usize, read: impl FnOnce() -> usize) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let points = read();
    let taken = MEMORY.peak_usage().saturating_sub(before);
    let promised = BASE + 24 * length + 8 * points;
    assert!(taken <= promised, "{taken} bytes taken for {length} bytes and {points} points");
}

/// Reads a file that begins with `signature`. Whatever it is, the answer is a scan or an error.
pub fn read_with(signature: &[u8], bytes: &[u8]) {
    read(&[signature, bytes].concat());
}

/// Reads the bytes of a file and uses what they hold.
pub fn read(bytes: &[u8]) {
    let mut found = Ok(None);
    within_memory(bytes.len(), || {
        found = scans::file::parse_file("fuzz", bytes);
        // Of a file that is refused nothing is left to count: it declares nothing that counts.
        found.as_ref().map_or(0, |scan| scan.as_ref().map_or(0, |scan| scan.heights.len()))
    });
    match found {
        Ok(Some(scan)) => {
            assert!(scan.mean().is_finite() && scan.missing() < scan.heights.len());
            let lines = scan.line_scans("fuzz", scans::file::MapLines::Columns, 1000);
            let lines = lines.expect("a scan in memory has no more points than lines may have");
            assert!(lines.iter().all(|line| line.positions.len() == line.heights.len()));
        }
        Ok(None) => {}
        Err(error) => assert!(error.to_string().starts_with("fuzz: ")),
    }
}
