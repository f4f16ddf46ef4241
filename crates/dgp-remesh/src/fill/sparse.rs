//! Long rims: the triangulation that bends least of those between corners that are near each other, at every scale.
//!
//! ```text
//! lines from a corner to   the nearest corners of all, of every second, every fourth, …, in space and along the rim,
//!                          and to all of the coarsest
//! ```
//!
//! The recurrence of `minimal.rs` over these lines alone. What it finds is then made better: by lines to where an edge
//! of the cover could be flipped, and by all lines from the corners of the triangles that bend most.
//!
//! - Input: the points of the rim, in order.
//! - Cost: O(n log n) lines, about 60 triangles for each.
//! - Guarantees: none of the least bend; the largest bend is that of the recurrence over all lines in most cases.
//! - Reference: Zou, Ju and Carr, "An algorithm for triangulating multiple 3D polygons", Computer Graphics Forum
//!   32(5), 2013.
//! - Departs from it: corners near each other at several scales instead of a Delaunay triangulation, which round
//!   and flat rims do not determine; then a search around what was found.

use dgp_mesh::{DVec3, Progress, spatial::PointTree};

use super::minimal::{Cell, Chosen, Rim, bend};
use crate::Error;

/// How many lines there are.
struct Scale {
    /// Nearest corners in space that a corner is joined to, at each scale.
    near: usize,
    /// Corners along the rim to each side, at each scale.
    along: usize,
    /// The coarsest scale has no more corners than twice this.
    coarsest: usize,
}

/// To know about how much a cover bends.
const COARSE: Scale = Scale { near: 2, along: 1, coarsest: 8 };

/// To find one that bends little.
const FINE: Scale = Scale { near: 6, along: 2, coarsest: 40 };

/// How often what was found is made better.
const ROUNDS: usize = 12;

/// More corners are not worst.
const MANY: usize = 32;

/// Lines of the cover that bend within this of the most are looked at again.
const WORST: f64 = 1e-9;

/// The best triangulation of a rim between corners near each other, made better if that is all there will be; `None` if
/// there is none.
pub(super) fn best(
    rim: &Rim<'_>,
    is_all: bool,
    progress: Progress<'_>,
) -> Result<Option<Chosen>, Error> {
    let lines = candidates(rim, &COARSE, progress.part(0.0, 0.05))?;
    let mut best = solve(rim, &lines, f64::INFINITY, progress.part(0.05, 0.2))?;
    if !is_all {
        return Ok(best);
    }
    let part = |round: usize| {
        let at = |i: usize| 0.2 + 0.8 * i as f64 / (ROUNDS + 1) as f64;
        progress.part(at(round), at(round + 1))
    };
    let mut lines = candidates(rim, &FINE, Progress::NONE)?;
    for round in 0..=ROUNDS {
        let limit = best.as_ref().map_or(f64::INFINITY, |(_, cell)| cell.bend);
        let found = solve(rim, &lines, limit, part(round))?;
        let is_better = match (&found, &best) {
            (Some(found), Some(best)) => found.1.is_better_than(&best.1),
            (found, _) => found.is_some(),
        };
        if is_better {
            best = found;
        } else if round > 0 {
            break;
        }
        let Some((triangles, cell)) = &best else { break };
        let before: usize = lines.iter().map(Vec::len).sum();
        for [a, b] in around(rim, triangles, cell) {
            let (a, b) = (a.min(b), a.max(b));
            if b > a + 1 && !rim.are_joined(a, b) {
                lines[a as usize].push(b);
            }
        }
        sort(&mut lines);
        if lines.iter().map(Vec::len).sum::<usize>() == before {
            break;
        }
    }
    Ok(best)
}

fn sort(lines: &mut [Vec<u32>]) {
    for list in lines {
        list.sort_unstable();
        list.dedup();
    }
}

/// For each corner those after it that it may be joined to, ascending; the next along the rim among them.
fn candidates(
    rim: &Rim<'_>,
    scale: &Scale,
    progress: Progress<'_>,
) -> Result<Vec<Vec<u32>>, Error> {
    let n = rim.points.len();
    let mut lines: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut join = |a: usize, b: usize| {
        let (a, b) = (a.min(b), a.max(b));
        let closes = a == 0 && b == n - 1;
        if b == a + 1 || closes || (b > a && !rim.are_joined(a as u32, b as u32)) {
            lines[a].push(b as u32);
        }
    };
    let mut step = 1;
    loop {
        progress.report((step as f64 / n as f64).min(1.0))?;
        let count = n.div_ceil(step);
        let is_last = count <= 2 * scale.coarsest;
        if is_last {
            for a in 0..n {
                for k in 0..count {
                    join(a, k * step);
                }
            }
            break;
        }
        let points: Vec<DVec3> = rim.points.iter().step_by(step).copied().collect();
        let tree = PointTree::new(&points, Progress::NONE)?;
        for a in 0..n {
            for near in tree.nearest_points(rim.points[a], scale.near + 1) {
                join(a, near.index * step);
            }
            let place = a / step;
            for k in place + count - scale.along..=place + count + scale.along + 1 {
                join(a, k % count * step);
            }
        }
        step *= 2;
    }
    sort(&mut lines);
    Ok(lines)
}

