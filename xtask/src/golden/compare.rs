//! When two answers count as the same.
//!
//! Counts are equal or not. Numbers may differ by what rounding explains: 1e-12 times the condition of
//! the quantity, that is, by how much it magnifies relative changes of the coordinates' differences.
//! The condition is worked out from the input alone, by formulas of this file.

use dgp_mesh::{DVec3, IndexedFaceSet, Mesh, NotManifold, VertexId, topology::components};
use serde_json::Value;

use super::facts::Facts;

/// How much more than rounding at condition 1 is allowed.
pub(crate) const TOLERANCE: f64 = 1e-12;

/// Beyond this condition the value of a peer is noise, and the element is left out and counted.
const WORST: f64 = 1e9;

/// The quantities that are compared, and their tolerances in words.
pub(crate) const QUANTITIES: [(&str, &str); 65] = [
    ("accepted", "equal"),
    ("vertices", "equal"),
    ("edges", "equal"),
    ("faces", "equal"),
    ("boundary_loops", "equal sizes"),
    ("components", "equal"),
    ("euler_characteristic", "equal"),
    ("genus", "equal"),
    ("rings", "equal hash"),
    ("face_normals", "1e-12 · L²/area"),
    ("face_areas", "1e-12 · L²"),
    ("corner_angles", "cosines to 1e-12"),
    ("corner_cotangents", "1e-12 · (L²/area)²"),
    ("vertex_normals_area", "1e-12 · condition"),
    ("vertex_normals_angle", "1e-12 · condition"),
    ("vertex_normals_max", "1e-12 · condition"),
    ("area", "1e-12 · Σ L²"),
    ("volume", "1e-12 · area · |x|"),
    ("distances", "1e-12 · largest"),
    ("principal_curvatures", "both within (h κ)² κ of the exact ones"),
    ("repaired_points", "equal"),
    ("repaired_edges", "equal"),
    ("repaired_faces", "equal"),
    ("repaired_boundary", "equal sizes"),
    ("repaired_components", "equal"),
    ("repaired_orientation", "equal up to turning a component over"),
    ("refined_loop", "1e-12 · largest coordinate"),
    ("refined_catmull_clark", "1e-12 · largest coordinate"),
    ("refined_sqrt3", "1e-12 · largest coordinate"),
    ("refined_butterfly", "1e-12 · largest coordinate"),
    ("refined_doo_sabin", "1e-12 · largest coordinate"),
    ("limits_loop", "1e-12 · largest coordinate"),
    ("limits_catmull_clark", "1e-12 · largest coordinate"),
    ("limits_at_ends", "1e-12 · largest coordinate"),
    ("limit_normals", "1e-12 · condition"),
    ("face_varying_all", "1e-12 · largest coordinate"),
    ("face_varying_none", "1e-12 · largest coordinate"),
    ("face_varying_corners_only", "1e-12 · largest coordinate"),
    ("face_varying_corners_plus_1", "1e-12 · largest coordinate"),
    ("face_varying_corners_plus_2", "1e-12 · largest coordinate"),
    ("face_varying_boundaries", "1e-12 · largest coordinate"),
    ("closest_near", "sums to 1e-12"),
    ("closest_box", "sums to 1e-12"),
    ("ray_first", "sums to 1e-9"),
    ("ray_any", "equal"),
    ("segment_any", "equal"),
    ("box_faces", "equal"),
    ("self_intersections", "equal"),
    ("self_intersects", "equal"),
    ("degenerate_faces", "equal"),
    ("needles", "equal"),
    ("caps", "equal"),
    ("joined_edges", "equal"),
    ("soup_points", "equal"),
    ("soup_polygons", "equal"),
    ("hausdorff", "intervals overlap"),
    ("decimated_mean", "ours at most 1.05 × theirs"),
    ("decimated_largest", "ours at most 1.25 × theirs"),
    ("hole_weight", "not larger by 1e-6 rad, or as bent and larger by 1e-9"),
    ("patch_energy", "not larger than 1.05 of theirs"),
    ("remeshed_low_angle", "not below the peer's by more than 0.5°"),
    ("remeshed_mean_angle", "not below the peer's by more than 0.5°"),
    ("remeshed_regular", "not below the peer's by more than 0.01"),
    ("remeshed_rms", "not above the peer's by more than 5 %"),
    ("remeshed_hausdorff", "not above the peer's by more than 10 %"),
];

