//! Height-difference correlation and spectrum of one line scan in a raw file, with their times; what
//! `benches/peers/surface_topography.py` measures against.
//!
//!     cargo run --release --example line_statistics HEIGHTS SPACING_M REPEATS OUT
//!
//! HEIGHTS holds little-endian doubles in metres. OUT gets, in the same form, the correlation in m² at
//! all lags up to half the scan, then the one-sided Hann density in m³ at all wavenumbers. The median
//! seconds of each go to standard output, plans and allocations included.

use asperity::surface::LineScan;
use asperity::surface::correlation::CorrelationPlan;
use asperity::surface::spectrum::{SpectrumPlan, Window};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [heights, spacing, repeats, out] = &arguments[..] else {
        return Err("wanted: HEIGHTS SPACING_M REPEATS OUT".into());
    };
    let bytes = std::fs::read(heights)?;
    let heights = bytes.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect();
    let scan = LineScan { name: "line".into(), origin: 0.0, spacing: spacing.parse()?, heights };
    let (points, repeats) = (scan.heights.len(), repeats.parse()?);
    let (correlation, correlation_seconds) =
        timed(repeats, || CorrelationPlan::new(points, points / 2).correlate(&scan));
    let (spectrum, spectrum_seconds) =
        timed(repeats, || SpectrumPlan::new(points)?.periodogram(&scan, Window::Hann));
    let (correlation, spectrum) = (correlation?, spectrum?);
    let values = correlation.values.iter().chain(&spectrum.density);
    std::fs::write(out, values.flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())?;
    println!("{correlation_seconds} {spectrum_seconds}");
    Ok(())
}

/// The result and the median of the times in seconds.
fn timed<T>(repeats: usize, work: impl Fn() -> T) -> (T, f64) {
    let mut result = work();
    let mut seconds: Vec<f64> = (0..repeats.max(1))
        .map(|_| {
            let start = Instant::now();
            result = work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (result, seconds[seconds.len() / 2])
}
