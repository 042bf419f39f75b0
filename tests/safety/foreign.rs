//! asperity never removes, renames or changes a file that it did not write.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use super::{Campaign, finished, quietly};
use crate::digests::digests;
use crate::outcome::Outcome;

/// Two cases, for what a sweep writes.
const SWEEP: &str = "\n[sweep]\nseeds = [1, 2]\n";
/// Names in a run folder that asperity uses, or that look like it.
const NAMES: [&str; 33] = [
    "ingest",
    "characterise",
    "approximate",
    "realise",
    "bem",
    "micro",
    "hybrid",
    "fem",
    "tables",
    "sinusoid",
    "sweep",
    "solves",
    "surfaces",
    "cases",
    "plans",
    "shards",
    "logs",
    "scans",
    ".tmp-x",
    ".tmp-bem-AbCdEf",
    ".old-x",
    ".old-bem",
    ".asperity",
    ".asperity-new-bem-AbCdEf",
    ".asperity-old-bem-AbCdEf",
    ".asperity-new-note-AbCdEf",
    ".lock",
    "last_run.json",
    "recipe.toml",
    "report.html",
    "friction.csv",
    "friction.svg",
    "scan_01.txt",
];
/// Names below them.
const INNER: [&str; 16] = [
    "seed=1",
    "seed=2",
    "bem",
    "ingest",
    "realise",
    "solves",
    "ab",
    "manifest.json",
    "recipe.toml",
    "last_run.json",
    "curves.arrow",
    "friction.arrow",
    ".asperity",
    ".asperity-files",
    ".tmp-x",
    "notes.txt",
];
const CONTENTS: [&str; 5] = [
    "",
    "mine",
    "{}",
    "{\"schema\": \"asperity.manifest\"}",
    "{\n  \"schema\": \"mine\",\n  \"recipe\": \"recipe.toml\"\n}",
];

/// What a user has put into the folder.
#[derive(Debug, Clone)]
enum Kind {
    File(&'static str),
    LinkToFile,
    LinkToFolder,
    LinkToNothing,
}

/// What is in the folder before.
#[derive(Debug, Clone, Copy)]
enum Before {
    Nothing,
    Run,
    Sweep,
}

fn kinds() -> impl Strategy<Value = Kind> {
    prop_oneof![
        5 => prop::sample::select(&CONTENTS[..]).prop_map(Kind::File),
        1 => Just(Kind::LinkToFile),
        2 => Just(Kind::LinkToFolder),
        1 => Just(Kind::LinkToNothing),
    ]
}

fn places() -> impl Strategy<Value = PathBuf> {
    let name = || prop::sample::select(&NAMES[..]);
    let inner = || prop::sample::select(&INNER[..]);
    prop_oneof![
        3 => name().prop_map(PathBuf::from),
        4 => (name(), inner()).prop_map(|(a, b)| Path::new(a).join(b)),
        2 => (name(), inner(), inner()).prop_map(|(a, b, c)| Path::new(a).join(b).join(c)),
    ]
}

/// Every file of a tree with its bytes and every link with its target, without following links.
fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(tree(&path));
        } else {
            found.insert(path.clone(), content(&path).unwrap());
        }
    }
    found
}

/// The bytes of a file, or where a link leads; none if it is not there.
fn content(path: &Path) -> Option<Vec<u8>> {
    if path.is_symlink() {
        return Some(fs::read_link(path).unwrap().into_os_string().into_encoded_bytes());
    }
    fs::read(path).ok()
}

/// A campaign with a finished run and a finished sweep, and a folder beside them that is none of asperity's.
fn prepared() -> Campaign {
    let campaign = finished();
    campaign.write("sweep.toml", &campaign.read("recipe.toml").replace("seed = 1\n", ""));
    campaign.write("sweep.toml", &(campaign.read("sweep.toml") + SWEEP));
    quietly(&campaign, "run sweep.toml --out spread").result();
    fs::create_dir_all(campaign.path("elsewhere/ab")).unwrap();
    for file in ["notes.txt", "manifest.json", "ab/x.json", "curves.arrow"] {
        campaign.write(&format!("elsewhere/{file}"), "mine");
    }
    campaign
}

