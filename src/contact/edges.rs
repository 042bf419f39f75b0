//! Contact area with the edges read between grid points.

/// Contact area fraction: the measure of the set where the pressure is positive.
///
/// Near an edge the pressure grows like the root of the distance, so its square is extrapolated
/// linearly from the last two contact points to the place where it vanishes, at most one step
/// beyond the last point. An island of one point counts one cell. Counting points alone would
/// make the area jump as the pressure changes.
pub(super) fn contact_area_fraction(pressure: &[f64]) -> f64 {
    let n = pressure.len();
    let at = |i: usize| pressure[i % n];
    let mut steps = 0.0;
    for i in 0..n {
        let (here, next) = (at(i) > 0.0, at(i + 1) > 0.0);
        match (here, next) {
            (true, true) => steps += 1.0,
            (true, false) => steps += overhang(at(i + n - 1), at(i)),
            (false, true) => steps += overhang(at(i + 2), at(i + 1)),
            (false, false) => {}
        }
    }
    steps / n as f64
}

/// Distance in grid steps from the last contact point to the edge; `inner` is the pressure one
/// point further inside.
pub(super) fn overhang(inner: f64, last: f64) -> f64 {
    if inner <= 0.0 {
        return 0.5;
    }
    let (inner, last) = (inner * inner, last * last);
    if inner <= last { 1.0 } else { (last / (inner - last)).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_under_a_root_is_read_exactly_wherever_its_edges_lie() {
        for shift in [0.0, 0.3, 0.77] {
            let pressure: Vec<f64> = (0..100)
                .map(|i| (i as f64 - 20.0 - shift).min(71.4 - i as f64).max(0.0).sqrt())
                .collect();
            let exact = (71.4 - 20.0 - shift) / 100.0;
            approx::assert_abs_diff_eq!(contact_area_fraction(&pressure), exact, epsilon = 1e-12);
        }
    }

    #[test]
    fn full_and_single_point_contact() {
        assert_eq!(contact_area_fraction(&[1.0; 8]), 1.0);
        assert_eq!(contact_area_fraction(&[0.0, 0.0, 3.0, 0.0]), 0.25);
        assert_eq!(contact_area_fraction(&[0.0; 4]), 0.0);
    }
}
