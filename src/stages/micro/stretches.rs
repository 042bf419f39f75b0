//! The microscale of surfaces: steep sines by themselves, and of windows of the scans the shortest octaves, in stretches
//! that are solved one by one.
//!
//! A window has some hundred of its shortest waves, too many for a mesh, and no two stretches of them are alike. So the
//! microscale is solved on several stretches, each made periodic, and what they differ by is the statistical error of the
//! local law. Stretches are taken where the macro surface is highest: rubber meets a road on its tops, which are worn
//! smoother than the rest.

use super::Micro;
use crate::multiscale::scales::{Scales, longest_micro, octaves};
use crate::stages::StageError;
use crate::stages::realise::{Surface, SurfaceKind};
use crate::surface::{Closure, LineScan, PeriodicProfile, Wave, wave};

/// Points of the heights of the microscale on its shortest wave, from which stretches are cut.
const POINTS_PER_WAVE: f64 = 16.0;
/// A stretch loses this share of its length where its ends pass into each other.
const BLENDED: f64 = 0.05;

/// How the surfaces of one kind are divided into microscale and macro surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Parting {
    /// Waves that are steeper than a threshold by themselves are the microscale.
    Steep(f64),
    /// Waves that are shorter than so many metres are.
    Shorter(f64),
}

impl Parting {
    /// How the surfaces of a kind are divided: all of them alike.
    pub fn of(surfaces: &[Surface], threshold: f64) -> Self {
        let of_windows = surfaces.iter().any(|surface| surface.kind.method.of_a_window());
        if !of_windows {
            return Self::Steep(threshold);
        }
        let profiles = surfaces.iter().map(|surface| &surface.profile[..]);
        Self::Shorter(longest_micro(profiles, threshold).unwrap_or(0.0))
    }

    /// The scales of a surface.
    pub fn scales(self, profile: &[Wave]) -> Scales {
        match self {
            Self::Steep(threshold) => Scales::part(profile, threshold),
            Self::Shorter(wavelength) => Scales::at(profile, wavelength),
        }
    }
}

/// The surfaces by their kinds, each with how they are divided.
pub(crate) fn partings(
    surfaces: &[Surface],
    threshold: f64,
) -> impl Iterator<Item = (&[Surface], Parting)> {
    let of_one_kind = surfaces.chunk_by(|a, b| a.kind == b.kind);
    of_one_kind.map(move |own| (own, Parting::of(own, threshold)))
}

/// Root mean square slope of the steepest octave that surfaces of windows leave to the half-space, in their mean.
pub(crate) fn steepest_octave_left(surfaces: &[Surface], parting: Parting) -> f64 {
    let left: Vec<Vec<Wave>> =
        surfaces.iter().map(|surface| parting.scales(&surface.profile).macroscale).collect();
    let waves = left.iter().flatten().map(|wave| wave.wavelength);
    let shortest = waves.fold(f64::INFINITY, f64::min);
    let octaves = octaves(left.iter().map(Vec::as_slice), shortest);
    octaves.into_iter().fold(0.0, f64::max).sqrt()
}

/// A stretch of the microscale of a surface, made periodic.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stretch {
    /// Its number, from 1.
    pub number: u32,
    /// Its waves by ascending wavelength.
    pub waves: Vec<Wave>,
    /// Its period in m.
    pub period: f64,
}

/// The stretches of the microscale of surfaces of one kind, whose microscale is shorter than `limit` metres: as many as
/// the parameters say, from surfaces spread over all of them.
///
/// # Errors
/// [`StageError::NoMacroscale`], [`StageError::Periodic`].
pub(crate) fn stretches(
    parameters: &Micro,
    surfaces: &[Surface],
    limit: f64,
) -> Result<Vec<Stretch>, StageError> {
    let wanted = parameters.stretches as usize;
    let length = f64::from(parameters.stretch_length) * limit;
    let count = surfaces.len();
    let mut taken: Vec<Vec<f64>> = vec![Vec::new(); count];
    let mut found = Vec::with_capacity(wanted);
    for k in 0..wanted {
        let index = if wanted < count { k * count / wanted } else { k % count };
        let surface = &surfaces[index];
        let scales = Scales::at(&surface.profile, limit);
        if scales.macroscale.is_empty() {
            let threshold = parameters.rms_slope_threshold;
            return Err(StageError::NoMacroscale { kind: surface.kind, threshold });
        }
        let Some(place) = highest(surface, &scales.macroscale, length, &taken[index]) else {
            break;
        };
        taken[index].push(place);
        let (waves, period) = cut(surface.kind, &scales.micro, surface.period(), place, length)?;
        let waves: Vec<Wave> =
            waves.into_iter().filter(|w| w.wavelength < limit && w.amplitude > 0.0).collect();
        found.push(Stretch { number: k as u32 + 1, waves, period });
    }
    Ok(found)
}

