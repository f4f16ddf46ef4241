//! The topology report: everything that can be said of a mesh without its coordinates.
//!
//! ```text
//! V − E + F = χ = Σ (2 − 2g − b) over the components
//! ```
//!
//! with genus g and b boundary loops for each orientable component.
//!
//! - Input: any faces, manifold or not. Vertices of no face are counted apart and belong to nothing.
//! - Cost: O(V + F) memory, and time but for sorting around each vertex.

use std::collections::BTreeMap;

use super::{
    components::face_list_components,
    edges::{EdgeUse, Side, for_each_edge},
    union_find::UnionFind,
};
use crate::{FaceId, FaceList, IndexedFaceSet, VertexId};

/// What [`topology_report`] finds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[must_use]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, read one by one")]
pub struct TopologyReport {
    /// All vertices.
    pub vertices: usize,
    /// Those on no face.
    pub isolated_vertices: usize,
    /// Pairs of vertices that a side of a face joins.
    pub edges: usize,
    /// All faces.
    pub faces: usize,
    /// Faces of three corners.
    pub triangles: usize,
    /// Faces of four corners.
    pub quads: usize,
    /// Faces of five corners or more.
    pub polygons: usize,
    /// Faces of fewer than three corners, and those that name a vertex twice.
    pub degenerate_faces: usize,
    /// Edges with one face.
    pub boundary_edges: usize,
    /// Edges with more than two faces.
    pub non_manifold_edges: usize,
    /// Vertices where the faces form anything but one fan.
    pub non_manifold_vertices: usize,
    /// Edges with two faces that disagree on which side is outside.
    pub flipped_edges: usize,
    /// How many holes there are: connected parts of all boundary edges. Holes that touch at a
    /// non-manifold vertex count as one.
    pub boundary_loops: usize,
    /// V − E + F over the vertices on faces.
    pub euler_characteristic: i64,
    /// The number of handles of all components; `None` unless manifold and orientable.
    pub genus: Option<usize>,
    /// Each part that hangs together, by smallest vertex. Faces that share a vertex hang together.
    pub components: Vec<ComponentReport>,
    /// Whether there are faces and no boundary edges.
    pub closed: bool,
    /// Whether the faces enclose a volume: closed, and along each edge as many faces lead one way as
    /// the other.
    pub watertight: bool,
    /// Whether no edge, vertex or face is non-manifold or degenerate.
    pub manifold: bool,
    /// Whether no edge is flipped.
    pub oriented: bool,
    /// Whether faces can be turned so that none is flipped.
    pub orientable: bool,
    /// Whether all faces hang together.
    pub connected: bool,
    /// k, if there are faces and each vertex on a face has k edges.
    pub regular: Option<usize>,
    /// How many vertices on faces have each number of edges.
    pub valence: BTreeMap<usize, usize>,
    /// How many faces have each number of corners.
    pub degree: BTreeMap<usize, usize>,
}

/// One component of a [`TopologyReport`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ComponentReport {
    /// Its vertices.
    pub vertices: usize,
    /// Its edges.
    pub edges: usize,
    /// Its faces.
    pub faces: usize,
    /// Its holes, as in [`TopologyReport::boundary_loops`].
    pub boundary_loops: usize,
    /// V − E + F.
    pub euler_characteristic: i64,
    /// The number of its handles; `None` unless manifold and orientable.
    pub genus: Option<usize>,
}

impl TopologyReport {
    /// 2E / V, the mean number of edges of a vertex on a face; `None` without faces.
    pub fn mean_valence(&self) -> Option<f64> {
        let vertices = self.vertices - self.isolated_vertices;
        (vertices > 0).then(|| 2.0 * self.edges as f64 / vertices as f64)
    }
}

/// Counts, components, holes, genus and properties of any face set.
pub fn topology_report(set: &IndexedFaceSet) -> TopologyReport {
    face_list_report(set.vertex_count(), set.faces())
}

