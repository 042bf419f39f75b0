//! `asperity rubber fit`, and friction at another temperature.

use std::fs;
use std::path::Path;

use super::{Outcome, asperity, asperity_at, project};

const SWEEPS: &str = "data/rubber/table_2_1_sweeps.csv";

fn fit(sweep: &Path, options: &str) -> Outcome {
    asperity_at(&format!("rubber fit {{}} --kind youngs {options}"), sweep)
}

/// A fitted rubber in a new folder.
fn fitted() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let rubber = folder.path().join("tread.toml").to_str().unwrap().to_owned();
    fit(&project(SWEEPS), &format!("--reference-temperature-c 20 --to {rubber}")).result();
    (folder, rubber)
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn sweeps_at_temperatures_become_a_rubber_with_its_law() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let options =
        format!("--reference-temperature-c 20 --to {} --plot {}", path("r.toml"), path("r.svg"));
    let json = fit(&project(SWEEPS), &format!("{options} --json")).json();
    assert_eq!((json["terms"].as_array().unwrap().len(), &json["points"]), (6, &152.into()));
    let law = &json["laws"][0]["law"]["wlf"];
    let half = |k: usize| number(&json["laws"][0]["confidence_95"][k]);
    // Twice the interval, which one of twenty truths leaves.
    assert!((number(&law["c1"]) - 8.86).abs() < 2.0 * half(0), "{}", json["laws"]);
    assert!((number(&law["c2_k"]) - 101.6).abs() < 2.0 * half(1), "{}", json["laws"]);
    // Noise of 2 %, less what the fit takes of it.
    for modulus in ["storage_modulus", "loss_modulus"] {
        let rms = number(&json["misfit"][modulus]["rms"]);
        assert!((0.015..0.025).contains(&rms), "{modulus} {rms}");
    }
    assert!(fs::read_to_string(path("r.svg")).unwrap().contains("shift factor"));
    let text = fs::read_to_string(path("r.toml")).unwrap();
    assert!(text.contains("reference_c = 20.0") && text.contains("wlf = { c1 = "), "{text}");

    let refused = fit(&project(SWEEPS), &options).error(2);
    assert!(refused.contains("r.toml exists already") && refused.contains("--force"), "{refused}");
    let table = fit(&project(SWEEPS), &format!("{options} --force")).result();
    assert!(table.contains("error of tan delta") && table.contains("\nWLF "), "{table}");
}

#[test]
fn another_temperature_is_another_speed() {
    let (_folder, rubber) = fitted();
    let text = fs::read_to_string(&rubber).unwrap();
    let law = text.lines().find(|line| line.starts_with("wlf")).unwrap();
    let numbers: Vec<f64> =
        law.split(['=', ',', '}']).filter_map(|part| part.trim().parse().ok()).collect();
    let [c1, c2] = numbers[..] else { panic!("{law}") };
    let factor = 10_f64.powf(-c1 * -15.0 / (c2 - 15.0));
    let friction = |options: &str| {
        let command =
            format!("solve bem --wave 0.0625:0.01867 --pressure 3.3 --points 1024 {options}");
        number(
            &asperity(&format!("{command} --rubber {rubber} --json")).json()["friction_coefficient"],
        )
    };
    let cold = friction("--speed 10 --temperature-c 5");
    let fast = friction(&format!("--speed {}", 10.0 * factor));
    // The half-space knows relaxation times only as products with the speed: residuals of 1e-10.
    approx::assert_relative_eq!(cold, fast, max_relative = 1e-9);
    let reference = friction("--speed 10 --temperature-c 20");
    assert!((cold - reference).abs() > 0.01 * reference, "{cold} {reference}");
}

