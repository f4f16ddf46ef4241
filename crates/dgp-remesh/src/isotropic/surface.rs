//! The triangles that remeshing edits: half-edges in place, three to a triangle.
//!
//! Half-edge k of triangle f has the number 4f + k, so that the next and the previous one are arithmetic and a
//! triangle is read at once. Corner k of a triangle is where its half-edge k starts. Triangles and vertices that
//! are gone leave their places to new ones.

use dgp_mesh::{DVec3, HalfedgeId, Mesh, spatial::Near};

use crate::Error;

/// No vertex, no half-edge, no line.
pub(super) const NONE: u32 = u32::MAX;

/// More triangles than this are refused rather than run out of memory on.
pub(super) const MOST_TRIANGLES: usize = 1 << 26;

/// A triangle, by its half-edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triangle {
    /// Where each half-edge starts; the first is `NONE` if the triangle is gone.
    pub(super) from: [u32; 3],
    /// The half-edge on the other side, `NONE` at a rim.
    pub(super) twin: [u32; 3],
    /// The line that runs along it, or `NONE`.
    pub(super) line: [u32; 3],
}

const GONE: Triangle = Triangle { from: [NONE; 3], twin: [NONE; 3], line: [NONE; 3] };

/// How a vertex may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Freedom {
    /// On the surface.
    Free,
    /// Along its line.
    Line,
    /// Not at all.
    Fixed,
}

/// What is known of a vertex beside where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    /// A half-edge that leaves it, at a rim the first one counterclockwise; `NONE` if it is on no triangle.
    pub(super) spoke: u32,
    /// How many edges it has.
    pub(super) valence: u32,
    /// How many it should have.
    pub(super) wanted: u32,
    pub(super) freedom: Freedom,
    pub(super) on_rim: bool,
    /// Whether it is there at all.
    pub(super) is_there: bool,
    /// The line it is on, if it may move along one, and where on it, as the length from the start.
    pub(super) line: u32,
    pub(super) along: f64,
    /// The length edges should have here.
    pub(super) size: f64,
    /// What was nearest on the input.
    pub(super) near: Near,
}

impl Vertex {
    pub(super) fn new(size: f64) -> Self {
        Vertex {
            spoke: NONE,
            valence: 0,
            wanted: 6,
            freedom: Freedom::Free,
            on_rim: false,
            is_there: true,
            line: NONE,
            along: 0.0,
            size,
            near: Near::default(),
        }
    }
}

#[inline]
pub(super) fn next(h: u32) -> u32 {
    if h & 3 == 2 { h - 2 } else { h + 1 }
}

#[inline]
pub(super) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(4) { h + 2 } else { h - 1 }
}

/// Triangles of a manifold, with holes perhaps.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) triangles: Vec<Triangle>,
    pub(super) positions: Vec<DVec3>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) face_count: usize,
    free_triangles: Vec<u32>,
    free_vertices: Vec<u32>,
    /// When a vertex was last met, for [`may_collapse`](Surface::may_collapse).
    marks: Vec<u32>,
    now: u32,
}

impl Surface {
    /// The triangles of `mesh` at other `positions`, with vertices that are free.
    pub(super) fn new(mesh: &Mesh, positions: Vec<DVec3>, size: f64) -> Result<Self, Error> {
        if mesh.face_count() > MOST_TRIANGLES {
            return Err(too_many(mesh.face_count()));
        }
        let mut place = vec![NONE; mesh.halfedge_count()];
        let mut sides: Vec<[HalfedgeId; 3]> = Vec::with_capacity(mesh.face_count());
        for f in mesh.faces() {
            let h = mesh.face_halfedge(f);
            let before = mesh.prev(h);
            let after = mesh.prev(before);
            if mesh.prev(after) != h {
                return Err(Error::NotTriangle { face: f, degree: mesh.degree(f) });
            }
            for (k, side) in [h, after, before].into_iter().enumerate() {
                place[side.index()] = (f.index() * 4 + k) as u32;
            }
            sides.push([h, after, before]);
        }
        let mut triangles = Vec::with_capacity(sides.len() + sides.len() / 4);
        triangles.extend(sides.iter().map(|side| Triangle {
            from: side.map(|h| mesh.from(h).index() as u32),
            twin: side.map(|h| place[h.twin().index()]),
            line: [NONE; 3],
        }));
        let count = positions.len();
        let vertices = mesh.vertices().map(|v| {
            let mut vertex = Vertex::new(size);
            if let Some(h) = mesh.vertex_halfedge(v) {
                vertex.on_rim = mesh.face(h).is_none();
                // The half-edge without a face is the last one counterclockwise.
                let first = if vertex.on_rim { mesh.ccw(h) } else { h };
                vertex.spoke = place[first.index()];
                vertex.valence = mesh.valence(v) as u32;
                vertex.wanted = if vertex.on_rim { 4 } else { 6 };
            } else {
                vertex.freedom = Freedom::Fixed;
            }
            vertex
        });
        Ok(Surface {
            face_count: triangles.len(),
            vertices: vertices.collect(),
            triangles,
            positions,
            free_triangles: Vec::new(),
            free_vertices: Vec::new(),
            marks: vec![0; count],
            now: 0,
        })
    }