/// Where in m the macro surface is highest at least `length` from where stretches were taken before, and from their
/// mirror images, which a mirrored window has a second time; `None` if there is no room left.
fn highest(surface: &Surface, macroscale: &[Wave], length: f64, taken: &[f64]) -> Option<f64> {
    let period = surface.period();
    let shortest = macroscale.iter().map(|wave| wave.wavelength).fold(period, f64::min);
    let points = ((POINTS_PER_WAVE * period / shortest).round() as usize).next_power_of_two();
    let heights = wave::sample(macroscale, period, points);
    let place = |i: usize| i as f64 * period / points as f64;
    let apart = |a: f64, b: f64| {
        let way = (a - b).rem_euclid(period);
        way.min(period - way)
    };
    let free = |i: &usize| {
        let x = place(*i);
        taken.iter().all(|other| apart(x, *other) >= length && apart(-x, *other) >= length)
    };
    let highest = (0..points).filter(free).max_by(|a, b| heights[*a].total_cmp(&heights[*b]))?;
    Some(place(highest))
}

/// The waves and the period of a stretch of `length` metres about a place.
fn cut(
    kind: SurfaceKind,
    micro: &[Wave],
    period: f64,
    place: f64,
    length: f64,
) -> Result<(Vec<Wave>, f64), StageError> {
    let shortest = micro.iter().map(|wave| wave.wavelength).fold(period, f64::min);
    let points = ((POINTS_PER_WAVE * period / shortest).round() as usize).next_power_of_two();
    let heights = wave::sample(micro, period, points);
    let spacing = period / points as f64;
    let count = (length / (1.0 - BLENDED) / spacing).round() as usize;
    let first = (place / spacing).round() as usize + points - count.min(points) / 2;
    let window = LineScan {
        name: kind.to_string(),
        origin: 0.0,
        spacing,
        heights: (0..count).map(|i| heights[(first + i) % points]).collect(),
    };
    let stretch = PeriodicProfile::new(&window, Closure::Blend, shortest, 0.0)?;
    Ok((stretch.waves, stretch.period))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::Method;
    use crate::surface::SineScale;
    use crate::surface::realisation::random_phases;

    /// A self-affine profile of 24 mm: amplitudes with the wavelength, a slope of 0.35 in every octave of ten waves.
    fn surfaces(count: u32) -> Vec<Surface> {
        let scale = |k: u32| {
            let wavelength = 24e-3 / f64::from(k);
            SineScale { wavelength, amplitude: 0.02 * wavelength / f64::from(k).sqrt() * 4.0 }
        };
        let scales: Vec<SineScale> = (1..=384).rev().map(scale).collect();
        let surface = |realisation: u32| Surface {
            kind: SurfaceKind::of(Method::Measured),
            realisation,
            profile: random_phases(&scales, 1, u64::from(realisation)),
        };
        (1..=count).map(surface).collect()
    }

    #[test]
    fn stretches_have_the_slope_of_the_microscale_and_differ() {
        let surfaces = surfaces(3);
        let slope = |waves: &[Wave]| crate::stages::realise::rms_slope(waves);
        let threshold = 0.8 * slope(&surfaces[0].profile);
        let Parting::Shorter(limit) = Parting::of(&surfaces, threshold) else { panic!() };
        let scales = Scales::at(&surfaces[0].profile, limit);
        let (gentle, steep) = (slope(&scales.macroscale), slope(&scales.micro));
        assert!(gentle <= threshold || steep > threshold, "{gentle} {steep}");
        let parameters = Micro { stretches: 6, stretch_length: 4, ..Micro::default() };
        let found = stretches(&parameters, &surfaces, limit).unwrap();
        assert_eq!(found.len(), 6);
        let squares = found.iter().map(|stretch| slope(&stretch.waves).powi(2));
        let rms = (squares.sum::<f64>() / 6.0).sqrt();
        assert!((rms / slope(&scales.micro) - 1.0).abs() < 0.3, "{rms}");
        for (i, a) in found.iter().enumerate() {
            assert!(
                a.waves.iter().all(|w| w.wavelength < limit && w.wavelength > 0.99 * 24e-3 / 384.0)
            );
            assert!((a.period / (4.0 * limit) - 1.0).abs() < 0.02, "{}", a.period);
            assert!(found[..i].iter().all(|b| b.waves != a.waves));
        }
        let left = steepest_octave_left(&surfaces, Parting::Shorter(limit));
        assert!(left > 0.0 && left < slope(&scales.macroscale));
    }

    #[test]
    fn a_gentle_profile_has_no_microscale() {
        let surfaces = surfaces(1);
        let parting = Parting::of(&surfaces, 100.0);
        assert!(parting.scales(&surfaces[0].profile).micro.is_empty());
    }
}
