//! How far a surface is from another at most, between two numbers that are sure.
//!
//! ```text
//! h(A, B) = max over x in A of min over y in B of |x − y|,    H(A, B) = max(h(A, B), h(B, A))
//! ```
//!
//! Distances at points of A are lower bounds. For a triangle of A with corners v and longest side l
//!
//! ```text
//! max over the triangle ≤ min over b of max over v of d(v, b)     the distance to one triangle b is convex
//!                       ≤ max over v of d(v, B) + l/√3            no point is further from a corner
//! ```
//!
//! are upper bounds; of the triangles b those nearest to the corners are tried, and then that nearest to the
//! center. Triangles whose upper
//! bound exceeds what is known from below by more than the tolerance are halved across their longest
//! side, those of the largest bound first.
//!
//! - Input: any two surfaces with triangles.
//! - Cost: a nearest point for each vertex, then up to three for each halving. Where the distance is nearly the same
//!   everywhere, as between two offset surfaces of fine triangles, their number is that of cells of
//!   the size of the tolerance; [`HausdorffOptions::queries`] ends that.
//! - Guarantees: lower ≤ h ≤ upper but for rounding, which is 2⁻⁴⁸ of the coordinates and added. The same
//!   bits for any number of threads.
//! - Reference: Tang, Lee and Kim, "Interactive Hausdorff distance computation for general polygonal
//!   models", ACM Transactions on Graphics 28(3), 2009; Cignoni, Rocchini and Scopigno, "Metro: measuring
//!   error on simplified surfaces", Computer Graphics Forum 17(2), 1998 (one-sided distances).
//! - Departs from it: triangles are halved in batches of fixed size, so that threads change nothing.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    TriangleTree,
    closest_point::{Nearest, closest_in_triangle},
};
use crate::{Error, FaceId, Progress, parallel};

/// Choices of [`hausdorff`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HausdorffOptions {
    /// How far the bounds may be apart, relative to the diagonal of the box around both surfaces.
    pub tolerance: f64,
    /// The most nearest points to look for beyond those of the vertices; then the bounds are what they
    /// are.
    pub queries: usize,
}

impl Default for HausdorffOptions {
    fn default() -> Self {
        HausdorffOptions { tolerance: 1e-4, queries: 20_000_000 }
    }
}

/// What is known of the largest distance from one surface to another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct HausdorffBounds {
    /// It is not less than this: the distance at `point`.
    pub lower: f64,
    /// It is not more than this.
    pub upper: f64,
    /// Where on the first surface the distance is `lower`.
    pub point: DVec3,
    /// The face it is on.
    pub face: FaceId,
    /// The nearest point of the second surface.
    pub nearest: DVec3,
    /// The face that is on.
    pub nearest_face: FaceId,
    /// How many nearest points were looked for.
    pub queries: usize,
    /// Whether the bounds are as close as was asked for.
    pub is_within_tolerance: bool,
}

/// What [`hausdorff`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct HausdorffReport {
    /// From the first surface to the second.
    pub forward: HausdorffBounds,
    /// From the second to the first.
    pub backward: HausdorffBounds,
}

impl HausdorffReport {
    /// The symmetric distance is not less than this.
    pub fn lower(&self) -> f64 {
        self.forward.lower.max(self.backward.lower)
    }

    /// The symmetric distance is not more than this.
    pub fn upper(&self) -> f64 {
        self.forward.upper.max(self.backward.upper)
    }
}

/// The Hausdorff distance of two surfaces, both ways.
///
/// Errors: [`Error::Empty`] if one has no triangles, [`Error::InvalidOption`].
pub fn hausdorff(
    a: &TriangleTree,
    b: &TriangleTree,
    options: &HausdorffOptions,
    progress: Progress<'_>,
) -> Result<HausdorffReport, Error> {
    let forward = one_sided_hausdorff(a, b, options, progress.part(0.0, 0.5))?;
    let backward = one_sided_hausdorff(b, a, options, progress.part(0.5, 1.0))?;
    Ok(HausdorffReport { forward, backward })
}

