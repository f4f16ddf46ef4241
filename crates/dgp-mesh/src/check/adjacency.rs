//! Which sides of faces meet at an edge, for faces that may form anything.
//!
//! Side c of a face runs from its corner c to the next one. Where just two sides join the same two
//! vertices they are mates; where more do, they are left without and listed.

use std::{ops::Range, sync::Arc};

use crate::{
    FaceId, FaceList, VertexId,
    build::sides::{Side, sorted_sides},
};

/// The side has no other at its edge.
const OPEN: u32 = u32::MAX;
/// The side has more than one other at its edge.
const CROWDED: u32 = u32::MAX - 1;

/// The sides of polygons, paired along edges that two of them share.
pub(crate) struct Adjacency {
    pub(crate) faces: Arc<FaceList>,
    pub(crate) vertex_count: usize,
    mates: Vec<u32>,
    /// The face of each corner, where that is no division.
    corner_faces: Option<Vec<FaceId>>,
    /// Pairs of mates that run the same way, by edge.
    pub(crate) misoriented: Vec<[usize; 2]>,
    crowded: Vec<Range<usize>>,
    crowded_sides: Vec<usize>,
}

impl Adjacency {
    /// Pairs the sides of `faces`, each of which has at least three corners, all distinct.
    pub(crate) fn new(vertex_count: usize, faces: Arc<FaceList>) -> Self {
        let (sides, starts) = sorted_sides(vertex_count, &faces);
        let mut adjacency = Adjacency {
            faces,
            vertex_count,
            mates: vec![OPEN; sides.len()],
            corner_faces: None,
            misoriented: Vec::new(),
            crowded: Vec::new(),
            crowded_sides: Vec::new(),
        };
        for bounds in starts[..=vertex_count].windows(2) {
            adjacency.pair(&sides[bounds[0] as usize..bounds[1] as usize]);
        }
        if adjacency.faces.uniform_degree() != Some(3) {
            let mut corner_faces = Vec::with_capacity(sides.len());
            for (f, face) in adjacency.faces.iter() {
                corner_faces.resize(corner_faces.len() + face.len(), f);
            }
            adjacency.corner_faces = Some(corner_faces);
        }
        adjacency
    }

    /// Pairs the sides at one vertex that lead to larger ones.
    fn pair(&mut self, bucket: &[Side]) {
        let mut rest = bucket;
        while let &[side, ref others @ ..] = rest {
            let shared = others.iter().take_while(|other| other.larger() == side.larger()).count();
            rest = &others[shared..];
            match shared {
                0 => {}
                1 => {
                    let pair = [side.corner(), others[0].corner()];
                    self.mates[pair[0]] = pair[1] as u32;
                    self.mates[pair[1]] = pair[0] as u32;
                    if side.is_forward() == others[0].is_forward() {
                        self.misoriented.push(pair);
                    }
                }
                _ => {
                    let start = self.crowded_sides.len();
                    self.crowded_sides.push(side.corner());
                    self.crowded_sides.extend(others[..shared].iter().map(|s| s.corner()));
                    self.crowded_sides[start..].sort_unstable();
                    for &side in &self.crowded_sides[start..] {
                        self.mates[side] = CROWDED;
                    }
                    self.crowded.push(start..self.crowded_sides.len());
                }
            }
        }
    }

    /// The sides at each edge that more than two share.
    pub(crate) fn crowded_edges(&self) -> impl ExactSizeIterator<Item = &[usize]> {
        self.crowded.iter().map(|range| &self.crowded_sides[range.clone()])
    }

    /// How many sides there are.
    #[inline]
    pub(crate) fn side_count(&self) -> usize {
        self.mates.len()
    }

    /// The side across the edge, if there is just one.
    #[inline]
    pub(crate) fn mate(&self, side: usize) -> Option<usize> {
        let mate = self.mates[side];
        (mate < CROWDED).then_some(mate as usize)
    }

    /// Whether no other side is at the edge.
    #[inline]
    pub(crate) fn is_open(&self, side: usize) -> bool {
        self.mates[side] == OPEN
    }

    /// Makes mates of two sides.
    pub(crate) fn join(&mut self, s: usize, t: usize) {
        self.mates[s] = t as u32;
        self.mates[t] = s as u32;
    }

    /// Leaves a side without a mate.
    pub(crate) fn open(&mut self, side: usize) {
        self.mates[side] = OPEN;
    }

    /// Where a side starts.
    #[inline]
    pub(crate) fn from(&self, side: usize) -> VertexId {
        self.faces.corners()[side]
    }

    /// Where a side ends.
    #[inline]
    pub(crate) fn to(&self, side: usize) -> VertexId {
        self.faces.corners()[self.next(side)]
    }

    /// The ends of a side, the smaller one first.
    pub(crate) fn edge(&self, side: usize) -> [VertexId; 2] {
        let (a, b) = (self.from(side), self.to(side));
        [a.min(b), a.max(b)]
    }

    /// The face a side is of.
    #[inline]
    pub(crate) fn face(&self, side: usize) -> FaceId {
        match &self.corner_faces {
            None => FaceId::new(side / 3),
            Some(faces) => faces[side],
        }
    }

    /// The sides of a face.
    #[inline]
    pub(crate) fn sides(&self, f: FaceId) -> Range<usize> {
        let start = self.faces.face_start(f).index();
        start..start + self.faces.degree(f)
    }

    /// The next side of the same face.
    #[inline]
    pub(crate) fn next(&self, side: usize) -> usize {
        let sides = self.sides_around(side);
        if side + 1 == sides.end { sides.start } else { side + 1 }
    }

    /// The side before in the same face.
    #[inline]
    pub(crate) fn prev(&self, side: usize) -> usize {
        let sides = self.sides_around(side);
        if side == sides.start { sides.end - 1 } else { side - 1 }
    }

    #[inline]
    fn sides_around(&self, side: usize) -> Range<usize> {
        match &self.corner_faces {
            None => side / 3 * 3..side / 3 * 3 + 3,
            Some(faces) => self.sides(faces[side]),
        }
    }

    /// Steps around vertex `v` across `side`, which is at `v`: the corner there on the other side, and
    /// the side to leave that by.
    #[inline]
    pub(crate) fn step(&self, v: VertexId, side: usize) -> Option<(usize, usize)> {
        let mate = self.mate(side)?;
        if self.from(mate) == v {
            return Some((mate, self.prev(mate)));
        }
        let corner = self.next(mate);
        Some((corner, corner))
    }

    /// Visits the corners of the fan that `corner` is in, first itself.
    pub(crate) fn walk_fan(&self, corner: usize, mut visit: impl FnMut(usize)) {
        let v = self.from(corner);
        visit(corner);
        for first in [self.prev(corner), corner] {
            let mut exit = first;
            while let Some((reached, next)) = self.step(v, exit) {
                if reached == corner {
                    return;
                }
                visit(reached);
                exit = next;
            }
        }
    }
}
