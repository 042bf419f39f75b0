//! Digital Surf `.sur` and `.pro`: a header of 512 bytes, a comment, a private zone and the
//! heights as integers, plain (`DIGITAL SURF`) or in zlib streams (`DSCOMPRESSED`).
//!
//! A height is `z = raw spacing_z + offset_z` in the unit of the step. Where the header says that
//! there are non-measured points, they hold its smallest raw height less 2.

use super::bytes::{Cursor, Number, count, holds};
use super::error::{FileProblem, Place, unexpected};
use super::heights::{Binary, Checked};
use super::{OpenScan, grid, spacing};
use crate::Source;
use crate::packed;
use flate2::read::ZlibDecoder;
use std::io::{self, Read, Take};

const PLAIN: &[u8] = b"DIGITAL SURF";
const COMPRESSED: &[u8] = b"DSCOMPRESSED";

pub(super) fn is_signature(start: &[u8]) -> bool {
    start.starts_with(PLAIN) || start.starts_with(COMPRESSED)
}

/// Offsets of the fields that are used; the header is packed.
mod offset {
    pub const OBJECTS: usize = 14;
    pub const KIND: usize = 18;
    pub const OBJECT_NAME: usize = 20;
    pub const OPERATOR_NAME: usize = 50;
    pub const SPECIAL_POINTS: usize = 86;
    pub const BITS: usize = 98;
    pub const SMALLEST: usize = 100;
    pub const COLUMNS: usize = 108;
    pub const ROWS: usize = 112;
    pub const SPACINGS: usize = 120;
    pub const STEP_UNITS: usize = 180;
    pub const TIME: usize = 306;
    pub const COMMENT_LENGTH: usize = 334;
    pub const OFFSET_Z: usize = 474;
    pub const END: usize = 512;
}

struct Header {
    kind: &'static str,
    columns: usize,
    rows: usize,
    number: Number,
    missing: Option<f64>,
    /// Spacings of x and y and the step of z in metres.
    steps: [f64; 3],
    offset_z: f64,
    data: usize,
    instrument: Vec<(String, String)>,
}

/// Reads the header of a Digital Surf file.
pub(super) fn open(source: Source<'_>) -> Result<OpenScan<'_>, FileProblem> {
    let header = read_header(source.start())?;
    let compressed = source.start().starts_with(COMPRESSED);
    let points = header.columns as u64 * header.rows as u64;
    let needed = points * header.number.bytes() as u64;
    let ([x, y, z], offset_z, missing) = (header.steps, header.offset_z, header.missing);
    let metres = move |raw| if missing == Some(raw) { f64::NAN } else { raw * z + offset_z };
    let (number, length, offset) = (header.number, source.length(), header.data);
    let place = (offset, length);
    let heights = if compressed {
        let packed = length.saturating_sub(offset as u64);
        packed::admit(Place::Byte(offset::COLUMNS), packed, needed)?;
        let streams = Streams::open(source, offset, needed)?;
        Checked::new(Binary::new(streams, number, points, metres, place))
    } else {
        holds(length, offset, needed, "the heights")?;
        Checked::new(Binary::new(source.from(offset), number, points, metres, place))
    };
    let signature = if compressed { "DSCOMPRESSED" } else { "DIGITAL SURF" };
    Ok(OpenScan {
        format: format!("Digital Surf {}", header.kind),
        detected: format!(
            "the first bytes are `{signature}`: Digital Surf {}, {}compressed, heights as {:?}",
            header.kind,
            if compressed { "" } else { "not " },
            header.number
        ),
        grid: grid(header.columns, header.rows, x, y),
        instrument: header.instrument,
        declared: Some((points, Place::Byte(offset::COLUMNS))),
        heights,
    })
}

fn read_header(bytes: &[u8]) -> Result<Header, FileProblem> {
    Cursor::new(bytes).take(offset::END as u64, "the header")?;
    let at = |offset| Cursor::at(bytes, offset);
    let kind = kind(at(offset::KIND).i16("the type of object")?)?;
    let objects = at(offset::OBJECTS).i16("the number of objects")?;
    if objects > 1 {
        let what = format!("a file of {objects} objects");
        let advice = "save the surface or profile on its own";
        return Err(FileProblem::Unsupported { place: Place::Byte(offset::OBJECTS), what, advice });
    }
    let number = match at(offset::BITS).i16("bits of a point")? {
        16 => Number::I16,
        32 => Number::I32,
        bits => {
            return Err(unexpected(Place::Byte(offset::BITS), "bits of a point", bits, "16 or 32"));
        }
    };
    let declared = |offset, what| {
        let value = at(offset).i32(what)?;
        u64::try_from(value).map_err(|_| unexpected(Place::Byte(offset), what, value, "1 or more"))
    };
    let columns = declared(offset::COLUMNS, "points of a line")?;
    let rows = declared(offset::ROWS, "number of lines")?;
    let (columns, rows) = count(Place::Byte(offset::COLUMNS), columns, rows)?;
    let special = at(offset::SPECIAL_POINTS).i16("special points")? != 0;
    let smallest = f64::from(at(offset::SMALLEST).i32("smallest height")?);
    let metres = [unit(bytes, 0)?, unit(bytes, 1)?, unit(bytes, 2)?];
    let mut fields = at(offset::SPACINGS);
    let mut steps = [0.0; 3];
    for (step, metres) in steps.iter_mut().zip(metres) {
        *step = f64::from(fields.f32("spacing")?) * metres.unwrap_or(1.0);
    }
    if let [None, ..] | [.., None] = metres {
        let place = Place::Byte(offset::STEP_UNITS);
        return Err(unexpected(place, "the unit of x or z", "not a length", "nm, um, mm, cm or m"));
    }
    if rows > 1 && metres[1].is_none() {
        let place = Place::Byte(offset::STEP_UNITS + 16);
        return Err(unexpected(place, "the unit of y", "not a length", "nm, um, mm, cm or m"));
    }
    spacing(Place::Byte(offset::SPACINGS), steps[0])?;
    if rows > 1 {
        spacing(Place::Byte(offset::SPACINGS + 4), steps[1])?;
    }
    let offset_z = f64::from(at(offset::OFFSET_Z).f32("offset of z")?) * metres[2].unwrap_or(1.0);
    let mut lengths = at(offset::COMMENT_LENGTH);
    let comment = lengths.u16("length of the comment")?;
    let private = lengths.u16("length of the private zone")?;
    Ok(Header {
        kind,
        columns,
        rows,
        number,
        missing: special.then_some(smallest - 2.0),
        steps,
        offset_z,
        data: offset::END + usize::from(comment) + usize::from(private),
        instrument: instrument(bytes, comment)?,
    })
}

fn kind(code: i16) -> Result<&'static str, FileProblem> {
    match code {
        1 => Ok("profile"),
        2 => Ok("surface"),
        other => Err(FileProblem::Unsupported {
            place: Place::Byte(offset::KIND),
            what: format!("an object of type {other}"),
            advice: "profiles (1) and surfaces (2) are read; save one of them on its own",
        }),
    }
}

