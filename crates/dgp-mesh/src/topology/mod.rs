//! What hangs together and how: components, holes, Euler characteristic, genus, neighborhoods.
//!
//! | question | function |
//! |---|---|
//! | everything about any face set, manifold or not | [`topology_report`], [`face_list_report`] |
//! | the parts of a mesh | [`components`], [`face_list_components`] |
//! | the rims of its holes | [`boundary_loops`], [`path_length`] |
//! | χ and genus of a mesh | [`euler_characteristic`], [`genus`] |
//! | whether counts somebody claims can be true | [`plausibility`], [`closed_triangle_counts`] |
//! | the five regular polyhedra, why there are no others | [`RegularPolyhedron`] |
//! | why a football has 12 pentagons | [`trivalent_balance`], [`fullerene_counts`] |
//! | the edges of faces that are no manifold | [`edge_uses`] |

mod boundary;
mod components;
mod edges;
mod euler;
mod plausibility;
mod polyhedra;
mod report;
pub(crate) mod union_find;

pub use boundary::{boundary_loops, path_length};
pub use components::{Components, components, face_list_components};
pub use edges::{EdgeUse, edge_uses};
pub use euler::{euler_characteristic, genus};
pub use plausibility::{
    Broken, ClaimedCounts, FaceKind, Plausibility, closed_triangle_counts, plausibility,
};
pub use polyhedra::{RegularPolyhedron, TrivalentBalance, fullerene_counts, trivalent_balance};
pub use report::{ComponentReport, TopologyReport, face_list_report, topology_report};
