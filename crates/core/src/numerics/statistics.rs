//! Means, spreads and confidence intervals of small samples, and lines through points.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Mean of a sample with its spread and the confidence interval of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanEstimate {
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation (divisor n - 1); NaN for fewer than two values.
    pub standard_deviation: f64,
    /// Half width of the two-sided 95 % confidence interval of the mean, Student's t with n - 1
    /// degrees of freedom; NaN for fewer than two values.
    pub confidence_95: f64,
    /// Number of values.
    pub count: usize,
}

impl MeanEstimate {
    /// Estimate from a sample; the values are taken as independent.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len();
        let n = count as f64;
        let mean = values.iter().sum::<f64>() / n;
        if count < 2 {
            return Self { mean, standard_deviation: f64::NAN, confidence_95: f64::NAN, count };
        }
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let standard_deviation = variance.sqrt();
        let confidence_95 = student_t_975(n - 1.0) * standard_deviation / n.sqrt();
        Self { mean, standard_deviation, confidence_95, count }
    }

    /// How many values of this spread have a mean whose 95 % confidence interval is at most as wide as `half_width` to
    /// each side: the smallest `n` with `t(n - 1) s <= half_width sqrt(n)`. `None` for a half width that is not
    /// positive, or an unknown spread.
    pub fn count_for(&self, half_width: f64) -> Option<usize> {
        let ratio = self.standard_deviation / half_width;
        if !(half_width > 0.0 && ratio.is_finite()) {
            return None;
        }
        let is_enough =
            |count: usize| student_t_975(count as f64 - 1.0) * ratio <= (count as f64).sqrt();
        // Doubled until it suffices, then bisected: unit steps would take as many steps as the number itself.
        let mut enough = 2;
        while !is_enough(enough) {
            enough = enough.checked_mul(2)?;
        }
        let mut too_few = enough / 2;
        while enough - too_few > 1 {
            let middle = too_few + (enough - too_few) / 2;
            if is_enough(middle) {
                enough = middle;
            } else {
                too_few = middle;
            }
        }
        Some(enough)
    }
}

/// Least-squares line of `y` over `x`: intercept and slope. The slope of fewer than two different
/// `x` is NaN.
pub fn least_squares_line(
    x: impl Iterator<Item = f64> + Clone,
    y: impl Iterator<Item = f64> + Clone,
) -> (f64, f64) {
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) =
            values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        sum / count
    };
    let (mean_x, mean_y) = (mean(&mut x.clone()), mean(&mut y.clone()));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (x, y) in x.zip(y) {
        covariance += (x - mean_x) * (y - mean_y);
        variance += (x - mean_x).powi(2);
    }
    let slope = covariance / variance;
    (mean_y - slope * mean_x, slope)
}

/// The 97.5 % quantile of Student's t, the factor of a two-sided 95 % interval.
///
/// # Panics
/// If `degrees_of_freedom` is not positive.
pub fn student_t_975(degrees_of_freedom: f64) -> f64 {
    const MANY: f64 = 1e3;
    const NORMAL: f64 = 1.959_963_984_540_054;
    if degrees_of_freedom >= MANY {
        // Abramowitz & Stegun 26.7.5, of which the next term is below 1e-11. The library loses digits there, and does
        // not terminate for the largest numbers.
        let (z2, n) = (NORMAL * NORMAL, degrees_of_freedom);
        let first = (z2 + 1.0) / 4.0;
        let second = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
        let third = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
        return NORMAL * (1.0 + (first + (second + third / n) / n) / n);
    }
    StudentsT::new(0.0, 1.0, degrees_of_freedom)
        .expect("degrees of freedom must be positive")
        .inverse_cdf(0.975)
}

/// Half width of the 95 % interval of a sum of independent parts, from the half width and the degrees of freedom of the
/// interval of each: the standard errors add in squares, and Student's t has the degrees of freedom
/// `(sum s²)² / sum (s⁴/n)` (Satterthwaite 1946, doi:10.2307/3002019). Intervals that add in squares instead are too wide,
/// because all parts are not off at once by what their few values leave open. Never below the widest of the parts.
pub fn combined_95(parts: &[(f64, f64)]) -> f64 {
    let variances = || {
        let standard_error = |&(half_width, freedom): &(f64, f64)| {
            if half_width == 0.0 { 0.0 } else { half_width / student_t_975(freedom) }
        };
        parts.iter().map(move |part| (standard_error(part).powi(2), part.1))
    };
    let sum: f64 = variances().map(|(variance, _)| variance).sum();
    if sum == 0.0 {
        return 0.0;
    }
    let present = variances().filter(|(variance, _)| *variance != 0.0);
    let freedom = sum.powi(2) / present.map(|(variance, n)| variance.powi(2) / n).sum::<f64>();
    let widest = parts.iter().map(|part| part.0).fold(0.0, f64::max);
    (student_t_975(freedom) * sum.sqrt()).max(widest)
}

