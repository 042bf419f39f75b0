//! Members of the zip archive, within limits.
//!
//! Members are looked up by name and read into memory; nothing is ever written under a name from
//! the archive.

use super::super::LARGEST_POINTS;
use super::super::error::{FileProblem, Place};
use md5::{Digest, Md5};
use std::io::{Cursor, Read};
use zip::ZipArchive;
use zip::result::ZipError;

/// Largest unpacked size of a member: the largest scan as `f64`.
const LARGEST_MEMBER: u64 = 8 * LARGEST_POINTS;
/// Largest unpacked size over packed size of members that are large; deflate reaches a thousand
/// on zeros, heights of instruments stay below ten.
const LARGEST_RATIO: u64 = 200;
/// Members up to this size may be packed as tightly as they like.
const SMALL_MEMBER: u64 = 1 << 20;
/// More members than any writer makes.
const MOST_MEMBERS: usize = 1000;

pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, FileProblem> {
        let damaged = |error: ZipError| FileProblem::Damaged {
            place: Place::Byte(0),
            reason: format!("no zip archive: {error}"),
        };
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
        if zip.len() > MOST_MEMBERS {
            return Err(FileProblem::TooLarge {
                place: Place::Byte(0),
                what: "the number of archive members",
                size: zip.len() as u64,
                limit: MOST_MEMBERS as u64,
            });
        }
        Ok(Self { zip })
    }

    fn find(&mut self, name: &str) -> Option<usize> {
        self.zip.index_for_name(name.trim().trim_start_matches('/'))
    }

    /// The unpacked bytes of a member.
    pub(super) fn member(&mut self, name: &str) -> Result<Vec<u8>, FileProblem> {
        let place = || Place::Member(name.to_owned());
        let damaged = |reason: String| FileProblem::Damaged { place: place(), reason };
        let index = self.find(name).ok_or_else(|| {
            let expected = match name {
                super::MAIN => "in every X3P file; from another archive unpack the scan first",
                _ => "there, since the document names it; export the scan again",
            };
            super::unexpected(place(), "the member", "not there", expected)
        })?;
        let file = self.zip.by_index(index).map_err(|error| damaged(error.to_string()))?;
        let (size, packed) = (file.size(), file.compressed_size());
        let limit = match packed.saturating_mul(LARGEST_RATIO) {
            by_ratio if by_ratio > SMALL_MEMBER => by_ratio.min(LARGEST_MEMBER),
            _ => SMALL_MEMBER,
        };
        let too_large =
            |size| FileProblem::TooLarge { place: place(), what: "the unpacked size", size, limit };
        if size > limit {
            return Err(too_large(size));
        }
        let mut bytes = Vec::new();
        // The stated size is not to be trusted either.
        let read = file.take(limit + 1).read_to_end(&mut bytes);
        read.map_err(|error| damaged(error.to_string()))?;
        if bytes.len() as u64 > limit {
            return Err(too_large(bytes.len() as u64));
        }
        Ok(bytes)
    }

    /// A binary member of known length, whose checksum is compared where it is stated.
    pub(super) fn binary(
        &mut self,
        name: &str,
        length: u64,
        stated: Option<&str>,
    ) -> Result<Vec<u8>, FileProblem> {
        let bytes = self.member(name)?;
        if bytes.len() as u64 != length {
            return Err(super::unexpected(
                Place::Member(name.to_owned()),
                "its length in bytes",
                bytes.len(),
                length,
            ));
        }
        if let Some(stated) = stated.filter(|stated| !stated.is_empty()) {
            check(name, &bytes, stated)?;
        }
        Ok(bytes)
    }

    /// Compares the checksum of the document with that in the member that holds it; false if
    /// there is none.
    pub(super) fn check_document(
        &mut self,
        document: &[u8],
        link: Option<&str>,
    ) -> Result<bool, FileProblem> {
        let name = link.filter(|link| !link.is_empty()).unwrap_or("md5checksum.hex");
        if self.find(name).is_none() {
            return Ok(false);
        }
        let line = self.member(name)?;
        let line = String::from_utf8_lossy(&line);
        let stated = line.split_whitespace().next().unwrap_or_default();
        check(super::MAIN, document, stated).map(|()| true)
    }
}

fn check(member: &str, bytes: &[u8], stated: &str) -> Result<(), FileProblem> {
    let found = checksum(bytes);
    if found.eq_ignore_ascii_case(stated.trim()) {
        return Ok(());
    }
    let stated = stated.chars().take(32).flat_map(char::escape_debug).collect();
    Err(FileProblem::Checksum { member: member.to_owned(), found, stated })
}

/// MD5 checksum as hexadecimal digits.
pub(super) fn checksum(bytes: &[u8]) -> String {
    Md5::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
