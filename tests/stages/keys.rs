//! The keys under which results are known, as they were: a change of the code that changes one makes all results of that
//! stage stale.

use asperity::pipeline;
use asperity::recipe::Recipe;
use serde::{Deserialize, Serialize};
use std::path::Path;

const COMMENT: &str = "\
# Keys of the stages of bundled recipes before anything is computed, made by this program itself:
#     ASPERITY_UPDATE_GOLDEN=1 cargo test --release --test stages keys
# Another key here makes results that users have count as stale. That is right where a number changes, with a raised
# REVISION, and wrong where the code has only moved.
";

/// The scans of captif are not bundled.
const RECIPES: [&str; 5] = ["asphalt", "captif", "verification", "smoke", "sweep"];

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Key {
    recipe: String,
    stage: String,
    key: String,
}

/// Returns the keys of the stages of a recipe, or of its first case; `None` if its scans are missing.
fn keys(name: &str) -> Option<Vec<Key>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(format!("{name}.toml"));
    let mut recipe = Recipe::read(&path).unwrap();
    if recipe.sweep.is_some() {
        recipe = recipe.cases().unwrap().swap_remove(0).recipe;
    }
    let scans = recipe.ingest.iter().flat_map(|ingest| &ingest.scans);
    if let Some(absent) = scans.into_iter().find(|scan| !scan.exists()) {
        println!("skipped: {name}, {} is not there", absent.display());
        return None;
    }
    let nowhere = tempfile::tempdir().unwrap();
    let identities = pipeline::identities(&recipe, nowhere.path()).unwrap();
    let key = |identity: &asperity::artifact::Identity| Key {
        recipe: name.into(),
        stage: identity.stage.clone(),
        key: identity.key().to_string(),
    };
    Some(identities.iter().map(key).collect())
}

#[test]
fn bundled_recipes_have_their_keys() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stages/golden/keys.csv");
    let found = RECIPES.map(|name| (name, keys(name)));
    if std::env::var_os("ASPERITY_UPDATE_GOLDEN").is_some() {
        let mut writer = csv::Writer::from_writer(Vec::from(COMMENT));
        let all = found.iter().flat_map(|(name, keys)| keys.as_ref().expect(name));
        all.for_each(|key| writer.serialize(key).unwrap());
        std::fs::write(&path, writer.into_inner().unwrap()).unwrap();
        return;
    }
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).unwrap();
    let golden: Vec<Key> = reader.deserialize().collect::<Result<_, _>>().unwrap();
    for (name, found) in found {
        let Some(found) = found else { continue };
        let golden: Vec<&Key> = golden.iter().filter(|key| key.recipe == name).collect();
        assert_eq!(found.iter().collect::<Vec<_>>(), golden);
    }
}
