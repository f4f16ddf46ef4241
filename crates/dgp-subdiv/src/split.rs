//! How faces split: the connectivity of the next level by arithmetic on that of this one.
//!
//! Both splits number the new vertices: old vertices, then a point per edge, then (four-way split of
//! polygons) a point per face; and the new edges: number h for the half of half-edge h next to the vertex
//! it leaves, then 2E + c for the edge that cuts off corner c or starts at the middle of its side.
//!
//! ```text
//!        of polygons, a quadrilateral per corner      of triangles, 4f + k at corner k, 4f + 3 inside
//!
//!              ●───────○───────●                                    ●
//!              │       │       │                                   ╱ ╲
//!              │   c₃  │  c₂   │                                  ╱c₂ ╲
//!              ○───────◎───────○                                 ○─────○
//!              │   c₀  │  c₁   │                                ╱ ╲   ╱ ╲
//!              │       │       │                               ╱c₀ ╲ ╱c₁ ╲
//!              ●──────▸○───────●                              ●────▸○─────●
//!            child edge h(c₀): leaves the vertex of c₀, ends at the middle of h(c₀)
//! ```
//!
//! - Cost: O(corners), one pass over each array, in parallel; no array is written twice.

use dgp_mesh::{Connectivity, FaceId, FaceList, HalfedgeArrays, HalfedgeId, VertexId, parallel};

use crate::topology::{Corners, Every, NONE, Starts, Topology};

/// How faces split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    /// Triangles: 4f + k at corner k of triangle f, 4f + 3 between them.
    Triangles,
    /// Polygons: a quadrilateral per corner c, with number c. Its corners: the old vertex, the middle of the
    /// side that starts there, the face point, the middle of the side before.
    Polygons,
}

/// The children of polygons.
pub(crate) fn split_polygons(parent: &Topology) -> Topology {
    Split::Polygons.children(parent)
}

/// The children of triangles.
pub(crate) fn split_triangles(parent: &Topology) -> Topology {
    Split::Triangles.children(parent)
}

/// Calls a method of [`Parent`] with the degree of its faces known.
macro_rules! by_degree {
    ($split:expr, $parent:expr, $method:ident) => {
        match (&$parent.starts, $split) {
            (_, Split::Triangles) => Parent::new($parent, $split, &Every::<3>).$method(),
            (Starts::Every(4), _) => Parent::new($parent, $split, &Every::<4>).$method(),
            _ => Parent::new($parent, $split, $parent).$method(),
        }
    };
}

impl Split {
    /// The connectivity of the next level.
    pub(crate) fn children(self, parent: &Topology) -> Topology {
        by_degree!(self, parent, children)
    }

    /// The faces of the next level.
    pub(crate) fn faces(self, parent: &Topology) -> FaceList {
        by_degree!(self, parent, faces)
    }

    /// The next level as a mesh, with the numbers that [`children`](Self::children) gives.
    pub(crate) fn connectivity(self, parent: &Topology) -> Connectivity {
        by_degree!(self, parent, connectivity)
    }
}

/// What is split.
struct Parent<'a, C> {
    topology: &'a Topology,
    split: Split,
    corners: &'a C,
    vertices: u32,
    edges: u32,
}

/// What a vertex comes from.
enum Origin {
    /// A vertex, with its first half-edge.
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

impl<'a, C: Corners> Parent<'a, C> {
    fn new(topology: &'a Topology, split: Split, corners: &'a C) -> Self {
        let (vertices, edges) = (topology.vertex_count() as u32, topology.edge_count() as u32);
        Parent { topology, split, corners, vertices, edges }
    }

