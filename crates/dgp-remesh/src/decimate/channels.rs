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
//! - Departs from it: planes and gradients are those of the present triangles (memoryless); in the order of
//!   collapses the values of a vertex on a seam count as if they changed by the same amount on both sides, while
//!   the values it then gets are the best ones of each chart.

use dgp_mesh::{AttributeTable, COLOR, Color, DVec2, DVec3, FaceId, Id, Mesh, NORMAL, Normal, UV};

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
    /// The sums around each vertex where it has one chart.
    spread: Vec<[f64; 6]>,
    weight: Vec<f64>,
    pull: Vec<DVec3>,
    /// Whether corners at a vertex differ.
    is_split: Vec<bool>,
}

/// Sums over the triangles around a vertex with the same values at it.
#[derive(Clone, Copy)]
struct Chart<'a> {
    /// Σ w g gᵀ over triangles and channels, and Σ w.
    spread: [f64; 6],
    weight: f64,
    /// Σ w g of each channel.
    pull: &'a [DVec3],
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
            is_split: vec![false; n],
        })
    }

    fn at(&self, f: u32, k: usize) -> usize {
        self.width * (3 * f as usize + k)
    }

    fn values_at(&self, at: usize) -> &[f64] {
        &self.values[at..at + self.width]
    }

    /// Sums anew over the triangles around `v`, whose normals are those times the root of their weight.
    pub(super) fn refresh(&mut self, rings: &Rings, normals: &[DVec3], v: u32) {
        let mut pull = std::mem::take(&mut self.pull);
        let room = &mut pull[self.width * v as usize..self.width * (v as usize + 1)];
        let corner = |&f: &u32| self.values_at(self.at(f, rings.corner(f, v)));
        let mut corners = rings.ring(v).iter().map(corner);
        let first = corners.next();
        self.is_split[v as usize] = corners.any(|other| Some(other) != first);
        let sums = self.sums(rings, normals, v, None, room);
        (self.spread[v as usize], self.weight[v as usize]) = sums;
        self.pull = pull;
    }

    /// Σ w g gᵀ, Σ w, and into `pull` Σ w g, over the triangles around `v` with the values of corner `like` at it, or over
    /// all.
    fn sums(
        &self,
        rings: &Rings,
        normals: &[DVec3],
        v: u32,
        like: Option<usize>,
        pull: &mut [DVec3],
    ) -> ([f64; 6], f64) {
        let (mut spread, mut weight) = ([0.0; 6], 0.0);
        pull.fill(DVec3::ZERO);
        for &f in rings.ring(v) {
            let k = rings.corner(f, v);
            let here = self.at(f, k);
            if like.is_some_and(|like| self.values_at(like) != self.values_at(here)) {
                continue;
            }
            let Some([along_x, along_y]) = gradients(rings, f, v) else { continue };
            let w = normals[f as usize].length_squared();
            let [next, prev] = [(k + 1) % 3, (k + 2) % 3].map(|k| self.at(f, k));
            weight += w;
            for (j, pull) in pull.iter_mut().enumerate() {
                let s = self.values[here + j];
                let (to_x, to_y) = (self.values[next + j] - s, self.values[prev + j] - s);
                if to_x == 0.0 && to_y == 0.0 {
                    continue;
                }
                let gradient = (along_x * to_x + along_y * to_y) * self.scale;
                for (entry, more) in spread.iter_mut().zip(outer(gradient, w)) {
                    *entry += more;
                }
                *pull += gradient * w;
            }
        }
        (spread, weight)
    }

    /// The chart around `v` with the values of corner `like` at it; `room` is for its sums where there are others.
    fn chart<'a>(
        &'a self,
        rings: &Rings,
        normals: &[DVec3],
        (v, like): (u32, usize),
        room: &'a mut Vec<DVec3>,
    ) -> Chart<'a> {
        let i = v as usize;
        if !self.is_split[i] {
            let pull = &self.pull[self.width * i..self.width * (i + 1)];
            return Chart { spread: self.spread[i], weight: self.weight[i], pull };
        }
        room.resize(self.width, DVec3::ZERO);
        let (spread, weight) = self.sums(rings, normals, v, Some(like), room);
        Chart { spread, weight, pull: room }
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

    /// The two sides, or one where the other is the same.
    fn distinct<'a>(&self, sides: &'a Sides) -> &'a [[usize; 2]] {
        let [left, right] = &sides.corners;
        let is_same = (0..2).all(|end| self.values_at(left[end]) == self.values_at(right[end]));
        if is_same { &sides.corners[..1] } else { &sides.corners }
    }

    /// What the edge from `v` to `w` along `e` costs with the best values, relative to `v`.
    pub(super) fn quadric(
        &self,
        rings: &Rings,
        normals: &[DVec3],
        [v, w]: [u32; 2],
        e: DVec3,
    ) -> Quadric {
        let mut sum = Quadric::ZERO;
        let Some(sides) = self.sides(rings, v, w) else { return sum };
        let (mut room_v, mut room_w) = (Vec::new(), Vec::new());
        for &[a, b] in self.distinct(&sides) {
            let at_v = self.chart(rings, normals, (v, a), &mut room_v);
            let at_w = self.chart(rings, normals, (w, b), &mut room_w);
            let weight = at_v.weight + at_w.weight;
            if !(weight > 0.0) {
                continue;
            }
            let of_w = Quadric { a: at_w.spread, ..Quadric::ZERO };
            let along = of_w.times(e);
            sum += Quadric { a: at_v.spread, ..Quadric::ZERO };
            sum += Quadric { a: at_w.spread, b: -along, c: e.dot(along) };
            for j in 0..self.width {
                let step = (self.values[b + j] - self.values[a + j]) * self.scale;
                let (pull, of_w) = (at_v.pull[j] + at_w.pull[j], at_w.pull[j]);
                let h = at_w.weight * step - of_w.dot(e);
                for (entry, more) in sum.a.iter_mut().zip(outer(pull, 1.0 / weight)) {
                    *entry -= more;
                }
                sum.b += step * of_w - pull * (h / weight);
                sum.c += step * (at_w.weight * step - 2.0 * of_w.dot(e)) - h * h / weight;
            }
        }
        sum
    }

    /// Gives corners at `v` and `w`, which are about to become one at `v + x`, the best values there: each chart by what
    /// is linear in it.
    pub(super) fn merge(&mut self, rings: &Rings, normals: &[DVec3], ends: [u32; 2], x: DVec3) {
        let Some(sides) = self.sides(rings, ends[0], ends[1]) else { return };
        let [p, q] = ends.map(|v| rings.positions[v as usize]);
        let moves = [x, x - (q - p)];
        // Both are brought up to date, for what they know may be of before their surroundings changed.
        for v in ends {
            self.refresh(rings, normals, v);
        }
        let mut goals: Vec<([usize; 2], Vec<f64>)> = Vec::new();
        for &corners in self.distinct(&sides) {
            goals.push((corners, self.best(rings, normals, (ends, corners), moves)));
        }
        let mut changed: Vec<(usize, Vec<f64>)> = Vec::new();
        for (end, v) in ends.into_iter().enumerate() {
            for &f in rings.ring(v) {
                let at = self.at(f, rings.corner(f, v));
                let seen = goals.iter().find(|g| self.values_at(g.0[end]) == self.values_at(at));
                changed.push((
                    at,
                    match seen {
                        Some((_, goal)) => goal.clone(),
                        // A chart that the edge does not touch.
                        None => self.best(rings, normals, ([v; 2], [at; 2]), [moves[end]; 2]),
                    },
                ));
            }
        }
        for (at, goal) in changed {
            self.values[at..at + self.width].copy_from_slice(&goal);
        }
    }

    /// The best values where charts at two vertices, with the values of these corners, come together.
    fn best(
        &self,
        rings: &Rings,
        normals: &[DVec3],
        (ends, corners): ([u32; 2], [usize; 2]),
        moves: [DVec3; 2],
    ) -> Vec<f64> {
        // Where a vertex was, its values are.
        if let Some(end) = moves.iter().position(|&x| x == DVec3::ZERO) {
            return self.values_at(corners[end]).to_vec();
        }
        let (mut room_v, mut room_w) = (Vec::new(), Vec::new());
        let at_v = self.chart(rings, normals, (ends[0], corners[0]), &mut room_v);
        let at_w = self.chart(rings, normals, (ends[1], corners[1]), &mut room_w);
        let weight = (at_v.weight + at_w.weight) * self.scale;
        let value = |j: usize| {
            let [a, b] = corners.map(|corner| self.values[corner + j]);
            let pull = at_v.pull[j].dot(moves[0]) + at_w.pull[j].dot(moves[1]);
            let t = (pull + at_w.weight * (b - a) * self.scale) / weight;
            if t != 0.0 && (a + t).is_finite() { a + t } else { a }
        };
        (0..self.width).map(value).collect()
    }

    /// Puts the values into `mesh`, which has what is left of `rings` in the same order; `number` has the number of
    /// each vertex there.
    pub(super) fn give_back(&self, rings: &Rings, number: &[u32], mesh: &mut Mesh) {
        let mut corners = Vec::with_capacity(3 * rings.face_count);
        for (new, (old, face)) in rings.left().enumerate() {
            for h in mesh.face_halfedges(FaceId::new(new)) {
                let v = mesh.from(h);
                let k = face
                    .iter()
                    .position(|&u| u != NONE && number[u as usize] as usize == v.index());
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

/// The gradients in `f` of what is 1 at one of the corners after `v` and 0 at the others; `None` without area.
#[inline]
fn gradients(rings: &Rings, f: u32, v: u32) -> Option<[DVec3; 2]> {
    let origin = rings.positions[v as usize];
    let [x, y] = rings.others(f, v).map(|u| rings.positions[u as usize] - origin);
    let area = x.cross(y);
    let square = area.length_squared();
    (square > 0.0).then(|| [y.cross(area) / square, area.cross(x) / square])
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
