//! The command line: arguments, printing, exit codes.
//!
//! Results go to standard output, everything else to standard error. Exit code 0 is success, 1 a
//! failed computation or an output that could not be written, 2 bad input, 130 an interrupt.
//!
//! | module | what it holds |
//! |---|---|
//! | `adhesion` | the shear stress of the contact area from measured friction |
//! | `compare` | which of two runs has more friction |
//! | `convert` | scans from one format to another |
//! | `cutoff` | friction over the shortest wavelength |
//! | `error` | errors with their exit codes |
//! | `export` | friction tables for people and other programs |
//! | `figure_file` | figures as files, SVG or PNG |
//! | `init` | a folder to start in |
//! | `inspect` | what is in a file or folder |
//! | `interrupt` | Ctrl-C, and the signal by which a scheduler ends a job, for commands that have something to clean up; the others simply end |
//! | `last_run` | the note of the last run: the recipe from which the results of a run folder were computed, so that `export` can tell whether they are up to date |
//! | `output` | standard output and files |
//! | `plan` | what a recipe will compute, before it runs |
//! | `plot` | single figures of a run |
//! | `progress` | progress bars, on a terminal and for what takes more than a second |
//! | `recipe_options` | what `run` and `status` have in common: the recipe, the scans, the run folder |
//! | `report` | everything about a run in one file |
//! | `rubber` | a rubber file from measured moduli |
//! | `run` | a recipe from scans to tables |
//! | `run_folder` | the run folder that a command reads |
//! | `shell` | completions for shells and manual pages |
//! | `solve` | a single contact problem |
//! | `status` | which results are up to date |
//! | `sweep` | many cases on many machines |
//! | `synth` | synthetic scans of asphalt |
//! | `theory` | what older theories predict, without a contact being solved |
//! | `threads` | the threads of a command |
//! | `validate` | measured friction beside what is computed for it |
//! | `values` | parsers of single option values |
//! | `verify` | whether the files of a run folder are unchanged |
//! | `water` | pools that a rubber seals, and the film under a block |

mod adhesion;
mod compare;
mod convert;
mod cutoff;
mod error;
mod export;
mod figure_file;
mod init;
mod inspect;
mod interrupt;
mod last_run;
mod output;
mod plan;
mod plot;
mod progress;
mod recipe_options;
mod report;
mod rubber;
mod run;
mod run_folder;
mod shell;
mod solve;
mod status;
mod sweep;
mod synth;
mod theory;
mod threads;
mod validate;
mod values;
mod verify;
mod water;

pub use error::CliError;

use clap::{Parser, Subcommand};

const EXIT_CODES: &str = "\
Exit codes of every command: 0 success, 1 a computation failed or its result could not be written, 2 an option, a recipe or a file cannot be used, \
130 interrupted.";

/// Hysteretic rubber friction on asphalt: profilometer scans in, friction tables with error bars
/// out.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// Print results and errors only: no warnings, no notes.
    #[arg(long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Init(init::Init),
    Run(run::Run),
    Status(status::Status),
    #[command(name = "plan")]
    Plan(plan::PlanCommand),
    #[command(subcommand)]
    Sweep(sweep::Sweep),
    Export(export::Export),
    Report(report::Report),
    Plot(plot::Plot),
    Compare(compare::Compare),
    #[command(name = "cutoff")]
    Cutoff(cutoff::CutoffCommand),
    /// Solve a single contact problem, without a recipe.
    #[command(subcommand)]
    Solve(solve::Solve),
    /// Predict friction by an older theory, without a contact being solved.
    #[command(subcommand)]
    Theory(theory::Theory),
    /// Make a rubber from measured moduli.
    #[command(subcommand)]
    Rubber(rubber::Rubber),
    /// Find the shear stress of the contact area.
    #[command(subcommand)]
    Adhesion(adhesion::Adhesion),
    Validate(validate::Validate),
    #[command(name = "water")]
    Water(Box<water::WaterCommand>),
    Synth(synth::Synth),
    Inspect(inspect::Inspect),
    Convert(convert::Convert),
    Verify(verify::Verify),
    Completions(shell::Completions),
    Man(shell::Man),
}

impl Arguments {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`], whose exit code tells bad input from a failed computation.
    pub fn run(self) -> Result<(), CliError> {
        match self.command {
            Command::Run(command) => command.run(self.quiet),
            Command::Status(command) => command.run(),
            Command::Plan(command) => command.run(self.quiet),
            Command::Sweep(command) => command.run(self.quiet),
            Command::Export(command) => command.run(self.quiet),
            Command::Report(command) => command.run(self.quiet),
            Command::Plot(command) => command.run(self.quiet),
            Command::Compare(command) => command.run(self.quiet),
            Command::Cutoff(command) => command.run(self.quiet),
            Command::Solve(command) => command.run(self.quiet),
            Command::Theory(command) => command.run(self.quiet),
            Command::Rubber(command) => command.run(self.quiet),
            Command::Adhesion(command) => command.run(self.quiet),
            Command::Validate(command) => command.run(self.quiet),
            Command::Water(command) => command.run(self.quiet),
            Command::Synth(command) => command.run(self.quiet),
            Command::Inspect(command) => command.run(),
            Command::Convert(command) => command.run(self.quiet),
            Command::Init(command) => command.run(self.quiet),
            Command::Verify(command) => command.run(),
            Command::Completions(command) => command.run(),
            Command::Man(command) => command.run(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_of_the_arguments_is_consistent() {
        Arguments::command().debug_assert();
    }

    /// Where help lacks an example, a user has to guess the units.
    #[test]
    fn every_command_has_examples() {
        fn check(command: &clap::Command) {
            if command.has_subcommands() {
                command.get_subcommands().for_each(check);
            } else {
                let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
                let example = format!(" {} ", command.get_name());
                assert!(help.contains("Examples:") && help.contains(&example), "{example}");
            }
        }
        check(&Arguments::command());
    }
}
