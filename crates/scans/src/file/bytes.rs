//! Little-endian values from the bytes of a file, and heights from binary numbers.

use super::error::{FileProblem, Place, unexpected};

/// Reads values one after the other and knows where it is.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, offset: 0 }
    }

    pub(super) fn at(bytes: &'a [u8], offset: usize) -> Self {
        Self { bytes, offset }
    }

    pub(super) fn offset(&self) -> usize {
        self.offset
    }

    pub(super) fn place(&self) -> Place {
        Place::Byte(self.offset)
    }

    /// The next `length` bytes; nothing is allocated, whatever the length.
    pub(super) fn take(
        &mut self,
        length: u64,
        what: &'static str,
    ) -> Result<&'a [u8], FileProblem> {
        let rest = self.bytes.get(self.offset..).unwrap_or_default();
        let found = usize::try_from(length).ok().and_then(|length| rest.get(..length));
        let (offset, total) = (self.offset, self.bytes.len() as u64);
        let part =
            found.ok_or(FileProblem::Truncated { what, offset, needed: length, length: total })?;
        self.offset += part.len();
        Ok(part)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], FileProblem> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64, what)?);
        Ok(array)
    }

    pub(super) fn u8(&mut self, what: &'static str) -> Result<u8, FileProblem> {
        Ok(self.array::<1>(what)?[0])
    }

    pub(super) fn u16(&mut self, what: &'static str) -> Result<u16, FileProblem> {
        self.array(what).map(u16::from_le_bytes)
    }

    pub(super) fn i16(&mut self, what: &'static str) -> Result<i16, FileProblem> {
        self.array(what).map(i16::from_le_bytes)
    }

    pub(super) fn u32(&mut self, what: &'static str) -> Result<u32, FileProblem> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self, what: &'static str) -> Result<i32, FileProblem> {
        self.array(what).map(i32::from_le_bytes)
    }

    pub(super) fn f32(&mut self, what: &'static str) -> Result<f32, FileProblem> {
        self.array(what).map(f32::from_le_bytes)
    }

    pub(super) fn f64(&mut self, what: &'static str) -> Result<f64, FileProblem> {
        self.array(what).map(f64::from_le_bytes)
    }

    /// Text of a fixed length, without the blanks and zeros that fill it.
    pub(super) fn text(&mut self, length: u64, what: &'static str) -> Result<String, FileProblem> {
        let (text, _) =
            encoding_rs::WINDOWS_1252.decode_without_bom_handling(self.take(length, what)?);
        Ok(text.trim_matches(|c: char| c == '\0' || c.is_whitespace()).to_owned())
    }
}

/// Type of the binary numbers that hold heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    U8,
    U16,
    U32,
    F32,
    I8,
    I16,
    I32,
    F64,
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Smallest and largest value of an integer type.
    pub(super) fn range(self) -> Option<(f64, f64)> {
        match self {
            Self::U8 => Some((0.0, f64::from(u8::MAX))),
            Self::U16 => Some((0.0, f64::from(u16::MAX))),
            Self::U32 => Some((0.0, f64::from(u32::MAX))),
            Self::I8 => Some((f64::from(i8::MIN), f64::from(i8::MAX))),
            Self::I16 => Some((f64::from(i16::MIN), f64::from(i16::MAX))),
            Self::I32 => Some((f64::from(i32::MIN), f64::from(i32::MAX))),
            Self::F32 | Self::F64 => None,
        }
    }

    /// Appends all numbers in `bytes` to `values`; an incomplete last one is left out.
    pub(super) fn decode(self, bytes: &[u8], values: &mut Vec<f64>) {
        fn each<const N: usize>(
            bytes: &[u8],
            values: &mut Vec<f64>,
            value: impl Fn([u8; N]) -> f64,
        ) {
            values.extend(bytes.as_chunks::<N>().0.iter().map(|chunk| value(*chunk)));
        }
        match self {
            Self::U8 => each(bytes, values, |b| f64::from(u8::from_le_bytes(b))),
            Self::U16 => each(bytes, values, |b| f64::from(u16::from_le_bytes(b))),
            Self::U32 => each(bytes, values, |b| f64::from(u32::from_le_bytes(b))),
            Self::I8 => each(bytes, values, |b| f64::from(i8::from_le_bytes(b))),
            Self::I16 => each(bytes, values, |b| f64::from(i16::from_le_bytes(b))),
            Self::I32 => each(bytes, values, |b| f64::from(i32::from_le_bytes(b))),
            Self::F32 => each(bytes, values, |b| f64::from(f32::from_le_bytes(b))),
            Self::F64 => each(bytes, values, f64::from_le_bytes),
        }
    }
}

/// Whether a file of `length` bytes holds `needed` from `offset` on.
pub(super) fn holds(
    length: u64,
    offset: usize,
    needed: u64,
    what: &'static str,
) -> Result<(), FileProblem> {
    match length.checked_sub(offset as u64) {
        Some(rest) if needed <= rest => Ok(()),
        _ => Err(FileProblem::Truncated { what, offset, needed, length }),
    }
}

/// Checks a declared number of points before anything is made of it.
pub(super) fn count(place: Place, columns: u64, rows: u64) -> Result<(usize, usize), FileProblem> {
    /// A terabyte of the shortest numbers; products with the length of a number do not overflow.
    const MOST: u64 = 1 << 40;
    if columns == 0 || rows == 0 {
        let found = format!("{rows} rows of {columns} points");
        return Err(unexpected(place, "the size of the scan", found, "one point or more"));
    }
    let size = columns.saturating_mul(rows);
    match (usize::try_from(columns), usize::try_from(rows)) {
        (Ok(columns), Ok(rows)) if size <= MOST => Ok((columns, rows)),
        _ => {
            let what = "the number of points";
            Err(FileProblem::TooLarge { place, what, size, limit: MOST })
        }
    }
}
