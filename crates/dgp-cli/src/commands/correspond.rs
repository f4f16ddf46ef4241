//! `dgp correspond`: which point of one shape is which of another.

use std::{fmt::Write, path::PathBuf, process::ExitCode};

use clap::Args;
use dgp::{
    laplace::{
        self,
        spectral::{
            Eigenbasis, FunctionalMap, FunctionalMapOptions, ZoomOut, ZoomOutOptions,
            functional_map, heat_kernel, heat_kernel_diagonal, signature_times, zoomout,
        },
    },
    mesh::{COLOR, Color, DVec3, Mesh, Progress, VertexId, VertexMap, measure::bounding_box},
    view::{Field, Model, Paint, Panel, RenderOptions, Scene, Style, render},
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput, ids},
    commands::{
        scalars::csv,
        spectrum::{Operator, eigen_options},
    },
    failure::Failure,
    session::Session,
};

/// The vertex attribute of the second mesh that names a vertex of the first.
const CORRESPONDS: &str = "corresponds_to";

/// Options of `dgp correspond`.
///
/// Heat kernel signatures, and heat from the landmarks if there are any, give a functional map between the
/// first waves (Ovsjanikov et al. 2012), which ZoomOut refines (Melzi et al. 2019). For shapes that bend
/// without stretching, such as poses. The output is the second mesh with the vertex attribute
/// `corresponds_to`, the vertex of the first, and the colors that the first has by position.
#[derive(Debug, Args)]
pub(crate) struct Correspond {
    /// The mesh that colors come from
    #[arg(value_name = "FIRST")]
    first: PathBuf,
    /// The mesh whose vertices get partners on it
    #[arg(value_name = "SECOND")]
    second: PathBuf,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    operator: Operator,
    /// A vertex of the first mesh and its partner on the second; may be given several times. Without any, a
    /// symmetric shape may be mapped to its mirror image
    #[arg(long = "landmark", value_name = "V,W", value_parser = ids::<VertexId, 2>)]
    landmarks: Vec<[VertexId; 2]>,
    /// How many waves in the end
    #[arg(long, value_name = "K", default_value_t = 60)]
    count: usize,
    /// How many waves the first map is of
    #[arg(long, value_name = "K", default_value_t = 12)]
    start: usize,
    /// How many waves more in each round
    #[arg(long, value_name = "N", default_value_t = 2)]
    step: usize,
    /// At how many times signatures are compared
    #[arg(long, value_name = "N", default_value_t = 30)]
    signatures: usize,
    /// How many vertices are looked at until the last round
    #[arg(long, value_name = "N", default_value_t = 1000)]
    samples: usize,
    /// Write the first mesh with its colors
    #[arg(long, value_name = "MESH")]
    first_output: Option<PathBuf>,
    /// Write each vertex of the second mesh with its partner
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the map between waves, a row for each wave of the second mesh
    #[arg(long, value_name = "FILE")]
    matrix: Option<PathBuf>,
    /// Draw both meshes in the colors of the first into this PNG
    #[arg(long, value_name = "PNG")]
    picture: Option<PathBuf>,
}

impl Correspond {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        if self.start == 0 || self.start > self.count {
            let message = "--start must be at least 1 and at most --count";
            return Err(Failure::Usage(message.to_owned()));
        }
        let mut session = Session::new("correspond", common);
        let [first, second] =
            [&self.first, &self.second].map(|path| Input { path: path.clone(), format: None });
        let mut one = session.read(&first)?;
        let mut two = session.read(&second)?;
        let mut a = session.mesh(&first, &one)?;
        let mut b = session.mesh(&second, &two)?;
        for &[v, w] in &self.landmarks {
            Failure::need(v, a.vertex_count()).map_err(|e| e.in_file(&self.first))?;
            Failure::need(w, b.vertex_count()).map_err(|e| e.in_file(&self.second))?;
        }
        let mut basis = |mesh: &Mesh, path: &PathBuf| {
            let work = |progress: Progress<'_>| self.basis(mesh, common, progress);
            session.run("solving", work).map_err(|failure| failure.in_file(path))
        };
        let (phi, psi) = (basis(&a, &self.first)?, basis(&b, &self.second)?);
        let found = session.run("matching", |progress| self.find(&phi, &psi, progress))?;