    fn children(&self) -> Topology {
        let first = |v: u32| match self.origin(v) {
            Origin::Vertex(NONE) => NONE,
            Origin::Vertex(first) => 2 * first,
            // Beside a hole the first one has it on its right: it runs against the half-edge of the hole.
            Origin::Edge(e) => 2 * (2 * e + u32::from(self.topology.corner(2 * e + 1) == NONE)) + 1,
            Origin::Face(f) => self.inner(self.topology.corners(f).start) + 1,
        };
        let halfedge_corner = self.pairs(
            |h| {
                let last =
                    |c: u32| self.first_corner(self.corners.following(c)) + self.split.sides() - 1;
                [
                    self.beside(h).map_or(NONE, |c| self.first_corner(c)),
                    self.beside(h ^ 1).map_or(NONE, last),
                ]
            },
            |c| match self.split {
                // The triangle in the middle starts its side k at the middle of side k and ends it at
                // that of side k + 1, so the edge that cuts off corner c is its side c − 1.
                Split::Triangles => {
                    [self.first_corner(c) + 1, 12 * (c / 3) + 9 + self.corners.preceding(c) % 3]
                }
                Split::Polygons => [4 * c + 1, 4 * self.corners.following(c) + 2],
            },
        );
        let sides = match self.split {
            Split::Triangles => map(self.topology.face_count(), |f| self.triangle_sides(f))
                .into_flattened()
                .into_flattened(),
            Split::Polygons => {
                map(self.topology.corner_count(), |c| self.quad_sides(c)).into_flattened()
            }
        };
        Topology {
            starts: Starts::Every(self.split.sides()),
            corner_vertex: self.corner_vertices(|v| v),
            corner_halfedge: sides,
            halfedge_corner,
            vertex_halfedge: map(self.vertex_count(), first),
        }
    }

    fn faces(&self) -> FaceList {
        let vertices = self.corner_vertices(|v| VertexId::new(v as usize));
        FaceList::from_corners(vertices, self.split.sides() as usize)
    }

    fn connectivity(&self) -> Connectivity {
        let prev = self.pairs(
            |h| {
                let leaving = match self.beside(h) {
                    // After the half-edge of the hole that arrives where this one leaves.
                    None => 2 * self.topology.vertex_halfedge[self.from(h) as usize] + 1,
                    Some(c) => self.last_side(c),
                };
                let arriving = match (self.beside(h ^ 1), self.split) {
                    (None, _) => 2 * (h ^ 1),
                    (Some(c), Split::Triangles) => self.inner(self.corners.following(c)),
                    (Some(c), Split::Polygons) => self.inner(c) + 1,
                };
                [halfedge(leaving), halfedge(arriving)]
            },
            |c| {
                let second = match self.split {
                    Split::Triangles => self.inner(self.corners.preceding(c)) + 1,
                    Split::Polygons => self.inner(self.corners.following(c)),
                };
                [halfedge(2 * self.topology.corner_halfedge[c as usize]), halfedge(second)]
            },
        );
        let to = self.pairs(
            |h| [vertex(self.vertices + h / 2), vertex(self.from(h))],
            |c| {
                let first = match self.split {
                    Split::Triangles => self.middle(self.corners.preceding(c)),
                    Split::Polygons => self.vertices + self.edges + self.corners.face(c),
                };
                [vertex(first), vertex(self.middle(c))]
            },
        );
        let child = |c: u32| FaceId::new(self.child(c) as usize);
        let face = self.pairs(
            |h| {
                let after = |c: u32| child(self.corners.following(c));
                [self.beside(h).map(child), self.beside(h ^ 1).map(after)]
            },
            |c| {
                let other = match self.split {
                    Split::Triangles => FaceId::new(4 * (c as usize / 3) + 3),
                    Split::Polygons => child(self.corners.following(c)),
                };
                [Some(child(c)), Some(other)]
            },
        );
        let start = |v: u32| match self.origin(v) {
            Origin::Vertex(NONE) => None,
            Origin::Vertex(first) => Some(halfedge(2 * self.topology.start(first))),
            // At a hole, the half that runs along it.
            Origin::Edge(e) => {
                let has_face = self.beside(2 * e).is_some();
                Some(halfedge(2 * (2 * e + u32::from(!has_face)) + 1))
            }
            Origin::Face(f) => Some(halfedge(self.inner(self.topology.corners(f).start) + 1)),
        };
        let face_halfedge = match self.split {
            Split::Triangles => map(self.topology.face_count(), |f| {
                let [[a, ..], [b, ..], [c, ..], [d, ..]] = self.triangle_sides(f);
                [halfedge(a), halfedge(b), halfedge(c), halfedge(d)]
            })
            .into_flattened(),
            Split::Polygons => {
                let first = |c: u32| halfedge(2 * self.topology.corner_halfedge[c as usize]);
                map(self.topology.corner_count(), first)
            }
        };
        Connectivity::from_arrays(HalfedgeArrays {
            prev: prev.into(),
            to: to.into(),
            face: face.into(),
            vertex_halfedge: map(self.vertex_count(), start).into(),
            face_halfedge: face_halfedge.into(),
        })
    }

