//! Bilateral normal filtering: smooths within the faces of a shape and keeps its edges.
//!
//! ```text
//! n(f) ← Σ area(g) W(f, g) n(g), made unit      over the faces g around f
//! W(f, g) = exp(−|c(f) − c(g)|²/2σc²) exp(−|n(f) − n(g)|²/2σs²)
//! x(v) ← x(v) + mean over the faces f at v of n(f) (n(f) · (c(f) − x(v)))
//! ```
//!
//! with face centers c and the mean distance σc between neighboring ones: a face listens to faces that look
//! its way, so that noise averages out and an edge, across which normals differ by more than σs, stays. First the
//! normals are filtered, then vertices are moved until the faces have them. The global scheme finds all normals
//! at once:
//!
//! ```text
//! Σ area(f) (μ |n(f) − n₀(f)|² + (1 − μ) |n(f) − Σ W̃(f, g) n(g)|²) → least,     Σ W̃(f, ·) = 1
//! ```
//!
//! - Input: any mesh; polygons are taken to be flat.
//! - Cost: O(F) per iteration, in parallel; the global scheme one factorization.
//! - Guarantees: what is flat stays flat. Faces without area say nothing and are told nothing.
//! - Reference: Zheng, Fu, Au and Tai, "Bilateral normal filtering for mesh denoising", IEEE TVCG 17(10), 2011;
//!   Sun, Rosin, Martin and Langbein, "Fast and effective feature-preserving mesh denoising", 2007 (vertices).

use dgp_mesh::{
    DVec3, FaceId, FaceMap, Mesh, Progress, VertexSet,
    measure::{face_areas, face_normals},
    parallel,
};
use dgp_sparse::SparseMatrix;

use super::{
    Boundary, SmoothReport, Volume,
    run::{Task, check_finite, run},
};
use crate::{
    Error,
    solve::{FreeSystem, columns, points},
    unit::{power_of_two_below, unit_of},
};

/// How normals are filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BilateralScheme {
    /// Again and again from the faces around.
    Local {
        /// How often.
        iterations: usize,
    },
    /// All at once.
    Global {
        /// μ, from 0 to 1, what closeness to the given normals counts for; the rest is smoothness.
        fidelity: f64,
    },
}

impl Default for BilateralScheme {
    fn default() -> Self {
        BilateralScheme::Local { iterations: 20 }
    }
}

/// Which faces are around a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FaceNeighborhood {
    /// Those that share a vertex with it.
    #[default]
    Vertices,
    /// Those that share an edge: faster, and the edges of a shape are kept more strictly.
    Edges,
}

/// How strongly [`bilateral`] smooths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BilateralOptions {
    /// How normals are filtered.
    pub scheme: BilateralScheme,
    /// σs, the difference of unit normals that counts as an edge: 0.2 to 0.6 in the paper.
    pub sigma: f64,
    /// Which faces are around a face.
    pub neighborhood: FaceNeighborhood,
    /// How often vertices are moved toward the filtered normals: 10 to 20 in the paper.
    pub vertex_iterations: usize,
    /// What vertices at the rim of a hole do: `Fixed` or `Free`; `Curve` is refused.
    pub boundary: Boundary,
    /// What becomes of the enclosed volume.
    pub volume: Volume,
}

impl Default for BilateralOptions {
    fn default() -> Self {
        BilateralOptions {
            scheme: BilateralScheme::default(),
            sigma: 0.35,
            neighborhood: FaceNeighborhood::default(),
            vertex_iterations: 10,
            boundary: Boundary::default(),
            volume: Volume::default(),
        }
    }
}

