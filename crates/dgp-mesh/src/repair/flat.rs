//! Removing faces of zero area without opening anything.
//!
//! ```text
//!   two corners at one place            a corner on the side across
//!
//!        u═v                                 a────b────c
//!         │\      u and v become             └────────┘ ╲    b goes into the face across:
//!         │ \     one vertex                  ╲        ╱     its triangle (a, d, c) becomes
//!         w  …                                 ╲   d  ╱      (a, d, b) and (b, d, c)
//! ```
//!
//! Each step is done only where it keeps the manifold; what is left is tried again after the steps
//! around it, and listed in the end if nothing helps.
//!
//! - Input: faces that form a manifold.
//! - Cost: O(F) for each pass; a pass that removes nothing is the last.
//! - Reference: Botsch & Kobbelt, "A robust procedure to eliminate degenerate faces from triangle
//!   meshes", VMV 2001.
//! - Departs from it: only faces of exactly zero area; no slicing.

use std::collections::{BTreeMap, BTreeSet};

use super::{RepairAction, draft::Draft};
use crate::{
    CornerId, Elements, FaceId, VertexId, VertexMap, VertexSet,
    check::{adjacency::Adjacency, is_flat},
};

/// Passes after which flat faces in long chains are left: each halves the work at least in practice.
const PASSES: usize = 64;

/// Removes flat faces as far as that is possible.
pub(super) fn remove(draft: &mut Draft) {
    let mut removed = Vec::new();
    let mut flat = flat_faces(draft);
    for _ in 0..PASSES {
        if flat.is_empty() {
            break;
        }
        let pass = Pass::plan(draft, &flat);
        if pass.removed.is_empty() {
            break;
        }
        removed.extend(pass.removed.iter().map(|&f| draft.input_face(f)));
        pass.carry_out(draft);
        flat = flat_faces(draft);
    }
    removed.sort_unstable();
    removed.dedup();
    draft.record(RepairAction::RemoveFlatFaces, Elements::Faces(removed));
    let left = draft.input_faces(&flat);
    draft.record(RepairAction::LeaveFlatFaces, left);
}

fn flat_faces(draft: &Draft) -> Vec<FaceId> {
    let flat = draft.faces.iter().filter(|(_, face)| is_flat(&draft.positions, face));
    flat.map(|(f, _)| f).collect()
}

/// Steps that do not touch each other.
struct Pass {
    removed: Vec<FaceId>,
    dropped: BTreeSet<FaceId>,
    rewritten: BTreeMap<FaceId, Vec<(VertexId, CornerId)>>,
    /// Vertices with those that they go into.
    merged: Vec<[VertexId; 2]>,
    locked: VertexSet,
}

/// What the plan looks at.
struct View<'a> {
    draft: &'a Draft,
    adjacency: &'a Adjacency,
    /// A corner of each vertex.
    corners: &'a VertexMap<Option<usize>>,
    flat: &'a BTreeSet<FaceId>,
}

impl Pass {
    fn plan(draft: &mut Draft, flat: &[FaceId]) -> Self {
        let adjacency = draft.take_adjacency();
        let mut corners = VertexMap::filled(draft.positions.len(), None);
        for (corner, &v) in adjacency.faces.corners().iter().enumerate() {
            corners[v] = Some(corner);
        }
        let mut pass = Pass {
            removed: Vec::new(),
            dropped: BTreeSet::new(),
            rewritten: BTreeMap::new(),
            merged: Vec::new(),
            locked: VertexSet::new(),
        };
        let set = flat.iter().copied().collect();
        let view = View { draft, adjacency: &adjacency, corners: &corners, flat: &set };
        for &f in flat {
            pass.try_face(&view, f);
        }
        draft.put_adjacency(adjacency);
        pass
    }

    fn try_face(&mut self, view: &View<'_>, f: FaceId) {
        let &[a, b, c] = view.adjacency.faces.face(f) else { return };
        let start = view.adjacency.sides(f).start;
        let at = |v: VertexId| view.draft.positions[v];
        // Side k leads from corner k to corner k + 1.
        let equal = [[a, b], [b, c], [c, a]].iter().position(|&[v, w]| at(v) == at(w));
        if let Some(k) = equal {
            self.try_collapse(view, start + k);
            return;
        }
        // The longest side is across the corner between the others.
        let length = |[v, w]: [VertexId; 2]| (at(v) - at(w)).abs();
        let spans = [[a, b], [b, c], [c, a]].map(length);
        let longest = (0..3).find(|&k| (0..3).all(|j| spans[j].cmple(spans[k]).all()));
        if let Some(k) = longest {
            self.try_give(view, start + k);
        }
    }

