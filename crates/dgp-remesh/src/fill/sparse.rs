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

/// Nearest corners in space that a corner is joined to, at each scale.
const NEAR: usize = 6;

/// Corners along the rim to each side, at each scale.
const ALONG: usize = 2;

/// The coarsest scale has no more corners than twice this.
const COARSEST: usize = 16;

/// How often what was found is made better.
const ROUNDS: usize = 4;

/// Lines of the cover that bend within this of the most are looked at again.
const WORST: f64 = 1e-9;

/// The best triangulation of a rim between corners near each other; `None` if there is none.
pub(super) fn best(rim: &Rim<'_>, progress: Progress<'_>) -> Result<Option<Chosen>, Error> {
    let mut lines = candidates(rim, progress.part(0.0, 0.2))?;
    let part = |round: usize| {
        let at = |i: usize| 0.2 + 0.8 * i as f64 / (ROUNDS + 1) as f64;
        progress.part(at(round), at(round + 1))
    };
    let mut best: Option<Chosen> = solve(rim, &lines, part(0))?;
    for round in 1..=ROUNDS {
        let Some((triangles, cell)) = &best else { break };
        let more = around(rim, triangles, cell);
        let before: usize = lines.iter().map(Vec::len).sum();
        for [a, b] in more {
            let (a, b) = (a.min(b), a.max(b));
            if b > a + 1 && !rim.are_joined(a, b) {
                lines[a as usize].push(b);
            }
        }
        sort(&mut lines);
        if lines.iter().map(Vec::len).sum::<usize>() == before {
            break;
        }
        let Some(found) = solve(rim, &lines, part(round))? else { break };
        if !found.1.is_better_than(cell) {
            break;
        }
        best = Some(found);
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
fn candidates(rim: &Rim<'_>, progress: Progress<'_>) -> Result<Vec<Vec<u32>>, Error> {
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
        let is_last = count <= 2 * COARSEST;
        if is_last {
            (0..n).for_each(|a| (0..count).for_each(|k| join(a, k * step)));
            break;
        }
        let points: Vec<DVec3> = rim.points.iter().step_by(step).copied().collect();
        let tree = PointTree::new(&points, Progress::NONE)?;
        for a in 0..n {
            for near in tree.nearest_points(rim.points[a], NEAR + 1) {
                join(a, near.index * step);
            }
            let place = a / step;
            for k in place + count - ALONG..=place + count + ALONG + 1 {
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
    if worst.len() <= 2 * COARSEST {
        lines.extend(worst.iter().flat_map(|&a| (0..n).map(move |b| [a, b])));
    }
    lines
}

/// The lines from the lower corner on, with what is known of each, and for each corner those that end there.
struct Table {
    starts: Vec<usize>,
    ends: Vec<u32>,
    cells: Vec<Cell>,
    /// For each corner the corners of lower number and their lines, ascending.
    below_starts: Vec<usize>,
    below: Vec<(u32, u32)>,
}

impl Table {
    fn new(rim: &Rim<'_>, lines: &[Vec<u32>]) -> Self {
        let n = lines.len();
        let mut starts = vec![0];
        let mut ends = Vec::new();
        let mut below_starts = vec![0; n + 1];
        for list in lines {
            ends.extend(list);
            starts.push(ends.len());
            list.iter().for_each(|&c| below_starts[c as usize + 1] += 1);
        }
        for c in 0..n {
            below_starts[c + 1] += below_starts[c];
        }
        let mut places = below_starts.clone();
        let mut below = vec![(0, 0); ends.len()];
        let mut cells = vec![Cell::IMPOSSIBLE; ends.len()];
        for a in 0..n {
            for i in starts[a]..starts[a + 1] {
                let c = ends[i] as usize;
                below[places[c]] = (a as u32, i as u32);
                places[c] += 1;
                if c == a + 1 {
                    cells[i] = Cell::side(rim.normals[a]);
                }
            }
        }
        Table { starts, ends, cells, below_starts, below }
    }

    /// The line from a to c, if there is one.
    fn line(&self, a: usize, c: u32) -> Option<usize> {
        let list = &self.ends[self.starts[a]..self.starts[a + 1]];
        list.binary_search(&c).ok().map(|i| self.starts[a] + i)
    }
}

/// The recurrence over some lines.
fn solve(
    rim: &Rim<'_>,
    lines: &[Vec<u32>],
    progress: Progress<'_>,
) -> Result<Option<Chosen>, Error> {
    /// Lines between two reports.
    const STEP: usize = 1 << 15;
    let (n, points) = (lines.len(), rim.points);
    let mut table = Table::new(rim, lines);
    // Shorter ones first: a line needs those within it.
    let mut order: Vec<(u32, u32)> = Vec::with_capacity(table.ends.len());
    for a in 0..n {
        let longer =
            (table.starts[a]..table.starts[a + 1]).filter(|&i| table.ends[i] as usize > a + 1);
        order.extend(longer.map(|i| (a as u32, i as u32)));
    }
    order.sort_by_key(|&(a, i)| table.ends[i as usize] - a);
    for (done, &(a, i)) in order.iter().enumerate() {
        if done.is_multiple_of(STEP) {
            progress.report(done as f64 / order.len() as f64)?;
        }
        let (a, i) = (a as usize, i as usize);
        let c = table.ends[i] as usize;
        let beyond = if a == 0 && c == n - 1 { rim.normals[n - 1] } else { DVec3::ZERO };
        let mut best = Cell::IMPOSSIBLE;
        // Both lists ascend: their common corners are found in one pass.
        let below = &table.below[table.below_starts[c]..table.below_starts[c + 1]];
        let mut below = below[below.partition_point(|&(b, _)| b as usize <= a)..].iter().peekable();
        for first in table.starts[a]..i {
            let b = table.ends[first];
            while below.next_if(|&&(other, _)| other < b).is_some() {}
            let Some(&(other, second)) = below.peek().copied() else { break };
            if other == b {
                let parts = [&table.cells[first], &table.cells[second as usize]];
                best.offer([points[a], points[b as usize], points[c]], parts, b, beyond);
            }
        }
        table.cells[i] = best;
    }
    let Some(whole) = table.line(0, n as u32 - 1) else { return Ok(None) };
    let cell = table.cells[whole];
    if cell.apex == u32::MAX {
        return Ok(None);
    }
    let mut triangles = Vec::with_capacity(n - 2);
    let mut stack = vec![(0, n as u32 - 1)];
    while let Some((a, c)) = stack.pop() {
        if c - a < 2 {
            continue;
        }
        let Some(i) = table.line(a as usize, c) else { return Ok(None) };
        let b = table.cells[i].apex;
        triangles.push([a, b, c]);
        stack.extend([(b, c), (a, b)]);
    }
    Ok(Some((triangles, cell)))
}
