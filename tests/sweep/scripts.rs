//! Job scripts, as far as they can be seen without Slurm; `scripts/check_slurm.py` runs them on one.

use super::{campaign, plan, quietly};

#[test]
fn a_dry_run_prints_an_array_and_what_comes_after_it() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 7);
    let options = "--cpus 4 --partition short --sbatch=--constraint=avx2 --minutes 30";
    let text = quietly(&campaign, &format!("sweep submit {plan} --dry-run {options}")).result();
    for line in [
        "#SBATCH --array=0-6",
        "#SBATCH --requeue",
        "#SBATCH --time=30",
        "#SBATCH --cpus-per-task=4",
        "#SBATCH --partition=short",
        "#SBATCH --constraint=avx2",
    ] {
        assert!(text.contains(line), "{line} in\n{text}");
    }
    assert!(text.contains(&format!("sweep run {plan}\n")), "{text}");
    // What follows is asked for with the same options.
    assert!(text.contains("--submit-next --cpus=4 --partition=short"), "{text}");
    assert!(!campaign.path("out/logs").exists());
}

#[test]
fn more_shards_than_an_array_takes_are_refused() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 1002);
    let error = quietly(&campaign, &format!("sweep submit {plan} --dry-run")).error(2);
    assert!(error.contains("1002 shards") && error.contains("MaxArraySize"), "{error}");
}

#[test]
fn without_slurm_a_submission_says_so() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 2);
    let mut command = campaign.command(&format!("--quiet sweep submit {plan}"));
    let error = crate::outcome::Outcome::of(command.env("PATH", "")).error(2);
    assert!(error.contains("sbatch cannot be started"), "{error}");
}

#[test]
fn folders_with_blanks_and_quotes_are_one_word() {
    let campaign = campaign();
    let out = "it's a study";
    let mut command = campaign.command("--quiet sweep plan recipe.toml --shards 2 --out");
    let plan = crate::outcome::Outcome::of(command.arg(out)).result();
    let mut command = campaign.command("--quiet sweep submit --dry-run");
    let text = crate::outcome::Outcome::of(command.arg(plan.trim())).result();
    assert!(text.contains(&plan.trim().replace('\'', r"'\''")), "{text}");
    let output = text.lines().find(|line| line.starts_with("#SBATCH --output=")).unwrap();
    assert!(
        output.contains("=\"/") && output.ends_with("it's a study/logs/%A_%a.log\""),
        "{output}"
    );
    let scripts = campaign.path("script.sh");
    std::fs::write(&scripts, text).unwrap();
    assert!(std::process::Command::new("sh").arg("-n").arg(scripts).status().unwrap().success());
}
