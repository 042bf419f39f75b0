//! The encoding of a text by its content.

use encoding_rs::{EUC_KR, Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;

/// Label and text. Byte order marks and valid UTF-8 are certain; of the rest, CP949 is told by
/// its Hangul in pairs of bytes beyond ASCII, and Western European (latin1, windows-1252) is what
/// remains.
pub(crate) fn decode(bytes: &[u8]) -> (&'static str, Cow<'_, str>) {
    if let Some((encoding, mark)) = Encoding::for_bom(bytes) {
        let (text, _) = encoding.decode_without_bom_handling(&bytes[mark..]);
        return (label(encoding), text);
    }
    if let Some(encoding) = wide(bytes) {
        return (label(encoding), encoding.decode_without_bom_handling(bytes).0);
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return ("utf-8", Cow::Borrowed(text));
    }
    let (korean, malformed) = EUC_KR.decode_without_bom_handling(bytes);
    if !malformed && stands_in_pairs(bytes) && is_korean(&korean) {
        return ("euc-kr", korean);
    }
    ("windows-1252", WINDOWS_1252.decode_without_bom_handling(bytes).0)
}

fn label(encoding: &'static Encoding) -> &'static str {
    if encoding == UTF_8 {
        "utf-8"
    } else if encoding == UTF_16LE {
        "utf-16le"
    } else {
        "utf-16be"
    }
}

/// UTF-16 without a mark: one of the two bytes of nearly every character of numbers is zero.
fn wide(bytes: &[u8]) -> Option<&'static Encoding> {
    let start = &bytes[..bytes.len().min(4096) & !1];
    let zeros = |offset| start.iter().skip(offset).step_by(2).filter(|byte| **byte == 0).count();
    let most = start.len() * 2 / 5;
    match (zeros(0), zeros(1)) {
        _ if start.is_empty() => None,
        (0, odd) if odd > most => Some(UTF_16LE),
        (even, 0) if even > most => Some(UTF_16BE),
        _ => None,
    }
}

/// Whether bytes beyond ASCII occur in runs of even length more often than not, as those of the
/// common Hangul do. A lone one is a letter of Western European: `\xb5m` is `\u{b5}m`, though CP949
/// has a rare syllable for these two bytes as well.
fn stands_in_pairs(bytes: &[u8]) -> bool {
    let runs = bytes.split(u8::is_ascii).map(<[u8]>::len).filter(|length| *length > 0);
    let (even, odd) = runs.fold((0_usize, 0_usize), |(even, odd), length| {
        (even + usize::from(length % 2 == 0), odd + length % 2)
    });
    even > odd
}

/// Whether most characters beyond ASCII are Hangul syllables.
fn is_korean(text: &str) -> bool {
    let beyond = text.chars().filter(|c| !c.is_ascii());
    let (hangul, all) = beyond.fold((0, 0), |(hangul, all), c| {
        (hangul + usize::from(('\u{ac00}'..='\u{d7a3}').contains(&c)), all + 1)
    });
    2 * hangul > all
}
