//! How decimation by quadrics chooses.

use std::f64::consts::PI;

use crate::Error;

/// How [`decimate_quadric`](crate::decimate_quadric) chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricOptions {
    /// Where the vertex of a collapsed edge goes.
    pub placement: Placement,
    /// Which planes count.
    pub memory: Memory,
    /// What happens to rims of holes.
    pub boundary: Boundary,
    /// How much planes through rims count against planes of triangles.
    pub boundary_weight: f64,
    /// Edges between faces that meet at a larger angle of their normals, in radians, are kept sharp; π for none.
    pub feature_angle: f64,
    /// How much planes through sharp edges count.
    pub feature_weight: f64,
    /// The largest angle a triangle may turn by in one collapse, in radians.
    pub largest_turn: f64,
    /// How strongly points are kept near the middle of the edge where planes leave them free.
    pub damping: f64,
    /// Whether vertices go where the volume stays the same.
    pub volume: Volume,
    /// How long a difference of 1 in normals, colors (of 0..1) and texture coordinates is, of the diagonal of the
    /// box around the mesh; 0 if they only travel. Columns of numbers that are all finite count (Hoppe 1999).
    pub attribute_weight: f64,
    /// In which order edges collapse.
    pub order: Order,
    /// How often, in the end, vertices move along their normals to where the input is nearest. Not done toward an error,
    /// nor where all vertices are ones of the input.
    pub polish: usize,
    /// How much the squared length of an edge counts, so that among collapses without error short edges come
    /// first.
    pub length_weight: f64,
}

impl QuadricOptions {
    /// The fastest: many collapses at a time, onto vertices of the input, by planes of the input.
    pub fn fast() -> Self {
        QuadricOptions {
            placement: Placement::Ends,
            memory: Memory::Kept,
            volume: Volume::Free,
            order: Order::Passes,
            polish: 0,
            ..QuadricOptions::default()
        }
    }

    /// Refuses numbers outside of their range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let blend = if let Memory::Blend(share) = self.memory { share } else { 0.0 };
        for (name, value) in [
            ("boundary_weight", self.boundary_weight),
            ("feature_angle", self.feature_angle),
            ("feature_weight", self.feature_weight),
            ("largest_turn", self.largest_turn),
            ("damping", self.damping),
            ("attribute_weight", self.attribute_weight),
            ("length_weight", self.length_weight),
            ("memory", blend),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                let expected = "zero or more, and finite";
                return Err(Error::InvalidOption { name, value, expected });
            }
        }
        Ok(())
    }
}

impl Default for QuadricOptions {
    fn default() -> Self {
        QuadricOptions {
            placement: Placement::Optimal,
            memory: Memory::Memoryless,
            boundary: Boundary::Weighted,
            boundary_weight: 1.0,
            feature_angle: PI,
            feature_weight: 1.0,
            largest_turn: 75_f64.to_radians(),
            damping: 1e-4,
            length_weight: 1e-9,
            attribute_weight: 0.0,
            order: Order::Best,
            polish: 1,
            volume: Volume::Kept,
        }
    }
}

/// Where the vertex of a collapsed edge goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// Where the quadric is least.
    Optimal,
    /// To the better end: all vertices of the result are ones of the input.
    Ends,
}

/// In which order edges collapse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The cheapest of all is next.
    Best,
    /// In passes over all vertices, each of which collapses cheap edges that are not next to each other: several
    /// times faster, and farther from the input.
    Passes,
}

/// Whether a collapse may change the volume inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Volume {
    /// The best point of those that leave the volume as it is: surfaces stay on both sides of the input.
    Kept,
    /// The best point: round surfaces grow a little.
    Free,
}

/// Which planes count in the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    /// Those of the present triangles.
    Memoryless,
    /// Those of all triangles of the input that were merged.
    Kept,
    /// Those of the present triangles, and this much of the input's.
    Blend(f64),
}

/// What happens to rims of holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// They are kept in shape by planes.
    Weighted,
    /// Their vertices stay.
    Kept,
}
