//! Walking on the mesh.
//!
//! ```text
//!            to(h)
//!             ●                 h.twin()    the other direction          (no mesh needed)
//!            /│\                h.edge()    the undirected edge          (no mesh needed)
//!  next(h)  / │ \               next(h)     the following side of face(h)
//!          /  │  \              prev(h)     the preceding side of face(h)
//!         ● h↑│↓  ●             face(h)     the face to the left, None outside
//!          \  │  / h.twin()     ccw(h)      prev(h).twin(), the next spoke of from(h)
//!  prev(h)  \ │ /               cw(h)       next(h.twin()), the previous spoke
//!            \│/
//!             ●
//!           from(h)
//! ```
//!
//! Names follow one rule: `{center}_{what}`, as in `vertex_faces` or `face_vertices`.
//! Everything that goes around something goes counterclockwise, seen from outside. Where a vertex is
//! on the boundary, the walk around it starts after the gap and ends before it.

use std::iter;

use crate::{Connectivity, EdgeId, FaceId, HalfedgeId, VertexId};

/// One step from a half-edge.
impl Connectivity {
    /// The following side of the same face, or of the same hole.
    ///
    /// Not stored: two steps back in a triangle, three in a quadrilateral, else around the face or
    /// around the vertex, whichever is shorter. Cost: O(min(degree, valence)).
    #[inline]
    pub fn next(&self, h: HalfedgeId) -> HalfedgeId {
        let two_back = self.prev(self.prev(h));
        let three_back = self.prev(two_back);
        if three_back == h {
            two_back
        } else if self.prev(three_back) == h {
            three_back
        } else {
            self.search_next(h)
        }
    }

    fn search_next(&self, h: HalfedgeId) -> HalfedgeId {
        // Sides before `h`, and what leaves the vertex where `h` ends.
        let (mut side, mut spoke) = (h, h.twin());
        loop {
            let preceding = self.prev(side);
            if preceding == h {
                return side;
            }
            side = preceding;
            let arriving = self.prev(spoke);
            if arriving == h {
                return spoke;
            }
            spoke = arriving.twin();
        }
    }

    /// The preceding side of the same face, or of the same hole.
    #[inline]
    pub fn prev(&self, h: HalfedgeId) -> HalfedgeId {
        self.prev[h]
    }

    /// The vertex `h` leaves.
    #[inline]
    pub fn from(&self, h: HalfedgeId) -> VertexId {
        self.to[h.twin()]
    }

    /// The vertex `h` arrives at.
    #[inline]
    pub fn to(&self, h: HalfedgeId) -> VertexId {
        self.to[h]
    }

    /// The face to the left of `h`, `None` where there is a hole.
    #[inline]
    pub fn face(&self, h: HalfedgeId) -> Option<FaceId> {
        self.face[h]
    }

    /// The next half-edge that leaves the same vertex, counterclockwise.
    #[inline]
    pub fn ccw(&self, h: HalfedgeId) -> HalfedgeId {
        self.prev(h).twin()
    }

    /// The next half-edge that leaves the same vertex, clockwise.
    #[inline]
    pub fn cw(&self, h: HalfedgeId) -> HalfedgeId {
        self.next(h.twin())
    }
}

/// Around a vertex.
impl Connectivity {
    /// A half-edge that leaves `v`: the one without a face at the boundary, none if `v` is isolated.
    #[inline]
    pub fn vertex_halfedge(&self, v: VertexId) -> Option<HalfedgeId> {
        self.vertex_halfedge[v]
    }

    /// The half-edges that leave `v`, in order; at the boundary the last one has no face.
    #[inline]
    pub fn vertex_halfedges(&self, v: VertexId) -> impl Iterator<Item = HalfedgeId> + '_ {
        // After the gap comes the first face, so one step on from the half-edge without a face.
        orbit(self.vertex_halfedge[v].map(|h| self.ccw(h)), |h| self.ccw(h))
    }

    /// The vertices one edge away from `v`, in order.
    #[inline]
    pub fn vertex_neighbors(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.vertex_halfedges(v).map(|h| self.to(h))
    }

    /// The edges at `v`, in order.
    #[inline]
    pub fn vertex_edges(&self, v: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        self.vertex_halfedges(v).map(HalfedgeId::edge)
    }

    /// The faces with a corner at `v`, in order.
    #[inline]
    pub fn vertex_faces(&self, v: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        self.vertex_halfedges(v).filter_map(|h| self.face(h))
    }

    /// The number of edges at `v`.
    #[inline]
    pub fn valence(&self, v: VertexId) -> usize {
        orbit(self.vertex_halfedge[v], |h| self.ccw(h)).count()
    }

    /// The half-edge from `v` to `w`, if an edge joins them.
    pub fn halfedge_between(&self, v: VertexId, w: VertexId) -> Option<HalfedgeId> {
        self.vertex_halfedges(v).find(|&h| self.to(h) == w)
    }
}

