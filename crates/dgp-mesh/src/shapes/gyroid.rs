//! A ball cut out of a gyroid: a closed surface of many handles in all directions.
//!
//! The solid is where sin x cos y + sin y cos z + sin z cos x < 0 within a ball. Its surface is taken from the
//! values on a grid, cell by cell, each cut into six tetrahedra along its diagonal; pieces that hang free and
//! closed cavities are left out. Handles that run in all directions, unlike those of
//! [`surface_of_genus`](super::surface_of_genus), leave no short cut through the surface.
//!
//! - Input: the periods along the diameter of the ball, and grid cells per period.
//! - Cost: O(cells), with the logarithm of the number of vertices for each.
//! - Reference: Schoen, *Infinite Periodic Minimal Surfaces without Self-Intersections*, NASA TN D-5541, 1970;
//!   Doi and Koide, *An Efficient Method of Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells*, 1991.

use std::{collections::BTreeMap, f64::consts::TAU};

use glam::DVec3;

use super::{at_least, face_count, manifold};
use crate::{Error, FaceList, Mesh, VertexId};

/// How near a vertex comes to a grid point, in parts of the edge it is on: nearer ones make slivers.
const NEAREST: f64 = 0.1;

/// A closed surface of many handles, of radius 1 around the origin; `cells` per period and direction.
/// Three periods of 16 cells have genus 57 and 125,412 triangles. At the rim, finer grids keep more handles.
pub fn gyroid(periods: usize, cells: usize) -> Result<Mesh, Error> {
    let per_side = periods.saturating_mul(cells);
    at_least("periods", periods, 1, "at least 1")?;
    at_least("cells", cells, 4, "at least 4 per period")?;
    face_count(&[per_side, per_side, per_side])?;
    let grid = Grid::new(periods, per_side + 3);
    let mut crossings = BTreeMap::new();
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let steps = [1, grid.n, grid.n * grid.n];
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    for cell in grid.cells() {
        for path in axes {
            let mut points = [cell; 4];
            for step in 0..3 {
                points[step + 1] = points[step] + steps[path[step]];
            }
            let (inside, outside): (Vec<_>, Vec<_>) =
                points.into_iter().partition(|&p| grid.values[p] < 0.0);
            let mut cross = |a: usize, b: usize| {
                *crossings.entry((inside[a], outside[b])).or_insert_with(|| {
                    positions.push(grid.crossing(inside[a], outside[b]));
                    positions.len() - 1
                })
            };
            let faces = match (inside.len(), outside.len()) {
                (1, 3) => vec![[cross(0, 0), cross(0, 1), cross(0, 2)]],
                (3, 1) => vec![[cross(0, 0), cross(1, 0), cross(2, 0)]],
                (2, 2) => {
                    let [a, b, c, d] = [cross(0, 0), cross(0, 1), cross(1, 1), cross(1, 0)];
                    vec![[a, b, c], [a, c, d]]
                }
                _ => continue,
            };
            // Whether the face turns the right way depends on the corners only, wherever they are cut.
            let corners: Vec<_> =
                inside.iter().chain(&outside).map(|&p| grid.position(p)).collect();
            let [b, c, d] = [1, 2, 3].map(|i| corners[i] - corners[0]);
            let turned = b.cross(c).dot(d) < 0.0;
            triangles.extend(faces.into_iter().map(|face| {
                let [a, b, c] = face.map(VertexId::new);
                if turned { [a, c, b] } else { [a, b, c] }
            }));
        }
    }
    manifold(positions, &FaceList::from_triangles(triangles))
}

/// Values on n³ points around the ball, negative in the solid.
struct Grid {
    n: usize,
    values: Vec<f64>,
}

impl Grid {
    fn new(periods: usize, n: usize) -> Self {
        let mut grid = Grid { n, values: vec![0.0; n * n * n] };
        let turn = TAU * 0.5 * periods as f64;
        for i in 0..grid.values.len() {
            let p = grid.position(i);
            // Off the symmetric places, where points of the grid lie on the surface.
            let [x, y, z] = (p * turn + DVec3::splat(0.123)).to_array();
            let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
            grid.values[i] = wave.max(turn * (p.length() - 1.0));
        }
        grid.keep_the_largest(true);
        grid.keep_the_largest(false);
        grid
    }

