//! What Euler's formula V − E + F = 2 says of polyhedra.
//!
//! ```text
//! 1/n + 1/m = 1/2 + 1/E          all faces have n sides, m meet at each vertex: five solutions
//! Σ (6 − k) F(k) = 12            three faces meet at each vertex, F(k) of them have k sides:
//!                                12 pentagons if there are only pentagons and hexagons
//! ```
//!
//! Reference: Euclid, *Elements* XIII; Coxeter, *Regular Polytopes*, section 1.7; Grünbaum, *Convex
//! Polytopes*, chapter 13.

use std::fmt;

use crate::{Connectivity, Mesh, shapes};

/// A polyhedron whose faces all have the same number of sides and whose vertices all have the same
/// number of edges: the symbol {n, m}.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegularPolyhedron {
    /// n, the number of sides of each face.
    pub sides: usize,
    /// m, the number of faces at each vertex.
    pub valence: usize,
    /// V = 2E/m.
    pub vertices: usize,
    /// E = 1/(1/n + 1/m − 1/2).
    pub edges: usize,
    /// F = 2E/n.
    pub faces: usize,
}

impl RegularPolyhedron {
    /// The polyhedron {n, m}: `None` unless n and m are at least 3 and 1/n + 1/m > 1/2.
    pub fn new(sides: usize, valence: usize) -> Option<Self> {
        let (n, m) = (sides, valence);
        // 1/n + 1/m > 1/2 ⇔ (n − 2)(m − 2) < 4.
        let product = n.checked_sub(2)?.checked_mul(m.checked_sub(2)?)?;
        if !(1..4).contains(&product) {
            return None;
        }
        let edges = 2 * n * m / (4 - product);
        Some(RegularPolyhedron {
            sides,
            valence,
            vertices: 2 * edges / m,
            edges,
            faces: 2 * edges / n,
        })
    }

    /// All there are, by n and then by m: the five Platonic solids.
    pub fn all() -> Vec<Self> {
        // (n − 2)(m − 2) < 4 leaves nothing beyond 5.
        let pairs = (3..6).flat_map(|n| (3..6).map(move |m| (n, m)));
        pairs.filter_map(|(n, m)| RegularPolyhedron::new(n, m)).collect()
    }

    /// The solid, its vertices on the unit sphere.
    pub fn mesh(&self) -> Mesh {
        match (self.sides, self.valence) {
            (3, 3) => shapes::tetrahedron(),
            (3, 4) => shapes::octahedron(),
            (3, _) => shapes::icosahedron(),
            (4, _) => shapes::cube(),
            _ => shapes::dodecahedron(),
        }
    }
}

impl fmt::Display for RegularPolyhedron {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{{}, {}}}", self.sides, self.valence)
    }
}

/// What [`trivalent_balance`] finds.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct TrivalentBalance {
    /// Whether three faces meet at every vertex and there is no hole; only then the formula holds.
    pub is_trivalent: bool,
    /// How many faces have each number of sides, from 0 on.
    pub faces_by_sides: Vec<usize>,
    /// Σ (6 − k) F(k).
    pub surplus: i64,
    /// 6 χ, which the surplus must be: 12 for a sphere.
    pub required: i64,
}

/// Counts how far the faces of a mesh fall short of hexagons: by 6 χ in all, if three meet at each
/// vertex and it is closed.
pub fn trivalent_balance(mesh: &Connectivity) -> TrivalentBalance {
    let mut faces_by_sides = Vec::new();
    for f in mesh.faces() {
        let sides = mesh.degree(f);
        if faces_by_sides.len() <= sides {
            faces_by_sides.resize(sides + 1, 0);
        }
        faces_by_sides[sides] += 1;
    }
    let surplus =
        faces_by_sides.iter().zip(0_i64..).map(|(&count, k)| (6 - k) * count as i64).sum();
    let is_three = |v| !mesh.is_boundary_vertex(v) && mesh.valence(v) == 3;
    TrivalentBalance {
        is_trivalent: mesh.vertices().all(is_three),
        faces_by_sides,
        surplus,
        required: 6 * super::euler_characteristic(mesh),
    }
}

