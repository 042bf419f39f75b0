//! Against dense LU in double precision.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::*;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, flexible_gmres};

/// A grid whose elements couple to their upstream neighbours too, with random values.
struct Grid {
    pattern: BlockPattern,
    coordinates: Vec<[f64; 2]>,
    values: Vec<Block>,
}

/// Numbers between -1 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }

    fn block(&mut self) -> Block {
        [[self.next(), self.next()], [self.next(), self.next()]]
    }
}

/// Nodes `columns[l]` wide in level `l` (each level as wide as the one before, or half), one more if
/// not periodic; an element of a level reaches into the next one, and into its upstream neighbour.
fn grid(columns: &[usize], periodic: bool, random: &mut Random) -> Grid {
    let mut coordinates = Vec::new();
    let mut first = Vec::new();
    for (level, &count) in columns.iter().enumerate() {
        first.push(coordinates.len());
        let nodes = count + usize::from(!periodic);
        let height = 0.01 * 1.3f64.powi(level as i32);
        coordinates.extend((0..nodes).map(|c| [c as f64 / count as f64, height]));
    }
    let node = |level: usize, column: usize| {
        first[level] + if periodic { column % columns[level] } else { column }
    };
    let corners = |level: usize, element: usize| {
        let ratio = columns[level] / columns[level + 1];
        let below = |column: usize| [column / ratio, column.div_ceil(ratio)];
        let lower = [below(element), below(element + 1)].concat();
        let mut nodes = vec![node(level, element), node(level, element + 1)];
        nodes.extend(lower.into_iter().map(|column| node(level + 1, column)));
        nodes
    };
    let mut couplings = Vec::new();
    for (level, &count) in columns[..columns.len() - 1].iter().enumerate() {
        for element in 0..count {
            let own = corners(level, element);
            let upstream = match element {
                0 if periodic => corners(level, count - 1),
                0 => Vec::new(),
                _ => corners(level, element - 1),
            };
            for &row in &own {
                couplings.extend(own.iter().chain(&upstream).map(|&c| (row as u32, c as u32)));
            }
        }
    }
    let pattern = BlockPattern::from_couplings(coordinates.len(), &couplings);
    let mut values: Vec<Block> = (0..pattern.blocks()).map(|_| random.block()).collect();
    for node in 0..pattern.nodes() {
        // Off the diagonal of the block, so that rows have to be exchanged.
        let at = pattern.position(node, node).unwrap();
        values[at][0][1] += 6.0;
        values[at][1][0] -= 6.0;
    }
    Grid { pattern, coordinates, values }
}

fn dense(grid: &Grid) -> Mat<f64> {
    let n = 2 * grid.pattern.nodes();
    let mut matrix = Mat::zeros(n, n);
    for row in 0..grid.pattern.nodes() {
        for (k, &column) in grid.pattern.row(row).iter().enumerate() {
            let block = grid.values[grid.pattern.start(row) + k];
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                matrix[(2 * row + i, 2 * column as usize + j)] = block[i][j];
            }
        }
    }
    matrix
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    euclidean_norm(&difference) / euclidean_norm(b)
}

/// Solves, and refines `steps` times with residuals in double precision.
fn solve(lu: &SparseLu, grid: &Grid, rhs: &[f64], steps: usize) -> Vec<f64> {
    let mut x = rhs.to_vec();
    lu.solve(&mut x);
    for _ in 0..steps {
        let mut correction = vec![0.0; rhs.len()];
        grid.pattern.multiply(&grid.values, &x, &mut correction);
        correction.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
        lu.solve(&mut correction);
        x.iter_mut().zip(correction).for_each(|(x, d)| *x += d);
    }
    x
}

#[test]
fn random_grids_agree_with_dense_elimination() {
    let mut random = Random(7);
    let grids: [(&[usize], bool); 7] = [
        (&[24; 9], true),
        (&[24; 9], false),
        (&[5; 40], true),
        (&[64, 64, 64, 32, 32, 16, 16, 8, 8], true),
        (&[48, 48, 24, 24, 12], false),
        (&[3; 2], true),
        (&[1; 2], false),
    ];
    for (columns, periodic) in grids {
        let mut grid = grid(columns, periodic, &mut random);
        let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
        // Twice, so that nothing of the first factors can be left in the second ones.
        for scale in [1.0, 1e9] {
            let mut unit = 1.0;
            for block in &mut grid.values {
                unit = if unit == 1.0 { 1.0 + 0.1 * random.next() } else { 1.0 };
                block.as_flattened_mut().iter_mut().for_each(|x| *x *= scale * unit);
            }
            lu.refactor(&grid.values, &Interrupt::default()).unwrap();
            let rhs: Vec<f64> = (0..2 * grid.pattern.nodes()).map(|_| random.next()).collect();
            let column = Mat::from_fn(rhs.len(), 1, |i, _| rhs[i]);
            let exact = dense(&grid).partial_piv_lu().solve(&column);
            let exact = exact.col_as_slice(0);
            let single = distance(&solve(&lu, &grid, &rhs, 0), exact);
            let refined = distance(&solve(&lu, &grid, &rhs, 1), exact);
            assert!(single < 3e-5, "{columns:?}, {periodic}: {single:e}");
            assert!(refined < 1e-10, "{columns:?}, {periodic}: {refined:e} after one refinement");
        }
    }
}

