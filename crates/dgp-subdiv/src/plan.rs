//! A plan of refinement: connectivity once, values many times.
//!
//! The plan holds the connectivity and the sharpness of each level. Refining values, be they positions of
//! an animated cage or data, then needs no search and no weights: masks are worked out row by row. The last
//! level, as large as all others by three, is only made when something is asked of it that refining values
//! and joining faces do not need: these are arithmetic on the level before.
//!
//! - Cost: to make, O(corners) of all levels; to refine, O(corners) per level, in parallel.
//! - Guarantees: the same bits for any number of threads; what would not fit is refused before starting.

use std::sync::OnceLock;

use dgp_mesh::{
    Connectivity, FaceId, FaceList, FaceMap, HalfedgeId, Id, Progress, VertexId, parallel,
};

use crate::{
    Counts, Error, RefinementOptions, Scheme, Sharpness, StencilTable,
    butterfly::Butterfly,
    doo_sabin::{self, DooSabin},
    face_varying::faces_of_thirds,
    limit::{Limit, LimitMasks},
    masks::{self, Masks, Value},
    options::BoundaryRule,
    primal::{Kind, Primal},
    sharpness::Creases,
    smooth,
    split::Split,
    sqrt3::{self, Sqrt3},
    stencil::check_length,
    topology::Topology,
};

/// How a cage is refined, level by level, apart from where its vertices are.
///
/// Vertices of a level are numbered: those of the level before, points on its edges, points in its faces
/// (of Doo–Sabin: by corner).
///
/// ```
/// use dgp_mesh::{DVec3, Progress, shapes};
/// use dgp_subdiv::{RefinementOptions, RefinementPlan, Sharpness};
///
/// let cage = shapes::cube();
/// let options = RefinementOptions { levels: 3, ..RefinementOptions::default() };
/// let plan = RefinementPlan::new(&cage, &Sharpness::new(), &options, Progress::NONE)?;
/// for frame in 0..4 {
///     let stretch = DVec3::new(1.0, 1.0, 1.0 + f64::from(frame));
///     let moved: Vec<DVec3> = cage.positions().values().iter().map(|&p| p * stretch).collect();
///     assert_eq!(plan.refine(&moved)?.len(), plan.counts(3).vertices as usize);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RefinementPlan {
    options: RefinementOptions,
    /// The cage, then each level but the last.
    levels: Vec<Level>,
    /// The last level, once it is asked for.
    last: OnceLock<Level>,
    /// The elements of each level.
    counts: Vec<Counts>,
    bytes: u64,
}

#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) topology: Topology,
    pub(crate) creases: Creases,
    /// Of Doo–Sabin, the face of the level before that each face comes from.
    parents: Vec<u32>,
}

/// How a level is made of the one before.
#[derive(Clone, Copy)]
enum Step {
    Split(Split),
    /// √3, by the number of the step.
    Thirds(usize),
    DooSabin,
}

impl Step {
    fn new(scheme: Scheme, step: usize) -> Self {
        match scheme {
            Scheme::Loop(_) | Scheme::Butterfly(_) => Step::Split(Split::Triangles),
            Scheme::CatmullClark | Scheme::Bilinear => Step::Split(Split::Polygons),
            Scheme::Sqrt3 => Step::Thirds(step),
            Scheme::DooSabin => Step::DooSabin,
        }
    }

    /// The level after this one.
    fn level(self, Level { topology, creases, .. }: &Level) -> Level {
        let (topology, parents) = match self {
            Step::Split(split) => (split.children(topology), Vec::new()),
            Step::Thirds(step) => (sqrt3::refined(topology, step), Vec::new()),
            Step::DooSabin => doo_sabin::refined(topology),
        };
        Level { topology, creases: creases.refined(), parents }
    }

    /// How many elements it has, given what was predicted.
    fn counts(self, parent: &Topology, predicted: Counts) -> Counts {
        match self {
            Step::Split(_) => predicted,
            Step::Thirds(step) => sqrt3::counts(parent, step),
            Step::DooSabin => doo_sabin::counts(parent),
        }
    }

