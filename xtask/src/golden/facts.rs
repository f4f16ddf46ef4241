//! What is known of one input: a report of single values, and columns with a number or three per
//! vertex, face or corner. Ours and the peers' have the same names.

use std::{collections::BTreeMap, fs, path::Path};

use dgp_mesh::{
    DVec3, Error, HalfedgeId, IndexedFaceSet, Mesh, NotManifold, VertexMap,
    measure::{self, NormalWeight, vertex_normals},
    topology,
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
        let corners = mesh.faces().flat_map(|f| mesh.face_halfedges(f));
        facts
            .columns
            .insert("corner_angles".into(), corners.map(|h: HalfedgeId| angles[h]).collect());
        facts.value("area", measure::area(&mesh));
        if report.closed {
            facts.value("volume", measure::volume(&mesh));
        }
    }
    facts
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
        let answer = driver.call(operation, input, &["--out", &prefix.to_string_lossy()])?;
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
