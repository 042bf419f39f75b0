//! Rubber files with tables of moduli and shift factors, softening with strain, and the bundled generic rubbers.

use std::fs;
use std::path::Path;

use super::{Outcome, asperity, asperity_at, project};
use crate::common::Campaign;
use asperity::rubber::{Rubber, Viscoelastic, read_rubber_at, read_rubber_data};

/// The built-in rubber as a table, ten points a decade from 1 mHz to 1 GHz, and its rubber file.
fn table(folder: &Path, keys: &str) -> String {
    let rubber = Rubber::table_2_1();
    let mut text = String::from("frequency_hz,storage_mpa,loss_mpa\n");
    for k in -30..=90 {
        let hertz = 10_f64.powf(f64::from(k) / 10.0);
        let modulus = rubber.complex_modulus(std::f64::consts::TAU * hertz) / 1e6;
        text += &format!("{hertz:.9e},{:.9e},{:.9e}\n", modulus.re, modulus.im);
    }
    fs::write(folder.join("curve.csv"), text).unwrap();
    let toml = format!(
        "name = \"table\"\npoisson_ratio = 0.49\nmaster_curve = \"curve.csv\"\nmodulus_kind = \"youngs\"\n{keys}"
    );
    fs::write(folder.join("table.toml"), toml).unwrap();
    folder.join("table.toml").to_str().unwrap().to_owned()
}

fn friction(options: &str) -> f64 {
    let command =
        format!("solve bem --wave 0.0625:0.01867 --pressure 3.3 --speed 10 {options} --json");
    asperity(&command).json()["friction_coefficient"].as_f64().unwrap()
}

#[test]
fn a_table_has_the_friction_of_the_rubber_that_it_was_measured_on() {
    let folder = tempfile::tempdir().unwrap();
    let rubber = table(folder.path(), "");
    let exact = friction("--points 1024");
    let found = friction(&format!("--points 1024 --rubber {rubber}"));
    // Cubics between ten points a decade.
    approx::assert_relative_eq!(found, exact, max_relative = 2e-3);
    let wide = "--wave 8:0.2 --pressure 0.1 --speed 0.001 --points 256";
    // A warning of the extrapolation comes before the error.
    let refused = asperity(&format!("solve bem {wide} --rubber {rubber}"));
    assert_eq!((refused.code, refused.stdout.as_str()), (2, ""), "{}", refused.stderr);
    let said = |part: &str| refused.stderr.contains(part);
    assert!(said("not known at 1.250e-4 Hz") && said("\"hold\""), "{}", refused.stderr);
    let held = table(folder.path(), "extrapolate = \"hold\"\n");
    let outcome = asperity(&format!("solve bem {wide} --rubber {held}"));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("held at the values of the nearer end"), "{}", outcome.stderr);
}

#[test]
fn finite_deformation_refuses_a_table_and_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let rubber = table(folder.path(), "");
    let options = "--wave 0.0625:0.01867 --speed 10 --pressure 1";
    let refused = asperity(&format!("solve fem {options} --rubber {rubber}")).error(2);
    assert!(refused.contains("table.toml") && refused.contains("asperity rubber fit"), "{refused}");
    let to = folder.path().join("fitted.toml");
    let curve = folder.path().join("curve.csv");
    let fit = format!("rubber fit {{}} --kind youngs --to {}", to.display());
    asperity_at(&fit, &curve).result();
    let fitted = friction(&format!("--points 1024 --rubber {}", to.display()));
    // The fit finds the six branches of exact moduli.
    approx::assert_relative_eq!(fitted, friction("--points 1024"), max_relative = 1e-4);
}

#[test]
fn a_run_takes_a_table_and_its_report_shows_it() {
    let campaign = Campaign::new();
    let rubber = table(campaign.root(), "");
    campaign.edit("recipe.toml", "rubber = \"rubber.toml\"", "rubber = \"table.toml\"");
    let run = |arguments: &str| Outcome::of(&mut campaign.command(arguments));
    let outcome = run("run recipe.toml --out out");
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let report = run("report out --to report.html");
    assert_eq!(report.code, 0, "{}", report.stderr);
    assert!(campaign.read("report.html").contains("a table of 121 moduli"));
    // Another row of the table makes the contacts stale.
    let curve = campaign.read("curve.csv");
    let row = curve.lines().nth(60).unwrap().to_owned();
    let changed = row.replace(row.split(',').nth(1).unwrap(), "9.0");
    campaign.edit("curve.csv", &row, &changed);
    let status = run("status recipe.toml --out out").result();
    assert!(status.contains("bem           stale: bem.rubber"), "{status}");
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + "\n[micro]\n"));
    let refused = run("run recipe.toml --out other").error(2);
    assert!(refused.contains("asperity rubber fit") && refused.contains("table.toml"), "{refused}");
    assert!(fs::metadata(&rubber).is_ok());
}

#[test]
fn summaries_tell_of_moduli_and_of_rows_that_are_not_causal() {
    let folder = tempfile::tempdir().unwrap();
    let rubber = table(folder.path(), "");
    let outcome = asperity(&format!("rubber summary {rubber}"));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stderr.is_empty(), "{}", outcome.stderr);
    assert!(outcome.stdout.contains("table of 121 moduli"), "{}", outcome.stdout);
    let json = asperity(&format!("rubber summary {rubber} --json")).json();
    assert_eq!(json["causality"]["points"].as_array().unwrap().len(), 121);
    let curve = fs::read_to_string(folder.path().join("curve.csv")).unwrap();
    let row = curve.lines().nth(61).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let loss = 0.3 * cells[2].parse::<f64>().unwrap();
    let bad = curve.replace(row, &format!("{},{},{loss}", cells[0], cells[1]));
    fs::write(folder.path().join("curve.csv"), bad).unwrap();
    let outcome = asperity(&format!("rubber summary {rubber}"));
    let warned =
        outcome.stderr.contains("Kramers-Kronig") && outcome.stderr.contains("1.000e3 Hz (-");
    assert!(warned, "{}", outcome.stderr);
}

