//! Persson's theory for isotropic surfaces with a continuous spectrum.
//!
//! | module | what it holds |
//! |---|---|
//! | `angle` | means of the moduli over the angle between waves and sliding |
//! | `diffusion` | contact area, strain and gap over the spread of the pressure |
//! | `quadrature` | the integrals over the wavenumber |
//! | `flash` | the heat of friction in the rubber |
//! | `error` | why there is no prediction |

mod angle;
mod diffusion;
mod error;
mod flash;
mod quadrature;
#[cfg(test)]
mod tests;

pub use diffusion::Diffusion;
pub use error::PerssonError;
pub use flash::{FlashPrediction, Heating};

use crate::rubber::{FrequencyRange, Viscoelastic};
use crate::surface::spectrum::IsotropicSpectrum;
use angle::AngularMeans;
use diffusion::Contact;
use quadrature::{Integrand, Sums};
use std::f64::consts::TAU;

/// What the theory leaves to be chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerssonOptions {
    /// γ between 0 and 1: the share of the strain of full contact that is left in vanishing contact.
    pub gamma: f64,
    /// Whether γ reduces the spread of the pressure as well.
    pub diffusion: Diffusion,
    /// Largest relative change of area, friction and gap by the last refinement of the quadrature.
    pub tolerance: f64,
}

impl Default for PerssonOptions {
    /// γ = 1/2 for friction alone, a tolerance of 1e-6.
    fn default() -> Self {
        Self { gamma: 0.5, diffusion: Diffusion::Full, tolerance: 1e-6 }
    }
}

/// Persson's theory of rubber that slides on an isotropic surface (J. Chem. Phys. 115, 3840, 2001,
/// doi:10.1063/1.1388626).
///
/// With `C(q)` the spectral density of the height over the plane (`<z²> = ∫ C d²q`), `E_r = E / (1 - ν²)`, φ the angle of
/// a wave to the sliding, `p` the mean pressure, and `<.>` the mean over φ:
///
/// ```text
/// V(q) = π/2 ∫ q³ C <|E_r(q v cos φ)|²> dq         variance of the pressure of full contact
/// P(q) = erf(1 / (2 sqrt(G))),  G = V / (2 p²)       share of the area in contact, seen with waves up to q
/// μ    = π/p ∫ q³ C <cos φ Im E_r(q v cos φ)> S P dq,   S = γ + (1 - γ) P²
/// ```
///
/// which is the published `G = 1/8 ∫ q³ C dq ∫ |E_r/p|² dφ` and `μ = 1/2 ∫ q³ C S P dq ∫ cos φ Im E_r/p dφ`. With
/// [`Diffusion::Reduced`] S also multiplies the integrand of `G`.
///
/// **Mean gap** (Persson, Phys. Rev. Lett. 99, 125502, 2007, doi:10.1103/PhysRevLett.99.125502; Yang & Persson, J. Phys.:
/// Condens. Matter 20, 215214, 2008, doi:10.1088/0953-8984/20/21/215214): from the energy `U = π/2 ∫ q² C M S P dq` of the
/// waves, `u = ∫_p^∞ (dU/dp') dp'/p'`, with `M² = <|E_r|²>`. For an elastic solid M is its modulus and this is the
/// published theory; a lossy rubber has no such energy, and its gap is that of an elastic solid with the modulus M at
/// every wavenumber.
///
/// Superposed sines in plane strain ([`super::Persson`]) have the same formulas without the mean over φ: a ring of waves
/// of the mean square height of a sine has its `V` and its friction, with `M²` in place of `|E_r|²` and
/// `<cos φ Im E_r>` in place of `Im E_r`.
///
/// Between the points of a measured rubber, waves across the sliding have any frequency down to zero. Those below the
/// measured ones are given the modulus of its lowest frequency, and [`IsotropicPrediction::unmeasured_share`] says how
/// much of the result that is.
///
/// ```
/// use asperity_core::rubber::Rubber;
/// use asperity_core::surface::spectrum::IsotropicSpectrum;
/// use asperity_core::theory::{IsotropicPersson, PerssonOptions};
///
/// // Self-affine with H = 0.8 from 1 cm to 10 um.
/// let density = |q: f64| 2e-13 * (q / 1e3).powf(-3.6);
/// let wavenumbers = vec![6e2, 6e5];
/// let densities = wavenumbers.iter().map(|q| density(*q)).collect();
/// let surface = IsotropicSpectrum::new(wavenumbers, densities)?;
/// let rubber = Rubber::table_2_1();
/// let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), PerssonOptions::default())?;
/// let at = theory.at(0.01, 3e5)?; // 10 mm/s, 0.3 MPa
/// println!("{} at area {}", at.friction_coefficient, at.contact_area_fraction);
/// assert!(at.errors.friction_coefficient <= 1e-6 * at.friction_coefficient);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct IsotropicPersson<'a> {
    spectrum: &'a IsotropicSpectrum,
    rubber: &'a dyn Viscoelastic,
    band: [f64; 2],
    options: PerssonOptions,
    contact: Contact,
}

