//! Friction of one surface at one speed and contact area, whatever model it is of.

use super::bem::CurveRow;
use super::fem::FemCurveRow;
use super::hybrid::HybridRow;
use super::realise::Surface;
use super::tables::TheoryRow;

/// A curve of friction over contact area: one surface at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CurveId {
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed in mm/s, as the recipe has it.
    pub speed_mm_s: f64,
}

impl Surface {
    /// Its curve at a speed in mm/s.
    pub(crate) fn at(&self, speed_mm_s: f64) -> CurveId {
        CurveId { waves: self.waves, realisation: self.realisation, speed_mm_s }
    }
}

impl CurveRow {
    /// The curve that it is a value of.
    pub(crate) fn curve(&self) -> CurveId {
        let Self { waves, realisation, speed_mm_s, .. } = *self;
        CurveId { waves, realisation, speed_mm_s }
    }

    /// Whether both are values of one curve.
    pub(crate) fn same_curve(&self, other: &Self) -> bool {
        self.curve() == other.curve()
    }
}

/// A value of friction with its errors; the units are those of the tables.
#[derive(Debug, Clone)]
pub(crate) struct FrictionAt {
    /// Whose it is.
    pub curve: CurveId,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
    /// Mean pressure in MPa.
    pub pressure_mpa: f64,
    /// Friction coefficient.
    pub friction_coefficient: f64,
    /// Estimated error by interpolation, absolute.
    pub interpolation_error: f64,
    /// Estimated error by the grid or the mesh, absolute; `None` where it is not known.
    pub discretisation_error: Option<f64>,
    /// Bound of the change by waves that were left out, absolute.
    pub left_out_error: f64,
}

impl From<&CurveRow> for FrictionAt {
    fn from(row: &CurveRow) -> Self {
        Self {
            curve: row.curve(),
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient,
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            left_out_error: row.left_out_error,
        }
    }
}

impl From<&FemCurveRow> for FrictionAt {
    fn from(row: &FemCurveRow) -> Self {
        let FemCurveRow { waves, realisation, speed_mm_s, .. } = *row;
        Self {
            curve: CurveId { waves, realisation, speed_mm_s },
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient,
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            left_out_error: 0.0,
        }
    }
}

impl From<&TheoryRow> for FrictionAt {
    fn from(row: &TheoryRow) -> Self {
        let TheoryRow { waves, realisation, speed_mm_s, .. } = *row;
        Self {
            curve: CurveId { waves, realisation, speed_mm_s },
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient,
            interpolation_error: 0.0,
            discretisation_error: None,
            left_out_error: 0.0,
        }
    }
}

impl FrictionAt {
    /// The corrected value; `None` where the correction is not known.
    pub fn corrected(row: &HybridRow) -> Option<Self> {
        let HybridRow { waves, realisation, speed_mm_s, .. } = *row;
        Some(Self {
            curve: CurveId { waves, realisation, speed_mm_s },
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient?,
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            left_out_error: row.left_out_error,
        })
    }
}
