//! What to refine with, and how far.

use crate::Error;

/// How faces are split and where their vertices go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Triangles into four; smooth but at creases. See [`loop_scheme`](crate::loop_scheme).
    Loop(LoopWeights),
    /// Polygons into quadrilaterals; smooth but at creases. See [`catmull_clark`](crate::catmull_clark).
    CatmullClark,
    /// Polygons into quadrilaterals, without moving anything; knows no creases, being all flat.
    Bilinear,
    /// Triangles into four through the vertices of the cage. See [`butterfly`](crate::butterfly).
    Butterfly(ButterflyRule),
    /// Triangles into three, edges flipped. See [`sqrt3`](crate::sqrt3).
    Sqrt3,
    /// A smaller copy of each face, with faces between for edges and vertices. See
    /// [`doo_sabin`](crate::doo_sabin).
    DooSabin,
}

/// How much the neighbors of a vertex count in Loop's scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoopWeights {
    /// β = (5/8 − (3/8 + ¼ cos 2π/d)²) / d (Loop 1987).
    #[default]
    Original,
    /// β = 3/(8d), 3/16 for d = 3 (Warren 1995).
    Warren,
    /// β = 3/(d(d + 2)): no special case.
    Simple,
}

/// What the butterfly scheme does where not six triangles meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ButterflyRule {
    /// The eight-point mask everywhere (Dyn, Levin and Gregory 1990): not smooth at such vertices.
    Original,
    /// A mask of its own at such vertices (Zorin, Schröder and Sweldens 1996): smooth there too.
    #[default]
    Modified,
}

/// What becomes of the rim of a hole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// Faces that touch a hole only support the surface and are left out of the result.
    None,
    /// The rim becomes a smooth curve.
    #[default]
    EdgeOnly,
    /// The rim becomes a smooth curve that runs through the corners: vertices with only one face.
    EdgeAndCorner,
}

/// How to refine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinementOptions {
    /// How faces are split.
    pub scheme: Scheme,
    /// How often.
    pub levels: usize,
    /// What becomes of the rim of a hole.
    pub boundary: BoundaryRule,
    /// How many bytes the plan, the refined mesh and its positions may take together. More is refused
    /// before anything is computed.
    pub memory_limit: u64,
}

impl Default for RefinementOptions {
    fn default() -> Self {
        RefinementOptions {
            scheme: Scheme::CatmullClark,
            levels: 1,
            boundary: BoundaryRule::default(),
            memory_limit: 8 << 30,
        }
    }
}

impl Scheme {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::Loop(_) => "Loop",
            Scheme::CatmullClark => "Catmull–Clark",
            Scheme::Bilinear => "Bilinear",
            Scheme::Butterfly(_) => "Butterfly",
            Scheme::Sqrt3 => "√3",
            Scheme::DooSabin => "Doo–Sabin",
        }
    }

    /// Whether it takes triangles only.
    pub fn needs_triangles(self) -> bool {
        matches!(self, Scheme::Loop(_) | Scheme::Butterfly(_) | Scheme::Sqrt3)
    }

    /// Whether it has rules for creases.
    pub fn has_creases(self) -> bool {
        matches!(self, Scheme::Loop(_) | Scheme::CatmullClark)
    }
}

/// How many elements a level has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Corners: vertices of faces, face after face.
    pub corners: u64,
    /// Faces.
    pub faces: u64,
}