    fn connectivity(self, parent: &Topology) -> Connectivity {
        match self {
            Step::Split(split) => split.connectivity(parent),
            Step::Thirds(step) => sqrt3::connectivity(parent, step),
            Step::DooSabin => doo_sabin::connectivity(parent),
        }
    }
}

impl RefinementPlan {
    /// Plans to refine `cage`.
    ///
    /// Errors: [`Error::TooLarge`] before anything is computed; [`Error::IsolatedVertex`];
    /// [`Error::NotTriangle`] and [`Error::TwoFaces`] where the scheme splits triangles;
    /// [`Error::EdgeSharpness`], [`Error::VertexSharpness`], [`Error::NoCreases`];
    /// [`Error::WrongLength`] if something sharp is not in the cage; [`Error::Cancelled`].
    pub fn new(
        cage: &Connectivity,
        sharpness: &Sharpness,
        options: &RefinementOptions,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        progress.report(0.0)?;
        let (predicted, bytes) = options.predict(counts(cage))?;
        check_sharpness(cage, sharpness, options.scheme)?;
        check_cage(cage, options.scheme)?;
        let topology = Topology::new(cage);
        let mut creases = Creases::new(sharpness);
        if options.boundary == BoundaryRule::EdgeAndCorner {
            creases.sharpen_corners(&topology);
        }
        let mut plan = RefinementPlan {
            options: *options,
            levels: vec![Level { topology, creases, parents: Vec::new() }],
            last: OnceLock::new(),
            counts: predicted,
            bytes,
        };
        let total: u64 = plan.counts[1..].iter().map(|counts| counts.corners).sum();
        let mut done = 0;
        for level in 1..=options.levels {
            done += plan.counts[level].corners;
            let (step, parent) = (plan.step(level), &plan.levels[level - 1]);
            plan.counts[level] = step.counts(&parent.topology, plan.counts[level]);
            if level < options.levels {
                plan.levels.push(step.level(parent));
            }
            progress.report(done as f64 / total.max(1) as f64)?;
        }
        Ok(plan)
    }

    /// How `level` is made of the one before.
    fn step(&self, level: usize) -> Step {
        Step::new(self.options.scheme, level - 1)
    }

    /// What it was made with.
    pub fn options(&self) -> &RefinementOptions {
        &self.options
    }

    /// How often the cage is refined.
    pub fn levels(&self) -> usize {
        self.options.levels
    }

    /// The bytes predicted for the plan and the refined mesh.
    pub fn predicted_bytes(&self) -> u64 {
        self.bytes
    }

