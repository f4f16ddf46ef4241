//! Whether counts that somebody claims for a mesh can be true.
//!
//! ```text
//! V − E + F = Σ (2 − 2g − b)                     every orientable manifold (Euler, Poincaré)
//! 2E = Σ degrees of faces + boundary edges       every edge has two sides
//! F = 2V − 4,  E = 3V − 6,  mean valence 6 − 12/V    closed triangle mesh of genus 0
//! ```
//!
//! Reference: Botsch et al., *Polygon Mesh Processing*, section 1.3.

use std::fmt;

/// The faces of a claimed mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceKind {
    /// All have three corners.
    #[default]
    Triangles,
    /// All have four corners.
    Quads,
    /// Each has three or more.
    Polygons,
}

/// What somebody says of an orientable manifold mesh whose vertices all lie on faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClaimedCounts {
    /// V.
    pub vertices: usize,
    /// E.
    pub edges: usize,
    /// F.
    pub faces: usize,
    /// How many parts.
    pub components: usize,
    /// b, how many holes; 0 for a closed mesh.
    pub boundary_loops: usize,
    /// What faces.
    pub kind: FaceKind,
}

/// An identity that the counts violate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Broken {
    /// V − E + F exceeds 2c − b, as if there were less than no handles.
    NegativeGenus {
        /// V − E + F.
        euler_characteristic: i128,
        /// 2c − b.
        limit: i128,
    },
    /// V − E + F and b are not both even or both odd, as if there were half a handle.
    HalfGenus {
        /// V − E + F.
        euler_characteristic: i128,
        /// b.
        boundary_loops: usize,
    },
    /// The number of edges that these faces and this boundary allow.
    Edges {
        /// E.
        edges: usize,
        /// The least E.
        least: usize,
        /// The largest E.
        most: usize,
    },
    /// A closed mesh of triangles has an even number of faces, as each edge has two sides.
    OddFaces {
        /// F.
        faces: usize,
    },
    /// Fewer vertices, faces or components than the other counts need.
    TooFew {
        /// Vertices, faces or components.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there must be.
        least: usize,
    },
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Broken::NegativeGenus { euler_characteristic, limit } => write!(
                f,
                "V − E + F = {euler_characteristic} exceeds 2 × components − holes = {limit}: \
                 the genus would be negative"
            ),
            Broken::HalfGenus { euler_characteristic, boundary_loops } => write!(
                f,
                "V − E + F = {euler_characteristic} and {boundary_loops} holes must be both even \
                 or both odd: the genus would not be whole"
            ),
            Broken::Edges { edges, least, most } if least == most => {
                write!(f, "{edges} edges, but these faces have {least}")
            }
            Broken::Edges { edges, least, most } if least > most => {
                write!(f, "{edges} edges: these faces need {least}, but there can be only {most}")
            }
            Broken::Edges { edges, least, most } => {
                write!(f, "{edges} edges, but these faces have {least} to {most}")
            }
            Broken::OddFaces { faces } => {
                write!(f, "{faces} triangles have an odd number of sides, and a closed mesh cannot")
            }
            Broken::TooFew { what, count, least } => {
                write!(f, "{count} {what}, but the other counts need at least {least}")
            }
        }
    }
}

/// What [`plausibility`] says.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use]
pub struct Plausibility {
    /// The identities that are violated; none if the counts can be true.
    pub broken: Vec<Broken>,
    /// The number of handles if the counts are true, by V − E + F = 2c − 2g − b.
    pub genus: Option<usize>,
}

