//! Mistakes that people make, on the command line and in a recipe: each answer has the file and line or the
//! option, the value as it was typed, and a way out; nothing is computed, and bad input is exit code 2.

use super::common::Campaign;
use super::{Outcome, binary};
use std::fs;

/// Runs the binary in the folder of the campaign; arguments are separated by blanks, `~` stands for one.
fn run(campaign: &Campaign, arguments: &str) -> Outcome {
    let arguments = arguments.split_whitespace().map(|argument| argument.replace('~', " "));
    Outcome::of(binary().current_dir(campaign.path("")).arg("--quiet").args(arguments))
}

fn check(campaign: &Campaign, arguments: &str, code: i32, parts: &[&str]) -> Vec<String> {
    let told = run(campaign, arguments);
    let missing = parts.iter().filter(|part| !told.stderr.contains(**part));
    let mut faults: Vec<String> = missing.map(|part| format!("lacks `{part}`")).collect();
    if told.code != code {
        faults.push(format!("exit code {} in place of {code}", told.code));
    }
    if told.stderr.contains("panicked") {
        faults.push("panic".into());
    }
    if faults.is_empty() {
        return faults;
    }
    vec![format!("asperity {arguments}\n  {}\n{}", faults.join(", "), told.stderr)]
}

const WAVE: &str = "solve bem --wave 0.0625:0.01867";

/// Arguments, and parts of the answer.
type Cases = Vec<(String, &'static [&'static str])>;

fn bem(rest: &str) -> String {
    format!("{WAVE} {rest}")
}

fn loaded(rest: &str) -> String {
    format!("{WAVE} --speed 10 --pressure 1 {rest}")
}

fn fem(rest: &str) -> String {
    format!("solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 {rest}")
}

fn text(text: &str) -> String {
    text.to_owned()
}

fn with_commands_and_options() -> Cases {
    vec![
        (text("slove bem"), &["'slove'", "'solve'"]),
        (text("solve bem"), &["--speed <MM_S>", "--wave", "--pressure"]),
        (bem("--speed 10"), &["--pressure <MPA>", "--area <FRACTION>"]),
        (bem("--sped 10 --pressure 1"), &["'--sped'", "'--speed'"]),
        (
            bem("--speed 10 --pressure 1 --area 0.1"),
            &["--pressure", "cannot be used with", "--area"],
        ),
        (loaded("--tolerance 1e-3 --points 64"), &["--tolerance", "cannot be used with"]),
        (loaded("--modulus 4"), &["--poisson <NU>"]),
        (loaded("--temperature-c 20"), &["--rubber <FILE>"]),
    ]
}

fn with_numbers() -> Cases {
    vec![
        (bem("--speed 0,5 --pressure 1"), &["`0,5`", "--speed", "decimal mark is a point"]),
        (bem("--speed -1 --pressure 1"), &["'-1'", "--speed", "not positive"]),
        (bem("--speed nan --pressure 1"), &["`nan`", "not a finite number"]),
        (bem("--speed 1e400 --pressure 1"), &["`1e400`", "not a finite number"]),
        (bem("--speed 10~mm/s --pressure 1"), &["`10 mm/s`", "without a unit", "MM_S"]),
        (bem("--speed 10 --area 5%"), &["`5%`", "5 % is 0.05"]),
        (bem("--speed 10 --area 5"), &["'5'", "between 0 and 1", "5 % is 0.05"]),
        (bem("--speed 10 --area 1e-400"), &["1e-400 is not between 0 and 1"]),
        (loaded("--points 1e3"), &["`1e3`", "whole number", "such as 1000"]),
        (loaded("--points 7"), &["--points is 7", "from 8 to 16777216"]),
        (loaded("--points 99999999999999999999999"), &["too large"]),
        (loaded("--tolerance 1e-9"), &["1e-9 is not between 1e-8 and 0.5"]),
        (loaded("--tolerance 1%"), &["`1%`", "a fraction (5 % is 0.05)"]),
        (loaded("--modulus 4 --poisson 0.7"), &["poisson_ratio is 0.7", "between 0 and 0.5"]),
    ]
}