/// What the theory says of the waves up to one wavenumber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsotropicPrediction {
    /// Largest wavenumber in rad/m.
    pub wavenumber: f64,
    /// It over that of the longest wave.
    pub magnification: f64,
    /// Real over nominal area of contact.
    pub contact_area_fraction: f64,
    /// Friction coefficient.
    pub friction_coefficient: f64,
    /// Friction coefficient that full contact would have at this pressure.
    pub full_contact_friction: f64,
    /// Mean gap in m between the surfaces.
    pub mean_gap: f64,
    /// Root mean square pressure of full contact in Pa, about its mean.
    pub full_contact_pressure: f64,
    /// Root mean square height in m.
    pub rms_height: f64,
    /// Root mean square gradient over the plane.
    pub rms_gradient: f64,
    /// The larger of the shares of friction and of the variance of the pressure that come from frequencies below those at
    /// which the rubber was measured.
    pub unmeasured_share: f64,
    /// Estimated errors of the quadrature.
    pub errors: PredictionErrors,
}

/// Changes by the last refinement of the quadrature, which are larger than what is left after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictionErrors {
    /// Of the contact area fraction.
    pub contact_area_fraction: f64,
    /// Of the friction coefficient.
    pub friction_coefficient: f64,
    /// Of the mean gap in m.
    pub mean_gap: f64,
}

/// Refinements before the quadrature gives up: panels of 1/128 in `ln q`.
const LEVELS: i32 = 7;

impl<'a> IsotropicPersson<'a> {
    /// The theory for a surface, of which the waves between two wavenumbers in rad/m are taken, and a rubber.
    ///
    /// # Errors
    /// [`PerssonError::Gamma`], [`PerssonError::Tolerance`], [`PerssonError::Band`] for cut-offs outside the spectrum or in
    /// the wrong order, [`PerssonError::Rubber`] for a rubber that is no solid.
    pub fn new(
        spectrum: &'a IsotropicSpectrum,
        rubber: &'a dyn Viscoelastic,
        band: [f64; 2],
        options: PerssonOptions,
    ) -> Result<Self, PerssonError> {
        let PerssonOptions { gamma, diffusion, tolerance } = options;
        if !(0.0..=1.0).contains(&gamma) {
            return Err(PerssonError::Gamma { value: gamma });
        }
        if !(1e-12..=0.1).contains(&tolerance) {
            return Err(PerssonError::Tolerance { value: tolerance });
        }
        let table = spectrum.band();
        if !(table[0] <= band[0] && band[0] < band[1] && band[1] <= table[1]) {
            return Err(PerssonError::Band { band, table });
        }
        rubber.validate()?;
        Ok(Self { spectrum, rubber, band, options, contact: Contact::new(gamma, diffusion) })
    }

    /// The prediction with all waves at a speed in m/s and a mean pressure in Pa.
    ///
    /// # Errors
    /// [`PerssonError::NotPositive`]; [`PerssonError::Rubber`] if the rubber is not known at the frequency of a wave along
    /// the sliding; [`PerssonError::Load`]; [`PerssonError::NotConverged`] and [`PerssonError::NotFinite`].
    pub fn at(&self, speed: f64, pressure: f64) -> Result<IsotropicPrediction, PerssonError> {
        let mut all = self.over_wavenumbers(speed, pressure, &[self.band[1]])?;
        Ok(all.remove(0))
    }

    /// The predictions with the waves up to each of some ascending wavenumbers in rad/m.
    ///
    /// # Errors
    /// As [`Self::at`]; [`PerssonError::Outside`] for a wavenumber outside the cut-offs or not above the one before.
    pub fn over_wavenumbers(
        &self,
        speed: f64,
        pressure: f64,
        wavenumbers: &[f64],
    ) -> Result<Vec<IsotropicPrediction>, PerssonError> {
        self.require_known(speed)?;
        let means =
            |wavenumber: f64, step: f64| AngularMeans::of(self.rubber, wavenumber * speed, step);
        self.predict(pressure, wavenumbers, &means)
    }

