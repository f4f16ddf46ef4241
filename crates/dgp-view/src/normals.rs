//! Normals for smooth shading: means over the faces around a vertex, but not across sharp edges.
//!
//! ```text
//! n(t, v) ∝ Σ α(s, v) n(s)   over the triangles s at v with ∠(n(s), n(t)) < crease angle
//! ```
//!
//! with α(s, v) the angle of s at v. Where all triangles at a vertex are within half the crease angle
//! of the mean, the sum is the same for each of them and is kept once.
//!
//! - Input: any triangles, and the vertices whose normals are wanted: those of triangles that are seen.
//! - Cost: O(T), and O(k²) at a sharp vertex of k triangles; flat beyond [`MOST_AROUND`].
//! - Reference: Thürmer, Wüthrich, "Computing vertex normals from polygonal facets", Journal of
//!   Graphics Tools 3(1), 1998, for the weights.

use dgp_mesh::{DVec3, FaceId, VertexId, parallel};

use crate::{Shading, body::Body};

/// A unit normal, or zero; digits beyond single precision cannot be seen.
type Normal = [f32; 3];

/// The most triangles around a sharp vertex that are compared with each other.
const MOST_AROUND: usize = 256;

/// The normals of a surface.
pub(crate) enum Normals {
    /// Those of the triangles.
    Flat,
    /// Those of polygons, by face.
    Polygons(Vec<Normal>),
    /// One for each vertex, then those of corners at sharp edges; `corners` tells which belong to a
    /// triangle, its vertices if empty.
    Smooth { normals: Vec<Normal>, corners: Vec<[u32; 3]> },
}

impl Normals {
    /// Those of vertices that are not `wanted` may be anything.
    pub(crate) fn new(body: &Body<'_>, wanted: &[bool]) -> Self {
        match body.style.shading {
            Shading::Flat => flat(body),
            Shading::Smooth { crease_angle } => smooth(body, wanted, crease_angle),
        }
    }

    /// The normal of triangle `t` at the point with these barycentric coordinates, perhaps zero.
    #[inline]
    pub(crate) fn at(&self, body: &Body<'_>, t: usize, barycentric: [f64; 3]) -> DVec3 {
        match self {
            Normals::Flat => triangle_normal(body, t),
            Normals::Polygons(normals) => to_f64(normals[body.face(t)]),
            Normals::Smooth { normals, corners } => {
                let at = corners.get(t).unwrap_or(&body.triangles[t]);
                let mut n = DVec3::ZERO;
                for k in 0..3 {
                    n += barycentric[k] * to_f64(normals[at[k] as usize]);
                }
                if n == DVec3::ZERO { triangle_normal(body, t) } else { n.normalize_or_zero() }
            }
        }
    }
}

/// The unit normal of triangle `t`, zero if it has no area.
#[inline]
pub(crate) fn triangle_normal(body: &Body<'_>, t: usize) -> DVec3 {
    let [a, b, c] = body.points(t);
    direction((b - a).cross(c - a))
}

/// The unit vector along `v`; zero if it has none or is no vector. Does not underflow.
fn direction(v: DVec3) -> DVec3 {
    let size = v.abs().max_element();
    if size > 0.0 && size.is_finite() { (v / size).normalize() } else { DVec3::ZERO }
}

/// Where polygons were cut, the sum over their pieces; a bent polygon would look folded otherwise.
fn flat(body: &Body<'_>) -> Normals {
    if let crate::body::Origin::Faces = body.origin {
        return Normals::Flat;
    }
    let mut sums = vec![DVec3::ZERO; body.shape.face_count()];
    for t in 0..body.triangles.len() {
        let [a, b, c] = body.points(t);
        let cross = (b - a).cross(c - a);
        if cross.is_finite() {
            sums[body.face(t)] += cross;
        }
    }
    Normals::Polygons(sums.into_iter().map(|n| direction(n).as_vec3().to_array()).collect())
}

fn smooth(body: &Body<'_>, wanted: &[bool], crease_angle: f64) -> Normals {
    let fan = |t: FaceId| Fan::new(body, t.index(), wanted);
    let fans = parallel::map(body.triangles.len(), fan);
    let fans = fans.values();
    // One pass in order: threads that add to the same vertices would have to wait for each other.
    let mut sums = vec![[0.0_f32; 3]; body.positions.len()];
    for (triangle, fan) in body.triangles.iter().zip(fans) {
        if fan.angles == [0.0; 3] {
            continue;
        }
        for (&v, &weight) in triangle.iter().zip(&fan.angles) {
            let sum = &mut sums[v as usize];
            for (x, n) in sum.iter_mut().zip(fan.normal) {
                *x += weight * n;
            }
        }
    }
    let unit = |v: VertexId| normalized(sums[v.index()]);
    let mut normals = parallel::map(sums.len(), unit).into_values();
    let corners = split_creases(body, fans, &mut normals, crease_angle);
    Normals::Smooth { normals, corners }
}

