//! First shift factors between sweeps, in closed form.
//!
//! Of two sweeps at neighbouring temperatures, the range of storage moduli that both have is
//! taken; the area between the two curves over it, divided by its height in ln E', is the
//! shift (Gergesova, Zupančič, Saprunov & Emri, J. Rheol. 55, 1, 2011, doi:10.1122/1.3503529):
//!
//! ```text
//! ln a_B - ln a_A = integral (ln ω_A(E') - ln ω_B(E')) d ln E' / (ln E'_high - ln E'_low)
//! ```

use super::{FitError, Sweep};

/// Points of each of two sweeps that must lie in the moduli of the other.
const LEAST_COMMON_POINTS: usize = 2;

/// ln a of every sweep, sorted by temperature, relative to the reference.
///
/// # Errors
/// [`FitError::NoOverlap`] of two neighbours.
pub(super) fn first_shifts(sweeps: &[Sweep], reference: usize) -> Result<Vec<f64>, FitError> {
    let mut shifts = vec![0.0];
    for pair in sweeps.windows(2) {
        let last = shifts[shifts.len() - 1];
        shifts.push(last + pair_shift(&pair[0], &pair[1])?);
    }
    let offset = shifts[reference];
    Ok(shifts.iter().map(|shift| shift - offset).collect())
}

fn pair_shift(colder: &Sweep, hotter: &Sweep) -> Result<f64, FitError> {
    let curves = [rising(colder), rising(hotter)];
    let low = curves.iter().map(|curve| curve[0][1]).fold(f64::NEG_INFINITY, f64::max);
    let high = curves.iter().map(|curve| curve[curve.len() - 1][1]).fold(f64::INFINITY, f64::min);
    let common = |sweep: &Sweep| {
        let inside = |modulus: f64| (low..=high).contains(&modulus.ln());
        sweep.points.iter().filter(|point| inside(point.storage_modulus)).count()
    };
    if high <= low || common(colder).min(common(hotter)) < LEAST_COMMON_POINTS {
        return Err(FitError::NoOverlap {
            colder_c: colder.temperature_c.unwrap_or(f64::NAN),
            hotter_c: hotter.temperature_c.unwrap_or(f64::NAN),
            colder_mpa: storage_range_mpa(colder),
            hotter_mpa: storage_range_mpa(hotter),
        });
    }
    let area = |curve: &[[f64; 2]]| integral(curve, low, high);
    Ok((area(&curves[0]) - area(&curves[1])) / (high - low))
}

/// ln ω and ln E' by ascending frequency; where noise lets E' fall, its running maximum.
fn rising(sweep: &Sweep) -> Vec<[f64; 2]> {
    let mut highest = f64::NEG_INFINITY;
    let point = |point: &super::SweepPoint| {
        highest = highest.max(point.storage_modulus.ln());
        [point.angular_frequency.ln(), highest]
    };
    sweep.points.iter().map(point).collect()
}

/// `integral of x dy` along a rising polyline of points (x, y), between two y.
fn integral(curve: &[[f64; 2]], low: f64, high: f64) -> f64 {
    let piece = |pair: &[[f64; 2]]| {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        let (from, to) = (y0.max(low), y1.min(high));
        if to <= from {
            return 0.0;
        }
        let at = |y: f64| x0 + (x1 - x0) * (y - y0) / (y1 - y0);
        0.5 * (at(from) + at(to)) * (to - from)
    };
    curve.windows(2).map(piece).sum()
}

fn storage_range_mpa(sweep: &Sweep) -> [f64; 2] {
    let moduli = || sweep.points.iter().map(|point| point.storage_modulus / 1e6);
    [moduli().fold(f64::INFINITY, f64::min), moduli().fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::super::SweepPoint;
    use super::*;

    fn sweep(temperature_c: f64, shift: f64, frequencies: std::ops::Range<i32>) -> Sweep {
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
            // Linear in the logarithms, so that interpolation is exact.
            let storage_modulus = 1e6 * (angular_frequency * shift).powf(0.3);
            SweepPoint { angular_frequency, storage_modulus, loss_modulus: 1e5 }
        };
        Sweep { temperature_c: Some(temperature_c), points: frequencies.map(point).collect() }
    }

    #[test]
    fn the_shift_of_straight_lines_is_exact() {
        let sweeps = [sweep(0.0, 50.0, -4..9), sweep(20.0, 1.0, -4..9), sweep(40.0, 0.1, -4..9)];
        let shifts = first_shifts(&sweeps, 1).unwrap();
        let expected = [50_f64.ln(), 0.0, 0.1_f64.ln()];
        for (shift, expected) in shifts.iter().zip(expected) {
            approx::assert_abs_diff_eq!(*shift, expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn sweeps_apart_are_named() {
        let sweeps = [sweep(0.0, 1e4, 0..9), sweep(20.0, 1.0, 0..9)];
        let message = first_shifts(&sweeps, 0).unwrap_err().to_string();
        assert!(message.contains("0 °C") && message.contains("20 °C"), "{message}");
    }
}
