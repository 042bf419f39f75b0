//! The theory for isotropic surfaces against exact cases and independent quadratures.

use super::*;
use crate::rubber::{MaxwellBranch, Rubber, RubberError};
use crate::surface::SineScale;
use crate::surface::spectrum::IsotropicError;
use crate::theory::Persson;
use approx::assert_relative_eq;
use rustfft::num_complex::Complex64;
use statrs::function::erf::erf;
use statrs::function::gamma::gamma;
use std::f64::consts::{FRAC_PI_2, PI};

const SPEED: f64 = 0.1;
const PRESSURE: f64 = 2e5;

fn rubber() -> Rubber {
    Rubber {
        name: "two branches".into(),
        equilibrium_modulus: 4e6,
        branches: vec![
            MaxwellBranch { modulus: 8e6, relaxation_time: 1e-3 },
            MaxwellBranch { modulus: 2e8, relaxation_time: 1e-5 },
        ],
        poisson_ratio: 0.49,
        finite_strain: Default::default(),
    }
}

/// A surface with a roll-off, a slope and a steeper end.
fn surface() -> IsotropicSpectrum {
    let end = 2e-14 * 50_f64.powf(-3.6);
    let densities = vec![4e-14, 2e-14, end, end * 4_f64.powf(-3.0)];
    IsotropicSpectrum::new(vec![3e2, 1e3, 5e4, 2e5], densities).unwrap()
}

/// `C = scale (q / from)^-(2 + 2 H)`.
fn self_affine(scale: f64, hurst: f64, [from, to]: [f64; 2]) -> IsotropicSpectrum {
    let end = scale * (to / from).powf(-2.0 - 2.0 * hurst);
    IsotropicSpectrum::new(vec![from, to], vec![scale, end]).unwrap()
}

fn options(gamma: f64, diffusion: Diffusion) -> PerssonOptions {
    PerssonOptions { gamma, diffusion, tolerance: 1e-8 }
}

fn predict(
    surface: &IsotropicSpectrum,
    rubber: &dyn Viscoelastic,
    options: PerssonOptions,
    [speed, pressure]: [f64; 2],
) -> IsotropicPrediction {
    let theory = IsotropicPersson::new(surface, rubber, surface.band(), options).unwrap();
    theory.at(speed, pressure).unwrap()
}

/// Figures of a prototype in numpy: trapezoids over 40001 wavenumbers, extrapolated from half as many, and the midpoint
/// rule over 4096 angles.
#[test]
fn an_independent_quadrature_has_the_same_friction_and_area() {
    for (speed, pressure, gamma, friction, area) in [
        (0.001, 2.0e+05, 0.5, 0.085_846_084_4, 0.033_941_552_4),
        (0.1, 2.0e+05, 0.5, 0.795_651_113_6, 0.007_332_906_7),
        (1.0, 2.0e+05, 1.0, 2.126_604_991_2, 0.001_384_271_2),
        (0.1, 5.0e+06, 0.5, 0.831_533_882_3, 0.181_724_938_1),
    ] {
        let at = predict(&surface(), &rubber(), options(gamma, Diffusion::Full), [speed, pressure]);
        // The prototype moved by a few 1e-8 when its wavenumbers were doubled last.
        assert_relative_eq!(at.friction_coefficient, friction, max_relative = 1e-7);
        assert_relative_eq!(at.contact_area_fraction, area, max_relative = 1e-7);
    }
}

#[test]
fn at_large_pressure_it_is_full_contact() {
    // One branch has the mean over the angle in closed form; q³ C is constant for H = 1/2.
    let (branch, time, scale) = (2e8, 1e-5, 1e-13);
    let rubber = Rubber {
        name: "one branch".into(),
        equilibrium_modulus: 4e6,
        branches: vec![MaxwellBranch { modulus: branch, relaxation_time: time }],
        poisson_ratio: 0.5,
        finite_strain: Default::default(),
    };
    let band = [1e3, 1e5];
    let surface = self_affine(scale, 0.5, band);
    let pressure = 1e10;
    for diffusion in [Diffusion::Full, Diffusion::Reduced] {
        let at = predict(&surface, &rubber, options(0.5, diffusion), [SPEED, pressure]);
        // <cos φ Im E> = E_1 (1 - 1/sqrt(1 + x²)) / x with x = q v τ; over q its integral is that of
        // 1/x - 1/(x sqrt(1 + x²)), ln x + asinh(1/x).
        let [from, to] = band.map(|q| q * SPEED * time);
        let integral = |x: f64| x.ln() + (1.0 / x).asinh();
        let loss = branch / 0.75 * (integral(to) - integral(from)) / (SPEED * time);
        let friction = PI / pressure * scale * band[0].powi(3) * loss;
        assert_relative_eq!(at.friction_coefficient, friction, max_relative = 1e-9);
        assert_relative_eq!(at.full_contact_friction, friction, max_relative = 1e-9);
        assert_eq!((at.contact_area_fraction, at.mean_gap), (1.0, 0.0));
    }
}

