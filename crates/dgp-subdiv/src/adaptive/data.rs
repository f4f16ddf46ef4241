//! Data that travel through adaptive refinement: worked out row by row where faces are split, taken to the
//! limit where they end up in the result.

use dgp_mesh::{AttributeTable, VertexId};

use super::patch::{Layer, Part};
use crate::{
    limit::{Limit, LimitMasks},
    masks::{Masks, Stencil, spell_out},
    primal::{Kind, Primal},
    topology::{NONE, Topology},
};

/// The data of vertices, and of corners, which are those of vertices of charts.
pub(super) struct Data {
    pub(super) vertex: Option<Carried>,
    pub(super) corner: Option<Carried>,
}

/// The data of one layer at all levels.
pub(super) struct Carried {
    /// A row per vertex of each level, and per vertex of the result.
    pub(super) table: AttributeTable<VertexId>,
    /// Between the ends of edges and the corners of faces, which is its own limit.
    is_linear: bool,
    /// The row of each vertex of all levels in the result, so that a vertex has one value only.
    rows: Vec<u32>,
    stencil: Stencil,
}

impl Carried {
    /// The data of the cage.
    pub(super) fn new(table: AttributeTable<VertexId>, is_linear: bool) -> Self {
        let rows = vec![NONE; table.len()];
        Carried { table, is_linear, rows, stencil: Stencil::default() }
    }

    /// Numbers one more vertex.
    pub(super) fn add(&mut self) -> u32 {
        self.rows.push(NONE);
        self.rows.len() as u32 - 1
    }

    /// Adds the rows of the next level of `part`; returns the first.
    pub(super) fn refine(&mut self, first_row: usize, part: &Part, kind: Kind) -> usize {
        let start = self.table.len();
        let Part { topology, creases, vertices, .. } = part;
        let masks = Primal::new(topology, creases, kind);
        let row_of = |v: u32| first_row + vertices[v as usize] as usize;
        for row in 0..masks.rows() {
            self.stencil.entries.clear();
            if self.is_linear {
                linear(topology, row, &mut self.stencil);
            } else {
                masks.row(row, &mut self.stencil);
                spell_out(topology, &mut self.stencil.entries);
            }
            self.push(row_of);
        }
        start
    }

    /// The row of vertex `v` of a layer in the result.
    pub(super) fn place(&mut self, layer: &Layer, v: u32, kind: Kind) -> VertexId {
        let id = layer.ids[v as usize] as usize;
        if self.rows.len() <= id {
            self.rows.resize(id + 1, NONE);
        }
        if self.rows[id] == NONE {
            let row_of = |v: u32| layer.first_row + v as usize;
            self.rows[id] = if self.is_linear {
                row_of(v) as u32
            } else {
                let Layer { topology, creases, .. } = layer;
                let masks = LimitMasks { topology, creases, kind, what: Limit::Position };
                self.stencil.entries.clear();
                masks.row(v as usize, &mut self.stencil);
                spell_out(topology, &mut self.stencil.entries);
                self.push(row_of)
            };
        }
        VertexId::new(self.rows[id] as usize)
    }

    /// Adds the row that the stencil makes of others; returns its number.
    fn push(&mut self, row_of: impl Fn(u32) -> usize) -> u32 {
        let entries = self.stencil.entries.iter();
        let parts: Vec<_> = entries.map(|&(v, w)| (w, VertexId::new(row_of(v)))).collect();
        self.table.push_mixed(&parts).index() as u32
    }
}

/// A row of old vertices, then middles of edges, then middles of faces.
fn linear(topology: &Topology, row: usize, stencil: &mut Stencil) {
    let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
    if row < vertices {
        stencil.push(row as u32, 1.0);
    } else if row < vertices + edges {
        for h in [2 * (row - vertices), 2 * (row - vertices) + 1] {
            stencil.push(topology.from(h as u32), 0.5);
        }
    } else {
        let corners = topology.corners((row - vertices - edges) as u32);
        let weight = 1.0 / corners.len() as f64;
        corners.for_each(|c| stencil.push(topology.vertex(c), weight));
    }
}
