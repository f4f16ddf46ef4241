//! Triangles of a polygon in space, for drawing.
//!
//! The polygon is seen along its normal (Newell's) and its ears are cut off. A polygon without an ear,
//! such as one that crosses itself, loses a corner anyway, so that the number of triangles is always
//! that of the corners less two.
//!
//! - Input: any sequence of points, repeated, collinear or crossing ones too.
//! - Cost: O(n r) for r reflex corners; beyond [`EARS`] corners a fan, which is right if convex.
//! - Reference: Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975.

use dgp_mesh::{DVec2, DVec3};

/// The most corners of a polygon that is cut ear by ear.
const EARS: usize = 4096;

/// The corners, as indices into `points`, of triangles that cover the polygon.
pub(crate) fn triangulate(points: &[DVec3], triangles: &mut Vec<[usize; 3]>) {
    let n = points.len();
    match n {
        0..3 => {}
        3 => triangles.push([0, 1, 2]),
        4 => triangles.extend(split_quad(points)),
        _ if n > EARS => triangles.extend((1..n - 1).map(|i| [0, i, i + 1])),
        _ => cut_ears(&flatten(points, normal(points)), triangles),
    }
}

/// The sum of the cross products of consecutive points: twice the area, along the normal.
pub(crate) fn normal(points: &[DVec3]) -> DVec3 {
    let Some(&first) = points.first() else { return DVec3::ZERO };
    points.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// Two triangles on both sides of the diagonal that is inside, the shorter one if both are.
fn split_quad(p: &[DVec3]) -> [[usize; 3]; 2] {
    let n = normal(p);
    let side = |a: usize, b: usize, c: usize| (p[b] - p[a]).cross(p[c] - p[a]).dot(n);
    let inside_02 = side(0, 1, 2).min(side(0, 2, 3));
    let inside_13 = side(1, 2, 3).min(side(1, 3, 0));
    let take_02 = match (inside_02 > 0.0, inside_13 > 0.0) {
        (true, true) => (p[2] - p[0]).length_squared() <= (p[3] - p[1]).length_squared(),
        (a, b) if a != b => a,
        _ => inside_02 >= inside_13,
    };
    if take_02 { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] }
}

/// The polygon in a plane, counterclockwise: the coordinate along which the normal is longest left
/// out.
fn flatten(points: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let a = normal.abs();
    let flat = |p: &DVec3| {
        if a.z >= a.x && a.z >= a.y {
            DVec2::new(
                if normal.z < 0.0 { p.y } else { p.x },
                if normal.z < 0.0 { p.x } else { p.y },
            )
        } else if a.x >= a.y {
            DVec2::new(
                if normal.x < 0.0 { p.z } else { p.y },
                if normal.x < 0.0 { p.y } else { p.z },
            )
        } else {
            DVec2::new(
                if normal.y < 0.0 { p.x } else { p.z },
                if normal.y < 0.0 { p.z } else { p.x },
            )
        }
    };
    points.iter().map(flat).collect()
}

fn cut_ears(points: &[DVec2], triangles: &mut Vec<[usize; 3]>) {
    let n = points.len();
    let mut next: Vec<usize> = (1..=n).map(|i| i % n).collect();
    let mut prev: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let turn =
        |a: usize, b: usize, c: usize| (points[b] - points[a]).perp_dot(points[c] - points[a]);
    let mut reflex: Vec<usize> = (0..n).filter(|&i| turn(prev[i], i, next[i]) <= 0.0).collect();
    let (mut left, mut i, mut misses) = (n, 0, 0);
    while left > 3 {
        let (a, b) = (prev[i], next[i]);
        let blocked = |&r: &usize| {
            let p = points[r];
            p != points[a]
                && p != points[i]
                && p != points[b]
                && turn(a, i, r) >= 0.0
                && turn(i, b, r) >= 0.0
                && turn(b, a, r) >= 0.0
        };
        let is_ear = turn(a, i, b) > 0.0 && !reflex.iter().any(blocked);
        if !is_ear && misses < left {
            (i, misses) = (b, misses + 1);
            continue;
        }
        triangles.push([a, i, b]);
        next[a] = b;
        prev[b] = a;
        reflex.retain(|&r| r != i && (r != a && r != b || turn(prev[r], r, next[r]) <= 0.0));
        // Going on after the next corner makes slimmer fans less likely.
        (left, misses, i) = (left - 1, 0, next[b]);
    }
    triangles.push([prev[i], i, next[i]]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(points: &[DVec3]) -> (usize, f64, f64) {
        let mut triangles = Vec::new();
        triangulate(points, &mut triangles);
        let n = normal(points).normalize_or_zero();
        let signed = triangles
            .iter()
            .map(|t| 0.5 * (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).dot(n));
        let (sum, least) = signed.fold((0.0, f64::MAX), |(s, m), a| (s + a, a.min(m)));
        (triangles.len(), sum, least)
    }

    #[test]
    fn a_concave_quad_is_split_at_its_notch_whichever_corner_is_first() {
        let arrow =
            [[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 3.0));
        for first in 0..4 {
            let mut turned = arrow;
            turned.rotate_left(first);
            assert_eq!(areas(&turned), (2, 1.0, 0.5), "from corner {first}");
        }
    }

    #[test]
    fn a_comb_is_covered_exactly_from_every_side() {
        // Four teeth of area 0.5 on a bar of area 7.
        let mut comb = vec![DVec3::new(0.0, -1.0, 0.0), DVec3::new(7.0, -1.0, 0.0)];
        for x in (0..4).rev() {
            let x = f64::from(2 * x);
            comb.extend([1.0, 0.5, 0.0].map(|s| DVec3::new(x + s, f64::from(s == 0.5), 0.0)));
        }
        for axis in 0..3 {
            let turned: Vec<DVec3> = comb
                .iter()
                .map(|p| match axis {
                    0 => *p,
                    1 => DVec3::new(p.y, p.z, p.x),
                    _ => DVec3::new(p.y, p.x, p.z),
                })
                .collect();
            let (count, area, least) = areas(&turned);
            assert_eq!((count, area), (12, 9.0));
            assert!(least >= 0.0, "no triangle lies outside: {least}");
        }
    }

    #[test]
    fn polygons_without_ears_still_end() {
        let star: Vec<DVec3> = (0..5)
            .map(|i| (f64::from(i) * 2.0 * std::f64::consts::TAU / 5.0).sin_cos())
            .map(|(y, x)| DVec3::new(x, y, 0.0))
            .collect();
        assert_eq!(areas(&star).0, 3);
        assert_eq!(areas(&[DVec3::ZERO; 7]).0, 5);
        assert_eq!(areas(&[DVec3::X, DVec3::NAN, DVec3::Y, DVec3::Z, DVec3::ONE]).0, 3);
    }
}
