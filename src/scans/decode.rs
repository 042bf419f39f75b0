//! From the bytes of a file to the text of its body.

use crate::scans::{ScanProblem, TextFormat};
use encoding_rs::{Encoding, UTF_8};
use std::borrow::Cow;

/// A problem with the line it is on, where it has one.
pub(super) type Located = (Option<usize>, ScanProblem);

/// The text of a file, without a byte order mark. UTF-8 is borrowed, all else is converted.
pub(super) fn decode<'a>(bytes: &'a [u8], label: &str) -> Result<Cow<'a, str>, Located> {
    let declared = Encoding::for_label(label.as_bytes()).ok_or_else(|| {
        let reason =
            format!("is `{label}`, which no encoding is called; try utf-8 or windows-1252");
        (None, ScanProblem::Description { key: "encoding", reason })
    })?;
    let (encoding, mark) = Encoding::for_bom(bytes).unwrap_or((declared, 0));
    let body = &bytes[mark..];
    let text = if encoding == UTF_8 {
        match std::str::from_utf8(body) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) if body.contains(&0) => return Err((None, ScanProblem::Binary)),
            Err(error) => {
                let valid = String::from_utf8_lossy(&body[..error.valid_up_to()]);
                let problem = ScanProblem::Encoding { encoding: encoding.name() };
                return Err((Some(count_line_ends(&valid) + 1), problem));
            }
        }
    } else {
        let (text, malformed) = encoding.decode_without_bom_handling(body);
        if malformed {
            let line = text.find('\u{FFFD}').map(|at| count_line_ends(&text[..at]) + 1);
            return Err((line, ScanProblem::Encoding { encoding: encoding.name() }));
        }
        text
    };
    if text.trim().is_empty() {
        return Err((None, ScanProblem::Empty));
    }
    if text.contains('\0') {
        return Err((None, ScanProblem::Binary));
    }
    Ok(text)
}

/// Offset of the first line after the preamble.
pub(super) fn body_start(text: &str, format: &TextFormat) -> Result<usize, ScanProblem> {
    let mut start = 0;
    for skipped in 0..format.skip_lines {
        if start == text.len() {
            let skip_lines = format.skip_lines;
            return Err(ScanProblem::SkippedAll { lines: skipped, skip_lines });
        }
        start = next_line(text, start);
    }
    let Some(marker) = &format.skip_until else { return Ok(start) };
    while start < text.len() {
        let found = text[start..].trim_start_matches([' ', '\t']).starts_with(marker.trim());
        start = next_line(text, start);
        if found {
            return Ok(start);
        }
    }
    Err(ScanProblem::NoMarker { marker: marker.clone() })
}

/// Offset of the line after the one at `start`; a line ends with `\n`, `\r\n`, `\r\r\n` or `\r`.
pub(super) fn next_line(text: &str, start: usize) -> usize {
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

/// Number of the line, from 1, that ends at the offset `end` (with or without its line end).
pub(super) fn line_number(text: &str, end: usize) -> usize {
    let read = &text[..end];
    let line = ["\r\r\n", "\r\n", "\n", "\r"].iter().find_map(|mark| read.strip_suffix(mark));
    count_line_ends(line.unwrap_or(read)) + 1
}

fn count_line_ends(text: &str) -> usize {
    lines(text).count() - usize::from(!text.is_empty() && !text.ends_with(['\r', '\n']))
}
