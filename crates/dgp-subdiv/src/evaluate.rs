//! Exact evaluation: the limit surface at any point of a face, with its derivatives.
//!
//! ```text
//! regular face    position = Σ b_i(u, v) p_i     16 bicubic B-splines, or 12 box splines of degree 4
//! other face      split the face and what is around it; go on with the part that holds the point
//! ```
//!
//! A part that touches no irregular vertex and nothing sharp is regular, so a point at the distance 2⁻ᵏ from
//! such things takes k splits. Stam takes them all at once, as powers of eigenvalues; step by step the same
//! sums are formed, and creases need no cases of their own.
//!
//! - Input: a quadrilateral for Catmull–Clark, (u, v) being (0, 0), (1, 0), (1, 1), (0, 1) at its corners; a
//!   triangle for Loop, (0, 0), (1, 0), (0, 1).
//! - Cost: a patch of 12 or 16 points where regular, and per split a step of some 40 points.
//! - Guarantees: positions exact up to rounding.
//! - Reference: Stam, "Exact evaluation of Catmull–Clark subdivision surfaces at arbitrary parameter values",
//!   SIGGRAPH 1998, and "Evaluation of Loop subdivision surfaces", SIGGRAPH 1998 course notes (the box
//!   splines).
//! - Departs from it: splits in place of eigenvectors; after 26 of them the part is as small as the square
//!   root of the precision, its limit corners are interpolated, and derivatives have half the digits.

use dgp_mesh::FaceId;

use crate::{
    Error, RefinementPlan,
    limit::{Limit, LimitMasks},
    masks::{self, Masks, Stencil, Value},
    plan::Level,
    primal::{Kind, Primal},
    sharpness::Creases,
    split::{split_polygons, split_triangles},
    stencil::check_length,
    topology::{NONE, Topology},
};

/// Splits after which interpolation errs by less than rounding: the square of 2⁻²⁶.
const SPLITS: usize = 26;

/// A point of the limit surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<T> {
    /// Where it is, or what the data are there.
    pub value: T,
    /// The derivatives with respect to u and v. At irregular vertices they vanish or grow beyond all
    /// bounds; [`RefinementPlan::limit_tangents`] has tangents there.
    pub derivatives: [T; 2],
}

impl RefinementPlan {
    /// The limit surface at the point (u, v) of a face of the last level, given the values at its vertices.
    ///
    /// Errors: [`Error::NoLimit`] unless the scheme is Loop or Catmull–Clark; [`Error::NotQuad`] if the
    /// face is no quadrilateral where it must be; [`Error::InvalidOption`] if the point is outside of the
    /// face; [`Error::WrongLength`].
    ///
    /// # Panics
    /// If there is no such face.
    pub fn evaluate<T: Value>(
        &self,
        values: &[T],
        face: FaceId,
        [u, v]: [f64; 2],
    ) -> Result<SurfacePoint<T>, Error> {
        let Level { topology, creases, .. } = self.last();
        check_length("vertex of the last level", values.len(), topology.vertex_count())?;
        let scheme = self.options().scheme;
        let kind = match Kind::of(scheme) {
            Some(kind) if kind != Kind::Bilinear => kind,
            _ => return Err(Error::NoLimit { scheme: scheme.name() }),
        };
        let degree = topology.corners(face.index() as u32).len();
        if kind == Kind::CatmullClark && degree != 4 {
            return Err(Error::NotQuad { face, degree });
        }
        let largest = if kind == Kind::CatmullClark { 1.0 } else { 1.0 - u };
        for (name, value, largest) in [("u", u, 1.0), ("v", v, largest)] {
            if !(0.0..=largest).contains(&value) {
                return Err(Error::InvalidOption { name, value, expected: "inside the face" });
            }
        }
        let part = Part::around(topology, creases, values, face.index() as u32, kind);
        Ok(part.evaluate([u, v]))
    }
}

/// A face with all faces that touch it.
struct Part<T> {
    kind: Kind,
    topology: Topology,
    creases: Creases,
    values: Vec<T>,
    face: u32,
}

