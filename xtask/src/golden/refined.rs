//! Refined meshes beside those of OpenMesh, CGAL and OpenSubdiv: vertices are matched by position, then
//! faces must be the same lists of them.
//!
//! Where a peer has another rule at rims of holes, and docs/book/golden.md names it, what no face near a
//! rim has a part in must still be the same.

use std::{fmt::Write, fs, path::Path};

use dgp_mesh::{DVec3, EdgeId, FaceId, FaceList, IndexedFaceSet, Mesh, Progress, VertexId, shapes};
use dgp_subdiv::{BoundaryRule, RefinementOptions, RefinementPlan, SHARP, Sharpness};

use super::{
    Facts, Table, Verdict, charts,
    compare::{Comparison, TOLERANCE},
};
use crate::{
    drive::subdivision::scheme,
    peers::{Driver, Peers},
    raw,
    shell::Outcome,
};

/// How far apart two vertices may be to be looked at as the same, of the largest coordinate.
const REACH: f64 = 1e-9;

/// The rules of peers that differ at rims, by peer and scheme; docs/book/golden.md explains them.
const OTHER_RIMS: [(&str, &str); 1] = [("OpenMesh", "catmull-clark")];

/// A cage with what is sharp in it.
pub(super) struct Cage {
    pub(super) name: String,
    pub(super) mesh: Mesh,
    pub(super) sharpness: Sharpness,
    pub(super) boundary: BoundaryRule,
}

pub(super) fn meshes(quads: bool) -> Outcome<Vec<(&'static str, Mesh)>> {
    let shapes = if quads {
        vec![
            ("cube", shapes::cube()),
            ("dodecahedron", shapes::dodecahedron()),
            ("football", shapes::truncated_icosahedron()),
            ("quad-torus", shapes::quad_torus(2.0, 0.5, 7, 5)?),
            ("quads-of-genus-2", shapes::quad_surface_of_genus(2, 1)?),
            ("quad-grid", shapes::quad_grid(8, 7)?),
            ("capped-cylinder", shapes::capped_cylinder(1.0, 2.0, 5, 2)?),
        ]
    } else {
        vec![
            ("tetrahedron", shapes::tetrahedron()),
            ("octahedron", shapes::octahedron()),
            ("icosphere", shapes::icosphere(1)?),
            ("torus", shapes::torus(2.0, 0.5, 7, 5)?),
            ("cone", shapes::capped_cone(1.0, 2.0, 9, 2)?),
            ("grid", shapes::grid(8, 7)?),
            // Wide enough for faces that are two rings from both rims.
            ("annulus", shapes::annulus(0.4, 1.0, 9, 8)?),
            ("holed-sphere", shapes::with_holes(&shapes::icosphere(2)?, 2, 1, 3)?),
        ]
    };
    // Noise, so that no two vertices are where another is.
    let noisy = shapes.into_iter().zip(1..);
    noisy.map(|((name, mesh), seed)| Ok((name, shapes::with_noise(mesh, 0.05, seed)?))).collect()
}

