//! Centroidal Voronoi remeshing: a new triangulation of about so many vertices, evenly spread, of nearly equal
//! triangles.
//!
//! ```text
//! E = Σ over clusters C, Σ over vertices v of C:  mᵥ |xᵥ − c|²,    c = Σ mᵥ xᵥ / Σ mᵥ,    mᵥ = ρᵥ Aᵥ
//! ```
//!
//! | step | what it does | file |
//! |---|---|---|
//! | density | ρ by curvature, where that is asked for | `density.rs` |
//! | refine | halves edges of the input until a cluster has many vertices | `refine.rs` |
//! | seed | as many vertices as the result is to have, far from each other | `seeds.rs` |
//! | cluster | moves vertices between clusters as long as E gets less | `clusters.rs` |
//! | mend | halves clusters whose dual would be no such surface | `flaws.rs` |
//! | dual | a vertex for each cluster, a triangle where three meet | `dual.rs` |
//! | relax | moves vertices to the means of their Voronoi cells on the surface, flips edges | `relax.rs` |
//! | carry | data of the input | `carry.rs` |
//!
//! - Input: a triangle mesh; its vertices on no face are left out.
//! - Cost: O(F log F) for F faces of the refined input; the clustering in one thread.
//! - Guarantees: a manifold with the components, the boundary loops and the genus of the input: clusters are disks
//!   that meet in single arcs and points, by which their dual is the same surface. For that there may be more
//!   vertices than asked for. All vertices lie on the input, those of its boundary on its boundary.
//! - Reference: Valette, Chassery and Prost, "Generic remeshing of 3D triangular meshes with metric-dependent
//!   discrete Voronoi diagrams", IEEE Transactions on Visualization and Computer Graphics 14(2), 2008; Edelsbrunner
//!   and Shah, "Triangulating topological spaces", 1997 (what makes the dual the same surface).
//! - Departs from it: the clusters are followed by steps of Lloyd's on the surface itself, since moves of single vertices
//!   come to an end before the cells are centroidal; a vertex changes only where both clusters stay what they are topologically; the gain of a change
//!   is that of Hartigan, "Clustering algorithms", 1975, which loses no digits; edges are halved where they are long
//!   instead of all faces cut in four; the density is the only metric.

mod carry;
mod clusters;
mod density;
mod dual;
mod flaws;
mod refine;
mod relax;
mod seeds;

use dgp_mesh::{
    Mesh, Progress,
    measure::{corner_angles, minimum_angle, require_triangles},
    topology::{boundary_loops, components, euler_characteristic},
};

use crate::Error;
use clusters::Clusters;
use refine::Fine;
use relax::Ground;

/// Where in its cluster a vertex of the result lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VoronoiPlacement {
    /// On the surface, nearest to the mean of the cluster.
    #[default]
    Mean,
    /// On the surface, nearest to where the planes of its faces meet, as far as they do: on edges and in
    /// corners where the cluster has them.
    Sharp,
}

/// What [`voronoi_remesh`] is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoronoiOptions {
    /// Of the random numbers.
    pub seed: u64,
    /// About how many vertices of the refined input a cluster has at least; 4 to 1000. More make better angles.
    pub resolution: f64,
    /// γ, how much denser vertices are where the surface bends: ρ = (κ₁² + κ₂²)^(γ/2); 0 is nowhere, 1.5 much.
    pub gradation: f64,
    /// Where in its cluster a vertex lies.
    pub placement: VoronoiPlacement,
    /// How often vertices are moved to the means of their cells in the end; 40 give most of the angles there are to
    /// be had.
    pub relaxations: usize,
}

impl Default for VoronoiOptions {
    fn default() -> Self {
        VoronoiOptions {
            seed: 0,
            resolution: 10.0,
            gradation: 0.0,
            placement: VoronoiPlacement::default(),
            relaxations: 40,
        }
    }
}

/// What [`voronoi_remesh`] did.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct VoronoiReport {
    /// Vertices of the input and of the result.
    pub vertices: [usize; 2],
    /// Faces of the input and of the result.
    pub faces: [usize; 2],
    /// Vertices of the refined input.
    pub refined: usize,
    /// E of the first clusters and of the last, relative to the first.
    pub energy: f64,
    /// Vertices that changed their cluster.
    pub moves: usize,
    /// Clusters that were halved for the sake of topology.
    pub splits: usize,
    /// Whether components, boundary loops and Euler characteristic are those of the input.
    pub topology_kept: bool,
    /// The smallest angle of the result, in radians.
    pub minimum_angle: f64,
    /// The mean over its triangles of their smallest angles, in radians.
    pub mean_minimum_angle: f64,
    /// The share of its inner vertices with six edges.
    pub regular: f64,
    /// Data that the result does not have: those of edges, and those of corners that jump between faces.
    pub dropped: Vec<String>,
}

/// More vertices are refused.
const MOST: usize = 1 << 24;

/// More vertices of the refined input are refused.
const FINEST: f64 = (1 << 28) as f64;

/// How often clusters are mended and improved again; after that they are mended only.
const IMPROVED: usize = 8;

