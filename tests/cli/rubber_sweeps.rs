//! `asperity rubber fit` of what laboratories send.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Outcome, asperity, asperity_at, project};

fn fit(sweep: &Path, options: &str) -> Outcome {
    asperity_at(&format!("rubber fit {{}} {options}"), sweep)
}

/// A file beside the project, if it is there.
fn shared(path: &str) -> Option<PathBuf> {
    let path = project("../shared").join(path);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

fn json(outcome: &Outcome) -> serde_json::Value {
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    serde_json::from_str(&outcome.stdout).unwrap()
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn glassy_sweeps_come_back_by_their_loss() {
    let Some(case) = shared("cases/12_glassy_sweeps_few_common_moduli/sweeps.csv") else { return };
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("a.toml").display().to_string();
    let options = format!("--kind youngs --reference-temperature-c 25 --json --to {to}");
    let outcome = fit(&case, &options);
    let json = json(&outcome);
    assert!(outcome.stderr.contains("joined by loss modulus and tan delta"), "{}", outcome.stderr);
    let shifts = json["shifts"].as_array().unwrap();
    assert_eq!(shifts.len(), 12);
    for shift in shifts {
        let difference = number(&shift["temperature_c"]) - 25.0;
        let right = -30.0 * difference / (190.0 + difference);
        let miss = (number(&shift["log10_shift"]) - right).abs();
        // E' of the coldest changes by less than it scatters, and its E'' is flat: it says so.
        let uncertain = shift["uncertain"] == true;
        assert_eq!(uncertain, difference == -60.0, "{shift}");
        assert!(uncertain || miss < 0.1, "{shift} {right}");
        let half = shift["confidence_95"].as_f64().unwrap_or_default();
        assert!(!uncertain || (miss < half && half > 1.0), "{shift} {right}");
    }
    assert!(outcome.stderr.contains("the shift factor at -35 °C is not determined"));
    let law = &json["laws"][0]["law"]["wlf"];
    // Over the measured range the law is the right one to 0.1 decades.
    for difference in [-52.5, -30.0, 22.5] {
        let of = |c1: f64, c2: f64| -c1 * difference / (c2 + difference);
        let miss = of(number(&law["c1"]), number(&law["c2_k"])) - of(30.0, 190.0);
        assert!(miss.abs() < 0.1, "{law} {difference}");
    }
}

#[test]
fn master_curves_with_given_factors_are_read() {
    for (name, reference) in [("S100", 39.96), ("S120", f64::NAN)] {
        let (Some(curve), Some(factors)) = (
            shared(&format!("validation/{name}_master_curve.txt")),
            shared(&format!("validation/{name}_shift_factors.txt")),
        ) else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let to = folder.path().join("r.toml").display().to_string();
        let factors = factors.display();
        let columns = "--columns frequency_hz=1,storage_pa=2,loss_pa=3";
        let options = format!("--kind youngs --shift-factors {factors} --json --to {to}");
        let by_header = fit(&curve, &options);
        let described = fit(&curve, &format!("{options} {columns} --force"));
        let (by_header, described) = (json(&by_header), json(&described));
        assert_eq!(by_header["terms"], described["terms"]);
        if reference.is_finite() {
            assert!((number(&described["reference_c"]) - reference).abs() < 0.01);
        }
        assert!(number(&described["misfit"]["storage_modulus"]["rms"]) < 0.15, "{described}");
        let friction = asperity(&format!(
            "solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3 --points 256 --rubber {to} --temperature-c 20"
        ));
        assert_eq!(friction.code, 0, "{}", friction.stderr);
    }
}

#[test]
fn a_vertical_shift_goes_into_the_rubber_and_its_other_temperatures() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // Moduli that grow with absolute temperature and shift by a decade in 20 K.
    let mut text = String::from("temperature_c,frequency_hz,storage_mpa,loss_mpa\n");
    for temperature in [0.0, 10.0, 20.0, 30.0, 40.0] {
        for k in 0..=12 {
            let frequency = 10_f64.powf(f64::from(k) / 4.0 - 1.0);
            let reduced = frequency * 10_f64.powf((20.0 - temperature) / 20.0);
            let factor = (temperature + 273.15) / 293.15;
            let (mut storage, mut loss) = (2.0, 0.0);
            for i in -3..=3 {
                let y = reduced * 10_f64.powi(i);
                storage += 2.0 * 1.5_f64.powi(-i) * y * y / (1.0 + y * y);
                loss += 2.0 * 1.5_f64.powi(-i) * y / (1.0 + y * y);
            }
            let (storage, loss) = (factor * storage, factor * loss);
            text += &format!("{temperature},{frequency},{storage},{loss}\n");
        }
    }
    fs::write(path("s.csv"), text).unwrap();
    let to = path("r.toml").display().to_string();
    let of = |vertical: &str| {
        let options = "--kind youngs --reference-temperature-c 20 --force --to";
        let outcome = fit(&path("s.csv"), &format!("{options} {to} --vertical-shift {vertical}"));
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        (outcome.stdout, fs::read_to_string(&to).unwrap())
    };
    let (table, text) = of("rho-t --expansion-per-k 0");
    assert!(table.contains("vertical factor") && table.contains(" 1.0682"), "{table}");
    assert!(text.contains("vertical = { rho_t = { expansion_per_k = 0e0 } }"), "{text}");
    // Full contact of a slow wave: the stiffness of the plateau, which grows by 313.15 / 293.15.
    let pressure = |celsius: u32| {
        let solve = "solve bem --wave 10:0.001 --speed 1e-6 --area 0.3 --points 256 --json --quiet";
        let outcome = asperity(&format!("{solve} --rubber {to} --temperature-c {celsius}"));
        number(&json(&outcome)["pressure_mpa"])
    };
    let ratio = pressure(40) / pressure(20);
    assert!((ratio - 313.15 / 293.15).abs() < 1e-3, "{ratio}");
    let (table, text) = of("free");
    assert!(table.contains("(T / T_r)^m with m"), "{table}");
    let exponent = text.split("power = { exponent = ").nth(1).unwrap().split(' ').next().unwrap();
    assert!((exponent.parse::<f64>().unwrap() - 1.0).abs() < 0.01, "{text}");
    let (table, text) = of("none");
    assert!(!text.contains("vertical") && !table.contains("vertical"), "{text}");
    let error = fit(&path("s.csv"), &format!("--kind youngs --expansion-per-k 1e-4 --to {to}"));
    assert!(error.error(2).contains("--vertical-shift rho-t"));
}

#[test]
fn a_rubber_in_pa_or_without_branches_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let rubber = folder.path().join("r.toml");
    let solve = "solve bem --wave 1:0.01 --pressure 0.1 --speed 10 --points 64";
    let warned = |text: &str| {
        fs::write(&rubber, text).unwrap();
        let outcome = asperity_at(&format!("{solve} --rubber {{}}"), &rubber);
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        outcome.stderr
    };
    let in_pa = "name = 't'\nequilibrium_modulus_mpa = 4e6\npoisson_ratio = 0.49\n";
    let text = warned(in_pa);
    assert!(text.contains("is 4000000, ") && text.contains("write 4"), "{text}");
    assert!(text.contains("has no branches"), "{text}");
    let branch = "[[branches]]\nmodulus_mpa = 2.0\nrelaxation_time_s = 1e-3\n";
    assert_eq!(warned(&(in_pa.replace("4e6", "4.0") + branch)), "");
}
