//! The options all commands share.

use std::{num::NonZeroUsize, path::PathBuf};

use clap::{Args, Parser, ValueEnum};
use dgp::{
    io::{Encoding, Format, ReadOptions, WriteOptions},
    mesh::{Id, MAX_ELEMENTS},
};

use crate::commands::Command;

/// Digital geometry processing: reads a mesh or a scan, says what is wrong with it, mends it, smooths
/// it, edits it, converts it, draws it.
///
/// Formats go by extension: obj, ply, stl, off, xyz, pwn. The file `-` is standard input or output.
/// Exit code: 0 done, 1 the data cannot be processed, 2 wrong usage.
#[derive(Debug, Parser)]
#[command(name = "dgp", version, propagate_version = true, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// What all commands understand.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Common options")]
pub(crate) struct Common {
    /// Write the report as JSON to FILE, or to standard output with `-`
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Compute with N threads; results are the same bits for any number
    #[arg(long, global = true, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Seed of everything random
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Print neither the summary nor a progress bar
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

/// A mesh to read.
#[derive(Clone, Debug, Args)]
pub(crate) struct Input {
    /// The mesh to read, `-` for standard input
    #[arg(value_name = "INPUT")]
    pub(crate) path: PathBuf,
    /// Read as this format, whatever the extension
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    pub(crate) format: Option<Format>,
}

/// A mesh to write.
#[derive(Clone, Debug, Args)]
pub(crate) struct Output {
    /// The mesh to write, `-` for standard output
    #[arg(id = "output", long = "output", short = 'o', value_name = "OUTPUT")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    writing: Writing,
}

/// A mesh to write, for commands whose report may be all that is wanted.
#[derive(Clone, Debug, Args)]
pub(crate) struct OptionalOutput {
    /// The mesh to write, `-` for standard output
    #[arg(id = "output", long = "output", short = 'o', value_name = "OUTPUT")]
    path: Option<PathBuf>,
    #[command(flatten)]
    writing: Writing,
}

/// How a mesh is written.
#[derive(Clone, Debug, Args)]
struct Writing {
    /// Write as this format, whatever the extension
    #[arg(long = "output-format", id = "output-format", value_name = "FORMAT", value_parser = format)]
    format: Option<Format>,
    /// How numbers are written; binary by default where the format has it (PLY, STL)
    #[arg(long, value_enum)]
    encoding: Option<EncodingName>,
}

/// How numbers stand in a file.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum EncodingName {
    /// Text that reads back bit for bit
    Text,
    /// Binary, lowest byte first
    Little,
    /// Binary, highest byte first
    Big,
}

impl Input {
    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions { format: self.format }
    }
}

impl Output {
    pub(crate) fn options(&self) -> WriteOptions {
        let encoding = self.writing.encoding.map(|encoding| match encoding {
            EncodingName::Text => Encoding::Text,
            EncodingName::Little => Encoding::LittleEndian,
            EncodingName::Big => Encoding::BigEndian,
        });
        WriteOptions { format: self.writing.format, encoding }
    }
}

impl OptionalOutput {
    /// The output, if one was asked for.
    pub(crate) fn given(&self) -> Option<Output> {
        let path = self.path.clone()?;
        Some(Output { path, writing: self.writing.clone() })
    }
}

fn format(name: &str) -> Result<Format, String> {
    Format::from_name(name).map_err(|error| error.to_string())
}

/// An element by its number or by its name as messages print it: `12`, `v12`, `f12`.
pub(crate) fn id<I: Id>(text: &str) -> Result<I, String> {
    let text = text.trim();
    let letter = &I::KIND[..1];
    let digits = text.strip_prefix(letter).unwrap_or(text);
    let index = digits.parse::<usize>().ok().filter(|&index| index <= MAX_ELEMENTS);
    index.map(I::from_index).ok_or_else(|| {
        format!("`{text}` is no {}: give its number, counted from 0, or {letter}NUMBER", I::KIND)
    })
}

/// So many ids separated by commas.
pub(crate) fn ids<I: Id, const N: usize>(text: &str) -> Result<[I; N], String> {
    let list: Vec<I> = text.split(',').map(id).collect::<Result<_, _>>()?;
    let count = list.len();
    list.try_into().map_err(|_| format!("{N} {} numbers are needed, not {count}", I::KIND))
}

/// So many finite numbers separated by commas.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let number = |part: &str| {
        let x = part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        x.ok_or_else(|| format!("`{part}` is no number"))
    };
    let list: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    let count = list.len();
    list.try_into().map_err(|_| format!("{N} numbers are needed, not {count}"))
}
