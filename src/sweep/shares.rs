//! Tasks dealt to shards by their predicted cost.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Deals tasks of the given costs to `shards` of about equal sums by longest-processing-time scheduling: the costliest
/// first, each to the shard with the least so far (Graham, whose largest sum is at most 4/3 of the least possible,
/// doi:10.1137/0117039). Returns the tasks of each shard, the costliest first.
///
/// Equal costs are dealt in their order, so that the same tasks give the same shares everywhere.
pub fn deal(costs: &[f64], shards: usize) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|a, b| costs[*b].total_cmp(&costs[*a]).then(a.cmp(b)));
    let mut shares = vec![Vec::new(); shards];
    let mut least: BinaryHeap<Reverse<(Load, usize)>> =
        (0..shards).map(|shard| Reverse((Load(0.0), shard))).collect();
    for task in order {
        let Some(Reverse((Load(sum), shard))) = least.pop() else { break };
        shares[shard].push(task);
        least.push(Reverse((Load(sum + costs[task]), shard)));
    }
    shares
}

/// A sum of costs, with an order.
#[derive(PartialEq)]
struct Load(f64);

impl Eq for Load {}

impl Ord for Load {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Load {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sums(costs: &[f64], shares: &[Vec<usize>]) -> Vec<f64> {
        shares.iter().map(|tasks| tasks.iter().map(|task| costs[*task]).sum()).collect()
    }

    #[test]
    fn the_known_worst_case_of_the_rule_is_reproduced() {
        // Two machines, 3 3 2 2 2: the rule ends at 7, the optimum is 6.
        let costs = [3.0, 2.0, 3.0, 2.0, 2.0];
        let shares = deal(&costs, 2);
        assert_eq!(shares, [vec![0, 1, 4], vec![2, 3]]);
        assert_eq!(sums(&costs, &shares), [7.0, 5.0]);
    }

    proptest! {
        #[test]
        fn every_task_is_dealt_once_and_no_shard_has_much_more_than_another(
            costs in proptest::collection::vec(0.0_f64..10.0, 0..200),
            shards in 1_usize..20,
        ) {
            let shares = deal(&costs, shards);
            let mut all: Vec<usize> = shares.concat();
            all.sort_unstable();
            prop_assert_eq!(all, (0..costs.len()).collect::<Vec<_>>());
            let sums = sums(&costs, &shares);
            let (least, most) = (
                sums.iter().copied().fold(f64::INFINITY, f64::min),
                sums.iter().copied().fold(0.0, f64::max),
            );
            let dearest = costs.iter().copied().fold(0.0, f64::max);
            prop_assert!(most - least <= dearest + 1e-9);
        }
    }
}
