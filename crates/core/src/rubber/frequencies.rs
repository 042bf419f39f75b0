//! The frequencies at which a rubber was measured, and those that a surface excites.

use serde::Serialize;

/// A range of frequencies in Hz, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrequencyRange {
    /// Lowest frequency in Hz.
    pub lowest_hz: f64,
    /// Highest frequency in Hz.
    pub highest_hz: f64,
}

/// Speeds and wavelengths are decimal in their files; the quotient of two of them is not.
const ROUNDING: f64 = 1e-9;

impl FrequencyRange {
    /// What waves excite in a rubber that slides over them: `f = v / λ` from the longest at the
    /// lowest speed to the shortest at the highest (wavelengths in m, speeds in m/s). The edges of
    /// small contacts add multiples of these. `None` without a wave or a speed.
    pub fn excited(
        wavelengths: impl IntoIterator<Item = f64>,
        speeds: impl IntoIterator<Item = f64>,
    ) -> Option<Self> {
        let [shortest, longest] = extremes(wavelengths)?;
        let [slowest, fastest] = extremes(speeds)?;
        Some(Self { lowest_hz: slowest / longest, highest_hz: fastest / shortest })
    }

    /// The range at a temperature where relaxation times are `factor` times as long.
    pub fn shifted(self, factor: f64) -> Self {
        Self { lowest_hz: self.lowest_hz / factor, highest_hz: self.highest_hz / factor }
    }

    /// The lowest frequency of another range if this one begins above it, otherwise the highest one if this one ends
    /// below it, in Hz.
    pub fn first_outside(&self, other: Self) -> Option<f64> {
        match self.exceeded_by(other) {
            [true, _] => Some(other.lowest_hz),
            [false, true] => Some(other.highest_hz),
            [false, false] => None,
        }
    }

    /// Whether another range begins below this one, and whether it ends above it.
    fn exceeded_by(&self, other: Self) -> [bool; 2] {
        let below = other.lowest_hz < self.lowest_hz * (1.0 - ROUNDING);
        let above = other.highest_hz > self.highest_hz * (1.0 + ROUNDING);
        [below, above]
    }

    /// A warning where a surface excites frequencies outside this measured range.
    pub fn extrapolation(&self, excited: Self) -> Option<String> {
        let side = match self.exceeded_by(excited) {
            [false, false] => return None,
            [true, false] => "below",
            [false, true] => "above",
            [true, true] => "below and above",
        };
        Some(format!(
            "the waves of the surface excite the rubber from {:.3e} to {:.3e} Hz, it was measured from {:.3e} to \
             {:.3e} Hz at this temperature: {side} that range the moduli are extrapolated",
            excited.lowest_hz, excited.highest_hz, self.lowest_hz, self.highest_hz
        ))
    }
}

fn extremes(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().fold(None, |found, value| match found {
        None => Some([value, value]),
        Some([least, most]) => Some([least.min(value), most.max(value)]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excited_frequencies_are_speeds_over_wavelengths() {
        let excited = FrequencyRange::excited([1e-3, 8e-3, 2e-3], [0.05, 0.01]).unwrap();
        assert_eq!(excited, FrequencyRange { lowest_hz: 1.25, highest_hz: 50.0 });
        assert_eq!(FrequencyRange::excited([], [1.0]), None);
    }

    #[test]
    fn only_what_lies_outside_is_warned_of() {
        let excited = FrequencyRange { lowest_hz: 1.0, highest_hz: 100.0 };
        let warning =
            |lowest_hz, highest_hz| FrequencyRange { lowest_hz, highest_hz }.extrapolation(excited);
        assert_eq!(warning(1.0, 100.0), None);
        assert_eq!(warning(1.0 + 1e-12, 100.0), None);
        assert!(warning(1.1, 100.0).unwrap().contains(": below that range"));
        assert!(warning(0.1, 99.0).unwrap().contains(": above that range"));
        assert!(warning(2.0, 50.0).unwrap().contains("below and above that range"));
        let shifted = FrequencyRange { lowest_hz: 1.0, highest_hz: 100.0 }.shifted(10.0);
        assert_eq!(shifted, FrequencyRange { lowest_hz: 0.1, highest_hz: 10.0 });
    }
}
