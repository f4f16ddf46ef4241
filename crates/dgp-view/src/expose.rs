//! From what is seen at every sample to pixels.

use std::sync::atomic::{AtomicUsize, Ordering};

use dgp_mesh::{Cancelled, Progress, parallel};

use crate::{
    Background, Image, RenderOptions,
    color::{Encoder, Linear, linear, mix},
    layout::Cell,
    occlusion::Openness,
    raster::{Kind, Layer, Steps, seen},
    shade::{Sample, Seen, Studio, Surface},
    shadow::Shadow,
};

/// Everything that is known before pixels are computed.
pub(crate) struct Exposure<'b> {
    pub(crate) studio: Studio<'b>,
    pub(crate) surfaces: &'b [Surface<'b>],
    pub(crate) layers: &'b [Layer<'b>],
    pub(crate) keys: &'b [u64],
    pub(crate) openness: &'b Openness,
    pub(crate) shadow: Option<&'b Shadow>,
}

/// The triangle that was shaded last: neighboring samples mostly show the same.
struct Last {
    id: u32,
    layer: usize,
    seen: Option<Seen>,
}

impl Exposure<'_> {
    /// Computes the pixels of a cell, and returns on how many of them something is seen.
    pub(crate) fn develop(
        &self,
        cell: &Cell,
        options: &RenderOptions,
        image: &mut Image,
        encoder: &Encoder,
        progress: Progress<'_>,
    ) -> Result<usize, Cancelled> {
        /// Rows of pixels at a time.
        const ROWS: usize = 8;
        let width = options.width as usize;
        let [left, top] = [cell.view.x as usize, cell.view.y as usize];
        let rows = top * width..(top + cell.view.height as usize) * width;
        let steps = Steps::new(progress, (cell.view.height as usize).div_ceil(ROWS));
        let covered = AtomicUsize::new(0);
        parallel::for_each_chunk(&mut image.pixels_mut()[rows], width * ROWS, |first, pixels| {
            if steps.one_more().is_err() {
                return;
            }
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
        });
        steps.finish()?;
        Ok(covered.into_inner())
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

pub(crate) fn fill_background(image: &mut Image, encoder: &Encoder, kind: Background) {
    let (width, height) = (image.width() as usize, image.height() as usize);
    for (row, pixels) in image.pixels_mut().chunks_mut(width).enumerate() {
        if let Some(color) = background(kind, row, height) {
            pixels.fill(encoder.pixel(color, 1.0));
        }
    }
}
