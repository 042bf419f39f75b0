//! Rubber files with tables, as the library reads them.

use asperity::rubber::causality::{CausalPoint, Causality};
use asperity::rubber::payne::PayneCurve;
use asperity::rubber::{
    Extrapolation, FrequencyRange, RubberData, Viscoelastic, parse_rubber_data, read_rubber,
    read_rubber_data, to_toml,
};
use std::error::Error;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

const TABLE: &str = "name = 'tread'\npoisson_ratio = 0.5\nmodulus_kind = 'youngs'\n\
    [[moduli]]\nfrequency_hz = 1.0\nstorage_mpa = 5.0\nloss_mpa = 0.5\n\
    [[moduli]]\nfrequency_hz = 100.0\nstorage_mpa = 7.0\nloss_mpa = 0.9\n";

fn parse(text: &str) -> Result<RubberData, String> {
    parse_rubber_data(Path::new("tread.toml"), text).map_err(|error| {
        let source = error.source().map(ToString::to_string);
        format!("{error}: {}", source.unwrap_or_default())
    })
}

fn with(text: &str, before: &str) -> String {
    TABLE.replacen("[[moduli]]", &format!("{text}\n[[moduli]]"), 1) + before
}

#[test]
fn a_table_in_the_file_is_a_rubber() {
    let data = parse(TABLE).unwrap();
    let modulus = data.rubber.complex_modulus(TAU * 100.0);
    approx::assert_relative_eq!(modulus.re, 7e6, max_relative = 1e-12);
    approx::assert_relative_eq!(modulus.im, 0.9e6, max_relative = 1e-12);
    assert_eq!(data.measured, Some(FrequencyRange { lowest_hz: 1.0, highest_hz: 100.0 }));
    // Shear moduli of an incompressible solid are a third.
    let shear = parse(&TABLE.replace("youngs", "shear")).unwrap();
    let three = shear.rubber.complex_modulus(TAU).re / data.rubber.complex_modulus(TAU).re;
    approx::assert_relative_eq!(three, 3.0, max_relative = 1e-12);
    let wide = FrequencyRange { lowest_hz: 0.1, highest_hz: 10.0 };
    assert!(data.rubber.require(wide).is_err());
    let held = parse(&with("extrapolate = 'hold'", "")).unwrap();
    held.rubber.require(wide).unwrap();
    let warnings = held.extrapolations(Some(wide));
    assert!(warnings[0].contains("held at the values of the nearer end"), "{warnings:?}");
}

#[test]
fn keys_that_do_not_go_together_are_named() {
    for (text, part) in [
        (TABLE.replace("modulus_kind = 'youngs'\n", ""), "modulus_kind is missing"),
        (with("equilibrium_modulus_mpa = 4.0", ""), "equilibrium_modulus_mpa is for a Maxwell"),
        (with("measured_hz = [1.0, 2.0]", ""), "frequencies of its rows"),
        (with("master_curve = 'x.csv'", ""), "keep one of them"),
        (with("columns = 'storage_pa=2'", ""), "columns describes"),
        (TABLE.replace("0.9", "-0.9"), "loss_mpa of [[moduli]] 2 is -0.9"),
        (with("points_per_decade = 0.0", ""), "points_per_decade is 0"),
        (TABLE[..TABLE.find("[[moduli]]\nfrequency_hz = 100").unwrap()].into(), "at 1 point(s)"),
        ("name = 'a'\npoisson_ratio = 0.5\n".into(), "or a table of moduli in its place"),
        (
            "name = 'a'\npoisson_ratio = 0.5\nequilibrium_modulus_mpa = 1.0\nextrapolate = 'hold'"
                .into(),
            "extrapolate is for a table",
        ),
        (
            with(
                "[temperature]\nreference_c = 20.0\n[[temperature.shift]]\ntemperature_c = 20.0\nlog10_shift = 0.0",
                "",
            ),
            "has 1 row",
        ),
        (with("[payne]\nstrain_kind = 'shear'", ""), "must have one of"),
    ] {
        let message = parse(&text).unwrap_err();
        assert!(message.contains("tread.toml") && message.contains(part), "{part}: {message}");
    }
}

