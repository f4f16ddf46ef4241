//! The leaves of all levels as one mesh, with its data.

use dgp_mesh::{
    AttributeTable, Connectivity, DVec3, EdgeId, FaceId, FaceList, HalfedgeId, Mesh, VertexId,
};

use super::{
    data::Data,
    patch::{Patch, Vertices},
};
use crate::{Error, SHARPNESS, primal::Kind, topology::NONE};

/// A vertex of the result as a level has it.
#[derive(Clone, Copy)]
struct Spot {
    level: usize,
    vertex: u32,
    /// Its vertex in the chart of the face.
    chart: u32,
}

/// The faces of the result and where they come from.
#[derive(Default)]
struct Leaves {
    faces: FaceList,
    positions: Vec<DVec3>,
    /// The row of each vertex, of each corner.
    vertex_rows: Vec<VertexId>,
    corner_rows: Vec<VertexId>,
    /// The edge of the cage under the side that starts at each corner, or none.
    cage_edges: Vec<u32>,
    cage_faces: Vec<u32>,
}

/// The leaves of all levels that are not split, with the vertices on their sides.
pub(super) fn join(
    cage: &Mesh,
    patches: &[Patch],
    vertices: &Vertices,
    data: &mut Data,
    kind: Kind,
) -> Result<Mesh, Error> {
    let mut leaves = Leaves::default();
    let mut number = vec![NONE; vertices.positions.len()];
    let (mut spots, mut face) = (Vec::new(), Vec::new());
    for (level, patch) in patches.iter().enumerate() {
        let mut asked = patch.asked.iter().copied().peekable();
        for f in 0..patch.leaves as u32 {
            if asked.next_if_eq(&f).is_some() {
                continue;
            }
            spots.clear();
            for c in patch.surface.topology.corners(f) {
                let halfedge = patch.surface.topology.corner_halfedge[c as usize];
                let chart = patch.charts.as_ref().map(|charts| &charts.topology);
                let chart_halfedge = chart.map_or(NONE, |t| t.corner_halfedge[c as usize]);
                let vertex = patch.surface.topology.vertex(c);
                spots.push(Spot { level, vertex, chart: chart.map_or(NONE, |t| t.vertex(c)) });
                side(patches, level, [halfedge, chart_halfedge], &mut spots);
                // A side lies on an edge of the cage or does not, with all its vertices.
                leaves.cage_edges.resize(
                    leaves.faces.corners().len() + spots.len(),
                    patch.cage_edges[halfedge as usize / 2],
                );
            }
            face.clear();
            for &Spot { level, vertex, chart } in &spots {
                let Patch { surface, charts, .. } = &patches[level];
                let id = surface.ids[vertex as usize] as usize;
                if number[id] == NONE {
                    number[id] = leaves.positions.len() as u32;
                    leaves.positions.push(vertices.positions[id]);
                    if let Some(carried) = &mut data.vertex {
                        leaves.vertex_rows.push(carried.place(surface, vertex, kind));
                    }
                }
                if let (Some(carried), Some(charts)) = (&mut data.corner, charts) {
                    leaves.corner_rows.push(carried.place(charts, chart, kind));
                }
                face.push(VertexId::new(number[id] as usize));
            }
            leaves.faces.push(&face);
            leaves.cage_faces.push(patch.cage_faces[f as usize]);
        }
    }
    let connectivity = Connectivity::from_faces(leaves.positions.len(), &leaves.faces)?;
    let mut mesh = Mesh::from_parts(connectivity, std::mem::take(&mut leaves.positions).into());
    leaves.carry(cage, data, &mut mesh);
    Ok(mesh)
}

/// Adds the vertices that splits have put on a half-edge, in order, as its face sees them.
fn side(patches: &[Patch], level: usize, [h, chart]: [u32; 2], spots: &mut Vec<Spot>) {
    let Some(&edge) = patches[level].surface.part_edges.get(&(h / 2)) else {
        return;
    };
    // The halves, numbered as the split numbers them, along the half-edge; see `split`.
    let along = 2 * edge + h % 2;
    let next = &patches[level + 1];
    let (chart_along, chart_vertex) = match (&patches[level].charts, &next.charts) {
        (Some(charts), Some(next)) => {
            let edge = charts.part_edges.get(&(chart / 2));
            let edge = edge.expect("a face beside one that is split supports it");
            let along = 2 * edge + chart % 2;
            ([2 * along, 2 * (along ^ 1) + 1], next.topology.to(2 * along))
        }
        _ => ([NONE; 2], NONE),
    };
    side(patches, level + 1, [2 * along, chart_along[0]], spots);
    let vertex = next.surface.topology.to(2 * along);
    spots.push(Spot { level: level + 1, vertex, chart: chart_vertex });
    side(patches, level + 1, [2 * (along ^ 1) + 1, chart_along[1]], spots);
}

impl Leaves {
    /// Gives the result its data. What is sharp is left out: the result is no cage.
    fn carry(&self, cage: &Mesh, data: &Data, mesh: &mut Mesh) {
        let old = cage.attributes();
        if let Some(carried) = &data.vertex {
            let pick = |v: VertexId| Some(self.vertex_rows[v.index()]);
            mesh.attributes_mut().vertex = carried.table.gather(self.vertex_rows.len(), pick);
            mesh.attributes_mut().vertex.remove(SHARPNESS);
        }
        if !old.face.is_empty() {
            let pick = |f: FaceId| Some(FaceId::new(self.cage_faces[f.index()] as usize));
            mesh.attributes_mut().face = old.face.gather(self.cage_faces.len(), pick);
        }
        if old.corner.is_empty() && old.edge.is_empty() {
            return;
        }
        let corners = self.halfedge_corners(mesh);
        if let Some(carried) = &data.corner {
            let pick = |h: HalfedgeId| corners[h.index()].map(|c| self.corner_rows[c]);
            mesh.attributes_mut().corner = carried.table.gather(corners.len(), pick);
        }
        if !old.edge.is_empty() {
            let source = |e: EdgeId| {
                let corner = e.halfedges().into_iter().find_map(|h| corners[h.index()]);
                let edge = self.cage_edges[corner.expect("an edge has a face")];
                (edge != NONE).then(|| EdgeId::new(edge as usize))
            };
            let mut edges: AttributeTable<EdgeId> = old.edge.gather(mesh.edge_count(), source);
            edges.remove(SHARPNESS);
            mesh.attributes_mut().edge = edges;
        }
    }

    /// The corner in the list of faces that each half-edge with a face starts at.
    fn halfedge_corners(&self, mesh: &Mesh) -> Vec<Option<usize>> {
        let mut corners = vec![None; mesh.halfedge_count()];
        let mut start = 0;
        for (f, face) in self.faces.iter() {
            for h in mesh.face_halfedges(f) {
                let place = face.iter().position(|&v| v == mesh.from(h));
                corners[h.index()] = place.map(|k| start + k);
            }
            start += face.len();
        }
        corners
    }
}
