//! Remeshing: triangles that are nearly equilateral, of one size or of the size that the shape needs.
//!
//! Each iteration, with L the length wanted,
//!
//! ```text
//! splits edges longer than 4/3 L at their middles,
//! collapses edges shorter than 4/5 L, unless that makes others longer than 4/3 L,
//! flips edges to lower Σ (valence − 6)²,  4 instead of 6 on rims,
//! moves vertices to p + (I − nnᵀ)(q − p),  q = Σ A m / Σ A of the triangles around p of areas A and middles m,
//! and from there to the nearest point of the input.
//! ```
//!
//! - Input: triangles, with holes perhaps; features are edges that stay sharp.
//! - Cost: O(n log n) for the hierarchy of the input, then each iteration O(n) and a nearest point for each vertex.
//! - Guarantees: a manifold of the same topology; vertices are points of the input, those on lines of features and
//!   rims points of these; corners of lines stay where they are. The same bits for any number of threads.
//! - Reference: Botsch and Kobbelt, "A remeshing approach to multiresolution modeling", Symposium on Geometry
//!   Processing 2004; Dunyach, Vanderhaeghe, Barthe, Botsch, "Adaptive remeshing for real-time mesh deformation",
//!   Eurographics 2013.
//! - Departs from it: vertices on lines are known by their length along them, so that they never leave these; all
//!   vertices move at once; of flips that leave valences as good, those that widen the smallest angle are done.

mod adaptive;
mod edits;
mod give_back;
mod lines;
mod options;
mod quality;
mod relax;
mod sizing;
mod surface;

use dgp_mesh::{
    DVec3, EdgeSet, Mesh, Progress, VertexId, VertexMap, VertexSet, spatial::TriangleTree,
};

pub use adaptive::remesh_adaptive;
pub use options::{AdaptiveOptions, Distance, Origin, RemeshOptions, RemeshReport, Rims};
pub use quality::{TriangleQuality, triangle_quality};

use self::{
    edits::{Aim, LONG, SHORT, halfedges},
    give_back::Packed,
    lines::{Line, Sharp},
    options::in_range,
    relax::{Ground, normals},
    sizing::Sizing,
    surface::{Freedom, MOST_TRIANGLES, NONE, Surface},
};
use crate::Error;

/// Makes the triangles of `mesh` nearly equilateral, with edges of about `length`, in the unit of the coordinates.
///
/// Of what is `kept`, vertices stay where they are and edges stay sharp: their lines keep their shape and get edges
/// of the same length. Data of vertices are mixed from those of the input where they come to lie; so are data of
/// corners, each from its side of the lines (see [`seam_edges`](crate::seam_edges) to keep seams); faces take those
/// of the face below their middle; edges lose theirs. A cancelled run leaves the mesh as it was.
///
/// ```
/// use dgp_mesh::{EdgeSet, Progress, VertexSet, shapes};
/// use dgp_remesh::{RemeshOptions, remesh_isotropic};
///
/// let mut mesh = shapes::torus(1.0, 0.4, 40, 9)?;
/// let none = (VertexSet::new(), EdgeSet::new());
/// let options = RemeshOptions::default();
/// let report = remesh_isotropic(&mut mesh, 0.1, (&none.0, &none.1), &options, Progress::NONE)?;
/// assert!(report.quality[1].minimum_angle.to_degrees() > 30.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Errors: [`Error::NotTriangle`], [`Error::NotFinite`], [`Error::InvalidOption`] if `length` is not positive or
/// beyond what the coordinates can tell apart, [`Error::Mesh`] for more triangles than there is room for,
/// [`Error::Cancelled`].
pub fn remesh_isotropic(
    mesh: &mut Mesh,
    length: f64,
    kept: (&VertexSet, &EdgeSet),
    options: &RemeshOptions,
    progress: Progress<'_>,
) -> Result<RemeshReport, Error> {
    options.check()?;
    in_range("length", length, length > 0.0 && length.is_finite(), "positive and finite")?;
    let mut run = Run::new(mesh, kept, options, 2.0 * length, progress.part(0.0, 0.1))?;
    let length = length * run.down;
    in_range("length", length, length > 0.0, "not so small beside the mesh")?;
    for vertex in &mut run.surface.vertices {
        vertex.size = length;
    }
    if options.rims == Rims::Kept {
        run.sizing = Sizing::beside_kept(mesh, &run.surface, &run.lines, length);
        run.take_sizes();
    }
    in_range("length", length / run.down, run.surface.is_feasible(), FEASIBLE)?;
    run.iterate(options.iterations, progress.part(0.1, 0.9))?;
    run.finish(mesh, progress.part(0.9, 1.0))
}

/// Steps after the last iteration that neither split nor collapse: what was split last is relaxed only then.
const POLISH: usize = 3;

/// What sizes must be.
const FEASIBLE: &str = "so large that 67 million triangles suffice";

/// Remeshing under way, in coordinates multiplied by a power of two.
struct Run {
    surface: Surface,
    lines: Vec<Line>,
    ground: Ground,
    sizing: Sizing,
    down: f64,
    splits: usize,
    collapses: usize,
    flips: usize,
    before: TriangleQuality,
    start: [usize; 2],
}

