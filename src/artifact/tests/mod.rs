//! Artifacts through their public interface: what is written comes back to the bit, what is not
//! intact is refused by name.

mod arrays;
mod solves;
mod store;
mod table;

use super::Row;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One row with every type
/// a column can have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct Sample {
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pressure_mpa: f64,
    /// Friction coefficient, absent where
    /// the solve did not converge.
    #[schemars(extend("unit" = "1"))]
    friction: Option<f64>,
    /// Iterations.
    iterations: u32,
    /// Seed of the realisation.
    seed: u64,
    /// Offset of the window in points.
    #[schemars(extend("unit" = "points"))]
    offset: i64,
    /// Whether the solve converged.
    converged: bool,
    /// Name of the surface.
    surface: String,
    /// A remark.
    remark: Option<String>,
    /// Amplitudes of the waves.
    #[schemars(extend("unit" = "mm"))]
    amplitudes_mm: Vec<f64>,
    /// Wall time.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    elapsed_s: f64,
}

impl Row for Sample {
    const SCHEMA: &'static str = "asperity.test.samples";
    const VERSION: u32 = 2;
}

fn samples() -> Vec<Sample> {
    let first = Sample {
        pressure_mpa: 0.1 + 0.2,
        friction: Some(-0.0),
        iterations: u32::MAX,
        seed: u64::MAX,
        offset: i64::MIN,
        converged: true,
        surface: "Straße 07 – µ".into(),
        remark: Some(String::new()),
        amplitudes_mm: vec![f64::MIN_POSITIVE / 8.0, 1.0 / 3.0, f64::MAX],
        elapsed_s: 1.25,
    };
    let second = Sample {
        friction: None,
        converged: false,
        remark: None,
        amplitudes_mm: Vec::new(),
        ..first.clone()
    };
    vec![first, second]
}

/// Every file below a folder with its bytes, and every link with where it leads.
fn tree(folder: &std::path::Path) -> std::collections::BTreeMap<std::path::PathBuf, Vec<u8>> {
    let mut found = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_symlink() {
            let target = std::fs::read_link(&path).unwrap();
            found.insert(path, target.into_os_string().into_encoded_bytes());
        } else if path.is_dir() {
            found.extend(tree(&path));
        } else {
            let bytes = std::fs::read(&path).unwrap();
            found.insert(path, bytes);
        }
    }
    found
}
