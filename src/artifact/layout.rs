//! Checks of the layout of an Arrow IPC file, before the reader trusts it.
//!
//! The reader takes offsets and lengths as they are, so a flipped bit could make it panic or ask
//! for more memory than there is. Everything is checked against the length of the file here.

use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::read_footer_length;
use arrow_ipc::{Block, root_as_footer, root_as_message};
use arrow_schema::{ArrowError, DataType, Schema};

/// Bytes of the trailer: length of the footer and the closing `ARROW1`.
const TRAILER: usize = 10;
/// Before the metadata of a message: this marker and a length of 4 bytes.
const MESSAGE_MARKER: [u8; 4] = [0xff; 4];
/// What the format aligns messages and buffers to.
const ALIGNMENT: usize = 8;

/// Refuses a file whose footer, record batches or buffers do not lie where they can.
pub(super) fn check_layout(bytes: &[u8]) -> Result<(), ArrowError> {
    let (rest, trailer) =
        bytes.split_last_chunk::<TRAILER>().ok_or_else(|| damage("shorter than its trailer"))?;
    let length = read_footer_length(*trailer)?;
    let start =
        rest.len().checked_sub(length).ok_or_else(|| damage("footer longer than the file"))?;
    let (body, footer) = rest.split_at(start);
    let footer = root_as_footer(footer).map_err(|error| damage(&format!("footer: {error}")))?;
    if footer.dictionaries().is_some_and(|dictionaries| !dictionaries.is_empty()) {
        return Err(damage("unexpected dictionaries"));
    }
    let schema = footer.schema().ok_or_else(|| damage("no schema"))?;
    let granularity = buffer_granularity(&try_fb_to_schema(schema)?)?;
    let mut blocks = footer.recordBatches().into_iter().flatten();
    blocks.try_for_each(|block| check_block(body, block, &granularity))
}

/// What the length of each buffer of a record batch is a multiple of, in the order of the file:
/// validity first, then offsets of 4 bytes where lengths vary, then the values.
fn buffer_granularity(schema: &Schema) -> Result<Vec<usize>, ArrowError> {
    let mut granularity = Vec::new();
    for field in schema.fields() {
        granularity.extend_from_slice(match field.data_type() {
            DataType::Float64 | DataType::UInt64 | DataType::Int64 => &[1, 8],
            DataType::UInt32 => &[1, 4],
            DataType::Boolean => &[1, 1],
            DataType::Utf8 => &[1, 4, 1],
            DataType::List(item) if *item.data_type() == DataType::Float64 => &[1, 4, 1, 8],
            other => {
                let reason = format!("column {} is {other}, as in no table", field.name());
                return Err(damage(&reason));
            }
        });
    }
    Ok(granularity)
}

fn check_block(body: &[u8], block: &Block, granularity: &[usize]) -> Result<(), ArrowError> {
    let outside = || damage("a record batch lies outside the file");
    let size = |value: i64| usize::try_from(value).map_err(|_| outside());
    let offset = size(block.offset())?;
    let metadata_length = size(block.metaDataLength().into())?;
    let body_length = size(block.bodyLength())?;
    let message = body.get(offset..).ok_or_else(outside)?;
    let (message, buffers) = message.split_at_checked(metadata_length).ok_or_else(outside)?;
    if body_length > buffers.len() || metadata_length % ALIGNMENT != 0 {
        return Err(outside());
    }

    let message = message.strip_prefix(&MESSAGE_MARKER).and_then(|message| message.get(4..));
    let message = message.ok_or_else(|| damage("a batch does not begin with its marker"))?;
    let message = root_as_message(message).map_err(|error| damage(&format!("batch: {error}")))?;
    let batch =
        message.header_as_record_batch().ok_or_else(|| damage("a block is no record batch"))?;
    let buffers = batch.buffers().unwrap_or_default();
    if buffers.len() != granularity.len() {
        return Err(damage("a record batch has not the buffers of its columns"));
    }
    for (buffer, granularity) in buffers.iter().zip(granularity) {
        let (offset, length) = (size(buffer.offset())?, size(buffer.length())?);
        if offset.checked_add(length).is_none_or(|end| end > body_length) {
            return Err(damage("a buffer lies outside its record batch"));
        }
        if offset % ALIGNMENT != 0 || length % granularity != 0 {
            return Err(damage("a buffer is not aligned to its values"));
        }
    }
    Ok(())
}

fn damage(reason: &str) -> ArrowError {
    ArrowError::ParseError(reason.to_owned())
}
