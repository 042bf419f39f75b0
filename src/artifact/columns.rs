//! From a row type to the columns of its table.
//!
//! The struct is the only description of a table: field types give the column types, doc comments
//! the descriptions, `schemars` extensions the units. Everything else (Arrow schema, JSON
//! document, digest) is derived from the [`Column`]s.

use std::sync::Arc;

use arrow_schema::{DataType, Field, FieldRef};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ArtifactError;

/// A flat struct that is one row of a table.
///
/// Fields are `f64`, `u32`, `u64`, `i64`, `bool`, `String` and `Vec<f64>`; `Option` of any of them
/// makes the column nullable. An enum of names is text on the disk, and its values are in the schema. Every field has a doc comment. Floating-point columns state their
/// unit, `"1"` if they have none:
///
/// ```
/// use asperity::artifact::{Row, columns};
///
/// /// One solved contact problem.
/// #[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
/// struct Solve {
///     /// Mean pressure.
///     #[schemars(extend("unit" = "MPa"))]
///     pressure_mpa: f64,
///     /// Wall time; differs from run to run and is no part of the content digest.
///     #[schemars(extend("unit" = "s", "volatile" = true))]
///     elapsed_s: f64,
/// }
///
/// impl Row for Solve {
///     const SCHEMA: &'static str = "asperity.example.solves";
///     const VERSION: u32 = 1;
/// }
///
/// let columns = columns::<Solve>()?;
/// assert_eq!(columns[0].unit.as_deref(), Some("MPa"));
/// # Ok::<(), asperity::artifact::ArtifactError>(())
/// ```
pub trait Row: Serialize + DeserializeOwned + JsonSchema {
    /// Name of the table, such as `asperity.bem.solves`.
    const SCHEMA: &'static str;
    /// Version of the table; raised with every change of a column.
    const VERSION: u32;
}

/// Type of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ColumnType {
    /// 64-bit floating point.
    #[serde(rename = "f64")]
    Float,
    /// Unsigned integer of 32 bits.
    #[serde(rename = "u32")]
    Unsigned32,
    /// Unsigned integer of 64 bits.
    #[serde(rename = "u64")]
    Unsigned64,
    /// Signed integer of 64 bits.
    #[serde(rename = "i64")]
    Integer,
    /// Truth value.
    #[serde(rename = "bool")]
    Boolean,
    /// UTF-8 text.
    #[serde(rename = "string")]
    Text,
    /// List of 64-bit floating-point numbers.
    #[serde(rename = "list<f64>")]
    FloatList,
}

impl ColumnType {
    fn of_json_schema(property: &Value, type_name: &str) -> Option<Self> {
        match (type_name, property["format"].as_str()) {
            ("number", Some("double")) => Some(Self::Float),
            ("integer", Some("uint32")) => Some(Self::Unsigned32),
            ("integer", Some("uint64")) => Some(Self::Unsigned64),
            ("integer", Some("int64")) => Some(Self::Integer),
            ("boolean", None) => Some(Self::Boolean),
            ("string", None) => Some(Self::Text),
            ("array", None) if property["items"]["format"] == "double" => Some(Self::FloatList),
            _ => None,
        }
    }

    fn data_type(self) -> DataType {
        match self {
            Self::Float => DataType::Float64,
            Self::Unsigned32 => DataType::UInt32,
            Self::Unsigned64 => DataType::UInt64,
            Self::Integer => DataType::Int64,
            Self::Boolean => DataType::Boolean,
            Self::Text => DataType::Utf8,
            Self::FloatList => {
                DataType::List(Arc::new(Field::new("item", DataType::Float64, false)))
            }
        }
    }

    pub(super) fn of_data_type(data_type: &DataType) -> Option<Self> {
        use ColumnType::{Boolean, Float, FloatList, Integer, Text, Unsigned32, Unsigned64};
        [Float, Unsigned32, Unsigned64, Integer, Boolean, Text, FloatList]
            .into_iter()
            .find(|kind| kind.data_type() == *data_type)
    }
}

/// One column of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Name of the field of the row type.
    pub name: String,
    /// Type of the values.
    #[serde(rename = "type")]
    pub kind: ColumnType,
    /// Whether values may be absent.
    pub nullable: bool,
    /// Unit, `"1"` for pure numbers; none for text and truth values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What the column holds.
    pub description: String,
    /// The values that a text may have, where the field is an enum; in the schema only, not in the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<String>,
    /// Whether the values differ between equal runs, which keeps them out of the content digest.
    pub volatile: bool,
}

