//! From the triangles that were edited back to a mesh, with data taken from the input.

use dgp_mesh::{
    Attributes, Connectivity, DVec3, FaceId, FaceList, FaceMap, HalfedgeId, Mesh, VertexId,
    VertexMap, measure::barycentric_3d, parallel, spatial::ClosestPoint,
};

use super::{
    options::Origin,
    relax::Ground,
    surface::{NONE, Surface, prev},
};
use crate::Error;

/// How far from a vertex toward the middle of what is around it one looks for the face it continues.
const INWARD: f64 = 1e-9;

/// The triangles as a mesh, and where its elements are in the surface.
pub(super) struct Packed {
    pub(super) mesh: Mesh,
    pub(super) vertices: Vec<u32>,
    pub(super) triangles: Vec<u32>,
}

impl Surface {
    /// What is left, in its order, at coordinates multiplied by `scale`.
    pub(super) fn packed(&self, scale: f64) -> Result<Packed, Error> {
        let count = self.vertices.len();
        let vertices: Vec<u32> = (0..count as u32).filter(|&v| self.vertex(v).is_there).collect();
        let mut number = vec![NONE; count];
        for (i, &v) in vertices.iter().enumerate() {
            number[v as usize] = i as u32;
        }
        let triangles: Vec<u32> =
            (0..self.triangles.len()).filter(|&f| self.has(f)).map(|f| f as u32).collect();
        let faces = triangles.iter().map(|&f| {
            self.triangles[f as usize].from.map(|v| VertexId::new(number[v as usize] as usize))
        });
        let list = FaceList::from_triangles(faces.collect());
        let connectivity = Connectivity::from_faces(vertices.len(), &list)?;
        let positions: Vec<DVec3> = vertices.iter().map(|&v| self.position(v) * scale).collect();
        Ok(Packed { mesh: Mesh::from_parts(connectivity, positions.into()), vertices, triangles })
    }

    /// Where each vertex lies on the input.
    pub(super) fn origins(
        &self,
        vertices: &[u32],
        ground: &Ground,
    ) -> VertexMap<Option<ClosestPoint>> {
        parallel::map(vertices.len(), |v: VertexId| {
            let vertex = self.vertex(vertices[v.index()]);
            let mut near = vertex.near;
            let position = self.position(vertices[v.index()]);
            let found = ground.tree.closest_point_near(position, &mut near);
            found.filter(|_| vertex.spoke != NONE)
        })
    }

    /// Fills the tables of `packed` with what the input has at the same places.
    pub(super) fn carry_data(
        &self,
        input: &Mesh,
        packed: &mut Packed,
        origins: &VertexMap<Option<ClosestPoint>>,
        ground: &Ground,
    ) {
        let data = input.attributes();
        let mut carried: Attributes = packed.mesh.attributes().clone();
        if !data.vertex.is_empty() {
            let old = data.vertex.len();
            let mut both = data.vertex.clone();
            both.resize(old + packed.vertices.len());
            for (v, origin) in origins.iter() {
                let own = VertexId::new(packed.vertices[v.index()] as usize);
                let place = VertexId::new(old + v.index());
                match origin {
                    Some(origin) => {
                        let parts = origin.barycentric.into_iter().zip(origin.vertices);
                        both.mix(place, &parts.collect::<Vec<_>>());
                    }
                    // Vertices of no face stay what they were.
                    None => both.copy(own, place),
                }
            }
            let of = |v: VertexId| Some(VertexId::new(old + v.index()));
            carried.vertex = both.gather(packed.vertices.len(), of);
        }
        if !data.face.is_empty() {
            let sources: FaceMap<Option<FaceId>> =
                parallel::map(packed.triangles.len(), |f: FaceId| {
                    let [p, q, r] = self.triangles[packed.triangles[f.index()] as usize]
                        .from
                        .map(|v| self.position(v));
                    ground.tree.closest_point((p + q + r) / 3.0).map(|found| found.face)
                });
            carried.face = data.face.gather(packed.triangles.len(), |f: FaceId| sources[f]);
        }
        if !data.corner.is_empty() {
            let old = data.corner.len();
            let mut both = data.corner.clone();
            both.resize(old + packed.mesh.halfedge_count());
            let at = self.corner_points(packed, origins, ground);
            for h in packed.mesh.halfedges().filter(|&h| !packed.mesh.is_boundary_halfedge(h)) {
                let Some(point) = &at[h.index()] else { continue };
                let parts: Vec<(f64, HalfedgeId)> = point
                    .barycentric
                    .into_iter()
                    .zip(point.vertices)
                    .filter_map(|(weight, v)| {
                        let mut sides = input.face_halfedges(point.face);
                        sides.find(|&side| input.from(side) == v).map(|side| (weight, side))
                    })
                    .collect();
                both.mix(HalfedgeId::new(old + h.index()), &parts);
            }
            carried.corner = both.gather(packed.mesh.halfedge_count(), |h: HalfedgeId| {
                Some(HalfedgeId::new(old + h.index()))
            });
        }
        *packed.mesh.attributes_mut() = carried;
    }

