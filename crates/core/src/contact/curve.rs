//! Friction over contact area, from as few pressures as the accuracy needs.

use super::refine::GridError;
use crate::error_kind::{ErrorKind, HasKind};
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
    /// Their estimated errors by the grid, if known.
    pub error: Option<GridError>,
}

/// Friction at one of the contact area fractions asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveValue {
    /// The contact area fraction asked for.
    pub contact_area_fraction: f64,
    /// Mean pressure in Pa, interpolated.
    pub mean_pressure: f64,
    /// Friction coefficient, interpolated.
    pub friction_coefficient: f64,
    /// Estimated error of `friction_coefficient` by interpolation, absolute.
    pub interpolation_error: f64,
    /// The larger of the errors by the grid of the two points that it lies between, including the change of friction by
    /// the error of the area; `None` if one of them is not known.
    pub discretisation_error: Option<f64>,
    /// Estimated error by the grid of contact area over pressure, relative: of the area where the pressure is that of a
    /// solve, of the pressure where it is interpolated for the area; `None` if that of one of the points is not known.
    pub relative_area_error: Option<f64>,
}

/// Why a curve could not be found.
#[derive(Debug, thiserror::Error)]
pub enum CurveError<E> {
    /// A solve failed.
    #[error(transparent)]
    Solve(E),
    /// The area fractions do not ascend between 0 and 1.
    #[error("area fractions must ascend and lie between 0 and 1, found {0:?}")]
    Targets(Vec<f64>),
    /// Solves do not settle on a curve.
    #[error("friction over contact area did not settle on a curve within {solves} solves")]
    NotSmooth {
        /// Solves so far.
        solves: usize,
    },
    /// No pressure was found on one side of an area.
    #[error(
        "the contact area fraction {target} was not bracketed: after {solves} solves the nearest \
         is {found} at {pressure:e} Pa; use more points or leave this area out"
    )]
    NotBracketed {
        /// The contact area fraction asked for.
        target: f64,
        /// Nearest fraction found.
        found: f64,
        /// Its mean pressure in Pa.
        pressure: f64,
        /// Solves so far.
        solves: usize,
    },
}

impl<E: HasKind + 'static> HasKind for CurveError<E> {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Solve(source) => source.kind(),
            Self::Targets(_) => ErrorKind::Input,
            Self::NotSmooth { .. } | Self::NotBracketed { .. } => ErrorKind::Failure,
        }
    }
}

/// Logarithmic distance in area to the nearest solved point, and width of the gap between solved
/// points, one of which a target must keep to: friction is a curve with features of its own, and
/// two wide-apart points say nothing of what is between them.
const NEAR: f64 = 0.01;
const NARROW: f64 = 0.1;
/// Solves that the search for the two ends may take each.
const MOST_BRACKETING_SOLVES: usize = 24;
/// Solves per target after which the search for a curve ends.
const MOST_SOLVES_PER_TARGET: usize = 8;

/// Friction at the `targets` (contact area fractions, ascending), from solves that start at the
/// mean pressure `first_guess` in Pa.
///
/// The area grows with the pressure nearly like a power, so both ends are found by a secant in
/// logarithms. Then the target with the largest estimated error is solved, at the pressure that
/// the points so far predict for it, until every error is below `tolerance` times the friction.
/// The error is that between the cubic through the solved points and the straight lines between
/// them: the first is nearer to the truth. The abscissa is the logarithm of the area; ordinates
/// are friction and the logarithm of pressure.
///
/// # Errors
/// [`CurveError`]; errors of `solve` are passed on.
pub fn friction_curve<E>(
    targets: &[f64],
    tolerance: f64,
    first_guess: f64,
    solve: impl FnMut(f64) -> Result<CurvePoint, E>,
) -> Result<Vec<CurveValue>, CurveError<E>> {
    friction_curve_within(targets, Accuracy { tolerance, least_friction: 0.0 }, first_guess, solve)
}

/// When a curve is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Error of friction by interpolation, relative to the friction.
    pub tolerance: f64,
    /// Friction to which the tolerance refers where friction is less, as it is where it vanishes by symmetry: no error is small
    /// beside nothing.
    pub least_friction: f64,
}

