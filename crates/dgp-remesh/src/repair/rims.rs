//! Joining rims that lie along each other, T-junctions first.
//!
//! ```text
//!     ╲  │  ╱                          ╲  │  ╱
//!   a──t₁─t₂──b    split a b where   a──t₁─t₂──b    then edges at one place
//!   a─────────b    t₁ and t₂ are     a──┬──┬───b    become one
//!      ╲   ╱                            ╲  │ ╱
//! ```
//!
//! A vertex of a rim is a T-junction where it lies on an edge of a rim and an edge of its own rim runs along
//! that. Then edges of rims whose ends are at one place are joined; components are turned over for it where
//! that contradicts no other edge, so that a Möbius strip that was cut stays cut.
//!
//! - Input: a mesh of any polygons; what is split stays triangles where it was.
//! - Cost: O(n log n) for n edges of rims, O(F) where something is joined.
//! - Guarantees: the result is a manifold. A vertex moves at most as far as welding its rims moves it.
//! - Reference: Guéziec, Taubin, Lazarus and Horn, "Cutting and stitching: converting sets of polygons to
//!   manifold surfaces", IEEE TVCG 2001.
//! - Departs from it: of more than two edges at one place only those are joined that belong to one component
//!   without it.

use std::collections::BTreeMap;

use dgp_mesh::{
    DVec3, Editor, FaceId, FaceList, HalfedgeId, IndexedFaceSet, Mesh, Progress, RepairOptions,
    Tolerance, VertexId, VertexMap, Welding, repair_faces, spatial::TriangleTree,
    topology::components, weld_as, weld_within,
};

use super::{geometry, track::Track};
use crate::Error;

/// A T-junction is nearer to the edge than this fraction of its length, whatever the tolerance.
const SLANT: f64 = 0.01;

/// What [`stitch_rims`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[must_use]
pub struct StitchReport {
    /// T-junctions: vertices put on edges of rims.
    pub junctions: usize,
    /// Pairs of edges that became one.
    pub joined: usize,
    /// Vertices that went into others.
    pub merged: usize,
}

/// Joins rims of `mesh` that are up to `tolerance` apart, T-junctions included.
///
/// Errors: [`Error::NotFinite`]; [`Error::Mesh`] for a tolerance that is no length; [`Error::Edit`] if
/// there is no room for more vertices; [`Error::Cancelled`], which leaves the mesh as it was.
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, Progress, Tolerance};
/// use dgp_remesh::stitch_rims;
///
/// // Above the edge from 0 to 1 one triangle, below it two that meet in its middle.
/// let points = [[0, 0], [2, 0], [1, 2], [0, 0], [1, 0], [2, 0], [1, -2]];
/// let points = points.map(|[x, y]| DVec3::new(f64::from(x), f64::from(y), 0.0)).to_vec();
/// let faces = FaceList::from_indices(&[[0, 1, 2], [4, 3, 6], [5, 4, 6]]);
/// let mut mesh = Mesh::new(&IndexedFaceSet::new(points, faces)?)?;
/// let report = stitch_rims(&mut mesh, Tolerance::Exact, Progress::NONE)?;
/// assert_eq!((report.junctions, report.joined), (1, 2));
/// assert_eq!((mesh.vertex_count(), mesh.face_count()), (5, 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn stitch_rims(
    mesh: &mut Mesh,
    tolerance: Tolerance,
    progress: Progress<'_>,
) -> Result<StitchReport, Error> {
    let mut track = Track::of(mesh);
    stitch(mesh, tolerance, &RepairOptions::default(), &mut track, progress)
}

