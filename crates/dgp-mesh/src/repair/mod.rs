//! Repair: makes a manifold mesh of any faces, and tells what it changed, element by element.
//!
//! In this order, each step only where something is to be done:
//!
//! 1. weld vertices, where asked to;
//! 2. drop vertices with coordinates that are no finite numbers, and their faces;
//! 3. shorten faces that name a vertex twice, drop those of fewer than three corners;
//! 4. drop all but the first of equal faces, and those that lie back to back, where asked to;
//! 5. turn faces over so that neighbors agree, and cut where they cannot;
//! 6. where more than two faces meet at an edge, decide which two belong together;
//! 7. give each fan of faces at a vertex a vertex of its own;
//! 8. drop components, remove flat faces, fill holes, where asked to;
//! 9. turn closed surfaces that are inside out;
//! 10. drop vertices of no face.
//!
//! - Input: any face set.
//! - Cost: O(F) time and memory; holes of n edges O(n³) up to some 200 edges, O(n log n) beyond.
//! - Guarantees: the result is a manifold. Repairing it again with the same options changes nothing,
//!   with the exceptions said at the options. Independent of threads and of scale. A face is kept,
//!   shortened, turned or listed as dropped; no vertex is moved but by welding.
//! - Reference: Guéziec, Taubin, Lazarus & Horn, "Cutting and stitching: converting sets of polygons
//!   to manifold surfaces", IEEE TVCG 2001.
//! - Departs from it: at an edge of many faces those that enclose solid stay together, instead of all
//!   being cut apart and stitched again.

mod components;
mod degenerate;
mod draft;
mod fans;
mod flat;
mod holes;
mod report;
mod separate;
mod sheets;
mod triangulate;

pub use report::{Change, RepairAction, RepairReport};

use std::{borrow::Cow, sync::Arc};

use crate::check::{components::Solids, duplicates, orientation::Orientation};
use crate::{
    CornerId, Elements, Error, FaceId, FaceMap, Groups, IndexedFaceSet, Mesh, Progress, Tolerance,
    VertexId, VertexMap, Welding, weld,
};
use draft::Draft;

/// How to [`repair`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairOptions {
    /// Which vertices to make one, if any. Legal seams are duplicates too, so this is not done unasked.
    pub weld: Option<Tolerance>,
    /// What becomes of faces whose corners are on one line.
    pub flat_faces: FlatFaces,
    /// Which way faces are to look.
    pub orientation: Facing,
    /// What becomes of one-sided surfaces.
    pub one_sided: OneSided,
    /// What becomes of edges that more than two faces share.
    pub crowded_edges: CrowdedEdges,
    /// What becomes of faces that are the backs of others.
    pub opposite_faces: OppositeFaces,
    /// Which connected components stay.
    pub components: KeepComponents,
    /// Holes of up to this many edges are filled; none if it is zero. What has a rim by nature, such
    /// as a scan, has that filled too if it is short enough.
    pub hole_edges: usize,
    /// What becomes of vertices of no face. Where there is no face at all they stay in any case.
    pub isolated_vertices: IsolatedVertices,
}

/// What becomes of faces of zero area, all corners of which lie on one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FlatFaces {
    /// They stay: dropping them would open slits.
    #[default]
    Keep,
    /// They are removed without opening anything: two corners at one place become one vertex, and a
    /// corner on the opposite side goes into the face across. What cannot go so stays, and is listed.
    Remove,
}

/// Which way faces are to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Facing {
    /// As they do; where neighbors disagree the surface is cut.
    Keep,
    /// The way most of each component do.
    Consistent,
    /// The same, and closed components outward: outermost ones, and cavities within them inward. A
    /// closed component within another that looks outward stays as it is, since a body may overlap
    /// another.
    #[default]
    Outward,
}

/// What becomes of surfaces with only one side, such as a Möbius strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum OneSided {
    /// They are cut along the edges where their faces disagree.
    #[default]
    Cut,
    /// [`Error::OneSided`].
    Refuse,
}

/// What becomes of edges that more than two faces share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum CrowdedEdges {
    /// Faces stay together in twos: those with solid between them where the faces at the edge enclose
    /// volume, else those that continue each other straightest.
    #[default]
    Pair,
    /// All are cut apart.
    Cut,
}

/// What becomes of faces with the vertices of another in reverse order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum OppositeFaces {
    /// They stay.
    #[default]
    Keep,
    /// A patch of such pairs that other faces pass by, a wall between two solids or a fin, goes. One that
    /// others continue, or that stands alone, keeps one of its sides.
    Remove,
}

/// Which connected components stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum KeepComponents {
    /// All of them.
    #[default]
    All,
    /// That many, those with the most faces, the first of equals.
    Largest(usize),
    /// Those of at least that many faces.
    AtLeast(usize),
}

/// What becomes of vertices of no face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum IsolatedVertices {
    /// They are dropped.
    #[default]
    Drop,
    /// They stay.
    Keep,
}

