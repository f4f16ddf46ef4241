//! A cage with its plan of refinement, for commands that want what `dgp subdivide` computes with.

use clap::Args;
use dgp::{
    io::Document,
    mesh::Mesh,
    subdiv::{Error, RefinementOptions, RefinementPlan},
};

use super::{
    crease::Creasing,
    subdivide::{SchemeName, WeightsName, size},
};
use crate::{cli::Input, failure::Failure, session::Session};

/// A cage and how it is refined.
#[derive(Clone, Debug, Args)]
pub(super) struct Cage {
    #[command(flatten)]
    pub(super) input: Input,
    /// How faces are split
    #[arg(long, value_enum, default_value_t = SchemeName::CatmullClark)]
    pub(super) scheme: SchemeName,
    /// How much neighbors count (Loop)
    #[arg(long, value_enum, default_value_t = WeightsName::Original)]
    loop_weights: WeightsName,
    #[command(flatten)]
    creasing: Creasing,
    /// Refuse what would need more memory, in bytes or as 512M, 8G
    #[arg(long, value_name = "SIZE", default_value = "8G", value_parser = size)]
    memory_limit: u64,
}

/// What was read, and its plan.
pub(super) struct Planned {
    pub(super) document: Document,
    pub(super) mesh: Mesh,
    pub(super) plan: RefinementPlan,
}

impl Cage {
    /// Reads the cage and plans to refine it so often.
    pub(super) fn plan(
        &self,
        session: &mut Session<'_>,
        levels: usize,
    ) -> Result<Planned, Failure> {
        let Some(scheme) = self.scheme.with(self.loop_weights) else {
            let message = "--scheme phong bends by normals and has no stencils; take another";
            return Err(Failure::Usage(message.to_owned()));
        };
        let document = session.read(&self.input)?;
        let mesh = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let (sharpness, rules) =
            self.creasing.sharpness(&mesh, &document).map_err(|failure| failure.in_file(path))?;
        let (boundary, memory_limit) = (self.creasing.boundary(&rules), self.memory_limit);
        let options = RefinementOptions { scheme, levels, boundary, memory_limit };
        let plan = session
            .run("planning", |progress| RefinementPlan::new(&mesh, &sharpness, &options, progress))
            .map_err(|failure| failure.in_file(path))?;
        if let Some(vertex) = mesh.vertices().find(|&v| !mesh.position(v).is_finite()) {
            return Err(Failure::from(Error::NotFinite { vertex }).in_file(path));
        }
        Ok(Planned { document, mesh, plan })
    }
}
