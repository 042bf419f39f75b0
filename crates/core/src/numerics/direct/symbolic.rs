//! The symbolic factorisation: fronts, their borders and the position of each block.

use std::ops::Range;

use super::FactorError;
use super::dissection::{Part, dissect};
use super::numeric::Pivot;
use super::pattern::BlockPattern;

/// A dense matrix in which some nodes are eliminated, with the nodes that these are then coupled to.
///
/// Its factors are stored column by column: first the panel, columns of the own unknowns over all
/// rows (own, then border), then the columns of the border over the own rows.
#[derive(Debug)]
pub(super) struct Front {
    /// Own nodes, in the order of elimination.
    pub own: Range<usize>,
    /// The nodes that remain, by their position in the order of elimination, ascending.
    pub border: Vec<u32>,
    /// Position of each border node among own and border nodes of the parent, ascending.
    pub in_parent: Vec<u32>,
    pub children: Vec<usize>,
    /// First front of this one's subtree (fronts are in postorder).
    pub first: usize,
    /// Where its factors begin.
    pub offset: usize,
    /// Its blocks of the matrix.
    pub blocks: Vec<Entry>,
    /// Multiplications and additions of the whole subtree.
    pub work: f64,
}

/// A block of the matrix in a front.
#[derive(Debug)]
pub(super) struct Entry {
    /// Row node and column node in the matrix.
    pub row: u32,
    pub column: u32,
    /// Index in the values.
    pub value: u32,
    /// Position of its first entry in the factors of the front.
    pub to: u32,
}

impl Front {
    /// Number of unknowns that are eliminated.
    pub fn pivots(&self) -> usize {
        2 * self.own.len()
    }

    /// Number of unknowns that remain.
    pub fn remaining(&self) -> usize {
        2 * self.border.len()
    }

    /// Length of the panel.
    pub fn panel(&self) -> usize {
        self.pivots() * (self.pivots() + self.remaining())
    }

    /// Length of the factors.
    pub fn factors(&self) -> usize {
        self.panel() + self.pivots() * self.remaining()
    }
}

/// The order of elimination and its fronts.
#[derive(Debug)]
pub(super) struct Symbolic {
    /// Fronts in postorder.
    pub fronts: Vec<Front>,
    /// The node at each position in the order of elimination.
    pub order: Vec<u32>,
}

impl Symbolic {
    pub fn new(pattern: &BlockPattern, coordinates: &[[f64; 2]]) -> Self {
        let graph = pattern.symmetrised();
        let parts = dissect(&graph, coordinates);
        let order: Vec<u32> = parts.iter().flat_map(|part| &part.nodes).copied().collect();
        let mut place = vec![0; order.len()];
        for (at, &node) in order.iter().enumerate() {
            place[node as usize] = at as u32;
        }
        let mut fronts = eliminate(&graph, &parts, &order, &place);
        distribute(pattern, &mut fronts, &order, &place);
        Self { fronts, order }
    }

    /// Index of the unknown at each position in the order of elimination.
    pub fn unknowns(&self) -> impl Iterator<Item = usize> {
        self.order.iter().flat_map(|&node| [2 * node as usize, 2 * node as usize + 1])
    }

    /// Names the unknown of a pivot that is too small.
    pub fn singular(&self, pivot: Pivot) -> FactorError {
        let unknown = 2 * self.order[pivot.place / 2] as usize + pivot.place % 2;
        FactorError::Singular { unknown, relative: f64::from(pivot.relative) }
    }
}

/// Finds the borders: nodes coupled to the eliminated ones, and the borders of the children.
fn eliminate(graph: &BlockPattern, parts: &[Part], order: &[u32], place: &[u32]) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::with_capacity(parts.len());
    let (mut begin, mut offset) = (0, 0);
    for (k, part) in parts.iter().enumerate() {
        let own = begin..begin + part.nodes.len();
        begin = own.end;
        let coupled = order[own.clone()]
            .iter()
            .flat_map(|&node| graph.row(node as usize).iter().map(|&other| place[other as usize]));
        let left = part.children.iter().flat_map(|&child| fronts[child].border.iter().copied());
        let mut border: Vec<u32> =
            coupled.chain(left).filter(|&at| at as usize >= own.end).collect();
        border.sort_unstable();
        border.dedup();
        for &child in &part.children {
            let in_parent = places(&fronts[child].border, &own, &border);
            fronts[child].in_parent = in_parent;
        }
        let below: f64 = part.children.iter().map(|&child| fronts[child].work).sum();
        let mut front = Front {
            own,
            border,
            in_parent: Vec::new(),
            first: part.children.first().map_or(k, |&child| fronts[child].first),
            children: part.children.clone(),
            offset,
            blocks: Vec::new(),
            work: 0.0,
        };
        let (p, b) = (front.pivots() as f64, front.remaining() as f64);
        front.work = below + p * p * p / 3.0 + p * p * b + p * b * b;
        offset += front.factors();
        fronts.push(front);
    }
    fronts
}

/// Positions of the border nodes of a child among the own and border nodes of the parent.
fn places(border: &[u32], own: &Range<usize>, parents: &[u32]) -> Vec<u32> {
    border.iter().map(|&at| within(at as usize, own, parents) as u32).collect()
}

fn within(at: usize, own: &Range<usize>, border: &[u32]) -> usize {
    if at < own.end {
        at - own.start
    } else {
        let index = border.binary_search(&(at as u32));
        own.len() + index.expect("a coupled node is in the border")
    }
}

/// Gives each block to the front that eliminates the earlier one of its nodes.
fn distribute(pattern: &BlockPattern, fronts: &mut [Front], order: &[u32], place: &[u32]) {
    let mut owner = vec![0; order.len()];
    for (k, front) in fronts.iter().enumerate() {
        owner[front.own.clone()].fill(k);
    }
    for row in 0..pattern.nodes() {
        let i = place[row] as usize;
        for (value, &column) in (pattern.start(row)..).zip(pattern.row(row)) {
            let j = place[column as usize] as usize;
            let front = &mut fronts[owner[i.min(j)]];
            let (p, b) = (front.pivots(), front.remaining());
            let r = 2 * within(i, &front.own, &front.border);
            let c = 2 * within(j, &front.own, &front.border);
            let to = if c < p { c * (p + b) + r } else { front.panel() + (c - p) * p + r };
            let to = u32::try_from(to).expect("a front has fewer than 2^32 entries");
            front.blocks.push(Entry { row: row as u32, column, value: value as u32, to });
        }
    }
}
