//! `dgp info`: topology, geometry and quality of a whole, and what is around single elements.

mod euler;
pub(super) mod query;
mod values;

use std::{fmt::Write, process::ExitCode};

use clap::Args;
use dgp::{
    io::Document,
    mesh::{
        AttributeTable, Id, IndexedFaceSet, Progress,
        measure::{self, BoundingBox},
        topology::{self, TopologyReport},
    },
};
use serde_json::{Value, json};

use self::query::Queries;
use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// Options of `dgp info`.
#[derive(Debug, Args)]
pub(crate) struct Info {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    queries: Queries,
    /// What Euler's formula says: whether it is a regular solid, Σ (6 − k) F(k), whether its edges can be
    /// drawn in the plane or why not, how many colors its vertices need
    #[arg(long)]
    euler: bool,
}

impl Info {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("info", common);
        let document = session.read(&self.input)?;
        let facts = session.run("measuring", |_| Ok::<_, Failure>(Facts::of(&document.set)))?;
        let mut report = facts.to_json(&document);
        let mut text = facts.to_text(&document);
        if self.euler || !self.queries.is_empty() {
            let mesh = session.mesh(&self.input, &document)?;
            if self.euler {
                let work = |progress: Progress<'_>| euler::facts(&mesh, progress);
                let (facts, lines) = session.run("drawing edges", work)?;
                report["euler"] = facts;
                text += &lines;
            }
            let (answers, lines) =
                self.queries.answers(&mesh).map_err(|e| e.in_file(&self.input.path))?;
            if !self.queries.is_empty() {
                report["queries"] = answers;
                text += &lines;
            }
        }
        session.finish(&text, &report)?;
        Ok(ExitCode::SUCCESS)
    }
}

/// What can be said of a face set, manifold or not.
#[derive(Debug)]
pub(crate) struct Facts {
    pub(crate) topology: TopologyReport,
    area: f64,
    /// Only where the faces enclose one.
    pub(crate) volume: Option<f64>,
    bounding_box: Option<BoundingBox>,
    edge_length: Option<measure::Range>,
    minimum_angle: Option<f64>,
}

impl Facts {
    pub(crate) fn of(set: &IndexedFaceSet) -> Self {
        let topology = topology::topology_report(set);
        let volume = (topology.watertight && topology.faces > 0).then(|| measure::volume(set));
        Facts {
            topology,
            area: measure::area(set),
            volume,
            bounding_box: measure::bounding_box(set),
            edge_length: measure::face_set_edge_length_range(set),
            minimum_angle: measure::minimum_angle(set),
        }
    }

    pub(crate) fn to_json(&self, document: &Document) -> Value {
        let topology = &self.topology;
        let has_faces = topology.faces > 0;
        let valence: serde_json::Map<String, Value> =
            topology.valence.iter().map(|(k, &count)| (k.to_string(), count.into())).collect();
        let components: Vec<Value> = topology
            .components
            .iter()
            .map(|component| {
                json!({
                    "vertices": component.vertices,
                    "edges": component.edges,
                    "faces": component.faces,
                    "boundary_loops": component.boundary_loops,
                    "euler_characteristic": component.euler_characteristic,
                    "genus": component.genus,
                })
            })
            .collect();
        json!({
            "vertices": topology.vertices,
            "isolated_vertices": topology.isolated_vertices,
            "edges": topology.edges,
            "faces": topology.faces,
            "triangles": topology.triangles,
            "quads": topology.quads,
            "polygons": topology.polygons,
            "degenerate_faces": topology.degenerate_faces,
            "components": topology.components.len(),
            "component_list": components,
            "boundary_edges": topology.boundary_edges,
            "boundary_loops": has_faces.then_some(topology.boundary_loops),
            "non_manifold_edges": topology.non_manifold_edges,
            "non_manifold_vertices": topology.non_manifold_vertices,
            "flipped_edges": topology.flipped_edges,
            "euler_characteristic": has_faces.then_some(topology.euler_characteristic),
            "genus": topology.genus.filter(|_| has_faces),
            "closed": has_faces.then_some(topology.closed),
            "watertight": has_faces.then_some(topology.watertight),
            "manifold": has_faces.then_some(topology.manifold),
            "oriented": has_faces.then_some(topology.oriented),
            "orientable": has_faces.then_some(topology.orientable),
            "regular": topology.regular,
            "area": has_faces.then_some(self.area),
            "volume": self.volume,
            "bounding_box": self.bounding_box.map(|b| json!({
                "min": b.min.to_array(), "max": b.max.to_array(), "diagonal": b.diagonal(),
            })),
            "edge_length": self.edge_length.map(|l| json!({"min": l.min, "mean": l.mean, "max": l.max})),
            "minimum_angle": self.minimum_angle.map(f64::to_degrees),
            "valence": valence,
            "attributes": attributes(document),
        })
    }

