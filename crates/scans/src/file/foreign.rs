//! Files that are named for what they are, with the way to a format that is read.

use super::error::FileProblem;
use std::io::Cursor;
use zip::ZipArchive;

/// First bytes, what such a file is, and the way out.
const SIGNATURES: [(&[u8], &str, &str); 19] = [
    (b"\x01\x00Directory", "a Wyko OPD file", "export it as Wyko ASCII, SDF or X3P"),
    (b"%PDF", "a PDF document", "export the measurement itself, as SDF, X3P or text"),
    (b"{\\rtf", "a document of a word processor (RTF)", "save the numbers as plain text"),
    (b"GWYP", "a Gwyddion file", "save the channel as SDF or as an image as text"),
    (b"GWYO", "a Gwyddion file", "save the channel as SDF or as an image as text"),
    (b"AliconaImaging", "an Alicona AL3D file", "export it as SDF or X3P"),
    (b"VK3_", "a Keyence VK3 file", "export the heights as CSV or SDF"),
    (b"VK4_", "a Keyence VK4 file", "export the heights as CSV or SDF"),
    (b"VK6", "a Keyence VK6 file", "export the heights as CSV or SDF"),
    (b"\x88\x1b\x03\x6f", "a Zygo MetroPro file", "export it as SDF, X3P or text"),
    (b"\x88\x1b\x03\x70", "a Zygo MetroPro file", "export it as SDF, X3P or text"),
    (b"\x88\x1b\x03\x71", "a Zygo MetroPro file", "export it as SDF, X3P or text"),
    (b"\\*File list", "a NanoScope file", "export the heights as text with its unit"),
    (b"MATLAB 5.0", "a MATLAB file", "save positions and heights as text, with writematrix"),
    (b"LASF", "a LAS point cloud", "export a grid as text with columns x, y and z"),
    (
        b"II*\0",
        "a TIFF image",
        "export the heights, with their unit and spacing, as SDF, X3P or text",
    ),
    (
        b"MM\0*",
        "a TIFF image",
        "export the heights, with their unit and spacing, as SDF, X3P or text",
    ),
    (
        b"\x89PNG",
        "an image",
        "export the heights, with their unit and spacing, as SDF, X3P or text",
    ),
    (
        b"\xff\xd8\xff",
        "an image",
        "export the heights, with their unit and spacing, as SDF, X3P or text",
    ),
];

/// First bytes of a compound document (OLE 2).
const COMPOUND: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";

/// An entry that a compound document has, what it is then, and the way out.
const COMPOUNDS: [(&str, &str, &str); 4] = [
    (
        "ScopedContents",
        "a document of MountainsMap (.mnt)",
        "export the surface or the profile as Digital Surf .sur or .pro, SDF or X3P",
    ),
    ("Workbook", "a workbook of Excel before 2007 (.xls)", "save it as .xlsx or CSV"),
    ("WordDocument", "a Word document (.doc)", "save the numbers as plain text or in a workbook"),
    ("EncryptedPackage", "a document with a password", "save it without one"),
];

/// A member that an archive has, what it is then, and the way out.
const ARCHIVES: [(&str, &str, &str); 6] = [
    (
        "word/document.xml",
        "a Word document (.docx)",
        "save the numbers as plain text or in a workbook",
    ),
    ("ppt/presentation.xml", "a presentation (.pptx)", "export the measurement itself"),
    ("xl/workbook.bin", "a binary workbook (.xlsb)", "save it as .xlsx or CSV"),
    ("content.xml", "an OpenDocument file (.ods, .odt)", "save it as .xlsx or CSV"),
    ("LAYER_0.raw", "a Sensofar PLUX file", "export it as SDF, X3P or text"),
    ("LAYER_0.stack.raw", "a Sensofar PLUX file", "export it as SDF, X3P or text"),
];

/// What the file of these bytes is, where it is known and not read.
pub fn foreign(start: &[u8]) -> Option<FileProblem> {
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    let named = |what, advice| FileProblem::Foreign { what, advice };
    let by_signature = SIGNATURES.iter().find(|(signature, ..)| start.starts_with(signature));
    if let Some((_, what, advice)) = by_signature {
        return Some(named(what, advice));
    }
    if start.starts_with(COMPOUND) {
        let entry =
            |name: &str| name.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        let has = |name: &str| {
            let entry = entry(name);
            start.windows(entry.len()).any(|part| part == entry)
        };
        let known = COMPOUNDS.iter().find(|(name, ..)| has(name));
        return Some(known.map_or_else(
            || {
                named(
                    "a compound document of another program",
                    "export the scan as SDF, X3P or text",
                )
            },
            |(_, what, advice)| named(what, advice),
        ));
    }
    let begins = |word: &[u8]| text.get(..word.len()).is_some_and(|t| t.eq_ignore_ascii_case(word));
    if begins(b"<!doctype html") || begins(b"<html") {
        return Some(named("a web page", "download the file itself, not the page that shows it"));
    }
    begins(b"<?xml").then(|| {
        let what = "an XML document of a kind that is not known";
        named(
            what,
            "X3P and the profiles of NIST SMATS are read; export the scan as X3P, SDF or text",
        )
    })
}

/// What an archive without an X3P document is.
pub(super) fn foreign_archive(bytes: &[u8]) -> Option<FileProblem> {
    let archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    if archive.index_for_name("main.xml").is_some() {
        return None;
    }
    let known = ARCHIVES.iter().find(|(member, ..)| archive.index_for_name(member).is_some());
    if let Some((_, what, advice)) = known {
        return Some(FileProblem::Foreign { what, advice });
    }
    let holds = |ending: &str| {
        archive.file_names().flatten().any(|name| name.to_lowercase().ends_with(ending))
    };
    let (what, advice) = if [".x3p", ".sur", ".sdf", ".csv", ".txt"].into_iter().any(holds) {
        ("a zip archive of files", "unpack it and list the folder under ingest.scans")
    } else {
        (
            "a zip archive that is not an X3P file (it has no main.xml)",
            "from the program of an instrument (MountainsMap .mnt, Zemetrics .zmp and the like) export the surface as \
             SDF, X3P or Digital Surf .sur",
        )
    };
    Some(FileProblem::Foreign { what, advice })
}