/// How one quantity of one input compares.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    pub(crate) quantity: String,
    /// Numbers that were compared, and those left out because they are ill-conditioned.
    pub(crate) compared: usize,
    pub(crate) left_out: usize,
    /// The largest difference over its tolerance; above 1 they differ.
    pub(crate) worst: f64,
    pub(crate) verdict: Verdict,
}

/// Whether two answers agree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Verdict {
    Same,
    /// They differ by a convention that docs/book/golden.md explains.
    Convention(&'static str),
    Differs(String),
}

/// Compares everything a peer reports with ours.
pub(crate) fn compare(
    set: &IndexedFaceSet,
    ours: &Facts,
    theirs: &Facts,
    peer: &str,
) -> Vec<Comparison> {
    let conditions = Conditions::of(set);
    let mut comparisons = Vec::new();
    for (name, value) in &theirs.values {
        let own = ours.values.get(name).unwrap_or(&Value::Null);
        if name == "accepted" && own != value {
            let verdict = acceptance(ours, peer, value);
            return vec![Comparison::without_number(name, verdict)];
        }
        comparisons.push(conditions.single(name, own, value));
    }
    for (name, column) in &theirs.columns {
        comparisons.push(match ours.columns.get(name) {
            Some(own) => conditions.column(name, own, column),
            None => differs(name, "we have no such column".into()),
        });
    }
    comparisons
}

/// Compares which way faces look after a repair: turning all of a component over is no difference.
pub(crate) fn orientation(
    set: &IndexedFaceSet,
    ours: &Mesh,
    theirs: &IndexedFaceSet,
) -> Comparison {
    const NAME: &str = "repaired_orientation";
    let own = ours.to_indexed();
    if own.face_count() != set.face_count() || theirs.face_count() != set.face_count() {
        return differs(NAME, "the number of faces changed".into());
    }
    let components = components(ours);
    let mut votes = vec![[0_usize; 2]; components.count];
    for (f, face) in set.faces().iter() {
        let wanted = points(set, face);
        let turned = |set: &IndexedFaceSet| is_turned(&wanted, &points(set, set.faces().face(f)));
        let (Some(a), Some(b)) = (turned(&own), turned(theirs)) else {
            return differs(NAME, format!("{f} has other corners"));
        };
        if let Some(component) = components.face[f] {
            votes[component as usize][usize::from(a == b)] += 1;
        }
    }
    match votes.iter().map(|vote| vote[0].min(vote[1])).sum::<usize>() {
        0 => Comparison {
            quantity: NAME.into(),
            compared: set.face_count(),
            left_out: 0,
            worst: 0.0,
            verdict: Verdict::Same,
        },
        count => differs(NAME, format!("{count} faces look the other way")),
    }
}

fn points(set: &IndexedFaceSet, face: &[VertexId]) -> Vec<[u64; 3]> {
    face.iter().map(|&v| set.position(v).to_array().map(f64::to_bits)).collect()
}

/// Whether `face` is `wanted` walked backward; `None` if it is another.
fn is_turned(wanted: &[[u64; 3]], face: &[[u64; 3]]) -> Option<bool> {
    let rotated = |face: &[[u64; 3]]| {
        (0..face.len()).any(|k| face[k..].iter().chain(&face[..k]).eq(wanted.iter()))
    };
    let backward: Vec<[u64; 3]> = face.iter().rev().copied().collect();
    match (rotated(face), rotated(&backward)) {
        (true, _) => Some(false),
        (false, true) => Some(true),
        (false, false) => None,
    }
}

/// Why one of us takes faces the other refuses.
fn acceptance(ours: &Facts, peer: &str, theirs: &Value) -> Verdict {
    match (ours.refusal, theirs.as_bool()) {
        (Some(NotManifold::NonManifoldVertex { .. }), Some(true))
            if peer.starts_with("OpenMesh") =>
        {
            Verdict::Convention("bow-ties")
        }
        (Some(NotManifold::DegenerateFace { .. }), Some(true)) if peer.starts_with("OpenMesh") => {
            Verdict::Convention("degenerate faces")
        }
        (Some(NotManifold::NonFinite { .. }), Some(true)) => Verdict::Convention("no numbers"),
        (Some(reason), _) => Verdict::Differs(format!("we refuse ({reason}), {peer} accepts")),
        (None, _) => Verdict::Differs(format!("we accept, {peer} refuses")),
    }
}

impl Comparison {
    /// A verdict on something that is no number.
    pub(crate) fn without_number(quantity: &str, verdict: Verdict) -> Self {
        Comparison {
            quantity: quantity.into(),
            compared: 1,
            left_out: 0,
            worst: f64::INFINITY,
            verdict,
        }
    }
}

