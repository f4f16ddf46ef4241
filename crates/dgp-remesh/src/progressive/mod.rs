//! Progressive meshes: a coarse base and the vertex splits that lead back to the mesh, exactly.
//!
//! ```text
//!         c                         c
//!       ╱ │ ╲       split         ╱ │╲ ╲
//!     ╱   b   ╲     ─────→      ╱   a─b  ╲       a and the triangles at a b come,
//!     ╲   │   ╱     ←─────      ╲   │╱   ╱       some corners at b become corners at a
//!       ╲ │ ╱      collapse       ╲ │  ╱
//!         d                         d
//! ```
//!
//! Vertices and faces are numbered in the order in which they come, so that a level is the first so many of
//! each, and a split is the corners that change hands and one position.
//!
//! - Input: triangles, with holes perhaps.
//! - Cost: going from a level to another, the corners around the vertices split on the way.
//! - Guarantees: every level is what decimation had there, bit for bit, from whichever side one comes; the
//!   finest is the input. Data of vertices, and of corners without seams, are those that travel along.
//! - Reference: Hoppe, "Progressive meshes", SIGGRAPH 1996.
//! - Departs from it: corners that change hands are listed instead of found between two neighbors, which makes
//!   a split independent of how triangles are linked. Data of faces, and of corners with seams, are not kept.

mod data;
mod geomorph;
mod stream;

use data::Column;
pub use geomorph::Geomorph;
pub use stream::ProgressiveStream;

use dgp_mesh::{
    DVec3, FaceId, FaceList, FaceMap, IndexedFaceSet, Mesh, Progress, VertexId, VertexMap,
    VertexSet,
};

use crate::{
    Error, QuadricOptions, Target,
    decimate::{
        quadric::{Done, collapses},
        rings::{NONE, Rings},
    },
};

/// A mesh at any level of detail: level 0 is the base, and each level has one vertex more.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{ProgressiveMesh, QuadricOptions, Target};
///
/// let mesh = shapes::icosphere(3)?;
/// let options = QuadricOptions::default();
/// let mut levels = ProgressiveMesh::new(&mesh, Target::Faces(20), &options, Progress::NONE)?;
/// levels.set_level(levels.level_of_faces(300))?;
/// assert_eq!(levels.mesh()?.face_count(), 300);
///
/// let bytes = levels.to_bytes();
/// assert_eq!(ProgressiveMesh::from_bytes(&bytes)?.level_count(), levels.level_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ProgressiveMesh {
    /// Of the finest level known; those beyond the present level are as they will come.
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    base: [usize; 2],
    level: usize,
    face_count: usize,
    splits: Vec<Split>,
    /// Corners, as 3 face + corner, that change hands, split after split.
    moved: Vec<u32>,
    /// Where the vertex that is split is at the level on the other side.
    held: Vec<DVec3>,
    columns: Vec<Column>,
    /// Numbers of all columns, vertex after vertex as `positions`, and split after split as `held`.
    values: Vec<f64>,
    held_values: Vec<f64>,
    left_out: Vec<String>,
}

/// What a split does; the vertex that comes is told by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Split {
    vertex: u32,
    /// One or two.
    faces: u8,
    /// Where the corners that change hands end in the list of all.
    end: u32,
}

