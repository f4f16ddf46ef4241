//! The data of the input at the elements of the result.

use dgp_mesh::{Attributes, DVec3, FaceId, HalfedgeId, Mesh, VertexId, spatial::ClosestPoint};

use super::relax::Ground;
use crate::{Error, sample::mixed};

/// Gives `result`, at unit scale, the data of `input`; returns the names of those that have no place there.
pub(super) fn carry(
    input: &Mesh,
    ground: &Ground<'_>,
    result: &mut Mesh,
) -> Result<Vec<String>, Error> {
    let Attributes { vertex, corner, edge, face } = input.attributes();
    let mut dropped: Vec<String> = edge.names().map(str::to_owned).collect();
    if vertex.names().chain(corner.names()).next().is_some() {
        let places = ground.nearest(result.positions().values())?;
        let weighted = |k: usize| {
            let ClosestPoint { vertices, barycentric, .. } = places[k];
            [0, 1, 2].map(|k| (barycentric[k], vertices[k]))
        };
        let at_corner = |k: usize| {
            let first = input.face_halfedge(places[k].face);
            let around = [first, input.next(first), input.prev(first)];
            weighted(k).map(|(weight, v)| {
                (weight, around.into_iter().find(|&h| input.from(h) == v).unwrap_or(first))
            })
        };
        let count = result.vertex_count();
        let at_vertices = mixed(corner, count, at_corner);
        let source = |h: HalfedgeId| result.face(h).map(|_| result.from(h));
        let mut corners = at_vertices.gather(result.halfedge_count(), source);
        for name in jumping(input) {
            corners.remove(&name);
            dropped.push(name);
        }
        let attributes = result.attributes_mut();
        attributes.vertex = mixed(vertex, count, weighted);
        attributes.corner = corners;
    }
    if face.names().next().is_some() {
        let centers: Vec<DVec3> = result.faces().map(|f| result.face_center(f)).collect();
        let places = ground.nearest(&centers)?;
        let faces = face.gather(centers.len(), |f: FaceId| Some(places[f.index()].face));
        result.attributes_mut().face = faces;
    }
    Ok(dropped)
}

/// The columns of corners whose values differ around a vertex; others are data of vertices in truth.
fn jumping(input: &Mesh) -> Vec<String> {
    let around = |v: VertexId| {
        let mut corners = input.vertex_halfedges(v).filter(|&h| input.face(h).is_some());
        let first = corners.next();
        corners.filter_map(|h| first.map(|first| [first, h])).collect::<Vec<_>>()
    };
    input.attributes().corner.differing(input.vertices().flat_map(around))
}
