//! Tasks for contributors, run as `cargo xtask`: what makes the evidence pages of `docs`.
//!
//! Results go to standard output, all else to standard error. Exit code 0 is success, 1 a failed
//! computation or an output that could not be written, 2 bad input.

mod bench;
mod error;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Tasks for contributors to asperity.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", arg_required_else_help = true)]
struct Arguments {
    /// Print results and errors only.
    #[arg(long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    Bench(bench::command::Bench),
}

fn main() -> ExitCode {
    let Arguments { quiet, task } = Arguments::parse();
    let Task::Bench(bench) = task;
    match bench.run(quiet) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
