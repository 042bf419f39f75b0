//! Measured rows put in order for a table of moduli.

use super::fit::SweepPoint;
use std::f64::consts::LN_10;

/// Frequencies that differ by no more, relative, are one frequency: rows are written with four digits.
const SAME: f64 = 1e-5;

/// Rows of a measured master curve as a table takes them: by ascending frequency, every frequency once.
///
/// A master curve is put together from sweeps at several temperatures, so its rows are out of order, share frequencies and
/// scatter. Rows are sorted; those of one frequency (within 1e-5) become one point, the mean of the logarithms of both
/// moduli. With `points_per_decade` n the decades from the lowest frequency on are parted into n equal steps of `log ω`, and
/// the points of a step become one, the mean of the logarithms of frequency and moduli.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// The points.
    pub points: Vec<SweepPoint>,
    /// What was done, in words with counts; nothing if the rows were in order.
    pub notes: Vec<String>,
}

impl Cleaned {
    /// Puts rows in order. Rows with numbers that are not positive are kept for
    /// [`MeasuredModuli::new`](super::MeasuredModuli::new) to refuse.
    pub fn new(rows: &[SweepPoint], points_per_decade: Option<f64>) -> Self {
        let mut notes = Vec::new();
        let frequency = |point: &SweepPoint| point.angular_frequency;
        let out_of_order = rows.windows(2).filter(|w| frequency(&w[1]) < frequency(&w[0])).count();
        let mut sorted = rows.to_vec();
        sorted.sort_by(|a, b| frequency(a).total_cmp(&frequency(b)));
        if out_of_order > 0 {
            notes.push(format!(
                "{} rows sorted by frequency: {out_of_order} came after a row of higher frequency",
                rows.len()
            ));
        }
        let same = |a: &SweepPoint, b: &SweepPoint| frequency(b) <= frequency(a) * (1.0 + SAME);
        let mut points: Vec<SweepPoint> = sorted.chunk_by(same).map(logarithmic_mean).collect();
        if points.len() < rows.len() {
            notes.push(format!(
                "{} rows repeat a frequency and are averaged (logarithmic mean): {} points",
                rows.len() - points.len(),
                points.len()
            ));
        }
        if let (Some(per_decade), Some(first)) = (points_per_decade, points.first().copied()) {
            let step = |point: &SweepPoint| {
                ((frequency(point) / frequency(&first)).ln() / LN_10 * per_decade + SAME).floor()
            };
            let before = points.len();
            points = points.chunk_by(|a, b| step(a) == step(b)).map(logarithmic_mean).collect();
            notes.push(format!(
                "{before} points averaged to {}, at most {per_decade} a decade (logarithmic mean)",
                points.len()
            ));
        }
        Self { points, notes }
    }
}

fn logarithmic_mean(points: &[SweepPoint]) -> SweepPoint {
    if let [only] = points {
        return *only;
    }
    let mean = |of: fn(&SweepPoint) -> f64| {
        (points.iter().map(|point| of(point).ln()).sum::<f64>() / points.len() as f64).exp()
    };
    SweepPoint {
        angular_frequency: mean(|point| point.angular_frequency),
        storage_modulus: mean(|point| point.storage_modulus),
        loss_modulus: mean(|point| point.loss_modulus),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(angular_frequency: f64, storage_modulus: f64, loss_modulus: f64) -> SweepPoint {
        SweepPoint { angular_frequency, storage_modulus, loss_modulus }
    }

    #[test]
    fn rows_in_order_stay_as_they_are() {
        let rows = [point(1.0, 2.0, 3.0), point(2.0, 3.0, 4.0)];
        assert_eq!(Cleaned::new(&rows, None), Cleaned { points: rows.to_vec(), notes: vec![] });
    }

    #[test]
    fn repeated_and_unsorted_rows_are_merged_and_counted() {
        let rows = [point(5.0, 4.0, 1.0), point(1.0, 2.0, 3.0), point(5.0, 9.0, 4.0)];
        let Cleaned { points, notes } = Cleaned::new(&rows, None);
        assert_eq!(points[0], rows[1]);
        // Geometric means by hand: 2*3 and 1*2.
        approx::assert_relative_eq!(points[1].storage_modulus, 6.0, max_relative = 1e-15);
        approx::assert_relative_eq!(points[1].loss_modulus, 2.0, max_relative = 1e-15);
        assert_eq!(points.len(), 2);
        assert!(notes[0].contains("3 rows sorted") && notes[0].contains(": 1 came"), "{notes:?}");
        assert!(notes[1].contains("1 rows repeat"), "{notes:?}");
    }

    #[test]
    fn a_power_law_stays_one_when_it_is_averaged() {
        let rows: Vec<SweepPoint> = (0..41)
            .map(|k| 10_f64.powf(f64::from(k) / 10.0))
            .map(|w| point(w, w.powf(0.3), 0.2 * w.powf(0.3)))
            .collect();
        let Cleaned { points, notes } = Cleaned::new(&rows, Some(2.0));
        assert_eq!(points.len(), 9);
        assert!(notes[0].contains("41 points averaged to 9"), "{notes:?}");
        for point in points {
            let exact = point.angular_frequency.powf(0.3);
            approx::assert_relative_eq!(point.storage_modulus, exact, max_relative = 1e-14);
        }
    }
}
