//! Pictures of meshes and point clouds, drawn on the CPU into PNG.
//!
//! | topic | items |
//! |---|---|
//! | the picture | [`render`], [`picture`], [`Image`], [`RenderReport`] |
//! | what is in it | [`Scene`], [`Panel`], [`Model`], [`Shape`], [`Placement`] |
//! | how models look | [`Style`]: [`Fill`], [`Shading`], [`BackFaces`], [`Stroke`], [`Points`], [`Mark`], [`Arrows`] |
//! | their color | [`Paint`], [`attribute_paint`]: [`Field`], [`Scalars`], [`ColorMap`], [`Range`], [`Checker`] |
//! | curves over an axis, as SVG | [`Plot`], [`Curve`], [`Axis`] |
//! | the camera | [`RenderOptions`]: [`View`], [`Up`], [`Projection`], [`Framing`], [`Background`] |
//!
//! ```
//! use dgp_mesh::{DVec3, FaceList, IndexedFaceSet};
//!
//! let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = FaceList::from_indices(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
//! let tetrahedron = IndexedFaceSet::new(corners, faces)?;
//! let png = dgp_view::picture(&tetrahedron)?.to_png();
//! assert_eq!(png[1..4], *b"PNG");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod annotate;
mod arrows;
mod body;
mod camera;
mod capsule;
mod clip;
mod color;
mod color_map;
mod error;
mod expose;
mod font;
mod image;
mod ink;
mod layout;
mod light;
mod lines;
mod normals;
mod occlusion;
mod options;
mod paint;
mod plot;
mod raster;
mod render;
mod report;
mod scene;
mod shade;
mod shadow;
mod style;
mod ticks;

pub use color_map::ColorMap;
pub use error::Error;
pub use image::Image;
pub use options::{Background, ColorBars, Columns, Framing, Projection, RenderOptions, Up, View};
pub use paint::{Checker, Field, NOT_A_NUMBER, Paint, Range, Scalars, attribute_paint};
pub use plot::{Axis, Curve, Marker, Plot};
pub use render::{picture, render};
pub use report::{ModelReport, RenderReport};
pub use scene::{Model, Panel, Placement, Scene, Shape};
pub use style::{
    ArrowLength, Arrows, BackFaces, Fill, Mark, Marked, PointSize, Points, PointsShown, Shading,
    Stroke, Style, Vectors,
};
