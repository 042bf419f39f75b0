//! Nested dissection by coordinates: an order of elimination that keeps the factors sparse.

use super::pattern::BlockPattern;

/// A set of nodes that is eliminated at once, after the sets that it separates.
#[derive(Debug)]
pub(super) struct Part {
    /// The nodes: a separator, or the inside of a leaf.
    pub nodes: Vec<u32>,
    /// The parts that this one separates (none for a leaf, else two).
    pub children: Vec<usize>,
}

/// A set of at most this many nodes is not cut further: its front is dense and small enough.
const LEAF: usize = 16;

/// Halves the set of nodes recursively (George 1973, doi:10.1137/0710032) and returns
/// separators and leaves in postorder: children come before their parent, the root is last.
///
/// A cut is a line across one of the two axes; the nodes of one side that have a neighbour on the
/// other are the separator. Of the two axes and sides that with the smallest separator is taken.
/// Couplings around the wrap of a periodic grid are cut by the first line across them, as all others
/// are, so no period need be known.
pub(super) fn dissect(graph: &BlockPattern, coordinates: &[[f64; 2]]) -> Vec<Part> {
    let mut dissection = Dissection {
        graph,
        coordinates,
        side: vec![Side::Outside; graph.nodes()],
        parts: Vec::new(),
    };
    dissection.cut((0..graph.nodes() as u32).collect());
    dissection.parts
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Outside,
    Low,
    High,
}

struct Dissection<'a> {
    graph: &'a BlockPattern,
    coordinates: &'a [[f64; 2]],
    /// Of each node in the present cut; `Outside` between cuts.
    side: Vec<Side>,
    parts: Vec<Part>,
}

/// A set of nodes without its separator.
struct Halves {
    low: Vec<u32>,
    high: Vec<u32>,
    separator: Vec<u32>,
}

impl Dissection<'_> {
    /// Cuts a set of nodes down to leaves; returns the index of its own part.
    fn cut(&mut self, nodes: Vec<u32>) -> usize {
        let part = if nodes.len() <= LEAF {
            Part { nodes, children: Vec::new() }
        } else {
            let [x, y] = [0, 1].map(|axis| self.halve(&nodes, axis));
            let halves = if y.separator.len() < x.separator.len() { y } else { x };
            if halves.low.is_empty() || halves.high.is_empty() {
                // Everything is coupled to everything: nothing to gain.
                Part { nodes, children: Vec::new() }
            } else {
                drop(nodes);
                let children = vec![self.cut(halves.low), self.cut(halves.high)];
                Part { nodes: halves.separator, children }
            }
        };
        self.parts.push(part);
        self.parts.len() - 1
    }

    /// Halves a set across an axis, between two different coordinates if there are any.
    fn halve(&mut self, nodes: &[u32], axis: usize) -> Halves {
        let at = |node: u32| self.coordinates[node as usize];
        let mut sorted = nodes.to_vec();
        sorted.sort_unstable_by(|&a, &b| {
            let (p, q) = (at(a), at(b));
            p[axis].total_cmp(&q[axis]).then(p[1 - axis].total_cmp(&q[1 - axis])).then(a.cmp(&b))
        });
        let middle = sorted.len() / 2;
        let here = at(sorted[middle])[axis];
        let first = sorted.partition_point(|&node| at(node)[axis] < here);
        let last = sorted.partition_point(|&node| at(node)[axis] <= here);
        let nearest = if middle - first <= last - middle { first } else { last };
        // All have the same coordinate: order them by the other one and their number.
        let cut = if nearest == 0 || nearest == sorted.len() { middle } else { nearest };
        let (low, high) = sorted.split_at(cut);
        self.separate(low, high)
    }

    fn separate(&mut self, low: &[u32], high: &[u32]) -> Halves {
        low.iter().for_each(|&node| self.side[node as usize] = Side::Low);
        high.iter().for_each(|&node| self.side[node as usize] = Side::High);
        let touches = |node: u32, side: Side| {
            self.graph.row(node as usize).iter().any(|&other| self.side[other as usize] == side)
        };
        let (low_edge, low_rest): (Vec<u32>, Vec<u32>) =
            low.iter().partition(|&&node| touches(node, Side::High));
        let (high_edge, high_rest): (Vec<u32>, Vec<u32>) =
            high.iter().partition(|&&node| touches(node, Side::Low));
        low.iter().chain(high).for_each(|&node| self.side[node as usize] = Side::Outside);
        if low_edge.len() <= high_edge.len() {
            Halves { low: low_rest, high: high.to_vec(), separator: low_edge }
        } else {
            Halves { low: low.to_vec(), high: high_rest, separator: high_edge }
        }
    }
}
