//! The master curve of the rubber of a run.

use crate::artifact::RunView;
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::rubber::{FrequencyRange, Rubber};
use crate::stages::realise::{SURFACES, read_surfaces};
use serde_json::Value;
use std::f64::consts::TAU;

const CURVE_POINTS: i32 = 300;
/// By how much the curves go beyond what is excited and what relaxes.
const BEYOND: f64 = 30.0;

/// What the contacts of a run were solved with.
pub(in crate::report) struct Material {
    /// The rubber at the temperature of the run.
    pub rubber: Rubber,
    /// Its temperature, if the recipe names one.
    pub temperature_c: Option<f64>,
    /// Frequencies at which it was measured, if its file says.
    pub measured: Option<[f64; 2]>,
    /// Speeds, and the frequencies that the waves excite at each.
    pub excited: Vec<(f64, FrequencyRange)>,
}

/// The rubber of the manifest of the contacts.
pub(in crate::report) fn material(run: &RunView) -> Result<Option<Material>, ReportError> {
    let Some(manifest) = run.stage_manifest("bem")? else { return Ok(None) };
    let parameters = &manifest.parameters;
    let Ok(rubber) = serde_json::from_value::<Rubber>(parameters["rubber"].clone()) else {
        return Ok(None);
    };
    let measured = &parameters["measured"];
    let ends = [measured["lowest_hz"].as_f64(), measured["highest_hz"].as_f64()];
    let surfaces = if run.has(SURFACES)? { read_surfaces(run)? } else { vec![] };
    let waves = || surfaces.iter().flat_map(|s| &s.profile).filter(|w| w.amplitude > 0.0);
    let speeds = parameters["speeds_mm_s"].as_array().into_iter().flatten();
    let excited = speeds.filter_map(Value::as_f64).filter_map(|speed| {
        let range = FrequencyRange::excited(waves().map(|w| w.wavelength), [1e-3 * speed])?;
        Some((speed, range))
    });
    Ok(Some(Material {
        rubber,
        temperature_c: parameters["temperature_c"].as_f64(),
        measured: match ends {
            [Some(low), Some(high)] => Some([low, high]),
            _ => None,
        },
        excited: excited.collect(),
    }))
}

/// Moduli and loss factor over frequency, shaded where the surface excites the rubber.
pub(super) fn rubber(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(material) = material(run)? else { return Ok(None) };
    let rubber = &material.rubber;
    let relaxing = rubber.branches.iter().map(|branch| 1.0 / (TAU * branch.relaxation_time));
    let excited =
        material.excited.iter().flat_map(|(_, range)| [range.lowest_hz, range.highest_hz]);
    let ends = |value: f64| value.is_finite() && value > 0.0;
    let frequencies: Vec<f64> = relaxing.chain(excited).filter(|f| ends(*f)).collect();
    let low = frequencies.iter().copied().fold(f64::INFINITY, f64::min) / BEYOND;
    let high = frequencies.iter().copied().fold(0.0, f64::max) * BEYOND;
    if low > high {
        return Ok(None);
    }
    let at = |k: i32| low * (high / low).powf(f64::from(k) / f64::from(CURVE_POINTS));
    let line = |value: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        (0..=CURVE_POINTS).map(at).map(|f| (f, value(TAU * f))).collect()
    };
    let storage = line(&|w| 1e-6 * rubber.complex_modulus(w).re);
    let loss = line(&|w| 1e-6 * rubber.complex_modulus(w).im);
    let factor = line(&|w| rubber.complex_modulus(w).im / rubber.complex_modulus(w).re);
    let frequency = || Axis::logarithmic("frequency f / Hz");
    let with_ranges = |lines: Vec<Series>| spans(&material).into_iter().chain(lines).collect();
    let temperature =
        material.temperature_c.map_or(String::new(), |celsius| format!(" at {celsius} °C"));
    Ok(Some(Figure {
        caption: "Young's modulus of the rubber over frequency; shaded from the frequency v/λ of \
                  the longest wave to that of the shortest. Edges of small contacts excite multiples \
                  of these."
            .into(),
        panels: vec![
            Panel {
                title: format!("{}{temperature}", rubber.name),
                across: frequency(),
                up: Axis::logarithmic("Young's modulus / MPa"),
                series: with_ranges(vec![
                    Series::new("storage modulus E′", 1, Mark::Line(storage)),
                    Series::new("loss modulus E″", 2, Mark::Dashed(loss)),
                ]),
            },
            Panel {
                title: "Loss factor".into(),
                across: frequency(),
                up: Axis::from_zero("loss factor tan δ"),
                series: with_ranges(vec![Series::new("tan δ", 2, Mark::Line(factor))]),
            },
        ],
    }))
}

fn spans(material: &Material) -> Vec<Series> {
    let excited = material.excited.iter().enumerate().map(|(number, (speed, range))| {
        let span = Mark::Span(range.lowest_hz, range.highest_hz);
        Series::new(format!("excited at {speed} mm/s"), number + 3, span)
    });
    let ends = material.measured.into_iter().flatten().enumerate();
    let limits = ends.map(|(number, at)| Series {
        label: (number == 0).then(|| "limits of the measurement".into()),
        colour: 0,
        mark: Mark::Vertical(at),
    });
    excited.chain(limits).collect()
}
