//! `dgp repair`: mends a mesh and says what it changed.

use std::{fmt::Write, process::ExitCode};

use clap::{Args, ValueEnum};
use dgp::{
    mesh::{
        CrowdedEdges, Elements, Facing, FlatFaces, IndexedFaceSet, IsolatedVertices,
        KeepComponents, OneSided, OppositeFaces, RepairAction, RepairOptions, RepairReport,
        Tolerance, repair_faces,
    },
    remesh::{
        FillOptions, IntersectionOptions, LeastComponent, OpenSurfaces, Patch, SliverOptions,
        SurfaceRepairOptions, SurfaceRepairReport, repair_surface,
    },
};
use serde_json::{Value, json};

use super::check::{element_kind, elements};
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp repair`.
///
/// Without options the result is an oriented manifold that passes `dgp check`: vertices that are no
/// numbers and their faces go, and so do faces that are no polygons, copies of faces, walls within
/// solids and faces without area; faces are turned to agree, closed surfaces to look outward; edges of
/// three or more faces and vertices of several fans are taken apart; rims that lie along each other are
/// joined, T-junctions too; needles and caps go; faces that pass through each other are cut out and the
/// holes filled. The options change how, or ask for more. What cannot be mended within the limits is
/// refused with the reason.
#[derive(Debug, Args)]
pub(crate) struct Repair {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    mending: Mending,
    #[command(flatten)]
    surface: SurfaceMending,
}

/// How to mend.
#[derive(Clone, Debug, Args)]
pub(crate) struct Mending {
    /// Make vertices one that are up to EPS apart: 0 for those at the same place, a length, or a
    /// percentage of the diagonal such as 0.01%
    #[arg(long, value_name = "EPS", value_parser = tolerance)]
    weld: Option<Tolerance>,
    /// Which way faces are to look
    #[arg(long, value_name = "WAY", num_args = 0..=1, default_missing_value = "outward", default_value = "outward")]
    orient: Way,
    /// What becomes of edges of three or more faces
    #[arg(long, value_name = "HOW", num_args = 0..=1, default_missing_value = "pair", default_value = "pair")]
    split_non_manifold: Split,
    /// Refuse surfaces that have only one side instead of cutting them
    #[arg(long)]
    refuse_one_sided: bool,
    /// Remove faces of zero area, without opening the surface; done anyway but with `--minimal`
    #[arg(long)]
    drop_degenerate: bool,
    /// Keep only the N components with the most faces
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "1")]
    keep_largest: Option<usize>,
    /// Keep only components of at least N faces
    #[arg(long, value_name = "N", conflicts_with = "keep_largest")]
    drop_small: Option<usize>,
    /// Fill holes of up to N edges; without N all
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "4294967295")]
    fill_holes: Option<usize>,
    /// Keep vertices of no face
    #[arg(long)]
    keep_isolated: bool,
}

/// How to mend what is more than a matter of connectivity.
#[derive(Clone, Debug, Args)]
struct SurfaceMending {
    /// Make a manifold and no more: no rims joined, no slivers or intersections removed
    #[arg(long)]
    minimal: bool,
    /// Join rims up to EPS apart, and T-junctions on them; given as for `--weld`, `none` for not at all
    #[arg(long, value_name = "EPS", value_parser = reach, default_value = "0.0001%")]
    stitch: Reach,
    /// What becomes of faces that pass through each other
    #[arg(long, value_name = "HOW", default_value = "cut")]
    intersections: Crossing,
    /// Give up on intersections after N rounds
    #[arg(long, value_name = "N", default_value_t = 10)]
    max_rounds: usize,
    /// Cut out no more than this percentage of the faces
    #[arg(long, value_name = "PERCENT", value_parser = percentage, default_value = "30")]
    max_removed: f64,
    /// Collapse triangles whose longest edge is RATIO times as long as the shortest
    #[arg(long, value_name = "RATIO", value_parser = ratio, default_value = "10000")]
    needles: f64,
    /// Flip the longest edge of triangles with an angle of that many degrees
    #[arg(long, value_name = "DEGREES", value_parser = obtuse, default_value = "179.9")]
    caps: f64,
    /// Move the surface by no more than this percentage of the diagonal for needles and caps
    #[arg(long, value_name = "PERCENT", value_parser = percentage, default_value = "0.01")]
    max_move: f64,
    /// Keep only components with this percentage of the area of all
    #[arg(long, value_name = "PERCENT", value_parser = percentage, default_value = "0")]
    drop_area: f64,
    /// Keep only closed components with this percentage of the volume of the largest
    #[arg(long, value_name = "PERCENT", value_parser = percentage, default_value = "0")]
    drop_volume: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Way {
    /// As neighbors do, closed surfaces outward
    Outward,
    /// The same, and open surfaces towards where they are seen from
    Visible,
    /// As neighbors do
    Consistent,
    /// As they do; the surface is cut where neighbors disagree
    Keep,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Split {
    /// Faces that belong together stay in twos
    Pair,
    /// All faces are cut apart
    Cut,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Crossing {
    /// They are cut out, and the holes filled
    Cut,
    /// They stay, and are not looked for
    Keep,
}

/// How far apart rims that are joined may be.
#[derive(Clone, Copy, Debug)]
struct Reach(Option<Tolerance>);

impl Mending {
    pub(crate) fn options(&self) -> RepairOptions {
        RepairOptions {
            weld: self.weld,
            flat_faces: if self.drop_degenerate { FlatFaces::Remove } else { FlatFaces::Keep },
            orientation: match self.orient {
                Way::Outward | Way::Visible => Facing::Outward,
                Way::Consistent => Facing::Consistent,
                Way::Keep => Facing::Keep,
            },
            one_sided: if self.refuse_one_sided { OneSided::Refuse } else { OneSided::Cut },
            crowded_edges: match self.split_non_manifold {
                Split::Pair => CrowdedEdges::Pair,
                Split::Cut => CrowdedEdges::Cut,
            },
            opposite_faces: OppositeFaces::Keep,
            components: match (self.keep_largest, self.drop_small) {
                (Some(count), _) => KeepComponents::Largest(count),
                (None, Some(faces)) => KeepComponents::AtLeast(faces),
                (None, None) => KeepComponents::All,
            },
            hole_edges: self.fill_holes.unwrap_or(0),
            isolated_vertices: if self.keep_isolated {
                IsolatedVertices::Keep
            } else {
                IsolatedVertices::Drop
            },
        }
    }
}

impl Repair {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("repair", common);
        let mut document = session.read(&self.input)?;
        let path = &self.input.path;
        let (set, vertices, text, report) = if self.surface.minimal {
            let (set, report) = session
                .run("repairing", |progress| {
                    let options = self.mending.options();
                    let (set, report) = repair_faces(&document.set, &options, progress)?;
                    Ok::<_, dgp::mesh::Error>((set.into_owned(), report))
                })
                .map_err(|failure| failure.in_file(path))?;
            let (text, value) = (to_text(&report), to_json(&report));
            (set, report.vertices, text, value)
        } else {
            let (mesh, report) = session
                .run("repairing", |progress| {
                    repair_surface(&document.set, &self.options(), progress)
                })
                .map_err(|failure| failure.in_file(path))?;
            self.need_sound(&report).map_err(|failure| failure.in_file(path))?;
            let (text, value) = (surface_text(&report), surface_json(&report));
            let set = if report.is_unchanged() { document.set.clone() } else { mesh.to_indexed() };
            (set, report.vertices, text, value)
        };
        let summary = format!("{text}{} → {}", size(&document.set), size(&set));
        let lost = document.follow(set, &vertices);
        if lost > 0 {
            session.warn(format!("{lost} lines and points ended at vertices that were dropped"));
        }
        session.write(&self.output, &document)?;
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn options(&self) -> SurfaceRepairOptions {
        let surface = &self.surface;
        SurfaceRepairOptions {
            faces: RepairOptions {
                flat_faces: FlatFaces::Remove,
                opposite_faces: OppositeFaces::Remove,
                ..self.mending.options()
            },
            stitch: surface.stitch.0,
            components: LeastComponent {
                faces: 0,
                area: surface.drop_area,
                volume: surface.drop_volume,
            },
            holes: self.mending.fill_holes.map(|max_edges| FillOptions {
                max_edges,
                patch: Patch::Cover,
                ..FillOptions::default()
            }),
            slivers: Some(SliverOptions {
                needle_ratio: surface.needles,
                cap_angle: surface.caps.to_radians(),
                max_move: surface.max_move,
            }),
            intersections: (surface.intersections == Crossing::Cut).then(|| IntersectionOptions {
                max_rounds: surface.max_rounds,
                max_removed: surface.max_removed,
                ..IntersectionOptions::default()
            }),
            open_surfaces: match self.mending.orient {
                Way::Visible => OpenSurfaces::BySight,
                _ => OpenSurfaces::Keep,
            },
        }
    }

    /// Refuses a result in which faces still pass through each other.
    fn need_sound(&self, report: &SurfaceRepairReport) -> Result<(), Failure> {
        if report.is_sound() {
            return Ok(());
        }
        let cut = &report.intersections;
        if cut.left.is_empty() {
            return Err(Failure::Unrepaired(format!(
                "{} faces without area stay, since to remove them would break the manifold or move it too \
                 far; raise `--max-move`, or leave them with `--minimal`",
                report.flat_faces(),
            )));
        }
        let first = match cut.found.first() {
            Some([f, g]) => format!(", such as {f} with {g}"),
            None => String::new(),
        };
        Err(Failure::Unrepaired(format!(
            "{} pairs of faces pass through each other{first}, and {} are left after {} rounds of cutting \
             within {}% of the faces; raise `--max-rounds` or `--max-removed`, or leave all of them with \
             `--intersections keep`",
            report.meeting,
            cut.left.len(),
            cut.rounds,
            100.0 * self.surface.max_removed,
        )))
    }
}

fn size(set: &IndexedFaceSet) -> String {
    format!("{} vertices, {} faces", set.vertex_count(), set.face_count())
}

/// What was done to how many elements, a line each.
pub(crate) fn to_text(report: &RepairReport) -> String {
    let text = changes_text(report);
    if text.is_empty() { "nothing to repair: ".to_owned() } else { text }
}

fn changes_text(report: &RepairReport) -> String {
    const SHOWN: usize = 3;
    let mut text = String::new();
    for change in &report.changes {
        let (count, first) = (change.elements.len(), change.elements.first(SHOWN));
        let _ = writeln!(text, "{}: {first} ({count} in all)", sentence(change.action));
    }
    text
}

fn surface_text(report: &SurfaceRepairReport) -> String {
    let mut text = changes_text(&report.faces);
    let found = &report.intersections.found;
    if !found.is_empty() {
        let first = Elements::FacePairs(found.clone()).first(3);
        let _ = writeln!(text, "faces that met: {first} ({} pairs in all)", report.meeting);
    }
    for step in report.steps() {
        let _ = writeln!(text, "{}: {}", step.action.replace('_', " "), step.count);
    }
    if text.is_empty() { "nothing to repair: ".to_owned() } else { text }
}

pub(crate) fn to_json(report: &RepairReport) -> Value {
    json!({"changes": changes_json(report)})
}

fn changes_json(report: &RepairReport) -> Vec<Value> {
    let changes = report.changes.iter().map(|change| {
        json!({
            "step": change.action.step(),
            "action": change.action.name(),
            "count": change.elements.len(),
            "element_kind": element_kind(&change.elements),
            "elements": elements(&change.elements),
        })
    });
    changes.collect()
}

fn surface_json(report: &SurfaceRepairReport) -> Value {
    let mut changes = changes_json(&report.faces);
    changes.extend(
        report
            .steps()
            .into_iter()
            .map(|step| json!({"step": step.step, "action": step.action, "count": step.count})),
    );
    let cut = &report.intersections;
    json!({
        "changes": changes,
        "intersections": {
            "found": elements(&Elements::FacePairs(cut.found.clone())),
            "rounds": cut.rounds,
            "removed_faces": cut.removed,
            "added_faces": cut.added,
            "dropped_pieces": cut.pieces,
            "left": elements(&Elements::FacePairs(cut.left.clone())),
        },
        "slivers_left": elements(&Elements::Faces(report.slivers.left.clone())),
    })
}

/// An action in words.
pub(crate) fn sentence(action: RepairAction) -> String {
    action.name().replace('_', " ")
}

/// 0, a length, or a percentage of the diagonal.
pub(super) fn tolerance(text: &str) -> Result<Tolerance, String> {
    let (number, is_percentage) = match text.strip_suffix('%') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(0.0) => Ok(Tolerance::Exact),
        Ok(x) if x > 0.0 && x.is_finite() && is_percentage => Ok(Tolerance::OfDiagonal(x / 100.0)),
        Ok(x) if x > 0.0 && x.is_finite() => Ok(Tolerance::Distance(x)),
        _ => Err("a tolerance is 0, a length, or a percentage of the diagonal".to_owned()),
    }
}

fn reach(text: &str) -> Result<Reach, String> {
    match text {
        "none" => Ok(Reach(None)),
        _ => tolerance(text).map(|tolerance| Reach(Some(tolerance))),
    }
}

/// A percentage from 0 to 100, as a fraction.
fn percentage(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').unwrap_or(text).trim().parse::<f64>().ok();
    let number = number.filter(|x| (0.0..=100.0).contains(x));
    number.map(|x| x / 100.0).ok_or_else(|| format!("`{text}` is no percentage from 0 to 100"))
}

fn ratio(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| *x >= 1.0);
    number.ok_or_else(|| format!("`{text}` is no number from 1"))
}

fn obtuse(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| (90.0..=180.0).contains(x));
    number.ok_or_else(|| format!("`{text}` is no angle from 90 to 180 degrees"))
}
