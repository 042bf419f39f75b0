//! Friction to a given accuracy: grids are doubled until they agree.
//!
//! Friction and contact area of a resolved contact converge with the spacing, but not smoothly: contact edges fall
//! between points, differently on every grid. One difference between two grids may therefore be small by chance. The
//! error of the last grid is estimated from the last three, each less by the factor `r` for every doubling since:
//!
//! ```text
//! error(m) = max(|f(m) - f(m-1)|, |f(m-1) - f(m-2)| / r, |f(m-2) - f(m-3)| / r^2)
//! ```
//!
//! with `r` of [`HALF_SPACE`] or of [`FINITE_ELEMENTS`]. For `r = 4` it is three times the error of an exactly quadratic
//! sequence, which is the margin for all others: on a hundred random surfaces the true error of friction is below the
//! estimate in 98, and a fifth of it in the median; `tests/convergence` requires 95 and a tenth, of finite elements too.

use crate::error_kind::{ErrorKind, HasKind};

/// Doublings that the estimate looks back on.
const DIFFERENCES: usize = 3;
/// Convergence on the half-space, where contact edges are read between grid points.
pub const HALF_SPACE: Orders = Orders { friction: 4.0, area: 8.0 };
/// Convergence of an areal half-space: along the curved edges of its contacts the points are off by half a spacing, some to
/// one side and some to the other.
pub const AREAL: Orders = Orders { friction: 4.0, area: 2.0 };
/// Convergence of finite elements, whose area is known to a fraction of an element.
pub const FINITE_ELEMENTS: Orders = Orders { friction: 4.0, area: 2.0 };
/// Weight of a relative error of the area in friction as a function of area. Tables of road surfaces have
/// `|d ln friction / d ln area|` of up to 0.25 in their means.
pub const AREA_WEIGHT: f64 = 0.25;
/// With fewer points in contact friction is the slope of the profile at one node, the same on the next grids: such a
/// grid does not resolve the contact.
pub const LEAST_CONTACT_POINTS: f64 = 2.0;
/// Friction to which relative tolerances refer where friction is smaller.
pub const LEAST_FRICTION: f64 = 1e-4;

/// Relative accuracies that can be asked for, everywhere. Residuals are below 1e-10 and an error is estimated from
/// differences of solves, which below 1e-8 are rounding; above a half not one digit is right. Whether a problem reaches
/// its accuracy the solver reports, with the error reached.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-8..=0.5;
/// The same range as text.
pub const TOLERANCES_IN_WORDS: &str = "between 1e-8 and 0.5 (0.1 % is 0.001)";
/// Fractions of such an accuracy that grids, interpolation or realisations alone may take: a quarter or more.
pub const SHARES: std::ops::RangeInclusive<f64> = 1e-9..=0.5;
/// The same range as text.
pub const SHARES_IN_WORDS: &str = "between 1e-9 and 0.5 (0.1 % is 0.001)";

/// Factors by which errors fall with each doubling of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// That of the friction coefficient.
    pub friction: f64,
    /// That of the contact area.
    pub area: f64,
}

/// A contact on one of several grids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnGrid {
    /// Points of the grid.
    pub points: usize,
    /// Friction coefficient.
    pub friction_coefficient: f64,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
}

/// What the tolerance refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watched {
    /// The friction coefficient, or [`LEAST_FRICTION`] where friction is less.
    Friction,
    /// The contact area fraction: elastic bodies have no friction.
    ContactArea,
    /// The friction coefficient as a function of the contact area, whose error counts for
    /// [`AREA_WEIGHT`] of its own: friction changes with the area by less than a power of that.
    FrictionOverArea,
}

/// Estimated errors of a contact by its grid, absolute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridError {
    /// Of the friction coefficient.
    pub friction_coefficient: f64,
    /// Of the contact area fraction.
    pub contact_area_fraction: f64,
}

