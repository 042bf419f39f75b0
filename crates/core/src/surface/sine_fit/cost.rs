//! The cost of a fit of sines, its derivatives and its minimum.

use argmin::core::{
    CostFunction, Error, Executor, Gradient, Hessian, IterState, KV, Problem, Solver, State,
    TerminationReason, TerminationStatus,
};
use argmin::solver::trustregion::{Steihaug, TrustRegion};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::LN_10;

/// Gradient norm at which the trust region hands over to Newton's method.
const NEWTON_BASIN: f64 = 1e-7;

/// Halvings of a Newton step before it counts as round-off.
const MOST_HALVINGS: i32 = 10;

/// More than ten times what any fit in the tests takes.
const MAXIMUM_ITERATIONS: u64 = 1000;

/// `f(x) = mean over j of r_j^2`, `r_j = log10 sum_i x_i^2 G_ji - y_j`, with the relative amplitudes
/// `x_i = D_i / D_i,start` and `G_ji = D_i,start^2 g_i(s_j)`.
#[derive(Debug, Clone)]
pub(super) struct LogarithmicCost {
    shapes: DMatrix<f64>,
    measured: DVector<f64>,
}

impl LogarithmicCost {
    /// From the correlations of unit sines (one column a wave, one row a lag), the measured
    /// `log10 C` and the starting amplitudes.
    pub(super) fn new(units: &DMatrix<f64>, measured: &DVector<f64>, start: &[f64]) -> Self {
        let shapes = DMatrix::from_fn(units.nrows(), units.ncols(), |j, i| {
            units[(j, i)] * start[i] * start[i]
        });
        Self { shapes, measured: measured.clone() }
    }

    /// The same cost with the other waves at amplitude zero.
    pub(super) fn of_waves(&self, waves: &[usize]) -> Self {
        Self { shapes: self.shapes.select_columns(waves), measured: self.measured.clone() }
    }

    fn sums(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.shapes * x.component_mul(x)
    }

    /// `r_j`.
    pub(super) fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
        self.sums(x).map(f64::log10) - &self.measured
    }

    /// `w_ji = G_ji / sum_k x_k^2 G_jk`, so that `d r_j / d x_i = 2 x_i w_ji / ln 10`.
    fn weights(&self, x: &DVector<f64>) -> DMatrix<f64> {
        let sums = self.sums(x);
        DMatrix::from_fn(self.shapes.nrows(), self.shapes.ncols(), |j, i| {
            self.shapes[(j, i)] / sums[j]
        })
    }

    /// `d r_j / d ln x_i = 2 x_i^2 w_ji / ln 10`: twice the share of wave i, in decades.
    pub(super) fn logarithmic_jacobian(&self, x: &DVector<f64>) -> DMatrix<f64> {
        self.weights(x) * DMatrix::from_diagonal(&(x.component_mul(x) * (2.0 / LN_10)))
    }

    /// `d f / d (x_i^2) = 2 mean_j r_j w_ji / ln 10`.
    pub(super) fn derivative_by_squares(&self, x: &DVector<f64>) -> DVector<f64> {
        self.weights(x).tr_mul(&self.residuals(x)) * (2.0 / (LN_10 * self.measured.len() as f64))
    }
}

impl CostFunction for LogarithmicCost {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, x: &Self::Param) -> Result<f64, Error> {
        Ok(self.residuals(x).norm_squared() / self.measured.len() as f64)
    }
}

impl Gradient for LogarithmicCost {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, x: &Self::Param) -> Result<Self::Gradient, Error> {
        Ok(2.0 * self.derivative_by_squares(x).component_mul(x))
    }
}

impl Hessian for LogarithmicCost {
    type Param = DVector<f64>;
    type Hessian = DMatrix<f64>;

    /// `2 d_ik f_i + 4 x_i x_k f_ik` from the first and second derivatives of f by the squares,
    /// `f_ik = 2 mean_j w_ji w_jk (1/ln 10 - r_j) / ln 10`.
    fn hessian(&self, x: &Self::Param) -> Result<Self::Hessian, Error> {
        let weights = self.weights(x);
        let factors = self.residuals(x).map(|r| 1.0 / LN_10 - r);
        let scale = 2.0 / (LN_10 * self.measured.len() as f64);
        let second = weights.tr_mul(&(DMatrix::from_diagonal(&factors) * &weights)) * scale;
        let diagonal = 2.0 * self.derivative_by_squares(x);
        let coupled = second.component_mul(&(x * x.transpose())) * 4.0;
        Ok(coupled + DMatrix::from_diagonal(&diagonal))
    }
}

