//! `dgp manual`: manual pages, from the same descriptions as `--help`.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;

use super::create_folder;
use crate::{cli::Cli, failure::Failure, session::print_bytes};

/// Options of `dgp manual`.
///
/// `dgp manual | man -l -` shows the page.
#[derive(Debug, Args)]
pub(crate) struct Manual {
    /// The command to describe; without it the page lists all
    #[arg(value_name = "COMMAND", conflicts_with = "output")]
    command: Option<String>,
    /// Write all pages into this folder: dgp.1, dgp-info.1, …
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

impl Manual {
    pub(crate) fn run(&self) -> Result<ExitCode, Failure> {
        let mut whole = Cli::command();
        whole.build();
        if let Some(folder) = &self.output {
            create_folder(folder)?;
            for command in std::iter::once(&whole).chain(whole.get_subcommands()) {
                let name = command.get_display_name().unwrap_or(command.get_name());
                dgp::io::write_whole(folder.join(format!("{name}.1")), &page(command)?)?;
            }
            return Ok(ExitCode::SUCCESS);
        }
        let command = match &self.command {
            None => &whole,
            Some(name) => whole.find_subcommand(name).ok_or_else(|| {
                Failure::Usage(format!("there is no command `{name}`; `dgp --help` lists them"))
            })?,
        };
        print_bytes(&page(command)?)?;
        Ok(ExitCode::SUCCESS)
    }
}

/// The page of a command as a file for `man`.
fn page(command: &Command) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let rendered = Man::new(command.clone()).render(&mut bytes);
    rendered.map_err(|source| Failure::Pipe { what: "manual page", source })?;
    Ok(bytes)
}
