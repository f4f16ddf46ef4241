//! Checks the algebra of a mesh: one error for each invariant.
//!
//! Builds and edits keep these invariants, so that a mesh can only fail here by a bug of this crate.
//! Tests call this after every edit.

use crate::{Connectivity, EdgeId, FaceId, HalfedgeId, HalfedgeMap, Mesh, VertexId, VertexMap};

/// An invariant of [`Connectivity`] or [`Mesh`] that does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Invalid {
    /// Arrays of one kind of element have the same length, half-edges an even one.
    #[error("there are {count} {what}, but should be {expected}")]
    Length {
        /// What the array holds.
        what: &'static str,
        /// Its length.
        count: usize,
        /// What that should be.
        expected: usize,
    },
    /// A half-edge names only elements that exist.
    #[error("{halfedge} names an element that does not exist")]
    HalfedgeNamesMissing {
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The half-edge of a vertex exists.
    #[error("{vertex} names a half-edge that does not exist")]
    VertexNamesMissing {
        /// The vertex.
        vertex: VertexId,
    },
    /// The half-edge of a face exists.
    #[error("{face} names a half-edge that does not exist")]
    FaceNamesMissing {
        /// The face.
        face: FaceId,
    },
    /// Each half-edge precedes one other.
    #[error("{halfedge} precedes {count} half-edges instead of one")]
    Precedes {
        /// The half-edge.
        halfedge: HalfedgeId,
        /// How many it precedes.
        count: usize,
    },
    /// A half-edge and its next are of the same face, or both of none.
    #[error("{halfedge} and its next are not of the same face")]
    FaceChanges {
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The next of a half-edge leaves where it arrives.
    #[error("{halfedge} does not arrive where its next leaves")]
    Apart {
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The ends of an edge differ.
    #[error("{edge} joins {vertex} to itself")]
    Loop {
        /// The edge.
        edge: EdgeId,
        /// Both its ends.
        vertex: VertexId,
    },
    /// Each edge has a face.
    #[error("{edge} has no face on either side")]
    NoFace {
        /// The edge.
        edge: EdgeId,
    },
    /// The half-edge of a vertex leaves it.
    #[error("the half-edge of {vertex} does not leave it")]
    StartElsewhere {
        /// The vertex.
        vertex: VertexId,
    },
    /// The half-edge of a boundary vertex is the one with no face.
    #[error("{vertex} is at the boundary, but its half-edge has a face")]
    StartHasFace {
        /// The vertex.
        vertex: VertexId,
    },
    /// The half-edges that leave a vertex form one orbit.
    #[error("{halfedge} leaves {vertex}, but is not in the orbit of its half-edge")]
    SeveralFans {
        /// The vertex.
        vertex: VertexId,
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// The half-edge of a face is a side of it.
    #[error("the half-edge of {face} is no side of it")]
    SideElsewhere {
        /// The face.
        face: FaceId,
    },
    /// The sides of a face form one loop.
    #[error("{halfedge} is a side of {face}, but not in the loop of its half-edge")]
    SeveralLoops {
        /// The face.
        face: FaceId,
        /// The half-edge.
        halfedge: HalfedgeId,
    },
    /// Each face has at least three corners.
    #[error("{face} has only {degree} corners")]
    TooFewCorners {
        /// The face.
        face: FaceId,
        /// How many corners it has.
        degree: usize,
    },
    /// No face visits a vertex twice.
    #[error("{face} visits {vertex} twice")]
    RepeatedVertex {
        /// The face.
        face: FaceId,
        /// The vertex.
        vertex: VertexId,
    },
    /// No two edges join the same two vertices.
    #[error("{} and {} join the same vertices", edges[0], edges[1])]
    DoubleEdge {
        /// The edges.
        edges: [EdgeId; 2],
    },
    /// Coordinates are numbers.
    #[error("{vertex} has a coordinate that is infinite or not a number")]
    NonFinite {
        /// The vertex.
        vertex: VertexId,
    },
}

impl Mesh {
    /// Checks every invariant of the mesh, in linear time: those of its [`Connectivity`], finite
    /// positions, and that every table has a row for each element.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.connectivity().validate()?;
        let attributes = self.attributes();
        let lengths = [
            ("positions", self.positions().len(), self.vertex_count()),
            ("rows of vertex data", attributes.vertex.len(), self.vertex_count()),
            ("rows of corner data", attributes.corner.len(), self.halfedge_count()),
            ("rows of edge data", attributes.edge.len(), self.edge_count()),
            ("rows of face data", attributes.face.len(), self.face_count()),
        ];
        lengths_agree(&lengths)?;
        match self.positions().iter().find(|(_, p)| !p.is_finite()) {
            Some((vertex, _)) => Err(Invalid::NonFinite { vertex }),
            None => Ok(()),
        }
    }
}

impl Connectivity {
    /// Checks every invariant of half-edges, in linear time.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.names_exist()?;
        self.halfedges_agree()?;
        self.vertices_are_fans()?;
        self.faces_are_loops()?;
        self.edges_are_unique()
    }

    fn names_exist(&self) -> Result<(), Invalid> {
        let halfedges = self.halfedge_count();
        lengths_agree(&[
            ("half-edges", halfedges, 2 * (halfedges / 2)),
            ("ends", self.to.len(), halfedges),
            ("faces of half-edges", self.face.len(), halfedges),
        ])?;
        let (vertices, faces) = (self.vertex_count(), self.face_count());
        let missing = self.halfedges().find(|&h| {
            self.prev[h].index() >= halfedges
                || self.to[h].index() >= vertices
                || self.face[h].is_some_and(|f| f.index() >= faces)
        });
        if let Some(halfedge) = missing {
            return Err(Invalid::HalfedgeNamesMissing { halfedge });
        }
        let is_missing = |h: HalfedgeId| h.index() >= halfedges;
        let missing = self.vertices().find(|&v| self.vertex_halfedge[v].is_some_and(is_missing));
        if let Some(vertex) = missing {
            return Err(Invalid::VertexNamesMissing { vertex });
        }
        match self.faces().find(|&f| is_missing(self.face_halfedge[f])) {
            Some(face) => Err(Invalid::FaceNamesMissing { face }),
            None => Ok(()),
        }
    }

    fn halfedges_agree(&self) -> Result<(), Invalid> {
        let mut precedes = HalfedgeMap::filled(self.halfedge_count(), 0);
        for halfedge in self.halfedges() {
            precedes[self.prev(halfedge)] += 1;
        }
        if let Some((halfedge, &count)) = precedes.iter().find(|&(_, &count)| count != 1) {
            return Err(Invalid::Precedes { halfedge, count });
        }
        for halfedge in self.halfedges() {
            let next = self.next(halfedge);
            if self.face(next) != self.face(halfedge) {
                return Err(Invalid::FaceChanges { halfedge });
            }
            if self.from(next) != self.to(halfedge) {
                return Err(Invalid::Apart { halfedge });
            }
        }
        for edge in self.edges() {
            let [vertex, other] = self.edge_vertices(edge);
            if vertex == other {
                return Err(Invalid::Loop { edge, vertex });
            }
            if self.edge_faces(edge) == [None, None] {
                return Err(Invalid::NoFace { edge });
            }
        }
        Ok(())
    }

    fn vertices_are_fans(&self) -> Result<(), Invalid> {
        // prev is a permutation by now, so orbits end.
        let mut met = vec![false; self.halfedge_count()];
        for vertex in self.vertices() {
            let Some(start) = self.vertex_halfedge(vertex) else { continue };
            if self.from(start) != vertex {
                return Err(Invalid::StartElsewhere { vertex });
            }
            for h in self.vertex_halfedges(vertex) {
                met[h.index()] = true;
                if self.face(h).is_none() && h != start {
                    return Err(Invalid::StartHasFace { vertex });
                }
            }
        }
        match self.halfedges().find(|h| !met[h.index()]) {
            Some(halfedge) => Err(Invalid::SeveralFans { vertex: self.from(halfedge), halfedge }),
            None => Ok(()),
        }
    }

    fn faces_are_loops(&self) -> Result<(), Invalid> {
        let mut met = vec![false; self.halfedge_count()];
        let mut last_face = VertexMap::filled(self.vertex_count(), None);
        for face in self.faces() {
            if self.face(self.face_halfedge(face)) != Some(face) {
                return Err(Invalid::SideElsewhere { face });
            }
            let mut degree = 0;
            for h in self.face_halfedges(face) {
                met[h.index()] = true;
                degree += 1;
                let vertex = self.from(h);
                if last_face[vertex].replace(face) == Some(face) {
                    return Err(Invalid::RepeatedVertex { face, vertex });
                }
            }
            if degree < 3 {
                return Err(Invalid::TooFewCorners { face, degree });
            }
        }
        for halfedge in self.halfedges().filter(|h| !met[h.index()]) {
            if let Some(face) = self.face(halfedge) {
                return Err(Invalid::SeveralLoops { face, halfedge });
            }
        }
        Ok(())
    }

    fn edges_are_unique(&self) -> Result<(), Invalid> {
        let mut edge_from = VertexMap::filled(self.vertex_count(), None);
        for v in self.vertices() {
            for h in self.vertex_halfedges(v) {
                if let Some((last, edge)) = edge_from[self.to(h)].replace((v, h.edge()))
                    && last == v
                {
                    return Err(Invalid::DoubleEdge { edges: [edge, h.edge()] });
                }
            }
        }
        Ok(())
    }
}

fn lengths_agree(lengths: &[(&'static str, usize, usize)]) -> Result<(), Invalid> {
    match lengths.iter().find(|(_, count, expected)| count != expected) {
        Some(&(what, count, expected)) => Err(Invalid::Length { what, count, expected }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceList;

    /// Two triangles 0 1 2 and 2 1 3; e2 is their common edge 1–2.
    fn strip() -> Connectivity {
        let faces = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        Connectivity::from_faces(4, &faces).unwrap()
    }

    fn broken(change: impl Fn(&mut Connectivity)) -> Invalid {
        let mut mesh = strip();
        mesh.validate().unwrap();
        change(&mut mesh);
        mesh.validate().unwrap_err()
    }

    fn side(mesh: &Connectivity, a: usize, b: usize) -> HalfedgeId {
        mesh.halfedge_between(VertexId::new(a), VertexId::new(b)).unwrap()
    }

    #[test]
    fn names_must_exist() {
        let (h, v, f) = (HalfedgeId::new(0), VertexId::new(0), FaceId::new(0));
        let far = HalfedgeId::new(99);
        assert_eq!(broken(|m| m.prev[h] = far), Invalid::HalfedgeNamesMissing { halfedge: h });
        assert_eq!(
            broken(|m| m.to[h] = VertexId::new(4)),
            Invalid::HalfedgeNamesMissing { halfedge: h }
        );
        assert_eq!(
            broken(|m| m.vertex_halfedge[v] = Some(far)),
            Invalid::VertexNamesMissing { vertex: v }
        );
        assert_eq!(broken(|m| m.face_halfedge[f] = far), Invalid::FaceNamesMissing { face: f });
        assert!(matches!(broken(|m| m.to.truncate(3)), Invalid::Length { what: "ends", .. }));
    }

    #[test]
    fn each_half_edge_must_precede_one_of_its_face() {
        let h = side(&strip(), 0, 1);
        assert!(matches!(broken(|m| m.prev[h] = h), Invalid::Precedes { .. }));
        assert!(matches!(broken(|m| m.face[h] = None), Invalid::FaceChanges { .. }));
        assert!(matches!(broken(|m| m.to[h] = VertexId::new(3)), Invalid::Apart { .. }));
    }

    #[test]
    fn edges_must_have_two_ends_and_a_face() {
        let alone = |m: &mut Connectivity, ends: [usize; 2]| {
            for (k, v) in ends.into_iter().enumerate() {
                m.prev.push(HalfedgeId::new(10 + (k ^ 1)));
                m.to.push(VertexId::new(v));
                m.face.push(None);
            }
        };
        let edge = EdgeId::new(5);
        assert_eq!(broken(|m| alone(m, [0, 3])), Invalid::NoFace { edge });
        let vertex = VertexId::new(3);
        assert_eq!(broken(|m| alone(m, [3, 3])), Invalid::Loop { edge, vertex });
    }

    #[test]
    fn vertices_must_start_their_fan() {
        let (v, inner) = (VertexId::new(1), |m: &Connectivity| side(m, 1, 2));
        assert_eq!(
            broken(|m| m.vertex_halfedge[v] = Some(inner(m))),
            Invalid::StartHasFace { vertex: v }
        );
        assert_eq!(
            broken(|m| m.vertex_halfedge[v] = Some(inner(m).twin())),
            Invalid::StartElsewhere { vertex: v }
        );
        assert!(matches!(
            broken(|m| m.vertex_halfedge[v] = None),
            Invalid::SeveralFans { vertex, .. } if vertex == v
        ));
    }

    #[test]
    fn faces_must_be_loops_of_distinct_vertices() {
        let (f, g) = (FaceId::new(0), FaceId::new(1));
        assert_eq!(
            broken(|m| m.face_halfedge[f] = m.face_halfedge[g]),
            Invalid::SideElsewhere { face: f }
        );
        let merged = broken(|m| {
            for h in m.halfedges() {
                m.face[h] = m.face[h].map(|_| f);
            }
            m.face_halfedge.truncate(1);
        });
        assert!(matches!(merged, Invalid::SeveralLoops { face, .. } if face == f), "{merged}");
        // An edge with a loose end 3 into the triangle 0 1 2.
        let mut mesh = Connectivity::from_faces(4, &FaceList::from_indices(&[[0, 1, 2]])).unwrap();
        let (first, last) = (side(&mesh, 0, 1), side(&mesh, 2, 0));
        let [out, back] = [6, 7].map(HalfedgeId::new);
        for (prev, end) in [(last, 3), (out, 0)] {
            mesh.prev.push(prev);
            mesh.to.push(VertexId::new(end));
            mesh.face.push(Some(f));
        }
        mesh.prev[first] = back;
        mesh.vertex_halfedge[VertexId::new(3)] = Some(back);
        let vertex = VertexId::new(0);
        assert_eq!(mesh.validate(), Err(Invalid::RepeatedVertex { face: f, vertex }));
    }

    #[test]
    fn two_edges_must_not_join_the_same_vertices() {
        // An edge of a tetrahedron doubled, with a hole of two sides between the copies.
        let faces = FaceList::from_indices(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        let mut mesh = Connectivity::from_faces(4, &faces).unwrap();
        let t = side(&mesh, 1, 0);
        let [x, y] = [12, 13].map(HalfedgeId::new);
        let (before, after, face) = (mesh.prev(t), mesh.next(t), mesh.face(t));
        for (prev, end, face) in [(t, 1, None), (before, 0, face)] {
            mesh.prev.push(prev);
            mesh.to.push(VertexId::new(end));
            mesh.face.push(face);
        }
        mesh.prev[after] = y;
        (mesh.prev[t], mesh.face[t]) = (x, None);
        mesh.vertex_halfedge[VertexId::new(0)] = Some(x);
        mesh.vertex_halfedge[VertexId::new(1)] = Some(t);
        if let Some(f) = face {
            mesh.face_halfedge[f] = y;
        }
        let edges = [t.edge(), x.edge()];
        let mut reversed = edges;
        reversed.reverse();
        let error = mesh.validate().unwrap_err();
        assert!(
            [edges, reversed].map(|edges| Invalid::DoubleEdge { edges }).contains(&error),
            "{error}"
        );

        // The same with a face in the hole.
        let face = mesh.face_halfedge.push(x);
        (mesh.face[x], mesh.face[t]) = (Some(face), Some(face));
        assert_eq!(mesh.validate(), Err(Invalid::TooFewCorners { face, degree: 2 }));
    }
}
