//! Questions about single elements: what is around a vertex, a face, an edge; where holes are; what
//! the data are at a point of a triangle.

use std::fmt::Write;

use clap::Args;
use dgp::mesh::{
    DVec3, Error, FaceId, HalfedgeId, Mesh, VertexId,
    measure::{TriangleLocation, barycentric_3d, triangle_location},
    topology::{boundary_loops, path_length},
};
use serde_json::{Value, json};

use super::values::values;
use crate::{
    cli::{id, ids, numbers},
    failure::Failure,
};

/// Questions about single elements, answered in the order of this list. They need a manifold mesh.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Questions about elements (each may be asked several times)")]
pub(super) struct Queries {
    /// What is around vertex V, in counterclockwise order, and its data
    #[arg(long, value_name = "V", value_parser = id::<VertexId>)]
    vertex: Vec<VertexId>,
    /// What is around face F, and its data
    #[arg(long, value_name = "F", value_parser = id::<FaceId>)]
    face: Vec<FaceId>,
    /// What is at the edge between V and W
    #[arg(long, value_name = "V,W", value_parser = ids::<VertexId, 2>)]
    edge: Vec<[VertexId; 2]>,
    /// Whether an edge joins V and W, and which faces have both
    #[arg(long, value_name = "V,W", value_parser = ids::<VertexId, 2>)]
    adjacent: Vec<[VertexId; 2]>,
    /// The vertices along each hole
    #[arg(long)]
    loops: bool,
    /// Position and data at the point of triangle F that has these barycentric weights
    #[arg(long, value_name = "F,A,B,C", value_parser = weights, allow_hyphen_values = true)]
    at: Vec<(FaceId, [f64; 3])>,
    /// Barycentric coordinates of a point in the plane of triangle F, and the data there
    #[arg(long, value_name = "F,X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    locate: Vec<(FaceId, [f64; 3])>,
}

impl Queries {
    /// Whether anything is asked.
    pub(super) fn is_empty(&self) -> bool {
        let asked = [
            !self.vertex.is_empty(),
            !self.face.is_empty(),
            !self.edge.is_empty(),
            !self.adjacent.is_empty(),
            self.loops,
            !self.at.is_empty(),
            !self.locate.is_empty(),
        ];
        !asked.contains(&true)
    }

    /// The answers, by the name of the question, each with a line for people.
    pub(super) fn answers(&self, mesh: &Mesh) -> Result<(Value, String), Failure> {
        let mut answers = serde_json::Map::new();
        let mut text = String::new();
        let mut put = |name: &str, list: Vec<Value>| {
            for answer in &list {
                let _ = writeln!(text, "{name:<18} {answer}");
            }
            if !list.is_empty() {
                answers.insert(name.to_owned(), list.into());
            }
        };
        put("vertex", each(&self.vertex, |v| vertex(mesh, v))?);
        put("face", each(&self.face, |f| face(mesh, f))?);
        put("edge", each(&self.edge, |ends| edge(mesh, ends))?);
        put("adjacent", each(&self.adjacent, |pair| adjacent(mesh, pair))?);
        put("at", each(&self.at, |(f, weights)| at(mesh, f, weights))?);
        put("locate", each(&self.locate, |(f, p)| locate(mesh, f, p.into()))?);
        if self.loops {
            let loops = boundary_loops(mesh);
            put("loops", loops.iter().map(|rim| boundary_loop(mesh, rim)).collect());
            // No holes are an answer too.
            answers.entry("loops").or_insert_with(|| json!([]));
        }
        Ok((answers.into(), text))
    }
}

/// The answers to all questions of a kind.
fn each<T: Copy>(
    asked: &[T],
    answer: impl Fn(T) -> Result<Value, Failure>,
) -> Result<Vec<Value>, Failure> {
    asked.iter().map(|&question| answer(question)).collect()
}

fn vertex(mesh: &Mesh, v: VertexId) -> Result<Value, Failure> {
    Failure::need(v, mesh.vertex_count())?;
    Ok(json!({
        "vertex": v.index(),
        "position": mesh.position(v).to_array(),
        "valence": mesh.valence(v),
        "boundary": mesh.is_boundary_vertex(v),
        "neighbors": mesh.vertex_neighbors(v).map(VertexId::index).collect::<Vec<_>>(),
        "faces": mesh.vertex_faces(v).map(FaceId::index).collect::<Vec<_>>(),
        "attributes": values(&mesh.attributes().vertex, [v; 3], [1.0, 0.0, 0.0]),
    }))
}

fn face(mesh: &Mesh, f: FaceId) -> Result<Value, Failure> {
    Failure::need(f, mesh.face_count())?;
    let corner = &mesh.attributes().corner;
    let corners = mesh.face_halfedges(f).map(|h| values(corner, [h; 3], [1.0, 0.0, 0.0]));
    Ok(json!({
        "face": f.index(),
        "vertices": mesh.face_vertices(f).map(VertexId::index).collect::<Vec<_>>(),
        "neighbors": mesh.face_neighbors(f).map(FaceId::index).collect::<Vec<_>>(),
        "boundary": mesh.is_boundary_face(f),
        "area": mesh.face_area(f),
        "normal": mesh.face_normal(f).to_array(),
        "center": mesh.face_center(f).to_array(),
        "attributes": values(&mesh.attributes().face, [f; 3], [1.0, 0.0, 0.0]),
        "corner_attributes": corners.collect::<Vec<_>>(),
    }))
}

