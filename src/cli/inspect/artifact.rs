//! Tables and arrays.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Map, Value};

use super::provenance::Provenance;
use crate::cli::CliError;
use crate::cli::output::{aligned, significant};
use asperity::artifact::{
    ArrayDataset, ArraysInfo, Attribute, Column, DatasetInfo, ExportTable, TableInfo, arrays_info,
    read_arrays, table_info,
};
use asperity::text::visible_line;

const FIRST_ROWS: usize = 5;
/// Columns side by side; more do not fit into a line.
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
        Ok(Self {
            path: path.to_path_buf(),
            info,
            provenance: Provenance::of(path)?,
            first_rows: ExportTable::read(path)?.first_rows(FIRST_ROWS)?,
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
        for part in info.columns.chunks(COLUMNS_ABREAST) {
            let names: Vec<&str> = part.iter().map(|column| column.name.as_str()).collect();
            text += &side_by_side(&names, &self.first_rows);
            text.push('\n');
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

/// Some columns of the first rows under their names, to the right where they are numbers.
fn side_by_side(names: &[&str], rows: &[Map<String, Value>]) -> String {
    let cell = |row: &Map<String, Value>, name: &str| match row.get(name) {
        None | Some(Value::Null) => "-".to_owned(),
        Some(Value::String(text)) => visible_line(text).into_owned(),
        Some(value) => value.to_string(),
    };
    let is_text = |name: &str| rows.iter().any(|row| row.get(name).is_some_and(Value::is_string));
    let mut lines = vec![String::new(); rows.len() + 1];
    for name in names {
        let cells: Vec<String> = std::iter::once((*name).to_owned())
            .chain(rows.iter().map(|row| cell(row, name)))
            .collect();
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let text = is_text(name);
        for (line, cell) in lines.iter_mut().zip(&cells) {
            let cell = if text { format!("  {cell:<width$}") } else { format!("  {cell:>width$}") };
            line.push_str(&cell);
        }
    }
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
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
