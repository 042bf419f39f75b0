//! Where axes have ticks, and what stands there.

use super::Scale;
use std::ops::Range;

/// About as many labelled ticks an axis has room for.
const WANTED: f64 = 6.0;
/// Longest logarithmic axis, in decades, with ticks at 2 and 5.
const SHORT: f64 = 3.0;
/// Longest logarithmic axis, in decades, with the ticks of a linear one.
const TINY: f64 = 0.7;

/// Ticks of an axis, in its coordinates (decadic logarithms on a logarithmic one).
pub(super) struct Ticks {
    /// Ticks with a label.
    pub labelled: Vec<f64>,
    /// Ticks without.
    pub minor: Vec<f64>,
    scale: Scale,
    decimals: usize,
    /// Labels of a logarithmic axis are plain numbers, not powers of ten.
    plain: bool,
}

impl Ticks {
    /// Ticks within `range`, in coordinates.
    pub(super) fn new(scale: Scale, range: &Range<f64>) -> Self {
        match scale {
            Scale::Linear => Self::linear(range),
            Scale::Logarithmic => Self::logarithmic(range),
        }
    }

    /// No ticks at all.
    pub(super) fn none() -> Self {
        Self { labelled: vec![], minor: vec![], scale: Scale::Linear, decimals: 0, plain: true }
    }

    fn linear(range: &Range<f64>) -> Self {
        let step = round_step((range.end - range.start) / WANTED);
        let decimals = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
        Self {
            labelled: multiples(step, range),
            minor: vec![],
            scale: Scale::Linear,
            decimals,
            plain: true,
        }
    }

    fn logarithmic(range: &Range<f64>) -> Self {
        let scale = Scale::Logarithmic;
        let decades = range.end - range.start;
        if decades < TINY {
            let values = 10_f64.powf(range.start)..10_f64.powf(range.end);
            let linear = Self::linear(&values);
            let labelled = linear.labelled.iter().map(|value| value.log10()).collect();
            return Self { labelled, scale, ..linear };
        }
        let every = (decades / (WANTED + 1.0)).ceil();
        let at = |factors: &[f64], every: f64| -> Vec<f64> {
            let powers = multiples(every, &(range.start - every..range.end));
            let ticks =
                powers.iter().flat_map(|power| factors.iter().map(move |f| power + f.log10()));
            ticks.filter(|tick| range.contains(tick)).collect()
        };
        let between: Vec<f64> = (2..10).map(f64::from).collect();
        let labelled = if decades < SHORT { at(&[1.0, 2.0, 5.0], 1.0) } else { at(&[1.0], every) };
        let minor = if every > 1.0 { at(&[1.0], 1.0) } else { at(&between, 1.0) };
        // One way of writing along the whole axis.
        let plain = labelled.iter().all(|tick| (-3.01..4.01).contains(tick));
        Self { labelled, minor, scale, decimals: 0, plain }
    }

    /// What stands at a labelled tick.
    pub(super) fn label(&self, coordinate: f64) -> String {
        match self.scale {
            Scale::Linear => plain(coordinate, self.decimals),
            Scale::Logarithmic if self.decimals > 0 => {
                plain(10_f64.powf(coordinate), self.decimals)
            }
            Scale::Logarithmic => power_label(coordinate, self.plain),
        }
    }
}

/// 1, 2 or 5 times a power of ten, not below `wanted`.
fn round_step(wanted: f64) -> f64 {
    let power = 10_f64.powf(wanted.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= wanted * 0.999);
    factor.unwrap_or(10.0) * power
}

/// 1, 2 or 5 times a power of ten, not above `most`.
pub(super) fn round_length(most: f64) -> f64 {
    let power = most.log10().floor() as i32;
    // Division keeps 0.2 what it is written as.
    let times = |factor: f64| {
        if power < 0 { factor / 10_f64.powi(-power) } else { factor * 10_f64.powi(power) }
    };
    [5.0, 2.0].into_iter().map(times).find(|length| *length <= most).unwrap_or(times(1.0))
}

fn multiples(step: f64, range: &Range<f64>) -> Vec<f64> {
    let first = (range.start / step - 1e-9).ceil() as i64;
    let last = (range.end / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

fn plain(value: f64, decimals: usize) -> String {
    if decimals > 4 || value.abs() >= 1e5 {
        return scientific(value);
    }
    // Rounding must not leave the sign of a zero.
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').bytes().all(|digit| matches!(digit, b'0' | b'.')) {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "\u{2212}")
}

/// The value at a tick of a logarithmic axis, a digit times a power of ten.
fn power_label(coordinate: f64, plain: bool) -> String {
    let power = (coordinate + 1e-9).floor();
    let digit = 10_f64.powf(coordinate - power).round();
    if plain {
        let decimals = (-power).max(0.0) as usize;
        return format!("{:.decimals$}", digit * 10_f64.powf(power));
    }
    scientific(digit * 10_f64.powf(power))
}

/// A number such as 2×10⁻⁶.
pub(crate) fn scientific(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let text = format!("{value:.1e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let mantissa = mantissa.trim_end_matches(".0").replace('-', "\u{2212}");
    let exponent: String = exponent.chars().map(superscript).collect();
    match mantissa.as_str() {
        "1" => format!("10{exponent}"),
        _ => format!("{mantissa}\u{d7}10{exponent}"),
    }
}

fn superscript(character: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match character.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None => '⁻',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, range: Range<f64>) -> Vec<String> {
        let ticks = Ticks::new(scale, &range);
        ticks.labelled.iter().map(|tick| ticks.label(*tick)).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(
            labels(Scale::Linear, 0.0..0.105),
            ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]
        );
        assert_eq!(labels(Scale::Linear, -1.3..1.2), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Linear, 0.0..1.1e6)[1], "2×10⁵");
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten_or_their_1_2_5() {
        assert_eq!(labels(Scale::Logarithmic, -2.1..1.2), ["0.01", "0.1", "1", "10"]);
        assert_eq!(labels(Scale::Logarithmic, -0.1..1.2), ["1", "2", "5", "10"]);
        assert_eq!(labels(Scale::Logarithmic, 0.1..0.5), ["1.5", "2.0", "2.5", "3.0"]);
        assert_eq!(
            labels(Scale::Logarithmic, -12.0..8.5),
            ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰", "10³", "10⁶"]
        );
        assert_eq!(scientific(-2.5e-6), "−2.5×10⁻⁶");
    }

    #[test]
    fn lengths_of_scale_bars_are_round() {
        let lengths = [0.24, 1.6, 4.9, 5.0, 0.0125].map(round_length);
        assert_eq!(lengths, [0.2, 1.0, 2.0, 5.0, 0.01]);
    }

    #[test]
    fn ticks_stay_within_their_axis() {
        for range in [-7.3..2.9, 0.01..0.02, -3.0..-1.0] {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let ticks = Ticks::new(scale, &range);
                let inside = |tick: &f64| (range.start - 1e-6..range.end + 1e-6).contains(tick);
                assert!(ticks.labelled.len() >= 2, "{range:?}");
                assert!(ticks.labelled.iter().chain(&ticks.minor).all(inside), "{range:?}");
            }
        }
    }
}
