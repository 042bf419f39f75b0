//! How many realisations the scans are worth: beyond that, more draws make an average that is certain of a road that is not.

use super::CurveRow;
use crate::contact::refine::LEAST_FRICTION;
use crate::numerics::statistics::MeanEstimate;

/// Part of the error by the choice of scans that phases may add: the error of both is then 12 % above that of the scans.
pub(crate) const NEGLIGIBLE: f64 = 0.5;

/// What more realisations cannot mend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Worth {
    /// Sines: relative half widths of the 95 % intervals by the choice of scans, one for each value of the curves; empty if
    /// unknown.
    Errors(Vec<f64>),
    /// Draws of this number of windows, one after the other: the scatter between the windows.
    Windows(usize),
}

impl Worth {
    /// Nothing limits the accuracy but the number of realisations.
    pub const UNLIMITED: Self = Self::Errors(Vec::new());

    /// Number of realisations for which the statistical error of the average, half the width of its 95 % interval, fits at
    /// every value into what the other errors leave of the relative `tolerance`, or adds little to what the scans are worth.
    /// `curves` are those of the realisations so far, each at the same values. None where it cannot be told: of one curve, or
    /// if the other errors leave nothing.
    pub fn realisations_needed(&self, curves: &[&[CurveRow]], tolerance: f64) -> Option<usize> {
        let values = curves.first().map_or(0, |curve| curve.len());
        let at_value = |k: usize| {
            let friction: Vec<f64> =
                curves.iter().map(|curve| curve[k].friction_coefficient).collect();
            let mean = MeanEstimate::of(&friction).mean.abs().max(LEAST_FRICTION);
            let error = |row: &CurveRow| {
                row.interpolation_error
                    + row.discretisation_error.unwrap_or(0.0)
                    + row.left_out_error
            };
            let others =
                curves.iter().map(|curve| error(&curve[k])).sum::<f64>() / curves.len() as f64;
            let left = tolerance * mean - others;
            match self {
                Self::Windows(windows) if *windows > 1 => draws_needed(&friction, *windows, left),
                Self::Windows(_) => MeanEstimate::of(&friction).count_for(left),
                Self::Errors(errors) => {
                    let by_scans = errors.get(k).map_or(0.0, |error| error * mean);
                    MeanEstimate::of(&friction).count_for(left.max(NEGLIGIBLE * by_scans))
                }
            }
        };
        let counts: Option<Vec<usize>> = (0..values).map(at_value).collect();
        counts?.into_iter().max()
    }

    /// The next number of draws that takes all windows equally often.
    pub fn whole_rounds(&self, count: usize) -> usize {
        match self {
            Self::Windows(windows) => count.next_multiple_of((*windows).max(1)),
            Self::Errors(_) => count,
        }
    }
}