#[test]
fn old_factors_precondition_a_changed_matrix() {
    let mut random = Random(13);
    let mut grid = grid(&[64, 64, 64, 32, 32, 16, 16], true, &mut random);
    let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
    lu.refactor(&grid.values, &Interrupt::default()).unwrap();
    for block in &mut grid.values {
        block.as_flattened_mut().iter_mut().for_each(|x| *x *= 1.0 + 0.05 * random.next());
    }
    let exact: Vec<f64> = (0..2 * grid.pattern.nodes()).map(|_| random.next()).collect();
    let mut x = vec![0.0; exact.len()];
    grid.pattern.multiply(&grid.values, &exact, &mut x);
    let report = flexible_gmres(
        |x, y| grid.pattern.multiply(&grid.values, x, y),
        |v, z| {
            z.copy_from_slice(v);
            lu.solve(z);
        },
        &mut x,
        KrylovLimits { tolerance: 1e-11, max_iterations: 40 },
        &Interrupt::default(),
    );
    assert!(report.iterations < 25 && report.residual_norm <= 1e-11, "{report:?}");
    assert!(distance(&x, &exact) < 1e-11, "{:e}", distance(&x, &exact));
}

#[test]
fn rows_and_columns_of_unlike_size_cost_no_accuracy() {
    let mut random = Random(11);
    let mut grid = grid(&[16; 6], true, &mut random);
    let exponent = |index: usize| 10f64.powi((index % 5) as i32 * 12 - 24);
    for row in 0..grid.pattern.nodes() {
        for at in 0..grid.pattern.row(row).len() {
            let column = grid.pattern.row(row)[at] as usize;
            let block = &mut grid.values[grid.pattern.start(row) + at];
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                block[i][j] *= exponent(2 * row + i) * exponent(2 * column + j + 3);
            }
        }
    }
    let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
    lu.refactor(&grid.values, &Interrupt::default()).unwrap();
    let exact: Vec<f64> =
        (0..2 * grid.pattern.nodes()).map(|i| random.next() / exponent(i + 3)).collect();
    let mut x = vec![0.0; exact.len()];
    grid.pattern.multiply(&grid.values, &exact, &mut x);
    lu.solve(&mut x);
    for (i, (x, exact)) in x.iter().zip(&exact).enumerate() {
        let error = (x - exact).abs() * exponent(i + 3);
        assert!(error < 3e-5, "unknown {i}: {x} for {exact}");
    }
}

#[test]
fn scattered_nodes_without_order_or_distinct_coordinates_are_solved() {
    let mut random = Random(3);
    let nodes = 150;
    let couplings: Vec<(u32, u32)> = (0..nodes).map(|i| (i, (i * 7 + 3) % nodes)).collect();
    let pattern = BlockPattern::from_couplings(nodes as usize, &couplings);
    let mut values: Vec<Block> = (0..pattern.blocks()).map(|_| random.block()).collect();
    for node in 0..pattern.nodes() {
        let at = pattern.position(node, node).unwrap();
        values[at][0][0] += 4.0;
        values[at][1][1] += 4.0;
    }
    let grid = Grid { pattern, coordinates: vec![[0.5; 2]; nodes as usize], values };
    let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
    lu.refactor(&grid.values, &Interrupt::default()).unwrap();
    let exact: Vec<f64> = (0..2 * nodes).map(|_| random.next()).collect();
    let mut rhs = vec![0.0; exact.len()];
    grid.pattern.multiply(&grid.values, &exact, &mut rhs);
    assert!(distance(&solve(&lu, &grid, &rhs, 1), &exact) < 1e-10);
}

#[test]
fn singular_matrices_are_errors() {
    let mut random = Random(5);
    let mut grid = grid(&[32; 8], true, &mut random);
    let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
    let regular = grid.values.clone();
    // Rows that add up to zero, as those of a block that nothing holds: translations are free.
    for row in 0..grid.pattern.nodes() {
        let range = grid.pattern.start(row)..grid.pattern.start(row) + grid.pattern.row(row).len();
        let own = grid.pattern.position(row, row).unwrap();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let sum: f64 = range.clone().map(|at| grid.values[at][i][j]).sum();
            grid.values[own][i][j] -= sum;
        }
    }
    let outcome = lu.refactor(&grid.values, &Interrupt::default());
    assert!(outcome.is_err() || !lu.reproduces(&grid.values), "{outcome:?}");
    // A column of zeros is named.
    let mut zero = regular.clone();
    for row in 0..grid.pattern.nodes() {
        if let Some(at) = grid.pattern.position(row, 17) {
            zero[at][0][1] = 0.0;
            zero[at][1][1] = 0.0;
        }
    }
    let outcome = lu.refactor(&zero, &Interrupt::default());
    assert!(matches!(outcome, Err(FactorError::Singular { unknown: 35, .. })), "{outcome:?}");
    let mut not_a_number = regular.clone();
    not_a_number[100][0][0] = f64::NAN;
    let outcome = lu.refactor(&not_a_number, &Interrupt::default());
    assert!(matches!(outcome, Err(FactorError::Singular { .. })), "{outcome:?}");
    lu.refactor(&regular, &Interrupt::default()).unwrap();
    assert!(lu.reproduces(&regular));
}

#[test]
fn an_interrupt_ends_a_factorisation() {
    let grid = grid(&[32; 8], true, &mut Random(5));
    let mut lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
    let interrupt = Interrupt::default();
    interrupt.set();
    assert_eq!(lu.refactor(&grid.values, &interrupt), Err(FactorError::Interrupted));
    lu.refactor(&grid.values, &Interrupt::default()).unwrap();
}

#[test]
fn factors_of_a_strip_grow_with_its_length_alone() {
    let per_node = |columns: usize| {
        let grid = grid(&[columns; 18], true, &mut Random(1));
        let lu = SparseLu::analyse(grid.pattern.clone(), &grid.coordinates);
        lu.nonzeros() as f64 / grid.pattern.nodes() as f64
    };
    let (short, long) = (per_node(96), per_node(1536));
    assert!(long < 1.3 * short, "{short} and {long} factors a node");
}