fn with_waves() -> Cases {
    vec![
        (text("solve bem --wave 0.0625 --speed 10 --pressure 1"), &["'0.0625'", "0.0625:0.01867"]),
        (
            text("solve bem --wave 0.0625,0.01867 --speed 10 --pressure 1"),
            &["WAVELENGTH_MM:AMPLITUDE_MM"],
        ),
        (
            text("solve bem --wave 62.5um:18um --speed 10 --pressure 1"),
            &["`62.5um`", "wavelength in mm", "without a unit"],
        ),
        (
            text("solve bem --wave 0:1 --speed 10 --pressure 1"),
            &["'0:1'", "wavelength in mm", "not positive"],
        ),
        (text("solve bem --wave 1:0 --speed 10 --area 0.1"), &["flat", "--pressure"]),
        (
            text("solve bem --wave 1:0.1 --wave 1.41421:0.1 --speed 10 --pressure 1"),
            &["1, 1.41421 mm", "simple fractions"],
        ),
    ]
}

fn with_files() -> Cases {
    vec![
        (loaded("--rubber none.toml"), &["rubber none.toml", "check the path"]),
        (loaded("--rubber scans"), &["rubber scans", "folder", "give the file itself"]),
        (loaded("--rubber scans/track_0.txt"), &["scans/track_0.txt, line", "key = value"]),
        (
            loaded("--rubber recipe.toml"),
            &["recipe.toml, line", "this is a recipe: give the file of the rubber"],
        ),
        (loaded("--rubber rubber.toml --temperature-c 20"), &["rubber.toml", "[temperature]"]),
        (
            text("solve bem --profile none.txt --profile-unit mm --speed 1 --pressure 1"),
            &["none.txt", "check the path"],
        ),
        (
            text("solve bem --profile scans --profile-unit mm --speed 1 --pressure 1"),
            &["scans", "give the file itself"],
        ),
        (
            text("solve bem --profile rubber.toml --profile-unit mm --speed 1 --pressure 1"),
            &["rubber.toml, line", "2 columns x and z"],
        ),
        (
            text(
                "solve bem --profile scans/track_0.txt --profile-unit inch --speed 1 --pressure 1",
            ),
            &["'inch'", "nm, um, mm or m"],
        ),
        (text("run none.toml"), &["recipe none.toml", "check the path"]),
        (text("run scans"), &["recipe scans", "folder"]),
        (text("run scans/track_0.txt"), &["scans/track_0.txt, line", "key = value"]),
        (
            text("run rubber.toml"),
            &["rubber.toml, line", "this is the file of a rubber: give the recipe"],
        ),
        (text("run recipe.toml --scans none.txt"), &["scans none.txt", "ingest.scans"]),
        (text("run recipe.toml --scans rubber.toml --out out"), &["rubber.toml", "x_mm"]),
        (text("run recipe.toml --out rubber.toml"), &["rubber.toml", "choose another --out"]),
        (text("inspect none"), &["none", "No such file"]),
        (text("convert rubber.toml --to x.x3p"), &["rubber.toml", "--separator"]),
        (text("convert scans/track_0.txt --to x.xyz"), &["x.xyz", "*.x3p, *.sdf or *.csv"]),
        (
            text("rubber fit rubber.toml --kind shear --to y.toml"),
            &["rubber.toml, line", "frequency_hz"],
        ),
        (text("rubber fit none.csv --kind shera --to y.toml"), &["'shera'", "'shear'"]),
        (text("synth --out rubber.toml --scans 1"), &["rubber.toml is a file, not a folder"]),
        (text("synth --out new --length-mm 0"), &["--length-mm is 0 mm", "positive"]),
        (
            text("synth --out new --outer-hurst-exponent 1.5"),
            &["--outer-hurst-exponent is 1.5", "below 1"],
        ),
        (text("init rubber.toml"), &["rubber.toml"]),
    ]
}

fn with_stages() -> Cases {
    vec![
        (
            text("run recipe.toml --only bem --out none"),
            &["bem needs the results of ingest", "--from ingest"],
        ),
        (text("run recipe.toml --only bemm"), &["'bemm'", "'bem'"]),
        (text("run recipe.toml --only micro"), &["no stage micro", "realise, bem, tables"]),
        (text("run recipe.toml --only ingest --force bem"), &["--force bem", "one or the other"]),
        (text("run recipe.toml --threads 0"), &["--threads", "0"]),
        (text("run recipe.toml --threads -1"), &["'-1'", "--threads", "whole number of 0 or more"]),
        (text("run recipe.toml --tolerance 2"), &["2 is not between 1e-8 and 0.5"]),
        (text("status recipe.toml --tolerance 5%"), &["`5%`", "--tolerance"]),
    ]
}

