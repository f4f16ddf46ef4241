//! From a scene to a picture.

use std::sync::atomic::{AtomicUsize, Ordering};

use dgp_mesh::{Progress, parallel};

use crate::{
    Background, ColorBars, Error, Framing, Image, Model, ModelReport, Panel, Placement, Projection,
    RenderOptions, RenderReport, Scene, Shape, View,
    annotate::Writer,
    arrows::arrow_bodies,
    body::{Body, Frame, unit_power},
    camera::{Basis, Camera, Extent, Lens},
    capsule::Capsule,
    color::{Encoder, Linear, linear, mix},
    ink::{Ink, Place, check_marks, marked_faces},
    layout::{Cell, cells},
    light::Rig,
    lines::capsules,
    occlusion::Openness,
    raster::{Kind, Layer, seen, triangle_layer, visibility},
    shade::{Sample, Seen, Studio, Surface},
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
            check_marks(content, Place { panel, model })?;
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
        let keys = visibility(&layers, &camera);
        progress.report(0.5)?;
        let surfaces: Vec<Surface<'_>> = self
            .bodies
            .iter()
            .zip(self.inks)
            .enumerate()
            .map(|(i, (body, ink))| {
                let marks = self.panel.models.get(i).map(marked_faces).unwrap_or_default();
                Surface::new(body, ink, marks)
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
            Shadow::new(&self.bodies, self.frame.basis.axis(), &camera, options.shadow)
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
        let covered = exposure.develop(cell, options, canvas);
        progress.report(1.0)?;

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

/// Everything that is known before pixels are computed.
struct Exposure<'b> {
    studio: Studio<'b>,
    surfaces: &'b [Surface<'b>],
    layers: &'b [Layer<'b>],
    keys: &'b [u64],
    openness: &'b Openness,
    shadow: Option<&'b Shadow>,
}

/// The triangle that was shaded last: neighboring samples mostly show the same.
struct Last {
    id: u32,
    layer: usize,
    seen: Option<Seen>,
}

