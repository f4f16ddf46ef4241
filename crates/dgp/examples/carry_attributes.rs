//! Data that travel: temperatures, colors and a type of one's own through splits and collapses.
//!
//! `cargo run -p dgp --example carry_attributes`

use std::error::Error;

use dgp::mesh::{
    AttributeValue, COLOR, Color, Editor, Progress, VertexMap, graph::breadth_first, shapes,
};

/// When a vertex was measured: of several the latest counts.
#[derive(Clone, Debug, Default, PartialEq)]
struct Day(u32);

impl AttributeValue for Day {
    fn mix(parts: &[(f64, &Self)]) -> Self {
        parts.iter().map(|(_, day)| (*day).clone()).max_by_key(|day| day.0).unwrap_or_default()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut mesh = shapes::grid(8, 8)?;
    // Any number of named columns, per vertex, corner, edge or face.
    let heat: VertexMap<f64> = mesh.map_vertices(|v| 20.0 + 10.0 * mesh.position(v).x);
    let days: VertexMap<Day> = mesh.map_vertices(|v| Day(v.index() as u32 % 3));
    let red = Color::from_rgb8([200, 30, 30]);
    let colors = VertexMap::filled(mesh.vertex_count(), red);
    let attributes = mesh.attributes_mut();
    attributes.vertex.insert("temperature", heat);
    attributes.vertex.insert("day", days);
    attributes.vertex.insert(COLOR, colors);

    // Every edge is split in the middle, then every fifth edge that allows it collapses. The mesh
    // stays a manifold: an edit that would break it is refused and changes nothing.
    let mut editor = Editor::new(&mut mesh);
    for e in editor.edges().collect::<Vec<_>>() {
        let middle = editor.mesh().edge_midpoint(e);
        editor.split_edge_triangles(e, middle)?;
    }
    for e in editor.edges().step_by(5).collect::<Vec<_>>() {
        if editor.has_edge(e) && editor.can_collapse(e.halfedge()).is_ok() {
            editor.collapse(e.halfedge())?;
        }
    }
    let moved = editor.finish();

    // Temperatures were linear in x; mixed as positions are, they still are.
    let heat = mesh.attributes().vertex.get::<f64>("temperature").expect("it travels");
    for v in mesh.vertices() {
        assert!((heat[v] - (20.0 + 10.0 * mesh.position(v).x)).abs() < 1e-9);
    }
    let days = mesh.attributes().vertex.get::<Day>("day").expect("it travels");
    let latest = mesh.vertices().filter(|&v| days[v] == Day(2)).count();
    let colors = mesh.attributes().vertex.get::<Color>(COLOR).expect("it travels");
    assert!(mesh.vertices().all(|v| colors[v] == red));

    // Ids of before lead to those of now, or to nothing.
    let left = moved.vertices.values().iter().flatten().count();
    assert_eq!(left, mesh.vertex_count());
    let first = moved.vertices.values().iter().flatten().next().copied().expect("some are left");
    let reached = breadth_first(&mesh, &[first]).order.len();
    println!("{left} vertices, {latest} of them of day 2, {reached} within reach of {first}");
    mesh.validate()?;
    dgp::mesh::strict_mesh(&mesh.to_indexed(), Progress::NONE)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