/// Lines that could make a triangulation better: the other diagonal at each of its edges, and all from the corners
/// where it bends most.
fn around(rim: &Rim<'_>, triangles: &[[u32; 3]], cell: &Cell) -> Vec<[u32; 2]> {
    let n = rim.points.len() as u32;
    // Each side of a triangle with its third corner; those of two triangles come twice.
    let mut sides: Vec<([u32; 2], u32, usize)> = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        sides.extend([([a, b], c, t), ([b, c], a, t), ([a, c], b, t)]);
    }
    sides.sort_unstable();
    let normal = |t: usize| {
        let [a, b, c] = triangles[t].map(|i| rim.points[i as usize]);
        (b - a).cross(c - b).normalize_or_zero()
    };
    let mut lines = Vec::new();
    let mut worst: Vec<u32> = Vec::new();
    for same in sides.chunk_by(|x, y| x.0 == y.0) {
        let ([a, b], apex, t) = same[0];
        let bent = match same {
            [_, (_, other, u)] => {
                lines.push([apex, *other]);
                bend(normal(t), normal(*u))
            }
            _ if b == a + 1 => bend(normal(t), rim.normals[a as usize]),
            _ => bend(normal(t), rim.normals[n as usize - 1]),
        };
        if bent >= cell.bend * (1.0 - WORST) && bent > 0.0 {
            worst.extend([a, b]);
            worst.extend(same.iter().map(|side| side.1));
        }
    }
    worst.sort_unstable();
    worst.dedup();
    // On a rim that bends nowhere, or alike everywhere, no corner is worst.
    if worst.len() <= MANY {
        lines.extend(worst.iter().flat_map(|&a| (0..n).map(move |b| [a, b])));
    }
    lines
}

/// What is known of the lines that can be part of a cover, from their lower and from their upper corner on.
struct Table {
    cells: Vec<Cell>,
    /// For each corner the higher corners, ascending, with the largest bend of the part and the place of its cell.
    above: Vec<Vec<(u32, f64, u32)>>,
    /// For each corner the lower corners, descending.
    below: Vec<Vec<(u32, f64, u32)>>,
}

impl Table {
    /// The sides of the rim but the one that closes it.
    fn new(rim: &Rim<'_>) -> Self {
        let n = rim.points.len();
        let mut table =
            Table { cells: Vec::new(), above: vec![Vec::new(); n], below: vec![Vec::new(); n] };
        for a in 0..n as u32 - 1 {
            table.add(a, a + 1, Cell::side(rim.normals[a as usize]));
        }
        table
    }

    /// Takes a line not shorter along the rim than those before.
    fn add(&mut self, a: u32, c: u32, cell: Cell) {
        let place = self.cells.len() as u32;
        self.above[a as usize].push((c, cell.bend, place));
        self.below[c as usize].push((a, cell.bend, place));
        self.cells.push(cell);
    }

    /// The best triangle at a line, among the corners that have lines to both of its ends.
    fn best_apex(&self, points: &[DVec3], [a, c]: [u32; 2], limit: f64, beyond: DVec3) -> Cell {
        let mut best = Cell { bend: limit, ..Cell::IMPOSSIBLE };
        // Both lists ascend: their common corners are found in one pass.
        let mut below = self.below[c as usize].iter().rev();
        let Some(mut other) = below.next() else { return Cell::IMPOSSIBLE };
        'firsts: for &(b, bend, first) in &self.above[a as usize] {
            while other.0 < b {
                let Some(next) = below.next() else { break 'firsts };
                other = next;
            }
            if other.0 == b && bend <= best.bend && other.1 <= best.bend {
                let parts = [&self.cells[first as usize], &self.cells[other.2 as usize]];
                best.offer([a, b, c].map(|i| points[i as usize]), parts, b, beyond);
            }
        }
        if best.apex == u32::MAX { Cell::IMPOSSIBLE } else { best }
    }

    fn cell(&self, a: u32, c: u32) -> Option<&Cell> {
        let list = &self.above[a as usize];
        let place = list.binary_search_by_key(&c, |line| line.0).ok()?;
        Some(&self.cells[list[place].2 as usize])
    }
}

/// The recurrence over some lines; `None` if nothing bends less than `limit` or as much.
fn solve(
    rim: &Rim<'_>,
    lines: &[Vec<u32>],
    limit: f64,
    progress: Progress<'_>,
) -> Result<Option<Chosen>, Error> {
    /// Lines between two reports.
    const STEP: usize = 1 << 15;
    let n = lines.len();
    // Shorter ones first: a line needs those within it.
    let mut order: Vec<[u32; 2]> = Vec::with_capacity(lines.iter().map(Vec::len).sum());
    for (a, list) in lines.iter().enumerate() {
        let a = a as u32;
        order.extend(list.iter().filter(|&&c| c > a + 1).map(|&c| [a, c]));
    }
    order.sort_by_key(|[a, c]| c - a);
    let mut table = Table::new(rim);
    for (done, &[a, c]) in order.iter().enumerate() {
        if done.is_multiple_of(STEP) {
            progress.report(done as f64 / order.len() as f64)?;
        }
        let closes = a == 0 && c as usize == n - 1;
        let beyond = if closes { rim.normals[n - 1] } else { DVec3::ZERO };
        let best = table.best_apex(rim.points, [a, c], limit, beyond);
        if best.apex != u32::MAX {
            table.add(a, c, best);
        }
    }
    let Some(&whole) = table.cell(0, n as u32 - 1) else { return Ok(None) };
    let mut triangles = Vec::with_capacity(n - 2);
    let mut stack = vec![(0, n as u32 - 1)];
    while let Some((a, c)) = stack.pop() {
        if c - a < 2 {
            continue;
        }
        let Some(&Cell { apex: b, .. }) = table.cell(a, c) else { return Ok(None) };
        triangles.push([a, b, c]);
        stack.extend([(b, c), (a, b)]);
    }
    Ok(Some((triangles, whole)))
}
