//! The viscoelastic half-space: friction over the grid points on the period.

use super::{Case, Failure, Method, Prepared, Reference};
use asperity::contact::SlidingContact;
use asperity::rubber::Rubber;
use asperity::surface::{TABLE_3_1_MM, Wave, wave};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Wavelength and amplitude in mm of the ninth wave, thesis Table 3.2.
const NINTH_MM: (f64, f64) = (16.0, 0.21994);
/// Sliding speed in m/s of every case.
pub(super) const SPEED: f64 = 0.01;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "half-space-1-wave",
        problem: "half-space, 1 wave of Table 3.1 (0.0625 mm), 1 MPa, 10 mm/s: friction",
        reference_text: "131072 points",
        reference: Reference::OverResolved { prepare: one_wave, value: 1 << 17, quick: 512 },
        methods: &[Method {
            name: "half-space, 1 wave",
            knob: POINTS,
            values: &[32, 64, 128, 256, 512, 1024, 2048, 4096],
            prepare: one_wave,
        }],
    },
    Case {
        name: "half-space-3-waves",
        problem: "half-space, 3 waves of Table 3.1 (0.0625 to 0.25 mm), 0.5 MPa, 10 mm/s: friction",
        reference_text: "262144 points",
        reference: Reference::OverResolved { prepare: three_waves, value: 1 << 18, quick: 1024 },
        methods: &[Method {
            name: "half-space, 3 waves",
            knob: POINTS,
            values: &[32, 64, 128, 256, 512, 1024, 2048, 4096, 8192],
            prepare: three_waves,
        }],
    },
    Case {
        name: "half-space-8-waves",
        problem: "half-space, 8 waves of Table 3.1 (0.0625 to 8 mm), 0.3 MPa, 10 mm/s: friction",
        reference_text: "524288 points",
        reference: Reference::OverResolved { prepare: eight_waves, value: 1 << 19, quick: 4096 },
        methods: &[Method {
            name: "half-space, 8 waves",
            knob: POINTS,
            values: &[512, 1024, 2048, 4096, 8192, 16384, 32768, 65536],
            prepare: eight_waves,
        }],
    },
];

const POINTS: &str = "points";

fn one_wave(points: u32) -> Result<Prepared, Failure> {
    Ok(friction(surface(1), points, 1e6))
}

fn three_waves(points: u32) -> Result<Prepared, Failure> {
    Ok(friction(surface(3), points, 5e5))
}

fn eight_waves(points: u32) -> Result<Prepared, Failure> {
    Ok(friction(surface(8), points, 3e5))
}

/// Heights, grids, operators and one solve at a pressure in Pa.
fn friction(waves: Vec<Wave>, points: u32, pressure: f64) -> Prepared {
    let rubber = Rubber::table_2_1();
    Box::new(move || {
        let mut contact = contact(&rubber, &waves, points)?;
        Ok(vec![contact.solve(pressure)?.friction_coefficient])
    })
}

/// The contact with some waves on a grid over the longest one.
pub(super) fn contact(
    rubber: &Rubber,
    waves: &[Wave],
    points: u32,
) -> Result<SlidingContact, Failure> {
    let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let heights = wave::sample(waves, period, points as usize);
    Ok(SlidingContact::new(rubber, SPEED, period, &heights)?)
}

/// The shortest waves, 1 to 9 of them, with phases that are drawn once and for all.
pub(super) fn surface(waves: usize) -> Vec<Wave> {
    let mut generator = Pcg64::seed_from_u64(1);
    TABLE_3_1_MM
        .iter()
        .chain([&NINTH_MM])
        .take(waves)
        .map(|(wavelength, amplitude)| Wave {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
            phase: TAU * generator.random::<f64>(),
        })
        .collect()
}
