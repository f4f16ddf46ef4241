//! `dgp compare`: how far two surfaces are apart.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use dgp::{
    mesh::{
        COLOR, Color, IndexedFaceSet, Progress, VertexMap,
        spatial::{
            Chamfer, Deviation, DeviationOptions, HausdorffBounds, HausdorffOptions,
            HausdorffReport, TriangleTree, chamfer, deviation, hausdorff,
        },
    },
    view::{
        ColorMap, Field, Model, Paint, Panel, RenderOptions, Scalars, Scene, Shape, Style, render,
    },
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::scalars::vertex_colors,
    failure::Failure,
    session::Session,
};

/// The vertex attribute of the first mesh that holds the distance to the second.
const DISTANCE: &str = "distance";

/// Options of `dgp compare`.
///
/// Any faces will do, manifold or not. The Hausdorff distance comes as two numbers between which it surely
/// lies; mean and root mean square are over the area, the Chamfer distance is over the vertices. The output
/// is the first mesh with the vertex attribute `distance`, the distance to the second, and colors that show it.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// The mesh whose distance is measured
    #[arg(value_name = "FIRST")]
    first: PathBuf,
    /// The mesh it is measured to, and then the other way
    #[arg(value_name = "SECOND")]
    second: PathBuf,
    #[command(flatten)]
    output: OptionalOutput,
    /// How far the bounds of the Hausdorff distance may be apart, as a part of the diagonal of both meshes
    #[arg(long, value_name = "X", default_value_t = 1e-4)]
    tolerance: f64,
    /// The most points to look at for that beyond the vertices
    #[arg(long, value_name = "N", default_value_t = 20_000_000)]
    queries: usize,
    /// At how many points the mean is measured, about
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    samples: usize,
    /// Draw the first mesh in the colors of its distance into this PNG
    #[arg(long, value_name = "PNG")]
    picture: Option<PathBuf>,
}

/// What was measured.
struct Measured {
    hausdorff: HausdorffReport,
    forward: Deviation,
    backward: Deviation,
    chamfer: Chamfer,
    /// Of the vertices of the first mesh.
    distances: Vec<f64>,
    diagonal: f64,
}

impl Compare {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("compare", common);
        let [first, second] =
            [&self.first, &self.second].map(|path| Input { path: path.clone(), format: None });
        let mut one = session.read(&first)?;
        let two = session.read(&second)?;
        let mut tree = |set: &IndexedFaceSet, path: &PathBuf| {
            let built = session.run("building", |progress| {
                let tree = TriangleTree::new(set, progress)?;
                if tree.is_empty() { Err(dgp::mesh::Error::Empty) } else { Ok(tree) }
            });
            built.map_err(|failure| failure.in_file(path))
        };
        let trees = [tree(&one.set, &self.first)?, tree(&two.set, &self.second)?];
        let measured = session
            .run("measuring", |progress| self.measure([&one.set, &two.set], &trees, progress))?;
        if !measured.hausdorff.forward.is_within_tolerance
            || !measured.hausdorff.backward.is_within_tolerance
        {
            session
                .warn("the bounds are further apart than --tolerance; raise --queries".to_owned());
        }
        let values: VertexMap<f64> = measured.distances.clone().into();
        if let Some(path) = &self.picture {
            let png = session.run("drawing", |progress| draw(&one.set, &values, progress))?;
            session.store(path, &png)?;
        }
        if let Some(output) = self.output.given() {
            let colors: VertexMap<Color> = vertex_colors(&values, ColorMap::default(), false);
            one.set.vertex_attributes.insert(DISTANCE, values);
            one.set.vertex_attributes.insert(COLOR, colors);
            session.write(&output, &one)?;
        }
        session.finish(&measured.summary(), &measured.to_json())?;
        Ok(ExitCode::SUCCESS)
    }

    fn measure(
        &self,
        sets: [&IndexedFaceSet; 2],
        [a, b]: &[TriangleTree; 2],
        progress: Progress<'_>,
    ) -> Result<Measured, dgp::mesh::Error> {
        let options = HausdorffOptions { tolerance: self.tolerance, queries: self.queries };
        let samples = DeviationOptions { samples: self.samples };
        let [first, second] = sets.map(|set| {
            let finite = set.positions().values().iter().filter(|p| p.is_finite());
            finite.copied().collect::<Vec<_>>()
        });
        let hausdorff = hausdorff(a, b, &options, progress.part(0.0, 0.6))?;
        let forward = deviation(a, b, &samples, progress.part(0.6, 0.7))?;
        let backward = deviation(b, a, &samples, progress.part(0.7, 0.8))?;
        let chamfer = chamfer(&first, &second, progress.part(0.8, 0.9))?;
        let found = b.closest_points(&first, progress.part(0.9, 1.0))?;
        let mut found = found.into_iter().map(|hit| hit.distance);
        let distance = |p: &dgp::mesh::DVec3| {
            if p.is_finite() { found.next().unwrap_or(f64::INFINITY) } else { f64::INFINITY }
        };
        let distances = sets[0].positions().values().iter().map(distance).collect();
        let boxes = a.bounding_box().zip(b.bounding_box());
        let diagonal = boxes.map_or(0.0, |(a, b)| a.union(&b).diagonal());
        Ok(Measured { hausdorff, forward, backward, chamfer, distances, diagonal })
    }
}

