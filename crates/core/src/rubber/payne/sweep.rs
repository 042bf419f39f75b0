//! Strain sweeps.

use super::PayneError;

/// Fewest strains of a sweep.
const FEWEST: usize = 5;
/// Strains that differ by no more, relative, are one strain.
const SAME: f64 = 1e-6;
/// The modulus at vanishing strain is the median of the points up to this multiple of the smallest strain: half a decade.
const PLATEAU: f64 = 3.2;
/// A modulus further from its neighbours than this, relative, is left out, unless all scatter as much.
const OUTLIER: f64 = 0.1;
/// Largest curvature of the logarithm of a modulus over that of the strain: `m²` of Kraus' law with an exponent of 0.7. A line
/// through two points of a smooth sweep misses a third one by no more than half of this times its distances from both.
const CURVATURE: f64 = 0.5;
/// Multiple of the limit at an end, where lines are extrapolated.
const AT_AN_END: f64 = 2.0;
/// Multiple of the median distance, in standard deviations of a normal distribution, beyond which a point is an outlier.
const OUTLIER_SCATTER: f64 = 5.0 * 1.4826;

/// One amplitude of a strain sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainPoint {
    /// Amplitude of elongation, dimensionless.
    pub strain: f64,
    /// Storage modulus in Pa, or in any unit: ratios count.
    pub storage_modulus: f64,
    /// Loss modulus in the same unit.
    pub loss_modulus: f64,
}

/// A sweep over strain at one temperature and frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct StrainSweep {
    /// Temperature in °C.
    pub temperature_c: Option<f64>,
    /// Frequency in Hz, if it is known.
    pub frequency_hz: Option<f64>,
    /// Points in any order.
    pub points: Vec<StrainPoint>,
}

/// A sweep put in order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ordered {
    /// By ascending strain, every strain once.
    pub points: Vec<StrainPoint>,
    /// Outliers that were left out.
    pub left_out: Vec<StrainPoint>,
    /// Storage and loss modulus at vanishing strain.
    pub at_rest: [f64; 2],
}

impl StrainSweep {
    /// Checks the points and puts them in order: sorted, equal strains averaged in logarithms, outliers left out, moduli at
    /// vanishing strain as the median over the lowest half decade.
    pub(super) fn ordered(&self) -> Result<Ordered, PayneError> {
        let temperature_c = self.temperature_c;
        for point in &self.points {
            for (quantity, value) in [
                ("strain", point.strain),
                ("storage modulus", point.storage_modulus),
                ("loss modulus", point.loss_modulus),
            ] {
                if !(value > 0.0 && value.is_finite()) {
                    let wanted = "positive and finite";
                    return Err(PayneError::Number { temperature_c, quantity, value, wanted });
                }
            }
        }
        let mut sorted = self.points.clone();
        sorted.sort_by(|a, b| a.strain.total_cmp(&b.strain));
        let same = |a: &StrainPoint, b: &StrainPoint| b.strain <= a.strain * (1.0 + SAME);
        let merged: Vec<StrainPoint> = sorted.chunk_by(same).map(mean).collect();
        let outlying = outliers(&merged);
        let of = |wanted: bool| {
            let kept = merged.iter().zip(&outlying).filter(move |(_, out)| **out == wanted);
            kept.map(|(point, _)| *point).collect::<Vec<StrainPoint>>()
        };
        let (points, left_out) = (of(false), of(true));
        if points.len() < FEWEST {
            let (points, needed) = (points.len(), FEWEST);
            return Err(PayneError::TooFewPoints { temperature_c, points, needed });
        }
        let smallest = points[0].strain;
        let plateau: Vec<&StrainPoint> =
            points.iter().filter(|point| point.strain <= PLATEAU * smallest).collect();
        let at_rest = [
            median(plateau.iter().map(|point| point.storage_modulus).collect()),
            median(plateau.iter().map(|point| point.loss_modulus).collect()),
        ];
        Ok(Ordered { points, left_out, at_rest })
    }
}

