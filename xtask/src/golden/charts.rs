//! Texture coordinates with seams beside OpenSubdiv's face-varying data: the same charts, each rule.
//!
//! Vertices and faces are matched as in `refined`; then each corner must have the same value.

use std::{collections::HashMap, fmt::Write, fs, path::Path};

use dgp_mesh::{DVec2, DVec3, HalfedgeId, Mesh, Progress, UV, VertexId, shapes};
use dgp_subdiv::{
    BoundaryRule, FaceVarying, RefinementOptions, Sharpness, SubdivisionOptions, subdivide,
};

use super::{
    Facts, Table, Verdict,
    compare::{Comparison, TOLERANCE},
    refined::{Cage, Matching, listed, meshes, rotated, some_sharpness},
};
use crate::{drive::subdivision::scheme, peers::Driver, raw, shell::Outcome};

/// Quantities, how the driver calls the rules of OpenSubdiv, and ours.
const RULES: [(&str, &str, FaceVarying); 6] = [
    ("face_varying_all", "all", FaceVarying::Linear),
    ("face_varying_corners_only", "corners-only", FaceVarying::Smooth),
    ("face_varying_none", "none", FaceVarying::SmoothCorners),
    ("face_varying_corners_plus_1", "corners-plus-1", FaceVarying::SharpJunctions),
    ("face_varying_corners_plus_2", "corners-plus-2", FaceVarying::SharpEnds),
    ("face_varying_boundaries", "boundaries", FaceVarying::SharpRims),
];

/// Rules with which creases in one of two charts sharpen the other one too; docs/book/golden.md has more.
const DEPENDENT: [&str; 2] = ["corners-plus-1", "corners-plus-2"];

/// A mesh with its seams: corners around a vertex share a value between marked edges.
struct Charts {
    /// The value of each half-edge's corner.
    number: Vec<usize>,
    values: Vec<DVec2>,
}

impl Charts {
    /// Marks so many edges of a hundred.
    fn new(mesh: &Mesh, percent: u64) -> Self {
        let is_marked = |h: HalfedgeId| {
            let e = h.edge();
            mesh.is_boundary_edge(e) || noise(e.index() as u64) % 100 < percent
        };
        let mut charts = Charts { number: vec![0; mesh.halfedge_count()], values: Vec::new() };
        for v in mesh.vertices() {
            // Clockwise a half-edge follows its face, counterclockwise its face follows it.
            let mut around: Vec<HalfedgeId> = mesh.vertex_halfedges(v).collect();
            around.retain(|&h| !mesh.is_boundary_halfedge(h));
            let first = around.iter().position(|&h| is_marked(h)).unwrap_or(0);
            around.rotate_left(first);
            for (k, h) in around.into_iter().enumerate() {
                if k == 0 || is_marked(h) {
                    let n = charts.values.len() as u64;
                    let [x, y] = [2 * n, 2 * n + 1].map(|k| (noise(k) >> 40) as f64 / 16_777_216.0);
                    let p = mesh.position(v);
                    charts.values.push(DVec2::new(p.x + x, p.y + p.z / 2.0 + y));
                }
                charts.number[h.index()] = charts.values.len() - 1;
            }
        }
        charts
    }

    /// As lines for the driver, corner by corner of the faces.
    fn tags(&self, mesh: &Mesh, rule: &str) -> Outcome<String> {
        let mut text = format!("fvar {rule}\n");
        for value in &self.values {
            writeln!(text, "uv {:?} {:?}", value.x, value.y)?;
        }
        for f in mesh.faces() {
            // In the order of the list of faces.
            for v in mesh.face_vertices(f) {
                let h = mesh.face_halfedges(f).find(|&h| mesh.from(h) == v).ok_or("no corner")?;
                writeln!(text, "corner_uv {}", self.number[h.index()])?;
            }
        }
        Ok(text)
    }
}