/// Puts what a user has into `case/out`, where nothing is there already; returns the places.
fn plant(root: &Path, things: &[(PathBuf, Kind)]) -> Vec<PathBuf> {
    let mut planted = Vec::new();
    for (place, kind) in things {
        let path = root.join("case/out").join(place);
        let folder = path.parent().unwrap();
        // Not through a link, and not below a file.
        let inside = folder.ancestors().take_while(|folder| *folder != root);
        let free = content(&path).is_none() && !path.is_dir();
        if !free || inside.into_iter().any(|f| f.is_symlink() || f.is_file()) {
            continue;
        }
        fs::create_dir_all(folder).unwrap();
        match kind {
            Kind::File(text) => fs::write(&path, text).unwrap(),
            Kind::LinkToFile => symlink(root.join("elsewhere/notes.txt"), &path).unwrap(),
            Kind::LinkToFolder => symlink(root.join("elsewhere"), &path).unwrap(),
            Kind::LinkToNothing => symlink(root.join("elsewhere/nothing"), &path).unwrap(),
        }
        planted.push(path);
    }
    planted
}

/// Every command that could write into the folder; PLAN is the plan of the sweep, where there is one.
const COMMANDS: [&str; 27] = [
    "status recipe.toml --out case/out",
    "verify case/out",
    "inspect case/out",
    "plan recipe.toml",
    "run recipe.toml --out case/out --only ingest",
    "run recipe.toml --out case/out",
    "run recipe.toml --out case/out --force bem --take-over",
    "run recipe.toml --out case/out --from tables --force tables",
    "export case/out --format csv",
    "export case/out --format csv --to case/out",
    "export case/out --format csv --to case/out/friction.csv",
    "export case/out --format csv --to case/out/tables",
    "export case/out --format parquet --to case/out/notes.txt",
    "plot friction case/out --to case/out/friction.svg",
    "report case/out",
    "report case/out --to case/out/recipe.toml",
    "convert scans/track_0.txt --separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um \
     --z-unit um --missing BAD --to case/out/friction.csv",
    "synth --out case/out --scans 1 --length-mm 4 --spacing-um 50",
    "solve bem --wave 1:0.01 --speed 10 --modulus 3 --poisson 0.5 --points 64 --pressure 0.02 --fields \
     case/out/friction.csv",
    "init case/out",
    "sweep plan sweep.toml --out case/out --shards 2 --take-over",
    "sweep status PLAN",
    "sweep run PLAN --shard 0",
    "sweep run PLAN --shard 1",
    "sweep collect PLAN",
    "run sweep.toml --out case/out --take-over",
    "verify case/out",
];

/// Runs every command and says after which of them something of the user's was another.
fn all_stays(campaign: &Campaign, before: Before, things: &[(PathBuf, Kind)]) -> [usize; 2] {
    let root = campaign.root();
    let case = campaign.path("case");
    if case.exists() {
        fs::remove_dir_all(&case).unwrap();
    }
    fs::create_dir(&case).unwrap();
    let source = match before {
        Before::Nothing => None,
        Before::Run => Some("out"),
        Before::Sweep => Some("spread"),
    };
    if let Some(source) = source {
        let mut copy = Command::new("cp");
        copy.arg("-a").arg(root.join(source)).arg(case.join("out"));
        assert!(copy.status().unwrap().success());
    }
    let planted = plant(root, things);
    let watched = || {
        let inside = planted.iter().map(|path| (path.clone(), content(path).unwrap_or_default()));
        inside.chain(tree(&root.join("elsewhere"))).chain(tree(&root.join("scans"))).collect()
    };
    let expected: BTreeMap<PathBuf, Vec<u8>> = watched();
    let mut plan = String::new();
    let mut codes = [0, 0];
    for command in COMMANDS {
        if command.contains("PLAN") && plan.is_empty() {
            continue;
        }
        let done = quietly(campaign, &command.replace("PLAN", &plan));
        if command.starts_with("sweep plan") {
            plan = done.stdout.trim().to_owned();
        }
        assert!(
            planted.iter().all(|path| content(path).is_some()),
            "gone after {command}: {planted:?}"
        );
        assert_eq!(watched(), expected, "{command}: {}", done.stderr);
        assert!((0..=2).contains(&done.code), "{command}: {} {}", done.code, done.stderr);
        if command.starts_with("run recipe.toml --out case/out") {
            codes[usize::from(done.code != 0)] += 1;
        }
    }
    codes
}

