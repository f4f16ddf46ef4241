//! Edits: every one either keeps the mesh a valid oriented manifold or is refused and changes nothing.
//!
//! | edit | what it does | undone by |
//! |---|---|---|
//! | [`flip`](Editor::flip) | turns an edge within its two faces | flipping on |
//! | [`split_edge`](Editor::split_edge) | puts a vertex on an edge | `collapse` |
//! | [`split_edge_triangles`](Editor::split_edge_triangles) | the same; triangles stay triangles | `collapse` |
//! | [`collapse`](Editor::collapse), [`collapse_at`](Editor::collapse_at) | shrinks an edge to a point | |
//! | [`split_face`](Editor::split_face) | puts a vertex into a face | `merge_vertex_faces` |
//! | [`split_face_by`](Editor::split_face_by) | joins two corners of a face | `merge_faces` |
//! | [`merge_faces`](Editor::merge_faces) | removes an edge | `split_face_by` |
//! | [`merge_vertex_faces`](Editor::merge_vertex_faces) | removes a vertex, merging its faces | |
//! | [`add_vertex`](Editor::add_vertex), [`add_face`](Editor::add_face) | | `remove_…` |
//! | [`remove_face`](Editor::remove_face), [`remove_faces`](Editor::remove_faces), [`remove_vertex`](Editor::remove_vertex) | makes holes | `add_face` |
//!
//! Data travel: a new element gets the data of where it lies, mixed from its surroundings; corners
//! are mixed face by face, so that texture seams stay seams. What is new in the middle of a face (an
//! edge) has default values.

mod add;
mod collapse;
mod compact;
mod error;
mod flip;
mod merge;
mod remove;
mod reorder;
mod reverse;
mod split_edge;
mod split_face;
mod weights;

use glam::DVec3;

pub use compact::Compaction;
pub use error::EditError;
pub use remove::FaceRemoval;
pub use reorder::{Renumbering, reorder};

use crate::{
    Attributes, Connectivity, EdgeId, EdgeSet, FaceId, FaceSet, HalfedgeId, Invalid, MAX_ELEMENTS,
    Mesh, VertexId, VertexSet,
};

/// Edits a mesh. Ids stay what they are until [`finish`](Editor::finish); new elements get new ones.
///
/// Making an editor costs nothing, and dropping it only where elements were removed: the mesh is
/// then compacted, which `finish` does too and tells the new ids. A leaked editor leaves an empty
/// mesh behind.
///
/// ```
/// use dgp_mesh::{DVec3, Editor, FaceList, IndexedFaceSet, Mesh, VertexId};
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
/// let square = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
/// let mut mesh = Mesh::new(&IndexedFaceSet::new(corners, square)?)?;
/// let diagonal = mesh.halfedge_between(VertexId::new(1), VertexId::new(2)).unwrap().edge();
///
/// let mut editor = Editor::new(&mut mesh);
/// editor.flip(diagonal)?;
/// let center = editor.split_edge_triangles(diagonal, DVec3::new(0.5, 0.5, 0.0))?;
/// assert_eq!(editor.mesh().valence(center), 4);
/// editor.finish();
/// assert_eq!((mesh.vertex_count(), mesh.face_count()), (5, 4));
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Debug)]
pub struct Editor<'a> {
    /// Where the mesh goes back to; empty meanwhile.
    target: &'a mut Mesh,
    mesh: Mesh,
    removed: Removed,
}

/// Elements that are gone but still have a place in the arrays.
#[derive(Clone, Debug, Default)]
struct Removed {
    vertices: VertexSet,
    edges: EdgeSet,
    faces: FaceSet,
}

impl Removed {
    fn is_empty(&self) -> bool {
        self.vertices.is_empty() && self.edges.is_empty() && self.faces.is_empty()
    }
}

/// Begin and end.
impl<'a> Editor<'a> {
    /// An editor of `mesh`, which is empty until the editor is finished or dropped.
    pub fn new(mesh: &'a mut Mesh) -> Self {
        let edited = std::mem::take(mesh);
        Editor { target: mesh, mesh: edited, removed: Removed::default() }
    }

    /// Gives the mesh back without gaps, and tells where its elements went.
    pub fn finish(mut self) -> Compaction {
        self.compact()
    }