/// A rubber with a modulus that does not depend on frequency.
struct Constant(Complex64);

impl Viscoelastic for Constant {
    fn name(&self) -> &'static str {
        "constant"
    }

    fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        Complex64::new(self.0.re, self.0.im.copysign(angular_frequency))
    }

    fn poisson_ratio(&self) -> f64 {
        0.5
    }

    fn validate(&self) -> Result<(), RubberError> {
        Ok(())
    }
}

/// The ring of a sine's mean square height is that sine with the angular means for its modulus: `|E|` as it is and
/// `<cos φ> = 2/π` of the loss.
#[test]
fn a_narrow_ring_is_a_sine_of_the_line_theory() {
    let (wavelength, amplitude) = (1e-3, 2e-5);
    let wavenumber = TAU / wavelength;
    let width = 1e-4;
    let ends = [wavenumber * (1.0 - width), wavenumber * (1.0 + width)];
    // 2 π q C dq = D² / 2.
    let density = amplitude * amplitude / 2.0 / (TAU * wavenumber * (ends[1] - ends[0]));
    let ring = IsotropicSpectrum::new(ends.to_vec(), vec![density; 2]).unwrap();
    let plane = Complex64::new(3e6, 4e6);
    let loss: f64 = 4e6 * 2.0 / PI;
    let line = Constant(Complex64::new((5e6_f64.powi(2) - loss * loss).sqrt(), loss));
    for gamma in [0.3, 1.0] {
        let sine = Persson::new(&[SineScale { wavelength, amplitude }], &line, SPEED, gamma);
        let sine = sine.unwrap();
        for share in [1e-4, 1e-2, 0.3, 1.0, 20.0] {
            let pressure = share * sine.pressure_variance().sqrt();
            let setting = options(gamma, Diffusion::Full);
            let at = predict(&ring, &Constant(plane), setting, [SPEED, pressure]);
            let area = sine.contact_area_fraction(pressure);
            // q² varies by the square of the width over the ring.
            assert_relative_eq!(at.contact_area_fraction, area, max_relative = 1e-6);
            let friction = sine.friction_coefficient(pressure);
            assert_relative_eq!(at.friction_coefficient, friction, max_relative = 1e-6);
        }
    }
}

/// The line across an isotropic surface has half its pressure variance with one modulus, whatever the spectrum.
#[test]
fn the_plane_has_twice_the_pressure_variance_of_its_line() {
    let rubber = Rubber::elastic(3e6, 0.5);
    for hurst in [0.5_f64, 0.8, 1.0] {
        let surface = self_affine(1e-13, hurst, [1e3, 1e5]);
        let at = predict(&surface, &rubber, PerssonOptions::default(), [SPEED, PRESSURE]);
        // The line density of a power law with ends, C1 = 4 ∫ C k dk / sqrt(k² - q²), k = sqrt(q² + s²).
        let line = |q: f64| {
            let from = (1e6 - q * q).max(0.0).sqrt();
            let to = (1e10 - q * q).sqrt();
            midpoint(20_000, [from, to], |s| surface.density(q.hypot(s))) * 4.0
        };
        // Its slope, of which the plane has twice the mean square: V = E_r² <slope²> / 4.
        let slope = midpoint(2_000, [0.0, 1e5], |q| q * q * line(q));
        let variance = 16e12 * slope / 4.0;
        let ratio = at.full_contact_pressure.powi(2) / variance;
        // The midpoint rules, whose own error is of this order.
        assert_relative_eq!(ratio, 2.0, max_relative = 2e-3);
    }
}

