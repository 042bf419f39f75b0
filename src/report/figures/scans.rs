//! What the scans look like.

use super::thinned;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::html::number;
use crate::stages::ingest::{SCANS, read_windows};
use crate::surface::LineScan;
use crate::units::Units;
use std::f64::consts::TAU;

/// Windows that are drawn; more hide each other.
const DRAWN: usize = 4;
/// Stretches of a window that are drawn.
const STRETCHES: usize = 800;
/// Bars of the histogram of heights.
const BINS: usize = 60;

fn windows(run: &RunView) -> Result<Vec<LineScan>, ReportError> {
    if run.has(SCANS)? { Ok(read_windows(run)?) } else { Ok(vec![]) }
}

fn valid(windows: &[LineScan]) -> impl Iterator<Item = f64> {
    windows.iter().flat_map(|window| &window.heights).filter(|z| !z.is_nan()).map(|z| z.m_to_mm())
}

/// Some windows one above the other.
pub(super) fn scans(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let windows = windows(run)?;
    if valid(&windows).next().is_none() {
        return Ok(None);
    }
    let step = windows.len().div_ceil(DRAWN);
    let drawn: Vec<&LineScan> = windows.iter().step_by(step).collect();
    let range = |window: &LineScan| {
        let heights = || window.heights.iter().copied().filter(|z| !z.is_nan());
        heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
    };
    let largest = drawn.iter().map(|window| range(window)).fold(0.0, f64::max);
    let shift = 1.1 * largest.m_to_mm();
    let digits = 10_f64.powf(shift.log10().floor() - 1.0);
    let shift = (shift / digits).ceil() * digits;
    let series = drawn.iter().enumerate().map(|(number, window)| {
        let offset = (drawn.len() - 1 - number) as f64 * shift;
        let points: Vec<(f64, f64)> = window
            .heights
            .iter()
            .enumerate()
            .map(|(i, z)| (window.spacing.m_to_mm() * i as f64, z.m_to_mm() + offset))
            .collect();
        Series::new(&window.name, Colour::Nth(number), Mark::Line(thinned(&points, STRETCHES)))
    });
    let apart = match drawn.len() {
        1 => String::new(),
        _ => format!(", each {} above the next", number(shift, 2)),
    };
    let panel = Panel {
        title: format!("{} of {} windows", drawn.len(), windows.len()),
        x: Axis::linear("position x / mm"),
        y: Axis::linear(format!("height z / mm{apart}")),
        series: series.collect(),
    };
    Ok(Some(Figure {
        caption:
            "Heights of windows of the scans after cleaning and removal of the form; gaps are \
                  missing heights."
                .into(),
        panels: vec![panel],
    }))
}

/// Distribution of the heights, beside the Gaussian one of the same root mean square.
pub(super) fn heights(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let windows = windows(run)?;
    let count = valid(&windows).count() as f64;
    let low = valid(&windows).fold(f64::INFINITY, f64::min);
    let high = valid(&windows).fold(f64::NEG_INFINITY, f64::max);
    if high <= low || count == 0.0 {
        return Ok(None);
    }
    let width = (high - low) / BINS as f64;
    let mut densities = vec![0.0; BINS];
    for height in valid(&windows) {
        densities[(((height - low) / width) as usize).min(BINS - 1)] += 1.0 / (count * width);
    }
    let bars = densities.iter().enumerate().map(|(bin, density)| {
        let from = low + width * bin as f64;
        (from, from + width, *density)
    });
    let mean = valid(&windows).sum::<f64>() / count;
    let rq = (valid(&windows).map(|z| (z - mean).powi(2)).sum::<f64>() / count).sqrt();
    let gaussian = |z: f64| (-0.5 * ((z - mean) / rq).powi(2)).exp() / (rq * TAU.sqrt());
    let curve =
        (0..=200).map(|k| low + (high - low) * f64::from(k) / 200.0).map(|z| (z, gaussian(z)));
    let panel = Panel {
        title: format!("{} windows, {count} heights", windows.len()),
        x: Axis::linear("height z / mm"),
        y: Axis::from_zero("probability density / (1/mm)"),
        series: vec![
            Series::new("heights of the scans", Colour::Nth(0), Mark::Histogram(bars.collect())),
            Series::new(
                "Gaussian of the same mean and Rq",
                Colour::Nth(1),
                Mark::Line(curve.collect()),
            ),
        ],
    };
    Ok(Some(Figure {
        caption: "Distribution of the heights of all windows, beside the Gaussian distribution of \
                  the same mean and root mean square height."
            .into(),
        panels: vec![panel],
    }))
}
