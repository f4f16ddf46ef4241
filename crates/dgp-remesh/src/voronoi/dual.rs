//! The dual of the clusters: a vertex for each, a triangle where three meet.
//!
//! A vertex lies at the point of its cluster nearest to the mean, or nearest to where the planes of its faces meet; that
//! of a cluster on the boundary at the point of its part of the boundary nearest to the mean of that part.

use dgp_mesh::{DMat3, DVec3, FaceList, IndexedFaceSet, Mesh, VertexId, linear::symmetric_eigen};

use super::{VoronoiPlacement, clusters::Clusters, flaws::labels};
use crate::{Error, Quadric};

/// How much the mean counts beside the planes: along an edge the vertex stays where it is.
const DAMPING: f64 = 1e-3;

/// Corners of planes are taken up to so many spreads from the mean.
const FAR: f64 = 2.0;

/// The part of the weight of its planes in the second direction from which a cluster has an edge: that of two planes
/// that meet at some 30° in its middle.
const EDGE: f64 = 0.06;

/// A point of the refined input.
#[derive(Clone, Copy)]
struct Place {
    square: f64,
    point: DVec3,
}

/// The mesh of the clusters at unit scale, and which of its vertices are to stay where they are.
pub(super) fn dual(
    clusters: &Clusters<'_>,
    placement: VoronoiPlacement,
) -> Result<(Mesh, Vec<bool>), Error> {
    let mesh = &clusters.fine.mesh;
    let (targets, mut is_fixed) = targets(clusters, placement);
    let places = places(clusters, &targets);
    let faces = mesh.faces().map(|f| labels(clusters, f));
    let triangles = faces.filter(|[a, b, c]| a != b && b != c && c != a);
    let triangles = triangles.map(|labels| labels.map(|label| VertexId::new(label as usize)));
    let faces = FaceList::from_triangles(triangles.collect());
    let positions: Vec<DVec3> = places.iter().map(|place| place.point).collect();
    for v in mesh.vertices().filter(|&v| clusters.is_border(v) && !mesh.is_isolated_vertex(v)) {
        is_fixed[clusters.label(v) as usize] = true;
    }
    Ok((Mesh::new(&IndexedFaceSet::new(positions, faces)?)?, is_fixed))
}

/// Where the vertices should be, and whether there is an edge or a corner.
fn targets(clusters: &Clusters<'_>, placement: VoronoiPlacement) -> (Vec<DVec3>, Vec<bool>) {
    let means: Vec<DVec3> = (0..clusters.len() as u32).map(|k| clusters.mean(k)).collect();
    let count = means.len();
    if placement == VoronoiPlacement::Mean {
        return (means, vec![false; count]);
    }
    let mesh = &clusters.fine.mesh;
    let mut quadrics = vec![Quadric::default(); count];
    for f in mesh.faces() {
        let first = mesh.face_halfedge(f);
        let points =
            [first, mesh.next(first), mesh.prev(first)].map(|h| mesh.position(mesh.from(h)));
        for label in labels(clusters, f) {
            // From the mean, so that no digits are lost.
            let mean = means[label as usize];
            quadrics[label as usize] += Quadric::triangle(points.map(|p| p - mean));
        }
    }
    let spreads = clusters.spreads();
    let target = |k: usize| {
        let quadric = &quadrics[k];
        let matrix = DMat3::from_cols(
            quadric.times(DVec3::X),
            quadric.times(DVec3::Y),
            quadric.times(DVec3::Z),
        );
        if symmetric_eigen(&matrix).values.y <= EDGE * quadric.weight() {
            return None;
        }
        let best = quadric.minimum_near(DVec3::ZERO, DAMPING);
        best.filter(|p| p.length_squared() <= FAR * FAR * spreads[k]).map(|p| means[k] + p)
    };
    let sharp: Vec<Option<DVec3>> = (0..count).map(target).collect();
    let targets = sharp.iter().zip(&means).map(|(target, mean)| target.unwrap_or(*mean)).collect();
    (targets, sharp.iter().map(Option::is_some).collect())
}

/// The point of each cluster nearest to its target.
fn places(clusters: &Clusters<'_>, targets: &[DVec3]) -> Vec<Place> {
    let mesh = &clusters.fine.mesh;
    let none = Place { square: f64::INFINITY, point: DVec3::ZERO };
    let mut places = vec![none; targets.len()];
    for f in mesh.faces() {
        let first = mesh.face_halfedge(f);
        let corners = [first, mesh.next(first), mesh.prev(first)].map(|h| mesh.from(h));
        let points = corners.map(|v| mesh.position(v));
        let [a, b, c] = corners.map(|v| clusters.label(v));
        for (label, is_new) in [(a, true), (b, b != a), (c, c != a && c != b)] {
            if is_new {
                let target = targets[label as usize];
                offer(&mut places[label as usize], target, nearest_in_triangle(target, points));
            }
        }
    }
    on_border(clusters, &mut places);
    places
}

/// Takes a point if it is nearer.
fn offer(place: &mut Place, target: DVec3, point: DVec3) {
    let square = point.distance_squared(target);
    if square < place.square {
        *place = Place { square, point };
    }
}

/// Puts the vertices of clusters on the boundary there.
fn on_border(clusters: &Clusters<'_>, places: &mut [Place]) {
    let mesh = &clusters.fine.mesh;
    let mut means = vec![(DVec3::ZERO, 0.0); places.len()];
    let border = || mesh.edges().filter(|&e| mesh.is_boundary_edge(e));
    for e in border() {
        let ends = mesh.edge_vertices(e);
        let points = ends.map(|v| mesh.position(v));
        let length = points[0].distance(points[1]);
        // Each half belongs to the cluster of its end.
        for (end, point, other) in
            [(ends[0], points[0], points[1]), (ends[1], points[1], points[0])]
        {
            let (sum, weight) = &mut means[clusters.label(end) as usize];
            *sum += 0.5 * length * (0.75 * point + 0.25 * other);
            *weight += 0.5 * length;
        }
    }
    // What was found inside gives way.
    for (place, (_, weight)) in places.iter_mut().zip(&means) {
        if *weight > 0.0 {
            place.square = f64::INFINITY;
        }
    }
    for e in border() {
        let ends = mesh.edge_vertices(e);
        let points = ends.map(|v| mesh.position(v));
        for (k, &end) in ends.iter().enumerate() {
            let label = clusters.label(end) as usize;
            let (sum, weight) = means[label];
            if weight > 0.0 {
                let target = sum / weight;
                let point = nearest_on_side(target, points[k], 0.5 * (points[0] + points[1]));
                offer(&mut places[label], target, point);
            }
        }
    }
}

/// The point between `a` and `b` nearest to `p`.
fn nearest_on_side(p: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let along = (p - a).dot(b - a) / (b - a).length_squared();
    // Without length there is one point, and no number.
    if along > 0.0 { a + along.min(1.0) * (b - a) } else { a }
}

/// The point of a triangle nearest to `p`: the foot of the perpendicular if it is inside, else the best of the sides.
fn nearest_in_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (u, v, q) = (b - a, c - a, p - a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    let (s, t) = (q.cross(v).dot(normal) / square, u.cross(q).dot(normal) / square);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return a + s * u + t * v;
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| nearest_on_side(p, from, to));
    let nearer = |x: DVec3, y: DVec3| {
        if y.distance_squared(p) < x.distance_squared(p) { y } else { x }
    };
    nearer(nearer(sides[0], sides[1]), sides[2])
}