/// Few cases by default; PROPTEST_CASES in the environment asks for more.
#[test]
fn whatever_a_user_keeps_in_a_run_folder_stays() {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok());
    let config =
        Config { cases: cases.unwrap_or(6), failure_persistence: None, ..Config::default() };
    let campaign = prepared();
    let before = prop_oneof![Just(Before::Nothing), Just(Before::Run), Just(Before::Sweep)];
    let things = prop::collection::vec((places(), kinds()), 1..6);
    let codes = std::cell::RefCell::new([0, 0]);
    TestRunner::new(config)
        .run(&(before, things), |(before, things)| {
            let [done, refused] = all_stays(&campaign, before, &things);
            let mut codes = codes.borrow_mut();
            *codes = [codes[0] + done, codes[1] + refused];
            Ok(())
        })
        .unwrap();
    let [done, refused] = codes.into_inner();
    eprintln!("{done} runs did their work, {refused} were refused");
    // Neither is everything refused nor does nothing ever stand in the way.
    assert!(done > 0 && refused > 0, "{done} {refused}");
}

/// The case that was found: raw scans and tables of one's own in folders of the names of stages.
#[test]
fn a_project_with_folders_of_the_names_of_stages_is_refused_before_anything_is_computed() {
    let campaign = Campaign::new();
    for (file, text) in [
        ("project/ingest/track_0.txt", campaign.read("scans/track_0.txt")),
        ("project/tables/mine.csv", "a,b\n1,2\n".into()),
        ("project/.tmp-notes", "mine".into()),
        ("project/.old-x/notes", "mine".into()),
    ] {
        fs::create_dir_all(campaign.path(file).parent().unwrap()).unwrap();
        campaign.write(file, &text);
    }
    let before = tree(&campaign.path("project"));
    let error = quietly(&campaign, "run recipe.toml --out project").error(2);
    assert!(error.contains("project/ingest/track_0.txt"), "{error}");
    assert!(error.contains("move project/ingest away, or choose another --out"), "{error}");
    assert_eq!(tree(&campaign.path("project")), before);
    // The last of the stages is looked at before the first is computed.
    fs::remove_dir_all(campaign.path("project/ingest")).unwrap();
    let before = tree(&campaign.path("project"));
    let error = quietly(&campaign, "run recipe.toml --out project").error(2);
    assert!(error.contains("project/tables/mine.csv"), "{error}");
    assert_eq!(tree(&campaign.path("project")), before);
    fs::remove_dir_all(campaign.path("project/tables")).unwrap();
    quietly(&campaign, "run recipe.toml --out project").result();
    for (file, text) in before.iter().filter(|(file, _)| !file.ends_with("mine.csv")) {
        assert_eq!(&fs::read(file).unwrap(), text, "{}", file.display());
    }
}

/// `--force bem` solves again and leaves the solves of other stages where they are.
#[test]
fn a_forced_stage_replaces_its_own_solves_alone() {
    let campaign = finished();
    let whole = digests(&campaign.path("out"));
    let solves = tree(&campaign.path("out/solves"));
    // As of another stage: a solve under a key that this recipe has no use for.
    let store = asperity::artifact::SolveStore::open(campaign.path("out/solves")).unwrap();
    let key = asperity::artifact::Digest::of_bytes(b"a microscale");
    store.put(&key, &7.0).unwrap();
    campaign.write("out/solves/notes.txt", "mine");
    let before = tree(&campaign.path("out/solves"));
    assert_eq!(before.len(), solves.len() + 2);
    let modified = |path: &PathBuf| fs::metadata(path).unwrap().modified().unwrap();
    let times: Vec<_> = solves.keys().map(modified).collect();
    quietly(&campaign, "run recipe.toml --out out --force bem").result();
    assert_eq!(
        tree(&campaign.path("out/solves")).keys().collect::<Vec<_>>(),
        before.keys().collect::<Vec<_>>()
    );
    assert!(solves.keys().map(modified).zip(times).all(|(now, before)| now > before));
    assert_eq!(store.get::<f64>(&key).unwrap(), Some(7.0));
    assert_eq!(campaign.read("out/solves/notes.txt"), "mine");
    assert_eq!(digests(&campaign.path("out")), whole);
}

