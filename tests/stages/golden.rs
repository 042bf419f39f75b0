//! The friction of the smoke recipe as it was.

use super::run;
use asperity::artifact::RunView;
use asperity::recipe::Recipe;
use asperity::stages::tables::{FRICTION, FrictionRow};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How the file was made, and what a change means.
const COMMENT: &str = "\
# Friction of pipelines/smoke.toml, made by this program itself:
#     ASPERITY_UPDATE_GOLDEN=1 cargo test --release --test stages golden
# Other numbers here need a raised REVISION of the stage that gives them (src/stages) or, for the
# contact solver, a raised SOLVER_REVISION (src/stages/bem/curve.rs): otherwise results that users
# have count as up to date although they are not.
";

#[derive(Debug, Serialize, Deserialize)]
struct Golden {
    waves: u32,
    speed_mm_s: f64,
    contact_area_fraction: f64,
    realisation: u32,
    friction_coefficient: f64,
    pressure_mpa: f64,
}

fn smoke() -> Vec<Golden> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let recipe = Recipe::read(&project.join("pipelines/smoke.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    run(&recipe, folder.path());
    let rows = RunView::of(folder.path()).rows(FRICTION).unwrap();
    let each = |row: FrictionRow| {
        let golden = move |(realisation, friction_coefficient)| Golden {
            waves: row.kind.waves,
            speed_mm_s: row.speed_mm_s,
            contact_area_fraction: row.contact_area_fraction,
            realisation,
            friction_coefficient,
            pressure_mpa: row.pressure_mpa,
        };
        (1..).zip(row.realisations).map(golden).collect::<Vec<_>>()
    };
    rows.into_iter().flat_map(each).collect()
}

#[test]
fn the_smoke_recipe_gives_its_golden_values() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stages/golden/smoke.csv");
    let found = smoke();
    if std::env::var_os("ASPERITY_UPDATE_GOLDEN").is_some() {
        let mut writer = csv::Writer::from_writer(Vec::from(COMMENT));
        found.iter().for_each(|row| writer.serialize(row).unwrap());
        std::fs::write(&path, writer.into_inner().unwrap()).unwrap();
        return;
    }
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).unwrap();
    let golden: Vec<Golden> = reader.deserialize().collect::<Result<_, _>>().unwrap();
    assert_eq!(found.len(), golden.len(), "{COMMENT}");
    for (found, golden) in found.iter().zip(&golden) {
        let name = |g: &Golden| (g.waves, g.speed_mm_s, g.contact_area_fraction, g.realisation);
        assert_eq!(name(found), name(golden));
        // Solves are iterated to 1e-10 of the pressure; other machines round differently.
        let near = |a: f64, b: f64| (a / b - 1.0).abs() <= 1e-9;
        assert!(
            near(found.friction_coefficient, golden.friction_coefficient)
                && near(found.pressure_mpa, golden.pressure_mpa),
            "{found:?} instead of {golden:?}\n{COMMENT}"
        );
    }
}
