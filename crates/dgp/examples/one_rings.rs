//! A mesh built by hand, and walks on it: around vertices, around faces, along holes.
//!
//! `cargo run -p dgp --example one_rings`

use std::{error::Error, f64::consts::TAU};

use dgp::mesh::{
    DVec3, FaceList, IndexedFaceSet, Mesh, VertexId, VertexMap, measure::volume,
    topology::boundary_loops,
};

fn main() -> Result<(), Box<dyn Error>> {
    // A pyramid: four corners, an apex; a quad below and four triangles, counterclockwise from
    // outside. Faces may have any number of corners.
    let corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 3]];
    let positions: Vec<DVec3> = corners.map(|p| DVec3::from_array(p.map(f64::from))).to_vec();
    let faces: [&[usize]; 5] = [&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
    let set = IndexedFaceSet::new(positions, FaceList::from_indices(&faces))?;
    let pyramid = Mesh::new(&set)?;
    assert!((volume(&pyramid) - 4.0).abs() < 1e-12);

    // Around a vertex, counterclockwise.
    let apex = VertexId::new(4);
    let ring: Vec<VertexId> = pyramid.vertex_neighbors(apex).collect();
    println!("{apex} has the neighbors {ring:?}");
    for f in pyramid.vertex_faces(apex) {
        let corners: Vec<VertexId> = pyramid.face_vertices(f).collect();
        println!("  {f} has the corners {corners:?} and the area {:.3}", pyramid.face_area(f));
    }

    // Half-edges tell where one is on the way: the spokes of a vertex, and the angles between them.
    let angles =
        |v: VertexId| -> f64 { pyramid.vertex_halfedges(v).map(|h| pyramid.corner_angle(h)).sum() };
    let total: f64 = pyramid.vertices().map(|v| TAU - angles(v)).sum();
    println!("angle defects sum to {:.6} π, as on every sphere", total / std::f64::consts::PI);
    assert!((total - 2.0 * TAU).abs() < 1e-12);

    // A value for every vertex, computed in parallel: the mean of the neighbors.
    let means: VertexMap<DVec3> = pyramid.map_vertices(|v| {
        let sum: DVec3 = pyramid.vertex_neighbors(v).map(|w| pyramid.position(w)).sum();
        sum / pyramid.valence(v) as f64
    });
    assert_eq!(means[apex], DVec3::new(1.0, 1.0, 0.0));

    // Without its base the pyramid has a hole, whose rim is a loop of half-edges without a face.
    let open = Mesh::new(&IndexedFaceSet::new(
        set.positions().clone(),
        FaceList::from_indices(&faces[1..]),
    )?)?;
    let rim: Vec<VertexId> = boundary_loops(&open)[0].iter().map(|&h| open.from(h)).collect();
    println!("the hole is bounded by {rim:?}");
    assert_eq!(rim.len(), 4);
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
