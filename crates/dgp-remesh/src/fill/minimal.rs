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
//! - Cost: O(n³) time, O(n²) memory for up to [`WHOLE`] corners; longer rims: see `sparse.rs`.
//! - Guarantees: up to there the minimum of the recurrence, which need not be that over all triangulations: the
//!   bend at a c depends on what is chosen on its other side; same bits for any number of threads.
//! - Reference: Barequet and Sharir, "Filling gaps in the boundary of a polyhedron", Computer Aided
//!   Geometric Design 12, 1995; Liepa, "Filling holes in meshes", Symposium on Geometry Processing, 2003.
//! - Departs from it: triangles without area count as folded; candidates that cannot be better than others, or than what
//!   a few lines give, are left out before their triangle is looked at, several at a time.

use dgp_mesh::{DVec3, Progress, parallel};

use super::sparse;
use crate::Error;

/// For longer rims a limit is worth its time.
const SHORT: usize = 64;

/// For rims of more corners only some lines between corners are looked at.
pub(super) const WHOLE: usize = 1200;

/// Where some lines are not enough all are tried, up to so many corners.
const PATIENCE: usize = 2000;

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
pub(super) type Chosen = (Vec<[u32; 3]>, Cell);

/// What is known of the part of the rim from one corner to another.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    /// The largest 1 − cos of the angle between neighbors; infinite where the corners cannot be joined.
    pub(super) bend: f64,
    pub(super) area: f64,
    /// Of the triangle at the line between the corners.
    pub(super) normal: DVec3,
    /// Its third corner.
    pub(super) apex: u32,
}

impl Cell {
    pub(super) const IMPOSSIBLE: Cell =
        Cell { bend: f64::INFINITY, area: f64::INFINITY, normal: DVec3::ZERO, apex: u32::MAX };

    pub(super) fn side(normal: DVec3) -> Cell {
        Cell { bend: 0.0, area: 0.0, normal, apex: u32::MAX }
    }

    pub(super) fn is_better_than(&self, other: &Cell) -> bool {
        self.bend < other.bend || (self.bend == other.bend && self.area < other.area)
    }

    /// Takes the triangle of `points` at b, if it is better, given what is known of both sides at its apex.
    #[inline]
    pub(super) fn offer(
        &mut self,
        [a, b, c]: [DVec3; 3],
        [first, second]: [&Cell; 2],
        apex: u32,
        beyond: DVec3,
    ) {
        let below = first.bend.max(second.bend);
        if below > self.bend || !below.is_finite() {
            return;
        }
        let cross = (b - a).cross(c - b);
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
        let cell = Cell { bend, area, normal, apex };
        if cell.is_better_than(self) {
            *self = cell;
        }
    }
}

impl Rim<'_> {
    /// The best triangulation, or nearly; `None` where edges that are there already leave none.
    pub(super) fn triangulate(
        &self,
        progress: Progress<'_>,
    ) -> Result<Option<Triangulation>, Error> {
        let n = self.points.len();
        let chosen = if n <= SHORT {
            self.best(f64::INFINITY, progress)?
        } else {
            // What a few lines give tells how much none of the parts may bend.
            let few = sparse::best(self, n > WHOLE, progress.part(0.0, 0.3))?;
            let limit = few.as_ref().map_or(f64::INFINITY, |(_, cell)| cell.bend);
            let all = match few {
                Some(_) if n > WHOLE => None,
                _ if n > PATIENCE => None,
                _ => self.best(limit, progress.part(0.3, 1.0))?,
            };
            [few, all]
                .into_iter()
                .flatten()
                .reduce(|x, y| if y.1.is_better_than(&x.1) { y } else { x })
        };
        Ok(chosen.map(|(triangles, cell)| Triangulation {
            triangles,
            angle: angle(cell.bend),
            area: cell.area,
        }))
    }

    pub(super) fn are_joined(&self, a: u32, b: u32) -> bool {
        self.joined[a as usize].binary_search(&b).is_ok()
    }

    /// The best triangulation over all lines, if it bends less than `limit` or as much; `None` where there is none.
    pub(super) fn best(&self, limit: f64, progress: Progress<'_>) -> Result<Option<Chosen>, Error> {
        let n = self.points.len();
        let mut table = Table::new(self);
        for length in 2..n {
            progress.report((length as f64 / n as f64).powi(2))?;
            let count = n - length;
            let block = if count * length < SHARED { count } else { count.div_ceil(16) };
            let level = parallel::map_blocks(count, block, |range| {
                let cell = |a: usize| {
                    let c = a + length;
                    let closes = length + 1 == n;
                    if !closes && self.are_joined(a as u32, c as u32) {
                        return Cell::IMPOSSIBLE;
                    }
                    let beyond = if closes { self.normals[n - 1] } else { DVec3::ZERO };
                    table.best_apex(self.points, [a, c], limit, beyond)
                };
                range.map(cell).collect::<Vec<Cell>>()
            });
            for (a, cell) in level.into_iter().flatten().enumerate() {
                table.set(a, a + length, &cell);
            }
        }
        let whole = table.cell(0, n - 1);
        if whole.apex == u32::MAX {
            return Ok(None);
        }
        let mut triangles = Vec::with_capacity(n - 2);
        let mut stack = vec![(0, n - 1)];
        while let Some((a, c)) = stack.pop() {
            if c - a < 2 {
                continue;
            }
            let b = table.cell(a, c).apex as usize;
            triangles.push([a as u32, b as u32, c as u32]);
            stack.extend([(b, c), (a, b)]);
        }
        Ok(Some((triangles, *whole)))
    }
}

