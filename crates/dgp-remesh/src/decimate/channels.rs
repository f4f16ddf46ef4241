//! Data as further dimensions of decimation by quadrics.
//!
//! ```text
//! E(x, t) = Σ over a, b  Σ over triangles around it  w Σ over channels (g·(x − a) − t + s_a)²
//! t       = (G·x + h) / W      G = Σ w g,  W = Σ w,  h = w_b δ − G_b·e,  δ = s_b − s_a,  e = b − a
//! ```
//!
//! g is the gradient of a channel in a triangle, s what it is at a vertex, t its change at the vertex that
//! remains. With the best t of every position the rest is a quadric of the position alone, so that the
//! systems stay of three equations whatever the number of channels.
//!
//! - Input: normals, colors and texture coordinates of vertices and corners, of which all numbers are finite.
//! - Cost: O(channels) where a vertex or an edge is looked at.
//! - Guarantees: what is linear in a plane stays so to rounding; a seam stays a seam; values that do not
//!   change keep their bits.
//! - Reference: Hoppe, "New quadric metric for simplifying meshes with appearance attributes", Visualization
//!   1999.
//! - Departs from it: planes and gradients are those of the present triangles (memoryless); values of a
//!   vertex on a seam change by the same amount on both sides, and along a seam they are interpolated.

use dgp_mesh::{
    AttributeTable, COLOR, Color, DVec2, DVec3, FaceId, Id, Mesh, NORMAL, Normal, UV,
};

use super::rings::{NONE, Rings};
use crate::quadric::{Quadric, outer};

/// Numbers at corners, and how they change around vertices.
pub(super) struct Channels {
    /// Numbers a corner.
    width: usize,
    columns: Vec<Column>,
    /// Of corner k of face f from `width * (3 f + k)` on.
    values: Vec<f64>,
    /// How long a difference of 1 is.
    scale: f64,
    /// Of each vertex Σ w g gᵀ over triangles and channels, and Σ w.
    spread: Vec<[f64; 6]>,
    weight: Vec<f64>,
    /// Of each vertex and channel Σ w g.
    pull: Vec<DVec3>,
}

/// A column of a table of data.
#[derive(Clone, Copy)]
struct Column {
    name: &'static str,
    is_of_corners: bool,
    first: usize,
}

/// What an edge adds to the quadric of its position, and what is needed for the values there.
#[derive(Clone, Copy)]
pub(super) struct Sides {
    /// Corners at both ends in the triangles at the edge; the second pair is the first at a rim.
    corners: [[usize; 2]; 2],
}

impl Channels {
    /// Of normals, colors and texture coordinates of `mesh`; `None` if there are none of finite numbers.
    pub(super) fn new(mesh: &Mesh, rings: &Rings, scale: f64) -> Option<Self> {
        let data = mesh.attributes();
        let mut columns = Vec::new();
        let mut width = 0;
        for name in [NORMAL, COLOR, UV] {
            let of_vertices = width_of(&data.vertex, name);
            let of_corners = width_of(&data.corner, name);
            for (count, is_of_corners) in [(of_vertices, false), (of_corners, true)] {
                if count > 0 {
                    columns.push(Column { name, is_of_corners, first: width });
                    width += count;
                }
            }
        }
        let mut values = vec![0.0; 3 * rings.faces.len() * width];
        for (f, face) in mesh.faces().zip(&rings.faces) {
            for h in mesh.face_halfedges(f) {
                let v = mesh.from(h);
                let k = if face[0] as usize == v.index() {
                    0
                } else if face[1] as usize == v.index() {
                    1
                } else {
                    2
                };
                let at = width * (3 * f.index() + k);
                for column in &columns {
                    let room = &mut values[at + column.first..];
                    if column.is_of_corners {
                        unpack(&data.corner, column.name, h, room);
                    } else {
                        unpack(&data.vertex, column.name, v, room);
                    }
                }
            }
        }
        let n = rings.positions.len();
        let is_usable = width > 0 && values.iter().all(|x| x.is_finite());
        is_usable.then(|| Channels {
            width,
            columns,
            values,
            scale,
            spread: vec![[0.0; 6]; n],
            weight: vec![0.0; n],
            pull: vec![DVec3::ZERO; n * width],
        })
    }

    fn at(&self, f: u32, k: usize) -> usize {
        self.width * (3 * f as usize + k)
    }