fn edge(mesh: &Mesh, ends: [VertexId; 2]) -> Result<Value, Failure> {
    let h = halfedge(mesh, ends)?;
    let side = |h: HalfedgeId| mesh.face(h).map(FaceId::index);
    Ok(json!({
        "vertices": ends.map(VertexId::index),
        "length": mesh.edge_length(h.edge()),
        "boundary": mesh.is_boundary_edge(h.edge()),
        "left_face": side(h),
        "right_face": side(h.twin()),
        "dihedral_angle": mesh.dihedral_angle(h.edge()).map(f64::to_degrees),
    }))
}

fn adjacent(mesh: &Mesh, [v, w]: [VertexId; 2]) -> Result<Value, Failure> {
    for end in [v, w] {
        Failure::need(end, mesh.vertex_count())?;
    }
    Ok(json!({
        "vertices": [v.index(), w.index()],
        "adjacent": mesh.are_adjacent(v, w),
        "common_faces": mesh.common_faces(v, w).map(FaceId::index).collect::<Vec<_>>(),
    }))
}

fn boundary_loop(mesh: &Mesh, rim: &[HalfedgeId]) -> Value {
    json!({
        "edges": rim.len(),
        "length": path_length(mesh, rim),
        "vertices": rim.iter().map(|&h| mesh.from(h).index()).collect::<Vec<_>>(),
    })
}

fn at(mesh: &Mesh, f: FaceId, weights: [f64; 3]) -> Result<Value, Failure> {
    let corners = triangle(mesh, f)?;
    let p: DVec3 = (0..3).map(|k| weights[k] * mesh.position(corners[k])).sum();
    let mut answer = point(mesh, f, corners, weights);
    answer["position"] = p.to_array().to_vec().into();
    Ok(answer)
}

fn locate(mesh: &Mesh, f: FaceId, p: DVec3) -> Result<Value, Failure> {
    let corners = triangle(mesh, f)?;
    let points = corners.map(|v| mesh.position(v));
    let coordinates = barycentric_3d(p, points).ok_or(Failure::NoArea { face: f })?;
    let foot: DVec3 = (0..3).map(|k| coordinates[k] * points[k]).sum();
    let mut answer = point(mesh, f, corners, coordinates);
    answer["nearest_point_of_plane"] = foot.to_array().to_vec().into();
    answer["distance_to_plane"] = p.distance(foot).into();
    Ok(answer)
}

/// Where in the triangle the coordinates are, and the data there, which a point outside has not.
fn point(mesh: &Mesh, f: FaceId, corners: [VertexId; 3], coordinates: [f64; 3]) -> Value {
    let location = triangle_location(coordinates);
    let attributes = mesh.attributes();
    let h = mesh.face_halfedge(f);
    let sides = [h, mesh.next(h), mesh.prev(h)];
    let is_in = location != TriangleLocation::Outside;
    let of_vertices = is_in.then(|| values(&attributes.vertex, corners, coordinates));
    let of_corners = is_in.then(|| values(&attributes.corner, sides, coordinates));
    json!({
        "face": f.index(),
        "vertices": corners.map(VertexId::index),
        "coordinates": coordinates,
        "location": match location {
            TriangleLocation::Inside => "inside",
            TriangleLocation::OnSide(_) => "on a side",
            TriangleLocation::AtCorner(_) => "at a corner",
            TriangleLocation::Outside => "outside",
        },
        "attributes": of_vertices,
        "corner_attributes": of_corners,
        "face_attributes": values(&attributes.face, [f; 3], [1.0, 0.0, 0.0]),
    })
}

/// The half-edge from one vertex to another.
pub(crate) fn halfedge(mesh: &Mesh, vertices: [VertexId; 2]) -> Result<HalfedgeId, Failure> {
    for v in vertices {
        Failure::need(v, mesh.vertex_count())?;
    }
    mesh.halfedge_between(vertices[0], vertices[1]).ok_or(Failure::NotAnEdge { vertices })
}

fn triangle(mesh: &Mesh, f: FaceId) -> Result<[VertexId; 3], Failure> {
    Failure::need(f, mesh.face_count())?;
    let degree = mesh.degree(f);
    mesh.triangle(f).ok_or_else(|| Error::NotTriangle { face: f, degree }.into())
}

/// A face and three weights, which are divided by their sum.
fn weights(text: &str) -> Result<(FaceId, [f64; 3]), String> {
    let (face, weights) = place(text)?;
    let sum: f64 = weights.iter().sum();
    if weights.iter().any(|&w| w < 0.0) || !(sum > 0.0 && sum.is_finite()) {
        return Err("weights must not be negative, and one must be positive".to_owned());
    }
    Ok((face, weights.map(|w| w / sum)))
}

/// A face and three numbers.
fn place(text: &str) -> Result<(FaceId, [f64; 3]), String> {
    let (face, rest) = text.split_once(',').ok_or("a face and three numbers are needed")?;
    Ok((id(face)?, numbers(rest)?))
}