/// Around a face.
impl Connectivity {
    /// The first side of `f`.
    #[inline]
    pub fn face_halfedge(&self, f: FaceId) -> HalfedgeId {
        self.face_halfedge[f]
    }

    /// The sides of `f`, in order.
    #[inline]
    pub fn face_halfedges(&self, f: FaceId) -> impl Iterator<Item = HalfedgeId> + '_ {
        self.loop_halfedges(self.face_halfedge[f])
    }

    /// The corners of `f`, in order, from the one its first side leaves.
    #[inline]
    pub fn face_vertices(&self, f: FaceId) -> impl Iterator<Item = VertexId> + '_ {
        self.face_halfedges(f).map(|h| self.from(h))
    }

    /// The edges of `f`, in order.
    #[inline]
    pub fn face_edges(&self, f: FaceId) -> impl Iterator<Item = EdgeId> + '_ {
        self.face_halfedges(f).map(HalfedgeId::edge)
    }

    /// The faces on the other side of each edge of `f`, in order.
    #[inline]
    pub fn face_neighbors(&self, f: FaceId) -> impl Iterator<Item = FaceId> + '_ {
        self.face_halfedges(f).filter_map(|h| self.face(h.twin()))
    }

    /// The number of corners of `f`.
    #[inline]
    pub fn degree(&self, f: FaceId) -> usize {
        self.face_halfedges(f).count()
    }

    /// The corners of `f` if it is a triangle.
    #[inline]
    pub fn triangle(&self, f: FaceId) -> Option<[VertexId; 3]> {
        let h = self.face_halfedge[f];
        let k = self.prev(h);
        let g = self.prev(k);
        (self.prev(g) == h).then(|| [self.to(k), self.to(h), self.to(g)])
    }

    /// The half-edges of the face or hole that `h` runs along, from `h` on.
    #[inline]
    pub fn loop_halfedges(&self, h: HalfedgeId) -> impl Iterator<Item = HalfedgeId> + '_ {
        orbit(Some(h), |h| self.next(h))
    }
}

/// At an edge.
impl Connectivity {
    /// The ends of `e`: from and to of its first half-edge.
    #[inline]
    pub fn edge_vertices(&self, e: EdgeId) -> [VertexId; 2] {
        [self.from(e.halfedge()), self.to(e.halfedge())]
    }

    /// The faces left and right of the first half-edge of `e`.
    #[inline]
    pub fn edge_faces(&self, e: EdgeId) -> [Option<FaceId>; 2] {
        e.halfedges().map(|h| self.face(h))
    }
}

/// At the boundary.
impl Connectivity {
    /// Whether `h` runs along a hole: it has no face.
    #[inline]
    pub fn is_boundary_halfedge(&self, h: HalfedgeId) -> bool {
        self.face(h).is_none()
    }

    /// Whether `v` lies on the rim of a hole, or on no face at all.
    #[inline]
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.vertex_halfedge[v].is_none_or(|h| self.face(h).is_none())
    }

    /// Whether `v` lies on no face.
    #[inline]
    pub fn is_isolated_vertex(&self, v: VertexId) -> bool {
        self.vertex_halfedge[v].is_none()
    }

    /// Whether `e` lacks a face on one side.
    #[inline]
    pub fn is_boundary_edge(&self, e: EdgeId) -> bool {
        e.halfedges().iter().any(|&h| self.face(h).is_none())
    }

    /// Whether a side of `f` lies at a hole.
    pub fn is_boundary_face(&self, f: FaceId) -> bool {
        self.face_halfedges(f).any(|h| self.face(h.twin()).is_none())
    }
}

/// `start`, `step(start)`, `step(step(start))`, … until the orbit closes.
#[inline]
fn orbit(
    start: Option<HalfedgeId>,
    step: impl Fn(HalfedgeId) -> HalfedgeId,
) -> impl Iterator<Item = HalfedgeId> {
    iter::successors(start, move |&h| Some(step(h)).filter(|&h| Some(h) != start))
}
