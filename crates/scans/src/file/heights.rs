//! Heights of a file, some thousands at a time.

use super::bytes::Number;
use super::error::{FileProblem, Place, unexpected};
use std::io::Read;

/// What gives the heights of a file in their order, in metres, NaN where missing.
pub(super) trait Heights {
    /// Appends the next heights to `part`, which is empty; it stays empty at the end.
    fn read(&mut self, part: &mut Vec<f64>) -> Result<(), FileProblem>;
}

/// Heights in memory, as they are of formats that cannot be read from the start to the end.
impl Heights for Vec<f64> {
    fn read(&mut self, part: &mut Vec<f64>) -> Result<(), FileProblem> {
        *part = std::mem::take(self);
        Ok(())
    }
}

/// Heights as binary numbers.
pub(super) struct Binary<R, F> {
    reader: R,
    number: Number,
    left: u64,
    metres: F,
    buffer: Vec<u8>,
    /// Where the heights start, and how long the file is.
    place: (usize, u64),
}

impl<R: Read, F: Fn(f64) -> f64> Binary<R, F> {
    /// `points` numbers from `reader` on, which is at `offset` of a file of `length` bytes; a
    /// number has `metres`.
    pub(super) fn new(
        reader: R,
        number: Number,
        points: u64,
        metres: F,
        (offset, length): (usize, u64),
    ) -> Self {
        Self { reader, number, left: points, metres, buffer: Vec::new(), place: (offset, length) }
    }
}

impl<R: Read, F: Fn(f64) -> f64> Heights for Binary<R, F> {
    fn read(&mut self, part: &mut Vec<f64>) -> Result<(), FileProblem> {
        const POINTS: u64 = 1 << 13;
        let points = self.left.min(POINTS) as usize;
        self.buffer.resize(points * self.number.bytes(), 0);
        self.reader.read_exact(&mut self.buffer).map_err(|error| match error.kind() {
            // The length was right when the file was opened.
            std::io::ErrorKind::UnexpectedEof => FileProblem::Truncated {
                what: "the heights",
                offset: self.place.0,
                needed: self.left * self.number.bytes() as u64,
                length: self.place.1,
            },
            // The decoder of a compressed stream.
            std::io::ErrorKind::InvalidInput | std::io::ErrorKind::InvalidData => {
                FileProblem::Damaged { place: Place::Byte(self.place.0), reason: error.to_string() }
            }
            _ => error.into(),
        })?;
        self.number.decode(&self.buffer, part);
        part.iter_mut().for_each(|value| *value = (self.metres)(*value));
        self.left -= points as u64;
        Ok(())
    }
}

/// Heights that are plausible: the check that all formats have in common.
pub(super) struct Checked<'a> {
    heights: Box<dyn Heights + 'a>,
    read: usize,
    any: bool,
    ended: bool,
}

impl<'a> Checked<'a> {
    pub(super) fn new(heights: impl Heights + 'a) -> Self {
        Self { heights: Box::new(heights), read: 0, any: false, ended: false }
    }

    /// Replaces `part` by the next heights; false at the end.
    pub(super) fn read(&mut self, part: &mut Vec<f64>) -> Result<bool, FileProblem> {
        // Absolute elevations of roads are heights as well; all beyond is a mark or a wrong unit.
        const LARGEST_HEIGHT_M: f64 = 1e4;
        part.clear();
        if !self.ended {
            self.heights.read(part)?;
        }
        if part.is_empty() {
            self.ended = true;
            return match self.any {
                true => Ok(false),
                false => Err(FileProblem::AllMissing { points: self.read }),
            };
        }
        if let Some(index) = part.iter().position(|height| height.abs() > LARGEST_HEIGHT_M) {
            let found = format!("{:e} m", part[index]);
            let expected = "a height below 10 km or a mark of missing points of the format";
            let place = Place::Height(self.read + index + 1);
            return Err(unexpected(place, "the value", found, expected));
        }
        self.read += part.len();
        self.any = self.any || part.iter().any(|height| !height.is_nan());
        Ok(true)
    }
}
