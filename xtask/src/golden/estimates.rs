//! Principal curvatures beside those that CGAL fits: two estimators that agree with each other no better than each
//! with the surface, so both are compared with the exact values of surfaces that have formulas.
//!
//! ```text
//! e = √(Σ area ((κ₁ − k₁)² + (κ₂ − k₂)²) / Σ area)   ≤   (h κ)² κ
//! ```
//!
//! with the mean edge length h and the largest curvature κ: some percent here, far below what a wrong sign or factor does.
//! Where edges are halved, e falls as theory says: differences of normals of order 2 over edges have order 1, and 2 where
//! rings are symmetric; jets of degree d have order d − 1 (Cazals and Pouget 2005), here 3.

use std::{fs, path::Path};

use dgp_mesh::{
    DVec3, Mesh, VertexId, VertexMap,
    curvature::principal_curvatures,
    measure::{VertexArea, edge_length_range, vertex_areas},
    shapes,
};

use super::{Facts, Table, Verdict, compare::Comparison};
use crate::{peers::Peers, raw, shell::Outcome};

const QUANTITY: &str = "principal_curvatures";

/// The orders of our estimator and of CGAL's, less a tenth for meshes of finite size.
const ORDERS: [(&str, f64); 2] = [("ours", 0.9), ("CGAL's", 2.7)];

/// A surface with a formula, coarse and fine.
struct Surface {
    name: &'static str,
    meshes: [Mesh; 2],
    /// κ₁ ≥ κ₂ at a point, positive where it bends away from the outward normal.
    exact: fn(DVec3) -> [f64; 2],
    /// The largest curvature.
    most: f64,
}

const AXES: DVec3 = DVec3::new(1.0, 1.3, 1.7);

fn surfaces() -> Outcome<[Surface; 2]> {
    let ellipsoid = |level: usize| -> Outcome<Mesh> {
        let mut mesh = shapes::icosphere(level)?;
        mesh.set_positions(mesh.positions().map(|&p| AXES * p));
        Ok(mesh)
    };
    Ok([
        Surface {
            name: "ellipsoid",
            meshes: [ellipsoid(4)?, ellipsoid(5)?],
            exact: of_ellipsoid,
            // Where the longest axis ends: c/a².
            most: AXES.z / AXES.x.powi(2),
        },
        Surface {
            name: "torus",
            meshes: [shapes::torus(2.0, 1.0, 96, 48)?, shapes::torus(2.0, 1.0, 192, 96)?],
            exact: of_torus,
            most: 1.0,
        },
    ])
}

/// K = 1/(a²b²c² s²) and H = (a² + b² + c² − |p|²)/(2 a²b²c² s^(3/2)) with s = x²/a⁴ + y²/b⁴ + z²/c⁴.
fn of_ellipsoid(p: DVec3) -> [f64; 2] {
    let product = (AXES.x * AXES.y * AXES.z).powi(2);
    let s = (p / (AXES * AXES)).length_squared();
    let gaussian = 1.0 / (product * s * s);
    let mean = (AXES.length_squared() - p.length_squared()) / (2.0 * product * s.powf(1.5));
    let root = (mean * mean - gaussian).max(0.0).sqrt();
    [mean + root, mean - root]
}

/// 1 around the tube of radius 1, cos v/(2 + cos v) along it.
fn of_torus(p: DVec3) -> [f64; 2] {
    let cosine = p.x.hypot(p.y) - 2.0;
    [1.0, cosine / (2.0 + cosine)]
}

/// Compares on all surfaces, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    for surface in surfaces()? {
        let mut errors = [[0.0; 2]; 2];
        for (i, mesh) in surface.meshes.iter().enumerate() {
            let path = folder.join(format!("{}-{i}.raw", surface.name));
            raw::write(&path, &mesh.to_indexed())?;
            let mut theirs = Facts::default();
            theirs.add(&peers.cgal, "curvature", &path, &path.with_extension("cgal"))?;
            fs::remove_file(path)?;
            let found = their_curvatures(&theirs).ok_or("CGAL told no curvatures")?;
            errors[0][i] = surface.error(mesh, &our_curvatures(mesh)?);
            errors[1][i] = surface.error(mesh, &found);
        }
        for (who, errors) in ["dgp", "CGAL"].into_iter().zip(errors) {
            println!(
                "{QUANTITY} of the {}, {who}: {:.3e}, {:.3e}",
                surface.name, errors[0], errors[1]
            );
        }
        table.add(surface.name, "CGAL", vec![surface.judge(errors)]);
    }
    Ok(())
}

