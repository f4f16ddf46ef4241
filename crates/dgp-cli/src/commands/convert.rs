//! `dgp convert`: from one format to another, polygons to triangles on request.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::mesh::{
    Error, IndexedFaceSet, Mesh, Progress, TriangulationMethod, triangulate, triangulate_faces,
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp convert`.
#[derive(Debug, Args)]
pub(crate) struct Convert {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Cut polygons into triangles
    #[arg(long, value_enum, value_name = "METHOD", num_args = 0..=1, default_missing_value = "ear")]
    triangulate: Option<Cutting>,
}

/// How a polygon becomes triangles.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Cutting {
    /// All diagonals from the first corner: right for convex polygons
    Fan,
    /// Ears cut off: no triangle inverted in a simple polygon
    #[value(alias = "ears")]
    Ear,
    /// The smallest angle as large as can be (up to 128 corners, then as `ear`)
    Optimal,
    /// The least area in space, for polygons that are not flat (up to 128 corners, then as `ear`)
    LeastArea,
}

impl Convert {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("convert", common);
        let mut document = session.read(&self.input)?;
        let mut report = json!({});
        if let Some(cutting) = self.triangulate {
            let before = document.set.face_count();
            let cut = document.set.faces().iter().filter(|(_, face)| face.len() != 3).count();
            let (set, kind) = session
                .run("triangulating", |progress| {
                    triangles(&document.set, cutting.method(), progress)
                })
                .map_err(|failure| failure.in_file(&self.input.path))?;
            document.set = set;
            report["triangulation"] = json!({
                "method": cutting.to_possible_value().map(|value| value.get_name().to_owned()),
                "faces_before": before,
                "faces_cut": cut,
                "triangles": document.set.face_count(),
                "surface": kind,
            });
        }
        session.write(&self.output, &document)?;
        let summary = format!(
            "{} → {}: {} vertices, {} faces",
            self.input.path.display(),
            self.output.path.display(),
            document.set.vertex_count(),
            document.set.face_count(),
        );
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }
}

impl Cutting {
    fn method(self) -> TriangulationMethod {
        match self {
            Cutting::Fan => TriangulationMethod::Fan,
            Cutting::Ear => TriangulationMethod::Ears,
            Cutting::Optimal => TriangulationMethod::MaxMinAngle,
            Cutting::LeastArea => TriangulationMethod::MinArea,
        }
    }
}

/// The triangles of `set`, and whether it was a manifold, which then it still is: no diagonal joins
/// vertices that have an edge already. Other faces are cut each for itself.
fn triangles(
    set: &IndexedFaceSet,
    method: TriangulationMethod,
    progress: Progress<'_>,
) -> Result<(IndexedFaceSet, Value), Error> {
    if set.faces().is_triangles() {
        return Ok((set.clone(), Value::from("triangles already")));
    }
    match Mesh::new(set) {
        Ok(mut mesh) => {
            triangulate(&mut mesh, method, progress)?;
            Ok((mesh.to_indexed(), Value::from("manifold")))
        }
        Err(Error::NotManifold(_)) => {
            let (set, _) = triangulate_faces(set, method, progress)?;
            Ok((set, Value::from("not manifold")))
        }
        Err(other) => Err(other),
    }
}
