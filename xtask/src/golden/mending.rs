//! Counts of defects beside CGAL's: faces that meet, slivers, components, copies in soups, rims that are stitched.

use std::{fs, path::Path};

use dgp_mesh::{
    CrowdedEdges, DefectKind, Editor, FaceId, Facing, IndexedFaceSet, Mesh, Progress,
    RepairOptions, Tolerance, defects, repair_faces, shapes, spatial::TriangleTree, topology,
};
use dgp_remesh::{cap_faces, needle_faces, stitch_rims};

use super::{Comparison, Table, Verdict};
use crate::{
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// Manifolds with slivers, rims to be stitched and faces that meet.
fn manifolds() -> Outcome<Vec<(&'static str, IndexedFaceSet)>> {
    let sphere = shapes::icosphere(3)?;
    let mut slivers = sphere.clone();
    let mut editor = Editor::new(&mut slivers);
    for (k, e) in editor.edges().step_by(9).take(90).collect::<Vec<_>>().into_iter().enumerate() {
        let [a, b] = editor.mesh().edge_vertices(e).map(|v| editor.mesh().position(v));
        // From needles near the start of the edge to caps in its middle.
        let _ = editor.split_edge_triangles(e, a + (k as f64 + 1.0) / 180.0 * (b - a))?;
    }
    let _ = editor.finish();
    let loose = shapes::unweld_patch(&sphere.to_indexed(), 0.25, 4);
    let loose = shapes::unweld_patch(&loose, 0.2, 9);
    Ok(vec![
        ("sphere with slivers", slivers.to_indexed()),
        ("crumpled sphere", shapes::with_noise(sphere, 0.5, 3)?.to_indexed()),
        ("loose patches", loose),
        ("flat grid", shapes::grid(12, 7)?.to_indexed()),
    ])
}

/// Faces with copies of vertices and of faces, and vertices of no face.
fn soups() -> Outcome<Vec<(&'static str, IndexedFaceSet)>> {
    let sphere = shapes::icosphere(2)?.to_indexed();
    let mut soup = dgp_mesh::PolygonSoup::from_indexed(&sphere).to_indexed();
    let mut faces = soup.faces().clone();
    for f in (0..faces.len()).step_by(17).map(FaceId::new) {
        let copy = faces.face(f).to_vec();
        faces.push(&copy);
    }
    let mut positions = soup.positions().values().to_vec();
    positions.push(2.0 * positions[0]);
    soup = IndexedFaceSet::new(positions, faces)?;
    Ok(vec![("soup of a sphere", soup)])
}

/// Compares on all inputs, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    let path = folder.join("mending.raw");
    for (name, set) in manifolds()? {
        raw::write(&path, &set)?;
        let mut comparisons = judge(&peers.cgal, "defect-counts", &path, &counts(&set)?)?;
        if defects(&set, Progress::NONE)?.count(DefectKind::DuplicateVertex) > 0 {
            // For CGAL faces along rims at one place meet; for us they share what is there.
            let met = |c: &&mut Comparison| c.quantity.starts_with("self_intersect");
            for comparison in comparisons.iter_mut().filter(met) {
                comparison.verdict = Verdict::Convention("corners at one place are shared");
            }
        }
        table.add(name, "CGAL", comparisons);
    }
    for (name, set) in soups()? {
        raw::write(&path, &set)?;
        let options = RepairOptions {
            weld: Some(Tolerance::Exact),
            orientation: Facing::Keep,
            crowded_edges: CrowdedEdges::Pair,
            ..RepairOptions::default()
        };
        let (repaired, _) = repair_faces(&set, &options, Progress::NONE)?;
        let ours =
            [("soup_points", repaired.vertex_count()), ("soup_polygons", repaired.face_count())];
        table.add(name, "CGAL", judge(&peers.cgal, "soup-counts", &path, &ours)?);
    }
    Ok(fs::remove_file(path)?)
}

/// What we count, with CGAL's usual thresholds: needles from 4, caps from 160°.
fn counts(set: &IndexedFaceSet) -> Outcome<Vec<(&'static str, usize)>> {
    let mut mesh = Mesh::new(set)?;
    let pairs = TriangleTree::new(&mesh, Progress::NONE)?.self_intersections(Progress::NONE)?;
    let flat = defects(set, Progress::NONE)?.count(DefectKind::ZeroAreaFace);
    let mut counts = vec![
        ("self_intersections", pairs.len()),
        ("self_intersects", usize::from(!pairs.is_empty())),
        ("degenerate_faces", flat),
        ("needles", needle_faces(&mesh, 4.0).len()),
        ("caps", cap_faces(&mesh, 160.0_f64.to_radians()).len()),
        ("components", topology::components(&mesh).count),
    ];
    let stitched = stitch_rims(&mut mesh, Tolerance::Exact, Progress::NONE)?;
    counts.push(("joined_edges", stitched.joined));
    Ok(counts)
}

fn judge(
    driver: &Driver,
    operation: &str,
    path: &Path,
    ours: &[(&'static str, usize)],
) -> Outcome<Vec<Comparison>> {
    let theirs = driver.call(operation, path, &[])?;
    let comparison = |&(name, count): &(&'static str, usize)| {
        let peer = theirs[name].as_f64().unwrap_or(f64::NAN);
        let verdict = if peer == count as f64 {
            Verdict::Same
        } else {
            Verdict::Differs(format!("{count} and {peer}"))
        };
        let (quantity, worst) = (name.to_owned(), 0.0);
        Comparison { quantity, compared: 1, left_out: 0, worst, verdict }
    };
    Ok(ours.iter().map(comparison).collect())
}