    #[inline]
    pub(super) fn from(&self, h: u32) -> u32 {
        self.triangles[(h >> 2) as usize].from[(h & 3) as usize]
    }

    #[inline]
    pub(super) fn to(&self, h: u32) -> u32 {
        self.from(next(h))
    }

    #[inline]
    pub(super) fn twin(&self, h: u32) -> u32 {
        self.triangles[(h >> 2) as usize].twin[(h & 3) as usize]
    }

    #[inline]
    pub(super) fn line(&self, h: u32) -> u32 {
        self.triangles[(h >> 2) as usize].line[(h & 3) as usize]
    }

    pub(super) fn set_line(&mut self, h: u32, line: u32) {
        self.triangles[(h >> 2) as usize].line[(h & 3) as usize] = line;
    }

    /// Whether triangle `f` is there.
    #[inline]
    pub(super) fn has(&self, f: usize) -> bool {
        self.triangles[f].from[0] != NONE
    }

    #[inline]
    pub(super) fn position(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    #[inline]
    pub(super) fn vertex(&self, v: u32) -> &Vertex {
        &self.vertices[v as usize]
    }

    /// The squared length of the edge of `h`.
    #[inline]
    pub(super) fn square(&self, h: u32) -> f64 {
        (self.position(self.from(h)) - self.position(self.to(h))).length_squared()
    }

    /// The length an edge of these ends should have.
    #[inline]
    pub(super) fn size(&self, a: u32, b: u32) -> f64 {
        self.vertex(a).size.min(self.vertex(b).size)
    }

    /// The half-edges of triangles that leave `v`, counterclockwise.
    #[inline]
    pub(super) fn spokes(&self, v: u32) -> Spokes<'_> {
        let start = self.vertex(v).spoke;
        Spokes { surface: self, start, at: start }
    }

    /// Calls `visit` with every neighbor of `v`.
    #[inline]
    pub(super) fn each_neighbor(&self, v: u32, mut visit: impl FnMut(u32)) {
        let mut last = NONE;
        for h in self.spokes(v) {
            visit(self.to(h));
            last = h;
        }
        if self.vertex(v).on_rim && last != NONE {
            visit(self.from(prev(last)));
        }
    }

    /// Whether an edge joins `v` and `w`.
    #[inline]
    pub(super) fn are_joined(&self, v: u32, w: u32) -> bool {
        self.spokes(v).any(|h| self.to(h) == w || self.from(prev(h)) == w)
    }

    /// The neighbors of `v` along lines; of more than two the first two.
    pub(super) fn line_neighbors(&self, v: u32) -> [u32; 2] {
        let mut found = [NONE; 2];
        let mut count = 0;
        let mut last = NONE;
        for h in self.spokes(v) {
            if self.line(h) != NONE && count < 2 {
                found[count] = self.to(h);
                count += 1;
            }
            last = h;
        }
        if self.vertex(v).on_rim && last != NONE && count < 2 {
            found[count] = self.from(prev(last));
        }
        found
    }

    /// Twice the vector area of a triangle of these corners.
    #[inline]
    pub(super) fn area(&self, [a, b, c]: [u32; 3]) -> DVec3 {
        let p = self.position(a);
        (self.position(b) - p).cross(self.position(c) - p)
    }

    fn put_twins(&mut self, h: u32, g: u32) {
        if h != NONE {
            self.triangles[(h >> 2) as usize].twin[(h & 3) as usize] = g;
        }
        if g != NONE {
            self.triangles[(g >> 2) as usize].twin[(g & 3) as usize] = h;
        }
    }

