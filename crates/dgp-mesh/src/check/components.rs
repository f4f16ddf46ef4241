//! Faces joined across edges, and what closed components enclose.

use glam::DVec3;

use super::{
    Groups, adjacency::Adjacency, depth::odd_crossings, larger::have_larger, union::Union,
};
use crate::{FaceId, FaceMap, VertexId, VertexMap};

/// A volume smaller than this, relative to the sum of the sizes of its parts, may be rounding error.
const VOLUME_ERROR: f64 = 1e-12;

/// The connected components of faces.
pub(crate) struct Components {
    /// The first face of the component of each face.
    firsts: FaceMap<FaceId>,
}

impl Components {
    pub(crate) fn new(adjacency: &Adjacency) -> Self {
        let mut union = Union::new(adjacency.faces.len());
        for side in 0..adjacency.side_count() {
            if let Some(mate) = adjacency.mate(side).filter(|&mate| mate > side) {
                union.join(adjacency.face(side).index(), adjacency.face(mate).index());
            }
        }
        let first = |f: FaceId| FaceId::new(union.find(f.index()));
        Components { firsts: FaceMap::from_fn(adjacency.faces.len(), first) }
    }

    /// The first face of the component of `f`, by which it is known.
    pub(crate) fn first(&self, f: FaceId) -> FaceId {
        self.firsts[f]
    }

    /// The faces of each component whose first face is `wanted`.
    pub(crate) fn groups(&self, wanted: impl Fn(FaceId) -> bool) -> Groups<FaceId> {
        let mut members: Vec<(FaceId, FaceId)> =
            self.firsts.iter().map(|(f, &first)| (first, f)).filter(|m| wanted(m.0)).collect();
        members.sort_unstable();
        let mut groups = Groups::new();
        for group in members.chunk_by(|a, b| a.0 == b.0) {
            groups.push(group.iter().map(|&(_, f)| f));
        }
        groups
    }
}

/// The closed components that are consistently oriented, and how they lie in each other.
pub(crate) struct Solids<'a> {
    positions: &'a VertexMap<DVec3>,
    adjacency: &'a Adjacency,
    faces: Groups<FaceId>,
    boxes: Vec<(DVec3, DVec3)>,
}

impl<'a> Solids<'a> {
    pub(crate) fn new(positions: &'a VertexMap<DVec3>, adjacency: &'a Adjacency) -> Self {
        let mut closed = FaceMap::filled(adjacency.faces.len(), true);
        let components = Components::new(adjacency);
        for side in (0..adjacency.side_count()).filter(|&side| adjacency.mate(side).is_none()) {
            closed[components.first(adjacency.face(side))] = false;
        }
        for pair in &adjacency.misoriented {
            closed[components.first(adjacency.face(pair[0]))] = false;
        }
        for (f, face) in adjacency.faces.iter() {
            if !face.iter().all(|&v| positions[v].is_finite()) {
                closed[components.first(f)] = false;
            }
        }
        let faces = components.groups(|first| closed[first]);
        let bounds = |group: &[FaceId]| {
            let corners = group.iter().flat_map(|&f| adjacency.faces.face(f));
            let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            corners.map(|&v| positions[v]).fold(start, |(min, max), p| (min.min(p), max.max(p)))
        };
        let boxes = faces.iter().map(bounds).collect();
        Solids { positions, adjacency, faces, boxes }
    }

    /// The ones that are inside out: their volume is negative, and they are not the wall of a cavity
    /// within others.
    pub(crate) fn inward(&self) -> Groups<FaceId> {
        let mut inward = Groups::new();
        let negative = |(k, group): (usize, &[FaceId])| self.has_negative_volume(k, group);
        let candidates: Vec<bool> = self.faces.iter().enumerate().map(negative).collect();
        if !candidates.contains(&true) {
            return inward;
        }
        let is_cavity = self.cavities(&candidates);
        for (k, group) in self.faces.iter().enumerate() {
            if candidates[k] && !is_cavity[k] {
                inward.push(group.iter().copied());
            }
        }
        inward
    }

