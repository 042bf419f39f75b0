//! Which waves of a profile are the microscale.
//!
//! Of few sines, an octave apart, it is those that are steep by themselves. A measured profile has waves of all lengths:
//! of it the microscale is the shortest octaves, as few as leave the macro surface gentle.

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

    /// Divides the waves at a wavelength: the microscale is what is shorter.
    pub fn at(waves: &[Wave], wavelength: f64) -> Self {
        let present = waves.iter().filter(|wave| wave.amplitude != 0.0);
        let (micro, macroscale) = present.partition(|wave| wave.wavelength < wavelength);
        Self { micro, macroscale }
    }
}

/// Mean square slope of every octave of profiles, from the shortest wavelength on: those of `[shortest, 2 shortest)`,
/// `[2 shortest, 4 shortest)` and so on, the mean over the profiles.
pub fn octaves<'a>(profiles: impl Iterator<Item = &'a [Wave]> + Clone, shortest: f64) -> Vec<f64> {
    let (mut octaves, mut count) = (Vec::new(), 0.0);
    for waves in profiles {
        count += 1.0;
        for wave in waves.iter().filter(|wave| wave.amplitude != 0.0) {
            // A wave at the limit belongs to the longer octave, whatever its round-off.
            let octave = (wave.wavelength / shortest * (1.0 + ROUND_OFF)).log2().floor().max(0.0);
            let octave = octave as usize;
            if octaves.len() <= octave {
                octaves.resize(octave + 1, 0.0);
            }
            octaves[octave] += rms_slope(wave).powi(2);
        }
    }
    octaves.iter_mut().for_each(|octave| *octave /= count);
    octaves
}

/// The wavelength below which the waves are the microscale: as few of the shortest octaves of the profiles as together
/// have a root mean square slope above `threshold`, or leave the macro surfaces none above it, in the mean over the
/// profiles. `None` if all waves together are that gentle.
///
/// The first limit keeps the microscale to what a mesh can hold: a road of steep long waves, such as the flanks of its
/// stones, would all be microscale by the second.
pub fn longest_micro<'a>(
    profiles: impl Iterator<Item = &'a [Wave]> + Clone,
    threshold: f64,
) -> Option<f64> {
    let shortest = profiles.clone().flatten().filter(|wave| wave.amplitude != 0.0);
    let shortest = shortest.map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
    let octaves = octaves(profiles, shortest);
    let rest = |from: usize| octaves[from..].iter().sum::<f64>().sqrt();
    let short = |to: usize| octaves[..to].iter().sum::<f64>().sqrt();
    let enough = |count: &usize| rest(*count) <= threshold || short(*count) > threshold;
    let micro = (0..=octaves.len()).find(enough)?;
    // Slightly less, so that a wave at the limit is one of the macro surface.
    (micro > 0).then(|| shortest * 2.0_f64.powi(micro as i32) * (1.0 - ROUND_OFF))
}

/// The same tolerance of wavelengths as elsewhere.
const ROUND_OFF: f64 = 1e-9;

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

    #[test]
    fn as_few_octaves_as_leave_the_macro_surface_gentle() {
        // Slopes of 0.6 in each of three octaves, of two waves each.
        let wave = |wavelength: f64| {
            let amplitude = 0.6 * wavelength / std::f64::consts::TAU;
            Wave { wavelength, amplitude, phase: 0.1 }
        };
        let waves: Vec<Wave> = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0].map(|mm| wave(1e-3 * mm)).into();
        let profiles = || [&waves[..], &waves[..]].into_iter();
        let found = octaves(profiles(), 1e-3);
        assert_eq!(found.len(), 3);
        found.iter().for_each(|octave| approx::assert_relative_eq!(*octave, 0.36));
        assert_eq!(longest_micro(profiles(), 1.1), None);
        // Slopes of 0.6, 0.85 and 1.04 from the shortest octave on, and as many the other way.
        for (threshold, micro) in [(1.0, 2), (0.8, 4), (0.5, 2)] {
            let limit = longest_micro(profiles(), threshold).unwrap();
            let scales = Scales::at(&waves, limit);
            assert_eq!((scales.micro.len(), scales.macroscale.len()), (micro, 6 - micro));
        }
    }
}
