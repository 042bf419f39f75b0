//! Named one-dimensional arrays as HDF5 files.
//!
//! Every dataset has a `unit`; the file has schema name, version, description and the digest of
//! its content. Plain or with shuffle and deflate, which every HDF5 reader has; no object time
//! stamps, so equal arrays give equal bytes. The HDF5 library works under a process-wide lock: compute in parallel,
//! write from one place.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

use crate::files::name::Utf8Path;
use hdf5::types::VarLenUnicode;
use hdf5::{File, FileBuilder, Location};
use serde::Serialize;

use super::array_reader::Reader;
use super::content::hash_text;
use super::{ArtifactError, Digest, TOOL_VERSION};

pub(super) const FORMAT: &str = "HDF5 file of arrays";
/// Datasets from this size on are compressed; below, the chunk index costs more than it saves.
const COMPRESS_FROM_VALUES: usize = 1024 / size_of::<f64>();
/// 128 KiB: small against the chunk cache of 1 MiB, large against the overhead of a chunk.
const CHUNK_VALUES: usize = 16_384;
/// Of 9; files of tens of megabytes do not deserve the time of the higher levels.
const DEFLATE_LEVEL: u8 = 4;

/// Values hashed at a time: BLAKE3 works on many of its blocks of 1 KiB at once.
const HASHED_VALUES: usize = 4096;

/// Steps in which the image of a file grows in memory, and with which it is padded until it is closed: a disk
/// that has room for the file must have room for the padding.
const MEMORY_STEP_BYTES: usize = 4096;

/// How the values of a file are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// As they are: for measured heights, whose last digits are noise. Deflate takes a fifth off
    /// them, and took three tenths of the processor time of ingest.
    Plain,
    /// Shuffle and deflate: for smooth values, and those that are mostly zero.
    Compressed,
}

/// Value of an attribute.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Attribute {
    /// Floating-point number, NaN allowed.
    Float(f64),
    /// Signed integer.
    Integer(i64),
    /// UTF-8 text without NUL.
    Text(String),
}

/// One array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayDataset {
    /// Name, unique in the file; `/` separates groups, as in `scan_07/heights`.
    pub name: String,
    /// Unit of the values, `"1"` for pure numbers.
    pub unit: String,
    /// Further attributes; `unit` is reserved.
    pub attributes: BTreeMap<String, Attribute>,
    /// Values; NaN stands for a missing one.
    pub values: Vec<f64>,
}

/// What a file of arrays says about itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArraysInfo {
    /// Schema name.
    pub schema: String,
    /// Schema version.
    pub version: u32,
    /// Version of the tool that wrote the file.
    pub tool_version: String,
    /// What the file holds.
    pub description: String,
    /// Digest of names, units, attributes and values.
    pub content_digest: Digest,
    /// The datasets, sorted by name.
    pub datasets: Vec<DatasetInfo>,
}

/// One dataset without its values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DatasetInfo {
    /// Name with its groups.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// Number of values.
    pub length: usize,
    /// Further attributes.
    pub attributes: BTreeMap<String, Attribute>,
}

/// Writes arrays to a file and returns the content digest, which covers schema name and version,
/// names, units, attributes and exact bits of the values, whatever the order of the datasets.
///
/// An existing file is overwritten, read back and compared; the data are not forced to the disk, see
/// [`Pending::commit`](super::Pending::commit).
///
/// # Errors
/// [`ArtifactError::Dataset`] for names that are empty or used twice, an empty unit, or text that
/// HDF5 cannot hold; [`ArtifactError::Unwritable`] if the file cannot be written or holds something else
/// afterwards.
pub fn write_arrays(
    path: &Path,
    schema: &str,
    version: u32,
    description: &str,
    storage: Storage,
    datasets: &[ArrayDataset],
) -> Result<Digest, ArtifactError> {
    check_datasets(datasets)?;
    let digest = content_digest(schema, version, datasets);
    let header = [
        ("schema", Attribute::Text(schema.to_owned())),
        ("version", Attribute::Integer(i64::from(version))),
        ("tool_version", Attribute::Text(TOOL_VERSION.to_owned())),
        ("description", Attribute::Text(description.to_owned())),
        ("content_digest", Attribute::Text(digest.to_string())),
    ];
    let utf8 = Utf8Path::of(path).map_err(ArtifactError::io("create", path))?;
    let write = || -> hdf5::Result<()> {
        let file = in_memory().create(&utf8)?;
        for (name, value) in &header {
            write_attribute(&file, name, value)?;
        }
        datasets.iter().try_for_each(|dataset| write_dataset(&file, storage, dataset))?;
        file.flush()?;
        file.close()
    };
    let unwritable =
        |reason: String| ArtifactError::Unwritable { path: path.to_path_buf(), reason };
    write().map_err(|error| match error_number(&error) {
        Some(number) => ArtifactError::io("write", path)(io::Error::from_raw_os_error(number)),
        None => unwritable(innermost(&error)),
    })?;
    check_written(path, digest).map_err(unwritable)?;
    Ok(digest)
}