    /// How many elements a level has; the cage is level 0.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn counts(&self, level: usize) -> Counts {
        self.counts[level]
    }

    /// The values at the vertices of the last level, given those at the vertices of the cage.
    ///
    /// Error: [`Error::WrongLength`].
    pub fn refine<T: Value>(&self, values: &[T]) -> Result<Vec<T>, Error> {
        check_length("vertex of the cage", values.len(), self.vertices(0))?;
        let mut current = None;
        for step in 0..self.levels() {
            let old = current.as_deref().unwrap_or(values);
            current = Some(self.refined_values(step, old));
        }
        Ok(current.unwrap_or_else(|| values.to_vec()))
    }

    /// The values at the vertices of level `step` + 1, given those at the vertices of level `step`.
    ///
    /// Error: [`Error::WrongLength`].
    ///
    /// # Panics
    /// If there is no such level.
    pub fn refine_step<T: Value>(&self, step: usize, values: &[T]) -> Result<Vec<T>, Error> {
        assert!(step < self.levels(), "a plan of {} levels", self.levels());
        check_length("vertex of the level", values.len(), self.vertices(step))?;
        Ok(self.refined_values(step, values))
    }

    fn vertices(&self, level: usize) -> usize {
        self.counts[level].vertices as usize
    }

    fn refined_values<T: Value>(&self, step: usize, old: &[T]) -> Vec<T> {
        let Level { topology, creases, .. } = &self.levels[step];
        match Kind::of(self.options.scheme) {
            Some(kind) if creases.is_empty() => {
                let before = step.checked_sub(1).map(|before| &self.levels[before].topology);
                smooth::refined(before, topology, kind, old)
            }
            None => match self.options.scheme {
                Scheme::Butterfly(rule) => Butterfly::new(topology, rule).refined(old),
                Scheme::Sqrt3 => Sqrt3::new(topology, step).refined(old),
                _ => doo_sabin::refined_values(topology, old),
            },
            Some(_) => self.with_masks(step, |masks| masks::apply(masks, old)),
        }
    }

    /// The stencils that lead from level `step` to the next. Error: [`Error::TooManyEntries`].
    ///
    /// # Panics
    /// If there is no such level.
    pub fn step_stencils(&self, step: usize) -> Result<StencilTable, Error> {
        assert!(step < self.levels(), "a plan of {} levels", self.levels());
        self.with_masks(step, StencilTable::from_masks)
    }

    /// The stencils that lead from the cage to the last level. Error: [`Error::TooManyEntries`].
    pub fn stencils(&self) -> Result<StencilTable, Error> {
        let mut all: Option<StencilTable> = None;
        for step in 0..self.levels() {
            let next = self.step_stencils(step)?;
            all = Some(match all {
                Some(before) => next.compose(&before)?,
                None => next,
            });
        }
        match all {
            Some(all) => Ok(all),
            None => Ok(StencilTable::identity(self.vertices(0))),
        }
    }

    /// Where the vertices of the last level end up if they are refined for ever, given their values.
    ///
    /// Errors: [`Error::NoLimit`] unless the scheme is Loop, Catmull–Clark, bilinear or interpolates;
    /// [`Error::WrongLength`].
    pub fn limit<T: Value>(&self, values: &[T]) -> Result<Vec<T>, Error> {
        check_length("vertex of the last level", values.len(), self.vertices(self.levels()))?;
        if let Scheme::Butterfly(_) = self.options.scheme {
            return Ok(values.to_vec());
        }
        Ok(masks::apply(&self.limit_masks(Limit::Position)?, values))
    }

    /// The tangents of the limit surface at the vertices of the last level, given their values; the cross
    /// product of the first and the second points outward. Their lengths mean nothing. At a crease they
    /// are those of the surface to its left, at a corner those of the first sector. Beside a crease or rim that
    /// bounds more than 3 quadrilaterals or 5 triangles there is no tangent plane; these are the directions
    /// along it and of the first wave across.
    ///
    /// Errors: [`Error::NoLimit`] unless the scheme is Loop, Catmull–Clark or bilinear;
    /// [`Error::WrongLength`].
    pub fn limit_tangents<T: Value>(&self, values: &[T]) -> Result<[Vec<T>; 2], Error> {
        check_length("vertex of the last level", values.len(), self.vertices(self.levels()))?;
        let first = masks::apply(&self.limit_masks(Limit::Tangent(0))?, values);
        let second = masks::apply(&self.limit_masks(Limit::Tangent(1))?, values);
        Ok([first, second])
    }

    /// The stencils from the last level to its limit positions. Errors: [`Error::NoLimit`],
    /// [`Error::TooManyEntries`].
    pub fn limit_stencils(&self) -> Result<StencilTable, Error> {
        StencilTable::from_masks(&self.limit_masks(Limit::Position)?)
    }

    /// The stencils from the last level to its two tangents. Errors: [`Error::NoLimit`],
    /// [`Error::TooManyEntries`].
    pub fn tangent_stencils(&self) -> Result<[StencilTable; 2], Error> {
        let [first, second] = [0, 1].map(|k| self.limit_masks(Limit::Tangent(k)));
        Ok([StencilTable::from_masks(&first?)?, StencilTable::from_masks(&second?)?])
    }

    fn limit_masks(&self, what: Limit) -> Result<LimitMasks<'_>, Error> {
        let Level { topology, creases, .. } = self.last();
        let scheme = self.options.scheme;
        let kind = Kind::of(scheme).ok_or(Error::NoLimit { scheme: scheme.name() })?;
        Ok(LimitMasks { topology, creases, kind, what })
    }

    /// The faces of a level as lists of vertices.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn faces(&self, level: usize) -> FaceList {
        match self.unmade(level) {
            Some((Step::Split(split), parent)) => split.faces(&parent.topology),
            Some((Step::Thirds(step), parent)) => sqrt3::faces(&parent.topology, step),
            _ => self.level(level).topology.faces(),
        }
    }

    /// How `level` is made of which one, if it is the last.
    fn unmade(&self, level: usize) -> Option<(Step, &Level)> {
        let is_last = level > 0 && level == self.levels.len();
        is_last.then(|| (self.step(level), &self.levels[level - 1]))
    }

    /// The face of the cage that each face of the last level comes from; of faces that stand for an edge or
    /// a vertex one of those there.
    pub fn cage_faces(&self) -> FaceMap<FaceId> {
        if self.options.scheme == Scheme::Sqrt3 {
            let faces = faces_of_thirds(self);
            return faces.iter().map(|&f| FaceId::new(f as usize)).collect::<Vec<_>>().into();
        }
        let parents = |step: usize| &self.level(step + 1).parents;
        parallel::map(self.counts[self.levels()].faces as usize, |f: FaceId| {
            let mut face = f.index() as u32;
            for step in (0..self.levels()).rev() {
                face = match self.options.scheme {
                    Scheme::Loop(_) | Scheme::Butterfly(_) => face / 4,
                    Scheme::DooSabin => parents(step)[face as usize],
                    // The face of the corner with its number.
                    _ => self.levels[step].topology.face(face),
                };
            }
            FaceId::new(face as usize)
        })
    }

    /// The connectivity of the last level. Edges have the numbers they have in the plan, which knows them.
    pub fn connectivity(&self) -> Connectivity {
        match self.unmade(self.levels()) {
            Some((step, parent)) => step.connectivity(&parent.topology),
            None => self.last().topology.connectivity(),
        }
    }

    pub(crate) fn last(&self) -> &Level {
        self.level(self.levels())
    }

    pub(crate) fn level(&self, level: usize) -> &Level {
        match self.unmade(level) {
            Some((step, parent)) => self.last.get_or_init(|| step.level(parent)),
            None => &self.levels[level],
        }
    }

    /// Calls `f` with the masks that lead from level `step` to the next.
    pub(crate) fn with_masks<R>(&self, step: usize, f: impl FnOnce(&dyn Masks) -> R) -> R {
        let Level { topology, creases, .. } = &self.levels[step];
        match self.options.scheme {
            Scheme::Loop(weights) => f(&Primal::new(topology, creases, Kind::Loop(weights))),
            Scheme::CatmullClark => f(&Primal::new(topology, creases, Kind::CatmullClark)),
            Scheme::Bilinear => f(&Primal::new(topology, creases, Kind::Bilinear)),
            Scheme::Butterfly(rule) => f(&Butterfly::new(topology, rule)),
            Scheme::Sqrt3 => f(&Sqrt3::new(topology, step)),
            Scheme::DooSabin => f(&DooSabin::new(topology)),
        }
    }
}

