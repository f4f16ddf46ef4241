//! Phong tessellation: triangles bent by the normals at their corners.
//!
//! ```text
//! p*(u, v, w) = u² p₀ + v² p₁ + w² p₂ + uv (π₀(p₁) + π₁(p₀)) + vw (π₁(p₂) + π₂(p₁)) + wu (π₂(p₀) + π₀(p₂))
//! p = (1 − α)(u p₀ + v p₁ + w p₂) + α p*       π_i(q) = q − ((q − p_i)·n_i) n_i
//! ```
//!
//! Data of vertices and of corners are flat: mixed by u, v, w, those of corners within each triangle.
//!
//! - Input: triangles, a unit normal per vertex.
//! - Cost: O(segments² F).
//! - Guarantees: vertices stay; a point on an edge depends on its ends only, so there are no cracks.
//! - Reference: Boubekeur and Alexa, "Phong tessellation", SIGGRAPH Asia 2008.

use dgp_mesh::{
    AttributeTable, Connectivity, DVec3, EdgeId, FaceId, FaceList, HalfedgeId, Mesh, Progress,
    VertexId, VertexMap,
};

use crate::{Counts, Error, RefinementOptions, subdivide::check_finite};

/// How [`phong_tessellate`] bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongOptions {
    /// Into how many parts each edge is cut.
    pub segments: usize,
    /// α, from 0 (flat) to 1.
    pub alpha: f64,
    /// How many bytes may be used. More is refused before anything is computed.
    pub memory_limit: u64,
}

impl Default for PhongOptions {
    fn default() -> Self {
        let memory_limit = RefinementOptions::default().memory_limit;
        PhongOptions { segments: 4, alpha: 0.75, memory_limit }
    }
}

