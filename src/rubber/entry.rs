//! A rubber file as it is written, in the units of its keys.

use super::law::FiniteStrainEntry;
use crate::units::Units;
use asperity_core::rubber::{Extrapolation, MaxwellBranch, Rheology, Rubber, VerticalShift};
use serde::Deserialize;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RubberFile {
    pub name: String,
    /// For the reader of the file; computing needs it not.
    #[serde(default, rename = "source")]
    _source: Option<String>,
    pub equilibrium_modulus_mpa: Option<f64>,
    pub poisson_ratio: f64,
    pub measured_hz: Option<[f64; 2]>,
    /// File of a measured master curve.
    pub master_curve: Option<String>,
    pub modulus_kind: Option<KindEntry>,
    pub extrapolate: Option<Extrapolation>,
    pub points_per_decade: Option<f64>,
    /// Where the columns of the master curve are: `frequency_hz=1,storage_pa=2,loss_pa=3`.
    pub columns: Option<String>,
    pub temperature: Option<TemperatureEntry>,
    pub payne: Option<PayneEntry>,
    /// The law of the springs at finite strain.
    pub finite_strain: Option<FiniteStrainEntry>,
    #[serde(default)]
    pub branches: Vec<BranchEntry>,
    /// A measured master curve in the file itself.
    #[serde(default)]
    pub moduli: Vec<ModuliEntry>,
}

/// Which modulus was measured.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum KindEntry {
    Youngs,
    Shear,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TemperatureEntry {
    pub reference_c: Option<f64>,
    pub measured_c: Option<[f64; 2]>,
    pub wlf: Option<WlfEntry>,
    pub arrhenius: Option<ArrheniusEntry>,
    /// File of measured shift factors.
    pub shift_factors: Option<String>,
    /// Measured shift factors in the file itself.
    #[serde(default)]
    pub shift: Vec<ShiftEntry>,
    pub vertical: Option<VerticalShift>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WlfEntry {
    pub c1: f64,
    pub c2_k: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArrheniusEntry {
    pub activation_energy_kj_mol: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShiftEntry {
    pub temperature_c: f64,
    pub log10_shift: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BranchEntry {
    pub modulus_mpa: f64,
    pub relaxation_time_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModuliEntry {
    pub frequency_hz: f64,
    pub storage_mpa: f64,
    pub loss_mpa: f64,
}

/// Which strain is stated.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum StrainEntry {
    Elongation,
    Shear,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum StrainUnitEntry {
    Percent,
    Fraction,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LawEntry {
    Table,
    Kraus,
}

/// Section of softening with strain.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PayneEntry {
    pub strain_kind: StrainEntry,
    /// File of strain sweeps.
    pub strain_sweep: Option<String>,
    pub strain_unit: Option<StrainUnitEntry>,
    pub law: Option<LawEntry>,
    #[serde(default)]
    pub kraus: Vec<KrausEntry>,
    #[serde(default)]
    pub table: Vec<PayneTableEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KrausEntry {
    pub temperature_c: Option<f64>,
    pub critical_strain: f64,
    pub exponent: f64,
    pub storage_limit: f64,
    pub loss_limit: f64,
    pub loss_peak: f64,
    pub highest_strain: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PayneTableEntry {
    pub temperature_c: Option<f64>,
    pub strain: Vec<f64>,
    pub storage_factor: Vec<f64>,
    pub loss_factor: Vec<f64>,
}

impl RubberFile {
    /// Whether it has a table of moduli in place of a Maxwell model.
    pub fn is_table(&self) -> bool {
        self.master_curve.is_some() || !self.moduli.is_empty()
    }

    /// The first key that belongs to the other model, or to none.
    pub fn misplaced(&self) -> Option<String> {
        let table_keys = [
            ("modulus_kind", self.modulus_kind.is_some()),
            ("extrapolate", self.extrapolate.is_some()),
            ("points_per_decade", self.points_per_decade.is_some()),
            ("columns", self.columns.is_some()),
        ];
        let maxwell_keys = [
            ("equilibrium_modulus_mpa", self.equilibrium_modulus_mpa.is_some()),
            ("[[branches]]", !self.branches.is_empty()),
            ("measured_hz", self.measured_hz.is_some()),
            ("[finite_strain]", self.finite_strain.is_some()),
        ];
        let first = |keys: &[(&'static str, bool)]| {
            keys.iter().find(|(_, there)| *there).map(|(key, _)| *key)
        };
        if !self.is_table() {
            return first(&table_keys).map(|key| {
                format!("{key} is for a table of moduli: add master_curve = \"FILE\" or [[moduli]], or leave it out")
            });
        }
        if self.master_curve.is_some() && !self.moduli.is_empty() {
            return Some("master_curve and [[moduli]] are two tables: keep one of them".into());
        }
        if self.columns.is_some() && self.master_curve.is_none() {
            return Some("columns describes the file of master_curve: leave it out".into());
        }
        first(&maxwell_keys).map(|key| {
            format!(
                "{key} is for a Maxwell model and the file has a table of moduli: leave it out, or the table{}",
                if key == "measured_hz" { "; a table was measured at the frequencies of its rows" } else { "" }
            )
        })
    }

    /// The first modulus or relaxation time of a Maxwell model that is none, with its key.
    pub fn bad_number(&self) -> Option<(String, f64)> {
        let usable = |value: f64| value > 0.0 && value.mpa_to_pa().is_finite();
        let equilibrium = self
            .equilibrium_modulus_mpa
            .map(|modulus| ("equilibrium_modulus_mpa".to_owned(), modulus));
        let branches = self.branches.iter().enumerate().flat_map(|(k, branch)| {
            let named = |key: &str| format!("{key} of branch {}", k + 1);
            [
                (named("modulus_mpa"), branch.modulus_mpa),
                (named("relaxation_time_s"), branch.relaxation_time_s),
            ]
        });
        let moduli = self.moduli.iter().enumerate().flat_map(|(k, row)| {
            let named = |key: &str| format!("{key} of [[moduli]] {}", k + 1);
            [
                (named("frequency_hz"), row.frequency_hz),
                (named("storage_mpa"), row.storage_mpa),
                (named("loss_mpa"), row.loss_mpa),
            ]
        });
        let points = self.points_per_decade.map(|points| ("points_per_decade".to_owned(), points));
        let all = equilibrium.into_iter().chain(branches).chain(moduli).chain(points);
        all.into_iter().find(|(_, value)| !usable(*value))
    }

    /// The Maxwell model, if the file has the key that every one needs.
    pub fn maxwell(&self) -> Option<Rubber> {
        let branch = |entry: &BranchEntry| MaxwellBranch {
            modulus: entry.modulus_mpa.mpa_to_pa(),
            relaxation_time: entry.relaxation_time_s,
        };
        Some(Rubber {
            name: self.name.clone(),
            equilibrium_modulus: self.equilibrium_modulus_mpa?.mpa_to_pa(),
            branches: self.branches.iter().map(branch).collect(),
            poisson_ratio: self.poisson_ratio,
            finite_strain: Rheology::default(),
        })
    }
}