    /// For each corner of the result, by its half-edge, the point of the input it continues: the same one for all
    /// corners of a vertex between lines, on their side of these.
    fn corner_points(
        &self,
        packed: &Packed,
        origins: &VertexMap<Option<ClosestPoint>>,
        ground: &Ground,
    ) -> Vec<Option<ClosestPoint>> {
        // The half-edge of the result for each one of the surface.
        let mut place = vec![NONE; 4 * self.triangles.len()];
        for (f, &triangle) in packed.triangles.iter().enumerate() {
            let corners = self.triangles[triangle as usize].from;
            for h in packed.mesh.face_halfedges(FaceId::new(f)) {
                let v = packed.vertices[packed.mesh.from(h).index()];
                if let Some(k) = corners.iter().position(|&w| w == v) {
                    place[4 * triangle as usize + k] = h.index() as u32;
                }
            }
        }
        let mut points = vec![None; packed.mesh.halfedge_count()];
        let mut spokes = Vec::new();
        for (v, &own) in packed.vertices.iter().enumerate() {
            spokes.clear();
            spokes.extend(self.spokes(own));
            let count = spokes.len();
            let Some(first) = spokes.iter().position(|&h| self.line(h) != NONE) else {
                for &h in &spokes {
                    points[place[h as usize] as usize] = origins[VertexId::new(v)];
                }
                continue;
            };
            spokes.rotate_left(first);
            let mut start = 0;
            while start < count {
                let mut end = start + 1;
                while end < count && self.line(spokes[end]) == NONE {
                    end += 1;
                }
                let point = self.point_between(own, &spokes[start..end], ground);
                for &h in &spokes[start..end] {
                    points[place[h as usize] as usize] = point;
                }
                start = end;
            }
        }
        points
    }

    /// The point of the input at `v`, on the face that continues there between two lines.
    fn point_between(&self, v: u32, spokes: &[u32], ground: &Ground) -> Option<ClosestPoint> {
        let here = self.position(v);
        let middle: DVec3 = spokes
            .iter()
            .map(|&h| self.position(self.to(h)) + self.position(self.from(prev(h))))
            .sum();
        let middle = middle / (2.0 * spokes.len() as f64);
        let found = ground.tree.closest_point(here.lerp(middle, INWARD))?;
        Some(ground.in_face(here, &found))
    }
}

impl Ground {
    /// The point of the face of `found` that is nearest to `p`, or not far from that.
    fn in_face(&self, p: DVec3, found: &ClosestPoint) -> ClosestPoint {
        let corners = found.vertices.map(|v| self.positions[v.index()]);
        let Some(weights) = barycentric_3d(p, corners) else { return *found };
        let weights = weights.map(|weight| weight.max(0.0));
        let sum: f64 = weights.iter().sum();
        ClosestPoint { barycentric: weights.map(|weight| weight / sum), ..*found }
    }
}

impl From<&ClosestPoint> for Origin {
    fn from(point: &ClosestPoint) -> Self {
        Origin { face: point.face, vertices: point.vertices, barycentric: point.barycentric }
    }
}
