//! `asperity export` of the small campaign: tables, the report of cleaning, and what is refused.

use super::campaign::{RUN, outcome, with_microscale};
use crate::common::Campaign;
use std::fs;

#[test]
fn exports_are_complete_or_refused() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 50.0]");
    let export = |arguments: &str| outcome(&campaign, &format!("export {arguments}"));
    fs::create_dir(campaign.path("out")).unwrap();
    assert!(
        export("out --format csv").error(2).contains("no finished result of the stage `tables`")
    );
    assert!(export("recipe.toml --format csv").error(2).contains("give the folder of a run"));
    assert!(export("out --format docx").error(2).contains("latex, parquet, xlsx, svg"));
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).result(), "");
    assert!(export("out --format csv --waves 9").error(2).contains("or --speed out to see all"));
    assert!(export("out --format csv --speed 11").error(2).contains("no table"));
    assert!(export("out --format csv").error(2).contains("there are 2 tables"));
    assert!(export("out --format parquet").error(2).contains("--to"));
    let message = export("out --format markdown --to none/friction.md").error(2);
    assert!(message.contains("none/friction.md"), "{message}");

    let csv = export("out --format csv --speed 50").result();
    let header = "contact_area_fraction,pressure_mpa,realisation_1,realisation_2,mean,\
                  standard_deviation,confidence_95,left_out_error,error_estimate";
    assert_eq!(csv.lines().next(), Some(header));
    assert_eq!(csv.lines().count(), 1 + 3);
    for (format, start) in [("markdown", ""), ("latex", ""), ("svg", "<svg")] {
        let text = export(&format!("out --format {format}")).result();
        assert!(text.contains(start) && !text.is_empty(), "{format}");
    }
    let values = export("out --format csv --layout long --speed 50").result();
    assert!(values.lines().next().unwrap().ends_with("realisation,friction_coefficient"));
    assert_eq!(values.lines().count(), 1 + 3 * 2);
    assert!(export("out --format latex --layout long").error(2).contains("csv and parquet"));
    export("out --format csv --to tables").result();
    assert_eq!(fs::read_dir(campaign.path("tables")).unwrap().count(), 2);
    export("out --format parquet --to friction.parquet").result();
    assert!(fs::read(campaign.path("friction.parquet")).unwrap().starts_with(b"PAR1"));
    assert!(export("out --format parquet --to friction.parquet").error(2).contains("--force"));
}

#[test]
fn the_report_of_cleaning_names_planted_faults_with_their_scan() {
    let campaign = Campaign::new();
    // One spike of 0.9 mm, and a wall of 0.5 mm from 4 mm on in another scan.
    let planted = |name: &str, lift: &dyn Fn(f64) -> f64| {
        let lines = campaign.read(name);
        let lifted: Vec<String> = lines
            .lines()
            .map(|line| match line.split_once(';').map(|(x, z)| (x.parse(), z.parse::<f64>())) {
                Some((Ok(x), Ok(z))) => format!("{x};{:.3}", z + lift(x)),
                _ => line.to_owned(),
            })
            .collect();
        campaign.write(name, &(lifted.join("\n") + "\n"));
    };
    planted("scans/track_1.txt", &|x| if x == 5.0 { 900.0 } else { 0.0 });
    planted("scans/track_2.txt", &|x| if x < 4.0 { 0.0 } else { 500.0 });
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).code, 0);
    let report = outcome(&campaign, "export out --format markdown --cleaning").result();
    let section = |scan: &str| {
        let start = report.find(&format!("## {scan}\n")).unwrap();
        report[start + 3..].split("\n## ").next().unwrap().to_owned()
    };
    assert!(section("track_1").contains("| spikes | 1 | 0.31 % | missing |"), "{report}");
    assert!(section("track_2").contains("| level jumps | 1 |"), "{report}");
    assert!(!report.contains("## track_0"), "{report}");
    assert!(report.contains("3 of 3 kept"), "{report}");
    let message = outcome(&campaign, "export out --format csv --cleaning").error(2);
    assert!(message.contains("give --format markdown"), "{message}");
}

#[test]
fn exports_of_results_that_the_recipe_no_longer_asks_for_are_warned_of() {
    let campaign = with_microscale();
    outcome(&campaign, &format!("{RUN} --quiet")).result();
    let tables = "export out --format csv --model bem";
    let hybrid = "export out --format csv --table hybrid/curves";
    let fresh = outcome(&campaign, tables).result();
    outcome(&campaign, hybrid).result();

    let recipe = campaign.read("recipe.toml");
    campaign.edit("recipe.toml", "seed = 1", "seed = 2");
    for (export, stage) in [(tables, "tables"), (hybrid, "hybrid")] {
        let stale = outcome(&campaign, export);
        assert_eq!(stale.code, 0);
        let parts = [stage, "recipe.toml", "realise.seed: 1 -> 2", "`asperity run`"];
        assert!(stale.stderr.starts_with("warning: "), "{}", stale.stderr);
        assert!(parts.iter().all(|part| stale.stderr.contains(part)), "{}", stale.stderr);
        outcome(&campaign, &format!("{export} --quiet")).result();
    }
    campaign.write("recipe.toml", &recipe.replace("[micro]", ""));
    let left_over = outcome(&campaign, hybrid);
    assert!(left_over.stderr.contains("hybrid is left over"), "{}", left_over.stderr);
    outcome(&campaign, &format!("{RUN} --quiet")).result();
    assert_eq!(outcome(&campaign, tables).result(), fresh);
    let left_over = outcome(&campaign, hybrid);
    assert!(left_over.stderr.contains("has no such stage any more"), "{}", left_over.stderr);
    fs::remove_file(campaign.path("recipe.toml")).unwrap();
    let unknown = outcome(&campaign, tables);
    assert_eq!((unknown.code, unknown.stdout), (0, fresh));
    assert!(unknown.stderr.contains("cannot be told"), "{}", unknown.stderr);
}

#[test]
fn tables_that_are_not_there_are_answered_with_those_that_are() {
    let campaign = Campaign::new();
    let error = |arguments: &str| outcome(&campaign, &format!("export {arguments}")).error(2);
    for table in ["", "--table bem/curves"] {
        let message = error(&format!("none --format csv {table}"));
        assert!(message.contains("none does not exist: give the folder of a run"), "{message}");
    }
    outcome(&campaign, &format!("{RUN} --quiet")).result();
    for table in ["nope/x", "bem/x", "bemcurves"] {
        let message = error(&format!("out --format csv --table {table}"));
        assert!(message.contains(&format!("out has no table {table}; it has ")), "{message}");
        assert!(message.contains("bem/curves, ") && message.contains("tables/friction"));
    }
    fs::remove_file(campaign.path("out/bem/curves.arrow")).unwrap();
    let message = error("out --format csv --table bem/curves");
    assert!(message.contains("out/bem/curves.arrow") && message.contains("check the path"));
}
