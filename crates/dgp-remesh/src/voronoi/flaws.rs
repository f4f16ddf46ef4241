//! Which clusters would not give a dual that is the same surface.
//!
//! The dual of a division of a surface is that surface where each part is a disk with at most one arc of the boundary,
//! two parts meet in nothing or one arc with at most one end on the boundary, and three in nothing or one point
//! (Edelsbrunner and Shah 1997). Here a part is what lies around the vertices of a cluster, and
//!
//! ```text
//! disk            1 = vertices − edges + triangles whose corners are all in the cluster
//! arcs            of two clusters: edges between both − triangles with corners in both and nowhere else
//! boundary arcs   of a cluster: vertices − edges of the boundary in it
//! ```
//!
//! A cluster that is not so is halved, the larger where two or three meet: in the end each vertex is a cluster of its
//! own, and the dual is the mesh.

use dgp_mesh::{FaceId, VertexId};

use super::clusters::Clusters;

/// What two clusters have in common.
struct Meeting {
    clusters: [u32; 2],
    arcs: i32,
    border: i32,
}

/// The clusters to be halved, ascending.
pub(super) fn flawed(clusters: &Clusters<'_>) -> Vec<u32> {
    let mesh = &clusters.fine.mesh;
    let mut disk = vec![0_i32; clusters.len()];
    let mut border = vec![0_i32; clusters.len()];
    let mut touches = vec![false; clusters.len()];
    let mut meetings: Vec<Meeting> = Vec::new();
    let mut points: Vec<[u32; 3]> = Vec::new();
    for v in mesh.vertices().filter(|&v| !mesh.is_isolated_vertex(v)) {
        let cluster = clusters.label(v) as usize;
        disk[cluster] += 1;
        if clusters.is_border(v) {
            border[cluster] += 1;
            touches[cluster] = true;
        }
    }
    for e in mesh.edges() {
        let [a, b] = mesh.edge_vertices(e).map(|v| clusters.label(v));
        let is_border = i32::from(mesh.is_boundary_edge(e));
        if a == b {
            disk[a as usize] -= 1;
            border[a as usize] -= is_border;
        } else {
            meetings.push(Meeting { clusters: [a.min(b), a.max(b)], arcs: 1, border: is_border });
        }
    }
    for f in mesh.faces() {
        let mut labels = labels(clusters, f);
        labels.sort_unstable();
        let [a, b, c] = labels;
        if a == c {
            disk[a as usize] += 1;
        } else if a == b || b == c {
            meetings.push(Meeting { clusters: [a, c], arcs: -1, border: 0 });
        } else {
            points.push(labels);
        }
    }
    let larger = |labels: &[u32]| {
        let size = |label: u32| clusters.sizes[label as usize];
        labels.iter().copied().max_by_key(|&label| (size(label), std::cmp::Reverse(label)))
    };
    let is_arc = |k: usize| border[k] == i32::from(touches[k]);
    let mut flawed: Vec<u32> =
        (0..clusters.len()).filter(|&k| disk[k] != 1 || !is_arc(k)).map(|k| k as u32).collect();
    meetings.sort_unstable_by_key(|meeting| meeting.clusters);
    for same in meetings.chunk_by(|a, b| a.clusters == b.clusters) {
        let arcs: i32 = same.iter().map(|meeting| meeting.arcs).sum();
        let border: i32 = same.iter().map(|meeting| meeting.border).sum();
        if arcs != 1 || border > 1 {
            flawed.extend(larger(&same[0].clusters));
        }
    }
    points.sort_unstable();
    for pair in points.windows(2).filter(|pair| pair[0] == pair[1]) {
        flawed.extend(larger(&pair[0]));
    }
    flawed.sort_unstable();
    flawed.dedup();
    flawed.retain(|&label| clusters.sizes[label as usize] > 1);
    flawed
}

/// The clusters of the corners of a triangle, in order.
pub(super) fn labels(clusters: &Clusters<'_>, f: FaceId) -> [u32; 3] {
    let mesh = &clusters.fine.mesh;
    let first = mesh.face_halfedge(f);
    let corners = [first, mesh.next(first), mesh.prev(first)];
    corners.map(|h| mesh.from(h)).map(|v: VertexId| clusters.label(v))
}