impl Exposure<'_> {
    /// Computes the pixels of a cell, and returns on how many of them something is seen.
    fn develop(&self, cell: &Cell, options: &RenderOptions, canvas: &mut Canvas<'_>) -> usize {
        /// Rows of pixels at a time.
        const ROWS: usize = 8;
        let width = options.width as usize;
        let [left, top] = [cell.view.x as usize, cell.view.y as usize];
        let rows = top * width..(top + cell.view.height as usize) * width;
        let encoder = canvas.encoder;
        let covered = AtomicUsize::new(0);
        parallel::for_each_chunk(
            &mut canvas.image.pixels_mut()[rows],
            width * ROWS,
            |first, pixels| {
                let mut last = Last { id: u32::MAX, layer: 0, seen: None };
                let mut count = 0;
                for (i, row) in pixels.chunks_mut(width).enumerate() {
                    let y = first / width + i;
                    let behind = background(options.background, top + y, options.height as usize);
                    for x in 0..cell.view.width as usize {
                        let sample = self.pixel(x, y, options.samples as usize, &mut last);
                        count += usize::from(sample.alpha > 0.0);
                        let sample = self.grounded(sample, x, y, options.samples);
                        if sample.alpha > 0.0 {
                            row[left + x] = over(encoder, sample, behind);
                        }
                    }
                }
                covered.fetch_add(count, Ordering::Relaxed);
            },
        );
        covered.into_inner()
    }

    /// A pixel with the shadow behind it.
    fn grounded(&self, mut sample: Sample, x: usize, y: usize, samples: u32) -> Sample {
        if let Some(shadow) = self.shadow.filter(|_| sample.alpha < 1.0) {
            let [w, h] = self.studio.camera.size.map(|side| 0.5 * f64::from(side));
            let middle = |k: usize| (k as f64 + 0.5) * f64::from(samples);
            let dark = shadow.at(self.studio.camera, [middle(x) - w, h - middle(y)]);
            sample.alpha += (1.0 - sample.alpha) * dark;
        }
        sample
    }

    /// The mean of the samples of a pixel.
    fn pixel(&self, x: usize, y: usize, samples: usize, last: &mut Last) -> Sample {
        let width = self.studio.camera.size[0] as usize;
        let block =
            |i: usize| self.keys[(y * samples + i / samples) * width + x * samples + i % samples];
        let count = samples * samples;
        let first = block(0);
        if (1..count).all(|i| block(i) as u32 == first as u32) {
            let Some((id, _)) = seen(first) else { return Sample::default() };
            self.look_up(id, last);
            if self.is_smooth(last.layer) {
                let middle = |k: usize| (k * samples) as f64 + 0.5 * samples as f64;
                return self.sample(first, middle(x), middle(y), self.openness.at(x, y), last);
            }
        }
        let open = self.openness.at(x, y);
        let mut sum = Sample::default();
        for i in 0..count {
            let (sx, sy) = (x * samples + i % samples, y * samples + i / samples);
            let sample = self.sample(block(i), sx as f64 + 0.5, sy as f64 + 0.5, open, last);
            (0..3).for_each(|k| sum.light[k] += sample.light[k]);
            sum.alpha += sample.alpha;
        }
        let share = 1.0 / count as f32;
        Sample { light: sum.light.map(|x| x * share), alpha: sum.alpha * share }
    }

    /// What is seen at a place, in samples from the upper left.
    fn sample(&self, key: u64, x: f64, y: f64, open: f64, last: &mut Last) -> Sample {
        let Some((id, _)) = seen(key) else { return Sample::default() };
        self.look_up(id, last);
        let layer = &self.layers[last.layer];
        let i = (id - layer.base) as usize;
        match (&layer.kind, &last.seen) {
            (Kind::Capsules(capsules), _) => self.studio.capsule(&capsules[i], x, y),
            (Kind::Triangles { index, .. }, Some(seen)) => {
                let [w, h] = self.studio.camera.size.map(|side| 0.5 * f64::from(side));
                let surface = &self.surfaces[*index];
                self.studio.triangle(surface, i, seen, [x - w, h - y], open)
            }
            (Kind::Triangles { .. }, None) => Sample::default(),
        }
    }

    fn is_smooth(&self, layer: usize) -> bool {
        match &self.layers[layer].kind {
            Kind::Triangles { index, .. } => self.surfaces[*index].is_smooth(),
            Kind::Capsules(_) => true,
        }
    }

    /// Makes `last` the primitive `id`.
    fn look_up(&self, id: u32, last: &mut Last) {
        if last.id == id && last.id != u32::MAX {
            return;
        }
        let layer = self.layers.partition_point(|layer| layer.base <= id) - 1;
        let seen = match &self.layers[layer].kind {
            Kind::Triangles { body, .. } => {
                let t = (id - self.layers[layer].base) as usize;
                Some(Seen::new(body.points(t), self.studio.camera))
            }
            Kind::Capsules(_) => None,
        };
        *last = Last { id, layer, seen };
    }
}

/// A sample over what is behind it.
fn over(encoder: &Encoder, sample: Sample, behind: Option<Linear>) -> [u8; 4] {
    match behind {
        None => encoder.pixel(sample.light, sample.alpha),
        Some(behind) => {
            let rest = 1.0 - sample.alpha;
            encoder.pixel(std::array::from_fn(|k| sample.light[k] + rest * behind[k]), 1.0)
        }
    }
}

/// The background in a row of the picture, if there is one.
fn background(background: Background, row: usize, height: usize) -> Option<Linear> {
    match background {
        Background::Transparent => None,
        Background::Plain(color) => Some(linear(color)),
        Background::Gradient => {
            let t = (row as f32 + 0.5) / height as f32;
            Some(mix([0.96, 0.965, 0.975], [0.68, 0.70, 0.735], t * t))
        }
    }
}

fn fill_background(image: &mut Image, encoder: &Encoder, kind: Background) {
    let (width, height) = (image.width() as usize, image.height() as usize);
    for (row, pixels) in image.pixels_mut().chunks_mut(width).enumerate() {
        if let Some(color) = background(kind, row, height) {
            pixels.fill(encoder.pixel(color, 1.0));
        }
    }
}
