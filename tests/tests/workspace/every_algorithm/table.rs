//! The table: a line for every algorithm.

use dgp_io::{Document, Format, WriteOptions, read_bytes, write_bytes};
use dgp_laplace::smooth::{
    Boundary, NeighborWeight, TangentialOptions, TaubinOptions, UniformOptions, Volume, tangential,
    taubin, uniform,
};
use dgp_mesh::{
    CrowdedEdges, EdgeList, EdgeMap, Editor, FaceSet, FlatFaces, IndexedFaceSet, KeepComponents,
    Mesh, PolygonSoup, Progress, RepairOptions, Tolerance, TriangulationMethod, VertexId,
    VertexSet,
    curvature::{self, Neighborhood},
    defects,
    graph::{Until, astar, breadth_first, dijkstra},
    measure::{self, NormalWeight, VertexArea},
    reorder, repair, repair_faces, shapes, strict_mesh, topology, triangulate, triangulate_faces,
    weld, weld_exact, weld_within,
};
use dgp_view::{Field, Model, Paint, RenderOptions, Scalars, Scene, Shape, Stroke, Style, render};

use super::{
    decimations::decimations, inputs::Input, laplacians::laplacians, layouts::layouts,
    outcome::Outcome, repairs::repairs, spatial::spatial, subdivisions::subdivisions,
};

/// A name and what to run.
pub(crate) struct Algorithm {
    pub(crate) name: &'static str,
    body: Body,
}