/// Per frequency, the friction of full contact of a plane over that of a line across it is
/// `Γ(H) Γ(H + 1) / Γ(H + 1/2)²`, so all of it is where the surface goes beyond the frequencies that are lossy.
#[test]
fn the_plane_has_the_gamma_ratio_of_the_friction_of_its_line() {
    let time = 1e-5;
    let rubber = Rubber {
        name: "one branch".into(),
        equilibrium_modulus: 4e6,
        branches: vec![MaxwellBranch { modulus: 2e8, relaxation_time: time }],
        poisson_ratio: 0.5,
        finite_strain: Default::default(),
    };
    let closed = |hurst: f64| gamma(hurst) * gamma(hurst + 1.0) / gamma(hurst + 0.5).powi(2);
    for (hurst, expected) in [(0.5, FRAC_PI_2), (0.65, 1.431_8), (0.8, 1.346_3), (1.0, 4.0 / PI)] {
        assert_relative_eq!(closed(hurst), expected, max_relative = 5e-5);
    }
    // Friction of H = 1/2 has no end towards short waves.
    for (hurst, tolerance) in [(0.65, 3e-3), (0.8, 1e-4), (1.0, 1e-4)] {
        let ratio = closed(hurst);
        // Loss at q v τ = 1, which is q = 1e6; decades of waves on either side.
        let (scale, from, to) = (1e-20, 1e1, 1e16);
        let surface = self_affine(scale, hurst, [from, to]);
        let at = predict(&surface, &rubber, PerssonOptions::default(), [SPEED, 1e15]);
        // One-sided density of a line without ends, sine by sine: D² / 2 = C1 dq.
        let factor = 4.0 * PI.sqrt() * gamma(hurst + 0.5) / (2.0 * gamma(hurst + 1.0));
        let line = |q: f64| factor * q * surface.density(q);
        let count = 4000;
        let step = (to / from).ln() / f64::from(count);
        let waves: Vec<SineScale> = (0..count)
            .map(|k| {
                let q = from * ((f64::from(k) + 0.5) * step).exp();
                SineScale { wavelength: TAU / q, amplitude: (2.0 * line(q) * q * step).sqrt() }
            })
            .collect();
        let line = Persson::new(&waves, &rubber, SPEED, 0.5).unwrap().friction_coefficient(1e15);
        // What lies beyond the ends: the power 3 - 2 H of 1e-5 below, 2 H - 1 of 1e-10 above.
        assert_relative_eq!(at.friction_coefficient / line, ratio, max_relative = tolerance);
    }
}

/// Sum of the midpoint rule.
fn midpoint(count: u32, [from, to]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(count);
    (0..count).map(|k| of(from + (f64::from(k) + 0.5) * step)).sum::<f64>() * step
}

#[test]
fn small_loads_have_area_in_proportion_and_constant_friction() {
    for diffusion in [Diffusion::Full, Diffusion::Reduced] {
        let at =
            |pressure| predict(&surface(), &rubber(), options(0.5, diffusion), [SPEED, pressure]);
        let full = at(1e3).full_contact_pressure;
        let [light, lighter] = [1e-5, 1e-6].map(|share| at(share * full));
        let ratio = light.contact_area_fraction / lighter.contact_area_fraction;
        // Area is linear, but for what the longest waves in nearly full contact do to S: of the order of the load.
        assert_relative_eq!(ratio, 10.0, max_relative = 1e-4);
        let ratio = light.friction_coefficient / lighter.friction_coefficient;
        assert_relative_eq!(ratio, 1.0, max_relative = 1e-3);
        if diffusion == Diffusion::Full {
            let area = (2.0 / PI).sqrt() * 1e-6;
            assert_relative_eq!(lighter.contact_area_fraction, area, max_relative = 1e-8);
        }
    }
}