    /// Makes one vertex of the ends of `side`, which are at one place.
    fn try_collapse(&mut self, view: &View<'_>, side: usize) {
        let adjacency = view.adjacency;
        let (u, v) = (adjacency.from(side), adjacency.to(side));
        let (into, from) = (u.min(v), u.max(v));
        let (around_u, around_v) = (view.neighbors(u), view.neighbors(v));
        let mut apexes = BTreeSet::new();
        let mut faces = vec![adjacency.face(side)];
        faces.extend(adjacency.mate(side).map(|mate| adjacency.face(mate)));
        for &f in &faces {
            if let [a, b, c] = *adjacency.faces.face(f) {
                apexes.extend([a, b, c].into_iter().filter(|&w| w != u && w != v));
            }
        }
        // The link condition (Dey, Edelsbrunner, Guha & Nekhayev 1999), for polygons too.
        let common: BTreeSet<VertexId> = around_u.intersection(&around_v).copied().collect();
        let bridges_gap = view.is_on_rim(u) && view.is_on_rim(v) && adjacency.mate(side).is_some();
        let elsewhere = view
            .faces(u)
            .iter()
            .any(|f| !faces.contains(f) && adjacency.faces.face(*f).contains(&v));
        let touched: BTreeSet<VertexId> = around_u.union(&around_v).copied().collect();
        let lonely = touched.len() <= 3;
        if common != apexes || bridges_gap || elsewhere || lonely || !self.lock(&touched) {
            return;
        }
        self.merged.push([from, into]);
        for f in faces {
            self.removed.push(f);
            if adjacency.faces.degree(f) == 3 {
                self.dropped.insert(f);
            } else {
                let kept = |corner: &(VertexId, CornerId)| corner.0 != from;
                self.rewritten.insert(f, view.corners_of(f).into_iter().filter(kept).collect());
            }
        }
    }

    /// Gives the corner across `side` to the face beyond it.
    fn try_give(&mut self, view: &View<'_>, side: usize) {
        let adjacency = view.adjacency;
        let (f, middle) = (adjacency.face(side), adjacency.prev(side));
        let (a, c, b) = (adjacency.from(side), adjacency.to(side), adjacency.from(middle));
        let corner = |side: usize| (adjacency.from(side), view.draft.corner_sources[side]);
        let Some(mate) = adjacency.mate(side) else {
            // Without a face beyond, it just goes, unless that would leave two gaps at b.
            let at_end = adjacency.mate(middle).is_none()
                || adjacency.mate(adjacency.prev(middle)).is_none();
            if (at_end || !view.is_on_rim(b)) && self.lock(&[a, b, c].into()) {
                self.removed.push(f);
                self.dropped.insert(f);
            }
            return;
        };
        let g = adjacency.face(mate);
        let beyond = adjacency.faces.face(g);
        if view.flat.contains(&g) || beyond.contains(&b) {
            return;
        }
        let mut touched: BTreeSet<VertexId> = beyond.iter().copied().collect();
        touched.insert(b);
        if let [_, _, _] = *beyond {
            let apex = adjacency.prev(mate);
            if view.neighbors(b).contains(&adjacency.from(apex)) || !self.lock(&touched) {
                return;
            }
            // g = (c, a, d) and f = (a, c, b) become (d, b, a) and (b, d, c).
            let (at_a, at_c) = (corner(adjacency.next(mate)), corner(mate));
            self.rewritten.insert(g, vec![corner(apex), corner(middle), at_a]);
            self.rewritten.insert(f, vec![corner(middle), corner(apex), at_c]);
        } else {
            if !self.lock(&touched) {
                return;
            }
            let mut corners = Vec::new();
            for s in adjacency.sides(g) {
                corners.push(corner(s));
                if s == mate {
                    corners.push(corner(middle));
                }
            }
            self.rewritten.insert(g, corners);
            self.dropped.insert(f);
        }
        self.removed.push(f);
    }

    /// Reserves these vertices for a step; false if one is reserved.
    fn lock(&mut self, vertices: &BTreeSet<VertexId>) -> bool {
        let free = !vertices.iter().any(|&v| self.locked.contains(v));
        if free {
            self.locked.extend(vertices.iter().copied());
        }
        free
    }

    fn carry_out(mut self, draft: &mut Draft) {
        let mut into = VertexMap::from_fn(draft.positions.len(), |v: VertexId| v);
        for &[from, to] in &self.merged {
            into[from] = to;
            draft.merged.push([from, to].map(|v| draft.vertex_sources[v.index()]));
        }
        let done = draft.rewrite(|_, f, corners| {
            if let Some(new) = self.rewritten.remove(&f) {
                *corners = new;
            }
            for corner in corners.iter_mut() {
                corner.0 = into[corner.0];
            }
            Ok(!self.dropped.contains(&f))
        });
        done.expect("neither dropping nor renaming can fail");
        let gone: VertexSet = self.merged.iter().map(|pair| pair[0]).collect();
        draft.forget_vertices(&gone);
    }
}

impl View<'_> {
    fn fan(&self, v: VertexId) -> Vec<usize> {
        let mut fan = Vec::new();
        if let Some(corner) = self.corners[v] {
            self.adjacency.walk_fan(corner, |reached| fan.push(reached));
        }
        fan
    }

    fn faces(&self, v: VertexId) -> Vec<FaceId> {
        self.fan(v).into_iter().map(|corner| self.adjacency.face(corner)).collect()
    }

    /// The vertices one edge away.
    fn neighbors(&self, v: VertexId) -> BTreeSet<VertexId> {
        let ends = |corner| {
            let before = self.adjacency.prev(corner);
            [self.adjacency.to(corner), self.adjacency.from(before)]
        };
        self.fan(v).into_iter().flat_map(ends).collect()
    }

    fn is_on_rim(&self, v: VertexId) -> bool {
        self.fan(v).into_iter().any(|corner| {
            let before = self.adjacency.prev(corner);
            self.adjacency.is_open(corner) || self.adjacency.is_open(before)
        })
    }

    fn corners_of(&self, f: FaceId) -> Vec<(VertexId, CornerId)> {
        let corner = |side: usize| (self.adjacency.from(side), self.draft.corner_sources[side]);
        self.adjacency.sides(f).map(corner).collect()
    }
}
