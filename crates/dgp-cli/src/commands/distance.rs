//! `dgp distance`: how far points are from a surface, and whether they are inside.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    io::Document,
    mesh::{
        COLOR, DVec3, FaceList, IndexedFaceSet, Progress, VertexMap,
        spatial::{SignedDistances, TriangleTree, WindingNumbers, WindingOptions},
    },
    view::ColorMap,
};
use serde_json::json;

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::scalars::{csv, vertex_colors},
    failure::Failure,
    session::Session,
};

/// Options of `dgp distance`.
///
/// Distances are negative inside. The output is the points with the vertex attributes `distance` and
/// `winding_number`, and colors that show the distance.
#[derive(Debug, Args)]
pub(crate) struct Distance {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    /// The points: the vertices of this file
    #[arg(long, value_name = "FILE", required_unless_present = "grid", conflicts_with = "grid")]
    points: Option<PathBuf>,
    /// The points: a grid around the mesh, so many along its longest side
    #[arg(long, value_name = "N")]
    grid: Option<usize>,
    /// What tells inside from outside
    #[arg(long, value_enum, default_value_t = Sign::Winding)]
    sign: Sign,
    /// How far away triangles count as one, in radii: winding numbers get better as it grows
    #[arg(long, value_name = "BETA", default_value_t = 2.0)]
    accuracy: f64,
    /// Write a line for each point: coordinates, distance, winding number, nearest point, nearest face
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Sign {
    /// Inside is where the winding number is above one half: for soups and meshes with holes
    Winding,
    /// Inside is behind the nearest place: for closed meshes, and sides of open ones
    Normal,
    /// Nothing is inside
    None,
}

/// What was found at each point.
struct Found {
    distances: Vec<f64>,
    winding: Vec<f64>,
    nearest: Vec<(DVec3, usize)>,
}

impl Distance {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        /// A slip in the size of a grid must not fill the memory.
        const MOST: usize = 1024;
        if self.grid.is_some_and(|n| !(2..=MOST).contains(&n)) {
            return Err(Failure::Usage(format!("--grid must be from 2 to {MOST}")));
        }
        let mut session = Session::new("distance", common);
        let document = session.read(&self.input)?;
        let tree = session
            .run("building", |progress| TriangleTree::new(&document.set, progress))
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let points = match (&self.points, self.grid) {
            (Some(path), _) => {
                let points = session.read(&Input { path: path.clone(), format: None })?;
                points.set.positions().values().to_vec()
            }
            (None, n) => grid(&tree, n.unwrap_or(2)),
        };
        let found = session
            .run("measuring", |progress| self.measure(&tree, &points, progress))
            .map_err(|failure| failure.in_file(&self.input.path))?;

        if let Some(path) = &self.csv {
            let names = [
                "x",
                "y",
                "z",
                "distance",
                "winding_number",
                "nearest_x",
                "nearest_y",
                "nearest_z",
                "nearest_face",
            ];
            let row = |i: usize| {
                let (p, (nearest, face)) = (points[i], found.nearest[i]);
                let mut row = p.to_array().to_vec();
                row.extend([found.distances[i], found.winding[i]]);
                row.extend(nearest.to_array());
                row.push(face as f64);
                row
            };
            session.store(path, csv(&names, (0..points.len()).map(row)).as_bytes())?;
        }
        let inside = found.distances.iter().filter(|d| **d < 0.0).count();
        let least = found.distances.iter().copied().fold(f64::INFINITY, f64::min);
        let most = found.distances.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let summary = format!(
            "{} points, {inside} inside; distances from {least:.6e} to {most:.6e}",
            points.len()
        );
        let report = json!({
            "points": points.len(),
            "inside": inside,
            "sign": self.sign.to_possible_value().map(|value| value.get_name().to_owned()),
            "accuracy": self.accuracy,
            "distance": {"min": least, "max": most},
        });
        if let Some(output) = self.output.given() {
            let mut set = IndexedFaceSet::new(points, FaceList::new())?;
            let values: VertexMap<f64> = found.distances.into();
            let colors = vertex_colors(&values, ColorMap::CoolWarm, true);
            set.vertex_attributes.insert("distance", values);
            set.vertex_attributes.insert("winding_number", found.winding);
            set.vertex_attributes.insert(COLOR, colors);
            session.write(&output, &Document::from(set))?;
        }
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn measure(
        &self,
        tree: &TriangleTree,
        points: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Found, dgp::mesh::Error> {
        let options = WindingOptions { accuracy: self.accuracy };
        let signed = SignedDistances::new(tree).at_points(points, progress.part(0.0, 0.5))?;
        let winding =
            WindingNumbers::new(tree, options)?.at_points(points, progress.part(0.5, 1.0))?;
        let distance = |i: usize| {
            let plain = signed[i].closest.distance;
            let is_inside = match self.sign {
                Sign::Winding => winding[i] > 0.5,
                Sign::Normal => signed[i].distance < 0.0,
                Sign::None => false,
            };
            if is_inside { -plain } else { plain }
        };
        Ok(Found {
            distances: (0..points.len()).map(distance).collect(),
            nearest: signed.iter().map(|s| (s.closest.point, s.closest.face.index())).collect(),
            winding,
        })
    }
}

/// Points around a surface, a tenth of its size further than its box, x fastest.
fn grid(tree: &TriangleTree, n: usize) -> Vec<DVec3> {
    let Some(bounds) = tree.bounding_box() else { return Vec::new() };
    let size = bounds.size().max_element();
    let (start, end) = (bounds.min - 0.1 * size, bounds.max + 0.1 * size);
    let step = 1.2 * size / (n - 1) as f64;
    let [nx, ny, nz] = ((end - start) / step).to_array().map(|x| x.round() as usize + 1);
    let at = |i: usize| {
        let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
        start + step * DVec3::new(x as f64, y as f64, z as f64)
    };
    if step > 0.0 && step.is_finite() { (0..nx * ny * nz).map(at).collect() } else { vec![start] }
}
