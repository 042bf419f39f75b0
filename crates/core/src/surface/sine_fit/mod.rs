//! Approximation of a height-difference correlation by superposed sines.
//!
//! One sine of amplitude D and wavenumber `q = 2 π / λ` has (thesis 3.3.12-13)
//!
//! ```text
//! c(s) = D^2 g(s),   g = 2 sin^2(q s / 2) for s <= π / q,   2 above (the first maximum kept)
//! ```
//!
//! and sines with independent phases add: `C(s) = sum_i D_i^2 g_i(s)`. The amplitudes minimise
//! the mean over the lags of `(log10 sum_i D_i^2 g_i(s_j) - log10 C_measured(s_j))^2`. (3.4.2-3)
//! print the sum of logarithms; the logarithm of the sum is meant. [`FitRule`] has a second rule, by
//! which known sines come back, with the same cost of other curves.
//!
//! The cost is even in each D, so the unconstrained minimum in D is the minimum over `D >= 0` up to
//! signs. It is found by a trust region with the exact Hessian, closed by Newton steps. `D_i = 0` is always stationary; an
//! amplitude that ends there is a minimum only if the derivative by `D_i^2` is not negative (the
//! Karush-Kuhn-Tucker condition), which is checked.

use super::SineScale;
use super::correlation::CorrelationSample;
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::statistics::student_t_975;
use cost::{LogarithmicCost, minimise};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use thiserror::Error;

mod cost;
mod rule;

pub use rule::{FitRule, rms_height_of_correlation};

/// Largest derivative of the mean squared residual by the relative amplitudes at a solution. Its
/// round-off is about 1e-16.
const GRADIENT_TOLERANCE: f64 = 1e-11;

/// An amplitude this small against its start adds 1e-12 to a correlation at most: it is zero.
const VANISHING: f64 = 1e-6;

/// Beyond this condition number the singular values are round-off.
const SINGULAR: f64 = 1e14;

/// One fitted sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedScale {
    /// Wavelength and amplitude; an amplitude of zero is one the correlation has no place for.
    pub scale: SineScale,
    /// Half width in metres of the 95 % confidence interval of the amplitude; `None` for an
    /// amplitude of zero, infinite if the amplitudes are not determined (condition above 1e14).
    ///
    /// From the covariance `sigma^2 (J^T J)^-1` of the linearised fit with the residual variance
    /// `sigma^2`, lags less waves degrees of freedom. It takes the residuals as independent; those
    /// of neighbouring lags are not, so it is too narrow, the more so the denser the lags; means over lags
    /// ([`FitRule::Sines`]) are the least independent.
    pub confidence_95: Option<f64>,
}

/// Sines fitted to a correlation.
#[derive(Debug, Clone, PartialEq)]
pub struct SineFit {
    /// The sines, by ascending wavelength.
    pub scales: Vec<FittedScale>,
    /// Root mean square of the residuals in `log10 C`, or in that of its mean over lags ([`FitRule::Sines`]).
    pub rms_residual: f64,
    /// Ratio of the largest to the smallest singular value of `d log10 C(s_j) / d ln D_i`, over
    /// the amplitudes that are not zero: what a relative error of C can grow by.
    pub condition_number: f64,
    /// Norm of the gradient of the mean squared residual by `ln D_i`.
    pub gradient_norm: f64,
    /// Trust-region iterations, over all refits.
    pub iterations: u64,
    /// Number of lags.
    pub lags: usize,
}

/// A fit of sines that is not possible or did not converge.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SineFitError {
    /// No freedom left.
    #[error("{lags} lags for {waves} waves; give more lags than waves, at least one wave")]
    TooFewLags {
        /// Number of lags.
        lags: usize,
        /// Number of waves.
        waves: usize,
    },
    /// No logarithm, or no lag.
    #[error(
        "the height-difference correlation is {value} m2 at a lag of {:.6} mm, and both must be positive: do the scans have any \
         roughness there? look at the columns and units of x and z",
        .lag * 1e3
    )]
    NotPositive {
        /// The lag in metres.
        lag: f64,
        /// The correlation in m².
        value: f64,
    },
    /// A wavelength out of order.
    #[error("wavelength {wavelength} m; wavelengths must be positive, finite and ascending")]
    Wavelength {
        /// The wavelength in metres.
        wavelength: f64,
    },
    /// The optimiser stopped short.
    #[error(
        "the fit of {waves} waves stopped at gradient {gradient:e} after {iterations} iterations, {GRADIENT_TOLERANCE:e} is asked; fit fewer waves or more lags"
    )]
    NotConverged {
        /// Number of waves.
        waves: usize,
        /// Norm of the gradient it stopped at.
        gradient: f64,
        /// Iterations done.
        iterations: u64,
    },
    /// A stationary point that is not a minimum.
    #[error(
        "the wave of {wavelength} m went to amplitude zero where the cost still falls with it ({multiplier:e}); fit fewer waves or more lags"
    )]
    NotOptimal {
        /// The wavelength in metres.
        wavelength: f64,
        /// Derivative of the cost by the squared relative amplitude.
        multiplier: f64,
    },
}

