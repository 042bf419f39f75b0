//! Sparse matrices of 2 x 2 blocks: which nodes are coupled.

/// The 2 x 2 block of a pair of nodes: `block[i][j]` couples row unknown `i` to column unknown `j`.
pub type Block = [[f64; 2]; 2];

/// Positions of the nonzero blocks of a square matrix in compressed rows; 2 unknowns a node.
///
/// The blocks of a matrix of this pattern are a slice of [`Block`]s in the order of the rows, and
/// of the columns in a row. Unknown `c` of node `n` has the index `2 n + c`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockPattern {
    starts: Vec<usize>,
    columns: Vec<u32>,
}

impl BlockPattern {
    /// The pattern with these `(row, column)` pairs of nodes, in any order and with repetitions,
    /// and with the whole diagonal.
    ///
    /// # Panics
    /// If a node is not below `nodes`, or `nodes` does not fit into 32 bits.
    pub fn from_couplings(nodes: usize, couplings: &[(u32, u32)]) -> Self {
        let count = u32::try_from(nodes).expect("the nodes are numbered in 32 bits");
        let mut ends = vec![1; nodes + 1];
        ends[0] = 0;
        for &(row, column) in couplings {
            assert!(row < count && column < count, "a coupling names a node beyond {nodes}");
            ends[row as usize + 1] += 1;
        }
        for node in 0..nodes {
            ends[node + 1] += ends[node];
        }
        let mut next = ends.clone();
        let mut unsorted = vec![0; ends[nodes]];
        let diagonal = (0..count).map(|node| (node, node));
        for (row, column) in couplings.iter().copied().chain(diagonal) {
            unsorted[next[row as usize]] = column;
            next[row as usize] += 1;
        }
        let mut starts = vec![0];
        let mut columns = Vec::with_capacity(unsorted.len() / 2);
        for node in 0..nodes {
            let row = &mut unsorted[ends[node]..ends[node + 1]];
            row.sort_unstable();
            columns.extend(row.chunk_by(u32::eq).map(|same| same[0]));
            starts.push(columns.len());
        }
        Self { starts, columns }
    }

    /// Number of nodes: half the number of rows.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of nonzero blocks: the length of the values.
    pub fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Column nodes of a row of blocks, ascending.
    pub fn row(&self, node: usize) -> &[u32] {
        &self.columns[self.starts[node]..self.starts[node + 1]]
    }

    /// Position of the first block of this row of blocks in the values.
    pub fn start(&self, node: usize) -> usize {
        self.starts[node]
    }

    /// Position of the block of a pair of nodes in the values; `None` if it is zero.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let column = u32::try_from(column).ok()?;
        let within = self.row(row).binary_search(&column).ok()?;
        Some(self.starts[row] + within)
    }

    /// `y = A x` with the blocks `values`.
    ///
    /// # Panics
    /// If a length does not fit the pattern.
    pub fn multiply(&self, values: &[Block], x: &[f64], y: &mut [f64]) {
        assert!(values.len() == self.blocks() && x.len() == 2 * self.nodes() && y.len() == x.len());
        for (node, y) in y.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            *y = [0.0; 2];
            let blocks = &values[self.starts[node]..self.starts[node + 1]];
            for (&column, a) in self.row(node).iter().zip(blocks) {
                let x = &x[2 * column as usize..][..2];
                y[0] += a[0][0] * x[0] + a[0][1] * x[1];
                y[1] += a[1][0] * x[0] + a[1][1] * x[1];
            }
        }
    }

    /// The pattern of A + A^T.
    pub(super) fn symmetrised(&self) -> Self {
        let pairs = || {
            (0..self.nodes())
                .flat_map(|row| self.row(row).iter().map(move |&column| (row as u32, column)))
        };
        let both: Vec<(u32, u32)> = pairs().flat_map(|(i, j)| [(i, j), (j, i)]).collect();
        Self::from_couplings(self.nodes(), &both)
    }
}
