//! A mesh before and after, side by side, and what commands that want triangles share.

use std::path::PathBuf;

use clap::Args;
use dgp::{
    mesh::{Mesh, TriangulationMethod, triangulate},
    view::{Framing, Mark, Model, Panel, RenderOptions, Scene, Stroke, Style, render},
};

use crate::{cli::Input, failure::Failure, session::Session};

/// More faces than this make a wireframe black.
const WIRED: usize = 20_000;

/// A picture of a mesh before and after.
#[derive(Debug, Args)]
pub(super) struct BeforeAfter {
    /// Draw the mesh before and after into a PNG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

impl BeforeAfter {
    /// A copy of `mesh` as it is before, if a picture was asked for.
    pub(super) fn before(&self, mesh: &Mesh) -> Option<Mesh> {
        self.picture.is_some().then(|| mesh.clone())
    }

    /// Draws both, if a picture was asked for, with `marks` on that after.
    pub(super) fn draw(
        &self,
        session: &mut Session<'_>,
        before: Option<&Mesh>,
        after: &Mesh,
        marks: &[Mark],
    ) -> Result<(), Failure> {
        let (Some(path), Some(before)) = (&self.picture, before) else { return Ok(()) };
        let panels = [("before", before, &[][..]), ("after", after, marks)];
        let panels = panels.map(|(name, mesh, marks)| {
            let wireframe = if mesh.face_count() > WIRED { Stroke::NONE } else { Stroke::THIN };
            let marks = marks.to_vec();
            let style = Style { wireframe, boundary: Stroke::BOLD, marks, ..Style::faceted() };
            Panel::new(
                format!("{name}: {} faces", mesh.face_count()),
                Model { style, ..Model::new(mesh) },
            )
        });
        let scene = Scene { panels: panels.into() };
        let framing = Framing::Shared;
        let options =
            RenderOptions { width: 1200, height: 600, framing, ..RenderOptions::default() };
        let png = session.run("drawing", |progress| {
            Ok::<_, dgp::view::Error>(render(&scene, &options, progress)?.0.to_png())
        })?;
        session.store(path, &png)
    }
}

/// Cuts polygons of `mesh` into triangles, and says so.
pub(super) fn cut_polygons(
    session: &mut Session<'_>,
    input: &Input,
    mesh: &mut Mesh,
) -> Result<(), Failure> {
    if mesh.faces().all(|f| mesh.degree(f) == 3) {
        return Ok(());
    }
    session.warn(format!("{}: polygons are cut into triangles first", input.path.display()));
    session
        .run("triangulating", |p| triangulate(mesh, TriangulationMethod::default(), p))
        .map(drop)
        .map_err(|failure| failure.in_file(&input.path))
}
