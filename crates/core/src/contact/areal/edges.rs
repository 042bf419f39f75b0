//! Contact area with the edges read between grid points.
//!
//! Along a row or a column the pressures behind an edge are read as those of a line contact ([`EdgeReader`]): for an
//! edge across the row, or at half a right angle to it, the discrete problem next to the edge is that of a line, for
//! others nearly so. Each edge counts by rows and by columns in the parts that the square of its normal has along
//! both, so a row that an edge meets at a small angle, and that cannot be read, hardly counts.

use super::super::edges::EdgeReader;
use super::half_space::Body;
use rayon::prelude::*;
use std::f64::consts::{LN_2, PI};

/// Steps by which edges at odd angles to the grid are misread on average, at most: those of a Hertz contact, which have
/// all angles, are 0.013 steps too far in.
const MISREAD_STEPS: f64 = 0.02;

/// Reads contact areas on one grid.
pub(super) struct ArealEdges {
    along_rows: EdgeReader,
    along_columns: EdgeReader,
}

/// A contact area as part of the nominal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub fraction: f64,
    pub error: f64,
    /// Part of the points in contact.
    pub points: f64,
}

/// Contributions of a row.
#[derive(Clone, Copy, Default)]
struct Sum {
    points: usize,
    /// Neighbouring points of which one is in contact.
    edges: usize,
    /// Grid cells by which the contact is larger than its points.
    beyond: f64,
}

/// A field on the grid, periodic, with indices from -7 on.
#[derive(Clone, Copy)]
struct Grid<'a> {
    points: [usize; 2],
    values: &'a [f64],
}

impl Grid<'_> {
    fn at(&self, i: isize, j: isize) -> f64 {
        let wrap = |k: isize, n: usize| k.rem_euclid(n as isize) as usize;
        self.values[wrap(j, self.points[1]) * self.points[0] + wrap(i, self.points[0])]
    }
}

impl ArealEdges {
    /// Reader for a grid of a body.
    pub fn new(body: &Body, points: [usize; 2]) -> Self {
        let [vx, vy] = body.sliding.velocity();
        let spacing = |axis: usize| body.periods[axis] / points[axis] as f64;
        Self {
            along_rows: EdgeReader::new(body.rubber, vx, spacing(0)),
            along_columns: EdgeReader::new(body.rubber, vy, spacing(1)),
        }
    }

    /// Contact area for pressures and separations; the heights are those under the separations.
    pub fn area(
        &self,
        points: [usize; 2],
        pressure: &[f64],
        separation: &[f64],
        heights: &[f64],
    ) -> Area {
        let [nx, ny] = points;
        let grid = |values| Grid { points, values };
        let fields = [grid(pressure), grid(separation), grid(heights)];
        let rows: Vec<Sum> = (0..ny as isize)
            .into_par_iter()
            .map(|j| {
                (0..nx as isize).map(|i| self.at_point(&fields, i, j)).fold(Sum::default(), add)
            })
            .collect();
        let sum = rows.into_iter().fold(Sum::default(), add);
        let cells = (nx * ny) as f64;
        let in_contact = sum.points as f64 / cells;
        let fraction = ((sum.points as f64 + sum.beyond) / cells).clamp(0.0, 1.0);
        // Their correction for a digitised contact: (π - 1 + ln 2)/24 of the length of its edges along the grid.
        let by_length = in_contact - (PI - 1.0 + LN_2) / 24.0 * sum.edges as f64 / cells;
        let misread = MISREAD_STEPS * sum.edges as f64 / cells;
        let error = (fraction - by_length).abs().max(misread);
        Area { fraction, error, points: in_contact }
    }

    /// What the edges next to a contact point add.
    fn at_point(&self, fields: &[Grid; 3], i: isize, j: isize) -> Sum {
        let pressure = fields[0];
        if pressure.at(i, j) <= 0.0 {
            return Sum::default();
        }
        let mut sum = Sum { points: 1, ..Sum::default() };
        for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            if pressure.at(i + di, j + dj) > 0.0 {
                continue;
            }
            sum.edges += 1;
            let reader = if dj == 0 { &self.along_rows } else { &self.along_columns };
            let overhang = if pressure.at(i - di, j - dj) > 0.0 {
                let inwards = |k: usize| pressure.at(i - di * k as isize, j - dj * k as isize);
                reader.overhang_into(inwards, di + dj < 0)
            } else {
                0.5 * width_of_single_point(reader, fields, (i, j), (di, dj))
            };
            sum.beyond += share(pressure, (i, j), (di, dj)) * (overhang - 0.5);
        }
        sum
    }
}

/// Width in grid steps of a run of one point, see [`EdgeReader::width_of_single_point`].
fn width_of_single_point(
    reader: &EdgeReader,
    fields: &[Grid; 3],
    (i, j): (isize, isize),
    (di, dj): (isize, isize),
) -> f64 {
    let [_, separation, heights] = fields;
    let (si, sj) = (di.abs(), dj.abs());
    let places = [(i - si, j - sj), (i, j), (i + si, j + sj)];
    let open = places.map(|(i, j)| separation.at(i, j));
    // Displacements up to a constant.
    let displaced = places.map(|(i, j)| separation.at(i, j) + heights.at(i, j));
    reader.width_of_single_point(1, &displaced, &open)
}

/// Part in which an edge between a contact point and its neighbour counts: the square of the component of the normal,
/// by the contact points around both.
fn share(pressure: Grid, (i, j): (isize, isize), (di, dj): (isize, isize)) -> f64 {
    let inside = |i: isize, j: isize| f64::from(u8::from(pressure.at(i, j) > 0.0));
    let (mut along, mut across) = (0.0, 0.0);
    // Six points: both and their neighbours to the sides, and another six one step further out and in.
    for step in -1..=2_isize {
        let weight = if step <= 0 { 1.0 } else { -1.0 };
        for side in -1..=1_isize {
            let (a, b) = (i + di * step + dj * side, j + dj * step + di * side);
            along += weight * inside(a, b) * 0.5;
            across += inside(a, b) * side as f64 * 0.75;
        }
    }
    let (along, across) = (along * along, across * across);
    if along + across > 0.0 { along / (along + across) } else { 0.5 }
}

fn add(a: Sum, b: Sum) -> Sum {
    Sum { points: a.points + b.points, edges: a.edges + b.edges, beyond: a.beyond + b.beyond }
}