impl Default for RepairOptions {
    fn default() -> Self {
        RepairOptions {
            weld: None,
            flat_faces: FlatFaces::Keep,
            orientation: Facing::Outward,
            one_sided: OneSided::Cut,
            crowded_edges: CrowdedEdges::Pair,
            opposite_faces: OppositeFaces::Keep,
            components: KeepComponents::All,
            hole_edges: 0,
            isolated_vertices: IsolatedVertices::Drop,
        }
    }
}

/// Makes a mesh of `set`, whatever is wrong with it.
///
/// Errors: [`Error::OneSided`] if that is to be refused, [`Error::InvalidOption`] for a tolerance that
/// is no length, [`Error::TooMany`] if copies of vertices exceed what ids can count,
/// [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Progress, RepairAction, RepairOptions, repair};
///
/// // The second triangle looks the other way.
/// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
/// let faces = FaceList::from_indices(&[[0, 1, 2], [1, 2, 3]]);
/// let set = IndexedFaceSet::new(positions, faces)?;
/// let (mesh, report) = repair(&set, &RepairOptions::default(), Progress::NONE)?;
/// assert_eq!((mesh.face_count(), report.changes[0].action), (2, RepairAction::TurnFaces));
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
pub fn repair(
    set: &IndexedFaceSet,
    options: &RepairOptions,
    progress: Progress<'_>,
) -> Result<(Mesh, RepairReport), Error> {
    let (faces, report) = repair_faces(set, options, progress.part(0.0, 0.85))?;
    let mesh = Mesh::new(&faces)?;
    progress.report(1.0)?;
    Ok((mesh, report))
}

/// The faces of the mesh that [`repair`] makes of `set`; [`Mesh::new`] accepts them. Errors as there.
pub fn repair_faces<'a>(
    set: &'a IndexedFaceSet,
    options: &RepairOptions,
    progress: Progress<'_>,
) -> Result<(Cow<'a, IndexedFaceSet>, RepairReport), Error> {
    progress.report(0.0)?;
    let mut changes = Vec::new();
    let (base, welding) = welded(set, options, progress.part(0.0, 0.3), &mut changes)?;
    let mut draft = Draft::new(&base, welding, changes);

    draft.drop_non_finite();
    degenerate::mend(&mut draft)?;
    progress.report(0.4)?;
    let adjacency = draft.adjacency();
    // Equal faces share sides in a way that is no manifold's, so there is nothing to seek in one.
    let suspicious = !adjacency.misoriented.is_empty() || adjacency.crowded_edges().len() > 0;
    if suspicious || options.opposite_faces == OppositeFaces::Remove {
        drop_duplicates(&mut draft, options.opposite_faces);
    }
    progress.report(0.5)?;
    if suspicious {
        orient(&mut draft, options)?;
    }
    progress.report(0.6)?;
    fans::split(&mut draft, options.crowded_edges)?;
    progress.report(0.7)?;
    progress.report(0.8)?;
    components::keep(&mut draft, options.components);
    if options.flat_faces == FlatFaces::Remove {
        flat::remove(&mut draft);
    }
    progress.report(0.9)?;
    if options.hole_edges > 0 {
        holes::fill(&mut draft, options.hole_edges, progress.part(0.9, 1.0))?;
    }
    if options.orientation == Facing::Outward {
        turn_outward(&mut draft);
    }
    if options.isolated_vertices == IsolatedVertices::Drop {
        draft.drop_isolated();
    }
    progress.report(1.0)?;
    Ok(finish(base, draft))
}

fn welded<'a>(
    set: &'a IndexedFaceSet,
    options: &RepairOptions,
    progress: Progress<'_>,
    changes: &mut Vec<Change>,
) -> Result<(Cow<'a, IndexedFaceSet>, Option<Welding>), Error> {
    let Some(tolerance) = options.weld else { return Ok((Cow::Borrowed(set), None)) };
    let (base, report) = weld(set, tolerance, progress)?;
    let merges: Vec<_> = report.welding.merges().collect();
    if merges.is_empty() {
        return Ok((Cow::Borrowed(set), None));
    }
    let elements = Elements::VertexPairs(merges);
    changes.push(Change { action: RepairAction::MergeVertices, elements });
    Ok((Cow::Owned(base), Some(report.welding)))
}