    /// Sums anew over the triangles around `v`, whose normals are those times the root of their weight.
    pub(super) fn refresh(&mut self, rings: &Rings, normals: &[DVec3], v: u32) {
        let (mut spread, mut weight) = ([0.0; 6], 0.0);
        let pull = self.width * v as usize..self.width * (v as usize + 1);
        self.pull[pull.clone()].fill(DVec3::ZERO);
        let origin = rings.positions[v as usize];
        for &f in rings.ring(v) {
            let w = normals[f as usize].length_squared();
            let [x, y] = rings.others(f, v).map(|u| rings.positions[u as usize] - origin);
            let area = x.cross(y);
            let square = area.length_squared();
            if !(square > 0.0) {
                continue;
            }
            // Gradients of what is 1 at one of the others and 0 at the rest.
            let [along_x, along_y] = [y.cross(area) / square, area.cross(x) / square];
            let k = rings.corner(f, v);
            let here = self.at(f, k);
            let [next, prev] = [(k + 1) % 3, (k + 2) % 3].map(|k| self.at(f, k));
            weight += w;
            for j in 0..self.width {
                let s = self.values[here + j];
                let (to_x, to_y) = (self.values[next + j] - s, self.values[prev + j] - s);
                if to_x == 0.0 && to_y == 0.0 {
                    continue;
                }
                let gradient = (along_x * to_x + along_y * to_y) * self.scale;
                for (entry, more) in spread.iter_mut().zip(outer(gradient, w)) {
                    *entry += more;
                }
                self.pull[pull.start + j] += gradient * w;
            }
        }
        self.spread[v as usize] = spread;
        self.weight[v as usize] = weight;
    }

    /// The corners at `v` and `w` in the triangles at their edge.
    pub(super) fn sides(&self, rings: &Rings, v: u32, w: u32) -> Option<Sides> {
        let mut corners = [[0; 2]; 2];
        let mut count = 0;
        for &f in rings.ring(v).iter().filter(|&&f| rings.others(f, v).contains(&w)).take(2) {
            corners[count] = [self.at(f, rings.corner(f, v)), self.at(f, rings.corner(f, w))];
            count += 1;
        }
        if count == 1 {
            corners[1] = corners[0];
        }
        (count > 0).then_some(Sides { corners })
    }

    /// δ of channel `j`.
    #[inline]
    fn step(&self, sides: &Sides, j: usize) -> f64 {
        let of = |[a, b]: [usize; 2]| self.values[b + j] - self.values[a + j];
        0.5 * (of(sides.corners[0]) + of(sides.corners[1])) * self.scale
    }

    /// G and h of channel `j`.
    #[inline]
    fn line(&self, [v, w]: [u32; 2], e: DVec3, step: f64, j: usize) -> (DVec3, DVec3, f64) {
        let [of_v, of_w] = [v, w].map(|x| self.pull[self.width * x as usize + j]);
        (of_v + of_w, of_w, self.weight[w as usize] * step - of_w.dot(e))
    }

    /// What the edge from `v` to `w` along `e` costs with the best values, relative to `v`.
    pub(super) fn quadric(&self, rings: &Rings, [v, w]: [u32; 2], e: DVec3) -> Quadric {
        let (i, j) = (v as usize, w as usize);
        let weight = self.weight[i] + self.weight[j];
        let Some(sides) = self.sides(rings, v, w).filter(|_| weight > 0.0) else {
            return Quadric::ZERO;
        };
        let of_w = Quadric { a: self.spread[j], ..Quadric::ZERO };
        let along = of_w.times(e);
        let mut sum = Quadric { a: self.spread[j], b: -along, c: e.dot(along) };
        for (entry, more) in sum.a.iter_mut().zip(self.spread[i]) {
            *entry += more;
        }
        for channel in 0..self.width {
            let step = self.step(&sides, channel);
            let (pull, of_w, h) = self.line([v, w], e, step, channel);
            for (entry, more) in sum.a.iter_mut().zip(outer(pull, 1.0 / weight)) {
                *entry -= more;
            }
            sum.b += step * of_w - pull * (h / weight);
            sum.c += step * (self.weight[j] * step - 2.0 * of_w.dot(e)) - h * h / weight;
        }
        sum
    }

