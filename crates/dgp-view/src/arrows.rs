//! Vectors as arrows: a thin cylinder with a cone.

use std::f64::consts::TAU;

use dgp_mesh::DVec3;

use crate::{
    ArrowLength, Arrows, Error, Model, Vectors,
    body::{Body, Frame},
    color::{Linear, linear},
    ink::Place,
    lines::spacing,
};

/// Sides of the cylinder and the cone.
const SIDES: usize = 8;
/// Radii of cylinder and cone and length of the cone, as fractions of the length of the longest arrow.
const SHAFT: f64 = 0.035;
const HEAD: f64 = 0.10;
const HEAD_LENGTH: f64 = 0.30;
/// How long the longest arrow is, as a multiple of the spacing of the elements.
const REACH: f64 = 1.6;

/// The arrows of a model as bodies in view coordinates, with their colors.
pub(crate) fn arrow_bodies(
    model: &Model<'_>,
    body: &Body<'_>,
    frame: &Frame,
    place: Place,
) -> Result<Vec<(Body<'static>, Linear)>, Error> {
    let arrows = model.style.arrows.iter();
    arrows
        .map(|arrows| Ok((one_body(model, body, frame, arrows, place)?, linear(arrows.color))))
        .collect()
}

fn one_body(
    model: &Model<'_>,
    body: &Body<'_>,
    frame: &Frame,
    arrows: &Arrows,
    place: Place,
) -> Result<Body<'static>, Error> {
    let (starts, vectors) = match &arrows.vectors {
        Vectors::Vertices(vectors) => {
            let count = model.shape.vertex_count();
            place.check_count("vectors", "vertex", vectors.len(), count)?;
            (body.positions.clone(), vectors.values())
        }
        Vectors::Faces(vectors) => {
            place.check_count("vectors", "face", vectors.len(), model.shape.face_count())?;
            (face_centers(body), vectors.values())
        }
    };
    let drawn = |(&p, &v): (&DVec3, &DVec3)| (p.x.is_finite() && v.is_finite()).then_some((p, v));
    let drawn: Vec<_> = starts.iter().zip(vectors).filter_map(drawn).collect();
    let longest = drawn.iter().map(|(_, v)| v.abs().max_element()).fold(0.0, f64::max);
    if longest <= 0.0 {
        return Ok(Body::plain(Vec::new(), Vec::new()));
    }
    // Vectors may be of any unit: they are measured against the longest before anything is squared.
    let unit = |v: DVec3| frame.basis.view(model.placement.linear * (v / longest));
    let reach = drawn.iter().map(|&(_, v)| unit(v).length()).fold(0.0, f64::max);
    let length = match arrows.length {
        ArrowLength::BySpacing => REACH * spacing(&starts),
        ArrowLength::Times(factor) => frame.power.scale_length(factor * longest) * reach,
    };
    if !length.is_finite() || length == 0.0 || reach <= 0.0 {
        return Ok(Body::plain(Vec::new(), Vec::new()));
    }
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (p, v) in drawn {
        let along = unit(v) * (length / reach);
        if along.is_finite() && along != DVec3::ZERO {
            add_arrow(p, along, length.abs(), &mut positions, &mut triangles);
        }
    }
    Ok(Body::plain(positions, triangles))
}

/// The mean of the corners of each face, seen through its triangles; NaN for faces without any.
fn face_centers(body: &Body<'_>) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); body.shape.face_count()];
    for t in 0..body.triangles.len() {
        let sum = &mut sums[body.face(t)];
        *sum = (sum.0 + body.points(t).into_iter().sum::<DVec3>() / 3.0, sum.1 + 1.0);
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// An arrow from `p` to `p + along`; `longest` decides how thick it is.
fn add_arrow(
    p: DVec3,
    along: DVec3,
    longest: f64,
    positions: &mut Vec<DVec3>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let length = along.length();
    let axis = along / length;
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    // Short arrows are thinner, or they would be discs.
    let size = longest.min(2.0 * length);
    let neck = p + axis * (length - HEAD_LENGTH * size);
    let first = positions.len() as u32;
    for (center, radius) in [(p, SHAFT), (neck, SHAFT), (neck, HEAD)] {
        positions.extend((0..SIDES).map(|i| {
            let (y, x) = (TAU * i as f64 / SIDES as f64).sin_cos();
            center + radius * size * (x * side + y * up)
        }));
    }
    positions.extend([p + along, neck, p]);
    let sides = SIDES as u32;
    let (tip, middle, start) = (first + 3 * sides, first + 3 * sides + 1, first + 3 * sides + 2);
    for i in 0..sides {
        let j = (i + 1) % sides;
        let at = |ring: u32, k: u32| first + ring * sides + k;
        triangles.extend([
            [at(0, i), at(0, j), at(1, j)],
            [at(0, i), at(1, j), at(1, i)],
            [at(2, i), at(2, j), tip],
            [middle, at(2, j), at(2, i)],
            [start, at(0, j), at(0, i)],
        ]);
    }
}