/// Reads a file back and compares its content with what was to be written. The library reports no
/// error of what it writes when a dataset is closed, a chunk that could not be compressed for one.
fn check_written(path: &Path, expected: Digest) -> Result<(), String> {
    let read = || {
        let reader = Reader::open(path)?;
        reader.check_content(&reader.header()?)
    };
    match read() {
        Ok(found) if found == expected => Ok(()),
        Ok(_) => Err("its content was read back differently".to_owned()),
        Err(error) => Err(format!("it cannot be read back: {error}")),
    }
}

/// Reads a file that [`write_arrays`] wrote; the datasets come sorted by name.
///
/// # Errors
/// [`ArtifactError::WrongSchema`] and [`ArtifactError::WrongVersion`] if the file holds something
/// else, [`ArtifactError::Missing`], [`ArtifactError::Unreadable`] and [`ArtifactError::Damaged`]
/// if it is not intact, [`ArtifactError::Io`].
pub fn read_arrays(
    path: &Path,
    schema: &str,
    version: u32,
) -> Result<Vec<ArrayDataset>, ArtifactError> {
    let reader = Reader::open(path)?;
    let header = reader.header()?;
    ArtifactError::check_schema(path, (&header.schema, header.version), (schema, version))?;
    reader.datasets(&header)
}

/// Hands over the arrays of a file one by one, sorted by name, for files that are too large to be held as a whole. What was
/// handed over counts only if no error is returned: the digest of the content is known at the end.
///
/// # Errors
/// Those of [`read_arrays`].
pub fn visit_arrays(
    path: &Path,
    schema: &str,
    version: u32,
    each: impl FnMut(ArrayDataset),
) -> Result<(), ArtifactError> {
    let reader = Reader::open(path)?;
    let header = reader.header()?;
    ArtifactError::check_schema(path, (&header.schema, header.version), (schema, version))?;
    reader.visit(&header, each)
}

/// Schema and datasets of any file of arrays, after its content digest has been checked.
///
/// # Errors
/// [`ArtifactError::Missing`], [`ArtifactError::Unreadable`], [`ArtifactError::Damaged`] or
/// [`ArtifactError::Io`].
pub fn arrays_info(path: &Path) -> Result<ArraysInfo, ArtifactError> {
    let reader = Reader::open(path)?;
    let header = reader.header()?;
    let mut datasets = Vec::new();
    reader.visit(&header, |dataset| {
        datasets.push(DatasetInfo {
            name: dataset.name,
            unit: dataset.unit,
            length: dataset.values.len(),
            attributes: dataset.attributes,
        });
    })?;
    Ok(ArraysInfo { datasets, ..header })
}

/// The content digest of a file of arrays, computed from its content and equal to the recorded one.
///
/// # Errors
/// As [`arrays_info`].
pub(super) fn arrays_content(path: &Path) -> Result<Digest, ArtifactError> {
    let reader = Reader::open(path)?;
    reader.check_content(&reader.header()?)
}

fn check_datasets(datasets: &[ArrayDataset]) -> Result<(), ArtifactError> {
    let all: BTreeSet<&str> = datasets.iter().map(|dataset| dataset.name.as_str()).collect();
    let mut names = BTreeSet::new();
    for ArrayDataset { name, unit, attributes, .. } in datasets {
        let refuse = |reason: &str| {
            Err(ArtifactError::Dataset { name: name.clone(), reason: reason.to_owned() })
        };
        if name.split('/').any(|part| part.is_empty() || part == "." || part == "..") {
            return refuse("every part of its name between `/` must be a word");
        }
        if !names.insert(name.as_str()) {
            return refuse("its name is used twice");
        }
        let above = name.match_indices('/').map(|(at, _)| &name[..at]);
        if above.into_iter().any(|group| all.contains(group)) {
            return refuse("one of its groups is the name of a dataset");
        }
        if unit.is_empty() {
            return refuse("its unit is empty; pure numbers have the unit `1`");
        }
        if attributes.contains_key("unit") {
            return refuse("the attribute `unit` is a field of its own");
        }
        let texts = attributes.iter().flat_map(|(key, value)| match value {
            Attribute::Text(text) => [key, text],
            _ => [key, name],
        });
        if texts.chain([name, unit]).any(|text| text.contains('\0')) {
            return refuse("a text with a NUL character cannot be kept in HDF5");
        }
    }
    Ok(())
}

