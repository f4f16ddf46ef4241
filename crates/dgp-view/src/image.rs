//! The finished picture.

use std::fmt;

use crate::color::{Encoder, Linear, decode_pixel};

/// A picture: rows of pixels from the top, each red, green, blue, alpha (not premultiplied, sRGB).
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Image {
    /// A picture whose pixels are all transparent.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Image { width, height, pixels: vec![[0; 4]; width as usize * height as usize] }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row after row from the top.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// The pixel in column `x` of row `y`, counted from the upper left.
    ///
    /// # Panics
    /// If there is none.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The picture as a PNG file, without alpha where all pixels are opaque.
    pub fn to_png(&self) -> Vec<u8> {
        const WRITTEN: &str = "a picture has pixels, and a vector takes all bytes";
        let opaque = self.pixels.iter().all(|pixel| pixel[3] == 255);
        let (kind, bytes) = if opaque {
            (png::ColorType::Rgb, self.pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect())
        } else {
            (png::ColorType::Rgba, self.pixels.as_flattened().to_vec())
        };
        let mut file = Vec::with_capacity(bytes.len() / 4);
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(kind);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().expect(WRITTEN);
        writer.write_image_data(&bytes).expect(WRITTEN);
        writer.finish().expect(WRITTEN);
        file
    }

    /// All pixels, to be changed.
    pub(crate) fn pixels_mut(&mut self) -> &mut [[u8; 4]] {
        &mut self.pixels
    }

    /// Lays `color` over a pixel, if there is one at these coordinates.
    pub(crate) fn blend(&mut self, encoder: &Encoder, x: i64, y: i64, color: Linear, alpha: f32) {
        if alpha <= 0.0 || !(0..i64::from(self.width)).contains(&x) {
            return;
        }
        let Some(pixel) = usize::try_from(y)
            .ok()
            .and_then(|y| self.pixels.get_mut(y * self.width as usize + x as usize))
        else {
            return;
        };
        let alpha = alpha.min(1.0);
        let (under, under_alpha) = decode_pixel(*pixel);
        let rest = under_alpha * (1.0 - alpha);
        let mixed = std::array::from_fn(|k| color[k] * alpha + under[k] * rest);
        *pixel = encoder.pixel(mixed, alpha + rest);
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({}×{})", self.width, self.height)
    }
}