fn with_results() -> Cases {
    vec![
        (text("export nowhere --format csv"), &["nowhere does not exist", "runs/asphalt"]),
        (text("export recipe.toml --format csv"), &["recipe.toml is a file", "folder of a run"]),
        (text("export scans --format cvs"), &["'cvs'", "csv, markdown"]),
        (text("export scans --format csv --waves eight"), &["`eight`", "--waves", "whole number"]),
        (text("export scans --format csv --speed 0,5"), &["`0,5`", "decimal mark is a point"]),
        (text("verify recipe.toml"), &["recipe.toml is a file", "folder of a run"]),
        (text("plot frictoin scans"), &["`frictoin`", "did you mean `friction`?"]),
        (text("plot friction scans --to x.pdf"), &["x.pdf", ".svg or .png"]),
        (text("sweep collect none"), &["none", "plan.json"]),
        (text("man sovle"), &["sovle", "did you mean `solve`?"]),
    ]
}

fn with_finite_elements() -> Cases {
    vec![
        (fem("--columns 4"), &["columns is 4", "8 to 65536"]),
        (fem("--points 64"), &["--points", "--columns"]),
        (fem("--route transiant"), &["'transiant'", "'transient'"]),
        (fem("--drag-periods 3"), &["--drag-periods", "--route transient"]),
        (fem("--height -1"), &["'-1'", "--height", "not positive"]),
    ]
}

#[test]
fn mistakes_on_the_command_line_are_answered_with_what_was_typed_and_a_way_out() {
    let cases: Cases = [
        with_commands_and_options(),
        with_numbers(),
        with_waves(),
        with_files(),
        with_stages(),
        with_results(),
        with_finite_elements(),
    ]
    .concat();
    let campaign = Campaign::new();
    let told: Vec<String> =
        cases.iter().flat_map(|(arguments, parts)| check(&campaign, arguments, 2, parts)).collect();
    assert!(told.is_empty(), "{} of {}:\n{}", told.len(), cases.len(), told.join("\n"));
    assert!(!campaign.path("new").exists());
}

#[test]
fn mistakes_in_a_recipe_are_answered_with_line_and_value_once() {
    // What is replaced, by what, and parts of the answer.
    let cases: [(&str, &str, &[&str]); 36] = [
        (
            "5e-3",
            "\"5e-3\"",
            &["line 33, column", "\"5e-3\" is not a number: write 5e-3, without quotes"],
        ),
        ("5e-3", "0,005", &["line 33", "0,005 is not a number", "decimal mark is a point"]),
        ("5e-3", "0.5%", &["line 33", "0.5% is not a value", "percent sign"]),
        ("5e-3", "nan", &["line 33: bem.tolerance = nan: must be between 1e-9 and 0.5"]),
        ("5e-3", "1e400", &["line 33", "1e400 is too large"]),
        ("tolerance =", "tolerence =", &["line 33", "`tolerence`; did you mean `tolerance`?"]),
        ("[10.0]", "[]", &["bem.speeds_mm_s = []: must be one speed or more"]),
        ("[10.0]", "[10, 10.0]", &["bem.speeds_mm_s = [10, 10.0]", "without repeats"]),
        ("[10.0]", "10", &["10 is not a list: write [10]"]),
        ("[10.0]", "[\"10 mm/s\"]", &["\"10 mm/s\" is not a number", "without quotes"]),
        ("speeds_mm_s", "speeds_m_s", &["did you mean `speeds_mm_s`?"]),
        ("[0.02, 0.05, 0.1]", "[2, 5, 10]", &["bem.area_fractions = [2, 5, 10]", "5 % is 0.05"]),
        ("[0.02, 0.05, 0.1]", "[]", &["bem.area_fractions = []", "such as [0.05]"]),
        ("\"rubber.toml\"", "3", &["3 is not a text in quotes: write \"3\""]),
        ("rubber = \"rubber.toml\"", "", &["bem.rubber is missing: give a rubber file"]),
        ("seed = 1", "", &["realise.seed is missing: give a whole number"]),
        ("seed = 1", "seed = -1", &["line 27", "-1 is not a whole number of 0 or more"]),
        ("seed = 1", "seed = 99999999999999999999", &["99999999999999999999", "whole number"]),
        ("seed = 1", "seed = 1\nseed = 2", &["line 28", "`seed` occurs twice"]),
        (
            "realisations = 2",
            "realisations = 0",
            &["realise.realisations = 0: must be 1 to 100000"],
        ),
        ("realisations = 2", "realisations = 2.5", &["2.5 is not a whole number"]),
        ("realisations = 2", "realisations = true", &["true is not a whole number"]),
        ("realisations = 2", "", &["realise.realisations is missing"]),
        ("[2, 3]", "[2, 2, 3]", &["approximate.waves = [2, 2, 3]", "each once"]),
        ("[realise]", "[realize]", &["`realize`; did you mean `realise`?"]),
        (
            "\"semicolon\"",
            "\"semikolon\"",
            &["\"semikolon\" is not known here", "tab, comma, semicolon"],
        ),
        ("z_unit = \"um\"", "z_unit = \"inch\"", &["`inch`", "nm, um, mm, m"]),
        ("z_unit = \"um\"", "", &["z_unit", "never guessed"]),
        ("\"slope\"", "\"none\"", &["`none`", "mean, slope, polynomial"]),
        ("\"slope\"", "{ polynomial = 20 }", &["form.polynomial = 20", "12 or less"]),
        ("[characterise]", "[hybrid]", &["line 18", "[hybrid] without [micro]", "add [micro]"]),
        ("[characterise]", "[sweep]\nseeds = [1, 2]", &["realise.seed = 1", "left out beside"]),
        ("[characterise]", "[sweep]", &["line 18", "one list or more"]),
        ("[characterise]", "[tables]\ntheories = [\"person\"]", &["did you mean `persson`?"]),
        ("[characterise]", "[nonsense]", &["unknown key `nonsense`", "ingest, characterise"]),
        ("title = \"Small campaign\"", "", &["the key `title` is missing"]),
    ];
    let campaign = Campaign::new();
    let recipe = campaign.read("recipe.toml");
    let mut told = Vec::new();
    for (from, to, parts) in &cases {
        campaign.edit("recipe.toml", from, to);
        let parts: Vec<&str> = ["recipe recipe.toml"].iter().chain(*parts).copied().collect();
        told.extend(check(&campaign, "status recipe.toml", 2, &parts));
        let answer = run(&campaign, "status recipe.toml").stderr;
        if answer.contains("caused by") || answer.contains("wanted:") {
            told.push(format!("`{to}` is answered twice or in half a sentence:\n{answer}"));
        }
        campaign.write("recipe.toml", &recipe);
    }
    assert!(told.is_empty(), "{} of {}:\n{}", told.len(), cases.len(), told.join("\n"));
}