/// Half width of the two-sided 95 % jackknife interval from the n estimates that leave out one
/// member of the sample each: `t sqrt((n - 1)/n sum of (estimate - mean)^2)`, Student's t with n - 1
/// degrees of freedom.
///
/// # Panics
/// For fewer than two estimates.
pub fn jackknife_95(estimates: &[f64]) -> f64 {
    delete_d_jackknife_95(estimates, estimates.len(), 1)
}

/// Half width of the two-sided 95 % interval from estimates that leave out `left_out` of `members` each:
/// `t sqrt((members - left_out)/left_out mean of (estimate - mean)^2)`, Student's t with `members - 1` degrees of freedom.
///
/// For an estimate that is linear in the members it is that of the jackknife, if all pairs of members are left out
/// together equally often. For one that is not smooth, such as an amplitude that vanishes, the jackknife of single members
/// fails, because they change less than the error is; halves change as much as the error
/// (Shao & Wu 1989, doi:10.1214/aos/1176347263).
///
/// # Panics
/// For fewer than two members.
pub fn delete_d_jackknife_95(estimates: &[f64], members: usize, left_out: usize) -> f64 {
    let n = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / n;
    let squares: f64 = estimates.iter().map(|estimate| (estimate - mean).powi(2)).sum();
    let (all, out) = (members as f64, left_out as f64);
    student_t_975(all - 1.0) * ((all - out) / out * squares / n).sqrt()
}