/// A contact on the finest grid that was needed.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined<S> {
    /// The solution there.
    pub solution: S,
    /// Its errors; none if too few grids resolve the contact.
    pub error: Option<GridError>,
    /// All grids, from the coarsest.
    pub grids: Vec<OnGrid>,
}

/// Why the accuracy was not reached.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RefineError<E> {
    /// A solve failed.
    #[error(transparent)]
    Solve(E),
    /// The finest grid is not fine enough.
    #[error(
        "the relative accuracy {tolerance} is not reached: {}; ask for less accuracy, or for more \
         pressure if the contact is small",
        reached.map_or_else(
            || format!("up to {points} points no three grids resolve the contact"),
            |error| format!("on {points} points the error is {error:.1e}, and more than {most} are not tried")
        )
    )]
    NotReached {
        /// The relative accuracy asked for.
        tolerance: f64,
        /// Estimated relative error on the finest grid that was solved.
        reached: Option<f64>,
        /// Points of that grid.
        points: usize,
        /// Most points that may be tried.
        most: usize,
    },
}

impl<E: HasKind + 'static> HasKind for RefineError<E> {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Solve(source) => source.kind(),
            Self::NotReached { .. } => ErrorKind::Failure,
        }
    }
}

/// How far and how finely grids are refined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refinement {
    /// Relative accuracy.
    pub tolerance: f64,
    /// Of what.
    pub watched: Watched,
    /// How it converges.
    pub orders: Orders,
    /// Points of the coarsest grid.
    pub first: usize,
    /// Points that no grid exceeds.
    pub most: usize,
}

impl Refinement {
    /// Solves on grids of doubled points until the estimated error is within the tolerance. `solve`
    /// returns `None` for a grid without a solution; the estimate then starts again.
    ///
    /// # Errors
    /// [`RefineError::NotReached`] as soon as the order of convergence shows that the finest grid would not reach the
    /// tolerance; errors of `solve` are passed on.
    pub fn run<S, E>(
        &self,
        mut solve: impl FnMut(usize) -> Result<Option<S>, E>,
        view: impl Fn(&S) -> OnGrid,
    ) -> Result<Refined<S>, RefineError<E>> {
        let mut grids: Vec<OnGrid> = Vec::new();
        let (mut points, mut reached, mut solved) = (self.first, None, self.first);
        while points <= self.most {
            solved = points;
            match solve(points).map_err(RefineError::Solve)? {
                None => grids.clear(),
                Some(solution) => {
                    grids.push(view(&solution));
                    let error = grid_error(&grids, self.orders);
                    reached = error.map(|error| self.relative(&error, grids[grids.len() - 1]));
                    if reached.is_some_and(|reached| reached <= self.tolerance) {
                        return Ok(Refined { solution, error, grids });
                    }
                }
            }
            if reached.is_some_and(|reached| self.is_hopeless(points, reached)) {
                break;
            }
            points *= 2;
        }
        let (tolerance, most) = (self.tolerance, self.most);
        Err(RefineError::NotReached { tolerance, reached, points: solved, most })
    }

    fn relative(&self, error: &GridError, finest: OnGrid) -> f64 {
        let least = finest.friction_coefficient.abs().max(LEAST_FRICTION);
        let friction = error.friction_coefficient / least;
        let area = error.contact_area_fraction / finest.contact_area_fraction;
        match self.watched {
            Watched::Friction => friction,
            Watched::ContactArea => area,
            Watched::FrictionOverArea => friction.max(AREA_WEIGHT * area),
        }
    }

    /// Whether even twice the order of convergence would not reach the tolerance in time.
    fn is_hopeless(&self, points: usize, reached: f64) -> bool {
        let left = (self.most as f64 / points as f64).powi(4);
        reached / left > self.tolerance
    }
}