    /// Gives corners at `v` and `w`, which are about to become one at `v + x`, their values there.
    pub(super) fn merge(&mut self, rings: &Rings, [v, w]: [u32; 2], x: DVec3) {
        let Some(sides) = self.sides(rings, v, w) else { return };
        let e = rings.positions[w as usize] - rings.positions[v as usize];
        let weight = self.weight[v as usize] + self.weight[w as usize];
        let fraction = if x == DVec3::ZERO {
            0.0
        } else if x == e {
            1.0
        } else {
            (x.dot(e) / e.length_squared()).clamp(0.0, 1.0)
        };
        let is_at_end = fraction == 0.0 && x == DVec3::ZERO || x == e;
        for j in 0..self.width {
            let seen = sides.corners.map(|pair| pair.map(|corner| self.values[corner + j]));
            let between = |[a, b]: [f64; 2]| {
                if a == b || fraction == 0.0 {
                    a
                } else if fraction == 1.0 {
                    b
                } else {
                    a + (b - a) * fraction
                }
            };
            let mut goals = seen.map(between);
            if seen[0] == seen[1] && !is_at_end && weight > 0.0 {
                let step = self.step(&sides, j);
                let (pull, _, h) = self.line([v, w], e, step, j);
                let t = (pull.dot(x) + h) / weight / self.scale;
                let best = seen[0][0] + t;
                if t != 0.0 && best.is_finite() {
                    goals = [best; 2];
                }
            }
            for (end, vertex) in [v, w].into_iter().enumerate() {
                for &f in rings.ring(vertex) {
                    let at = self.at(f, rings.corner(f, vertex)) + j;
                    let value = self.values[at];
                    self.values[at] = if value == seen[0][end] {
                        goals[0]
                    } else if value == seen[1][end] {
                        goals[1]
                    } else {
                        value + (goals[0] - seen[0][end])
                    };
                }
            }
        }
    }

    /// Puts the values into `mesh`, which has what is left of `rings` in the same order; `number` has the number of
    /// each vertex there.
    pub(super) fn give_back(&self, rings: &Rings, number: &[u32], mesh: &mut Mesh) {
        let mut corners = Vec::with_capacity(3 * rings.face_count);
        for (new, (old, face)) in rings.left().enumerate() {
            for h in mesh.face_halfedges(FaceId::new(new)) {
                let v = mesh.from(h);
                let k = face.iter().position(|&u| u != NONE && number[u as usize] as usize == v.index());
                corners.extend(k.map(|k| (h, v, self.at(old.index() as u32, k))));
            }
        }
        let data = mesh.attributes_mut();
        for column in &self.columns {
            let values = |at: usize| &self.values[at + column.first..];
            if column.is_of_corners {
                let all = corners.iter().map(|&(h, _, at)| (h, values(at)));
                pack(&mut data.corner, column.name, all);
            } else {
                let all = corners.iter().map(|&(_, v, at)| (v, values(at)));
                pack(&mut data.vertex, column.name, all);
            }
        }
    }
}

/// How many numbers a value of the column has; 0 if there is none of the type that the name stands for.
fn width_of<I: Id>(table: &AttributeTable<I>, name: &str) -> usize {
    if table.get::<Normal>(name).is_some() {
        3
    } else if table.get::<Color>(name).is_some() {
        4
    } else if table.get::<DVec2>(name).is_some() {
        2
    } else {
        0
    }
}

fn unpack<I: Id>(table: &AttributeTable<I>, name: &str, id: I, room: &mut [f64]) {
    if let Some(column) = table.get::<Normal>(name) {
        room[..3].copy_from_slice(&column[id].0.to_array());
    } else if let Some(column) = table.get::<Color>(name) {
        room[..4].copy_from_slice(&column[id].0.map(f64::from));
    } else if let Some(column) = table.get::<DVec2>(name) {
        room[..2].copy_from_slice(&column[id].to_array());
    }
}

fn pack<'a, I: Id>(
    table: &mut AttributeTable<I>,
    name: &str,
    values: impl Iterator<Item = (I, &'a [f64])>,
) {
    if let Some(column) = table.get_mut::<Normal>(name) {
        for (id, x) in values {
            let normal = DVec3::new(x[0], x[1], x[2]);
            // Those that did not change keep their bits.
            if column[id.index()].0 != normal {
                column[id.index()] = Normal(normal.normalize_or_zero());
            }
        }
    } else if let Some(column) = table.get_mut::<Color>(name) {
        for (id, x) in values {
            column[id.index()] = Color([0, 1, 2, 3].map(|k| (x[k] as f32).clamp(0.0, 1.0)));
        }
    } else if let Some(column) = table.get_mut::<DVec2>(name) {
        for (id, x) in values {
            column[id.index()] = DVec2::new(x[0], x[1]);
        }
    }
}
