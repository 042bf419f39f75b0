//! Which waves of a profile are the microscale.

use crate::surface::{SineScale, Wave};

/// A profile divided into two scales.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// Waves with a root mean square slope above the threshold.
    pub micro: Vec<Wave>,
    /// The others.
    pub macroscale: Vec<Wave>,
}

/// Root mean square slope of one wave.
fn rms_slope(wave: &Wave) -> f64 {
    SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude.abs() }.rms_slope()
}

impl Scales {
    /// Divides the waves at an rms slope. The phase of a single micro wave does not matter: it is set to zero, so that
    /// all realisations share it.
    pub fn part(waves: &[Wave], threshold: f64) -> Self {
        let present = waves.iter().filter(|wave| wave.amplitude != 0.0);
        let (mut micro, macroscale): (Vec<Wave>, Vec<Wave>) =
            present.copied().partition(|wave| rms_slope(wave) > threshold);
        if let [only] = micro.as_mut_slice() {
            only.phase = 0.0;
        }
        Self { micro, macroscale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::TABLE_3_1_MM;

    #[test]
    fn steep_waves_are_the_microscale() {
        let wave = |wavelength, amplitude, phase| Wave { wavelength, amplitude, phase };
        let [first, second, third, (fourth, _), ..] = TABLE_3_1_MM;
        let waves = [
            wave(first.0, first.1, 1.0),
            wave(second.0, second.1, 2.0),
            wave(third.0, third.1, 3.0),
            wave(fourth, 0.0, 4.0),
        ];
        // Slopes of Table 3.1; the second is 0.1 % below what its amplitude gives.
        for (wave, published) in waves.iter().zip([1.3275, 0.9403, 0.5223]) {
            approx::assert_relative_eq!(rms_slope(wave), published, max_relative = 1e-3);
        }
        let one = Scales::part(&waves, 1.0);
        assert_eq!((one.micro[0].phase, one.micro.len(), one.macroscale.len()), (0.0, 1, 2));
        let two = Scales::part(&waves, 0.9);
        assert_eq!((two.micro[0].phase, two.micro.len()), (1.0, 2));
        assert!(Scales::part(&waves, 2.0).micro.is_empty());
    }
}