    fn vertex_count(&self) -> usize {
        let points = (self.vertices + self.edges) as usize;
        points + if self.split == Split::Polygons { self.topology.face_count() } else { 0 }
    }

    /// What a vertex of the next level comes from.
    #[inline]
    fn origin(&self, v: u32) -> Origin {
        if v < self.vertices {
            Origin::Vertex(self.topology.vertex_halfedge[v as usize])
        } else if v < self.vertices + self.edges {
            Origin::Edge(v - self.vertices)
        } else {
            Origin::Face(v - self.vertices - self.edges)
        }
    }

    /// The corner a half-edge starts at, `None` at a hole.
    #[inline]
    fn beside(&self, h: u32) -> Option<u32> {
        Some(self.topology.corner(h)).filter(|&corner| corner != NONE)
    }

    /// The vertex a half-edge leaves.
    #[inline]
    fn from(&self, h: u32) -> u32 {
        let corner = self.beside(h);
        let corner = corner.unwrap_or_else(|| self.corners.following(self.topology.corner(h ^ 1)));
        self.topology.vertex(corner)
    }

    /// The middle of the side that starts at a corner.
    #[inline]
    fn middle(&self, corner: u32) -> u32 {
        self.vertices + self.topology.edge(corner)
    }

    /// The child at a corner.
    #[inline]
    fn child(&self, corner: u32) -> u32 {
        match self.split {
            Split::Triangles => 4 * (corner / 3) + corner % 3,
            Split::Polygons => corner,
        }
    }

    /// The first corner of the child at a corner.
    #[inline]
    fn first_corner(&self, corner: u32) -> u32 {
        self.split.sides() * self.child(corner)
    }

    /// The vertices at the corners of the next level.
    fn corner_vertices<T: Send>(&self, id: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
        let topology = self.topology;
        match self.split {
            Split::Triangles => map(topology.face_count(), |f| {
                let first = 3 * f as usize;
                let old = &topology.corner_vertex[first..first + 3];
                let sides = &topology.corner_halfedge[first..first + 3];
                let (a, b, c) = (old[0], old[1], old[2]);
                let middle = |k: usize| self.vertices + (sides[k] >> 1);
                let (i, j, k) = (middle(0), middle(1), middle(2));
                let ids = [id(a), id(i), id(k), id(b), id(j), id(i)];
                [ids, [id(c), id(k), id(j), id(i), id(j), id(k)]]
            })
            .into_flattened()
            .into_flattened(),
            Split::Polygons => map(topology.corner_count(), |c| {
                let center = self.vertices + self.edges + self.corners.face(c);
                let before = self.middle(self.corners.preceding(c));
                [id(topology.vertex(c)), id(self.middle(c)), id(center), id(before)]
            })
            .into_flattened(),
        }
    }

    /// The first half-edge of the inner edge of a corner.
    #[inline]
    fn inner(&self, corner: u32) -> u32 {
        2 * (2 * self.edges + corner)
    }

