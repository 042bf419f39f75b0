//! Maps larger than what they are given in memory: a line at a time of those that are asked for.

use super::{ALONE, taken};
use asperity::scans::Source;
use asperity::scans::file::{FileProblem, MapLines, open};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::PoisonError;

/// The header of a binary SDF map of 16-bit heights in micrometres.
fn sdf_header(columns: u32, rows: u32) -> Vec<u8> {
    let mut bytes = b"bISO-2.0asperity  010120261200010120261200".to_vec();
    bytes.extend([columns, rows].iter().flat_map(|length| length.to_le_bytes()));
    bytes.extend([2e-6_f64, 3e-6, 1e-6, -1.0].iter().flat_map(|scale| scale.to_le_bytes()));
    bytes.extend([0, 5, 0]);
    bytes
}

/// The header of a plain Digital Surf map of the same heights.
fn surf_header(columns: u32, rows: u32) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    let mut put = |offset: usize, field: &[u8]| {
        bytes[offset..offset + field.len()].copy_from_slice(field);
    };
    put(0, b"DIGITAL SURF");
    put(14, &1_i16.to_le_bytes());
    put(18, &2_i16.to_le_bytes());
    put(98, &16_i16.to_le_bytes());
    put(108, &columns.to_le_bytes());
    put(112, &rows.to_le_bytes());
    put(120, &[2.0_f32.to_le_bytes(), 3.0_f32.to_le_bytes(), 1.0_f32.to_le_bytes()].concat());
    put(180, b"um              um              um");
    bytes
}

fn height(row: u32, column: u32) -> i16 {
    (row.wrapping_mul(7919).wrapping_add(column.wrapping_mul(104_729)) % 30_011) as i16
}

fn write_map(path: &Path, header: &[u8], columns: u32, rows: u32) {
    let mut file = BufWriter::new(File::create(path).unwrap());
    file.write_all(header).unwrap();
    for row in 0..rows {
        for column in 0..columns {
            file.write_all(&height(row, column).to_le_bytes()).unwrap();
        }
    }
    file.flush().unwrap();
}

/// Reads every `step`-th line, compares it with what was written, and gives its number and the peak.
fn lines_of(path: &Path, lines: MapLines, step: usize) -> (usize, usize) {
    let (peak, found) = taken(|| {
        let scan = open(Source::open(path).unwrap()).unwrap().unwrap();
        let mut found = 0_usize;
        scan.lines("map", lines, step, &mut |line| -> Result<(), FileProblem> {
            let number = (found * step) as u32;
            for (place, z) in line.heights.iter().enumerate() {
                let expected = match lines {
                    MapLines::Rows => height(number, place as u32),
                    MapLines::Columns => height(place as u32, number),
                };
                assert!((z * 1e6 - f64::from(expected)).abs() < 1e-6, "{} {place}", line.name);
            }
            found += 1;
            Ok(())
        })
        .unwrap();
        found
    });
    (found, peak)
}

#[test]
fn lines_of_a_map_take_the_memory_of_lines() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map");
    let (columns, rows) = (4096, 2000);
    // 16 MB, 65 MB as heights: a thirtieth of that suffices.
    for header in [sdf_header(columns, rows), surf_header(columns, rows)] {
        write_map(&path, &header, columns, rows);
        for (lines, found) in [(MapLines::Rows, 20), (MapLines::Columns, 41)] {
            let (count, peak) = lines_of(&path, lines, 100);
            println!("{lines:?}: {count} lines of {columns} x {rows} points, peak {peak} bytes");
            assert_eq!(count, found);
            assert!(peak < 2 << 20, "{peak}");
        }
        let (peak, statistics) =
            taken(|| open(Source::open(&path).unwrap()).unwrap().unwrap().statistics().unwrap());
        assert_eq!((statistics.points(), statistics.missing()), (4096 * 2000, 0));
        assert!(peak < 1 << 20, "{peak}");
    }
}

/// 20 000 x 20 000 points, of which 5 GB of text and 3 GB of heights would be: by hand, with --ignored.
#[test]
#[ignore = "writes 800 MB"]
fn lines_of_a_huge_map_take_the_memory_of_lines() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map");
    for header in [sdf_header(20_000, 20_000), surf_header(20_000, 20_000)] {
        write_map(&path, &header, 20_000, 20_000);
        let (count, peak) = lines_of(&path, MapLines::Rows, 100);
        println!("{count} rows of 20000 x 20000 points, peak {peak} bytes");
        assert!(count == 200 && peak < 2 << 20, "{count} {peak}");
    }
}

#[test]
fn more_lines_than_memory_are_refused_with_the_step_to_take() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map");
    let mut file = File::create(&path).unwrap();
    file.write_all(&sdf_header(1 << 16, 1 << 16)).unwrap();
    // Holes: 8 GB that take no room.
    file.set_len(8_600_000_000).unwrap();
    drop(file);
    let scan = open(Source::open(&path).unwrap()).unwrap().unwrap();
    let error =
        scan.lines("map", MapLines::Rows, 2, &mut |_| Ok::<(), FileProblem>(())).unwrap_err();
    let error = error.to_string();
    for part in ["every 2. line", "2147483648 points", "map_line_step = 16"] {
        assert!(error.contains(part), "`{part}` is not in {error}");
    }
    let scan = open(Source::open(&path).unwrap()).unwrap().unwrap();
    let error = scan.whole().unwrap_err().to_string();
    assert!(
        error.contains("byte 42: the number of points is 4294967296, above the limit"),
        "{error}"
    );
}
