//! What is asserted and reported of a hard case.

use crate::document;
use crate::lemke::DenseContact;
use crate::surfaces::Profile;
use asperity::contact::sliding::RESIDUAL_TOLERANCE;
use asperity::contact::{ContactSolution, SlidingContact};
use asperity::rubber::Rubber;
use std::f64::consts::TAU;
use std::fmt::Display;
use std::panic::Location;

/// A case of one or more solves: the worst of each figure.
pub struct Case {
    name: &'static str,
    size: String,
    route: &'static str,
    condition_number: Option<f64>,
    iterations: u64,
    residual: f64,
    difference: Option<f64>,
}

impl Case {
    pub fn new(name: &'static str, size: impl Display, route: &'static str) -> Self {
        let size = size.to_string();
        Self {
            name,
            size,
            route,
            condition_number: None,
            iterations: 0,
            residual: 0.0,
            difference: None,
        }
    }

    /// The figures of an iteration that must reach a residual.
    pub fn solved_to(&mut self, tolerance: f64, residual: f64, iterations: u64) {
        assert!(residual <= tolerance, "{}: residual {residual:e}", self.name);
        self.residual = self.residual.max(residual);
        self.iterations = self.iterations.max(iterations);
    }

    /// A contact at its full residual.
    pub fn solved(&mut self, solution: &ContactSolution) {
        self.solved_to(RESIDUAL_TOLERANCE, solution.residual, solution.iterations as u64);
    }

    pub fn conditioned(&mut self, condition_number: f64) {
        let worst = self.condition_number.map_or(condition_number, |c| c.max(condition_number));
        self.condition_number = Some(worst);
    }

    /// The difference from the second route, in the terms in which the tolerance is stated.
    pub fn differs(&mut self, difference: f64, tolerance: f64) {
        assert!(
            difference <= tolerance,
            "{}, {}: {difference:e} from {}, {tolerance:e} is allowed",
            self.name,
            self.size,
            self.route
        );
        self.difference = Some(self.difference.map_or(difference, |d| d.max(difference)));
    }

    /// Both numbers are one but for a relative difference.
    pub fn agrees(&mut self, a: f64, b: f64, tolerance: f64) {
        // In full contact separations and areas are equal to the last bit.
        let difference = if a == b { 0.0 } else { (a - b).abs() / b.abs() };
        self.differs(difference, tolerance);
    }

    /// Solves at the pressure of a dense contact; the pressures are compared by their largest and
    /// the separations by the height of the highest point.
    ///
    /// The fast solver leaves gaps of 1e-10 of the displacement; the pressure that such a gap makes
    /// is that times the condition number at most.
    pub fn compare_with_lemke(&mut self, rubber: &Rubber, speed: f64, profile: &Profile, d: f64) {
        let dense = DenseContact::at_depth(rubber, speed, profile, d);
        let mut contact =
            SlidingContact::new(rubber, speed, profile.period, &profile.heights).unwrap();
        let solution = contact.solve(dense.mean_pressure).unwrap();
        self.solved(&solution);
        self.conditioned(dense.condition_number);
        let largest = dense.pressure.max();
        let tolerance = RESIDUAL_TOLERANCE * dense.condition_number.max(10.0);
        for (fast, exact) in solution.pressure.iter().zip(&dense.pressure) {
            self.differs((fast - exact).abs() / largest, tolerance);
        }
        let separation = solution.mean_separation - dense.mean_separation;
        self.differs(separation.abs() / contact.height_range(), tolerance);
    }

    /// Enters the row of the table; a case without a second route is none.
    #[track_caller]
    pub fn enter(self) {
        let difference = self.difference.expect("a second route");
        let condition = self.condition_number.expect("a condition number");
        let row = [
            self.name.to_owned(),
            self.size,
            format!("{condition:.1e}"),
            self.iterations.to_string(),
            format!("{:.1e}", self.residual),
            self.route.to_owned(),
            format!("{difference:.1e}"),
            "solved".to_owned(),
        ];
        document::enter(Location::caller().file(), row);
    }
}

/// Enters the row of a case that is refused; the message is what the user reads.
#[track_caller]
pub fn enter_refusal(name: &str, size: impl Display, error: impl Display) {
    let none = || "-".to_owned();
    let verdict = format!("refused: {error}");
    let row = [name.to_owned(), size.to_string(), none(), none(), none(), none(), none(), verdict];
    document::enter(Location::caller().file(), row);
}

/// Condition number of the operator of a whole grid, a closed form: it is normal, so this is the
/// ratio of its compliances `2 / (|q| |E_r(q v)|)` at the longest and at the shortest wave.
pub fn grid_condition(rubber: &Rubber, speed: f64, profile: &Profile) -> f64 {
    let stiffness = |waves: f64| {
        let q = TAU * waves / profile.period;
        q * rubber.reduced_modulus(q * speed).norm()
    };
    let waves = (1..=profile.heights.len() / 2).map(|k| stiffness(k as f64));
    let (least, most) = waves.fold((f64::INFINITY, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
    most / least
}