/// Gives the triangles at sharp vertices normals of their own; empty if there are none.
fn split_creases(
    body: &Body<'_>,
    fans: &[Fan],
    normals: &mut Vec<Normal>,
    crease_angle: f64,
) -> Vec<[u32; 3]> {
    if crease_angle >= std::f64::consts::PI {
        return Vec::new();
    }
    let near = (0.5 * crease_angle).cos() as f32;
    let blocks = parallel::map_blocks(fans.len(), parallel::BLOCK, |range| {
        let corners = range.flat_map(|t| (0..3).map(move |k| (t, k)));
        let apart = |&(t, k): &(usize, usize)| {
            let v = body.triangles[t][k];
            dot(fans[t].normal, normals[v as usize]) < near && fans[t].angles[k] > 0.0
        };
        corners.filter(apart).map(|(t, k)| body.triangles[t][k]).collect::<Vec<u32>>()
    });
    let mut sharp: Vec<u32> = blocks.concat();
    if sharp.is_empty() {
        return Vec::new();
    }
    sharp.sort_unstable();
    sharp.dedup();
    let mut rank = vec![u32::MAX; body.positions.len()];
    for (i, &v) in sharp.iter().enumerate() {
        rank[v as usize] = i as u32;
    }
    // All corners at sharp vertices, sorted by vertex, each vertex's in the order of triangles.
    let mut around: Vec<(u32, u32, u32)> = Vec::new();
    for (t, triangle) in body.triangles.iter().enumerate() {
        for k in 0..3 {
            let r = rank[triangle[k] as usize];
            if r != u32::MAX && fans[t].angles[k] > 0.0 {
                around.push((r, t as u32, k as u32));
            }
        }
    }
    around.sort_unstable();
    let limit = crease_angle.cos() as f32;
    let mut corners = body.triangles.to_vec();
    for at_vertex in around.chunk_by(|a, b| a.0 == b.0) {
        for &(_, t, k) in at_vertex {
            let own = fans[t as usize].normal;
            let mut sum = [0.0_f32; 3];
            for &(_, s, l) in at_vertex.iter().take(MOST_AROUND) {
                let fan = &fans[s as usize];
                if at_vertex.len() <= MOST_AROUND && dot(own, fan.normal) > limit {
                    (0..3).for_each(|x| sum[x] += fan.angles[l as usize] * fan.normal[x]);
                }
            }
            let normal = normalized(sum);
            corners[t as usize][k as usize] = normals.len() as u32;
            normals.push(if normal == [0.0; 3] { own } else { normal });
        }
    }
    corners
}

/// The normal and the angles of a triangle at wanted vertices, zero if it has no area.
struct Fan {
    normal: Normal,
    angles: [f32; 3],
}

impl Fan {
    const NONE: Fan = Fan { normal: [0.0; 3], angles: [0.0; 3] };

    fn new(body: &Body<'_>, t: usize, wanted: &[bool]) -> Self {
        let wanted = body.triangles[t].map(|v| wanted[v as usize]);
        if wanted == [false; 3] {
            return Fan::NONE;
        }
        let [a, b, c] = body.points(t);
        let sides = [b - a, c - b, a - c].map(direction);
        let normal = direction((b - a).cross(c - a));
        if normal == DVec3::ZERO {
            return Fan::NONE;
        }
        let angle = |k: usize| {
            if wanted[k] { angle(-sides[(k + 2) % 3].dot(sides[k]) as f32) } else { 0.0 }
        };
        Fan { normal: normal.as_vec3().to_array(), angles: [angle(0), angle(1), angle(2)] }
    }
}

/// The angle whose cosine is `x`, to 7e-5: enough for a weight, and the same on every machine.
/// Abramowitz, Stegun, *Handbook of Mathematical Functions*, 4.4.45.
fn angle(x: f32) -> f32 {
    let y = x.abs().min(1.0);
    let root = (1.0 - y).sqrt();
    let angle = root * (1.570_728_8 + y * (-0.212_114_4 + y * (0.074_261 - 0.018_729_3 * y)));
    // Never zero, so that a weight tells a triangle with an area from one without.
    (if x < 0.0 { std::f32::consts::PI - angle } else { angle }).max(1e-4)
}

fn dot(a: Normal, b: Normal) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn normalized(n: Normal) -> Normal {
    let length = dot(n, n).sqrt();
    if length > 1e-12 { n.map(|x| x / length) } else { [0.0; 3] }
}

fn to_f64(n: Normal) -> DVec3 {
    DVec3::from_array(n.map(f64::from))
}
