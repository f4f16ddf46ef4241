//! What is sharp in a cage: by the tags of its file, by its angles.

use clap::{Args, ValueEnum};
use dgp::{
    io::{Document, SubdivisionRules},
    mesh::Mesh,
    subdiv::{BoundaryRule, SHARP, Sharpness},
};

use super::subdivide::sharpness;
use crate::failure::Failure;

/// What is sharp.
#[derive(Clone, Debug, Args)]
pub(super) struct Creasing {
    /// Apply the tags `crease`, `corner` and `interpolateboundary` of OBJ, and the vertex attribute
    /// `sharpness` (Loop, Catmull–Clark)
    #[arg(long)]
    creases: bool,
    /// Make creases of edges that bend by more than DEG degrees, beside those of the file
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    crease_angle: Option<f64>,
    /// How sharp those are: for so many levels, 10 for ever
    #[arg(long, value_name = "S", default_value_t = SHARP, value_parser = sharpness, requires = "crease_angle")]
    crease_sharpness: f64,
    /// What becomes of the rims of holes; by default what the tags say with --creases, else `smooth`
    #[arg(long, value_enum)]
    boundary: Option<BoundaryName>,
}

/// What becomes of the rim of a hole.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum BoundaryName {
    /// A smooth curve
    Smooth,
    /// A smooth curve that runs through the corners: vertices with only one face
    Corners,
    /// Faces there only support the surface and are left out
    None,
}

impl Creasing {
    /// Whether the tags of the file count.
    pub(super) fn takes_tags(&self) -> bool {
        self.creases
    }

    /// Whether anything may be sharp.
    pub(super) fn is_asked(&self) -> bool {
        self.creases || self.crease_angle.is_some()
    }

    /// How sharp edges and vertices are, and what the tags say.
    pub(super) fn sharpness(
        &self,
        mesh: &Mesh,
        document: &Document,
    ) -> Result<(Sharpness, SubdivisionRules), Failure> {
        let mut sharpness = Sharpness::new();
        let mut rules = SubdivisionRules::default();
        if self.creases {
            sharpness = Sharpness::from_attributes(mesh);
            rules = document.subdivision_rules()?;
            let check = |what: String, sharpness: f64| match sharpness {
                0.0..=SHARP => Ok(()),
                _ => Err(Failure::Sharpness { what, sharpness }),
            };
            for &([v, w], s) in &rules.creases {
                let no_edge = Failure::NotAnEdge { vertices: [v, w] };
                let h = mesh.halfedge_between(v, w).ok_or(no_edge)?;
                check(format!("the crease from {v} to {w}"), s)?;
                sharpness.set_edge(h.edge(), s);
            }
            for &(v, s) in &rules.corners {
                check(format!("the corner {v}"), s)?;
                sharpness.set_vertex(v, s);
            }
        }
        if let Some(angle) = self.crease_angle {
            let bends = |e| mesh.dihedral_angle(e).is_some_and(|bend| bend.abs() > angle);
            for e in mesh.edges().filter(|&e| bends(e)) {
                sharpness.set_edge(e, sharpness.edge(e).max(self.crease_sharpness));
            }
        }
        Ok((sharpness, rules))
    }

    /// What becomes of rims.
    pub(super) fn boundary(&self, rules: &SubdivisionRules) -> BoundaryRule {
        match (self.boundary, rules.boundary) {
            (Some(BoundaryName::None), _) | (None, Some(0)) => BoundaryRule::None,
            (Some(BoundaryName::Corners), _) | (None, Some(1)) => BoundaryRule::EdgeAndCorner,
            (Some(BoundaryName::Smooth) | None, _) => BoundaryRule::EdgeOnly,
        }
    }
}

/// An angle of at most 180°, in radians.
fn degrees(text: &str) -> Result<f64, String> {
    let found = text.parse::<f64>().ok().filter(|angle| (0.0..=180.0).contains(angle));
    let message = || format!("`{text}` is no angle; give degrees from 0 to 180");
    found.map(f64::to_radians).ok_or_else(message)
}
