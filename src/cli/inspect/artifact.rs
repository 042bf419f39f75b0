//! Tables and arrays.

use std::path::{Path, PathBuf};

use polars::prelude::{AnyValue, DataFrame};
use serde::Serialize;
use serde_json::{Map, Value};

use super::provenance::Provenance;
use crate::cli::CliError;
use crate::cli::output::{aligned, significant};
use asperity::artifact::{
    ArrayDataset, ArraysInfo, Attribute, Column, DatasetInfo, TableInfo, arrays_info, data_frame,
    read_arrays, table_info,
};

const FIRST_ROWS: usize = 5;
/// polars hides the middle of wider tables.
const COLUMNS_ABREAST: usize = 8;

/// A table.
#[derive(Debug, Serialize)]
pub(super) struct Table {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    #[serde(flatten)]
    info: TableInfo,
    provenance: Option<Provenance>,
    first_rows: Vec<Map<String, Value>>,
    #[serde(skip)]
    frame: DataFrame,
}

/// A file of arrays.
#[derive(Debug, Serialize)]
pub(super) struct Arrays {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    #[serde(flatten)]
    info: ArraysInfo,
    provenance: Option<Provenance>,
    /// In the order of the datasets.
    statistics: Vec<Statistics>,
}

/// Summary of the values of an array, in its unit.
#[derive(Debug, Serialize)]
struct Statistics {
    /// Number of values that are NaN.
    missing: usize,
    /// Mean of the others; none if there are none.
    mean: Option<f64>,
    /// Root of the mean square of the others.
    rms: Option<f64>,
}

impl Table {
    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        let info = table_info(path)?;
        let frame = data_frame(path)?.head(Some(FIRST_ROWS));
        Ok(Self {
            path: path.to_path_buf(),
            info,
            provenance: Provenance::of(path)?,
            first_rows: rows(&frame),
            frame,
        })
    }

    pub(super) fn text(&self) -> String {
        let info = &self.info;
        let mut lines = vec![
            ("table", self.path.display().to_string()),
            ("schema", format!("{} version {}", info.schema, info.version)),
            ("description", info.description.clone()),
            ("tool", format!("asperity {}", info.tool_version)),
            ("content", format!("{:#}", info.content_digest)),
            ("shape", format!("{} rows, {} columns", info.rows, info.columns.len())),
        ];
        lines.extend(self.provenance.iter().flat_map(Provenance::lines));
        lines.extend(info.metadata.iter().map(|(key, value)| (key.as_str(), value.clone())));
        let columns: Vec<_> =
            info.columns.iter().map(|column| (column.name.as_str(), column_text(column))).collect();
        let mut text = format!("{}\ncolumns\n{}\nfirst rows\n", aligned(&lines), aligned(&columns));
        for part in self.frame.columns().chunks(COLUMNS_ABREAST) {
            let names = part.iter().map(|column| column.name().clone());
            if let Ok(part) = self.frame.select(names) {
                text += &format!("{part}\n");
            }
        }
        text
    }
}

fn column_text(column: &Column) -> String {
    let kind = serde_json::to_value(column.kind).unwrap_or_default();
    let kind = kind.as_str().unwrap_or_default();
    let nullable = if column.nullable { ", may be absent" } else { "" };
    let unit = match column.unit.as_deref() {
        None => String::new(),
        Some("1") => " (number)".to_owned(),
        Some(unit) => format!(" in {unit}"),
    };
    format!("{kind}{unit}{nullable}: {}", column.description)
}

fn rows(frame: &DataFrame) -> Vec<Map<String, Value>> {
    let row = |index: usize| {
        let cell = |column: &polars::prelude::Column| {
            let value = column.get(index).map_or(Value::Null, |value| to_json(&value));
            (column.name().to_string(), value)
        };
        frame.columns().iter().map(cell).collect()
    };
    (0..frame.height()).map(row).collect()
}

/// The types that a table can have; see [`asperity::artifact::ColumnType`].
fn to_json(value: &AnyValue) -> Value {
    match value {
        AnyValue::Null => Value::Null,
        AnyValue::Boolean(value) => (*value).into(),
        AnyValue::UInt32(value) => (*value).into(),
        AnyValue::UInt64(value) => (*value).into(),
        AnyValue::Int64(value) => (*value).into(),
        AnyValue::Float64(value) => (*value).into(),
        AnyValue::String(text) => (*text).into(),
        AnyValue::List(values) => values.iter().map(|value| to_json(&value)).collect(),
        other => other.to_string().into(),
    }
}

impl Arrays {
    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        let info = arrays_info(path)?;
        let datasets = read_arrays(path, &info.schema, info.version)?;
        Ok(Self {
            path: path.to_path_buf(),
            info,
            provenance: Provenance::of(path)?,
            statistics: datasets.iter().map(Statistics::of).collect(),
        })
    }

    pub(super) fn text(&self) -> String {
        let info = &self.info;
        let mut lines = vec![
            ("arrays", self.path.display().to_string()),
            ("schema", format!("{} version {}", info.schema, info.version)),
            ("description", info.description.clone()),
            ("tool", format!("asperity {}", info.tool_version)),
            ("content", format!("{:#}", info.content_digest)),
            ("shape", format!("{} datasets", info.datasets.len())),
        ];
        lines.extend(self.provenance.iter().flat_map(Provenance::lines));
        let datasets: Vec<_> = info
            .datasets
            .iter()
            .zip(&self.statistics)
            .map(|(dataset, statistics)| (dataset.name.as_str(), statistics.text(dataset)))
            .collect();
        format!("{}\ndatasets\n{}", aligned(&lines), aligned(&datasets))
    }
}

impl Statistics {
    fn of(dataset: &ArrayDataset) -> Self {
        let present: Vec<f64> =
            dataset.values.iter().copied().filter(|value| !value.is_nan()).collect();
        let count = present.len() as f64;
        let some = |value: f64| (count > 0.0).then_some(value);
        Self {
            missing: dataset.values.len() - present.len(),
            mean: some(present.iter().sum::<f64>() / count),
            rms: some((present.iter().map(|value| value * value).sum::<f64>() / count).sqrt()),
        }
    }

    fn text(&self, dataset: &DatasetInfo) -> String {
        let unit = if dataset.unit == "1" { String::new() } else { format!(" {}", dataset.unit) };
        let number =
            |value: Option<f64>| value.map_or("none".into(), |value| significant(value) + &unit);
        let attributes: String = dataset
            .attributes
            .iter()
            .map(|(name, value)| match value {
                Attribute::Float(value) => format!(", {name} = {value}"),
                Attribute::Integer(value) => format!(", {name} = {value}"),
                Attribute::Text(value) => format!(", {name} = {value}"),
            })
            .collect();
        format!(
            "{} values, {} missing, mean {}, rms {}{attributes}",
            dataset.length,
            self.missing,
            number(self.mean),
            number(self.rms)
        )
    }
}
