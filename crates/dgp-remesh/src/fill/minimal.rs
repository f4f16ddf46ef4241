//! The triangulation of a closed rim whose faces bend least, and of those the one of least area.
//!
//! ```text
//! w(a, c) = min over b between a and c of  w(a, b) + w(b, c) + w(triangle a b c)
//! (α, A) + (β, B) = (max(α, β), A + B),   α the largest angle between neighbors, A the area
//! ```
//!
//! The smaller of two weights has the smaller α, or with equal α the smaller A. Neighbors are the triangles that were chosen at the sides a b and b c, and on the rim the faces outside.
//!
//! - Input: the points of the rim, in order.
//! - Cost: O(n³) time, O(n²) memory for n ≤ 1000; beyond, rims are divided: see [`Rim::triangulate`].
//! - Guarantees: the minimum of the recurrence, which need not be that over all triangulations: the bend at
//!   a c depends on what is chosen on its other side; same bits for any number of threads.
//! - Reference: Barequet and Sharir, "Filling gaps in the boundary of a polyhedron", Computer Aided
//!   Geometric Design 12, 1995; Liepa, "Filling holes in meshes", Symposium on Geometry Processing, 2003.
//! - Departs from it: triangles without area count as folded; candidates that cannot be better are left out before their triangle is looked at.

use dgp_mesh::{DVec3, Progress, parallel};

use crate::Error;

/// Rims of more sides are divided.
const WHOLE: usize = 1000;

/// Into how many parts, about.
const PARTS: usize = 400;

/// Levels with fewer candidates are not shared among threads.
const SHARED: usize = 20_000;

/// A hole: its rim, and what is around it.
pub(super) struct Rim<'a> {
    /// The corners, the hole to the left of each side from one to the next.
    pub(super) points: &'a [DVec3],
    /// The normal of the face beyond each side; zero where there is none.
    pub(super) normals: &'a [DVec3],
    /// For each corner, ascending: the corners that an edge joins it to.
    pub(super) joined: &'a [Vec<u32>],
}

/// Triangles of corners of the rim, each a < b < c, and how good they are.
pub(super) struct Triangulation {
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest angle between neighbors, in radians.
    pub(super) angle: f64,
    pub(super) area: f64,
}

/// 1 − cos π.
const FOLDED: f64 = 2.0;

/// Triangles of corners of the rim, and what is known of all of them.
type Chosen = (Vec<[u32; 3]>, Cell);

/// What is known of the part of the rim from one corner to another.
#[derive(Clone, Copy)]
struct Cell {
    /// The largest 1 − cos of the angle between neighbors; infinite where the corners cannot be joined.
    bend: f64,
    area: f64,
    /// Of the triangle at the line between the corners.
    normal: DVec3,
    /// Its third corner.
    apex: u32,
}

impl Cell {
    const IMPOSSIBLE: Cell =
        Cell { bend: f64::INFINITY, area: f64::INFINITY, normal: DVec3::ZERO, apex: u32::MAX };

    fn side(normal: DVec3) -> Cell {
        Cell { bend: 0.0, area: 0.0, normal, apex: u32::MAX }
    }

    fn is_better_than(&self, other: &Cell) -> bool {
        self.bend < other.bend || (self.bend == other.bend && self.area < other.area)
    }
}

