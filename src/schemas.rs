//! Everything that other programs may read or write, as JSON documents: the tables, the arrays,
//! the manifest and the recipe. The folder `schemas` holds them; a test compares.

use crate::artifact::{ArtifactError, Manifest, Row, arrays_schema, table_schema};
use crate::recipe::Recipe;
use crate::stages::{
    approximate, areal, bem, characterise, feedback, fem, hybrid, ingest, methods, micro,
    multilevel, realise, sinusoid, tables,
};
use crate::sweep::SweepFrictionRow;
use schemars::schema_for;
use serde_json::Value;

/// Name, which is that of the file without `.json`, and document of each kind.
///
/// # Errors
/// [`ArtifactError::RowType`] for a row type that is no table: a mistake in the program.
pub fn documents() -> Result<Vec<(String, Value)>, ArtifactError> {
    let manifest = format!("{}.v{}", Manifest::SCHEMA, Manifest::VERSION);
    Ok(vec![
        ("asperity.recipe".into(), schema_for!(Recipe).to_value()),
        (manifest, schema_for!(Manifest).to_value()),
        arrays(&ingest::scans_schema()),
        table::<ingest::ScanReportRow>()?,
        table::<ingest::FaultRow>()?,
        table::<ingest::WindowRow>()?,
        arrays(&ingest::maps_schema()),
        table::<ingest::MapRow>()?,
        table::<characterise::ParametersRow>()?,
        table::<characterise::AverageRow>()?,
        table::<characterise::CorrelationRow>()?,
        table::<characterise::SpectrumRow>()?,
        table::<characterise::IsotropicRow>()?,
        table::<characterise::HurstRow>()?,
        table::<characterise::AgreementRow>()?,
        table::<characterise::SelfAffineRow>()?,
        table::<characterise::ProfileRow>()?,
        table::<characterise::DepthRow>()?,
        table::<characterise::TextureRow>()?,
        table::<characterise::ArealParametersRow>()?,
        table::<characterise::ArealCorrelationRow>()?,
        table::<characterise::ArealSpectrumRow>()?,
        table::<characterise::ArealDirectionRow>()?,
        table::<approximate::ScaleRow>()?,
        table::<approximate::ReplicateRow>()?,
        table::<approximate::FitRow>()?,
        table::<approximate::FittedRow>()?,
        table::<realise::SurfaceRow>()?,
        table::<realise::ProfileRow>()?,
        table::<realise::ArealRow>()?,
        arrays(&realise::areal_schema()),
        table::<bem::SolveRow>()?,
        table::<bem::CurveRow>()?,
        table::<bem::RealisationsRow>()?,
        table::<bem::ScanErrorRow>()?,
        arrays(&bem::fields_schema()),
        table::<areal::ArealSolveRow>()?,
        table::<areal::ArealCurveRow>()?,
        table::<areal::ArealUnsolvedRow>()?,
        arrays(&areal::areal_fields_schema()),
        table::<methods::MethodCurveRow>()?,
        table::<methods::MethodFrictionRow>()?,
        table::<feedback::ContactRow>()?,
        table::<feedback::UnsolvedRow>()?,
        table::<micro::SampleRow>()?,
        table::<micro::LawRow>()?,
        table::<hybrid::HybridRow>()?,
        table::<hybrid::LocalRow>()?,
        table::<fem::FemCurveRow>()?,
        table::<fem::FemSolveRow>()?,
        table::<multilevel::AverageRow>()?,
        table::<multilevel::PairRow>()?,
        table::<tables::TotalRow>()?,
        table::<tables::EffectRow>()?,
        table::<tables::FrictionRow>()?,
        table::<tables::BudgetRow>()?,
        table::<tables::MethodRow>()?,
        table::<tables::ComparisonRow>()?,
        table::<tables::CorrectionRow>()?,
        table::<tables::ModelRow>()?,
        table::<tables::TheoryRow>()?,
        table::<SweepFrictionRow>()?,
        table::<sinusoid::PointRow>()?,
        table::<sinusoid::AsymptoteRow>()?,
        table::<sinusoid::FieldRow>()?,
        table::<sinusoid::PeakRow>()?,
        table::<sinusoid::AgreementRow>()?,
    ])
}

fn table<R: Row>() -> Result<(String, Value), ArtifactError> {
    Ok((format!("{}.v{}", R::SCHEMA, R::VERSION), table_schema::<R>()?))
}

fn arrays(schema: &crate::artifact::ArraysSchema) -> (String, Value) {
    (format!("{}.v{}", schema.schema, schema.version), arrays_schema(schema))
}