/// Which code an error has is a property of the error, not of the command that meets it.
#[test]
fn a_file_has_the_same_exit_code_in_every_command() {
    let campaign = Campaign::new();
    let project = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scans/formats/scan_1.sdf");
    let whole = fs::read(project).unwrap();
    fs::write(campaign.path("cut.sdf"), &whole[..whole.len() / 2]).unwrap();
    for command in [
        "inspect cut.sdf",
        "convert cut.sdf --to x.csv",
        "init new --scans cut.sdf",
        "run recipe.toml --scans cut.sdf --out out",
    ] {
        let told = run(&campaign, command);
        assert_eq!(told.code, 2, "{command}: {}", told.stderr);
        assert!(told.stderr.contains("cut.sdf"), "{command}: {}", told.stderr);
    }
}

#[test]
fn an_accuracy_has_one_range() {
    let campaign = Campaign::new();
    // A recipe takes what a solve takes.
    run(&campaign, "status recipe.toml --tolerance 1e-6").result();
    run(&campaign, "status recipe.toml --tolerance 1e-8").result();
    let recipe = campaign.read("recipe.toml");
    let text = recipe.replace("tolerance = 5e-3\n", "");
    campaign.write("recipe.toml", &format!("tolerance = 1e-8\n{text}"));
    run(&campaign, "status recipe.toml").result();
    campaign.write("recipe.toml", &recipe);
}

#[test]
fn the_nearest_area_is_given_within_its_own_error() {
    let campaign = Campaign::new();
    // The area of this grid jumps over 0.01.
    let solve = "solve bem --wave 0.0625:0.01867 --wave 0.5:0.05 --wave 8:0.3 --speed 0.1 --area 0.01 --json";
    let found = run(&campaign, &format!("{solve} --points 4096")).json();
    let distance = (found["contact_area_fraction"].as_f64().unwrap() - 0.01).abs();
    let error = found["error_estimate"]["contact_area_fraction"].as_f64().unwrap();
    assert!(distance > 1e-8 && distance <= error, "{distance} off with an error of {error}");
    // That of a coarser one by more than it errs.
    let refused = run(&campaign, &format!("{solve} --points 1024")).error(1);
    assert!(refused.contains("fraction 0.01 on 1024 points"), "{refused}");
}