/// How far a point of `from` is from `to` at most.
///
/// Errors: [`Error::Empty`] if one has no triangles, [`Error::InvalidOption`].
pub fn one_sided_hausdorff(
    from: &TriangleTree,
    to: &TriangleTree,
    options: &HausdorffOptions,
    progress: Progress<'_>,
) -> Result<HausdorffBounds, Error> {
    if !(options.tolerance > 0.0) {
        return Err(Error::option("tolerance", options.tolerance, "positive"));
    }
    let (Some(box_a), Some(box_b)) = (from.bounds, to.bounds) else { return Err(Error::Empty) };
    let both = box_a.union(&box_b);
    // All in the frame of `to`.
    let frame = &to.nodes.frame;
    let half = (0.5 * both.max - 0.5 * both.min) * frame.scale.down;
    let size = both.max.abs().max(both.min.abs()).max_element() * frame.scale.down;
    if !half.is_finite() || !size.is_finite() {
        return Err(Error::option(
            "tolerance",
            options.tolerance,
            "used on surfaces of comparable size",
        ));
    }
    let search = Search {
        from,
        to,
        tolerance: options.tolerance * 2.0 * half.length(),
        rounding: size / (1_u64 << 48) as f64,
    };
    search.run(options.queries, progress)
}

/// A point of A and the nearest of B.
#[derive(Clone, Copy)]
struct Probe {
    point: DVec3,
    distance: f64,
    /// The triangle of B.
    triangle: u32,
}

/// A triangle of A or a part of one.
#[derive(Clone, Copy)]
struct Piece {
    corners: [Probe; 3],
    upper: f64,
    /// The triangle of A.
    source: u32,
}

struct Search<'a> {
    from: &'a TriangleTree,
    to: &'a TriangleTree,
    tolerance: f64,
    rounding: f64,
}

/// The largest distance so far, and where.
#[derive(Clone, Copy)]
struct Lower {
    distance: f64,
    probe: Probe,
    source: u32,
}

impl Lower {
    fn raise(&mut self, probe: Probe, source: u32) {
        if probe.distance > self.distance {
            *self = Lower { distance: probe.distance, probe, source };
        }
    }
}

/// How many triangles are halved side by side, and after how many queries each is compared again.
const ROUND: usize = 4096;
const HALVINGS: usize = 32;