fn differs(name: &str, message: String) -> Comparison {
    Comparison::without_number(name, Verdict::Differs(message))
}

/// How ill-conditioned each element of an input is.
struct Conditions<'a> {
    set: &'a IndexedFaceSet,
    /// Square of the longest side of each face, or of its largest coordinate where it is no triangle.
    square: Vec<f64>,
    /// Sum of the cross products around each face, twice its area long.
    cross: Vec<DVec3>,
}

impl<'a> Conditions<'a> {
    fn of(set: &'a IndexedFaceSet) -> Self {
        let (mut square, mut cross) = (Vec::new(), Vec::new());
        for (_, face) in set.faces().iter() {
            let points: Vec<DVec3> = face.iter().map(|&v| set.position(v)).collect();
            let count = points.len();
            let sides = (0..count).map(|i| points[(i + 1) % count].distance_squared(points[i]));
            let longest = sides.fold(0.0, f64::max);
            let largest = points.iter().map(|p| p.length_squared()).fold(longest, f64::max);
            square.push(if count == 3 { longest } else { largest });
            let fan = (1..count.saturating_sub(1))
                .map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0]));
            cross.push(fan.sum());
        }
        Conditions { set, square, cross }
    }

    /// L² over the area of each face.
    fn faces(&self) -> Vec<f64> {
        self.square
            .iter()
            .zip(&self.cross)
            .map(|(square, cross)| (square / cross.length()).max(1.0))
            .collect()
    }

    /// A value of the condition of its face for each corner.
    fn corners(&self, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let faces = self.faces().into_iter().zip(self.set.faces().iter());
        faces
            .flat_map(|(condition, (_, face))| std::iter::repeat_n(f(condition), face.len()))
            .collect()
    }

    /// Of the sum of weight · normal at each vertex: Σ weight · condition over the length of the sum.
    fn vertices(&self, name: &str) -> Vec<f64> {
        let faces = self.faces();
        let mut sums = vec![(0.0, DVec3::ZERO); self.set.vertex_count()];
        for (f, face) in self.set.faces().iter() {
            let normal = self.cross[f.index()].normalize_or_zero();
            for k in 0..face.len() {
                let at = |i: usize| self.set.position(face[(k + i) % face.len()]);
                let (u, v) = (at(1) - at(0), at(face.len() - 1) - at(0));
                let weight = match name {
                    "vertex_normals_area" => self.cross[f.index()].length(),
                    "vertex_normals_angle" => u.cross(v).length().atan2(u.dot(v)),
                    _ => u.cross(v).length() / (u.length_squared() * v.length_squared()),
                };
                let (total, sum) = &mut sums[face[k].index()];
                *total += weight * faces[f.index()];
                *sum += weight * normal;
            }
        }
        sums.iter().map(|(total, sum)| (total / sum.length()).max(1.0)).collect()
    }

    fn single(&self, name: &str, ours: &Value, theirs: &Value) -> Comparison {
        let scale = match name {
            "area" => self.square.iter().sum::<f64>(),
            "volume" => {
                let farthest =
                    self.set.positions().values().iter().map(|p| p.length()).fold(0.0, f64::max);
                0.5 * self.cross.iter().map(|c| c.length()).sum::<f64>() * farthest
            }
            _ => 0.0,
        };
        let same = match (ours.as_f64(), theirs.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= TOLERANCE * scale,
            _ => numbers(ours) == numbers(theirs) && ours.as_str() == theirs.as_str(),
        };
        let worst = match (ours.as_f64(), theirs.as_f64()) {
            (Some(a), Some(b)) if scale > 0.0 => (a - b).abs() / (TOLERANCE * scale),
            _ if same => 0.0,
            _ => f64::INFINITY,
        };
        if !same {
            return Comparison { worst, ..differs(name, format!("{ours} instead of {theirs}")) };
        }
        Comparison {
            quantity: name.into(),
            compared: 1,
            left_out: 0,
            worst,
            verdict: Verdict::Same,
        }
    }

    fn column(&self, name: &str, ours: &[f64], theirs: &[f64]) -> Comparison {
        if ours.len() != theirs.len() {
            return differs(name, format!("{} numbers instead of {}", ours.len(), theirs.len()));
        }
        let faces = || self.faces();
        let (width, allowed): (usize, Vec<f64>) = match name {
            "face_normals" => (3, faces()),
            "vertex_normals_area" | "vertex_normals_angle" | "vertex_normals_max" => {
                (3, self.vertices(name))
            }
            "face_areas" => (1, self.square.clone()),
            "corner_angles" => (1, vec![1.0; ours.len()]),
            "corner_cotangents" => (1, self.corners(|condition| condition * condition)),
            _ => (1, vec![ours.iter().copied().fold(0.0, f64::max); ours.len()]),
        };
        let relative = width == 3;
        let (mut compared, mut left_out, mut worst, mut at) = (0, 0, 0.0, 0);
        for (i, (a, b)) in ours.chunks(width).zip(theirs.chunks(width)).enumerate() {
            // Written so that a condition of 0/0 is left out as well.
            let usable = allowed[i] < WORST || !relative && allowed[i].is_finite();
            if !usable {
                left_out += 1;
                continue;
            }
            compared += 1;
            let difference = match name {
                "corner_angles" => (a[0].cos() - b[0].cos()).abs(),
                _ => a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt(),
            };
            let ratio = if difference == 0.0 { 0.0 } else { difference / (TOLERANCE * allowed[i]) };
            if ratio > worst || ratio.is_nan() {
                (worst, at) = (if ratio.is_nan() { f64::INFINITY } else { ratio }, i);
            }
        }
        let verdict = if worst <= 1.0 {
            Verdict::Same
        } else {
            let [a, b] = [ours, theirs].map(|column| &column[at * width..(at + 1) * width]);
            Verdict::Differs(format!(
                "element {at}: {a:?} instead of {b:?}, {worst:.1} times the tolerance"
            ))
        };
        Comparison { quantity: name.into(), compared, left_out, worst, verdict }
    }
}

