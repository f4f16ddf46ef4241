//! A model made ready to draw: triangles in view coordinates, and where each comes from.

use std::borrow::Cow;

use dgp_mesh::{
    Color, DMat3, DVec3, FaceId, FaceList, HalfedgeId, Id, Mesh, TriangulationMethod, VertexId,
    parallel, triangulate_polygon,
};

use crate::{
    BackFaces, Fill, Model, ModelReport, Paint, Placement, PointSize, Points, PointsShown, Shading,
    Shape, Stroke, Style,
    camera::{Basis, Extent, Lens},
};

/// A model in view coordinates.
pub(crate) struct Body<'a> {
    pub(crate) shape: Shape<'a>,
    pub(crate) style: &'a Style,
    /// Turns normals into view coordinates; not normalized.
    turn: DMat3,
    /// Where each vertex is; NaN where that is no place. Relative to the eye once there is a camera.
    pub(crate) positions: Vec<DVec3>,
    /// Vertices of triangles that cover the faces.
    pub(crate) triangles: Cow<'a, [[u32; 3]]>,
    /// Which vertices are drawn; `None` for all.
    used: Option<Vec<bool>>,
    pub(crate) origin: Origin,
    pub(crate) report: ModelReport,
}

/// Where triangles come from.
pub(crate) enum Origin {
    /// Triangle t is face t, its sides are those of the face.
    Faces,
    /// Triangle t is a piece of `faces[t]` with these corners; bit k of `sides[t]` tells whether its
    /// side from corner k on is a side of the face.
    Pieces { faces: Vec<u32>, corners: Vec<[u32; 3]>, sides: Vec<u8> },
}

/// The style of bodies that are no models.
static PLAIN: Style = Style {
    fill: Fill::Shaded,
    shading: Shading::Smooth { crease_angle: Shading::CREASE_ANGLE },
    paint: Paint::Uniform(Color([1.0; 4])),
    back_faces: BackFaces::LikeFront,
    wireframe: Stroke::NONE,
    boundary: Stroke::NONE,
    points: Points { shown: PointsShown::Never, size: PointSize::BySpacing },
    marks: Vec::new(),
    arrows: Vec::new(),
};

/// From the coordinates of the scene to view coordinates: scales by a power of two, which keeps all
/// digits, so that the largest coordinate is about 1 and nothing overflows on the way; then turns.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) basis: Basis,
    pub(crate) power: Power,
}

/// A power of two, as two factors that are numbers even where their product is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Power(f64, f64);

impl Power {
    /// The one that brings `largest`, positive and finite, into 1..2.
    fn unit(largest: f64) -> Self {
        // Numbers too small to be normal come into range first.
        let (x, shift) =
            if largest < 1e-290 { (largest * 2_f64.powi(100), 100) } else { (largest, 0) };
        let exponent = (x.to_bits() >> 52) as i32 - 1023;
        let total = shift - exponent;
        Power(2_f64.powi(total / 2), 2_f64.powi(total - total / 2))
    }

    pub(crate) fn scale(self, p: DVec3) -> DVec3 {
        p * self.0 * self.1
    }

    /// The same for a length.
    pub(crate) fn scale_length(self, x: f64) -> f64 {
        x * self.0 * self.1
    }
}

/// The power of two that brings the coordinates of all `models` to about 1.
pub(crate) fn unit_power<'a>(models: impl Iterator<Item = &'a Model<'a>>) -> Power {
    let mut largest = 0.0_f64;
    for model in models {
        let positions = model.shape.positions();
        let reach = |v: VertexId| {
            let p = positions[v.index()];
            if p.is_finite() { p.abs().max_element() } else { 0.0 }
        };
        let shift = model.placement.translation;
        let shift = if shift.is_finite() { shift.abs().max_element() } else { 0.0 };
        largest = largest.max(shift).max(parallel::reduce(positions.len(), 0.0, reach, f64::max));
    }
    if largest > 0.0 { Power::unit(largest) } else { Power(1.0, 1.0) }
}

impl Frame {
    /// `p` of a model placed like this in view coordinates, NaN if it is nowhere.
    #[inline]
    pub(crate) fn view(&self, placement: &Placement, p: DVec3) -> DVec3 {
        let mut p = self.power.scale(p);
        if *placement != Placement::default() {
            p = placement.linear * p + self.power.scale(placement.translation);
        }
        let view = self.basis.view(p);
        if view.is_finite() { view } else { DVec3::NAN }
    }
}

impl Frame {
    /// Turns normals of a model placed like this.
    fn normals(&self, placement: &Placement) -> DMat3 {
        // The cofactors: the inverse transpose, up to a factor, also where there is no inverse.
        let [a, b, c] = [placement.linear.x_axis, placement.linear.y_axis, placement.linear.z_axis];
        let cofactors = [b.cross(c), c.cross(a), a.cross(b)].map(|column| self.basis.view(column));
        DMat3::from_cols(cofactors[0], cofactors[1], cofactors[2])
    }
}

