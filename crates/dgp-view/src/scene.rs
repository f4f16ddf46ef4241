//! What is in a picture: panels side by side, in each of them models that share a space.

use dgp_mesh::{DMat3, DVec3, IndexedFaceSet, Mesh};

use crate::Style;

/// Everything in a picture: its panels, from left to right and top to bottom.
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet};
/// use dgp_view::{Model, Panel, Scene, Style};
///
/// let faces = FaceList::from_indices(&[[0, 1, 2]]);
/// let triangle = IndexedFaceSet::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], faces)?;
/// let scene = Scene {
///     panels: vec![
///         Panel::new("shaded", Model::new(&triangle)),
///         Panel::new("wireframe", Model { style: Style::wireframe(), ..Model::new(&triangle) }),
///     ],
/// };
/// # assert_eq!(scene.panels.len(), 2);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Scene<'a> {
    /// The panels.
    pub panels: Vec<Panel<'a>>,
}

/// Models that share a space, seen by one camera.
#[derive(Clone, Debug, Default)]
pub struct Panel<'a> {
    /// What is written below, in ASCII; nothing if empty.
    pub caption: String,
    /// The models.
    pub models: Vec<Model<'a>>,
}

/// A shape, how it looks and where it stands.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    /// What is drawn.
    pub shape: Shape<'a>,
    /// How it looks.
    pub style: Style,
    /// Where it stands.
    pub placement: Placement,
}

/// What can be drawn. Everything is accepted: what has no place in a picture (coordinates that are no
/// numbers, faces of fewer than three vertices) is skipped and counted in the report.
#[derive(Clone, Copy, Debug)]
pub enum Shape<'a> {
    /// A manifold mesh.
    Mesh(&'a Mesh),
    /// Any faces; points, if there are none.
    Faces(&'a IndexedFaceSet),
    /// Points alone.
    Points(&'a [DVec3]),
}

/// Where a model stands: p ↦ linear p + translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rotation, scale, shear.
    pub linear: DMat3,
    /// Shift, after that.
    pub translation: DVec3,
}

impl<'a> Scene<'a> {
    /// One model without a caption.
    pub fn new(model: Model<'a>) -> Self {
        Scene { panels: vec![Panel::new("", model)] }
    }
}

impl<'a> Panel<'a> {
    /// One model with a caption below.
    pub fn new(caption: impl Into<String>, model: Model<'a>) -> Self {
        Panel { caption: caption.into(), models: vec![model] }
    }
}

impl<'a> Model<'a> {
    /// A shape as it stands in the default style.
    pub fn new(shape: impl Into<Shape<'a>>) -> Self {
        Model { shape: shape.into(), style: Style::default(), placement: Placement::default() }
    }
}

impl Shape<'_> {
    /// How many vertices or points there are.
    pub fn vertex_count(&self) -> usize {
        match self {
            Shape::Mesh(mesh) => mesh.vertex_count(),
            Shape::Faces(set) => set.vertex_count(),
            Shape::Points(points) => points.len(),
        }
    }

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        match self {
            Shape::Mesh(mesh) => mesh.face_count(),
            Shape::Faces(set) => set.face_count(),
            Shape::Points(_) => 0,
        }
    }

    /// How many corners there are: half-edges of a mesh, corners of a face set.
    pub fn corner_count(&self) -> usize {
        match self {
            Shape::Mesh(mesh) => mesh.halfedge_count(),
            Shape::Faces(set) => set.faces().corners().len(),
            Shape::Points(_) => 0,
        }
    }

    /// Where each vertex is.
    pub fn positions(&self) -> &[DVec3] {
        match self {
            Shape::Mesh(mesh) => mesh.positions().values(),
            Shape::Faces(set) => set.positions().values(),
            Shape::Points(points) => points,
        }
    }
}

impl<'a> From<&'a Mesh> for Shape<'a> {
    fn from(mesh: &'a Mesh) -> Self {
        Shape::Mesh(mesh)
    }
}

impl<'a> From<&'a IndexedFaceSet> for Shape<'a> {
    fn from(set: &'a IndexedFaceSet) -> Self {
        Shape::Faces(set)
    }
}

impl<'a> From<&'a [DVec3]> for Shape<'a> {
    fn from(points: &'a [DVec3]) -> Self {
        Shape::Points(points)
    }
}

impl Default for Placement {
    /// As it stands.
    fn default() -> Self {
        Placement { linear: DMat3::IDENTITY, translation: DVec3::ZERO }
    }
}

impl Placement {
    /// The shift by `translation`.
    pub fn at(translation: DVec3) -> Self {
        Placement { translation, ..Placement::default() }
    }
}
