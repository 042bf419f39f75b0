//! Nonlinear least squares: a trust region on the Gauss-Newton model, closed by Gauss-Newton steps.

use argmin::core::{CostFunction, Error, Executor, Gradient, Hessian, State};
use argmin::solver::trustregion::{Steihaug, TrustRegion};
use nalgebra::{DMatrix, DVector};

/// More than ten times the iterations of a converging fit.
const MAXIMUM_ITERATIONS: u64 = 200;
/// Conjugate gradients end after as many steps as there are parameters but for round-off, which can keep a flat direction
/// from ever reaching the tolerance.
const MAXIMUM_INNER_ITERATIONS: u64 = 1000;
/// Relative to the largest singular value of the Jacobian; parameters do not change along flatter directions.
const FLAT: f64 = 1e-12;
/// Of the offset, see [`Minimum::offset`]; a thousandth of a standard error.
const CONVERGED_OFFSET: f64 = 1e-3;
/// Root mean square residual (relative) that is round-off of data and model.
pub(crate) const ROUND_OFF: f64 = 1e-9;

/// Residuals that depend on parameters.
pub(crate) trait LeastSquares {
    /// The residuals.
    fn residuals(&self, parameters: &DVector<f64>) -> DVector<f64>;
    /// Their derivatives, a row for each residual.
    fn jacobian(&self, parameters: &DVector<f64>) -> DMatrix<f64>;
}

/// Where a minimisation ended.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub parameters: DVector<f64>,
    /// Root mean square of the residuals.
    pub rms: f64,
    /// Part of the residuals in the tangent space over the part orthogonal to it, per degree of freedom: the distance
    /// to the minimum in standard errors (Bates & Watts, Technometrics 23, 179, 1981,
    /// doi:10.1080/00401706.1981.10486255).
    pub offset: f64,
}

impl Minimum {
    pub fn converged(&self) -> bool {
        self.rms < ROUND_OFF || self.offset < CONVERGED_OFFSET
    }
}

struct MeanSquare<'a, P>(&'a P);

impl<P: LeastSquares> CostFunction for MeanSquare<'_, P> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, parameters: &Self::Param) -> Result<f64, Error> {
        let residuals = self.0.residuals(parameters);
        Ok(residuals.norm_squared() / residuals.len() as f64)
    }
}

impl<P: LeastSquares> Gradient for MeanSquare<'_, P> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, parameters: &Self::Param) -> Result<Self::Gradient, Error> {
        let residuals = self.0.residuals(parameters);
        let gradient = self.0.jacobian(parameters).tr_mul(&residuals);
        Ok(gradient * (2.0 / residuals.len() as f64))
    }
}

impl<P: LeastSquares> Hessian for MeanSquare<'_, P> {
    type Param = DVector<f64>;
    type Hessian = DMatrix<f64>;

    /// `2 J^T J / n`: the second derivatives of the residuals are left out.
    fn hessian(&self, parameters: &Self::Param) -> Result<Self::Hessian, Error> {
        let jacobian = self.0.jacobian(parameters);
        Ok(jacobian.tr_mul(&jacobian) * (2.0 / jacobian.nrows() as f64))
    }
}

/// Minimises the sum of squares from a start; `None` if a residual is not a number.
pub(crate) fn minimise<P: LeastSquares>(problem: &P, start: DVector<f64>) -> Option<Minimum> {
    let steihaug = Steihaug::new().with_epsilon(1e-12).ok()?;
    let steihaug = steihaug.with_max_iters(MAXIMUM_INNER_ITERATIONS);
    let run = Executor::new(MeanSquare(problem), TrustRegion::new(steihaug))
        .configure(|state| state.param(start).max_iters(MAXIMUM_ITERATIONS).target_cost(0.0))
        .timer(false)
        .run();
    let mut parameters = run.ok()?.state.get_best_param()?.clone();
    loop {
        let (step, offset) = gauss_newton(problem, &parameters)?;
        let next = &parameters - step;
        let (now, then) = (problem.residuals(&parameters).norm(), problem.residuals(&next).norm());
        let falls = then < now && gauss_newton(problem, &next)?.1 < offset;
        if !falls {
            let rms = now / (problem.residuals(&parameters).len() as f64).sqrt();
            return rms.is_finite().then_some(Minimum { parameters, rms, offset });
        }
        parameters = next;
    }
}

/// The Gauss-Newton step and the offset.
fn gauss_newton<P: LeastSquares>(
    problem: &P,
    parameters: &DVector<f64>,
) -> Option<(DVector<f64>, f64)> {
    let residuals = problem.residuals(parameters);
    let svd = problem.jacobian(parameters).svd(true, true);
    let flat = FLAT * svd.singular_values.max();
    let step = svd.solve(&residuals, flat).ok()?;
    let directions = svd.u.as_ref()?;
    let count = svd.singular_values.iter().filter(|value| **value > flat).count();
    let tangent = directions.tr_mul(&residuals);
    let within: f64 = (0..tangent.len())
        .filter(|k| svd.singular_values[*k] > flat)
        .map(|k| tangent[k].powi(2))
        .sum();
    let orthogonal = (residuals.norm_squared() - within).max(f64::MIN_POSITIVE);
    let freedom = residuals.len().saturating_sub(count).max(1) as f64;
    Some((step, (within / count as f64).sqrt() / (orthogonal / freedom).sqrt()))
}