/// Where a minimisation ended.
pub(super) struct Minimum {
    pub(super) amplitudes: DVector<f64>,
    pub(super) gradient_norm: f64,
    pub(super) iterations: u64,
}

type AmplitudeState = IterState<DVector<f64>, DVector<f64>, (), DMatrix<f64>, (), f64>;
type SteihaugRegion = TrustRegion<Steihaug<DVector<f64>, f64>, f64>;

/// A trust region that ends at a small gradient; argmin's own has no criterion of the kind.
struct UntilStationary {
    region: SteihaugRegion,
    tolerance: f64,
}

impl Solver<LogarithmicCost, AmplitudeState> for UntilStationary {
    fn name(&self) -> &'static str {
        "trust region until the gradient is small"
    }

    fn init(
        &mut self,
        problem: &mut Problem<LogarithmicCost>,
        state: AmplitudeState,
    ) -> Result<(AmplitudeState, Option<KV>), Error> {
        self.region.init(problem, state)
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<LogarithmicCost>,
        state: AmplitudeState,
    ) -> Result<(AmplitudeState, Option<KV>), Error> {
        self.region.next_iter(problem, state)
    }

    fn terminate(&mut self, state: &AmplitudeState) -> TerminationStatus {
        match state.get_gradient() {
            Some(gradient) if gradient.norm() <= self.tolerance => {
                TerminationStatus::Terminated(TerminationReason::SolverConverged)
            }
            _ => TerminationStatus::NotTerminated,
        }
    }
}

/// Minimise from a start; the caller checks whether the gradient is small enough.
///
/// The trust region judges a step by the fall of the cost, which round-off hides once the gradient
/// is below some 1e-9; Newton steps, judged by the gradient, go on from there.
pub(super) fn minimise(cost: &LogarithmicCost, start: DVector<f64>) -> Minimum {
    let failed = Minimum { amplitudes: start.clone(), gradient_norm: f64::NAN, iterations: 0 };
    let Ok(steihaug) = Steihaug::new().with_epsilon(1e-12) else { return failed };
    let solver = UntilStationary { region: TrustRegion::new(steihaug), tolerance: NEWTON_BASIN };
    let run = Executor::new(cost.clone(), solver)
        .configure(|state| state.param(start).max_iters(MAXIMUM_ITERATIONS))
        .timer(false)
        .run();
    let Ok(mut result) = run else { return failed };
    let iterations = result.state.get_iter();
    let Some(amplitudes) = result.state.take_param() else { return failed };
    let (amplitudes, gradient_norm) =
        newton(cost, amplitudes).unwrap_or((failed.amplitudes, f64::NAN));
    Minimum { amplitudes, gradient_norm, iterations }
}

/// Newton steps for as long as the gradient falls; returns the last point and its gradient norm.
/// Directions in which the cost does not change are left alone.
///
/// A step that makes the gradient grow is halved: waves that are hard to distinguish leave a valley
/// so flat along its bottom that a whole step leaves the reach of the quadratic model, but along a
/// Newton step the gradient falls at first.
fn newton(
    cost: &LogarithmicCost,
    mut amplitudes: DVector<f64>,
) -> Result<(DVector<f64>, f64), Error> {
    let mut gradient = cost.gradient(&amplitudes)?;
    loop {
        let svd = cost.hessian(&amplitudes)?.svd(true, true);
        let flat = 1e-12 * svd.singular_values.max();
        let step = svd.solve(&gradient, flat).map_err(Error::msg)?;
        let mut shortened = (0..=MOST_HALVINGS).filter_map(|halvings| {
            let next = &amplitudes - &step * 0.5_f64.powi(halvings);
            let next_gradient = cost.gradient(&next).ok()?;
            (next_gradient.norm() < gradient.norm()).then_some((next, next_gradient))
        });
        let Some(better) = shortened.next() else {
            return Ok((amplitudes, gradient.norm()));
        };
        (amplitudes, gradient) = better;
    }
}