/// The elements of a mesh.
pub(crate) fn counts(mesh: &Connectivity) -> Counts {
    let has_face = |h: HalfedgeId| u64::from(!mesh.is_boundary_halfedge(h));
    Counts {
        vertices: mesh.vertex_count() as u64,
        edges: mesh.edge_count() as u64,
        corners: parallel::reduce(mesh.halfedge_count(), 0, has_face, |a, b| a + b),
        faces: mesh.face_count() as u64,
    }
}

/// Refuses sharpness out of range, of elements that are not there, and where the scheme has no rules.
fn check_sharpness(
    cage: &Connectivity,
    sharpness: &Sharpness,
    scheme: Scheme,
) -> Result<(), Error> {
    sharpness.validate()?;
    let [edges, vertices] = sharpness.lengths();
    if edges > cage.edge_count() {
        return check_length("edge of the cage", edges, cage.edge_count());
    }
    if vertices > cage.vertex_count() {
        return check_length("vertex of the cage", vertices, cage.vertex_count());
    }
    if !(scheme.has_creases() || scheme == Scheme::Bilinear || sharpness.is_smooth()) {
        return Err(Error::NoCreases { scheme: scheme.name() });
    }
    Ok(())
}

/// Refuses vertices and faces that the scheme cannot split.
fn check_cage(cage: &Connectivity, scheme: Scheme) -> Result<(), Error> {
    if let Some(vertex) = first(cage.vertex_count(), |v| cage.is_isolated_vertex(v)) {
        return Err(Error::IsolatedVertex { vertex });
    }
    if scheme.needs_triangles()
        && let Some(face) = first(cage.face_count(), |f: FaceId| cage.triangle(f).is_none())
    {
        let (scheme, degree) = (scheme.name(), cage.degree(face));
        return Err(Error::NotTriangle { scheme, face, degree });
    }
    if scheme.needs_triangles() || scheme == Scheme::DooSabin {
        let is_bad = |v: VertexId| match cage.vertex_halfedge(v) {
            Some(h) if !cage.is_boundary_halfedge(h) => cage.ccw(cage.ccw(h)) == h,
            _ => false,
        };
        if let Some(vertex) = first(cage.vertex_count(), is_bad) {
            return Err(Error::TwoFaces { scheme: scheme.name(), vertex });
        }
    }
    Ok(())
}

