//! Triangles and, for each vertex, the list of those around it: what the fast decimator edits.
//!
//! A ring is a run of numbers in one long array, so that its triangles are fetched side by side instead of one
//! after the other as walking along half-edges does. A ring that grows beyond its room moves to the end.

use dgp_mesh::{DVec3, FaceId, FaceList, Mesh, VertexId};

use crate::Error;

/// No vertex, no face.
pub(crate) const NONE: u32 = u32::MAX;

/// What a side of a triangle is; side k leads from corner k to the next one.
pub(crate) const RIM: u8 = 1;
/// Sides where the surface is sharp, see [`RIM`].
pub(crate) const SHARP: u8 = 8;

/// Where the triangles of a vertex are listed.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: u32,
    len: u32,
    room: u32,
}

/// Triangles of a manifold, with holes perhaps.
#[derive(Clone, Debug)]
pub(crate) struct Rings {
    pub(crate) positions: Vec<DVec3>,
    /// The corners; of triangles that are gone the first is `NONE`.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Bits `RIM << k` and `SHARP << k` of side k.
    pub(crate) sides: Vec<u8>,
    /// Whether a vertex is on the rim of a hole.
    pub(crate) on_rim: Vec<bool>,
    runs: Vec<Run>,
    lists: Vec<u32>,
    pub(crate) face_count: usize,
    pub(crate) vertex_count: usize,
}

/// What a collapse does to the neighborhood.
pub(crate) struct Shared {
    /// The triangles that vanish, and the corner of each that is not on the edge.
    pub(crate) faces: [(u32, u32); 2],
    pub(crate) count: usize,
}

impl Rings {
    /// The triangles of `mesh`; positions are put in by the caller.
    pub(crate) fn new(mesh: &Mesh, positions: Vec<DVec3>) -> Result<Self, Error> {
        let mut faces = Vec::with_capacity(mesh.face_count());
        let mut sides = Vec::with_capacity(mesh.face_count());
        for f in mesh.faces() {
            // The corners are walked to by `prev`, which is what is stored.
            let h = mesh.face_halfedge(f);
            let before = mesh.prev(h);
            let after = mesh.prev(before);
            if mesh.prev(after) != h {
                return Err(Error::NotTriangle { face: f, degree: mesh.degree(f) });
            }
            faces.push([mesh.to(before), mesh.to(h), mesh.to(after)].map(|v| v.index() as u32));
            let mut bits = 0;
            for (k, g) in [h, after, before].into_iter().enumerate() {
                if mesh.face(g.twin()).is_none() {
                    bits |= RIM << k;
                }
            }
            sides.push(bits);
        }
        let on_rim = mesh
            .vertices()
            .map(|v| mesh.vertex_halfedge(v).is_some_and(|h| mesh.face(h).is_none()));
        let on_rim: Vec<bool> = on_rim.collect();
        let (runs, lists) = listed(mesh.vertex_count(), &faces);
        let (face_count, vertex_count) = (faces.len(), mesh.vertex_count());
        Ok(Rings { positions, faces, sides, on_rim, runs, lists, face_count, vertex_count })
    }

    /// The triangles around `v`.
    #[inline]
    pub(crate) fn ring(&self, v: u32) -> &[u32] {
        let run = self.runs[v as usize];
        &self.lists[run.start as usize..(run.start + run.len) as usize]
    }

    /// How many triangles there are around `v`.
    #[inline]
    pub(crate) fn ring_len(&self, v: u32) -> usize {
        self.runs[v as usize].len as usize
    }

    /// At which corner of `f` `v` is.
    #[inline]
    pub(crate) fn corner(&self, f: u32, v: u32) -> usize {
        let [a, b, _] = self.faces[f as usize];
        if a == v {
            0
        } else if b == v {
            1
        } else {
            2
        }
    }