/// [`friction_curve`] with a least friction to which the tolerance refers.
///
/// # Errors
/// Those of [`friction_curve`].
pub fn friction_curve_within<E>(
    targets: &[f64],
    accuracy: Accuracy,
    first_guess: f64,
    solve: impl FnMut(f64) -> Result<CurvePoint, E>,
) -> Result<Vec<CurveValue>, CurveError<E>> {
    let ascending = targets.windows(2).all(|w| w[0] < w[1]);
    let inside = targets.iter().all(|a| *a > 0.0 && *a < 1.0);
    if targets.is_empty() || !ascending || !inside {
        return Err(CurveError::Targets(targets.to_vec()));
    }
    let mut sampler = Sampler { solve, points: Vec::new(), jumps: Vec::new() };
    sampler.add(first_guess)?;
    sampler.reach(targets[0], Side::Below)?;
    sampler.reach(targets[targets.len() - 1], Side::Above)?;
    for _ in 0..MOST_SOLVES_PER_TARGET * targets.len() {
        let values = sampler.values(targets);
        let excess = |value: &CurveValue| {
            let friction = value.friction_coefficient.abs().max(accuracy.least_friction);
            value.interpolation_error / (accuracy.tolerance * friction)
        };
        let Some(worst) = values.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))) else {
            break;
        };
        if excess(worst) <= 1.0 {
            return Ok(values);
        }
        sampler.narrow(worst)?;
    }
    Err(CurveError::NotSmooth { solves: sampler.points.len() })
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
    /// Targets that no pressure has.
    jumps: Vec<f64>,
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

    /// The curve at the targets with its errors; infinite where the solved points are too far off.
    fn values(&self, targets: &[f64]) -> Vec<CurveValue> {
        let area: Vec<f64> = self.points.iter().map(|p| p.contact_area_fraction.ln()).collect();
        let of = |value: fn(&CurvePoint) -> f64| self.points.iter().map(value).collect::<Vec<_>>();
        let friction = CubicHermite::smooth(area.clone(), of(|p| p.friction_coefficient));
        let lines = CubicHermite::linear(area.clone(), of(|p| p.friction_coefficient));
        let pressure = CubicHermite::monotone(area.clone(), of(|p| p.mean_pressure.ln()));
        let value = |target: &f64| {
            let at = target.ln();
            let above = area.partition_point(|a| *a < at).min(area.len() - 1);
            let below = above.saturating_sub(1);
            let nearest = (at - area[below]).abs().min((area[above] - at).abs());
            let resolved = nearest <= NEAR || area[above] - area[below] <= NARROW;
            let between = (friction.at(at) - lines.at(at)).abs();
            let (below, above) = (&self.points[below], &self.points[above]);
            let change = (above.friction_coefficient - below.friction_coefficient).abs();
            let interpolation_error = match resolved {
                true => between,
                false if self.jumps.contains(target) => change.max(between),
                false => f64::INFINITY,
            };
            let width = (above.contact_area_fraction / below.contact_area_fraction).ln();
            let slope = if width > 0.0 { change / width } else { 0.0 };
            let error = |point: &CurvePoint| {
                point.error.map(|error| {
                    let area = error.contact_area_fraction / point.contact_area_fraction;
                    error.friction_coefficient + slope * area
                })
            };
            // An area that is off by a share is had at a pressure that is off by that share over the local exponent.
            let exponent =
                (width / (above.mean_pressure / below.mean_pressure).ln()).clamp(0.3, 1.5);
            let exponent = if exponent.is_nan() { 1.0 } else { exponent };
            let of_area = |point: &CurvePoint| {
                point.error.map(|error| {
                    error.contact_area_fraction / point.contact_area_fraction / exponent
                })
            };
            CurveValue {
                contact_area_fraction: *target,
                mean_pressure: pressure.at(at).exp(),
                friction_coefficient: friction.at(at),
                interpolation_error,
                discretisation_error: error(below)
                    .zip(error(above))
                    .map(|(below, above)| below.max(above)),
                relative_area_error: of_area(below)
                    .zip(of_area(above))
                    .map(|(below, above)| below.max(above)),
            }
        };
        targets.iter().map(value).collect()
    }

    /// Solves once more for a value that is not good enough, at the pressure predicted for its area, or,
    /// if that leaves the solved points about it as they were, at the middle of their pressures.
    ///
    /// Some areas no pressure has: contacts that merge on a grid close the points between them all at
    /// once, and a finer grid may find less area at more pressure. Such a jump is where the points on both
    /// sides have nearly the same pressure but not the same area, or no pressure between theirs an area between.
    fn narrow(&mut self, value: &CurveValue) -> Result<(), CurveError<E>> {
        let target = value.contact_area_fraction;
        let before = self.bracket(target);
        self.add(value.mean_pressure)?;
        if self.bracket(target) == before {
            self.add((before[0].mean_pressure * before[1].mean_pressure).sqrt())?;
        }
        let [below, above] = self.bracket(target);
        let near = (above.mean_pressure / below.mean_pressure).ln() <= NEAR;
        let apart = (above.contact_area_fraction / below.contact_area_fraction).ln() > NARROW;
        if [below, above] == before || (near && apart) {
            self.jumps.push(target);
        }
        Ok(())
    }

    /// The solved points about an area.
    fn bracket(&self, target: f64) -> [CurvePoint; 2] {
        let above = self.points.partition_point(|p| p.contact_area_fraction < target);
        let above = above.min(self.points.len() - 1);
        [self.points[above.saturating_sub(1)], self.points[above]]
    }
}

#[cfg(test)]
mod tests;