    /// Checks the speed, and that the rubber is known at the frequencies of the waves along the sliding.
    fn require_known(&self, speed: f64) -> Result<(), PerssonError> {
        positive("the speed in m/s", speed)?;
        let lengths = self.band.map(|wavenumber| TAU / wavenumber);
        if let Some(excited) = FrequencyRange::excited(lengths, [speed]) {
            self.rubber.require(excited)?;
        }
        Ok(())
    }

    /// The predictions with given angular means, refined until they settle.
    fn predict(
        &self,
        pressure: f64,
        wavenumbers: &[f64],
        means: &dyn Fn(f64, f64) -> AngularMeans,
    ) -> Result<Vec<IsotropicPrediction>, PerssonError> {
        positive("the mean pressure in Pa", pressure)?;
        let mut marks = vec![self.band[0]];
        for &wavenumber in wavenumbers {
            if !(wavenumber > marks[marks.len() - 1] && wavenumber <= self.band[1]) {
                return Err(PerssonError::Outside { wavenumber, band: self.band });
            }
            marks.push(wavenumber);
        }
        let (spectrum, contact) = (self.spectrum, &self.contact);
        let integrand = Integrand { spectrum, contact, pressure, means };
        let mut before: Option<Vec<IsotropicPrediction>> = None;
        let mut worst = ("the contact area fraction", f64::INFINITY);
        for level in 0..=LEVELS {
            let sums = integrand.sums(&marks, level);
            let rows = sums.iter().zip(wavenumbers);
            let mut now = rows
                .map(|(sums, wavenumber)| self.prediction(*wavenumber, pressure, sums))
                .collect::<Result<Vec<_>, _>>()?;
            if let Some(before) = before {
                worst = ("the contact area fraction", 0.0);
                for (now, before) in now.iter_mut().zip(before) {
                    now.errors = now.changes_from(&before);
                    let relative = now.largest_relative_error();
                    worst = if relative.1 > worst.1 { relative } else { worst };
                }
                if worst.1 <= self.options.tolerance {
                    return Ok(now);
                }
            }
            before = Some(now);
        }
        let (quantity, change) = worst;
        let tolerance = self.options.tolerance;
        Err(PerssonError::NotConverged { quantity, change, tolerance })
    }

    fn prediction(
        &self,
        wavenumber: f64,
        pressure: f64,
        sums: &Sums,
    ) -> Result<IsotropicPrediction, PerssonError> {
        let full = sums.variance.sqrt();
        for (quantity, value) in [
            ("the variance of the pressure", sums.variance),
            ("the friction of full contact", sums.full_friction),
            ("the mean gap", sums.gap),
        ] {
            if !value.is_finite() {
                return Err(PerssonError::NotFinite { quantity, value });
            }
        }
        if full > diffusion::LARGEST * pressure {
            let ratio = pressure / full;
            return Err(PerssonError::Load { pressure, full, ratio });
        }
        let band = [self.band[0], wavenumber];
        let share = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        Ok(IsotropicPrediction {
            wavenumber,
            magnification: wavenumber / self.band[0],
            contact_area_fraction: self.contact.at(full / pressure).area,
            friction_coefficient: sums.friction,
            full_contact_friction: sums.full_friction,
            mean_gap: sums.gap,
            full_contact_pressure: full,
            rms_height: self.spectrum.rms_height(band),
            rms_gradient: self.spectrum.rms_gradient(band),
            unmeasured_share: share(sums.unmeasured_variance, sums.variance)
                .max(share(sums.unmeasured_friction, sums.friction)),
            errors: PredictionErrors {
                contact_area_fraction: f64::NAN,
                friction_coefficient: f64::NAN,
                mean_gap: f64::NAN,
            },
        })
    }
}

impl IsotropicPrediction {
    fn changes_from(&self, before: &Self) -> PredictionErrors {
        let change = |of: fn(&Self) -> f64| (of(self) - of(before)).abs();
        PredictionErrors {
            contact_area_fraction: change(|p| p.contact_area_fraction),
            friction_coefficient: change(|p| p.friction_coefficient),
            mean_gap: change(|p| p.mean_gap),
        }
    }

    fn largest_relative_error(&self) -> (&'static str, f64) {
        let relative =
            |error: f64, value: f64| if error == 0.0 { 0.0 } else { error / value.abs() };
        [
            (
                "the contact area fraction",
                relative(self.errors.contact_area_fraction, self.contact_area_fraction),
            ),
            (
                "the friction coefficient",
                relative(self.errors.friction_coefficient, self.friction_coefficient),
            ),
            ("the mean gap", relative(self.errors.mean_gap, self.mean_gap)),
        ]
        .into_iter()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or(("the contact area fraction", 0.0))
    }
}

fn positive(quantity: &'static str, value: f64) -> Result<(), PerssonError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PerssonError::NotPositive { quantity, value })
}
