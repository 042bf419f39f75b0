//! From the bytes of a file to lines of text.

use crate::lines::{LineError, Lines};
use crate::{ScanProblem, Source, TextFormat};
use encoding_rs::{Decoder, DecoderResult, Encoding, UTF_8};
use std::io::{self, Read};

/// A problem with the line it is on, where it has one.
pub(super) type Located = (Option<usize>, ScanProblem);

/// The lines of a text file, without a byte order mark; one is in memory at a time.
pub(super) struct TextLines<'a> {
    lines: Lines<Box<dyn Read + 'a>>,
    encoding: &'static Encoding,
    /// Whether any line had more than blanks.
    any: bool,
}

impl<'a> TextLines<'a> {
    /// Decodes by the mark at the start, else by `label`.
    pub(super) fn open(source: Source<'a>, label: &str) -> Result<Self, Located> {
        let declared = Encoding::for_label(label.as_bytes()).ok_or_else(|| {
            let reason =
                format!("is `{label}`, which no encoding is called; try utf-8 or windows-1252");
            (None, ScanProblem::Description { key: "encoding", reason })
        })?;
        let (encoding, mark) = Encoding::for_bom(source.start()).unwrap_or((declared, 0));
        let is_wide = encoding.output_encoding() != encoding;
        if !is_wide && source.start().contains(&0) {
            return Err((None, ScanProblem::Binary));
        }
        let bytes = source.from(mark);
        let text: Box<dyn Read + 'a> =
            if encoding == UTF_8 { Box::new(bytes) } else { Box::new(Utf8::new(bytes, encoding)) };
        Ok(Self { lines: Lines::new(text), encoding, any: false })
    }

    /// The next line, without its end; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<&str>, Located> {
        let number = self.number() + 1;
        let found = self.lines.advance().map_err(|error| match error {
            LineError::Io(error) => (None, error.into()),
            LineError::TooLong(limit) => (Some(number), ScanProblem::LongLine { limit }),
        })?;
        if !found {
            return Ok(None);
        }
        let bytes = self.lines.line();
        if bytes.contains(&0) {
            return Err((None, ScanProblem::Binary));
        }
        let text = std::str::from_utf8(bytes).map_err(|_| {
            (Some(number), ScanProblem::Encoding { encoding: self.encoding.name() })
        })?;
        self.any = self.any || !text.trim().is_empty();
        Ok(Some(text))
    }

    /// The line last read, without its end.
    pub(super) fn line(&self) -> &str {
        std::str::from_utf8(self.lines.line()).unwrap_or_default()
    }

    /// Number of the line last read, from 1.
    pub(super) fn number(&self) -> usize {
        self.lines.number()
    }

    /// Whether the line last read has a line end.
    pub(super) fn is_ended(&self) -> bool {
        self.lines.is_ended()
    }

    /// What a file that ends too early is: `problem`, or without any text.
    pub(super) fn ends_with(&self, problem: ScanProblem) -> ScanProblem {
        if self.any { problem } else { ScanProblem::Empty }
    }

    /// Reads over the preamble.
    pub(super) fn skip_preamble(&mut self, format: &TextFormat) -> Result<(), Located> {
        let skip_lines = format.skip_lines;
        for lines in 0..skip_lines {
            if self.next()?.is_none() {
                return Err((None, self.ends_with(ScanProblem::SkippedAll { lines, skip_lines })));
            }
        }
        let Some(marker) = &format.skip_until else { return Ok(()) };
        while let Some(line) = self.next()? {
            if line.trim_start_matches([' ', '\t']).starts_with(marker.trim()) {
                return Ok(());
            }
        }
        Err((None, self.ends_with(ScanProblem::NoMarker { marker: marker.clone() })))
    }
}

/// Bytes of any encoding as UTF-8. What is malformed becomes a byte that UTF-8 does not have, so
/// that it is found on its line.
struct Utf8<R> {
    reader: R,
    decoder: Decoder,
    raw: Vec<u8>,
    /// Part of `raw` that is not decoded.
    undecoded: std::ops::Range<usize>,
    ended: bool,
    text: Vec<u8>,
    at: usize,
}

impl<R: Read> Utf8<R> {
    fn new(reader: R, encoding: &'static Encoding) -> Self {
        Self {
            reader,
            decoder: encoding.new_decoder_without_bom_handling(),
            raw: vec![0; 1 << 14],
            undecoded: 0..0,
            ended: false,
            text: Vec::new(),
            at: 0,
        }
    }

    /// Decodes some more; nothing at the end.
    fn decode(&mut self) -> io::Result<()> {
        const MALFORMED: u8 = 0xff;
        self.at = 0;
        self.text.clear();
        while self.text.is_empty() && !self.ended {
            if self.undecoded.is_empty() {
                self.undecoded = 0..self.reader.read(&mut self.raw)?;
            }
            // The last call signals the end of the input.
            let last = self.undecoded.is_empty();
            self.text.resize(1 << 16, 0);
            let source = &self.raw[self.undecoded.clone()];
            let (result, read, written) =
                self.decoder.decode_to_utf8_without_replacement(source, &mut self.text, last);
            self.text.truncate(written);
            self.undecoded.start += read;
            match result {
                DecoderResult::InputEmpty => self.ended = last,
                DecoderResult::OutputFull => {}
                DecoderResult::Malformed(..) => self.text.push(MALFORMED),
            }
        }
        Ok(())
    }
}

impl<R: Read> Read for Utf8<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.at == self.text.len() {
            self.decode()?;
        }
        let part = &self.text[self.at..];
        let length = part.len().min(buffer.len());
        buffer[..length].copy_from_slice(&part[..length]);
        self.at += length;
        Ok(length)
    }
}

/// The lines of a text without their ends.
pub(super) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut start = 0;
    std::iter::from_fn(move || {
        (start < text.len()).then(|| {
            let next = next_line(text, start);
            let line = text[start..next].trim_end_matches(['\r', '\n']);
            start = next;
            line
        })
    })
}

/// Offset of the line after the one at `start`; a line ends with `\n`, `\r\n`, `\r\r\n` or `\r`.
fn next_line(text: &str, start: usize) -> usize {
    // Bytes: the search for characters is slower, and is called for every line.
    let rest = &text.as_bytes()[start..];
    match rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')) {
        None => text.len(),
        Some(length) => start + length + line_end_length(&rest[length..]),
    }
}

/// Length of the line end at the start of `bytes`. Programs that write `\r\n` to a file in text
/// mode leave `\r\r\n`, which is one line end and no blank line.
fn line_end_length(bytes: &[u8]) -> usize {
    ["\r\r\n", "\r\n"]
        .iter()
        .find(|end| bytes.starts_with(end.as_bytes()))
        .map_or(1, |end| end.len())
}
