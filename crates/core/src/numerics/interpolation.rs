//! Interpolation between a few expensive points.

/// Piecewise cubic Hermite interpolant.
#[derive(Debug, Clone, PartialEq)]
pub struct CubicHermite {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Slopes at the points; `None` for straight lines.
    slope: Option<Vec<f64>>,
}

impl CubicHermite {
    /// Interpolant that keeps monotone data monotone (Fritsch & Carlson 1980,
    /// doi:10.1137/0717021, with the slopes of Fritsch & Butland 1984, doi:10.1137/0905021); of
    /// third order on monotone data, of second near an extremum.
    ///
    /// # Panics
    /// If the lengths differ, there is no point, or `x` does not ascend strictly.
    pub fn monotone(x: Vec<f64>, y: Vec<f64>) -> Self {
        Self::with_slopes(x, y, harmonic_slope, limited_end_slope)
    }

    /// Interpolant with the slopes of [`Self::smooth`] as far as they keep monotone data monotone:
    /// at most three times the smaller secant (de Boor & Swartz 1977, doi:10.1016/0021-9045(77)90067-0),
    /// zero at an extremum. On smooth data with even steps its error is a tenth of that of
    /// [`Self::monotone`]; where the data bend sharply it hugs them less closely.
    ///
    /// # Panics
    /// As [`Self::monotone`].
    pub fn monotone_parabolas(x: Vec<f64>, y: Vec<f64>) -> Self {
        Self::with_slopes(x, y, box_slope, box_end_slope)
    }

    /// Interpolant whose slope at a point is that of the parabola through it and its neighbours:
    /// for smooth data with extrema, of third order.
    ///
    /// # Panics
    /// As [`Self::monotone`].
    pub fn smooth(x: Vec<f64>, y: Vec<f64>) -> Self {
        Self::with_slopes(x, y, parabola_slope, parabola_end_slope)
    }

    /// Straight lines between the points.
    ///
    /// # Panics
    /// As [`Self::monotone`].
    pub fn linear(x: Vec<f64>, y: Vec<f64>) -> Self {
        check(&x, &y);
        Self { x, y, slope: None }
    }

    fn with_slopes(x: Vec<f64>, y: Vec<f64>, inner: SlopeRule, end: SlopeRule) -> Self {
        assert!(
            x.len() == y.len() && !x.is_empty(),
            "as many abscissae as ordinates, at least one"
        );
        assert!(x.windows(2).all(|w| w[0] < w[1]), "abscissae must ascend");
        let step: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
        let secant: Vec<f64> = y.windows(2).zip(&step).map(|(w, h)| (w[1] - w[0]) / h).collect();
        let last = secant.len();
        let slope = match last {
            0 => vec![0.0],
            1 => vec![secant[0]; 2],
            _ => {
                let mut slope = vec![end(step[0], step[1], secant[0], secant[1])];
                slope.extend(
                    (1..last).map(|i| inner(step[i - 1], step[i], secant[i - 1], secant[i])),
                );
                let (near, far) = (last - 1, last - 2);
                slope.push(end(step[near], step[far], secant[near], secant[far]));
                slope
            }
        };
        Self { x, y, slope: Some(slope) }
    }

    /// The same curve arriving at its last point with slope zero; data that are monotone stay so.
    /// Straight lines stay as they are.
    pub fn flat_at_the_end(mut self) -> Self {
        if let Some(slope) = self.slope.as_mut().and_then(|slope| slope.last_mut()) {
            *slope = 0.0;
        }
        self
    }

    /// Derivative at `x`; at a kink that of the piece beyond it, and zero beyond the ends, where
    /// [`Self::at`] is constant.
    pub fn derivative(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        if x < self.x[0] || x > self.x[last] || last == 0 {
            return 0.0;
        }
        let i = (self.x.partition_point(|knot| *knot <= x) - 1).min(last - 1);
        let step = self.x[i + 1] - self.x[i];
        let secant = (self.y[i + 1] - self.y[i]) / step;
        let Some(slope) = &self.slope else {
            return secant;
        };
        let t = (x - self.x[i]) / step;
        6.0 * t * (1.0 - t) * secant
            + (1.0 - t) * (1.0 - 3.0 * t) * slope[i]
            + t * (3.0 * t - 2.0) * slope[i + 1]
    }

