//! The grid of a height map whose points are listed one by one.

/// A grid along two axes, and the place of each point on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lattice {
    /// Points along the first axis.
    pub(super) columns: usize,
    /// Points along the second axis.
    pub(super) rows: usize,
    /// Spacing along the first axis, in the unit of its positions.
    pub(super) step_x: f64,
    /// Spacing along the second axis, in the unit of its positions.
    pub(super) step_y: f64,
    origin: (f64, f64),
}

/// Points that a line needs to be one.
const FEWEST_POINTS: usize = 3;
/// Lines that a map needs to be one.
const FEWEST_LINES: usize = 2;
/// Largest distance of a position from its place, in spacings.
const LARGEST_DEVIATION: f64 = 0.3;

impl Lattice {
    /// The grid of positions that are sorted by rows or by columns; points and lines may be left
    /// out, directions may alternate.
    ///
    /// # Errors
    /// Why there is no grid, in words.
    pub(super) fn of(x: &[f64], y: &[f64]) -> Result<Self, String> {
        let fewest = FEWEST_LINES * FEWEST_POINTS;
        if x.len() < fewest {
            return Err(format!(
                "a map has at least {FEWEST_LINES} lines of {FEWEST_POINTS} points, {fewest} in all, and these are \
                 {}; for one line leave ingest.text.y_column out",
                x.len()
            ));
        }
        let (along_x, along_y) = (steps(x, y), steps(y, x));
        let (step_x, step_y) = match (along_x, along_y) {
            (Some((step_x, step_y)), None) => (step_x, step_y),
            (None, Some((step_y, step_x))) => (step_x, step_y),
            (Some(_), Some(_)) | (None, None) => {
                return Err(
                    "the positions are not sorted into the rows or columns of a map; sort the file by y and x".into()
                );
            }
        };
        let (columns, origin_x) = extent(x, step_x, "x")?;
        let (rows, origin_y) = extent(y, step_y, "y")?;
        Ok(Self { columns, rows, step_x, step_y, origin: (origin_x, origin_y) })
    }

    /// Place of a point: its column and its row.
    pub(super) fn place(&self, x: f64, y: f64) -> (usize, usize) {
        let place = |value: f64, origin: f64, step: f64| {
            ((value - origin) / step).round().max(0.0) as usize
        };
        (place(x, self.origin.0, self.step_x), place(y, self.origin.1, self.step_y))
    }
}

/// Number of places along an axis and the first of them.
fn extent(values: &[f64], step: f64, axis: &str) -> Result<(usize, f64), String> {
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let offset = |value: &f64| (value - lowest) - ((value - lowest) / step).round() * step;
    let origin = lowest + values.iter().map(offset).sum::<f64>() / values.len() as f64;
    let (mut last, mut worst) = (0.0_f64, (0.0_f64, lowest));
    for value in values {
        let place = ((value - origin) / step).round();
        last = last.max(place);
        let deviation = ((value - origin) / step - place).abs();
        if deviation > worst.0 {
            worst = (deviation, *value);
        }
    }
    if worst.0 > LARGEST_DEVIATION {
        return Err(format!(
            "the {axis} position {} is {:.0} % of the spacing {step:.6} off the grid of the others (in the unit of the \
             file); export the map on an equal grid",
            worst.1,
            100.0 * worst.0
        ));
    }
    Ok((last as usize + 1, origin))
}

/// Spacings along `fast`, the positions that change from point to point, and along `slow`, those
/// that change from line to line; `None` where the positions are not of that kind.
fn steps(fast: &[f64], slow: &[f64]) -> Option<(f64, f64)> {
    let lines = lines(fast);
    let points = fast.len();
    if lines.len() < FEWEST_LINES || points < FEWEST_POINTS * lines.len() {
        return None;
    }
    let step_fast = step(lines.iter().map(|line| &fast[line.clone()]))?;
    let level =
        |line: &std::ops::Range<usize>| slow[line.clone()].iter().sum::<f64>() / line.len() as f64;
    let levels: Vec<f64> = lines.iter().map(level).collect();
    let step_slow = step([levels.as_slice()].into_iter())?;
    // Lines that are none have other positions within them than between them.
    let off = |(line, level): (&std::ops::Range<usize>, &f64)| {
        slow[line.clone()]
            .iter()
            .filter(|value| (*value - level).abs() > LARGEST_DEVIATION * step_slow)
            .count()
    };
    let outside: usize = lines.iter().zip(&levels).map(off).sum();
    let turns = levels
        .windows(2)
        .filter(|pair| (pair[1] - pair[0]) * (levels[levels.len() - 1] - levels[0]) < 0.0);
    (20 * outside <= points && 20 * turns.count() <= levels.len()).then_some((step_fast, step_slow))
}

