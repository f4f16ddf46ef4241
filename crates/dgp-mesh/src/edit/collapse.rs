//! Edge collapse: shrinks an edge to a point; triangles at the edge become edges.
//!
//! ```text
//!        c                      c
//!      ╱ │ ╲                    │
//!    ╱   │   ╲   collapse       │
//!   z    a → b    ─────→    z ─ b        a and two edges of each triangle go,
//!    ╲   │   ╱                  │        the edges at b stay
//!      ╲ │ ╱                    │
//!        d                      d
//! ```
//!
//! The result is a manifold of the same topology if and only if the neighborhoods of the ends share
//! nothing but the triangles at the edge:
//!
//! ```text
//! Lk(a) ∩ Lk(b) = Lk(ab)       holes count as coned to one extra vertex
//! ```
//!
//! - Input: polygons of any degree; a polygon loses a corner.
//! - Cost: O(valence of a × valence of b), for high valences O(n log n).
//! - Reference: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999.
//! - Departs from it: polygons may not visit a vertex twice, which the condition for triangles
//!   implies and which is checked for larger faces.

use glam::DVec3;

use super::{EditError, Editor, need_finite, weights::fraction_along};
use crate::{Connectivity, FaceId, HalfedgeId, VertexId};

impl Editor<'_> {
    /// Moves the start of `h` into its end, which stays where it is and is returned.
    ///
    /// Of two edges that become one, that of the end survives. Corner data stay continuous where
    /// they were: the corners of `from(h)` that agree with a face at the edge get the value that
    /// `to(h)` has in that face; corners beyond a texture seam keep their own.
    ///
    /// Refused as by [`can_collapse`](Editor::can_collapse).
    pub fn collapse(&mut self, h: HalfedgeId) -> Result<VertexId, EditError> {
        self.can_collapse(h)?;
        self.mix_corners(h, 1.0);
        Ok(self.contract(h))
    }

    /// Moves both ends of `h` to `position`; the end of `h` survives and is returned.
    ///
    /// Data are mixed as at the point of the edge nearest to `position`.
    /// Refused as by [`can_collapse`](Editor::can_collapse), and if `position` is not finite.
    pub fn collapse_at(&mut self, h: HalfedgeId, position: DVec3) -> Result<VertexId, EditError> {
        need_finite(position)?;
        self.can_collapse(h)?;
        let (a, b) = (self.mesh.from(h), self.mesh.to(h));
        let x = fraction_along(position, self.mesh.position(a), self.mesh.position(b));
        self.mix_corners(h, x);
        self.mesh.attributes.vertex.mix(b, &[(1.0 - x, a), (x, b)]);
        self.mesh.positions[b] = position;
        Ok(self.contract(h))
    }

    /// Whether [`collapse`](Editor::collapse) would collapse `h`, and if not, why.
    pub fn can_collapse(&self, h: HalfedgeId) -> Result<(), EditError> {
        self.need_halfedge(h)?;
        let mesh = &self.mesh.connectivity;
        let (t, edge) = (h.twin(), h.edge());
        let (a, b) = (mesh.from(h), mesh.to(h));
        let is_inner = mesh.face(h).is_some() && mesh.face(t).is_some();
        if is_inner && mesh.is_boundary_vertex(a) && mesh.is_boundary_vertex(b) {
            return Err(EditError::BoundaryEnds { edge });
        }
        let (c, d) = (apex(mesh, h), apex(mesh, t));
        triangles_may_go(mesh, h, c, d)?;

        let neighbors = Neighbors::of(mesh, b);
        let mut g = mesh.ccw(h);
        while g != h {
            let vertex = mesh.to(g);
            if Some(vertex) != c && Some(vertex) != d && neighbors.contain(vertex) {
                return Err(EditError::LinkCondition { edge, vertex });
            }
            // A polygon around a that b is on as well, though not next to a.
            let is_at_edge = g == mesh.next(t);
            if mesh.face(g).is_some()
                && !is_at_edge
                && !mesh.is_triangle_loop(g)
                && mesh.loop_halfedges(g).any(|s| mesh.to(s) == b)
            {
                return Err(EditError::RepeatedVertex { vertex: b });
            }
            g = mesh.ccw(g);
        }
        Ok(())
    }

    /// Gives the corners that meet where `h` was their values: those at fraction `x` of the edge, on
    /// each of its sides.
    fn mix_corners(&mut self, h: HalfedgeId, x: f64) {
        if self.mesh.attributes.corner.is_empty() {
            return;
        }
        let mesh = &self.mesh.connectivity;
        let corner = &mut self.mesh.attributes.corner;
        let t = h.twin();
        let (at_b, at_a) = (mesh.next(h), mesh.next(t));
        // Around a: counterclockwise from the left face, clockwise from the right one up to what
        // the left one got. Around b: the other way.
        let mut left = Vec::new();
        let mut right = Vec::new();
        let (mut left_end_a, mut left_end_b) = (h, at_b);
        let goes_on = |g, start| mesh.face(g).is_some() && corner.equal(g, start);
        if mesh.face(h).is_some() {
            left.extend(run(h, |g| mesh.ccw(g), |g| g != at_a && goes_on(g, h)));
            left_end_a = left[left.len() - 1];
            left.extend(run(at_b, |g| mesh.cw(g), |g| g != t && goes_on(g, at_b)));
            left_end_b = left[left.len() - 1];
        }
        if mesh.face(t).is_some() {
            right.extend(run(at_a, |g| mesh.cw(g), |g| g != left_end_a && goes_on(g, at_a)));
            right.extend(run(t, |g| mesh.ccw(g), |g| g != left_end_b && goes_on(g, t)));
        }
        for (wedge, a, b) in [(left, h, at_b), (right, at_a, t)] {
            if wedge.is_empty() {
                continue;
            }
            corner.mix(b, &[(1.0 - x, a), (x, b)]);
            for &g in wedge.iter().filter(|&&g| g != b) {
                corner.copy(b, g);
            }
        }
    }

    /// Relinks what hangs on the start of `h`, and removes what is left over.
    fn contract(&mut self, h: HalfedgeId) -> VertexId {
        let mesh = &mut self.mesh.connectivity;
        let t = h.twin();
        let (a, b) = (mesh.from(h), mesh.to(h));
        let (after_h, before_h) = (mesh.next(h), mesh.prev(h));
        let (after_t, before_t) = (mesh.next(t), mesh.prev(t));
        let start = mesh.start_after_contraction(h);
        let mut g = mesh.ccw(h);
        while g != h {
            mesh.to[g.twin()] = b;
            g = mesh.ccw(g);
        }
        mesh.vertex_halfedge[b] = start;
        for (gone, next) in [(h, after_h), (t, after_t)] {
            if let Some(f) = mesh.face(gone)
                && mesh.face_halfedge[f] == gone
            {
                mesh.face_halfedge[f] = next;
            }
        }
        mesh.link(before_h, after_h);
        mesh.link(before_t, after_t);
        self.drop_edge(h);
        self.drop_vertex(a);
        // What was a triangle is now a loop of two sides; the edge of b stays.
        if self.mesh.next(after_h) == before_h {
            self.zip(after_h, before_h);
        }
        if self.mesh.next(after_t) == before_t {
            self.zip(before_t, after_t);
        }
        b
    }

    /// Closes the face whose two sides are `kept` and `gone`.
    fn zip(&mut self, kept: HalfedgeId, gone: HalfedgeId) {
        let mesh = &mut self.mesh.connectivity;
        let outer = gone.twin();
        let (x, y) = (mesh.from(kept), mesh.to(kept));
        let face = mesh.face(kept);
        let (before, after) = (mesh.prev(outer), mesh.next(outer));
        mesh.link(before, kept);
        mesh.link(kept, after);
        mesh.face[kept] = mesh.face[outer];
        if let Some(f) = mesh.face(outer)
            && mesh.face_halfedge[f] == outer
        {
            mesh.face_halfedge[f] = kept;
        }
        for (v, lost, gained) in [(x, outer, kept), (y, gone, kept.twin())] {
            if mesh.vertex_halfedge[v] == Some(lost) {
                mesh.vertex_halfedge[v] = Some(gained);
            }
        }
        self.mesh.attributes.corner.copy(outer, kept);
        self.drop_edge(gone);
        if let Some(f) = face {
            self.drop_face(f, gone);
        }
    }
}