    /// The last side of the child at a corner: the half of the side before that arrives at it.
    #[inline]
    fn last_side(&self, corner: u32) -> u32 {
        let before = self.corners.preceding(corner);
        2 * (self.topology.corner_halfedge[before as usize] ^ 1) + 1
    }

    /// The half-edges of the four children of a triangle.
    #[inline]
    fn triangle_sides(&self, f: u32) -> [[u32; 3]; 4] {
        let first = 3 * f as usize;
        let sides = &self.topology.corner_halfedge[first..first + 3];
        let (a, b, c) = (sides[0], sides[1], sides[2]);
        let (i, j, k) = (self.inner(3 * f), self.inner(3 * f + 1), self.inner(3 * f + 2));
        let arriving = |h: u32| 2 * (h ^ 1) + 1;
        [
            [2 * a, i, arriving(c)],
            [2 * b, j, arriving(a)],
            [2 * c, k, arriving(b)],
            [j + 1, k + 1, i + 1],
        ]
    }

    /// The half-edges of the child of a polygon at a corner.
    #[inline]
    fn quad_sides(&self, c: u32) -> [u32; 4] {
        [
            2 * self.topology.corner_halfedge[c as usize],
            self.inner(c),
            self.inner(self.corners.preceding(c)) + 1,
            self.last_side(c),
        ]
    }

    /// Values at the half-edges of the next level: `outer` gives those of the half of half-edge h next to the
    /// vertex it leaves, there and back; `inner` those of the edge of a corner.
    fn pairs<T: Send>(
        &self,
        outer: impl Fn(u32) -> [T; 2] + Sync + Send,
        inner: impl Fn(u32) -> [T; 2] + Sync + Send,
    ) -> Vec<T> {
        let halves = 2 * self.edges;
        let pair = |i: u32| if i < halves { outer(i) } else { inner(i - halves) };
        map(halves as usize + self.topology.corner_count(), pair).into_flattened()
    }
}

impl Split {
    /// The corners of a child.
    #[inline]
    fn sides(self) -> u32 {
        match self {
            Split::Triangles => 3,
            Split::Polygons => 4,
        }
    }
}

#[inline]
fn halfedge(h: u32) -> HalfedgeId {
    HalfedgeId::new(h as usize)
}

#[inline]
fn vertex(v: u32) -> VertexId {
    VertexId::new(v as usize)
}

fn map<T: Send>(count: usize, f: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
    parallel::map(count, |i: VertexId| f(i.index() as u32)).into_values()
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{Connectivity, Mesh, VertexId, shapes};

    use super::*;

    /// All that arrays say of one another, and what half-edges joined from the faces say.
    fn check(topology: &Topology) {
        let mesh = Connectivity::from_faces(topology.vertex_count(), &topology.faces()).unwrap();
        assert_eq!(topology.edge_count(), mesh.edge_count());
        for c in 0..topology.corner_count() as u32 {
            let h = topology.corner_halfedge[c as usize];
            assert_eq!(topology.corner(h), c);
            assert_eq!(topology.to(h), topology.vertex(topology.next(c)));
            assert_eq!(topology.prev(topology.next(c)), c);
        }
        let mut spokes = Vec::new();
        for v in mesh.vertices() {
            let closed = topology.spokes(v.index(), &mut spokes);
            assert_eq!(closed, !mesh.is_boundary_vertex(v), "{v}");
            let around: Vec<usize> = mesh.vertex_neighbors(v).map(VertexId::index).collect();
            let mine: Vec<usize> = spokes.iter().map(|&h| topology.to(h) as usize).collect();
            assert!(spokes.iter().all(|&h| topology.from(h) as usize == v.index()));
            assert_eq!(topology.start(topology.vertex_halfedge[v.index()]) == spokes[0], closed);
            if closed {
                let first = around.iter().position(|&w| w == mine[0]).unwrap();
                assert_eq!(mine, [&around[first..], &around[..first]].concat(), "{v}");
            } else {
                assert_eq!(mine, around, "{v}");
            }
        }
    }

    /// The children as a mesh, by whichever way.
    fn check_mesh(parent: &Topology, split: Split) {
        let children = split.children(parent);
        let mesh = split.connectivity(parent);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh, children.connectivity());
        assert_eq!(split.faces(parent), children.faces());
        let vertices = children.vertex_count();
        let halfedges = &children.corner_halfedge;
        let paired =
            Connectivity::from_paired_corners(vertices, &children.faces(), halfedges).unwrap();
        for h in mesh.halfedges() {
            assert_eq!(
                (mesh.prev(h), mesh.to(h), mesh.face(h)),
                (paired.prev(h), paired.to(h), paired.face(h))
            );
        }
        for v in mesh.vertices() {
            assert_eq!(mesh.is_boundary_vertex(v), paired.is_boundary_vertex(v));
        }
        assert_eq!(Topology::new(&mesh).faces(), children.faces());
    }

