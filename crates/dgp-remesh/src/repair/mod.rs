//! Repair of surfaces: what connectivity alone does not tell.
//!
//! | step | what it does | file |
//! |---|---|---|
//! | faces | a manifold of any faces, by [`dgp_mesh::repair_faces`] | |
//! | stitch | joins rims that lie along each other, T-junctions too | `rims.rs` |
//! | components | drops what is too small | `components.rs` |
//! | holes | fills them, where asked to | `../fill` |
//! | slivers | collapses needles, flips caps | `slivers.rs` |
//! | intersections | cuts out what meets, and fills the holes | `intersections.rs` |
//! | facing | turns closed components outward, open ones by sight where asked to | `facing.rs` |
//!
//! Slivers and intersections take turns, as mending one may bring the other about.

mod components;
mod facing;
mod geometry;
mod intersections;
mod report;
mod rims;
mod slivers;
mod track;

use dgp_mesh::{
    Editor, FaceSet, Facing, FlatFaces, IndexedFaceSet, KeepComponents, Mesh, OppositeFaces,
    Progress, RepairOptions, RepairReport, Tolerance, repair_faces, topology::boundary_loops,
};

use crate::{
    Error, FillOptions, HoleOutcome,
    fill::{fill, new_hole},
};

pub use components::{LeastComponent, drop_small_components};
pub use facing::hidden_fronts;
pub use intersections::{IntersectionOptions, IntersectionReport, remove_self_intersections};
pub use report::{RepairStep, SurfaceRepairReport};
pub use rims::{StitchReport, stitch_rims};
pub use slivers::{SliverOptions, SliverReport, cap_faces, needle_faces, remove_slivers};

use track::Track;

/// So many times slivers and intersections take turns.
const TURNS: usize = 4;

/// How [`repair_surface`] works. `None` leaves a step out.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceRepairOptions {
    /// How a manifold is made of the faces. Components are chosen after rims are joined; holes are
    /// [`holes`](Self::holes).
    pub faces: RepairOptions,
    /// How far apart rims that are joined may be.
    pub stitch: Option<Tolerance>,
    /// What a component must have to stay.
    pub components: LeastComponent,
    /// How holes are filled.
    pub holes: Option<FillOptions>,
    /// Which slivers go.
    pub slivers: Option<SliverOptions>,
    /// How faces that pass through each other go.
    pub intersections: Option<IntersectionOptions>,
    /// Which way open components look.
    pub open_surfaces: OpenSurfaces,
}

/// Which way open components are to look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OpenSurfaces {
    /// As most of their faces do.
    #[default]
    Keep,
    /// Towards where they are seen from: see [`hidden_fronts`]. A room that was scanned from within is
    /// turned, too.
    BySight,
}

impl Default for SurfaceRepairOptions {
    fn default() -> Self {
        SurfaceRepairOptions {
            faces: RepairOptions {
                flat_faces: FlatFaces::Remove,
                opposite_faces: OppositeFaces::Remove,
                ..RepairOptions::default()
            },
            stitch: Some(Tolerance::OfDiagonal(1e-6)),
            components: LeastComponent::default(),
            holes: None,
            slivers: Some(SliverOptions::default()),
            intersections: Some(IntersectionOptions::default()),
            open_surfaces: OpenSurfaces::Keep,
        }
    }
}

/// Makes a mesh of `set` and mends its geometry, as far as the limits of the steps allow; the report tells
/// what is left.
///
/// Data travel. Errors: those of [`dgp_mesh::repair_faces`] as [`Error::Mesh`],
/// [`Error::InvalidOption`], [`Error::Cancelled`].
///
/// ```
/// use dgp_mesh::{Progress, shapes, topology::boundary_loops};
/// use dgp_remesh::{SurfaceRepairOptions, repair_surface};
///
/// // A sphere with a patch cut loose and another turned over.
/// let sphere = shapes::icosphere(3)?.to_indexed();
/// let broken = shapes::flip_patch(&shapes::unweld_patch(&sphere, 0.2, 1), 0.2, 2);
/// let options = SurfaceRepairOptions::default();
/// let (mesh, report) = repair_surface(&broken, &options, Progress::NONE)?;
/// assert!(report.is_sound() && boundary_loops(&mesh).is_empty());
/// assert_eq!((mesh.vertex_count(), mesh.face_count()), (642, 1280));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn repair_surface(
    set: &IndexedFaceSet,
    options: &SurfaceRepairOptions,
    progress: Progress<'_>,
) -> Result<(Mesh, SurfaceRepairReport), Error> {
    let faces = RepairOptions { components: KeepComponents::All, hole_edges: 0, ..options.faces };
    let (repaired, first) = repair_faces(set, &faces, progress.part(0.0, 0.15))?;
    let mut mesh = Mesh::new(&repaired)?;
    let mut track = Track { vertices: first.vertices.clone(), faces: first.face_sources.clone() };
    let mut report = SurfaceRepairReport { faces: first, ..SurfaceRepairReport::default() };

    if let Some(tolerance) = options.stitch {
        let part = progress.part(0.15, 0.3);
        report.stitch = rims::stitch(&mut mesh, tolerance, &faces, &mut track, part)?;
    }
    if options.faces.components != KeepComponents::All {
        let keep = RepairOptions { components: options.faces.components, ..unchanging(&faces) };
        report.components = again(&mut mesh, &keep, &mut track, progress.part(0.3, 0.33))?.changes;
    }
    let part = progress.part(0.33, 0.35);
    let small = components::drop_small(&mut mesh, &options.components, &mut track, part)?;
    report.small_components = small.len();
    if options.faces.flat_faces == FlatFaces::Remove {
        report.flat_components = components::drop_flat(&mut mesh, &mut track)?;
    }
    if let Some(holes) = &options.holes {
        fill_all(&mut mesh, holes, &mut track, &mut report, progress.part(0.35, 0.5))?;
    }
    take_turns(&mut mesh, options, &mut track, &mut report, progress.part(0.5, 0.9))?;

    let last = RepairOptions { weld: None, ..faces };
    let last = again(&mut mesh, &last, &mut track, progress.part(0.9, 0.95))?;
    report.follow(last);
    if options.open_surfaces == OpenSurfaces::BySight {
        let hidden = facing::hidden_fronts(&mesh, progress.part(0.95, 1.0))?;
        if !hidden.is_empty() {
            mesh = facing::turned(&mesh, &hidden)?;
        }
        report.turned_by_sight = hidden.len();
    }
    report.vertices = track.vertices;
    report.face_sources = track.faces;
    progress.report(1.0)?;
    Ok((mesh, report))
}

