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

use crate::topology::{NONE, Starts, Topology, face_list};

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

impl Split {
    /// The connectivity of the next level.
    pub(crate) fn children(self, parent: &Topology) -> Topology {
        let first = |v: VertexId| match self.origin(parent, v.index()) {
            Origin::Vertex(NONE) => NONE,
            Origin::Vertex(first) => 2 * first,
            // Beside a hole the first one has it on its right: it runs against the half-edge of the hole.
            Origin::Edge(e) => 2 * (2 * e + u32::from(parent.corner(2 * e + 1) == NONE)) + 1,
            Origin::Face(f) => inner(parent, parent.corners(f).start) + 1,
        };
        Topology {
            starts: self.starts(),
            corner_vertex: self.corner_vertex(parent),
            corner_halfedge: match self {
                Split::Triangles => {
                    let sides = map(parent.face_count(), |f| triangle_sides(parent, f));
                    sides.into_flattened().into_flattened()
                }
                Split::Polygons => {
                    map(parent.corner_count(), |c| quad_sides(parent, c)).into_flattened()
                }
            },
            halfedge_corner: pairs(
                parent,
                |h| {
                    let leaving = parent.corner(h);
                    let arriving = parent.corner(h ^ 1);
                    let last =
                        |corner: u32| self.first_corner(parent.next(corner)) + self.sides() - 1;
                    [
                        if leaving == NONE { NONE } else { self.first_corner(leaving) },
                        if arriving == NONE { NONE } else { last(arriving) },
                    ]
                },
                |c| match self {
                    // The triangle in the middle starts its side k at the middle of side k and ends it at
                    // that of side k + 1, so the edge that cuts off corner c is its side c − 1.
                    Split::Triangles => {
                        [self.first_corner(c) + 1, 12 * (c / 3) + 9 + parent.prev(c) % 3]
                    }
                    Split::Polygons => [4 * c + 1, 4 * parent.next(c) + 2],
                },
            ),
            vertex_halfedge: map(self.vertex_count(parent), |v| first(VertexId::new(v as usize))),
        }
    }

    /// The faces of the next level.
    pub(crate) fn faces(self, parent: &Topology) -> FaceList {
        face_list(&self.starts(), &self.corner_vertex(parent))
    }

    /// The next level as a mesh, with the numbers that [`children`](Self::children) gives.
    pub(crate) fn connectivity(self, parent: &Topology) -> Connectivity {
        let (vertices, edges) = (parent.vertex_count() as u32, parent.edge_count() as u32);
        let id = |h: u32| HalfedgeId::new(h as usize);
        let vertex = |v: u32| VertexId::new(v as usize);
        let middle = |c: u32| vertex(vertices + parent.edge(c));
        let prev = pairs(
            parent,
            |h| {
                let leaving = match parent.corner(h) {
                    // After the half-edge of the hole that arrives where this one leaves.
                    NONE => 2 * parent.vertex_halfedge[parent.from(h) as usize] + 1,
                    corner => last_side(parent, corner),
                };
                let arriving = match parent.corner(h ^ 1) {
                    NONE => 2 * (h ^ 1),
                    corner => match self {
                        Split::Triangles => inner(parent, parent.next(corner)),
                        Split::Polygons => inner(parent, corner) + 1,
                    },
                };
                [id(leaving), id(arriving)]
            },
            |c| {
                let second = match self {
                    Split::Triangles => inner(parent, parent.prev(c)) + 1,
                    Split::Polygons => inner(parent, parent.next(c)),
                };
                [id(2 * parent.corner_halfedge[c as usize]), id(second)]
            },
        );
        let to = pairs(
            parent,
            |h| [vertex(vertices + h / 2), vertex(parent.from(h))],
            |c| match self {
                Split::Triangles => [middle(parent.prev(c)), middle(c)],
                Split::Polygons => [vertex(vertices + edges + parent.face(c)), middle(c)],
            },
        );
        let child = |c: u32| FaceId::new(self.child(c) as usize);
        let face = pairs(
            parent,
            |h| {
                let at = |corner: u32| (corner != NONE).then_some(corner);
                let leaving = at(parent.corner(h)).map(child);
                [leaving, at(parent.corner(h ^ 1)).map(|corner| child(parent.next(corner)))]
            },
            |c| {
                let other = match self {
                    Split::Triangles => FaceId::new(4 * (c as usize / 3) + 3),
                    Split::Polygons => child(parent.next(c)),
                };
                [Some(child(c)), Some(other)]
            },
        );
        let vertex_halfedge =
            map(self.vertex_count(parent), |v| match self.origin(parent, v as usize) {
                Origin::Vertex(NONE) => None,
                Origin::Vertex(first) => Some(id(2 * parent.start(first))),
                // At a hole, the half that runs along it.
                Origin::Edge(e) => {
                    Some(id(2 * (2 * e + u32::from(parent.corner(2 * e) == NONE)) + 1))
                }
                Origin::Face(f) => Some(id(inner(parent, parent.corners(f).start) + 1)),
            });
        let face_halfedge = match self {
            Split::Triangles => map(parent.face_count(), |f| {
                let sides = triangle_sides(parent, f);
                sides.map(|[first, ..]| id(first))
            })
            .into_flattened(),
            Split::Polygons => {
                map(parent.corner_count(), |c| id(2 * parent.corner_halfedge[c as usize]))
            }
        };
        Connectivity::from_arrays(HalfedgeArrays {
            prev: prev.into(),
            to: to.into(),
            face: face.into(),
            vertex_halfedge: vertex_halfedge.into(),
            face_halfedge: face_halfedge.into(),
        })
    }

