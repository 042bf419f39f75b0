//! Files as laboratories send them: the cases beside the project, where they are there, and the
//! same kinds made here.
//!
//! | module | what it holds |
//! |---|---|
//! | `instrument` | files that state their units |
//! | `points` | maps as text of one point per line |
//! | `table` | text of columns: encodings, line ends, headers |
//! | `workbook` | sheets of workbooks |

mod instrument;
mod points;
mod table;
mod workbook;

use super::description::{Column, DecimalMark, LengthUnit, Separator};
use super::file::{Grid, ScanFile, parse_file};
use super::text_shape::TextShape;
use super::{Described, TextFormat, parse_described, parse_text};
use approx::assert_relative_eq;
use asperity_core::surface::RawScan;
use std::path::PathBuf;

/// A file of a case; `None`, and said, where the cases are not there.
fn case(name: &str) -> Option<Vec<u8>> {
    let path =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/cases")).join(name);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        println!("skipped: {} is not there", path.display());
    }
    bytes
}

fn shape(bytes: &[u8]) -> TextShape {
    TextShape::of(bytes).unwrap()
}

/// What the proposal of a recipe reads: the section itself, as a recipe has it.
fn proposed(bytes: &[u8]) -> Described {
    #[derive(serde::Deserialize)]
    struct Recipe {
        ingest: Ingest,
    }
    #[derive(serde::Deserialize)]
    struct Ingest {
        text: TextFormat,
    }
    let shape = shape(bytes);
    let section = shape.recipe_section();
    let format =
        toml::from_str::<Recipe>(&section).unwrap_or_else(|e| panic!("{section}{e}")).ingest.text;
    assert_eq!(shape.format().as_ref(), Ok(&format), "{section}");
    parse_described("file", bytes, &format).unwrap_or_else(|error| panic!("{section}{error}"))
}

fn line(bytes: &[u8]) -> RawScan {
    match proposed(bytes) {
        Described::Line(scan) => scan,
        Described::Map(map) => panic!("{map:?}"),
    }
}

fn map(bytes: &[u8]) -> ScanFile {
    match proposed(bytes) {
        Described::Line(scan) => panic!("{scan:?}"),
        Described::Map(map) => map,
    }
}

fn native(bytes: &[u8]) -> ScanFile {
    parse_file("file", bytes).unwrap().unwrap()
}

fn refused(bytes: &[u8]) -> String {
    parse_file("file", bytes).unwrap_err().to_string()
}

fn mean_and_rms(heights: &[f64]) -> (f64, f64) {
    let there: Vec<f64> = heights.iter().copied().filter(|height| !height.is_nan()).collect();
    let mean = there.iter().sum::<f64>() / there.len() as f64;
    let square = there.iter().map(|height| (height - mean).powi(2)).sum::<f64>();
    (mean, (square / there.len() as f64).sqrt())
}

fn spacing(scan: &RawScan) -> f64 {
    let last = scan.positions.len() - 1;
    (scan.positions[last] - scan.positions[0]) / last as f64
}
