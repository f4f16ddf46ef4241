//! `dgp param`: lays a surface out in the plane.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    laplace::intrinsic::{IntrinsicOptions, intrinsic_delaunay},
    mesh::{DVec2, Mesh, Progress, UV, VertexId, VertexMap},
    param::{
        DistortionReport, Outline, Spread, Weights, boundary_crossings, convex_boundary,
        disk_boundary, distortion, face_distortions, least_squares_conformal, map_to_boundary,
        map_with_laplacian,
    },
    view::{ColorMap, Field, Model, Paint, Panel, RenderOptions, Scalars, Scene, Style, render},
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::scalars::Pictured,
    failure::Failure,
    session::Session,
};

/// Options of `dgp param`.
///
/// The output has texture coordinates, or is the layout itself (`--flat`). The surface must be one piece without
/// handles and have a boundary; of several rims the longest is the boundary, and the others stay open.
#[derive(Debug, Args)]
pub(crate) struct Param {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    pictured: Pictured,
    /// How vertices find their place
    #[arg(long, value_enum, default_value_t = Method::MeanValue)]
    method: Method,
    /// Where the boundary goes, but for `lscm`, which leaves it free
    #[arg(long, value_enum, default_value_t = Shape::Circle)]
    boundary: Shape,
    /// Write the layout as a mesh in the plane z = 0
    #[arg(long)]
    flat: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// The mean of the neighbors: never folds, keeps no shape (Tutte 1963)
    Tutte,
    /// By cotangents: little stretched, may fold where triangles are obtuse (Eck 1995)
    Harmonic,
    /// By cotangents of the intrinsic Delaunay triangulation, which are not negative inside
    IntrinsicHarmonic,
    /// By tangents of half angles: never folds, nearly harmonic (Floater 2003)
    MeanValue,
    /// Angles kept as well as possible, the boundary free (Lévy 2002)
    Lscm,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shape {
    /// The circle in the unit square
    Circle,
    /// The unit square
    Square,
}

impl Param {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("param", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let (rim, map) = session
            .run("laying out", |progress| self.map(&mesh, progress))
            .map_err(|failure| failure.in_file(path))?;
        let report = distortion(&mesh, &map).map_err(|e| Failure::from(e).in_file(path))?;
        let points: Vec<DVec2> = rim.iter().map(|&v| map[v]).collect();
        let crossings = boundary_crossings(&points).len();
        self.draw(&mut session, &mesh, &map)?;
        if let Some(output) = self.output.given() {
            if self.flat {
                mesh.set_positions(map.map(|p| p.extend(0.0)));
            } else {
                let data = mesh.attributes_mut();
                data.corner.remove(UV);
                data.vertex.insert(UV, map);
            }
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
        }
        let summary = format!(
            "{}: {} faces turned over, {} flat, boundary crosses itself {crossings} times; angles {:.4} \
             (at most {:.3}), areas {:.4} (at most {:.3}), 1 being undistorted",
            path.display(),
            report.flipped,
            report.flat,
            report.conformal.mean,
            report.conformal.max,
            report.areal.mean,
            report.areal.max,
        );
        session.finish(&summary, &to_json(&report, rim.len(), crossings))?;
        Ok(ExitCode::SUCCESS)
    }

    /// The boundary, and where each vertex goes.
    fn map(
        &self,
        mesh: &Mesh,
        progress: Progress<'_>,
    ) -> Result<(Vec<VertexId>, VertexMap<DVec2>), Failure> {
        let rim = disk_boundary(mesh)?;
        if self.method == Method::Lscm {
            let map = least_squares_conformal(mesh, &[], progress)?;
            return Ok((rim, map));
        }
        let outline = match self.boundary {
            Shape::Circle => Outline::Circle,
            Shape::Square => Outline::Square,
        };
        let held = convex_boundary(mesh, &rim, &outline)?;
        let weights = match self.method {
            Method::Tutte => Weights::Uniform,
            Method::Harmonic => Weights::Harmonic,
            Method::MeanValue | Method::Lscm => Weights::MeanValue,
            Method::IntrinsicHarmonic => {
                let options = IntrinsicOptions::default();
                let intrinsic = intrinsic_delaunay(mesh, &options, progress.part(0.0, 0.2))?;
                let rest = progress.part(0.2, 1.0);
                let map = map_with_laplacian(&intrinsic.laplacian, &rim, &held, rest)?;
                return Ok((rim, map));
            }
        };
        let map = map_to_boundary(mesh, &rim, &held, weights, progress)?;
        Ok((rim, map))
    }

    /// The surface and its layout, colored by how much angles are distorted.
    fn draw(
        &self,
        session: &mut Session<'_>,
        mesh: &Mesh,
        map: &VertexMap<DVec2>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.pictured.picture else { return Ok(()) };
        let faces = face_distortions(mesh, map)?;
        // Faces that are turned over have no color.
        let shown = faces.map(|face| {
            let value = face.conformal();
            if value >= 1.0 { value.ln() } else { f64::NAN }
        });
        let mut layout = mesh.clone();
        layout.set_positions(map.map(|p| p.extend(0.0)));
        let panel = |name: &str, mesh| {
            let scalars =
                Scalars { map: ColorMap::Viridis, ..Scalars::new(Field::Faces(shown.clone())) };
            let style = Style { paint: Paint::Scalars(scalars), ..Style::default() };
            Panel::new(name.to_owned(), Model { style, ..Model::new(mesh) })
        };
        let scene = Scene {
            panels: vec![panel("log of angle distortion", mesh), panel("layout", &layout)],
        };
        let png = session.run("drawing", |progress| {
            let (image, _) = render(&scene, &RenderOptions::default(), progress)?;
            Ok::<_, dgp::view::Error>(image.to_png())
        })?;
        session.store(path, &png)
    }
}

fn to_json(report: &DistortionReport, boundary: usize, crossings: usize) -> Value {
    let spread =
        |spread: Spread| json!({"min": spread.min, "mean": spread.mean, "max": spread.max});
    json!({
        "boundary_vertices": boundary,
        "boundary_crossings": crossings,
        "flipped": report.flipped,
        "flat": report.flat,
        "area": report.area,
        "mapped_area": report.mapped_area,
        "conformal": spread(report.conformal),
        "areal": spread(report.areal),
        "symmetric_dirichlet": spread(report.symmetric_dirichlet),
        "stretch": report.stretch,
        "largest_stretch": report.largest_stretch,
    })
}
