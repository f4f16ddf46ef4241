//! What was drawn and what was not.

/// What [`render`](crate::render) drew, and what it left out.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct RenderReport {
    /// On how many pixels a model is seen.
    pub covered_pixels: usize,
    /// Each model of each panel, in order.
    pub models: Vec<ModelReport>,
}

/// What was drawn of a model, and what was left out.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct ModelReport {
    /// Its panel, counted from 0.
    pub panel: usize,
    /// Its place in the panel, counted from 0.
    pub model: usize,
    /// Triangles with an area; polygons count as the triangles they were cut into.
    pub triangles: usize,
    /// Lines and points drawn beside them.
    pub lines_and_points: usize,
    /// Triangles left out since they have no area.
    pub triangles_without_area: usize,
    /// Triangles left out since a coordinate of a corner is infinite or not a number.
    pub triangles_at_non_finite_vertices: usize,
    /// Faces left out since they have fewer than three vertices.
    pub faces_of_fewer_than_three_vertices: usize,
    /// Vertices with a coordinate that is infinite or not a number.
    pub non_finite_vertices: usize,
    /// The numbers that have the first and the last color, if the model is painted by numbers.
    pub range: Option<(f64, f64)>,
}