/// Options that change nothing of a mesh.
fn unchanging(options: &RepairOptions) -> RepairOptions {
    RepairOptions {
        weld: None,
        flat_faces: FlatFaces::Keep,
        opposite_faces: OppositeFaces::Keep,
        orientation: Facing::Keep,
        ..*options
    }
}

/// Repairs the faces of a mesh once more.
fn again(
    mesh: &mut Mesh,
    options: &RepairOptions,
    track: &mut Track,
    progress: Progress<'_>,
) -> Result<RepairReport, Error> {
    let set = mesh.to_indexed();
    let (repaired, report) = repair_faces(&set, options, progress)?;
    if !report.changes.is_empty() {
        *mesh = Mesh::new(&repaired)?;
        track.repaired(&report);
    }
    Ok(report)
}

/// Fills all holes that are short enough, but not around a single face.
fn fill_all(
    mesh: &mut Mesh,
    options: &FillOptions,
    track: &mut Track,
    report: &mut SurfaceRepairReport,
    progress: Progress<'_>,
) -> Result<(), Error> {
    geometry::need_finite(mesh)?;
    let rims = boundary_loops(mesh);
    let mut editor = Editor::new(mesh);
    let mut faces = FaceSet::new();
    for (k, rim) in rims.iter().enumerate() {
        let part = |k: usize| k as f64 / rims.len() as f64;
        progress.report(part(k))?;
        let around = editor.mesh().face(rim[0].twin());
        let is_alone = rim.iter().all(|&h| editor.mesh().face(h.twin()) == around);
        let mut hole = new_hole(rim, 0.0);
        if is_alone || rim.len() > options.max_edges {
            report.holes_left += 1;
            continue;
        }
        fill(
            &mut editor,
            rim,
            options,
            &mut hole,
            &mut faces,
            progress.part(part(k), part(k + 1)),
        )?;
        match hole.outcome {
            HoleOutcome::Filled => report.holes_filled += 1,
            _ => report.holes_left += 1,
        }
    }
    report.hole_faces = faces.len();
    track.compacted(&editor.finish(), &[]);
    Ok(())
}

/// Slivers and intersections until neither brings the other about.
fn take_turns(
    mesh: &mut Mesh,
    options: &SurfaceRepairOptions,
    track: &mut Track,
    report: &mut SurfaceRepairReport,
    progress: Progress<'_>,
) -> Result<(), Error> {
    for turn in 0..TURNS {
        let (start, end) = (1.0 - 0.5_f64.powi(turn as i32), 1.0 - 0.5_f64.powi(turn as i32 + 1));
        let part = progress.part(start, end);
        if let Some(slivers) = &options.slivers {
            report.add_slivers(slivers::remove(mesh, slivers, track, part.part(0.0, 0.3))?);
        }
        let Some(intersections) = &options.intersections else { break };
        let before = track.clone();
        let done = intersections::remove(mesh, intersections, track, part.part(0.3, 1.0))?;
        let changed = done.removed > 0;
        report.add_intersections(done, &before);
        if !changed {
            break;
        }
        if let Some(tolerance) = options.stitch {
            // Cuts may leave rims that lie along each other.
            let faces = RepairOptions { components: KeepComponents::All, ..options.faces };
            let more = rims::stitch(mesh, tolerance, &faces, track, part.part(1.0, 1.0))?;
            report.stitch.junctions += more.junctions;
            report.stitch.joined += more.joined;
            report.stitch.merged += more.merged;
        }
    }
    Ok(())
}
