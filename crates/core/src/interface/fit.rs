//! Constants of the shear law from measured friction.

use super::ShearError;
use super::law::{Activation, GaussianShear, ShearLaw, check_temperature, positive};
use crate::numerics::least_squares::{LeastSquares, Minimum, minimise};
use crate::numerics::statistics::student_t_975;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::LN_10;

/// Measured friction beside what is computed for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredFriction {
    /// Sliding speed in m/s.
    pub speed: f64,
    /// Temperature in °C.
    pub temperature_c: f64,
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Measured friction coefficient.
    pub friction: f64,
    /// Computed hysteretic friction coefficient there.
    pub hysteretic: f64,
    /// Computed contact area fraction there.
    pub contact_area_fraction: f64,
}

/// What of a [`GaussianShear`] is not fitted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fixed {
    /// Speed v_0 in m/s of the largest stress.
    pub peak_speed: Option<f64>,
    /// c.
    pub width: Option<f64>,
    /// Activation energy ε in eV.
    pub energy_ev: Option<f64>,
}

/// A fitted constant with the ends of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The constant.
    pub value: f64,
    /// Ends of the interval; `None` for a constant that was fixed.
    pub ends: Option<[f64; 2]>,
}

/// A fitted shear law.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedShear {
    /// The law.
    pub law: GaussianShear,
    /// τ_0 in Pa.
    pub peak_stress: Interval,
    /// v_0 in m/s.
    pub peak_speed: Interval,
    /// c.
    pub width: Interval,
    /// ε in eV; `None` without a shift.
    pub energy_ev: Option<Interval>,
    /// Root mean square of [`Self::residuals`].
    pub rms: f64,
    /// Predicted minus measured friction coefficients, in the order of the measurements.
    pub residuals: Vec<f64>,
    /// Measurements less fitted constants.
    pub degrees_of_freedom: usize,
    /// How uncertain the constants are together.
    scatter: Scatter,
}

/// Scatter of the measurements about a fitted law, and of its constants.
#[derive(Debug, Clone, PartialEq)]
struct Scatter {
    /// The fitted constants, in the order of the coordinates.
    free: Vec<Constant>,
    /// Standard deviation of a friction coefficient about the law.
    noise: f64,
    /// Covariance of the coordinates.
    covariance: DMatrix<f64>,
    /// Quantile of Student's t, 97.5 %.
    t: f64,
}

/// Friction by a fitted law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedFriction {
    /// Friction coefficient, hysteresis and shear together.
    pub friction: f64,
    /// Its part by the shear.
    pub adhesive: f64,
    /// Half width of the 95 % interval of one more measurement there: the uncertainty of the constants and the scatter of the
    /// measurements about the law, linearised, with Student's t. Errors of computed hysteresis and area are not in it.
    pub half_width_95: f64,
}

impl FittedShear {
    /// What the law predicts where something is measured, or would be; the measured friction has no effect.
    ///
    /// # Errors
    /// [`ShearError::OutOfRange`].
    pub fn predict(&self, at: &MeasuredFriction) -> Result<PredictedFriction, ShearError> {
        let stress = ShearLaw::Gaussian(self.law).stress(at.speed, at.temperature_c)?;
        let adhesive = stress * at.contact_area_fraction / at.pressure;
        let Scatter { free, noise, covariance, t } = &self.scatter;
        let slopes = self.law.relative_slopes(at, free) * adhesive;
        let of_constants = slopes.dot(&(covariance * &slopes));
        Ok(PredictedFriction {
            friction: at.hysteretic + adhesive,
            adhesive,
            half_width_95: t * (noise * noise + of_constants).sqrt(),
        })
    }
}

impl GaussianShear {
    /// Derivatives of the logarithm of the stress by the coordinates of a fit.
    fn relative_slopes(&self, m: &MeasuredFriction, free: &[Constant]) -> DVector<f64> {
        let reference_c = self.shift.map_or(20.0, |shift| shift.reference_c);
        let one_ev = Activation { energy_ev: 1.0, reference_c };
        let by_energy = one_ev.ln_factor(m.temperature_c) / LN_10;
        let energy = self.shift.map_or(0.0, |shift| shift.energy_ev);
        let decades = (m.speed / self.peak_speed).log10() + energy * by_energy;
        let slope = |constant: &Constant| match constant {
            Constant::Stress => 1.0,
            Constant::Speed => 2.0 * self.width * decades,
            Constant::Width => -self.width * decades * decades,
            Constant::Energy => -2.0 * self.width * decades * by_energy,
        };
        DVector::from_iterator(free.len(), free.iter().map(slope))
    }
}