/// `mesh` with each triangle cut into `segments`² that are bent by `normals`, unit vectors one per
/// vertex; with its data. Vertices keep their numbers, points on edges and in faces follow.
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::TooLarge`],
/// [`Error::InvalidOption`], [`Error::WrongLength`], [`Error::Cancelled`].
pub fn phong_tessellate(
    mesh: &Mesh,
    normals: &VertexMap<DVec3>,
    options: &PhongOptions,
    progress: Progress<'_>,
) -> Result<Mesh, Error> {
    progress.report(0.0)?;
    options.validate()?;
    crate::stencil::check_length("vertex", normals.len(), mesh.vertex_count())?;
    check_finite(mesh.positions().values())?;
    check_finite(normals.values())?;
    if let Some(face) = mesh.faces().find(|&f| mesh.triangle(f).is_none()) {
        let degree = mesh.degree(face);
        return Err(Error::NotTriangle { scheme: "Phong tessellation", face, degree });
    }
    let cut = Cut { mesh, normals, n: options.segments, alpha: options.alpha };
    cut.check_size(options.memory_limit)?;
    let (positions, faces) = (cut.positions(), cut.faces());
    progress.report(0.5)?;
    check_finite(&positions)?;
    let connectivity = Connectivity::from_faces(positions.len(), &faces)?;
    let mut bent = Mesh::from_parts(connectivity, positions.into());
    progress.report(0.8)?;
    cut.carry(&faces, &mut bent);
    progress.report(1.0)?;
    Ok(bent)
}

impl PhongOptions {
    fn validate(&self) -> Result<(), Error> {
        if self.segments == 0 {
            return Err(Error::InvalidOption {
                name: "segments",
                value: 0.0,
                expected: "at least 1",
            });
        }
        if !(0.0..=1.0).contains(&self.alpha) {
            return Err(Error::InvalidOption {
                name: "alpha",
                value: self.alpha,
                expected: "from 0 to 1",
            });
        }
        Ok(())
    }
}

/// Where the points of the result are.
struct Cut<'a> {
    mesh: &'a Mesh,
    normals: &'a VertexMap<DVec3>,
    n: usize,
    alpha: f64,
}

impl Cut<'_> {
    fn check_size(&self, limit: u64) -> Result<(), Error> {
        let n = u128::from(self.n as u64);
        let [vertices, edges, faces] =
            [self.mesh.vertex_count(), self.mesh.edge_count(), self.mesh.face_count()]
                .map(|count| count as u128);
        let square = n.saturating_mul(n);
        let counts = [
            square.saturating_mul(faces).saturating_add(vertices.max(edges)),
            square.saturating_mul(faces).saturating_mul(2).saturating_add(edges),
            square.saturating_mul(faces).saturating_mul(3),
            square.saturating_mul(faces),
        ]
        .map(|count| u64::try_from(count).unwrap_or(u64::MAX));
        let [vertices, edges, corners, faces] = counts;
        let counts = Counts { vertices, edges, corners, faces };
        let options =
            RefinementOptions { levels: 0, memory_limit: limit, ..RefinementOptions::default() };
        options.predict(counts).map(|_| ())
    }

    /// The point between corners, with weights that sum to 1.
    fn point(&self, corners: [VertexId; 3], [u, v, w]: [f64; 3]) -> DVec3 {
        let [p, q, r] = corners.map(|v| self.mesh.position(v));
        let flat = u * p + v * q + w * r;
        // Onto the plane at the first of two corners, and of the second onto its plane.
        let pair = |i: usize, j: usize| {
            let project = |i: usize, j: usize| {
                let (p, normal) = (self.mesh.position(corners[i]), self.normals[corners[i]]);
                let q = self.mesh.position(corners[j]);
                q - (q - p).dot(normal) * normal
            };
            project(i, j) + project(j, i)
        };
        let bent = u * u * p + v * v * q + w * w * r;
        let bent = bent + u * v * pair(0, 1) + v * w * pair(1, 2) + w * u * pair(2, 0);
        (1.0 - self.alpha) * flat + self.alpha * bent
    }

    fn positions(&self) -> Vec<DVec3> {
        let mut positions = self.mesh.positions().values().to_vec();
        self.each_point(|corners, weights| positions.push(self.point(corners, weights)));
        positions
    }

    /// The corners and weights of each new point, in the order of their numbers.
    fn each_point(&self, mut f: impl FnMut([VertexId; 3], [f64; 3])) {
        let n = self.n as f64;
        for e in self.mesh.edges() {
            let [a, b] = self.mesh.edge_vertices(e);
            for i in 1..self.n {
                let t = i as f64 / n;
                f([a, b, b], [1.0 - t, t, 0.0]);
            }
        }
        for face in self.mesh.faces() {
            let corners = self.mesh.triangle(face).expect("checked before");
            for i in 1..self.n {
                for j in 1..self.n - i {
                    let (v, w) = (i as f64 / n, j as f64 / n);
                    f(corners, [1.0 - v - w, v, w]);
                }
            }
        }
    }

    /// The parts of a triangle, each corner by its steps toward the second and the third corner.
    fn parts(&self) -> Vec<[[usize; 2]; 3]> {
        let mut parts = Vec::with_capacity(self.n * self.n);
        for i in 0..self.n {
            for j in 0..self.n - i {
                parts.push([[i, j], [i + 1, j], [i, j + 1]]);
                if i + j + 1 < self.n {
                    parts.push([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
                }
            }
        }
        parts
    }

    fn faces(&self) -> FaceList {
        let parts = self.parts();
        let at = |f: FaceId, [i, j]: [usize; 2]| VertexId::new(self.number(f, i, j));
        let mut triangles = Vec::with_capacity(self.mesh.face_count() * parts.len());
        for f in self.mesh.faces() {
            triangles.extend(parts.iter().map(|part| part.map(|step| at(f, step))));
        }
        FaceList::from_triangles(triangles)
    }

    /// Gives `bent`, which has these faces, the data of the mesh.
    fn carry(&self, faces: &FaceList, bent: &mut Mesh) {
        let old = self.mesh.attributes();
        if !old.vertex.is_empty() {
            let mut vertex = old.vertex.clone();
            self.each_point(|[p, q, r], [u, v, w]| {
                vertex.push_mixed(&[(u, p), (v, q), (w, r)]);
            });
            bent.attributes_mut().vertex = vertex;
        }
        let parts = self.parts();
        if !old.face.is_empty() {
            let pick = |f: FaceId| Some(FaceId::new(f.index() / parts.len()));
            bent.attributes_mut().face = old.face.gather(bent.face_count(), pick);
        }
        if !old.corner.is_empty() {
            bent.attributes_mut().corner = self.corners(&parts, faces, bent);
        }
        if !old.edge.is_empty() {
            let mut source = vec![None; bent.edge_count()];
            for e in self.mesh.edges() {
                let h = e.halfedge();
                let end = |i: usize| match i {
                    0 => self.mesh.from(h),
                    i if i == self.n => self.mesh.to(h),
                    i => VertexId::new(self.on_edge(h, i)),
                };
                for i in 0..self.n {
                    if let Some(part) = bent.halfedge_between(end(i), end(i + 1)) {
                        source[part.edge().index()] = Some(e);
                    }
                }
            }
            let pick = |e: EdgeId| source[e.index()];
            bent.attributes_mut().edge = old.edge.gather(source.len(), pick);
        }
    }

    /// The data of the corners of `bent`.
    fn corners(
        &self,
        parts: &[[[usize; 2]; 3]],
        faces: &FaceList,
        bent: &Mesh,
    ) -> AttributeTable<HalfedgeId> {
        let n = self.n as f64;
        let mut data = self.mesh.attributes().corner.clone();
        let mut rows = vec![None; bent.halfedge_count()];
        for f in self.mesh.faces() {
            let sides: Vec<HalfedgeId> = self.mesh.face_halfedges(f).collect();
            let corners = self.mesh.triangle(f).expect("checked before").map(|v| {
                let side = sides.iter().find(|&&h| self.mesh.from(h) == v);
                *side.expect("a side leaves a corner")
            });
            for (k, part) in parts.iter().enumerate() {
                let child = FaceId::new(f.index() * parts.len() + k);
                for h in bent.face_halfedges(child) {
                    let place = faces.face(child).iter().position(|&v| v == bent.from(h));
                    let [i, j] = part[place.expect("a side leaves a corner")];
                    let weights =
                        [(self.n - i - j) as f64, i as f64, j as f64].map(|share| share / n);
                    let mix = [0, 1, 2].map(|k| (weights[k], corners[k]));
                    rows[h.index()] = Some(data.push_mixed(&mix));
                }
            }
        }
        data.gather(rows.len(), |h: HalfedgeId| rows[h.index()])
    }

    /// The number of the point `i` steps toward the second corner and `j` toward the third.
    fn number(&self, f: FaceId, i: usize, j: usize) -> usize {
        let n = self.n;
        let [p, q, r] = self.mesh.triangle(f).expect("checked before");
        let first = self.mesh.face_halfedge(f);
        let second = self.mesh.next(first);
        let sides = [first, second, self.mesh.next(second)];
        // Sides of the triangle in the order of its corners.
        let side = |from: VertexId| {
            sides.into_iter().find(|&h| self.mesh.from(h) == from).expect("a side leaves a corner")
        };
        match (i, j) {
            (0, 0) => p.index(),
            (i, 0) if i == n => q.index(),
            (0, j) if j == n => r.index(),
            (i, 0) => self.on_edge(side(p), i),
            (0, j) => self.on_edge(side(r), n - j),
            (i, j) if i + j == n => self.on_edge(side(q), j),
            (i, j) => {
                let before = self.mesh.vertex_count() + self.mesh.edge_count() * (n - 1);
                // Rows before row i have n − 2, n − 3, … points.
                let rows: usize = (1..i).map(|i| n - 1 - i).sum();
                before + f.index() * ((n - 1) * (n - 2) / 2) + rows + j - 1
            }
        }
    }

    /// The number of the point `i` steps along `h`.
    fn on_edge(&self, h: HalfedgeId, i: usize) -> usize {
        let e: EdgeId = h.edge();
        let i = if h == e.halfedge() { i } else { self.n - i };
        self.mesh.vertex_count() + e.index() * (self.n - 1) + i - 1
    }
}

#[cfg(test)]
mod tests {
    use dgp_mesh::shapes;

    use super::*;

    fn sphere(level: usize) -> (Mesh, VertexMap<DVec3>) {
        let mesh = shapes::icosphere(level).unwrap();
        let normals = mesh.map_vertices(|v| mesh.position(v).normalize());
        (mesh, normals)
    }

    #[test]
    fn spheres_come_closer_and_vertices_stay() {
        for level in 0..3 {
            let (mesh, normals) = sphere(level);
            let deviation = |alpha: f64| {
                let options = PhongOptions { segments: 5, alpha, ..PhongOptions::default() };
                let bent = phong_tessellate(&mesh, &normals, &options, Progress::NONE).unwrap();
                assert_eq!(bent.face_count(), 25 * mesh.face_count());
                assert_eq!(dgp_mesh::topology::euler_characteristic(&bent), 2);
                assert_eq!(
                    &bent.positions().values()[..mesh.vertex_count()],
                    mesh.positions().values()
                );
                let radii = bent.positions().values().iter().map(|p| (p.length() - 1.0).abs());
                radii.fold(0.0, f64::max)
            };
            assert!(deviation(0.75) < 0.5 * deviation(0.0), "level {level}");
        }
    }

    #[test]
    fn planes_stay_planes() {
        let mesh = shapes::grid(3, 2).unwrap();
        let normals = mesh.map_vertices(|_| DVec3::Z);
        let bent = phong_tessellate(&mesh, &normals, &PhongOptions::default(), Progress::NONE);
        let bent = bent.unwrap();
        assert!(bent.positions().values().iter().all(|p| p.z == 0.0));
        let area = |mesh: &Mesh| dgp_mesh::measure::face_areas(mesh).values().iter().sum::<f64>();
        assert!((area(&bent) - area(&mesh)).abs() < 1e-14);
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let (mesh, normals) = sphere(0);
        let refused = |options: PhongOptions| {
            phong_tessellate(&mesh, &normals, &options, Progress::NONE).unwrap_err()
        };
        let default = PhongOptions::default();
        let name = |error: Error| match error {
            Error::InvalidOption { name, .. } => name,
            other => panic!("{other}"),
        };
        assert_eq!(name(refused(PhongOptions { segments: 0, ..default })), "segments");
        assert_eq!(name(refused(PhongOptions { alpha: f64::NAN, ..default })), "alpha");
        let error = refused(PhongOptions { segments: usize::MAX, ..default });
        assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    }
}