impl<T: Value> Part<T> {
    /// The surroundings of a face. What is at their rim is not that of the surface, but reaches the face
    /// in no later step either, since only its own surroundings are kept each time.
    fn around(topology: &Topology, creases: &Creases, values: &[T], face: u32, kind: Kind) -> Self {
        let mut faces = vec![face];
        let mut spokes = Vec::new();
        for c in topology.corners(face) {
            topology.spokes(topology.vertex(c) as usize, &mut spokes);
            let corners = spokes.iter().map(|&h| topology.corner(h)).filter(|&c| c != NONE);
            for f in corners.map(|c| topology.face(c)) {
                if !faces.contains(&f) {
                    faces.push(f);
                }
            }
        }
        let (local, vertices, edges) = topology.part(&faces);
        let edges = edges.iter().map(|&e| creases.edge(topology, e as usize)).collect();
        let sharp = vertices.iter().map(|&v| creases.vertex(v as usize)).collect();
        Part {
            kind,
            topology: local,
            creases: Creases::listed(edges, sharp),
            values: vertices.iter().map(|&v| values[v as usize]).collect(),
            face: 0,
        }
    }

    fn evaluate(self, mut at: [f64; 2]) -> SurfacePoint<T> {
        let mut part = self;
        // Derivatives of the coordinates in the part by those in the face.
        let mut chain = [[1.0, 0.0], [0.0, 1.0]];
        for _ in 0..SPLITS {
            if let Some(points) = part.regular() {
                return part.spline(&points, at, chain);
            }
            let (child, map) = part.child(at);
            at = [0, 1].map(|i| map[i][0] * at[0] + map[i][1] * at[1] + map[i][2]);
            // Rounding may leave the part by a little.
            at = at.map(|x| x.clamp(0.0, 1.0));
            chain =
                [0, 1].map(|i| [0, 1].map(|j| map[i][0] * chain[0][j] + map[i][1] * chain[1][j]));
            part = part.split(child);
        }
        part.interpolated(at, chain)
    }

    /// The split part around a child of the face.
    fn split(&self, child: u32) -> Self {
        let masks = Primal::new(&self.topology, &self.creases, self.kind);
        let values = masks::apply(&masks, &self.values);
        let (topology, face) = match self.kind {
            Kind::Loop(_) => (split_triangles(&self.topology), 4 * self.face + child),
            Kind::CatmullClark | Kind::Bilinear => {
                (split_polygons(&self.topology), self.topology.corners(self.face).start + child)
            }
        };
        Part::around(&topology, &self.creases.refined(), &values, face, self.kind)
    }