/// A folder with a rubber file beside its tables.
fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("tread.toml");
    (folder, path)
}

const FILES: &str = "name = 'tread'\npoisson_ratio = 0.5\nmaster_curve = 'curve.csv'\nmodulus_kind = 'youngs'\n\
    [temperature]\nshift_factors = 'shifts.txt'\n[payne]\nstrain_kind = 'shear'\nstrain_unit = 'percent'\n\
    strain_sweep = 'strain.csv'\n";

fn strain_rows() -> String {
    let mut text = String::from("temperature_c,strain,storage_mpa,loss_mpa\n");
    for celsius in [10, 50] {
        for k in 0..12 {
            let strain = 0.01 * 10_f64.powf(f64::from(k) / 4.0);
            let storage = 3.0 + 9.0 / (1.0 + strain);
            text += &format!("{celsius},{strain:.6},{storage:.6},{:.6}\n", 0.15 * storage);
        }
    }
    text
}

#[test]
fn files_beside_the_rubber_are_read_and_written_into_one() {
    let curve = "frequency_hz,storage_mpa,loss_mpa\n10,6,0.7\n1,5,0.5\n10,6.4,0.74\n1000,9,1.5\n";
    let shifts = "temperature_c log10_shift\n20 0\n0 2.1\n40 -1.4\n";
    let strain = strain_rows();
    let files = [
        ("tread.toml", FILES),
        ("curve.csv", curve),
        ("shifts.txt", shifts),
        ("strain.csv", strain.as_str()),
    ];
    let (_folder, path) = folder(&files);
    let data = read_rubber_data(&path).unwrap();
    assert_eq!(data.temperature_c(), Some(20.0));
    assert_eq!(data.rubber.table().unwrap().points().len(), 3);
    assert!(
        data.notes[0].contains("sorted") && data.notes[1].contains("repeat"),
        "{:?}",
        data.notes
    );
    // 40 °C: frequencies are a factor of 10^1.4 higher.
    let hot = data.at_temperature(40.0).unwrap();
    approx::assert_relative_eq!(
        hot.measured.unwrap().lowest_hz,
        10_f64.powf(1.4),
        max_relative = 1e-12
    );
    assert!(data.at_temperature(41.0).unwrap_err().to_string().contains("from 0 to 40 °C"));
    // A shear of 1 % is an elongation of 1/√3 %: half of the part that breaks.
    let law = data.payne_law().unwrap();
    let f = law.storage_factor(0.01 / 3_f64.sqrt());
    approx::assert_relative_eq!(f, 7.5 / 12.0, max_relative = 0.02);
    let written = to_toml(&data, "tread.toml");
    let again = parse(&written).unwrap();
    assert!(again.notes.is_empty());
    for (a, b) in
        again.rubber.table().unwrap().points().iter().zip(data.rubber.table().unwrap().points())
    {
        approx::assert_relative_eq!(a.storage_modulus, b.storage_modulus, max_relative = 1e-6);
    }
    let [a, b] = [&again, &data].map(|data| data.payne_law().unwrap().loss_factor(0.02));
    approx::assert_relative_eq!(a, b, max_relative = 1e-5);
    let error = read_rubber(&path).unwrap_err();
    assert!(error.source().unwrap().to_string().contains("asperity rubber fit"), "{error}");
}

