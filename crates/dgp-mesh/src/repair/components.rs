//! Keeping the components that count.

use std::cmp::Reverse;

use super::{KeepComponents, RepairAction, draft::Draft};
use crate::{Elements, FaceId, FaceSet, check::components::Components};

/// Drops the components that are not to be kept.
pub(super) fn keep(draft: &mut Draft, which: KeepComponents) {
    if which == KeepComponents::All {
        return;
    }
    let components = Components::new(draft.adjacency());
    let mut sizes: Vec<(usize, FaceId)> =
        components.groups(|_| true).iter().map(|group| (group.len(), group[0])).collect();
    sizes.sort_by_key(|&(size, first)| (Reverse(size), first));
    let kept = match which {
        KeepComponents::All => sizes.len(),
        KeepComponents::Largest(count) => count.min(sizes.len()),
        KeepComponents::AtLeast(faces) => sizes.partition_point(|&(size, _)| size >= faces),
    };
    let dropped: FaceSet = sizes[kept..].iter().map(|&(_, first)| first).collect();
    let mut groups = components.groups(|first| dropped.contains(first));
    let mut faces = groups.members().to_vec();
    faces.sort_unstable();
    for f in groups.members_mut() {
        *f = draft.input_face(*f);
    }
    draft.record(RepairAction::DropComponents, Elements::FaceGroups(groups));
    draft.drop_faces(&faces);
}
