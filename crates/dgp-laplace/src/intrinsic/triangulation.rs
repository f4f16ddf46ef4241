//! Triangles known by the lengths of their sides alone, glued side to side.
//!
//! An edge may join a vertex to itself, two edges may join the same vertices, and the faces at a vertex may
//! form several fans: flips lead there, and so do tufted covers.

use dgp_mesh::{
    Connectivity, EdgeMap, Mesh, VertexMap,
    measure::{edge_lengths, require_triangles},
};
use dgp_sparse::SparseMatrix;

use crate::{Error, unit::power_of_two_below};

/// No side lies across: a rim.
const NONE: u32 = u32::MAX;

/// A surface made of flat triangles, which is nowhere: only lengths are known.
///
/// Triangle t has the sides 3t, 3t + 1 and 3t + 2, each leading from one of its corners to the next.
///
/// ```
/// use dgp_laplace::intrinsic::IntrinsicTriangulation;
/// use dgp_mesh::{Progress, shapes};
///
/// let mut surface = IntrinsicTriangulation::of_mesh(&shapes::trefoil(40, 8)?)?;
/// let flips = surface.flip_to_delaunay(Progress::NONE)?;
/// assert!(flips > 0 && surface.least_weight().unwrap() > -1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct IntrinsicTriangulation {
    vertex_count: usize,
    /// The vertex each side leads from.
    from: Vec<u32>,
    /// The side across, or [`NONE`].
    across: Vec<u32>,
    /// The length of each side, the same from both triangles.
    length: Vec<f64>,
}

/// How it is made, and what it gives.
impl IntrinsicTriangulation {
    /// The triangles of `mesh` with their lengths.
    ///
    /// Errors: [`dgp_mesh::Error::NotTriangle`] in [`Error::Mesh`].
    pub fn of_mesh(mesh: &Mesh) -> Result<Self, Error> {
        require_triangles(mesh)?;
        let lengths = edge_lengths(mesh);
        if let Some((edge, _)) = lengths.iter().find(|(_, length)| !length.is_finite()) {
            return Err(Error::NoLength { edge });
        }
        Ok(Self::glued(mesh, &lengths))
    }

    /// The triangles of `mesh` with these lengths of its edges, wherever its vertices may be.
    ///
    /// Errors: [`Error::NoTriangle`] for a face that is no triangle or whose lengths no triangle has.
    ///
    /// # Panics
    /// If there is not one length per edge.
    pub fn from_lengths(mesh: &Connectivity, lengths: &EdgeMap<f64>) -> Result<Self, Error> {
        assert_eq!(lengths.len(), mesh.edge_count(), "one length per edge");
        for f in mesh.faces() {
            let sides: Vec<f64> = mesh.face_edges(f).map(|e| lengths[e]).collect();
            let Ok([a, b, c]) = <[f64; 3]>::try_from(sides.as_slice()) else {
                let degree = sides.len();
                return Err(Error::Mesh(dgp_mesh::Error::NotTriangle { face: f, degree }));
            };
            let is_side = |x: f64, y: f64, z: f64| x > 0.0 && x <= y + z && x.is_finite();
            if !(is_side(a, b, c) && is_side(b, c, a) && is_side(c, a, b)) {
                return Err(Error::NoTriangle { triangle: f.index(), lengths: [a, b, c] });
            }
        }
        Ok(Self::glued(mesh, lengths))
    }

    fn glued(mesh: &Connectivity, lengths: &EdgeMap<f64>) -> Self {
        let count = 3 * mesh.face_count();
        let mut side_of = vec![NONE; mesh.halfedge_count()];
        let (mut from, mut length) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut halfedges = Vec::with_capacity(count);
        for h in mesh.faces().flat_map(|f| mesh.face_halfedges(f)) {
            side_of[h.index()] = from.len() as u32;
            from.push(mesh.from(h).index() as u32);
            length.push(lengths[h.edge()]);
            halfedges.push(h);
        }
        let across = halfedges.iter().map(|h| side_of[h.twin().index()]).collect();
        IntrinsicTriangulation { vertex_count: mesh.vertex_count(), from, across, length }
    }

    /// Triangles by their corners, the side across each side and the lengths of the sides.
    pub(super) fn from_parts(
        vertex_count: usize,
        from: Vec<u32>,
        across: Vec<u32>,
        length: Vec<f64>,
    ) -> Self {
        IntrinsicTriangulation { vertex_count, from, across, length }
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.from.len() / 3
    }

    /// The corners of triangle `t` by their numbers, and the lengths of the sides that lead from each to
    /// the next.
    pub fn triangle(&self, t: usize) -> ([usize; 3], [f64; 3]) {
        let sides = [3 * t, 3 * t + 1, 3 * t + 2];
        (sides.map(|s| self.from[s] as usize), sides.map(|s| self.length[s]))
    }

    /// The side across side `s`, if there is one.
    pub(super) fn across(&self, s: usize) -> Option<usize> {
        (self.across[s] != NONE).then_some(self.across[s] as usize)
    }

    pub(super) fn lengths(&self) -> &[f64] {
        &self.length
    }

    pub(super) fn lengths_mut(&mut self) -> &mut [f64] {
        &mut self.length
    }

    /// The cotangent Laplacian of the triangles; an edge from a vertex to itself counts nothing.
    ///
    /// Errors: [`Error::Sparse`] for more entries than a matrix can hold.
    pub fn laplacian(&self) -> Result<SparseMatrix, Error> {
        let edge = |(s, weight): (usize, f64)| (self.from[s], self.from[next(s)], weight);
        let edges: Vec<_> = self.weights().map(edge).collect();
        Ok(SparseMatrix::from_edges(self.vertex_count, &edges)?)
    }