/// What is known of a and c > a, by a and by c: both are read one after the other.
struct Table {
    n: usize,
    row_bends: Vec<f64>,
    rows: Vec<Cell>,
    column_bends: Vec<f64>,
    columns: Vec<Cell>,
}

impl Table {
    fn new(rim: &Rim<'_>) -> Self {
        let n = rim.points.len();
        let size = n * (n - 1) / 2;
        let mut table = Table {
            n,
            row_bends: vec![f64::INFINITY; size],
            rows: vec![Cell::IMPOSSIBLE; size],
            column_bends: vec![f64::INFINITY; size],
            columns: vec![Cell::IMPOSSIBLE; size],
        };
        for a in 0..n - 1 {
            table.set(a, a + 1, &Cell::side(rim.normals[a]));
        }
        table
    }

    /// Where the row of `a` has what is known of it and a + 1.
    fn row(&self, a: usize) -> usize {
        a * (2 * self.n - a - 1) / 2
    }

    /// Where the column of `c` has what is known of 0 and it.
    fn column(c: usize) -> usize {
        c * (c - 1) / 2
    }

    fn cell(&self, a: usize, c: usize) -> &Cell {
        &self.rows[self.row(a) + c - a - 1]
    }

    fn set(&mut self, a: usize, c: usize, cell: &Cell) {
        let (row, column) = (self.row(a) + c - a - 1, Self::column(c) + a);
        self.row_bends[row] = cell.bend;
        self.rows[row] = *cell;
        self.column_bends[column] = cell.bend;
        self.columns[column] = *cell;
    }

    /// The best triangle at the line from a to c, given what is known of a and each b and of each b and c.
    fn best_apex(&self, points: &[DVec3], [a, c]: [usize; 2], limit: f64, beyond: DVec3) -> Cell {
        /// Apexes that are looked at together.
        const FEW: usize = 16;
        let (row, column) = (self.row(a), Self::column(c));
        let (rows, columns) = (row..row + c - a - 1, column + a + 1..column + c);
        let (firsts, seconds) = (&self.rows[rows.clone()], &self.columns[columns.clone()]);
        let mut best = Cell { bend: limit, ..Cell::IMPOSSIBLE };
        let mut offer = |k: usize| {
            let b = a + 1 + k;
            let parts = [&firsts[k], &seconds[k]];
            best.offer([points[a], points[b], points[c]], parts, b as u32, beyond);
            best.bend
        };
        // That of a shorter line leaves little for the others.
        let guess = self.cell(a, c - 1).apex;
        let mut most = if guess < c as u32 { offer(guess as usize - a - 1) } else { limit };
        let bends = self.row_bends[rows].chunks(FEW).zip(self.column_bends[columns].chunks(FEW));
        for (chunk, (firsts, seconds)) in bends.enumerate() {
            // Without a branch for each, so that several are compared at a time.
            let larger = |(x, y): (&f64, &f64)| if x > y { *x } else { *y };
            let smaller = |x: f64, y: f64| if x < y { x } else { y };
            let least = firsts.iter().zip(seconds).map(larger).fold(f64::INFINITY, smaller);
            if least > most || least == f64::INFINITY {
                continue;
            }
            for (k, pair) in firsts.iter().zip(seconds).enumerate() {
                if larger(pair) <= most {
                    most = offer(FEW * chunk + k);
                }
            }
        }
        if best.apex == u32::MAX { Cell::IMPOSSIBLE } else { best }
    }
}

/// 1 − cos of the angle between two normals; none where one of them is zero.
pub(super) fn bend(a: DVec3, b: DVec3) -> f64 {
    if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { 1.0 - a.dot(b) }
}

fn angle(bend: f64) -> f64 {
    (1.0 - bend).clamp(-1.0, 1.0).acos()
}