/// Halves of up to six members, of which each is left out in turn: every member equally often, every pair of them equally
/// often. Of an odd number the smaller half. All halves of five and fewer, ten of the twenty of six (a balanced block design).
///
/// # Panics
/// For fewer than two members or more than six.
pub fn balanced_halves(members: usize) -> Vec<Vec<usize>> {
    assert!((2..=6).contains(&members), "{members} members");
    if members == 6 {
        const BLOCKS: [[usize; 3]; 10] = [
            [0, 1, 2],
            [0, 1, 3],
            [0, 2, 4],
            [0, 3, 5],
            [0, 4, 5],
            [1, 2, 5],
            [1, 3, 4],
            [1, 4, 5],
            [2, 3, 4],
            [2, 3, 5],
        ];
        return BLOCKS.map(Vec::from).to_vec();
    }
    let of_a_half = |set: &usize| set.count_ones() as usize == members / 2;
    let members_of = |set: usize| (0..members).filter(|k| set >> k & 1 == 1).collect();
    (0..1 << members).filter(of_a_half).map(members_of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again_and_one_point_makes_none() {
        let x = [0.0, 1.0, 4.0];
        let (intercept, slope) =
            least_squares_line(x.into_iter(), x.into_iter().map(|x| 3.0 - 2.0 * x));
        approx::assert_abs_diff_eq!(intercept, 3.0, epsilon = 1e-14);
        approx::assert_abs_diff_eq!(slope, -2.0, epsilon = 1e-15);
        // Normal equations by hand: means 1 and 2, covariance 1, variance 2.
        let (intercept, slope) =
            least_squares_line([0.0, 1.0, 2.0].into_iter(), [1.0, 3.0, 2.0].into_iter());
        assert_eq!((intercept, slope), (1.5, 0.5));
        let one = || [1.0].into_iter();
        assert!(least_squares_line(one(), one()).1.is_nan());
    }

    #[test]
    fn interval_of_five_values_uses_the_tabulated_quantile() {
        let estimate = MeanEstimate::of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(estimate.mean, 3.0);
        approx::assert_relative_eq!(estimate.standard_deviation, 2.5_f64.sqrt(), epsilon = 1e-14);
        // t(0.975, 4) = 2.776445 in every table.
        let expected = 2.776_445_105 * 2.5_f64.sqrt() / 5.0_f64.sqrt();
        approx::assert_relative_eq!(estimate.confidence_95, expected, max_relative = 1e-8);
    }

    #[test]
    fn the_count_for_a_half_width_is_the_smallest_that_has_it() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let estimate = MeanEstimate::of(&values);
        // Five values have this interval; a slightly smaller one takes six.
        assert_eq!(estimate.count_for(estimate.confidence_95 * 1.0001), Some(5));
        assert_eq!(estimate.count_for(estimate.confidence_95 * 0.9999), Some(6));
        // Of many, (1.96 s / w)^2 = 9604 * 2.5.
        let many = estimate.count_for(0.02).unwrap();
        assert!((24_010..24_020).contains(&many), "{many}");
        // However many: (1.96 s / w)^2 = 9.6e14.
        let millions = estimate.count_for(1e-7).unwrap() as f64;
        approx::assert_relative_eq!(millions, 9.603_647e14, max_relative = 1e-6);
        assert_eq!(estimate.count_for(0.0), None);
        assert_eq!(MeanEstimate::of(&[1.0]).count_for(0.1), None);
        assert_eq!(MeanEstimate::of(&[1.0, 1.0]).count_for(1e-9), Some(2));
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_interval() {
        let values = [1.0, 2.5, 3.0, 4.0, 7.0];
        let sum: f64 = values.iter().sum();
        let without: Vec<f64> = values.iter().map(|value| (sum - value) / 4.0).collect();
        let expected = MeanEstimate::of(&values).confidence_95;
        approx::assert_relative_eq!(jackknife_95(&without), expected, max_relative = 1e-13);
    }

    #[test]
    fn quantiles_go_over_into_the_normal_distribution() {
        let probability = StudentsT::new(0.0, 1.0, 1e3).unwrap().cdf(student_t_975(1e3));
        approx::assert_relative_eq!(probability, 0.975, max_relative = 1e-10);
        // The slope there is 2.4e-6.
        let (before, after) = (student_t_975(999.999), student_t_975(1e3));
        approx::assert_relative_eq!(before, after, max_relative = 1e-8);
        approx::assert_relative_eq!(
            student_t_975(1e15),
            1.959_963_984_540_054,
            max_relative = 1e-12
        );
    }

    #[test]
    fn a_single_value_has_no_interval() {
        let estimate = MeanEstimate::of(&[2.0]);
        assert_eq!(estimate.mean, 2.0);
        assert!(estimate.confidence_95.is_nan());
    }

    #[test]
    fn parts_add_with_the_degrees_of_freedom_of_both() {
        assert_eq!(combined_95(&[(0.0, 5.0), (0.0, 3.0)]), 0.0);
        approx::assert_relative_eq!(
            combined_95(&[(0.3, 5.0), (0.0, 0.0)]),
            0.3,
            max_relative = 1e-12
        );
        // Two equal parts of five degrees have ten: 2.228 139 in every table.
        let one = student_t_975(5.0);
        let both = combined_95(&[(one, 5.0), (one, 5.0)]);
        approx::assert_relative_eq!(both, 2.228_139 * 2.0_f64.sqrt(), max_relative = 1e-6);
        // 1 and 2 with 4 and 9 degrees: 25 / (1/4 + 16/9) = 12.329 degrees.
        let parts = [(student_t_975(4.0), 4.0), (2.0 * student_t_975(9.0), 9.0)];
        let expected = student_t_975(25.0 / (0.25 + 16.0 / 9.0)) * 5.0_f64.sqrt();
        approx::assert_relative_eq!(combined_95(&parts), expected, max_relative = 1e-12);
        // Of two values and of many: 12.7 and 2, whose errors together have 1.2 degrees.
        assert_eq!(combined_95(&[(12.7, 1.0), (0.9, 1e6)]), 12.7);
    }

    #[test]
    fn halves_are_balanced_and_give_the_variance_of_a_mean() {
        for members in 2..=6 {
            let halves = balanced_halves(members);
            assert!(halves.iter().all(|half| half.len() == members / 2));
            let both = |i: usize, j: usize| {
                halves.iter().filter(|half| half.contains(&i) && half.contains(&j)).count()
            };
            for i in 0..members {
                assert_eq!(both(i, i), both(0, 0));
                for j in 0..i {
                    assert_eq!(both(i, j), both(0, 1), "{members}: {i} {j}");
                }
            }
            let values = &[1.0, 2.0, 4.0, 8.0, 16.0, 32.0][..members];
            let without = |half: &Vec<usize>| {
                let rest = (0..members).filter(|k| !half.contains(k));
                rest.map(|k| values[k]).sum::<f64>() / (members - half.len()) as f64
            };
            let estimates: Vec<f64> = halves.iter().map(without).collect();
            let found = delete_d_jackknife_95(&estimates, members, members / 2);
            let expected = MeanEstimate::of(values).confidence_95;
            approx::assert_relative_eq!(found, expected, max_relative = 1e-12);
        }
    }
}
