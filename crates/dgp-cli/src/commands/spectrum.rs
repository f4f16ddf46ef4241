//! `dgp spectrum`: the lowest eigenvalues and eigenfunctions of a Laplacian.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    laplace::{
        self,
        intrinsic::{IntrinsicOptions, intrinsic_delaunay},
        laplacian::{cotangent_laplacian, uniform_laplacian, vertex_masses},
        spectral::{Eigenbasis, nodal_domains},
    },
    mesh::{Mesh, Progress, VertexMap},
    sparse::{EigenOptions, SparseMatrix},
    view::{ColorMap, Curve, Field, Marker, Plot},
};
use serde_json::json;

use crate::{
    cli::{Common, Input},
    commands::scalars::{Pictured, csv},
    failure::Failure,
    session::Session,
};

/// Options of `dgp spectrum`.
///
/// With `--eigenvectors` the functions are written as the vertex attributes `eigenvector_0`,
/// `eigenvector_1`, …
#[derive(Debug, Args)]
pub(crate) struct Spectrum {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    operator: Operator,
    #[command(flatten)]
    pictured: Pictured,
    /// How many eigenvalues
    #[arg(long, value_name = "K", default_value_t = 20)]
    count: usize,
    /// Write the mesh with the functions at its vertices
    #[arg(long, value_name = "MESH")]
    eigenvectors: Option<PathBuf>,
    /// Write eigenvalues and residuals as lines of numbers
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the eigenvalues into this SVG
    #[arg(long, value_name = "SVG")]
    plot: Option<PathBuf>,
}

/// A Laplacian and its masses.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Operator {
    /// Which Laplacian
    #[arg(long, value_enum, default_value_t = LaplacianName::Cotan)]
    pub(crate) laplacian: LaplacianName,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LaplacianName {
    /// Of the graph: weights and masses 1
    Uniform,
    /// Of the surface: cotangents and areas
    Cotan,
    /// Of the surface, without negative weights: cotangents of the intrinsic Delaunay triangulation
    Intrinsic,
}

impl Operator {
    /// The matrix and the masses for `mesh`.
    pub(crate) fn of(
        self,
        mesh: &Mesh,
        progress: Progress<'_>,
    ) -> Result<(SparseMatrix, VertexMap<f64>), laplace::Error> {
        Ok(match self.laplacian {
            LaplacianName::Uniform => {
                (uniform_laplacian(mesh)?, VertexMap::filled(mesh.vertex_count(), 1.0))
            }
            LaplacianName::Cotan => (cotangent_laplacian(mesh)?, vertex_masses(mesh)),
            LaplacianName::Intrinsic => {
                let found = intrinsic_delaunay(mesh, &IntrinsicOptions::default(), progress)?;
                (found.laplacian, found.masses)
            }
        })
    }

    /// Whether it has the lengths of the surface in it, and not the graph alone.
    pub(crate) fn knows_lengths(self) -> bool {
        self.laplacian != LaplacianName::Uniform
    }

    /// The name as on the command line.
    pub(crate) fn name(self) -> String {
        self.laplacian.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
    }
}

/// Options of the eigensolver with the seed of the command line.
pub(crate) fn eigen_options(common: &Common) -> EigenOptions {
    EigenOptions { seed: common.seed, ..EigenOptions::default() }
}

impl Spectrum {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("spectrum", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let basis = session
            .run("solving", |progress| {
                let (laplacian, masses) = self.operator.of(&mesh, progress.part(0.0, 0.1))?;
                let options = eigen_options(common);
                Eigenbasis::new(&laplacian, &masses, self.count, &options, progress.part(0.1, 1.0))
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let domains: Vec<usize> = (0..basis.len())
            .map(|i| {
                let domains = nodal_domains(&mesh, basis.function(i));
                domains.positive + domains.negative
            })
            .collect();

        if let Some(path) = &self.csv {
            let rows = basis.values().iter().zip(basis.residuals()).enumerate();
            let rows = rows.map(|(i, (value, residual))| vec![i as f64, *value, *residual]);
            session.store(path, csv(&["index", "eigenvalue", "residual"], rows).as_bytes())?;
        }
        if let Some(path) = &self.plot {
            session.store(path, self.plot(&basis).to_svg().as_bytes())?;
        }
        // The first waves that are not constant on each part.
        let fields = (basis.zero_count()..basis.len()).take(6).map(|i| {
            let function = Field::Vertices(basis.function(i).to_vec().into());
            (format!("{i}: {:.5}", basis.values()[i]), function)
        });
        self.pictured.draw_all(&mut session, &mesh, fields.collect(), ColorMap::CoolWarm)?;
        if let Some(path) = &self.eigenvectors {
            for i in 0..basis.len() {
                let function: VertexMap<f64> = basis.function(i).to_vec().into();
                mesh.attributes_mut().vertex.insert(&format!("eigenvector_{i}"), function);
            }
            document.set = mesh.to_indexed();
            session.write_stage(path, &document)?;
        }

        let worst = basis.residuals().iter().copied().fold(0.0, f64::max);
        let summary = format!(
            "{}: {} eigenvalues of the {} Laplacian from {:.6e} to {:.6e}, {} of them zero; \
             residuals up to {worst:.1e}; {}",
            self.input.path.display(),
            basis.len(),
            self.operator.name(),
            basis.values()[0],
            basis.values()[basis.len() - 1],
            basis.zero_count(),
            session.spent(),
        );
        let report = json!({
            "laplacian": self.operator.name(),
            "eigenvalues": basis.values(),
            "residuals": basis.residuals(),
            "zero_eigenvalues": basis.zero_count(),
            "orthogonality": basis.report().orthogonality,
            "confirmed": basis.report().confirmed,
            "components": basis.report().components,
            "shift": basis.report().shift,
            "solves": basis.report().solves,
            "restarts": basis.report().restarts,
            "nodal_domains": domains,
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn plot(&self, basis: &Eigenbasis) -> Plot {
        let points = basis.values().iter().enumerate().map(|(i, &value)| [i as f64, value]);
        let curve = Curve { marker: Marker::Dots, ..Curve::new("eigenvalue", points.collect()) };
        let title = format!("Spectrum of the {} Laplacian", self.operator.name());
        Plot { curves: vec![curve], ..Plot::new(title, "index", "eigenvalue") }
    }
}
