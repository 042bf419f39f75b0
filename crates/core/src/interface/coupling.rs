//! Contact of a half-space under shear, for any Poisson ratio.

use super::ShearError;
use super::law::positive;
use crate::contact::half_space::HalfSpace;
use crate::contact::{ContactError, ContactSolution, SlidingContact};
use crate::rubber::Viscoelastic;
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex64;

/// Most contacts that are solved.
const MOST_STEPS: usize = 60;
/// Change of friction between two steps, absolute over the sum of both frictions, below which it has settled.
const SETTLED: f64 = 1e-7;
/// Pressure over the pressure-weighted mean pressure below which the shear stress fades: points change sides at the edges of
/// contacts, and a stress that jumps with them has no fixed point.
const FADES: f64 = 0.1;

/// Friction with a shear stress in the contact area, and what the shear does to the contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearCoupling {
    /// Friction by the pressure on the slopes of the profile, `mean(t z') / p`, of the contact under shear.
    pub hysteretic: f64,
    /// The same without shear.
    pub hysteretic_alone: f64,
    /// Friction by the shear, `mean(τ) / p`.
    pub adhesive: f64,
    /// The same if the contact were that without shear.
    pub adhesive_alone: f64,
    /// Contact area fraction under shear, read at grid points.
    pub contact_area_fraction: f64,
    /// The same without shear.
    pub contact_area_fraction_alone: f64,
    /// Contacts that were solved.
    pub steps: usize,
}

/// Steady contact at a mean pressure in Pa with a constant shear stress τ_f in Pa wherever the surfaces touch; it fades to nothing
/// where the pressure is below a tenth of its pressure-weighted mean, at the edges of contacts.
///
/// Shear moves the surface of a half-space up or down unless ν = 1/2. With τ the shear stress against the motion,
///
/// ```text
/// ŵ(q) = 2/(|q| E_r(q v)) [t̂(q) + i β sgn(q) τ̂(q)],   β = (1 - 2ν) / (2 (1 - ν))
/// ```
///
/// (Johnson, Contact Mechanics, 1985, section 2.4; β is Dundurs' second constant against a rigid body). β is 0.0196 at
/// ν = 0.49. The motion by the shear is taken off the heights, and the contact is solved again until friction has settled to 1e-7.
/// `heights` in m on equidistant points of the `period` in m, `speed` in m/s.
///
/// # Errors
/// [`ShearError::OutOfRange`] for a negative shear stress, [`ShearError::Contact`],
/// [`ShearError::CouplingNotConverged`].
pub fn shear_coupling(
    rubber: &dyn Viscoelastic,
    speed: f64,
    period: f64,
    heights: &[f64],
    mean_pressure: f64,
    shear_stress: f64,
) -> Result<ShearCoupling, ShearError> {
    if shear_stress != 0.0 {
        positive("the shear stress in Pa", shear_stress)?;
    }
    let alone = SlidingContact::new(rubber, speed, period, heights)?.solve(mean_pressure)?;
    let mut planner = RealFftPlanner::new();
    let mut space = HalfSpace::new(&mut planner, rubber, speed, period, heights.len())
        .map_err(ContactError::from)?;
    let slopes = space.slope(heights);
    let nu = rubber.poisson_ratio();
    let beta = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
    let area = |solution: &ContactSolution| {
        solution.pressure.iter().filter(|t| **t > 0.0).count() as f64 / heights.len() as f64
    };
    let on_slopes = |solution: &ContactSolution| {
        let work: f64 = solution.pressure.iter().zip(&slopes).map(|(t, slope)| t * slope).sum();
        work / heights.len() as f64 / mean_pressure
    };
    let hysteretic_alone = on_slopes(&alone);
    let friction_of =
        |shear: &[f64]| shear.iter().sum::<f64>() / heights.len() as f64 / mean_pressure;
    let adhesive_alone = friction_of(&shear_of(&alone, shear_stress));
    let (mut solution, mut last, mut change) = (alone.clone(), f64::INFINITY, f64::INFINITY);
    for step in 1..=MOST_STEPS {
        let shear = shear_of(&solution, shear_stress);
        let moved = motion(&mut space, &mut planner, &shear, beta);
        let lowered: Vec<f64> = heights.iter().zip(&moved).map(|(z, w)| z - w).collect();
        solution = SlidingContact::new(rubber, speed, period, &lowered)?.solve(mean_pressure)?;
        let hysteretic = on_slopes(&solution);
        let adhesive = friction_of(&shear_of(&solution, shear_stress));
        let friction = hysteretic + adhesive;
        change = (friction - last).abs() / (hysteretic.abs() + adhesive).max(f64::MIN_POSITIVE);
        if change < SETTLED || beta == 0.0 || shear_stress == 0.0 {
            return Ok(ShearCoupling {
                hysteretic,
                hysteretic_alone,
                adhesive,
                adhesive_alone,
                contact_area_fraction: area(&solution),
                contact_area_fraction_alone: area(&alone),
                steps: step,
            });
        }
        last = friction;
    }
    Err(ShearError::CouplingNotConverged { steps: MOST_STEPS, change })
}

/// Shear stress in Pa at every point of a contact.
fn shear_of(solution: &ContactSolution, shear_stress: f64) -> Vec<f64> {
    let pressure = &solution.pressure;
    let square: f64 = pressure.iter().map(|t| t * t).sum();
    let fades = FADES * square / pressure.iter().sum::<f64>();
    pressure.iter().map(|t| shear_stress * (t / fades).clamp(0.0, 1.0)).collect()
}

