//! Friction of one surface at one speed and contact area, whatever model it is of.

use super::areal::ArealCurveRow;
use super::bem::{CurveRow, Given};
use super::feedback::ContactRow;
use super::fem::FemCurveRow;
use super::hybrid::HybridRow;
use super::realise::{Surface, SurfaceKind};
use super::tables::TheoryRow;

/// A curve of friction over contact area: one surface at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CurveId {
    /// Which surfaces.
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed in mm/s, as the recipe has it.
    pub speed_mm_s: f64,
}

impl Surface {
    /// Its curve at a speed in mm/s.
    pub(crate) fn at(&self, speed_mm_s: f64) -> CurveId {
        CurveId { kind: self.kind, realisation: self.realisation, speed_mm_s }
    }
}

impl CurveRow {
    /// The curve that it is a value of.
    pub(crate) fn curve(&self) -> CurveId {
        let Self { kind, realisation, speed_mm_s, .. } = *self;
        CurveId { kind, realisation, speed_mm_s }
    }

    /// Whether both are values of one curve.
    pub(crate) fn same_curve(&self, other: &Self) -> bool {
        self.curve() == other.curve()
    }
}

/// What a value of friction is given for, and the value of that: what values must share to be averaged or compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Condition(Given, u64);

impl Condition {
    /// From both contact area fraction and mean pressure in MPa, of which one counts. Both are positive, so that their
    /// bits have their order.
    pub fn of(given: Given, contact_area_fraction: f64, pressure_mpa: f64) -> Self {
        let value = match given {
            Given::Area => contact_area_fraction,
            Given::Pressure => pressure_mpa,
        };
        Self(given, value.to_bits())
    }
}

/// A value of friction with its errors; the units are those of the tables.
#[derive(Debug, Clone)]
pub(crate) struct FrictionAt {
    /// Whose it is.
    pub curve: CurveId,
    /// What the value is for.
    pub given: Given,
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
    /// Statistical error by the stretches of the microscale, absolute; `None` where it is not known.
    pub microscale_error: Option<f64>,
    /// Estimated error by the grid of contact area over pressure, relative; `None` where it is not known.
    pub relative_area_error: Option<f64>,
}

impl From<&CurveRow> for FrictionAt {
    fn from(row: &CurveRow) -> Self {
        Self {
            curve: row.curve(),
            given: row.given,
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient,
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            left_out_error: row.left_out_error,
            microscale_error: Some(0.0),
            relative_area_error: row.relative_area_error,
        }
    }
}

impl From<&ArealCurveRow> for FrictionAt {
    fn from(row: &ArealCurveRow) -> Self {
        let ArealCurveRow { kind, realisation, speed_mm_s, .. } = *row;
        let curve = CurveId { kind, realisation, speed_mm_s };
        let condition = [row.contact_area_fraction, row.pressure_mpa];
        Self {
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            relative_area_error: row.relative_area_error,
            ..Self::without_errors(curve, row.given, condition, row.friction_coefficient)
        }
    }
}

impl From<&ContactRow> for FrictionAt {
    fn from(row: &ContactRow) -> Self {
        let ContactRow { kind, realisation, speed_mm_s, .. } = *row;
        let curve = CurveId { kind, realisation, speed_mm_s };
        let condition = [row.contact_area_fraction, row.pressure_mpa];
        Self {
            discretisation_error: row.discretisation_error,
            relative_area_error: row.relative_area_error,
            ..Self::without_errors(curve, Given::Pressure, condition, row.friction_coefficient)
        }
    }
}

impl From<&FemCurveRow> for FrictionAt {
    fn from(row: &FemCurveRow) -> Self {
        let FemCurveRow { kind, realisation, speed_mm_s, .. } = *row;
        let curve = CurveId { kind, realisation, speed_mm_s };
        let condition = [row.contact_area_fraction, row.pressure_mpa];
        Self {
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            ..Self::without_errors(curve, row.given, condition, row.friction_coefficient)
        }
    }
}

impl From<&TheoryRow> for FrictionAt {
    fn from(row: &TheoryRow) -> Self {
        let TheoryRow { kind, realisation, speed_mm_s, .. } = *row;
        let curve = CurveId { kind, realisation, speed_mm_s };
        let condition = [row.contact_area_fraction, row.pressure_mpa];
        Self::without_errors(curve, row.given, condition, row.friction_coefficient)
    }
}

impl FrictionAt {
    /// Friction at a contact area fraction and a pressure in MPa, with all waves and no estimate of its error.
    fn without_errors(
        curve: CurveId,
        given: Given,
        [contact_area_fraction, pressure_mpa]: [f64; 2],
        friction_coefficient: f64,
    ) -> Self {
        Self {
            curve,
            given,
            contact_area_fraction,
            pressure_mpa,
            friction_coefficient,
            interpolation_error: 0.0,
            discretisation_error: None,
            left_out_error: 0.0,
            microscale_error: Some(0.0),
            relative_area_error: None,
        }
    }

    /// What it is given for, with the value that all realisations share.
    pub fn condition(&self) -> Condition {
        Condition::of(self.given, self.contact_area_fraction, self.pressure_mpa)
    }

    /// The corrected value; `None` where the correction is not known. Area and pressure are those of the half-space, whose
    /// error is not known here.
    pub fn corrected(row: &HybridRow) -> Option<Self> {
        let HybridRow { kind, realisation, speed_mm_s, .. } = *row;
        Some(Self {
            curve: CurveId { kind, realisation, speed_mm_s },
            given: row.given,
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            friction_coefficient: row.friction_coefficient?,
            interpolation_error: row.interpolation_error,
            discretisation_error: row.discretisation_error,
            left_out_error: row.left_out_error,
            microscale_error: row.microscale_error,
            relative_area_error: None,
        })
    }
}
