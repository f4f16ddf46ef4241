//! Cutting a surface or graph into parts where little holds them together.
//!
//! ```text
//! Bisection   the largest part is cut at a level of its Fiedler vector, such that both sides get
//!             their share of the mass, until there are k
//! Clusters    vertices are points (φ₀(v), …, φ₍ₖ₋₁₎(v)), which k-means puts into clusters
//! ```
//!
//! - Input: a Laplacian without negative weights, masses, how many parts.
//! - Cost: an eigenproblem of two pairs per cut, or one of k pairs and some rounds of O(k² n).
//! - Guarantees: each vertex with mass is in a part and no part is empty. Bisection gives parts of nearly
//!   equal mass; clusters follow the necks instead. Parts need not be connected; the report counts their pieces.
//! - Reference: Pothen, Simon and Liou, "Partitioning sparse matrices with eigenvectors of graphs", SIAM J.
//!   Matrix Analysis 11, 1990; Shi and Malik, "Normalized cuts and image segmentation", PAMI 2000; Liu and
//!   Zhang, "Segmentation of 3D meshes through spectral clustering", Pacific Graphics 2004.

use dgp_mesh::{Progress, VertexMap};
use dgp_sparse::{EigenOptions, SparseMatrix};

use super::{
    basis::Eigenbasis,
    cluster::k_means,
    fiedler::fiedler,
    graph::{check_weights, induced, parts},
};
use crate::Error;

/// How to cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PartitionMethod {
    /// Recursively in two, by the Fiedler vector: parts of equal mass.
    Bisection,
    /// By clusters of the spectral embedding: parts as the shape has them.
    #[default]
    Clusters,
}

/// Options of [`partition`].
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionOptions {
    /// How to cut.
    pub method: PartitionMethod,
    /// Seed of the first centers of clusters.
    pub seed: u64,
    /// How many times clusters are sought from other centers; the best ones are taken. At least 1.
    pub attempts: usize,
}

impl Default for PartitionOptions {
    fn default() -> Self {
        PartitionOptions { method: PartitionMethod::default(), seed: 1, attempts: 8 }
    }
}

/// The parts, and how good they are.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Partition {
    /// The part of each vertex, from 0; none for vertices without mass. Numbered by their first vertex.
    pub part: VertexMap<Option<u32>>,
    /// The mass of each part.
    pub masses: Vec<f64>,
    /// How many connected pieces each part has.
    pub pieces: Vec<usize>,
    /// The weight of all edges between parts.
    pub cut: f64,
    /// Σ (weight of the edges that leave a part) / (mass of the part).
    pub ratio_cut: f64,
}

/// Cuts the graph of `laplacian` into `count` parts.
///
/// Errors: [`Error::InvalidOption`] unless `count` is between 1 and the number of vertices with mass,
/// [`Error::NegativeWeight`] (take the intrinsic Delaunay Laplacian or the uniform one), those of
/// [`Eigenbasis::new`].
pub fn partition(
    laplacian: &SparseMatrix,
    masses: &VertexMap<f64>,
    count: usize,
    options: &PartitionOptions,
    progress: Progress<'_>,
) -> Result<Partition, Error> {
    assert_eq!(masses.len(), laplacian.rows(), "a mass per row");
    check_weights(laplacian)?;
    let rows: Vec<u32> =
        (0..masses.len() as u32).filter(|&row| masses.values()[row as usize] > 0.0).collect();
    if count == 0 || count > rows.len() {
        let expected = "between 1 and the number of vertices with mass";
        return Err(Error::option("count", count as f64, expected));
    }
    if options.attempts == 0 {
        return Err(Error::option("attempts", 0.0, "at least 1"));
    }
    let labels = match options.method {
        _ if count == 1 => vec![0; rows.len()],
        PartitionMethod::Bisection => bisections(laplacian, masses, &rows, count, progress)?,
        PartitionMethod::Clusters => {
            let eigen = EigenOptions::default();
            let basis = Eigenbasis::new(laplacian, masses, count, &eigen, progress.part(0.0, 0.8))?;
            let all = basis.rows(count);
            let points: Vec<f64> = rows
                .iter()
                .flat_map(|&row| &all[row as usize * count..(row as usize + 1) * count])
                .copied()
                .collect();
            let weights: Vec<f64> = rows.iter().map(|&r| masses.values()[r as usize]).collect();
            k_means(&points, &weights, count, options, progress.part(0.8, 1.0))?
        }
    };
    Ok(report(laplacian, masses, &rows, &labels, count))
}

