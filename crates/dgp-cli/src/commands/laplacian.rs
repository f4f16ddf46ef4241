//! `dgp laplacian`: the matrices of a mesh or a cloud, checked and written.

use std::{
    fmt::Write,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use dgp::{
    io::Document,
    laplace::{
        self,
        differential::{DifferentialOperator, EdgeWeight, Reconstruction, RowScale},
        intrinsic::{
            IntrinsicLaplacian, IntrinsicOptions, IntrinsicReport, PointCloudOptions,
            intrinsic_delaunay, point_cloud_laplacian, tufted_laplacian,
        },
        kernel::{HeatKernel, Neighbors, gaussian_laplacian, mesh_heat_laplacian},
        laplacian::{
            LaplacianReport, MassKind, cotangent_laplacian, laplacian_report, mass_matrix,
            mean_value_laplacian, normalized_laplacian, random_walk_laplacian, uniform_laplacian,
        },
    },
    mesh::{
        DVec3, IndexedFaceSet, Mesh, Progress, VertexId, VertexMap, VertexSet,
        measure::{bounding_box, edge_length_range},
        topology::components,
    },
    sparse::SparseMatrix,
};
use serde_json::{Value, json};

use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// The vertex attribute that holds differential coordinates.
const COORDINATES: &str = "differential_coordinates";

/// Options of `dgp laplacian`.
///
/// Matrices are written in the Matrix Market format: −weights off the diagonal, their sums on it, row and
/// column i + 1 for vertex i.
#[derive(Debug, Args)]
pub(crate) struct Laplacian {
    #[command(flatten)]
    input: Input,
    /// Write the Laplacian, `-` for standard output
    #[arg(id = "output", long = "output", short = 'o', value_name = "MTX")]
    output: Option<PathBuf>,
    /// Write the mass matrix
    #[arg(long, value_name = "MTX")]
    mass_output: Option<PathBuf>,
    /// Which Laplacian
    #[arg(long, value_enum, default_value_t = Kind::Cotan)]
    kind: Kind,
    /// Which mass, for uniform, cotan and mean-value; the others have their own
    #[arg(long, value_enum, value_name = "MASS")]
    mass: Option<MassName>,
    /// Divide rows by something
    #[arg(long, value_enum, default_value_t = Normalize::No)]
    normalize: Normalize,
    /// How many of the nearest points to look at (point-cloud, gaussian)
    #[arg(long, value_name = "K", default_value_t = 30)]
    neighbors: usize,
    /// How far the kernel reaches: its time in squares of the mean edge length, or for points in
    /// squares of the mean distance to the nearest (gaussian, heat)
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    time: f64,
    /// Write the mesh with its differential coordinates, and report how well they lead back to the
    /// positions from one vertex of each component (uniform, cotan, mean-value)
    #[arg(long, value_name = "MESH")]
    coordinates: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Of the graph: weights 1
    Uniform,
    /// Of the surface: (cot α + cot β)/2
    #[value(alias = "cotangent")]
    Cotan,
    /// Of the surface, positive weights, not symmetric (Floater 2003)
    MeanValue,
    /// Cotangents of the intrinsic Delaunay triangulation
    Intrinsic,
    /// The same of any triangles, manifold or not (Sharp and Crane 2020)
    Tufted,
    /// The same of points without faces
    PointCloud,
    /// Of the graph of nearest points, with Gaussian weights (Belkin and Niyogi 2003)
    Gaussian,
    /// Heat kernels times areas, which converges at each vertex (Belkin, Sun and Wang 2008)
    Heat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MassName {
    /// A third of each triangle, on the diagonal
    Barycentric,
    /// By nearness, safe for obtuse triangles, on the diagonal (Meyer et al. 2003)
    #[value(alias = "voronoi")]
    Mixed,
    /// The full matrix of linear finite elements
    #[value(alias = "galerkin")]
    Consistent,
    /// 1 for each vertex
    Ones,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Normalize {
    /// As it is
    No,
    /// By the diagonal: rows 1, −w/Σw
    Rows,
    /// By the roots of masses on both sides: M⁻½ L M⁻½
    Symmetric,
}

/// What was made.
struct Found {
    laplacian: SparseMatrix,
    mass: SparseMatrix,
    /// The name of the mass.
    mass_name: &'static str,
    intrinsic: Option<IntrinsicReport>,
}

impl Laplacian {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let own_mass = !matches!(self.kind, Kind::Uniform | Kind::Cotan | Kind::MeanValue);
        for (given, option) in
            [(self.mass.is_some(), "--mass"), (self.coordinates.is_some(), "--coordinates")]
        {
            if given && own_mass {
                let message = format!("{option} goes with --kind uniform, cotan and mean-value");
                return Err(Failure::Usage(message));
            }
        }
        let mut session = Session::new("laplacian", common);
        let mut document = session.read(&self.input)?;
        let is_mesh = !matches!(self.kind, Kind::Tufted | Kind::PointCloud | Kind::Gaussian);
        let mesh = if is_mesh { Some(session.mesh(&self.input, &document)?) } else { None };
        let found = session
            .run("assembling", |progress| match &mesh {
                Some(mesh) => self.of_mesh(mesh, progress),
                None => self.of_set(&document.set, progress),
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let matrix = match self.normalize {
            Normalize::No => Ok(found.laplacian),
            Normalize::Rows => random_walk_laplacian(&found.laplacian),
            Normalize::Symmetric => {
                let ones = vec![1.0; found.mass.rows()];
                normalized_laplacian(&found.laplacian, &found.mass.product(&ones))
            }
        };
        let matrix = matrix.map_err(|e| Failure::from(e).in_file(&self.input.path))?;
        let checks = laplacian_report(&matrix);
        let total: f64 = found.mass.values().iter().sum();
        let mut report = json!({
            "kind": name(&self.kind),
            "normalize": name(&self.normalize),
            "entries": matrix.entries(),
            "checks": to_json(&checks),
            "mass": {"kind": found.mass_name, "entries": found.mass.entries(), "total": total},
            "intrinsic": found.intrinsic.map(|r| json!({
                "triangles": r.triangles, "flips": r.flips, "added_length": r.added_length,
                "dropped_faces": r.dropped_faces,
            })),
            "coordinates": Value::Null,
        });
        let mut text = words(&self.input.path, &name(&self.kind), &checks);
        let _ = writeln!(text, "mass {}, in all {total}", found.mass_name);
        if let Some(r) = &found.intrinsic {
            let _ = writeln!(text, "{} triangles after {} flips", r.triangles, r.flips);
        }
        if let (Some(path), Some(mesh)) = (&self.coordinates, mesh) {
            let (rebuilt, error) = self.coordinates(&mut session, &mut document, mesh, path)?;
            report["coordinates"] = json!({
                "path": path.to_string_lossy(), "fixed_vertices": rebuilt, "largest_error": error,
            });
            let _ = writeln!(
                text,
                "positions from differential coordinates and {rebuilt} fixed vertices: off by {error:.1e} \
                 of the diagonal at most"
            );
        }
        if let Some(path) = &self.mass_output {
            session.store(path, found.mass.to_matrix_market().as_bytes())?;
        }
        if let Some(path) = &self.output {
            let bytes = matrix.to_matrix_market().into_bytes();
            let described = json!({
                "path": path.to_string_lossy(), "format": "mtx", "bytes": bytes.len(),
                "rows": matrix.rows(), "entries": matrix.entries(),
            });
            session.write_bytes(path, &bytes, described)?;
        }
        session.finish(&text, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn of_mesh(&self, mesh: &Mesh, progress: Progress<'_>) -> Result<Found, laplace::Error> {
        let laplacian = match self.kind {
            Kind::Intrinsic => {
                let found = intrinsic_delaunay(mesh, &IntrinsicOptions::default(), progress)?;
                return Ok(Found::of_intrinsic(found));
            }
            Kind::Heat => {
                let mean = edge_length_range(mesh).map_or(1.0, |range| range.mean);
                let h = self.time * mean * mean;
                let (laplacian, masses) = mesh_heat_laplacian(mesh, h, &HeatKernel::default())?;
                let mass = SparseMatrix::from_diagonal(masses.values());
                return Ok(Found { laplacian, mass, mass_name: "barycentric", intrinsic: None });
            }
            Kind::Uniform => uniform_laplacian(mesh)?,
            Kind::MeanValue => mean_value_laplacian(mesh)?,
            _ => cotangent_laplacian(mesh)?,
        };
        let is_graph = self.kind == Kind::Uniform;
        let chosen =
            self.mass.unwrap_or(if is_graph { MassName::Ones } else { MassName::Barycentric });
        let (mass, mass_name) = match chosen {
            MassName::Barycentric => (mass_matrix(mesh, MassKind::Barycentric)?, "barycentric"),
            MassName::Mixed => (mass_matrix(mesh, MassKind::MixedVoronoi)?, "mixed"),
            MassName::Consistent => (mass_matrix(mesh, MassKind::Galerkin)?, "consistent"),
            MassName::Ones => (ones(mesh.vertex_count()), "ones"),
        };
        Ok(Found { laplacian, mass, mass_name, intrinsic: None })
    }

    fn of_set(
        &self,
        set: &IndexedFaceSet,
        progress: Progress<'_>,
    ) -> Result<Found, laplace::Error> {
        let points = set.positions();
        match self.kind {
            Kind::Tufted => {
                let found = tufted_laplacian(set, &IntrinsicOptions::default(), progress)?;
                Ok(Found::of_intrinsic(found))
            }
            Kind::PointCloud => {
                let options =
                    PointCloudOptions { neighbors: self.neighbors, ..PointCloudOptions::default() };
                Ok(Found::of_intrinsic(point_cloud_laplacian(points, &options, progress)?))
            }
            _ => {
                // exp(−distance²/4h) for a kernel of time h.
                let t = 1.0 / (4.0 * self.time * spacing(points)?.powi(2));
                let laplacian = gaussian_laplacian(points, t, Neighbors::Nearest(self.neighbors))?;
                let mass = ones(points.len());
                Ok(Found { laplacian, mass, mass_name: "ones", intrinsic: None })
            }
        }
    }

    /// Writes differential coordinates; how many vertices were fixed to come back, and by how much of
    /// the diagonal positions are off then.
    fn coordinates(
        &self,
        session: &mut Session<'_>,
        document: &mut Document,
        mut mesh: Mesh,
        path: &Path,
    ) -> Result<(usize, f64), Failure> {
        let weight = match self.kind {
            Kind::Uniform => EdgeWeight::Uniform,
            Kind::MeanValue => EdgeWeight::MeanValue,
            _ => EdgeWeight::Cotangent,
        };
        let fixed = anchors(&mesh);
        let (delta, error) = session
            .run("rebuilding", |progress| {
                let operator = DifferentialOperator::new(&mesh, weight, RowScale::Weights)?;
                let delta = operator.coordinates(mesh.positions());
                let solver = Reconstruction::new(&operator, &fixed, progress)?;
                let found = solver.solve(&delta, mesh.positions())?;
                let off = |v: VertexId| found[v].distance(mesh.position(v));
                Ok::<_, laplace::Error>((delta, mesh.vertices().map(off).fold(0.0, f64::max)))
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let diagonal = bounding_box(&document.set).map_or(1.0, |b| b.diagonal());
        mesh.attributes_mut().vertex.insert(COORDINATES, delta);
        document.set = mesh.to_indexed();
        session.write_stage(path, document)?;
        let relative = if diagonal > 0.0 { error / diagonal } else { error };
        Ok((fixed.len(), relative))
    }
}

impl Found {
    fn of_intrinsic(found: IntrinsicLaplacian) -> Self {
        Found {
            mass: SparseMatrix::from_diagonal(found.masses.values()),
            laplacian: found.laplacian,
            mass_name: "barycentric",
            intrinsic: Some(found.report),
        }
    }
}

fn ones(count: usize) -> SparseMatrix {
    SparseMatrix::from_diagonal(&vec![1.0; count])
}

/// A vertex of each component, and all vertices of no face: what has to stay for the others to be found.
fn anchors(mesh: &Mesh) -> VertexSet {
    let parts = components(mesh);
    let mut seen = vec![false; parts.count];
    let first = |v: &VertexId| match parts.vertex[*v] {
        Some(part) => !std::mem::replace(&mut seen[part as usize], true),
        None => true,
    };
    mesh.vertices().filter(first).collect()
}

/// The mean distance of a point to the nearest other one; 1 where all are in one place.
fn spacing(points: &VertexMap<DVec3>) -> Result<f64, laplace::Error> {
    let nearest = dgp::laplace::kernel::nearest_distances(points)?;
    let finite = nearest.values().iter().copied().filter(|d| d.is_finite());
    let (count, sum) = finite.fold((0.0, 0.0), |(count, sum), d| (count + 1.0, sum + d));
    Ok(if sum > 0.0 { sum / count } else { 1.0 })
}

/// The name as on the command line.
fn name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
}

fn words(path: &Path, kind: &str, checks: &LaplacianReport) -> String {
    let weight = |w: Option<f64>| w.map_or_else(|| "none".to_owned(), |w| format!("{w:.6e}"));
    let mut text = format!(
        "{}: {kind} Laplacian of {} rows and {} edges\n",
        path.display(),
        checks.rows,
        checks.edges
    );
    let symmetry = match checks.asymmetry {
        0.0 => "symmetric".to_owned(),
        other => format!("not symmetric, by {other:.1e} of the largest entry"),
    };
    let _ = writeln!(text, "{symmetry}; rows sum to zero up to {:.1e}", checks.row_sum_error);
    let _ = writeln!(
        text,
        "weights from {} to {}, {} of them negative",
        weight(checks.least_weight),
        weight(checks.largest_weight),
        checks.negative_weights
    );
    text
}

fn to_json(checks: &LaplacianReport) -> Value {
    json!({
        "rows": checks.rows,
        "edges": checks.edges,
        "negative_weights": checks.negative_weights,
        "least_weight": checks.least_weight,
        "largest_weight": checks.largest_weight,
        "row_sum_error": checks.row_sum_error,
        "asymmetry": checks.asymmetry,
    })
}
