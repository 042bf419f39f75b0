//! Completions for shells and manual pages.

use std::io;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::output::print;
use super::{Arguments, CliError};

const COMPLETIONS: &str = "\
Examples:
  For bash, in a file that it reads at its start:
    asperity completions bash > ~/.local/share/bash-completion/completions/asperity
  For zsh and fish:
    asperity completions zsh > ~/.zfunc/_asperity
    asperity completions fish > ~/.config/fish/completions/asperity.fish";

const MAN: &str = "\
Examples:
  The manual page of the program, to be read or installed:
    asperity man > asperity.1 && man ./asperity.1
  That of one command:
    asperity man run > asperity-run.1";

/// Print completions of commands and options for a shell.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS)]
pub(super) struct Completions {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError::Failure`] if standard output cannot be written.
    pub(super) fn run(self) -> Result<(), CliError> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "asperity", &mut text);
        print(&String::from_utf8_lossy(&text))
    }
}

/// Print the manual page of the program or of a command.
#[derive(Debug, Args)]
#[command(after_help = MAN)]
pub(super) struct Man {
    /// The command, such as `run` or `solve bem`; the program if not given.
    command: Vec<String>,
}

impl Man {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError::Input`] for a command that does not exist.
    pub(super) fn run(self) -> Result<(), CliError> {
        let mut command = Arguments::command();
        command.build();
        for name in &self.command {
            let found = command.find_subcommand(name).cloned();
            command = found.ok_or_else(|| {
                let known: Vec<&str> =
                    command.get_subcommands().map(clap::Command::get_name).collect();
                CliError::input(format!(
                    "there is no command {name}; {}",
                    super::values::meant(name, &known)
                ))
            })?;
        }
        let mut text = Vec::new();
        let rendered: io::Result<()> = clap_mangen::Man::new(command).render(&mut text);
        rendered.map_err(CliError::failure)?;
        print(&String::from_utf8_lossy(&text))
    }
}