/// Motion of the surface into the rubber in m by a shear stress against the motion: `i β sgn(q)` times what a pressure
/// of the same size does.
fn motion(
    space: &mut HalfSpace,
    planner: &mut RealFftPlanner<f64>,
    shear: &[f64],
    beta: f64,
) -> Vec<f64> {
    let n = shear.len();
    let mut pressed = vec![0.0; n];
    space.displacement(shear, &mut pressed);
    let (forward, backward) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut pressed, &mut spectrum).expect("buffers made for the transform");
    for x in &mut spectrum {
        *x *= Complex64::new(0.0, beta / n as f64);
    }
    // A real field has real mean, and a real highest wave on an even grid.
    spectrum[0] = Complex64::ZERO;
    if n.is_multiple_of(2) {
        spectrum[n / 2] = Complex64::ZERO;
    }
    let mut moved = backward.make_output_vec();
    backward.process(&mut spectrum, &mut moved).expect("buffers made for the transform");
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;
    use crate::surface::{Wave, wave};

    const PERIOD: f64 = 1e-3;
    const POINTS: usize = 1024;

    fn profile() -> Vec<f64> {
        let waves = [(1.0, 2e-5, 0.3), (4.0, 4e-6, 2.0)];
        let waves =
            waves.map(|(n, amplitude, phase)| Wave { wavelength: PERIOD / n, amplitude, phase });
        wave::sample(&waves, PERIOD, POINTS)
    }

    fn coupled(rubber: &Rubber, shear: f64) -> ShearCoupling {
        shear_coupling(rubber, 0.01, PERIOD, &profile(), 1e5, shear).unwrap()
    }

    #[test]
    fn an_incompressible_rubber_does_not_feel_the_shear() {
        let rubber = Rubber { poisson_ratio: 0.5, ..Rubber::table_2_1() };
        let with = coupled(&rubber, 3e6);
        assert_eq!(with.hysteretic, with.hysteretic_alone);
        assert_eq!(with.contact_area_fraction, with.contact_area_fraction_alone);
        assert_eq!(with.adhesive, with.adhesive_alone);
        // Nearly all of the contact carries the full stress.
        let full = 3e6 * with.contact_area_fraction / 1e5;
        assert!((0.9 * full..full).contains(&with.adhesive), "{with:?}");
    }

    /// Points ahead of a load Q along x move into the body by (1 - 2ν)(1 + ν) Q / (2 E), points behind it out of it:
    /// Maxwell and Betti, from the motion of the surface towards a load normal to it (Johnson 2.23a).
    #[test]
    fn the_surface_tilts_under_a_band_of_shear() {
        let (nu, modulus, shear) = (0.3, 5e6, 1e5);
        let rubber = Rubber::elastic(modulus, nu);
        let mut planner = RealFftPlanner::new();
        let points = 4096;
        let mut space = HalfSpace::new(&mut planner, &rubber, 0.01, PERIOD, points).unwrap();
        let band: Vec<f64> =
            (0..points).map(|i| if i < points / 4 { shear } else { 0.0 }).collect();
        let beta = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
        let moved = motion(&mut space, &mut planner, &band, beta);
        let slope = |from: usize, to: usize| {
            (moved[to] - moved[from]) / ((to - from) as f64 * PERIOD / points as f64)
        };
        let (within, outside) = (slope(256, 768), slope(1536, 3584));
        // The friction stress acts against x on the rubber: Q = -τ, hence the sign.
        let expected = -2.0 * (1.0 - 2.0 * nu) * (1.0 + nu) / (2.0 * modulus) * shear;
        approx::assert_relative_eq!(within - outside, expected, max_relative = 2e-3);
    }

    /// The table of `docs/total_friction.md`: five waves of Table 3.1 at 0.3 MPa under 5 MPa of shear.
    #[test]
    #[ignore = "prints a table; .ci/full"]
    fn what_the_sum_leaves_out() {
        use crate::surface::TABLE_3_1_MM;
        let phases = [0.3, 2.0, 4.4, 1.1, 5.2];
        let waves: Vec<Wave> = TABLE_3_1_MM[..5]
            .iter()
            .zip(phases)
            .map(|((length, amplitude), phase)| Wave {
                wavelength: 1e-3 * length,
                amplitude: 0.4e-3 * amplitude,
                phase,
            })
            .collect();
        let profile = wave::sample(&waves, 1e-3, 4096);
        for speed in [1e-3, 1e-2, 1e-1, 1.0] {
            let with =
                shear_coupling(&Rubber::table_2_1(), speed, 1e-3, &profile, 3e5, 5e6).unwrap();
            let sum = with.hysteretic_alone + with.adhesive_alone;
            let total = with.hysteretic + with.adhesive;
            println!("{speed:e} m/s: sum {sum:.5}, coupled {total:.5}, {with:?}");
            assert!((total / sum - 1.0).abs() < 0.05, "{with:?}");
        }
    }

    #[test]
    fn the_effect_grows_with_the_shear_and_is_that_of_one_percent() {
        let rubber = Rubber::table_2_1();
        let [small, large] = [1e5, 1e6].map(|shear| coupled(&rubber, shear));
        let change = |c: &ShearCoupling| c.hysteretic / c.hysteretic_alone - 1.0;
        assert!(change(&small).abs() < change(&large).abs(), "{small:?} {large:?}");
        let negative = shear_coupling(&rubber, 0.01, PERIOD, &profile(), 1e5, -1.0);
        assert!(matches!(negative, Err(ShearError::OutOfRange { .. })));
    }
}