impl Connectivity {
    /// With which half-edge the ring of `to(h)` starts after the contraction of `h`: one that leaves
    /// either end of `h` now.
    fn start_after_contraction(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        let t = h.twin();
        let (of_a, of_b) = (self.vertex_halfedge[self.from(h)], self.vertex_halfedge[self.to(h)]);
        let a_is_boundary = of_a.is_some_and(|g| self.face(g).is_none());
        match of_b {
            // The rim passes through a, and goes on as it does there.
            _ if a_is_boundary && of_a != Some(h) => of_a,
            Some(g) if g != t => Some(g),
            // The ring of b started with the edge itself.
            _ if of_a != Some(h) => of_a,
            _ => Some(self.next(h)),
        }
    }
}

/// The vertex opposite to `h`, if its face is a triangle.
pub(super) fn apex(mesh: &Connectivity, h: HalfedgeId) -> Option<VertexId> {
    (mesh.face(h).is_some() && mesh.is_triangle_loop(h)).then(|| mesh.to(mesh.next(h)))
}

/// Whether the triangles at `h`, with opposite vertices `c` and `d`, can become edges.
fn triangles_may_go(
    mesh: &Connectivity,
    h: HalfedgeId,
    c: Option<VertexId>,
    d: Option<VertexId>,
) -> Result<(), EditError> {
    for (side, apex) in [(h, c), (h.twin(), d)] {
        let (next, prev) = (mesh.next(side), mesh.prev(side));
        if apex.is_some() && mesh.face(next.twin()).is_none() && mesh.face(prev.twin()).is_none() {
            let kept = if side == h { next } else { prev };
            return Err(EditError::LastFace { edge: kept.edge() });
        }
    }
    let (Some(c), Some(d)) = (c, d) else { return Ok(()) };
    let same = |faces: [Option<FaceId>; 2]| match faces {
        [Some(f), Some(g)] => Err(EditError::SameCorners { faces: [f, g] }),
        _ => Ok(()),
    };
    if c == d {
        return same([mesh.face(h), mesh.face(h.twin())]);
    }
    // A tetrahedron would become two triangles back to back.
    let beyond = [mesh.prev(h).twin(), mesh.next(h).twin()];
    if beyond.iter().all(|&g| apex(mesh, g) == Some(d)) {
        return same(beyond.map(|g| mesh.face(g)));
    }
    Ok(())
}