#[test]
fn friction_grows_with_gamma_and_the_area_of_the_reduced_diffusion_falls() {
    let at = |gamma, diffusion| {
        predict(&surface(), &rubber(), options(gamma, diffusion), [SPEED, PRESSURE])
    };
    let gammas = [0.0, 0.25, 0.5, 0.75, 1.0];
    let full = gammas.map(|gamma| at(gamma, Diffusion::Full));
    let reduced = gammas.map(|gamma| at(gamma, Diffusion::Reduced));
    for k in 1..gammas.len() {
        assert!(full[k].friction_coefficient > full[k - 1].friction_coefficient);
        assert_eq!(full[k].contact_area_fraction, full[0].contact_area_fraction);
        assert!(full[k].mean_gap > full[k - 1].mean_gap);
        assert!(reduced[k].contact_area_fraction < reduced[k - 1].contact_area_fraction);
        assert!(reduced[k - 1].contact_area_fraction > full[k - 1].contact_area_fraction);
    }
    // Without a reduction both are one.
    assert_relative_eq!(
        reduced[4].friction_coefficient,
        full[4].friction_coefficient,
        max_relative = 1e-7
    );
}

/// The published double integral over wavenumber and pressure, by sums of its own.
#[test]
fn the_gap_of_an_elastic_solid_is_the_published_double_integral() {
    let reduced = 4e6;
    let rubber = Rubber::elastic(0.75 * reduced, 0.5);
    let (scale, hurst, band) = (1e-13, 0.8, [1e3, 1e5]);
    let surface = self_affine(scale, hurst, band);
    let (gamma, pressure) = (0.45, 3e4);
    let at = predict(&surface, &rubber, options(gamma, Diffusion::Full), [SPEED, pressure]);
    // u = sqrt(π) ∫ q² C w ∫_p (γ + 3 (1 - γ) P²) exp(-(w p'/E_r)²) dp'/p' dq, P = erf(w p'/E_r), w = (π ∫ q³ C)^(-1/2).
    let inner = |w: f64| {
        midpoint(2000, [pressure.ln(), (10.0 * reduced / w).max(pressure).ln()], |ln_p| {
            let x = w * ln_p.exp() / reduced;
            (gamma + 3.0 * (1.0 - gamma) * erf(x).powi(2)) * (-x * x).exp()
        })
    };
    // s = sqrt(ln ζ) takes the root at the longest wave away.
    let gap = midpoint(4000, [0.0, (band[1] / band[0]).ln().sqrt()], |s| {
        let (q, power) = (band[0] * (s * s).exp(), 2.0 - 2.0 * hurst);
        let integral = scale * band[0].powi(4) * (power * s * s).exp_m1() / power;
        let w = 1.0 / (PI * integral).sqrt();
        PI.sqrt() * q.powi(3) * surface.density(q) * w * inner(w) * 2.0 * s
    });
    // The midpoint rules, beginning at the knee of the longest waves.
    assert_relative_eq!(at.mean_gap, gap, max_relative = 1e-5);
}

/// `p = β E_r exp(-u / u_0)` at small load, `u_0 = γ ∫ q² C (∫^q q'³ C)^(-1/2) dq`.
#[test]
fn the_gap_of_an_elastic_solid_falls_with_the_logarithm_of_a_small_load() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let (scale, hurst, band) = (1e-13, 0.8, [1e3, 1e5]);
    let surface = self_affine(scale, hurst, band);
    for gamma in [0.45, 1.0] {
        let gap = |pressure| {
            predict(&surface, &rubber, options(gamma, Diffusion::Full), [SPEED, pressure]).mean_gap
        };
        let power = 2.0 - 2.0 * hurst;
        // s = sqrt(ln ζ) takes the root at the longest wave away.
        let decay = midpoint(4000, [0.0, (band[1] / band[0]).ln().sqrt()], |s| {
            let (q, ln_zeta) = (band[0] * (s * s).exp(), s * s);
            let integral = scale * band[0].powi(4) * (power * ln_zeta).exp_m1() / power;
            gamma * q.powi(3) * surface.density(q) / integral.sqrt() * 2.0 * s
        });
        let slope = |p: f64| (gap(p) - gap(10.0 * p)) / 10_f64.ln();
        // The longest waves close last: what is left falls with the load.
        assert_relative_eq!(slope(1.0), decay, max_relative = 1e-3);
        // At large load it falls faster.
        assert!(gap(2e7) < 1e-3 * decay);
    }
}