fn draw(
    set: &IndexedFaceSet,
    values: &VertexMap<f64>,
    progress: Progress<'_>,
) -> Result<Vec<u8>, dgp::view::Error> {
    let scalars =
        Scalars { label: DISTANCE.to_owned(), ..Scalars::new(Field::Vertices(values.clone())) };
    let style = Style { paint: Paint::Scalars(scalars), ..Style::default() };
    let model = Model { style, ..Model::new(Shape::Faces(set)) };
    let scene = Scene { panels: vec![Panel::new("", model)] };
    let (image, _) = render(&scene, &RenderOptions::default(), progress)?;
    Ok(image.to_png())
}

impl Measured {
    fn summary(&self) -> String {
        let part = |x: f64| {
            let percent = if self.diagonal > 0.0 { 100.0 * x / self.diagonal } else { 0.0 };
            format!("{x:.6e} ({percent:.4} % of the diagonal)")
        };
        format!(
            "Hausdorff distance from {:.6e} to {}\n\
             there and back: mean {:.6e} and {:.6e}, root mean square {} and {}\n\
             Chamfer distance of the vertices {:.6e}",
            self.hausdorff.lower(),
            part(self.hausdorff.upper()),
            self.forward.mean,
            self.backward.mean,
            part(self.forward.rms),
            part(self.backward.rms),
            self.chamfer.distance(),
        )
    }

    fn to_json(&self) -> Value {
        json!({
            "diagonal": self.diagonal,
            "hausdorff": {
                "lower": self.hausdorff.lower(),
                "upper": self.hausdorff.upper(),
                "forward": bounds_json(&self.hausdorff.forward),
                "backward": bounds_json(&self.hausdorff.backward),
            },
            "forward": deviation_json(&self.forward),
            "backward": deviation_json(&self.backward),
            "rms": self.forward.rms.max(self.backward.rms),
            "chamfer": {
                "distance": self.chamfer.distance(),
                "forward": self.chamfer.forward,
                "backward": self.chamfer.backward,
                "forward_square": self.chamfer.forward_square,
                "backward_square": self.chamfer.backward_square,
                "largest": self.chamfer.largest,
            },
        })
    }
}

fn bounds_json(bounds: &HausdorffBounds) -> Value {
    json!({
        "lower": bounds.lower,
        "upper": bounds.upper,
        "point": bounds.point.to_array(),
        "face": bounds.face.index(),
        "nearest": bounds.nearest.to_array(),
        "nearest_face": bounds.nearest_face.index(),
        "queries": bounds.queries,
        "within_tolerance": bounds.is_within_tolerance,
    })
}

fn deviation_json(deviation: &Deviation) -> Value {
    json!({
        "mean": deviation.mean,
        "rms": deviation.rms,
        "largest_sample": deviation.largest,
        "samples": deviation.samples,
    })
}