#[test]
fn shear_moduli_and_units_give_the_same_rubber() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let text = fs::read_to_string(project(SWEEPS)).unwrap();
    let mut shear = String::from("temperature_c,loss_pa,storage_kpa,angular_frequency_rad_s\n");
    for line in text.lines().skip(3) {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let [frequency, storage, loss, temperature] = numbers[..] else { panic!("{line}") };
        let (angular, shear_storage) = (std::f64::consts::TAU * frequency, storage * 1e3 / 3.0);
        shear += &format!("{temperature},{},{shear_storage},{angular}\n", loss * 1e6 / 3.0);
    }
    fs::write(path("shear.csv"), shear).unwrap();
    let of = |sweep: &Path, kind: &str| {
        let options = "--poisson-ratio 0.5 --json --force --to";
        let to = path("r.toml").to_str().unwrap().to_owned();
        asperity_at(&format!("rubber fit {{}} --kind {kind} {options} {to}"), sweep).json()
    };
    let (young, shear) = (of(&project(SWEEPS), "youngs"), of(&path("shear.csv"), "shear"));
    for k in 0..6 {
        let modulus = |json: &serde_json::Value| number(&json["terms"][k]["modulus"]["value"]);
        // What rounding of the input becomes where the optimiser stops.
        approx::assert_relative_eq!(modulus(&young), modulus(&shear), max_relative = 1e-6);
    }
}

#[test]
fn what_is_extrapolated_is_warned_of() {
    let (folder, rubber) = fitted();
    let solve = |options: &str| {
        let command = "solve bem --wave 1:0.01 --pressure 3 --points 256";
        let outcome = asperity(&format!("{command} --rubber {rubber} {options}"));
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        outcome.stderr
    };
    assert_eq!(solve("--speed 10"), "");
    let slow = solve("--speed 0.01");
    assert!(slow.contains("from 1.000e-2 to 1.000e-2 Hz") && slow.contains("below that range"));
    let hot = solve("--speed 1000 --temperature-c 45");
    assert!(hot.contains("45 °C is outside the -30 to 20 °C"), "{hot}");
    assert!(solve("--speed 0.01 --quiet").is_empty());

    let arguments = "solve bem --wave 1:0.01 --pressure 3 --speed 10 --temperature-c";
    let error = asperity(&format!("{arguments} -90 --rubber {rubber}")).error(2);
    assert!(error.contains("WLF equation has no shift factor at -90 °C"), "{error}");
    let error = asperity_at(
        &format!("{arguments} 40 --rubber {{}}"),
        &project("data/rubber/table_2_1.toml"),
    );
    assert!(error.error(2).contains("no [temperature] section"));
    assert!(asperity(&format!("{arguments} 40")).error(2).contains("--rubber"));

    // A glass transition whose rubbery plateau was not measured.
    let sweep = folder.path().join("transition.csv");
    let mut text = String::from("frequency_hz,storage_mpa,loss_mpa\n");
    for k in -4..=8 {
        let frequency = 10_f64.powf(f64::from(k) / 4.0);
        let (storage, loss) = (100.0 * frequency.powf(0.4), 70.0 * frequency.powf(0.4));
        text += &format!("{frequency},{storage},{loss}\n");
    }
    fs::write(&sweep, text).unwrap();
    let outcome = fit(&sweep, &format!("--to {}", folder.path().join("t.toml").display()));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("limit of slow loading"), "{}", outcome.stderr);
}

