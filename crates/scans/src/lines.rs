//! Lines and words of a stream of bytes, one at a time.

use std::io::{self, Read};

/// Longest line, in bytes. A row of 100 000 columns has a tenth.
pub(super) const LONGEST_LINE: usize = 1 << 22;
/// Longest word, in bytes; a number of 300 digits is written by nothing that measures.
const LONGEST_WORD: usize = 1 << 10;
const CHUNK: usize = 1 << 16;

/// Why a line or word cannot be given.
#[derive(Debug)]
pub(super) enum LineError {
    Io(io::Error),
    /// Longer than any line of a scan; the length that is allowed.
    TooLong(usize),
}

/// Splits a stream into lines, which end with `\n`, `\r\n`, `\r\r\n` or `\r`, or into words between blanks.
pub(super) struct Lines<R> {
    reader: R,
    chunk: Vec<u8>,
    /// Where the unread part of the chunk starts.
    at: usize,
    line: Vec<u8>,
    number: usize,
    ended: bool,
    after_return: bool,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self {
            reader,
            chunk: Vec::new(),
            at: 0,
            line: Vec::new(),
            number: 0,
            ended: true,
            after_return: false,
        }
    }

    /// Number of the line last read, from 1; 0 before the first.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// Whether what was last read is followed by a line end (a word: by a blank), and not by the
    /// end of the file.
    pub(super) fn is_ended(&self) -> bool {
        self.ended
    }

    /// The line last read, without its end.
    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Reads the next line, [`Lines::line`] then; false at the end.
    pub(super) fn advance(&mut self) -> Result<bool, LineError> {
        self.line.clear();
        if !self.fill()? {
            return Ok(false);
        }
        self.number += 1;
        self.ended = false;
        while self.fill()? {
            let unread = &self.chunk[self.at..];
            let end = unread.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let part = &unread[..end.unwrap_or(unread.len())];
            if self.line.len() + part.len() > LONGEST_LINE {
                return Err(LineError::TooLong(LONGEST_LINE));
            }
            self.line.extend_from_slice(part);
            self.at += part.len();
            if end.is_some() {
                self.after_return = self.chunk[self.at] == b'\r';
                self.at += 1;
                self.ended = true;
                break;
            }
        }
        Ok(true)
    }

    /// Reads the next word, [`Lines::line`] then; false at the end. Starts on the line after the
    /// one last read; [`Lines::number`] is that of the word.
    pub(super) fn word(&mut self) -> Result<bool, LineError> {
        if self.ended {
            self.number += 1;
            self.ended = false;
        }
        self.line.clear();
        while self.fill()? {
            let byte = self.chunk[self.at];
            if byte.is_ascii_whitespace() {
                if !self.line.is_empty() {
                    return Ok(true);
                }
                self.at += 1;
                if matches!(byte, b'\n' | b'\r') {
                    self.after_return = byte == b'\r';
                    self.number += 1;
                }
                continue;
            }
            if self.line.len() == LONGEST_WORD {
                return Err(LineError::TooLong(LONGEST_WORD));
            }
            self.line.push(byte);
            self.at += 1;
        }
        Ok(!self.line.is_empty())
    }

    /// Whether the file ends here.
    pub(super) fn is_at_end(&mut self) -> Result<bool, LineError> {
        Ok(!self.fill()?)
    }

    /// Reads a chunk where the last is used up; false at the end.
    fn fill(&mut self) -> Result<bool, LineError> {
        loop {
            if self.at == self.chunk.len() {
                self.chunk.clear();
                self.at = 0;
                if !self.read_on()? {
                    return Ok(false);
                }
            }
            // The rest of `\r\n`, or of `\r\r\n`, which programs leave that write `\r\n` in text mode.
            if std::mem::take(&mut self.after_return) {
                let byte = self.chunk[self.at];
                let rest = match byte {
                    b'\n' => 1,
                    b'\r' if self.byte_after()? == Some(b'\n') => 2,
                    _ => return Ok(true),
                };
                self.at += rest;
                continue;
            }
            return Ok(true);
        }
    }

    /// The byte after the first unread one, which stays unread; `None` at the end of the file.
    fn byte_after(&mut self) -> Result<Option<u8>, LineError> {
        if self.at + 1 == self.chunk.len() {
            self.chunk.drain(..self.at);
            self.at = 0;
            self.read_on()?;
        }
        Ok(self.chunk.get(self.at + 1).copied())
    }

    /// Appends to the chunk what the reader gives; false at the end.
    fn read_on(&mut self) -> Result<bool, LineError> {
        let before = self.chunk.len();
        self.chunk.resize(before + CHUNK, 0);
        let read = loop {
            match self.reader.read(&mut self.chunk[before..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                other => break other,
            }
        };
        self.chunk.truncate(before + *read.as_ref().unwrap_or(&0));
        Ok(read.map_err(LineError::Io)? > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives a byte at a time, so that every line end falls on the end of a chunk.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let Some((first, rest)) = self.0.split_first() else { return Ok(0) };
            buffer[0] = *first;
            self.0 = rest;
            Ok(1)
        }
    }

    fn all(mut lines: Lines<impl Read>) -> Vec<(usize, String, bool)> {
        let mut found = Vec::new();
        while lines.advance().unwrap() {
            let text = String::from_utf8(lines.line().to_vec()).unwrap();
            found.push((lines.number(), text, lines.is_ended()));
        }
        found
    }

    #[test]
    fn lines_end_in_four_ways_wherever_the_chunks_end() {
        let text = b"a\nb\r\n\rc\r\r\nd\r\re";
        let expected: Vec<_> = [
            ("a", true),
            ("b", true),
            ("", true),
            ("c", true),
            ("d", true),
            ("", true),
            ("e", false),
        ]
        .into_iter()
        .enumerate()
        .map(|(i, (line, ended))| (i + 1, line.to_owned(), ended))
        .collect();
        assert_eq!(all(Lines::new(text.as_slice())), expected);
        assert_eq!(all(Lines::new(Slow(text))), expected);
        assert_eq!(all(Lines::new(&b""[..])), []);
    }

    #[test]
    fn words_know_their_line_and_whether_they_are_finished() {
        for slow in [false, true] {
            let text = b"head\r\n1 2\r\n\n3";
            let reader: Box<dyn Read> =
                if slow { Box::new(Slow(text)) } else { Box::new(&text[..]) };
            let mut lines = Lines::new(reader);
            assert!(lines.advance().unwrap());
            let mut words = Vec::new();
            while lines.word().unwrap() {
                words.push((lines.number(), lines.line().to_vec()));
            }
            assert_eq!(words, [(2, b"1".to_vec()), (2, b"2".to_vec()), (4, b"3".to_vec())]);
        }
    }

    #[test]
    fn endless_lines_and_words_are_refused() {
        let endless = || Lines::new(io::repeat(b'1'));
        assert!(matches!(endless().advance(), Err(LineError::TooLong(LONGEST_LINE))));
        assert!(matches!(endless().word(), Err(LineError::TooLong(LONGEST_WORD))));
    }
}