/// Checks counts against the identities of orientable manifold meshes.
///
/// Every violation is a proof that no such mesh exists; no violation means that none was found.
pub fn plausibility(claimed: &ClaimedCounts) -> Plausibility {
    let ClaimedCounts { vertices, edges, faces, components, boundary_loops, kind } = *claimed;
    let mut broken = Vec::new();

    // The smallest component is one face, or two back to back if closed. Each hole opens one at most.
    let corners = if kind == FaceKind::Quads { 4 } else { 3 };
    let closed = components.saturating_sub(boundary_loops);
    for (what, count, least) in [
        ("components", components, usize::from(faces > 0)),
        ("faces", faces, components.saturating_add(closed)),
        ("vertices", vertices, components.saturating_mul(corners)),
    ] {
        if count < least {
            broken.push(Broken::TooFew { what, count, least });
        }
    }

    // 2E = Σ degrees + boundary edges, of which each hole has at least three.
    let sides = corners.saturating_mul(faces);
    let is_closed = boundary_loops == 0;
    if is_closed && kind == FaceKind::Triangles && faces % 2 == 1 {
        broken.push(Broken::OddFaces { faces });
    }
    // No two edges join the same vertices, and each vertex has at least two.
    let simple = vertices.saturating_mul(vertices.saturating_sub(1)) / 2;
    let least = sides.saturating_add(boundary_loops.saturating_mul(3)).div_ceil(2).max(vertices);
    let most = match kind {
        FaceKind::Polygons => simple,
        _ if is_closed => simple.min(sides.div_ceil(2)),
        _ => simple.min(sides),
    };
    if !(least..=most).contains(&edges) {
        broken.push(Broken::Edges { edges, least, most });
    }

    let [v, e, f, c, b] = [vertices, edges, faces, components, boundary_loops].map(|n| n as i128);
    let (euler_characteristic, limit) = (v - e + f, 2 * c - b);
    let handles = limit - euler_characteristic;
    if handles < 0 {
        broken.push(Broken::NegativeGenus { euler_characteristic, limit });
    }
    if handles % 2 != 0 {
        broken.push(Broken::HalfGenus { euler_characteristic, boundary_loops });
    }
    let genus = (handles >= 0 && handles % 2 == 0).then_some((handles / 2) as usize);
    Plausibility { broken, genus }
}

/// V, E and F of a closed triangle mesh of genus 0 with that many vertices: E = 3V − 6, F = 2V − 4.
/// `None` below three.
pub fn closed_triangle_counts(vertices: usize) -> Option<ClaimedCounts> {
    (vertices >= 3).then(|| ClaimedCounts {
        vertices,
        edges: 3 * vertices - 6,
        faces: 2 * vertices - 4,
        components: 1,
        boundary_loops: 0,
        kind: FaceKind::Triangles,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_wrong_count_breaks_its_identity() {
        let sphere = closed_triangle_counts(12).unwrap();
        assert_eq!((sphere.edges, sphere.faces), (30, 20));
        assert_eq!(plausibility(&sphere), Plausibility { broken: vec![], genus: Some(0) });

        let verdict = |change: fn(&mut ClaimedCounts)| {
            let mut claimed = closed_triangle_counts(12).unwrap();
            change(&mut claimed);
            plausibility(&claimed).broken
        };
        assert_eq!(
            verdict(|c| c.edges = 29),
            [
                Broken::Edges { edges: 29, least: 30, most: 30 },
                Broken::NegativeGenus { euler_characteristic: 3, limit: 2 },
                Broken::HalfGenus { euler_characteristic: 3, boundary_loops: 0 },
            ]
        );
        assert_eq!(
            verdict(|c| c.vertices = 11),
            [Broken::HalfGenus { euler_characteristic: 1, boundary_loops: 0 }]
        );
        assert_eq!(
            verdict(|c| c.vertices = 14),
            [Broken::NegativeGenus { euler_characteristic: 4, limit: 2 }]
        );
        assert!(verdict(|c| c.faces = 21).contains(&Broken::OddFaces { faces: 21 }));
        assert!(verdict(|c| c.components = 0).contains(&Broken::TooFew {
            what: "components",
            count: 0,
            least: 1
        }));
        assert_eq!(
            verdict(|c| c.components = 5),
            [Broken::TooFew { what: "vertices", count: 12, least: 15 }]
        );
    }

    #[test]
    fn counts_beyond_all_measure_are_judged_too() {
        let n = usize::MAX;
        let claimed = ClaimedCounts {
            vertices: n,
            edges: n,
            faces: n,
            components: n,
            boundary_loops: n,
            kind: FaceKind::Polygons,
        };
        assert!(!plausibility(&claimed).broken.is_empty());
    }
}
