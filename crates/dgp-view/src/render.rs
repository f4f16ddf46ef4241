//! From a scene to a picture.

use dgp_mesh::{Progress, parallel};

use crate::{
    ColorBars, Error, Framing, Image, Model, ModelReport, Panel, Placement, Projection,
    RenderOptions, RenderReport, Scene, Shape, View,
    annotate::Writer,
    arrows::arrow_bodies,
    body::{Body, Frame, unit_power},
    camera::{Basis, Camera, Extent, Lens},
    capsule::Capsule,
    color::Encoder,
    expose::{Exposure, fill_background},
    ink::{Ink, Place, check_style, marked_faces},
    layout::{Cell, cells},
    light::Rig,
    lines::capsules,
    occlusion::Openness,
    raster::{Kind, Layer, seen_vertices, triangle_layer, visibility},
    shade::{Studio, Surface},
    shadow::Shadow,
};

/// Draws a scene.
///
/// Any input gives a picture: a panel without anything that can be drawn says so. The picture is the
/// same, bit for bit, for any number of threads, and if all models are scaled by the same power of
/// two. The report tells what was left out. Takes eight bytes for each sample of a panel and some 60
/// for each triangle.
///
/// Errors: [`Error::ImageSize`], [`Error::PanelsDoNotFit`], [`Error::InvalidOption`],
/// [`Error::CountMismatch`], [`Error::ElementOutOfRange`], [`Error::NoEdges`], [`Error::TooMany`],
/// [`Error::Cancelled`].
pub fn render(
    scene: &Scene<'_>,
    options: &RenderOptions,
    progress: Progress<'_>,
) -> Result<(Image, RenderReport), Error> {
    options.validate()?;
    let cells = cells(&scene.panels, options)?;
    for (panel, content) in scene.panels.iter().enumerate() {
        for (model, content) in content.models.iter().enumerate() {
            check_style(content, Place { panel, model })?;
        }
    }
    progress.report(0.0)?;
    let encoder = Encoder::new();
    let mut image = Image::new(options.width, options.height);
    fill_background(&mut image, &encoder, options.background);
    let mut report = RenderReport::default();

    let count = scene.panels.len().max(1) as f64;
    let preparing = progress.part(0.0, 0.3);
    let mut views = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        preparing.report(i as f64 / count)?;
        views.push(PanelView::new(scene, i, cell, options)?);
    }
    if options.framing == Framing::Shared {
        let all = views.iter().fold(Extent::EMPTY, |extent, view| extent.union(view.extent));
        for view in &mut views {
            view.extent = all;
        }
    }
    let mut canvas = Canvas { image: &mut image, encoder: &encoder, report: &mut report };
    let drawing = progress.part(0.3, 1.0);
    for (i, (view, cell)) in views.into_iter().zip(&cells).enumerate() {
        let drawing = drawing.part(i as f64 / count, (i + 1) as f64 / count);
        view.draw(cell, options, &mut canvas, drawing)?;
    }
    Ok((image, report))
}

/// A picture of one shape with the default style and options.
pub fn picture<'a>(shape: impl Into<Shape<'a>>) -> Result<Image, Error> {
    let scene = Scene::new(Model::new(shape));
    render(&scene, &RenderOptions::default(), Progress::NONE).map(|(image, _)| image)
}

/// A panel made ready.
struct PanelView<'a> {
    index: usize,
    panel: &'a Panel<'a>,
    /// Models first, then their arrows.
    bodies: Vec<Body<'a>>,
    inks: Vec<Ink<'a>>,
    frame: Frame,
    lens: Lens,
    extent: Extent,
}

impl<'a> PanelView<'a> {
    fn new(
        scene: &'a Scene<'a>,
        index: usize,
        cell: &Cell,
        options: &RenderOptions,
    ) -> Result<Self, Error> {
        let panel = &scene.panels[index];
        let power = match options.framing {
            Framing::Each => unit_power(panel.models.iter()),
            Framing::Shared => unit_power(scene.panels.iter().flat_map(|panel| &panel.models)),
        };
        let frame = Frame { basis: Basis::new(options.view, options.up), power };
        let size = [cell.view.width, cell.view.height].map(|side| side * options.samples);
        let projection = match (options.view, options.projection) {
            // An eye somewhere makes sense in perspective only.
            (View::Eye { .. }, Projection::Orthographic) => Projection::default(),
            (_, projection) => projection,
        };
        let lens = Lens::new(size, options.margin, projection);
        let (mut bodies, mut inks, mut arrows) = (Vec::new(), Vec::new(), Vec::new());
        for (i, model) in panel.models.iter().enumerate() {
            let place = Place { panel: index, model: i };
            inks.push(Ink::new(model, place)?);
            let body = Body::new(model, &frame);
            arrows.extend(arrow_bodies(model, &body, &frame, place)?);
            bodies.push(body);
        }
        for (body, color) in arrows {
            bodies.push(body);
            inks.push(Ink::Uniform(color));
        }
        let extents = bodies.iter().map(|body| body.extent(&lens));
        let extent = extents.fold(Extent::EMPTY, Extent::union);
        Ok(PanelView { index, panel, bodies, inks, frame, lens, extent })
    }

