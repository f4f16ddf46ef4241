//! Which faces belong together at an edge that more than two share.
//!
//! Looking along the edge, faces stand around it like the pages of a book. A face has solid on its
//! inner side, so the pages of a face that runs up the edge and of one that runs down enclose a wedge
//! of solid. Where as many run up as down, the faces are taken to bound volume: the pairs with the
//! smallest wedges stay together, so that solids that touch come apart. Otherwise, as at a fin, those
//! stay together that continue each other straightest.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::CrowdedEdges;
use crate::{FaceId, VertexMap, check::adjacency::Adjacency};

/// Pages closer than this, in radians, are the two sides of one sheet and enclose no solid. Far above
/// rounding error, far below the angle of any wedge that was meant.
const SAME_PAGE: f64 = 1e-9;

/// What a pair costs whose angle is unknown, as that of a flat face: more than any other.
const UNKNOWN: f64 = 10.0;

/// Edges of more faces than this are cut apart: no surface was meant there.
const MOST: usize = 200;

/// An edge of more than two faces.
pub(super) struct Crowd {
    pub(super) sides: Vec<usize>,
    /// The sides that stay together.
    pub(super) pairs: Vec<[usize; 2]>,
}

/// Joins the sides of each crowded edge that belong together and leaves the others open.
pub(super) fn separate(
    adjacency: &mut Adjacency,
    positions: &VertexMap<DVec3>,
    mode: CrowdedEdges,
) -> Vec<Crowd> {
    let crowd = |sides: &[usize]| {
        let pairs = match mode {
            CrowdedEdges::Pair if sides.len() <= MOST => pairs(adjacency, positions, sides),
            CrowdedEdges::Pair | CrowdedEdges::Cut => Vec::new(),
        };
        Crowd { sides: sides.to_vec(), pairs }
    };
    let crowds: Vec<Crowd> = adjacency.crowded_edges().map(crowd).collect();
    for crowd in &crowds {
        for &side in &crowd.sides {
            adjacency.open(side);
        }
        for &[s, t] in &crowd.pairs {
            adjacency.join(s, t);
        }
    }
    crowds
}

fn pairs(adjacency: &Adjacency, positions: &VertexMap<DVec3>, sides: &[usize]) -> Vec<[usize; 2]> {
    let angles = angles(adjacency, positions, sides);
    let [lower, _] = adjacency.edge(sides[0]);
    let (up, down): (Vec<usize>, Vec<usize>) =
        (0..sides.len()).partition(|&k| adjacency.from(sides[k]) == lower);
    let bounds_volume = up.len() == down.len();
    let mut costs = Vec::with_capacity(up.len() * down.len());
    for &i in &up {
        for &j in &down {
            let cost = match (angles[i], angles[j]) {
                (Some(a), Some(b)) => {
                    let wedge = wedge(a, b);
                    if bounds_volume { wedge } else { (wedge - PI).abs() }
                }
                _ => UNKNOWN,
            };
            costs.push((cost, sides[i], sides[j]));
        }
    }
    costs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    for (_, s, t) in costs {
        if !pairs.iter().any(|pair| pair.contains(&s) || pair.contains(&t)) {
            pairs.push([s, t]);
        }
    }
    pairs
}

/// The angle of solid between a face that runs up at angle `a` and one that runs down at `b`.
fn wedge(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    if turn < SAME_PAGE { TAU } else { turn }
}

/// The angles at which the faces stand around the edge; `None` where a face is flat.
fn angles(
    adjacency: &Adjacency,
    positions: &VertexMap<DVec3>,
    sides: &[usize],
) -> Vec<Option<f64>> {
    let [lower, upper] = adjacency.edge(sides[0]);
    let Some(axis) = direction(positions[upper] - positions[lower]) else {
        return vec![None; sides.len()];
    };
    let pages: Vec<Option<DVec3>> = sides
        .iter()
        .map(|&side| {
            let normal = face_normal(adjacency, positions, adjacency.face(side))?;
            let along = if adjacency.from(side) == lower { axis } else { -axis };
            direction(normal.cross(along))
        })
        .collect();
    let Some(x) = pages.iter().flatten().next().copied() else {
        return pages.iter().map(|_| None).collect();
    };
    let y = axis.cross(x);
    pages.iter().map(|page| page.map(|page| page.dot(y).atan2(page.dot(x)))).collect()
}

/// The unit normal of a polygon by Newell's sum; `None` if it is flat.
pub(super) fn face_normal(
    adjacency: &Adjacency,
    positions: &VertexMap<DVec3>,
    f: FaceId,
) -> Option<DVec3> {
    let face = adjacency.faces.face(f);
    let first = positions[face[0]];
    let spokes = || face[1..].iter().map(|&v| positions[v] - first);
    let size = spokes().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let scaled: Vec<DVec3> = spokes().map(|p| p / size).collect();
    direction(scaled.windows(2).map(|pair| pair[0].cross(pair[1])).sum())
}

/// `v` at length one; `None` if it has no length.
pub(super) fn direction(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}
