//! Constants of the laws at finite strain from a measured curve of stress over stretch in uniaxial tension or
//! compression.
//!
//! An incompressible solid with `W = f(I1)` has, at the stretch λ, the force over the undeformed area
//!
//! ```text
//! P = 2 f'(I1) (λ - λ⁻²),   I1 = λ² + 2/λ        (Treloar, The Physics of Rubber Elasticity, 3rd ed., 1975)
//! ```
//!
//! so that `P / (λ - λ⁻²)` is the modulus `μ Φ'(I1 - 3)` of that strain. The constants are those with the least mean
//! square of its relative error: by linear least squares for neo-Hooke and Yeoh, by a search over the locking stretch for
//! Arruda and Boyce's law. The shear modulus is that of the speed and the softening (Mullins) of the measurement, not of
//! the series of the rubber; the ratios are what a rubber file takes.

use super::Rheology;
use crate::error_kind::{ErrorKind, HasKind};
use nalgebra::{DMatrix, DVector};

/// A stretch this near to 1 gives no modulus: a strain that is off by 1e-3 is a tenth of it.
const LEAST_STRAIN: f64 = 0.01;
/// Fewest points of a fit of three constants.
const FEWEST: usize = 6;
/// Stretches that rubber may have: natural rubber breaks at 8, and blocks are not pressed to a fiftieth.
const POSSIBLE: std::ops::RangeInclusive<f64> = 0.02..=20.0;
/// Locking stretches that are tried at first, as multiples of the largest chain stretch measured.
const STRETCHES: [f64; 2] = [1.000_1, 30.0];
const TRIES: usize = 400;

/// A measured point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniaxialPoint {
    /// Length over undeformed length.
    pub stretch: f64,
    /// Force over undeformed area in Pa, negative in compression.
    pub nominal_stress: f64,
}

/// A law with the constants that fit a curve best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HyperelasticFit {
    /// The law with its constants.
    pub law: Rheology,
    /// Shear modulus at small strain in Pa, of the measurement.
    pub shear_modulus: f64,
    /// Root mean square of the relative error of the stress.
    pub misfit: f64,
    /// Largest `I1 - 3` that was measured.
    pub largest_invariant: f64,
}

/// Why a curve has no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HyperelasticError {
    /// A number that is none.
    #[error("point {point}: {quantity} is {value}, it must be {range}")]
    BadNumber {
        /// Number of the point, from 1.
        point: usize,
        /// Which number.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// Too few points away from a stretch of 1.
    #[error(
        "{points} points are further than {LEAST_STRAIN} from a stretch of 1, and a fit needs {FEWEST}: measure more, \
         or to larger strains"
    )]
    TooFewPoints {
        /// How many there are.
        points: usize,
    },
    /// The best law has no positive modulus.
    #[error(
        "the best {law} law has a shear modulus of {shear_modulus:.3e} Pa at small strain, which is not positive: look for \
         slack in the first points of the curve, or leave them out"
    )]
    NotPositive {
        /// Name of the law.
        law: &'static str,
        /// The modulus in Pa.
        shear_modulus: f64,
    },
    /// The moduli of the points do not determine the constants.
    #[error("the stretches are too close to each other to tell the constants of the law apart")]
    Undetermined,
}

impl HasKind for HyperelasticError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Fits neo-Hooke, Yeoh's and Arruda and Boyce's law to a curve, in this order.
///
/// # Errors
/// [`HyperelasticError`].
pub fn fit_uniaxial(points: &[UniaxialPoint]) -> Result<[HyperelasticFit; 3], HyperelasticError> {
    let moduli = moduli(points)?;
    let fits = [neo_hooke(&moduli), yeoh(&moduli)?, arruda_boyce(&moduli)];
    let bad = fits.iter().find(|fit| !(fit.shear_modulus > 0.0 && fit.shear_modulus.is_finite()));
    match bad {
        None => Ok(fits),
        Some(HyperelasticFit { law, shear_modulus, .. }) => {
            Err(HyperelasticError::NotPositive { law: law.name(), shear_modulus: *shear_modulus })
        }
    }
}

