//! Correlation and spectrum of the scans.

use super::grouped;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::html::number;
use crate::report::read::{rows, table};
use crate::stages::approximate::{FITTED, RULE_KEY};
use crate::stages::characterise::{
    AVERAGE, CORRELATION, RELIABLE_KEY, SELF_AFFINE, SPECTRUM, SelfAffineRow, SpectrumRow,
};
use std::f64::consts::TAU;

/// Correlation of the scans, of their self-affine fit and of the superposed sines.
pub(super) fn correlation(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(measured) = rows(run, CORRELATION)? else {
        return Ok(None);
    };
    let (fitted, metadata) = table(run, FITTED)?.unwrap_or_default();
    let average: Vec<(f64, f64)> = measured
        .iter()
        .filter(|row| row.scan == AVERAGE)
        .map(|row| (row.lag_mm, row.correlation_mm2))
        .collect();
    let mut series = vec![];
    for (number, (waves, rows)) in grouped(&fitted, |row| row.waves).into_iter().enumerate() {
        let line = rows.iter().map(|row| (row.lag_mm, row.fitted_mm2)).collect();
        let mark = if number % 2 == 0 { Mark::Line(line) } else { Mark::Dashed(line) };
        series.push(Series::new(format!("{waves} sines"), Colour::Nth(number + 1), mark));
    }
    let fits = rows(run, SELF_AFFINE)?.unwrap_or_default();
    if let Some(fit) = fits.iter().find(|row| row.scan == AVERAGE) {
        series.insert(0, self_affine(fit, &average));
    }
    // By the rule of sines the fitted curves are means over lags, and so is what they are to meet.
    if metadata.get(RULE_KEY).is_some_and(|rule| rule.starts_with("sines")) {
        let first = fitted.first().map(|row| row.waves);
        let of_first = fitted.iter().filter(|row| Some(row.waves) == first);
        let means = of_first.map(|row| (row.lag_mm, row.measured_mm2)).collect();
        series.push(Series::new("scans, mean up to s", Colour::Black, Mark::OpenCircles(means)));
    }
    series.push(Series::new("scans, average", Colour::Nth(0), Mark::FilledCircles(average)));
    Ok(Some(Figure {
        caption: "Height-difference correlation of the scans, averaged over all pairs of points, \
                  its self-affine fit and the correlation of the fitted sines."
            .into(),
        panels: vec![Panel {
            title: "Height-difference correlation".into(),
            x: Axis::logarithmic("lag s / mm"),
            y: Axis::logarithmic("correlation C(s) / mm²"),
            series,
        }],
    }))
}

fn self_affine(fit: &SelfAffineRow, average: &[(f64, f64)]) -> Series {
    let value = |lag: f64| {
        let share = (lag / fit.parallel_length_mm).min(1.0);
        fit.perpendicular_length_mm.powi(2) * share.powf(2.0 * fit.hurst_exponent)
    };
    let line = average.iter().map(|&(lag, _)| (lag, value(lag))).collect();
    let label = format!("self-affine, H = {:.2}", fit.hurst_exponent);
    Series::new(label, Colour::Black, Mark::Dashed(line))
}

/// Spectrum of the scans with its standard error and the limit of what the instrument shows.
pub(super) fn spectrum(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some((all, metadata)) = table(run, SPECTRUM)? else {
        return Ok(None);
    };
    let average: Vec<&SpectrumRow> = all.iter().filter(|row| row.scan == AVERAGE).collect();
    let band = |row: &&SpectrumRow| {
        let (density, error) = (row.density_mm3, row.standard_error_mm3);
        (row.wavenumber_rad_mm, density - error, density + error)
    };
    let geometric = |row: &&SpectrumRow| Some((row.wavenumber_rad_mm, row.geometric_density_mm3?));
    let line = average.iter().map(|row| (row.wavenumber_rad_mm, row.density_mm3)).collect();
    let mut series = vec![
        Series::new(
            "± standard error",
            Colour::Nth(0),
            Mark::Band(average.iter().map(band).collect()),
        ),
        Series::new("arithmetic mean", Colour::Nth(0), Mark::Line(line)),
        Series::new(
            "geometric mean, unbiased",
            Colour::Nth(1),
            Mark::OpenCircles(average.iter().filter_map(geometric).collect()),
        ),
    ];
    let reliable: Option<f64> = metadata.get(RELIABLE_KEY).and_then(|text| text.parse().ok());
    if let Some(wavelength) = reliable.filter(|wavelength| *wavelength > 0.0) {
        let label = format!("shortest reliable wave, {} mm", number(wavelength, 3));
        series.push(Series::new(label, Colour::Black, Mark::VerticalLine(TAU / wavelength)));
    }
    Ok(Some(Figure {
        caption:
            "Power spectral density of the scans, averaged over the windows and in bins, with \
                  its standard error over the windows."
                .into(),
        panels: vec![Panel {
            title: "Power spectral density of the line scans".into(),
            x: Axis::logarithmic("wavenumber q / (rad/mm)"),
            y: Axis::logarithmic("density C(q) / mm³"),
            series,
        }],
    }))
}