/// A mesh of about `vertices` vertices with the shape of `mesh`.
///
/// Data of vertices are mixed where the new ones lie; those of faces are those of the face where three clusters meet;
/// for those of corners see [`VoronoiReport::dropped`].
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::NoArea`], [`Error::InvalidOption`], [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{VoronoiOptions, voronoi_remesh};
///
/// let blob = shapes::blob(3)?;
/// let (mesh, report) = voronoi_remesh(&blob, 300, &VoronoiOptions::default(), Progress::NONE)?;
/// assert!(mesh.vertex_count() == 300 && report.topology_kept);
/// assert!(report.minimum_angle.to_degrees() > 20.0 && report.regular > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn voronoi_remesh(
    mesh: &Mesh,
    vertices: usize,
    options: &VoronoiOptions,
    progress: Progress<'_>,
) -> Result<(Mesh, VoronoiReport), Error> {
    check(mesh, vertices, options)?;
    let density = density::density(mesh, options.gradation)?;
    progress.report(0.05)?;
    let fine = Fine::new(mesh, &density, vertices, options.resolution, progress.part(0.05, 0.2))?;
    let seeds = seeds::seeds(&fine, vertices, options, progress.part(0.2, 0.35))?;
    let mut clusters = Clusters::new(&fine, &seeds);
    let before = clusters.energy();
    let mut moves = clusters.improve(progress.part(0.35, 0.5))?;
    let (mut splits, mut rounds) = (0, 0);
    loop {
        progress.part(0.5, 0.6).report(1.0 - 1.0 / (1.0 + rounds as f64))?;
        let flawed = flaws::flawed(&clusters);
        if flawed.is_empty() {
            break;
        }
        splits += flawed.len();
        clusters.halve(&flawed);
        if rounds < IMPROVED {
            moves += clusters.improve(Progress::NONE)?;
        }
        rounds += 1;
    }
    let energy = if before > 0.0 { clusters.energy() / before } else { 1.0 };
    let (mut result, is_fixed) = dual::dual(&clusters, options.placement)?;
    let ground = Ground::new(mesh, fine.unit, &density)?;
    let clustered = (mean_smallest_angle(&result), result.clone());
    let steps = options.relaxations;
    relax::relax(&mut result, &is_fixed, &ground, steps, progress.part(0.6, 0.95))?;
    // Cells of very few vertices are larger than what stars tell of them.
    if mean_smallest_angle(&result) < clustered.0 {
        result = clustered.1;
    }
    let dropped = carry::carry(mesh, &ground, &mut result)?;
    for v in result.vertices() {
        result.set_position(v, result.position(v) * fine.unit);
    }
    let inner = || result.vertices().filter(|&v| !result.is_boundary_vertex(v));
    let regular = inner().filter(|&v| result.valence(v) == 6).count() as f64;
    let report = VoronoiReport {
        vertices: [mesh.vertex_count(), result.vertex_count()],
        faces: [mesh.face_count(), result.face_count()],
        refined: fine.mesh.vertex_count(),
        energy,
        moves,
        splits,
        topology_kept: topology(mesh) == topology(&result),
        minimum_angle: minimum_angle(&result).unwrap_or(0.0),
        mean_minimum_angle: mean_smallest_angle(&result),
        regular: regular / inner().count().max(1) as f64,
        dropped,
    };
    progress.report(1.0)?;
    Ok((result, report))
}

fn check(mesh: &Mesh, vertices: usize, options: &VoronoiOptions) -> Result<(), Error> {
    let VoronoiOptions { resolution, gradation, .. } = *options;
    let asked = vertices as f64;
    for (name, value, is_right, expected) in [
        ("vertices", asked, (1..=MOST).contains(&vertices), "between 1 and 2²⁴"),
        ("resolution", resolution, (4.0..=1000.0).contains(&resolution), "between 4 and 1000"),
        ("gradation", gradation, (0.0..=4.0).contains(&gradation), "between 0 and 4"),
        (
            "vertices",
            asked,
            !(resolution * asked > FINEST),
            "so few that times `resolution` they are at most 2²⁸",
        ),
    ] {
        if !is_right {
            return Err(Error::InvalidOption { name, value, expected });
        }
    }
    if let Some(vertex) = mesh.vertices().find(|&v| !mesh.position(v).is_finite()) {
        return Err(Error::NotFinite { vertex });
    }
    require_triangles(mesh).map_err(|error| match error {
        dgp_mesh::Error::NotTriangle { face, degree } => Error::NotTriangle { face, degree },
        other => other.into(),
    })
}

/// The mean over the triangles of their smallest angles.
fn mean_smallest_angle(mesh: &Mesh) -> f64 {
    let angles = corner_angles(mesh);
    let smallest = |f| mesh.face_halfedges(f).map(|h| angles[h]).fold(f64::INFINITY, f64::min);
    mesh.faces().map(smallest).sum::<f64>() / mesh.face_count() as f64
}

/// Components, boundary loops, Euler characteristic.
fn topology(mesh: &Mesh) -> (usize, usize, i64) {
    (components(mesh).count, boundary_loops(mesh).len(), euler_characteristic(mesh))
}
