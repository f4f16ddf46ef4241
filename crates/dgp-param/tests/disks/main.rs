//! Maps to the plane as callers meet them.

mod bad_input;
mod conformal;
mod convex;
mod measures;

use dgp_mesh::{DVec2, DVec3, Mesh, VertexMap, shapes};

/// A grid of n × n squares, each cut in two, bent by `bend` from the unit square into space.
fn bent_grid(n: usize, bend: impl Fn(DVec2) -> DVec3) -> Mesh {
    let mut mesh = shapes::grid(n, n).unwrap();
    let (lo, hi) = mesh
        .positions()
        .values()
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let size = (hi - lo).max(DVec3::splat(1e-300));
    mesh.set_positions(mesh.positions().map(|&p| bend(((p - lo) / size).truncate())));
    mesh
}

/// A bumpy patch with a curved rim.
fn hills(n: usize) -> Mesh {
    bent_grid(n, |p| {
        let q = 4.0 * p - DVec2::splat(2.0);
        let height = (1.7 * q.x).sin() * (1.3 * q.y).cos() + 0.3 * (5.0 * q.x * q.y).sin();
        DVec3::new(q.x + 0.2 * q.y * q.y, q.y, height)
    })
}

/// The largest distance between two maps after the similarity that takes vertices `a` and `b` of the first to
/// where the second has them.
fn difference_of_shape(first: &VertexMap<DVec2>, second: &VertexMap<DVec2>) -> f64 {
    let (a, b) = (first.values(), second.values());
    let last = a.len() - 1;
    let factor = (b[last] - b[0]).rotate((a[last] - a[0]).recip_turn());
    a.iter()
        .zip(b)
        .map(|(p, q)| ((*p - a[0]).rotate(factor) + b[0]).distance(*q))
        .fold(0.0, f64::max)
}

trait RecipTurn {
    fn recip_turn(self) -> DVec2;
}

impl RecipTurn for DVec2 {
    /// 1/z of complex numbers.
    fn recip_turn(self) -> DVec2 {
        DVec2::new(self.x, -self.y) / self.length_squared()
    }
}