#[test]
fn mistakes_in_files_beside_the_rubber_are_located() {
    let strain = strain_rows();
    let message = |curve: &str, shifts: &str, toml: &str| {
        let files = [
            ("tread.toml", toml),
            ("curve.csv", curve),
            ("shifts.txt", shifts),
            ("strain.csv", &strain),
        ];
        let (_folder, path) = folder(&files);
        let error = read_rubber_data(&path).unwrap_err();
        format!("{error}: {}", error.source().map(ToString::to_string).unwrap_or_default())
    };
    let curve = "frequency_hz,storage_mpa,loss_mpa\n1,5,0.5\n10,6,0.7\n";
    let shifts = "temperature_c log10_shift\n20 0\n0 2.1\n40 -1.4\n";
    let bad = message(&curve.replace("0.7", "-0.7"), shifts, FILES);
    assert!(bad.contains("master_curve") && bad.contains("curve.csv, line 3"), "{bad}");
    let rising = message(curve, &shifts.replace("-1.4", "1.4"), FILES);
    assert!(rising.contains("does not fall from 20 to 40 °C"), "{rising}");
    let off = message(
        curve,
        shifts,
        &FILES.replace("shift_factors", "reference_c = 25.0\nshift_factors"),
    );
    assert!(off.contains("it is 1 at 20 °C"), "{off}");
    let unit = message(curve, shifts, &FILES.replace("strain_unit = 'percent'\n", ""));
    assert!(unit.contains("strain_unit"), "{unit}");
    let none = message(
        curve,
        shifts,
        &FILES[..FILES.find("[temperature]").unwrap()].replace("curve.csv", "other.csv"),
    );
    assert!(none.contains("other.csv"), "{none}");
}

/// The public set beside the project, if it is there.
fn validation(compound: &str) -> Option<(tempfile::TempDir, PathBuf)> {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/validation");
    let target = tempfile::tempdir().unwrap();
    for part in ["master_curve", "shift_factors", "strain_sweep"] {
        let name = format!("{compound}_{part}.txt");
        if std::fs::copy(shared.join(&name), target.path().join(&name)).is_err() {
            eprintln!("skipped: {} is not there", shared.join(&name).display());
            return None;
        }
    }
    let text = format!(
        "name = '{compound}'\npoisson_ratio = 0.49\nmaster_curve = '{compound}_master_curve.txt'\nmodulus_kind = 'youngs'\n\
         [temperature]\nshift_factors = '{compound}_shift_factors.txt'\n\
         [payne]\nstrain_kind = 'elongation'\nstrain_unit = 'percent'\nstrain_sweep = '{compound}_strain_sweep.txt'\n"
    );
    let path = target.path().join("rubber.toml");
    std::fs::write(&path, text).unwrap();
    Some((target, path))
}

#[test]
fn the_public_tread_compounds_are_rubbers() {
    for compound in ["S100", "S120"] {
        let Some((_folder, path)) = validation(compound) else { return };
        let data = read_rubber_data(&path).unwrap();
        let cold = data.at_temperature(20.0).unwrap();
        let modulus = cold.rubber.complex_modulus(TAU);
        let causality = Causality::of(data.rubber.table().unwrap());
        println!(
            "{compound}: {:.3} MPa, tan delta {:.3} at 20 °C and 1 Hz",
            modulus.re / 1e6,
            modulus.im / modulus.re
        );
        println!("{}", causality.summary());
        println!("{:?}", data.oddities());
        // Tread compounds have some 5 to 15 MPa, and lose a tenth to a third.
        assert!((5e6..15e6).contains(&modulus.re), "{modulus}");
        assert!((0.05..0.35).contains(&(modulus.im / modulus.re)), "{modulus}");
        if compound == "S120" {
            // Two rows have a loss modulus of a quarter to a third of those around them, which themselves are too high.
            let found = causality.violations();
            for frequency_hz in [0.2078, 3.631] {
                let near =
                    |point: &CausalPoint| (point.frequency_hz / frequency_hz - 1.0).abs() < 1e-3;
                assert!(found.iter().any(near), "{}", causality.summary());
            }
        }
        let payne = data.payne.as_ref().unwrap();
        assert_eq!(payne.curves().len(), 4);
        assert!(payne.curves().iter().all(|(_, curve)| matches!(curve, PayneCurve::Table(_))));
        let law = cold.payne_law().unwrap();
        println!("f and g at 1 %: {:?}, at 10 %: {:?}", law.factors(0.01), law.factors(0.1));
        assert!((0.5..0.8).contains(&law.storage_factor(0.01)), "{}", law.storage_factor(0.01));
        assert_eq!(data.rubber.table().unwrap().extrapolation(), Extrapolation::Refuse);
    }
}