        let colors = colors(&a);
        let moved = found.points.map(|&v| colors[v]);
        if let Some(path) = &self.csv {
            let rows = found.points.iter().map(|(w, v)| vec![w.index() as f64, v.index() as f64]);
            session.store(path, csv(&["vertex", CORRESPONDS], rows).as_bytes())?;
        }
        if let Some(path) = &self.matrix {
            let names: Vec<String> = (0..found.map.columns).map(|j| format!("wave_{j}")).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let rows = found.map.entries.chunks(found.map.columns).map(<[f64]>::to_vec);
            session.store(path, csv(&names, rows).as_bytes())?;
        }
        if let Some(path) = &self.picture {
            let png = session.run("drawing", |progress| {
                let panel = |mesh, colors: &VertexMap<Color>, caption: &str| {
                    let paint = Paint::Colors(Field::Vertices(colors.clone()));
                    let style = Style { paint, ..Style::default() };
                    Panel::new(caption, Model { style, ..Model::new(mesh) })
                };
                let panels = vec![panel(&a, &colors, "first"), panel(&b, &moved, "second")];
                let scene = Scene { panels };
                let (image, _) = render(&scene, &RenderOptions::default(), progress)?;
                Ok::<_, dgp::view::Error>(image.to_png())
            })?;
            session.store(path, &png)?;
        }
        let same_number = (a.vertex_count() == b.vertex_count()).then(|| by_number(&a, &found));
        let summary = self.summary(&found, same_number);
        if let Some(path) = &self.first_output {
            a.attributes_mut().vertex.insert(COLOR, colors);
            one.set = a.to_indexed();
            session.write_stage(path, &one)?;
        }
        if let Some(output) = self.output.given() {
            let partners = found.points.map(|v| v.index() as i32);
            let data = &mut b.attributes_mut().vertex;
            data.insert(CORRESPONDS, partners);
            data.insert(COLOR, moved);
            two.set = b.to_indexed();
            session.write(&output, &two)?;
        }
        let report = json!({
            "laplacian": self.operator.name(),
            "waves": found.map.columns,
            "landmarks": self.landmarks.len(),
            "rounds": found.changed.len(),
            "changed": found.changed,
            "orthogonality_defect": found.map.orthogonality_defect(),
            "same_number": same_number.map_or(Value::Null, |(equal, distance)| json!({
                "vertices": equal, "mean_distance": distance,
            })),
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    /// The waves of a mesh scaled to area 1, so that size does not matter.
    fn basis(
        &self,
        mesh: &Mesh,
        common: &Common,
        progress: Progress<'_>,
    ) -> Result<Eigenbasis, laplace::Error> {
        let (laplacian, masses) = self.operator.of(mesh, progress.part(0.0, 0.1))?;
        let total: f64 = masses.values().iter().sum();
        let masses = if total > 0.0 { masses.map(|m| m / total) } else { masses };
        let options = eigen_options(common);
        Eigenbasis::new(&laplacian, &masses, self.count, &options, progress.part(0.1, 1.0))
    }

    /// A map of few waves from what is known, refined to all.
    fn find(
        &self,
        first: &Eigenbasis,
        second: &Eigenbasis,
        progress: Progress<'_>,
    ) -> Result<ZoomOut, laplace::Error> {
        // The same times on both: areas are 1.
        let times = signature_times(first, self.signatures)?;
        let mut from = Vec::new();
        let mut to = Vec::new();
        for &time in &times {
            from.push(heat_kernel_diagonal(first, time)?);
            to.push(heat_kernel_diagonal(second, time)?);
        }
        for &[v, w] in &self.landmarks {
            for &time in &times {
                from.push(heat_kernel(first, time, v)?);
                to.push(heat_kernel(second, time, w)?);
            }
        }
        let (a, b) = (first.truncated(self.start), second.truncated(self.start));
        let options = FunctionalMapOptions::default();
        let part = progress.part(0.0, 0.1);
        let rough: FunctionalMap = functional_map(&a, &b, &from, &to, &options, part)?;
        let vertices = second.vertex_count();
        // At least as many samples as waves, or they could not be told apart.
        let samples = self.samples.max(2 * self.count).min(vertices);
        let options = ZoomOutOptions { step: self.step, samples };
        zoomout(first, second, &rough, &options, progress.part(0.1, 1.0))
    }

    fn summary(&self, found: &ZoomOut, same_number: Option<(usize, f64)>) -> String {
        let mut text = format!(
            "{} → {}: {} vertices by {} waves in {} rounds, orthogonal up to {:.2e}",
            self.first.display(),
            self.second.display(),
            found.points.len(),
            found.map.columns,
            found.changed.len(),
            found.map.orthogonality_defect(),
        );
        if let Some((equal, distance)) = same_number {
            let percent = 100.0 * distance;
            let _ = write!(
                text,
                "\n{equal} have the partner of their own number; on average partners are {percent:.2}% of \
                 the diagonal away from it"
            );
        }
        text
    }
}

/// How many partners have the number of the vertex itself, and how far they are from it on average, in
/// diagonals of the first mesh: what is wrong, if both meshes number the same points the same.
fn by_number(first: &Mesh, found: &ZoomOut) -> (usize, f64) {
    let equal = found.points.iter().filter(|(w, v)| w == *v).count();
    let away = |(w, v): (VertexId, &VertexId)| first.position(w).distance(first.position(*v));
    let mean = found.points.iter().map(away).sum::<f64>() / found.points.len().max(1) as f64;
    let diagonal = bounding_box(first).map_or(1.0, |b| b.diagonal());
    (equal, if diagonal > 0.0 { mean / diagonal } else { mean })
}

/// Red, green and blue along the axes of the bounding box.
fn colors(mesh: &Mesh) -> VertexMap<Color> {
    let points = mesh.positions().values();
    let low = points.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
    let size = points.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p)) - low;
    mesh.positions().map(|&p| {
        let part = |k: usize| if size[k] > 0.0 { (p[k] - low[k]) / size[k] } else { 0.5 };
        let byte = |k: usize| (40.0 + 200.0 * part(k)).round() as u8;
        Color::from_rgb8([byte(0), byte(1), byte(2)])
    })
}
