//! A half-edge mesh that is always a valid oriented 2-manifold with boundary, and what stands around it.
//!
//! | topic | items |
//! |---|---|
//! | ids and data | [`VertexId`] [`HalfedgeId`] [`EdgeId`] [`FaceId`] [`CornerId`], [`VertexMap`] …, [`VertexSet`] …, [`AttributeTable`] |
//! | first meshes | [`shapes`] |
//! | measures | [`measure`]: lengths, areas, angles, normals, volume, boxes |
//! | curvature | [`curvature`]: Gaussian, mean, principal with directions |
//! | topology | [`topology`]: components, holes, Euler characteristic, genus |
//! | representations | [`PolygonSoup`], [`IndexedFaceSet`] with its [`FaceList`], [`EdgeList`], [`Connectivity`], [`Mesh`] |
//! | what is wrong | [`defects`] and its [`DefectReport`] |
//! | what mends it | [`repair`](repair()), [`repair_faces`], [`RepairOptions`] |
//! | welding | [`weld_exact`], [`weld_within`], [`weld`], [`weld_as`] |
//! | triangles from polygons | [`triangulate()`] [`triangulate_faces`] [`triangulate_polygon`] |
//! | where things are | [`spatial`]: nearest points, rays, inside and outside, distances of surfaces |
//! | edits | [`Editor`], [`reorder`], [`Mesh::reverse`], [`Mesh::validate`] |
//! | search | [`graph`]: breadth-first, Dijkstra, A*, adjacency lists |
//! | long computations | [`Progress`], [`Cancelled`], [`parallel`] |
//!
//! ```
//! use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, VertexId};
//!
//! let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = FaceList::from_indices(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
//! let mesh = Mesh::new(&IndexedFaceSet::new(corners, faces)?)?;
//! let neighbors = mesh.vertex_neighbors(VertexId::new(0));
//! assert_eq!(neighbors.map(|w| mesh.position(w)).sum::<DVec3>(), DVec3::ONE);
//! # Ok::<(), dgp_mesh::Error>(())
//! ```

mod attribute;
mod build;
mod check;
mod connectivity;
pub mod curvature;
mod edge_list;
mod edit;
mod error;
mod face_list;
pub mod graph;
mod id;
mod indexed;
pub mod linear;
mod map;
pub mod measure;
mod mesh;
mod navigate;
pub mod parallel;
mod progress;
mod repair;
mod set;
pub mod shapes;
mod soup;
pub mod spatial;
pub mod topology;
mod triangulate;
mod validate;
mod weld;

pub use glam::{DMat3, DVec2, DVec3};

pub use attribute::{
    AttributeColumn, AttributeTable, AttributeValue, COLOR, Color, GROUP, Label, MATERIAL, NORMAL,
    Normal, OBJECT, SMOOTHING, UV,
};
pub use build::strict_mesh;
pub use check::{Defect, DefectKind, DefectReport, Elements, Groups, Severity, defects};
pub use connectivity::{Connectivity, HalfedgeArrays, NotManifold};
pub use edge_list::EdgeList;
pub use edit::{Compaction, EditError, Editor, FaceRemoval, Renumbering, reorder};
pub use error::Error;
pub use face_list::FaceList;
pub use id::{CornerId, EdgeId, FaceId, HalfedgeId, Id, MAX_ELEMENTS, VertexId};
pub use indexed::IndexedFaceSet;
pub use map::{CornerMap, EdgeMap, FaceMap, HalfedgeMap, IdMap, VertexMap};
pub use mesh::{Attributes, Mesh};
pub use progress::{Callback, Cancelled, Progress};
pub use repair::{
    Change, CrowdedEdges, Facing, FlatFaces, IsolatedVertices, KeepComponents, OneSided,
    OppositeFaces, RepairAction, RepairOptions, RepairReport, repair, repair_faces,
};
pub use set::{EdgeSet, FaceSet, HalfedgeSet, IdSet, VertexSet};
pub use soup::PolygonSoup;
pub use triangulate::{
    OPTIMAL_LIMIT, TriangulationMethod, triangulate, triangulate_faces, triangulate_polygon,
};
pub use validate::Invalid;
pub use weld::{Tolerance, WeldReport, Welding, weld, weld_as, weld_exact, weld_within};