pub(super) fn stitch(
    mesh: &mut Mesh,
    tolerance: Tolerance,
    options: &RepairOptions,
    track: &mut Track,
    progress: Progress<'_>,
) -> Result<StitchReport, Error> {
    geometry::need_finite(mesh)?;
    let mut report = StitchReport::default();
    let reach = match tolerance {
        Tolerance::Exact => 0.0,
        Tolerance::Distance(distance) => distance,
        Tolerance::OfDiagonal(fraction) => fraction * geometry::diagonal(mesh),
    };
    // Whether the tolerance is one is for the welding to say.
    let classes = Classes::new(mesh, Tolerance::Distance(reach), progress.part(0.0, 0.2))?;
    if classes.rims.is_empty() {
        progress.report(1.0)?;
        return Ok(report);
    }
    let junctions = find_junctions(mesh, &classes, reach, progress.part(0.2, 0.4))?;
    let mut changed = mesh.clone();
    let mut now = track.clone();
    report.junctions = split(&mut changed, &mut now, &junctions)?;
    progress.report(0.5)?;
    let classes = if report.junctions > 0 {
        Classes::new(&changed, Tolerance::Distance(reach), progress.part(0.5, 0.6))?
    } else {
        classes
    };
    let (welding, joined) = classes.welding(&changed);
    report.joined = joined;
    report.merged = welding.merged();
    if report.merged > 0 {
        let (welded, _) = weld_as(&changed.to_indexed(), welding.clone());
        // What was asked for at the start is done; here only what joining has brought about.
        let options = RepairOptions { weld: None, hole_edges: 0, ..*options };
        let (faces, mended) = repair_faces(&welded, &options, progress.part(0.6, 0.9))?;
        let joined = Mesh::new(&faces)?;
        let rims = |mesh: &Mesh| mesh.edges().filter(|&e| mesh.is_boundary_edge(e)).count();
        if rims(&joined) >= rims(mesh) {
            // What was joined came apart again, since it made no manifold.
            progress.report(1.0)?;
            return Ok(StitchReport::default());
        }
        changed = joined;
        now.welded(&welding);
        now.repaired(&mended);
    }
    (*mesh, *track) = (changed, now);
    progress.report(1.0)?;
    Ok(report)
}

/// The places where vertices of rims are.
struct Classes {
    /// The sides of faces along rims.
    rims: Vec<HalfedgeId>,
    /// The place of each vertex of a rim.
    class: VertexMap<Option<u32>>,
}

impl Classes {
    fn new(mesh: &Mesh, tolerance: Tolerance, progress: Progress<'_>) -> Result<Self, Error> {
        let rims: Vec<HalfedgeId> = mesh
            .halfedges()
            .filter(|&h| mesh.face(h).is_some() && mesh.face(h.twin()).is_none())
            .collect();
        let mut vertices: Vec<VertexId> =
            rims.iter().flat_map(|&h| [mesh.from(h), mesh.to(h)]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points: Vec<DVec3> = vertices.iter().map(|&v| mesh.position(v)).collect();
        let welding = weld_within(&points, tolerance, progress)?;
        let mut class = VertexMap::filled(mesh.vertex_count(), None);
        for (&v, place) in vertices.iter().zip(welding.vertices.values()) {
            class[v] = Some(place.index() as u32);
        }
        Ok(Classes { rims, class })
    }

    /// The places of both ends of a side; `None` where they are one.
    fn ends(&self, mesh: &Mesh, h: HalfedgeId) -> Option<[u32; 2]> {
        let (a, b) = (self.class[mesh.from(h)]?, self.class[mesh.to(h)]?);
        (a != b).then_some([a, b])
    }

    /// Which vertices become one when edges at one place are joined, and how many pairs of edges that are.
    fn welding(&self, mesh: &Mesh) -> (Welding, usize) {
        let mut places: BTreeMap<[u32; 2], Vec<(HalfedgeId, bool)>> = BTreeMap::new();
        for &h in &self.rims {
            if let Some([a, b]) = self.ends(mesh, h) {
                places.entry([a.min(b), a.max(b)]).or_default().push((h, a < b));
            }
        }
        let parts = components(mesh);
        let part = |h: HalfedgeId| mesh.face(h).and_then(|f| parts.face[f]).map(|c| c as usize);
        let mut sides = Parity::new(parts.count);
        let mut vertices = Parity::new(mesh.vertex_count());
        let mut joined = 0;
        let mut join = |sides: &mut Parity, group: &[(HalfedgeId, bool)]| {
            let &[(first, forward), (second, runs_forward)] = group else { return };
            let (Some(s), Some(t)) = (part(first), part(second)) else { return };
            // Faces that agree run along a shared edge in opposite directions.
            let turned = runs_forward == forward;
            if mesh.face(first) == mesh.face(second) || !sides.join(s, t, turned) {
                return;
            }
            let ends = |h: HalfedgeId| [mesh.from(h).index(), mesh.to(h).index()];
            let ([a, b], [c, d]) = (ends(first), ends(second));
            let [c, d] = if turned { [c, d] } else { [d, c] };
            vertices.join(a, c, false);
            vertices.join(b, d, false);
            joined += 1;
        };
        for group in places.values() {
            join(&mut sides, group);
        }
        // Of more than two at a place those that hang together by now, as solids that touch do.
        for group in places.values().filter(|group| group.len() > 2) {
            let mut whole: BTreeMap<usize, Vec<(HalfedgeId, bool)>> = BTreeMap::new();
            for &side in group {
                if let Some(part) = part(side.0) {
                    whole.entry(sides.find(part).0).or_default().push(side);
                }
            }
            for group in whole.values() {
                join(&mut sides, group);
            }
        }
        let mut originals = VertexMap::new();
        let mut numbers = VertexMap::filled(mesh.vertex_count(), VertexId::new(0));
        for v in mesh.vertices() {
            let root = VertexId::new(vertices.find(v.index()).0);
            numbers[v] = if root == v { originals.push(v) } else { numbers[root] };
        }
        (Welding { vertices: numbers, originals }, joined)
    }
}

/// Sets that are joined, with what is known of which members are turned against each other.
struct Parity {
    parents: Vec<(u32, bool)>,
}

impl Parity {
    fn new(len: usize) -> Self {
        Parity { parents: (0..len as u32).map(|i| (i, false)).collect() }
    }