    /// Closes the gaps that removed elements left: all ids change as the result tells.
    pub fn compact(&mut self) -> Compaction {
        let removed = std::mem::take(&mut self.removed);
        let compaction = Compaction::without(&self.mesh, &removed);
        if !removed.is_empty() {
            compaction.apply(&mut self.mesh);
        }
        compaction
    }

    /// Checks every invariant of [`Mesh`], and that nothing names a removed element. For tests: it
    /// copies the mesh.
    pub fn validate(&self) -> Result<(), Invalid> {
        let mut mesh = self.mesh.clone();
        if !self.removed.is_empty() {
            self.need_no_removed_names()?;
            Compaction::without(&mesh, &self.removed).apply(&mut mesh);
        }
        mesh.validate()
    }
}

impl Drop for Editor<'_> {
    fn drop(&mut self) {
        if !self.removed.is_empty() {
            self.compact();
        }
        *self.target = std::mem::take(&mut self.mesh);
    }
}

/// What there is.
impl Editor<'_> {
    /// The mesh as it is now, for walking and measuring from elements that are there.
    ///
    /// Its arrays and counts include removed elements: ask the editor for those that are left. A
    /// removed vertex is isolated, a removed face has one side, so that walks from them end.
    #[inline]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The data that travel with the mesh, to be changed. Each table keeps its length.
    pub fn attributes_mut(&mut self) -> &mut Attributes {
        &mut self.mesh.attributes
    }

    /// Moves `v` to `position`.
    #[inline]
    pub fn set_position(&mut self, v: VertexId, position: DVec3) {
        self.mesh.positions[v] = position;
    }

    /// How many vertices are left.
    pub fn vertex_count(&self) -> usize {
        self.mesh.vertex_count() - self.removed.vertices.len()
    }

    /// How many edges are left.
    pub fn edge_count(&self) -> usize {
        self.mesh.edge_count() - self.removed.edges.len()
    }

    /// How many faces are left.
    pub fn face_count(&self) -> usize {
        self.mesh.face_count() - self.removed.faces.len()
    }

    /// The vertices that are left.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = VertexId> + '_ {
        self.mesh.vertices().filter(|&v| !self.removed.vertices.contains(v))
    }

    /// The edges that are left.
    pub fn edges(&self) -> impl DoubleEndedIterator<Item = EdgeId> + '_ {
        self.mesh.edges().filter(|&e| !self.removed.edges.contains(e))
    }

    /// The half-edges that are left.
    pub fn halfedges(&self) -> impl DoubleEndedIterator<Item = HalfedgeId> + '_ {
        self.mesh.halfedges().filter(|&h| !self.removed.edges.contains(h.edge()))
    }

    /// The faces that are left.
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = FaceId> + '_ {
        self.mesh.faces().filter(|&f| !self.removed.faces.contains(f))
    }

    /// Whether `v` is there: it exists and was not removed.
    #[inline]
    pub fn has_vertex(&self, v: VertexId) -> bool {
        v.index() < self.mesh.vertex_count() && !self.removed.vertices.contains(v)
    }

    /// Whether `e` is there: it exists and was not removed.
    #[inline]
    pub fn has_edge(&self, e: EdgeId) -> bool {
        e.index() < self.mesh.edge_count() && !self.removed.edges.contains(e)
    }

    /// Whether `h` is there: it exists and was not removed.
    #[inline]
    pub fn has_halfedge(&self, h: HalfedgeId) -> bool {
        self.has_edge(h.edge())
    }

    /// Whether `f` is there: it exists and was not removed.
    #[inline]
    pub fn has_face(&self, f: FaceId) -> bool {
        f.index() < self.mesh.face_count() && !self.removed.faces.contains(f)
    }
}