/// The same for faces without positions, such as [`Connectivity::to_faces`](crate::Connectivity).
///
/// # Panics
/// If a face names a vertex beyond `vertex_count`.
pub fn face_list_report(vertex_count: usize, faces: &FaceList) -> TopologyReport {
    let components = face_list_components(vertex_count, faces);
    let mut tally = Tally::new(vertex_count, faces);
    for_each_edge(vertex_count, faces, |edge, sides| tally.add(faces, edge, sides));
    let mut report = TopologyReport {
        vertices: vertex_count,
        faces: faces.len(),
        components: vec![ComponentReport::default(); components.count],
        orientable: true,
        ..TopologyReport::default()
    };
    let mut is_sound = vec![true; components.count];
    let part_of = |v: VertexId| components.vertex[v].map(|c| c as usize);
    let mut balanced = true;
    for edge in &tally.edges {
        report.edges += 1;
        report.boundary_edges += usize::from(edge.is_boundary());
        report.non_manifold_edges += usize::from(edge.is_non_manifold());
        report.flipped_edges += usize::from(edge.is_flipped());
        balanced &= edge.forward == edge.backward;
        if let Some(c) = part_of(edge.vertices[0]) {
            report.components[c].edges += 1;
        }
    }
    let fans = tally.fans(vertex_count, faces);
    for v in (0..vertex_count).map(VertexId::new) {
        let i = v.index();
        let Some(c) = part_of(v) else {
            report.isolated_vertices += 1;
            continue;
        };
        let is_manifold = fans[i] == 1 && !tally.at_bad_edge[i];
        let is_first_of_rim = tally.on_rim[i] && tally.rims.find(i) == i;
        report.non_manifold_vertices += usize::from(!is_manifold);
        is_sound[c] &= is_manifold;
        *report.valence.entry(tally.valence[i] as usize).or_default() += 1;
        report.boundary_loops += usize::from(is_first_of_rim);
        report.components[c].boundary_loops += usize::from(is_first_of_rim);
        report.components[c].vertices += 1;
    }
    for (f, face) in faces.iter() {
        let is_degenerate = is_degenerate(face);
        let is_one_sided = tally.is_one_sided(f);
        report.degenerate_faces += usize::from(is_degenerate);
        report.orientable &= !is_one_sided;
        *report.degree.entry(face.len()).or_default() += 1;
        if let Some(c) = components.face[f] {
            report.components[c as usize].faces += 1;
            is_sound[c as usize] &= !is_degenerate && !is_one_sided;
        }
    }
    for (part, is_sound) in report.components.iter_mut().zip(is_sound) {
        part.euler_characteristic = part.vertices as i64 - part.edges as i64 + part.faces as i64;
        // 2 − 2g − b = χ has a solution g ≥ 0 on every orientable manifold.
        let handles = 2 - part.boundary_loops as i64 - part.euler_characteristic;
        part.genus = is_sound.then_some(handles as usize / 2);
    }
    conclude(&mut report, balanced);
    report
}

/// Fills in what follows from the counts.
fn conclude(report: &mut TopologyReport, balanced: bool) {
    let of_degree = |degree| report.degree.get(&degree).copied().unwrap_or(0);
    (report.triangles, report.quads) = (of_degree(3), of_degree(4));
    report.polygons = report.degree.range(5..).map(|(_, count)| count).sum();
    report.euler_characteristic = report.components.iter().map(|c| c.euler_characteristic).sum();
    report.closed = report.faces > 0 && report.boundary_edges == 0;
    report.watertight = report.closed && balanced;
    report.manifold = report.non_manifold_edges == 0
        && report.non_manifold_vertices == 0
        && report.degenerate_faces == 0;
    report.oriented = report.flipped_edges == 0;
    report.connected = report.components.len() == 1;
    report.genus = report.components.iter().map(|c| c.genus).sum();
    report.regular = match report.valence.len() {
        1 => report.valence.keys().next().copied(),
        _ => None,
    };
}

/// Whether `face` has fewer than three corners or names a vertex twice.
fn is_degenerate(face: &[VertexId]) -> bool {
    match *face {
        [a, b, c] => a == b || b == c || c == a,
        [] | [_] | [_, _] => true,
        _ => {
            let mut sorted = face.to_vec();
            sorted.sort_unstable();
            sorted.windows(2).any(|pair| pair[0] == pair[1])
        }
    }
}

/// What is gathered edge by edge.
struct Tally {
    edges: Vec<EdgeUse>,
    /// The number of edges at each vertex.
    valence: Vec<u32>,
    /// Whether a vertex ends an edge of more than two faces.
    at_bad_edge: Vec<bool>,
    /// Whether a vertex ends a boundary edge.
    on_rim: Vec<bool>,
    /// Vertices joined by boundary edges.
    rims: UnionFind,
    /// Corners joined where their faces share an edge at their vertex: the fans.
    corners: UnionFind,
    /// Faces as they are (2f) and turned over (2f + 1), joined where they agree along an edge. On a
    /// one-sided surface a face is joined with itself turned over.
    turned: UnionFind,
    /// The face of each corner.
    face: Vec<FaceId>,
}

impl Tally {
    fn new(vertex_count: usize, faces: &FaceList) -> Self {
        Tally {
            edges: Vec::with_capacity(faces.corners().len() / 2 + 1),
            valence: vec![0; vertex_count],
            at_bad_edge: vec![false; vertex_count],
            on_rim: vec![false; vertex_count],
            rims: UnionFind::new(vertex_count),
            corners: UnionFind::new(faces.corners().len()),
            turned: UnionFind::new(2 * faces.len()),
            face: faces.iter().flat_map(|(f, face)| face.iter().map(move |_| f)).collect(),
        }
    }

