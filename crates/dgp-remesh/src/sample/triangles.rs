//! The triangles of a surface at unit scale, and how much area lies before each.

use dgp_mesh::{DVec3, FaceId, measure::Surface};

use super::SurfaceSample;
use crate::Error;

/// A surface whose largest coordinate is between 1 and 2, by a power of two.
pub(crate) struct Triangles {
    corners: Vec<[u32; 3]>,
    points: Vec<DVec3>,
    /// The length of 1 in units of the surface.
    pub(crate) unit: f64,
}

impl Triangles {
    /// Errors: [`Error::NotTriangle`], [`Error::NotFinite`].
    pub(crate) fn new(surface: &impl Surface) -> Result<Self, Error> {
        let positions = surface.vertex_positions();
        let mut corners = Vec::with_capacity(surface.number_of_faces());
        let mut largest = 0.0_f64;
        for face in (0..surface.number_of_faces()).map(FaceId::new) {
            let Some(triangle) = surface.corners_of_triangle(face) else {
                return Err(Error::NotTriangle { face, degree: surface.polygon(face).count() });
            };
            for vertex in triangle {
                let p = positions[vertex];
                if !p.is_finite() {
                    return Err(Error::NotFinite { vertex });
                }
                largest = largest.max(p.abs().max_element());
            }
            corners.push(triangle.map(|v| v.index() as u32));
        }
        let unit = power_of_two(largest);
        // What is on no face may be no number, and is not looked at.
        let points = positions.values().iter().map(|&p| p / unit).collect();
        Ok(Triangles { corners, points, unit })
    }

    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    pub(crate) fn points(&self, f: usize) -> [DVec3; 3] {
        self.corners[f].map(|v| self.points[v as usize])
    }

    pub(crate) fn area(&self, f: usize) -> f64 {
        let [a, b, c] = self.points(f);
        0.5 * (b - a).cross(c - a).length()
    }

    /// The point of face `f` with the weights 1 − v − w, v and w, at unit scale.
    pub(crate) fn at(&self, f: usize, [v, w]: [f64; 2]) -> DVec3 {
        let [a, b, c] = self.points(f);
        a + v * (b - a) + w * (c - a)
    }

    /// The same as a sample.
    pub(crate) fn sample(&self, f: usize, [v, w]: [f64; 2]) -> SurfaceSample {
        SurfaceSample {
            face: FaceId::new(f),
            barycentric: [(1.0 - v - w).max(0.0), v, w],
            position: self.at(f, [v, w]) * self.unit,
        }
    }

    /// The area up to and with each of some faces, in their order.
    ///
    /// Errors: [`Error::NoArea`].
    pub(crate) fn cumulative(&self, order: impl Iterator<Item = usize>) -> Result<Vec<f64>, Error> {
        let mut sum = 0.0;
        let sums = order.map(|f| {
            sum += self.area(f);
            sum
        });
        let sums: Vec<f64> = sums.collect();
        if sums.last().is_some_and(|&total| total > 0.0) { Ok(sums) } else { Err(Error::NoArea) }
    }
}

/// Which entry of a cumulative list holds `x`, which is not less than 0.
pub(crate) fn locate(cumulative: &[f64], x: f64) -> usize {
    let place = cumulative.partition_point(|&sum| sum <= x);
    if place < cumulative.len() {
        return place;
    }
    // Rounded up to the whole: the last that has a part of it.
    let total = cumulative[cumulative.len() - 1];
    cumulative.partition_point(|&sum| sum < total)
}

/// The largest power of two not above `x`, kept where it and its reciprocal are normal numbers.
pub(crate) fn power_of_two(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    2_f64.powi(exponent.clamp(-1000, 1000))
}