    /// Which child of the face holds a point, and the rows (a, b, c) with which its coordinates there are
    /// a u + b v + c.
    fn child(&self, [u, v]: [f64; 2]) -> (u32, [[f64; 3]; 2]) {
        match self.kind {
            Kind::Loop(_) => {
                if u + v <= 0.5 {
                    (0, [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
                } else if u >= 0.5 {
                    (1, [[0.0, 2.0, 0.0], [-2.0, -2.0, 2.0]])
                } else if v >= 0.5 {
                    (2, [[-2.0, -2.0, 2.0], [2.0, 0.0, 0.0]])
                } else {
                    (3, [[2.0, 2.0, -1.0], [-2.0, 0.0, 1.0]])
                }
            }
            Kind::CatmullClark | Kind::Bilinear => match (u >= 0.5, v >= 0.5) {
                (false, false) => (0, [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]),
                (true, false) => (1, [[0.0, 2.0, 0.0], [-2.0, 0.0, 2.0]]),
                (true, true) => (2, [[-2.0, 0.0, 2.0], [0.0, -2.0, 2.0]]),
                (false, true) => (3, [[0.0, -2.0, 2.0], [2.0, 0.0, 0.0]]),
            },
        }
    }

    /// The vertices of the patch, if the face is regular.
    fn regular(&self) -> Option<Vec<u32>> {
        let topology = &self.topology;
        let valence = if self.kind == Kind::CatmullClark { 4 } else { 6 };
        let mut points = Vec::new();
        let mut spokes = Vec::new();
        for corner in topology.corners(self.face) {
            let v = topology.vertex(corner);
            let closed = topology.spokes(v as usize, &mut spokes);
            let is_sharp = |h: &u32| self.creases.edge(topology, *h as usize / 2) > 0.0;
            let is_quad = |h: &u32| topology.corners(topology.face(topology.corner(*h))).len() == 4;
            if !closed
                || spokes.len() != valence
                || self.creases.vertex(v as usize) > 0.0
                || spokes.iter().any(is_sharp)
                || valence == 4 && !spokes.iter().all(is_quad)
            {
                return None;
            }
            // From the side of the face on.
            let first = topology.corner_halfedge[corner as usize];
            let first = spokes.iter().position(|&h| h == first).expect("it leaves the vertex");
            spokes.rotate_left(first);
            points.push(v);
            let to = |k: usize| topology.to(spokes[k]);
            if valence == 4 {
                // Behind the corner: away from the side, across, away from the side before.
                let across = topology.next(topology.next(topology.corner(spokes[2])));
                points.extend([to(2), topology.vertex(across), to(3)]);
            } else {
                points.extend([to(3), to(4), to(5)]);
            }
        }
        Some(points)
    }

    fn spline(&self, points: &[u32], [u, v]: [f64; 2], chain: [[f64; 2]; 2]) -> SurfacePoint<T> {
        let weights = match self.kind {
            Kind::Loop(_) => box_splines(u, v),
            Kind::CatmullClark | Kind::Bilinear => bicubic_splines(u, v),
        };
        let sum = |k: usize| {
            let terms = points.iter().zip(&weights);
            terms.fold(T::default(), |sum, (&p, w)| sum + self.values[p as usize] * w[k])
        };
        with_chain(sum(0), [sum(1), sum(2)], chain)
    }

    /// Between the limits of the corners.
    fn interpolated(&self, [u, v]: [f64; 2], chain: [[f64; 2]; 2]) -> SurfacePoint<T> {
        let limits = LimitMasks {
            topology: &self.topology,
            creases: &self.creases,
            kind: self.kind,
            what: Limit::Position,
        };
        let corner = |c: u32| {
            let mut stencil = Stencil::default();
            limits.row(self.topology.vertex(c) as usize, &mut stencil);
            masks::spell_out(&self.topology, &mut stencil.entries);
            let terms = stencil.entries.iter();
            terms.fold(T::default(), |sum, &(p, w)| sum + self.values[p as usize] * w)
        };
        let corners: Vec<T> = self.topology.corners(self.face).map(corner).collect();
        let sum = |weights: &[f64]| {
            corners.iter().zip(weights).fold(T::default(), |sum, (&p, &w)| sum + p * w)
        };
        let (value, du, dv) = if corners.len() == 3 {
            (sum(&[1.0 - u - v, u, v]), sum(&[-1.0, 1.0]), sum(&[-1.0, 0.0, 1.0]))
        } else {
            (
                sum(&[(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]),
                sum(&[v - 1.0, 1.0 - v, v, -v]),
                sum(&[u - 1.0, -u, u, 1.0 - u]),
            )
        };
        with_chain(value, [du, dv], chain)
    }
}

/// Derivatives by the coordinates of the face, from those by the coordinates of a part.
fn with_chain<T: Value>(value: T, inner: [T; 2], chain: [[f64; 2]; 2]) -> SurfacePoint<T> {
    let derivatives = [0, 1].map(|j| inner[0] * chain[0][j] + inner[1] * chain[1][j]);
    SurfacePoint { value, derivatives }
}

/// The weights of the points of a bicubic patch and their derivatives: of each corner itself, then what is
/// away from its side, across, away from the side before.
fn bicubic_splines(u: f64, v: f64) -> Vec<[f64; 3]> {
    let ([bu, du], [bv, dv]) = (cubic_splines(u), cubic_splines(v));
    let mut weights = Vec::with_capacity(16);
    // Corner, and the direction of the side that starts there.
    for ([x, y], [dx, dy]) in
        [([1, 1], [1, 0]), ([2, 1], [0, 1]), ([2, 2], [-1, 0]), ([1, 2], [0, -1])]
    {
        // The side before comes from a quarter turn to the left.
        let (away, before) = ([-dx, -dy], [dy, -dx]);
        for [ox, oy] in [[0, 0], away, [away[0] + before[0], away[1] + before[1]], before] {
            let (i, j) = ((x + ox) as usize, (y + oy) as usize);
            weights.push([bu[i] * bv[j], du[i] * bv[j], bu[i] * dv[j]]);
        }
    }
    weights
}

/// The four cubic B-splines on an interval, and their derivatives.
fn cubic_splines(t: f64) -> [[f64; 4]; 2] {
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            2.0 / 3.0 - t * t * (2.0 - t) / 2.0,
            2.0 / 3.0 - s * s * (2.0 - s) / 2.0,
            t * t * t / 6.0,
        ],
        [-s * s / 2.0, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, t * t / 2.0],
    ]
}

/// The weights of the points of a box-spline patch and their derivatives: of each corner itself, then of
/// its three neighbors behind it: away from the side that starts there, straight back, beside that side.
///
/// In barycentric coordinates, a at the corner, b and c at the next ones; times 12.
fn box_splines(u: f64, v: f64) -> Vec<[f64; 3]> {
    /// Factor and exponents of a, b, c.
    type Terms = &'static [(f64, [i32; 3])];
    const CORNER: Terms = &[
        (6.0, [4, 0, 0]),
        (24.0, [3, 1, 0]),
        (24.0, [3, 0, 1]),
        (24.0, [2, 2, 0]),
        (60.0, [2, 1, 1]),
        (24.0, [2, 0, 2]),
        (8.0, [1, 3, 0]),
        (36.0, [1, 2, 1]),
        (36.0, [1, 1, 2]),
        (8.0, [1, 0, 3]),
        (1.0, [0, 4, 0]),
        (6.0, [0, 3, 1]),
        (12.0, [0, 2, 2]),
        (6.0, [0, 1, 3]),
        (1.0, [0, 0, 4]),
    ];
    const FAR_FROM_B: Terms = &[(1.0, [4, 0, 0]), (2.0, [3, 0, 1])];
    const FAR_FROM_C: Terms = &[(1.0, [4, 0, 0]), (2.0, [3, 1, 0])];
    const ACROSS_AB: Terms = &[
        (1.0, [4, 0, 0]),
        (6.0, [3, 1, 0]),
        (12.0, [2, 2, 0]),
        (6.0, [1, 3, 0]),
        (1.0, [0, 4, 0]),
        (2.0, [3, 0, 1]),
        (6.0, [2, 1, 1]),
        (6.0, [1, 2, 1]),
        (2.0, [0, 3, 1]),
    ];
    let at = [1.0 - u - v, u, v];
    let mut weights = Vec::with_capacity(12);
    for k in 0..3 {
        let turned = [0, 1, 2].map(|i| at[(k + i) % 3]);
        for terms in [CORNER, FAR_FROM_B, FAR_FROM_C, ACROSS_AB] {
            let power = |x: f64, n: i32| if n < 0 { 0.0 } else { x.powi(n) };
            let product =
                |n: [i32; 3]| -> f64 { turned.iter().zip(n).map(|(&x, n)| power(x, n)).product() };
            let value: f64 = terms.iter().map(|&(factor, n)| factor * product(n)).sum();
            // By a, b and c as if they were independent.
            let slope = [0, 1, 2].map(|i| {
                let term = |&(factor, mut n): &(f64, [i32; 3])| {
                    let exponent = f64::from(n[i]);
                    n[i] -= 1;
                    if exponent == 0.0 { 0.0 } else { factor * exponent * product(n) }
                };
                terms.iter().map(term).sum::<f64>()
            });
            // Where the coordinates of the patch are among the turned ones.
            let [du, dv] = [1, 2].map(|j| slope[(j + 3 - k) % 3] - slope[(3 - k) % 3]);
            weights.push([value, du, dv].map(|x| x / 12.0));
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the points of a patch are if it is flat and regular, in its own coordinates.
    fn places(valence: usize) -> Vec<[f64; 2]> {
        let corners: &[[f64; 2]] = if valence == 4 {
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        } else {
            &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
        };
        let n = corners.len();
        let mut places = Vec::new();
        for k in 0..n {
            let [p, q, r] = [corners[k], corners[(k + 1) % n], corners[(k + n - 1) % n]];
            let at = |i: f64, j: f64| [0, 1].map(|x| p[x] + i * (q[x] - p[x]) + j * (r[x] - p[x]));
            if valence == 4 {
                places.extend([p, at(-1.0, 0.0), at(-1.0, -1.0), at(0.0, -1.0)]);
            } else {
                places.extend([p, at(-1.0, 0.0), at(0.0, -1.0), at(1.0, -1.0)]);
            }
        }
        places
    }

    #[test]
    fn splines_reproduce_what_is_linear() {
        for (valence, splines) in [
            (4, bicubic_splines as fn(f64, f64) -> Vec<[f64; 3]>),
            (6, box_splines as fn(f64, f64) -> Vec<[f64; 3]>),
        ] {
            for (u, v) in [(0.0, 0.0), (0.3, 0.6), (1.0, 0.0), (0.25, 0.5), (0.1, 0.05)] {
                let weights = splines(u, v);
                let places = places(valence);
                assert_eq!(weights.len(), places.len());
                let sum = |k: usize, f: &dyn Fn([f64; 2]) -> f64| -> f64 {
                    weights.iter().zip(&places).map(|(w, &p)| w[k] * f(p)).sum()
                };
                let [one, x, y]: [&dyn Fn([f64; 2]) -> f64; 3] = [&|_| 1.0, &|p| p[0], &|p| p[1]];
                let found = [one, x, y].map(|f| [sum(0, f), sum(1, f), sum(2, f)]);
                let expected = [[1.0, 0.0, 0.0], [u, 1.0, 0.0], [v, 0.0, 1.0]];
                for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                    assert!((found - expected).abs() < 1e-15 * 8.0, "{valence} {u} {v} {found}");
                }
            }
        }
    }
}