/// Runs of positions in one direction.
fn lines(fast: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut lines = Vec::new();
    let (mut start, mut direction) = (0, 0.0);
    for point in 1..fast.len() {
        let step = fast[point] - fast[point - 1];
        if point == start + 1 && step != 0.0 {
            direction = step;
        } else if step * direction <= 0.0 {
            lines.push(start..point);
            (start, direction) = (point, 0.0);
        }
    }
    if start < fast.len() {
        lines.push(start..fast.len());
    }
    lines
}

/// Spacing of positions in lines: the slope of the least-squares line through them over their
/// places, which the median step numbers.
fn step<'a>(lines: impl Iterator<Item = &'a [f64]> + Clone) -> Option<f64> {
    let mut sizes: Vec<f64> = lines
        .clone()
        .flat_map(|line| line.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
        .filter(|step| *step > 0.0)
        .collect();
    if sizes.is_empty() {
        return None;
    }
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    drop(sizes);
    let (mut over, mut under) = (0.0, 0.0);
    for line in lines {
        let place = |place: &mut f64, pair: &[f64]| {
            *place += ((pair[1] - pair[0]) / median).round();
            Some(*place)
        };
        let places = || std::iter::once(0.0).chain(line.windows(2).scan(0.0, place));
        let count = line.len() as f64;
        let (mean_place, mean) = (places().sum::<f64>() / count, line.iter().sum::<f64>() / count);
        for (place, value) in places().zip(line) {
            over += (place - mean_place) * (value - mean);
            under += (place - mean_place).powi(2);
        }
    }
    Some(over / under).filter(|step| *step > 0.0 && step.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions of `columns` times `rows` points, by rows.
    fn grid(columns: usize, rows: usize, step: (f64, f64), jitter: f64) -> (Vec<f64>, Vec<f64>) {
        let shift = |i: usize, k: usize| jitter * ((i * 7919 + k * 104_729) % 101) as f64 / 101.0;
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .enumerate()
            .map(|(i, (column, row))| {
                let place = |k: usize, at: usize, step: f64| 5.0 + (at as f64 + shift(i, k)) * step;
                (place(0, column, step.0), place(1, row, step.1))
            })
            .unzip()
    }

    fn is_found(x: &[f64], y: &[f64], size: (usize, usize), step: (f64, f64)) {
        let found = Lattice::of(x, y).unwrap();
        assert_eq!((found.columns, found.rows), size);
        approx::assert_relative_eq!(found.step_x, step.0, max_relative = 1e-3);
        approx::assert_relative_eq!(found.step_y, step.1, max_relative = 1e-2);
    }

    #[test]
    fn grids_are_found_by_rows_and_by_columns_with_jitter_and_gaps() {
        let step = (0.0375, 0.5);
        for jitter in [0.0, 0.1, 0.2] {
            let (x, y) = grid(40, 25, step, jitter);
            is_found(&x, &y, (40, 25), step);
            is_found(&y, &x, (25, 40), (step.1, step.0));
            // One row and every seventh point are not there.
            let kept = |i: usize| i % 7 != 3 && i / 40 != 11;
            let keep = |values: &[f64]| -> Vec<f64> {
                values
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| kept(*i))
                    .map(|(_, value)| *value)
                    .collect()
            };
            is_found(&keep(&x), &keep(&y), (40, 25), step);
        }
    }

    #[test]
    fn alternating_directions_rounded_positions_and_two_lines_are_grids() {
        let (mut x, y) = grid(30, 6, (0.0375, 0.05), 0.0);
        for line in x.chunks_mut(30).skip(1).step_by(2) {
            line.reverse();
        }
        is_found(&x, &y, (30, 6), (0.0375, 0.05));
        let (x, y) = grid(2000, 2, (0.0375, 0.05), 0.0);
        let rounded: Vec<f64> = x.iter().map(|x| (x * 1e3).round() / 1e3).collect();
        is_found(&rounded, &y, (2000, 2), (0.0375, 0.05));
    }

    #[test]
    fn lines_and_scattered_points_are_no_grids() {
        let line: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
        let height: Vec<f64> = line.iter().map(|x| (7.0 * x).sin()).collect();
        assert!(Lattice::of(&line, &height).is_err());
        assert!(Lattice::of(&line, &line).is_err());
        let scattered = |seed: f64| -> Vec<f64> {
            line.iter().map(|x| (x * seed).sin() * 43.0 % 1.0).collect()
        };
        assert!(Lattice::of(&scattered(917.3), &scattered(331.7)).is_err());
        assert!(Lattice::of(&[], &[]).is_err());
    }
}