/// `start` and the half-edges that follow it by `step` as long as they `belong`.
fn run(
    start: HalfedgeId,
    step: impl Fn(HalfedgeId) -> HalfedgeId,
    belongs: impl Fn(HalfedgeId) -> bool,
) -> impl Iterator<Item = HalfedgeId> {
    std::iter::successors(Some(start), move |&g| {
        Some(step(g)).filter(|&g| g != start && belongs(g))
    })
}

/// The neighbors of a vertex, to look others up in.
enum Neighbors {
    Few([Option<VertexId>; Neighbors::FEW]),
    /// Sorted.
    Many(Vec<VertexId>),
}

impl Neighbors {
    /// Up to so many a plain search is the fastest; nearly all vertices have fewer.
    const FEW: usize = 16;

    fn of(mesh: &Connectivity, v: VertexId) -> Self {
        let mut few = [None; Neighbors::FEW];
        for (k, w) in mesh.vertex_neighbors(v).enumerate() {
            if k == Neighbors::FEW {
                let mut many: Vec<_> = mesh.vertex_neighbors(v).collect();
                many.sort_unstable();
                return Neighbors::Many(many);
            }
            few[k] = Some(w);
        }
        Neighbors::Few(few)
    }

    #[inline]
    fn contain(&self, v: VertexId) -> bool {
        match self {
            Neighbors::Few(few) => few.contains(&Some(v)),
            Neighbors::Many(many) => many.binary_search(&v).is_ok(),
        }
    }
}
