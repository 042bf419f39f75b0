//! Strain sweeps.

use super::PayneError;

/// Fewest strains of a sweep.
const FEWEST: usize = 5;
/// Strains that differ by no more, relative, are one strain.
const SAME: f64 = 1e-6;
/// The modulus at vanishing strain is the median of the points up to this multiple of the smallest strain: half a decade.
const PLATEAU: f64 = 3.2;
/// A modulus further from the median of its neighbours than this, relative, is left out, unless all scatter as much.
const OUTLIER: f64 = 0.05;
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

/// Which points lie off the median of the five around them (Hampel's identifier, J. Am. Stat. Assoc. 69, 383, 1974,
/// doi:10.1080/01621459.1974.10482962) in either modulus. At an end the five are those next to it, with the trend over
/// them taken off.
fn outliers(points: &[StrainPoint]) -> Vec<bool> {
    let distances = |of: fn(&StrainPoint) -> f64| -> Vec<f64> {
        let ln: Vec<f64> = points.iter().map(|point| of(point).ln()).collect();
        (0..ln.len()).map(|k| distance(&ln, k)).collect()
    };
    let beyond = |distances: &[f64]| {
        let scatter = median(distances.iter().map(|distance| distance.abs()).collect());
        let limit = OUTLIER.max(OUTLIER_SCATTER * scatter);
        distances.iter().map(|distance| distance.abs() > limit).collect::<Vec<bool>>()
    };
    let [storage, loss] = [
        beyond(&distances(|point| point.storage_modulus)),
        beyond(&distances(|point| point.loss_modulus)),
    ];
    storage.iter().zip(loss).map(|(a, b)| *a || b).collect()
}

/// Distance of a value from the line through its neighbours, median over the pairs of the two nearest on either side; at an
/// end from the line through pairs on the one side that there is.
fn distance(values: &[f64], k: usize) -> f64 {
    let value = |offset: isize| {
        let index = k.checked_add_signed(offset)?;
        values.get(index).copied()
    };
    let mut predicted = Vec::new();
    for (a, b) in [(-1, 1), (-2, 2), (-2, -1), (1, 2), (-3, -1), (1, 3), (-1, 2), (-2, 1)] {
        if let (Some(left), Some(right)) = (value(a), value(b)) {
            let part = -(a as f64) / (b - a) as f64;
            predicted.push(left + part * (right - left));
        }
    }
    if predicted.is_empty() { 0.0 } else { values[k] - median(predicted) }
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