/// Fits a [`GaussianShear`] to measured friction: least squares of `μ_h + τ_f A / (p A_0) - μ`, all measurements of the
/// same weight.
///
/// `reference_c` is T_0 in °C; without it the law has no shift, and the energy must not be fixed. The intervals are those of
/// the linearised fit in the logarithms of the constants (in ε itself) with Student's t: they hold the scatter of the measurements about the law,
/// not the error of computed hysteresis and area.
///
/// # Errors
/// [`ShearError::OutOfRange`], [`ShearError::TooFewMeasurements`], [`ShearError::OneTemperature`],
/// [`ShearError::NothingLeft`], [`ShearError::NotConverged`] where the measurements do not determine the constants.
pub fn fit_shear(
    measured: &[MeasuredFriction],
    reference_c: Option<f64>,
    fixed: Fixed,
) -> Result<FittedShear, ShearError> {
    check(measured, reference_c, fixed)?;
    let problem = Problem {
        measured,
        reference_c: reference_c.unwrap_or(20.0),
        fixed,
        shifted: reference_c.is_some(),
    };
    let count = problem.constants();
    if measured.len() <= count {
        return Err(ShearError::TooFewMeasurements {
            measurements: measured.len(),
            constants: count,
        });
    }
    if measured.iter().all(|m| m.friction <= m.hysteretic) {
        return Err(ShearError::NothingLeft);
    }
    let best = problem
        .starts()
        .into_iter()
        .filter_map(|start| minimise(&problem, start))
        .filter(Minimum::converged)
        .min_by(|a, b| a.rms.total_cmp(&b.rms))
        .ok_or(ShearError::NotConverged)?;
    problem.fitted(&best)
}

fn check(
    measured: &[MeasuredFriction],
    reference_c: Option<f64>,
    fixed: Fixed,
) -> Result<(), ShearError> {
    for m in measured {
        positive("the measured speed in m/s", m.speed)?;
        positive("the mean pressure in Pa", m.pressure)?;
        positive("the computed contact area fraction", m.contact_area_fraction)?;
        check_temperature("the measured temperature in °C", m.temperature_c)?;
        let finite =
            [("the measured friction", m.friction), ("the hysteretic friction", m.hysteretic)];
        for (quantity, value) in finite {
            if !value.is_finite() {
                return Err(ShearError::OutOfRange { quantity, value, range: "finite" });
            }
        }
    }
    fixed.peak_speed.map_or(Ok(()), |v| positive("the fixed speed in m/s", v))?;
    fixed.width.map_or(Ok(()), |c| positive("the fixed width", c))?;
    let Some(reference_c) = reference_c else { return Ok(()) };
    check_temperature("the reference temperature in °C", reference_c)?;
    let one = measured.windows(2).all(|pair| pair[0].temperature_c == pair[1].temperature_c);
    if one && fixed.energy_ev.is_none() { Err(ShearError::OneTemperature) } else { Ok(()) }
}

/// The constants as coordinates: `ln τ_0`, `log10 v_0`, `ln c`, ε, without those that are fixed.
struct Problem<'a> {
    measured: &'a [MeasuredFriction],
    reference_c: f64,
    fixed: Fixed,
    shifted: bool,
}

/// A constant of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Constant {
    Stress,
    Speed,
    Width,
    Energy,
}