/// Smooths `mesh`, but for the vertices of `fixed`, and keeps its edges.
///
/// If cancelled while normals are filtered the mesh is as it was; later the iterations done so far remain.
/// Errors: [`Error::InvalidOption`], [`Error::Sparse`], [`Error::Cancelled`], and those of the other methods.
pub fn bilateral(
    mesh: &mut Mesh,
    fixed: &VertexSet,
    options: &BilateralOptions,
    progress: Progress<'_>,
) -> Result<SmoothReport, Error> {
    let BilateralOptions { scheme, sigma, neighborhood, vertex_iterations, boundary, volume } =
        *options;
    if !(sigma > 0.0 && sigma.is_finite()) {
        return Err(Error::option("sigma", sigma, "positive and finite"));
    }
    if boundary == Boundary::Curve {
        return Err(Error::option("boundary", 1.0, "fixed or free: normals smooth no curves"));
    }
    check_finite(mesh)?;
    let filter = Filter::new(mesh, sigma, neighborhood);
    let part = progress.part(0.0, 0.7);
    let normals = match scheme {
        BilateralScheme::Local { iterations } => filter.local(iterations, part)?,
        BilateralScheme::Global { fidelity } => filter.global(fidelity, part)?,
    };
    let faces = Incidence::new(mesh);
    let progress = progress.part(0.7, 1.0);
    let task = Task { fixed, boundary, volume, iterations: vertex_iterations, progress };
    run(mesh, &task, |rings, positions, room| {
        let centers = faces.centers(positions);
        parallel::for_each_chunk(room, parallel::BLOCK, |first, chunk| {
            for (i, moved) in chunk.iter_mut().enumerate() {
                let v = first + i;
                let p = positions[v];
                *moved =
                    if rings.is_fixed(v) { p } else { p + faces.step(v, p, &centers, &normals) };
            }
        });
        std::mem::swap(positions, room);
    })
}

/// What the filters know of the faces.
struct Filter {
    normals: FaceMap<DVec3>,
    /// Relative to the largest.
    areas: Vec<f64>,
    /// The neighbors of face f are at `[f]..[f + 1]`, each with area times the weight of its distance.
    starts: Vec<u32>,
    neighbors: Vec<(u32, f64)>,
    sigma: f64,
}

impl Filter {
    fn new(mesh: &Mesh, sigma: f64, neighborhood: FaceNeighborhood) -> Self {
        let unit = unit_of(mesh.positions().values());
        let centers = mesh.map_faces(|f| mesh.face_center(f) * unit);
        let areas = face_areas(mesh);
        let largest = areas.values().iter().copied().filter(|a| a.is_finite()).fold(0.0, f64::max);
        let down = power_of_two_below(largest);
        let areas: Vec<f64> = areas.values().iter().map(|a| (a * down).min(2.0)).collect();
        let across = |e| match mesh.edge_faces(e) {
            [Some(f), Some(g)] => Some(centers[f].distance(centers[g])),
            _ => None,
        };
        let (count, sum) = mesh
            .edges()
            .filter_map(across)
            .fold((0.0, 0.0), |(count, sum), distance| (count + 1.0, sum + distance));
        let spread: f64 = if count > 0.0 { sum / count } else { 1.0 };
        let blocks = parallel::map_blocks(mesh.face_count(), parallel::BLOCK, |range| {
            let (mut ends, mut neighbors) = (Vec::new(), Vec::new());
            let mut around = Vec::new();
            for f in range.map(FaceId::new) {
                around.clear();
                match neighborhood {
                    FaceNeighborhood::Edges => around.extend(mesh.face_neighbors(f)),
                    FaceNeighborhood::Vertices => {
                        around.extend(mesh.face_vertices(f).flat_map(|v| mesh.vertex_faces(v)));
                    }
                }
                around.sort_unstable();
                around.dedup();
                for &g in around.iter().filter(|&&g| g != f) {
                    let distance = centers[f].distance(centers[g]) / spread;
                    let near = (-0.5 * distance * distance).exp();
                    let near = if near.is_finite() { near } else { 1.0 };
                    neighbors.push((g.index() as u32, areas[g.index()] * near));
                }
                ends.push(neighbors.len() as u32);
            }
            (ends, neighbors)
        });
        let (mut starts, mut neighbors) = (vec![0], Vec::new());
        for (ends, part) in blocks {
            let before = neighbors.len() as u32;
            starts.extend(ends.iter().map(|end| before + end));
            neighbors.extend(part);
        }
        Filter { normals: face_normals(mesh), areas, starts, neighbors, sigma }
    }

