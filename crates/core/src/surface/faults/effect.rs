//! What a fault means for the texture.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The shortest waves of a scan with gaps, without filling them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Root mean square of the first differences over the spacing; 0 where there is no pair.
    pub rms_slope: f64,
    /// Mean square in m² of the second differences `z(i-1) - 2 z(i) + z(i+1)`, the power spectral
    /// density weighted by `16 sin^4(q dx / 2)`: nine tenths of that weight, on white noise, lie
    /// above half the Nyquist wavenumber. 0 where there are no three neighbours.
    pub high_frequency: f64,
}

impl Texture {
    /// Of equidistant heights in metres, `spacing` metres apart; NaN where missing.
    pub fn new(heights: &[f64], spacing: f64) -> Self {
        let first = heights.windows(2).map(|z| z[1] - z[0]);
        let second = heights.windows(3).map(|z| z[0] - 2.0 * z[1] + z[2]);
        Self { rms_slope: mean_square(first).sqrt() / spacing, high_frequency: mean_square(second) }
    }
}

fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let valid = values.filter(|value| !value.is_nan());
    let (sum, count) = valid.fold((0.0, 0_usize), |(sum, count), z| (sum + z * z, count + 1));
    sum / count.max(1) as f64
}

/// One kind of fault in one scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaultReport {
    /// `spikes`, `level jumps` ...
    pub fault: String,
    /// The criterion with its numbers.
    pub criterion: String,
    /// What was done: `kept`, `missing`, `cut`, `averaged`, `reported`.
    pub decision: String,
    /// How often it was found.
    pub count: usize,
    /// Share of the points concerned, between 0 and 1.
    pub share: f64,
    /// What was measured besides, if anything, as `measure_name` says.
    pub measure: Option<f64>,
    /// Name and unit of the measure.
    pub measure_name: Option<String>,
    /// Root mean square slope at the spacing of the file before the fault is removed.
    pub rms_slope_before: Option<f64>,
    /// And after, whether or not it was decided to remove it.
    pub rms_slope_after: Option<f64>,
    /// Mean square of the second differences after over before: the ratio of the power spectral
    /// density at the highest wavenumbers.
    pub high_frequency_ratio: Option<f64>,
}

impl FaultReport {
    /// A fault that was found, without an effect on the texture.
    pub fn new(fault: &str, criterion: String, decision: &str, count: usize, share: f64) -> Self {
        Self {
            fault: fault.to_owned(),
            criterion,
            decision: decision.to_owned(),
            count,
            share,
            measure: None,
            measure_name: None,
            rms_slope_before: None,
            rms_slope_after: None,
            high_frequency_ratio: None,
        }
    }

    /// The report with a measure.
    pub fn measuring(self, name: &str, measure: f64) -> Self {
        Self { measure: Some(measure), measure_name: Some(name.to_owned()), ..self }
    }

    /// The report with the texture before and after the removal.
    pub fn with_effect(self, before: Texture, after: Texture) -> Self {
        let ratio = after.high_frequency / before.high_frequency;
        Self {
            rms_slope_before: Some(before.rms_slope),
            rms_slope_after: Some(after.rms_slope),
            high_frequency_ratio: ratio.is_finite().then_some(ratio),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_those_of_the_valid_neighbours() {
        let texture = Texture::new(&[0.0, 1.0, 4.0, f64::NAN, 2.0, 2.0], 0.5);
        // Steps 1, 3, 0; one second difference, 2.
        assert_eq!(texture.rms_slope, (10.0_f64 / 3.0).sqrt() / 0.5);
        assert_eq!(texture.high_frequency, 4.0);
        assert_eq!(Texture::new(&[], 1.0), Texture { rms_slope: 0.0, high_frequency: 0.0 });
    }

    #[test]
    fn the_shortest_wave_has_its_exact_weight() {
        // At the Nyquist wavenumber 16 sin^4 is 16, the mean square of the wave 1.
        let wave: Vec<f64> = (0..10).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(Texture::new(&wave, 1.0).high_frequency, 16.0);
    }

    #[test]
    fn a_ratio_over_nothing_is_none() {
        let flat = Texture::new(&[0.0; 4], 1.0);
        let report = FaultReport::new("spikes", String::new(), "kept", 0, 0.0);
        assert_eq!(report.with_effect(flat, flat).high_frequency_ratio, None);
    }
}
