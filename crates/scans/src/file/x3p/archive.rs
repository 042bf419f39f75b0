//! Members of the zip archive, within limits.
//!
//! Members are looked up by name and unpacked as they are read; none is completely in memory, and
//! nothing is ever written under a name from the archive.

use super::super::error::{FileProblem, Place};
use crate::packed;
use md5::{Digest, Md5};
use std::io::{self, Cursor, Read, Take};
use zip::ZipArchive;
use zip::result::ZipError;

/// More members than any writer makes.
const MOST_MEMBERS: usize = 1000;

pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    length: u64,
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
        Ok(Self { zip, length: bytes.len() as u64 })
    }

    fn find(&mut self, name: &str) -> Option<usize> {
        self.zip.index_for_name(name.trim().trim_start_matches('/'))
    }

    /// A member, to be unpacked.
    pub(super) fn member(&mut self, name: &str) -> Result<Member<'_>, FileProblem> {
        let place = Place::Member(name.to_owned());
        let index = self.find(name).ok_or_else(|| {
            let expected = match name {
                super::MAIN => "in every X3P file; from another archive unpack the scan first",
                _ => "there, since the document names it; export the scan again",
            };
            super::unexpected(place.clone(), "the member", "not there", expected)
        })?;
        let file = self.zip.by_index(index).map_err(|error| FileProblem::Damaged {
            place: place.clone(),
            reason: error.to_string(),
        })?;
        // Neither of the stated sizes is to be trusted.
        let (size, packed) = (file.size(), file.compressed_size().min(self.length));
        packed::admit(place.clone(), packed, size)?;
        let limit = packed::limit(packed);
        let file: Box<dyn Read + '_> = Box::new(file);
        let file = file.take(limit.saturating_add(1));
        Ok(Member { name: name.to_owned(), file, size, packed, limit, checksum: Md5::new() })
    }

    /// A binary member of known length.
    pub(super) fn binary(&mut self, name: &str, length: u64) -> Result<Member<'_>, FileProblem> {
        let member = self.member(name)?;
        if member.size != length {
            let place = Place::Member(name.to_owned());
            return Err(super::unexpected(place, "its length in bytes", member.size, length));
        }
        Ok(member)
    }

    /// Compares the checksum of the document with that in the member that holds it; false if
    /// there is none.
    pub(super) fn check_document(
        &mut self,
        found: String,
        link: Option<&str>,
    ) -> Result<bool, FileProblem> {
        /// A checksum and the name of the file, with room.
        const ENOUGH: u64 = 4096;
        let name = link.filter(|link| !link.is_empty()).unwrap_or("md5checksum.hex");
        if self.find(name).is_none() {
            return Ok(false);
        }
        let mut member = self.member(name)?;
        let mut line = Vec::new();
        let read = member.by_ref().take(ENOUGH).read_to_end(&mut line);
        read.map_err(|error| member.damaged(&error))?;
        let line = String::from_utf8_lossy(&line);
        let stated = line.split_whitespace().next().unwrap_or_default();
        compare(super::MAIN, found, stated).map(|()| true)
    }
}

/// A member that is unpacked, with the checksum of what was read.
pub(super) struct Member<'a> {
    name: String,
    file: Take<Box<dyn Read + 'a>>,
    /// Unpacked size that the archive states.
    pub(super) size: u64,
    packed: u64,
    limit: u64,
    checksum: Md5,
}

impl Read for Member<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.checksum.update(&buffer[..read]);
        Ok(read)
    }
}

impl Member<'_> {
    /// The error of reading, for the archive.
    pub(super) fn damaged(&self, error: &io::Error) -> FileProblem {
        let place = Place::Member(self.name.clone());
        FileProblem::Damaged { place, reason: error.to_string() }
    }

    /// Reads the remaining bytes and returns the checksum of all.
    pub(super) fn finish(mut self) -> Result<String, FileProblem> {
        // The archive compares its checksum at the end.
        io::copy(&mut self, &mut io::sink()).map_err(|error| self.damaged(&error))?;
        if self.file.limit() == 0 {
            let (place, unpacked) = (Place::Member(self.name), self.limit + 1);
            return Err(FileProblem::Ratio { place, packed: self.packed, unpacked });
        }
        Ok(hexadecimal(&self.checksum.finalize()))
    }

    /// Reads the remaining bytes and compares the checksum of all with the stated one, if there is one.
    pub(super) fn check(self, stated: Option<&str>) -> Result<(), FileProblem> {
        let name = self.name.clone();
        let found = self.finish()?;
        match stated.filter(|stated| !stated.is_empty()) {
            Some(stated) => compare(&name, found, stated),
            None => Ok(()),
        }
    }
}

fn compare(member: &str, found: String, stated: &str) -> Result<(), FileProblem> {
    if found.eq_ignore_ascii_case(stated.trim()) {
        return Ok(());
    }
    let stated = stated.chars().take(32).flat_map(char::escape_debug).collect();
    Err(FileProblem::Checksum { member: member.to_owned(), found, stated })
}

/// MD5 checksum as hexadecimal digits.
pub(super) fn checksum(bytes: &[u8]) -> String {
    hexadecimal(&Md5::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
