//! By how much the surroundings of a new vertex count in its data.

use glam::DVec3;

/// Which fraction of the way from `a` to `b` the point of the edge nearest to `p` lies, in 0..=1;
/// one half if there is no way.
pub(super) fn fraction_along(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    if p == a || p == b {
        return if p == a && p == b { 0.5 } else { f64::from(u8::from(p == b)) };
    }
    // In units of the edge, so that no square overflows or vanishes.
    let way = b - a;
    let size = way.abs().max_element();
    let (way, to_p) = (way / size, (p - a) / size);
    let x = to_p.dot(way) / way.length_squared();
    if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.5 }
}

/// Weights of `corners` that sum to 1, are not negative, and average the corners to `p` if it is in
/// the plane of a planar convex polygon: of all such weights those that differ least from equal ones.
///
/// ```text
/// w_i = 1/n + d_i · S⁺ (p − c)       d_i = p_i − c,  S = Σ d_i d_iᵀ,  c = mean of the corners
/// ```
///
/// Where `p` is off the plane its nearest point in it counts; where it is outside of the polygon,
/// negative weights become zero.
pub(super) fn corner_weights(p: DVec3, corners: &[DVec3]) -> Vec<f64> {
    let equal = 1.0 / corners.len() as f64;
    let center = corners.iter().map(|&q| q * equal).sum::<DVec3>();
    let size = corners.iter().map(|&q| (q - center).abs().max_element()).fold(0.0, f64::max);
    let arms: Vec<DVec3> = corners.iter().map(|&q| (q - center) / size).collect();
    // How far rounded coordinates may put corners off a line or plane that they are on: some units
    // in the last place of the largest, in units of the face. Ten times less would let rounding push
    // points of slivers outside; ten times more would flatten more faces than need be.
    let largest = corners.iter().map(|q| q.abs().max_element()).fold(0.0, f64::max);
    let basis = basis_of(&arms, 64.0 * f64::EPSILON * (largest / size));
    let pull = basis.map(|direction| (p - center).dot(direction) / size);
    let coordinates = basis.map(|direction| centered(arms.iter().map(|d| d.dot(direction))));
    let solution = solve(&coordinates, pull);
    let weight = |i: usize| {
        let offset: f64 = (0..3).map(|k| coordinates[k][i] * solution[k]).sum();
        (equal + offset).max(0.0)
    };
    let mut weights: Vec<f64> = (0..corners.len()).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    if sum.is_finite() && sum > 0.0 {
        for weight in &mut weights {
            *weight /= sum;
        }
    } else {
        weights.fill(equal);
    }
    weights
}

/// Values less their mean. Corners that nearly lie on a line have coordinates off it that are little
/// more than rounding; their sum must vanish all the same, for the solution is large in return.
fn centered(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    for value in &mut values {
        *value -= mean;
    }
    values
}

/// Orthonormal directions that span `arms`, found by repeatedly taking the arm farthest from what is
/// spanned so far; zero where arms span no more than `negligible` beyond that.
fn basis_of(arms: &[DVec3], negligible: f64) -> [DVec3; 3] {
    let mut basis = [DVec3::ZERO; 3];
    let mut rest = arms.to_vec();
    for k in 0..3 {
        let Some(&farthest) = rest.iter().max_by(|a, b| a.length().total_cmp(&b.length())) else {
            break;
        };
        if farthest.length().is_nan() || farthest.length() <= negligible {
            break;
        }
        // Subtracting what is spanned a second time removes what rounding left of it.
        let direction = farthest.normalize();
        let along: DVec3 = basis.iter().map(|&b| b * b.dot(direction)).sum();
        basis[k] = (direction - along).normalize();
        for arm in &mut rest {
            *arm -= basis[k] * arm.dot(basis[k]);
        }
    }
    basis
}

/// The x with Σ c_i c_iᵀ x = pull, by Gaussian elimination of the positive semidefinite matrix; zero
/// along directions in which all coordinates vanish.
fn solve(coordinates: &[Vec<f64>; 3], pull: [f64; 3]) -> [f64; 3] {
    let mut rows = [[0.0; 4]; 3];
    for i in 0..3 {
        for j in 0..3 {
            rows[i][j] = coordinates[i].iter().zip(&coordinates[j]).map(|(a, b)| a * b).sum();
        }
        rows[i][3] = pull[i];
    }
    for k in 0..3 {
        let pivot = rows[k];
        for row in &mut rows[k + 1..] {
            let factor = if pivot[k] > 0.0 { row[k] / pivot[k] } else { 0.0 };
            for (entry, p) in row.iter_mut().zip(pivot) {
                *entry -= factor * p;
            }
        }
    }
    let mut x = [0.0; 3];
    for k in (0..3).rev() {
        let known: f64 = (k + 1..3).map(|j| rows[k][j] * x[j]).sum();
        x[k] = if rows[k][k] > 0.0 { (rows[k][3] - known) / rows[k][k] } else { 0.0 };
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_average_the_corners_to_the_point() {
        let triangle = [DVec3::X, DVec3::Y, DVec3::new(0.3, 0.1, 2.0)];
        let weights =
            corner_weights(0.2 * triangle[0] + 0.5 * triangle[1] + 0.3 * triangle[2], &triangle);
        for (weight, expected) in weights.iter().zip([0.2, 0.5, 0.3]) {
            assert!((weight - expected).abs() < 1e-14, "{weights:?}");
        }
        let quad = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.4), DVec3::Y];
        let p = DVec3::new(0.4, 0.6, 0.15);
        let average: DVec3 = corner_weights(p, &quad).iter().zip(quad).map(|(&w, q)| w * q).sum();
        assert!(average.distance(p) < 1e-14, "{average}");
    }

    #[test]
    fn slivers_reproduce_points_as_well() {
        for thickness in [1e-5, 1e-9, 1e-11, 1e-13, 0.0] {
            let (along, off) = (DVec3::new(0.3, 0.8, -0.4), DVec3::new(0.8, -0.3, 0.1));
            let sliver =
                [DVec3::ONE, DVec3::ONE + along, DVec3::ONE + 0.4 * along + thickness * off];
            let p = 0.3 * sliver[0] + 0.3 * sliver[1] + 0.4 * sliver[2];
            let average: DVec3 =
                corner_weights(p, &sliver).iter().zip(sliver).map(|(&w, q)| w * q).sum();
            assert!(
                average.distance(p) < 1e-15 + thickness.min(1e-12),
                "{thickness}: {}",
                average - p
            );
        }
    }

    #[test]
    fn degenerate_faces_have_equal_weights() {
        assert_eq!(corner_weights(DVec3::X, &[DVec3::Y; 3]), [1.0 / 3.0; 3]);
        let huge = [DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 1e308);
        assert!(corner_weights(-huge[0], &huge).iter().all(|w| w.is_finite()));
    }

    #[test]
    fn fractions_do_not_depend_on_the_scale() {
        let (p, a, b) = (DVec3::new(0.3, 0.2, 0.0), DVec3::ZERO, DVec3::new(1.0, 0.7, 0.1));
        let fraction = fraction_along(p, a, b);
        for scale in [2_f64.powi(-1000), 2_f64.powi(1000)] {
            assert_eq!(fraction_along(p * scale, a * scale, b * scale), fraction);
        }
        assert_eq!(fraction_along(p, a, a), 0.5);
        assert_eq!(fraction_along(b * 2.0, a, b), 1.0);
    }
}
