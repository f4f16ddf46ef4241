//! `dgp completions`: what a shell needs to complete commands and options.

use std::process::ExitCode;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::{cli::Cli, failure::Failure, session::print_bytes};

/// Options of `dgp completions`.
///
/// For example `dgp completions bash > ~/.local/share/bash-completion/completions/dgp`, or
/// `dgp completions zsh > _dgp` in a folder of `$fpath`, or
/// `dgp completions fish > ~/.config/fish/completions/dgp.fish`.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self) -> Result<ExitCode, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "dgp", &mut script);
        print_bytes(&script)?;
        Ok(ExitCode::SUCCESS)
    }
}
