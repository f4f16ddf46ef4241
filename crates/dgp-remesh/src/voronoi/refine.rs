//! The input, fine enough that a cluster has many vertices.
//!
//! Edges are halved, the longest first, until none is longer than those of equal triangles of which a cluster has as
//! many vertices as are wanted. Long is measured by the density: ℓ² √ρ.

use std::{cmp::Reverse, collections::BinaryHeap};

use dgp_mesh::{
    DVec3, EdgeId, EditError, Editor, Mesh, Progress, VertexId,
    measure::{VertexArea, vertex_areas},
};

use crate::{Error, sample::power_of_two};

/// The name of the column that follows the edits.
const DENSITY: &str = "density";

/// Edges are halved up to so many times the vertices that equal triangles would have.
const MOST: f64 = 8.0;

/// The refined input at unit scale.
pub(super) struct Fine {
    pub(super) mesh: Mesh,
    pub(super) density: Vec<f64>,
    /// The area of each vertex.
    pub(super) areas: Vec<f64>,
    /// The length of 1 in units of the input.
    pub(super) unit: f64,
}

impl Fine {
    /// With at least about `resolution` vertices for each of `count` clusters.
    pub(super) fn new(
        input: &Mesh,
        density: &[f64],
        count: usize,
        resolution: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let used = input.vertices().filter(|&v| !input.is_isolated_vertex(v));
        let largest = used.map(|v| input.position(v).abs().max_element()).fold(0.0, f64::max);
        let unit = power_of_two(largest);
        let positions: Vec<DVec3> = input.positions().values().iter().map(|&p| p / unit).collect();
        let mut mesh = Mesh::from_parts(input.connectivity().clone(), positions.into());
        mesh.attributes_mut().vertex.insert(DENSITY, density.to_vec());
        let areas = vertex_areas(&mesh, VertexArea::Barycentric);
        let whole: f64 =
            areas.values().iter().zip(density).map(|(area, density)| area * density.sqrt()).sum();
        if !(whole > 0.0) {
            return Err(Error::NoArea);
        }
        // Equilateral triangles have 2/√3 vertices in the square of an edge.
        let longest = 2.0 / 3_f64.sqrt() * whole / (resolution * count as f64);
        halve(&mut mesh, longest, resolution * count as f64, progress)?;
        let areas = vertex_areas(&mesh, VertexArea::Barycentric).into_values();
        let density = mesh.attributes().vertex.get::<f64>(DENSITY);
        let density = density.map_or_else(Vec::new, |column| column.values().to_vec());
        Ok(Fine { mesh, density, areas, unit })
    }
}

/// Halves edges with ℓ² √ρ above `longest`.
fn halve(
    mesh: &mut Mesh,
    longest: f64,
    expected: f64,
    progress: Progress<'_>,
) -> Result<(), Error> {
    /// Cuts between two reports.
    const STEP: usize = 1 << 14;
    let size = |mesh: &Mesh, e: EdgeId| {
        let [a, b] = mesh.edge_vertices(e);
        let density = mesh.attributes().vertex.get::<f64>(DENSITY);
        let density = density.map_or(1.0, |column| 0.5 * (column[a] + column[b]));
        mesh.position(a).distance_squared(mesh.position(b)) * density.sqrt()
    };
    let entry = |mesh: &Mesh, e: EdgeId| {
        let size = size(mesh, e);
        (size > longest).then(|| (size.to_bits(), Reverse(e)))
    };
    let mut waiting: BinaryHeap<(u64, Reverse<EdgeId>)> =
        mesh.edges().filter_map(|e| entry(mesh, e)).collect();
    if waiting.is_empty() {
        return Ok(());
    }
    // A surface that is nearly lines has little area and long edges.
    let most = MOST * expected + mesh.edge_count() as f64;
    let mut editor = Editor::new(mesh);
    let mut cuts = 0_usize;
    while let Some((bits, Reverse(e))) = waiting.pop() {
        // An edge that was halved before has two entries, one of them of the whole.
        if size(editor.mesh(), e).to_bits() != bits {
            continue;
        }
        if cuts.is_multiple_of(STEP) {
            progress.report((cuts as f64 / expected).min(1.0))?;
        }
        if cuts as f64 > most {
            break;
        }
        cuts += 1;
        let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
        let middle: VertexId = match editor.split_edge_triangles(e, 0.5 * (a + b)) {
            Ok(middle) => middle,
            // Two triangles back to back stay as they are.
            Err(EditError::SameCorners { .. }) => continue,
            Err(error) => return Err(Error::Edit(error)),
        };
        let mesh = editor.mesh();
        waiting.extend(mesh.vertex_edges(middle).filter_map(|e| entry(mesh, e)));
    }
    let _ = editor.finish();
    Ok(())
}