impl Search<'_> {
    fn run(&self, budget: usize, progress: Progress<'_>) -> Result<HausdorffBounds, Error> {
        let probes = self.vertex_probes(progress.part(0.0, 0.4))?;
        let corners = |i: usize| self.from.vertices[i].map(|v| probes[v.index()]);
        let mut all = Findings::default();
        for i in 0..self.from.len() {
            for probe in corners(i).into_iter().flatten() {
                all.lower.raise(probe, i as u32);
            }
        }
        let start = all.lower;
        let blocks = parallel::map_blocks(self.from.len(), parallel::BLOCK, |range| {
            let mut found = Findings { lower: start, ..Findings::default() };
            for i in range {
                let [Some(a), Some(b), Some(c)] = corners(i) else { continue };
                self.settle([a, b, c], f64::INFINITY, i as u32, &mut found);
            }
            found
        });
        for found in blocks {
            all.absorb(found);
        }

        let mut open = f64::INFINITY;
        while all.queries < budget {
            let known = all.lower.distance;
            let settled = &mut all.settled;
            all.pieces.retain(|piece| {
                let is_open = piece.upper > known + self.tolerance;
                *settled = if is_open { *settled } else { settled.max(piece.upper) };
                is_open
            });
            let highest = all.pieces.iter().map(|piece| piece.upper).fold(known, f64::max);
            open = open.min(highest - known);
            let near = self.tolerance / open.max(self.tolerance);
            let part = near.max(all.queries as f64 / budget as f64).min(1.0);
            progress.part(0.4, 1.0).report(part)?;
            let count = ROUND.min(all.pieces.len());
            if count == 0 {
                break;
            }
            if count < all.pieces.len() {
                all.pieces.select_nth_unstable_by(count - 1, by_upper);
            }
            all.pieces[..count].sort_unstable_by(by_upper);
            let rest = all.pieces.split_off(count);
            let highest = std::mem::replace(&mut all.pieces, rest);
            let blocks = parallel::map_blocks(count, 16, |range| {
                let halved = range.map(|i| self.halve(highest[i], all.lower));
                halved.collect::<Vec<_>>()
            });
            for found in blocks.into_iter().flatten() {
                all.absorb(found);
            }
        }
        progress.report(1.0)?;
        let open = all.pieces.iter().map(|piece| piece.upper).fold(0.0, f64::max);
        let queries = all.queries + probes.iter().flatten().count();
        Ok(self.bounds(&all.lower, all.settled.max(open), queries))
    }

    /// The probe of each vertex of A that a triangle has.
    fn vertex_probes(&self, progress: Progress<'_>) -> Result<Vec<Option<Probe>>, Error> {
        let corners = self.from.vertices.as_flattened();
        let count = corners.iter().map(|v| v.index() + 1).max().unwrap_or(0);
        // In the order in which the leaves have them, neighbors follow each other.
        let mut is_seen = vec![false; count];
        let mut order = Vec::with_capacity(count);
        for (i, v) in corners.iter().enumerate() {
            if !std::mem::replace(&mut is_seen[v.index()], true) {
                order.push((v.index(), self.point(i / 3, i % 3)));
            }
        }
        let mut probes = vec![None; count];
        for (k, part) in order.chunks(ROUND * 16).enumerate() {
            progress.report((k * ROUND * 16) as f64 / order.len() as f64)?;
            let blocks = parallel::map_blocks(part.len(), 256, |range| {
                let mut last = None;
                let probes = part[range].iter().map(|&(_, point)| {
                    let probe = self.probe(point, last);
                    last = Some(probe.triangle as usize);
                    probe
                });
                probes.collect::<Vec<_>>()
            });
            for (&(v, _), probe) in part.iter().zip(blocks.into_iter().flatten()) {
                probes[v] = Some(probe);
            }
        }
        Ok(probes)
    }

    /// Corner `k` of triangle `i` of A in the frame of B.
    fn point(&self, i: usize, k: usize) -> DVec3 {
        let up = self.from.nodes.frame.scale.up;
        self.from.triangles[i][k] * up * self.to.nodes.frame.scale.down
    }

    fn probe(&self, point: DVec3, guess: Option<usize>) -> Probe {
        let nearest = self.to.nearest(point, guess);
        let Nearest { square, triangle, .. } = nearest.expect("there are triangles");
        Probe { point, distance: square.sqrt(), triangle: triangle as u32 }
    }

    /// Bounds a piece from above, by no more than `parent`, and keeps it if that does not settle it.
    fn settle(&self, corners: [Probe; 3], parent: f64, source: u32, found: &mut Findings) {
        let [a, b, c] = corners;
        let sides = [b.point - c.point, c.point - a.point, a.point - b.point];
        let longest = sides.map(DVec3::length_squared).into_iter().fold(0.0, f64::max).sqrt();
        let farthest = a.distance.max(b.distance).max(c.distance);
        let mut upper = parent.min(farthest + longest * (1.0 / 3.0_f64.sqrt()) * (1.0 + 1e-12));
        for (k, probe) in corners.iter().enumerate() {
            if corners[..k].iter().all(|other| other.triangle != probe.triangle) {
                upper = upper.min(self.to_triangle(&corners, probe.triangle));
            }
        }
        if upper > found.lower.distance + self.tolerance {
            let center = (a.point + b.point + c.point) / 3.0;
            let center = self.probe(center, Some(a.triangle as usize));
            found.queries += 1;
            found.lower.raise(center, source);
            if corners.iter().all(|other| other.triangle != center.triangle) {
                upper = upper.min(self.to_triangle(&corners, center.triangle));
            }
        }
        let upper = upper.max(farthest);
        if upper > found.lower.distance + self.tolerance {
            found.pieces.push(Piece { corners, upper, source });
        } else {
            found.settled = found.settled.max(upper);
        }
    }

    /// The largest distance of a piece to one triangle of B: at a corner.
    fn to_triangle(&self, corners: &[Probe; 3], triangle: u32) -> f64 {
        let triangle = &self.to.triangles[triangle as usize];
        let squares = corners.map(|corner| closest_in_triangle(corner.point, triangle).0);
        squares.into_iter().fold(0.0, f64::max).sqrt()
    }

    /// Halves a piece again and again.
    fn halve(&self, piece: Piece, lower: Lower) -> Findings {
        let mut found = Findings { pieces: vec![piece], lower, ..Findings::default() };
        let mut rest = Vec::new();
        while let Some(piece) = found.pieces.pop() {
            if piece.upper <= found.lower.distance + self.tolerance {
                found.settled = found.settled.max(piece.upper);
                continue;
            }
            if found.queries >= HALVINGS {
                rest.push(piece);
                continue;
            }
            let [a, b, c] = piece.corners.map(|probe| probe.point);
            let sides =
                [(c - b).length_squared(), (a - c).length_squared(), (b - a).length_squared()];
            let k = (0..3).fold(0, |best, i| if sides[i] > sides[best] { i } else { best });
            let [apex, from, to] = [0, 1, 2].map(|i| piece.corners[(k + i) % 3]);
            let middle = self.probe(0.5 * (from.point + to.point), Some(from.triangle as usize));
            found.queries += 1;
            found.lower.raise(middle, piece.source);
            self.settle([apex, from, middle], piece.upper, piece.source, &mut found);
            self.settle([apex, middle, to], piece.upper, piece.source, &mut found);
        }
        found.pieces = rest;
        found
    }

    fn bounds(&self, lower: &Lower, upper: f64, queries: usize) -> HausdorffBounds {
        let up = self.to.nodes.frame.scale.up;
        let point = lower.probe.point * up;
        let i = lower.probe.triangle as usize;
        let (_, weights) = closest_in_triangle(lower.probe.point, &self.to.triangles[i]);
        let upper = upper.max(lower.distance);
        HausdorffBounds {
            lower: (lower.distance - self.rounding).max(0.0) * up,
            upper: (upper + self.rounding) * up,
            point,
            face: self.from.faces[lower.source as usize],
            nearest: self.to.point_at(i, weights) * up,
            nearest_face: self.to.faces[i],
            queries,
            is_within_tolerance: upper <= lower.distance + self.tolerance,
        }
    }
}

/// What came of looking at pieces: those that are left, the largest upper bound of the others.
#[derive(Default)]
struct Findings {
    pieces: Vec<Piece>,
    lower: Lower,
    settled: f64,
    queries: usize,
}

impl Findings {
    fn absorb(&mut self, other: Findings) {
        self.queries += other.queries;
        self.settled = self.settled.max(other.settled);
        if other.lower.distance > self.lower.distance {
            self.lower = other.lower;
        }
        self.pieces.extend(other.pieces);
    }
}

impl Default for Lower {
    fn default() -> Self {
        Lower { distance: -1.0, probe: Probe::NONE, source: 0 }
    }
}

impl Probe {
    const NONE: Probe = Probe { point: DVec3::ZERO, distance: -1.0, triangle: 0 };
}

/// The largest bound first; of equal ones in an order that threads cannot change.
fn by_upper(a: &Piece, b: &Piece) -> Ordering {
    let place = |piece: &Piece| piece.corners.map(|probe| probe.point.to_array().map(f64::to_bits));
    b.upper.total_cmp(&a.upper).then(a.source.cmp(&b.source)).then_with(|| place(a).cmp(&place(b)))
}
