//! A file as a stream of known length whose start can be looked at.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

/// Bytes of the start that are held: more than the header of any binary format (131 582 bytes of
/// Digital Surf with the longest comment and private zone).
const START: u64 = 1 << 18;

/// The bytes of a scan file, read once from the start to the end.
///
/// Of a file no more than its first 256 KiB are in memory, unless a format asks for
/// the whole.
pub struct Source<'a> {
    start: Cow<'a, [u8]>,
    rest: Box<dyn Read + 'a>,
    length: u64,
}

impl<'a> Source<'a> {
    /// A stream of `length` bytes.
    ///
    /// # Errors
    /// Those of `reader`.
    pub fn new(mut reader: impl Read + 'a, length: u64) -> io::Result<Self> {
        let mut start = Vec::new();
        reader.by_ref().take(START).read_to_end(&mut start)?;
        Ok(Self { start: Cow::Owned(start), rest: Box::new(reader), length })
    }

    /// The file at `path`.
    ///
    /// # Errors
    /// Those of the operating system; anything but a plain file is refused, before it is opened, since
    /// a pipe would wait for its writer.
    pub fn open(path: &Path) -> io::Result<Source<'static>> {
        asperity_files::admit(path, u64::MAX)?;
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Source::new(file, length)
    }

    /// Bytes in memory, all of which are the start.
    pub fn of_bytes(bytes: &'a [u8]) -> Self {
        Self {
            start: Cow::Borrowed(bytes),
            rest: Box::new(io::empty()),
            length: bytes.len() as u64,
        }
    }

    /// The first bytes, all of them where the file is short.
    pub fn start(&self) -> &[u8] {
        &self.start
    }

    /// Number of bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// All bytes from `offset` on, which lies within the start.
    pub(super) fn from(self, offset: usize) -> impl Read + 'a {
        let mut start = Cursor::new(self.start);
        start.set_position(offset as u64);
        start.chain(self.rest)
    }

    /// The same bytes; of an archive, whose directory is at its end, all are the start then.
    ///
    /// # Errors
    /// Those of reading the rest of the file, which may have at most [`LARGEST_FILE`](crate::LARGEST_FILE) bytes.
    pub fn with_directory(self) -> io::Result<Self> {
        if !self.start.starts_with(b"PK\x03\x04") {
            return Ok(self);
        }
        let start = self.whole()?;
        let length = start.len() as u64;
        Ok(Self { start, rest: Box::new(io::empty()), length })
    }

    /// All bytes in memory.
    ///
    /// # Errors
    /// Those of reading; [`io::ErrorKind::FileTooLarge`] beyond [`super::LARGEST_FILE`].
    pub(super) fn whole(self) -> io::Result<Cow<'a, [u8]>> {
        super::admit_size(self.length)?;
        if self.start.len() as u64 >= self.length {
            return Ok(self.start);
        }
        let mut bytes = self.start.into_owned();
        // Another reader may make the file longer than it was: `take` keeps the limit.
        let left = self.length - bytes.len() as u64;
        bytes.reserve_exact(usize::try_from(left).unwrap_or(0));
        self.rest.take(left).read_to_end(&mut bytes)?;
        Ok(Cow::Owned(bytes))
    }
}