impl HasKind for SineFitError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooFewLags { .. } | Self::Wavelength { .. } | Self::NotPositive { .. } => {
                ErrorKind::Input
            }
            Self::NotConverged { .. } | Self::NotOptimal { .. } => ErrorKind::Failure,
        }
    }
}

impl SineFit {
    /// The sines without their intervals.
    pub fn sine_scales(&self) -> Vec<SineScale> {
        self.scales.iter().map(|fitted| fitted.scale).collect()
    }

    /// Root mean square height `sqrt(sum_i D_i²/2)` in metres of a surface made of the sines, whatever the
    /// phases and the rule of the fit.
    pub fn rms_height(&self) -> f64 {
        let squares = self.scales.iter().map(|fitted| fitted.scale.amplitude.powi(2));
        (0.5 * squares.sum::<f64>()).sqrt()
    }
}

/// Height-difference correlation in m² of superposed sines with independent phases at lag `s`
/// (metres), each kept at its plateau above half its wavelength (3.3.12-13).
pub fn superposed_correlation(scales: &[SineScale], s: f64) -> f64 {
    scales.iter().map(|scale| scale.amplitude.powi(2) * unit_correlation(scale.wavelength, s)).sum()
}

/// Correlation of one sine of amplitude 1.
fn unit_correlation(wavelength: f64, s: f64) -> f64 {
    if 2.0 * s >= wavelength { 2.0 } else { 2.0 * (PI * s / wavelength).sin().powi(2) }
}

/// Fit the amplitudes of sines of given wavelengths (metres, ascending) to a correlation, by the rule of the thesis:
/// [`fit_sines_by`] with [`FitRule::Thesis`].
///
/// # Errors
/// Those of [`fit_sines_by`].
pub fn fit_sines(
    samples: &[CorrelationSample],
    wavelengths: &[f64],
) -> Result<SineFit, SineFitError> {
    fit_sines_by(FitRule::Thesis, samples, wavelengths)
}

/// Fit the amplitudes of sines of given wavelengths (metres, ascending) to a correlation by a rule.
///
/// Every lag weighs the same, so the lags should be log-spaced
/// ([`sample_log_spaced`](super::HeightDifferenceCorrelation::sample_log_spaced)). [`FitRule::Sines`] uses those up to
/// half the longest wavelength.
///
/// # Errors
/// Too few lags, lags or values that are not positive, wavelengths out of order, no convergence.
pub fn fit_sines_by(
    rule: FitRule,
    samples: &[CorrelationSample],
    wavelengths: &[f64],
) -> Result<SineFit, SineFitError> {
    let compared = rule.compared(samples, wavelengths.iter().copied().fold(0.0, f64::max));
    check(&compared, wavelengths)?;
    let start: Vec<f64> = wavelengths.iter().map(|w| starting_amplitude(&compared, *w)).collect();
    fit_from(rule, &compared, wavelengths, &start)
}

/// The fit from starting amplitudes, of what the rule compares.
fn fit_from(
    rule: FitRule,
    samples: &[CorrelationSample],
    wavelengths: &[f64],
    start: &[f64],
) -> Result<SineFit, SineFitError> {
    let shapes = unit_shapes(rule, samples, wavelengths);
    let measured = DVector::from_iterator(samples.len(), samples.iter().map(|s| s.value.log10()));
    let full = LogarithmicCost::new(&shapes, &measured, start);

    let mut active: Vec<usize> = (0..wavelengths.len()).collect();
    let mut relative = DVector::from_element(wavelengths.len(), 1.0);
    let mut iterations = 0;
    loop {
        let found = minimise(&full.of_waves(&active), relative);
        iterations += found.iterations;
        if found.gradient_norm.is_nan() || found.gradient_norm > GRADIENT_TOLERANCE {
            let (waves, gradient) = (active.len(), found.gradient_norm);
            return Err(SineFitError::NotConverged { waves, gradient, iterations });
        }
        let vanishes = |k: usize| found.amplitudes[k].abs() <= VANISHING;
        let kept: Vec<usize> = (0..active.len()).filter(|&k| !vanishes(k)).collect();
        relative = found.amplitudes.select_rows(&kept);
        if kept.len() == active.len() {
            break;
        }
        active = kept.iter().map(|&k| active[k]).collect();
    }
    check_zeros(&full, &active, &relative, wavelengths)?;
    let fitted = full.of_waves(&active);
    Ok(report(&fitted, &active, &relative, wavelengths, start, iterations))
}

