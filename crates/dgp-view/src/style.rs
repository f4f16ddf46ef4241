//! How a model looks.

use dgp_mesh::{Color, EdgeSet, FaceSet, VertexId, VertexMap, VertexSet};
use dgp_mesh::{DVec3, FaceMap};

use crate::Paint;

/// How a model looks. The default is smooth shading in one color, with back faces in another, so that
/// a flipped patch is seen at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Whether and how faces are filled.
    pub fill: Fill,
    /// How light falls on them.
    pub shading: Shading,
    /// Their color.
    pub paint: Paint,
    /// What their back sides look like.
    pub back_faces: BackFaces,
    /// The edges of all faces.
    pub wireframe: Stroke,
    /// The edges of just one face.
    pub boundary: Stroke,
    /// Vertices as points.
    pub points: Points,
    /// Elements drawn in a color of their own, such as defects.
    pub marks: Vec<Mark>,
    /// Vectors drawn as arrows.
    pub arrows: Vec<Arrows>,
}

/// Whether and how faces are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fill {
    /// With their paint, in light and shade.
    #[default]
    Shaded,
    /// With their paint as it is, without light, as in a map.
    Flat,
    /// With the background, so that they hide what is behind them.
    Background,
    /// Not at all.
    None,
}

/// How light falls on faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// As on a smooth surface: normals are means over the faces at a vertex, weighted by angle.
    Smooth {
        /// The angle in radians between two faces from which the edge between them looks sharp.
        crease_angle: f64,
    },
    /// As on flat faces.
    Flat,
}

/// What the back sides of faces look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BackFaces {
    /// In a color of their own.
    Colored(Color),
    /// Like the front.
    LikeFront,
    /// Not drawn.
    Hidden,
}

/// A line; none if its width is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its color; lines are as opaque as its alpha says.
    pub color: Color,
    /// Its width in pixels.
    pub width: f64,
}

/// Which vertices are drawn as points, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Points {
    /// Which.
    pub shown: PointsShown,
    /// How large.
    pub size: PointSize,
}

/// Which vertices are drawn as points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointsShown {
    /// All if there are no faces, else none.
    #[default]
    WithoutFaces,
    /// All.
    All,
    /// None.
    Never,
}

/// How large points are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PointSize {
    /// So that neighbors on a surface just touch.
    #[default]
    BySpacing,
    /// A diameter in pixels.
    Pixels(f64),
}

/// Elements drawn in a color of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Which.
    pub elements: Marked,
    /// In which color.
    pub color: Color,
    /// How wide lines and points are, in pixels.
    pub width: f64,
}

/// A set of elements.
#[derive(Clone, Debug, PartialEq)]
pub enum Marked {
    /// Vertices, drawn as balls.
    Vertices(VertexSet),
    /// Edges of a mesh, drawn as lines.
    Edges(EdgeSet),
    /// Faces, painted.
    Faces(FaceSet),
    /// Lines between pairs of vertices: edges of a face set, or paths.
    Segments(Vec<[VertexId; 2]>),
}

/// Vectors drawn as arrows.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrows {
    /// Where they start, and what they are.
    pub vectors: Vectors,
    /// In which color.
    pub color: Color,
    /// How long the arrows are.
    pub length: ArrowLength,
}

/// A vector at each element of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Vectors {
    /// At the vertices.
    Vertices(VertexMap<DVec3>),
    /// At the centers of the faces.
    Faces(FaceMap<DVec3>),
}

/// How long arrows are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ArrowLength {
    /// So that the longest does not reach much further than the next element.
    #[default]
    BySpacing,
    /// This many times the vector.
    Times(f64),
}

impl Default for Style {
    fn default() -> Self {
        Style {
            fill: Fill::default(),
            shading: Shading::default(),
            paint: Paint::default(),
            back_faces: BackFaces::default(),
            wireframe: Stroke::NONE,
            boundary: Stroke::NONE,
            points: Points::default(),
            marks: Vec::new(),
            arrows: Vec::new(),
        }
    }
}

impl Style {
    /// Edges alone, hidden lines removed.
    pub fn wireframe() -> Self {
        Style {
            fill: Fill::Background,
            back_faces: BackFaces::LikeFront,
            wireframe: Stroke::THIN,
            ..Style::default()
        }
    }

    /// Flat shading with edges.
    pub fn faceted() -> Self {
        Style { shading: Shading::Flat, wireframe: Stroke::THIN, ..Style::default() }
    }
}

impl Shading {
    /// The crease angle of the default: below that of a cube and of most machine parts, above that
    /// of a coarse sphere.
    pub const CREASE_ANGLE: f64 = std::f64::consts::FRAC_PI_4;
}

impl Default for Shading {
    fn default() -> Self {
        Shading::Smooth { crease_angle: Shading::CREASE_ANGLE }
    }
}

impl Default for BackFaces {
    /// A warm color, opposite to that of the front.
    fn default() -> Self {
        BackFaces::Colored(Color([0.86, 0.42, 0.20, 1.0]))
    }
}

impl Stroke {
    /// No line.
    pub const NONE: Stroke = Stroke { color: Color([0.0, 0.0, 0.0, 1.0]), width: 0.0 };
    /// The lines of a wireframe.
    pub const THIN: Stroke = Stroke { color: Color([0.07, 0.09, 0.13, 1.0]), width: 1.0 };
    /// The lines of a boundary.
    pub const BOLD: Stroke = Stroke { color: Color([0.78, 0.10, 0.16, 1.0]), width: 3.0 };
}

impl Mark {
    /// Elements in a signal color.
    pub fn new(elements: Marked) -> Self {
        Mark { elements, color: Color([0.85, 0.05, 0.30, 1.0]), width: 4.0 }
    }
}

impl Arrows {
    /// Arrows sized by the spacing of the elements they start at.
    pub fn new(vectors: Vectors) -> Self {
        let color = Color([0.12, 0.25, 0.55, 1.0]);
        Arrows { vectors, color, length: ArrowLength::default() }
    }
}
