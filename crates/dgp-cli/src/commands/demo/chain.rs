//! One scan through all stages.

use std::path::Path;

use dgp::{
    io::Document,
    laplace::smooth::{TaubinOptions, taubin},
    mesh::{
        DVec3, Defect, DefectKind, DefectReport, Elements, IndexedFaceSet, Mesh, RepairOptions,
        RepairReport, Severity, Tolerance, VertexId, VertexMap, VertexSet, defects, repair,
    },
    view::{
        Mark, Marked, Model, Paint, Panel, RenderOptions, Scene, Stroke, Style, attribute_paint,
        render,
    },
};
use serde_json::{Value, json};

use super::super::{check, info::Facts, render::vertex_scalars, repair as mending};
use crate::{failure::Failure, session::Session};

/// How often the demo smooths.
const ITERATIONS: usize = 10;
/// Holes of up to this many edges are filled.
const HOLE_EDGES: usize = 500;
/// Pixels of a picture of one stage.
const STAGE_SIZE: (u32, u32) = (900, 720);
/// Pixels of the picture of all stages.
const OVERVIEW_SIZE: (u32, u32) = (2000, 460);

/// What became of one scan.
#[derive(Debug)]
pub(super) struct Chain {
    pub(super) name: String,
    pub(super) sentence: String,
    /// The picture of all stages.
    pub(super) overview: String,
    pub(super) stages: Vec<Stage>,
    report: Value,
}

/// One stage, with the names of its files.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) title: String,
    pub(super) sentence: String,
    pub(super) picture: String,
    pub(super) files: Vec<String>,
    pub(super) facts: Vec<(String, String)>,
}

/// Where and under which name a chain writes.
struct Place<'a> {
    folder: &'a Path,
    name: &'a str,
}

impl Chain {
    /// Checks, mends and smooths `scan`, and writes each stage with a picture into `folder`.
    pub(super) fn run(
        session: &mut Session<'_>,
        folder: &Path,
        name: &str,
        mut scan: Document,
    ) -> Result<Self, Failure> {
        let place = Place { folder, name };
        let scan_file = place.mesh(session, "1-scan.ply", &scan)?;
        let scan_facts = Facts::of(&scan.set);
        let found = session.run("checking", |progress| defects(&scan.set, progress))?;

        let options = RepairOptions {
            weld: Some(Tolerance::Exact),
            hole_edges: HOLE_EDGES,
            ..RepairOptions::default()
        };
        let (mut mesh, repaired) =
            session.run("repairing", |progress| repair(&scan.set, &options, progress))?;
        let mended_set = mesh.to_indexed();
        let mended_facts = Facts::of(&mended_set);
        let original = scan.set.clone();
        scan.follow(mended_set.clone(), &repaired.vertices);
        let mended_file = place.mesh(session, "3-mended.ply", &scan)?;

        let before = mesh.positions().clone();
        let options = TaubinOptions { iterations: ITERATIONS, ..TaubinOptions::default() };
        let smoothed = session.run("smoothing", |progress| {
            taubin(&mut mesh, &VertexSet::new(), &options, progress)
        })?;
        let moved = distances(&before, &mesh);
        let smooth_set = mesh.to_indexed();
        let smooth_facts = Facts::of(&smooth_set);
        scan.set = smooth_set.clone();
        let smooth_files = ["ply", "obj", "off", "stl"]
            .map(|format| place.mesh(session, &format!("4-smooth.{format}"), &scan));
        let smooth_files = smooth_files.into_iter().collect::<Result<Vec<_>, _>>()?;

        let models = [
            ("scan", Model { style: colored(&original), ..Model::new(&original) }),
            ("defects", Model { style: marked(&found), ..Model::new(&original) }),
            ("mended", Model::new(&mended_set)),
            ("smooth", Model::new(&smooth_set)),
            ("moved", Model { style: painted(moved, "moved"), ..Model::new(&smooth_set) }),
        ];
        let mut pictures = Vec::new();
        for (k, (title, model)) in models.iter().enumerate() {
            let file = format!("{}-{title}.png", k + 1);
            let scene = Scene::new(model.clone());
            pictures.push(place.picture(session, &file, &scene, STAGE_SIZE)?);
        }
        let panels = models.into_iter().map(|(title, model)| Panel::new(title, model)).collect();
        let overview = place.picture(session, "overview.png", &Scene { panels }, OVERVIEW_SIZE)?;

        let report = json!({
            "name": name,
            "scan": scan_facts.to_json(&Document::from(original)),
            "check": check::to_json(&found),
            "repair": mending::to_json(&repaired),
            "mended": mended_facts.to_json(&Document::from(mended_set)),
            "smooth": smooth_facts.to_json(&scan),
            "moved": {"mean": smoothed.mean_displacement, "max": smoothed.max_displacement},
        });
        let report_file = place.file("report.json");
        session.store(&place.folder.join(&report_file), format!("{report:#}\n").as_bytes())?;

        let worst: usize = found.of(Severity::Error).map(Defect::count).sum();
        let sentence = format!(
            "{} faces, {worst} errors; mended: {}; {}",
            scan_facts.topology.faces,
            if mended_facts.topology.closed { "closed" } else { "open" },
            if mended_facts.topology.manifold { "an oriented manifold" } else { "not manifold" },
        );
        let texts = [
            ("Scan", "As it came, in its own colors.".to_owned(), facts(&scan_facts)),
            (
                "Defects",
                "Red: edges and vertices that are wrong, and rims.".to_owned(),
                listed(&found),
            ),
            (
                "Mended",
                "Welded, turned, taken apart, holes filled.".to_owned(),
                changed(&repaired, &mended_facts),
            ),
            (
                "Smooth",
                format!("Taubin, {} iterations; also as OBJ, OFF and STL.", smoothed.iterations),
                facts(&smooth_facts),
            ),
            (
                "Moved",
                "How far each vertex went.".to_owned(),
                vec![
                    ("mean".to_owned(), format!("{:.3e}", smoothed.mean_displacement)),
                    ("most".to_owned(), format!("{:.3e}", smoothed.max_displacement)),
                ],
            ),
        ];
        let files = [vec![scan_file], vec![report_file], vec![mended_file], smooth_files, vec![]];
        let stages = texts.into_iter().zip(files).zip(pictures).map(
            |(((title, sentence, facts), files), picture)| Stage {
                title: title.to_owned(),
                sentence,
                picture,
                files,
                facts,
            },
        );
        Ok(Chain { name: name.to_owned(), sentence, overview, stages: stages.collect(), report })
    }