fn our_curvatures(mesh: &Mesh) -> Outcome<VertexMap<[f64; 2]>> {
    Ok(principal_curvatures(mesh)?.map(|k| [k.max, k.min]))
}

/// CGAL counts curvatures as positive where the surface bends toward the normal it was given, the outward one.
fn their_curvatures(facts: &Facts) -> Option<VertexMap<[f64; 2]>> {
    let (most, least) = (facts.columns.get("curvature_max")?, facts.columns.get("curvature_min")?);
    Some(most.iter().zip(least).map(|(a, b)| [-b, -a]).collect::<Vec<_>>().into())
}

impl Surface {
    fn error(&self, mesh: &Mesh, found: &VertexMap<[f64; 2]>) -> f64 {
        let areas = vertex_areas(mesh, VertexArea::Barycentric);
        let square = |v: VertexId| {
            let exact = (self.exact)(mesh.position(v));
            (0..2).map(|k| (found[v][k] - exact[k]).powi(2)).sum::<f64>()
        };
        let total: f64 = areas.values().iter().sum();
        (mesh.vertices().map(|v| areas[v] * square(v)).sum::<f64>() / total).sqrt()
    }

    /// Ours and theirs, coarse and fine.
    fn judge(&self, errors: [[f64; 2]; 2]) -> Comparison {
        let tolerance = |mesh: &Mesh| {
            let h = edge_length_range(mesh).map_or(0.0, |range| range.mean);
            (h * self.most).powi(2) * self.most
        };
        let allowed = [0, 1].map(|i| tolerance(&self.meshes[i]));
        let mut worst = 0.0_f64;
        let mut verdict = Verdict::Same;
        for ((who, least), errors) in ORDERS.into_iter().zip(errors) {
            for i in 0..2 {
                worst = worst.max(errors[i] / allowed[i]);
            }
            let order = (errors[0] / errors[1]).log2();
            if order < least {
                verdict = Verdict::Differs(format!("{who} converge with order {order:.2} only"));
            }
        }
        if worst > 1.0 {
            verdict = Verdict::Differs(format!("off by {worst:.2} times (h κ)² κ: {errors:?}"));
        }
        let compared = self.meshes.iter().map(|mesh| 2 * mesh.vertex_count()).sum();
        Comparison { quantity: QUANTITY.into(), compared, left_out: 0, worst, verdict }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ours_are_within_the_tolerance_and_a_wrong_sign_is_not() {
        for surface in surfaces().unwrap() {
            let both = surface.meshes.each_ref().map(|mesh| our_curvatures(mesh).unwrap());
            let errors = |found: &[VertexMap<[f64; 2]>; 2]| {
                [0, 1].map(|i| surface.error(&surface.meshes[i], &found[i]))
            };
            let ours = errors(&both);
            // As if CGAL's were exact from order 3 on.
            let same = surface.judge([ours, [8e-4, 1e-4]]);
            assert_eq!(same.verdict, Verdict::Same, "{}: {ours:?}", surface.name);
            let turned = errors(&both.map(|found| found.map(|k| [-k[1], -k[0]])));
            let verdict = surface.judge([turned, [8e-4, 1e-4]]).verdict;
            assert!(matches!(verdict, Verdict::Differs(_)), "{}: {turned:?}", surface.name);
        }
    }

    #[test]
    fn the_formulas_are_those_of_a_sphere_where_axes_end() {
        // At the end of the longest axis: c/a² and c/b².
        let [most, least] = of_ellipsoid(DVec3::Z * AXES.z);
        assert!((most - AXES.z).abs() < 1e-14 && (least - AXES.z / 1.69).abs() < 1e-14);
        assert_eq!(of_torus(DVec3::new(3.0, 0.0, 0.0)), [1.0, 1.0 / 3.0]);
    }
}