    fn draw(
        mut self,
        cell: &Cell,
        options: &RenderOptions,
        canvas: &mut Canvas<'_>,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        progress.report(0.0)?;
        let camera = self.camera(options.view);
        for body in &mut self.bodies {
            parallel::for_each_chunk(&mut body.positions, parallel::BLOCK, |_, positions| {
                for p in positions {
                    *p -= camera.eye;
                }
            });
        }
        let pixel = f64::from(options.samples);
        let lines: Vec<Vec<Capsule>> = self
            .bodies
            .iter()
            .zip(&self.inks)
            .map(|(body, ink)| capsules(body, ink, pixel))
            .collect();
        let layers = layers(&self.bodies, &lines, &camera)?;
        progress.report(0.1)?;
        let keys = visibility(&layers, &camera, progress.part(0.1, 0.5))?;
        progress.report(0.5)?;
        let surfaces: Vec<Surface<'_>> = self
            .bodies
            .iter()
            .zip(self.inks)
            .zip(seen_vertices(&self.bodies, &layers, &keys))
            .enumerate()
            .map(|(i, ((body, ink), seen))| {
                let marks = self.panel.models.get(i).map(marked_faces).unwrap_or_default();
                Surface::new(body, ink, marks, &seen)
            })
            .collect();
        progress.report(0.6)?;
        let studio = Studio { camera: &camera, rig: Rig::new(), pixel };
        let openness = if options.occlusion > 0.0 {
            let radius = OCCLUSION_RADIUS * (self.extent.max - self.extent.min).max_element();
            let samples = options.samples as usize;
            Openness::new(&layers, &keys, &camera, samples, options.occlusion, radius)
        } else {
            Openness::full()
        };
        progress.report(0.7)?;
        let shadow = if options.shadow > 0.0 {
            let drawing = progress.part(0.7, 0.75);
            Shadow::new(&self.bodies, self.frame.basis.axis(), &camera, options.shadow, drawing)?
        } else {
            None
        };
        progress.report(0.75)?;
        let exposure = Exposure {
            studio,
            surfaces: &surfaces,
            layers: &layers,
            keys: &keys,
            openness: &openness,
            shadow: shadow.as_ref(),
        };
        let developing = progress.part(0.75, 1.0);
        let covered = exposure.develop(cell, options, canvas.image, canvas.encoder, developing)?;

        canvas.report.covered_pixels += covered;
        let mut writer = Writer {
            image: &mut *canvas.image,
            encoder: canvas.encoder,
            background: options.background,
        };
        if layers.iter().all(|layer| layer.len() == 0) {
            writer.note(cell, "empty");
        }
        writer.caption(cell, &self.panel.caption);
        if options.color_bars == ColorBars::Shown {
            let scalars = surfaces.iter().find_map(|surface| match &surface.ink {
                Ink::Scalars(ink) => Some(ink),
                Ink::Uniform(_) | Ink::Colors(..) | Ink::Checker(..) => None,
            });
            if let Some(ink) = scalars {
                writer.color_bar(cell, ink);
            }
        }
        for (model, (body, lines)) in surfaces.iter().zip(&lines).enumerate() {
            if model < self.panel.models.len() {
                let range = match &body.ink {
                    Ink::Scalars(ink) => ink.range,
                    Ink::Uniform(_) | Ink::Colors(..) | Ink::Checker(..) => None,
                };
                canvas.report.models.push(ModelReport {
                    panel: self.index,
                    model,
                    lines_and_points: lines.len(),
                    range,
                    ..body.body.report.clone()
                });
            }
        }
        Ok(())
    }

    fn camera(&self, view: View) -> Camera {
        match view {
            View::Eye { eye, .. } => {
                let eye = self.frame.view(&Placement::default(), eye);
                Camera::at_eye(eye, &self.extent, &self.lens)
            }
            _ => Camera::fit(&self.extent, &self.lens),
        }
    }
}

/// The distance up to which things darken each other, as a fraction of the size of what is drawn.
const OCCLUSION_RADIUS: f64 = 0.12;

/// What panels are drawn on.
struct Canvas<'i> {
    image: &'i mut Image,
    encoder: &'i Encoder,
    report: &'i mut RenderReport,
}

/// The surfaces and lines of all bodies, numbered through.
fn layers<'b>(
    bodies: &'b [Body<'b>],
    lines: &'b [Vec<Capsule>],
    camera: &Camera,
) -> Result<Vec<Layer<'b>>, Error> {
    let count: usize = bodies.iter().map(|body| body.triangles.len()).sum::<usize>()
        + lines.iter().map(Vec::len).sum::<usize>();
    if count > dgp_mesh::MAX_ELEMENTS {
        return Err(Error::TooMany { count });
    }
    let (mut layers, mut base) = (Vec::new(), 0);
    for (i, (body, lines)) in bodies.iter().zip(lines).enumerate() {
        layers.push(triangle_layer(base, i, body, camera));
        base += body.triangles.len() as u32;
        layers.push(Layer { base, kind: Kind::Capsules(lines) });
        base += lines.len() as u32;
    }
    Ok(layers)
}
