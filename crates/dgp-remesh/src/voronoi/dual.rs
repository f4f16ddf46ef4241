//! The dual of the clusters: a vertex for each, a triangle where three meet.
//!
//! A vertex lies at the point of its cluster nearest to the mean, or nearest to where the planes of its faces meet; that
//! of a cluster on the boundary at the point of its part of the boundary nearest to the mean of that part.

use dgp_mesh::{
    Attributes, CornerId, DVec3, FaceId, FaceList, HalfedgeId, IndexedFaceSet, Mesh, Progress,
    VertexId, measure::barycentric_3d,
};

use super::{VoronoiPlacement, clusters::Clusters, flaws::labels};
use crate::{Error, Quadric, sample::mixed};

/// How much the mean counts beside the planes: directions in which faces bend less stay free.
const DAMPING: f64 = 1e-2;

/// Corners of planes are taken up to so many spreads from the mean.
const FAR: f64 = 2.0;

/// A point of the refined input.
#[derive(Clone, Copy)]
struct Place {
    square: f64,
    point: DVec3,
    face: FaceId,
}

/// The mesh of the clusters with the data of `input`, and the names of data that it cannot have.
pub(super) fn dual(
    input: &Mesh,
    clusters: &Clusters<'_>,
    placement: VoronoiPlacement,
    progress: Progress<'_>,
) -> Result<(Mesh, Vec<String>), Error> {
    let fine = clusters.fine;
    let places = places(clusters, &targets(clusters, placement));
    progress.report(0.5)?;
    let (mut triangles, mut sources) = (Vec::new(), Vec::new());
    for f in fine.mesh.faces() {
        let [a, b, c] = labels(clusters, f);
        if a != b && b != c && c != a {
            triangles.push([a, b, c].map(|label| VertexId::new(label as usize)));
            sources.push(FaceId::new(fine.parents[f.index()] as usize));
        }
    }
    let positions: Vec<DVec3> = places.iter().map(|place| place.point * fine.unit).collect();
    let mut set = IndexedFaceSet::new(positions, FaceList::from_triangles(triangles))?;
    let dropped = carry(input, clusters, &places, &sources, &mut set);
    Ok((Mesh::new(&set)?, dropped))
}

/// Where the vertices should be.
fn targets(clusters: &Clusters<'_>, placement: VoronoiPlacement) -> Vec<DVec3> {
    let means: Vec<DVec3> = (0..clusters.len() as u32).map(|k| clusters.mean(k)).collect();
    if placement == VoronoiPlacement::Mean {
        return means;
    }
    let mesh = &clusters.fine.mesh;
    let mut quadrics = vec![Quadric::default(); means.len()];
    for f in mesh.faces() {
        let corners = labels(clusters, f);
        let first = mesh.face_halfedge(f);
        let points =
            [first, mesh.next(first), mesh.prev(first)].map(|h| mesh.position(mesh.from(h)));
        for label in corners {
            // From the mean, so that no digits are lost.
            let mean = means[label as usize];
            quadrics[label as usize] += Quadric::triangle(points.map(|p| p - mean));
        }
    }
    let spreads = clusters.spreads();
    let target = |k: usize| {
        let best = quadrics[k].minimum_near(DVec3::ZERO, DAMPING);
        best.filter(|p| p.length_squared() <= FAR * FAR * spreads[k])
            .map_or(means[k], |p| means[k] + p)
    };
    (0..means.len()).map(target).collect()
}

/// The point of each cluster nearest to its target.
fn places(clusters: &Clusters<'_>, targets: &[DVec3]) -> Vec<Place> {
    let mesh = &clusters.fine.mesh;
    let none = Place { square: f64::INFINITY, point: DVec3::ZERO, face: FaceId::new(0) };
    let mut places = vec![none; targets.len()];
    for f in mesh.faces() {
        let first = mesh.face_halfedge(f);
        let corners = [first, mesh.next(first), mesh.prev(first)].map(|h| mesh.from(h));
        let points = corners.map(|v| mesh.position(v));
        let [a, b, c] = corners.map(|v| clusters.label(v));
        for (label, is_new) in [(a, true), (b, b != a), (c, c != a && c != b)] {
            if is_new {
                let target = targets[label as usize];
                offer(&mut places[label as usize], target, nearest_in_triangle(target, points), f);
            }
        }
    }
    on_border(clusters, &mut places);
    places
}

/// Takes a point if it is nearer.
fn offer(place: &mut Place, target: DVec3, point: DVec3, face: FaceId) {
    let square = point.distance_squared(target);
    if square < place.square {
        *place = Place { square, point, face };
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
        let Some(face) = mesh.edge_faces(e).into_iter().flatten().next() else { continue };
        for (k, &end) in ends.iter().enumerate() {
            let label = clusters.label(end) as usize;
            let (sum, weight) = means[label];
            if weight > 0.0 {
                let target = sum / weight;
                let point = nearest_on_side(target, points[k], 0.5 * (points[0] + points[1]));
                offer(&mut places[label], target, point, face);
            }
        }
    }
}

/// Data of the input for the vertices, faces and corners of the result; returns what has no place there.
fn carry(
    input: &Mesh,
    clusters: &Clusters<'_>,
    places: &[Place],
    sources: &[FaceId],
    set: &mut IndexedFaceSet,
) -> Vec<String> {
    let Attributes { vertex, corner, edge, face } = input.attributes();
    let mut dropped: Vec<String> = edge.names().map(str::to_owned).collect();
    // Columns of corners that are the same around each vertex are data of vertices in truth.
    let around = |v: VertexId| {
        let corners = input.vertex_halfedges(v).filter(|&h| input.face(h).is_some());
        let corners: Vec<HalfedgeId> = corners.collect();
        (1..corners.len()).map(|i| [corners[0], corners[i]]).collect::<Vec<_>>()
    };
    let jumping = corner.differing(input.vertices().flat_map(around));
    let parts = |k: usize| {
        let face = FaceId::new(clusters.fine.parents[places[k].face.index()] as usize);
        let first = input.face_halfedge(face);
        let corners = [first, input.next(first), input.prev(first)];
        let points = corners.map(|h| input.position(input.from(h)) / clusters.fine.unit);
        let weights = barycentric_3d(places[k].point, points).unwrap_or([1.0, 0.0, 0.0]);
        let weights = weights.map(|x| x.max(0.0));
        let sum: f64 = weights.iter().sum();
        [0, 1, 2].map(|k| (weights[k] / sum, corners[k]))
    };
    set.vertex_attributes =
        mixed(vertex, places.len(), |k| parts(k).map(|(weight, h)| (weight, input.from(h))));
    let at_vertices = mixed(corner, places.len(), parts);
    let faces = set.faces().clone();
    set.corner_attributes =
        at_vertices.gather(faces.corners().len(), |c: CornerId| Some(faces.vertex(c)));
    for name in jumping {
        set.corner_attributes.remove(&name);
        dropped.push(name);
    }
    set.face_attributes = face.gather(sources.len(), |f: FaceId| Some(sources[f.index()]));
    dropped
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
