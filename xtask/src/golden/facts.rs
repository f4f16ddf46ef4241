//! What is known of one input: a report of single values, and columns with a number or three per
//! vertex, face or corner. Ours and the peers' have the same names.

use std::{collections::BTreeMap, fs, path::Path};

use dgp_mesh::{
    CrowdedEdges, DVec3, Error, Facing, HalfedgeId, IndexedFaceSet, IsolatedVertices, Mesh,
    NotManifold, Progress, RepairOptions, VertexId, VertexMap,
    graph::{Until, dijkstra},
    measure::{self, NormalWeight, vertex_normals},
    repair, topology,
};
use serde_json::{Map, Value, json};

use crate::{peers::Driver, raw, shell::Outcome};

/// Single values and columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    pub(crate) values: Map<String, Value>,
    pub(crate) columns: BTreeMap<String, Vec<f64>>,
    /// Why we refused the faces, if we did.
    pub(crate) refusal: Option<NotManifold>,
}

/// Our facts of `set`.
pub(crate) fn ours(set: &IndexedFaceSet) -> Facts {
    let mut facts = Facts::default();
    let mesh = match Mesh::new(set) {
        Ok(mesh) => mesh,
        Err(error) => {
            facts.value("accepted", false);
            if let Error::NotManifold(reason) = error {
                facts.refusal = Some(reason);
            }
            return facts;
        }
    };
    facts.value("accepted", true);
    facts.value("vertices", mesh.vertex_count());
    facts.value("edges", mesh.edge_count());
    facts.value("faces", mesh.face_count());
    let mut loops: Vec<usize> = topology::boundary_loops(&mesh).iter().map(Vec::len).collect();
    loops.sort_unstable();
    facts.value("boundary_loops", loops);
    let report = topology::topology_report(set);
    facts.value("components", report.components.len());
    facts.value("euler_characteristic", report.euler_characteristic);
    facts.value("genus", report.genus);
    facts.value("rings", ring_hash(&mesh));

    facts.vectors("face_normals", measure::face_normals(&mesh).values());
    if set.faces().is_triangles() {
        facts.columns.insert("face_areas".into(), measure::face_areas(&mesh).into_values());
        for (name, weight) in [
            ("vertex_normals_area", NormalWeight::Area),
            ("vertex_normals_angle", NormalWeight::Angle),
            ("vertex_normals_max", NormalWeight::Max),
        ] {
            facts.vectors(name, vertex_normals(&mesh, weight).values());
        }
        let angles = measure::corner_angles(&mesh);
        let corners: Vec<HalfedgeId> = mesh.faces().flat_map(|f| mesh.face_halfedges(f)).collect();
        let mut column = |name: &str, f: &dyn Fn(HalfedgeId) -> f64| {
            facts.columns.insert(name.into(), corners.iter().map(|&h| f(h)).collect());
        };
        column("corner_angles", &|h| angles[h]);
        // Ours is of the angle opposite a half-edge.
        column("corner_cotangents", &|h| mesh.cotangent(mesh.next(h)));
        facts.value("area", measure::area(&mesh));
        if report.closed {
            facts.value("volume", measure::volume(&mesh));
        }
    }
    facts
}

/// Our distances along edges from the first vertex; -1 where no path leads.
pub(crate) fn distances(set: &IndexedFaceSet, facts: &mut Facts) -> Outcome<()> {
    let mesh = Mesh::new(set)?;
    let (lengths, start) = (measure::edge_lengths(&mesh), VertexId::new(0));
    let found = dijkstra(&mesh, &lengths, &[start], Until::AllReached, Progress::NONE)?;
    let distances = found.distance.map(|&d| if d.is_finite() { d } else { -1.0 });
    facts.columns.insert("distances".into(), distances.into_values());
    Ok(())
}

/// Our repair of faces that make no mesh, with the choices that CGAL makes: as many faces as before, all
/// cut apart at edges that more than two share.
pub(crate) fn repaired(set: &IndexedFaceSet) -> Outcome<(Facts, Mesh)> {
    let options = RepairOptions {
        orientation: Facing::Consistent,
        crowded_edges: CrowdedEdges::Cut,
        isolated_vertices: IsolatedVertices::Keep,
        ..RepairOptions::default()
    };
    let (mesh, _) = repair(set, &options, Progress::NONE)?;
    let mut facts = Facts::default();
    facts.value("repaired_points", mesh.vertex_count());
    facts.value("repaired_edges", mesh.edge_count());
    facts.value("repaired_faces", mesh.face_count());
    let mut loops: Vec<usize> = topology::boundary_loops(&mesh).iter().map(Vec::len).collect();
    loops.sort_unstable();
    facts.value("repaired_boundary", loops);
    facts.value("repaired_components", topology::components(&mesh).count);
    Ok((facts, mesh))
}

