//! Published tables beside the computed ones.

use super::super::approximate::ScaleRow;
use super::super::micro::{SAMPLES, SampleRow, between_samples};
use super::super::realise::{Method, SurfaceKind, same_surfaces};
use super::{FrictionRow, Model, Tables};
use crate::artifact::{Digest, Input, Metadata, Row, RunView, Table};
use crate::files;
use crate::stages::bem::Given;
use crate::stages::{Context, StageError};
use crate::units::Units;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A published table of friction over contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// What it is called where it was published.
    pub name: String,
    /// Number of waves of its approximation.
    pub waves: u32,
    /// Its sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Its contact model.
    #[serde(default)]
    pub model: Model,
    /// CSV file with at least the columns `area_fraction` and `average`.
    #[serde(with = "crate::files::name::path")]
    #[schemars(with = "String")]
    pub file: PathBuf,
}

/// A published table of the friction of a microscale over its mean pressure, under both models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PublishedCorrections {
    /// What it is called where it was published.
    pub name: String,
    /// Number of waves of the approximation whose microscale it is of.
    pub waves: u32,
    /// Its sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// CSV file with at least the columns `pressure_mpa`, `friction_bem` and `friction_fem`.
    #[serde(with = "crate::files::name::path")]
    #[schemars(with = "String")]
    pub file: PathBuf,
}

/// Computed beside published friction: `comparison.arrow`, where the recipe names published
/// tables.
pub const COMPARISON: Table<ComparisonRow> = Table::new("tables", "comparison.arrow");
/// Computed beside published corrections: `corrections.arrow`, where the recipe names some.
pub const CORRECTIONS: Table<CorrectionRow> = Table::new("tables", "corrections.arrow");
/// Metadata of [`COMPARISON`] and [`CORRECTIONS`]: the note of the recipe.
pub const NOTE_KEY: &str = "note";

/// Computed beside published friction at one contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonRow {
    /// Name of the published table.
    pub published_table: String,
    /// Contact model of both.
    pub model: Model,
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Published average.
    #[schemars(extend("unit" = "1"))]
    pub published: f64,
    /// Computed mean.
    #[schemars(extend("unit" = "1"))]
    pub computed: f64,
    /// Realisations of the computed mean.
    pub realisations: u32,
    /// Half width of the 95 % confidence interval of the computed mean.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Estimated error of the computed mean by the grid or the mesh; absent where it is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Computed less published, over published.
    #[schemars(extend("unit" = "1"))]
    pub relative_difference: f64,
}

impl Row for ComparisonRow {
    const SCHEMA: &'static str = "asperity.tables.comparison";
    const VERSION: u32 = 2;
}

/// Computed beside published friction of a microscale at one mean pressure; the computed one is interpolated
/// between the samples of `micro`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectionRow {
    /// Name of the published table.
    pub published_table: String,
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Published friction coefficient of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub published_half_space: f64,
    /// Computed friction coefficient of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub computed_half_space: f64,
    /// Published friction coefficient at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub published_finite_deformation: f64,
    /// Computed friction coefficient at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub computed_finite_deformation: f64,
    /// Largest estimated error of the computed difference by interpolation.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the computed friction at finite deformation by the mesh; absent where it is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
}

impl Row for CorrectionRow {
    const SCHEMA: &'static str = "asperity.tables.corrections";
    const VERSION: u32 = 1;
}

/// The published tables as inputs of the stage.
///
/// # Errors
/// [`StageError::Artifact`] for a file that cannot be read.
pub fn inputs(parameters: &Tables) -> Result<Vec<Input>, StageError> {
    let tables = parameters.published.iter().map(|table| (&table.name, &table.file));
    let corrections =
        parameters.published_corrections.iter().map(|table| (&table.name, &table.file));
    let input = |(name, file): (&String, &PathBuf)| {
        Ok(Input {
            name: name.clone(),
            digest: digest(file)?,
            origin: Some(file.display().to_string()),
        })
    };
    tables.chain(corrections).map(input).collect()
}

fn digest(path: &Path) -> Result<Digest, StageError> {
    let unreadable = |source: std::io::Error| StageError::Published {
        path: path.to_owned(),
        source: source.into(),
    };
    files::admit(path, files::LARGEST_NUMBERS).map_err(unreadable)?;
    Ok(Digest::of_file(path)?)
}