    /// Value at `offset` beyond the point `piece` less the value there, which keeps all digits of small rises of large
    /// values; beyond the last point zero.
    pub fn rise(&self, piece: usize, offset: f64) -> f64 {
        if piece + 1 >= self.x.len() {
            return 0.0;
        }
        let step = self.x[piece + 1] - self.x[piece];
        let whole = self.y[piece + 1] - self.y[piece];
        let t = offset / step;
        let Some(slope) = &self.slope else {
            return t * whole;
        };
        t * (t * (3.0 - 2.0 * t) * whole
            + (1.0 - t) * step * ((1.0 - t) * slope[piece] - t * slope[piece + 1]))
    }

    /// Value at `x`; beyond the ends the value at the nearer end: nothing is extrapolated.
    pub fn at(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        if x <= self.x[0] {
            return self.y[0];
        }
        if x >= self.x[last] {
            return self.y[last];
        }
        let i = self.x.partition_point(|knot| *knot <= x) - 1;
        let step = self.x[i + 1] - self.x[i];
        let t = (x - self.x[i]) / step;
        let Some(slope) = &self.slope else {
            return (1.0 - t) * self.y[i] + t * self.y[i + 1];
        };
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * self.y[i]
            + (t3 - 2.0 * t2 + t) * step * slope[i]
            + (3.0 * t2 - 2.0 * t3) * self.y[i + 1]
            + (t3 - t2) * step * slope[i + 1]
    }
}

fn check(x: &[f64], y: &[f64]) {
    assert!(x.len() == y.len() && !x.is_empty(), "as many abscissae as ordinates, at least one");
    assert!(x.windows(2).all(|w| w[0] < w[1]), "abscissae must ascend");
}

/// Slope at a point from two neighbouring steps and the secants over them; at an end the nearer
/// step comes first.
type SlopeRule = fn(f64, f64, f64, f64) -> f64;

/// Weighted harmonic mean of the secants; zero at an extremum.
fn harmonic_slope(left: f64, right: f64, secant_left: f64, secant_right: f64) -> f64 {
    if secant_left * secant_right <= 0.0 {
        return 0.0;
    }
    let (a, b) = (2.0 * right + left, right + 2.0 * left);
    (a + b) / (a / secant_left + b / secant_right)
}

fn parabola_slope(left: f64, right: f64, secant_left: f64, secant_right: f64) -> f64 {
    (right * secant_left + left * secant_right) / (left + right)
}

fn parabola_end_slope(near: f64, far: f64, secant_near: f64, secant_far: f64) -> f64 {
    ((2.0 * near + far) * secant_near - near * secant_far) / (near + far)
}

/// The slope of the parabola, limited to the box in which a cubic is monotone.
fn box_slope(left: f64, right: f64, secant_left: f64, secant_right: f64) -> f64 {
    if secant_left * secant_right <= 0.0 {
        return 0.0;
    }
    let slope = parabola_slope(left, right, secant_left, secant_right);
    slope.abs().min(3.0 * secant_left.abs().min(secant_right.abs())).copysign(slope)
}

fn box_end_slope(near: f64, far: f64, secant_near: f64, secant_far: f64) -> f64 {
    let slope = parabola_end_slope(near, far, secant_near, secant_far);
    if slope * secant_near <= 0.0 {
        0.0
    } else {
        slope.abs().min(3.0 * secant_near.abs()).copysign(slope)
    }
}