/// Both recipes of `asperity init` are called recipe.toml.
#[test]
fn two_projects_have_two_run_folders_and_a_run_folder_has_one_recipe() {
    let campaign = Campaign::new();
    for project in ["a", "b"] {
        fs::create_dir_all(campaign.path(project).join("scans")).unwrap();
        let recipe =
            campaign.read("recipe.toml").replace("seed = 1", &format!("seed = {}", project.len()));
        campaign.write(&format!("{project}/recipe.toml"), &recipe);
        campaign.write(&format!("{project}/rubber.toml"), &campaign.read("rubber.toml"));
        for scan in 0..2 {
            let name = format!("scans/track_{scan}.txt");
            campaign.write(&format!("{project}/{name}"), &campaign.read(&name));
        }
    }
    quietly(&campaign, "run a/recipe.toml").result();
    let first = tree(&campaign.path("a/runs/recipe"));
    quietly(&campaign, "run b/recipe.toml").result();
    assert_eq!(tree(&campaign.path("a/runs/recipe")), first);
    assert!(campaign.path("b/runs/recipe/tables").is_dir() && !campaign.path("runs").exists());

    let error = quietly(&campaign, "run b/recipe.toml --out a/runs/recipe").error(2);
    assert!(error.contains("a/runs/recipe is the run folder of another recipe"), "{error}");
    assert!(error.contains("a/recipe.toml") && error.contains("--take-over"), "{error}");
    assert_eq!(tree(&campaign.path("a/runs/recipe")), first);
    quietly(&campaign, "run b/recipe.toml --out a/runs/recipe --take-over").result();
    let error = quietly(&campaign, "run a/recipe.toml").error(2);
    assert!(error.contains("b/recipe.toml"), "{error}");
    // A project that is moved as a whole goes on.
    fs::rename(campaign.path("b"), campaign.path("moved")).unwrap();
    let moved = quietly(&campaign, "run moved/recipe.toml --json").json();
    let stages = moved["stages"].as_array().unwrap();
    assert!(stages.iter().all(|stage| stage["computed"] == false), "{moved}");
}

/// The temporary folder has no say where nothing temporary is needed.
#[test]
fn an_export_needs_no_temporary_folder() {
    let campaign = finished();
    for arguments in [
        "export out --format csv",
        "export out --format csv --table bem/curves",
        "export out --format parquet --to friction.parquet",
        "export out --format csv --to tables",
    ] {
        let mut command = campaign.command(&format!("--quiet {arguments}"));
        let done = Outcome::of(command.env("TMPDIR", campaign.path("no/such/folder")));
        assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{arguments}");
    }
}

#[test]
fn outputs_are_overwritten_if_that_is_asked_for_and_not_otherwise() {
    let campaign = finished();
    campaign.write("mine.csv", "mine");
    let solve =
        "solve bem --wave 1:0.01 --speed 10 --modulus 3 --poisson 0.5 --points 64 --pressure 0.02";
    for arguments in [
        "export out --format csv --to mine.csv".to_owned(),
        "export out --format markdown --to mine.csv".to_owned(),
        "report out --to mine.csv".to_owned(),
        format!("{solve} --fields mine.csv"),
    ] {
        let error = quietly(&campaign, &arguments).error(2);
        assert!(error.contains("mine.csv exists already"), "{arguments}: {error}");
        assert_eq!(campaign.read("mine.csv"), "mine", "{arguments}");
        assert_eq!(quietly(&campaign, &format!("{arguments} --force")).code, 0, "{arguments}");
        assert_ne!(campaign.read("mine.csv"), "mine", "{arguments}");
        campaign.write("mine.csv", "mine");
    }
}