/// Writes what the recipe names of published tables.
///
/// # Errors
/// [`StageError::Published`] for a published table that cannot be read; those of the store.
pub(super) fn write(
    parameters: &Tables,
    rows: &[FrictionRow],
    fitted: &[ScaleRow],
    run: &RunView,
    context: &mut Context,
) -> Result<(), StageError> {
    let metadata = Metadata::from([(NOTE_KEY.to_owned(), parameters.note.clone())]);
    if !parameters.published.is_empty() {
        let mut compared = Vec::new();
        for published in &parameters.published {
            compared.extend(compare(published, rows, fitted)?);
        }
        context.pending.write_table(COMPARISON, &compared, &metadata)?;
    }
    if !parameters.published_corrections.is_empty() {
        let samples = run.rows(SAMPLES)?;
        let mut compared = Vec::new();
        for published in &parameters.published_corrections {
            compared.extend(compare_corrections(published, &samples, fitted)?);
        }
        context.pending.write_table(CORRECTIONS, &compared, &metadata)?;
    }
    Ok(())
}

fn lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, StageError> {
    let bad = |source| StageError::Published { path: path.to_owned(), source };
    let mut reader = csv::Reader::from_path(path).map_err(bad)?;
    reader.deserialize().collect::<Result<_, _>>().map_err(bad)
}

/// The computed rows that the published table has too. Surfaces that two numbers of waves share are computed
/// under one of them.
fn compare(
    published: &Published,
    rows: &[FrictionRow],
    fitted: &[ScaleRow],
) -> Result<Vec<ComparisonRow>, StageError> {
    #[derive(Deserialize)]
    struct Line {
        area_fraction: f64,
        average: f64,
    }
    let mut compared = Vec::new();
    for line in lines::<Line>(&published.file)? {
        let computed = rows.iter().find(|row| {
            row.model == published.model
                && is_of(row.kind, published.waves, fitted)
                && row.speed_mm_s == published.speed_mm_s
                && row.given == Given::Area
                && row.contact_area_fraction == line.area_fraction
        });
        compared.extend(computed.map(|row| ComparisonRow {
            published_table: published.name.clone(),
            model: row.model,
            waves: published.waves,
            speed_mm_s: row.speed_mm_s,
            contact_area_fraction: row.contact_area_fraction,
            published: line.average,
            computed: row.mean,
            realisations: row.realisations.len() as u32,
            confidence_95: row.confidence_95,
            discretisation_error: row.discretisation_error,
            relative_difference: row.mean / line.average - 1.0,
        }));
    }
    Ok(compared)
}

/// Both models of the microscale at the published pressures that lie between its samples.
fn compare_corrections(
    published: &PublishedCorrections,
    samples: &[SampleRow],
    fitted: &[ScaleRow],
) -> Result<Vec<CorrectionRow>, StageError> {
    #[derive(Deserialize)]
    struct Line {
        pressure_mpa: f64,
        friction_bem: f64,
        friction_fem: f64,
    }
    let own: Vec<&SampleRow> = samples
        .iter()
        .filter(|row| {
            row.realisation <= 1
                && row.speed_mm_s == published.speed_mm_s
                && is_of(row.kind, published.waves, fitted)
        })
        .collect();
    if own.is_empty() {
        return Ok(Vec::new());
    }
    let microscale = between_samples(&own);
    let mut compared = Vec::new();
    for line in lines::<Line>(&published.file)? {
        let pressure = line.pressure_mpa.mpa_to_pa();
        let Some((half_space, finite)) = microscale.friction(pressure) else { continue };
        let mesh = microscale.correction(&[pressure]).ok().flatten();
        compared.push(CorrectionRow {
            published_table: published.name.clone(),
            waves: published.waves,
            speed_mm_s: published.speed_mm_s,
            pressure_mpa: line.pressure_mpa,
            published_half_space: line.friction_bem,
            computed_half_space: half_space,
            published_finite_deformation: line.friction_fem,
            computed_finite_deformation: finite,
            interpolation_error: microscale.interpolation_error(),
            discretisation_error: mesh.and_then(|correction| correction.discretisation_error),
        });
    }
    Ok(compared)
}

/// Published tables are of sines.
fn is_of(kind: SurfaceKind, published: u32, fitted: &[ScaleRow]) -> bool {
    kind.is_sines(published)
        || kind.method == Method::Sines && same_surfaces(fitted, kind.waves, published)
}