/// Compares all schemes on all cages with all peers that have them, and notes it in the table.
pub(super) fn compare(peers: &Peers, folder: &Path, table: &mut Table) -> Outcome<()> {
    type Peer<'a> = (&'a str, &'a Driver);
    let schemes: [(&str, bool, &[Peer<'_>]); 5] = [
        ("loop", false, &[("OpenMesh", &peers.openmesh), ("CGAL", &peers.cgal)]),
        ("catmull-clark", true, &[("OpenMesh", &peers.openmesh), ("CGAL", &peers.cgal)]),
        ("sqrt3", false, &[("OpenMesh", &peers.openmesh), ("CGAL", &peers.cgal)]),
        ("butterfly", false, &[("OpenMesh", &peers.openmesh)]),
        ("doo-sabin", true, &[("CGAL", &peers.cgal)]),
    ];
    for (name, quads, drivers) in schemes {
        let mut cages = meshes(quads)?;
        if quads {
            cages.extend(meshes(false)?);
        }
        for (shape, mesh) in cages {
            let cage = Cage {
                name: shape.into(),
                mesh,
                sharpness: Sharpness::new(),
                boundary: BoundaryRule::EdgeOnly,
            };
            for levels in 1..=3 {
                for (peer, driver) in drivers {
                    cage.compare(name, levels, (peer, driver), folder, table)?;
                }
            }
        }
    }
    let Some(driver) = &peers.opensubdiv else { return Ok(()) };
    for (name, quads) in [("loop", false), ("catmull-clark", true)] {
        let mut cages = meshes(quads)?;
        if quads {
            cages.extend(meshes(false)?);
        }
        for (shape, mesh) in cages {
            for (kind, boundary) in
                [("edge", BoundaryRule::EdgeOnly), ("corner", BoundaryRule::EdgeAndCorner)]
            {
                for sharpness in [Sharpness::new(), some_sharpness(&mesh)] {
                    let tags = if sharpness.is_smooth() { "smooth" } else { "creased" };
                    let name_of = format!("{shape}-{kind}-{tags}");
                    let cage = Cage { name: name_of, mesh: mesh.clone(), sharpness, boundary };
                    for levels in 1..=4 {
                        cage.compare(name, levels, ("OpenSubdiv", driver), folder, table)?;
                    }
                }
            }
        }
    }
    charts::compare(driver, folder, table)
}

/// Every rule somewhere; all values are exact in 32 bits, which OpenSubdiv keeps them in.
pub(super) fn some_sharpness(mesh: &Mesh) -> Sharpness {
    let mut sharpness = Sharpness::new();
    let values = [0.0, 0.25, 1.0, 1.75, SHARP, 0.0, 2.5, 0.0, 0.0];
    for e in mesh.edges() {
        sharpness.set_edge(e, values[e.index() % values.len()]);
    }
    sharpness.set_vertex(VertexId::new(1), 0.625);
    sharpness.set_vertex(VertexId::new(2), SHARP);
    sharpness
}

/// After how many levels `some_sharpness` has worn off; limits of OpenSubdiv take for granted that it has.
const WORN_OFF: usize = 3;

impl Cage {
    fn compare(
        &self,
        name: &str,
        levels: usize,
        (peer, driver): (&str, &Driver),
        folder: &Path,
        table: &mut Table,
    ) -> Outcome<()> {
        let quantity = format!("refined_{}", name.replace('-', "_"));
        let label = format!("{}, {levels} levels", self.name);
        let path = folder.join("cage.raw");
        raw::write(&path, &self.mesh.to_indexed())?;
        let tags = folder.join("cage.tags");
        fs::write(&tags, self.tags()?)?;
        let prefix = folder.join("refined");
        let (count, tag_file) = (levels.to_string(), tags.to_string_lossy());
        let options = ["--scheme", name, "--levels", &count, "--tags", &tag_file];
        let mut facts = Facts::default();
        if let Err(error) = facts.add_with(driver, "subdivide", &path, &prefix, &options) {
            let verdict = Verdict::Differs(format!("no answer: {error}"));
            table.add(&label, peer, vec![Comparison::without_number(&quantity, verdict)]);
            return Ok(());
        }
        let written = folder.join("refined.raw");
        let theirs = raw::read(&written)?;
        for file in [&path, &tags, &written] {
            fs::remove_file(file)?;
        }

        let scheme = scheme(name)?;
        let options = RefinementOptions {
            scheme,
            levels,
            boundary: self.boundary,
            ..RefinementOptions::default()
        };
        let plan = RefinementPlan::new(&self.mesh, &self.sharpness, &options, Progress::NONE)?;
        let positions = plan.refine(self.mesh.positions().values())?;
        let faces = listed(&plan.faces(levels));
        let matching = Matching::new(&positions, &theirs);
        let mut verdict = matching.verdict(&faces, &theirs);
        if verdict != Verdict::Same
            && OTHER_RIMS.contains(&(peer, name))
            && let Some(inside) = self.inside(&plan)
            && inside.iter().all(|&v| matching.partner[v].is_some())
        {
            verdict = Verdict::Convention("rims");
        }
        let worst = matching.worst / TOLERANCE;
        let mut comparisons = vec![Comparison {
            quantity,
            compared: 3 * positions.len(),
            left_out: 0,
            worst,
            verdict: verdict.clone(),
        }];
        let settled = self.sharpness.is_smooth() || levels >= WORN_OFF;
        if peer == "OpenSubdiv" && verdict == Verdict::Same && settled {
            comparisons.extend(self.limits(name, &plan, &positions, &matching, &facts)?);
        }
        table.add(&label, peer, comparisons);
        Ok(())
    }

    /// Whether a vertex of the cage, and so of each level, is where a crease that stays sharp ends.
    fn is_dart(&self, vertex: usize) -> bool {
        if vertex >= self.mesh.vertex_count() {
            return false;
        }
        let v = VertexId::new(vertex);
        let is_sharp = |e: EdgeId| self.mesh.is_boundary_edge(e) || self.sharpness.edge(e) >= SHARP;
        let sharp = self.mesh.vertex_halfedges(v).filter(|h| is_sharp(h.edge())).count();
        sharp == 1 && self.sharpness.vertex(v) < SHARP
    }

    /// Limit positions, and normals where nothing is sharp. At ends of creases OpenSubdiv takes the mask of smooth
    /// vertices, and at rims the tangents of other rules unless they are regular; docs/book/golden.md says why
    /// ours are the limits of what both refine. There it must have what those rules say.
    fn limits(
        &self,
        name: &str,
        plan: &RefinementPlan,
        refined: &[DVec3],
        matching: &Matching,
        facts: &Facts,
    ) -> Outcome<Vec<Comparison>> {
        let column = |name: &str| -> Outcome<Vec<DVec3>> {
            let numbers = facts.columns.get(name).ok_or("OpenSubdiv told no limits")?;
            Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
        };
        let (theirs, first, second) =
            (column("limits")?, column("tangents_1")?, column("tangents_2")?);
        let ours = plan.limit(refined)?;
        let [u, v] = plan.limit_tangents(refined)?;
        let size = ours.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let partner = |i: usize| matching.partner[i].unwrap_or(i);
        let connectivity = plan.connectivity();
        let as_smooth = RefinementOptions { levels: 0, ..*plan.options() };
        let as_smooth =
            RefinementPlan::new(&connectivity, &Sharpness::new(), &as_smooth, Progress::NONE)?;
        let as_smooth = as_smooth.limit(refined)?;
        let regular = if name == "loop" { 4 } else { 3 };
        let (mut limits, mut ends, mut normals, mut rims) =
            (Worst::default(), Worst::default(), Worst::default(), Worst::default());
        for i in 0..ours.len() {
            let j = partner(i);
            if self.is_dart(i) {
                ends.add(as_smooth[i].distance(theirs[j]) / size);
                continue;
            }
            limits.add(ours[i].distance(theirs[j]) / size);
            let [mine, other] = [u[i].cross(v[i]), first[j].cross(second[j])];
            let flatness = |n: DVec3, a: DVec3, b: DVec3| n.length() / (a.length() * b.length());
            let flat = flatness(mine, u[i], v[i]).min(flatness(other, first[j], second[j]));
            let turned = mine.normalize().distance(other.normalize()) * flat;
            let vertex = VertexId::new(i);
            if connectivity.is_boundary_vertex(vertex) && connectivity.valence(vertex) != regular {
                rims.add(turned);
            } else {
                normals.add(turned);
            }
        }
        let judge = |quantity: &str, found: &Worst, left_out, same| Comparison {
            quantity: quantity.to_owned(),
            compared: found.count,
            left_out,
            worst: found.worst / TOLERANCE,
            verdict: if found.worst <= TOLERANCE {
                same
            } else {
                Verdict::Differs(format!("off by {:e}", found.worst))
            },
        };
        let quantity = format!("limits_{}", name.replace('-', "_"));
        let mut all = vec![judge(&quantity, &limits, ends.count, Verdict::Same)];
        if ends.count > 0 {
            all.push(judge("limits_at_ends", &ends, 0, Verdict::Convention("ends of creases")));
        }
        if self.sharpness.is_smooth() {
            all.push(judge("limit_normals", &normals, rims.count, Verdict::Same));
        }
        Ok(all)
    }

    pub(super) fn tags(&self) -> Outcome<String> {
        let mut text = String::from(match self.boundary {
            BoundaryRule::None => "boundary none\n",
            BoundaryRule::EdgeOnly => "boundary edge\n",
            BoundaryRule::EdgeAndCorner => "boundary corner\n",
        });
        for e in self.mesh.edges().filter(|&e| self.sharpness.edge(e) > 0.0) {
            let [a, b] = self.mesh.edge_vertices(e);
            writeln!(text, "crease {} {} {}", a.index(), b.index(), self.sharpness.edge(e))?;
        }
        for v in self.mesh.vertices().filter(|&v| self.sharpness.vertex(v) > 0.0) {
            writeln!(text, "corner {} {}", v.index(), self.sharpness.vertex(v))?;
        }
        Ok(text)
    }

    /// The vertices of the last level that are only in faces of faces of the cage two rings away from
    /// rims; `None` if the cage has no rims or nothing is as far away.
    fn inside(&self, plan: &RefinementPlan) -> Option<Vec<usize>> {
        let mesh = &self.mesh;
        let mut near = mesh.map_vertices(|v| mesh.is_boundary_vertex(v));
        for _ in 0..2 {
            near = mesh.map_vertices(|v| near[v] || mesh.vertex_neighbors(v).any(|w| near[w]));
        }
        let outer = mesh.map_faces(|f| mesh.face_vertices(f).any(|v| near[v]));
        let cage_faces = plan.cage_faces();
        let mut is_inside = vec![true; plan.counts(plan.levels()).vertices as usize];
        for (f, face) in plan.faces(plan.levels()).iter() {
            if outer[cage_faces[f]] {
                for v in face {
                    is_inside[v.index()] = false;
                }
            }
        }
        let inside: Vec<usize> = (0..is_inside.len()).filter(|&v| is_inside[v]).collect();
        let has_rims = mesh.vertices().any(|v| mesh.is_boundary_vertex(v));
        (has_rims && !inside.is_empty()).then_some(inside)
    }
}

/// The faces of the last level as plain indices.
pub(super) fn listed(faces: &FaceList) -> Vec<Vec<usize>> {
    let ids = (0..faces.len()).map(FaceId::new);
    ids.map(|f| faces.face(f).iter().map(|v| v.index()).collect()).collect()
}

/// The largest of some differences.
#[derive(Default)]
struct Worst {
    worst: f64,
    count: usize,
}

impl Worst {
    fn add(&mut self, difference: f64) {
        self.worst = self.worst.max(difference);
        self.count += 1;
    }
}

/// Which vertex of theirs is where one of ours is.
pub(super) struct Matching {
    pub(super) partner: Vec<Option<usize>>,
    /// The largest distance, of the largest coordinate.
    worst: f64,
}

impl Matching {
    pub(super) fn new(ours: &[DVec3], theirs: &IndexedFaceSet) -> Self {
        let theirs = theirs.positions().values();
        let mut order: Vec<usize> = (0..theirs.len()).collect();
        order.sort_by(|&a, &b| theirs[a].x.total_cmp(&theirs[b].x));
        let size = ours.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let reach = REACH * size;
        let (mut worst, mut is_taken) = (0.0_f64, vec![false; theirs.len()]);
        let partner = ours.iter().map(|p| {
            let start = order.partition_point(|&w| theirs[w].x < p.x - reach);
            let near = order[start..].iter().take_while(|&&w| theirs[w].x <= p.x + reach);
            let distance = |w: usize| theirs[w].distance(*p);
            let found = near.min_by(|&&a, &&b| distance(a).total_cmp(&distance(b)));
            let found = *found.filter(|&&w| distance(w) <= reach && !is_taken[w])?;
            is_taken[found] = true;
            worst = worst.max(distance(found) / size);
            Some(found)
        });
        let partner = partner.collect();
        Matching { partner, worst }
    }

    pub(super) fn verdict(&self, ours: &[Vec<usize>], theirs: &IndexedFaceSet) -> Verdict {
        let [mine, other] = [self.partner.len(), theirs.vertex_count()];
        if mine != other || ours.len() != theirs.face_count() {
            let (faces, count) = (ours.len(), theirs.face_count());
            return Verdict::Differs(format!(
                "{mine} vertices and {faces} faces instead of {other} and {count}"
            ));
        }
        let alone = self.partner.iter().filter(|partner| partner.is_none()).count();
        if alone > 0 {
            return Verdict::Differs(format!("{alone} of {mine} vertices are elsewhere"));
        }
        if self.worst > TOLERANCE {
            return Verdict::Differs(format!("vertices are off by {:e}", self.worst));
        }
        let named = |face: &Vec<usize>| -> Vec<usize> {
            face.iter().filter_map(|&v| self.partner[v]).collect()
        };
        let sorted = |faces: Vec<Vec<usize>>| {
            let mut faces: Vec<Vec<usize>> = faces.into_iter().map(rotated).collect();
            faces.sort_unstable();
            faces
        };
        if sorted(ours.iter().map(named).collect()) == sorted(raw::faces(theirs)) {
            Verdict::Same
        } else {
            Verdict::Differs("faces join other vertices".into())
        }
    }
}

/// The face from its smallest vertex on.
pub(super) fn rotated(mut face: Vec<usize>) -> Vec<usize> {
    let least = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
    face.rotate_left(least);
    face
}
