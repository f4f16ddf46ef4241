//! Lengths, areas, angles, normals, volumes and boxes.
//!
//! | of | of one element | of all |
//! |---|---|---|
//! | edges | [`Mesh::edge_length`](crate::Mesh::edge_length), `halfedge_vector`, `edge_midpoint` | [`edge_lengths`], [`edge_length_range`] |
//! | faces | [`Mesh::face_area`](crate::Mesh::face_area), `face_normal`, `face_vector_area`, `face_center` | [`face_areas`], [`face_normals`], [`face_vector_areas`] |
//! | corners | [`Mesh::corner_angle`](crate::Mesh::corner_angle), `cotangent` | [`corner_angles`], [`minimum_angle`] |
//! | edges between faces | [`Mesh::dihedral_angle`](crate::Mesh::dihedral_angle) | [`cotangent_weights`] |
//! | vertices | [`vertex_normal`] | [`vertex_normals`], [`vertex_areas`] |
//! | the surface | | [`area`], [`surface_centroid`], [`vertex_centroid`], [`bounding_box`], [`oriented_box`] |
//! | the solid | | [`volume`], [`mass_properties`] |
//! | any face set | | [`geometry_report`] |
//! | points of a triangle | [`barycentric_2d`], [`barycentric_3d`], [`triangle_location`], [`interpolate`] | |
//!
//! What makes sense on faces that form no manifold takes any [`Surface`]. All results are finite for
//! finite coordinates, degenerate elements included (each function says what they give), unless the
//! number exceeds what an f64 holds. Scaling a mesh by 2^k scales them exactly, and they keep their
//! digits far from the origin.

mod angle;
mod barycentric;
mod bounding_box;
mod cotangent;
mod edge;
mod face;
pub(crate) mod frame;
mod mass;
mod oriented_box;
mod report;
pub(crate) mod scale;
mod surface;
mod vertex_area;
mod vertex_normal;
mod volume;

pub use angle::{corner_angles, minimum_angle};
pub use barycentric::{
    TriangleLocation, barycentric_2d, barycentric_3d, interpolate, triangle_location,
};
pub use bounding_box::{BoundingBox, bounding_box};
pub(crate) use cotangent::cross_of_shorter;
pub use cotangent::{cotangent_weights, require_triangles};
pub use edge::{Range, edge_length_range, edge_lengths, face_set_edge_length_range};
pub use face::{area, face_areas, face_normals, face_vector_areas};
pub use mass::{MassProperties, mass_properties, surface_centroid, vertex_centroid};
pub use oriented_box::{OrientedBox, oriented_box};
pub use report::{GeometryReport, geometry_report};
pub use surface::Surface;
pub(crate) use vertex_area::voronoi_share;
pub use vertex_area::{VertexArea, corner_areas, vertex_areas};
pub use vertex_normal::{NormalWeight, vertex_normal, vertex_normals};
pub use volume::volume;

#[cfg(test)]
mod tests;