    /// The least of the weights (cot α + cot β)/2 of edges with two triangles; `None` if there are none.
    pub fn least_weight(&self) -> Option<f64> {
        let inner = self.weights().filter(|&(s, _)| self.across(s).is_some());
        inner.map(|(_, weight)| weight).reduce(f64::min)
    }

    /// A third of the area of the triangles around each vertex.
    pub fn masses(&self) -> VertexMap<f64> {
        let mut masses = vec![0.0; self.vertex_count];
        for t in 0..self.triangle_count() {
            let ([a, b, c], sides) = self.triangle(t);
            let third = area(sides) / 3.0;
            for v in [a, b, c] {
                masses[v] += third;
            }
        }
        masses.into()
    }

    /// The area of all triangles.
    pub fn area(&self) -> f64 {
        (0..self.triangle_count()).map(|t| area(self.triangle(t).1)).sum()
    }

    /// One side of each edge, with its weight.
    fn weights(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let cotangents: Vec<f64> =
            (0..self.triangle_count()).flat_map(|t| cotangents(self.triangle(t).1)).collect();
        (0..self.from.len()).filter_map(move |s| match self.across(s) {
            None => Some((s, 0.5 * cotangents[s])),
            Some(other) if s < other => Some((s, 0.5 * cotangents[s] + 0.5 * cotangents[other])),
            Some(_) => None,
        })
    }

    /// Replaces the edge of side `s`, with a triangle on both sides, by the other diagonal of the four-sided
    /// figure of the two, which has this length.
    ///
    /// ```text
    ///        k                   k
    ///       /|\                 / \
    ///      / | \               / f \
    ///     i  |  l      →      i-----l        f keeps side s, now from i to l
    ///      \ | /               \ g /         g keeps the side across, now from l to i
    ///       \|/                 \ /
    ///        j                   j
    /// ```
    pub(super) fn flip(&mut self, s: usize, length: f64) {
        let t = self.across[s] as usize;
        // s leads from j to k, with i opposite; t from k to j, with l opposite. Then f has the sides i→l,
        // l→k and k→i, and g has l→i, i→j and j→l.
        let (ki, ij) = (next(s), prev(s));
        let (jl, lk) = (next(t), prev(t));
        let (i, l) = (self.from[ij], self.from[lk]);
        let moves = [(lk, ki), (ki, ij), (ij, jl), (jl, lk)];
        let before = moves.map(|(old, _)| (self.from[old], self.across[old], self.length[old]));
        for ((_, new), (from, across, length)) in moves.into_iter().zip(before) {
            // What lies across may itself be one of the sides that move.
            let across = moves.iter().find(|m| m.0 as u32 == across).map_or(across, |m| m.1 as u32);
            self.from[new] = from;
            self.across[new] = across;
            self.length[new] = length;
            if across != NONE {
                self.across[across as usize] = new as u32;
            }
        }
        (self.from[s], self.from[t]) = (i, l);
        (self.length[s], self.length[t]) = (length, length);
    }
}

/// The following side of the same triangle.
pub(super) fn next(s: usize) -> usize {
    if s % 3 == 2 { s - 2 } else { s + 1 }
}

/// The preceding side of the same triangle.
pub(super) fn prev(s: usize) -> usize {
    if s.is_multiple_of(3) { s + 2 } else { s - 1 }
}

/// The area of a triangle with these sides, 0 if there is none.
pub(super) fn area(sides: [f64; 3]) -> f64 {
    let unit = power_of_two_below(sides[0].max(sides[1]).max(sides[2]));
    scaled_area(sides.map(|side| side * unit)) / unit / unit
}

/// Kahan's form of Heron's formula, which does not cancel in needles.
fn scaled_area(mut sides: [f64; 3]) -> f64 {
    sides.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = sides;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    if product > 0.0 { 0.25 * product.sqrt() } else { 0.0 }
}

/// The cotangents of the angles opposite the three sides; all 0 if the triangle has no area.
pub(super) fn cotangents(sides: [f64; 3]) -> [f64; 3] {
    let unit = power_of_two_below(sides[0].max(sides[1]).max(sides[2]));
    let [a, b, c] = sides.map(|side| side * unit);
    let four_areas = 4.0 * scaled_area([a, b, c]);
    if four_areas == 0.0 {
        return [0.0; 3];
    }
    // b² + c² − a² with a difference of squares as a product.
    let opposite = |a: f64, b: f64, c: f64| {
        let (shorter, longer) = (b.min(c), b.max(c));
        let sum = shorter * shorter + (longer - a) * (longer + a);
        (sum / four_areas).clamp(-f64::MAX, f64::MAX)
    };
    [opposite(a, b, c), opposite(b, c, a), opposite(c, a, b)]
}

/// Where the corner opposite a side of length `base` is, whose triangle goes on with sides of these
/// lengths: how far along the side from its start, and how far from it.
pub(super) fn corner([base, after, before]: [f64; 3]) -> [f64; 2] {
    let unit = power_of_two_below(base.max(after).max(before));
    let [base, after, before] = [base, after, before].map(|side| side * unit);
    let along = (base * base + (before - after) * (before + after)) / (2.0 * base);
    [along, 2.0 * scaled_area([base, after, before]) / base].map(|x| x / unit)
}