impl Run {
    /// `reach` is the distance over which lines must turn at corners.
    fn new(
        mesh: &Mesh,
        (fixed, features): (&VertexSet, &EdgeSet),
        options: &RemeshOptions,
        reach: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let positions = mesh.positions();
        if let Some((vertex, _)) = positions.iter().find(|(_, p)| !p.is_finite()) {
            return Err(Error::NotFinite { vertex });
        }
        let before = triangle_quality(mesh)?;
        let largest = positions.values().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let down = 2_f64.powi(-exponent(largest));
        let scaled: Vec<DVec3> = positions.values().iter().map(|&p| p * down).collect();
        let mut surface = Surface::new(mesh, scaled.clone(), 1.0)?;
        progress.report(0.2)?;
        let sharp = Sharp {
            features,
            fixed,
            keeps_rims: options.rims == Rims::Kept,
            corner_angle: options.corner_angle,
            reach: reach * down,
        };
        let lines = lines::find(mesh, &mut surface, &sharp);
        progress.report(0.3)?;
        let copy = Mesh::from_parts(mesh.connectivity().clone(), scaled.clone().into());
        let tree = TriangleTree::new(&copy, progress.part(0.3, 1.0))?;
        let ground = Ground { positions: scaled, tree, normals: normals(&surface) };
        Ok(Run {
            surface,
            lines,
            ground,
            sizing: Sizing::uniform(),
            down,
            splits: 0,
            collapses: 0,
            flips: 0,
            before,
            start: [mesh.vertex_count(), mesh.face_count()],
        })
    }

    /// The loop of the paper, then some steps that only flip and relax.
    fn iterate(&mut self, count: usize, progress: Progress<'_>) -> Result<(), Error> {
        if count == 0 {
            return Ok(progress.report(1.0)?);
        }
        let most = 1000 + (4.0 * self.surface.estimate()) as usize;
        for i in 0..count + POLISH {
            let part = |x: f64| (i as f64 + x) / (count + POLISH) as f64;
            let (surface, lines) = (&mut self.surface, &self.lines);
            if i < count {
                let collapsing = progress.part(part(0.2), part(0.4));
                self.splits +=
                    surface.split_long(lines, most, progress.part(part(0.0), part(0.2)))?;
                self.collapses += surface.collapse_short(lines, collapsing)?;
            }
            self.flips += surface.flip_all(Aim::Valences, progress.part(part(0.4), part(0.6)))?;
            surface.relax(
                &self.ground,
                lines,
                &self.sizing,
                progress.part(part(0.6), part(1.0)),
            )?;
        }
        self.flips += self.surface.flip_all(Aim::Angles, Progress::NONE)?;
        progress.report(1.0)?;
        Ok(())
    }

    /// Puts the result into `mesh`.
    fn finish(self, mesh: &mut Mesh, progress: Progress<'_>) -> Result<RemeshReport, Error> {
        progress.report(0.0)?;
        let mut packed = self.surface.packed(1.0 / self.down)?;
        let origins = self.surface.origins(&packed.vertices, &self.ground);
        progress.report(0.5)?;
        self.surface.carry_data(mesh, &mut packed, &origins, &self.ground);
        let [short_edges, long_edges] = self.surface.odd_edges();
        let Packed { mesh: result, vertices, .. } = packed;
        let is_fixed = |&&v: &&u32| self.surface.vertex(v).freedom == Freedom::Fixed;
        let report = RemeshReport {
            vertices: [self.start[0], result.vertex_count()],
            faces: [self.start[1], result.face_count()],
            splits: self.splits,
            collapses: self.collapses,
            flips: self.flips,
            lines: self.lines.len(),
            corners: vertices.iter().filter(is_fixed).count(),
            short_edges,
            long_edges,
            quality: [self.before, triangle_quality(&result)?],
            origins: VertexMap::from_fn(origins.len(), |v: VertexId| {
                origins[v].as_ref().map(Origin::from)
            }),
            distance: None,
        };
        progress.report(1.0)?;
        *mesh = result;
        Ok(report)
    }
}

impl Surface {
    /// Whether there is room for triangles of the sizes wanted.
    fn is_feasible(&self) -> bool {
        self.estimate() <= MOST_TRIANGLES as f64
    }

    /// About how many triangles of the sizes wanted there will be.
    fn estimate(&self) -> f64 {
        let mut count = 0.0;
        for triangle in self.triangles.iter().filter(|triangle| triangle.from[0] != NONE) {
            let size = triangle
                .from
                .map(|v| self.vertex(v).size)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let [a, b, c] = triangle.from.map(|v| self.position(v) / size);
            // Equilateral triangles of side 1 have an area of √3/4; a side of length l ends at least l of them.
            let area = 0.5 * (b - a).cross(c - a).length();
            count +=
                area * 4.0 / 3.0_f64.sqrt() + 0.5 * (a.distance(b) + b.distance(c) + c.distance(a));
        }
        count
    }

    /// How many edges are too short and too long.
    fn odd_edges(&self) -> [usize; 2] {
        let mut odd = [0; 2];
        for f in (0..self.triangles.len()).filter(|&f| self.has(f)) {
            for h in halfedges(f).filter(|&h| self.stands_for_edge(h)) {
                let relative = self.relative(h);
                odd[0] += usize::from(relative < SHORT * SHORT);
                odd[1] += usize::from(relative > LONG * LONG);
            }
        }
        odd
    }
}

/// The exponent of 2 in `x`, 0 for none, kept where its reciprocal is a number too.
fn exponent(x: f64) -> i32 {
    if x > 0.0 { (((x.to_bits() >> 52) & 0x7ff) as i32 - 1023).clamp(-1021, 1021) } else { 0 }
}