    /// The corners of `f` after `v`, counterclockwise.
    #[inline]
    pub(crate) fn others(&self, f: u32, v: u32) -> [u32; 2] {
        let [a, b, c] = self.faces[f as usize];
        if a == v {
            [b, c]
        } else if b == v {
            [c, a]
        } else {
            [a, b]
        }
    }

    /// Calls `visit` with every neighbor of `v`.
    #[inline]
    pub(crate) fn each_neighbor(&self, v: u32, mut visit: impl FnMut(u32)) {
        let on_rim = self.on_rim[v as usize];
        for &f in self.ring(v) {
            let [next, prev] = self.others(f, v);
            visit(next);
            if on_rim {
                let k = self.corner(f, v);
                let incoming = if k == 0 { 2 } else { k - 1 };
                if self.sides[f as usize] & (RIM << incoming) != 0 {
                    visit(prev);
                }
            }
        }
    }

    /// The triangles at the edge from `a` to `b`.
    #[inline]
    pub(crate) fn shared(&self, a: u32, b: u32) -> Shared {
        let mut shared = Shared { faces: [(NONE, NONE); 2], count: 0 };
        for &f in self.ring(a) {
            let [x, y] = self.others(f, a);
            if x == b || y == b {
                if shared.count < 2 {
                    shared.faces[shared.count] = (f, if x == b { y } else { x });
                }
                shared.count += 1;
            }
        }
        shared
    }

    /// Whether the collapse of the edge keeps a manifold of the same topology; `marks` holds for each vertex
    /// when it was last met, `now` is later than all of them.
    #[inline]
    pub(crate) fn may_collapse(
        &self,
        a: u32,
        b: u32,
        shared: &Shared,
        marks: &mut [u32],
        now: u32,
    ) -> bool {
        let rims = (self.on_rim[a as usize], self.on_rim[b as usize]);
        // An edge inside whose ends are both on rims would pinch the surface.
        if shared.count == 0 || shared.count > 2 || (rims == (true, true) && shared.count == 2) {
            return false;
        }
        for &(f, apex) in &shared.faces[..shared.count] {
            // The last triangle of its corner would go.
            if rim_sides_at(self, f, apex) == 2 {
                return false;
            }
            // An inner vertex that would keep two triangles.
            if self.ring_len(apex) <= 3 && !self.on_rim[apex as usize] {
                return false;
            }
        }
        self.each_neighbor(a, |w| marks[w as usize] = now);
        let mut common = 0;
        self.each_neighbor(b, |w| common += usize::from(marks[w as usize] == now));
        common == shared.count
    }

    /// Moves `a` into `b`, whose position the caller sets.
    pub(crate) fn collapse(&mut self, a: u32, b: u32, shared: &Shared) {
        for &(f, apex) in &shared.faces[..shared.count] {
            self.fold(f, a, b, apex);
            self.drop_from(apex, f);
            self.drop_from(b, f);
            self.faces[f as usize][0] = NONE;
            self.face_count -= 1;
        }
        let from = self.runs[a as usize];
        let gone = &shared.faces[..shared.count];
        // What stays of the ring of a, in place.
        let mut left = 0;
        for k in from.start..from.start + from.len {
            let f = self.lists[k as usize];
            if gone.iter().any(|&(g, _)| g == f) {
                continue;
            }
            let face = &mut self.faces[f as usize];
            for corner in face.iter_mut() {
                if *corner == a {
                    *corner = b;
                }
            }
            self.lists[(from.start + left) as usize] = f;
            left += 1;
        }
        let to = self.runs[b as usize];
        let len = to.len + left;
        let (source, target) = (from.start as usize, to.start as usize);
        if len <= to.room {
            self.lists.copy_within(source..source + left as usize, target + to.len as usize);
            self.runs[b as usize].len = len;
        } else if len <= from.room {
            self.lists.copy_within(target..target + to.len as usize, source + left as usize);
            self.runs[b as usize] = Run { start: from.start, len, room: from.room };
        } else {
            let start = self.lists.len();
            self.lists.extend_from_within(target..target + to.len as usize);
            self.lists.extend_from_within(source..source + left as usize);
            // Room for one collapse more.
            let room = len + len / 2;
            self.lists.resize(start + room as usize, NONE);
            self.runs[b as usize] = Run { start: start as u32, len, room };
        }
        self.runs[a as usize].len = 0;
        self.on_rim[b as usize] |= self.on_rim[a as usize];
        self.vertex_count -= 1;
    }