impl Rim<'_> {
    /// The best triangulation; `None` where edges that are there already leave none.
    ///
    /// Of a long rim the best triangulations of short parts are found first, and then the best of what
    /// is left.
    pub(super) fn triangulate(
        &self,
        progress: Progress<'_>,
    ) -> Result<Option<Triangulation>, Error> {
        let n = self.points.len();
        if n <= WHOLE {
            let all: Vec<u32> = (0..n as u32).collect();
            let normals = self.normals.to_vec();
            return Ok(self.best(&all, &normals, progress)?.map(|(triangles, cell)| {
                Triangulation { triangles, angle: angle(cell.bend), area: cell.area }
            }));
        }
        let Some((corners, ends)) = self.parts(n.div_ceil(PARTS)) else { return Ok(None) };
        let mut triangles = Vec::with_capacity(n - 2);
        let (mut bend, mut area) = (0.0_f64, 0.0);
        let mut normals = Vec::with_capacity(corners.len());
        for (k, (&start, &end)) in corners.iter().zip(&ends).enumerate() {
            progress.part(0.0, 0.5).report(k as f64 / corners.len() as f64)?;
            let part: Vec<u32> = (start..=end).map(|i| i % n as u32).collect();
            let mut outside: Vec<DVec3> =
                part[..part.len() - 1].iter().map(|&i| self.normals[i as usize]).collect();
            if part.len() == 2 {
                normals.push(outside[0]);
                continue;
            }
            outside.push(DVec3::ZERO);
            let Some((found, cell)) = self.best(&part, &outside, Progress::NONE)? else {
                return Ok(None);
            };
            triangles.extend(found);
            bend = bend.max(cell.bend);
            area += cell.area;
            normals.push(cell.normal);
        }
        let best = self.best(&corners, &normals, progress.part(0.5, 1.0))?;
        Ok(best.map(|(found, cell)| {
            triangles.extend(found);
            Triangulation { triangles, angle: angle(bend.max(cell.bend)), area: area + cell.area }
        }))
    }

    /// Corners about `step` apart that can be joined, from 0 on, and for each the end of its part.
    fn parts(&self, step: usize) -> Option<(Vec<u32>, Vec<u32>)> {
        let n = self.points.len() as u32;
        let mut corners = vec![0_u32];
        loop {
            let start = corners[corners.len() - 1];
            let free = |end: &u32| !self.are_joined(start, *end);
            match (start + step as u32..n - 1).find(free) {
                Some(end) => corners.push(end),
                None => break,
            }
        }
        // The last part ends where the first starts.
        while self.are_joined(corners[corners.len() - 1], 0) {
            corners.pop();
        }
        let ends = corners.iter().skip(1).copied().chain([n]).collect();
        (corners.len() > 2).then_some((corners, ends))
    }

    fn are_joined(&self, a: u32, b: u32) -> bool {
        self.joined[a as usize].binary_search(&b).is_ok()
    }

    /// The best triangulation of some corners in order, with a normal beyond each side, the last that of
    /// the side which closes; `None` where there is none.
    fn best(
        &self,
        corners: &[u32],
        normals: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Option<Chosen>, Error> {
        let n = corners.len();
        let points: Vec<DVec3> = corners.iter().map(|&i| self.points[i as usize]).collect();
        // What is known of a and c, by a and by c: both are read one after the other.
        let mut rows = vec![Cell::IMPOSSIBLE; n * n];
        let mut columns = vec![Cell::IMPOSSIBLE; n * n];
        for i in 0..n - 1 {
            rows[i * n + i + 1] = Cell::side(normals[i]);
            columns[(i + 1) * n + i] = rows[i * n + i + 1];
        }
        for length in 2..n {
            progress.report(length as f64 / n as f64)?;
            let count = n - length;
            let block = if count * length < SHARED { count } else { count.div_ceil(16) };
            let level = parallel::map_blocks(count, block, |range| {
                let found = range.map(|a| {
                    let c = a + length;
                    let closes = length + 1 == n;
                    if !closes && self.are_joined(corners[a], corners[c]) {
                        return Cell::IMPOSSIBLE;
                    }
                    let beyond = if closes { normals[n - 1] } else { DVec3::ZERO };
                    best_apex(
                        &points,
                        a,
                        c,
                        &rows[a * n..(a + 1) * n],
                        &columns[c * n..(c + 1) * n],
                        beyond,
                    )
                });
                found.collect::<Vec<Cell>>()
            });
            for (a, cell) in level.into_iter().flatten().enumerate() {
                rows[a * n + a + length] = cell;
                columns[(a + length) * n + a] = cell;
            }
        }
        let whole = rows[n - 1];
        if whole.apex == u32::MAX {
            return Ok(None);
        }
        let mut triangles = Vec::with_capacity(n - 2);
        let mut stack = vec![(0, n - 1)];
        while let Some((a, c)) = stack.pop() {
            if c - a < 2 {
                continue;
            }
            let b = rows[a * n + c].apex as usize;
            triangles.push([corners[a], corners[b], corners[c]]);
            stack.extend([(b, c), (a, b)]);
        }
        Ok(Some((triangles, whole)))
    }
}

/// The best triangle at the line from a to c, given what is known of a and each b and of each b and c.
fn best_apex(
    points: &[DVec3],
    a: usize,
    c: usize,
    row: &[Cell],
    column: &[Cell],
    beyond: DVec3,
) -> Cell {
    let mut best = Cell::IMPOSSIBLE;
    for b in a + 1..c {
        let (first, second) = (&row[b], &column[b]);
        let below = first.bend.max(second.bend);
        if below > best.bend || !below.is_finite() {
            continue;
        }
        let cross = (points[b] - points[a]).cross(points[c] - points[b]);
        let length = cross.length();
        // What lies beyond a triangle without area could look anywhere: it counts as folded.
        let (normal, bend) = if length > 0.0 {
            let normal = cross / length;
            let sides = bend(normal, first.normal).max(bend(normal, second.normal));
            (normal, below.max(sides).max(bend(normal, beyond)))
        } else {
            (DVec3::ZERO, FOLDED)
        };
        let area = first.area + second.area + 0.5 * length;
        let cell = Cell { bend, area, normal, apex: b as u32 };
        if cell.is_better_than(&best) {
            best = cell;
        }
    }
    best
}

/// 1 − cos of the angle between two normals; none where one of them is zero.
fn bend(a: DVec3, b: DVec3) -> f64 {
    if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { 1.0 - a.dot(b) }
}

fn angle(bend: f64) -> f64 {
    (1.0 - bend).clamp(-1.0, 1.0).acos()
}
