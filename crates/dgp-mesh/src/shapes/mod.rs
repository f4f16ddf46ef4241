//! Shapes made by formula, for tests, examples and first steps; and damage, to test what mends it.
//!
//! | shape | functions |
//! |---|---|
//! | Platonic solids | [`tetrahedron`] [`cube`] [`octahedron`] [`dodecahedron`] [`icosahedron`] |
//! | spheres | [`icosphere`] [`uv_sphere`] [`quad_sphere`] |
//! | pentagons and hexagons | [`truncated_icosahedron`] [`goldberg`], their duals [`geodesic_sphere`] |
//! | boxes | [`cuboid`] [`quad_cuboid`] |
//! | around an axis | [`surface_of_revolution`] [`cylinder`] [`capped_cylinder`] [`cone`] [`capped_cone`] [`dumbbell`] |
//! | flat | [`grid`] [`quad_grid`] [`disk`] [`annulus`] |
//! | with handles | [`torus`] [`quad_torus`] [`surface_of_genus`] [`quad_surface_of_genus`] [`gyroid`] [`trefoil`] |
//! | closed and bumpy | [`blob`] |
//! | one-sided | [`mobius_strip`], an [`IndexedFaceSet`](crate::IndexedFaceSet) since no mesh can hold it |
//! | damage | [`with_noise`] [`with_holes`] [`shuffled`] [`flip_patch`] [`unweld_patch`] [`like_a_scan`] |
//! | random numbers | [`Random`] |
//!
//! Faces turn counterclockwise seen from outside; flat shapes lie in the plane z = 0 and face +z.
//! Functions with a size return an error where it is out of range or asks for more than [`MAX_FACES`].
//!
//! ```
//! use dgp_mesh::shapes::icosphere;
//!
//! let sphere = icosphere(3)?;
//! assert_eq!((sphere.vertex_count(), sphere.face_count()), (642, 1280));
//! # Ok::<(), dgp_mesh::Error>(())
//! ```

mod blob;
mod cuboid;
mod damage;
mod flat;
mod genus;
mod goldberg;
mod gyroid;
mod knot;
mod mobius;
mod patch;
mod platonic;
mod random;
mod revolution;
mod scan;
mod sphere;
mod torus;

use glam::DVec3;

use crate::{Connectivity, Error, FaceList, Mesh};

pub use blob::blob;
pub use cuboid::{cuboid, quad_cuboid};
pub use damage::{flip_patch, shuffled, unweld_patch, with_holes, with_noise};
pub use flat::{annulus, disk, grid, quad_grid};
pub use genus::{quad_surface_of_genus, surface_of_genus};
pub use goldberg::{geodesic_sphere, goldberg, truncated_icosahedron};
pub use gyroid::gyroid;
pub use knot::trefoil;
pub use mobius::mobius_strip;
pub use platonic::{cube, dodecahedron, icosahedron, octahedron, tetrahedron};
pub use random::Random;
pub use revolution::{
    capped_cone, capped_cylinder, cone, cylinder, dumbbell, surface_of_revolution,
};
pub use scan::{CONFIDENCE, like_a_scan};
pub use sphere::{icosphere, quad_sphere, uv_sphere};
pub use torus::{quad_torus, torus};

/// The most faces a shape can have: a slip in a size must not fill the memory.
pub const MAX_FACES: usize = 1 << 25;

/// What a patch is tiled with.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tiling {
    Triangles,
    Quads,
}

/// The mesh of a formula that is known to give a manifold.
fn manifold(positions: Vec<DVec3>, faces: &FaceList) -> Result<Mesh, Error> {
    let connectivity = Connectivity::from_faces(positions.len(), faces)?;
    Ok(Mesh::from_parts(connectivity, positions.into()))
}

/// The product, unless a mesh of that many faces would be too large.
fn face_count(factors: &[usize]) -> Result<usize, Error> {
    let product = factors.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    match product {
        Some(count) if count <= MAX_FACES => Ok(count),
        _ => {
            Err(Error::option("faces", product.map_or(f64::INFINITY, |n| n as f64), "at most 2²⁵"))
        }
    }
}

/// `value`, unless it is below `least`; `expected` says so.
fn at_least(
    name: &'static str,
    value: usize,
    least: usize,
    expected: &'static str,
) -> Result<usize, Error> {
    if value < least {
        return Err(Error::option(name, value as f64, expected));
    }
    Ok(value)
}

/// `value`, if it is a length whose square is neither zero nor infinite.
fn length(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && (value * value).is_normal() {
        return Ok(value);
    }
    Err(Error::option(name, value, "positive and finite, its square too"))
}

#[cfg(test)]
mod tests;