impl Counts {
    /// Those of the next level; an upper bound where holes make them depend on more. `None` if they
    /// exceed 64 bits.
    fn refined(self, scheme: Scheme) -> Option<Counts> {
        let Counts { vertices, edges, corners, faces } = self;
        let add = |a: u64, b: u64| a.checked_add(b);
        Some(match scheme {
            Scheme::Loop(_) | Scheme::Butterfly(_) => Counts {
                vertices: add(vertices, edges)?,
                edges: add(edges.checked_mul(2)?, corners)?,
                corners: corners.checked_mul(4)?,
                faces: faces.checked_mul(4)?,
            },
            Scheme::CatmullClark | Scheme::Bilinear => Counts {
                vertices: add(add(vertices, edges)?, faces)?,
                edges: add(edges.checked_mul(2)?, corners)?,
                corners: corners.checked_mul(4)?,
                faces: corners,
            },
            Scheme::Sqrt3 => Counts {
                vertices: add(vertices, faces)?,
                edges: edges.checked_mul(3)?,
                corners: corners.checked_mul(3)?,
                faces: faces.checked_mul(3)?,
            },
            // Each corner becomes a vertex with four sides, shared by two faces each.
            Scheme::DooSabin => Counts {
                vertices: corners,
                edges: corners.checked_mul(2)?,
                corners: corners.checked_mul(4)?,
                faces: add(add(vertices, edges)?, faces)?,
            },
        })
    }

    /// Bytes for a plan's level, and for the mesh and positions if it is the last.
    fn bytes(self) -> Option<u64> {
        let plan = self.vertices.checked_mul(4)?.checked_add(self.edges.checked_mul(16)?)?;
        let plan = plan.checked_add(self.corners.checked_mul(4)?)?;
        // Two sets of positions; faces as lists and as half-edges, with what joining them takes.
        let mesh = self.vertices.checked_mul(2 * 24 + 16)?;
        let mesh = mesh.checked_add(self.corners.checked_mul(4 * 6)?)?;
        plan.checked_add(mesh.checked_add(self.edges.checked_mul(2 * 16)?)?)
    }
}

impl RefinementOptions {
    /// The counts of each level from the cage on, and the bytes that the plan and the refined mesh need.
    ///
    /// Errors: [`Error::TooLarge`] with the first level that exceeds the memory limit or 32-bit ids.
    pub fn predict(&self, cage: Counts) -> Result<(Vec<Counts>, u64), Error> {
        // A half-edge and a corner are numbered with 32 bits, of which one value is taken.
        const IDS: u64 = 1 << 31;
        let mut counts = vec![cage];
        let mut total = 0_u64;
        for level in 0..=self.levels {
            let last = counts[level];
            let refuse = |bytes: u64, limit: u64| {
                Err(Error::TooLarge { level, faces: last.faces, bytes, limit })
            };
            let Some(bytes) = last.bytes() else {
                return refuse(u64::MAX, self.memory_limit);
            };
            if last.corners.max(2 * last.edges).max(last.vertices) >= IDS {
                return refuse(total.saturating_add(bytes), self.memory_limit.min(IDS));
            }
            // Only the last level has positions at once with the one before, which is smaller.
            let plan = 4 * last.vertices + 16 * last.edges + 4 * last.corners;
            if total.saturating_add(bytes) > self.memory_limit {
                return refuse(total.saturating_add(bytes), self.memory_limit);
            }
            if level == self.levels {
                return Ok((counts, total + bytes));
            }
            total += plan;
            match last.refined(self.scheme) {
                Some(next) => counts.push(next),
                None => return refuse(u64::MAX, self.memory_limit),
            }
        }
        unreachable!("the last level returns")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: Counts = Counts { vertices: 8, edges: 12, corners: 24, faces: 6 };

    #[test]
    fn what_would_not_fit_is_refused_with_its_size() {
        let options = RefinementOptions { levels: 10_000_000, ..RefinementOptions::default() };
        let Err(Error::TooLarge { level, faces, bytes, limit }) = options.predict(CUBE) else {
            panic!("ten million levels do not fit");
        };
        assert_eq!((faces, limit), (6 << (2 * level), 8 << 30));
        assert!(bytes > limit && level < 20, "{level} {bytes}");
        let less = RefinementOptions { levels: level - 1, ..options };
        assert!(less.predict(CUBE).unwrap().1 <= limit);
    }

    #[test]
    fn ids_run_out_before_numbers_do() {
        let options = RefinementOptions {
            levels: usize::MAX,
            memory_limit: u64::MAX,
            ..RefinementOptions::default()
        };
        assert!(
            matches!(options.predict(CUBE), Err(Error::TooLarge { limit, .. }) if limit == 1 << 31)
        );
    }
}