    /// Of the two sides of `f` that become one, each gives what it is to the triangle beyond the other.
    fn fold(&mut self, f: u32, a: u32, b: u32, apex: u32) {
        let side = |rings: &Rings, f: u32, x: u32, y: u32| {
            let k = rings.corner(f, x);
            // From x to y, or from y to x.
            if rings.faces[f as usize][(k + 1) % 3] == y { k } else { (k + 2) % 3 }
        };
        let bits = self.sides[f as usize];
        let at_a = (bits >> side(self, f, a, apex)) & 9;
        let at_b = (bits >> side(self, f, b, apex)) & 9;
        for (end, gained) in [(a, at_b), (b, at_a)] {
            if gained == 0 {
                continue;
            }
            let beyond = self
                .ring(end)
                .iter()
                .copied()
                .find(|&g| g != f && self.others(g, end).contains(&apex));
            if let Some(g) = beyond {
                let k = side(self, g, end, apex);
                self.sides[g as usize] |= gained << k;
            }
        }
    }

    fn drop_from(&mut self, v: u32, f: u32) {
        let run = self.runs[v as usize];
        let range = run.start as usize..(run.start + run.len) as usize;
        let list = &mut self.lists[range];
        if let Some(at) = list.iter().position(|&g| g == f) {
            // The order stays, so that it does not depend on what was here before.
            list.copy_within(at + 1.., at);
            self.runs[v as usize].len -= 1;
        }
    }

    /// The triangles that are left, with their old numbers.
    pub(crate) fn left(&self) -> impl Iterator<Item = (FaceId, [u32; 3])> + '_ {
        let faces = self.faces.iter().enumerate().filter(|(_, face)| face[0] != NONE);
        faces.map(|(f, &face)| (FaceId::new(f), face))
    }

    /// The triangles that are left as a list, on vertices numbered by `number`.
    pub(crate) fn face_list(&self, number: impl Fn(u32) -> VertexId) -> FaceList {
        let faces = self.left().map(|(_, face)| face.map(&number));
        let mut list = Vec::with_capacity(self.face_count);
        list.extend(faces);
        FaceList::from_triangles(list)
    }
}

/// How many of the sides of `f` at its corner `apex` are on a rim.
fn rim_sides_at(rings: &Rings, f: u32, apex: u32) -> usize {
    let k = rings.corner(f, apex);
    let bits = rings.sides[f as usize];
    [k, (k + 2) % 3].iter().filter(|&&k| bits & (RIM << k) != 0).count()
}

/// For each vertex the triangles around it, in their order.
fn listed(vertex_count: usize, faces: &[[u32; 3]]) -> (Vec<Run>, Vec<u32>) {
    let mut counts = vec![0_u32; vertex_count];
    for v in faces.iter().flatten() {
        counts[*v as usize] += 1;
    }
    let mut start = 0;
    let mut runs = Vec::with_capacity(vertex_count);
    for &count in &counts {
        runs.push(Run { start, len: 0, room: count });
        start += count;
    }
    let mut lists = Vec::with_capacity(3 * faces.len() + 3 * faces.len() / 2);
    lists.resize(start as usize, NONE);
    for (f, face) in faces.iter().enumerate() {
        for &v in face {
            let run = &mut runs[v as usize];
            lists[(run.start + run.len) as usize] = f as u32;
            run.len += 1;
        }
    }
    (runs, lists)
}