/// Columns of the table of a row type, in the order of its fields.
///
/// # Errors
/// [`ArtifactError::RowType`] if a field has a type that no column has, no doc comment or no unit.
pub fn columns<R: Row>() -> Result<Vec<Column>, ArtifactError> {
    let schema = json_schema::<R>();
    // `properties` is a map; `required` lists the fields in the order of declaration, and all of
    // them because the schema is that of writing.
    let required = schema["required"].as_array().into_iter().flatten();
    let columns: Vec<Column> = required
        .filter_map(Value::as_str)
        .map(|name| {
            Column::of_json_schema(name, &schema["properties"][name]).map_err(|reason| {
                ArtifactError::RowType { schema: R::SCHEMA.into(), column: name.into(), reason }
            })
        })
        .collect::<Result<_, _>>()?;
    let fields = schema["properties"].as_object().map_or(0, serde_json::Map::len);
    if columns.len() != fields || fields == 0 {
        return Err(ArtifactError::RowType {
            schema: R::SCHEMA.into(),
            column: "(all)".into(),
            reason: "must be fields of a struct, written always (no skip_serializing_if)".into(),
        });
    }
    Ok(columns)
}

/// Description of the whole table, the doc comment of the row type.
pub(super) fn table_description<R: Row>() -> String {
    one_line(&json_schema::<R>()["description"])
}

fn json_schema<R: Row>() -> Value {
    let settings = SchemaSettings::draft2020_12()
        .for_serialize()
        .with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<R>().to_value()
}

fn text(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

/// Doc comments are wrapped for the source code; the description is one line.
fn one_line(description: &Value) -> String {
    description.as_str().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Column {
    fn of_json_schema(name: &str, property: &Value) -> Result<Self, String> {
        // An enum whose variants have comments is a choice of constants.
        let constants = property["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
        let names =
            |constant: &Value| constant["type"] == "string" && constant["const"].is_string();
        let chosen = !constants.is_empty() && constants.iter().all(names);
        let (type_name, nullable) = match &property["type"] {
            Value::Null if chosen => (Some("string"), false),
            Value::Array(types) => (types.first().and_then(Value::as_str), types.len() == 2),
            single => (single.as_str(), false),
        };
        let kind = type_name
            .and_then(|type_name| ColumnType::of_json_schema(property, type_name))
            .ok_or("must be f64, u32, u64, i64, bool, String, Vec<f64> or an Option of them")?;
        let description = one_line(&property["description"]);
        if description.is_empty() {
            return Err("has no doc comment, which is its description".into());
        }
        let unit = match (property["unit"].as_str(), kind) {
            (Some(unit), _) => Some(unit.to_owned()),
            (None, ColumnType::Float | ColumnType::FloatList) => {
                return Err("states no unit: #[schemars(extend(\"unit\" = \"MPa\"))]".into());
            }
            (None, ColumnType::Boolean | ColumnType::Text) => None,
            (None, _) => Some("1".into()),
        };
        let volatile = property["volatile"] == true;
        let values = match property["enum"].as_array() {
            Some(values) => values.iter().filter_map(text).collect(),
            None => constants.iter().filter_map(|constant| text(&constant["const"])).collect(),
        };
        Ok(Self { name: name.into(), kind, nullable, unit, description, values, volatile })
    }

    /// The Arrow field with unit and description in its metadata.
    pub(super) fn to_field(&self) -> FieldRef {
        let mut metadata = vec![("description".to_owned(), self.description.clone())];
        metadata.extend(self.unit.iter().map(|unit| ("unit".to_owned(), unit.clone())));
        if self.volatile {
            metadata.push(("volatile".to_owned(), "true".to_owned()));
        }
        let field = Field::new(&self.name, self.kind.data_type(), self.nullable);
        Arc::new(field.with_metadata(metadata.into_iter().collect::<arrow_schema::Metadata>()))
    }

    /// The column of an Arrow field; none if its type is not one of a table.
    pub(super) fn of_field(field: &Field) -> Option<Self> {
        let metadata = field.metadata();
        Some(Self {
            name: field.name().clone(),
            kind: ColumnType::of_data_type(field.data_type())?,
            nullable: field.is_nullable(),
            unit: metadata.get("unit").cloned(),
            description: metadata.get("description").cloned().unwrap_or_default(),
            values: Vec::new(),
            volatile: metadata.get("volatile").is_some_and(|flag| flag == "true"),
        })
    }
}