    /// Whether the volume is negative beyond rounding. Relative to the size of the box.
    fn has_negative_volume(&self, k: usize, group: &[FaceId]) -> bool {
        let (min, max) = self.boxes[k];
        let center = min.midpoint(max);
        let size = (max - min).max_element();
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        let (mut sum, mut parts) = (0.0, 0.0);
        for &f in group {
            self.for_each_triangle(f, |triangle| {
                let [a, b, c] = triangle.map(|v| (self.positions[v] - center) / size);
                let part = a.dot(b.cross(c));
                sum += part;
                parts += part.abs();
            });
        }
        sum < -VOLUME_ERROR * parts
    }

    /// Which of the `candidates` an odd number of other components surround.
    fn cavities(&self, candidates: &[bool]) -> Vec<bool> {
        let mut is_cavity = vec![false; candidates.len()];
        let (inner, surrounds) = self.nesting(candidates);
        if inner.is_empty() {
            return is_cavity;
        }
        // Scaled by a power of two, so that the predicates neither overflow nor lose bits.
        let reach = self.boxes.iter().map(|(min, max)| min.abs().max(max.abs()).max_element());
        let scale = 2.0_f64.powi(-(reach.fold(1e-300, f64::max).log2().floor() as i32).max(-1000));
        let scaled: VertexMap<DVec3> =
            self.positions.values().iter().map(|p| p * scale).collect::<Vec<_>>().into();
        let triangles_of = |group: &[FaceId]| {
            let mut triangles = Vec::with_capacity(group.len());
            for &f in group {
                self.for_each_triangle(f, |triangle| triangles.push(triangle));
            }
            triangles
        };
        let groups: Vec<&[FaceId]> = self.faces.iter().collect();
        let surrounding = groups.iter().zip(&surrounds).filter(|&(_, &surrounds)| surrounds);
        let mut triangles: Vec<_> =
            surrounding.flat_map(|(group, _)| triangles_of(group)).collect();
        let point = |&k: &usize| scaled[self.adjacency.faces.face(groups[k][0])[0]];
        let points: Vec<DVec3> = inner.iter().map(point).collect();
        let odd = odd_crossings(&points, &scaled, &mut triangles);
        for ((k, point), odd) in inner.into_iter().zip(points).zip(odd) {
            // Without its own.
            let mut own = if surrounds[k] { triangles_of(groups[k]) } else { Vec::new() };
            is_cavity[k] = odd ^ odd_crossings(&[point], &scaled, &mut own)[0];
        }
        is_cavity
    }

    /// The `candidates` whose boxes lie in the box of another component, and which components have
    /// such a box in theirs: no others can surround a candidate.
    fn nesting(&self, candidates: &[bool]) -> (Vec<usize>, Vec<bool>) {
        let reach = |(min, max): &(DVec3, DVec3)| {
            let (min, max) = (-*min, *max);
            [min.x, min.y, min.z, max.x, max.y, max.z]
        };
        let all: Vec<[f64; 6]> = self.boxes.iter().map(reach).collect();
        let numbers: Vec<usize> = (0..candidates.len()).filter(|&k| candidates[k]).collect();
        let asking: Vec<[f64; 6]> = numbers.iter().map(|&k| all[k]).collect();
        let is_inner = have_larger(&asking, &all);
        let negated = |reaches: &[[f64; 6]]| -> Vec<[f64; 6]> {
            reaches.iter().map(|reach| reach.map(|x| -x)).collect()
        };
        let surrounds = have_larger(&negated(&all), &negated(&asking));
        let inner = numbers.into_iter().zip(is_inner).filter(|&(_, is_inner)| is_inner);
        (inner.map(|(k, _)| k).collect(), surrounds)
    }

    fn for_each_triangle(&self, f: FaceId, mut visit: impl FnMut([VertexId; 3])) {
        let [first, rest @ ..] = self.adjacency.faces.face(f) else { return };
        for pair in rest.windows(2) {
            visit([*first, pair[0], pair[1]]);
        }
    }
}