/// The end slope of the parabola, limited to keep the shape.
fn limited_end_slope(near: f64, far: f64, secant_near: f64, secant_far: f64) -> f64 {
    let slope = parabola_end_slope(near, far, secant_near, secant_far);
    if slope * secant_near <= 0.0 {
        0.0
    } else if secant_near * secant_far <= 0.0 && slope.abs() > 3.0 * secant_near.abs() {
        3.0 * secant_near
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_rise_is_the_value_less_that_of_the_point_before() {
        let (x, y) = (vec![0.0, 1.0, 4.0, 4.5], vec![1.0, 3.0, 9.0, 9.1]);
        for rule in [CubicHermite::monotone_parabolas, CubicHermite::smooth, CubicHermite::linear] {
            let curve = rule(x.clone(), y.clone());
            for piece in 0..3 {
                for share in [0.0, 0.2, 0.7, 1.0] {
                    let offset = share * (x[piece + 1] - x[piece]);
                    let there = curve.at(x[piece] + offset) - y[piece];
                    approx::assert_abs_diff_eq!(curve.rise(piece, offset), there, epsilon = 1e-14);
                }
            }
            assert_eq!(curve.rise(3, 0.1), 0.0);
        }
        // A rise of one millionth keeps its digits beside a value of a million.
        let steep = CubicHermite::linear(vec![0.0, 1.0], vec![1e6, 1e6 + 1.0]);
        assert_eq!(steep.rise(0, 1e-6), 1e-6);
    }

    #[test]
    fn a_straight_line_is_exact() {
        let monotone = [CubicHermite::monotone, CubicHermite::monotone_parabolas];
        for rule in monotone.into_iter().chain([CubicHermite::smooth, CubicHermite::linear]) {
            let line = rule(vec![0.0, 1.0, 4.0], vec![1.0, 3.0, 9.0]);
            for x in [0.0, 0.3, 2.0, 3.9, 4.0] {
                approx::assert_abs_diff_eq!(line.at(x), 1.0 + 2.0 * x, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn the_derivative_is_the_limit_of_differences() {
        let x: Vec<f64> = (0..6).map(|i| f64::from(i * i)).collect();
        let y: Vec<f64> = x.iter().map(|x| (1.0 + x).ln()).collect();
        for rule in [CubicHermite::monotone, CubicHermite::smooth, CubicHermite::linear] {
            for curve in [rule(x.clone(), y.clone()), rule(x.clone(), y.clone()).flat_at_the_end()]
            {
                for place in [0.3, 2.0, 5.5, 11.0, 24.9] {
                    let difference = (curve.at(place + 1e-5) - curve.at(place - 1e-5)) / 2e-5;
                    // Differences of second order on cubics with third derivatives below one.
                    approx::assert_abs_diff_eq!(
                        curve.derivative(place),
                        difference,
                        epsilon = 1e-9
                    );
                }
            }
        }
        let flat = CubicHermite::monotone(x, y).flat_at_the_end();
        assert_eq!(flat.derivative(25.0), 0.0);
        assert_eq!(flat.derivative(26.0), 0.0);
    }

    #[test]
    fn a_smooth_curve_converges_with_third_order() {
        // Slopes of second order make an interpolant of third; the parabola's error is odd on
        // equal steps and gains an order inside.
        for rule in [CubicHermite::monotone, CubicHermite::monotone_parabolas, CubicHermite::smooth]
        {
            let error = |n: usize| {
                let x: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
                let curve = rule(x.clone(), x.iter().map(|x| x.exp()).collect());
                (0..1000)
                    .map(|i| f64::from(i) / 999.0)
                    .map(|x| (curve.at(x) - x.exp()).abs())
                    .fold(0.0_f64, f64::max)
            };
            let rate = (error(16) / error(32)).log2();
            assert!((2.7..=4.2).contains(&rate), "observed order {rate}");
        }
    }

    proptest! {
        #[test]
        fn monotone_data_stay_monotone(steps in prop::collection::vec((0.01..2.0, 0.0..5.0), 2..12)) {
            let (mut x, mut y) = (vec![0.0], vec![0.0]);
            for (dx, dy) in steps {
                x.push(x[x.len() - 1] + dx);
                y.push(y[y.len() - 1] + dy);
            }
            let end = x[x.len() - 1];
            for rule in [CubicHermite::monotone, CubicHermite::monotone_parabolas] {
                for curve in [rule(x.clone(), y.clone()), rule(x.clone(), y.clone()).flat_at_the_end()] {
                    let values: Vec<f64> =
                        (0..=500).map(|i| curve.at(end * f64::from(i) / 500.0)).collect();
                    prop_assert!(values.windows(2).all(|w| w[1] >= w[0] - 1e-12));
                }
            }
        }
    }
}
