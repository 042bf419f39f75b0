//! How many realisations of each model give the wanted interval for the least work.

use super::estimate::Spread;
use crate::fem::cost::{MeshCost, solves_of_curve};
use crate::stages::bem::{Bem, SolveRow};
use crate::stages::fem::Fem;

/// Seconds for a grid point and an active-set iteration of the half-space, as in a sweep. It is part of the
/// results: to change it asks for another revision of the stage.
const SECONDS_PER_POINT_AND_ITERATION: f64 = 4.4e-7;
/// The numbers are at most multiplied by this at once: they follow from spreads that are not well
/// known yet.
const MOST_GROWTH: usize = 4;
const MOST_GROWTH_OF_PAIRS: usize = 2;
/// And grow by this share at least, so that the last few do not come one by one.
const LEAST_GROWTH: f64 = 0.1;
/// Where no numbers give the wanted interval, the half-space may leave it this much wider than with
/// all of its realisations.
const NEARLY: f64 = 1.05;

/// Numbers of realisations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shares {
    /// On the half-space.
    pub half_space: usize,
    /// Of these at finite deformation too.
    pub pairs: usize,
}

/// Cost of a curve of each model, in seconds of the machine of reference. By points and iterations, never
/// by the clock: the numbers of realisations must be the same on every machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Costs {
    pub half_space: f64,
    pub pair: f64,
}

impl Costs {
    /// From the solves of the half-space, of so many curves, and the mesh of a contact at finite deformation.
    pub fn new<'a>(
        solves: impl Iterator<Item = &'a SolveRow>,
        curves: usize,
        mesh: MeshCost,
        fem: &Fem,
        bem: &Bem,
    ) -> Self {
        let work: f64 = solves.map(|row| (row.iterations * row.grid_points) as f64).sum();
        let pressures = solves_of_curve(bem.wanted().range(), fem.pressure_ratio);
        Self {
            half_space: SECONDS_PER_POINT_AND_ITERATION * work / curves.max(1) as f64,
            pair: mesh.seconds_of_solves(pressures),
        }
    }
}

/// What is asked for at one contact area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Goal {
    pub spread: Spread,
    /// Largest half width of the interval.
    pub half_width: f64,
}

impl Goal {
    /// Half width that is expected for these numbers, over the wanted one.
    fn ratio(&self, shares: Shares) -> f64 {
        self.spread.half_width(shares.half_space, shares.pairs) / self.half_width
    }
}

/// The numbers to be solved next: of least cost among those that are expected to meet every goal, from
/// the present ones, which do not, to the most there may be; at most [`MOST_GROWTH`] times the present
/// ones. If even the most do not meet them, as many pairs as there may be. `None` if there are no more.
pub(super) fn choose(goals: &[Goal], now: Shares, most: Shares, costs: Costs) -> Option<Shares> {
    let worst = |half_space: usize, pairs: usize| {
        let shares = Shares { half_space, pairs };
        // Not a number, of a single pair, is too wide.
        goals.iter().map(|goal| goal.ratio(shares)).fold(0.0, |worst: f64, ratio| {
            if ratio.is_nan() { f64::INFINITY } else { worst.max(ratio) }
        })
    };
    let mut best: Option<(f64, Shares)> = None;
    for pairs in now.pairs..=most.pairs {
        let of_pairs = costs.pair * (pairs - now.pairs) as f64;
        if best.is_some_and(|(cost, _)| cost <= of_pairs) {
            break;
        }
        let from = now.half_space.max(pairs);
        let Some(half_space) = fewest(from, most.half_space, |n| worst(n, pairs) <= 1.0) else {
            continue;
        };
        let cost = of_pairs + costs.half_space * (half_space - now.half_space) as f64;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, Shares { half_space, pairs }));
        }
    }
    let aim = best.map_or_else(
        || {
            let enough = NEARLY * worst(most.half_space, most.pairs);
            let from = now.half_space.max(most.pairs);
            let nearly = |n| worst(n, most.pairs) <= enough;
            let half_space = fewest(from, most.half_space, nearly).unwrap_or(most.half_space);
            Shares { half_space, pairs: most.pairs }
        },
        |(_, shares)| shares,
    );
    let next = step(now, aim, most);
    (next != now).then_some(next)
}