impl ProgressiveMesh {
    /// Decimates a copy of `mesh` toward `target`, which becomes the base, and keeps all levels between. The
    /// present level is the finest. `options.polish` is not done, for it is
    /// the end of one level only; data are mixed as they travel, also where `options.attribute_weight` makes them count.
    ///
    /// Errors: those of [`decimate_quadric`](crate::decimate_quadric).
    pub fn new(
        mesh: &Mesh,
        target: Target,
        options: &QuadricOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let log = collapses(mesh, target, &VertexSet::new(), options, progress.part(0.0, 0.8))?;
        let mut rings = Rings::new(mesh, mesh.positions().values().to_vec())?;
        // Of each collapse, in its order: corners that change hands, triangles that go, positions.
        let mut corners: Vec<u32> = Vec::new();
        let mut ends = Vec::with_capacity(log.len());
        let mut gone: Vec<Gone> = Vec::with_capacity(log.len());
        let mut counts = Vec::with_capacity(log.len());
        let mut held = Vec::with_capacity(log.len());
        for (k, done) in log.iter().enumerate() {
            if k.is_multiple_of(4096) {
                progress.part(0.8, 1.0).report(k as f64 / log.len() as f64)?;
            }
            let shared = rings.shared(done.from, done.to);
            let mut went = [(NONE, [NONE; 3]); 2];
            for (slot, &(f, _)) in went.iter_mut().zip(&shared.faces[..shared.count]) {
                *slot = (f, rings.faces[f as usize]);
            }
            for &f in rings.ring(done.from) {
                if went.iter().all(|&(g, _)| g != f) {
                    corners.push(3 * f + rings.corner(f, done.from) as u32);
                }
            }
            ends.push(corners.len());
            gone.push(went);
            counts.push(shared.count as u8);
            held.push(rings.positions[done.to as usize]);
            rings.collapse(done.from, done.to, &shared);
            rings.positions[done.to as usize] = done.position;
        }
        let (columns, left_out) = data::columns(mesh);
        let mut result = ordered(mesh, &rings, &log, (&corners, &ends), (&gone, &counts), &held);
        result.left_out = left_out;
        if !columns.is_empty() {
            result.bring_data(mesh, &log, columns);
        }
        result.set_level(log.len())?;
        Ok(result)
    }

    /// How many splits there are: the finest level.
    pub fn level_count(&self) -> usize {
        self.splits.len()
    }

    /// The present level.
    pub fn level(&self) -> usize {
        self.level
    }

    /// Vertices at the present level.
    pub fn vertex_count(&self) -> usize {
        self.base[0] + self.level
    }

    /// Faces at the present level.
    pub fn face_count(&self) -> usize {
        self.face_count
    }

    /// Vertices and faces of the base.
    pub fn base_counts(&self) -> [usize; 2] {
        self.base
    }

    /// Where the vertices of the present level are.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions[..self.vertex_count()]
    }

    /// The corners of the faces of the present level, as numbers of vertices.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces[..self.face_count]
    }

    /// The finest level of at most `faces` faces, or the base.
    pub fn level_of_faces(&self, faces: usize) -> usize {
        let mut count = self.base[1];
        for (level, split) in self.splits.iter().enumerate() {
            count += usize::from(split.faces);
            if count > faces {
                return level;
            }
        }
        self.splits.len()
    }

    /// Goes to `level`, in time proportional to the corners that change on the way.
    ///
    /// Errors: [`Error::NoLevel`].
    pub fn set_level(&mut self, level: usize) -> Result<(), Error> {
        if level > self.splits.len() {
            return Err(Error::NoLevel { level, levels: self.splits.len() });
        }
        while self.level < level {
            self.change(self.level, true);
            self.level += 1;
        }
        while self.level > level {
            self.level -= 1;
            self.change(self.level, false);
        }
        Ok(())
    }

    /// Does the split that leads from level `k` to the next, or undoes it.
    fn change(&mut self, k: usize, forward: bool) {
        let split = self.splits[k];
        let new = (self.base[0] + k) as u32;
        let vertex = if forward { new } else { split.vertex };
        for &corner in &self.moved[self.start(k)..split.end as usize] {
            self.faces[corner as usize / 3][corner as usize % 3] = vertex;
        }
        std::mem::swap(&mut self.positions[split.vertex as usize], &mut self.held[k]);
        let width = data::width(&self.columns);
        if width > 0 {
            let at = width * split.vertex as usize;
            let (present, other) =
                (&mut self.values[at..at + width], &mut self.held_values[width * k..][..width]);
            present.swap_with_slice(other);
        }
        if forward {
            self.face_count += usize::from(split.faces);
        } else {
            self.face_count -= usize::from(split.faces);
        }
    }

    /// Where the corners of split `k` start in the list of all.
    fn start(&self, k: usize) -> usize {
        k.checked_sub(1).map_or(0, |before| self.splits[before].end as usize)
    }

    /// The present level as a mesh.
    pub fn mesh(&self) -> Result<Mesh, Error> {
        let corners = self.faces().iter().map(|face| face.map(|v| VertexId::new(v as usize)));
        let list = FaceList::from_triangles(corners.collect());
        let positions = VertexMap::from(self.positions().to_vec());
        let mut mesh = Mesh::new(&IndexedFaceSet::new(positions, list)?)?;
        self.dress(&mut mesh);
        Ok(mesh)
    }

    /// Has the data of `mesh` travel along the collapses; the present level is the base.
    fn bring_data(&mut self, mesh: &Mesh, log: &[Done], columns: Vec<Column>) {
        let travelled = data::travel(mesh, &columns, log);
        let width = data::width(&columns);
        let mut is_left = vec![true; mesh.vertex_count()];
        for done in log {
            is_left[done.from as usize] = false;
        }
        let base = travelled.at_base.chunks_exact(width).zip(&is_left).filter(|(_, left)| **left);
        self.values = base.flat_map(|(value, _)| value).copied().collect();
        self.values.extend(travelled.gone.chunks_exact(width).rev().flatten());
        self.held_values = travelled.before.chunks_exact(width).rev().flatten().copied().collect();
        self.columns = columns;
    }
}

