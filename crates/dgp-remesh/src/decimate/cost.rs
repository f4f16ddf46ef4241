//! What a collapse costs: edge length, curvature, quadrics, or whatever the caller says.
//!
//! ```text
//! length      |u − v|
//! curvature   |u − v| · max over triangles f at u  min over triangles n at the edge  (1 − n_f·n_n)/2
//! quadric     min over p of Q_u(p) + Q_v(p)
//! ```
//!
//! - Input: an edge of a mesh, and what the cost remembers of its ends.
//! - Cost: O(1) for length, O(valence²) for curvature, a system of three equations for quadrics.
//! - Reference: Melax, "A simple, fast, and effective polygon reduction algorithm", Game Developer 1998;
//!   Garland and Heckbert 1997; Trettner and Kobbelt 2020.

use dgp_mesh::{DVec3, HalfedgeId, Mesh, VertexId, VertexMap};

use crate::Quadric;

/// What a collapse costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// Collapses are done in the order of it. Infinite or no number: never.
    pub key: f64,
    /// What [`Target::Error`](crate::Target::Error) is compared with, in the unit of the coordinates.
    pub error: f64,
}

/// Orders the collapses of [`decimate`](crate::decimate()). A closure that prices the collapse of a half-edge
/// is one.
pub trait CollapseCost {
    /// Where the vertex that remains when `from(h)` and `to(h)` become one goes, if it may go anywhere.
    fn place(&self, mesh: &Mesh, h: HalfedgeId) -> DVec3 {
        mesh.position(mesh.to(h))
    }

    /// What it costs to merge `from(h)` into `to(h)` at `position`.
    fn price(&self, mesh: &Mesh, h: HalfedgeId, position: DVec3) -> Price;

    /// Called before `from(h)` is merged into `to(h)` at `position`.
    fn merge(&mut self, _mesh: &Mesh, _h: HalfedgeId, _position: DVec3) {}

    /// Whether a collapse changes the price of edges between neighbors of the vertex that remains.
    fn reaches_ring(&self) -> bool {
        true
    }
}

impl<F: Fn(&Mesh, HalfedgeId) -> f64> CollapseCost for F {
    fn price(&self, mesh: &Mesh, h: HalfedgeId, _position: DVec3) -> Price {
        let key = self(mesh, h);
        Price { key, error: key }
    }
}

/// Short edges first; they shrink to their middle.
#[derive(Clone, Copy, Debug, Default)]
pub struct LengthCost;

impl CollapseCost for LengthCost {
    fn place(&self, mesh: &Mesh, h: HalfedgeId) -> DVec3 {
        mesh.edge_midpoint(h.edge())
    }

    fn price(&self, mesh: &Mesh, h: HalfedgeId, _position: DVec3) -> Price {
        let key = mesh.edge_length(h.edge());
        Price { key, error: key }
    }

    fn reaches_ring(&self) -> bool {
        false
    }
}

/// Short edges where the surface bends little first; vertices stay ones of the input (Melax 1998).
#[derive(Clone, Copy, Debug, Default)]
pub struct CurvatureCost;

impl CollapseCost for CurvatureCost {
    fn price(&self, mesh: &Mesh, h: HalfedgeId, _position: DVec3) -> Price {
        let sides = mesh.edge_faces(h.edge()).map(|f| f.map(|f| mesh.face_normal(f)));
        let bend = |f| {
            let normal = mesh.face_normal(f);
            let turns = sides.iter().flatten().map(|n| 0.5 * (1.0 - normal.dot(*n)));
            turns.fold(1.0, f64::min)
        };
        let mut worst = mesh.vertex_faces(mesh.from(h)).map(bend).fold(0.0, f64::max);
        // A vertex of a rim may go along the rim only without a price.
        if mesh.is_boundary_vertex(mesh.from(h)) && !mesh.is_boundary_edge(h.edge()) {
            worst = 1.0;
        }
        let key = mesh.edge_length(h.edge()) * worst;
        Price { key, error: key }
    }
}

/// Quadrics of the planes of the input, kept as vertices merge.
#[derive(Clone, Debug)]
pub struct QuadricCost {
    /// Relative to the position of each vertex.
    quadrics: VertexMap<Quadric>,
    damping: f64,
}