    fn new_vertex(&mut self, position: DVec3, vertex: Vertex) -> u32 {
        if let Some(v) = self.free_vertices.pop() {
            self.positions[v as usize] = position;
            self.vertices[v as usize] = vertex;
            return v;
        }
        self.positions.push(position);
        self.vertices.push(vertex);
        self.marks.push(0);
        (self.positions.len() - 1) as u32
    }

    fn new_triangle(&mut self, triangle: Triangle) -> u32 {
        self.face_count += 1;
        if let Some(f) = self.free_triangles.pop() {
            self.triangles[f as usize] = triangle;
            return f;
        }
        self.triangles.push(triangle);
        (self.triangles.len() - 1) as u32
    }

    /// Splits the edge of `h` by a vertex at `position`, whose spoke and valence are set here.
    ///
    /// ```text
    ///      c              c
    ///     /f\           /f|f2\
    ///    a-h-b    →    a--m---b
    ///     \g/           \g|g2/
    ///      d              d
    /// ```
    pub(super) fn split(&mut self, h: u32, position: DVec3, vertex: Vertex) -> Result<u32, Error> {
        if self.face_count + 2 > MOST_TRIANGLES {
            return Err(too_many(self.face_count + 2));
        }
        let t = self.twin(h);
        let (b, c, line) = (self.to(h), self.from(prev(h)), self.line(h));
        let m = self.new_vertex(position, vertex);
        let (h_next, outer) = (next(h), self.twin(next(h)));
        let f2 = self.new_triangle(Triangle {
            from: [m, b, c],
            twin: [NONE; 3],
            line: [line, self.line(h_next), NONE],
        });
        let f2 = f2 * 4;
        self.triangles[(h >> 2) as usize].from[(h_next & 3) as usize] = m;
        self.set_line(h_next, NONE);
        self.put_twins(f2 + 1, outer);
        self.put_twins(h_next, f2 + 2);
        if self.vertex(b).spoke == h_next {
            self.vertices[b as usize].spoke = f2 + 1;
        }
        self.vertices[c as usize].valence += 1;
        let mut valence = 3;
        if t != NONE {
            valence = 4;
            let d = self.from(prev(t));
            let (t_prev, outer) = (prev(t), self.twin(prev(t)));
            let g2 = self.new_triangle(Triangle {
                from: [b, m, d],
                twin: [NONE; 3],
                line: [line, NONE, self.line(t_prev)],
            });
            let g2 = g2 * 4;
            self.triangles[(t >> 2) as usize].from[(t & 3) as usize] = m;
            self.set_line(t_prev, NONE);
            self.put_twins(g2 + 2, outer);
            self.put_twins(t_prev, g2 + 1);
            self.put_twins(f2, g2);
            if self.vertex(b).spoke == t {
                self.vertices[b as usize].spoke = g2;
            }
            if self.vertex(d).spoke == t_prev {
                self.vertices[d as usize].spoke = g2 + 2;
            }
            self.vertices[d as usize].valence += 1;
        }
        let vertex = &mut self.vertices[m as usize];
        vertex.spoke = f2;
        vertex.valence = valence;
        vertex.on_rim = t == NONE;
        Ok(m)
    }

    /// Whether the surface remains a manifold of the same topology, and no line vanishes or meets another, when
    /// the ends of `h` are joined.
    pub(super) fn may_collapse(&mut self, h: u32) -> bool {
        let t = self.twin(h);
        let (a, b) = (self.from(h), self.to(h));
        // An edge inside whose ends are both on rims would pinch the surface.
        if t != NONE && self.vertex(a).on_rim && self.vertex(b).on_rim {
            return false;
        }
        let mut common = 0;
        for side in [h, t] {
            if side == NONE {
                continue;
            }
            common += 1;
            let (after, before) = (next(side), prev(side));
            let apex = *self.vertex(self.from(before));
            let least = if apex.on_rim { 2 } else { 3 };
            let is_ear = self.twin(after) == NONE && self.twin(before) == NONE;
            let both_lines = self.line(after) != NONE && self.line(before) != NONE;
            if apex.valence <= least || is_ear || both_lines {
                return false;
            }
        }
        if self.now == u32::MAX {
            self.marks.fill(0);
            self.now = 0;
        }
        self.now += 1;
        let (now, mut marks) = (self.now, std::mem::take(&mut self.marks));
        self.each_neighbor(a, |w| marks[w as usize] = now);
        let mut met = 0;
        self.each_neighbor(b, |w| met += usize::from(marks[w as usize] == now));
        self.marks = marks;
        met == common
    }

