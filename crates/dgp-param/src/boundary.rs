//! The boundary of a surface on a convex shape, by arc length.
//!
//! ```text
//! ψ_i = 2π (l_1 + … + l_i) / (l_1 + … + l_n)       l: lengths of the edges of the boundary
//! ```
//!
//! On a polygon the vertices nearest to its corners, by arc length, go there; between two corners lengths
//! are in proportion.
//!
//! - Input: a boundary loop of positive length.
//! - Cost: O(n) for n vertices, O(n + k) with k corners.
//! - Reference: Floater, "Parametrization and smooth approximation of surface triangulations", 1997.

use dgp_mesh::{DVec2, Mesh, VertexId};

use crate::{Error, disk::check_boundary};

/// A convex shape in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Outline {
    /// The circle around (½, ½) with radius ½, from the right on.
    #[default]
    Circle,
    /// The square from (0, 0) to (1, 1), from its lower left corner on.
    Square,
    /// A convex polygon, counterclockwise.
    Polygon(Vec<DVec2>),
}

/// Where the vertices of `boundary`, a loop as [`disk_boundary`](crate::disk_boundary) gives it, go on
/// `outline`: in order, each step in proportion to the length of its edge.
///
/// The first vertex goes to the start of the outline. A side of a polygon that has no vertex between its ends
/// is fine; triangles all of whose corners come to lie on one side have no area afterwards.
///
/// Errors: [`Error::NotBoundary`], [`Error::NoLength`], [`Error::NotConvex`], [`Error::TooFewVertices`].
pub fn convex_boundary(
    mesh: &Mesh,
    boundary: &[VertexId],
    outline: &Outline,
) -> Result<Vec<DVec2>, Error> {
    check_boundary(mesh, boundary)?;
    let n = boundary.len();
    let step = |i: usize| mesh.position(boundary[i]).distance(mesh.position(boundary[(i + 1) % n]));
    let mut along = Vec::with_capacity(n);
    let mut length = 0.0;
    for i in 0..n {
        along.push(length);
        length += step(i);
    }
    if !(length > 0.0 && length.is_finite()) {
        return Err(Error::NoLength { length });
    }
    let parts: Vec<f64> = along.iter().map(|along| along / length).collect();
    match outline {
        Outline::Circle => Ok(parts
            .iter()
            .map(|part| 0.5 * (DVec2::ONE + DVec2::from_angle(std::f64::consts::TAU * part)))
            .collect()),
        Outline::Square => {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from);
            on_polygon(&parts, &corners)
        }
        Outline::Polygon(corners) => {
            check_convex(corners)?;
            on_polygon(&parts, corners)
        }
    }
}

/// An error unless each corner turns left and the polygon goes around once.
fn check_convex(corners: &[DVec2]) -> Result<(), Error> {
    let n = corners.len();
    let side = |i: usize| corners[(i + 1) % n] - corners[i % n];
    let turn = |i: usize| side(i + n - 1).perp_dot(side(i));
    match (0..n).find(|&i| turn(i) <= 0.0 || turn(i).is_nan()) {
        Some(corner) => Err(Error::NotConvex { corner }),
        None if n < 3 => Err(Error::NotConvex { corner: 0 }),
        None => {
            // A star turns left everywhere too, but more than once.
            let angle: f64 = (0..n).map(|i| side(i + n - 1).angle_to(side(i))).sum();
            let once = angle < 1.5 * std::f64::consts::TAU;
            if once { Ok(()) } else { Err(Error::NotConvex { corner: 0 }) }
        }
    }
}

/// Points at these parts of the way around a polygon, some of which go to its corners.
fn on_polygon(parts: &[f64], corners: &[DVec2]) -> Result<Vec<DVec2>, Error> {
    let (n, k) = (parts.len(), corners.len());
    if n < k {
        return Err(Error::TooFewVertices { vertices: n, corners: k });
    }
    let sides: Vec<f64> = (0..k).map(|i| corners[i].distance(corners[(i + 1) % k])).collect();
    let total: f64 = sides.iter().sum();
    // The vertex of each corner: the nearest by arc length that leaves enough for the others.
    let mut at = vec![0; k + 1];
    at[k] = n;
    let mut done = 0.0;
    for i in 1..k {
        done += sides[i - 1] / total;
        let (first, last) = (at[i - 1] + 1, n - (k - i));
        let after = parts.partition_point(|&part| part < done).clamp(first, last);
        let before = (after - 1).clamp(first, last);
        at[i] = if done - parts[before] <= parts[after] - done { before } else { after };
    }
    let part = |i: usize| if i == n { 1.0 } else { parts[i] };
    let mut points = Vec::with_capacity(n);
    for (i, corner) in corners.iter().enumerate() {
        let (start, end) = (at[i], at[i + 1]);
        let span = part(end) - part(start);
        let next = corners[(i + 1) % k];
        points.extend((start..end).map(|j| {
            // Where edges have no length vertices are spaced evenly.
            let t = if span > 0.0 {
                (part(j) - part(start)) / span
            } else {
                (j - start) as f64 / (end - start) as f64
            };
            corner.lerp(next, t)
        }));
    }
    Ok(points)
}
