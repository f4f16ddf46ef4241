//! Points, marked elements, boundaries and bare edges as capsules.

use dgp_mesh::{DVec3, NORMAL, Normal};

use crate::{
    Fill, Marked, PointSize, Shape, Stroke,
    body::Body,
    capsule::{Capsule, Look, Radius},
    color::linear,
    ink::Ink,
};

/// All lines and points of a body whose positions are relative to the eye; `pixel` is the number of
/// samples along a pixel.
pub(crate) fn capsules(body: &Body<'_>, ink: &Ink<'_>, pixel: f64) -> Vec<Capsule> {
    let style = body.style;
    let mut capsules = Vec::new();
    if body.shows_points() {
        add_points(body, ink, pixel, &mut capsules);
    }
    if style.fill == Fill::None && style.wireframe.width > 0.0 {
        add_lines(body, &sides(body), style.wireframe, pixel, &mut capsules);
    }
    if style.boundary.width > 0.0 {
        add_lines(body, &boundary(body), style.boundary, pixel, &mut capsules);
    }
    for mark in &style.marks {
        let stroke = Stroke { color: mark.color, width: mark.width };
        match (&mark.elements, body.shape) {
            (Marked::Vertices(set), _) => {
                for v in set.iter() {
                    let p = body.positions[v.index()];
                    // Balls twice as wide as lines look as heavy as they do.
                    let radius = Radius::Samples(mark.width * pixel);
                    let (color, look) = (linear(mark.color), Look::Ball);
                    capsules.push(Capsule { ends: [p; 2], radius, color, look });
                }
            }
            (Marked::Edges(set), Shape::Mesh(mesh)) => {
                let ends = |e| mesh.edge_vertices(e).map(|v| v.index() as u32);
                let edges: Vec<[u32; 2]> = set.iter().map(ends).collect();
                add_lines(body, &edges, stroke, pixel, &mut capsules);
            }
            (Marked::Segments(segments), _) => {
                let ends = |segment: &[dgp_mesh::VertexId; 2]| segment.map(|v| v.index() as u32);
                let segments: Vec<[u32; 2]> = segments.iter().map(ends).collect();
                add_lines(body, &segments, stroke, pixel, &mut capsules);
            }
            (Marked::Faces(_) | Marked::Edges(_), _) => {}
        }
    }
    capsules.retain(|capsule| capsule.ends.iter().all(|p| p.x.is_finite()));
    capsules
}

fn add_lines(
    body: &Body<'_>,
    edges: &[[u32; 2]],
    stroke: Stroke,
    pixel: f64,
    capsules: &mut Vec<Capsule>,
) {
    let (color, radius) = (linear(stroke.color), Radius::Samples(0.5 * stroke.width * pixel));
    capsules.extend(edges.iter().map(|edge| {
        let ends = edge.map(|v| body.positions[v as usize]);
        Capsule { ends, radius, color, look: Look::Line }
    }));
}

fn add_points(body: &Body<'_>, ink: &Ink<'_>, pixel: f64, capsules: &mut Vec<Capsule>) {
    let radius = match body.style.points.size {
        PointSize::Pixels(diameter) => Radius::Samples(0.5 * diameter.max(0.0) * pixel),
        PointSize::BySpacing => Radius::Space(0.6 * spacing(&body.positions), 0.6 * pixel),
    };
    let normals = match body.shape {
        Shape::Mesh(mesh) => mesh.attributes().vertex.get::<Normal>(NORMAL),
        Shape::Faces(set) => set.vertex_attributes.get::<Normal>(NORMAL),
        Shape::Points(_) => None,
    };
    let normals = normals.map(dgp_mesh::AttributeColumn::values);
    capsules.extend(body.positions.iter().enumerate().map(|(v, &p)| {
        let look = match normals.map(|normals| body.turn(normals[v].0)) {
            Some(n) if n != DVec3::ZERO => Look::Surfel(n.as_vec3().to_array()),
            _ => Look::Ball,
        };
        Capsule { ends: [p; 2], radius, color: ink.at_vertex(v), look }
    }));
}

/// About how far points on a surface are from their neighbors: the surface is taken to have the area
/// of the cells of a grid that hold points, seen along the axis along which they are fewest.
///
/// The grid is so coarse that cells on the surface hold several points each.
pub(crate) fn spacing(points: &[DVec3]) -> f64 {
    let finite = || points.iter().filter(|p| p.x.is_finite());
    let (mut min, mut max, mut count) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0_usize);
    for &p in finite() {
        (min, max, count) = (min.min(p), max.max(p), count + 1);
    }
    let size = (max - min).max_element();
    if count < 2 || size.is_nan() || size <= 0.0 {
        return if count == 0 || size <= 0.0 { 0.05 } else { size };
    }
    let cells = (0.35 * (count as f64).sqrt()).clamp(2.0, 1024.0);
    let cell = size / cells;
    let mut keys: Vec<u64> = finite()
        .map(|&p| {
            let [x, y, z] = ((p - min) / cell).to_array().map(|x| x as u64);
            x << 42 | y << 21 | z
        })
        .collect();
    keys.sort_unstable();
    keys.dedup();
    // A surface across a grid meets about 1.5 cells for each cell of its area.
    (keys.len() as f64 / 1.5 / count as f64).sqrt() * cell
}

/// The sides of all faces.
fn sides(body: &Body<'_>) -> Vec<[u32; 2]> {
    let mut sides = Vec::new();
    for (t, triangle) in body.triangles.iter().enumerate() {
        for k in (0..3).filter(|k| body.sides(t) >> k & 1 == 1) {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            sides.push([a.min(b), a.max(b)]);
        }
    }
    sides.sort_unstable();
    sides.dedup();
    sides
}

/// The edges with a face on one side only.
fn boundary(body: &Body<'_>) -> Vec<[u32; 2]> {
    if let Shape::Mesh(mesh) = body.shape {
        let edges = mesh.edges().filter(|&e| mesh.is_boundary_edge(e));
        return edges.map(|e| mesh.edge_vertices(e).map(|v| v.index() as u32)).collect();
    }
    let mut sides = Vec::new();
    for (t, triangle) in body.triangles.iter().enumerate() {
        for k in (0..3).filter(|k| body.sides(t) >> k & 1 == 1) {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            sides.push([a.min(b), a.max(b)]);
        }
    }
    sides.sort_unstable();
    sides.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spacing_of_a_grid_of_points_is_nearly_that_of_the_grid() {
        let grid = |n: usize, step: f64| -> Vec<DVec3> {
            let point = |i: usize| DVec3::new((i % n) as f64, (i / n) as f64, 0.0) * step;
            (0..n * n).map(point).collect()
        };
        for n in [10, 100, 300] {
            let found = spacing(&grid(n, 0.25));
            assert!((0.15..0.35).contains(&found), "{n}: {found}");
        }
        assert_eq!(spacing(&grid(50, 2.0)), 8.0 * spacing(&grid(50, 0.25)));
    }

    #[test]
    fn few_points_have_some_spacing() {
        for points in [vec![], vec![DVec3::ONE], vec![DVec3::ONE; 5], vec![DVec3::NAN; 2]] {
            assert_eq!(spacing(&points), 0.05, "{points:?}");
        }
    }
}