/// The smallest number from `low` to `high` that is enough, if `high` is; what is enough stays enough.
fn fewest(low: usize, high: usize, enough: impl Fn(usize) -> bool) -> Option<usize> {
    if low > high || !enough(high) {
        return None;
    }
    let (mut low, mut high) = (low, high);
    while low < high {
        let middle = low + (high - low) / 2;
        if enough(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(low)
}

/// Towards the aim, neither too far nor by too little. Where the aim is what is there, although its interval
/// is still too wide, both grow a little.
fn step(now: Shares, aim: Shares, most: Shares) -> Shares {
    let least = |now: usize| now + (LEAST_GROWTH * now as f64).ceil() as usize;
    let towards = |now: usize, aim: usize, growth: usize, most: usize| {
        if aim > now { aim.max(least(now)).min(growth * now).min(most) } else { now }
    };
    let aim = if aim == now {
        Shares { half_space: now.half_space + 1, pairs: (now.pairs + 1).min(most.pairs) }
    } else {
        aim
    };
    let pairs = towards(now.pairs, aim.pairs, MOST_GROWTH_OF_PAIRS, most.pairs);
    let half_space = towards(now.half_space, aim.half_space, MOST_GROWTH, most.half_space);
    Shares { half_space: half_space.max(pairs).min(most.half_space), pairs }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::estimate::Estimate;
    use super::*;

    /// Pairs of half-space and finite deformation, skewed and correlated.
    pub struct Draw {
        state: u64,
    }

    /// Mean of [`Draw::pair`] at finite deformation.
    pub const MEAN: f64 = 0.8;

    impl Draw {
        pub fn new(seed: u64) -> Self {
            Self { state: seed }
        }

        /// SplitMix64 (doi:10.1145/2660193.2660195), uniform above 0.
        fn uniform(&mut self) -> f64 {
            self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (((z ^ (z >> 31)) >> 11) as f64 + 1.0) / (1u64 << 53) as f64
        }

        /// Gamma of whole shape and mean 1.
        fn gamma(&mut self, shape: u32) -> f64 {
            let sum: f64 = (0..shape).map(|_| -self.uniform().ln()).sum();
            sum / f64::from(shape)
        }

        /// The half-space has mean 1, spread 0.35 and skewness 0.7; finite deformation is 0.8 of it with
        /// a noise of skewness 0.9; their correlation is 0.98.
        pub fn pair(&mut self) -> (f64, f64) {
            let half_space = self.gamma(8);
            (half_space, 0.8 * half_space + 0.12 * (self.gamma(5) - 1.0))
        }
    }

    fn goal(half_space: f64, difference: f64, half_width: f64) -> Goal {
        Goal { spread: Spread { half_space, difference, correlation: 0.0 }, half_width }
    }

    const NOW: Shares = Shares { half_space: 20, pairs: 5 };
    const MOST: Shares = Shares { half_space: 1000, pairs: 30 };
    const COSTS: Costs = Costs { half_space: 0.1, pair: 10.0 };

    #[test]
    fn cheap_realisations_are_added_before_dear_ones_as_far_as_they_help() {
        let half_space = choose(&[goal(1.0, 1e-6, 0.25)], NOW, MOST, COSTS).unwrap();
        assert_eq!(half_space.pairs, 5);
        assert!((55..=80).contains(&half_space.half_space), "{half_space:?}");
        // The differences alone are too wide: t(4) 0.3 / √5 = 0.37.
        let pairs = choose(&[goal(0.01, 0.09, 0.25)], NOW, MOST, COSTS).unwrap();
        assert!((7..=10).contains(&pairs.pairs), "{pairs:?}");
        // Pairs for nothing make the half-space grow no more than they need.
        let free = Costs { half_space: 1.0, pair: 1e-9 };
        let free = choose(&[goal(0.01, 0.09, 0.25)], NOW, MOST, free).unwrap();
        assert_eq!(free.half_space, 20);
    }

    #[test]
    fn the_choice_is_the_cheapest_of_all_that_meet_every_goal() {
        let goals = [goal(0.8, 0.04, 0.3), goal(0.5, 0.09, 0.35)];
        let chosen = choose(&goals, NOW, MOST, COSTS).unwrap();
        let cost = |s: Shares| 10.0 * (s.pairs - 5) as f64 + 0.1 * (s.half_space - 20) as f64;
        let meets = |s: Shares| goals.iter().all(|goal| goal.ratio(s) <= 1.0);
        assert!(meets(chosen));
        for pairs in 5..=30 {
            for half_space in 20..=80 {
                let other = Shares { half_space, pairs };
                let cheaper = pairs <= half_space && meets(other) && cost(other) < cost(chosen);
                assert!(!cheaper, "{other:?} {chosen:?}");
            }
        }
    }

    #[test]
    fn the_limits_end_the_search() {
        let out_of_reach = [goal(1.0, 1.0, 1e-3)];
        let next = choose(&out_of_reach, NOW, MOST, COSTS).unwrap();
        assert_eq!(next, Shares { half_space: 80, pairs: 10 });
        let full = Shares { half_space: 1000, pairs: 30 };
        assert_eq!(choose(&out_of_reach, full, MOST, COSTS), None);
        let no_pairs = Shares { half_space: 20, pairs: 0 };
        let none = Shares { half_space: 1000, pairs: 0 };
        let half_space = choose(&[goal(1.0, 0.0, 0.3)], no_pairs, none, COSTS).unwrap();
        assert_eq!(half_space.pairs, 0);
        assert!((45..=50).contains(&half_space.half_space), "{half_space:?}");
    }

    /// The numbers follow from the samples that they judge; how often the interval still holds the mean.
    #[test]
    fn averages_that_stop_when_they_are_good_enough_still_hold_the_mean() {
        let mut draw = Draw::new(11);
        let (families, tolerance) = (400, 0.05);
        let (mut inside, mut pairs_used) = (0, 0);
        for _ in 0..families {
            let pairs: Vec<(f64, f64)> = (0..1000).map(|_| draw.pair()).collect();
            let half_space: Vec<f64> = pairs.iter().map(|pair| pair.0).collect();
            let full: Vec<f64> = pairs.iter().map(|pair| pair.1).collect();
            let mut now = Shares { half_space: 40, pairs: 5 };
            let estimate = loop {
                let (b, f) = (&half_space[..now.half_space], &full[..now.pairs]);
                let estimate = Estimate::new(b, f);
                let half_width = tolerance * estimate.mean;
                let goal = Goal { spread: Spread::new(b, f), half_width };
                if estimate.confidence_95 <= half_width {
                    break estimate;
                }
                match choose(&[goal], now, Shares { half_space: 1000, pairs: 1000 }, COSTS) {
                    Some(next) => now = next,
                    None => break estimate,
                }
            };
            pairs_used += now.pairs;
            inside += usize::from((estimate.mean - MEAN).abs() <= estimate.confidence_95);
        }
        let share = inside as f64 / f64::from(families);
        let average = pairs_used as f64 / f64::from(families);
        eprintln!("{share} with {average} pairs");
        assert!(share >= 0.93, "{share} with {average} pairs");
    }
}
