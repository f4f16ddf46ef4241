//! `dgp demo`: the whole chain on a scan, into a folder with pictures.

mod chain;
mod page;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use dgp::{
    io::{Document, Format},
    mesh::{Error, IndexedFaceSet, shapes},
};
use serde_json::{Value, json};

use self::chain::Chain;
use super::create_folder;
use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// Options of `dgp demo`.
#[derive(Debug, Args)]
pub(crate) struct Demo {
    /// A mesh to run it on, in place of the built-in scans; `-` for standard input
    #[arg(value_name = "INPUT")]
    input: Option<PathBuf>,
    /// Read as this format, whatever the extension
    #[arg(long, value_name = "FORMAT", value_parser = |name: &str| Format::from_name(name).map_err(|e| e.to_string()))]
    format: Option<Format>,
    /// The folder to write
    #[arg(long, short, value_name = "FOLDER", default_value = "demo")]
    output: PathBuf,
    /// The built-in shape that is made to look like a scan
    #[arg(long, value_enum, default_value_t = Shape::All)]
    shape: Shape,
    /// How fine the built-in shapes are: each level has four times the triangles, 6 some 80,000
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(2..=9))]
    level: u8,
}

/// A built-in shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// All of them
    All,
    /// A tube in a trefoil knot
    Knot,
    /// A ball with bumps
    Blob,
    /// A surface with three handles
    Handles,
}

impl Shape {
    /// The single shapes, by name.
    fn parts(self) -> Vec<(Shape, &'static str)> {
        let all = [(Shape::Knot, "knot"), (Shape::Blob, "blob"), (Shape::Handles, "handles")];
        all.into_iter().filter(|&(shape, _)| self == Shape::All || self == shape).collect()
    }

    /// The shape as a careless scanner sees it.
    fn scan(self, level: u8, seed: u64) -> Result<IndexedFaceSet, Error> {
        let level = usize::from(level);
        let shape = match self {
            // About four times as long around as across, and 20·4ˡ triangles as the others have.
            Shape::All | Shape::Knot => shapes::trefoil(20 << (level - 1), 1 << level)?,
            Shape::Blob => shapes::blob(level)?,
            Shape::Handles => shapes::surface_of_genus(3, level - 1)?,
        };
        shapes::like_a_scan(&shape, seed)
    }
}

impl Demo {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("demo", common);
        create_folder(&self.output)?;
        let mut chains = Vec::new();
        match &self.input {
            Some(path) => {
                let input = Input { path: path.clone(), format: self.format };
                let document = session.read(&input)?;
                let name = path.file_stem().map_or("input".into(), |name| name.to_string_lossy());
                chains.push(Chain::run(&mut session, &self.output, &plain(&name), document)?);
            }
            None => {
                for (shape, name) in self.shape.parts() {
                    let scan = session.run("scanning", |_| shape.scan(self.level, common.seed))?;
                    let document = Document::from(scan);
                    chains.push(Chain::run(&mut session, &self.output, name, document)?);
                }
            }
        }
        let index = self.output.join("index.html");
        let page = page::page(&chains);
        session.write_bytes(&index, page.as_bytes(), folder(&self.output))?;
        let mut lines: Vec<String> =
            chains.iter().map(|chain| format!("{}: {}", chain.name, chain.sentence)).collect();
        lines.push(format!("{}; open {}", session.spent(), index.display()));
        let report: Value = chains.iter().map(Chain::to_json).collect();
        session.finish(&lines.join("\n"), &json!({"chains": report}))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn folder(path: &Path) -> Value {
    json!({"path": path.to_string_lossy()})
}

/// A name that is safe in file names and links.
fn plain(name: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '-' };
    name.chars().map(safe).collect()
}