enum Body {
    /// On any faces.
    Set(fn(&IndexedFaceSet, Progress<'_>) -> Outcome),
    /// On meshes only.
    Mesh(fn(&Mesh, Progress<'_>) -> Outcome),
}

impl Algorithm {
    /// The outcome; `None` where it needs a mesh and there is none.
    pub(crate) fn run(&self, input: &Input, progress: Progress<'_>) -> Option<Outcome> {
        match self.body {
            Body::Set(body) => Some(body(&input.set, progress)),
            Body::Mesh(body) => input.mesh.as_ref().map(|mesh| body(mesh, progress)),
        }
    }
}

/// All there are. To add one, add a line: a name, and a closure from faces or a mesh to an outcome.
pub(crate) fn algorithms() -> Vec<Algorithm> {
    [
        building(),
        measures(),
        curvatures(),
        searches(),
        spatial(),
        edits(),
        smoothing(),
        laplacians(),
        subdivisions(),
        decimations(),
        layouts(),
        repairs(),
        pictures_and_files(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

pub(crate) fn set(
    name: &'static str,
    body: fn(&IndexedFaceSet, Progress<'_>) -> Outcome,
) -> Algorithm {
    Algorithm { name, body: Body::Set(body) }
}

pub(crate) fn mesh(name: &'static str, body: fn(&Mesh, Progress<'_>) -> Outcome) -> Algorithm {
    Algorithm { name, body: Body::Mesh(body) }
}

/// The outcome of what changes a copy of a mesh.
pub(crate) fn changed<T: std::fmt::Debug>(
    mesh: &Mesh,
    change: impl FnOnce(&mut Mesh) -> T,
) -> Outcome {
    let mut mesh = mesh.clone();
    let told = change(&mut mesh);
    Outcome::of_mesh(&mesh, &told)
}

/// The outcome of what makes a mesh, and maybe a report, or an error.
pub(crate) fn made<T: std::fmt::Debug, E: std::fmt::Debug>(
    result: Result<(Mesh, T), E>,
) -> Outcome {
    match result {
        Ok((mesh, told)) => Outcome::of_mesh(&mesh, &told),
        Err(error) => Outcome::of(&error),
    }
}

fn building() -> Vec<Algorithm> {
    vec![
        set("Mesh::new", |s, _| made(Mesh::new(s).map(|m| (m, ())))),
        set("strict_mesh", |s, p| made(strict_mesh(s, p).map(|m| (m, ())))),
        set("defects", |s, p| Outcome::of(&defects(s, p))),
        set("repair", |s, p| made(repair(s, &RepairOptions::default(), p))),
        set("repair everything", |s, p| made(repair(s, &everything(), p))),
        set("repair_faces", |s, p| Outcome::of(&repair_faces(s, &everything(), p))),
        set("weld_exact", |s, _| Outcome::of(&weld_exact(s.positions().values()))),
        set("weld_within", |s, p| {
            Outcome::of(&weld_within(s.positions().values(), Tolerance::OfDiagonal(0.01), p))
        }),
        set("weld", |s, p| Outcome::of(&weld(s, Tolerance::Exact, p))),
        set("PolygonSoup", |s, _| Outcome::of(&PolygonSoup::from_indexed(s).to_indexed())),
        set("EdgeList", |s, _| Outcome::of(&EdgeList::from_indexed(s).to_indexed())),
        set("triangulate_faces by ears", |s, p| {
            Outcome::of(&triangulate_faces(s, TriangulationMethod::Ears, p))
        }),
        set("triangulate_faces for angles", |s, p| {
            Outcome::of(&triangulate_faces(s, TriangulationMethod::MaxMinAngle, p))
        }),
        set("triangulate_faces for area", |s, p| {
            Outcome::of(&triangulate_faces(s, TriangulationMethod::MinArea, p))
        }),
        set("triangulate_faces by fans", |s, p| {
            Outcome::of(&triangulate_faces(s, TriangulationMethod::Fan, p))
        }),
        mesh("Mesh::to_indexed", |m, _| Outcome::of(&m.to_indexed())),
        mesh("EdgeList::from_mesh", |m, _| Outcome::of(&EdgeList::from_mesh(m).to_indexed())),
        mesh("triangulate by ears", |m, p| {
            changed(m, |m| triangulate(m, TriangulationMethod::Ears, p))
        }),
        mesh("triangulate for angles", |m, p| {
            changed(m, |m| triangulate(m, TriangulationMethod::MaxMinAngle, p))
        }),
    ]
}

fn everything() -> RepairOptions {
    RepairOptions {
        weld: Some(Tolerance::OfDiagonal(1e-6)),
        flat_faces: FlatFaces::Remove,
        crowded_edges: CrowdedEdges::Cut,
        components: KeepComponents::Largest(3),
        hole_edges: 500,
        ..RepairOptions::default()
    }
}

fn measures() -> Vec<Algorithm> {
    vec![
        set("area", |s, _| Outcome::of(&measure::area(s))),
        set("volume", |s, _| Outcome::of(&measure::volume(s))),
        set("face_areas", |s, _| Outcome::of(&measure::face_areas(s))),
        set("face_normals", |s, _| Outcome::of(&measure::face_normals(s))),
        set("face_vector_areas", |s, _| Outcome::of(&measure::face_vector_areas(s))),
        set("minimum_angle", |s, _| Outcome::of(&measure::minimum_angle(s))),
        set("bounding_box", |s, _| Outcome::of(&measure::bounding_box(s))),
        set("oriented_box", |s, _| Outcome::of(&measure::oriented_box(s))),
        set("mass_properties", |s, _| Outcome::of(&measure::mass_properties(s))),
        set("surface_centroid", |s, _| Outcome::of(&measure::surface_centroid(s))),
        set("vertex_centroid", |s, _| Outcome::of(&measure::vertex_centroid(s))),
        set("face_set_edge_length_range", |s, _| {
            Outcome::of(&measure::face_set_edge_length_range(s))
        }),
        set("geometry_report", |s, _| {
            Outcome::of(&measure::geometry_report(s, &topology::topology_report(s)))
        }),
        mesh("edge_lengths", |m, _| Outcome::of(&measure::edge_lengths(m))),
        mesh("edge_length_range", |m, _| Outcome::of(&measure::edge_length_range(m))),
        mesh("corner_angles", |m, _| Outcome::of(&measure::corner_angles(m))),
        mesh("cotangent_weights", |m, _| Outcome::of(&measure::cotangent_weights(m))),
        mesh("dihedral angles", |m, _| Outcome::of(&m.map_edges(|e| m.dihedral_angle(e)))),
        mesh("vertex_areas, barycentric", |m, _| {
            Outcome::of(&measure::vertex_areas(m, VertexArea::Barycentric))
        }),
        mesh("vertex_areas, mixed", |m, _| {
            Outcome::of(&measure::vertex_areas(m, VertexArea::MixedVoronoi))
        }),
        mesh("corner_areas", |m, _| {
            Outcome::of(&measure::corner_areas(m, VertexArea::MixedVoronoi))
        }),
        mesh("vertex_normals by area", |m, _| {
            Outcome::of(&measure::vertex_normals(m, NormalWeight::Area))
        }),
        mesh("vertex_normals by angle", |m, _| {
            Outcome::of(&measure::vertex_normals(m, NormalWeight::Angle))
        }),
        mesh("vertex_normals by Max", |m, _| {
            Outcome::of(&measure::vertex_normals(m, NormalWeight::Max))
        }),
    ]
}

fn curvatures() -> Vec<Algorithm> {
    vec![
        mesh("angle_defects", |m, _| Outcome::of(&curvature::angle_defects(m))),
        mesh("gaussian_curvatures", |m, _| {
            Outcome::of(&curvature::gaussian_curvatures(m, VertexArea::MixedVoronoi))
        }),
        mesh("mean_curvatures", |m, _| {
            Outcome::of(&curvature::mean_curvatures(m, VertexArea::Barycentric))
        }),
        mesh("mean_curvature_vectors", |m, _| {
            Outcome::of(&curvature::mean_curvature_vectors(m, VertexArea::MixedVoronoi))
        }),
        mesh("principal_curvatures", |m, _| Outcome::of(&curvature::principal_curvatures(m))),
        mesh("normal_cycle_curvatures", |m, p| {
            let length = measure::edge_length_range(m).map_or(1.0, |range| range.mean);
            let ball = Neighborhood::Ball(2.0 * length);
            Outcome::of(&curvature::normal_cycle_curvatures(m, ball, p))
        }),
        mesh("curvature_report", |m, _| Outcome::of(&curvature::curvature_report(m))),
    ]
}

fn searches() -> Vec<Algorithm> {
    vec![
        set("topology_report", |s, _| Outcome::of(&topology::topology_report(s))),
        set("face_list_components", |s, _| {
            Outcome::of(&topology::face_list_components(s.vertex_count(), s.faces()))
        }),
        set("edge_uses", |s, _| Outcome::of(&topology::edge_uses(s.vertex_count(), s.faces()))),
        mesh("components", |m, _| Outcome::of(&topology::components(m))),
        mesh("boundary_loops", |m, _| Outcome::of(&topology::boundary_loops(m))),
        mesh("euler_characteristic", |m, _| Outcome::of(&topology::euler_characteristic(m))),
        mesh("genus", |m, _| Outcome::of(&topology::genus(m))),
        mesh("vertex_adjacency", |m, _| Outcome::of(&m.vertex_adjacency())),
        mesh("breadth_first", |m, _| Outcome::of(&breadth_first(m, &first(m)))),
        mesh("dijkstra", |m, p| {
            let lengths = measure::edge_lengths(m);
            Outcome::of(&dijkstra(m, &lengths, &first(m), Until::AllReached, p))
        }),
        mesh("dijkstra over edges that are closed", |m, p| {
            let closed = EdgeMap::filled(m.edge_count(), f64::INFINITY);
            Outcome::of(&dijkstra(m, &closed, &first(m), Until::AllReached, p))
        }),
        mesh("astar", |m, p| {
            let lengths = measure::edge_lengths(m);
            let ends = m.vertices().next().zip(m.vertices().next_back());
            Outcome::of(&ends.map(|(v, w)| astar(m, &lengths, v, w, p)))
        }),
    ]
}

/// The first vertex, if there is one.
fn first(mesh: &Mesh) -> Vec<VertexId> {
    mesh.vertices().take(1).collect()
}

fn edits() -> Vec<Algorithm> {
    vec![
        mesh("reorder", |m, _| changed(m, reorder)),
        mesh("Mesh::reverse", |m, _| changed(m, Mesh::reverse)),
        mesh("split every edge", |m, _| {
            changed(m, |m| {
                let mut editor = Editor::new(m);
                for e in editor.edges().collect::<Vec<_>>() {
                    // Back to back triangles and places beyond all numbers are refused.
                    let _ = editor.split_edge_triangles(e, editor.mesh().edge_midpoint(e));
                }
                editor.finish()
            })
        }),
        mesh("collapse what can be", |m, _| {
            changed(m, |m| {
                let mut editor = Editor::new(m);
                for e in editor.edges().step_by(3).collect::<Vec<_>>() {
                    let _ = editor.collapse(e.halfedge());
                }
                editor.finish()
            })
        }),
        mesh("flip what can be", |m, _| {
            changed(m, |m| {
                let mut editor = Editor::new(m);
                for e in editor.edges().step_by(2).collect::<Vec<_>>() {
                    let _ = editor.flip(e);
                }
                editor.finish()
            })
        }),
        mesh("remove every third face", |m, _| {
            changed(m, |m| {
                let faces: FaceSet = m.faces().step_by(3).collect();
                let mut editor = Editor::new(m);
                (editor.remove_faces(&faces), editor.remove_isolated_vertices(), editor.finish())
            })
        }),
        mesh("with_noise", |m, _| made(shapes::with_noise(m.clone(), 0.1, 3).map(|m| (m, ())))),
        mesh("with_holes", |m, _| made(shapes::with_holes(m, 2, 1, 3).map(|m| (m, ())))),
        mesh("like_a_scan", |m, _| Outcome::of(&shapes::like_a_scan(m, 3))),
        set("shuffled", |s, _| Outcome::of(&shapes::shuffled(s, 3))),
    ]
}

fn smoothing() -> Vec<Algorithm> {
    vec![
        mesh("uniform", |m, p| {
            let options = UniformOptions { iterations: 3, ..UniformOptions::default() };
            changed(m, |m| uniform(m, &VertexSet::new(), &options, p))
        }),
        mesh("uniform along curves, volume kept", |m, p| {
            let (boundary, volume) = (Boundary::Curve, Volume::Keep);
            let options =
                UniformOptions { iterations: 3, boundary, volume, ..UniformOptions::default() };
            changed(m, |m| uniform(m, &VertexSet::all(2), &options, p))
        }),
        mesh("taubin", |m, p| {
            let options = TaubinOptions { iterations: 3, ..TaubinOptions::default() };
            changed(m, |m| taubin(m, &VertexSet::new(), &options, p))
        }),
        mesh("tangential", |m, p| {
            let weight = NeighborWeight::Area;
            let options =
                TangentialOptions { iterations: 3, weight, ..TangentialOptions::default() };
            changed(m, |m| tangential(m, &VertexSet::new(), &options, p))
        }),
    ]
}

fn pictures_and_files() -> Vec<Algorithm> {
    vec![
        set("render", |s, p| picture(Shape::Faces(s), Style::default(), p)),
        set("render flat with lines", |s, p| {
            let boundary = Stroke::BOLD;
            picture(Shape::Faces(s), Style { boundary, ..Style::faceted() }, p)
        }),
        mesh("render a mesh by its heights", |m, p| {
            let heights = Scalars {
                isolines: 5,
                ..Scalars::new(Field::Vertices(m.map_vertices(|v| m.position(v).y)))
            };
            let paint = Paint::Scalars(heights);
            picture(Shape::Mesh(m), Style { paint, ..Style::default() }, p)
        }),
        set("render points", |s, p| {
            picture(Shape::Points(s.positions().values()), Style::default(), p)
        }),
        set("write and read OBJ", |s, p| file(s, Format::Obj, p)),
        set("write and read PLY", |s, p| file(s, Format::Ply, p)),
        set("write and read STL", |s, p| file(s, Format::Stl, p)),
        set("write and read OFF", |s, p| file(s, Format::Off, p)),
    ]
}

fn picture(shape: Shape<'_>, style: Style, progress: Progress<'_>) -> Outcome {
    let options = RenderOptions { width: 200, height: 150, ..RenderOptions::default() };
    let scene = Scene::new(Model { style, ..Model::new(shape) });
    let drawn = render(&scene, &options, progress);
    // Where there is nothing to draw a range of values may be none; pixels are never NaN.
    Outcome::of(&drawn.map(|(image, report)| (image.to_png(), report)))
}

fn file(set: &IndexedFaceSet, format: Format, progress: Progress<'_>) -> Outcome {
    let document = Document::from(set.clone());
    let written = write_bytes(&document, format, &WriteOptions::default(), progress);
    let read = written.as_ref().ok().map(|(bytes, _)| read_bytes(bytes, format));
    Outcome::of(&(written, read))
}
