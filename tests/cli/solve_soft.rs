//! `asperity solve soft`.

use super::asperity_at;
use serde_json::Value;

const CONTACT: &str = "solve soft --wave 0.25:0.012 --wave 1:0.02:1 --pressure 0.3 --speed 10 --points 256 --rubber {}";

/// A generic rubber with two laws of softening in place of its own.
fn rubber(folder: &tempfile::TempDir, section: &str) -> std::path::PathBuf {
    let path = folder.path().join("tread.toml");
    let plain = std::fs::read_to_string(super::project("data/rubber/table_2_1.toml")).unwrap();
    // A section of its own may stand anywhere but behind `[[branches]]`, which it would end.
    std::fs::write(&path, plain + "\n" + section).unwrap();
    path
}

const SOFTENING: &str = "[payne]\nstrain_kind = 'elongation'\n[[payne.table]]\nstrain = [0.001, 0.01, 0.1, 1.0]\n\
     storage_factor = [1.0, 0.8, 0.5, 0.3]\nloss_factor = [1.0, 1.1, 0.7, 0.4]\n";

#[test]
fn a_rubber_that_softens_has_more_area_and_one_that_does_not_has_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = format!("{CONTACT} --json");
    let soft = asperity_at(&arguments, &rubber(&folder, SOFTENING)).json();
    let of = |result: &Value, side: &str, key: &str| result[side][key].as_f64().unwrap();
    let area = |side: &str| of(&soft, side, "contact_area_fraction");
    assert!(area("softened") > 1.1 * area("small_strain"), "{soft}");
    // Each wave has the factors of its own strain; they lie between the rows of the table.
    let list = |key: &str| -> Vec<f64> {
        soft[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (strain, storage) = (list("wave_strain"), list("wave_storage_factor"));
    assert_eq!(strain.len(), storage.len());
    assert!(strain.iter().all(|strain| *strain > 0.0), "{strain:?}");
    assert!(storage.iter().all(|f| (0.3..=1.0).contains(f)), "{storage:?}");
    // The last step may have changed factors by the tolerance.
    let largest = soft["largest_strain"].as_f64().unwrap();
    assert_eq!(largest, strain.iter().copied().fold(0.0, f64::max));

    let stiff = SOFTENING
        .replace("0.8, 0.5, 0.3", "1.0, 1.0, 1.0")
        .replace("1.1, 0.7, 0.4", "1.0, 1.0, 1.0");
    let same = asperity_at(&arguments, &rubber(&folder, &stiff)).json();
    for key in ["friction_coefficient", "contact_area_fraction"] {
        assert_eq!(of(&same, "softened", key), of(&same, "small_strain", key));
        // Without softening both commands solve one contact.
        let bem = arguments.replace("solve soft", "solve bem");
        let bem = asperity_at(&bem, &rubber(&folder, &stiff)).json();
        assert_eq!(of(&same, "softened", key), bem[key].as_f64().unwrap());
    }
}

#[test]
fn a_rubber_without_strain_sweeps_is_refused_and_a_strain_beyond_them_told() {
    let folder = tempfile::tempdir().unwrap();
    let error = asperity_at(CONTACT, &rubber(&folder, "")).error(2);
    assert!(
        error.contains("section [payne]") && error.contains("asperity rubber payne"),
        "{error}"
    );
    let short = SOFTENING.replace("0.001, 0.01, 0.1, 1.0", "0.0001, 0.001, 0.002, 0.003");
    let outcome = asperity_at(CONTACT, &rubber(&folder, &short));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("warning") && outcome.stderr.contains("up to 0.003"),
        "{}",
        outcome.stderr
    );
    assert!(outcome.stdout.contains("friction, softened"));
}
