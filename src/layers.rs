//! The order of the modules: each imports from those below it alone, so that there is no circle.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Modules of the program, the lowest first. What the crates below it hold may be imported by all.
const PROGRAM: &[&str] = &[
    "text",
    "units",
    "requirement",
    "plot",
    "rubber",
    "artifact",
    "stages",
    "measurement",
    "recipe",
    "report",
    "validation",
    "pipeline",
    "sweep",
    "schemas",
    "forecast",
    "cutoff",
];

/// Modules of the mechanics, the lowest first.
const MECHANICS: &[&str] = &[
    "error_kind",
    "numerics",
    "surface",
    "rubber",
    "reference",
    "heat",
    "contact",
    "interface",
    "multiscale",
    "fem",
    "homogenisation",
    "theory",
    "water",
];

/// Every Rust file of a top module: `NAME.rs` and all in `NAME/`.
fn files_of(source: &Path, module: &str) -> Vec<PathBuf> {
    let file = source.join(format!("{module}.rs"));
    let mut files = files_below(&source.join(module));
    files.extend(Some(file).filter(|file| file.is_file()));
    files
}

/// Every Rust file of a folder and those in it.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut folders = vec![folder.to_owned()];
    let mut files = vec![];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    files
}

/// The names behind `crate::` in a text.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.split("crate::").skip(1).map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        &rest[..end.unwrap_or(rest.len())]
    })
}

/// Imports of a module from itself or from one above it, and modules that the order does not know.
fn upward(source: &Path, order: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (place, module) in order.iter().enumerate() {
        let files = files_of(source, module);
        assert!(!files.is_empty(), "{module} is no module of {}", source.display());
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            for name in imports(&text) {
                if order[place + 1..].contains(&name) {
                    found.insert(format!("{} imports {name}", file.display()));
                }
            }
        }
    }
    // The command line is a target of its own, which nothing can import.
    let outside = ["lib", "main", "cli", "layers"];
    let known = |name: &str| order.contains(&name) || outside.contains(&name);
    for entry in std::fs::read_dir(source).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if !known(&name) {
            found.insert(format!("{name} has no place in the order"));
        }
    }
    found
}

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn no_module_imports_from_one_above_it() {
    let none = BTreeSet::new();
    assert_eq!(upward(&project().join("src"), PROGRAM), none);
    assert_eq!(upward(&project().join("crates/core/src"), MECHANICS), none);
}

#[test]
fn an_import_upwards_and_an_unknown_module_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("low")).unwrap();
    write("low/mod.rs", "use crate::low::inside;\nuse crate::high::{A, B};\n");
    write("high.rs", "use crate::low;\n");
    write("box_in_the_hall.rs", "");
    let found = upward(folder.path(), &["low", "high"]);
    let found: Vec<&str> = found.iter().map(String::as_str).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].ends_with("low/mod.rs imports high"), "{found:?}");
    assert_eq!(found[1], "box_in_the_hall has no place in the order");
}

/// The mechanics run anywhere.
#[test]
fn the_mechanics_use_nothing_of_one_operating_system() {
    for module in MECHANICS {
        for file in files_of(&project().join("crates/core/src"), module) {
            let text = std::fs::read_to_string(&file).unwrap();
            assert!(!text.contains("std::os::"), "{}", file.display());
        }
    }
}

/// Figures look alike because one module draws them.
#[test]
fn only_the_plot_module_draws() {
    let library = concat!("plot", "ters");
    let folders = ["src", "crates", "tests", "benches", "examples"];
    let files = folders.iter().flat_map(|folder| files_below(&project().join(folder)));
    let (plot, others): (Vec<PathBuf>, Vec<PathBuf>) = files
        .filter(|file| std::fs::read_to_string(file).unwrap().contains(library))
        .partition(|file| file.starts_with(project().join("src/plot")));
    assert!(!plot.is_empty());
    assert_eq!(others, Vec::<PathBuf>::new());
}

/// What another operating system needs is in one module (`crates/files/src/os.rs`).
#[test]
fn the_operating_system_is_asked_in_one_place() {
    let mut files = files_of(&project().join("src"), "cli");
    files.extend(PROGRAM.iter().flat_map(|module| files_of(&project().join("src"), module)));
    let folder = |name: &str| std::fs::read_dir(project().join(name)).unwrap();
    files.extend(folder("crates/files/src").map(|entry| entry.unwrap().path()));
    let asks = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).unwrap();
        let in_code = code(&text).any(|line| line.contains("std::os::"));
        in_code && !file.components().any(|part| part.as_os_str() == "tests")
    };
    files.retain(asks);
    assert_eq!(files, [project().join("crates/files/src/os.rs")]);
}

/// Lines of code, without comments and what follows `#[cfg(test)]`.
fn code(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().take_while(|line| !line.starts_with("#[cfg(test)]"));
    lines.filter(|line| !line.trim_start().starts_with("//"))
}

/// Whether a line multiplies or divides by a thousand or a million.
fn changes_a_unit(line: &str) -> bool {
    ["1e3", "1e6", "1e9"].iter().any(|power| {
        line.match_indices(power).any(|(at, _)| {
            let (before, after) = (&line[..at], &line[at + power.len()..]);
            let whole = !after.starts_with(|c: char| c.is_alphanumeric() || c == '.');
            whole && (before.ends_with("* ") || before.ends_with("/ ") || after.starts_with(" *"))
        })
    })
}

/// Another place would convert another way, and change the last bit.
#[test]
fn quantities_change_their_unit_in_one_place() {
    let mut found = Vec::new();
    for module in PROGRAM.iter().chain(&["cli"]).filter(|module| **module != "units") {
        for file in files_of(&project().join("src"), module) {
            let text = std::fs::read_to_string(&file).unwrap();
            let lines = code(&text).filter(|line| changes_a_unit(line));
            found.extend(lines.map(|line| format!("{}: {line}", file.display())));
        }
    }
    assert_eq!(found, [""; 0]);
    assert!(changes_a_unit("a / 1e6,") && changes_a_unit("1e3 * x") && !changes_a_unit("1e3..2.0"));
}
