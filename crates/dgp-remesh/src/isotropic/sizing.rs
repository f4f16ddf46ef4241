//! The length that edges should have at each place of the input.
//!
//! ```text
//! L = √(6ε/κ − 3ε²),    κ = max(|κ₁|, |κ₂|)
//! ```
//!
//! is the side of an equilateral triangle on a sphere of curvature κ whose middle is ε away from it.
//!
//! - Input: triangles; curvatures are those on each side of a line, and those of the lines themselves.
//! - Cost: O(n log n).
//! - Reference: Dunyach, Vanderhaeghe, Barthe, Botsch, "Adaptive remeshing for real-time mesh deformation",
//!   Eurographics 2013 (short papers); Persson, "Mesh size functions for implicit geometry and PDE-based mesh
//!   generation", Engineering with Computers 22(2), 2006 (gradation).

use dgp_mesh::{
    DVec3, FaceList, IndexedFaceSet, Mesh, VertexId, curvature::principal_curvatures,
    graph::IndexedHeap, spatial::ClosestPoint,
};

use super::{
    edits::halfedges,
    lines::Line,
    surface::{Freedom, NONE, Surface},
};
use crate::Error;

/// The length wanted at each vertex of the input, between which it is linear.
#[derive(Clone, Debug)]
pub(super) struct Sizing {
    /// Empty if it is the same everywhere.
    values: Vec<f64>,
    /// What it cannot be shorter than beside edges that are kept: longer ones cannot be split there without end.
    floor: Vec<f64>,
    least: f64,
}

/// By how much the length may shrink over a distance of one away from edges that are kept.
const SLOPE: f64 = 0.3;

/// What sizes are made for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) tolerance: f64,
    pub(super) shortest: f64,
    pub(super) longest: f64,
    /// By how much the length may grow over a distance of one.
    pub(super) gradation: f64,
}

impl Sizing {
    /// The same everywhere: vertices know it.
    pub(super) fn uniform() -> Self {
        Sizing { values: Vec::new(), floor: Vec::new(), least: 0.0 }
    }

    /// The same everywhere but beside edges that are kept and longer.
    pub(super) fn beside_kept(mesh: &Mesh, surface: &Surface, lines: &[Line], length: f64) -> Self {
        let floor = kept_lengths(mesh, surface, lines);
        let values = floor.iter().map(|&floor| floor.max(length)).collect();
        Sizing { values, floor, least: length }
    }

    pub(super) fn varies(&self) -> bool {
        !self.values.is_empty()
    }

    /// The length wanted at a point of the input.
    pub(super) fn at(&self, point: &ClosestPoint) -> f64 {
        let values = point.vertices.map(|v| self.values[v.index()]);
        let [a, b, c] = point.barycentric;
        (a * values[0] + b * values[1] + c * values[2]).max(self.least)
    }

    /// From the curvatures of the input, whose lines are marked in `surface`.
    pub(super) fn from_curvature(
        mesh: &Mesh,
        surface: &Surface,
        lines: &[Line],
        wanted: &Wanted,
    ) -> Result<Self, Error> {
        let Wanted { tolerance, shortest, longest, .. } = *wanted;
        let bends = curvatures(surface)?;
        let of = |bend: f64| {
            let square = 6.0 * tolerance / bend - 3.0 * tolerance * tolerance;
            // No curvature at all gives an infinite length, one beyond 2/ε none.
            let length = if square > 0.0 { square.sqrt() } else { 0.0 };
            length.clamp(shortest, longest)
        };
        let values = bends.into_iter().map(of).collect();
        let floor = kept_lengths(mesh, surface, lines);
        let mut sizing = Sizing { values, floor, least: shortest };
        sizing.smooth(mesh, &surface.positions, wanted.gradation);
        Ok(sizing)
    }

    /// Makes the lengths at vertices `v` shorter by `factor` (v), and others so that they grow no faster than they
    /// may. Returns whether any became shorter.
    pub(super) fn shorten(
        &mut self,
        mesh: &Mesh,
        positions: &[DVec3],
        factors: &[f64],
        gradation: f64,
    ) -> bool {
        let mut has_changed = false;
        for (value, factor) in self.values.iter_mut().zip(factors) {
            let new = (*value * factor).max(self.least);
            has_changed |= new < *value;
            *value = new;
        }
        self.smooth(mesh, positions, gradation);
        has_changed
    }