#[test]
fn waves_up_to_a_wavenumber_are_a_surface_that_ends_there() {
    let (surface, rubber) = (surface(), rubber());
    let theory = |band| IsotropicPersson::new(&surface, &rubber, band, PerssonOptions::default());
    let marks = [5e2, 1e3, 2e4, 2e5];
    let all = theory([3e2, 2e5]).unwrap().over_wavenumbers(SPEED, PRESSURE, &marks).unwrap();
    for (row, mark) in all.iter().zip(marks) {
        let alone = theory([3e2, mark]).unwrap().at(SPEED, PRESSURE).unwrap();
        assert_relative_eq!(
            row.friction_coefficient,
            alone.friction_coefficient,
            max_relative = 1e-6
        );
        assert_relative_eq!(
            row.contact_area_fraction,
            alone.contact_area_fraction,
            max_relative = 1e-6
        );
        assert_relative_eq!(row.mean_gap, alone.mean_gap, max_relative = 1e-5);
        assert_relative_eq!(row.rms_height, surface.rms_height([3e2, mark]), max_relative = 1e-12);
        assert_relative_eq!(row.magnification, mark / 3e2, max_relative = 1e-12);
    }
}

/// The stated error is not smaller than the true one.
#[test]
fn the_error_is_an_upper_bound_of_the_change_to_a_finer_quadrature() {
    let (surface, rubber) = (surface(), rubber());
    let at = |tolerance| {
        let options = PerssonOptions { tolerance, ..Default::default() };
        IsotropicPersson::new(&surface, &rubber, surface.band(), options)
            .unwrap()
            .at(SPEED, PRESSURE)
            .unwrap()
    };
    let (coarse, fine) = (at(1e-2), at(1e-11));
    let change = (coarse.friction_coefficient - fine.friction_coefficient).abs();
    assert!(change <= coarse.errors.friction_coefficient, "{change:e} {:?}", coarse.errors);
    let change = (coarse.mean_gap - fine.mean_gap).abs();
    assert!(change <= coarse.errors.mean_gap, "{change:e} {:?}", coarse.errors);
}

#[test]
fn mistakes_are_named() {
    let (surface, rubber) = (surface(), rubber());
    let new = |band, options| IsotropicPersson::new(&surface, &rubber, band, options).map(|_| ());
    let fine = PerssonOptions::default();
    for gamma in [-0.1, 1.1, f64::NAN] {
        let error = new(surface.band(), PerssonOptions { gamma, ..fine }).unwrap_err();
        assert!(matches!(error, PerssonError::Gamma { .. }));
    }
    for tolerance in [0.0, 1e-13, f64::NAN] {
        let error = new(surface.band(), PerssonOptions { tolerance, ..fine }).unwrap_err();
        assert!(matches!(error, PerssonError::Tolerance { .. }));
    }
    for band in [[1e2, 1e5], [1e3, 1e6], [1e5, 1e3], [1e3, 1e3], [f64::NAN, 1e5]] {
        assert!(matches!(new(band, fine).unwrap_err(), PerssonError::Band { .. }));
    }
    let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), fine).unwrap();
    for (speed, pressure) in
        [(0.0, 1e5), (-1.0, 1e5), (f64::NAN, 1e5), (1.0, 0.0), (1.0, f64::INFINITY)]
    {
        let error = theory.at(speed, pressure).unwrap_err();
        assert!(matches!(error, PerssonError::NotPositive { .. }), "{error}");
    }
    assert!(matches!(theory.at(SPEED, 1e-6).unwrap_err(), PerssonError::Load { .. }));
    for marks in [[1e3, 1e3], [1e3, 3e5], [1e2, 1e3]] {
        let error = theory.over_wavenumbers(SPEED, PRESSURE, &marks).unwrap_err();
        assert!(matches!(error, PerssonError::Outside { .. }));
    }
    let soft = Rubber { equilibrium_modulus: -1.0, ..rubber.clone() };
    let error = IsotropicPersson::new(&surface, &soft, surface.band(), fine).map(|_| ());
    assert!(matches!(error.unwrap_err(), PerssonError::Rubber(_)));
    assert!(matches!(
        IsotropicSpectrum::new(vec![1.0, 2.0], vec![1.0]),
        Err(IsotropicError::Count { .. })
    ));
}
