//! The superposed sines.

use super::grouped;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::approximate::{ScaleRow, WAVES};
use crate::units::Units;

/// The steepness from which a wave counts to the microscale of a run, if it has one.
pub(in crate::report) fn microscale_slope(run: &RunView) -> Result<Option<f64>, ReportError> {
    let manifest = run.stage_manifest("micro")?;
    Ok(manifest.and_then(|manifest| manifest.parameters["micro"]["rms_slope_threshold"].as_f64()))
}

/// Amplitudes with their intervals, and slopes with the limit of the half-space.
pub(super) fn waves(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(scales) = rows(run, WAVES)? else { return Ok(None) };
    let (mut amplitudes, mut slopes) = (vec![], vec![]);
    for (number, (waves, rows)) in grouped(&scales, |row| row.waves).into_iter().enumerate() {
        let (name, colour) = (format!("{waves} waves"), Colour::Nth(number));
        // Side by side, so that the bars of different fits do not hide each other.
        let beside = 1.06_f64.powi(number as i32);
        let place = |row: &ScaleRow| beside * row.wavelength_mm;
        let bars = rows.iter().filter_map(|row| {
            let half = row.amplitude_confidence_95_mm?;
            // An amplitude is not negative, and one of zero has no place on a logarithmic axis.
            let low = (row.amplitude_mm - half).max(0.0);
            (row.amplitude_mm > 0.0)
                .then(|| (place(row), low.mm_to_um(), (row.amplitude_mm + half).mm_to_um()))
        });
        amplitudes.push(Series::unnamed(colour, Mark::ErrorBars(bars.collect())));
        let amplitude = rows.iter().map(|row| (place(row), row.amplitude_mm.mm_to_um())).collect();
        amplitudes.push(Series::new(&name, colour, Mark::FilledCircles(amplitude)));
        let slope: Vec<(f64, f64)> = rows.iter().map(|row| (place(row), row.rms_slope)).collect();
        slopes.push(Series::unnamed(colour, Mark::Dashed(slope.clone())));
        slopes.push(Series::new(&name, colour, Mark::FilledCircles(slope)));
    }
    if let Some(limit) = microscale_slope(run)? {
        let label = "finite deformation above this slope";
        slopes.push(Series::new(label, Colour::Black, Mark::HorizontalLine(limit)));
    }
    let wavelength = || Axis::logarithmic("wavelength λ / mm");
    let panel = |title: &str, y, series| Panel { title: title.into(), x: wavelength(), y, series };
    Ok(Some(Figure {
        caption: "Amplitudes of the superposed sines with 95 % confidence intervals, where they \
                  are known, and their root mean square slopes. Different numbers of waves are set \
                  side by side; waves of zero amplitude are left out."
            .into(),
        panels: vec![
            panel(
                "Amplitudes, bars: 95 % interval",
                Axis::logarithmic("amplitude D / µm"),
                amplitudes,
            ),
            panel("Slopes", Axis::from_zero("root mean square slope"), slopes),
        ],
    }))
}
