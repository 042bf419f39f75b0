//! Contact patches of a periodic map.

/// The patches of a contact: points that touch along an edge of their cells, also across the edges of the period.
pub(super) struct Patches {
    /// The patch of every point, row by row; `None` outside the contact.
    of_point: Vec<Option<usize>>,
    /// Points of every patch.
    sizes: Vec<usize>,
}

impl Patches {
    /// Finds them; `contact` has `points[0]` points in each row.
    pub fn of(contact: &[bool], points: [usize; 2]) -> Self {
        let [nx, ny] = points;
        let mut of_point = vec![None; contact.len()];
        let mut sizes = Vec::new();
        for start in 0..contact.len() {
            if !contact[start] || of_point[start].is_some() {
                continue;
            }
            let patch = sizes.len();
            of_point[start] = Some(patch);
            let mut open = vec![start];
            let mut size = 0;
            while let Some(point) = open.pop() {
                size += 1;
                let (x, y) = (point % nx, point / nx);
                let row = |y: usize| nx * (y % ny);
                let neighbours = [
                    row(y) + (x + 1) % nx,
                    row(y) + (x + nx - 1) % nx,
                    row(y + 1) + x,
                    row(y + ny - 1) + x,
                ];
                for next in neighbours {
                    if contact[next] && of_point[next].is_none() {
                        of_point[next] = Some(patch);
                        open.push(next);
                    }
                }
            }
            sizes.push(size);
        }
        Self { of_point, sizes }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.sizes.len()
    }

    /// Share of the largest patch in all points in contact.
    pub fn largest_share(&self) -> f64 {
        let largest = self.sizes.iter().max().copied().unwrap_or(0);
        largest as f64 / self.sizes.iter().sum::<usize>().max(1) as f64
    }

    /// For every point the number of points of its patch; NaN outside the contact.
    pub fn size_at_points(&self) -> Vec<f64> {
        let size = |patch: &Option<usize>| patch.map_or(f64::NAN, |patch| self.sizes[patch] as f64);
        self.of_point.iter().map(size).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patches(rows: &[&str]) -> Patches {
        let contact: Vec<bool> =
            rows.iter().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
        Patches::of(&contact, [rows[0].len(), rows.len()])
    }

    #[test]
    fn patches_go_on_across_the_edges_of_the_period() {
        let found = patches(&["#....#", "......", "..##..", "#.....", "#....."]);
        // The corner, with what is below it in the next period; the middle.
        assert_eq!((found.count(), found.largest_share()), (2, 4.0 / 6.0));
        let sizes = found.size_at_points();
        assert!(sizes[1].is_nan());
        assert_eq!((sizes[0], sizes[5], sizes[14], sizes[24]), (4.0, 4.0, 2.0, 4.0));
    }

    #[test]
    fn corners_do_not_join_patches() {
        assert_eq!(patches(&["....", ".#..", "..#.", "...."]).count(), 2);
        let nothing = patches(&["...", "..."]);
        assert_eq!((nothing.count(), nothing.largest_share()), (0, 0.0));
        let all = patches(&["##", "##"]);
        assert_eq!((all.count(), all.largest_share()), (1, 1.0));
    }
}
