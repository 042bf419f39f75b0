//! The master curve of the rubber of a run.

use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::rubber::{FrequencyRange, RubberModel, Viscoelastic};
use crate::stages::realise::{AREAL_SURFACES, SURFACES, read_surfaces};
use crate::units::Units;
use serde_json::Value;
use std::f64::consts::TAU;

/// Colour of the storage modulus.
pub(super) const STORAGE: Colour = Colour::Nth(0);
/// Colour of the loss modulus and of the loss factor.
pub(super) const LOSS: Colour = Colour::Nth(1);
const CURVE_POINTS: i32 = 300;
/// By how much the curves go beyond what is excited and what relaxes.
const BEYOND: f64 = 30.0;

/// What the contacts of a run were solved with.
pub(in crate::report) struct Material {
    /// The rubber at the temperature of the run.
    pub rubber: RubberModel,
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
    let Ok(rubber) = serde_json::from_value::<RubberModel>(parameters["rubber"].clone()) else {
        return Ok(None);
    };
    let measured = &parameters["measured"];
    let ends = [measured["lowest_hz"].as_f64(), measured["highest_hz"].as_f64()];
    let surfaces = if run.has(SURFACES)? { read_surfaces(run)? } else { vec![] };
    let waves = || surfaces.iter().flat_map(|s| &s.profile).filter(|w| w.amplitude > 0.0);
    let areal = rows(run, AREAL_SURFACES)?.unwrap_or_default();
    let of_maps = areal.iter().flat_map(|row| {
        [row.period_x_mm.max(row.period_y_mm), row.shortest_wavelength_mm].map(Units::mm_to_m)
    });
    let lengths: Vec<f64> = waves().map(|w| w.wavelength).chain(of_maps).collect();
    let speeds = parameters["speeds_mm_s"].as_array().into_iter().flatten();
    let excited = speeds.filter_map(Value::as_f64).filter_map(|speed| {
        let range = FrequencyRange::excited(lengths.iter().copied(), [1e-3 * speed])?;
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
    let relaxing: Vec<f64> = match rubber {
        RubberModel::Maxwell(rubber) => {
            rubber.branches.iter().map(|branch| 1.0 / (TAU * branch.relaxation_time)).collect()
        }
        RubberModel::Table(table) => vec![table.range().lowest_hz, table.range().highest_hz],
    };
    let excited =
        material.excited.iter().flat_map(|(_, range)| [range.lowest_hz, range.highest_hz]);
    let ends = |value: f64| value.is_finite() && value > 0.0;
    let of_interest: Vec<f64> = relaxing.into_iter().chain(excited).filter(|f| ends(*f)).collect();
    let low = of_interest.iter().copied().fold(f64::INFINITY, f64::min) / BEYOND;
    let high = of_interest.iter().copied().fold(0.0, f64::max) * BEYOND;
    if low > high {
        return Ok(None);
    }
    let over = frequencies(low, high);
    let tan_delta = |frequency: &f64| {
        let modulus = rubber.complex_modulus(TAU * frequency);
        (*frequency, modulus.im / modulus.re)
    };
    let lines = moduli(rubber, &over, &|_| true)
        .map(|(name, mark, colour)| Series::new(name, colour, mark));
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
                title: format!("{}{temperature}", rubber.name()),
                x: frequency(),
                y: modulus_axis(),
                series: with_ranges(lines.to_vec()),
            },
            Panel {
                title: "Loss factor".into(),
                x: frequency(),
                y: Axis::from_zero("loss factor tan δ"),
                series: with_ranges(vec![Series::new(
                    "tan δ",
                    LOSS,
                    Mark::Line(over.iter().map(tan_delta).collect()),
                )]),
            },
        ],
    }))
}

/// Axis of moduli in MPa.
pub(super) fn modulus_axis() -> Axis {
    Axis::logarithmic("Young's modulus / MPa")
}

/// Frequencies in Hz in equal ratios from the lowest to the highest.
pub(super) fn frequencies(lowest: f64, highest: f64) -> Vec<f64> {
    let share = |k: i32| f64::from(k) / f64::from(CURVE_POINTS);
    (0..=CURVE_POINTS).map(|k| lowest * (highest / lowest).powf(share(k))).collect()
}

/// Storage and loss modulus of a rubber in MPa over frequencies in Hz, where `shown` holds for the
/// modulus: name, line and colour.
pub(super) fn moduli(
    rubber: &RubberModel,
    frequencies: &[f64],
    shown: &dyn Fn(f64) -> bool,
) -> [(&'static str, Mark, Colour); 2] {
    let line = |part: fn(&RubberModel, f64) -> f64| -> Points {
        let modulus = |frequency: &f64| 1e-6 * part(rubber, TAU * frequency);
        let value = |modulus: f64| if shown(modulus) { modulus } else { f64::NAN };
        frequencies.iter().map(|frequency| (*frequency, value(modulus(frequency)))).collect()
    };
    [
        ("storage modulus E′", Mark::Line(line(|rubber, w| rubber.complex_modulus(w).re)), STORAGE),
        ("loss modulus E″", Mark::Dashed(line(|rubber, w| rubber.complex_modulus(w).im)), LOSS),
    ]
}

fn spans(material: &Material) -> Vec<Series> {
    let excited = material.excited.iter().enumerate().map(|(number, (speed, range))| {
        let span = Mark::Span(range.lowest_hz, range.highest_hz);
        Series::new(format!("excited at {speed} mm/s"), Colour::Nth(number + 2), span)
    });
    let ends = material.measured.into_iter().flatten().enumerate();
    let limits = ends.map(|(number, at)| Series {
        label: (number == 0).then(|| "limits of the measurement".into()),
        colour: Colour::Black,
        mark: Mark::VerticalLine(at),
    });
    excited.chain(limits).collect()
}
