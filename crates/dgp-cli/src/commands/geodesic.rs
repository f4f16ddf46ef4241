//! `dgp geodesic`: how far vertices are from others, and the shortest way between two.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    mesh::{
        COLOR, Color, HalfedgeId, Mesh, VertexId, VertexMap,
        graph::{ShortestPaths, Until, astar, dijkstra},
        measure::edge_lengths,
    },
    view::ColorMap,
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input, OptionalOutput, id},
    failure::Failure,
    session::Session,
};

/// The vertex attribute that holds distances: infinite where no path leads.
const DISTANCE: &str = "distance";
/// The vertex attribute that marks the vertices of the path by 1.
const ON_PATH: &str = "on_path";
/// The color of what cannot be reached.
const UNREACHED: [u8; 3] = [150; 3];
/// The color of the path.
const PATH: [u8; 3] = [215, 25, 28];

/// Options of `dgp geodesic`.
///
/// Distances are lengths of paths along edges. The output has them as the vertex attribute
/// `distance` (infinite where no path leads), the vertices of the path marked in `on_path`, and colors
/// that show both.
#[derive(Debug, Args)]
pub(crate) struct Geodesic {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    /// The vertices to start from
    #[arg(long, value_name = "V,…", required = true, value_delimiter = ',', value_parser = id::<VertexId>)]
    from: Vec<VertexId>,
    /// The vertex to go to: reports the shortest path
    #[arg(long, value_name = "V", value_parser = id::<VertexId>)]
    to: Option<VertexId>,
    /// How to search
    #[arg(long, value_enum, default_value_t = Method::Dijkstra)]
    method: Method,
    /// Keep the colors of the file
    #[arg(long)]
    keep_colors: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Distances of all vertices, along edges
    Dijkstra,
    /// The path to one vertex only, along edges, looking towards it first
    Astar,
}

/// A path along edges.
struct Route {
    length: f64,
    halfedges: Vec<HalfedgeId>,
    start: VertexId,
    /// How many vertices the search looked at.
    visited: usize,
}

impl Geodesic {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("geodesic", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let (found, route) =
            self.search(&mut session, &mesh).map_err(|e| e.in_file(&self.input.path))?;

        let reached = found.as_ref().map(|found| found.order.len());
        let mut lines = Vec::new();
        let mut report = json!({
            "method": self.method.to_possible_value().map(|value| value.get_name().to_owned()),
            "from": self.from.iter().map(|v| v.index()).collect::<Vec<_>>(),
            "reached": reached,
            "unreachable": Value::Null,
            "farthest": Value::Null,
            "path": Value::Null,
        });
        if let Some(found) = &found {
            let unreachable = mesh.vertices().filter(|&v| !found.distance[v].is_finite());
            let unreachable: Vec<usize> = unreachable.map(VertexId::index).collect();
            if let Some(&v) = found.order.last() {
                let distance = found.distance[v];
                lines.push(format!(
                    "{} vertices reached, {v} last at {distance}",
                    found.order.len()
                ));
                report["farthest"] = json!({"vertex": v.index(), "distance": distance});
            }
            if !unreachable.is_empty() {
                let count = unreachable.len();
                session
                    .warn(format!("no path leads to {count} vertices; their distance is infinite"));
            }
            report["unreachable"] = unreachable.into();
        }
        if let Some(route) = &route {
            let vertices = route.vertices(&mesh);
            lines.push(format!(
                "the path from {} to {} has {} edges and length {}",
                vertices[0],
                vertices[vertices.len() - 1],
                route.halfedges.len(),
                route.length
            ));
            report["path"] = json!({
                "length": route.length,
                "vertices": vertices.iter().map(|v| v.index()).collect::<Vec<_>>(),
                "visited": route.visited,
            });
        }
        if let Some(output) = self.output.given() {
            self.mark(&mut mesh, found, route.as_ref());
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
            lines.push(format!("written to {}", output.path.display()));
        }
        session.finish(&lines.join("\n"), &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn search(
        &self,
        session: &mut Session<'_>,
        mesh: &Mesh,
    ) -> Result<(Option<ShortestPaths>, Option<Route>), Failure> {
        for &v in self.from.iter().chain(&self.to) {
            Failure::need(v, mesh.vertex_count())?;
        }
        let lengths = edge_lengths(mesh);
        let no_path = |to: VertexId| Failure::NoPath { from: self.from.clone(), to };
        match (self.method, self.to) {
            (Method::Dijkstra, to) => {
                let found = session.run("searching", |progress| {
                    dijkstra(mesh, &lengths, &self.from, Until::AllReached, progress)
                })?;
                let Some(to) = to else { return Ok((Some(found), None)) };
                let halfedges = found.path(mesh, to).ok_or_else(|| no_path(to))?;
                let start = halfedges.first().map_or(to, |&h| mesh.from(h));
                let visited = found.order.len();
                let route = Route { length: found.distance[to], halfedges, start, visited };
                Ok((Some(found), Some(route)))
            }
            (Method::Astar, Some(to)) if self.from.len() == 1 => {
                let start = self.from[0];
                let path = session
                    .run("searching", |progress| astar(mesh, &lengths, start, to, progress))?
                    .ok_or_else(|| no_path(to))?;
                let (length, visited) = (path.length, path.visited);
                Ok((None, Some(Route { length, halfedges: path.halfedges, start, visited })))
            }
            (Method::Astar, _) => Err(Failure::Usage(
                "--method astar goes from one vertex to one: give --from V --to W".to_owned(),
            )),
        }
    }

    /// Puts what was found into the data of the vertices.
    fn mark(&self, mesh: &mut Mesh, found: Option<ShortestPaths>, route: Option<&Route>) {
        let mut colors = VertexMap::filled(mesh.vertex_count(), Color::from_rgb8(UNREACHED));
        if let Some(found) = found {
            let farthest = found.order.last().map_or(0.0, |&v| found.distance[v]);
            for &v in &found.order {
                let part = if farthest > 0.0 { found.distance[v] / farthest } else { 0.0 };
                // In the 8 bits that files hold, so that no format has to round.
                let color = ColorMap::default().color(part);
                colors[v] = Color::from_rgba8(color.to_rgba8());
            }
            mesh.attributes_mut().vertex.insert(DISTANCE, found.distance);
        }
        if let Some(route) = route {
            let mut on_path = VertexMap::filled(mesh.vertex_count(), 0_u8);
            for v in route.vertices(mesh) {
                on_path[v] = 1;
                colors[v] = Color::from_rgb8(PATH);
            }
            mesh.attributes_mut().vertex.insert(ON_PATH, on_path);
        }
        if !self.keep_colors {
            mesh.attributes_mut().vertex.insert(COLOR, colors);
        }
    }
}

impl Route {
    /// The vertices it visits, its ends included.
    fn vertices(&self, mesh: &Mesh) -> Vec<VertexId> {
        std::iter::once(self.start).chain(self.halfedges.iter().map(|&h| mesh.to(h))).collect()
    }
}
