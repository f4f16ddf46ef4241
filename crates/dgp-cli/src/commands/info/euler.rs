//! What Euler's formula says of a mesh: regular solids, twelve pentagons, planarity, colors.

use std::fmt::Write;

use dgp::mesh::{
    Mesh, Progress, VertexId,
    graph::{
        Graph, Kuratowski, bipartition, edge_bound, five_coloring, kuratowski, planar_embedding,
        smallest_last_coloring,
    },
    topology::{RegularPolyhedron, trivalent_balance},
};
use serde_json::{Value, json};

use crate::failure::Failure;

/// Graphs of more edges are told to be planar or not, but not why not: a proof takes many tests.
const PROVABLE_EDGES: usize = 20_000;

/// The facts as a report, and as lines.
pub(super) fn facts(mesh: &Mesh, progress: Progress<'_>) -> Result<(Value, String), Failure> {
    let graph = Graph::of_mesh(mesh);
    let (v, e, f) = (mesh.vertex_count(), mesh.edge_count(), mesh.face_count());
    let solid = regular(mesh);
    let balance = trivalent_balance(mesh);
    let bound = edge_bound(&graph);
    let drawing = planar_embedding(&graph);
    let colors = smallest_last_coloring(&graph);
    let five = five_coloring(&graph);
    let obstruction = match drawing {
        None if e <= PROVABLE_EDGES => kuratowski(&graph, progress)?,
        _ => None,
    };

    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<18} {value}");
    };
    line("V − E + F", format!("{v} − {e} + {f} = {}", v as i64 - e as i64 + f as i64));
    line("regular", solid.map_or("no".to_owned(), |solid| format!("{solid}")));
    let mut words = format!("Σ (6 − k) F(k) = {}", balance.surplus);
    if balance.is_trivalent {
        let _ = write!(words, ", as 6 χ = {} demands where three faces meet", balance.required);
    }
    line("sides", words);
    let mut words = bound.limit.map_or("none".to_owned(), |limit| format!("{e} ≤ {limit}"));
    if bound.limit.is_some_and(|limit| e > limit) {
        words = words.replace('≤', ">");
    }
    if let Some(limit) = bound.bipartite_limit {
        let sign = if e > limit { '>' } else { '≤' };
        let _ = write!(words, "; bipartite: {e} {sign} {limit}");
    }
    line("edge bounds", words);
    let kind = obstruction.as_ref().map(|found| match found.kind {
        Kuratowski::K5 => "K5",
        Kuratowski::K33 => "K3,3",
    });
    let planar = match (&drawing, &obstruction, kind) {
        (Some(_), _, _) => "yes".to_owned(),
        (None, Some(found), Some(kind)) => {
            let corners: Vec<String> =
                found.branch_vertices.iter().map(ToString::to_string).collect();
            let count = found.edges.len();
            format!("no: {count} edges form a {kind} with the corners {}", corners.join(" "))
        }
        _ => "no".to_owned(),
    };
    line("planar edges", planar);
    let fewer = five.as_ref().map_or(String::new(), |five| format!(", {} with swaps", five.count));
    line("colors", format!("{} suffice, smallest last{fewer}", colors.count));

    let report = json!({
        "regular": solid.map(|s| json!({"sides": s.sides, "valence": s.valence})),
        "trivalent": balance.is_trivalent,
        "faces_by_sides": balance.faces_by_sides,
        "surplus": balance.surplus,
        "required_surplus": balance.is_trivalent.then_some(balance.required),
        "edge_limit": bound.limit,
        "bipartite": bipartition(&graph).is_some(),
        "bipartite_edge_limit": bound.bipartite_limit,
        "planar": drawing.is_some(),
        "obstruction": obstruction.map(|found| json!({
            "kind": kind,
            "branch_vertices": found.branch_vertices.iter().map(|v| v.index()).collect::<Vec<_>>(),
            "edges": found.edges.iter().map(|e| {
                mesh.edge_vertices(*e).map(VertexId::index)
            }).collect::<Vec<_>>(),
        })),
        "colors": colors.count,
        "degeneracy": colors.degeneracy,
        "five_colors": five.map(|five| five.count),
    });
    Ok((report, text))
}

/// The regular solid that the connectivity is of, if it is one.
fn regular(mesh: &Mesh) -> Option<RegularPolyhedron> {
    let sides = mesh.degree(mesh.faces().next()?);
    let valence = mesh.valence(mesh.vertices().next()?);
    let solid = RegularPolyhedron::new(sides, valence)?;
    let counts = (mesh.vertex_count(), mesh.edge_count(), mesh.face_count());
    let is_solid = counts == (solid.vertices, solid.edges, solid.faces)
        && mesh.faces().all(|f| mesh.degree(f) == sides)
        && mesh.vertices().all(|v| mesh.valence(v) == valence && !mesh.is_boundary_vertex(v));
    is_solid.then_some(solid)
}
