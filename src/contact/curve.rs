//! Friction over contact area, from as few pressures as the accuracy needs.

use crate::numerics::interpolation::CubicHermite;

/// One solved pressure on the way to a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Mean pressure in Pa.
    pub mean_pressure: f64,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
    /// Friction coefficient.
    pub friction_coefficient: f64,
}

/// Friction at one of the wanted contact area fractions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveValue {
    /// The wanted contact area fraction.
    pub contact_area_fraction: f64,
    /// Mean pressure in Pa, interpolated.
    pub mean_pressure: f64,
    /// Friction coefficient, interpolated.
    pub friction_coefficient: f64,
    /// Estimated error of `friction_coefficient` by interpolation, absolute: how far the curve
    /// was off at the nearest point that was solved to check it.
    pub interpolation_error: f64,
}

/// Why a curve could not be found.
#[derive(Debug, thiserror::Error)]
pub enum CurveError<E> {
    /// A solve failed.
    #[error(transparent)]
    Solve(E),
    /// The wanted area fractions are no ascending list between 0 and 1.
    #[error("area fractions must ascend and lie between 0 and 1, found {0:?}")]
    Targets(Vec<f64>),
    /// No pressure was found on the one side of a wanted area.
    #[error(
        "the contact area fraction {target} was not bracketed: after {solves} solves the nearest \
         is {found} at {pressure:e} Pa; use more points or leave this area out"
    )]
    NotBracketed {
        /// The wanted contact area fraction.
        target: f64,
        /// Nearest fraction found.
        found: f64,
        /// Its mean pressure in Pa.
        pressure: f64,
        /// Solves so far.
        solves: usize,
    },
}

/// Relative distance in area within which a solved point stands for a target.
const NEAR: f64 = 0.05;
/// Solves that one target may take until a point is near or the curve agrees with itself there.
const MOST_CHECKS: usize = 6;
/// Solves that the search for the two ends may take each.
const MOST_BRACKETING_SOLVES: usize = 24;

/// Friction at the `targets` (contact area fractions, ascending), from solves that start at the
/// mean pressure `first_guess` in Pa.
///
/// The area grows with the pressure nearly like a power, so both ends are found by a secant in
/// logarithms. Between them the interval of targets is halved: the middle target is solved and
/// compared with what the curve said there; where they agree to `tolerance` (relative to the
/// friction) the targets on both sides are read from the curve. The abscissa is the logarithm of
/// the area; ordinates are friction and the logarithm of pressure.
///
/// # Errors
/// [`CurveError`]; errors of `solve` are passed on.
pub fn friction_curve<E>(
    targets: &[f64],
    tolerance: f64,
    first_guess: f64,
    solve: impl FnMut(f64) -> Result<CurvePoint, E>,
) -> Result<Vec<CurveValue>, CurveError<E>> {
    let ascending = targets.windows(2).all(|w| w[0] < w[1]);
    let inside = targets.iter().all(|a| *a > 0.0 && *a < 1.0);
    if targets.is_empty() || !ascending || !inside {
        return Err(CurveError::Targets(targets.to_vec()));
    }
    let mut sampler = Sampler { solve, points: Vec::new() };
    sampler.add(first_guess)?;
    sampler.reach(targets[0], Side::Below)?;
    sampler.reach(targets[targets.len() - 1], Side::Above)?;
    let mut errors = vec![0.0; targets.len()];
    let last = targets.len() - 1;
    for end in [0, last] {
        errors[end] = sampler.settle(targets[end], tolerance)?;
    }
    if last > 1 {
        sampler.halve(&targets[1..last], &mut errors[1..last], tolerance)?;
    }
    let (friction, pressure) = sampler.interpolants();
    let value = |(target, error): (&f64, f64)| CurveValue {
        contact_area_fraction: *target,
        mean_pressure: pressure.at(target.ln()).exp(),
        friction_coefficient: friction.at(target.ln()),
        interpolation_error: error,
    };
    Ok(targets.iter().zip(errors).map(value).collect())
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Below,
    Above,
}

struct Sampler<S> {
    solve: S,
    /// Ascending in area, and therefore in pressure.
    points: Vec<CurvePoint>,
}

