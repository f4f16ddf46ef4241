//! The inputs: spheres with noise, in the order of their making and shuffled, and a surface of many handles.

use std::{
    fs,
    path::{Path, PathBuf},
};

use dgp_io::{Document, Encoding, WriteOptions};
use dgp_mesh::{FaceId, IndexedFaceSet, Progress, shapes};

use super::{Effort, cases::Cage};
use crate::{golden::holes::cup, raw, shell::Outcome};

/// A mesh on disk.
pub(super) struct Input {
    pub(super) name: String,
    pub(super) triangles: usize,
    /// The raw mesh.
    pub(super) raw: PathBuf,
    /// The same with some faces turned over.
    pub(super) soup: PathBuf,
    /// The folder with the mesh in every format, if it was written.
    pub(super) files: Option<PathBuf>,
    pub(super) purpose: Purpose,
}

/// Which cases an input is for.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    /// All but the refinement of cages.
    Any,
    /// The solvers, whose work depends on the handles.
    Solvers,
    /// To have their holes filled.
    Holes,
    /// To be refined so often.
    Refinement(Cage, usize),
    /// Decimation only.
    Decimation,
}

/// Writes the inputs for this effort.
pub(super) fn prepare(effort: Effort, folder: &Path) -> Outcome<Vec<Input>> {
    let levels: &[usize] = if effort == Effort::Quick { &[4] } else { &[6, 7, 8] };
    let mut inputs = Vec::new();
    for (i, &level) in levels.iter().enumerate() {
        let set = shapes::with_noise(shapes::icosphere(level)?, 0.05, 1)?.to_indexed();
        let triangles = set.face_count();
        let name = format!("sphere-{}k", triangles / 1000);
        let place = folder.join(&name);
        fs::create_dir_all(&place)?;
        let path = place.join("mesh.raw");
        raw::write(&path, &set)?;
        let soup = place.join("soup.raw");
        raw::write(&soup, &turned(&set)?)?;
        let shuffled = (i + 1 == levels.len()).then(|| shapes::shuffled(&set, 2));
        let document = Document { set, ..Document::default() };
        for (file, encoding) in [
            ("mesh.obj", None),
            ("mesh.ply", Some(Encoding::LittleEndian)),
            ("mesh-ascii.ply", Some(Encoding::Text)),
            ("mesh.stl", Some(Encoding::LittleEndian)),
            ("mesh.off", None),
        ] {
            let options = WriteOptions { encoding, ..WriteOptions::default() };
            let report = dgp_io::write(place.join(file), &document, &options, Progress::NONE);
            if let Err(error) = report {
                eprintln!("{file}: {error}");
            }
        }
        inputs.push(Input {
            name: name.clone(),
            triangles,
            raw: path,
            soup,
            files: Some(place),
            purpose: Purpose::Any,
        });
        if let Some(set) = shuffled {
            let path = folder.join(format!("{name}-shuffled.raw"));
            raw::write(&path, &set)?;
            let soup = folder.join(format!("{name}-shuffled-soup.raw"));
            raw::write(&soup, &turned(&set)?)?;
            inputs.push(Input {
                name: format!("{name}, shuffled"),
                triangles,
                raw: path,
                soup,
                files: None,
                purpose: Purpose::Any,
            });
        }
    }
    let cells = if effort == Effort::Quick { 4 } else { 25 };
    let set = shapes::gyroid(3, cells)?.to_indexed();
    let triangles = set.face_count();
    let name = format!("gyroid-{}k", triangles / 1000);
    let path = folder.join(format!("{name}.raw"));
    raw::write(&path, &set)?;
    inputs.push(Input {
        name,
        triangles,
        soup: path.clone(),
        raw: path,
        files: None,
        purpose: Purpose::Solvers,
    });
    cages(effort, folder, &mut inputs)?;
    holed(effort, folder, &mut inputs)?;
    Ok(inputs)
}

/// Cups whose rims have so many corners.
fn holed(effort: Effort, folder: &Path, inputs: &mut Vec<Input>) -> Outcome<()> {
    let sizes: &[usize] = if effort == Effort::Quick { &[100] } else { &[100, 300, 1000, 3000] };
    for &corners in sizes {
        let set = cup(corners)?;
        let triangles = set.face_count();
        let raw = folder.join(format!("cup-{corners}.raw"));
        raw::write(&raw, &set)?;
        inputs.push(Input {
            name: format!("rim of {corners}"),
            triangles,
            soup: raw.clone(),
            raw,
            files: None,
            purpose: Purpose::Holes,
        });
    }
    Ok(())
}

/// Cages to be refined to a million faces and to several: few levels of many faces, many of few. The
/// faces are those after splits in four.
fn cages(effort: Effort, folder: &Path, inputs: &mut Vec<Input>) -> Outcome<()> {
    // Levels of the sphere of triangles, cuts of that of quadrilaterals, how often to refine.
    let sizes: &[(usize, usize, usize)] = match effort {
        Effort::Quick => &[(1, 3, 2)],
        Effort::Full => &[(8, 448, 1), (7, 224, 1), (5, 56, 4), (3, 14, 5), (2, 7, 7)],
    };
    for &(level, cuts, levels) in sizes {
        for (cage, mesh) in [
            (Cage::Triangles, shapes::icosphere(level)?),
            (Cage::Quads, shapes::quad_sphere(cuts)?),
        ] {
            let set = shapes::with_noise(mesh, 0.05, 3)?.to_indexed();
            let kind = if cage == Cage::Triangles { "triangles" } else { "quads" };
            let name = format!("{} {kind}, {levels}×", set.face_count());
            let raw = folder.join(format!("cage-{kind}-{levels}-{}.raw", set.face_count()));
            raw::write(&raw, &set)?;
            let triangles = set.face_count() << (2 * levels);
            inputs.push(Input {
                name,
                triangles,
                soup: raw.clone(),
                raw,
                files: None,
                purpose: Purpose::Refinement(cage, levels),
            });
        }
    }
    Ok(())
}

/// Every hundredth face turned over.
fn turned(set: &IndexedFaceSet) -> Outcome<IndexedFaceSet> {
    let mut faces = set.faces().clone();
    for f in (0..faces.len()).step_by(100).map(FaceId::new) {
        faces.face_mut(f).reverse();
    }
    Ok(IndexedFaceSet::new(set.positions().clone(), faces)?)
}
