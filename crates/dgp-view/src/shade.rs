//! The color of every pixel, from what is seen at its samples.

use dgp_mesh::{DVec3, FaceSet};

use crate::{
    BackFaces, Fill, Stroke,
    body::Body,
    camera::Camera,
    capsule::{Capsule, Look},
    color::{Linear, linear, mix},
    ink::{Ink, Spot, marked},
    light::Rig,
    normals::{Normals, triangle_normal},
};

/// A surface made ready to be shaded.
pub(crate) struct Surface<'a> {
    pub(crate) body: &'a Body<'a>,
    pub(crate) normals: Normals,
    pub(crate) ink: Ink<'a>,
    pub(crate) marks: Vec<(&'a FaceSet, Linear)>,
    pub(crate) back: Option<Linear>,
    pub(crate) line: Linear,
}

impl<'a> Surface<'a> {
    /// `seen` tells the vertices of triangles that are seen somewhere.
    pub(crate) fn new(
        body: &'a Body<'a>,
        ink: Ink<'a>,
        marks: Vec<(&'a FaceSet, Linear)>,
        seen: &[bool],
    ) -> Self {
        let style = body.style;
        let back = match style.back_faces {
            BackFaces::Colored(color) => Some(linear(color)),
            BackFaces::LikeFront | BackFaces::Hidden => None,
        };
        let line = linear(style.wireframe.color);
        Surface { normals: Normals::new(body, seen), body, ink, marks, back, line }
    }

    /// Whether one sample shows all there is in a pixel it covers.
    pub(crate) fn is_smooth(&self) -> bool {
        self.ink.is_smooth() && self.body.style.wireframe.width <= 0.0
    }
}

/// Light and opacity, the former already multiplied by the latter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    pub(crate) light: Linear,
    pub(crate) alpha: f32,
}

/// What all samples of a picture share.
pub(crate) struct Studio<'b> {
    pub(crate) camera: &'b Camera,
    pub(crate) rig: Rig,
    /// Samples along a pixel.
    pub(crate) pixel: f64,
}

/// A triangle as the camera sees it: barycentric coordinates as ratios of functions that are linear in
/// the picture.
pub(crate) struct Seen {
    /// Constant, per sample to the right, per sample up; of each corner.
    forms: [[f64; 3]; 3],
    sum: [f64; 3],
}

impl Seen {
    /// The triangle with these corners relative to the eye.
    pub(crate) fn new([a, b, c]: [DVec3; 3], camera: &Camera) -> Self {
        let f = camera.focal;
        // Volume of the tetrahedron of the eye, a point of the picture, and a side of the triangle; or
        // area of the triangle of the point and that side.
        let form = |p: DVec3, q: DVec3| {
            if camera.perspective {
                let n = p.cross(q);
                [n.z, -n.x / f, -n.y / f]
            } else {
                [p.x * q.y - p.y * q.x, (p.y - q.y) / f, (q.x - p.x) / f]
            }
        };
        let forms = [form(b, c), form(c, a), form(a, b)];
        let sum = std::array::from_fn(|k| forms[0][k] + forms[1][k] + forms[2][k]);
        Seen { forms, sum }
    }

    /// Barycentric coordinates of what is seen right of and above the middle of the picture, how they
    /// change along the picture, and whether the front is seen. Points beside the triangle get the
    /// nearest corner or side, roughly.
    pub(crate) fn at(&self, x: f64, y: f64) -> ([f64; 3], [[f64; 3]; 2], bool) {
        let value = |form: &[f64; 3]| form[0] + form[1] * x + form[2] * y;
        let sum = value(&self.sum);
        let mut at = self.forms.map(|form| (value(&form) / sum).max(0.0));
        let total = at[0] + at[1] + at[2];
        if !(total.is_finite() && total > 0.0) {
            return ([1.0 / 3.0; 3], [[0.0; 3]; 2], sum > 0.0);
        }
        at = at.map(|w| w / total);
        let slope = |axis: usize| {
            std::array::from_fn(|k| (self.forms[k][axis] - at[k] * self.sum[axis]) / sum)
        };
        (at, [slope(1), slope(2)], sum > 0.0)
    }
}

