//! Holes filled beside CGAL: the weights of covers, and how smooth fair patches are.
//!
//! The weight of a cover is the largest angle between neighbors, those outside of the rim among them, and then the
//! area: ours are not larger. How smooth a patch is tells the bending energy of hinges over its edges and its rim,
//!
//! ```text
//! Σ 3 θ² |e|² / (A₁ + A₂)     over edges e with a new face, θ the angle between the faces
//! ```
//!
//! (Grinspun, Hirani, Desbrun and Schröder, "Discrete shells", 2003): ours is at most a twentieth larger.

use std::{fs, path::Path};

use dgp_mesh::{
    DVec3, Editor, FaceId, FaceList, FaceSet, IndexedFaceSet, Mesh, VertexId, shapes,
    topology::face_list_components,
};

use super::{Comparison, Table, Verdict};
use crate::{
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// Angles within this, in radians, are the same.
const ANGLE: f64 = 1e-6;

/// Areas within this part are the same.
const AREA: f64 = 1e-9;

/// Energies of ours may be so much of theirs.
const ENERGY: f64 = 1.05;

fn inputs() -> Outcome<Vec<(String, IndexedFaceSet)>> {
    let cut = |mesh: Mesh, gone: &dyn Fn(DVec3) -> bool| -> Outcome<IndexedFaceSet> {
        let mut mesh = mesh;
        let faces: FaceSet = mesh.faces().filter(|&f| gone(mesh.face_center(f))).collect();
        let mut editor = Editor::new(&mut mesh);
        let _ = editor.remove_faces(&faces)?;
        editor.remove_isolated_vertices();
        let _ = editor.finish();
        Ok(mesh.to_indexed())
    };
    let sphere = shapes::icosphere(5)?;
    let noisy = shapes::with_noise(shapes::icosphere(5)?, 0.1, 3)?;
    let torus = shapes::torus(2.0, 0.7, 90, 40)?;
    let mut inputs = vec![
        ("bowl".to_owned(), cut(sphere.clone(), &|p| p.z > 0.6)?),
        ("noisy bowl".to_owned(), cut(noisy, &|p| p.z > 0.6)?),
        (
            "saddle".to_owned(),
            cut(torus.clone(), &|p| p.x < -1.0 && p.z.abs() < 0.4 && p.length() < 2.0)?,
        ),
        ("bite".to_owned(), cut(torus, &|p| p.x > 2.2)?),
        ("holed sphere".to_owned(), shapes::with_holes(&sphere, 6, 4, 3)?.to_indexed()),
    ];
    for corners in [150, 400, 1000] {
        inputs.push((format!("cup of {corners}"), cup(corners)?));
    }
    Ok(inputs)
}

/// A cup whose rim of so many corners goes up and down.
pub(crate) fn cup(corners: usize) -> Outcome<IndexedFaceSet> {
    let rows = 4;
    let mut points = vec![DVec3::new(0.0, 0.0, -1.0)];
    for row in 0..rows {
        for i in 0..corners {
            let angle = std::f64::consts::TAU * i as f64 / corners as f64;
            let part = f64::from(row + 1) / f64::from(rows);
            let wave = 0.2 * (3.0 * angle).cos() + 0.05 * (11.0 * angle).sin();
            let radius = (part * std::f64::consts::FRAC_PI_2).sin();
            let height = -(part * std::f64::consts::FRAC_PI_2).cos() + part * wave;
            points.push(DVec3::new(radius * angle.cos(), radius * angle.sin(), height));
        }
    }
    let at = |row: usize, i: usize| VertexId::new(1 + row * corners + i % corners);
    let mut faces = FaceList::new();
    for i in 0..corners {
        // Seen from outside, below.
        faces.push(&[VertexId::new(0), at(0, i + 1), at(0, i)]);
        for row in 0..rows as usize - 1 {
            faces.push(&[at(row, i), at(row, i + 1), at(row + 1, i)]);
            faces.push(&[at(row, i + 1), at(row + 1, i + 1), at(row + 1, i)]);
        }
    }
    Ok(IndexedFaceSet::new(points, faces)?)
}

/// Compares on all inputs, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    for (name, set) in inputs()? {
        let path = folder.join("holes.raw");
        raw::write(&path, &set)?;
        let mut comparisons = Vec::new();
        for operation in ["fill-cover", "fill-fair"] {
            let filled = |driver: &Driver| -> Outcome<Mesh> {
                let out = folder.join("filled");
                let told = driver.call(operation, &path, &["--out", &out.to_string_lossy()])?;
                if told["filled"] != true {
                    return Err(format!("{} leaves a hole open", driver.name).into());
                }
                let mesh = Mesh::new(&raw::read(&out.with_extension("raw"))?)?;
                fs::remove_file(out.with_extension("raw"))?;
                Ok(mesh)
            };
            let (ours, theirs) = (filled(&Driver::ours()?)?, filled(&peers.cgal)?);
            comparisons.push(if operation == "fill-cover" {
                covers(&ours, &theirs, set.face_count())
            } else {
                patches(&ours, &theirs, set.face_count())
            });
        }
        table.add(&name, "CGAL", comparisons);
        fs::remove_file(path)?;
    }
    Ok(())
}

