//! What the comparisons run on: shapes made in code, and real meshes where they are installed.

use std::fs;

use dgp_mesh::{
    DVec3, Error, FaceList, IndexedFaceSet, Mesh,
    shapes::{self, Random},
};

use crate::{data, shell::Outcome};

/// The largest file to read, in bytes.
const LARGEST: u64 = 6 << 20;

/// A mesh with a name.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) set: IndexedFaceSet,
}

impl Input {
    fn new(name: &str, set: IndexedFaceSet) -> Self {
        Input { name: name.into(), set }
    }
}

/// Small inputs, whose answers are stored under tests/golden/.
pub(crate) fn small() -> Result<Vec<Input>, Error> {
    let meshes: Vec<(&str, Mesh)> = vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::cube()),
        ("dodecahedron", shapes::dodecahedron()),
        ("icosphere", shapes::with_noise(shapes::icosphere(1)?, 0.05, 1)?),
        ("torus", shapes::torus(2.0, 0.5, 7, 5)?),
        ("quad-torus", shapes::quad_torus(2.0, 0.5, 5, 4)?),
        ("grid", shapes::with_noise(shapes::grid(3, 4)?, 0.1, 2)?),
        ("quad-grid", shapes::quad_grid(3, 2)?),
        ("annulus", shapes::annulus(0.5, 1.0, 8, 2)?),
        ("holed-sphere", shapes::with_holes(&shapes::icosphere(2)?, 2, 1, 3)?),
        ("capped-cone", shapes::capped_cone(1.0, 2.0, 6, 2)?),
    ];
    let mut inputs: Vec<Input> =
        meshes.into_iter().map(|(name, mesh)| Input::new(name, mesh.to_indexed())).collect();
    inputs.push(Input::new("mobius", shapes::mobius_strip(7, 2)?));
    inputs.extend(refused()?);
    Ok(inputs)
}

/// Faces that make no manifold, and two that nearly do not.
fn refused() -> Result<Vec<Input>, Error> {
    let cases: [(&str, usize, &[&[usize]]); 8] = [
        ("three-faces-at-an-edge", 5, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]),
        ("misoriented-pair", 4, &[&[0, 1, 2], &[0, 1, 3]]),
        ("open-bow-tie", 5, &[&[0, 1, 2], &[0, 3, 4]]),
        (
            "closed-bow-tie",
            7,
            &[
                &[0, 2, 1],
                &[0, 1, 3],
                &[1, 2, 3],
                &[2, 0, 3],
                &[4, 3, 5],
                &[4, 5, 6],
                &[5, 3, 6],
                &[3, 4, 6],
            ],
        ),
        ("twice-the-same-face", 4, &[&[0, 1, 2], &[0, 1, 2]]),
        ("repeated-corner", 4, &[&[0, 1, 1], &[1, 2, 3]]),
        ("two-components", 7, &[&[0, 1, 2], &[3, 4, 5, 6]]),
        ("isolated-vertices", 6, &[&[1, 3, 5]]),
    ];
    let mut random = Random::new(4);
    let mut inputs = Vec::new();
    for (name, count, faces) in cases {
        let positions: Vec<DVec3> = (0..count).map(|_| random.direction()).collect();
        inputs
            .push(Input::new(name, IndexedFaceSet::new(positions, FaceList::from_indices(faces))?));
    }
    Ok(inputs)
}

/// Larger inputs that are compared where the peers are installed.
pub(crate) fn large() -> Result<Vec<Input>, Error> {
    let meshes: Vec<(&str, Mesh)> = vec![
        ("noisy-sphere-20k", shapes::with_noise(shapes::icosphere(5)?, 0.005, 5)?),
        ("torus-large", shapes::torus(3.0, 1.0, 200, 90)?),
        ("genus-3", shapes::surface_of_genus(3, 3)?),
        ("quads-of-genus-2", shapes::quad_surface_of_genus(2, 2)?),
        ("holed-sphere-large", shapes::with_holes(&shapes::icosphere(4)?, 7, 2, 6)?),
        ("trefoil", shapes::trefoil(200, 20)?),
        ("dumbbell", shapes::dumbbell(0.2, 60, 80)?),
        ("uv-sphere", shapes::uv_sphere(50, 40)?),
        ("disk", shapes::disk(20)?),
        ("blob", shapes::blob(4)?),
    ];
    let mut inputs: Vec<Input> =
        meshes.into_iter().map(|(name, mesh)| Input::new(name, mesh.to_indexed())).collect();
    let shuffled = shapes::shuffled(&inputs[0].set, 7);
    inputs.push(Input::new("shuffled-sphere", shuffled));
    Ok(inputs)
}

/// Real meshes where they are installed: those of Debian's package and the shared ones. Files that are
/// no mesh, and those too large to compare in a minute, are left out.
pub(crate) fn real() -> Outcome<Vec<Input>> {
    let mut folders = Vec::new();
    match data::unpack() {
        Ok(folder) => folders.push(folder),
        Err(error) => println!("without real meshes: {error}"),
    }
    folders.extend(data::shared());
    let mut inputs = Vec::new();
    for folder in folders {
        for path in data::files(&folder, &["off", "obj", "ply", "stl"])? {
            let size = fs::metadata(&path)?.len();
            let Ok(document) = dgp_io::read(&path) else { continue };
            if document.set.face_count() == 0 || size > LARGEST {
                continue;
            }
            let name = path.strip_prefix(&folder)?.to_string_lossy().replace(['/', '.'], "-");
            inputs.push(Input::new(&name, document.set));
        }
    }
    println!("{} real meshes", inputs.len());
    Ok(inputs)
}