/// The part of each of these rows by repeated cuts.
fn bisections(
    laplacian: &SparseMatrix,
    masses: &VertexMap<f64>,
    rows: &[u32],
    count: usize,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Error> {
    let mut labels = vec![0; masses.len()];
    // The rows of a part, and how many parts it is to become.
    let mut waiting = vec![(rows.to_vec(), count)];
    let mut done = 0;
    while let Some((part, share)) = waiting.pop() {
        if share == 1 {
            for &row in &part {
                labels[row as usize] = done;
            }
            done += 1;
            progress.report(f64::from(done) / count as f64)?;
            continue;
        }
        let low_share = share / 2;
        let order = slow_order(laplacian, masses, &part)?;
        // As much mass as its share, but at least a row for each part to come.
        let mass = |row: u32| masses.values()[row as usize];
        let wanted =
            order.iter().map(|&row| mass(row)).sum::<f64>() * low_share as f64 / share as f64;
        let (mut at, mut sum) = (0, 0.0);
        while at < order.len() && sum + 0.5 * mass(order[at]) < wanted {
            sum += mass(order[at]);
            at += 1;
        }
        let at = at.clamp(low_share, order.len() - (share - low_share));
        let (low, high) = order.split_at(at);
        waiting.push((high.to_vec(), share - low_share));
        waiting.push((low.to_vec(), low_share));
    }
    Ok(rows.iter().map(|&row| labels[row as usize]).collect())
}

/// These rows in the order of their Fiedler vector; pieces one after the other, if they are several.
fn slow_order(
    laplacian: &SparseMatrix,
    masses: &VertexMap<f64>,
    rows: &[u32],
) -> Result<Vec<u32>, Error> {
    let (labels, count) = parts(laplacian, rows);
    let mut pieces = vec![Vec::new(); count];
    for (&row, &label) in rows.iter().zip(&labels) {
        pieces[label as usize].push(row);
    }
    let mut order = Vec::with_capacity(rows.len());
    for mut piece in pieces {
        piece.sort_unstable();
        if piece.len() > 2 {
            let sub = induced(laplacian, &piece)?;
            let mass: VertexMap<f64> =
                piece.iter().map(|&row| masses.values()[row as usize]).collect::<Vec<_>>().into();
            let slow = fiedler(&sub, &mass, Progress::NONE)?.vector.into_values();
            let mut by_value: Vec<usize> = (0..piece.len()).collect();
            by_value.sort_by(|&i, &j| slow[i].total_cmp(&slow[j]));
            piece = by_value.into_iter().map(|i| piece[i]).collect();
        }
        order.extend(piece);
    }
    Ok(order)
}

/// The parts numbered by their first row, and what is known of them.
fn report(
    laplacian: &SparseMatrix,
    masses: &VertexMap<f64>,
    rows: &[u32],
    labels: &[u32],
    count: usize,
) -> Partition {
    let mut names = vec![None; count];
    let mut next = 0;
    let mut part: VertexMap<Option<u32>> = VertexMap::filled(masses.len(), None);
    let mut members = vec![Vec::new(); count];
    for (&row, &label) in rows.iter().zip(labels) {
        let name = *names[label as usize].get_or_insert_with(|| {
            next += 1;
            next - 1
        });
        part.values_mut()[row as usize] = Some(name);
        members[name as usize].push(row);
    }
    members.truncate(next as usize);
    let mass = |rows: &Vec<u32>| rows.iter().map(|&row| masses.values()[row as usize]).sum();
    let part_masses: Vec<f64> = members.iter().map(mass).collect();
    let mut leaving = vec![0.0; members.len()];
    for (i, j, entry) in laplacian.triplets() {
        if let (Some(a), Some(b)) = (part.values()[i], part.values()[j])
            && a != b
        {
            leaving[a as usize] -= entry;
        }
    }
    Partition {
        pieces: members.iter().map(|rows| parts(laplacian, rows).1).collect(),
        cut: leaving.iter().sum::<f64>() / 2.0,
        ratio_cut: leaving.iter().zip(&part_masses).map(|(cut, mass)| cut / mass).sum(),
        masses: part_masses,
        part,
    }
}