#[test]
fn bad_sweeps_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let (sweep, rubber) = (folder.path().join("sweep.csv"), folder.path().join("r.toml"));
    let header = "frequency_hz,storage_mpa,loss_mpa\n";
    let two_temperatures = "frequency_hz,storage_mpa,loss_mpa,temperature_c\n\
        1,2,1,20\n10,3,1,20\n100,4,1,20\n1,20,1,0\n10,30,1,0\n100,40,1,0\n";
    let cases = [
        ("", "there is no header"),
        (header, "there are no rows"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,1\n", "one point only"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,1\n10,NaN,1\n", "line 3: storage_mpa is NaN"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,1\n10,inf,1\n", "line 3: storage_mpa is inf"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,-1\n10,2,1\n", "line 2: loss_mpa is -1"),
        ("frequency_hz,storage_mpa,loss_mpa\n0,2,1\n10,2,1\n", "line 2: frequency_hz is 0"),
        (
            "frequency_hz,storage_mpa,loss_mpa\n1,2,1\n\n1.0,2,1\n",
            "line 4: the frequency 1.0 is given",
        ),
        ("frequency_hz,storage_mpa,loss_mpa\nHz,MPa,MPa\n", "there are no rows"),
        ("frequency_hz,storage_mpa,loss_mpa\nHz,kPa,MPa\n", "is in MPa and the row below says kPa"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,\n2,3,1\n", "line 2: loss_mpa is ``"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2,5,1\n", "line 2: 4 values where the header has 3"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,5,2,1\n", "4 values where the header has 3"),
        ("frequency_hz;storage_mpa;loss_mpa\n1;1.234,5;1\n", "line 2: `1.234,5` has a comma"),
        ("frequency,storage_mpa,loss_mpa\n1,2,1\n", "`frequency` has no unit that is known"),
        ("f_hz,E' [mPa],E'' [mPa]\n1,2,1\n", "has no unit that is known"),
        ("storage_mpa,loss_mpa\n2,1\n", "no column of the frequency"),
        ("frequency_hz,storage_mpa\n1,2\n", "no column of the loss modulus"),
        (
            "strain,frequency_hz,storage_mpa,loss_mpa\n1,1,2,1\n2,1,2,1\n",
            "line 3: the frequency 1 is given here for the second time: this looks like a strain sweep",
        ),
        ("frequency_hz,storage_mpa,loss_mpa,temperature_c\n1,2,1,-300\n", "absolute zero"),
        ("frequency_hz,storage_mpa,loss_mpa,loss_pa\n1,2,1,1\n", "2 columns of the loss modulus"),
        ("frequency_hz,storage_mpa,loss_mpa\n1,2e20,1\n2,3,1\n", "check the number and its unit"),
        (two_temperatures, "the sweeps at 0 °C"),
    ];
    for (text, part) in cases {
        fs::write(&sweep, text).unwrap();
        let error = fit(&sweep, &format!("--to {}", rubber.display())).error(2);
        assert!(error.contains("sweep.csv") && error.contains(part), "{text}: {error}");
    }
    fs::write(&sweep, [0xff, 0xfe, 0x00]).unwrap();
    let error = fit(&sweep, &format!("--to {}", rubber.display())).error(2);
    assert!(error.contains("there is no header"), "{error}");
    fs::write(&sweep, [0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1]).unwrap();
    let error = fit(&sweep, &format!("--to {}", rubber.display())).error(2);
    assert!(error.contains("(.xls)") && error.contains("save it as .xlsx"), "{error}");
    let error =
        fit(&folder.path().join("none.csv"), &format!("--to {}", rubber.display())).error(2);
    assert!(error.contains("cannot read the sweeps"), "{error}");
    assert!(!rubber.exists());
}

#[test]
fn bad_options_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let rubber = folder.path().join("r.toml");
    let to = format!("--to {}", rubber.display());
    let cases = [
        ("--terms 0", "--terms is 0"),
        ("--terms 152", "152 points are too few"),
        ("--poisson-ratio 0.6", "--poisson-ratio is 0.6"),
        ("--reference-temperature-c 5", "choose one of [-30, -25, -20, -15, -10, 0, 10, 20] °C"),
        ("--reference-temperature-c nan", "not a finite number"),
    ];
    for (options, part) in cases {
        let error = fit(&project(SWEEPS), &format!("{options} {to}")).error(2);
        assert!(error.contains(part), "{options}: {error}");
    }
    let error = fit(&project(SWEEPS), &format!("{to} --plot {}", rubber.display())).error(2);
    assert!(error.contains("the same file"), "{error}");
    let sweeps = folder.path().join("sweeps.csv");
    fs::copy(project(SWEEPS), &sweeps).unwrap();
    let error = fit(&sweeps, &format!("--force --to {}", sweeps.display())).error(2);
    assert!(error.contains("is the measured sweep"), "{error}");
    let error = asperity_at(&format!("rubber fit {{}} {to}"), &project(SWEEPS)).error(2);
    assert!(error.contains("--kind <KIND>"), "{error}");
    let plain = "frequency_hz,storage_mpa,loss_mpa\n1,2,1\n10,3,1\n100,4,1\n";
    fs::write(&sweeps, plain).unwrap();
    let error = fit(&sweeps, &format!("{to} --reference-temperature-c 20")).error(2);
    assert!(error.contains("no column temperature_c"), "{error}");
    assert!(!rubber.exists());
}
