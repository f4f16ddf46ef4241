//! Nodal domains: the connected regions where a function is positive, and where it is negative.
//!
//! - Input: a mesh, a value per vertex.
//! - Cost: O(V).
//! - Guarantees: vertices where the function is zero are in no domain. The i-th eigenfunction (from 1) of
//!   multiplicity r has at most i + r − 1 domains if no weight is negative.
//! - Reference: Courant and Hilbert, *Methods of Mathematical Physics* I, VI.6; Davies, Gladwell, Leydold
//!   and Stadler, "Discrete nodal domain theorems", Linear Algebra and its Applications 336, 2001.

use dgp_mesh::{Connectivity, VertexMap};

/// The regions of one sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodalDomains {
    /// The domain of each vertex, none where the function is zero.
    pub domain: VertexMap<Option<u32>>,
    /// How many domains are positive.
    pub positive: usize,
    /// How many domains are negative.
    pub negative: usize,
}

/// The nodal domains of `values`, numbered in order of their first vertex.
///
/// # Panics
/// If there is not a value per vertex.
pub fn nodal_domains(mesh: &Connectivity, values: &[f64]) -> NodalDomains {
    assert_eq!(values.len(), mesh.vertex_count(), "a value per vertex");
    let sign = |value: f64| if value > 0.0 { 1_i8 } else { -i8::from(value < 0.0) };
    let mut domain = VertexMap::filled(values.len(), None);
    let mut counts = [0; 2];
    let mut stack = Vec::new();
    for v in mesh.vertices() {
        let own = sign(values[v.index()]);
        if own == 0 || domain[v].is_some() {
            continue;
        }
        let label = (counts[0] + counts[1]) as u32;
        counts[usize::from(own < 0)] += 1;
        domain[v] = Some(label);
        stack.push(v);
        while let Some(v) = stack.pop() {
            for w in mesh.vertex_neighbors(v) {
                if domain[w].is_none() && sign(values[w.index()]) == own {
                    domain[w] = Some(label);
                    stack.push(w);
                }
            }
        }
    }
    NodalDomains { domain, positive: counts[0], negative: counts[1] }
}