    fn add(&mut self, faces: &FaceList, edge: EdgeUse, sides: &[Side]) {
        self.edges.push(edge);
        let [a, b] = edge.vertices.map(VertexId::index);
        for v in [a, b] {
            self.valence[v] += 1;
            self.at_bad_edge[v] |= edge.is_non_manifold();
            self.on_rim[v] |= edge.is_boundary();
        }
        if edge.is_boundary() {
            self.rims.join(a, b);
        }
        for pair in sides.windows(2) {
            let is_opposite = faces.vertex(pair[0].from) != faces.vertex(pair[1].from);
            let ends =
                if is_opposite { [pair[1].to, pair[1].from] } else { [pair[1].from, pair[1].to] };
            self.corners.join(pair[0].from.index(), ends[0].index());
            self.corners.join(pair[0].to.index(), ends[1].index());
            if sides.len() == 2 {
                let [f, g] = [pair[0], pair[1]].map(|s| 2 * self.face[s.from.index()].index());
                let turn = usize::from(!is_opposite);
                self.turned.join(f, g + turn);
                self.turned.join(f + 1, g + 1 - turn);
            }
        }
    }

    /// How many fans the corners of each vertex form.
    fn fans(&mut self, vertex_count: usize, faces: &FaceList) -> Vec<u32> {
        let mut fans = vec![0; vertex_count];
        for (c, v) in faces.corners().iter().enumerate() {
            fans[v.index()] += u32::from(self.corners.find(c) == c);
        }
        fans
    }

    /// Whether walking over edges leads from one side of `f` to the other.
    fn is_one_sided(&mut self, f: FaceId) -> bool {
        self.turned.find(2 * f.index()) == self.turned.find(2 * f.index() + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report<F: AsRef<[usize]>>(vertices: usize, faces: &[F]) -> TopologyReport {
        face_list_report(vertices, &FaceList::from_indices(faces))
    }

    const TETRAHEDRON: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_everything_a_solid_should_be() {
        let found = report(5, &TETRAHEDRON);
        assert!(found.closed && found.watertight && found.manifold && found.oriented);
        assert!(found.orientable && found.connected);
        assert_eq!((found.edges, found.euler_characteristic, found.genus), (6, 2, Some(0)));
        assert_eq!((found.isolated_vertices, found.regular), (1, Some(3)));
        assert_eq!(found.valence, BTreeMap::from([(3, 4)]));
        assert_eq!(found.mean_valence(), Some(3.0));
    }

    #[test]
    fn a_turned_face_spoils_the_orientation_but_not_orientability() {
        let mut faces = TETRAHEDRON;
        faces[0].reverse();
        let found = report(4, &faces);
        assert!(found.closed && found.manifold && found.orientable);
        assert!(!found.oriented && !found.watertight);
        assert_eq!((found.flipped_edges, found.genus), (3, Some(0)));
    }

    #[test]
    fn a_moebius_strip_has_one_rim_and_no_genus() {
        // Five quads around, the last one glued with a half turn.
        let faces = [[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5], [6, 8, 9, 7], [8, 1, 0, 9]];
        let found = report(10, &faces);
        assert!(found.manifold && !found.orientable && !found.closed);
        assert_eq!((found.euler_characteristic, found.boundary_loops, found.genus), (0, 1, None));
        assert_eq!(found.quads, 5);
    }

    #[test]
    fn two_solids_that_touch_at_a_vertex_are_one_component_that_is_no_manifold() {
        let other = TETRAHEDRON.map(|face| face.map(|v| if v == 3 { 3 } else { v + 4 }));
        let found = report(7, &[TETRAHEDRON, other].concat());
        assert!(found.watertight && !found.manifold && found.connected);
        assert_eq!((found.non_manifold_vertices, found.non_manifold_edges), (1, 0));
        assert_eq!(found.genus, None);
    }

    #[test]
    fn three_faces_at_an_edge_break_the_edge_and_its_ends() {
        let found = report(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!((found.non_manifold_edges, found.non_manifold_vertices), (1, 2));
        assert!(!found.manifold && !found.closed);
    }

    #[test]
    fn degenerate_faces_are_counted_not_feared() {
        let found = report::<&[usize]>(4, &[&[], &[0], &[1, 2], &[3, 3, 3]]);
        assert_eq!((found.degenerate_faces, found.edges, found.components.len()), (4, 1, 3));
        assert!(!found.manifold && found.genus.is_none());
        let none = report::<[usize; 3]>(2, &[]);
        assert!(!none.closed && none.components.is_empty() && none.genus == Some(0));
    }
}