/// The triangles that go in a collapse, with their corners.
type Gone = [(u32, [u32; 3]); 2];

/// Numbers vertices and faces in the order in which they come when the collapses are undone; at the base.
fn ordered(
    mesh: &Mesh,
    rings: &Rings,
    log: &[Done],
    (corners, ends): (&[u32], &[usize]),
    (gone, counts): (&[Gone], &[u8]),
    before: &[DVec3],
) -> ProgressiveMesh {
    let mut is_left = vec![true; mesh.vertex_count()];
    for done in log {
        is_left[done.from as usize] = false;
    }
    let mut vertices: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    vertices.retain(|&v| is_left[v as usize]);
    let mut faces: Vec<u32> = rings.left().map(|(f, _)| f.index() as u32).collect();
    let base = [vertices.len(), faces.len()];
    for (done, (went, &count)) in log.iter().zip(gone.iter().zip(counts)).rev() {
        vertices.push(done.from);
        faces.extend(went[..usize::from(count)].iter().map(|&(f, _)| f));
    }
    let mut vertex_number = VertexMap::filled(mesh.vertex_count(), NONE);
    for (new, &old) in vertices.iter().enumerate() {
        vertex_number[VertexId::new(old as usize)] = new as u32;
    }
    let mut face_number = FaceMap::filled(mesh.face_count(), NONE);
    for (new, &old) in faces.iter().enumerate() {
        face_number[FaceId::new(old as usize)] = new as u32;
    }
    let number = |v: u32| vertex_number[VertexId::new(v as usize)];
    // Corners as they are when a face comes; those of the base at the end.
    let mut corner_lists: Vec<[u32; 3]> = rings.left().map(|(_, face)| face.map(number)).collect();
    let mut splits = Vec::with_capacity(log.len());
    let mut moved = Vec::with_capacity(corners.len());
    for k in (0..log.len()).rev() {
        let start = k.checked_sub(1).map_or(0, |before| ends[before]);
        for &corner in &corners[start..ends[k]] {
            moved.push(3 * face_number[FaceId::new(corner as usize / 3)] + corner % 3);
        }
        let from = moved.len() - (ends[k] - start);
        moved[from..].sort_unstable();
        let went = &gone[k][..usize::from(counts[k])];
        corner_lists.extend(went.iter().map(|&(_, face)| face.map(number)));
        splits.push(Split { vertex: number(log[k].to), faces: counts[k], end: moved.len() as u32 });
    }
    let positions = vertices.iter().map(|&v| rings.positions[v as usize]).collect();
    let held = before.iter().rev().copied().collect();
    ProgressiveMesh {
        positions,
        faces: corner_lists,
        face_count: base[1],
        base,
        level: 0,
        splits,
        moved,
        held,
        columns: Vec::new(),
        values: Vec::new(),
        held_values: Vec::new(),
        left_out: Vec::new(),
    }
}
