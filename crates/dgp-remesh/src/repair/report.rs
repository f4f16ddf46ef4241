//! What a repair of a surface did, step by step.

use dgp_mesh::{Change, FaceId, FaceMap, RepairAction, RepairReport, VertexId, VertexMap};

use super::{IntersectionReport, SliverReport, StitchReport, track::Track};

/// What [`repair_surface`](crate::repair_surface) did.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct SurfaceRepairReport {
    /// How a manifold was made of the faces, by the elements of the input.
    pub faces: RepairReport,
    /// Rims that were joined.
    pub stitch: StitchReport,
    /// Components that were dropped by the number of their faces, by the elements of that time.
    pub components: Vec<Change>,
    /// Components that were dropped as too small.
    pub small_components: usize,
    /// Holes that were filled.
    pub holes_filled: usize,
    /// Holes that were to be filled and are not: too long, around a single face, or without a
    /// triangulation.
    pub holes_left: usize,
    /// Faces that fill holes.
    pub hole_faces: usize,
    /// Slivers that went; those left by their ids now.
    pub slivers: SliverReport,
    /// What passed through itself: pairs found by the faces of the input where both are from there, pairs
    /// left by their ids now.
    pub intersections: IntersectionReport,
    /// How many pairs of faces met when rims were joined and holes filled.
    pub meeting: usize,
    /// Components that were dropped since all of their faces were without area.
    pub flat_components: usize,
    /// What the last look at the faces changed, by the elements of that time.
    pub last: Vec<Change>,
    /// Open components that were turned to where they are seen from.
    pub turned_by_sight: usize,
    /// What became of each vertex of the input: where it went into another that one, `None` if it is gone.
    pub vertices: VertexMap<Option<VertexId>>,
    /// The face of the input that each face was, `None` if it is new.
    pub face_sources: FaceMap<Option<FaceId>>,
}

/// A step that changed something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RepairStep {
    /// The step, as in `stitch`.
    pub step: &'static str,
    /// What was done, as in `join_edges`.
    pub action: &'static str,
    /// To how many elements.
    pub count: usize,
}

impl SurfaceRepairReport {
    /// Whether nothing was changed.
    pub fn is_unchanged(&self) -> bool {
        let leaves = |action: &str| action.starts_with("leave");
        self.faces.changes.iter().all(|change| leaves(change.action.name()))
            && self.steps().iter().all(|step| leaves(step.action))
    }

    /// Whether no faces pass through each other, as far as was looked for, and none is without area, as
    /// far as those were to go.
    pub fn is_sound(&self) -> bool {
        self.intersections.left.is_empty() && self.flat_faces() == 0
    }

    /// How many faces without area stay, since removing them would break the manifold.
    pub fn flat_faces(&self) -> usize {
        let left = self.last.iter().find(|c| c.action == RepairAction::LeaveFlatFaces);
        left.map_or(0, |change| change.elements.len())
    }

    /// What was done after a manifold was made, in order; what changed nothing is left out.
    pub fn steps(&self) -> Vec<RepairStep> {
        let changes = |changes: &[Change]| {
            let step = |change: &Change| {
                (change.action.step(), change.action.name(), change.elements.len())
            };
            changes.iter().map(step).collect::<Vec<_>>()
        };
        let mut steps = vec![
            ("stitch", "split_edges_at_junctions", self.stitch.junctions),
            ("stitch", "join_edges", self.stitch.joined),
        ];
        steps.extend(changes(&self.components));
        steps.extend([
            ("components", "drop_flat_components", self.flat_components),
            ("components", "drop_small_components", self.small_components),
            ("fill_holes", "fill_holes", self.holes_filled),
            ("fill_holes", "leave_holes", self.holes_left),
            ("slivers", "collapse_edges", self.slivers.collapsed),
            ("slivers", "flip_edges", self.slivers.flipped),
            ("slivers", "remove_caps_at_rims", self.slivers.removed),
            ("slivers", "leave_slivers", self.slivers.left.len()),
            ("intersections", "remove_faces", self.intersections.removed),
            ("intersections", "fill_cuts", self.intersections.filled),
            ("intersections", "leave_cuts_open", self.intersections.open),
            ("intersections", "leave_intersections", self.intersections.left.len()),
        ]);
        steps.extend(changes(&self.last));
        steps.push(("orient", "turn_open_components", self.turned_by_sight));
        let step = |(step, action, count)| RepairStep { step, action, count };
        steps.into_iter().map(step).filter(|step| step.count > 0).collect()
    }

    pub(super) fn add_slivers(&mut self, more: SliverReport) {
        self.slivers.collapsed += more.collapsed;
        self.slivers.flipped += more.flipped;
        self.slivers.removed += more.removed;
        self.slivers.left = more.left;
    }

    /// Adds a turn before which `track` was where faces came from.
    pub(super) fn add_intersections(&mut self, more: IntersectionReport, track: &Track) {
        let all = &mut self.intersections;
        let source = |[f, g]: [FaceId; 2]| Some([track.faces[f]?, track.faces[g]?]);
        if all.rounds == 0 {
            self.meeting = more.found.len();
            all.found = more.found.iter().filter_map(|&pair| source(pair)).collect();
        }
        all.rounds += more.rounds;
        all.removed += more.removed;
        all.added += more.added;
        all.filled += more.filled;
        all.pieces += more.pieces;
        all.open += more.open;
        all.left = more.left;
    }

    /// Adds the last look at the faces, and renames what is left as that does.
    pub(super) fn follow(&mut self, last: RepairReport) {
        let new = |f: &FaceId| last.faces[*f];
        self.slivers.left = self.slivers.left.iter().filter_map(new).collect();
        let pair = |[f, g]: &[FaceId; 2]| Some([new(f)?, new(g)?]);
        self.intersections.left = self.intersections.left.iter().filter_map(pair).collect();
        self.last = last.changes;
    }
}