/// What the rule compares of sines of amplitude 1: one column a wave, one row a lag.
fn unit_shapes(rule: FitRule, samples: &[CorrelationSample], wavelengths: &[f64]) -> DMatrix<f64> {
    let lags = rule::lags(samples);
    let columns = wavelengths.iter().map(|&wavelength| rule.unit_shape(wavelength, &lags).into());
    DMatrix::from_columns(&columns.collect::<Vec<DVector<f64>>>())
}

fn check(samples: &[CorrelationSample], wavelengths: &[f64]) -> Result<(), SineFitError> {
    let (lags, waves) = (samples.len(), wavelengths.len());
    if waves == 0 || lags <= waves {
        return Err(SineFitError::TooFewLags { lags, waves });
    }
    let usable = |x: f64| x > 0.0 && x.is_finite();
    if let Some(s) = samples.iter().find(|s| !usable(s.value) || !usable(s.lag)) {
        return Err(SineFitError::NotPositive { lag: s.lag, value: s.value });
    }
    let mut previous = 0.0;
    for &wavelength in wavelengths {
        if !(wavelength > previous && wavelength.is_finite()) {
            return Err(SineFitError::Wavelength { wavelength });
        }
        previous = wavelength;
    }
    Ok(())
}

/// Half the measured correlation at half the wavelength, `2 D^2 = C / 2`: about right for a
/// correlation that doubles with the lag, and never zero.
fn starting_amplitude(samples: &[CorrelationSample], wavelength: f64) -> f64 {
    let distance = |s: &CorrelationSample| (2.0 * s.lag / wavelength).ln().abs();
    let nearest = samples.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(0.0, |sample| (sample.value / 4.0).sqrt())
}

/// Karush-Kuhn-Tucker condition of the amplitudes that went to zero.
fn check_zeros(
    full: &LogarithmicCost,
    active: &[usize],
    relative: &DVector<f64>,
    wavelengths: &[f64],
) -> Result<(), SineFitError> {
    let mut amplitudes = DVector::zeros(wavelengths.len());
    active.iter().zip(relative.iter()).for_each(|(&i, &x)| amplitudes[i] = x);
    let multipliers = full.derivative_by_squares(&amplitudes);
    let zeros = (0..wavelengths.len()).filter(|i| !active.contains(i));
    match zeros.map(|i| (wavelengths[i], multipliers[i])).find(|(_, m)| *m < -GRADIENT_TOLERANCE) {
        Some((wavelength, multiplier)) => Err(SineFitError::NotOptimal { wavelength, multiplier }),
        None => Ok(()),
    }
}

/// Residual, condition and intervals at a solution.
fn report(
    model: &LogarithmicCost,
    active: &[usize],
    relative: &DVector<f64>,
    wavelengths: &[f64],
    start: &[f64],
    iterations: u64,
) -> SineFit {
    let residuals = model.residuals(relative);
    let jacobian = model.logarithmic_jacobian(relative);
    let lags = residuals.len();
    let freedom = (lags - active.len()) as f64;
    let spread = student_t_975(freedom) * (residuals.norm_squared() / freedom).sqrt();
    let gradient_norm = 2.0 * jacobian.tr_mul(&residuals).norm() / lags as f64;
    let svd = jacobian.svd(false, true);
    let singular = &svd.singular_values;
    let directions = svd.v_t.as_ref().expect("the right singular vectors were asked for");
    let condition_number = singular.max() / singular.min();
    let mut scales: Vec<FittedScale> = wavelengths
        .iter()
        .map(|&wavelength| SineScale { wavelength, amplitude: 0.0 })
        .map(|scale| FittedScale { scale, confidence_95: None })
        .collect();
    for (k, &i) in active.iter().enumerate() {
        let amplitude = relative[k].abs() * start[i];
        let terms = directions.column(k).component_div(singular);
        // Not by an infinite factor: the spread of a fit without residual is zero.
        let determined = condition_number < SINGULAR;
        let half_width = if determined { amplitude * spread * terms.norm() } else { f64::INFINITY };
        scales[i].scale.amplitude = amplitude;
        scales[i].confidence_95 = Some(half_width);
    }
    SineFit {
        scales,
        rms_residual: residuals.norm() / (lags as f64).sqrt(),
        condition_number,
        gradient_norm,
        iterations,
        lags,
    }
}

#[cfg(test)]
mod tests;
