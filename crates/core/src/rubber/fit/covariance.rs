//! The covariance of fitted parameters, and intervals from it.

use super::terms::Fitted;
use crate::numerics::statistics::student_t_975;
use nalgebra::DMatrix;

/// Covariance `s² (JᵀJ)⁻¹` of the linearised fit in the logarithms of the parameters.
pub(super) struct Covariance {
    /// Row of each parameter in `root`; `None` for a time at its limit.
    places: Vec<Option<usize>>,
    /// `s V S⁻¹` of the singular values of J = U S Vᵀ: the covariance is `root rootᵀ`.
    root: DMatrix<f64>,
    student_t: f64,
}

impl Covariance {
    pub fn new(fitted: &Fitted) -> Self {
        let Fitted { problem, series, .. } = fitted;
        let free = problem.free_columns(series);
        let jacobian = problem.logarithmic_jacobian(series).select_columns(&free);
        let mut places = vec![None; problem.parameters()];
        let svd = jacobian.svd(false, true);
        let mut root = DMatrix::zeros(free.len(), free.len());
        if let Some(directions) = &svd.v_t {
            root = directions.transpose();
            for (mut column, value) in root.column_iter_mut().zip(svd.singular_values.iter()) {
                column *= fitted.noise() / value;
            }
        }
        for (place, column) in free.iter().enumerate() {
            places[*column] = Some(place);
        }
        Self { places, root, student_t: student_t_975(fitted.freedom()) }
    }

    /// Half width of the 95 % interval of a parameter; `None` for a time at its limit.
    pub fn half_width(&self, column: usize) -> Option<f64> {
        self.places[column].map(|place| self.student_t * self.root.row(place).norm())
    }

    /// Covariance of some parameters; `None` with one at its limit.
    pub fn block(&self, columns: &[usize]) -> Option<DMatrix<f64>> {
        let places: Option<Vec<usize>> =
            columns.iter().map(|column| self.places[*column]).collect();
        let root = self.root.select_rows(&places?);
        Some(&root * root.transpose())
    }
}
