//! The lines of the table for Laplacians, smoothing by solving, diffusion, planarity.

use dgp_laplace::{
    differential::{DifferentialOperator, EdgeWeight, Reconstruction, RowScale},
    flow::{FlowKind, FlowOptions, FlowSize, heat_step, mean_curvature_flow},
    intrinsic::{
        IntrinsicLaplacian, IntrinsicOptions, PointCloudOptions, intrinsic_delaunay,
        point_cloud_laplacian, tufted_laplacian,
    },
    kernel::{HeatKernel, Neighbors, gaussian_laplacian, mesh_heat_laplacian, nearest_distances},
    laplacian::{
        MassKind, cotangent_laplacian, laplacian_report, mass_matrix, mean_value_laplacian,
        normalized_laplacian, random_walk_laplacian, uniform_laplacian,
    },
    smooth::{
        BilateralOptions, BilateralScheme, CotangentOptions, FaceNeighborhood, ImplicitOptions,
        ImplicitWeight, bilateral, cotangent, implicit,
    },
    spectral::{
        Eigenbasis, PartitionOptions, fiedler, heat_kernel_diagonal, partition, signature_times,
    },
};
use dgp_mesh::{
    Mesh, VertexSet,
    curvature::{Neighborhood, normal_cycle_curvatures},
    graph::{Graph, five_coloring, planar_embedding, smallest_last_coloring},
    measure::edge_length_range,
    topology::trivalent_balance,
};
use dgp_sparse::{EigenOptions, SparseMatrix};

use super::{
    outcome::Outcome,
    table::{Algorithm, changed, mesh, set},
};

/// Of all entries, which a large matrix does not print.
fn matrix<E: std::fmt::Debug>(result: Result<SparseMatrix, E>) -> Outcome {
    Outcome::of(&result.map(|m| (laplacian_report(&m), m.indices().to_vec(), m.values().to_vec())))
}

fn with_masses<E: std::fmt::Debug>(result: Result<IntrinsicLaplacian, E>) -> Outcome {
    Outcome::of(
        &result.map(|found| (found.laplacian.values().to_vec(), found.masses, found.report)),
    )
}

/// The square of the mean length of edges.
fn area_of_edges(mesh: &Mesh) -> f64 {
    edge_length_range(mesh).map_or(1.0, |range| range.mean * range.mean)
}

pub(crate) fn laplacians() -> Vec<Algorithm> {
    let mut all = graphs();
    all.extend(matrices());
    all.extend(solving());
    all.extend(waves());
    all
}

fn graphs() -> Vec<Algorithm> {
    vec![
        mesh("normal_cycle_curvatures of rings", |m, p| {
            Outcome::of(&normal_cycle_curvatures(m, Neighborhood::OneRing, p))
        }),
        mesh("trivalent_balance", |m, _| Outcome::of(&trivalent_balance(m))),
        mesh("planar_embedding", |m, _| Outcome::of(&planar_embedding(&Graph::of_mesh(m)))),
        mesh("smallest_last_coloring", |m, _| {
            Outcome::of(&smallest_last_coloring(&Graph::of_mesh(m)))
        }),
        mesh("five_coloring", |m, _| Outcome::of(&five_coloring(&Graph::of_mesh(m)))),
    ]
}

fn matrices() -> Vec<Algorithm> {
    vec![
        mesh("uniform_laplacian", |m, _| matrix(uniform_laplacian(m))),
        mesh("cotangent_laplacian", |m, _| matrix(cotangent_laplacian(m))),
        mesh("mean_value_laplacian", |m, _| matrix(mean_value_laplacian(m))),
        mesh("random_walk_laplacian", |m, _| {
            matrix(cotangent_laplacian(m).and_then(|l| random_walk_laplacian(&l)))
        }),
        mesh("normalized_laplacian", |m, _| {
            matrix(uniform_laplacian(m).and_then(|l| normalized_laplacian(&l, &l.diagonal())))
        }),
        mesh("mass_matrix", |m, _| matrix(mass_matrix(m, MassKind::Galerkin))),
        mesh("intrinsic_delaunay", |m, p| {
            with_masses(intrinsic_delaunay(m, &IntrinsicOptions::default(), p))
        }),
        set("tufted_laplacian", |s, p| {
            with_masses(tufted_laplacian(s, &IntrinsicOptions::default(), p))
        }),
        set("point_cloud_laplacian", |s, p| {
            let options = PointCloudOptions { neighbors: 12, ..PointCloudOptions::default() };
            with_masses(point_cloud_laplacian(s.positions(), &options, p))
        }),
        set("gaussian_laplacian", |s, _| {
            matrix(gaussian_laplacian(s.positions(), 1.0, Neighbors::Nearest(6)))
        }),
        set("nearest_distances", |s, _| Outcome::of(&nearest_distances(s.positions()))),
        mesh("mesh_heat_laplacian", |m, _| {
            let h = area_of_edges(m);
            let found = mesh_heat_laplacian(m, h, &HeatKernel { cutoff: 0.1 });
            matrix(found.map(|found| found.0))
        }),
    ]
}