fn drop_duplicates(draft: &mut Draft, opposite_faces: OppositeFaces) {
    let found = duplicates(draft.positions.len(), &draft.faces);
    let (pairs, opposite) = (found.same, found.opposite);
    if opposite_faces == OppositeFaces::Remove && !opposite.is_empty() {
        // Both at once, as ids change when faces go.
        let backs = sheets::to_drop(draft, &pairs, &opposite);
        draft.record(RepairAction::DropOppositeFaces, draft.input_faces(&backs));
        let mut dropped: Vec<FaceId> = pairs.iter().map(|pair| pair[0]).chain(backs).collect();
        dropped.sort_unstable();
        dropped.dedup();
        let pairs = pairs.iter().map(|pair| pair.map(|f| draft.input_face(f))).collect();
        draft.record(RepairAction::DropDuplicateFaces, Elements::FacePairs(pairs));
        draft.drop_faces(&dropped);
        return;
    }
    let dropped: Vec<FaceId> = pairs.iter().map(|pair| pair[0]).collect();
    let pairs = pairs.iter().map(|pair| pair.map(|f| draft.input_face(f))).collect();
    draft.record(RepairAction::DropDuplicateFaces, Elements::FacePairs(pairs));
    draft.drop_faces(&dropped);
}

/// Makes neighbors agree as far as they can; the others are cut when fans are split.
fn orient(draft: &mut Draft, options: &RepairOptions) -> Result<(), Error> {
    if options.orientation == Facing::Keep {
        return Ok(());
    }
    let adjacency = draft.take_adjacency();
    let Orientation { turned, disagreeing } = Orientation::new(&adjacency);
    if let (OneSided::Refuse, Some(&[s, t])) = (options.one_sided, disagreeing.first()) {
        return Err(Error::OneSided {
            edges: disagreeing.len(),
            vertices: adjacency.edge(s).map(|v| draft.input_vertex(v)),
            faces: [s, t].map(|side| draft.input_face(adjacency.face(side))),
        });
    }
    draft.put_adjacency(adjacency);
    let turned: Vec<FaceId> = turned.iter().filter(|&(_, &turn)| turn).map(|(f, _)| f).collect();
    draft.turn(&turned);
    let turned = turned.into_iter().map(|f| draft.input_face(f)).collect();
    draft.record(RepairAction::TurnFaces, Elements::Faces(turned));
    Ok(())
}

fn turn_outward(draft: &mut Draft) {
    let adjacency = draft.take_adjacency();
    let inward = Solids::new(&draft.positions, &adjacency).inward();
    draft.put_adjacency(adjacency);
    let mut faces: Vec<FaceId> = inward.members().to_vec();
    faces.sort_unstable();
    draft.turn(&faces);
    // Faces that fill holes were not in the input.
    let filled_from = draft.filled_from.unwrap_or(draft.faces.len());
    let mut turned = Groups::new();
    for group in inward.iter() {
        let old = group.iter().filter(|f| f.index() < filled_from);
        turned.push(old.map(|&f| draft.input_face(f)));
    }
    draft.record(RepairAction::TurnComponents, Elements::FaceGroups(turned));
}

/// The repaired set with all data, and the maps between its elements and those of the input.
fn finish(base: Cow<'_, IndexedFaceSet>, draft: Draft) -> (Cow<'_, IndexedFaceSet>, RepairReport) {
    let Draft { positions, faces, vertex_sources, corner_sources, face_sources, .. } = draft;
    let mut first = VertexMap::filled(base.vertex_count(), None);
    for (i, &source) in vertex_sources.iter().enumerate().rev() {
        first[source] = Some(VertexId::new(i));
    }
    // Later merges first, so that chains of them end where the vertex is.
    for &[from, into] in draft.merged.iter().rev() {
        first[from] = first[from].or(first[into]);
    }
    let (vertices, originals) = match draft.welding {
        None => (first, None),
        Some(Welding { vertices, originals }) => (vertices.map(|&v| first[v]), Some(originals)),
    };
    let filled_from = draft.filled_from.unwrap_or(face_sources.len());
    let mut new_faces = FaceMap::filled(base.face_count(), None);
    for (i, &source) in face_sources[..filled_from].iter().enumerate() {
        new_faces[source] = Some(FaceId::new(i));
    }
    let input = |&v: &VertexId| originals.as_ref().map_or(v, |originals| originals[v]);
    let face_source = |f: FaceId| (f.index() < filled_from).then(|| face_sources[f.index()]);
    let report = RepairReport {
        vertices,
        vertex_sources: vertex_sources.iter().map(input).collect::<Vec<_>>().into(),
        faces: new_faces,
        face_sources: FaceMap::from_fn(face_sources.len(), face_source),
        changes: draft.changes,
    };
    if report.changes.is_empty() {
        return (base, report);
    }
    let faces = Arc::try_unwrap(faces).unwrap_or_else(|shared| (*shared).clone());
    let mut set = IndexedFaceSet::from_valid(positions, faces);
    let (vertex, corner) = (&vertex_sources, &corner_sources);
    set.vertex_attributes =
        base.vertex_attributes.gather(vertex.len(), |v: VertexId| Some(vertex[v.index()]));
    set.corner_attributes =
        base.corner_attributes.gather(corner.len(), |c: CornerId| Some(corner[c.index()]));
    set.face_attributes =
        base.face_attributes.gather(face_sources.len(), |f: FaceId| Some(face_sources[f.index()]));
    (Cow::Owned(set), report)
}

#[cfg(test)]
mod tests;
