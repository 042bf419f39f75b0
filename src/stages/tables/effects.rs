//! Friction with the heat and the strain of the contact beside that without.

use super::average::average;
use super::basis::Basis;
use super::total::Shear;
use super::{FrictionRow, Model};
use crate::artifact::{Row, RunView, Table};
use crate::interface::ShearError;
use crate::stages::StageError;
use crate::stages::feedback::{CONTACTS, ContactRow, Effect, UNSOLVED, UnsolvedRow};
use crate::stages::friction::FrictionAt;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Friction under every effect: `effects.arrow`, where the recipe has a section `[feedback]`.
pub const EFFECTS: Table<EffectRow> = Table::new("tables", "effects.arrow");

/// Friction of the half-space under one effect, averaged over the realisations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// What changes the moduli: `cold`, nothing, as in `friction.arrow`; `soft`, strain; `hot`, heat; `soft-hot`, both.
    pub effect: Effect,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Shortest wavelength of the surfaces.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_wavelength_mm: f64,
    /// Windows of the scans that the surfaces are made of; 0 where the recipe states the waves.
    pub windows: u32,
    /// Contact area fraction, mean over the realisations.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Friction coefficient by hysteresis of each realisation, in their order.
    #[schemars(extend("unit" = "1"))]
    pub realisations: Vec<f64>,
    /// Friction coefficient by hysteresis, mean over the realisations.
    #[schemars(extend("unit" = "1"))]
    pub hysteretic: f64,
    /// Half width of the 95 % confidence interval of `hysteretic` by the realisations, Student's t; draws of one window count
    /// once. Absent for fewer than two.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Estimated error of `hysteretic` by the grid, absolute: the mean of those of the realisations; absent where one is not
    /// known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Estimated error of the contact area by the grid, relative: the mean of those of the realisations; absent where one is not
    /// known.
    #[schemars(extend("unit" = "1"))]
    pub relative_area_error: Option<f64>,
    /// Rise of the temperature of the surface in contact over that before sliding, mean over the realisations; absent without
    /// heat.
    #[schemars(extend("unit" = "K"))]
    pub contact_rise_k: Option<f64>,
    /// Friction coefficient by the shear of the contact area, the mean of `τ_f A / (p A_0)` with the stress of `[adhesion]` at
    /// this speed and the temperature before sliding, whatever the effect; absent without the section.
    #[schemars(extend("unit" = "1"))]
    pub adhesive: Option<f64>,
    /// Sum of both frictions; absent without a section `[adhesion]`.
    #[schemars(extend("unit" = "1"))]
    pub total: Option<f64>,
    /// Error of `total`, or of `hysteretic` where there is no total: the half width of the 95 % interval by realisations and
    /// scans together, of the sums where there are two, plus the error by the grid, that of the contact area times `adhesive`
    /// included; absent where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub error_estimate: Option<f64>,
}

impl Row for EffectRow {
    const SCHEMA: &'static str = "asperity.tables.effects";
    const VERSION: u32 = 1;
}

/// What the contacts of one average have in common; all numbers are positive, so that their bits have their order.
type Key = (SurfaceKind, u64, u64, Effect);

fn key(kind: SurfaceKind, speed_mm_s: f64, pressure_mpa: f64, effect: Effect) -> Key {
    (kind, speed_mm_s.to_bits(), pressure_mpa.to_bits(), effect)
}

/// The averages of a run by surfaces, speed, pressure and effect; those that lack a surface are left out: an average over the
/// others would be one over the easier ones.
///
/// # Errors
/// Those of the store; [`StageError::Shear`].
pub(super) fn effects(
    run: &RunView,
    shear: Option<&Shear>,
    basis: &Basis,
) -> Result<Vec<EffectRow>, StageError> {
    let (contacts, unsolved) = (run.rows(CONTACTS)?, run.rows(UNSOLVED)?);
    Ok(averages(contacts, &unsolved, shear, basis)?)
}

fn averages(
    mut contacts: Vec<ContactRow>,
    unsolved: &[UnsolvedRow],
    shear: Option<&Shear>,
    basis: &Basis,
) -> Result<Vec<EffectRow>, ShearError> {
    let of = |row: &ContactRow| key(row.kind, row.speed_mm_s, row.pressure_mpa, row.effect);
    let lacking: BTreeSet<Key> = unsolved
        .iter()
        .map(|row| key(row.kind, row.speed_mm_s, row.pressure_mpa, row.effect))
        .collect();
    contacts.retain(|row| !lacking.contains(&of(row)));
    contacts.sort_by_key(|row| (of(row), row.realisation));
    contacts.chunk_by(|a, b| of(a) == of(b)).map(|own| row(own, shear, basis)).collect()
}

/// The average of contacts that differ in their realisation alone.
fn row(
    contacts: &[ContactRow],
    shear: Option<&Shear>,
    basis: &Basis,
) -> Result<EffectRow, ShearError> {
    let values: Vec<FrictionAt> = contacts.iter().map(FrictionAt::from).collect();
    let sums: Option<Vec<FrictionAt>> =
        shear.map(|shear| values.iter().map(|value| shear.sum(value)).collect()).transpose()?;
    let averaged = |values: Vec<FrictionAt>| -> FrictionRow {
        let mut rows = average(Model::Bem, values);
        basis.complete(&mut rows);
        rows.swap_remove(0)
    };
    let (hysteretic, total) = (averaged(values), sums.map(averaged));
    let mean = |of: fn(&ContactRow) -> Option<f64>| {
        let count = contacts.len() as f64;
        contacts.iter().map(of).try_fold(0.0, |sum, value| Some(sum + value? / count))
    };
    let error = total.as_ref().unwrap_or(&hysteretic).error_estimate;
    Ok(EffectRow {
        kind: hysteretic.kind,
        effect: contacts[0].effect,
        speed_mm_s: hysteretic.speed_mm_s,
        pressure_mpa: hysteretic.pressure_mpa,
        shortest_wavelength_mm: hysteretic.shortest_wavelength_mm,
        windows: hysteretic.windows,
        contact_area_fraction: hysteretic.contact_area_fraction,
        hysteretic: hysteretic.mean,
        confidence_95: hysteretic.confidence_95,
        discretisation_error: hysteretic.discretisation_error,
        relative_area_error: mean(|row| row.relative_area_error),
        contact_rise_k: mean(|row| row.contact_rise_k),
        adhesive: total.as_ref().map(|total| total.mean - hysteretic.mean),
        total: total.as_ref().map(|total| total.mean),
        error_estimate: error,
        realisations: hysteretic.realisations,
    })
}
