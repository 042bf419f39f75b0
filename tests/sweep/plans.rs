//! Plans: the same everywhere, of what is missing, sealed.

use super::{campaign, plan, quietly, solved};
use serde_json::Value;
use std::fs;

fn read(path: &str) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Keys of the tasks of each shard.
fn shares(plan: &str, shards: usize) -> Vec<Vec<String>> {
    let list = |shard: usize| {
        let path = plan.replace("plan.json", &format!("shard_{shard:05}.json"));
        let tasks = read(&path)["tasks"].as_array().unwrap().clone();
        tasks.iter().map(|task| task["key"].as_str().unwrap().to_owned()).collect()
    };
    (0..shards).map(list).collect()
}

#[test]
fn the_same_recipe_gives_the_same_plan() {
    let campaign = campaign();
    let first = plan(&campaign, "out", 3);
    assert_eq!(plan(&campaign, "out", 3), first);
    let elsewhere = quietly(&campaign, "sweep plan recipe.toml --out other --shards 3").result();
    assert_eq!(shares(elsewhere.trim(), 3), shares(&first, 3));
    // One thread or many.
    let one = campaign
        .command("--quiet sweep plan recipe.toml --out third --shards 3")
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .unwrap();
    let one = String::from_utf8(one.stdout).unwrap();
    assert_eq!(shares(one.trim(), 3), shares(&first, 3));
}

#[test]
fn shards_are_balanced_and_every_task_is_in_one() {
    let campaign = campaign();
    let path = plan(&campaign, "out", 5);
    let mut keys = shares(&path, 5).concat();
    keys.sort();
    let count = keys.len();
    keys.dedup();
    // The curves that costs are told from are solved by then: two speeds for two specimens.
    assert_eq!((keys.len(), count), (28, 28));
    let plan = read(&path);
    let seconds: Vec<f64> =
        plan["shards"].as_array().unwrap().iter().map(|s| s["seconds"].as_f64().unwrap()).collect();
    let mean = seconds.iter().sum::<f64>() / 5.0;
    assert!(seconds.iter().all(|s| (s / mean - 1.0).abs() < 0.2), "{seconds:?}");
}

/// The curves for the error of the scans are tasks like others: two realisations without each of the three windows of one
/// specimen and the two of the other.
#[test]
fn the_error_of_the_scans_is_planned_with_the_rest() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "estimate_scan_error = false\n", "");
    let path = plan(&campaign, "out", 2);
    let tasks: usize = shares(&path, 2).iter().map(Vec::len).sum();
    assert_eq!(tasks, 28 + 4 * 2 * 2 * (3 + 2));
    for shard in 0..2 {
        quietly(&campaign, &format!("sweep run {path} --shard {shard}")).result();
    }
    quietly(&campaign, &format!("sweep collect {path}")).result();
    let csv = quietly(&campaign, "export out --format csv").result();
    let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let place = names.iter().position(|name| *name == "scan_error").unwrap();
    for line in csv.lines().skip(1) {
        assert!(line.split(',').nth(place).unwrap().parse::<f64>().unwrap() > 0.0, "{line}");
    }
}

#[test]
fn what_is_solved_is_not_planned_again() {
    let campaign = campaign();
    let plan_path = plan(&campaign, "out", 4);
    quietly(&campaign, &format!("sweep run {plan_path} --shard 2")).result();
    let rest: usize = shares(&plan(&campaign, "out", 4), 4).iter().map(Vec::len).sum();
    assert_eq!(rest, 28 - shares(&plan_path, 4)[2].len());
    let plan_path = solved(&campaign, "out", 4);
    quietly(&campaign, &format!("sweep collect {plan_path}")).result();
    let done = quietly(&campaign, "sweep plan recipe.toml --out out --shards 4 --json").result();
    assert_eq!(
        serde_json::from_str::<Value>(&done).unwrap()["tasks"],
        serde_json::json!([0, 0, 0, 0])
    );
    // Another seed adds its own tasks and no others.
    campaign.edit("recipe.toml", "seeds = [1, 2]", "seeds = [1, 2, 3]");
    let more: usize = shares(&plan(&campaign, "out", 2), 2).iter().map(Vec::len).sum();
    assert_eq!(more, 16);
}

#[test]
fn an_edited_plan_or_list_is_refused() {
    let campaign = campaign();
    let path = plan(&campaign, "out", 2);
    let list = path.replace("plan.json", "shard_00001.json");
    for file in [&path, &list] {
        let text = fs::read_to_string(file).unwrap();
        let edited = text.replacen("50.0", "60.0", 1);
        assert_ne!(edited, text);
        for damaged in [edited, text[..text.len() / 2].to_owned(), String::new()] {
            fs::write(file, damaged).unwrap();
            let error = quietly(&campaign, &format!("sweep run {path} --shard 1")).error(2);
            assert!(error.contains(file.as_str()) && error.contains("plan again"), "{error}");
        }
        // Planning again mends it.
        fs::write(file, &text[..10]).unwrap();
        assert_eq!(plan(&campaign, "out", 2), path);
        quietly(&campaign, &format!("sweep run {path} --shard 1")).result();
        fs::write(file, text).unwrap();
        fs::remove_dir_all(campaign.path("out/solves")).unwrap();
    }
    for none in ["recipe.toml", "nothing.json", "out"] {
        quietly(&campaign, &format!("sweep run {none} --shard 0")).error(2);
    }
}

#[test]
fn a_recipe_with_lists_is_no_recipe_of_one_case() {
    let campaign = campaign();
    for command in ["status recipe.toml", "plan recipe.toml"] {
        let error = quietly(&campaign, command).error(2);
        assert!(error.contains("[sweep] of 8 cases"), "{command}: {error}");
    }
    let error = quietly(&campaign, "run recipe.toml --only bem").error(2);
    assert!(error.contains("--only"), "{error}");
    let error = quietly(&campaign, "run recipe.toml --scans scans").error(2);
    assert!(error.contains("specimens"), "{error}");
    assert!(
        quietly(&campaign, "sweep plan recipe.toml --shards 0").error(2).contains("--shards 0")
    );
}

/// Without lists there is one case, whose curves are spread all the same.
#[test]
fn a_recipe_without_lists_can_be_spread_too() {
    let campaign = crate::common::Campaign::new();
    let plan = solved(&campaign, "out", 2);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    quietly(&campaign, "run recipe.toml --out single").result();
    let read = |path: &str| fs::read(campaign.path(path)).unwrap();
    let table = "tables/friction.arrow";
    assert_eq!(read(&format!("out/cases/all/{table}")), read(&format!("single/{table}")));
}

/// What cannot be solved does not stop the plan, also where costs are told from it.
#[test]
fn a_plan_is_made_of_tasks_without_a_solution_too() {
    let campaign = campaign();
    // Fewer than two points in the smallest contact on the finest grid that is tried.
    campaign.edit("recipe.toml", "[0.02, 0.05, 0.1]", "[0.00001, 0.05, 0.1]");
    let plan = plan(&campaign, "out", 2);
    assert_eq!(shares(&plan, 2).concat().len(), 32);
    let outcome = quietly(&campaign, &format!("sweep run {plan} --shard 0"));
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.contains("leave it out of bem.area_fractions"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("16 of 16 tasks of shard 0"), "{}", outcome.stderr);
}
