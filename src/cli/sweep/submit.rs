//! `asperity sweep submit`.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use clap::Args;

use super::super::output::print;
use super::super::{CliError, values};
use super::PlanPath;
use asperity::sweep::slurm::{DEFAULT_MAX_ARRAY_SIZE, Request, scripts};
use asperity::sweep::{Layout, SweepPlan, read_plan};

const EXAMPLES: &str = "\
Examples:
  An array with an element for each shard, and a job that collects after it:
    asperity sweep submit $PLAN
  To read what would be submitted, or to change it by hand:
    asperity sweep submit $PLAN --dry-run
  Four cores for each element, on a partition of one's own:
    asperity sweep submit $PLAN --cpus 4 --partition short --sbatch=--constraint=avx2";

/// Write job scripts for Slurm and submit them.
///
/// The array is requeued if a node fails; time and memory are three times those predicted. The job that collects
/// runs after all elements have ended, also if some failed, and names what is missing.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Submit {
    #[command(flatten)]
    plan: PlanPath,
    /// Print the scripts and submit nothing.
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    slurm: SlurmOptions,
}

/// Resources of each element.
#[derive(Debug, Args)]
pub(super) struct SlurmOptions {
    /// Cores of each element.
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::one_or_more::<usize>)]
    cpus: usize,
    /// Partition.
    #[arg(long, value_name = "NAME", value_parser = values::line)]
    partition: Option<String>,
    /// Account to be charged.
    #[arg(long, value_name = "NAME", value_parser = values::line)]
    account: Option<String>,
    /// Minutes for each element, instead of three times the prediction.
    #[arg(long, value_name = "MINUTES", value_parser = values::one_or_more::<u32>)]
    minutes: Option<u32>,
    /// Memory of each element in MB, instead of three times the prediction.
    #[arg(long, value_name = "MB", value_parser = values::one_or_more::<u32>)]
    megabytes: Option<u32>,
    /// A further option of sbatch, such as --sbatch=--constraint=avx2; may be given several times.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true, value_parser = values::line)]
    sbatch: Vec<String>,
}

impl SlurmOptions {
    fn request(&self) -> Result<Request, CliError> {
        let program = std::env::current_exe().map_err(CliError::failure)?;
        Ok(Request {
            program: program.display().to_string(),
            cpus: self.cpus,
            partition: self.partition.clone(),
            account: self.account.clone(),
            minutes: self.minutes,
            megabytes: self.megabytes,
            further: self.sbatch.clone(),
        })
    }
}

impl Submit {
    pub(super) fn run(self) -> Result<(), CliError> {
        let path = self.plan.absolute()?;
        let plan = read_plan(&path)?;
        if self.dry_run {
            let scripts = scripts(&path, &plan, &self.slurm.request()?, max_array_size())?;
            return print(&format!("{}\n{}", scripts.array, scripts.collect));
        }
        if plan.tasks() == 0 {
            return Err(CliError::input(
                "no task is missing in this plan: `asperity sweep collect` makes the tables",
            ));
        }
        submit(&path, &plan, &self.slurm)
    }
}

/// Submits the array of a plan and the job that collects after it; prints the numbers of both.
pub(super) fn submit(
    path: &Path,
    plan: &SweepPlan,
    options: &SlurmOptions,
) -> Result<(), CliError> {
    let scripts = scripts(path, plan, &options.request()?, max_array_size())?;
    let logs = Layout::of_plan(path)?.logs();
    std::fs::create_dir_all(&logs)
        .map_err(|error| CliError::failure(format!("cannot create {}: {error}", logs.display())))?;
    let array = sbatch(&[], &scripts.array)?;
    let after = format!("--dependency=afterany:{array}");
    let collect = sbatch(&[&after], &scripts.collect)?;
    print(&format!("array {array}, then collect {collect}; logs in {}\n", logs.display()))
}

/// Hands a script to sbatch and returns the number of the job.
fn sbatch(options: &[&str], script: &str) -> Result<String, CliError> {
    let failed = |why: String| CliError::failure(format!("sbatch: {why}"));
    let mut child = Command::new("sbatch")
        .arg("--parsable")
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| {
            CliError::input(format!(
                "sbatch cannot be started ({error}): submit where Slurm is, or run the shards otherwise \
                 (--dry-run shows the commands)"
            ))
        })?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(script.as_bytes()).map_err(|error| failed(error.to_string()))?;
    }
    let output = child.wait_with_output().map_err(|error| failed(error.to_string()))?;
    if !output.status.success() {
        return Err(failed(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    // "job" or "job;cluster".
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.trim().split(';').next().unwrap_or_default().to_owned())
}

/// Slurm's limit of the elements of an array, or its default if Slurm does not answer.
fn max_array_size() -> usize {
    let output = Command::new("scontrol").args(["show", "config"]).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let lines = text.unwrap_or_default();
    let line = lines.lines().find(|line| line.starts_with("MaxArraySize"));
    line.and_then(|line| line.rsplit('=').next()?.trim().parse().ok())
        .unwrap_or(DEFAULT_MAX_ARRAY_SIZE)
}