impl QuadricCost {
    /// Planes of faces, weighted by area, and of rims, weighted by squared length times `boundary_weight`.
    /// Faces that are no triangles count as the triangles around their center.
    pub fn new(mesh: &Mesh, boundary_weight: f64) -> Self {
        let mut quadrics = QuadricCost::of_triangles(mesh, Quadric::triangle);
        for h in mesh.halfedges().filter(|&h| mesh.is_boundary_halfedge(h)) {
            let Some(f) = mesh.face(h.twin()) else { continue };
            let side = mesh.halfedge_vector(h);
            let away = side.cross(mesh.face_normal(f));
            let length = away.length();
            if length > 0.0 {
                let fence =
                    Quadric::plane(away / length, DVec3::ZERO, boundary_weight * length * length);
                quadrics[mesh.from(h)] += fence;
                quadrics[mesh.to(h)] += fence;
            }
        }
        QuadricCost { quadrics, damping: 1e-6 }
    }

    /// Probabilistic quadrics: coordinates are taken to be off by `sigma` times the mean edge length.
    pub fn probabilistic(mesh: &Mesh, sigma: f64) -> Self {
        let lengths = mesh.edges().map(|e| mesh.edge_length(e));
        let mean = lengths.sum::<f64>() / mesh.edge_count().max(1) as f64;
        let of = |p| Quadric::probabilistic_triangle(p, sigma * mean);
        QuadricCost { quadrics: QuadricCost::of_triangles(mesh, of), damping: 0.0 }
    }

    fn of_triangles(mesh: &Mesh, of: impl Fn([DVec3; 3]) -> Quadric) -> VertexMap<Quadric> {
        let mut quadrics = VertexMap::filled(mesh.vertex_count(), Quadric::ZERO);
        let mut add = |v: VertexId, corners: [DVec3; 3]| {
            let p = mesh.position(v);
            quadrics[v] += of(corners.map(|q| q - p));
        };
        for f in mesh.faces() {
            if let Some(corners) = mesh.triangle(f) {
                let positions = corners.map(|v| mesh.position(v));
                for v in corners {
                    add(v, positions);
                }
            } else {
                let center = mesh.face_center(f);
                for h in mesh.face_halfedges(f) {
                    let ends = [mesh.from(h), mesh.to(h)];
                    let [p, q] = ends.map(|v| mesh.position(v));
                    for v in ends {
                        add(v, [p, q, center]);
                    }
                }
            }
        }
        quadrics
    }

    /// The quadric of both ends, relative to the middle of the edge.
    fn merged(&self, mesh: &Mesh, h: HalfedgeId, origin: DVec3) -> Quadric {
        let of = |v: VertexId| self.quadrics[v].moved(origin - mesh.position(v));
        of(mesh.from(h)) + of(mesh.to(h))
    }
}

impl CollapseCost for QuadricCost {
    fn place(&self, mesh: &Mesh, h: HalfedgeId) -> DVec3 {
        let middle = mesh.edge_midpoint(h.edge());
        let quadric = self.merged(mesh, h, middle);
        let ends = [mesh.position(mesh.from(h)), mesh.position(mesh.to(h))];
        let reach = 2.0 * (ends[1] - ends[0]).length();
        let best = quadric.minimum_near(DVec3::ZERO, self.damping);
        let best = best.filter(|p| p.length() <= reach).map(|p| middle + p);
        // Ends first: of equals they are chosen, and stay exactly where they are.
        let candidates = [ends[1], ends[0], middle].into_iter().chain(best);
        let mut found = (f64::INFINITY, ends[1]);
        for p in candidates {
            let value = quadric.at(p - middle).max(0.0);
            if value < found.0 {
                found = (value, p);
            }
        }
        found.1
    }

    fn price(&self, mesh: &Mesh, h: HalfedgeId, position: DVec3) -> Price {
        let quadric = self.merged(mesh, h, position);
        let key = quadric.c.max(0.0);
        let weight = quadric.weight();
        Price { key, error: if key > 0.0 { (key / weight).sqrt() } else { 0.0 } }
    }

    fn merge(&mut self, mesh: &Mesh, h: HalfedgeId, position: DVec3) {
        self.quadrics[mesh.to(h)] = self.merged(mesh, h, position);
    }

    fn reaches_ring(&self) -> bool {
        false
    }
}
