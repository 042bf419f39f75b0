//! The mesh of the block: congruent parallelograms in every row.

/// Displacements, forces and positions of a row of nodes: `(x, z)` of node `j` at `[2 j]`.
pub type NodeRow = [f64];

/// Points of the plain Gauss rule on the unit square, at which the shear part is integrated.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Points at which one element is integrated: four for the shear part, the centre for the
/// volumetric part.
pub const POINTS: usize = 5;
/// The point of the volumetric part.
pub const CENTRE: usize = 4;
/// Coordinates of the points in the unit square.
pub const PLACES: [(f64, f64); POINTS] = [
    (GAUSS[0], GAUSS[0]),
    (GAUSS[1], GAUSS[0]),
    (GAUSS[0], GAUSS[1]),
    (GAUSS[1], GAUSS[1]),
    (0.5, 0.5),
];

/// A block of one period, cut into rows of equally wide elements.
///
/// Nodes of neighbouring rows may be shifted against each other. The body is homogeneous along a
/// row and the field periodic, so a shift changes nothing but the shape of the elements: it keeps
/// them upright when the block shears as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Elements in a row.
    pub columns: usize,
    /// Length of the period in m.
    pub period: f64,
    /// Height of each row of elements in m, from the contact upwards.
    pub row_heights: Vec<f64>,
    /// Shift of the nodes over height, `d(shift)/dZ`.
    pub skew: f64,
}

/// The growth of rows away from the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Height of the lowest row over the width of an element.
    pub first: f64,
    /// Ratio of the heights of neighbouring rows, at least 1.
    pub growth: f64,
}

impl Mesh {
    /// A mesh with rows that grow geometrically with the distance from the contact, up to
    /// an eighth of the period, where the field is smooth.
    pub fn graded(columns: usize, period: f64, height: f64, grading: Grading) -> Self {
        let largest = 0.125 * period.min(height);
        let mut heights = Vec::new();
        let mut next = grading.first * period / columns as f64;
        let mut total = 0.0;
        while total < height * (1.0 - 1e-12) {
            heights.push(next);
            total += next;
            next = (next * grading.growth).min(largest.max(next));
        }
        let scale = height / total;
        let row_heights = heights.iter().map(|h| h * scale).collect();
        Self { columns, period, row_heights, skew: 0.0 }
    }

    /// Rows of elements.
    pub fn rows(&self) -> usize {
        self.row_heights.len()
    }

    /// Width of an element in m.
    pub fn spacing(&self) -> f64 {
        self.period / self.columns as f64
    }

    /// Height of the block in m.
    pub fn height(&self) -> f64 {
        self.row_heights.iter().sum()
    }

    /// Heights Z in m of the rows of nodes.
    pub fn node_heights(&self) -> Vec<f64> {
        let mut z = 0.0;
        let mut heights = vec![0.0];
        for h in &self.row_heights {
            z += h;
            heights.push(z);
        }
        heights
    }

    /// Gradients and weights of the elements in a row.
    pub fn element(&self, row: usize) -> Element {
        Element::new(self.spacing(), self.row_heights[row], self.skew)
    }
}

impl Element {
    /// An element of the given `width` and `height` in m, whose upper edge is shifted along by
    /// `skew` times its height.
    pub fn new(width: f64, height: f64, skew: f64) -> Self {
        let gradients = PLACES.map(|(a, b)| {
            // Derivatives by the coordinates a and b of the unit square, nodes in the order
            // lower left, lower right, upper left, upper right.
            let by_a = [-(1.0 - b), 1.0 - b, -b, b];
            let by_b = [-(1.0 - a), -a, 1.0 - a, a];
            [0, 1, 2, 3]
                .map(|node| [by_a[node] / width, by_b[node] / height - skew * by_a[node] / width])
        });
        let area = width * height;
        Self { gradients, weights: [0.25 * area, 0.25 * area, 0.25 * area, 0.25 * area, area] }
    }
}

/// The integration of one element.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Gradient (1/m) of the shape function of each node at each point.
    pub gradients: [[[f64; 2]; 4]; POINTS],
    /// Weight in m² of each point.
    pub weights: [f64; POINTS],
}