impl Problem<'_> {
    /// The fitted constants, in the order of the coordinates.
    fn free(&self) -> Vec<Constant> {
        let free = [
            (Constant::Stress, true),
            (Constant::Speed, self.fixed.peak_speed.is_none()),
            (Constant::Width, self.fixed.width.is_none()),
            (Constant::Energy, self.shifted && self.fixed.energy_ev.is_none()),
        ];
        free.into_iter().filter(|(_, free)| *free).map(|(constant, _)| constant).collect()
    }

    fn constants(&self) -> usize {
        self.free().len()
    }

    fn law(&self, coordinates: &DVector<f64>) -> GaussianShear {
        let free = self.free();
        let at = |constant| free.iter().position(|c| *c == constant).map(|k| coordinates[k]);
        let energy = at(Constant::Energy).or(self.fixed.energy_ev).filter(|_| self.shifted);
        GaussianShear {
            peak_stress: at(Constant::Stress).map_or(1.0, f64::exp),
            peak_speed: at(Constant::Speed)
                .map_or_else(|| self.fixed.peak_speed.unwrap_or(1.0), |d| 10.0_f64.powf(d)),
            width: at(Constant::Width).map_or_else(|| self.fixed.width.unwrap_or(1.0), f64::exp),
            shift: energy.map(|energy_ev| Activation { energy_ev, reference_c: self.reference_c }),
        }
    }

    /// Adhesive friction for τ_0 = 1 Pa.
    fn shape(&self, law: &GaussianShear, m: &MeasuredFriction) -> f64 {
        let by_energy = law.shift.map_or(0.0, |shift| shift.ln_factor(m.temperature_c) / LN_10);
        let decades = (m.speed / law.peak_speed).log10() + by_energy;
        (-law.width * decades * decades).exp() * m.contact_area_fraction / m.pressure
    }

    /// Where to start: the best of a grid of v_0, c and ε with the stress that suits them, so that no minimum in reach is
    /// missed.
    fn starts(&self) -> Vec<DVector<f64>> {
        let or = |fixed: Option<f64>, grid: Vec<f64>| fixed.map_or(grid, |value| vec![value]);
        let widths = or(self.fixed.width, vec![0.01, 0.03, 0.1, 0.3, 1.0]);
        let energies = if self.shifted {
            or(self.fixed.energy_ev, vec![0.3, 0.6, 1.0, 1.5, 2.0])
        } else {
            vec![0.0]
        };
        let speeds = or(
            self.fixed.peak_speed,
            (-18..=8).map(|half| 10.0_f64.powf(0.5 * f64::from(half))).collect(),
        );
        let mut starts: Vec<(f64, DVector<f64>)> = Vec::new();
        for (width, energy_ev, peak_speed) in combinations(&widths, &energies, &speeds) {
            let shift =
                self.shifted.then_some(Activation { energy_ev, reference_c: self.reference_c });
            let law = GaussianShear { peak_stress: 1.0, peak_speed, width, shift };
            let shapes: Vec<f64> = self.measured.iter().map(|m| self.shape(&law, m)).collect();
            let left = self.measured.iter().map(|m| m.friction - m.hysteretic);
            let (mut along, mut square) = (0.0, 0.0);
            for (shape, left) in shapes.iter().zip(left.clone()) {
                along += shape * left;
                square += shape * shape;
            }
            let stress = along / square;
            if !(stress > 0.0 && stress.is_finite()) {
                continue;
            }
            let misfit: f64 = shapes.iter().zip(left).map(|(s, y)| (stress * s - y).powi(2)).sum();
            let coordinate = |constant: Constant| match constant {
                Constant::Stress => stress.ln(),
                Constant::Speed => peak_speed.log10(),
                Constant::Width => width.ln(),
                Constant::Energy => energy_ev,
            };
            let start =
                DVector::from_iterator(self.constants(), self.free().into_iter().map(coordinate));
            starts.push((misfit, start));
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.into_iter().take(STARTS).map(|(_, start)| start).collect()
    }

    fn fitted(&self, minimum: &Minimum) -> Result<FittedShear, ShearError> {
        let at = &minimum.parameters;
        let law = self.law(at);
        ShearLaw::Gaussian(law).validate().map_err(|_| ShearError::NotConverged)?;
        let residuals = self.residuals(at);
        let freedom = self.measured.len() - self.constants();
        let noise = residuals.norm() / (freedom as f64).sqrt();
        let svd = self.jacobian(at).svd(false, true);
        let (values, directions) =
            (&svd.singular_values, svd.v_t.as_ref().ok_or(ShearError::NotConverged)?);
        if values.min() < UNDETERMINED * values.max() {
            return Err(ShearError::NotConverged);
        }
        let t = student_t_975(freedom as f64);
        let scaled = DMatrix::from_fn(values.len(), values.len(), |j, k| {
            noise * directions[(j, k)] / values[j]
        });
        let covariance = scaled.transpose() * &scaled;
        let half_width = |k: usize| t * covariance[(k, k)].sqrt();
        let free = self.free();
        let interval = |constant: Constant, value: f64| {
            let ends = free.iter().position(|c| *c == constant).map(|k| {
                let half = half_width(k);
                [-half, half].map(|change| match constant {
                    Constant::Stress | Constant::Width => value * change.exp(),
                    Constant::Speed => value * 10.0_f64.powf(change),
                    Constant::Energy => value + change,
                })
            });
            Interval { value, ends }
        };
        Ok(FittedShear {
            law,
            peak_stress: interval(Constant::Stress, law.peak_stress),
            peak_speed: interval(Constant::Speed, law.peak_speed),
            width: interval(Constant::Width, law.width),
            energy_ev: law.shift.map(|shift| interval(Constant::Energy, shift.energy_ev)),
            rms: residuals.norm() / (residuals.len() as f64).sqrt(),
            residuals: residuals.iter().copied().collect(),
            degrees_of_freedom: freedom,
            scatter: Scatter { free, noise, covariance, t },
        })
    }
}

/// Starts that are followed to a minimum.
const STARTS: usize = 6;
/// Ratio of singular values of the Jacobian below which measurements do not determine the constants.
const UNDETERMINED: f64 = 1e-8;

/// All combinations of three lists.
fn combinations<'a>(
    a: &'a [f64],
    b: &'a [f64],
    c: &'a [f64],
) -> impl Iterator<Item = (f64, f64, f64)> + 'a {
    a.iter().flat_map(move |x| b.iter().flat_map(move |y| c.iter().map(move |z| (*x, *y, *z))))
}

impl LeastSquares for Problem<'_> {
    fn residuals(&self, coordinates: &DVector<f64>) -> DVector<f64> {
        let law = self.law(coordinates);
        let of = |m: &MeasuredFriction| {
            m.hysteretic + law.peak_stress * self.shape(&law, m) - m.friction
        };
        DVector::from_iterator(self.measured.len(), self.measured.iter().map(of))
    }

    fn jacobian(&self, coordinates: &DVector<f64>) -> DMatrix<f64> {
        let law = self.law(coordinates);
        let free = self.free();
        let rows = self.measured.iter().map(|m| {
            let adhesive = law.peak_stress * self.shape(&law, m);
            (law.relative_slopes(m, &free) * adhesive).transpose()
        });
        DMatrix::from_rows(&rows.collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests;