    fn starts(self) -> Starts {
        Starts::Every(self.sides())
    }

    /// The corners of a child.
    fn sides(self) -> u32 {
        match self {
            Split::Triangles => 3,
            Split::Polygons => 4,
        }
    }

    fn vertex_count(self, parent: &Topology) -> usize {
        let points = parent.vertex_count() + parent.edge_count();
        points + if self == Split::Polygons { parent.face_count() } else { 0 }
    }

    /// The child at a corner.
    #[inline]
    fn child(self, corner: u32) -> u32 {
        match self {
            Split::Triangles => 4 * (corner / 3) + corner % 3,
            Split::Polygons => corner,
        }
    }

    /// The first corner of the child at a corner.
    #[inline]
    fn first_corner(self, corner: u32) -> u32 {
        self.sides() * self.child(corner)
    }

    /// What a vertex of the next level comes from.
    #[inline]
    fn origin(self, parent: &Topology, v: usize) -> Origin {
        let (vertices, edges) = (parent.vertex_count(), parent.edge_count());
        if v < vertices {
            Origin::Vertex(parent.vertex_halfedge[v])
        } else if v < vertices + edges {
            Origin::Edge((v - vertices) as u32)
        } else {
            Origin::Face((v - vertices - edges) as u32)
        }
    }

    /// The vertices at the corners of the next level.
    fn corner_vertex(self, parent: &Topology) -> Vec<u32> {
        let (vertices, edges) = (parent.vertex_count() as u32, parent.edge_count() as u32);
        let middle = |c: u32| vertices + parent.edge(c);
        match self {
            Split::Triangles => map(parent.face_count(), |f| {
                let corners = [3 * f, 3 * f + 1, 3 * f + 2];
                let [a, b, c] = corners.map(|c| parent.vertex(c));
                let [i, j, k] = corners.map(middle);
                [a, i, k, b, j, i, c, k, j, i, j, k]
            })
            .into_flattened(),
            Split::Polygons => map(parent.corner_count(), |c| {
                let center = vertices + edges + parent.face(c);
                [parent.vertex(c), middle(c), center, middle(parent.prev(c))]
            })
            .into_flattened(),
        }
    }
}

/// What a vertex comes from.
enum Origin {
    /// A vertex, with its first half-edge.
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

/// The first half-edge of the inner edge of a corner.
#[inline]
fn inner(parent: &Topology, corner: u32) -> u32 {
    2 * (2 * parent.edge_count() as u32 + corner)
}

/// The last side of the child at a corner: the half of the side before that arrives at it.
#[inline]
fn last_side(parent: &Topology, corner: u32) -> u32 {
    2 * (parent.corner_halfedge[parent.prev(corner) as usize] ^ 1) + 1
}

/// The half-edges of the four children of a triangle.
#[inline]
fn triangle_sides(parent: &Topology, f: u32) -> [[u32; 3]; 4] {
    let corners = [3 * f, 3 * f + 1, 3 * f + 2];
    let [a, b, c] = corners.map(|c| parent.corner_halfedge[c as usize]);
    let [i, j, k] = corners.map(|c| inner(parent, c));
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
fn quad_sides(parent: &Topology, c: u32) -> [u32; 4] {
    [
        2 * parent.corner_halfedge[c as usize],
        inner(parent, c),
        inner(parent, parent.prev(c)) + 1,
        last_side(parent, c),
    ]
}

fn map<T: Send>(count: usize, f: impl Fn(u32) -> T + Sync + Send) -> Vec<T> {
    parallel::map(count, |i: VertexId| f(i.index() as u32)).into_values()
}

/// Values at the half-edges of the next level: `outer` gives those of the half of half-edge h next to the
/// vertex it leaves, there and back; `inner` those of the edge of a corner.
fn pairs<T: Send>(
    parent: &Topology,
    outer: impl Fn(u32) -> [T; 2] + Sync + Send,
    inner: impl Fn(u32) -> [T; 2] + Sync + Send,
) -> Vec<T> {
    let halves = 2 * parent.edge_count() as u32;
    let pair = |i: u32| if i < halves { outer(i) } else { inner(i - halves) };
    map(halves as usize + parent.corner_count(), pair).into_flattened()
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
}
