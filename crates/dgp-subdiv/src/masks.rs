//! Masks: how each new value is worked out from old ones, row by row, when it is asked for.
//!
//! Refining values applies the rows where they are made, so a level of several million vertices stores no
//! weights; a [`StencilTable`](crate::StencilTable) stores them for those who want a matrix. A mask may
//! name the mean of a face in place of its corners: column V + f, V being how many old values there are.
//! That keeps the masks of polygons short, and each mean is computed once.

use std::ops::{Add, Mul};

use dgp_mesh::parallel;

use crate::topology::Topology;

/// What can be refined: numbers and vectors.
pub trait Value:
    Copy + Default + Send + Sync + Add<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Default + Send + Sync + Add<Output = T> + Mul<f64, Output = T>> Value for T {}

/// The rows of a step.
pub(crate) trait Masks: Sync {
    /// How many new values there are.
    fn rows(&self) -> usize;

    /// What the old values belong to.
    fn topology(&self) -> &Topology;

    /// Where the means of faces are.
    fn means(&self) -> Means;

    /// Writes a row; columns may come several times.
    fn row(&self, row: usize, stencil: &mut Stencil);
}

/// Where the means of faces are that rows name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Means {
    /// No row names any.
    Unused,
    /// They are the last rows, which are made first.
    Last,
    /// They are no rows.
    Beside,
}

/// The row being written, and room to work in.
#[derive(Debug, Default)]
pub(crate) struct Stencil {
    /// Columns and weights.
    pub(crate) entries: Vec<(u32, f64)>,
    /// Half-edges that leave a vertex.
    pub(crate) spokes: Vec<u32>,
    /// Their sharpness.
    pub(crate) sharpness: Vec<f64>,
}

impl Stencil {
    #[inline]
    pub(crate) fn push(&mut self, column: u32, weight: f64) {
        self.entries.push((column, weight));
    }
}

/// The new values, given one old value per vertex.
pub(crate) fn apply<T: Value>(masks: &dyn Masks, old: &[T]) -> Vec<T> {
    let topology = masks.topology();
    debug_assert_eq!(old.len(), topology.vertex_count());
    let mut new = vec![T::default(); masks.rows()];
    let faces = topology.face_count();
    match masks.means() {
        Means::Unused => apply_rows(masks, &mut new, |column| old[column as usize]),
        Means::Last => {
            let (head, means) = new.split_at_mut(masks.rows() - faces);
            face_means(topology, old, means);
            apply_rows(masks, head, two(old, means));
        }
        Means::Beside => {
            let mut means = vec![T::default(); faces];
            face_means(topology, old, &mut means);
            apply_rows(masks, &mut new, two(old, &means));
        }
    }
    new
}

/// Reads columns from the first list, those beyond it from the second.
#[inline]
fn two<'a, T: Value>(old: &'a [T], means: &'a [T]) -> impl Fn(u32) -> T + Sync + Send + 'a {
    |column| {
        let column = column as usize;
        if column < old.len() { old[column] } else { means[column - old.len()] }
    }
}

fn apply_rows<T: Value>(masks: &dyn Masks, new: &mut [T], old: impl Fn(u32) -> T + Sync + Send) {
    parallel::for_each_chunk(new, parallel::BLOCK, |first, chunk| {
        let mut stencil = Stencil::default();
        for (row, value) in (first..).zip(chunk) {
            stencil.entries.clear();
            masks.row(row, &mut stencil);
            let mut sum = T::default();
            for &(column, weight) in &stencil.entries {
                sum = sum + old(column) * weight;
            }
            *value = sum;
        }
    });
}

pub(crate) fn face_means<T: Value>(topology: &Topology, old: &[T], means: &mut [T]) {
    parallel::for_each_chunk(means, parallel::BLOCK, |first, chunk| {
        for (f, mean) in (first as u32..).zip(chunk) {
            let corners = topology.corners(f);
            let weight = 1.0 / corners.len() as f64;
            let mut sum = T::default();
            for c in corners {
                sum = sum + old[topology.vertex(c) as usize] * weight;
            }
            *mean = sum;
        }
    });
}

/// The entries of a row with the means of faces spelled out, each column once and in order, without zeros.
pub(crate) fn spell_out(topology: &Topology, entries: &mut Vec<(u32, f64)>) {
    let vertices = topology.vertex_count() as u32;
    for k in 0..entries.len() {
        let (column, weight) = entries[k];
        if column < vertices {
            continue;
        }
        let corners = topology.corners(column - vertices);
        let share = weight / corners.len() as f64;
        entries[k] = (topology.vertex(corners.start), share);
        entries.extend(corners.skip(1).map(|c| (topology.vertex(c), share)));
    }
    merge(entries);
}

/// Sorts entries by column and sums those of the same; leaves out what is zero.
pub(crate) fn merge(entries: &mut Vec<(u32, f64)>) {
    // Stable, so that sums have the same order everywhere.
    entries.sort_by_key(|&(column, _)| column);
    entries.dedup_by(|later, kept| {
        let same = later.0 == kept.0;
        if same {
            kept.1 += later.1;
        }
        same
    });
    entries.retain(|&(_, weight)| weight != 0.0);
}