fn write_dataset(file: &File, storage: Storage, dataset: &ArrayDataset) -> hdf5::Result<()> {
    let ArrayDataset { name, unit, attributes, values } = dataset;
    let mut builder = file.new_dataset_builder().obj_track_times(false);
    if storage == Storage::Compressed && values.len() >= COMPRESS_FROM_VALUES {
        builder = builder.chunk(values.len().min(CHUNK_VALUES)).shuffle().deflate(DEFLATE_LEVEL);
    }
    let written = builder.with_data(values.as_slice()).create(name.as_str())?;
    write_attribute(&written, "unit", &Attribute::Text(unit.clone()))?;
    attributes.iter().try_for_each(|(key, value)| write_attribute(&written, key, value))
}

fn write_attribute(location: &Location, name: &str, value: &Attribute) -> hdf5::Result<()> {
    match value {
        Attribute::Float(x) => location.new_attr::<f64>().create(name)?.write_scalar(x),
        Attribute::Integer(i) => location.new_attr::<i64>().create(name)?.write_scalar(i),
        // Variable length and UTF-8: h5py gives `str`, `bytes` for the fixed or ASCII kinds.
        Attribute::Text(text) => {
            let text: VarLenUnicode =
                text.parse().map_err(|error| format!("text of `{name}`: {error:?}"))?;
            location.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&text)
        }
    }
}

/// Access without HDF5's own lock of the file. That lock outlives its holder in any process started
/// meanwhile, because HDF5 lets its descriptors be inherited, and network file systems may lack
/// locks. It guards against nothing here: a run folder has a lock of its own, and files appear
/// whole, by renaming.
pub(super) fn unlocked() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|access| access.file_locking(false));
    builder
}

/// Access that builds a file in memory and writes it when it is flushed, whose errors are reported: those of
/// writes when a dataset is closed are not.
fn in_memory() -> FileBuilder {
    let mut builder = unlocked();
    builder.with_fapl(|access| access.core_options(MEMORY_STEP_BYTES, true));
    builder
}

fn content_digest(schema: &str, version: u32, datasets: &[ArrayDataset]) -> Digest {
    let sorted: BTreeMap<&str, &ArrayDataset> =
        datasets.iter().map(|dataset| (dataset.name.as_str(), dataset)).collect();
    let mut content = ContentHasher::new(schema, version);
    sorted.values().for_each(|dataset| content.add(dataset));
    content.finish()
}

/// The content digest of datasets that come sorted by name.
pub(super) struct ContentHasher(blake3::Hasher);

impl ContentHasher {
    pub(super) fn new(schema: &str, version: u32) -> Self {
        let mut hasher = blake3::Hasher::new();
        hash_text(&mut hasher, schema);
        hasher.update(&version.to_le_bytes());
        Self(hasher)
    }

    pub(super) fn add(&mut self, dataset: &ArrayDataset) {
        let hasher = &mut self.0;
        hash_text(hasher, &dataset.name);
        hash_text(hasher, &dataset.unit);
        hasher.update(&(dataset.attributes.len() as u64).to_le_bytes());
        for (key, value) in &dataset.attributes {
            hash_text(hasher, key);
            match value {
                Attribute::Float(x) => hash_text(hasher, &format!("f64 {:x}", x.to_bits())),
                Attribute::Integer(i) => hash_text(hasher, &format!("i64 {i}")),
                Attribute::Text(text) => hash_text(hasher, &format!("text {text}")),
            }
        }
        hasher.update(&(dataset.values.len() as u64).to_le_bytes());
        let mut bytes = Vec::with_capacity(HASHED_VALUES * size_of::<f64>());
        for values in dataset.values.chunks(HASHED_VALUES) {
            bytes.clear();
            bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            hasher.update(&bytes);
        }
    }

    pub(super) fn finish(self) -> Digest {
        Digest::of_hasher(&self.0)
    }
}

/// The number of the operating system's error in the first cause, which the library has as `errno = 28`.
fn error_number(error: &hdf5::Error) -> Option<i32> {
    let cause = innermost(error);
    let (_, number) = cause.split_once("errno = ")?;
    let digits = number.find(|digit: char| !digit.is_ascii_digit()).unwrap_or(number.len());
    number[..digits].parse().ok().filter(|number| *number != 0)
}

/// The first cause in the library's stack of errors, in one line.
pub(super) fn innermost(error: &hdf5::Error) -> String {
    match error.stack().and_then(|stack| stack.last().map(|frame| frame.desc().to_owned())) {
        Some(cause) => cause,
        None => error.to_string(),
    }
}