impl Studio<'_> {
    /// The sample at `(x, y)`, in samples right of and above the middle, on triangle `t` of a surface.
    pub(crate) fn triangle(
        &self,
        surface: &Surface<'_>,
        t: usize,
        seen: &Seen,
        [x, y]: [f64; 2],
        open: f64,
    ) -> Sample {
        let body = surface.body;
        let style = body.style;
        let (at, slopes, front) = seen.at(x, y);
        let spot = Spot {
            face: body.face(t),
            vertices: body.triangles[t],
            corners: if surface.ink.is_at_corners() { body.corners(t) } else { [0; 3] },
            at,
            slopes,
        };
        let mut sample = if style.fill == Fill::Background {
            Sample::default()
        } else {
            let albedo = marked(&surface.marks, spot.face)
                .or(surface.back.filter(|_| !front))
                .unwrap_or_else(|| surface.ink.at(&spot, self.pixel));
            let light = if style.fill == Fill::Flat {
                albedo
            } else {
                let toward = self.toward_viewer(body.points(t), at);
                let n = surface.normals.at(body, t, at);
                let n = facing(if front { n } else { -n }, toward);
                let n = if n == DVec3::ZERO { triangle_normal(body, t) } else { n };
                self.rig.shade(albedo, n, toward, open)
            };
            Sample { light, alpha: 1.0 }
        };
        let cover = self.line_cover(style.wireframe, body.sides(t), &spot);
        if cover > 0.0 {
            sample.light = mix(sample.light, surface.line, cover);
            sample.alpha += (1.0 - sample.alpha) * cover;
        }
        sample
    }

    /// The sample at `(x, y)`, in samples from the upper left, on a line or a point.
    pub(crate) fn capsule(&self, capsule: &Capsule, x: f64, y: f64) -> Sample {
        let toward = self.toward_viewer([capsule.ends[0]; 3], [1.0, 0.0, 0.0]);
        let light = match (capsule.look, capsule.flat(self.camera)) {
            (Look::Line, _) | (_, None) => capsule.color,
            (Look::Surfel(n), _) => {
                let n = DVec3::from_array(n.map(f64::from));
                let n = if n.dot(toward) < 0.0 { -n } else { n };
                self.rig.shade(capsule.color, n, toward, 1.0)
            }
            (Look::Ball, Some(flat)) => {
                let (px, py) = ((x - flat.a[0]) / flat.radius, (flat.a[1] - y) / flat.radius);
                let n = DVec3::new(px, py, (1.0 - px * px - py * py).max(0.0).sqrt());
                self.rig.shade(capsule.color, n.normalize_or_zero(), toward, 1.0)
            }
        };
        Sample { light, alpha: 1.0 }
    }

    /// From a point of a triangle toward the eye.
    fn toward_viewer(&self, [a, b, c]: [DVec3; 3], at: [f64; 3]) -> DVec3 {
        if self.camera.perspective {
            -(at[0] * a + at[1] * b + at[2] * c).normalize_or_zero()
        } else {
            DVec3::Z
        }
    }

    /// How much of a sample the sides of its triangle cover.
    ///
    /// Where triangles are not much larger than lines are wide, lines fade, or all would be black.
    /// Reference: Bærentzen et al., "Single-pass wireframe rendering", SIGGRAPH sketches 2006.
    fn line_cover(&self, stroke: Stroke, sides: u8, spot: &Spot) -> f32 {
        if stroke.width <= 0.0 {
            return 0.0;
        }
        let half = 0.5 * stroke.width * self.pixel;
        let (mut distance, mut height) = (f64::INFINITY, f64::INFINITY);
        for k in 0..3 {
            // Corner k + 2 is the one opposite to the side from corner k on.
            let opposite = (k + 2) % 3;
            let slope = spot.slopes[0][opposite].hypot(spot.slopes[1][opposite]);
            height = height.min(1.0 / slope);
            if sides >> k & 1 == 1 {
                distance = distance.min(spot.at[opposite] / slope);
            }
        }
        let cover = (half + 0.5 - distance).clamp(0.0, 1.0);
        let fade = (height / (7.0 * half)).clamp(0.2, 1.0);
        (cover * fade * f64::from(stroke.color.0[3])) as f32
    }
}

/// A normal that does not point away from the viewer: interpolated ones do near outlines.
fn facing(n: DVec3, toward: DVec3) -> DVec3 {
    let away = n.dot(toward);
    if away >= 0.0 { n } else { (n - away * toward).normalize_or_zero() }
}
