//! A vertex of its own for each fan of faces.
//!
//! Faces at a vertex form a fan where they are mates across edges. All but the first fan get a copy of
//! the vertex. Two pairs at a crowded edge can end up in the same fans at both of its ends, as where a
//! tube is pinched shut: then the edge would still be shared by four faces. If the faces there meet
//! their own backs across other edges, they are the two sides of a sheet, which come apart along its
//! rim; else all pairs at the edge are cut. After that an open fan holds at most the two faces at its
//! ends, which fit together.

use std::collections::BTreeSet;

use super::{
    CrowdedEdges, RepairAction,
    draft::Draft,
    separate::{Crowd, separate},
};
use crate::{
    Elements, Error, MAX_ELEMENTS, VertexId, check::adjacency::Adjacency, check::fans_per_vertex,
};

/// Splits all vertices of several fans, after sides at crowded edges found their mates.
pub(super) fn split(draft: &mut Draft, mode: CrowdedEdges) -> Result<(), Error> {
    let mut adjacency = draft.take_adjacency();
    let disagreeing = std::mem::take(&mut adjacency.misoriented);
    for &[s, t] in &disagreeing {
        adjacency.open(s);
        adjacency.open(t);
    }
    let mut crowds = separate(&mut adjacency, &draft.positions, mode);
    let separated = edges(draft, &adjacency, crowds.iter().map(|crowd| crowd.sides[0]));
    let mut cut: Vec<usize> = disagreeing.iter().map(|pair| pair[0]).collect();
    let (labels, sources) = loop {
        let several = fans_per_vertex(&adjacency);
        if several.is_empty() && crowds.is_empty() {
            draft.put_adjacency(adjacency);
            return Ok(());
        }
        let (labels, sources) = label(draft, &adjacency, &several)?;
        let conflicts: Vec<usize> =
            (0..crowds.len()).filter(|&k| is_conflict(&crowds[k], &adjacency, &labels)).collect();
        if conflicts.is_empty() {
            break (labels, sources);
        }
        let folds = folds(&adjacency, conflicts.iter().map(|&k| &crowds[k]));
        for &side in &folds {
            let mate = adjacency.mate(side).expect("a fold joins two sides");
            adjacency.open(side);
            adjacency.open(mate);
        }
        if folds.is_empty() {
            for k in conflicts {
                for side in std::mem::take(&mut crowds[k].pairs).into_flattened() {
                    adjacency.open(side);
                }
            }
        }
        cut.extend(folds);
    };
    let cut = edges(draft, &adjacency, cut.into_iter());
    draft.record(RepairAction::CutEdges, cut);
    draft.record(RepairAction::SeparateEdges, separated);
    let copies = sources.iter().map(|&v| draft.input_vertex(v)).collect();
    draft.record(RepairAction::SplitVertices, Elements::Vertices(copies));
    for v in sources {
        draft.copy_vertex(v)?;
    }
    draft.faces_mut().corners_mut().copy_from_slice(&labels);
    Ok(())
}

/// Whether more than two sides, a pair among them, would still be at one edge: between the same copies
/// of its ends.
fn is_conflict(crowd: &Crowd, adjacency: &Adjacency, labels: &[VertexId]) -> bool {
    let ends = |&side: &usize| {
        let (v, w) = (labels[side], labels[adjacency.next(side)]);
        [v.min(w), v.max(w)]
    };
    let mut ends: Vec<_> = crowd.sides.iter().map(ends).collect();
    ends.sort_unstable();
    !crowd.pairs.is_empty() && ends.windows(3).any(|three| three[0] == three[2])
}

/// The sides across which the faces of these crowds meet their own backs, one for each edge.
fn folds<'a>(adjacency: &Adjacency, crowds: impl Iterator<Item = &'a Crowd>) -> Vec<usize> {
    let faces = crowds.flat_map(|crowd| crowd.sides.iter().map(|&side| adjacency.face(side)));
    let is_fold = |&side: &usize| {
        let Some(mate) = adjacency.mate(side) else { return false };
        let (f, g) = (adjacency.face(side), adjacency.face(mate));
        let (mut ahead, mut back) = (side, mate);
        adjacency.faces.degree(f) == adjacency.faces.degree(g)
            && (0..adjacency.faces.degree(f)).all(|_| {
                let same = adjacency.from(ahead) == adjacency.to(back);
                (ahead, back) = (adjacency.next(ahead), adjacency.prev(back));
                same
            })
    };
    let sides = faces.flat_map(|f| adjacency.sides(f)).filter(is_fold);
    let first = |side: usize| adjacency.mate(side).map_or(side, |mate| mate.min(side));
    let firsts: BTreeSet<usize> = sides.map(first).collect();
    firsts.into_iter().collect()
}

fn edges(draft: &Draft, adjacency: &Adjacency, sides: impl Iterator<Item = usize>) -> Elements {
    Elements::Edges(sides.map(|side| adjacency.edge(side).map(|v| draft.input_vertex(v))).collect())
}

/// The vertex of each corner when the fans of these vertices get their own, and the vertex that each
/// new one is a copy of.
fn label(
    draft: &Draft,
    adjacency: &Adjacency,
    several: &[VertexId],
) -> Result<(Vec<VertexId>, Vec<VertexId>), Error> {
    let mut labels = adjacency.faces.corners().to_vec();
    let mut is_split = vec![false; draft.positions.len()];
    for &v in several {
        is_split[v.index()] = true;
    }
    let mut corners: Vec<(VertexId, usize)> = labels
        .iter()
        .enumerate()
        .filter(|(_, v)| is_split[v.index()])
        .map(|(corner, &v)| (v, corner))
        .collect();
    corners.sort_unstable();
    let mut sources = Vec::new();
    let mut seen = vec![false; labels.len()];
    for group in corners.chunk_by(|a, b| a.0 == b.0) {
        for (k, &(v, corner)) in group.iter().enumerate() {
            if seen[corner] {
                continue;
            }
            let label = if k == 0 {
                v
            } else {
                sources.push(v);
                let count = draft.positions.len() + sources.len();
                if count > MAX_ELEMENTS {
                    return Err(Error::TooMany { kind: "vertices", count, limit: MAX_ELEMENTS });
                }
                VertexId::new(count - 1)
            };
            adjacency.walk_fan(corner, |reached| {
                seen[reached] = true;
                labels[reached] = label;
            });
        }
    }
    Ok((labels, sources))
}
