//! Newton's method at one pressure on one grid.

use super::NotConverged;
use super::level::{Balance, Level};
use super::long::Long;
use super::state::State;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, flexible_gmres};

/// Relative accuracy of the linear solves; the looser one holds on a level in haste as long as the residual is above
/// the last number, where the linearisation error is larger than that.
const LINEAR_TOLERANCE: f64 = 1e-2;
const LINEAR_TOLERANCE_IN_HASTE: (f64, f64) = (0.1, 0.05);
/// Factor of the residuals of points with a barrier on a level in haste.
const HASTE: f64 = 10.0;
/// Krylov iterations beyond which factors of an earlier state are renewed, without haste and with.
const MOST_WITH_OLD_FACTORS: [usize; 2] = [18, 12];
/// Krylov iterations of one linear solve.
const MOST_ITERATIONS: usize = 120;
/// Largest change of a contact unknown in a step, in periods.
const LARGEST_CHANGE: f64 = 0.3;
/// Halvings of a step.
const MOST_HALVINGS: usize = 8;
/// Steps at the start of which the residual may grow by the first factor, later by the second; below the
/// last number growth does not count.
const STARTING_STEPS: usize = 5;
const GROWTH: [f64; 2] = [10.0, 2.0];
const SLIGHT: f64 = 0.1;
/// A solve is given up if the residual is above the first number after as many steps as the second. In haste the last
/// two numbers apply as well, to detect a step that was too long early (33 and 12 were seen on eight waves where it was
/// not).
const HOPELESS: [(f64, usize); 4] = [(5.0, 5), (1.0, 8), (40.0, 1), (15.0, 2)];
const HOPELESS_WITHOUT_HASTE: usize = 2;
/// Most Newton steps from one solution to the next, of all solves between them, without haste and with: without a
/// solution, ever shorter steps would go on for ever. The longest known ways to a solution take 240 and 360.
const MOST_SPENT: [usize; 2] = [1000, 600];
/// Fractions of det F and of A that a step must leave.
const LEFT_OF_VOLUME: f64 = 0.2;
const LEFT_OF_LABEL: f64 = 0.1;

/// What a solve is to reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub pressure: f64,
    /// Share of the barrier; none for the exact contact.
    pub barrier: f64,
    /// Residual as [`Balance`] has it.
    pub tolerance: f64,
    pub most_steps: usize,
}

impl Level {
    /// Takes a state to the target; returns the Newton steps and the residual. If it fails, the state is unchanged.
    pub fn solve(
        &mut self,
        state: &mut State,
        target: Target,
    ) -> Result<(usize, f64), NotConverged> {
        let mut now = State { pressure: target.pressure, ..state.clone() };
        self.factored = false;
        let mut balance = self.balance(&mut now, target.barrier)?;
        let hasty = self.in_haste && target.barrier > 0.0;
        let tolerance = target.tolerance * if hasty { HASTE } else { 1.0 };
        let mut touching: Vec<bool> = Vec::new();
        for step in 0..=target.most_steps {
            let settled = target.barrier > 0.0 || {
                let before = std::mem::replace(&mut touching, now.touching());
                before == touching
            };
            if balance.norm < tolerance && settled {
                *state = now;
                return Ok((step, balance.norm));
            }
            let rules = if self.in_haste { HOPELESS.len() } else { HOPELESS_WITHOUT_HASTE };
            let hopeless =
                HOPELESS[..rules].iter().any(|(norm, from)| step >= *from && balance.norm > *norm);
            let spent = self.cost.newton_steps >= MOST_SPENT[usize::from(self.in_haste)];
            if step == target.most_steps || hopeless || spent || self.interrupt.is_set() {
                break;
            }
            let change = self.direction(&balance, settled)?;
            self.cost.newton_steps += 1;
            let growth = GROWTH[usize::from(step >= STARTING_STEPS)];
            let allowed = growth * balance.norm.max(SLIGHT);
            (now, balance) = self.search(&now, &balance, &change, target.barrier, allowed)?;
        }
        Err(NotConverged)
    }

    /// Newton's direction. Old factors are tried first unless the contact has changed.
    fn direction(&mut self, balance: &Balance, settled: bool) -> Result<Vec<f64>, NotConverged> {
        let right: Vec<f64> = balance.residual.iter().map(|r| -r).collect();
        let relative = match LINEAR_TOLERANCE_IN_HASTE {
            (tolerance, above) if self.in_haste && balance.norm > above => tolerance,
            _ => LINEAR_TOLERANCE,
        };
        let tolerance = relative * euclidean_norm(&right);
        if self.factored && settled {
            let most = MOST_WITH_OLD_FACTORS[usize::from(self.in_haste)];
            let (change, left) = self.krylov(balance, &right, tolerance, most);
            if left <= tolerance {
                return Ok(change);
            }
        }
        self.factorise(&balance.pairs)?;
        let (change, _) = self.krylov(balance, &right, tolerance, MOST_ITERATIONS);
        if self.interrupt.is_set() { Err(NotConverged) } else { Ok(change) }
    }

    fn krylov(
        &mut self,
        balance: &Balance,
        right: &[f64],
        tolerance: f64,
        max_iterations: usize,
    ) -> (Vec<f64>, f64) {
        let limits = KrylovLimits { tolerance, max_iterations };
        let level = &*self;
        let mut change = right.to_vec();
        let report = flexible_gmres(
            |z, image| image.copy_from_slice(&level.tangent(&balance.pairs, z)),
            |v, z| {
                z.copy_from_slice(v);
                level.factors.solve(z);
            },
            &mut change,
            limits,
            &level.interrupt,
        );
        self.cost.krylov_iterations += report.iterations;
        (change, report.residual_norm)
    }

    /// The longest acceptable step along a direction.
    fn search(
        &mut self,
        from: &State,
        at: &Balance,
        change: &[f64],
        barrier: f64,
        allowed: f64,
    ) -> Result<(State, Balance), NotConverged> {
        let contact = change[..2 * from.contact.len()].iter().skip(1).step_by(2);
        let largest = contact.fold(0.0_f64, |most, x| most.max(x.abs()));
        let mut length = (LARGEST_CHANGE * self.grid().period / largest).min(1.0);
        for _ in 0..MOST_HALVINGS {
            let mut next = self.moved(from, change, length);
            if let Ok(balance) = self.balance(&mut next, barrier) {
                let (new, old) = (balance.validity, at.validity);
                if balance.norm < allowed
                    && new.volume > LEFT_OF_VOLUME * old.volume.min(1.0)
                    && new.label > LEFT_OF_LABEL * old.label
                {
                    return Ok((next, balance));
                }
            }
            length *= 0.5;
        }
        Err(NotConverged)
    }

    fn moved(&self, from: &State, change: &[f64], length: f64) -> State {
        let mut next = from.clone();
        next.displacements.iter_mut().zip(change).for_each(|(u, d)| *u += length * d);
        let fixed = self.upper_edge();
        next.displacements[fixed].iter_mut().step_by(2).for_each(|x| *x = Long::default());
        for (tau, node) in next.contact.iter_mut().zip(change.chunks_exact(2)) {
            *tau += length * node[1];
        }
        next
    }
}
