//! Quadric error metrics: the weighted squared distances to many planes as one quadratic function.
//!
//! ```text
//! Q(p) = Σ w (n·p + d)² = pᵀ A p + 2 bᵀ p + c      A = Σ w n nᵀ,  b = Σ w d n,  c = Σ w d²
//! argmin Q:  A p = −b
//! ```
//!
//! Probabilistic quadrics take the expectation over noise of the points of a triangle; it makes A
//! positive definite, so that flat surroundings have one best point as well:
//!
//! ```text
//! Q(x) = E (N·(x − p))²    N = (p₀ − p₂) × (p₁ − p₂), coordinates of variance σ²
//! A = N Nᵀ + σ² Σ (|e|² I − e eᵀ) + 6σ⁴ I     over the three sides e
//! ```
//!
//! - Input: planes or triangles with weights.
//! - Cost: O(1) each; a system of three equations for the best point.
//! - Reference: Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997;
//!   Trettner and Kobbelt, "Fast and robust QEM based on probabilistic quadrics", Eurographics 2020.
//! - Departs from it: the optimum is sought near a given point (the middle of the edge), by damping along
//!   directions that the quadric leaves free; a quadric is kept relative to an origin of its own, without
//!   which squares of coordinates drown squares of distances.

use dgp_mesh::DVec3;

/// Weighted squared distances to planes.
///
/// Positions are relative to an origin that the caller chose and keeps in mind: [`Quadric::moved`] changes it.
///
/// ```
/// use dgp_mesh::DVec3;
/// use dgp_remesh::Quadric;
///
/// // Three planes meet where their quadric is least.
/// let mut quadric = Quadric::ZERO;
/// for (normal, point) in [(DVec3::X, 1.0), (DVec3::Y, 2.0), (DVec3::Z, 3.0)] {
///     quadric += Quadric::plane(normal, normal * point, 1.0);
/// }
/// let best = quadric.minimum_near(DVec3::ZERO, 0.0).unwrap();
/// assert!(best.distance(DVec3::new(1.0, 2.0, 3.0)) < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quadric {
    /// A by rows of its upper triangle: xx, xy, xz, yy, yz, zz.
    pub a: [f64; 6],
    /// Half of the gradient at the origin.
    pub b: DVec3,
    /// The value at the origin.
    pub c: f64,
}

impl Quadric {
    /// Zero everywhere.
    pub const ZERO: Quadric = Quadric { a: [0.0; 6], b: DVec3::ZERO, c: 0.0 };

    /// `weight` times the squared distance to the plane through `point` with unit normal `normal`.
    #[inline]
    pub fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let d = -normal.dot(point);
        Quadric { a: outer(normal, weight), b: normal * (weight * d), c: weight * d * d }
    }

    /// The squared distance to the plane of a triangle, times its area.
    #[inline]
    pub fn triangle(p: [DVec3; 3]) -> Self {
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        let twice_area = normal.length();
        if !(twice_area > 0.0) {
            return Quadric::ZERO;
        }
        Quadric::plane(normal / twice_area, p[0], 0.5 * twice_area)
    }

    /// The expected squared distance to the plane of a triangle, times its area, if each coordinate of each
    /// corner is off by a normally distributed error of standard deviation `sigma`, in the unit of lengths.
    pub fn probabilistic_triangle(p: [DVec3; 3], sigma: f64) -> Self {
        // With the last corner as origin most terms vanish.
        let [u, v] = [p[0] - p[2], p[1] - p[2]];
        let normal = u.cross(v);
        let twice_area = normal.length();
        if !(twice_area > 0.0) {
            return Quadric::ZERO;
        }
        let s2 = sigma * sigma;
        let s4 = s2 * s2;
        let mut a = outer(normal, 1.0);
        for arm in [u, v, u - v] {
            let along = outer(arm, -s2);
            for (entry, less) in a.iter_mut().zip(along) {
                *entry += less;
            }
            for k in DIAGONAL {
                a[k] += s2 * arm.length_squared();
            }
        }
        for k in DIAGONAL {
            a[k] += 6.0 * s4;
        }
        let b = -(s2 * normal.cross(u - v) + 2.0 * s4 * (u + v));
        let c = s2 * normal.length_squared()
            + 2.0 * s4 * (u.length_squared() + v.length_squared())
            + 6.0 * s4 * s2;
        // (N·x)² is the squared distance times |N|².
        let scale = 0.5 / twice_area;
        Quadric { a: a.map(|x| x * scale), b: b * scale, c: c * scale }.moved(-p[2])
    }

    /// The same function, where positions count from `origin` of the present coordinates.
    #[inline]
    pub fn moved(&self, origin: DVec3) -> Self {
        let along = self.times(origin);
        Quadric { a: self.a, b: self.b + along, c: self.c + origin.dot(2.0 * self.b + along) }
    }

    /// The value at `p`.
    #[inline]
    pub fn at(&self, p: DVec3) -> f64 {
        p.dot(self.times(p) + 2.0 * self.b) + self.c
    }

    /// A p.
    #[inline]
    pub fn times(&self, p: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        DVec3::new(
            xx * p.x + xy * p.y + xz * p.z,
            xy * p.x + yy * p.y + yz * p.z,
            xz * p.x + yz * p.y + zz * p.z,
        )
    }

    /// The sum of the weights of the planes.
    #[inline]
    pub fn weight(&self) -> f64 {
        self.a[0] + self.a[3] + self.a[5]
    }

    /// Where Q(p) + `damping` · weight · |p − near|² is least: the minimum of Q itself where that is well
    /// determined, and close to `near` along directions that the planes leave free. `None` where there
    /// is no single one: without damping, if the planes do not meet in a point.
    #[inline]
    pub fn minimum_near(&self, near: DVec3, damping: f64) -> Option<DVec3> {
        let mut a = self.a;
        let damp = damping * self.weight();
        for k in DIAGONAL {
            a[k] += damp;
        }
        let step = solve(a, -(self.times(near) + self.b))?;
        Some(near + step)
    }
}