fn waves() -> Vec<Algorithm> {
    vec![
        mesh("eigenfunctions and their heat", |m, p| {
            let found = intrinsic_delaunay(m, &IntrinsicOptions::default(), p.part(0.0, 0.2));
            let result = found.and_then(|found| {
                let (options, part) = (EigenOptions::default(), p.part(0.2, 1.0));
                let basis = Eigenbasis::new(&found.laplacian, &found.masses, 4, &options, part)?;
                let time = signature_times(&basis, 1)?[0];
                Ok((basis.values().to_vec(), heat_kernel_diagonal(&basis, time)?))
            });
            Outcome::of(&result)
        }),
        mesh("fiedler", |m, p| {
            let ones = m.map_vertices(|_| 1.0);
            let found = uniform_laplacian(m).and_then(|l| fiedler(&l, &ones, p));
            Outcome::of(&found.map(|found| (found.value, found.vector)))
        }),
        mesh("partition", |m, p| {
            let ones = m.map_vertices(|_| 1.0);
            let options = PartitionOptions { attempts: 2, ..PartitionOptions::default() };
            let found = uniform_laplacian(m).and_then(|l| partition(&l, &ones, 3, &options, p));
            Outcome::of(&found.map(|found| found.part))
        }),
    ]
}

fn solving() -> Vec<Algorithm> {
    vec![
        mesh("cotangent", |m, p| {
            let options = CotangentOptions { iterations: 3, ..CotangentOptions::default() };
            changed(m, |m| cotangent(m, &VertexSet::new(), &options, p))
        }),
        mesh("implicit", |m, p| {
            changed(m, |m| implicit(m, &VertexSet::new(), &ImplicitOptions::default(), p))
        }),
        mesh("implicit, uniform", |m, p| {
            let weight = ImplicitWeight::Uniform;
            let options = ImplicitOptions { weight, ..ImplicitOptions::default() };
            changed(m, |m| implicit(m, &VertexSet::all(3), &options, p))
        }),
        mesh("bilateral", |m, p| {
            let scheme = BilateralScheme::Local { iterations: 3 };
            let options = BilateralOptions { scheme, ..BilateralOptions::default() };
            changed(m, |m| bilateral(m, &VertexSet::new(), &options, p))
        }),
        mesh("bilateral, global", |m, p| {
            let scheme = BilateralScheme::Global { fidelity: 0.1 };
            let neighborhood = FaceNeighborhood::Edges;
            let options = BilateralOptions { scheme, neighborhood, ..BilateralOptions::default() };
            changed(m, |m| bilateral(m, &VertexSet::new(), &options, p))
        }),
        mesh("differential coordinates and back", |m, p| {
            let result = DifferentialOperator::new(m, EdgeWeight::Cotangent, RowScale::None)
                .and_then(|operator| {
                    let delta = operator.coordinates(m.positions());
                    let solver = Reconstruction::new(&operator, &VertexSet::all(1), p)?;
                    solver.solve(&delta, m.positions())
                });
            Outcome::of(&result)
        }),
        mesh("heat_step", |m, p| {
            Outcome::of(&heat_step(m, &m.positions().map(|p| p.x), area_of_edges(m), p))
        }),
        mesh("mean_curvature_flow", |m, p| {
            let options = FlowOptions { steps: 2, ..FlowOptions::default() };
            let time = area_of_edges(m);
            changed(m, |m| mean_curvature_flow(m, &VertexSet::new(), time, &options, p))
        }),
        mesh("mean_curvature_flow, conformalized", |m, p| {
            let (kind, size) = (FlowKind::Conformalized, FlowSize::KeepsArea);
            let options = FlowOptions { steps: 2, kind, size };
            let time = area_of_edges(m);
            changed(m, |m| mean_curvature_flow(m, &VertexSet::new(), time, &options, p))
        }),
    ]
}
