//! Reading of HDF5 files of arrays, with their content compared with the digest in them.

use super::arrays::{
    ArrayDataset, ArraysInfo, Attribute, ContentHasher, FORMAT, innermost, unlocked,
};
use super::{ArtifactError, Digest};
use crate::files::name::Utf8Path;
use hdf5::types::{FloatSize, TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, File, Group, Location, LocationType};
use std::path::Path;

/// Deflate shortens by 1032 at most; the rest is for the shuffle filter's padding of a last chunk.
const MOST_COMPRESSION: u64 = 2048;

/// An open file, its path for the messages and its size.
pub(super) struct Reader<'a> {
    path: &'a Path,
    file: File,
    bytes: u64,
}

impl<'a> Reader<'a> {
    pub(super) fn open(path: &'a Path) -> Result<Self, ArtifactError> {
        // Separates a file that is not there or not ours to read from one that is not HDF5.
        let bytes = std::fs::File::open(path)
            .and_then(|file| Ok(file.metadata()?.len()))
            .map_err(ArtifactError::io("open", path))?;
        let utf8 = Utf8Path::of(path).map_err(ArtifactError::io("open", path))?;
        let file = unlocked()
            .open(utf8)
            .map_err(|error| ArtifactError::unreadable(path, FORMAT, innermost(&error)))?;
        Ok(Self { path, file, bytes })
    }

    fn unreadable(&self, error: hdf5::Error) -> ArtifactError {
        ArtifactError::unreadable(self.path, FORMAT, innermost(&error))
    }

    pub(super) fn header(&self) -> Result<ArraysInfo, ArtifactError> {
        let text = |name: &str| match self.attribute(&self.file, "the file", name)? {
            Attribute::Text(text) => Ok(text),
            other => {
                let reason = format!("`{name}` is {other:?}");
                Err(ArtifactError::unreadable(self.path, FORMAT, reason))
            }
        };
        let version = self.attribute(&self.file, "the file", "version")?;
        let invalid = |reason: String| ArtifactError::unreadable(self.path, FORMAT, reason);
        Ok(ArraysInfo {
            schema: text("schema")?,
            version: match version {
                Attribute::Integer(version) => u32::try_from(version).ok(),
                _ => None,
            }
            .ok_or_else(|| invalid(format!("its schema version is {version:?}")))?,
            tool_version: text("tool_version")?,
            description: text("description")?,
            content_digest: text("content_digest")?.parse().map_err(invalid)?,
            datasets: Vec::new(),
        })
    }

    pub(super) fn datasets(&self, header: &ArraysInfo) -> Result<Vec<ArrayDataset>, ArtifactError> {
        let mut datasets = Vec::new();
        self.visit(header, |dataset| datasets.push(dataset))?;
        Ok(datasets)
    }

    /// The digest of the content, after it has been compared with the recorded one.
    pub(super) fn check_content(&self, header: &ArraysInfo) -> Result<Digest, ArtifactError> {
        self.visit(header, drop)?;
        Ok(header.content_digest)
    }

    /// Reads the datasets one by one, sorted by name, and compares their digest with the recorded one.
    pub(super) fn visit(
        &self,
        header: &ArraysInfo,
        mut each: impl FnMut(ArrayDataset),
    ) -> Result<(), ArtifactError> {
        let mut datasets = Vec::new();
        self.collect(&self.file, &mut datasets)?;
        datasets.sort_by_cached_key(name_of);
        let mut content = ContentHasher::new(&header.schema, header.version);
        for dataset in datasets {
            let dataset = self.dataset(&dataset)?;
            content.add(&dataset);
            each(dataset);
        }
        ArtifactError::check_digest(self.path, header.content_digest, content.finish())
    }

    fn collect(&self, group: &Group, into: &mut Vec<Dataset>) -> Result<(), ArtifactError> {
        let failed = |error| self.unreadable(error);
        // Opened by their names: HDF5 looks through the whole file for the name of each object that
        // was not, which takes the square of the number of datasets.
        for name in group.member_names().map_err(failed)? {
            match group.loc_type_by_name(&name).map_err(failed)? {
                LocationType::Dataset => into.push(group.dataset(&name).map_err(failed)?),
                LocationType::Group => {
                    self.collect(&group.group(&name).map_err(failed)?, into)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn dataset(&self, dataset: &Dataset) -> Result<ArrayDataset, ArtifactError> {
        let name = name_of(dataset);
        let owner = format!("dataset `{name}`");
        let unit = match self.attribute(dataset, &owner, "unit")? {
            Attribute::Text(unit) => unit,
            other => {
                let reason = format!("the unit of {owner} is {other:?}");
                return Err(ArtifactError::unreadable(self.path, FORMAT, reason));
            }
        };
        let keys = dataset.attr_names().map_err(|error| self.unreadable(error))?;
        let attributes = keys
            .into_iter()
            .filter(|key| key != "unit")
            .map(|key| Ok((key.clone(), self.attribute(dataset, &owner, &key)?)))
            .collect::<Result<_, ArtifactError>>()?;
        self.check_length(&owner, dataset.size())?;
        let values = dataset.read_raw::<f64>().map_err(|error| self.unreadable(error))?;
        Ok(ArrayDataset { name, unit, attributes, values })
    }

    /// Refuses a number of values that no file of this size can hold before they are given memory.
    fn check_length(&self, owner: &str, values: usize) -> Result<(), ArtifactError> {
        let most = self.bytes.saturating_mul(MOST_COMPRESSION) / size_of::<f64>() as u64;
        if values as u64 <= most {
            return Ok(());
        }
        let reason = format!(
            "{owner} has {values} values, more than a file of {} bytes can hold",
            self.bytes
        );
        Err(ArtifactError::unreadable(self.path, FORMAT, reason))
    }

    fn attribute(
        &self,
        location: &Location,
        owner: &str,
        name: &str,
    ) -> Result<Attribute, ArtifactError> {
        let attribute = location.attr(name).map_err(|_| ArtifactError::Missing {
            path: self.path.to_path_buf(),
            what: format!("attribute `{name}` of {owner}"),
        })?;
        let read = || -> hdf5::Result<Attribute> {
            match attribute.dtype()?.to_descriptor()? {
                TypeDescriptor::Float(FloatSize::U8) => {
                    attribute.read_scalar().map(Attribute::Float)
                }
                TypeDescriptor::Integer(_) => attribute.read_scalar().map(Attribute::Integer),
                TypeDescriptor::VarLenUnicode => {
                    let text = attribute.read_scalar::<VarLenUnicode>()?;
                    Ok(Attribute::Text(text.as_str().to_owned()))
                }
                other => Err(format!("attribute `{name}` of {owner} is {other}").into()),
            }
        };
        read().map_err(|error| self.unreadable(error))
    }
}

fn name_of(dataset: &Dataset) -> String {
    dataset.name().trim_start_matches('/').to_owned()
}