impl<S, E> Sampler<S>
where
    S: FnMut(f64) -> Result<CurvePoint, E>,
{
    fn add(&mut self, pressure: f64) -> Result<CurvePoint, CurveError<E>> {
        let point = (self.solve)(pressure).map_err(CurveError::Solve)?;
        let area = point.contact_area_fraction;
        let place = self.points.partition_point(|p| p.contact_area_fraction < area);
        // Two equal areas make no function; the later point replaces the earlier.
        match self.points.get_mut(place) {
            Some(same) if same.contact_area_fraction == area => *same = point,
            _ => self.points.insert(place, point),
        }
        Ok(point)
    }

    /// Solves until an area at or beyond the target on that side is known.
    fn reach(&mut self, target: f64, side: Side) -> Result<(), CurveError<E>> {
        for _ in 0..MOST_BRACKETING_SOLVES {
            let outermost = match side {
                Side::Below => self.points[0],
                Side::Above => self.points[self.points.len() - 1],
            };
            let reached = match side {
                Side::Below => outermost.contact_area_fraction <= target,
                Side::Above => outermost.contact_area_fraction >= target,
            };
            if reached {
                return Ok(());
            }
            // A little beyond the target, so that the next solve is the last; never more than a
            // factor of 30, since the power law is only local.
            let beyond = if side == Side::Below { 0.97 } else { 1.03 };
            let factor = (target / outermost.contact_area_fraction).powf(1.0 / self.exponent(side));
            let pressure = outermost.mean_pressure * (factor * beyond).clamp(1.0 / 30.0, 30.0);
            self.add(pressure)?;
        }
        let nearest = match side {
            Side::Below => self.points[0],
            Side::Above => self.points[self.points.len() - 1],
        };
        Err(CurveError::NotBracketed {
            target,
            found: nearest.contact_area_fraction,
            pressure: nearest.mean_pressure,
            solves: self.points.len(),
        })
    }

    /// Local exponent b of area ~ pressure^b on that side; contact is nearly linear.
    fn exponent(&self, side: Side) -> f64 {
        let n = self.points.len();
        if n < 2 {
            return 1.0;
        }
        let (a, b) = match side {
            Side::Below => (self.points[0], self.points[1]),
            Side::Above => (self.points[n - 2], self.points[n - 1]),
        };
        let exponent = (b.contact_area_fraction / a.contact_area_fraction).ln()
            / (b.mean_pressure / a.mean_pressure).ln();
        if exponent.is_finite() { exponent.clamp(0.3, 1.5) } else { 1.0 }
    }

    fn interpolants(&self) -> (CubicHermite, CubicHermite) {
        let area: Vec<f64> = self.points.iter().map(|p| p.contact_area_fraction.ln()).collect();
        let friction = self.points.iter().map(|p| p.friction_coefficient).collect();
        let pressure = self.points.iter().map(|p| p.mean_pressure.ln()).collect();
        (CubicHermite::smooth(area.clone(), friction), CubicHermite::monotone(area, pressure))
    }

    fn halve(
        &mut self,
        targets: &[f64],
        errors: &mut [f64],
        tolerance: f64,
    ) -> Result<(), CurveError<E>> {
        if targets.is_empty() {
            return Ok(());
        }
        let middle = self.middle_of_the_gap(targets);
        let (mut error, agrees) = self.check(targets[middle], tolerance)?;
        let (below, above) = errors.split_at_mut(middle);
        if agrees {
            // The curve held in the middle of the gap: what is left is smaller.
            below.fill(error);
            above.fill(error);
            return Ok(());
        }
        error = self.settle(targets[middle], tolerance)?.min(error);
        above[0] = error;
        self.halve(&targets[..middle], below, tolerance)?;
        self.halve(&targets[middle + 1..], &mut above[1..], tolerance)
    }

    /// Index of the target nearest to the middle, in logarithms, of the gap between the solved
    /// points around the targets.
    fn middle_of_the_gap(&self, targets: &[f64]) -> usize {
        let (first, last) = (targets[0], targets[targets.len() - 1]);
        let areas = || self.points.iter().map(|p| p.contact_area_fraction);
        let below = areas().filter(|a| *a <= first).fold(0.0, f64::max).max(first / 2.0);
        let above = areas().filter(|a| *a >= last).fold(1.0, f64::min).min(last * 2.0);
        let distance = |target: f64| (target.ln() - 0.5 * (below.ln() + above.ln())).abs();
        (0..targets.len())
            .min_by(|i, j| distance(targets[*i]).total_cmp(&distance(targets[*j])))
            .unwrap_or(0)
    }

    /// Solves until a point lies so close to the target that the curve must hold there, or does;
    /// returns by how much it was off last.
    fn settle(&mut self, target: f64, tolerance: f64) -> Result<f64, CurveError<E>> {
        let mut error = f64::INFINITY;
        for _ in 0..MOST_CHECKS {
            let near = |p: &CurvePoint| (p.contact_area_fraction / target).ln().abs() < NEAR;
            if let Some(point) = self.points.iter().find(|p| near(p)) {
                // A gap of a twentieth in area is far below the features of the curve.
                return Ok(error.min(tolerance * point.friction_coefficient.abs()));
            }
            let agrees;
            (error, agrees) = self.check(target, tolerance)?;
            if agrees {
                break;
            }
        }
        Ok(error)
    }

    /// Solves at the pressure predicted for the target; returns by how much the curve was off
    /// there, and whether that is within the tolerance.
    fn check(&mut self, target: f64, tolerance: f64) -> Result<(f64, bool), CurveError<E>> {
        let (friction, pressure) = self.interpolants();
        let point = self.add(pressure.at(target.ln()).exp())?;
        let predicted = friction.at(point.contact_area_fraction.ln());
        let error = (predicted - point.friction_coefficient).abs();
        Ok((error, error <= tolerance * point.friction_coefficient.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    const TARGETS: [f64; 12] =
        [0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1];

    fn area(pressure: f64) -> f64 {
        (pressure / 1e7).powf(0.9).tanh()
    }

    fn friction(area: f64) -> f64 {
        1.1 * (-(area / 0.03).ln().powi(2) / 20.0).exp()
    }

    fn point(pressure: f64) -> Result<CurvePoint, Infallible> {
        let contact_area_fraction = area(pressure);
        let friction_coefficient = friction(contact_area_fraction);
        Ok(CurvePoint { mean_pressure: pressure, contact_area_fraction, friction_coefficient })
    }

    #[test]
    fn the_error_is_within_the_tolerance_and_costs_fewer_solves_than_targets_allow() {
        let mut previous = usize::MAX;
        for (tolerance, most) in [(1e-3, 16), (1e-2, 11)] {
            let mut solves = 0;
            let curve = friction_curve(&TARGETS, tolerance, 3e3, |p| {
                solves += 1;
                point(p)
            })
            .unwrap();
            for value in &curve {
                let exact = friction(value.contact_area_fraction);
                let error = (value.friction_coefficient - exact).abs();
                assert!(error <= tolerance * exact, "{value:?} {exact}");
                let there = area(value.mean_pressure);
                approx::assert_relative_eq!(
                    there,
                    value.contact_area_fraction,
                    max_relative = 0.01
                );
            }
            assert!(solves <= most && solves <= previous, "{solves} solves for {tolerance}");
            previous = solves;
        }
    }

    #[test]
    fn one_target_and_a_far_guess() {
        for guess in [1e-2, 1e12] {
            let curve = friction_curve(&[0.05], 1e-4, guess, point).unwrap();
            approx::assert_relative_eq!(
                curve[0].friction_coefficient,
                friction(0.05),
                max_relative = 1e-4
            );
        }
    }

    #[test]
    fn an_area_out_of_reach_is_an_error_that_names_it() {
        let error = friction_curve(&[0.5], 1e-3, 1.0, |p| {
            let limited = CurvePoint { contact_area_fraction: 0.3, ..point(p)? };
            Ok::<_, Infallible>(limited)
        })
        .unwrap_err();
        assert!(error.to_string().contains("0.5 was not bracketed"), "{error}");
    }

    #[test]
    fn bad_targets_are_refused() {
        for targets in [&[][..], &[0.1, 0.1], &[0.2, 0.1], &[0.0], &[1.0], &[f64::NAN]] {
            assert!(friction_curve(targets, 1e-3, 1.0, point).is_err());
        }
    }
}