/// A point as `I1 - 3` and the modulus `P / (λ - λ⁻²)` in Pa.
#[derive(Debug, Clone, Copy)]
struct Modulus {
    invariant: f64,
    modulus: f64,
}

fn moduli(points: &[UniaxialPoint]) -> Result<Vec<Modulus>, HyperelasticError> {
    let mut moduli = Vec::new();
    for (k, UniaxialPoint { stretch, nominal_stress }) in points.iter().copied().enumerate() {
        let bad = |quantity, value, range| HyperelasticError::BadNumber {
            point: k + 1,
            quantity,
            value,
            range,
        };
        if !POSSIBLE.contains(&stretch) {
            let range =
                "from 0.02 to 20, 1 without load: a strain in percent is a hundred times too large";
            return Err(bad("the stretch", stretch, range));
        }
        if !nominal_stress.is_finite() {
            return Err(bad("the stress in Pa", nominal_stress, "finite"));
        }
        if (stretch - 1.0).abs() < LEAST_STRAIN {
            continue;
        }
        let modulus = nominal_stress / (stretch - stretch.powi(-2));
        if modulus <= 0.0 {
            let range = "positive in tension and negative in compression";
            return Err(bad("the stress in Pa", nominal_stress, range));
        }
        moduli.push(Modulus { invariant: stretch.powi(2) + 2.0 / stretch - 3.0, modulus });
    }
    if moduli.len() < FEWEST {
        return Err(HyperelasticError::TooFewPoints { points: moduli.len() });
    }
    Ok(moduli)
}

/// The law with its best modulus: `μ Φ' / modulus` is to be one.
fn scaled(law: Rheology, moduli: &[Modulus]) -> HyperelasticFit {
    let stiffening = law.stiffening();
    let shares: Vec<f64> =
        moduli.iter().map(|at| stiffening.slope_at(at.invariant) / at.modulus).collect();
    let (sum, squares) = shares.iter().fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
    let shear_modulus = sum / squares;
    let errors: f64 = shares.iter().map(|share| (shear_modulus * share - 1.0).powi(2)).sum();
    HyperelasticFit {
        law,
        shear_modulus,
        misfit: (errors / moduli.len() as f64).sqrt(),
        largest_invariant: moduli.iter().map(|at| at.invariant).fold(0.0, f64::max),
    }
}

fn neo_hooke(moduli: &[Modulus]) -> HyperelasticFit {
    scaled(Rheology::NeoHookean, moduli)
}

fn yeoh(moduli: &[Modulus]) -> Result<HyperelasticFit, HyperelasticError> {
    let largest = moduli.iter().map(|at| at.invariant).fold(0.0, f64::max);
    let scale = moduli.iter().map(|at| at.modulus).fold(0.0, f64::max);
    // Columns of one size: powers of the invariant over the largest one.
    let matrix = DMatrix::from_fn(moduli.len(), 3, |k, power| {
        scale * (moduli[k].invariant / largest).powi(power as i32) / moduli[k].modulus
    });
    let ones = DVector::from_element(moduli.len(), 1.0);
    let solution = matrix.clone().svd(true, true).solve(&ones, 1e-12);
    let solution = solution.map_err(|_| HyperelasticError::Undetermined)?;
    // μ Φ' = μ + 2 μ (c2/c1) y + 3 μ (c3/c1) y².
    let law = Rheology::Yeoh {
        c2_over_c1: solution[1] / solution[0] / (2.0 * largest),
        c3_over_c1: solution[2] / solution[0] / (3.0 * largest.powi(2)),
    };
    // The law may end within the curve, where its factor is held: errors are those of the polynomial.
    let errors = (matrix * &solution - ones).norm_squared();
    Ok(HyperelasticFit {
        law,
        shear_modulus: solution[0] * scale,
        misfit: (errors / moduli.len() as f64).sqrt(),
        largest_invariant: largest,
    })
}