    /// Joins the ends of `h`, of which `goes` vanishes, after [`may_collapse`](Self::may_collapse). The caller moves
    /// the one that is left.
    pub(super) fn collapse(&mut self, h: u32, goes: u32) {
        let t = self.twin(h);
        let stays = if self.from(h) == goes { self.to(h) } else { self.from(h) };
        let start = self.vertex(goes).spoke;
        let mut at = start;
        loop {
            let before = prev(at);
            self.triangles[(at >> 2) as usize].from[(at & 3) as usize] = stays;
            at = self.twin(before);
            if at == NONE || at == start {
                break;
            }
        }
        let mut spoke = NONE;
        let mut shared = 0;
        for side in [h, t] {
            if side == NONE {
                continue;
            }
            shared += 1;
            let (after, before) = (next(side), prev(side));
            let c = self.from(before);
            let (x, y) = (self.twin(after), self.twin(before));
            let line = self.line(after).min(self.line(before));
            self.put_twins(x, y);
            for outer in [x, y] {
                if outer != NONE {
                    self.set_line(outer, line);
                }
            }
            // x leaves the apex; without it the apex is on the rim and has another spoke.
            if self.vertex(c).spoke == before {
                self.vertices[c as usize].spoke = x;
            }
            self.vertices[c as usize].valence -= 1;
            // Either is there, or the apex would have lost its last triangle. y leaves what stays.
            spoke = if y == NONE { next(x) } else { y };
            self.triangles[(side >> 2) as usize] = GONE;
            self.free_triangles.push(side >> 2);
            self.face_count -= 1;
        }
        let removed = self.vertices[goes as usize];
        let kept = &mut self.vertices[stays as usize];
        kept.valence = kept.valence + removed.valence - 2 - shared;
        kept.on_rim |= removed.on_rim;
        let removed = &mut self.vertices[goes as usize];
        removed.spoke = NONE;
        removed.is_there = false;
        self.free_vertices.push(goes);
        self.vertices[stays as usize].spoke = self.first_spoke(spoke);
    }

    /// The first spoke counterclockwise of the vertex `h` leaves.
    fn first_spoke(&self, h: u32) -> u32 {
        let mut at = h;
        loop {
            let t = self.twin(at);
            if t == NONE {
                return at;
            }
            at = next(t);
            if at == h {
                return h;
            }
        }
    }

    /// Turns the edge of `h`, which is inside, to the other diagonal. The caller has made sure that no edge is
    /// there.
    pub(super) fn flip(&mut self, h: u32) {
        let t = self.twin(h);
        let (h1, h2, t1, t2) = (next(h), prev(h), next(t), prev(t));
        let [a, b, c, d] = [self.from(h), self.from(t), self.from(h2), self.from(t2)];
        let [x, y, z, w] = [h1, h2, t1, t2].map(|s| (self.twin(s), self.line(s)));
        let put = |surface: &mut Surface, side: u32, from: u32, (twin, line): (u32, u32)| {
            surface.triangles[(side >> 2) as usize].from[(side & 3) as usize] = from;
            surface.set_line(side, line);
            surface.put_twins(side, twin);
        };
        put(self, h, d, (t, NONE));
        put(self, h1, c, y);
        put(self, h2, a, z);
        put(self, t, c, (h, NONE));
        put(self, t1, d, w);
        put(self, t2, b, x);
        let vertices = &mut self.vertices;
        for (v, old, new, change) in
            [(a, [h, t1], h2, -1), (b, [t, h1], t2, -1), (c, [h2; 2], h1, 1), (d, [t2; 2], t1, 1)]
        {
            let vertex = &mut vertices[v as usize];
            if old.contains(&vertex.spoke) {
                vertex.spoke = new;
            }
            vertex.valence = vertex.valence.wrapping_add_signed(change);
        }
    }
}

/// The half-edges that leave a vertex: see [`Surface::spokes`].
pub(super) struct Spokes<'a> {
    surface: &'a Surface,
    start: u32,
    at: u32,
}

impl Iterator for Spokes<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let h = self.at;
        if h == NONE {
            return None;
        }
        let after = self.surface.twin(prev(h));
        self.at = if after == self.start { NONE } else { after };
        Some(h)
    }
}

fn too_many(count: usize) -> Error {
    let limit = MOST_TRIANGLES;
    Error::Mesh(dgp_mesh::Error::TooMany { kind: "triangles", count, limit })
}

#[cfg(test)]
mod tests;
