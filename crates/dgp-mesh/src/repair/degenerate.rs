//! Faces that name a vertex twice, and faces of fewer than three corners.
//!
//! Equal neighbors become one corner, and a spike a, b, a becomes a. What then still names a vertex
//! twice goes around a hole by a bridge, or has a neck: its later visits get copies of the vertex, so
//! that the face stays in place with all its corners.

use super::{RepairAction, draft::Draft};
use crate::{CornerId, Error, FaceId, VertexId, check::Repeats};

type Corner = (VertexId, CornerId);

/// Leaves only faces of three or more distinct vertices.
pub(super) fn mend(draft: &mut Draft) -> Result<(), Error> {
    let mut repeats = Repeats::default();
    let is_bad = |face: &[VertexId], repeats: &mut Repeats| face.len() < 3 || repeats.any(face);
    if !draft.faces.iter().any(|(_, face)| is_bad(face, &mut repeats)) {
        return Ok(());
    }
    let (mut shortened, mut copied, mut dropped) = (Vec::new(), Vec::new(), Vec::new());
    let mut vertices = Vec::new();
    draft.rewrite(|draft, f, corners| {
        vertices.clear();
        vertices.extend(corners.iter().map(|corner| corner.0));
        if !is_bad(&vertices, &mut repeats) {
            return Ok(true);
        }
        let before = corners.len();
        shorten(corners);
        if corners.len() < 3 {
            dropped.push(draft.input_face(f));
            return Ok(false);
        }
        note(draft, f, corners.len() < before, &mut shortened);
        let copies = copy_later_visits(draft, corners)?;
        note(draft, f, copies, &mut copied);
        Ok(true)
    })?;
    for (action, faces) in [
        (RepairAction::ShortenFaces, shortened),
        (RepairAction::CopyCorners, copied),
        (RepairAction::DropShortFaces, dropped),
    ] {
        draft.record(action, crate::Elements::Faces(faces));
    }
    Ok(())
}

fn note(draft: &Draft, f: FaceId, changed: bool, list: &mut Vec<FaceId>) {
    if changed {
        list.push(draft.input_face(f));
    }
}

/// Removes repetitions and spikes, around the end too.
fn shorten(corners: &mut Vec<Corner>) {
    let mut kept: Vec<Corner> = Vec::with_capacity(corners.len());
    for &corner in corners.iter() {
        push(&mut kept, corner);
    }
    // What is left can still meet itself where the end joins the start.
    let mut start = 0;
    while kept.len() - start >= 2 {
        let last = kept.len() - 1;
        if kept[start].0 == kept[last].0 {
            kept.pop();
        } else if last == start + 1 {
            break;
        } else if kept[start + 1].0 == kept[last].0 {
            // A spike at the start.
            start += 1;
            kept.pop();
        } else if kept[start].0 == kept[last - 1].0 {
            // A spike at the end.
            kept.pop();
            kept.pop();
        } else {
            break;
        }
    }
    corners.clear();
    corners.extend_from_slice(&kept[start..]);
}

fn push(kept: &mut Vec<Corner>, corner: Corner) {
    match *kept.as_slice() {
        [.., last] if last.0 == corner.0 => {}
        [.., before, _] if before.0 == corner.0 => {
            kept.pop();
        }
        _ => kept.push(corner),
    }
}

/// Gives each visit of a vertex after the first a copy of it; returns whether there was one.
fn copy_later_visits(draft: &mut Draft, corners: &mut [Corner]) -> Result<bool, Error> {
    let mut order: Vec<usize> = (0..corners.len()).collect();
    order.sort_by_key(|&k| (corners[k].0, k));
    let mut later: Vec<usize> = order
        .windows(2)
        .filter(|pair| corners[pair[0]].0 == corners[pair[1]].0)
        .map(|pair| pair[1])
        .collect();
    later.sort_unstable();
    for &k in &later {
        corners[k].0 = draft.copy_vertex(corners[k].0)?;
    }
    Ok(!later.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shortened(face: &[usize]) -> Vec<usize> {
        let mut corners: Vec<Corner> =
            face.iter().enumerate().map(|(k, &v)| (VertexId::new(v), CornerId::new(k))).collect();
        shorten(&mut corners);
        corners.iter().map(|corner| corner.0.index()).collect()
    }

    #[test]
    fn repetitions_and_spikes_go() {
        assert_eq!(shortened(&[0, 1, 1, 2]), [0, 1, 2]);
        assert_eq!(shortened(&[0, 1, 2, 0]), [0, 1, 2]);
        assert_eq!(shortened(&[0, 1, 2, 3, 2]), [0, 1, 2]);
        assert_eq!(shortened(&[3, 2, 0, 1, 2]), [2, 0, 1]);
        assert_eq!(shortened(&[0, 1, 2, 5, 0, 7]), [0, 1, 2, 5]);
        assert_eq!(shortened(&[0, 1, 2, 1]), [0, 1]);
        assert_eq!(shortened(&[4, 4, 4]), [4]);
        assert_eq!(shortened(&[]), []);
    }

    #[test]
    fn bridges_to_a_hole_stay() {
        let bridge = [0, 1, 2, 3, 0, 4, 6, 5, 4];
        assert_eq!(shortened(&bridge), bridge);
    }
}
