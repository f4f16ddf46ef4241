//! `dgp sample`: points on a surface.

use std::{fmt::Write, path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    io::Document,
    mesh::{
        Color, DVec3, FaceList, IndexedFaceSet, NORMAL, Normal, Progress, TriangulationMethod,
        VertexId, VertexSet, triangulate_faces,
    },
    remesh::{
        self, BlueNoiseOptions, PoissonOptions, SampleNormal, SurfaceSample, sample_attributes,
        sample_blue_noise, sample_normals, sample_poisson_disk, sample_stratified, sample_uniform,
    },
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp sample`.
///
/// Any triangles will do, a manifold or not; polygons are cut into triangles first. Points have normals, and the colors,
/// groups and other data of the surface.
#[derive(Debug, Args)]
pub(crate) struct Sample {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    goal: Goal,
    /// How N points are spread
    #[arg(long, value_enum, default_value_t = Spread::BlueNoise, conflicts_with = "radius")]
    method: Spread,
    /// Which way points look
    #[arg(long, value_enum, default_value_t = Normals::Smooth)]
    normals: Normals,
    /// Draw the surface and the points into a PNG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// How many points.
#[derive(Clone, Debug, Args)]
#[group(required = true, multiple = false)]
struct Goal {
    /// N points
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// As many as have room at distances of R at least: a length (Poisson-disk sampling)
    #[arg(long, value_name = "R")]
    radius: Option<f64>,
}

/// How so many points are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Spread {
    /// As far from each other as can be: the best of five times as many (Yuksel 2015)
    BlueNoise,
    /// One in each of N parts of equal area
    Stratified,
    /// Each anywhere
    Uniform,
}

/// Which way points look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Normals {
    /// As a smooth surface does
    Smooth,
    /// As the face does
    Face,
    /// Nowhere: no normals are written
    None,
}

impl Sample {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("sample", common);
        let document = session.read(&self.input)?;
        let path = &self.input.path;
        let in_file = |failure: Failure| failure.in_file(path);
        let mut surface = document.set;
        if !surface.faces().is_triangles() {
            session.warn(format!("{}: polygons are cut into triangles first", path.display()));
            let cut =
                |p: Progress<'_>| triangulate_faces(&surface, TriangulationMethod::default(), p);
            surface = session.run("triangulating", cut).map_err(in_file)?.0;
        }
        let seed = common.seed;
        let (samples, report) =
            session.run("sampling", |p| self.apply(&surface, seed, p)).map_err(in_file)?;
        let mut points = IndexedFaceSet::new(
            samples.iter().map(|sample| sample.position).collect::<Vec<DVec3>>(),
            FaceList::new(),
        )?;
        points.vertex_attributes = sample_attributes(&surface, &samples);
        points.vertex_attributes.remove(NORMAL);
        let normals = match self.normals {
            Normals::Smooth => Some(SampleNormal::Smooth),
            Normals::Face => Some(SampleNormal::Face),
            Normals::None => None,
        };
        if let Some(normals) = normals {
            let normals = sample_normals(&surface, &samples, normals).into_iter().map(Normal);
            points.vertex_attributes.insert(NORMAL, normals.collect::<Vec<Normal>>());
        }
        if let Some(picture) = &self.picture {
            let png = session.run("drawing", |p| picture_of(&surface, &samples, p))?;
            session.store(picture, &png)?;
        }
        session.write(&self.output, &Document::from(points))?;
        let mut summary = format!(
            "{} → {}: {} points",
            path.display(),
            self.output.path.display(),
            samples.len()
        );
        if let Some(distance) = report["least_distance"].as_f64() {
            let _ = write!(summary, ", at least {distance:.6e} apart");
        }
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn apply(
        &self,
        surface: &IndexedFaceSet,
        seed: u64,
        progress: Progress<'_>,
    ) -> Result<(Vec<SurfaceSample>, Value), remesh::Error> {
        if let Some(radius) = self.goal.radius {
            let options = PoissonOptions { seed, ..PoissonOptions::default() };
            let (samples, report) = sample_poisson_disk(surface, radius, &options, progress)?;
            let told = json!({
                "method": "poisson-disk",
                "points": samples.len(),
                "radius": radius,
                "least_distance": report.least_distance,
                "coverage": report.coverage,
                "darts": report.darts,
            });
            return Ok((samples, told));
        }
        let count = self.goal.count.unwrap_or_default();
        let mut told = json!({
            "method": self.method.to_possible_value().map(|value| value.get_name().to_owned()),
            "points": count,
        });
        let samples = match self.method {
            Spread::Uniform => sample_uniform(surface, count, seed, progress)?,
            Spread::Stratified => sample_stratified(surface, count, seed, progress)?,
            Spread::BlueNoise => {
                let options = BlueNoiseOptions { seed, ..BlueNoiseOptions::default() };
                let (samples, report) = sample_blue_noise(surface, count, &options, progress)?;
                told["least_distance"] = json!(report.least_distance);
                told["largest_possible"] = json!(report.largest_possible);
                told["candidates"] = json!(report.candidates);
                samples
            }
        };
        Ok((samples, told))
    }
}

/// The surface with the points on it.
fn picture_of(
    surface: &IndexedFaceSet,
    samples: &[SurfaceSample],
    progress: Progress<'_>,
) -> Result<Vec<u8>, Failure> {
    use dgp::view::{Mark, Marked, Model, Panel, RenderOptions, Scene, Style, render};
    let known = surface.vertex_count();
    let mut positions = surface.positions().values().to_vec();
    positions.extend(samples.iter().map(|sample| sample.position));
    let both = IndexedFaceSet::new(positions, surface.faces().clone())?;
    let points: VertexSet = (known..known + samples.len()).map(VertexId::new).collect();
    // Some 40 % of the way from one point to the next, in a picture of 800 pixels.
    let width = (320.0 / (samples.len() as f64).sqrt()).clamp(1.5, 8.0);
    let color = Color::from_rgb8([0xc0, 0x39, 0x2b]);
    let mark = Mark { elements: Marked::Vertices(points), color, width };
    let style = Style { marks: vec![mark], ..Style::default() };
    let panel =
        Panel::new(format!("{} points", samples.len()), Model { style, ..Model::new(&both) });
    let options = RenderOptions { width: 800, height: 800, ..RenderOptions::default() };
    Ok(render(&Scene { panels: vec![panel] }, &options, progress)?.0.to_png())
}
