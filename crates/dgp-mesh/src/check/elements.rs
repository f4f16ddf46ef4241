//! Lists of elements of one kind, for reports.

use crate::{FaceId, VertexId};

/// The elements that have a defect, or that a repair changed. Ids are those of the input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Elements {
    /// Vertices.
    Vertices(Vec<VertexId>),
    /// Vertices, each with the one it equals or went into.
    VertexPairs(Vec<[VertexId; 2]>),
    /// Edges, by their ends.
    Edges(Vec<[VertexId; 2]>),
    /// Faces.
    Faces(Vec<FaceId>),
    /// Faces, each with the one it equals.
    FacePairs(Vec<[FaceId; 2]>),
    /// Sets of faces.
    FaceGroups(Groups<FaceId>),
    /// Closed chains of edges, by their vertices in turn.
    Loops(Groups<VertexId>),
}

impl Elements {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Elements::Vertices(list) => list.len(),
            Elements::VertexPairs(list) | Elements::Edges(list) => list.len(),
            Elements::Faces(list) => list.len(),
            Elements::FacePairs(list) => list.len(),
            Elements::FaceGroups(groups) => groups.len(),
            Elements::Loops(groups) => groups.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first ones as text, as in "v1–v2, v3–v4 and 7 more".
    pub fn first(&self, count: usize) -> String {
        fn text<T>(
            all: impl ExactSizeIterator<Item = T>,
            n: usize,
            one: impl Fn(T) -> String,
        ) -> String {
            let more = all.len().saturating_sub(n);
            let shown = all.take(n).map(one).collect::<Vec<_>>().join(", ");
            if more > 0 { format!("{shown} and {more} more") } else { shown }
        }
        let loop_text = |group: &[VertexId]| match group {
            [v, ..] => format!("{} edges from {v}", group.len()),
            [] => String::new(),
        };
        let group_text = |group: &[FaceId]| match group {
            [f, ..] => format!("{} faces from {f}", group.len()),
            [] => String::new(),
        };
        match self {
            Elements::Vertices(list) => text(list.iter(), count, ToString::to_string),
            Elements::VertexPairs(list) => text(list.iter(), count, |[v, w]| format!("{v} = {w}")),
            Elements::Edges(list) => text(list.iter(), count, |[v, w]| format!("{v}–{w}")),
            Elements::Faces(list) => text(list.iter(), count, ToString::to_string),
            Elements::FacePairs(list) => text(list.iter(), count, |[f, g]| format!("{f} = {g}")),
            Elements::FaceGroups(groups) => text(groups.iter(), count, group_text),
            Elements::Loops(groups) => text(groups.iter(), count, loop_text),
        }
    }
}

/// Lists of ids, one after the other in one array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Groups<I> {
    members: Vec<I>,
    /// Where each group ends.
    ends: Vec<usize>,
}

impl<I> Groups<I> {
    /// No groups.
    pub const fn new() -> Self {
        Groups { members: Vec::new(), ends: Vec::new() }
    }

    /// Adds a group.
    pub fn push(&mut self, group: impl IntoIterator<Item = I>) {
        self.members.extend(group);
        self.ends.push(self.members.len());
    }

    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are no groups.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The groups in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[I]> {
        (0..self.ends.len()).map(|g| {
            let start = if g == 0 { 0 } else { self.ends[g - 1] };
            &self.members[start..self.ends[g]]
        })
    }

    /// The members of all groups in order.
    pub fn members(&self) -> &[I] {
        &self.members
    }

    pub(crate) fn members_mut(&mut self) -> &mut [I] {
        &mut self.members
    }
}

impl<I> Default for Groups<I> {
    fn default() -> Self {
        Groups::new()
    }
}
