//! Total friction: hysteresis and the shear of the contact area together.

use super::adhesion::Adhesion;
use super::basis::Basis;
use super::{FrictionRow, Model, average};
use crate::artifact::{Row, Table};
use crate::interface::{ShearError, ShearLaw};
use crate::stages::bem::Given;
use crate::stages::friction::FrictionAt;
use crate::stages::realise::SurfaceKind;
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hysteretic, adhesive and total friction: `total.arrow`, where the recipe has a section `[adhesion]`.
pub const TOTAL: Table<TotalRow> = Table::new("tables", "total.arrow");

/// Friction by hysteresis and by the shear of the contact area, averaged over the realisations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TotalRow {
    /// Contact model of the hysteresis; the contact area is that of the half-space but for `fem` and the theories.
    pub model: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction, averaged over the realisations where the pressure is given.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure, averaged over the realisations where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Shortest wavelength of the surfaces.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_wavelength_mm: f64,
    /// Shortest wavelength at which the shear stress was fitted.
    #[schemars(extend("unit" = "mm"))]
    pub fitted_wavelength_mm: f64,
    /// Temperature of rubber and interface; absent where the recipe states none.
    #[schemars(extend("unit" = "degC"))]
    pub temperature_c: Option<f64>,
    /// Shear stress of the contact area.
    #[schemars(extend("unit" = "MPa"))]
    pub shear_mpa: f64,
    /// Friction coefficient by hysteresis: the mean of `friction.arrow`.
    #[schemars(extend("unit" = "1"))]
    pub hysteretic: f64,
    /// Friction coefficient by the shear of the contact area, shear stress times area over pressure.
    #[schemars(extend("unit" = "1"))]
    pub adhesive: f64,
    /// Sum of both.
    #[schemars(extend("unit" = "1"))]
    pub total: f64,
    /// Half width of the 95 % confidence interval of the total by the realisations, whose sums are averaged: a surface that
    /// is rougher has more hysteresis and less area.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Error of the total, all parts: those of the hysteretic friction, the error of contact area over pressure by the grid, and
    /// the scatter of the sum. It does not hold the error of the shear stress itself. Absent where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub error_estimate: Option<f64>,
}

impl Row for TotalRow {
    const SCHEMA: &'static str = "asperity.tables.total";
    const VERSION: u32 = 1;
}

/// The shear of the contact area for one recipe.
pub(super) struct Shear<'a> {
    section: &'a Adhesion,
    law: ShearLaw,
    temperature_c: Option<f64>,
}

impl<'a> Shear<'a> {
    /// For a section and the temperature of the rubber in °C.
    pub fn new(section: &'a Adhesion, temperature_c: Option<f64>) -> Result<Self, ShearError> {
        Ok(Self { section, law: section.shear_law()?, temperature_c })
    }

    /// In MPa.
    fn stress_mpa(&self, speed_mm_s: f64) -> Result<f64, ShearError> {
        // Without a shift the temperature has no effect, and the recipe need not state one.
        let temperature_c = self.temperature_c.unwrap_or(20.0);
        Ok(self.law.stress(speed_mm_s.mm_to_m(), temperature_c)?.pa_to_mpa())
    }

    /// Averages of the sums of both frictions, beside those of the hysteresis in `rows`, of the values of every model.
    pub fn totals(
        &self,
        values: &[(Model, Vec<FrictionAt>)],
        rows: &[FrictionRow],
        basis: &Basis,
    ) -> Result<Vec<TotalRow>, ShearError> {
        let mut totals = Vec::new();
        for (model, values) in values {
            let sums: Result<Vec<_>, _> = values.iter().map(|value| self.sum(value)).collect();
            let mut sums = average(*model, sums?);
            let hysteretic = |sum: &FrictionRow| rows.iter().find(|row| same(row, sum));
            for sum in &mut sums {
                sum.model_error = hysteretic(sum).and_then(|row| row.model_error);
            }
            basis.complete(&mut sums);
            for sum in &sums {
                totals.extend(hysteretic(sum).map(|row| self.row(sum, row)).transpose()?);
            }
        }
        Ok(totals)
    }

    /// A value with the friction of its contact area.
    pub fn sum(&self, value: &FrictionAt) -> Result<FrictionAt, ShearError> {
        let ratio = value.contact_area_fraction / value.pressure_mpa;
        let adhesive = self.stress_mpa(value.curve.speed_mm_s)? * ratio;
        let by_area = value.relative_area_error.map(|error| error * adhesive);
        Ok(FrictionAt {
            friction_coefficient: value.friction_coefficient + adhesive,
            discretisation_error: value.discretisation_error.zip(by_area).map(|(a, b)| a + b),
            ..value.clone()
        })
    }

    fn row(&self, sum: &FrictionRow, hysteretic: &FrictionRow) -> Result<TotalRow, ShearError> {
        Ok(TotalRow {
            model: sum.model,
            kind: sum.kind,
            speed_mm_s: sum.speed_mm_s,
            given: sum.given,
            contact_area_fraction: sum.contact_area_fraction,
            pressure_mpa: sum.pressure_mpa,
            shortest_wavelength_mm: sum.shortest_wavelength_mm,
            fitted_wavelength_mm: self.section.shortest_wavelength_mm,
            temperature_c: self.temperature_c,
            shear_mpa: self.stress_mpa(sum.speed_mm_s)?,
            hysteretic: hysteretic.mean,
            adhesive: sum.mean - hysteretic.mean,
            total: sum.mean,
            confidence_95: sum.confidence_95,
            error_estimate: sum.error_estimate,
        })
    }

    /// Warnings of tables whose shortest wavelength is not that of the shear stress.
    pub fn warnings(&self, totals: &[TotalRow]) -> Vec<String> {
        let fitted = self.section.shortest_wavelength_mm;
        let mut others: Vec<f64> = totals
            .iter()
            .map(|row| row.shortest_wavelength_mm)
            .filter(|shortest| (shortest / fitted - 1.0).abs() > SAME_WAVELENGTH)
            .collect();
        others.sort_by(f64::total_cmp);
        others.dedup();
        let warning = |shortest: &f64| {
            format!(
                "the shear stress of [adhesion] belongs to a shortest wavelength of {fitted} mm, and surfaces here end at \
                 {shortest:.6} mm: the contact area grows with every wave that is left out; fit it again with \
                 `asperity adhesion fit`"
            )
        };
        others.iter().map(warning).collect()
    }
}

/// Relative difference of shortest wavelengths that counts as none: windows have waves that are fractions of their length.
const SAME_WAVELENGTH: f64 = 0.05;

fn same(a: &FrictionRow, b: &FrictionRow) -> bool {
    (a.model, a.kind, a.speed_mm_s, a.condition()) == (b.model, b.kind, b.speed_mm_s, b.condition())
}