/// The counts of a trivalent polyhedron of 12 pentagons and these hexagons: V = 20 + 2h, E = 30 + 3h,
/// F = 12 + h. Every h but 1 occurs (Grünbaum and Motzkin 1963): `None` for that.
#[must_use]
pub fn fullerene_counts(hexagons: usize) -> Option<[usize; 3]> {
    let h = hexagons;
    let counts =
        || Some([20 + h.checked_mul(2)?, 30_usize.checked_add(h.checked_mul(3)?)?, 12 + h]);
    if h == 1 { None } else { counts() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{euler_characteristic, genus};

    #[test]
    fn there_are_five_regular_polyhedra_and_each_is_built() {
        let all = RegularPolyhedron::all();
        let symbols: Vec<String> = all.iter().map(ToString::to_string).collect();
        assert_eq!(symbols, ["{3, 3}", "{3, 4}", "{3, 5}", "{4, 3}", "{5, 3}"]);
        for solid in all {
            assert_eq!(solid.vertices + solid.faces, solid.edges + 2, "{solid}");
            let mesh = solid.mesh();
            let counts = (mesh.vertex_count(), mesh.edge_count(), mesh.face_count());
            assert_eq!(counts, (solid.vertices, solid.edges, solid.faces), "{solid}");
            assert!(mesh.faces().all(|f| mesh.degree(f) == solid.sides), "{solid}");
            assert!(mesh.vertices().all(|v| mesh.valence(v) == solid.valence), "{solid}");
            // Regular in space too: all edges have the same length.
            let lengths: Vec<f64> = mesh.edges().map(|e| mesh.edge_length(e)).collect();
            assert!(lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-14), "{solid}");
        }
    }

    #[test]
    fn no_other_pair_satisfies_the_inequality() {
        for n in 0..60 {
            for m in 0..60 {
                let holds = n >= 3 && m >= 3 && 2 * (n + m) > n * m;
                assert_eq!(RegularPolyhedron::new(n, m).is_some(), holds, "{{{n}, {m}}}");
            }
        }
        assert_eq!(RegularPolyhedron::new(usize::MAX, usize::MAX), None);
    }

    #[test]
    fn pentagons_and_hexagons_close_with_twelve_pentagons() {
        let football = shapes::truncated_icosahedron();
        let balance = trivalent_balance(&football);
        assert!(balance.is_trivalent);
        assert_eq!(balance.faces_by_sides, [0, 0, 0, 0, 0, 12, 20]);
        assert_eq!((balance.surplus, balance.required), (12, 12));
        let lengths: Vec<f64> = football.edges().map(|e| football.edge_length(e)).collect();
        assert!(lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-14), "Archimedean");

        for a in 0..6 {
            for b in 0..6 {
                let t = a * a + a * b + b * b;
                if t == 0 {
                    assert!(shapes::goldberg(a, b).is_err());
                    continue;
                }
                let mesh = shapes::goldberg(a, b).unwrap();
                let balance = trivalent_balance(&mesh);
                assert!(balance.is_trivalent, "GP({a}, {b})");
                assert_eq!(balance.faces_by_sides[5], 12, "GP({a}, {b})");
                assert_eq!((balance.surplus, balance.required), (12, 12), "GP({a}, {b})");
                let counts = [mesh.vertex_count(), mesh.edge_count(), mesh.face_count()];
                assert_eq!(Some(counts), fullerene_counts(10 * (t - 1)), "GP({a}, {b})");
                assert_eq!(genus(&mesh), 0, "GP({a}, {b})");
                for f in mesh.faces() {
                    // Flat, and touching the unit sphere.
                    let normal = mesh.face_normal(f);
                    for v in mesh.face_vertices(f) {
                        let height = mesh.position(v).dot(normal);
                        assert!((height - 1.0).abs() < 1e-12, "GP({a}, {b}) {f}: {height}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_dual_has_five_triangles_at_twelve_vertices() {
        for (a, b) in [(1, 0), (0, 3), (2, 2), (4, 1), (1, 4), (3, 5)] {
            let t = a * a + a * b + b * b;
            let mesh = shapes::geodesic_sphere(a, b).unwrap();
            assert_eq!(mesh.face_count(), 20 * t, "{a} {b}");
            let fives = mesh.vertices().filter(|&v| mesh.valence(v) == 5).count();
            let sixes = mesh.vertices().filter(|&v| mesh.valence(v) == 6).count();
            assert_eq!((fives, sixes), (12, 10 * (t - 1)), "{a} {b}");
            assert!(mesh.faces().all(|f| mesh.face_normal(f).dot(mesh.face_center(f)) > 0.0));
        }
    }

    #[test]
    fn on_a_torus_the_sides_balance() {
        let torus = shapes::torus(2.0, 1.0, 9, 6).unwrap();
        assert!(!trivalent_balance(&torus).is_trivalent);
        assert_eq!(euler_characteristic(&torus), trivalent_balance(&torus).required);
        assert_eq!(fullerene_counts(1), None);
    }
}