    fn neighbors(&self, f: usize) -> &[(u32, f64)] {
        &self.neighbors[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    /// exp(−|m − n|²/2σs²)
    fn similarity(&self, m: DVec3, n: DVec3) -> f64 {
        (-0.5 * m.distance_squared(n) / (self.sigma * self.sigma)).exp()
    }

    fn local(&self, iterations: usize, progress: Progress<'_>) -> Result<FaceMap<DVec3>, Error> {
        let mut normals = self.normals.clone();
        for iteration in 0..iterations {
            progress.report(iteration as f64 / iterations as f64)?;
            normals = parallel::map(normals.len(), |f: FaceId| {
                let n = normals[f];
                let term = |&(g, weight): &(u32, f64)| {
                    let m = normals.values()[g as usize];
                    weight * self.similarity(n, m) * m
                };
                // The face itself speaks too.
                let own = self.areas[f.index()] * n;
                let sum = own + self.neighbors(f.index()).iter().map(term).sum::<DVec3>();
                if n == DVec3::ZERO { n } else { sum.try_normalize().unwrap_or(n) }
            });
        }
        Ok(normals)
    }

    fn global(&self, fidelity: f64, progress: Progress<'_>) -> Result<FaceMap<DVec3>, Error> {
        if !(fidelity > 0.0 && fidelity <= 1.0) {
            return Err(Error::option("fidelity", fidelity, "above 0 and at most 1"));
        }
        progress.report(0.0)?;
        let count = self.areas.len();
        // I − W̃
        let mut triplets = Vec::with_capacity(count + self.neighbors.len());
        for f in 0..count {
            let n = self.normals.values()[f];
            let weight = |&(g, weight): &(u32, f64)| {
                (g, weight * self.similarity(n, self.normals.values()[g as usize]))
            };
            let weights: Vec<(u32, f64)> = self.neighbors(f).iter().map(weight).collect();
            let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
            if total > 0.0 {
                triplets.push((f as u32, f as u32, 1.0));
                triplets.extend(weights.into_iter().map(|(g, w)| (f as u32, g, -w / total)));
            }
        }
        let difference = SparseMatrix::from_triplets(count, count, &triplets)?;
        let smooth: Vec<f64> = self.areas.iter().map(|area| (1.0 - fidelity) * area).collect();
        let close: Vec<f64> = self.areas.iter().map(|area| fidelity * area).collect();
        let matrix = difference.gram(&smooth)?.plus_diagonal(&close)?;
        let diagonal = matrix.diagonal();
        let mut system = FreeSystem::new(count, |f| diagonal[f] == 0.0 || close[f] == 0.0);
        system.factor(&matrix, progress.part(0.1, 0.9))?;
        let mut x = columns(self.normals.values(), 1.0);
        let rhs: Vec<f64> = x.iter().zip(close.iter().cycle()).map(|(x, c)| x * c).collect();
        system.solve(&rhs, &mut x)?;
        let solved = points(&x, 1.0);
        let unit = |f: FaceId| solved[f.index()].try_normalize().unwrap_or(self.normals[f]);
        Ok(parallel::map(count, unit))
    }
}

/// Faces and vertices as lists.
struct Incidence {
    /// The corners of face f are at `[f]..[f + 1]`.
    corner_starts: Vec<u32>,
    corners: Vec<u32>,
    /// The faces of vertex v are at `[v]..[v + 1]`.
    face_starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    fn new(mesh: &Mesh) -> Self {
        let (mut corner_starts, mut corners) = (vec![0], Vec::new());
        for f in mesh.faces() {
            corners.extend(mesh.face_vertices(f).map(|v| v.index() as u32));
            corner_starts.push(corners.len() as u32);
        }
        let (mut face_starts, mut faces) = (vec![0], Vec::new());
        for v in mesh.vertices() {
            faces.extend(mesh.vertex_faces(v).map(|f| f.index() as u32));
            face_starts.push(faces.len() as u32);
        }
        Incidence { corner_starts, corners, face_starts, faces }
    }

    fn centers(&self, positions: &[DVec3]) -> FaceMap<DVec3> {
        parallel::map(self.corner_starts.len() - 1, |f: FaceId| {
            let range = self.corner_starts[f.index()]..self.corner_starts[f.index() + 1];
            let corners = &self.corners[range.start as usize..range.end as usize];
            let first = positions[corners[0] as usize];
            // Differences, so that what is flat along an axis stays so exactly.
            let sum: DVec3 = corners.iter().map(|&v| positions[v as usize] - first).sum();
            first + sum / corners.len() as f64
        })
    }

    /// How far vertex number `v` at `p` moves: the mean of its ways to the planes of its faces.
    fn step(
        &self,
        v: usize,
        p: DVec3,
        centers: &FaceMap<DVec3>,
        normals: &FaceMap<DVec3>,
    ) -> DVec3 {
        let range = self.face_starts[v] as usize..self.face_starts[v + 1] as usize;
        let faces = &self.faces[range];
        let way = |&f: &u32| {
            let f = FaceId::new(f as usize);
            let n = normals[f];
            n * n.dot(centers[f] - p)
        };
        faces.iter().map(way).sum::<DVec3>() / faces.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use dgp_mesh::{shapes, shapes::Random};

    use super::*;

    /// What becomes of the root mean square of faint noise on a flat lattice, wave by wave. Heights at the
    /// vertices with the phases a and b per cell tilt the two triangles of a cell; a wave of the faces that has the
    /// value 1 − k under I − W̃ is scaled by μ/(μ + (1 − μ) k²).
    fn predicted(fidelity: f64) -> f64 {
        // Distances between the centers across a diagonal and across a side, for cells of size 1.
        let [near, far] = [2.0, 5.0].map(|square: f64| square.sqrt() / 3.0);
        let spread = (near + 2.0 * far) / 3.0;
        let [near, far] = [near, far].map(|d: f64| (-0.5 * (d / spread).powi(2)).exp());
        let (near, far) = (near / (near + 2.0 * far), far / (near + 2.0 * far));
        let waves = 64;
        let (mut before, mut after) = (0.0, 0.0);
        for i in 0..waves * waves {
            let [a, b] = [i % waves, i / waves].map(|k| f64::from(k) * TAU / f64::from(waves));
            // From the lower to the upper triangle of a cell: s = near + far e^(ia) + far e^(−ib).
            let s = [near + far * (a.cos() + b.cos()), far * (a.sin() - b.sin())];
            let size = s[0].hypot(s[1]);
            // Upper and lower triangles have tilts of the same size; how far they are in phase with s tells how much
            // of them belongs to k = 1 − |s| and to 1 + |s|.
            let phase = if size > 0.0 { s[1].atan2(s[0]) } else { 0.0 };
            for (tilt, lag) in [(2.0 - 2.0 * a.cos(), b), (2.0 - 2.0 * b.cos(), -a)] {
                let together = 0.5 + 0.5 * (lag + phase).cos();
                for (part, k) in [(together, 1.0 - size), (1.0 - together, 1.0 + size)] {
                    let gain = fidelity / (fidelity + (1.0 - fidelity) * k * k);
                    before += tilt * part;
                    after += tilt * part * gain * gain;
                }
            }
        }
        f64::sqrt(after / before)
    }

    /// Faint noise meets no edge, and then all normals at once is a linear filter whose gain is known.
    #[test]
    fn the_global_scheme_scales_faint_noise_as_its_equation_says() {
        let n = 64;
        let mut random = Random::new(3);
        let mut mesh = shapes::grid(n, n).unwrap();
        let size = 1e-4 / n as f64;
        let bumpy: Vec<DVec3> =
            mesh.positions().values().iter().map(|p| p.with_z(size * random.normal())).collect();
        mesh.set_positions(bumpy.into());
        let filter = Filter::new(&mesh, 0.35, FaceNeighborhood::Edges);
        let inside = |f: &FaceId| {
            let c = mesh.face_center(*f);
            (c.truncate() - 0.5).abs().max_element() < 0.4
        };
        let tilt = |normals: &FaceMap<DVec3>| {
            let square = |f| normals[f].truncate().length_squared();
            mesh.faces().filter(inside).map(square).sum::<f64>().sqrt()
        };
        for fidelity in [0.2, 0.05] {
            let filtered = filter.global(fidelity, Progress::NONE).unwrap();
            let ratio = tilt(&filtered) / tilt(&filter.normals);
            let expected = predicted(fidelity);
            // Some 5000 faces, correlated over few: a sample of the noise is off by some percent.
            assert!((ratio / expected - 1.0).abs() < 0.05, "{fidelity}: {ratio} {expected}");
        }
    }
}
