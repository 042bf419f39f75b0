//! Digest of the content of a table, independent of the bytes of its file.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};

use super::{Column, ColumnType, Digest};

/// Digest over columns in order, each as one sequence over all batches, so that it does not depend
/// on how a file is divided. Lengths are hashed before what they measure.
pub(super) fn table_content_digest(
    schema: &str,
    version: u32,
    columns: &[Column],
    batches: &[RecordBatch],
) -> Digest {
    let mut hasher = blake3::Hasher::new();
    hash_text(&mut hasher, schema);
    hasher.update(&version.to_le_bytes());
    let rows: usize = batches.iter().map(RecordBatch::num_rows).sum();
    hasher.update(&(rows as u64).to_le_bytes());
    for (index, column) in columns.iter().enumerate().filter(|(_, column)| !column.volatile) {
        hash_text(&mut hasher, &column.name);
        hasher.update(&[column.kind as u8, u8::from(column.nullable)]);
        hash_text(&mut hasher, column.unit.as_deref().unwrap_or_default());
        for batch in batches {
            hash_array(&mut hasher, column.kind, batch.column(index));
        }
    }
    Digest::of_hasher(&hasher)
}

fn hash_array(hasher: &mut blake3::Hasher, kind: ColumnType, array: &dyn Array) {
    match kind {
        ColumnType::Float => hash_numbers::<Float64Type>(hasher, array, f64::to_le_bytes),
        ColumnType::Unsigned32 => {
            hash_numbers::<UInt32Type>(hasher, array, |x| u64::from(x).to_le_bytes());
        }
        ColumnType::Unsigned64 => hash_numbers::<UInt64Type>(hasher, array, u64::to_le_bytes),
        ColumnType::Integer => hash_numbers::<Int64Type>(hasher, array, i64::to_le_bytes),
        ColumnType::Boolean => {
            for value in array.as_boolean() {
                hasher.update(&[value.map_or(2, u8::from)]);
            }
        }
        ColumnType::Text => {
            for value in array.as_string::<i32>() {
                hasher.update(&[u8::from(value.is_some())]);
                hash_text(hasher, value.unwrap_or_default());
            }
        }
        ColumnType::FloatList => {
            for list in array.as_list::<i32>() {
                let length = list.as_ref().map_or(u64::MAX, |list| list.len() as u64);
                hasher.update(&length.to_le_bytes());
                if let Some(list) = list {
                    hash_numbers::<Float64Type>(hasher, &list, f64::to_le_bytes);
                }
            }
        }
    }
}

fn hash_numbers<T: ArrowPrimitiveType>(
    hasher: &mut blake3::Hasher,
    array: &dyn Array,
    to_bytes: impl Fn(T::Native) -> [u8; 8],
) {
    for value in array.as_primitive::<T>() {
        hasher.update(&[u8::from(value.is_some())]);
        hasher.update(&value.map_or([0; 8], &to_bytes));
    }
}

/// Hashes a text after its length.
pub(super) fn hash_text(hasher: &mut blake3::Hasher, text: &str) {
    hasher.update(&(text.len() as u64).to_le_bytes());
    hasher.update(text.as_bytes());
}