    fn to_text(&self, document: &Document) -> String {
        let mut text = String::new();
        let topology = &self.topology;
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<18} {value}");
        };
        let mut faces = topology.faces.to_string();
        if topology.faces > 0 {
            let kinds = [
                (topology.triangles, "triangles"),
                (topology.quads, "quads"),
                (topology.polygons, "larger polygons"),
                (topology.degenerate_faces, "degenerate"),
            ];
            let kinds = kinds.iter().filter(|(count, _)| *count > 0);
            let kinds: Vec<String> = kinds.map(|(count, kind)| format!("{count} {kind}")).collect();
            faces = format!("{faces} ({})", kinds.join(", "));
        }
        let mut vertices = topology.vertices.to_string();
        if topology.isolated_vertices > 0 && topology.faces > 0 {
            vertices = format!("{vertices} ({} of no face)", topology.isolated_vertices);
        }
        line("vertices", vertices);
        line("edges", topology.edges.to_string());
        line("faces", faces);
        if topology.faces > 0 {
            line("components", topology.components.len().to_string());
            line(
                "boundary loops",
                format!("{} ({} edges)", topology.boundary_loops, topology.boundary_edges),
            );
            line("Euler char.", topology.euler_characteristic.to_string());
            line("genus", topology.genus.map_or("none".to_owned(), |genus| genus.to_string()));
            line("properties", self.properties().join(", "));
            let problems = [
                (topology.non_manifold_edges, "non-manifold edges"),
                (topology.non_manifold_vertices, "non-manifold vertices"),
                (topology.flipped_edges, "flipped edges"),
            ];
            let problems = problems.iter().filter(|(count, _)| *count > 0);
            let problems: Vec<String> =
                problems.map(|(count, kind)| format!("{count} {kind}")).collect();
            if !problems.is_empty() {
                line("problems", problems.join(", "));
            }
            line("area", self.area.to_string());
        }
        if let Some(volume) = self.volume {
            line("volume", volume.to_string());
        }
        if let Some(b) = self.bounding_box {
            line("bounding box", format!("{} … {}", point(b.min), point(b.max)));
            line("diagonal", b.diagonal().to_string());
        }
        if let Some(l) = self.edge_length {
            line("edge length", format!("{} … {}, mean {}", l.min, l.max, l.mean));
        }
        if let Some(angle) = self.minimum_angle {
            line("smallest angle", format!("{:.4}°", angle.to_degrees()));
        }
        if !topology.valence.is_empty() {
            let most: Vec<String> =
                topology.valence.iter().map(|(k, count)| format!("{k}: {count}")).collect();
            line("valence", shortened(&most, 12));
        }
        for (element, names) in attribute_names(document) {
            line(&format!("{element} data"), names.join(", "));
        }
        text
    }

    fn properties(&self) -> Vec<&'static str> {
        let topology = &self.topology;
        let word = |is: bool, yes, no| if is { yes } else { no };
        vec![
            word(topology.closed, "closed", "open"),
            word(topology.manifold, "manifold", "not manifold"),
            word(topology.oriented, "oriented", "not oriented"),
            word(topology.orientable, "orientable", "not orientable"),
            word(topology.connected, "connected", "not connected"),
        ]
    }
}

/// The first `most` entries, and how many more there are.
fn shortened(entries: &[String], most: usize) -> String {
    match entries.len().checked_sub(most) {
        None | Some(0) => entries.join(", "),
        Some(more) => format!("{}, {more} more", entries[..most].join(", ")),
    }
}

fn point(p: dgp::mesh::DVec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

/// The names of the attributes on each kind of element that has any.
fn attribute_names(document: &Document) -> Vec<(&'static str, Vec<String>)> {
    fn names<I: Id>(table: &AttributeTable<I>) -> Vec<String> {
        table.names().map(str::to_owned).collect()
    }
    let set = &document.set;
    let mut tables = vec![
        ("vertex", names(&set.vertex_attributes)),
        ("corner", names(&set.corner_attributes)),
        ("face", names(&set.face_attributes)),
    ];
    tables.retain(|(_, names)| !names.is_empty());
    tables
}

fn attributes(document: &Document) -> Value {
    let tables = attribute_names(document).into_iter();
    tables.map(|(element, names)| (element.to_owned(), Value::from(names))).collect()
}