/// CGAL's repair, by the same names, and the faces it made.
pub(crate) fn their_repair(driver: &Driver, input: &Path) -> Outcome<(Facts, IndexedFaceSet)> {
    let prefix = input.with_extension("repaired");
    let answer = driver.call("repair", input, &["--out", &prefix.to_string_lossy()])?;
    let mut facts = Facts::default();
    for (name, theirs) in [
        ("repaired_points", "vertices"),
        ("repaired_edges", "edges"),
        ("repaired_faces", "faces"),
        ("repaired_boundary", "boundary_loops"),
        ("repaired_components", "components"),
    ] {
        facts.value(name, answer[theirs].clone());
    }
    let path = prefix.with_extension("repaired.raw");
    let set = raw::read(&path)?;
    fs::remove_file(path)?;
    Ok((facts, set))
}

/// What a peer says of the mesh in `input`; columns go through files beside it.
pub(crate) fn theirs(driver: &Driver, input: &Path, set: &IndexedFaceSet) -> Outcome<Facts> {
    let prefix = input.with_extension(if driver.name == "CGAL" { "cgal" } else { "openmesh" });
    let mut facts = Facts::default();
    facts.add(driver, "facts", input, &prefix)?;
    facts.derive(set);
    Ok(facts)
}

impl Facts {
    fn value(&mut self, name: &str, value: impl Into<Value>) {
        self.values.insert(name.into(), value.into());
    }

    fn vectors(&mut self, name: &str, vectors: &[DVec3]) {
        self.columns.insert(name.into(), vectors.iter().flat_map(DVec3::to_array).collect());
    }

    /// Adds the answer of a driver to one operation.
    pub(crate) fn add(
        &mut self,
        driver: &Driver,
        operation: &str,
        input: &Path,
        prefix: &Path,
    ) -> Outcome<()> {
        self.add_with(driver, operation, input, prefix, &[])
    }

    /// The same with more options.
    pub(crate) fn add_with(
        &mut self,
        driver: &Driver,
        operation: &str,
        input: &Path,
        prefix: &Path,
        options: &[&str],
    ) -> Outcome<()> {
        let out = prefix.to_string_lossy();
        let answer = driver.call(operation, input, &[&["--out", &out], options].concat())?;
        let measured = ["ms", "cpu_ms", "peak_bytes"];
        let values = answer.as_object().cloned().unwrap_or_default();
        self.values
            .extend(values.into_iter().filter(|(name, _)| !measured.contains(&name.as_str())));
        let folder = prefix.parent().expect("a file has a folder");
        let start =
            format!("{}.", prefix.file_name().expect("a file has a name").to_string_lossy());
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let column = name.strip_prefix(&start).and_then(|rest| rest.strip_suffix(".f64"));
            if let Some(column) = column {
                self.columns.insert(column.into(), raw::doubles(&fs::read(&path)?));
                fs::remove_file(&path)?;
            }
        }
        Ok(())
    }

    /// Euler characteristic and genus, which no peer reports, from what it counts.
    fn derive(&mut self, set: &IndexedFaceSet) {
        let number = |name: &str| self.values.get(name).and_then(Value::as_f64);
        let (Some(v), Some(e), Some(f)) = (number("vertices"), number("edges"), number("faces"))
        else {
            return;
        };
        let mut used: VertexMap<bool> = VertexMap::filled(set.vertex_count(), false);
        for &vertex in set.faces().corners() {
            used[vertex] = true;
        }
        let isolated = used.values().iter().filter(|used| !**used).count() as f64;
        let characteristic = v - isolated - e + f;
        let holes =
            self.values.get("boundary_loops").and_then(Value::as_array).map_or(0, Vec::len) as f64;
        let components = number("components").unwrap_or(0.0);
        self.value("euler_characteristic", characteristic);
        self.value("genus", (2.0 * components - holes - characteristic) / 2.0);
    }

    /// As stored under tests/golden/.
    pub(crate) fn to_json(&self) -> Value {
        json!({"values": self.values, "columns": self.columns})
    }

    /// From what [`Facts::to_json`] gave.
    pub(crate) fn from_json(value: &Value) -> Outcome<Facts> {
        Ok(Facts {
            values: value["values"].as_object().cloned().unwrap_or_default(),
            columns: serde_json::from_value(value["columns"].clone())?,
            refusal: None,
        })
    }
}

/// Hash of all one-rings that depends neither on the order of the vertices nor on where a ring starts:
/// the same as in `xtask/reference/protocol.hpp`.
fn ring_hash(mesh: &Mesh) -> String {
    let mut ring = Vec::new();
    let mut sum = 0_u64;
    for v in mesh.vertices() {
        ring.clear();
        ring.extend(mesh.vertex_neighbors(v).map(|w| w.index() as u32));
        let least = ring.iter().enumerate().min_by_key(|(_, w)| **w).map_or(0, |(i, _)| i);
        ring.rotate_left(least);
        let bytes = std::iter::once(v.index() as u32)
            .chain(ring.iter().copied())
            .flat_map(u32::to_le_bytes);
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        });
        sum = sum.wrapping_add(hash);
    }
    format!("{sum:016x}")
}