    fn position(&self, i: usize) -> DVec3 {
        let at = [i % self.n, i / self.n % self.n, i / (self.n * self.n)];
        let middle = 0.5 * (self.n - 1) as f64;
        // A point beyond the ball on each side.
        DVec3::from_array(at.map(|k| (k as f64 - middle) / (middle - 1.0)))
    }

    /// Where the surface meets the line between a point in the solid and one outside.
    fn crossing(&self, inside: usize, outside: usize) -> DVec3 {
        let [a, b] = [inside, outside].map(|p| self.values[p].abs());
        let t = (a / (a + b)).clamp(NEAREST, 1.0 - NEAREST);
        self.position(inside).lerp(self.position(outside), t)
    }

    /// The first point of each cell.
    fn cells(&self) -> impl Iterator<Item = usize> {
        let n = self.n;
        let side = 0..n - 1;
        side.clone().flat_map(move |z| {
            let side = side.clone();
            side.clone().flat_map(move |y| side.clone().map(move |x| (z * n + y) * n + x))
        })
    }

    /// Turns what is solid (or what is not) over but for the largest piece that tetrahedra connect.
    fn keep_the_largest(&mut self, solid: bool) {
        let n = self.n;
        let mut piece = vec![0_usize; self.values.len()];
        let (mut largest, mut most) = (0, 0);
        let mut waiting = Vec::new();
        for start in 0..piece.len() {
            if piece[start] != 0 || (self.values[start] < 0.0) != solid {
                continue;
            }
            let mut size = 0;
            piece[start] = start + 1;
            waiting.push(start);
            while let Some(p) = waiting.pop() {
                size += 1;
                let at = [p % n, p / n % n, p / (n * n)];
                for step in 1..8_usize {
                    let delta = [step & 1, step >> 1 & 1, step >> 2];
                    let offset = delta[0] + n * (delta[1] + n * delta[2]);
                    let forth = (0..3).all(|k| at[k] + delta[k] < n).then(|| p + offset);
                    let back = (0..3).all(|k| at[k] >= delta[k]).then(|| p - offset);
                    for q in [forth, back].into_iter().flatten() {
                        if piece[q] == 0 && (self.values[q] < 0.0) == solid {
                            piece[q] = start + 1;
                            waiting.push(q);
                        }
                    }
                }
            }
            if size > most {
                (largest, most) = (start + 1, size);
            }
        }
        for (value, &piece) in self.values.iter_mut().zip(&piece) {
            if piece != 0 && piece != largest {
                *value = -*value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{measure::volume, topology};

    /// All corners of the cell that are reached in the solid, each from one with fewer steps.
    fn chains(grid: &Grid, steps: [usize; 3], p: usize, taken: usize) -> i64 {
        let further = (taken + 1..8).filter(|next| next & taken == taken).map(|next| {
            let q = p + (0..3).filter(|k| next >> k & 1 == 1).map(|k| steps[k]).sum::<usize>();
            if grid.values[q] < 0.0 { -chains(grid, steps, p, next) } else { 0 }
        });
        1 + further.sum::<i64>()
    }

    /// Points less edges plus triangles less tetrahedra of the solid: a boundary has twice that of what it bounds.
    fn euler_characteristic(grid: &Grid) -> i64 {
        let n = grid.n;
        let steps = [1, n, n * n];
        // What is solid ends before the last points.
        (0..grid.values.len())
            .filter(|&p| grid.values[p] < 0.0)
            .map(|p| chains(grid, steps, p, 0))
            .sum()
    }

    #[test]
    fn a_gyroid_has_handles_in_all_directions() {
        for (periods, cells) in [(1, 9), (2, 12), (3, 10)] {
            let mesh = gyroid(periods, cells).unwrap();
            let solid = euler_characteristic(&Grid::new(periods, periods * cells + 3));
            assert_eq!(topology::euler_characteristic(&mesh), 2 * solid, "{periods} {cells}");
            assert_eq!(topology::components(&mesh).count, 1);
            assert!(periods == 1 || solid < -10, "{solid}");
            // Half of space is solid, but for what hangs free at the rim.
            let share = volume(&mesh) / (4.0 / 3.0 * std::f64::consts::PI);
            assert!((0.3..0.55).contains(&share), "{share}");
        }
    }
}