    /// The smallest of the set of `i`, and whether `i` is turned against it.
    fn find(&mut self, i: usize) -> (usize, bool) {
        let (mut root, mut turned) = (i, false);
        while self.parents[root].0 as usize != root {
            turned ^= self.parents[root].1;
            root = self.parents[root].0 as usize;
        }
        let (mut at, mut rest) = (i, turned);
        while at != root {
            let (next, step) = self.parents[at];
            self.parents[at] = (root as u32, rest);
            rest ^= step;
            at = next as usize;
        }
        (root, turned)
    }

    /// Joins the sets of `i` and `j`, which are `turned` against each other or not; false if the opposite
    /// is known.
    fn join(&mut self, i: usize, j: usize, turned: bool) -> bool {
        let ((r, a), (s, b)) = (self.find(i), self.find(j));
        if r == s {
            return a ^ b == turned;
        }
        self.parents[r.max(s)] = (r.min(s) as u32, a ^ b ^ turned);
        true
    }
}

/// A vertex of a rim on a side along another, and how far along that.
struct Junction {
    side: HalfedgeId,
    along: f64,
    vertex: VertexId,
}

fn find_junctions(
    mesh: &Mesh,
    classes: &Classes,
    reach: f64,
    progress: Progress<'_>,
) -> Result<Vec<Junction>, Error> {
    // Edges as triangles without area, for which the tree knows their points.
    let mut edges = FaceList::new();
    for &h in &classes.rims {
        edges.push(&[mesh.from(h), mesh.to(h), mesh.to(h)]);
    }
    let edges = IndexedFaceSet::new(mesh.positions().clone(), edges)?;
    let tree = TriangleTree::new(&edges, progress.part(0.0, 0.3))?;
    let mut found = Vec::new();
    // The rim passes each of its vertices once.
    for (k, &arriving) in classes.rims.iter().enumerate() {
        if k % 4096 == 0 {
            progress.report(0.3 + 0.7 * k as f64 / classes.rims.len() as f64)?;
        }
        let v = mesh.to(arriving);
        let near = tree.faces_within(mesh.position(v), reach);
        if near.len() <= 2 {
            continue;
        }
        let on: Vec<(HalfedgeId, f64)> = near
            .into_iter()
            .map(|f| classes.rims[f.index()])
            .filter_map(|side| Some((side, place_on(mesh, classes, side, v, reach)?)))
            .collect();
        found.extend(on.into_iter().map(|(side, along)| Junction { side, along, vertex: v }));
    }
    keep_chains(mesh, classes, &mut found);
    found.sort_by(|s, t| {
        s.side.cmp(&t.side).then(s.along.total_cmp(&t.along)).then(s.vertex.cmp(&t.vertex))
    });
    // Vertices at one place are one junction.
    found.dedup_by(|s, t| s.side == t.side && classes.class[s.vertex] == classes.class[t.vertex]);
    Ok(found)
}

/// How far along a side `v` lies, strictly between its ends; `None` if it does not lie on it.
fn place_on(
    mesh: &Mesh,
    classes: &Classes,
    side: HalfedgeId,
    v: VertexId,
    reach: f64,
) -> Option<f64> {
    let [a, b] = classes.ends(mesh, side)?;
    let face = mesh.face(side)?;
    if classes.class[v] == Some(a)
        || classes.class[v] == Some(b)
        || mesh.face_vertices(face).any(|w| w == v)
    {
        return None;
    }
    let [p, q] = [mesh.from(side), mesh.to(side)].map(|w| mesh.position(w));
    let length = geometry::distance(p, q);
    let x = mesh.position(v);
    let along = geometry::distance(p, x) / length;
    (along < 1.0
        && geometry::distance(x, q) < length
        && geometry::height(p, q, x) <= reach.min(SLANT * length))
    .then_some(along)
}

/// Keeps the junctions whose own rim runs along the edge that they lie on: where a mere corner touches,
/// there is nothing to join.
fn keep_chains(mesh: &Mesh, classes: &Classes, found: &mut Vec<Junction>) {
    let mut on_side: BTreeMap<HalfedgeId, Vec<u32>> = BTreeMap::new();
    for junction in found.iter() {
        on_side.entry(junction.side).or_default().extend(classes.class[junction.vertex]);
    }
    for (&side, places) in &mut on_side {
        places.extend(classes.ends(mesh, side).into_iter().flatten());
        places.sort_unstable();
    }
    found.retain(|junction| {
        let places = &on_side[&junction.side];
        let Some(rim) = mesh.vertex_halfedge(junction.vertex) else { return false };
        // The rim at a vertex of it starts with the half-edge of the vertex.
        let (next, prev) = (mesh.to(rim), mesh.from(mesh.prev(rim)));
        [next, prev].into_iter().any(|w| {
            classes.class[w].is_some_and(|place| {
                Some(place) != classes.class[junction.vertex]
                    && places.binary_search(&place).is_ok()
            })
        })
    });
}

/// Puts vertices on the sides; how many.
fn split(mesh: &mut Mesh, track: &mut Track, junctions: &[Junction]) -> Result<usize, Error> {
    let positions: Vec<DVec3> = junctions.iter().map(|j| mesh.position(j.vertex)).collect();
    let mut editor = Editor::new(mesh);
    let mut pieces = Vec::new();
    let mut start = 0;
    for group in junctions.chunk_by(|s, t| s.side == t.side) {
        let end = editor.mesh().to(group[0].side);
        let mut side = group[0].side;
        for &position in &positions[start..start + group.len()] {
            let (face, count) = (editor.mesh().face(side), editor.mesh().face_count());
            let new = editor.split_edge_triangles(side.edge(), position).map_err(Error::Edit)?;
            pieces.extend((count..editor.mesh().face_count()).map(|f| (FaceId::new(f), face)));
            let rest = editor.mesh().halfedge_between(new, end);
            let Some(rest) = rest else { break };
            side = rest;
        }
        start += group.len();
    }
    // Nothing was removed, so that ids stay; each piece of a face comes from where that came from.
    track.compacted(&editor.finish(), &[]);
    for (piece, face) in pieces {
        track.faces[piece] = face.and_then(|f| track.faces[f]);
    }
    Ok(junctions.len())
}
