//! Vertices move to the middle of what surrounds them, along the surface, and back onto the input.
//!
//! All move at once, from where all were before. Those after whose move a triangle would look elsewhere stay.

use dgp_mesh::{
    Cancelled, DVec3, FaceId, FaceMap, Progress, VertexId, VertexMap, parallel,
    spatial::{Near, TriangleTree},
};

use super::{
    lines::{Line, along},
    sizing::Sizing,
    surface::{Freedom, NONE, Surface, prev},
};

/// The least cosine between a triangle before and after a move.
const LEAST_COSINE: f64 = 0.3;

/// The input, to come back to.
pub(super) struct Ground {
    pub(super) positions: Vec<DVec3>,
    pub(super) tree: TriangleTree,
    /// The normals of its faces.
    pub(super) normals: FaceMap<DVec3>,
}

/// A vertex after its move.
#[derive(Clone, Copy)]
struct Moved {
    position: DVec3,
    along: f64,
    near: Near,
    size: f64,
}

impl Surface {
    /// One step of relaxation for all vertices; those that would turn triangles over stay.
    pub(super) fn relax(
        &mut self,
        ground: &Ground,
        lines: &[Line],
        sizing: &Sizing,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        progress.report(0.0)?;
        let moved: VertexMap<Moved> = parallel::map(self.vertices.len(), |v: VertexId| {
            self.moved(v.index() as u32, ground, lines, sizing)
        });
        progress.report(0.8)?;
        let moved = moved.into_values();
        let mut stays = vec![false; moved.len()];
        let at = |v: u32, stays: &[bool]| {
            if stays[v as usize] { self.position(v) } else { moved[v as usize].position }
        };
        let is_turned = |f: usize, stays: &[bool]| {
            let corners = self.triangles[f].from;
            let [p, q, r] = corners.map(|v| at(v, stays));
            turns(self.area(corners), (q - p).cross(r - p))
        };
        let turned = parallel::map_blocks(self.triangles.len(), parallel::BLOCK, |range| {
            let turned = range.filter(|&f| self.has(f) && is_turned(f, &stays));
            turned.collect::<Vec<usize>>()
        });
        // What stays may turn what is around it in turn.
        let mut waiting: Vec<usize> = turned.into_iter().flatten().rev().collect();
        while let Some(f) = waiting.pop() {
            if !is_turned(f, &stays) {
                continue;
            }
            for v in self.triangles[f].from {
                if !std::mem::replace(&mut stays[v as usize], true) {
                    waiting.extend(self.spokes(v).map(|h| (h >> 2) as usize));
                }
            }
        }
        for (v, (new, stays)) in moved.into_iter().zip(stays).enumerate() {
            if !stays {
                self.positions[v] = new.position;
                let vertex = &mut self.vertices[v];
                vertex.along = new.along;
                vertex.near = new.near;
                vertex.size = new.size;
            }
        }
        Ok(())
    }

    /// Where `v` moves to.
    fn moved(&self, v: u32, ground: &Ground, lines: &[Line], sizing: &Sizing) -> Moved {
        let vertex = self.vertex(v);
        let here = self.position(v);
        let mut moved =
            Moved { position: here, along: vertex.along, near: vertex.near, size: vertex.size };
        if !vertex.is_there || vertex.spoke == NONE {
            return moved;
        }
        match vertex.freedom {
            Freedom::Fixed => {}
            Freedom::Line => {
                let line = &lines[vertex.line as usize];
                let mut sum = 0.0;
                for w in self.line_neighbors(v) {
                    if w != NONE {
                        sum += 0.5 * line.way(vertex.along, along(self, line, w));
                    }
                }
                // Half the way, or every other vertex would swing.
                moved.along += 0.5 * sum;
                moved.position = line.point(moved.along);
                if sizing.varies() {
                    let found = ground.tree.closest_point_near(moved.position, &mut moved.near);
                    moved.size = found.map_or(moved.size, |found| sizing.at(&found));
                }
            }
            Freedom::Free => {
                let (goal, normal) = self.goal(v);
                let mut near = vertex.near;
                if let Some(found) = ground.tree.closest_point_near(goal, &mut near) {
                    // The other side of a thin wall is nearer, but not where it belongs.
                    if ground.normals[found.face].dot(normal) >= 0.0 {
                        moved.position = found.point;
                        moved.near = near;
                        if sizing.varies() {
                            moved.size = sizing.at(&found);
                        }
                    }
                }
            }
        }
        moved
    }

    /// The middle of the triangles around `v`, by their areas, in its tangent plane; and its normal.
    fn goal(&self, v: u32) -> (DVec3, DVec3) {
        let here = self.position(v);
        let (mut sum, mut weight, mut normal) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for h in self.spokes(v) {
            let (b, c) = (self.to(h), self.from(prev(h)));
            let (x, y) = (self.position(b) - here, self.position(c) - here);
            let area = x.cross(y);
            let size = (self.vertex(v).size + self.vertex(b).size + self.vertex(c).size) / 3.0;
            // Small triangles are where they should be small.
            let w = area.length() / (size * size);
            sum += (x + y) * (w / 3.0);
            weight += w;
            normal += area;
        }
        let normal = normal.normalize_or_zero();
        if !(weight > 0.0) {
            return (here, normal);
        }
        let way = sum / weight;
        (here + way - normal * way.dot(normal), normal)
    }
}

/// Whether a triangle of one vector area becomes one that looks elsewhere or has none.
#[inline]
fn turns(before: DVec3, after: DVec3) -> bool {
    let (was, is) = (before.length_squared(), after.length_squared());
    let cosine = before.dot(after);
    was > 0.0 && (cosine <= 0.0 || cosine * cosine < LEAST_COSINE * LEAST_COSINE * was * is)
}

/// The normals of the triangles of `faces`.
pub(super) fn normals(surface: &Surface) -> FaceMap<DVec3> {
    parallel::map(surface.triangles.len(), |f: FaceId| {
        surface.area(surface.triangles[f.index()].from).normalize_or_zero()
    })
}