#[test]
fn strain_sweeps_become_a_section_of_a_rubber_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut text = String::from("temperature_c,frequency_hz,strain,storage_mpa,loss_mpa\n");
    for celsius in [10.0, 50.0] {
        for k in 0..14 {
            let strain = 0.01 * 10_f64.powf(f64::from(k) / 4.0);
            let broken = (strain / 1.5_f64).powf(1.2);
            let storage = 0.2 + 0.8 / (1.0 + broken);
            let loss = 0.3 + (0.7 + 0.5 * broken.sqrt()) / (1.0 + broken);
            text += &format!("{celsius},1,{strain:.6},{:.6},{:.6}\n", 12.0 * storage, 1.8 * loss);
        }
    }
    fs::write(path("strain.csv"), text).unwrap();
    let fit =
        |options: &str| asperity_at(&format!("rubber payne {{}} {options}"), &path("strain.csv"));
    assert!(fit("--strain-kind elongation").error(2).contains("strain_percent"));
    let section = path("payne.toml");
    let options = format!(
        "--strain-kind elongation --strain-unit percent --law kraus --to {}",
        section.display()
    );
    let json = fit(&format!("{options} --json")).json();
    for row in json.as_array().unwrap() {
        let number = |key: &str| row[key].as_f64().unwrap();
        // The file has seven digits.
        for (key, exact) in [
            ("critical_strain", 0.015),
            ("exponent", 0.6),
            ("storage_limit", 0.2),
            ("loss_limit", 0.3),
            ("loss_peak", 0.25),
        ] {
            approx::assert_relative_eq!(number(key), exact, max_relative = 1e-3);
        }
        assert!(number("storage_rms") < 1e-5 && number("own_loss_rms") > 0.05, "{row}");
    }
    assert!(fit(&options).error(2).contains("exists already"));
    let rubber = fs::read_to_string(project("data/rubber/example_wlf.toml")).unwrap();
    fs::write(path("r.toml"), rubber + &fs::read_to_string(&section).unwrap()).unwrap();
    let law = read_rubber_at(path("r.toml"), Some(30.0)).unwrap().payne_law().unwrap();
    approx::assert_relative_eq!(law.storage_factor(0.015), 0.6, max_relative = 1e-3);
    let table = fit("--strain-kind elongation --strain-unit percent").result();
    assert!(table.contains("rms of E'"), "{table}");
    // The largest strains are 18 % and stand as 17.8.
    let fraction = fit("--strain-kind elongation --strain-unit fraction").error(2);
    assert!(fraction.contains("strain.csv, line") && fraction.contains("--strain-unit percent"));
    let text = fs::read_to_string(path("strain.csv")).unwrap();
    let swapped = text.replace("storage_mpa,loss_mpa", "loss_mpa,storage_mpa");
    fs::write(path("strain.csv"), swapped).unwrap();
    let warned = fit("--strain-kind elongation --strain-unit percent").stderr;
    assert!(
        warned.contains("at every strain at 10 °C") && warned.contains("exchanged"),
        "{warned}"
    );
}

#[test]
fn a_header_with_the_symbol_of_the_other_modulus_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = table(folder.path(), "");
    let curve = folder.path().join("curve.csv");
    let text = fs::read_to_string(&curve).unwrap();
    fs::write(&curve, text.replace("storage_mpa,loss_mpa", "G'/MPa,G''/MPa")).unwrap();
    let refused = asperity(&format!("rubber summary {file}")).error(2);
    for part in ["curve.csv", "`G'/MPa` names a shear modulus", "modulus_kind = \"shear\""] {
        assert!(refused.contains(part), "{part}: {refused}");
    }
    let toml = fs::read_to_string(&file).unwrap();
    fs::write(&file, toml.replace("youngs", "shear")).unwrap();
    let shear = read_rubber_data(&file).unwrap();
    let youngs = Rubber::table_2_1().complex_modulus(10.0);
    // E = 2 (1 + 0.49) G; cubics between ten points a decade.
    let found = shear.rubber.complex_modulus(10.0);
    approx::assert_relative_eq!(found.re, 2.98 * youngs.re, max_relative = 2e-3);
}

#[test]
fn the_bundled_generic_rubbers_say_so_and_are_plausible() {
    let mut found = 0;
    for entry in fs::read_dir(project("data/rubber")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if !name.starts_with("generic_") {
            continue;
        }
        found += 1;
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("# GENERIC, NOT A MEASUREMENT"), "{name}");
        assert!(text.contains("source = \"generic, not a measurement"), "{name}");
        let data = read_rubber_data(&path).unwrap();
        assert_eq!(data.oddities(), [""; 0], "{name}");
        let rubber = data.rubber.maxwell().unwrap();
        let modulus = rubber.complex_modulus(std::f64::consts::TAU);
        assert!((1e6..12e6).contains(&modulus.re), "{name} {modulus}");
        assert!((1e9..4e9).contains(&rubber.glassy_modulus()), "{name}");
        // Colder is stiffer.
        let cold = data.at_temperature(-10.0).unwrap().rubber.maxwell().unwrap().clone();
        assert!(cold.complex_modulus(10.0).re > rubber.complex_modulus(10.0).re, "{name}");
        let summary = asperity(&format!("rubber summary {}", path.display())).result();
        assert!(summary.contains("Generic"), "{summary}");
    }
    assert_eq!(found, 3);
}