    #[test]
    fn children_fit_together() {
        let triangles: [Mesh; 4] = [
            shapes::octahedron(),
            shapes::grid(3, 2).unwrap(),
            shapes::annulus(0.5, 1.0, 7, 2).unwrap(),
            shapes::grid(1, 1).unwrap(),
        ];
        for mesh in &triangles {
            let cage = Topology::new(mesh);
            check(&cage);
            let once = split_triangles(&cage);
            check(&once);
            check(&split_triangles(&once));
            check(&split_polygons(&split_triangles(&cage)));
            check_mesh(&cage, Split::Triangles);
            check_mesh(&once, Split::Triangles);
            check_mesh(&once, Split::Polygons);
        }
        let polygons: [Mesh; 4] = [
            shapes::truncated_icosahedron(),
            shapes::quad_grid(2, 3).unwrap(),
            shapes::dodecahedron(),
            shapes::capped_cylinder(1.0, 2.0, 5, 2).unwrap(),
        ];
        for mesh in &polygons {
            let cage = Topology::new(mesh);
            check(&cage);
            let once = split_polygons(&cage);
            check(&once);
            check(&split_polygons(&once));
            check_mesh(&cage, Split::Polygons);
            check_mesh(&once, Split::Polygons);
        }
    }
    #[test]
    fn children_of_other_schemes_fit_together() {
        for mesh in [
            shapes::octahedron(),
            shapes::grid(3, 2).unwrap(),
            shapes::annulus(0.5, 1.0, 7, 2).unwrap(),
            shapes::grid(1, 1).unwrap(),
        ] {
            // The second step and the fourth cut rims.
            let mut level = Topology::new(&mesh);
            for step in 0..4 {
                let joined = crate::sqrt3::connectivity(&level, step);
                let faces = crate::sqrt3::faces(&level, step);
                let counts = crate::sqrt3::counts(&level, step);
                level = crate::sqrt3::refined(&level, step);
                check(&level);
                assert_eq!(joined.validate(), Ok(()));
                assert_eq!(joined, level.connectivity());
                assert_eq!((faces, counts), (level.faces(), level.counts()));
            }
        }
        for mesh in [
            shapes::octahedron(),
            shapes::truncated_icosahedron(),
            shapes::quad_grid(2, 3).unwrap(),
            shapes::capped_cylinder(1.0, 2.0, 5, 2).unwrap(),
        ] {
            let mut level = Topology::new(&mesh);
            for _ in 0..3 {
                let joined = crate::doo_sabin::connectivity(&level);
                let (children, parents) = crate::doo_sabin::refined(&level);
                check(&children);
                assert_eq!(joined.validate(), Ok(()));
                assert_eq!(joined, children.connectivity());
                assert_eq!(crate::doo_sabin::counts(&level), children.counts());
                assert_eq!(parents.len(), children.face_count());
                level = children;
            }
        }
    }
}