impl<'a> Body<'a> {
    pub(crate) fn new(model: &'a Model<'a>, frame: &Frame) -> Self {
        let source = model.shape.positions();
        let view = |v: VertexId| frame.view(&model.placement, source[v.index()]);
        let positions = parallel::map::<VertexId, _>(source.len(), view).into_values();
        let (triangles, origin) = match model.shape {
            Shape::Mesh(mesh) => mesh_triangles(mesh, &positions),
            Shape::Faces(set) => face_triangles(set.faces(), &positions),
            Shape::Points(_) => (Vec::new(), Origin::Faces),
        };
        let mut body = Body {
            shape: model.shape,
            style: &model.style,
            turn: frame.normals(&model.placement),
            positions,
            triangles: Cow::Owned(triangles),
            used: None,
            origin,
            report: ModelReport::default(),
        };
        if !body.shows_points() {
            body.used = used(body.positions.len(), &body.triangles);
        }
        body.count();
        body
    }

    /// A body that is no model: triangles in one color.
    pub(crate) fn plain(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let used = used(positions.len(), &triangles);
        Body::of_triangles(positions, Cow::Owned(triangles), used)
    }

    /// The same triangles in one color, with their vertices elsewhere.
    pub(crate) fn moved(&self, positions: Vec<DVec3>) -> Body<'_> {
        let used = if self.shows_points() {
            used(positions.len(), &self.triangles)
        } else {
            self.used.clone()
        };
        Body::of_triangles(positions, Cow::Borrowed(&self.triangles), used)
    }

    fn of_triangles(
        positions: Vec<DVec3>,
        triangles: Cow<'a, [[u32; 3]]>,
        used: Option<Vec<bool>>,
    ) -> Self {
        Body {
            shape: Shape::Points(&[]),
            style: &PLAIN,
            turn: DMat3::IDENTITY,
            positions,
            triangles,
            used,
            origin: Origin::Faces,
            report: ModelReport::default(),
        }
    }

    /// A normal of the shape in view coordinates; zero if it is none.
    pub(crate) fn turn(&self, normal: DVec3) -> DVec3 {
        (self.turn * normal).normalize_or_zero()
    }

    /// The face triangle `t` belongs to.
    #[inline]
    pub(crate) fn face(&self, t: usize) -> usize {
        match &self.origin {
            Origin::Faces => t,
            Origin::Pieces { faces, .. } => faces[t] as usize,
        }
    }

    /// Bit k tells whether the side of triangle `t` from corner k on is a side of a face.
    #[inline]
    pub(crate) fn sides(&self, t: usize) -> u8 {
        match &self.origin {
            Origin::Faces => 0b111,
            Origin::Pieces { sides, .. } => sides[t],
        }
    }

    /// The corners of triangle `t`: half-edges of a mesh, corners of a face set.
    pub(crate) fn corners(&self, t: usize) -> [usize; 3] {
        match (&self.origin, self.shape) {
            (Origin::Pieces { corners, .. }, _) => corners[t].map(|c| c as usize),
            (Origin::Faces, Shape::Mesh(mesh)) => {
                let h = mesh.face_halfedge(FaceId::new(t));
                [h, mesh.next(h), mesh.prev(h)].map(HalfedgeId::index)
            }
            (Origin::Faces, _) => [3 * t, 3 * t + 1, 3 * t + 2],
        }
    }

    /// Where the corners of triangle `t` are.
    #[inline]
    pub(crate) fn points(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// Whether vertices are drawn as points.
    pub(crate) fn shows_points(&self) -> bool {
        match self.style.points.shown {
            PointsShown::WithoutFaces => self.shape.face_count() == 0,
            PointsShown::All => true,
            PointsShown::Never => false,
        }
    }

    /// The extent of what is drawn.
    pub(crate) fn extent(&self, lens: &Lens) -> Extent {
        let used = self.used.as_ref();
        let blocks = parallel::map_blocks(self.positions.len(), parallel::BLOCK, |range| {
            let mut extent = Extent::EMPTY;
            for i in range {
                let p = self.positions[i];
                if used.is_none_or(|used| used[i]) && p.x.is_finite() {
                    extent.add(p, lens);
                }
            }
            extent
        });
        blocks.into_iter().fold(Extent::EMPTY, Extent::union)
    }

    /// Counts what is drawn and what is not.
    fn count(&mut self) {
        let nowhere = parallel::reduce(
            self.positions.len(),
            0,
            |v: VertexId| usize::from(self.positions[v.index()].x.is_nan()),
            |a, b| a + b,
        );
        let kinds = parallel::reduce(
            self.triangles.len(),
            [0; 3],
            |t: FaceId| {
                let [a, b, c] = self.points(t.index());
                let cross = (b - a).cross(c - a);
                let nowhere = !cross.is_finite();
                let flat = !nowhere && cross == DVec3::ZERO;
                [usize::from(!nowhere && !flat), usize::from(nowhere), usize::from(flat)]
            },
            |a, b| std::array::from_fn(|k| a[k] + b[k]),
        );
        self.report.triangles = kinds[0];
        self.report.triangles_at_non_finite_vertices = kinds[1];
        self.report.triangles_without_area = kinds[2];
        self.report.non_finite_vertices = nowhere;
        self.report.faces_of_fewer_than_three_vertices = match self.shape {
            Shape::Faces(set) => set.faces().iter().filter(|(_, face)| face.len() < 3).count(),
            Shape::Mesh(_) | Shape::Points(_) => 0,
        };
    }
}

