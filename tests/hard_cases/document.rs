//! The table in `docs/hard_cases.md`: every case looks for its row there, or writes it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Cells of a row: case, size, condition, iterations, residual, independent solution, difference, verdict.
pub type Row = [String; 8];

/// Rows by section, case and size.
type Table = BTreeMap<(usize, String, String), Row>;

/// Files of cases and the titles of their sections.
const SECTIONS: [(&str, &str); 9] = [
    ("small_contacts", "Small contacts and single spikes"),
    ("closing", "Near full contact"),
    ("flat_parts", "Flat regions, plateaus, equal peaks"),
    ("rubbers", "Relaxed and glassy limits"),
    ("scales", "Extreme scales"),
    ("grids", "Grid sizes and translations"),
    ("incompressible", "Incompressible rubber on the half-space"),
    ("finite_deformation", "Finite elements: nearly incompressible rubber, steep profiles"),
    ("wave_fits", "Ill-posed wave fits"),
];

const HEAD: &str = "\
# Hard cases
Contact problems and fits on which solvers often fail. Each case is a test with its own data (`tests/hard_cases`) that is solved
to the full residual and compared with an independent solution, or refused with a reason. The independent solution shares no
code with the first: it is exact, Lemke's complementary pivoting on the dense matrix, a scaled or translated copy of the same
problem, or another expression of the same number. The tests fail if a residual is above its tolerance (1e-10 of the half-space,
1e-8 of finite elements, gradient 1e-11 of the fits) or if the solutions differ by more than a bound justified in the test.

Numbers are the worst of all solves of a case. The condition number is that of the dense matrix on the contact set where
Lemke's method is the independent solution; of the operator on the full grid, in closed form, elsewhere on the half-space; the
ratio of bulk to shear modulus for finite elements; of the Jacobian for fits. Iterations are those of the active set on the
finest grid, Newton steps, or steps of the minimisation. Differences are relative, but for those of pressures (by the largest),
separations (by the height of the profile) and frictions that may vanish (absolute).

This page is written by the tests; do not edit it. A normal test run fails if a case is not listed or has another verdict:

    rm docs/hard_cases.md
    ASPERITY_UPDATE_HARD_CASES=1 cargo test --release --test hard_cases
";
const COLUMNS: &str = "\
| case | size | condition number | iterations | residual | independent solution | difference | verdict |
|---|---|---|---|---|---|---|---|
";

/// Tests run side by side; one at a time may write.
static DOCUMENT: Mutex<()> = Mutex::new(());

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/hard_cases.md")
}

/// Writes the row of a case in `file` if asked for, else demands that the document has one with the
/// same verdict. Its digits are round-off of another machine.
pub fn enter(file: &str, row: Row) {
    let stem = Path::new(file).file_stem().unwrap().to_str().unwrap();
    let section =
        SECTIONS.iter().position(|(name, _)| *name == stem).expect("a section for the file");
    let key = (section, row[0].clone(), row[1].clone());
    let _one_at_a_time = DOCUMENT.lock().unwrap_or_else(PoisonError::into_inner);
    let text = std::fs::read_to_string(path()).unwrap_or_default();
    let mut table = parse(&text);
    if std::env::var_os("ASPERITY_UPDATE_HARD_CASES").is_some() {
        table.insert(key, row);
        std::fs::write(path(), write(&table)).unwrap();
        return;
    }
    let word = |row: &Row| row[7].split(':').next().unwrap_or_default().to_owned();
    assert_eq!(
        table.get(&key).map(word),
        Some(word(&row)),
        "docs/hard_cases.md on `{}, {}`: regenerate it as its head says",
        row[0],
        row[1]
    );
}

fn parse(text: &str) -> Table {
    let mut table = Table::new();
    let mut section = 0;
    for line in text.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            section =
                SECTIONS.iter().position(|(_, known)| *known == title).expect("a known section");
        }
        let cells = line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned());
        let cells: Vec<String> = cells.collect();
        let is_row = line.starts_with("| ") && cells[0] != "case";
        if let (true, Ok(row)) = (is_row, Row::try_from(cells)) {
            table.insert((section, row[0].clone(), row[1].clone()), row);
        }
    }
    table
}

fn write(table: &Table) -> String {
    let mut text = HEAD.to_owned();
    for (index, (_, title)) in SECTIONS.iter().enumerate() {
        text += &format!("\n## {title}\n{COLUMNS}");
        for ((section, ..), row) in table {
            if *section == index {
                text += &format!("| {} |\n", row.join(" | "));
            }
        }
    }
    text
}

/// A case that is gone, or has another name, must not stay in the document.
#[test]
fn the_document_has_no_cases_but_those_of_the_tests() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard_cases");
    let source = |(file, _): &(&str, &str)| {
        std::fs::read_to_string(folder.join(file).with_extension("rs")).unwrap()
    };
    let sources: Vec<String> = SECTIONS.iter().map(source).collect();
    let _one_at_a_time = DOCUMENT.lock().unwrap_or_else(PoisonError::into_inner);
    let text = std::fs::read_to_string(path()).unwrap_or_default();
    for (section, case, _) in parse(&text).keys() {
        assert!(sources[*section].contains(&format!("\"{case}\"")), "no test makes `{case}`");
    }
}
