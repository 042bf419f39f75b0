//! Job scripts for Slurm: an array with an element for each shard, and a job that collects after it.

use super::{Layout, SweepError, SweepPlan};
use std::fmt::Write;
use std::path::Path;

/// Elements of an array where nothing else is known: Slurm's default `MaxArraySize` of 1001.
pub const DEFAULT_MAX_ARRAY_SIZE: usize = 1001;
/// Time and memory are asked for with this margin: predictions are good within a factor of two.
const MARGIN: f64 = 3.0;
/// No job asks for less than this time in minutes and memory in MB.
const LEAST_MINUTES: f64 = 10.0;
const LEAST_MEGABYTES: f64 = 500.0;

/// What the scripts ask for besides what the plan predicts.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// The program, with its path.
    pub program: String,
    /// Cores of an element.
    pub cpus: usize,
    /// Partition, if not the default one.
    pub partition: Option<String>,
    /// Account, if one is to be charged.
    pub account: Option<String>,
    /// Minutes for an element, in place of the prediction.
    pub minutes: Option<u32>,
    /// Megabytes for an element, in place of the prediction.
    pub megabytes: Option<u32>,
    /// Further arguments of `sbatch`, a line each.
    pub further: Vec<String>,
}

impl Request {
    /// The options of `asperity sweep submit` that ask for the same.
    fn arguments(&self) -> Vec<String> {
        let mut arguments = vec![format!("--cpus={}", self.cpus.max(1))];
        let named = [
            ("partition", self.partition.clone()),
            ("account", self.account.clone()),
            ("minutes", self.minutes.map(|minutes| minutes.to_string())),
            ("megabytes", self.megabytes.map(|megabytes| megabytes.to_string())),
        ];
        let named = named.into_iter().filter_map(|(o, v)| Some(format!("--{o}={}", v?)));
        arguments.extend(named);
        arguments.extend(self.further.iter().map(|further| format!("--sbatch={further}")));
        arguments
    }
}

/// The two job scripts of a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scripts {
    /// The array: one element for each shard, requeued when its node fails.
    pub array: String,
    /// The job after it, whatever came of its elements: it collects, or names what is missing; what follows from
    /// the results is planned and submitted as the next array.
    pub collect: String,
}

/// The scripts of the plan at `path`, which is absolute.
///
/// # Errors
/// [`SweepError::Slurm`] for more shards than an array takes.
pub fn scripts(
    path: &Path,
    plan: &SweepPlan,
    request: &Request,
    max_array_size: usize,
) -> Result<Scripts, SweepError> {
    let shards = plan.shards.len();
    // The largest index is one less than MaxArraySize.
    if shards > max_array_size {
        return Err(SweepError::Slurm(format!(
            "the plan has {shards} shards, arrays here take {max_array_size} elements (MaxArraySize): plan again \
             with --shards {max_array_size}"
        )));
    }
    let longest = plan.seconds().fold(0.0, f64::max) / request.cpus.max(1) as f64;
    let minutes = (MARGIN * longest / 60.0).max(LEAST_MINUTES).ceil();
    let minutes = request.minutes.map_or(minutes, f64::from);
    let megabytes = (MARGIN * plan.megabytes(request.cpus.max(1))).max(LEAST_MEGABYTES).ceil();
    let megabytes = request.megabytes.map_or(megabytes, f64::from);
    let logs = Layout::of_plan(path)?.logs();
    let (program, plan_path) = (shell_word(&request.program), shell_path(path));
    let log = |name: &str| quoted_option(&logs.join(name));
    let mut array = header("asperity", minutes, megabytes, request);
    // Writing to a string cannot fail.
    let _ = writeln!(array, "#SBATCH --array=0-{}", shards.saturating_sub(1));
    let _ = writeln!(array, "#SBATCH --requeue");
    let _ = writeln!(array, "#SBATCH --output={}", log("%A_%a.log"));
    let _ = writeln!(array, "exec {program} sweep run {plan_path}");
    let mut collect = header("asperity-collect", minutes, megabytes, request);
    let _ = writeln!(collect, "#SBATCH --requeue");
    let _ = writeln!(collect, "#SBATCH --output={}", log("%j_collect.log"));
    let further: String =
        request.arguments().iter().map(|word| format!(" {}", shell_word(word))).collect();
    let _ = writeln!(collect, "exec {program} sweep collect {plan_path} --submit-next{further}");
    Ok(Scripts { array, collect })
}

fn header(name: &str, minutes: f64, megabytes: f64, request: &Request) -> String {
    let mut text = format!(
        "#!/bin/sh\n#SBATCH --job-name={name}\n#SBATCH --time={minutes}\n#SBATCH --mem={megabytes}M\n\
         #SBATCH --cpus-per-task={}\n#SBATCH --open-mode=append\n",
        request.cpus.max(1)
    );
    let named = [("partition", &request.partition), ("account", &request.account)];
    for (option, value) in named.into_iter().filter_map(|(o, v)| Some((o, v.as_ref()?))) {
        let _ = writeln!(text, "#SBATCH --{option}={value}");
    }
    for further in &request.further {
        let _ = writeln!(text, "#SBATCH {further}");
    }
    text
}

/// A text as one word of a shell.
pub fn shell_word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:=@,".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// A path as one word of a POSIX shell, also one that is not UTF-8: `printf` then makes its bytes.
pub fn shell_path(path: &Path) -> String {
    if let Some(text) = path.to_str() {
        return shell_word(text);
    }
    let byte = |byte: &u8| match byte {
        plain if plain.is_ascii_alphanumeric() || b"/._-".contains(plain) => {
            char::from(*plain).to_string()
        }
        other => format!("\\{other:03o}"),
    };
    let bytes: String = path.as_os_str().as_encoded_bytes().iter().map(byte).collect();
    format!("\"$(printf '{bytes}')\"")
}

/// One word of an `#SBATCH` line, where a blank ends the option and `%` begins a pattern.
fn quoted_option(path: &Path) -> String {
    let text = path.display().to_string();
    if text.contains([' ', '\'']) { format!("\"{text}\"") } else { text }
}