/// A contact on the grid of `points`, with the errors that three coarser grids show; grids of fewer
/// than `least` points are left out.
///
/// # Errors
/// Those of `solve`; on a coarser grid only those that are not `no_solution`, after which the estimate starts again.
pub fn on_grid<S, E>(
    points: usize,
    least: usize,
    orders: Orders,
    mut solve: impl FnMut(usize) -> Result<S, E>,
    no_solution: impl Fn(&E) -> bool,
    view: impl Fn(&S) -> OnGrid,
) -> Result<Refined<S>, E> {
    let coarser = (1..=DIFFERENCES).rev().map(|halvings| points >> halvings);
    let mut grids = Vec::new();
    for coarse in coarser.filter(|&coarse| coarse >= least) {
        match solve(coarse) {
            Ok(solution) => grids.push(view(&solution)),
            Err(error) if no_solution(&error) => grids.clear(),
            Err(error) => return Err(error),
        }
    }
    let solution = solve(points)?;
    grids.push(view(&solution));
    Ok(Refined { error: grid_error(&grids, orders), solution, grids })
}

/// Errors of the last of the grids, from the coarsest; none if fewer than three in a row, the last
/// among them, resolve the contact.
pub fn grid_error(grids: &[OnGrid], orders: Orders) -> Option<GridError> {
    let unresolved =
        |grid: &OnGrid| grid.contact_area_fraction * (grid.points as f64) < LEAST_CONTACT_POINTS;
    let start = grids.iter().rposition(unresolved).map_or(0, |last| last + 1);
    let resolved = &grids[start..];
    let error = |value: fn(&OnGrid) -> f64, order: f64| {
        let differences =
            resolved.windows(2).rev().map(|pair| (value(&pair[1]) - value(&pair[0])).abs());
        let scaled = differences.take(DIFFERENCES).enumerate();
        scaled.map(|(doublings, d)| d / order.powi(doublings as i32)).fold(0.0, f64::max)
    };
    (resolved.len() >= 3).then(|| GridError {
        friction_coefficient: error(|grid| grid.friction_coefficient, orders.friction),
        contact_area_fraction: error(|grid| grid.contact_area_fraction, orders.area),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const REFINEMENT: Refinement = Refinement {
        tolerance: 1e-3,
        watched: Watched::Friction,
        orders: HALF_SPACE,
        first: 8,
        most: 1 << 16,
    };

    fn grid(points: usize, friction_coefficient: f64) -> OnGrid {
        OnGrid { points, friction_coefficient, contact_area_fraction: 0.5 }
    }

    fn quadratic(points: usize) -> Result<Option<OnGrid>, ()> {
        Ok(Some(grid(points, 0.7 + 5.0 / (points * points) as f64)))
    }

    #[test]
    fn an_exactly_quadratic_sequence_has_three_times_its_error() {
        let grids: Vec<OnGrid> = [8, 16, 32, 64].map(|n| quadratic(n).unwrap().unwrap()).to_vec();
        let error = grid_error(&grids, HALF_SPACE).unwrap().friction_coefficient;
        approx::assert_relative_eq!(error, 3.0 * 5.0 / 4096.0, max_relative = 1e-12);
        assert_eq!(grid_error(&grids[..2], HALF_SPACE), None);
    }

    #[test]
    fn grids_that_agree_by_chance_are_not_believed() {
        let grids = [grid(8, 1.0), grid(16, 0.6), grid(32, 0.6), grid(64, 0.6)];
        assert_eq!(grid_error(&grids, HALF_SPACE).unwrap().friction_coefficient, 0.4 / 16.0);
    }

    #[test]
    fn one_node_in_contact_is_no_resolved_contact() {
        let small = |points| OnGrid { contact_area_fraction: 0.01, ..grid(points, 0.3) };
        let grids = [64, 128, 256, 512].map(small);
        assert_eq!(grid_error(&grids, HALF_SPACE), None);
        assert!(grid_error(&[64, 128, 256, 512, 1024].map(small), HALF_SPACE).is_some());
    }

    #[test]
    fn the_coarsest_grid_within_the_tolerance_is_taken() {
        let refined = REFINEMENT.run(quadratic, |grid| *grid).unwrap();
        // 15 / n^2 <= 1e-3 of 0.7 from n = 147 on.
        assert_eq!(refined.solution.points, 256);
        assert_eq!(refined.grids.len(), 6);
        assert!(
            (refined.solution.friction_coefficient - 0.7).abs()
                <= refined.error.unwrap().friction_coefficient
        );
    }

    #[test]
    fn what_cannot_be_reached_is_refused_with_the_error_so_far_and_without_wasted_grids() {
        let mut solves = 0;
        let coarse = Refinement { most: 64, ..REFINEMENT };
        let error = coarse
            .run(
                |points| {
                    solves += 1;
                    Ok::<_, ()>(Some(grid(points, 1.0 + 100.0 / points as f64)))
                },
                |grid| *grid,
            )
            .unwrap_err();
        assert_eq!(solves, 3);
        let RefineError::NotReached { reached: Some(reached), points: 32, most: 64, .. } = error
        else {
            panic!("{error:?}")
        };
        assert!(reached > 0.5);
    }

    #[test]
    fn grids_without_solution_begin_the_estimate_anew_and_failures_are_passed_on() {
        let solve = |points| if points == 512 { Ok::<_, ()>(None) } else { quadratic(points) };
        let fine = Refinement { tolerance: 1e-5, ..REFINEMENT };
        let refined = fine.run(solve, |grid| *grid).unwrap();
        assert_eq!((refined.grids[0].points, refined.grids.len()), (1024, 3));
        let failed = REFINEMENT.run(|_| Err::<Option<OnGrid>, _>("broken"), |grid| *grid);
        assert_eq!(failed.unwrap_err(), RefineError::Solve("broken"));
    }

    #[test]
    fn friction_of_next_to_nothing_has_an_absolute_tolerance_and_area_stands_in_for_it() {
        let tiny = |points: usize| Ok::<_, ()>(Some(grid(points, 1e-9 / points as f64)));
        assert_eq!(REFINEMENT.run(tiny, |grid| *grid).unwrap().solution.points, 32);
        let area = Refinement { watched: Watched::ContactArea, ..REFINEMENT };
        let elastic = |points: usize| {
            Ok::<_, ()>(Some(OnGrid {
                contact_area_fraction: 0.1 + 1.0 / (points * points) as f64,
                ..grid(points, 0.0)
            }))
        };
        assert_eq!(area.run(elastic, |grid| *grid).unwrap().solution.points, 256);
        // A quarter of the relative error of the area: half the points.
        let over_area = Refinement { watched: Watched::FrictionOverArea, ..REFINEMENT };
        assert_eq!(over_area.run(elastic, |grid| *grid).unwrap().solution.points, 128);
    }

    #[test]
    fn a_given_grid_is_judged_by_the_coarser_ones() {
        let solve = |points: usize| quadratic(points).map(Option::unwrap);
        let refined = on_grid(64, 8, HALF_SPACE, solve, |()| false, |grid| *grid).unwrap();
        assert_eq!(refined.grids.iter().map(|g| g.points).collect::<Vec<_>>(), [8, 16, 32, 64]);
        approx::assert_relative_eq!(
            refined.error.unwrap().friction_coefficient,
            15.0 / 4096.0,
            max_relative = 1e-12
        );
    }

    #[test]
    fn only_a_grid_without_solution_is_passed_over() {
        let solve = |points: usize| match points {
            16 => Err("the disk is full"),
            _ => quadratic(points).map(Option::unwrap).map_err(|()| "never"),
        };
        let passed_over = on_grid(64, 8, HALF_SPACE, solve, |_| true, |grid| *grid).unwrap();
        assert_eq!((passed_over.error, passed_over.grids.len()), (None, 2));
        let told = on_grid(64, 8, HALF_SPACE, solve, |why| *why == "no solution", |grid| *grid);
        assert_eq!(told.unwrap_err(), "the disk is full");
    }
}
