//! The geometry report: size and quality of any face set.

use super::{
    BoundingBox, Range, area, bounding_box, face_normals, face_set_edge_length_range,
    minimum_angle, volume,
};
use crate::{DVec3, IndexedFaceSet, topology::TopologyReport};

/// What [`geometry_report`] finds; `None` for what has no meaning.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct GeometryReport {
    /// Vertices with a coordinate that is infinite or not a number. They count for nothing below.
    pub non_finite_vertices: usize,
    /// Faces without area, degenerate ones included.
    pub zero_area_faces: usize,
    /// The sum of the areas of the faces, which are taken to be flat; `None` without faces.
    pub area: Option<f64>,
    /// The volume inside, negative if faces point inward; `None` unless watertight.
    pub volume: Option<f64>,
    /// The smallest box around all vertices.
    pub bounding_box: Option<BoundingBox>,
    /// Shortest, mean and longest edge.
    pub edge_length: Option<Range>,
    /// The smallest corner of a face, in radians.
    pub minimum_angle: Option<f64>,
}

/// Size and quality of `set`, whose [`topology_report`](crate::topology::topology_report()) says
/// whether it has a volume.
///
/// Area and volume are `None` where a vertex is not finite.
pub fn geometry_report(set: &IndexedFaceSet, topology: &TopologyReport) -> GeometryReport {
    let non_finite_vertices = set.positions().values().iter().filter(|p| !p.is_finite()).count();
    let is_sound = non_finite_vertices == 0 && set.face_count() > 0;
    let normals = face_normals(set);
    GeometryReport {
        non_finite_vertices,
        zero_area_faces: normals.values().iter().filter(|&&n| n == DVec3::ZERO).count(),
        area: is_sound.then(|| area(set)),
        volume: (is_sound && topology.watertight).then(|| volume(set)),
        bounding_box: bounding_box(set),
        edge_length: face_set_edge_length_range(set),
        minimum_angle: minimum_angle(set),
    }
}