    pub(super) fn to_json(&self) -> Value {
        self.report.clone()
    }
}

impl Place<'_> {
    fn file(&self, file: &str) -> String {
        format!("{}-{file}", self.name)
    }

    fn mesh(
        &self,
        session: &mut Session<'_>,
        file: &str,
        document: &Document,
    ) -> Result<String, Failure> {
        let file = self.file(file);
        session.write_stage(&self.folder.join(&file), document)?;
        Ok(file)
    }

    fn picture(
        &self,
        session: &mut Session<'_>,
        file: &str,
        scene: &Scene<'_>,
        (width, height): (u32, u32),
    ) -> Result<String, Failure> {
        let options = RenderOptions { width, height, ..RenderOptions::default() };
        let png = session.run("drawing", |progress| {
            Ok::<_, dgp::view::Error>(render(scene, &options, progress)?.0.to_png())
        })?;
        let file = self.file(file);
        session.store(&self.folder.join(&file), &png)?;
        Ok(file)
    }
}

/// In the colors of the file, if it has any.
fn colored(set: &IndexedFaceSet) -> Style {
    let paint = attribute_paint(set.into(), dgp::mesh::COLOR).unwrap_or_default();
    Style { paint, ..Style::default() }
}

/// With wrong edges and vertices, and rims, in red.
fn marked(found: &DefectReport) -> Style {
    let mut marks = Vec::new();
    for defect in &found.defects {
        let elements = match &defect.elements {
            Elements::Edges(edges) => Marked::Segments(edges.clone()),
            Elements::Loops(loops) => Marked::Segments(loops.iter().flat_map(rim).collect()),
            Elements::Vertices(list) if defect.kind == DefectKind::NonManifoldVertex => {
                Marked::Vertices(list.iter().copied().collect())
            }
            _ => continue,
        };
        marks.push(Mark::new(elements));
    }
    Style { marks, wireframe: Stroke::NONE, ..Style::default() }
}

/// The edges of a closed chain of vertices.
fn rim(vertices: &[VertexId]) -> Vec<[VertexId; 2]> {
    let following = vertices.iter().cycle().skip(1);
    vertices.iter().zip(following).map(|(&v, &w)| [v, w]).collect()
}

fn painted(values: VertexMap<f64>, label: &str) -> Style {
    let paint: Paint = vertex_scalars(values, label);
    Style { paint, ..Style::default() }
}

/// How far each vertex is from where it was.
fn distances(before: &VertexMap<DVec3>, mesh: &Mesh) -> VertexMap<f64> {
    mesh.map_vertices(|v| mesh.position(v).distance(before[v]))
}

/// A few facts in words.
fn facts(facts: &Facts) -> Vec<(String, String)> {
    let topology = &facts.topology;
    let row = |name: &str, value: String| (name.to_owned(), value);
    vec![
        row("vertices", topology.vertices.to_string()),
        row("faces", topology.faces.to_string()),
        row("components", topology.components.len().to_string()),
        row("holes", topology.boundary_loops.to_string()),
        row("genus", topology.genus.map_or("none".to_owned(), |genus| genus.to_string())),
        row("volume", facts.volume.map_or("none".to_owned(), |volume| format!("{volume:.6}"))),
    ]
}

/// Each kind of defect and how often it occurs.
fn listed(found: &DefectReport) -> Vec<(String, String)> {
    let row = |defect: &Defect| (defect.kind.name().replace('_', " "), defect.count().to_string());
    found.defects.iter().map(row).collect()
}

/// Each change and to how many elements, then the facts.
fn changed(report: &RepairReport, after: &Facts) -> Vec<(String, String)> {
    let changes = report.changes.iter();
    let mut rows: Vec<_> = changes
        .map(|change| (mending::sentence(change.action), change.elements.len().to_string()))
        .collect();
    rows.extend(facts(after));
    rows
}