    /// Lowers values until L(v) ≤ L(w) + gradation |vw| along every edge.
    fn smooth(&mut self, mesh: &Mesh, positions: &[DVec3], gradation: f64) {
        let keys = self.values.iter().enumerate().map(|(v, &value)| (VertexId::new(v), value));
        let mut queue = IndexedHeap::from_keys(keys);
        while let Some((v, value)) = queue.pop() {
            for w in mesh.vertex_neighbors(v) {
                let distance = positions[v.index()].distance(positions[w.index()]);
                let most = value + gradation * distance;
                if most < self.values[w.index()] && queue.key(w).is_some() {
                    self.values[w.index()] = most;
                    queue.set(w, most);
                }
            }
        }
        for (value, floor) in self.values.iter_mut().zip(&self.floor) {
            *value = value.max(*floor);
        }
    }
}

/// The longest edge that is kept at each vertex, less what lies between it and others; zero without any.
fn kept_lengths(mesh: &Mesh, surface: &Surface, lines: &[Line]) -> Vec<f64> {
    let mut lengths = vec![0.0_f64; surface.vertices.len()];
    if lines.iter().all(|line| !line.is_kept) {
        return lengths;
    }
    for h in (0..surface.triangles.len()).flat_map(halfedges) {
        let line = surface.line(h);
        if line != NONE && lines[line as usize].is_kept {
            let length = surface.square(h).sqrt();
            for v in [surface.from(h), surface.to(h)] {
                lengths[v as usize] = lengths[v as usize].max(length);
            }
        }
    }
    // The longest first: the heap gives the least.
    let keys = lengths.iter().enumerate().map(|(v, &length)| (VertexId::new(v), -length));
    let mut queue = IndexedHeap::from_keys(keys);
    while let Some((v, key)) = queue.pop() {
        for w in mesh.vertex_neighbors(v) {
            let distance = surface.positions[v.index()].distance(surface.positions[w.index()]);
            let least = -key - SLOPE * distance;
            if least > lengths[w.index()] && queue.key(w).is_some() {
                lengths[w.index()] = least;
                queue.set(w, -least);
            }
        }
    }
    lengths
}

/// The largest curvature at each vertex, on any side of the lines there or of the line itself.
fn curvatures(surface: &Surface) -> Result<Vec<f64>, Error> {
    let (cut, origin) = cut_along_lines(surface)?;
    let mut bends = vec![0.0_f64; surface.vertices.len()];
    for (v, curvature) in principal_curvatures(&cut)?.iter() {
        let bend = &mut bends[origin[v.index()] as usize];
        *bend = bend.max(curvature.max.abs()).max(curvature.min.abs());
    }
    for (v, vertex) in surface.vertices.iter().enumerate() {
        if vertex.freedom != Freedom::Line {
            continue;
        }
        let here = surface.positions[v];
        let [a, b] = surface.line_neighbors(v as u32);
        if a == NONE || b == NONE {
            continue;
        }
        let (x, y) = (here - surface.position(a), surface.position(b) - here);
        let length = 0.5 * (x.length() + y.length());
        let turn = x.angle_between(y);
        if turn.is_finite() && length > 0.0 {
            bends[v] = bends[v].max(turn / length);
        }
    }
    Ok(bends)
}

/// The surface cut along its lines, and which vertex each of its vertices was.
fn cut_along_lines(surface: &Surface) -> Result<(Mesh, Vec<u32>), Error> {
    let mut corners = vec![[0_u32; 3]; surface.triangles.len()];
    let mut origin = Vec::with_capacity(surface.vertices.len());
    let mut spokes = Vec::new();
    for v in 0..surface.vertices.len() as u32 {
        spokes.clear();
        spokes.extend(surface.spokes(v));
        let first = spokes.iter().position(|&h| surface.line(h) != NONE).unwrap_or(0);
        for i in 0..spokes.len() {
            let h = spokes[(first + i) % spokes.len()];
            if i == 0 || surface.line(h) != NONE {
                origin.push(v);
            }
            corners[(h >> 2) as usize][(h & 3) as usize] = origin.len() as u32 - 1;
        }
    }
    let positions: Vec<DVec3> = origin.iter().map(|&v| surface.position(v)).collect();
    let faces = FaceList::from_triangles(
        corners.iter().map(|face| face.map(|v| VertexId::new(v as usize))).collect(),
    );
    Ok((Mesh::new(&IndexedFaceSet::new(positions, faces)?)?, origin))
}