/// Metres of the step unit of an axis; `None` if it is not a length.
fn unit(bytes: &[u8], axis: usize) -> Result<Option<f64>, FileProblem> {
    let text = Cursor::at(bytes, offset::STEP_UNITS + 16 * axis).text(16, "unit of the axis")?;
    Ok(super::metres_of(&text))
}

fn instrument(bytes: &[u8], comment: u16) -> Result<Vec<(String, String)>, FileProblem> {
    let mut time = Cursor::at(bytes, offset::TIME);
    let mut parts = [0; 6];
    for part in &mut parts {
        *part = time.i16("time of the measurement")?;
    }
    let [second, minute, hour, day, month, year] = parts;
    let date = format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}");
    let texts = [
        ("object", Cursor::at(bytes, offset::OBJECT_NAME).text(30, "name of the object")?),
        ("operator", Cursor::at(bytes, offset::OPERATOR_NAME).text(30, "name of the operator")?),
        ("created", if year == 0 { String::new() } else { date }),
        ("comment", Cursor::at(bytes, offset::END).text(u64::from(comment), "the comment")?),
    ];
    let named = texts.into_iter().filter(|(_, text)| !text.is_empty());
    Ok(named.map(|(name, text)| (name.to_owned(), text)).collect())
}

/// The heights of a compressed file: number of streams, their lengths, the streams.
struct Streams<'a> {
    /// Lengths of the streams that follow, plain and packed.
    directory: std::vec::IntoIter<(u64, u64)>,
    /// The stream being unpacked with the remaining bytes of it, then the bytes after it.
    stream: ZlibDecoder<Take<Box<dyn Read + 'a>>>,
    left: u64,
}

impl<'a> Streams<'a> {
    fn open(source: Source<'a>, offset: usize, length: u64) -> Result<Self, FileProblem> {
        const MOST_STREAMS: u32 = 1024;
        let mut cursor = Cursor::at(source.start(), offset);
        let place = cursor.place();
        let streams = cursor.u32("the number of streams")?;
        if streams > MOST_STREAMS {
            let (size, limit) = (u64::from(streams), u64::from(MOST_STREAMS));
            return Err(FileProblem::TooLarge {
                place,
                what: "the number of streams",
                size,
                limit,
            });
        }
        let mut directory = Vec::new();
        for _ in 0..streams {
            let plain = cursor.u32("length of a stream")?;
            directory.push((u64::from(plain), u64::from(cursor.u32("packed length of a stream")?)));
        }
        let declared: u64 = directory.iter().map(|(plain, _)| plain).sum();
        if declared != length {
            return Err(unexpected(place, "the length of the streams", declared, length));
        }
        let packed: u64 = directory.iter().map(|(_, packed)| packed).sum();
        holds(source.length(), cursor.offset(), packed, "the streams")?;
        let offset = cursor.offset();
        let rest: Box<dyn Read + 'a> = Box::new(source.from(offset));
        let stream = ZlibDecoder::new(rest.take(0));
        Ok(Self { directory: directory.into_iter(), stream, left: 0 })
    }

    /// Opens the next stream; false if there is none.
    fn next(&mut self) -> io::Result<bool> {
        let packed = self.stream.get_mut();
        io::copy(packed, &mut io::sink())?;
        let Some((plain, packed_length)) = self.directory.next() else { return Ok(false) };
        let done: Take<Box<dyn Read + 'a>> = (Box::new(io::empty()) as Box<dyn Read + 'a>).take(0);
        let rest = std::mem::replace(packed, done).into_inner();
        self.stream = ZlibDecoder::new(rest.take(packed_length));
        self.left = plain;
        Ok(true)
    }
}

impl Read for Streams<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.left == 0 {
            if !self.next()? {
                return Ok(0);
            }
        }
        let most = buffer.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let read = self.stream.read(&mut buffer[..most])?;
        if read == 0 && most > 0 {
            let reason = format!("a stream ends {} bytes before its length", self.left);
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        self.left -= read as u64;
        // The decoder compares the checksum where it comes to the end.
        if self.left == 0 && self.stream.read(&mut [0])? > 0 {
            let reason = "a stream continues after its length";
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        Ok(read)
    }
}