/// Which of `count` vertices are corners of `triangles`; `None` for all.
fn used(count: usize, triangles: &[[u32; 3]]) -> Option<Vec<bool>> {
    let mut used = vec![false; count];
    for v in triangles.as_flattened() {
        used[*v as usize] = true;
    }
    used.contains(&false).then_some(used)
}

/// What no triangle of a mesh is.
const NO_TRIANGLE: [u32; 3] = [u32::MAX; 3];

fn mesh_triangles(mesh: &Mesh, positions: &[DVec3]) -> (Vec<[u32; 3]>, Origin) {
    let triangle = |f: FaceId| {
        mesh.triangle(f).map_or(NO_TRIANGLE, |corners| corners.map(|v| v.index() as u32))
    };
    let triangles = parallel::map(mesh.face_count(), triangle).into_values();
    if !triangles.contains(&NO_TRIANGLE) {
        return (triangles, Origin::Faces);
    }
    cut_faces(mesh.face_count(), positions, |f, polygon| {
        polygon.extend(mesh.face_halfedges(f).map(|h| (h.index(), mesh.from(h).index())));
    })
}

fn face_triangles(list: &FaceList, positions: &[DVec3]) -> (Vec<[u32; 3]>, Origin) {
    if list.is_triangles() {
        let corners = list.corners().as_chunks::<3>().0;
        let triangle = |f: FaceId| corners[f.index()].map(|v| v.index() as u32);
        return (parallel::map(corners.len(), triangle).into_values(), Origin::Faces);
    }
    cut_faces(list.len(), positions, |f, polygon| {
        let vertices = list.face(f).iter().map(|v| v.index());
        polygon.extend(list.face_corners(f).map(Id::index).zip(vertices));
    })
}

/// All faces cut into triangles, given what adds the corners of a face, each with its vertex.
fn cut_faces(
    count: usize,
    positions: &[DVec3],
    polygon_of: impl Fn(FaceId, &mut Vec<(usize, usize)>) + Sync + Send,
) -> (Vec<[u32; 3]>, Origin) {
    let blocks = parallel::map_blocks(count, parallel::BLOCK, |range| {
        let mut pieces = Pieces::default();
        let mut polygon = Vec::new();
        for f in range.map(FaceId::new) {
            polygon.clear();
            polygon_of(f, &mut polygon);
            pieces.cut(f, &polygon, positions);
        }
        pieces
    });
    let mut all = Pieces::default();
    for block in blocks {
        all.triangles.extend(block.triangles);
        all.corners.extend(block.corners);
        all.faces.extend(block.faces);
        all.sides.extend(block.sides);
    }
    let origin = Origin::Pieces { faces: all.faces, corners: all.corners, sides: all.sides };
    (all.triangles, origin)
}

/// Polygons on their way to triangles.
#[derive(Default)]
struct Pieces {
    triangles: Vec<[u32; 3]>,
    corners: Vec<[u32; 3]>,
    faces: Vec<u32>,
    sides: Vec<u8>,
    /// Of the face at hand.
    points: Vec<DVec3>,
}

impl Pieces {
    /// Adds the triangles of face `f`, whose corners and their vertices are given.
    fn cut(&mut self, f: FaceId, polygon: &[(usize, usize)], positions: &[DVec3]) {
        self.points.clear();
        self.points.extend(polygon.iter().map(|&(_, v)| positions[v]));
        let n = polygon.len();
        for cut in triangulate_polygon(&self.points, TriangulationMethod::Ears) {
            let is_side = |k: usize| (cut[k] + 1) % n == cut[(k + 1) % 3];
            self.sides.push((0..3).map(|k| u8::from(is_side(k)) << k).sum());
            self.triangles.push(cut.map(|i| polygon[i].1 as u32));
            self.corners.push(cut.map(|i| polygon[i].0 as u32));
            self.faces.push(f.index() as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_bring_every_size_to_one() {
        for x in [1.0, 1e300, f64::MAX, 1e-300, f64::from_bits(1), 0.7] {
            let scaled = Power::unit(x).scale_length(x);
            assert!((1.0..2.0).contains(&scaled), "{x} becomes {scaled}");
        }
        assert_eq!(Power::unit(3.0), Power::unit(2.5));
    }
}