fn arruda_boyce(moduli: &[Modulus]) -> HyperelasticFit {
    let largest = moduli.iter().map(|at| at.invariant).fold(0.0, f64::max);
    // Chains are not straight at the largest strain.
    let least = (1.0 + largest / 3.0).sqrt();
    let [from, to] = STRETCHES.map(|factor| (factor * least).ln());
    let fit = |at: f64| scaled(Rheology::ArrudaBoyce { locking_stretch: at.exp() }, moduli);
    let step = (to - from) / TRIES as f64;
    let tried = (0..=TRIES).map(|k| from + step * k as f64);
    let best = tried.min_by(|a, b| fit(*a).misfit.total_cmp(&fit(*b).misfit)).unwrap_or(from);
    // Golden sections about the best one.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = ((best - step).max(from), (best + step).min(to));
    while high - low > 1e-9 {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if fit(left).misfit < fit(right).misfit { high = right } else { low = left }
    }
    fit(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const MODULUS: f64 = 1.3e6;

    fn curve(law: Rheology, stretches: &[f64]) -> Vec<UniaxialPoint> {
        let stiffening = law.stiffening();
        let at = |stretch: &f64| {
            let invariant = stretch.powi(2) + 2.0 / stretch - 3.0;
            let modulus = MODULUS * stiffening.slope_at(invariant);
            UniaxialPoint {
                stretch: *stretch,
                nominal_stress: modulus * (stretch - stretch.powi(-2)),
            }
        };
        stretches.iter().map(at).collect()
    }

    fn stretches() -> Vec<f64> {
        (0..30).map(|k| 0.6 + 0.1 * f64::from(k)).collect()
    }

    #[test]
    fn known_constants_are_found_again() {
        let yeoh = Rheology::Yeoh { c2_over_c1: -0.08, c3_over_c1: 0.007 };
        let [neo_hooke, found, _] = fit_uniaxial(&curve(yeoh, &stretches())).unwrap();
        let Rheology::Yeoh { c2_over_c1, c3_over_c1 } = found.law else { panic!("{found:?}") };
        assert_relative_eq!(c2_over_c1, -0.08, max_relative = 1e-9);
        assert_relative_eq!(c3_over_c1, 0.007, max_relative = 1e-9);
        assert_relative_eq!(found.shear_modulus, MODULUS, max_relative = 1e-9);
        assert!(found.misfit < 1e-9 && neo_hooke.misfit > 0.1, "{found:?} {neo_hooke:?}");
        let chains = Rheology::ArrudaBoyce { locking_stretch: 2.8 };
        let [_, _, found] = fit_uniaxial(&curve(chains, &stretches())).unwrap();
        let Rheology::ArrudaBoyce { locking_stretch } = found.law else { panic!("{found:?}") };
        assert_relative_eq!(locking_stretch, 2.8, max_relative = 1e-6);
        assert_relative_eq!(found.shear_modulus, MODULUS, max_relative = 1e-6);
        let [found, ..] = fit_uniaxial(&curve(Rheology::NeoHookean, &stretches())).unwrap();
        assert_relative_eq!(found.shear_modulus, MODULUS, max_relative = 1e-12);
        assert!(found.misfit < 1e-12);
    }

    #[test]
    fn bad_curves_are_refused_with_the_point() {
        let refused = |points: &[UniaxialPoint], text: &str| {
            let error = fit_uniaxial(points).unwrap_err().to_string();
            assert!(error.contains(text), "{error}");
        };
        let good = curve(Rheology::NeoHookean, &stretches());
        refused(&[], "0 points");
        refused(&good[..5], "and a fit needs 6");
        refused(&vec![UniaxialPoint { stretch: 1.001, nominal_stress: 1.0 }; 20], "0 points");
        for (stretch, nominal_stress, text) in [
            (f64::NAN, 1.0, "point 3: the stretch is NaN"),
            (-0.5, 1.0, "point 3: the stretch is -0.5"),
            (51.0, 1.0, "a strain in percent"),
            (1e200, 1.0, "from 0.02 to 20"),
            (2.0, f64::INFINITY, "point 3: the stress in Pa is inf"),
            (2.0, -1.0, "positive in tension and negative in compression"),
        ] {
            let mut points = good.clone();
            points[2] = UniaxialPoint { stretch, nominal_stress };
            refused(&points, text);
        }
    }
}
