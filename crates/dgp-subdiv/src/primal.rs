//! The masks of a step of Loop, Catmull–Clark or bilinear refinement.
//!
//! The three differ in the mask of a smooth vertex and of a smooth edge; corners and creases are the same.
//! Rows: old vertices, then edges, then (of polygons) faces.

use crate::{
    catmull_clark::catmull_clark_vertex,
    loop_scheme::loop_beta,
    masks::{Masks, Means, Stencil},
    options::{LoopWeights, Scheme},
    ring::{Mix, Rule, mix},
    sharpness::Creases,
    topology::Topology,
};

/// Valences whose masks are worked out once.
pub(crate) const COMMON: usize = 16;

/// A scheme that keeps its vertices and adds points on edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Loop(LoopWeights),
    CatmullClark,
    Bilinear,
}

impl Kind {
    pub(crate) fn of(scheme: Scheme) -> Option<Kind> {
        match scheme {
            Scheme::Loop(weights) => Some(Kind::Loop(weights)),
            Scheme::CatmullClark => Some(Kind::CatmullClark),
            Scheme::Bilinear => Some(Kind::Bilinear),
            Scheme::Butterfly(_) | Scheme::Sqrt3 | Scheme::DooSabin => None,
        }
    }

    /// How much a smooth vertex, each of its neighbors and each mean of a face count.
    pub(crate) fn smooth_vertex(self, valence: usize) -> [f64; 3] {
        match self {
            Kind::Loop(weights) => {
                let beta = loop_beta(weights, valence);
                [1.0 - valence as f64 * beta, beta, 0.0]
            }
            Kind::CatmullClark => catmull_clark_vertex(valence),
            Kind::Bilinear => [1.0, 0.0, 0.0],
        }
    }

    /// How much each end of a smooth edge counts, and each corner across or mean of a face.
    pub(crate) fn smooth_edge(self) -> [f64; 2] {
        match self {
            Kind::Loop(_) => [3.0 / 8.0, 1.0 / 8.0],
            Kind::CatmullClark => [1.0 / 4.0, 1.0 / 4.0],
            Kind::Bilinear => [1.0 / 2.0, 0.0],
        }
    }

    pub(crate) fn splits_polygons(self) -> bool {
        !matches!(self, Kind::Loop(_))
    }
}

/// The masks of a step.
pub(crate) struct Primal<'a> {
    topology: &'a Topology,
    creases: &'a Creases,
    kind: Kind,
    common: [[f64; 3]; COMMON],
}

impl<'a> Primal<'a> {
    pub(crate) fn new(topology: &'a Topology, creases: &'a Creases, kind: Kind) -> Self {
        let mut common = [[0.0; 3]; COMMON];
        for (valence, mask) in common.iter_mut().enumerate().skip(1) {
            *mask = kind.smooth_vertex(valence);
        }
        Primal { topology, creases, kind, common }
    }

    fn vertex(&self, v: usize, stencil: &mut Stencil) {
        if self.kind == Kind::Bilinear {
            stencil.push(v as u32, 1.0);
            return;
        }
        let mut spokes = std::mem::take(&mut stencil.spokes);
        let closed = self.topology.spokes(v, &mut spokes);
        if self.creases.is_empty() {
            let rule = if closed { Rule::Smooth } else { Rule::Crease([0, spokes.len() - 1]) };
            self.push(rule, 1.0, v, &spokes, stencil);
        } else {
            let sharpness =
                spokes.iter().map(|h| self.creases.edge(self.topology, *h as usize / 2));
            stencil.sharpness.clear();
            stencil.sharpness.extend(sharpness);
            let Mix { first, second, weight } = mix(self.creases.vertex(v), &stencil.sharpness);
            self.push(first, weight, v, &spokes, stencil);
            if weight < 1.0 {
                self.push(second, 1.0 - weight, v, &spokes, stencil);
            }
        }
        stencil.spokes = spokes;
    }

    /// Adds `factor` times the mask of a rule.
    fn push(&self, rule: Rule, factor: f64, v: usize, spokes: &[u32], stencil: &mut Stencil) {
        let topology = self.topology;
        match rule {
            Rule::Corner => stencil.push(v as u32, factor),
            Rule::Crease(ends) => {
                stencil.push(v as u32, 0.75 * factor);
                for end in ends {
                    stencil.push(topology.to(spokes[end]), 0.125 * factor);
                }
            }
            Rule::Smooth => {
                let valence = spokes.len();
                let common = self.common.get(valence);
                let mask = common.map_or_else(|| self.kind.smooth_vertex(valence), |mask| *mask);
                let [center, neighbor, face] = mask.map(|weight| factor * weight);
                stencil.push(v as u32, center);
                stencil.entries.extend(spokes.iter().map(|&h| (topology.to(h), neighbor)));
                if self.kind.splits_polygons() {
                    let vertices = topology.vertex_count() as u32;
                    let column = |&h: &u32| (vertices + topology.face(topology.corner(h)), face);
                    stencil.entries.extend(spokes.iter().map(column));
                }
            }
        }
    }

    fn edge(&self, e: usize, stencil: &mut Stencil) {
        let topology = self.topology;
        let sharp = self.creases.edge(topology, e).min(1.0);
        let [end, side] = self.kind.smooth_edge();
        let end = (1.0 - sharp) * end + sharp * 0.5;
        let side = (1.0 - sharp) * side;
        for h in [2 * e as u32, 2 * e as u32 + 1] {
            stencil.push(topology.from(h), end);
            if side > 0.0 {
                let corner = topology.corner(h);
                let across = if self.kind.splits_polygons() {
                    topology.vertex_count() as u32 + topology.face(corner)
                } else {
                    topology.vertex(topology.prev(corner))
                };
                stencil.push(across, side);
            }
        }
    }
}

impl Masks for Primal<'_> {
    fn rows(&self) -> usize {
        let points = self.topology.vertex_count() + self.topology.edge_count();
        points + if self.kind.splits_polygons() { self.topology.face_count() } else { 0 }
    }

    fn topology(&self) -> &Topology {
        self.topology
    }

    fn means(&self) -> Means {
        if self.kind.splits_polygons() { Means::Last } else { Means::Unused }
    }

    #[inline]
    fn row(&self, row: usize, stencil: &mut Stencil) {
        let vertices = self.topology.vertex_count();
        let points = vertices + self.topology.edge_count();
        if row < vertices {
            self.vertex(row, stencil);
        } else if row < points {
            self.edge(row - vertices, stencil);
        } else {
            stencil.push((vertices + row - points) as u32, 1.0);
        }
    }
}