/// The weights of all holes.
fn covers(ours: &Mesh, theirs: &Mesh, known: usize) -> Comparison {
    let (ours, theirs) = (weights(ours, known), weights(theirs, known));
    let mut verdict = Verdict::Same;
    let mut worst = 0.0_f64;
    if ours.len() != theirs.len() {
        verdict = Verdict::Differs(format!("{} and {} holes", ours.len(), theirs.len()));
    }
    for (a, b) in ours.iter().zip(&theirs) {
        let is_less = a.0 < b.0 - ANGLE;
        let is_same = a.0 <= b.0 + ANGLE && a.1 <= b.1 * (1.0 + AREA);
        if !(is_less || is_same) {
            verdict = Verdict::Differs(format!("{a:?} and {b:?}"));
        }
        if !is_less {
            worst = worst.max((a.0 - b.0) / ANGLE);
        }
    }
    let quantity = "hole_weight".to_owned();
    Comparison { quantity, compared: ours.len(), left_out: 0, worst, verdict }
}

/// The largest angle and the area of each hole that was filled, in the order of the vertices of their rims.
fn weights(mesh: &Mesh, known: usize) -> Vec<(f64, f64)> {
    let new: Vec<FaceId> = mesh.faces().filter(|f| f.index() >= known).collect();
    let mut faces = FaceList::new();
    for &f in &new {
        faces.push(&mesh.face_vertices(f).collect::<Vec<_>>());
    }
    let parts = face_list_components(mesh.vertex_count(), &faces);
    let mut weights = vec![(0.0_f64, 0.0); parts.count];
    for (i, &f) in new.iter().enumerate() {
        let Some(part) = parts.face[FaceId::new(i)] else { continue };
        let (bend, area) = &mut weights[part as usize];
        *area += mesh.face_area(f);
        for h in mesh.face_halfedges(f) {
            if let Some(other) = mesh.face(h.twin()) {
                *bend = bend.max(mesh.face_normal(f).angle_between(mesh.face_normal(other)));
            }
        }
    }
    weights
}

/// The energies of all patches together.
fn patches(ours: &Mesh, theirs: &Mesh, known: usize) -> Comparison {
    let (a, b) = (energy(ours, known), energy(theirs, known));
    let verdict = if a <= ENERGY * b {
        Verdict::Same
    } else {
        Verdict::Differs(format!("energies {a} and {b}"))
    };
    let quantity = "patch_energy".to_owned();
    Comparison { quantity, compared: 1, left_out: 0, worst: a / (ENERGY * b), verdict }
}

fn energy(mesh: &Mesh, known: usize) -> f64 {
    let hinge = |e| {
        let [Some(f), Some(g)] = mesh.edge_faces(e) else { return 0.0 };
        if f.index() < known && g.index() < known {
            return 0.0;
        }
        let angle = mesh.face_normal(f).angle_between(mesh.face_normal(g));
        let areas = mesh.face_area(f) + mesh.face_area(g);
        3.0 * (angle * mesh.edge_length(e)).powi(2) / areas
    };
    mesh.edges().map(hinge).sum()
}