/// The first of `count` elements of which `is_wanted` holds.
pub(crate) fn first<I: Id>(count: usize, is_wanted: impl Fn(I) -> bool + Sync + Send) -> Option<I> {
    let found = parallel::map_blocks(count, parallel::BLOCK, |block| {
        block.map(I::from_index).find(|&id| is_wanted(id))
    });
    found.into_iter().flatten().next()
}

#[cfg(test)]
mod tests {
    use dgp_mesh::{EdgeId, shapes};

    use super::*;
    use crate::SHARP;

    #[test]
    fn bad_cages_are_refused_by_name() {
        let plan = |mesh: &Connectivity, scheme, sharpness: &Sharpness| {
            let options = RefinementOptions { scheme, ..RefinementOptions::default() };
            RefinementPlan::new(mesh, sharpness, &options, Progress::NONE).map(|_| ())
        };
        let (cube, smooth) = (shapes::cube(), Sharpness::new());
        let error = plan(&cube, Scheme::Sqrt3, &smooth).unwrap_err();
        assert!(matches!(error, Error::NotTriangle { degree: 4, .. }), "{error}");
        let lonely = Connectivity::from_faces(4, &FaceList::from_indices(&[[0, 1, 2]])).unwrap();
        let error = plan(&lonely, Scheme::CatmullClark, &smooth).unwrap_err();
        assert_eq!(error, Error::IsolatedVertex { vertex: VertexId::new(3) });
        let pillow = FaceList::from_indices(&[[0, 1, 2], [2, 1, 0]]);
        let pillow = Connectivity::from_faces(3, &pillow).unwrap();
        let scheme = Scheme::Loop(crate::LoopWeights::Original);
        assert!(matches!(plan(&pillow, scheme, &smooth), Err(Error::TwoFaces { .. })));
        assert_eq!(plan(&pillow, Scheme::CatmullClark, &smooth), Ok(()));

        let mut sharp = Sharpness::new();
        sharp.set_edge(EdgeId::new(3), -0.5);
        let error = plan(&cube, Scheme::CatmullClark, &sharp).unwrap_err();
        assert_eq!(error, Error::EdgeSharpness { edge: EdgeId::new(3), sharpness: -0.5 });
        sharp.set_edge(EdgeId::new(3), SHARP);
        assert_eq!(plan(&cube, Scheme::CatmullClark, &sharp), Ok(()));
        assert!(matches!(plan(&cube, Scheme::DooSabin, &sharp), Err(Error::NoCreases { .. })));
        sharp.set_vertex(VertexId::new(2), f64::NAN);
        let error = plan(&cube, Scheme::CatmullClark, &sharp).unwrap_err();
        assert!(matches!(error, Error::VertexSharpness { .. }), "{error}");
        let mut outside = Sharpness::new();
        outside.set_edge(EdgeId::new(12), 1.0);
        let error = plan(&cube, Scheme::CatmullClark, &outside).unwrap_err();
        assert!(matches!(error, Error::WrongLength { given: 13, expected: 12, .. }), "{error}");
    }
}
