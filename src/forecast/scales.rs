//! Which model each scale of a surface gets, and why.

use crate::multiscale::scales::octaves;
use crate::rubber::{RubberModel, Viscoelastic};
use crate::stages::micro::{Micro, Parting};
use crate::surface::{SineScale, Wave};
use crate::units::Units;
use serde::Serialize;
use std::f64::consts::{PI, SQRT_2, TAU};

/// Model of a scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScaleModel {
    /// No amplitude: nothing is computed of it, and the period is not made for it.
    LeftOut,
    /// The half-space.
    HalfSpace,
    /// The half-space, corrected by finite elements.
    FiniteElements,
}

/// One wave of a surface at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScaleForecast {
    /// Wavelength in mm.
    pub wavelength_mm: f64,
    /// Amplitude in mm.
    pub amplitude_mm: f64,
    /// Root mean square slope.
    pub rms_slope: f64,
    /// Mean pressure of full contact with this wave alone, `π |E_r(q v)| D / λ`, in MPa.
    pub full_contact_mpa: f64,
    /// Mean pressure within the contacts at the largest wanted area over that: from 1 on the contacts
    /// follow the wave to its valleys.
    pub pressed_flat: f64,
    /// Model.
    pub model: ScaleModel,
    /// Why.
    pub reason: String,
}

/// The scales of a profile under the mean pressure in Pa and contact area fraction of `contact`.
pub(super) fn scales(
    rubber: &RubberModel,
    profile: &[Wave],
    speed: f64,
    contact: [f64; 2],
    threshold: Option<f64>,
) -> Vec<ScaleForecast> {
    let within = contact[0] / contact[1];
    let of_one = |wave: &Wave| {
        let modulus = rubber.reduced_modulus(TAU / wave.wavelength * speed).norm();
        let full = PI * modulus * wave.amplitude / wave.wavelength;
        let scale = SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude.abs() };
        let (model, reason) = choose(scale.rms_slope(), threshold);
        ScaleForecast {
            wavelength_mm: wave.wavelength.m_to_mm(),
            amplitude_mm: wave.amplitude.m_to_mm(),
            rms_slope: scale.rms_slope(),
            full_contact_mpa: full.pa_to_mpa(),
            pressed_flat: if full > 0.0 { within / full } else { 0.0 },
            model,
            reason,
        }
    };
    profile.iter().map(of_one).collect()
}

/// The octaves of windows with the models that the microscale gives them.
pub(super) fn parted(mut scales: Vec<ScaleForecast>, parting: Parting) -> Vec<ScaleForecast> {
    let Parting::Shorter(limit) = parting else { return scales };
    for scale in &mut scales {
        (scale.model, scale.reason) = if scale.wavelength_mm < limit.m_to_mm() {
            let reason =
                "one of the shortest octaves, which are the microscale (micro.rms_slope_threshold)";
            (ScaleModel::FiniteElements, reason.into())
        } else {
            (ScaleModel::HalfSpace, "an octave of the macro surface".into())
        };
    }
    scales
}

/// A sine for every octave of a profile, with the root mean square slope of the octave, in its middle: a profile has
/// thousands of waves.
pub(super) fn octaves_as_sines(profile: &[Wave]) -> Vec<Wave> {
    let present = profile.iter().filter(|wave| wave.amplitude != 0.0);
    let shortest = present.map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
    let sine = |(octave, square): (i32, f64)| {
        let wavelength = shortest * 2.0_f64.powi(octave) * SQRT_2;
        Wave { wavelength, amplitude: (2.0 * square).sqrt() * wavelength / TAU, phase: 0.0 }
    };
    (0..).zip(octaves([profile].into_iter(), shortest)).map(sine).collect()
}

fn choose(slope: f64, threshold: Option<f64>) -> (ScaleModel, String) {
    match threshold {
        _ if slope == 0.0 => (ScaleModel::LeftOut, "zero amplitude in the fit".into()),
        Some(threshold) if slope > threshold => {
            let reason = format!("steeper than {threshold} (micro.rms_slope_threshold)");
            (ScaleModel::FiniteElements, reason)
        }
        Some(threshold) => (ScaleModel::HalfSpace, format!("slope up to {threshold}")),
        None => {
            let usual = Micro::default().rms_slope_threshold;
            let reason = if slope > usual {
                format!("steeper than {usual}, but the recipe has no [micro]")
            } else {
                "no [micro]".into()
            };
            (ScaleModel::HalfSpace, reason)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steep_scales_get_finite_elements_and_absent_ones_nothing() {
        let wave = |wavelength, amplitude| Wave { wavelength, amplitude, phase: 0.0 };
        // Slopes 1.33, 0.94 and none.
        let profile = [wave(6.25e-5, 1.867e-5), wave(1.25e-4, 2.648e-5), wave(2.5e-4, 0.0)];
        let rubber = RubberModel::from(crate::rubber::Rubber::elastic(3e6, 0.5));
        let scales = scales(&rubber, &profile, 0.01, [1e5, 0.1], Some(1.0));
        let models: Vec<ScaleModel> = scales.iter().map(|scale| scale.model).collect();
        assert_eq!(
            models,
            [ScaleModel::FiniteElements, ScaleModel::HalfSpace, ScaleModel::LeftOut]
        );
        // p* = pi E_r D / lambda with E_r = 4 MPa; 1 MPa within the contacts.
        approx::assert_relative_eq!(scales[0].full_contact_mpa, 3.7538, max_relative = 1e-4);
        approx::assert_relative_eq!(scales[0].pressed_flat, 1.0 / 3.7538, max_relative = 1e-4);
        let without = super::scales(&rubber, &profile, 0.01, [1e5, 0.1], None);
        assert_eq!(without[0].model, ScaleModel::HalfSpace);
        assert!(without[0].reason.contains("no [micro]"));
    }
}
