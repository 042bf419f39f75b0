//! The unknowns of a block whose upper edge moves as a whole.
//!
//! The upper edge moves as a whole in x, so its nodes share one unknown. All other nodes have two unknowns each. A
//! displacement of the rubber along itself changes nothing in the frame of the profile, so one condition is needed: the
//! mean x displacement of the contact nodes is zero, not that of the upper edge, so that the contact stays at the same
//! nodes however far the block shears.

/// Positions of unknowns in a vector: node by node, the upper edge with z only, then the common
/// x displacement of the upper edge.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns {
    /// Nodes in a row.
    pub columns: usize,
    /// Rows of elements.
    pub rows: usize,
}

impl Unknowns {
    /// Number of unknowns but the common displacement of the upper edge.
    pub fn free(&self) -> usize {
        self.upper_edge() + self.columns
    }

    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.free() + 1
    }

    /// First unknown of the upper edge.
    pub fn upper_edge(&self) -> usize {
        2 * self.columns * self.rows
    }

    /// Unknown of an entry of an array over the nodes; none for x at the upper edge.
    pub fn index_of(&self, entry: usize) -> Option<usize> {
        let upper = self.upper_edge();
        match entry.checked_sub(upper) {
            None => Some(entry),
            Some(beyond) if beyond % 2 == 1 => Some(upper + beyond / 2),
            Some(_) => None,
        }
    }

    /// Array over the nodes from the unknowns.
    pub fn expand(&self, unknowns: &[f64]) -> Vec<f64> {
        let upper = self.upper_edge();
        let common = unknowns[self.free()];
        let mut nodes = Vec::with_capacity(upper + 2 * self.columns);
        nodes.extend_from_slice(&unknowns[..upper]);
        nodes.extend(unknowns[upper..self.free()].iter().flat_map(|z| [common, *z]));
        nodes
    }

    /// Forces that belong to the unknowns, without the one of the upper edge along x, which holds the block; the mean x
    /// displacement of the contact nodes takes its place.
    pub fn reduce(&self, forces: &[f64], mean_displacement: f64) -> Vec<f64> {
        let upper = self.upper_edge();
        let mut reduced = Vec::with_capacity(self.count());
        reduced.extend_from_slice(&forces[..upper]);
        reduced.extend(forces[upper..].iter().skip(1).step_by(2));
        reduced.push(mean_displacement);
        reduced
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknowns_leave_out_the_x_displacements_of_the_upper_edge() {
        let unknowns = Unknowns { columns: 3, rows: 2 };
        assert_eq!((unknowns.free(), unknowns.count()), (15, 16));
        let values: Vec<f64> = (0..16).map(f64::from).collect();
        let nodes = unknowns.expand(&values);
        assert_eq!(nodes[12..], [15.0, 12.0, 15.0, 13.0, 15.0, 14.0]);
        for (entry, value) in nodes.iter().enumerate() {
            assert_eq!(unknowns.index_of(entry).map_or(15.0, |index| index as f64), *value);
        }
    }
}