/// Numbers of a value, so that 3 and 3.0 are the same.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().filter_map(Value::as_f64).collect(),
        Value::Bool(truth) => vec![f64::from(u8::from(*truth))],
        other => other.as_f64().into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::facts;
    use dgp_mesh::shapes::icosphere;

    fn sphere() -> (IndexedFaceSet, Facts) {
        let set = icosphere(1).unwrap().to_indexed();
        let facts = facts::ours(&set);
        (set, facts)
    }

    fn differing(set: &IndexedFaceSet, ours: &Facts, theirs: &Facts) -> Vec<String> {
        let all = compare(set, ours, theirs, "a peer");
        all.into_iter().filter(|c| c.verdict != Verdict::Same).map(|c| c.quantity).collect()
    }

    #[test]
    fn facts_equal_themselves_and_every_change_beyond_rounding_is_seen() {
        let (set, ours) = sphere();
        assert_eq!(differing(&set, &ours, &ours), [""; 0]);
        for name in ours.columns.keys() {
            let mut theirs = ours.clone();
            theirs.columns.get_mut(name).unwrap()[4] += 1e-9;
            assert_eq!(differing(&set, &ours, &theirs), [name.as_str()]);
        }
        for name in ours.values.keys().filter(|name| *name != "rings") {
            let mut theirs = ours.clone();
            let changed = ours.values[name].as_f64().unwrap_or(1.0) + 1e-9;
            theirs.values.insert(name.clone(), changed.into());
            assert_eq!(differing(&set, &ours, &theirs), [name.as_str()]);
        }
    }

    #[test]
    fn turning_a_whole_component_over_is_no_difference_and_turning_part_is() {
        let (set, _) = sphere();
        let mesh = Mesh::new(&set).unwrap();
        let turned = |faces: usize| {
            let mut lists = crate::raw::faces(&set);
            for face in lists.iter_mut().take(faces) {
                face.reverse();
            }
            IndexedFaceSet::new(set.positions().clone(), dgp_mesh::FaceList::from_indices(&lists))
        };
        let verdict = |faces| orientation(&set, &mesh, &turned(faces).unwrap()).verdict;
        assert_eq!((verdict(0), verdict(80)), (Verdict::Same, Verdict::Same));
        assert!(matches!(verdict(3), Verdict::Differs(_)));
    }

    #[test]
    fn bow_ties_are_a_convention_of_openmesh_only() {
        let ours = Facts {
            refusal: Some(NotManifold::NonManifoldVertex { vertex: dgp_mesh::VertexId::new(0) }),
            ..Facts::default()
        };
        assert_eq!(acceptance(&ours, "OpenMesh", &true.into()), Verdict::Convention("bow-ties"));
        assert!(matches!(acceptance(&ours, "CGAL", &true.into()), Verdict::Differs(_)));
    }

    #[test]
    fn every_quantity_we_report_is_in_the_list() {
        let (_, ours) = sphere();
        for name in ours.values.keys().chain(ours.columns.keys()) {
            assert!(QUANTITIES.iter().any(|(known, _)| known == name), "{name}");
        }
    }
}
