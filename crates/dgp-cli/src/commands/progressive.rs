//! `dgp progressive`: all levels of detail of a mesh in one file, and back.

use std::{path::Path, process::ExitCode};

use clap::Args;
use dgp::{
    io::Document,
    remesh::{ProgressiveMesh, QuadricOptions, Target},
};
use serde_json::json;

use super::{
    before_after::cut_polygons,
    decimate::{Amount, amount},
};
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// The extension of files of progressive meshes.
const EXTENSION: &str = "dgpp";

/// Options of `dgp progressive`.
///
/// A file whose name ends in `.dgpp` is a progressive mesh, as input and as output: coarse levels come first, so
/// that it can be shown while it arrives. Of any other mesh one is made; the finest level is the mesh itself, bit for
/// bit. Data of vertices are kept at every level, and those of corners where no seam is.
#[derive(Debug, Args)]
pub(crate) struct Progressive {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Faces of the base, or a percentage of those there are, where a progressive mesh is made
    #[arg(long, value_name = "N|P%", value_parser = amount, default_value = "1%")]
    base: Amount,
    /// Write the level after N vertex splits, or after P% of all; the finest unless told
    #[arg(long, value_name = "N|P%", value_parser = amount, conflicts_with = "faces")]
    level: Option<Amount>,
    /// Write the finest level of at most N faces, or of P% of the finest's
    #[arg(long, value_name = "N|P%", value_parser = amount)]
    faces: Option<Amount>,
}

impl Progressive {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("progressive", common);
        let path = &self.input.path;
        let mut levels =
            if is_progressive(path) { self.read(&mut session)? } else { self.make(&mut session)? };
        let finest = levels.face_count();
        let level = match (self.level, self.faces) {
            (Some(level), _) => level.count(levels.level_count()),
            (_, Some(faces)) => levels.level_of_faces(faces.count(finest)),
            _ => levels.level_count(),
        };
        let target = &self.output.path;
        if is_progressive(target) {
            if self.level.is_some() || self.faces.is_some() {
                let what =
                    "--level and --faces choose a level for a mesh to write; a .dgpp file has all";
                return Err(Failure::Usage(what.to_owned()));
            }
            let bytes = session.run("packing", |_| Ok::<_, Failure>(levels.to_bytes()))?;
            let described = json!({
                "path": target.to_string_lossy(),
                "bytes": bytes.len(),
            });
            session.write_bytes(target, &bytes, described)?;
        } else {
            session
                .run("changing the level", |_| levels.set_level(level))
                .map_err(|failure| failure.in_file(path))?;
            let set = levels.mesh()?.to_indexed();
            session.write(&self.output, &Document { set, ..Document::default() })?;
        }
        let [vertices, faces] = levels.base_counts();
        let summary = format!(
            "{} → {}: {vertices} vertices and {faces} faces, then {} splits; level {} of them has {} and {}",
            path.display(),
            target.display(),
            levels.level_count(),
            levels.level(),
            levels.vertex_count(),
            levels.face_count(),
        );
        let report = json!({
            "base": {"vertices": vertices, "faces": faces},
            "levels": levels.level_count(),
            "level": levels.level(),
            "vertices": levels.vertex_count(),
            "faces": levels.face_count(),
            "attributes": levels.column_names().collect::<Vec<_>>(),
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn read(&self, session: &mut Session<'_>) -> Result<ProgressiveMesh, Failure> {
        let path = &self.input.path;
        session.read_file(
            path,
            |bytes| Ok(ProgressiveMesh::from_bytes(bytes)?),
            |levels| {
                json!({
                    "path": path.to_string_lossy(),
                    "format": EXTENSION,
                    "vertices": levels.vertex_count(),
                    "faces": levels.face_count(),
                })
            },
        )
    }

    fn make(&self, session: &mut Session<'_>) -> Result<ProgressiveMesh, Failure> {
        let path = &self.input.path;
        let document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        cut_polygons(session, &self.input, &mut mesh)?;
        let target = Target::Faces(self.base.count(mesh.face_count()));
        let options = QuadricOptions::default();
        let levels = session
            .run("decimating", |p| ProgressiveMesh::new(&mesh, target, &options, p))
            .map_err(|failure| failure.in_file(path))?;
        for what in levels.left_out() {
            session.warn(format!("{}: levels do not have {what}", path.display()));
        }
        Ok(levels)
    }
}

fn is_progressive(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}
