//! Sharpness: for how many levels an edge or a vertex is refined as if it were a crease or a corner.
//!
//! ```text
//! 0          smooth
//! 0 < s < 1  the next level is a mix of sharp and smooth
//! s ≥ 1      the next level is sharp; its children have sharpness s − 1
//! 10         sharp at every level
//! ```
//!
//! - Input: numbers from 0 to 10.
//! - Cost: O(sharp elements) per level.
//! - Reference: DeRose, Kass and Truong, "Subdivision surfaces in character animation", SIGGRAPH 1998.
//! - Departs from it: 10 stands for ever, as files of OpenSubdiv have it.

use dgp_mesh::{AttributeColumn, EdgeId, EdgeMap, Mesh, VertexId, VertexMap};

use crate::{Error, topology::Topology};

/// The name of the attributes, of type `f64` on edges and on vertices, that
/// [`Sharpness::from_attributes`] reads.
pub const SHARPNESS: &str = "sharpness";

/// The sharpness that never wears off.
pub const SHARP: f64 = 10.0;

/// How sharp edges and vertices are: 0 where nothing is said.
///
/// ```
/// use dgp_mesh::{AttributeColumn, EdgeId, VertexId};
/// use dgp_subdiv::{SHARP, Sharpness};
///
/// let mut sharpness = Sharpness::new();
/// sharpness.set_edge(EdgeId::new(3), 1.5);
/// sharpness.set_vertex(VertexId::new(0), SHARP);
/// assert_eq!(sharpness.edge(EdgeId::new(2)), 0.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sharpness {
    edges: EdgeMap<f64>,
    vertices: VertexMap<f64>,
}

impl Sharpness {
    /// Everything is smooth.
    pub const fn new() -> Self {
        Sharpness { edges: EdgeMap::new(), vertices: VertexMap::new() }
    }

    /// What the attributes [`SHARPNESS`] of edges and vertices of `mesh` say; 0 where there are none.
    pub fn from_attributes(mesh: &Mesh) -> Self {
        let edges = mesh.attributes().edge.get::<f64>(SHARPNESS);
        let vertices = mesh.attributes().vertex.get::<f64>(SHARPNESS);
        Sharpness {
            edges: edges.map(AttributeColumn::to_map).unwrap_or_default(),
            vertices: vertices.map(AttributeColumn::to_map).unwrap_or_default(),
        }
    }

    /// Writes the attributes [`SHARPNESS`] of `mesh`.
    pub fn to_attributes(&self, mesh: &mut Mesh) {
        let edges = mesh.map_edges(|e| self.edge(e));
        let vertices = mesh.map_vertices(|v| self.vertex(v));
        mesh.attributes_mut().edge.insert(SHARPNESS, edges);
        mesh.attributes_mut().vertex.insert(SHARPNESS, vertices);
    }

    /// How sharp `e` is.
    pub fn edge(&self, e: EdgeId) -> f64 {
        self.edges.get(e).copied().unwrap_or(0.0)
    }

    /// How sharp `v` is.
    pub fn vertex(&self, v: VertexId) -> f64 {
        self.vertices.get(v).copied().unwrap_or(0.0)
    }

    /// Makes `e` as sharp as `sharpness`, which must be 0 to 10 when a plan is made of it.
    pub fn set_edge(&mut self, e: EdgeId, sharpness: f64) {
        if self.edges.len() <= e.index() {
            self.edges.resize(e.index() + 1);
        }
        self.edges[e] = sharpness;
    }

    /// Makes `v` as sharp as `sharpness`, which must be 0 to 10 when a plan is made of it.
    pub fn set_vertex(&mut self, v: VertexId, sharpness: f64) {
        if self.vertices.len() <= v.index() {
            self.vertices.resize(v.index() + 1);
        }
        self.vertices[v] = sharpness;
    }

    /// Whether nothing is sharp.
    pub fn is_smooth(&self) -> bool {
        self.edges.values().iter().chain(self.vertices.values()).all(|&s| s == 0.0)
    }

    /// Beyond how many edges and vertices nothing is said.
    pub(crate) fn lengths(&self) -> [usize; 2] {
        [self.edges.len(), self.vertices.len()]
    }

    /// An error if a value is out of range.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let is_wrong = |s: f64| !(0.0..=SHARP).contains(&s);
        if let Some((edge, &sharpness)) = self.edges.iter().find(|(_, s)| is_wrong(**s)) {
            return Err(Error::EdgeSharpness { edge, sharpness });
        }
        if let Some((vertex, &sharpness)) = self.vertices.iter().find(|(_, s)| is_wrong(**s)) {
            return Err(Error::VertexSharpness { vertex, sharpness });
        }
        Ok(())
    }
}

/// What is left of a sharpness after a level.
#[inline]
pub(crate) fn decrement(sharpness: f64) -> f64 {
    if sharpness >= SHARP { SHARP } else { (sharpness - 1.0).max(0.0) }
}

/// The sharpness of a level; elements beyond the end are smooth. Empty where all are, which saves looking.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Creases {
    edges: Vec<f64>,
    vertices: Vec<f64>,
}

impl Creases {
    /// Those of the cage. Rims of holes are sharp without being listed.
    pub(crate) fn new(sharpness: &Sharpness) -> Self {
        Creases {
            edges: sharpness.edges.values().to_vec(),
            vertices: sharpness.vertices.values().to_vec(),
        }
        .trimmed()
    }

    /// The sharpness of each edge and of each vertex.
    pub(crate) fn listed(edges: Vec<f64>, vertices: Vec<f64>) -> Self {
        Creases { edges, vertices }.trimmed()
    }

    /// Makes vertices with a single face corners for ever.
    pub(crate) fn sharpen_corners(&mut self, topology: &Topology) {
        for v in 0..topology.vertex_count() {
            let first = topology.vertex_halfedge[v];
            if !topology.is_boundary_vertex(v) {
                continue;
            }
            let corner = topology.corner(first);
            let second = topology.corner_halfedge[topology.prev(corner) as usize] ^ 1;
            if topology.corner(second) == crate::topology::NONE {
                if self.vertices.len() <= v {
                    self.vertices.resize(v + 1, 0.0);
                }
                self.vertices[v] = SHARP;
            }
        }
    }

    /// Those of the next level after a split that numbers the halves of edge e 2e and 2e + 1, keeps the
    /// numbers of vertices, and gives all others larger numbers.
    pub(crate) fn refined(&self) -> Self {
        Creases {
            edges: self.edges.iter().flat_map(|&s| [decrement(s); 2]).collect(),
            vertices: self.vertices.iter().map(|&s| decrement(s)).collect(),
        }
        .trimmed()
    }

    /// Whether nothing but rims is sharp.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.edges.is_empty() && self.vertices.is_empty()
    }

    #[inline]
    pub(crate) fn edge(&self, topology: &Topology, edge: usize) -> f64 {
        if topology.is_boundary_edge(edge) { SHARP } else { self.listed_edge(edge) }
    }

    /// The sharpness of an edge, rims not counted.
    #[inline]
    pub(crate) fn listed_edge(&self, edge: usize) -> f64 {
        self.edges.get(edge).copied().unwrap_or(0.0)
    }

    #[inline]
    pub(crate) fn vertex(&self, vertex: usize) -> f64 {
        self.vertices.get(vertex).copied().unwrap_or(0.0)
    }

    /// Without the smooth elements at the end.
    fn trimmed(mut self) -> Self {
        for values in [&mut self.edges, &mut self.vertices] {
            let len = values.iter().rposition(|&s| s > 0.0).map_or(0, |last| last + 1);
            values.truncate(len);
        }
        self
    }
}
