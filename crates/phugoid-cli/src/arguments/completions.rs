//! `phugoid completions` and `phugoid man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

use super::help::examples_and_exit_codes;

/// Prints a script with which a shell completes the commands and options of this program
///
/// The script fits this build: its commands, options, methods and formats. Make it again after an update.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid completions bash > ~/.local/share/bash-completion/completions/phugoid
  phugoid completions zsh > ~/.zfunc/_phugoid          a folder of $fpath
  phugoid completions fish > ~/.config/fish/completions/phugoid.fish
  phugoid completions powershell >> $PROFILE"
))]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub(crate) shell: Shell,
}

/// Prints the manual page of this program, or writes the pages of all commands
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid man | man -l -                               read it
  phugoid man estimate | man -l -                      the page of one command
  phugoid man --out ~/.local/share/man/man1            then: man phugoid-estimate"
))]
pub(crate) struct Man {
    /// The command whose page is printed, for a command of a command with both names: `fleet tell` [default: the
    /// program itself]
    #[arg(value_name = "COMMAND", conflicts_with = "out")]
    pub(crate) command: Vec<String>,
    /// Write the pages of the program and of every command to this folder, phugoid.1, phugoid-estimate.1 and so on,
    /// instead of printing one; other files of the folder stay
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}
