//! The measured factors themselves.

use super::sweep::Ordered;
use super::{PayneError, StrainPoint, StrainSweep};
use crate::numerics::interpolation::CubicHermite;
use serde::Serialize;

/// Below the smallest strain divided by this both factors are 1.
const AT_REST: f64 = 3.2;
/// Largest factor that is read from a file: a loss modulus that grows tenfold with strain is a mistake.
const LARGEST: f64 = 10.0;

/// Factors over strain, cubic in ln ε between the points and monotone where they are; 1 at vanishing strain, constant beyond
/// the largest strain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PayneTable {
    rows: Vec<[f64; 3]>,
    // Both follow from the rows.
    #[serde(skip)]
    storage: CubicHermite,
    #[serde(skip)]
    loss: CubicHermite,
}

/// A table made of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFit {
    /// Temperature of the sweep in °C.
    pub temperature_c: Option<f64>,
    /// The table.
    pub table: PayneTable,
    /// Storage modulus at vanishing strain, in the unit of the sweep.
    pub storage_modulus: f64,
    /// Loss modulus at vanishing strain, in the unit of the sweep.
    pub loss_modulus: f64,
    /// Points that were left out as outliers.
    pub left_out: Vec<StrainPoint>,
    /// By how much storage moduli were changed to fall with strain, root mean square, relative.
    pub monotone_rms: f64,
}

impl PayneTable {
    /// The table of strains (ascending, positive) and factors.
    ///
    /// # Errors
    /// [`PayneError::Lengths`], [`PayneError::TooFewPoints`] for fewer than two strains, [`PayneError::NotAscending`];
    /// [`PayneError::Number`] for a strain or factor that is not positive, a storage factor above 1 or a loss factor above
    /// 10.
    pub fn new(
        temperature_c: Option<f64>,
        strain: &[f64],
        storage_factor: &[f64],
        loss_factor: &[f64],
    ) -> Result<Self, PayneError> {
        let (strains, storage, loss) = (strain.len(), storage_factor.len(), loss_factor.len());
        if storage != strains || loss != strains {
            return Err(PayneError::Lengths { temperature_c, strains, storage, loss });
        }
        if strains < 2 {
            let (points, needed) = (strains, 2);
            return Err(PayneError::TooFewPoints { temperature_c, points, needed });
        }
        let check = |quantity, values: &[f64], most: f64, wanted| {
            let bad = values.iter().find(|value| !(**value > 0.0 && **value <= most));
            bad.map_or(Ok(()), |value| {
                Err(PayneError::Number { temperature_c, quantity, value: *value, wanted })
            })
        };
        check("strain", strain, f64::MAX, "positive and finite")?;
        check("storage factor", storage_factor, 1.0, "positive and at most 1")?;
        check("loss factor", loss_factor, LARGEST, "positive and at most 10")?;
        if let Some(pair) = strain.windows(2).find(|pair| pair[1] <= pair[0]) {
            let (strain, before) = (pair[1], pair[0]);
            return Err(PayneError::NotAscending { temperature_c, strain, before });
        }
        let rows = (0..strains).map(|k| [strain[k], storage_factor[k], loss_factor[k]]).collect();
        Ok(Self::through(rows))
    }

    fn through(rows: Vec<[f64; 3]>) -> Self {
        let curve = |column: usize| {
            let mut x = vec![(rows[0][0] / AT_REST).ln()];
            x.extend(rows.iter().map(|row| row[0].ln()));
            let mut y = vec![1.0];
            y.extend(rows.iter().map(|row| row[column]));
            CubicHermite::monotone_parabolas(x, y)
        };
        let [storage, loss] = [curve(1), curve(2)];
        Self { rows, storage, loss }
    }

    /// The factors of a sweep: moduli over those at vanishing strain, outliers left out, the storage modulus made to fall
    /// with strain (the nearest falling sequence in ln E') and not above that at vanishing strain.
    ///
    /// # Errors
    /// [`PayneError::Number`], [`PayneError::TooFewPoints`].
    pub fn fit(sweep: &StrainSweep) -> Result<TableFit, PayneError> {
        let Ordered { points, left_out, at_rest: [storage_modulus, loss_modulus] } =
            sweep.ordered()?;
        let measured: Vec<f64> =
            points.iter().map(|point| (point.storage_modulus / storage_modulus).ln()).collect();
        let falling: Vec<f64> = falling(&measured).iter().map(|value| value.min(0.0)).collect();
        let squares: f64 = measured.iter().zip(&falling).map(|(a, b)| (a - b).powi(2)).sum();
        let monotone_rms = (squares / points.len() as f64).sqrt();
        let row = |(point, ln): (&StrainPoint, &f64)| {
            [point.strain, ln.exp(), point.loss_modulus / loss_modulus]
        };
        let table = Self::through(points.iter().zip(&falling).map(row).collect());
        let temperature_c = sweep.temperature_c;
        Ok(TableFit { temperature_c, table, storage_modulus, loss_modulus, left_out, monotone_rms })
    }

    /// Strain, storage factor and loss factor of each point.
    pub fn rows(&self) -> &[[f64; 3]] {
        &self.rows
    }

    pub(super) fn highest_strain(&self) -> f64 {
        self.rows[self.rows.len() - 1][0]
    }

    pub(super) fn factors(&self, strain: f64) -> [f64; 2] {
        if strain == 0.0 {
            return [1.0; 2];
        }
        let at = strain.ln();
        [self.storage.at(at), self.loss.at(at)]
    }
}

/// The falling sequence nearest to values, by least squares: pool adjacent violators.
fn falling(values: &[f64]) -> Vec<f64> {
    let mut blocks: Vec<(usize, f64)> = Vec::new();
    for value in values {
        blocks.push((1, *value));
        while let [.., before, last] = blocks[..]
            && before.1 < last.1
        {
            let count = before.0 + last.0;
            let mean = (before.0 as f64 * before.1 + last.0 as f64 * last.1) / count as f64;
            blocks.truncate(blocks.len() - 2);
            blocks.push((count, mean));
        }
    }
    blocks.into_iter().flat_map(|(count, value)| std::iter::repeat_n(value, count)).collect()
}