/// The same numbers everywhere.
fn noise(k: u64) -> u64 {
    let x = (k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^ (x >> 27)
}

/// Compares all rules on all cages.
pub(super) fn compare(driver: &Driver, folder: &Path, table: &mut Table) -> Outcome<()> {
    for (name, quads) in [("loop", false), ("catmull-clark", true)] {
        let mut cages = meshes(quads)?;
        if quads {
            cages.push(("grid", shapes::with_noise(shapes::grid(8, 7)?, 0.05, 1)?));
        }
        for (shape, mesh) in cages {
            for percent in [15, 50] {
                let charts = Charts::new(&mesh, percent);
                for (kind, boundary) in
                    [("edge", BoundaryRule::EdgeOnly), ("corner", BoundaryRule::EdgeAndCorner)]
                {
                    for sharpness in [Sharpness::new(), some_sharpness(&mesh)] {
                        let tags = if sharpness.is_smooth() { "smooth" } else { "creased" };
                        let name_of = format!("{shape}-{percent}-{kind}-{tags}");
                        let cage = Cage { name: name_of, mesh: mesh.clone(), sharpness, boundary };
                        for (rule, levels) in RULES.iter().flat_map(|r| [(r, 1), (r, 3)]) {
                            let found = one(&cage, &charts, (name, levels), rule, driver, folder);
                            let label = format!("{}, {levels} levels", cage.name);
                            table.add(&label, "OpenSubdiv", vec![found?]);
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

fn one(
    cage: &Cage,
    charts: &Charts,
    (name, levels): (&str, usize),
    &(quantity, rule, face_varying): &(&str, &str, FaceVarying),
    driver: &Driver,
    folder: &Path,
) -> Outcome<Comparison> {
    let path = folder.join("cage.raw");
    raw::write(&path, &cage.mesh.to_indexed())?;
    let tags = folder.join("cage.tags");
    fs::write(&tags, cage.tags()? + &charts.tags(&cage.mesh, rule)?)?;
    let (count, tag_file) = (levels.to_string(), tags.to_string_lossy());
    let options = ["--scheme", name, "--levels", &count, "--tags", &tag_file];
    let mut facts = Facts::default();
    facts.add_with(driver, "subdivide", &path, &folder.join("refined"), &options)?;
    let theirs = raw::read(&folder.join("refined.raw"))?;
    let numbers = facts.columns.get("uv").ok_or("OpenSubdiv told no texture coordinates")?;
    let their_uv: Vec<DVec2> = numbers.chunks_exact(2).map(DVec2::from_slice).collect();

    let mut mesh = cage.mesh.clone();
    let uv: Vec<DVec2> = charts.number.iter().map(|&n| charts.values[n]).collect();
    mesh.attributes_mut().corner.insert(UV, uv);
    let boundary = cage.boundary;
    let refinement =
        RefinementOptions { scheme: scheme(name)?, levels, boundary, ..Default::default() };
    let options = SubdivisionOptions { refinement, face_varying, ..Default::default() };
    let (refined, _) = subdivide(&mesh, &cage.sharpness, &options, Progress::NONE)?;
    let uv = refined.attributes().corner.get::<DVec2>(UV).ok_or("no texture coordinates")?;

    let positions: Vec<DVec3> = refined.positions().values().to_vec();
    let matching = Matching::new(&positions, &theirs);
    let faces = listed(&refined.to_faces());
    let verdict = matching.verdict(&faces, &theirs);
    if verdict != Verdict::Same {
        return Ok(Comparison::without_number(quantity, verdict));
    }
    // Where the corners of each of their faces begin, by its vertices.
    let mut starts = HashMap::new();
    let mut start = 0;
    for face in raw::faces(&theirs) {
        let corners = face.len();
        starts.insert(rotated(face.clone()), (start, face));
        start += corners;
    }
    let size = charts.values.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for f in refined.faces() {
        let partner = |v: VertexId| matching.partner[v.index()].unwrap_or_default();
        let named: Vec<usize> = refined.face_vertices(f).map(partner).collect();
        let (start, face) = starts.get(&rotated(named)).ok_or("a face has no partner")?;
        for h in refined.face_halfedges(f) {
            let v = partner(refined.from(h));
            let k = face.iter().position(|&w| w == v).ok_or("a corner has no partner")?;
            worst = worst.max(uv[h].distance(their_uv[start + k]) / size);
            compared += 2;
        }
    }
    let verdict = if worst <= TOLERANCE {
        Verdict::Same
    } else if DEPENDENT.contains(&rule) && !cage.sharpness.is_smooth() {
        Verdict::Convention("creases at seams")
    } else {
        Verdict::Differs(format!("off by {worst:e}"))
    };
    let worst = worst / TOLERANCE;
    Ok(Comparison { quantity: quantity.to_owned(), compared, left_out: 0, worst, verdict })
}
