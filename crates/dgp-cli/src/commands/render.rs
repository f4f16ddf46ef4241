//! `dgp render`: draws meshes into a PNG.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    io::{Document, Format},
    view::{
        BackFaces, Background, Checker, ColorMap, Columns, Error, Field, Fill, Framing, Model,
        Paint, Panel, Projection, Range, RenderOptions, RenderReport, Scalars, Scene, Shading,
        Shape, Stroke, Style, Up, View, attribute_paint, render,
    },
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// Options of `dgp render`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches of a command line")]
pub(crate) struct Render {
    /// The meshes to draw, side by side; `-` for standard input
    #[arg(value_name = "INPUT", required = true)]
    inputs: Vec<PathBuf>,
    /// Read as this format, whatever the extension
    #[arg(long, value_name = "FORMAT", value_parser = |name: &str| Format::from_name(name).map_err(|e| e.to_string()))]
    format: Option<Format>,
    /// The picture to write, `-` for standard output
    #[arg(long, short, value_name = "PNG")]
    output: PathBuf,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "1200x900", value_parser = size)]
    size: (u32, u32),
    /// Samples per pixel and direction, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 2)]
    samples: u32,
    /// How light falls on faces
    #[arg(long, value_enum, default_value_t = ShadingName::Smooth)]
    shading: ShadingName,
    /// The angle in degrees from which an edge looks sharp
    #[arg(long, value_name = "DEG", default_value_t = 45.0)]
    crease_angle: f64,
    /// Draw edges
    #[arg(long, value_enum, num_args = 0..=1, default_missing_value = "over")]
    wireframe: Option<Wireframe>,
    /// Draw the edges of just one face
    #[arg(long)]
    boundary: bool,
    /// Color by this attribute (`color`, `uv`, `confidence`, …), or `none`; by default the colors of
    /// the file if it has any
    #[arg(long, value_name = "ATTRIBUTE")]
    color_by: Option<String>,
    /// How numbers become colors
    #[arg(long, value_enum, default_value_t = ColorMapName::Viridis)]
    colormap: ColorMapName,
    /// Which numbers have the first and the last color: two numbers, `robust`, `full` or `symmetric`
    #[arg(long, value_name = "MIN,MAX", default_value = "robust", value_parser = range)]
    range: Range,
    /// About how many lines of equal value to draw
    #[arg(long, value_name = "N", default_value_t = 0)]
    isolines: u32,
    /// Squares of the checkerboard along a unit of texture coordinates
    #[arg(long, value_name = "N", default_value_t = 16.0)]
    squares: f64,
    /// Where to look from: three-quarter, front, back, left, right, top, bottom, or a direction x,y,z
    #[arg(long, default_value = "three-quarter", value_parser = parsed::<View>, allow_hyphen_values = true)]
    view: View,
    /// The axis that points up, y or z
    #[arg(long, default_value = "y", value_parser = parsed::<Up>)]
    up: Up,
    /// Draw without perspective
    #[arg(long)]
    orthographic: bool,
    /// What is behind: gradient, white, black, transparent or #rrggbb
    #[arg(long, default_value = "gradient", value_parser = parsed::<Background>)]
    background: Background,
    /// What the back sides of faces look like
    #[arg(long, value_enum, default_value_t = BackFacesName::Colored)]
    backfaces: BackFacesName,
    /// Let all pictures share one camera, so that sizes can be compared
    #[arg(long)]
    shared_camera: bool,
    /// How many pictures there are in a row
    #[arg(long, value_name = "N")]
    columns: Option<u32>,
    /// Write no names below the pictures
    #[arg(long)]
    no_captions: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ShadingName {
    /// As on a smooth surface
    Smooth,
    /// As on flat faces
    Flat,
    /// Colors as they are, without light
    Unlit,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Wireframe {
    /// Over the faces
    Over,
    /// Alone, hidden lines removed
    Only,
    /// Alone, hidden lines shown
    Through,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ColorMapName {
    /// From dark blue over green to yellow
    Viridis,
    /// From blue over gray to red, for deviations
    Coolwarm,
    /// A rainbow
    Turbo,
    /// From dark to light
    Gray,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum BackFacesName {
    /// In a color of their own, so that flipped faces are seen
    Colored,
    /// Like the front
    Front,
    /// Not drawn
    Hidden,
}

impl Render {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("render", common);
        let mut documents = Vec::new();
        for path in &self.inputs {
            documents.push(session.read(&Input { path: path.clone(), format: self.format })?);
        }
        let mut scene = Scene::default();
        for (path, document) in self.inputs.iter().zip(&documents) {
            let model = Model { style: self.style(document)?, ..Model::new(&document.set) };
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            let caption = if self.no_captions { String::new() } else { name.into_owned() };
            scene.panels.push(Panel::new(caption, model));
        }
        let options = self.options();
        let (png, report) = session.run("drawing", |progress| {
            let (image, report) = render(&scene, &options, progress)?;
            Ok::<_, Error>((image.to_png(), report))
        })?;
        for (path, model) in self.inputs.iter().zip(&report.models) {
            for line in left_out(model) {
                session.warn(format!("{}: {line}", path.display()));
            }
        }
        let described = json!({
            "path": self.output.to_string_lossy(),
            "width": options.width,
            "height": options.height,
        });
        session.write_bytes(&self.output, &png, described)?;
        let triangles: usize = report.models.iter().map(|model| model.triangles).sum();
        let summary = format!(
            "{}: {}×{}, {triangles} triangles, {}",
            self.output.display(),
            options.width,
            options.height,
            session.spent(),
        );
        session.finish(&summary, &to_json(&report))?;
        Ok(ExitCode::SUCCESS)
    }

    fn options(&self) -> RenderOptions {
        let (width, height) = self.size;
        RenderOptions {
            width,
            height,
            samples: self.samples,
            view: self.view,
            up: self.up,
            projection: if self.orthographic {
                Projection::Orthographic
            } else {
                Projection::default()
            },
            framing: if self.shared_camera { Framing::Shared } else { Framing::Each },
            columns: self.columns.map_or(Columns::Auto, Columns::Count),
            background: self.background,
            ..RenderOptions::default()
        }
    }

    fn style(&self, document: &Document) -> Result<Style, Failure> {
        let mut style = Style { paint: self.paint(document)?, ..Style::default() };
        match self.shading {
            ShadingName::Smooth => {
                style.shading = Shading::Smooth { crease_angle: self.crease_angle.to_radians() };
            }
            ShadingName::Flat => style.shading = Shading::Flat,
            ShadingName::Unlit => style.fill = Fill::Flat,
        }
        style.back_faces = match self.backfaces {
            BackFacesName::Colored => BackFaces::default(),
            BackFacesName::Front => BackFaces::LikeFront,
            BackFacesName::Hidden => BackFaces::Hidden,
        };
        match self.wireframe {
            None => {}
            Some(Wireframe::Over) => style.wireframe = Stroke::THIN,
            Some(Wireframe::Only) => {
                style = Style { paint: style.paint, shading: style.shading, ..Style::wireframe() };
            }
            Some(Wireframe::Through) => {
                style.wireframe = Stroke::THIN;
                style.fill = Fill::None;
            }
        }
        if self.boundary {
            style.boundary = Stroke::BOLD;
        }
        Ok(style)
    }

    fn paint(&self, document: &Document) -> Result<Paint, Failure> {
        let shape = Shape::Faces(&document.set);
        let paint = match self.color_by.as_deref() {
            Some("none") => Paint::default(),
            Some(name) => attribute_paint(shape, name)?,
            None => attribute_paint(shape, dgp::mesh::COLOR).unwrap_or_default(),
        };
        let map = match self.colormap {
            ColorMapName::Viridis => ColorMap::Viridis,
            ColorMapName::Coolwarm => ColorMap::CoolWarm,
            ColorMapName::Turbo => ColorMap::Turbo,
            ColorMapName::Gray => ColorMap::Gray,
        };
        Ok(match paint {
            Paint::Scalars(scalars) => Paint::Scalars(Scalars {
                map,
                range: self.range,
                isolines: self.isolines,
                ..scalars
            }),
            Paint::Checker(checker) => Paint::Checker(Checker { squares: self.squares, ..checker }),
            other => other,
        })
    }
}

/// What of a model is not in the picture, in sentences.
fn left_out(model: &dgp::view::ModelReport) -> Vec<String> {
    [
        (model.triangles_without_area, "triangles without area"),
        (model.triangles_at_non_finite_vertices, "triangles at vertices that are no numbers"),
        (model.faces_of_fewer_than_three_vertices, "faces of fewer than three vertices"),
        (model.non_finite_vertices, "vertices that are no numbers"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what} not drawn"))
    .collect()
}

fn to_json(report: &RenderReport) -> Value {
    let models = report.models.iter().map(|model| {
        json!({
            "panel": model.panel,
            "model": model.model,
            "triangles": model.triangles,
            "lines_and_points": model.lines_and_points,
            "triangles_without_area": model.triangles_without_area,
            "triangles_at_non_finite_vertices": model.triangles_at_non_finite_vertices,
            "faces_of_fewer_than_three_vertices": model.faces_of_fewer_than_three_vertices,
            "non_finite_vertices": model.non_finite_vertices,
            "range": model.range.map(|(low, high)| [low, high]),
        })
    });
    json!({"covered_pixels": report.covered_pixels, "models": models.collect::<Vec<Value>>()})
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X', '×']).map(|(w, h)| (w.parse(), h.parse()));
    match parts {
        Some((Ok(width), Ok(height))) => Ok((width, height)),
        _ => Err("a size is two numbers, as in 1200x900".to_owned()),
    }
}

fn range(text: &str) -> Result<Range, String> {
    match text {
        "robust" => return Ok(Range::Robust),
        "full" => return Ok(Range::Full),
        "symmetric" => return Ok(Range::Symmetric),
        _ => {}
    }
    let numbers = text.split_once(',').map(|(a, b)| (a.parse::<f64>(), b.parse::<f64>()));
    match numbers {
        Some((Ok(low), Ok(high))) if low < high => Ok(Range::Between(low, high)),
        _ => Err("a range is two rising numbers, as in 0,1.5".to_owned()),
    }
}

fn parsed<T: std::str::FromStr<Err = Error>>(word: &str) -> Result<T, String> {
    word.parse().map_err(|error: Error| error.to_string())
}

/// A field of values at the vertices, painted through the default map.
pub(crate) fn vertex_scalars(values: dgp::mesh::VertexMap<f64>, label: &str) -> Paint {
    let scalars = Scalars::new(Field::Vertices(values));
    Paint::Scalars(Scalars { label: label.to_owned(), ..scalars })
}