/// Draws, all windows equally often, for which the interval by the means of the windows is at most `left` to each side, or
/// for which the scatter of the draws adds little to that between the windows (analysis of variance of one factor).
fn draws_needed(friction: &[f64], windows: usize, left: f64) -> Option<usize> {
    let solved = friction.len();
    if left <= 0.0 {
        return None;
    }
    if solved < windows {
        return Some(windows);
    }
    let each = solved / windows;
    let draws = |window: usize| -> Vec<f64> {
        friction.iter().skip(window).step_by(windows).take(each).copied().collect()
    };
    let of_windows: Vec<MeanEstimate> =
        (0..windows).map(|window| MeanEstimate::of(&draws(window))).collect();
    let means: Vec<f64> = of_windows.iter().map(|own| own.mean).collect();
    let between = MeanEstimate::of(&means);
    if between.confidence_95 <= left {
        return Some(solved);
    }
    if each < 2 {
        return Some(2 * windows);
    }
    let count = windows as f64;
    let of_draws = of_windows.iter().map(|own| own.standard_deviation.powi(2)).sum::<f64>() / count;
    let total = between.standard_deviation.powi(2) / count;
    let of_road = (total - of_draws / (count * each as f64)).max(0.0);
    let quantile = between.confidence_95 / total.sqrt();
    let allowed = ((left / quantile).powi(2) - of_road).max(NEGLIGIBLE.powi(2) * of_road);
    let needed = (of_draws / (count * allowed)).ceil();
    needed.is_finite().then(|| (windows as f64 * needed).max(solved as f64) as usize)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::stages::bem::Given;
    use crate::stages::realise::SurfaceKind;

    pub fn row(friction_coefficient: f64, interpolation_error: f64) -> CurveRow {
        CurveRow {
            kind: SurfaceKind::sines(1),
            realisation: 1,
            speed_mm_s: 1.0,
            given: Given::Area,
            contact_area_fraction: 0.1,
            pressure_mpa: 1.0,
            friction_coefficient,
            interpolation_error,
            discretisation_error: None,
            left_out_error: 0.0,
            relative_area_error: None,
        }
    }

    fn needed(worth: &Worth, friction: &[f64], error: f64, tolerance: f64) -> Option<usize> {
        let curves: Vec<[CurveRow; 1]> = friction.iter().map(|f| [row(*f, error)]).collect();
        let curves: Vec<&[CurveRow]> = curves.iter().map(|curve| &curve[..]).collect();
        worth.realisations_needed(&curves, tolerance)
    }

    #[test]
    fn the_number_follows_from_the_spread_and_what_is_left_of_the_tolerance() {
        let friction = [0.9, 1.0, 1.1, 1.0];
        let spread = MeanEstimate::of(&friction);
        let of = |friction: &[f64], error, tolerance| {
            needed(&Worth::UNLIMITED, friction, error, tolerance)
        };
        assert_eq!(of(&friction, 0.0, 0.05), spread.count_for(0.05));
        assert_eq!(of(&friction, 0.03, 0.05), spread.count_for(0.02));
        assert_eq!(of(&friction, 0.05, 0.05), None);
        assert_eq!(of(&friction[..1], 0.0, 0.05), None);
    }

    #[test]
    fn phases_are_not_known_better_than_half_of_what_the_scans_leave() {
        let friction = [0.9, 1.0, 1.1, 1.0];
        let spread = MeanEstimate::of(&friction);
        let scans = Worth::Errors(vec![0.2]);
        assert_eq!(needed(&scans, &friction, 0.0, 0.01), spread.count_for(0.1));
        assert_eq!(needed(&scans, &friction, 0.0, 0.15), spread.count_for(0.15));
        // The other errors leave nothing of the tolerance, and matter less than the scans.
        assert_eq!(needed(&scans, &friction, 0.02, 0.01), spread.count_for(0.1));
    }

    #[test]
    fn draws_stop_where_the_windows_make_the_error() {
        let windows = Worth::Windows(3);
        // Three windows that differ by much, and draws that differ by little: two of each tell that no more help.
        let apart = [0.5, 1.0, 1.5, 0.52, 1.02, 1.52];
        assert_eq!(needed(&windows, &apart[..2], 0.0, 0.01), Some(3));
        assert_eq!(needed(&windows, &apart[..3], 0.0, 0.01), Some(6));
        assert_eq!(needed(&windows, &apart, 0.0, 0.01), Some(6));
        // Windows that are alike, and draws that differ: as many as the tolerance asks for. The variance of a draw is
        // 0.02, the means are 0.995, 1 and 1.005, t(2) = 4.3027: 0.02 / (3 (0.002/4.302 65)^2) = 30 854.7 of each.
        let alike = [0.895, 0.9, 0.905, 1.095, 1.1, 1.105];
        assert_eq!(needed(&windows, &alike, 0.0, 0.02), Some(6));
        assert_eq!(needed(&windows, &alike, 0.0, 0.002), Some(3 * 30_855));
        assert_eq!(windows.whole_rounds(8), 9);
        assert_eq!(Worth::UNLIMITED.whole_rounds(8), 8);
        // One window has no interval: its draws are refined like sines without scans.
        let one = Worth::Windows(1);
        assert_eq!(needed(&one, &alike, 0.0, 0.1), MeanEstimate::of(&alike).count_for(0.1));
    }
}