impl std::ops::AddAssign for Quadric {
    #[inline]
    fn add_assign(&mut self, other: Quadric) {
        for (x, y) in self.a.iter_mut().zip(other.a) {
            *x += y;
        }
        self.b += other.b;
        self.c += other.c;
    }
}

impl std::ops::Add for Quadric {
    type Output = Quadric;

    #[inline]
    fn add(mut self, other: Quadric) -> Quadric {
        self += other;
        self
    }
}

/// Where `a` has its diagonal.
const DIAGONAL: [usize; 3] = [0, 3, 5];

/// weight · n nᵀ.
#[inline]
pub(crate) fn outer(n: DVec3, weight: f64) -> [f64; 6] {
    let m = n * weight;
    [m.x * n.x, m.x * n.y, m.x * n.z, m.y * n.y, m.y * n.z, m.z * n.z]
}

/// The x with A x = r for positive definite A, by LDLᵀ; `None` where a pivot is below what rounding of A
/// may have made it.
#[inline]
pub(crate) fn solve([xx, xy, xz, yy, yz, zz]: [f64; 6], r: DVec3) -> Option<DVec3> {
    let least = 64.0 * f64::EPSILON * (xx + yy + zz);
    let i0 = 1.0 / xx;
    let (l1, l2) = (xy * i0, xz * i0);
    let d1 = yy - l1 * xy;
    let off = yz - l1 * xz;
    let i1 = 1.0 / d1;
    let l3 = off * i1;
    let d2 = zz - l2 * xz - l3 * off;
    if !(xx > least && d1 > least && d2 > least) {
        return None;
    }
    let y1 = r.y - l1 * r.x;
    let y2 = r.z - l2 * r.x - l3 * y1;
    let z = y2 / d2;
    let y = y1 * i1 - l3 * z;
    let x = r.x * i0 - l1 * y - l2 * z;
    Some(DVec3::new(x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] =
        [DVec3::new(1.0, 0.2, 0.1), DVec3::new(0.3, 1.4, -0.2), DVec3::new(-0.5, 0.1, 0.7)];

    #[test]
    fn it_is_the_squared_distance_times_the_area() {
        let quadric = Quadric::triangle(CORNERS);
        let cross = (CORNERS[1] - CORNERS[0]).cross(CORNERS[2] - CORNERS[0]);
        let p = DVec3::new(0.4, 2.0, 3.0);
        let distance = (p - CORNERS[0]).dot(cross.normalize());
        let expected = 0.5 * cross.length() * distance * distance;
        assert!((quadric.at(p) - expected).abs() < 1e-13 * expected);
        for corner in CORNERS {
            assert!(quadric.at(corner).abs() < 1e-15);
        }
        let moved = quadric.moved(DVec3::new(0.1, -3.0, 0.4));
        assert!((moved.at(p - DVec3::new(0.1, -3.0, 0.4)) - expected).abs() < 1e-13 * expected);
    }

    #[test]
    fn planes_leave_their_directions_to_the_point_given() {
        let plane = Quadric::plane(DVec3::Z, DVec3::new(0.0, 0.0, 2.0), 3.0);
        assert_eq!(plane.minimum_near(DVec3::ONE, 0.0), None);
        let best = plane.minimum_near(DVec3::ONE, 1e-9).unwrap();
        assert!(best.distance(DVec3::new(1.0, 1.0, 2.0)) < 1e-8, "{best}");
    }

    #[test]
    fn expectations_do_not_depend_on_the_corner_one_starts_with_and_tend_to_the_plane() {
        let [p, q, r] = CORNERS;
        let x = DVec3::new(0.4, 2.0, 3.0);
        let values = [[p, q, r], [q, r, p], [r, p, q]]
            .map(|corners| Quadric::probabilistic_triangle(corners, 0.3).at(x));
        assert!((values[0] - values[1]).abs() < 1e-12 && (values[0] - values[2]).abs() < 1e-12);
        let sharp = Quadric::probabilistic_triangle(CORNERS, 1e-9).at(x);
        assert!((sharp - Quadric::triangle(CORNERS).at(x)).abs() < 1e-12);
    }

    #[test]
    fn expectations_are_the_mean_over_samples() {
        let sigma = 0.3;
        // Twelve uniform numbers sum to nearly a normal one.
        let mut state = 7_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let x = DVec3::new(0.4, 2.0, 3.0);
        let twice_area = (CORNERS[0] - CORNERS[2]).cross(CORNERS[1] - CORNERS[2]).length();
        let samples = 200_000;
        let mut sum = 0.0;
        for _ in 0..samples {
            let [p, q, r] = CORNERS.map(|c| c + sigma * DVec3::new(normal(), normal(), normal()));
            sum += (p - r).cross(q - r).dot(x - p).powi(2) * 0.5 / twice_area;
        }
        let expected = Quadric::probabilistic_triangle(CORNERS, sigma).at(x);
        let mean = sum / f64::from(samples);
        assert!((mean - expected).abs() < 0.02 * expected, "{mean} {expected}");
    }
}