/// Conditions that several edits have.
impl Editor<'_> {
    #[inline]
    fn need_vertex(&self, vertex: VertexId) -> Result<(), EditError> {
        if self.has_vertex(vertex) { Ok(()) } else { Err(EditError::NoVertex { vertex }) }
    }

    #[inline]
    fn need_edge(&self, edge: EdgeId) -> Result<(), EditError> {
        if self.has_edge(edge) { Ok(()) } else { Err(EditError::NoEdge { edge }) }
    }

    #[inline]
    fn need_halfedge(&self, halfedge: HalfedgeId) -> Result<(), EditError> {
        if self.has_halfedge(halfedge) { Ok(()) } else { Err(EditError::NoHalfedge { halfedge }) }
    }

    #[inline]
    fn need_face(&self, face: FaceId) -> Result<(), EditError> {
        if self.has_face(face) { Ok(()) } else { Err(EditError::NoFace { face }) }
    }

    /// Whether ids suffice for so many new elements.
    #[inline]
    fn need_room(&self, vertices: usize, edges: usize, faces: usize) -> Result<(), EditError> {
        let counts = [
            ("vertices", self.mesh.vertex_count() + vertices),
            ("half-edges", self.mesh.halfedge_count() + 2 * edges),
            ("faces", self.mesh.face_count() + faces),
        ];
        match counts.iter().find(|(_, count)| *count > MAX_ELEMENTS) {
            Some(&(kind, _)) => Err(EditError::TooMany { kind }),
            None => Ok(()),
        }
    }
}

#[inline]
fn need_finite(position: DVec3) -> Result<(), EditError> {
    if position.is_finite() { Ok(()) } else { Err(EditError::NonFinite) }
}

/// Elements come and go.
impl Editor<'_> {
    /// A new vertex on no face, with default data.
    fn push_vertex(&mut self, position: DVec3) -> VertexId {
        self.mesh.connectivity.vertex_halfedge.push(None);
        let v = self.mesh.positions.push(position);
        self.mesh.attributes.vertex.resize(v.index() + 1);
        v
    }

    /// A new edge with default data, linked to nothing: its direction that arrives at `to` and whose
    /// twin arrives at `from`.
    fn push_edge(&mut self, from: VertexId, to: VertexId) -> HalfedgeId {
        let connectivity = &mut self.mesh.connectivity;
        let h = HalfedgeId::new(connectivity.halfedge_count());
        for (g, end) in [(h, to), (h.twin(), from)] {
            connectivity.prev.push(g);
            connectivity.to.push(end);
            connectivity.face.push(None);
        }
        self.mesh.attributes.edge.resize(h.edge().index() + 1);
        self.mesh.attributes.corner.resize(h.index() + 2);
        h
    }

    /// A new face with default data and the sides of the loop of `h`.
    fn push_face(&mut self, h: HalfedgeId) -> FaceId {
        let connectivity = &mut self.mesh.connectivity;
        let f = connectivity.face_halfedge.push(h);
        connectivity.set_loop_face(h, Some(f));
        self.mesh.attributes.face.resize(f.index() + 1);
        f
    }

    /// Forgets `v`, on which nothing depends any more.
    fn drop_vertex(&mut self, v: VertexId) {
        self.mesh.connectivity.vertex_halfedge[v] = None;
        self.removed.vertices.insert(v);
    }

    /// Forgets the edge of `h`, on which nothing depends any more.
    fn drop_edge(&mut self, h: HalfedgeId) {
        let connectivity = &mut self.mesh.connectivity;
        for g in [h, h.twin()] {
            connectivity.link(g, g);
            connectivity.face[g] = None;
        }
        self.removed.edges.insert(h.edge());
    }

    /// Forgets `f`, on which nothing depends any more; `h` is any removed half-edge.
    fn drop_face(&mut self, f: FaceId, h: HalfedgeId) {
        self.mesh.connectivity.face_halfedge[f] = h;
        self.removed.faces.insert(f);
    }
}

/// Pointers.
impl Connectivity {
    /// Lets `g` follow `h`.
    #[inline]
    fn link(&mut self, h: HalfedgeId, g: HalfedgeId) {
        self.prev[g] = h;
    }

    /// Gives the whole loop of `h` to `f`.
    fn set_loop_face(&mut self, h: HalfedgeId, f: Option<FaceId>) {
        let mut g = h;
        loop {
            self.face[g] = f;
            g = self.prev[g];
            if g == h {
                return;
            }
        }
    }

    /// Whether the loop of `h` has three sides.
    #[inline]
    fn is_triangle_loop(&self, h: HalfedgeId) -> bool {
        self.prev(self.prev(self.prev(h))) == h
    }
}
