//! What the stage reads of the microscales: samples and laws of each surface, speed and stretch.

use super::{Hybrid, RepulsiveLaw};
use crate::multiscale::correction::Microscale;
use crate::multiscale::{LawEnd, LocalLaw};
use crate::stages::SolveError;
use crate::stages::bem::CurveRow;
use crate::stages::micro::{LawRow, SampleRow, between_samples, law_of};
use crate::stages::realise::{Surface, SurfaceKind};
use crate::units::Units;

/// What all curves read.
pub(super) struct Data {
    pub curves: Vec<CurveRow>,
    pub samples: Vec<SampleRow>,
    pub laws: Vec<LawRow>,
}

/// One microscale at one speed: samples, one or more, and law.
pub(super) struct Sampled<'a> {
    pub samples: Vec<&'a SampleRow>,
    laws: Vec<LawRow>,
}

impl Data {
    /// Numbers of the stretches of a surface at a speed that have samples; 0 is the microscale of sines.
    pub fn stretches(&self, surface: &Surface, speed_mm_s: f64) -> Vec<u32> {
        let own = |row: &&SampleRow| {
            is_sampled(surface, speed_mm_s, (row.kind, row.realisation, row.speed_mm_s))
        };
        let mut numbers: Vec<u32> =
            self.samples.iter().filter(own).map(|row| row.stretch).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    pub fn of(&self, surface: &Surface, speed_mm_s: f64, stretch: u32) -> Sampled<'_> {
        let sample = |row: &&SampleRow| {
            row.stretch == stretch
                && is_sampled(surface, speed_mm_s, (row.kind, row.realisation, row.speed_mm_s))
        };
        let law = |row: &&LawRow| {
            row.stretch == stretch
                && is_sampled(surface, speed_mm_s, (row.kind, row.realisation, row.speed_mm_s))
        };
        Sampled {
            samples: self.samples.iter().filter(sample).collect(),
            laws: self.laws.iter().filter(law).cloned().collect(),
        }
    }
}

/// Whether a row of a kind, realisation and speed is of the microscale of a surface at a speed.
fn is_sampled(surface: &Surface, speed_mm_s: f64, row: (SurfaceKind, u32, f64)) -> bool {
    let (kind, realisation, speed) = row;
    kind == surface.kind && [0, surface.realisation].contains(&realisation) && speed == speed_mm_s
}

/// Friction of a microscale between its samples, the law that its macro surface meets and the pressure in Pa of its
/// full contact on the half-space.
pub(super) fn microscale(
    parameters: &Hybrid,
    own: &Sampled,
) -> Result<(Microscale, LocalLaw, f64), SolveError> {
    let Sampled { samples, laws: rows } = own;
    let column = |value: fn(&SampleRow) -> f64| samples.iter().map(|row| value(row)).collect();
    let pressures: Vec<f64> = column(|row| row.pressure_mpa.mpa_to_pa());
    let law = match parameters.law {
        RepulsiveLaw::HalfSpace => law_of(rows)?,
        RepulsiveLaw::FiniteDeformation => {
            let separations: Vec<f64> =
                column(|row| row.separation_finite_deformation_mm.mm_to_m());
            let falling = 1 + separations.windows(2).take_while(|pair| pair[1] < pair[0]).count();
            let touch = rows.first().map_or(0.0, |row| row.touch_separation_m);
            let end = LawEnd::PartialContact;
            LocalLaw::new(touch, &pressures[..falling], &separations[..falling], end)?
        }
    };
    let microscale = between_samples(samples);
    let full_contact = rows.iter().map(|row| row.pressure_pa).fold(0.0, f64::max);
    Ok((microscale, law, full_contact))
}
