//! What reading a file takes of memory, counted at every allocation: at most 32 MB, 24 bytes a byte of the file and
//! 8 bytes a point that it declares, for good files and for files made to take more.

mod hostile;
mod maps;

use asperity::scans::description::{Column, LengthUnit, Separator};
use asperity::scans::file::parse_file;
use asperity::scans::{TextFormat, parse_text};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

#[global_allocator]
static MEMORY: peak_alloc::PeakAlloc = peak_alloc::PeakAlloc;

/// One test at a time: the allocator counts the whole process.
static ALONE: Mutex<()> = Mutex::new(());

/// Bytes taken at the highest while `read` runs, and what it gives.
fn taken<T>(read: impl FnOnce() -> T) -> (usize, T) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = read();
    (MEMORY.peak_usage().saturating_sub(before), result)
}

/// Reads the bytes in every way and compares what each takes with the promise; gives the error of the reader that
/// knows the format, and prints the figures.
#[track_caller]
fn read_within_promise(name: &str, bytes: &[u8]) -> String {
    let (peak, found) = taken(|| parse_file("file", bytes));
    let points =
        found.as_ref().map_or(0, |scan| scan.as_ref().map_or(0, |scan| scan.heights.len()));
    let judge = |reader: &str, peak: usize, points: usize| {
        let promised = (32 << 20) + 24 * bytes.len() + 8 * points;
        println!(
            "{name}, {reader}: {} bytes, {points} points, peak {peak}, promised {promised}",
            bytes.len()
        );
        assert!(peak <= promised, "{name}, {reader}: {peak} bytes, promised {promised}");
    };
    judge("by content", peak, points);
    let is_text = matches!(found, Ok(None));
    let mut answer = found.map_or_else(|error| error.to_string(), |_| String::new());
    for separator in [Separator::Comma, Separator::Whitespace] {
        for header in [true, false] {
            let format = heights_alone(separator, header);
            let (peak, found) = taken(|| parse_text("file", bytes, &format));
            // A text declares no points.
            judge("as text", peak, 0);
            if let (Err(error), true, true) = (found, is_text, answer.is_empty()) {
                answer = error.to_string();
            }
        }
    }
    answer
}

fn heights_alone(separator: Separator, header: bool) -> TextFormat {
    TextFormat {
        separator,
        decimal_mark: Default::default(),
        comment: None,
        skip_lines: 0,
        skip_until: None,
        stop_at: None,
        matrix: false,
        header: Some(header),
        x_column: None,
        x_spacing_um: Some(1.0),
        y_spacing_um: None,
        x_unit: None,
        y_column: None,
        y_unit: None,
        sheet: None,
        z_column: Some(Column::Number(1)),
        z_unit: Some(LengthUnit::Um),
        invert_z: false,
        missing: vec![String::new()],
        encoding: "windows-1252".into(),
        cut_start_mm: 0.0,
        cut_end_mm: 0.0,
    }
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

#[test]
fn the_corpus_is_read_within_the_promise() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut corpus = Vec::new();
    for folder in ["data/scans", "../shared/formats", "../shared/scans"] {
        if root.join(folder).is_dir() {
            files(&root.join(folder), &mut corpus);
        } else {
            println!("skipped: {folder} is not there");
        }
    }
    for path in corpus {
        read_within_promise(&path.display().to_string(), &std::fs::read(&path).unwrap());
    }
}
