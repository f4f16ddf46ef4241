//! Limits against refinement itself. A vertex and the faces around it refine to a vertex and faces around it,
//! so a single fan can be refined for ever: moved to the origin and doubled after each level, which loses no
//! digit, it shows where the vertex goes, how fast, and which plane the faces turn into.

use dgp_mesh::{DVec3, FaceList, IndexedFaceSet, Mesh, Progress, VertexId};
use dgp_subdiv::{
    BoundaryRule, LoopWeights, RefinementOptions, RefinementPlan, SHARP, Scheme, Sharpness,
    StencilTable, catmull_clark::catmull_clark_vertex, loop_scheme::loop_beta,
};

const LOOP: Scheme = Scheme::Loop(LoopWeights::Original);
const CENTER: VertexId = VertexId::new(0);

/// The faces around vertex 0. Face i lies between spokes i and i + 1; the other end of spoke i is vertex
/// i + 1, and the corner of a quadrilateral across comes after those.
#[derive(Clone)]
struct Fan {
    scheme: Scheme,
    boundary: BoundaryRule,
    mesh: Mesh,
    /// Of the spokes, and of the vertex.
    spokes: Vec<f64>,
    sharpness: f64,
}

/// Numbers that look random, from -1 to 1.
fn noise(k: usize) -> f64 {
    let x = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((x ^ (x >> 29)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

impl Fan {
    /// A bumpy one. Closed if it has as many faces as spokes.
    fn new(scheme: Scheme, faces: usize, spokes: &[f64]) -> Self {
        let angle = std::f64::consts::TAU / (faces.max(3) as f64 + 0.3);
        let at = |turns: f64, radius: f64, k: usize| {
            let (sin, cos) = (turns * angle).sin_cos();
            let bump = DVec3::new(noise(3 * k), noise(3 * k + 1), 2.0 * noise(3 * k + 2));
            DVec3::new(radius * cos, radius * sin, 0.0) + 0.15 * bump
        };
        let mut positions = vec![at(0.0, 0.0, 99)];
        positions.extend((0..spokes.len()).map(|i| at(i as f64, 1.0, i)));
        if scheme == Scheme::CatmullClark {
            positions.extend((0..faces).map(|i| at(i as f64 + 0.5, 1.4, i + 40)));
        }
        let mesh = Fan::mesh(scheme, faces, spokes.len(), positions);
        let boundary = BoundaryRule::EdgeOnly;
        Fan { scheme, boundary, mesh, spokes: spokes.to_vec(), sharpness: 0.0 }
    }

    fn mesh(scheme: Scheme, faces: usize, spokes: usize, positions: Vec<DVec3>) -> Mesh {
        let corners = |i: usize| {
            let [a, b] = [1 + i, 1 + (i + 1) % spokes];
            if scheme == Scheme::CatmullClark {
                vec![0, a, 1 + spokes + i, b]
            } else {
                vec![0, a, b]
            }
        };
        let list = FaceList::from_indices(&(0..faces).map(corners).collect::<Vec<_>>());
        Mesh::new(&IndexedFaceSet::new(positions, list).unwrap()).unwrap()
    }

    fn faces(&self) -> usize {
        self.mesh.face_count()
    }

    fn plan(&self, levels: usize) -> RefinementPlan {
        let mut sharpness = Sharpness::new();
        for (i, &s) in self.spokes.iter().enumerate() {
            let h = self.mesh.halfedge_between(CENTER, VertexId::new(i + 1)).unwrap();
            if !self.mesh.is_boundary_edge(h.edge()) {
                sharpness.set_edge(h.edge(), s);
            }
        }
        sharpness.set_vertex(CENTER, self.sharpness);
        let Fan { scheme, boundary, .. } = *self;
        let options =
            RefinementOptions { scheme, levels, boundary, ..RefinementOptions::default() };
        RefinementPlan::new(&self.mesh, &sharpness, &options, Progress::NONE).unwrap()
    }

    /// The numbers that the vertices of the next fan have in the refined mesh.
    fn next_vertices(&self) -> Vec<usize> {
        let (vertices, edges) = (self.mesh.vertex_count(), self.mesh.edge_count());
        let spoke = |i: usize| {
            let h = self.mesh.halfedge_between(CENTER, VertexId::new(i + 1)).unwrap();
            vertices + h.edge().index()
        };
        let mut numbers = vec![0];
        numbers.extend((0..self.spokes.len()).map(spoke));
        if self.scheme == Scheme::CatmullClark {
            numbers.extend((0..self.faces()).map(|f| vertices + edges + f));
        }
        numbers
    }

    fn positions(&self) -> &[DVec3] {
        self.mesh.positions().values()
    }

    /// The fan of the next level.
    fn next(&self) -> Fan {
        let refined = self.plan(1).refine(self.positions()).unwrap();
        let positions = self.next_vertices().into_iter().map(|v| refined[v]).collect();
        let less = |s: f64| if s >= SHARP { SHARP } else { (s - 1.0).max(0.0) };
        Fan {
            mesh: Fan::mesh(self.scheme, self.faces(), self.spokes.len(), positions),
            spokes: self.spokes.iter().map(|&s| less(s)).collect(),
            sharpness: less(self.sharpness),
            ..*self
        }
    }

    /// The subdivision matrix by rows: the next fan from this one.
    fn matrix(&self) -> Vec<Vec<f64>> {
        let table: StencilTable = self.plan(1).step_stencils(0).unwrap();
        let row = |v: usize| {
            let mut row = vec![0.0; table.columns()];
            let (columns, weights) = table.row(v);
            columns.iter().zip(weights).for_each(|(&c, &w)| row[c as usize] = w);
            row
        };
        self.next_vertices().into_iter().map(row).collect()
    }

    /// The fan moved to the origin and doubled, given where the origin and the unit are.
    fn zoomed(mut self, origin: &mut DVec3, unit: &mut f64) -> Fan {
        let center = self.positions()[0];
        *origin += *unit * center;
        *unit /= 2.0;
        let moved: Vec<DVec3> = self.positions().iter().map(|&p| 2.0 * (p - center)).collect();
        self.mesh.set_positions(moved.into());
        self
    }

    /// The faces that `limit_tangents` speaks of: left of the first of two sharp spokes, or all.
    fn sector(&self) -> Vec<usize> {
        let first = self.mesh.vertex_halfedge(CENTER).unwrap();
        let start =
            if self.mesh.is_boundary_halfedge(first) { 0 } else { self.mesh.to(first).index() - 1 };
        let count = self.spokes.len();
        let order: Vec<usize> = (0..count).map(|k| (start + k) % count).collect();
        let sharp: Vec<usize> = (0..count).filter(|&k| self.spokes[order[k]] >= SHARP).collect();
        match sharp[..] {
            [first, second, ..] => order[first..second].to_vec(),
            _ => (0..self.faces()).collect(),
        }
    }

    /// Whether the plain rules make a tangent plane. Left of a crease of k faces the waves sin πj/k shrink like the
    /// first wave around a smooth vertex of 2k/j edges, and the way along the crease by ½. The first wave and
    /// the way along the crease span the plane if no other wave shrinks as slowly; but the second, that of k
    /// edges, has ½ where k is regular, 4 of Catmull–Clark and 6 of Loop, and more beyond.
    fn has_plane(&self) -> bool {
        let regular = if self.scheme == LOOP { 6 } else { 4 };
        let forever = self.spokes.iter().filter(|&&s| s >= SHARP).count();
        forever < 2 || self.sector().len() < regular
    }

    /// The direction of the sum of the normals of some faces at the vertex, and how far from a line they are.
    fn normal(&self, faces: &[usize]) -> (DVec3, f64) {
        let p = self.positions();
        let count = self.spokes.len();
        let sides = |f: usize| [p[1 + f] - p[0], p[1 + (f + 1) % count] - p[0]];
        let sum: DVec3 = faces.iter().map(|&f| sides(f)[0].cross(sides(f)[1])).sum();
        let squares = faces.iter().map(|&f| sides(f)[0].length_squared());
        (sum.normalize_or_zero(), sum.length() / squares.fold(0.0, f64::max))
    }

    /// Where the vertex ends up, and the normal there: refined for 200 levels, the normal from where it
    /// changed least in eight levels, as long as the fan, which may get ever thinner, is no line yet.
    fn numeric_limit(&self) -> (DVec3, DVec3, f64) {
        let (mut origin, mut unit) = (DVec3::ZERO, 1.0);
        let sector = self.sector();
        let mut fan = self.clone();
        let mut normals = Vec::new();
        for _ in 0..200 {
            fan = fan.zoomed(&mut origin, &mut unit).next();
            let (normal, width) = fan.normal(&sector);
            if width > 1e-8 {
                normals.push(normal);
            }
        }
        let changes = normals.iter().zip(&normals[8..]).map(|(a, b)| (a.distance(*b), *b));
        let (change, normal) = changes.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        (origin, normal, change)
    }
}

/// Inside: smooth, darts, creases, corners; and rims. With names and whether there is a tangent plane.
fn fans(scheme: Scheme) -> Vec<(String, Fan, bool)> {
    let mut fans = Vec::new();
    for d in 3..10 {
        let spokes = |sharp: &[(usize, f64)]| {
            let mut spokes = vec![0.0; d];
            for &(i, s) in sharp {
                spokes[i] = s;
            }
            spokes
        };
        let mut add = |name: &str, fan: Fan, has_plane| {
            fans.push((format!("{name} of {d}"), fan, has_plane));
        };
        add("smooth", Fan::new(scheme, d, &spokes(&[])), true);
        // Ends of creases: for ever, and those that wear off before or behind the vertex.
        add("dart", Fan::new(scheme, d, &spokes(&[(1, SHARP)])), true);
        add("dart that wears off", Fan::new(scheme, d, &spokes(&[(1, 2.3)])), true);
        let worn = Fan::new(scheme, d, &spokes(&[(0, SHARP), (d / 2, 1.6)]));
        add("crease that becomes a dart", worn, true);
        let worn = Fan::new(scheme, d, &spokes(&[(0, SHARP), (1, 0.7), (d / 2 + 1, SHARP)]));
        add("corner that becomes a crease", worn, true);
        add("crease", Fan::new(scheme, d, &spokes(&[(0, SHARP), (d / 2, SHARP)])), true);
        let mut blunt = Fan::new(scheme, d, &spokes(&[(2, SHARP)]));
        blunt.sharpness = 1.5;
        add("sharp dart that wears off", blunt, true);
        let mut sharp = Fan::new(scheme, d, &spokes(&[(2, SHARP)]));
        sharp.sharpness = SHARP;
        add("crease that ends in a corner", sharp, false);
        let three = spokes(&[(0, SHARP), (1, SHARP), (2, SHARP)]);
        add("three creases", Fan::new(scheme, d, &three), false);
    }
    for faces in 1..8 {
        let mut spokes = vec![0.0; faces + 1];
        (spokes[0], spokes[faces]) = (SHARP, SHARP);
        fans.push((format!("rim of {faces}"), Fan::new(scheme, faces, &spokes), true));
        let corner = Fan { sharpness: SHARP, ..Fan::new(scheme, faces, &spokes) };
        fans.push((format!("corner at a rim of {faces}"), corner, faces == 1));
        if faces > 1 {
            spokes[1] = SHARP;
            let end = Fan::new(scheme, faces, &spokes);
            fans.push((format!("crease that ends at a rim of {faces}"), end, true));
        }
    }
    let mut single = Fan::new(scheme, 1, &[SHARP, SHARP]);
    single.boundary = BoundaryRule::EdgeAndCorner;
    fans.push(("corner by rule".to_owned(), single, true));
    fans
}

#[test]
fn positions_and_normals_are_where_refinement_leads() {
    for scheme in [LOOP, Scheme::CatmullClark] {
        for (name, fan, has_plane) in fans(scheme) {
            let plan = fan.plan(0);
            let limit = plan.limit(fan.positions()).unwrap()[0];
            let (position, normal, change) = fan.numeric_limit();
            let off = limit.distance(position);
            assert!(off < 1e-12, "{scheme:?} {name}: {off:e}");
            if has_plane && fan.has_plane() {
                let [u, v] = plan.limit_tangents(fan.positions()).unwrap();
                let mine = u[0].cross(v[0]).normalize();
                let off = mine.distance(normal);
                assert!(off < 1e-6, "{scheme:?} {name}: normal off by {off:e}, {change:e}");
            }
        }
    }
}

/// w A
fn product(w: &[f64], matrix: &[Vec<f64>]) -> Vec<f64> {
    let mut product = vec![0.0; w.len()];
    for (&weight, row) in w.iter().zip(matrix) {
        row.iter().zip(&mut product).for_each(|(a, sum)| *sum += weight * a);
    }
    product
}

fn size(w: &[f64]) -> f64 {
    w.iter().fold(0.0, |size, x| size.max(x.abs()))
}

/// After n levels a vertex is off its limit by e Aⁿ p − ℓ p, where e picks it from its fan p, A is the
/// subdivision matrix and ℓ its left eigenvector of 1. So it is off by (e − ℓ) Aⁿ p, which shrinks by the largest
/// eigenvalue whose eigenvector e − ℓ has a part in. Smooth under Loop that is 5/8 − dβ of the block
/// ((1 − dβ, dβ), (3/8, 5/8)) of the vertex and the mean of its neighbors: waves around the vertex do not
/// move it. Under Catmull–Clark it is the second eigenvalue of the block of the vertex, the mean of the
/// neighbors and that of the corners across. On a crease and on a rim it is the ¼ of cubic splines, whose ½ does
/// not move the middle. At a dart the matrix says it.
#[test]
fn refinement_approaches_the_limit_at_the_rate_of_the_eigenvalue() {
    for scheme in [LOOP, Scheme::CatmullClark] {
        for (name, fan, _) in fans(scheme) {
            let wears_off = |s: &f64| *s > 0.0 && *s < SHARP;
            if fan.spokes.iter().chain([&fan.sharpness]).any(wears_off) {
                continue;
            }
            let matrix = fan.matrix();
            let stencils = fan.plan(0).limit_stencils().unwrap();
            let mut off = vec![0.0; matrix.len()];
            off[0] = 1.0;
            let (columns, weights) = stencils.row(0);
            columns.iter().zip(weights).for_each(|(&c, &w)| off[c as usize] -= w);
            if size(&off) < 1e-15 {
                // A corner is there from the start.
                assert_eq!(fan.next().positions()[0], fan.positions()[0], "{name}");
                continue;
            }
            // Refined, the vertex is off by what the matrix says, level by level.
            let limit = fan.plan(0).limit(fan.positions()).unwrap()[0];
            let (mut now, mut predicted) = (fan.clone(), off.clone());
            let mut ratio = 0.0;
            for level in 1..=10 {
                now = now.next();
                let before = size(&predicted);
                if before < 1e-10 {
                    break;
                }
                predicted = product(&predicted, &matrix);
                ratio = size(&predicted) / before;
                let parts = predicted.iter().zip(fan.positions());
                let expected: DVec3 = parts.map(|(&w, &p)| w * p).sum();
                let found = now.positions()[0] - limit;
                assert!(found.distance(expected) < 1e-14, "{name} {level}: {found} {expected}");
            }
            // For ever: the eigenvalue.
            // Until what rounding has of other eigenvectors is a millionth.
            let mut eigenvalue = ratio;
            while size(&predicted) > 1e-10 {
                let next = product(&predicted, &matrix);
                eigenvalue = size(&next) / size(&predicted);
                predicted = next;
            }
            let d = fan.faces();
            let known = if name.starts_with("smooth") {
                Some(if scheme == LOOP {
                    5.0 / 8.0 - d as f64 * loop_beta(LoopWeights::Original, d)
                } else {
                    catmull_clark_rate(d)
                })
            } else {
                (name.starts_with("crease of") || name.starts_with("rim")).then_some(0.25)
            };
            if let Some(known) = known {
                assert!(
                    (eigenvalue - known).abs() < 1e-6,
                    "{scheme:?} {name}: {eigenvalue} {known}"
                );
            }
        }
    }
}

/// The second eigenvalue of the block of the vertex v, the mean w of its neighbors and that x of the corners
/// across: F = (v + 2w + x)/4, v′ = a v + b d w + c d F, w′ = (v + w + 2F)/4, x′ = F.
fn catmull_clark_rate(d: usize) -> f64 {
    let [center, neighbor, face] = catmull_clark_vertex(d).map(|w| w * d as f64);
    let center = center / d as f64;
    let f = [0.25, 0.5, 0.25];
    let rows = [
        [center + face * f[0], neighbor + face * f[1], face * f[2]],
        [0.25 + 0.5 * f[0], 0.25 + 0.5 * f[1], 0.5 * f[2]],
        f,
    ];
    // One eigenvalue is 1, so the others have the sum and the product that are left.
    let sum = rows[0][0] + rows[1][1] + rows[2][2] - 1.0;
    let minor = |i: usize, j: usize| rows[i][i] * rows[j][j] - rows[i][j] * rows[j][i];
    let product = minor(0, 1) + minor(1, 2) + minor(0, 2) - sum;
    sum / 2.0 + (sum * sum / 4.0 - product).sqrt()
}