/// Which points lie off the lines through their neighbours in either modulus, by more than the scatter of all (in the manner
/// of Hampel's identifier, J. Am. Stat. Assoc. 69, 383, 1974, doi:10.1080/01621459.1974.10482962) and by more than a smooth
/// sweep bends between strains so far apart.
fn outliers(points: &[StrainPoint]) -> Vec<bool> {
    let x: Vec<f64> = points.iter().map(|point| point.strain.ln()).collect();
    let beyond = |of: fn(&StrainPoint) -> f64| {
        let y: Vec<f64> = points.iter().map(|point| of(point).ln()).collect();
        let lines: Vec<Line> = (0..y.len()).map(|k| Line::of_neighbours(&x, &y, k)).collect();
        let distances = lines.iter().map(|line| line.distance).collect();
        let limit = OUTLIER.max(OUTLIER_SCATTER * median(distances));
        let is_beyond = |(k, line): (usize, &Line)| {
            let at_an_end = k == 0 || k + 1 == x.len();
            let limit = if at_an_end { AT_AN_END * limit } else { limit };
            line.distance > limit.max(line.bend)
        };
        lines.iter().enumerate().map(is_beyond).collect::<Vec<bool>>()
    };
    let storage = beyond(|point| point.storage_modulus);
    let loss = beyond(|point| point.loss_modulus);
    storage.iter().zip(loss).map(|(a, b)| *a || b).collect()
}

/// A value beside the lines through pairs of its neighbours.
struct Line {
    /// Distance of the value from the median of the lines.
    distance: f64,
    /// The largest distance that the curvature of a smooth sweep explains: the median over the lines.
    bend: f64,
}

impl Line {
    /// One outlier among the neighbours is in less than half of the pairs. At an end the neighbours are the five on the one
    /// side that there is.
    fn of_neighbours(x: &[f64], y: &[f64], k: usize) -> Self {
        const AROUND: [(isize, isize); 10] = [
            (-1, 1),
            (-2, 2),
            (-2, -1),
            (1, 2),
            (-3, -1),
            (1, 3),
            (-1, 2),
            (-2, 1),
            (-3, 2),
            (-2, 3),
        ];
        const BESIDE: [(isize, isize); 10] =
            [(1, 2), (1, 3), (1, 4), (1, 5), (2, 3), (2, 4), (2, 5), (3, 4), (3, 5), (4, 5)];
        let pairs = match k {
            0 => BESIDE,
            _ if k + 1 == x.len() => BESIDE.map(|(a, b)| (-a, -b)),
            _ => AROUND,
        };
        let index = |offset: isize| k.checked_add_signed(offset).filter(|index| *index < x.len());
        let pairs = || pairs.into_iter().filter_map(|(a, b)| index(a).zip(index(b)));
        if pairs().next().is_none() {
            return Self { distance: 0.0, bend: 0.0 };
        }
        let line = |(a, b): (usize, usize)| y[a] + (x[k] - x[a]) / (x[b] - x[a]) * (y[b] - y[a]);
        let bend = |(a, b): (usize, usize)| 0.5 * CURVATURE * ((x[k] - x[a]) * (x[k] - x[b])).abs();
        Self {
            distance: (y[k] - median(pairs().map(line).collect())).abs(),
            bend: median(pairs().map(bend).collect()),
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

fn mean(points: &[StrainPoint]) -> StrainPoint {
    if let [only] = points {
        return *only;
    }
    let mean = |of: fn(&StrainPoint) -> f64| {
        (points.iter().map(|point| of(point).ln()).sum::<f64>() / points.len() as f64).exp()
    };
    StrainPoint {
        strain: mean(|point| point.strain),
        storage_modulus: mean(|point| point.storage_modulus),
        loss_modulus: mean(|point| point.loss_modulus),
    }
}
