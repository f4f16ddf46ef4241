//! `dgp stencils`: subdivision as a matrix, written and applied.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use dgp::{
    io::Document,
    mesh::{DVec3, Mesh},
    subdiv::{self, RefinementPlan, StencilTable},
};
use serde_json::json;

use super::{
    cage::{Cage, Planned},
    create_folder,
};
use crate::{
    cli::{Common, Input},
    failure::Failure,
    session::Session,
};

/// Options of `dgp stencils`.
///
/// The matrix is written in the Matrix Market format: row i + 1 says how vertex i of the refined mesh, as
/// `dgp subdivide` numbers them, is mixed from the vertices of the cage.
#[derive(Debug, Args)]
pub(crate) struct Stencils {
    #[command(flatten)]
    cage: Cage,
    /// Write the matrix, `-` for standard output
    #[arg(id = "output", long = "output", short = 'o', value_name = "MTX")]
    output: Option<PathBuf>,
    /// How often faces are split
    #[arg(long, value_name = "N", default_value_t = 1)]
    levels: usize,
    /// Start from this level in place of the cage, which is level 0
    #[arg(long, value_name = "LEVEL", default_value_t = 0)]
    from: usize,
    /// What rows stand for
    #[arg(long, value_enum, default_value_t = Rows::Refined)]
    rows: Rows,
    /// Write the transposed matrix: what each vertex of the cage adds to the refined ones
    #[arg(long)]
    transpose: bool,
    /// Refine these meshes, the cage in other poses, by the one matrix; --into says where
    #[arg(long, value_name = "MESH", num_args = 1.., requires = "into")]
    apply: Vec<PathBuf>,
    /// The folder for the refined meshes of --apply, under their names
    #[arg(long, value_name = "FOLDER", requires = "apply")]
    into: Option<PathBuf>,
}

/// What the rows of the matrix stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Rows {
    /// The vertices of the last level
    Refined,
    /// Where they are on the limit surface (Loop, Catmull–Clark, bilinear)
    Limit,
    /// The first tangents there; rows sum to 0
    #[value(name = "tangent-1")]
    Tangent1,
    /// The second tangents; first × second points outward
    #[value(name = "tangent-2")]
    Tangent2,
}

impl Stencils {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        self.check()?;
        let mut session = Session::new("stencils", common);
        let Planned { mesh, plan, .. } = self.cage.plan(&mut session, self.levels)?;
        let path = &self.cage.input.path;
        let table = session
            .run("composing", |_| self.table(&plan))
            .map_err(|failure| failure.in_file(path))?;
        let sums = (0..table.rows()).map(|row| table.row(row).1.iter().sum::<f64>());
        let (least, largest) =
            sums.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let longest = (0..table.rows()).map(|row| table.row(row).0.len()).max();
        let mut applied = Vec::new();
        if let Some(folder) = &self.into {
            create_folder(folder)?;
            for pose in &self.apply {
                applied.push(self.refine(&mut session, &mesh, &plan, &table, pose, folder)?);
            }
        }
        let written = if self.transpose { table.transposed() } else { table };
        if let Some(output) = &self.output {
            let mut bytes = Vec::new();
            written
                .write_matrix_market(&mut bytes)
                .map_err(|source| Failure::Text { path: output.clone(), source })?;
            let described = json!({
                "path": output.to_string_lossy(), "format": "mtx", "bytes": bytes.len(),
                "rows": written.rows(), "entries": written.entries(),
            });
            session.write_bytes(output, &bytes, described)?;
        }
        let name = self.rows.to_possible_value().map(|value| value.get_name().to_owned());
        let summary = format!(
            "{}: {} rows, {} columns, {} weights, at most {} in a row of the table; {} meshes refined; {}",
            path.display(),
            written.rows(),
            written.columns(),
            written.entries(),
            longest.unwrap_or(0),
            applied.len(),
            session.spent(),
        );
        let report = json!({
            "scheme": self.cage.scheme.name(),
            "levels": self.levels,
            "from": self.from,
            "stands_for": name,
            "transposed": self.transpose,
            "rows": written.rows(),
            "columns": written.columns(),
            "entries": written.entries(),
            "longest_row": longest,
            "row_sums": if least <= largest { json!([least, largest]) } else { json!(null) },
            "applied": applied,
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    fn check(&self) -> Result<(), Failure> {
        let is_step = self.from < self.levels || self.from == 0;
        if self.from > self.levels || (self.rows == Rows::Refined && !is_step) {
            let message = format!("--from {} must be below --levels {}", self.from, self.levels);
            return Err(Failure::Usage(message));
        }
        if !self.apply.is_empty() && (self.from > 0 || self.is_tangent()) {
            let message =
                "--apply takes cages to points: without --from, and --rows refined or limit";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(())
    }

    fn is_tangent(&self) -> bool {
        matches!(self.rows, Rows::Tangent1 | Rows::Tangent2)
    }

    /// The steps one after the other, then the limit.
    fn table(&self, plan: &RefinementPlan) -> Result<StencilTable, subdiv::Error> {
        let mut steps = (self.from..self.levels).map(|step| plan.step_stencils(step));
        let first = match self.rows {
            Rows::Refined => None,
            Rows::Limit => Some(plan.limit_stencils()?),
            Rows::Tangent1 => Some(first(plan.tangent_stencils()?)),
            Rows::Tangent2 => Some(second(plan.tangent_stencils()?)),
        };
        let refining = match steps.next() {
            None => None,
            Some(first) => Some(steps.try_fold(first?, |before, step| step?.compose(&before))?),
        };
        match (first, refining) {
            (Some(last), Some(before)) => last.compose(&before),
            (Some(table), None) | (None, Some(table)) => Ok(table),
            // No step at all changes nothing.
            (None, None) => plan.stencils(),
        }
    }

    /// Refines one pose and writes it; its path.
    fn refine(
        &self,
        session: &mut Session<'_>,
        mesh: &Mesh,
        plan: &RefinementPlan,
        table: &StencilTable,
        pose: &Path,
        folder: &Path,
    ) -> Result<String, Failure> {
        let input = Input { path: pose.to_owned(), format: None };
        let document = session.read(&input)?;
        let same = document.set.vertex_count() == mesh.vertex_count()
            && document.set.faces() == mesh.to_indexed().faces();
        if !same {
            let message = format!(
                "{} does not have the faces of {}; poses differ in positions only",
                pose.display(),
                self.cage.input.path.display()
            );
            return Err(Failure::Usage(message));
        }
        let positions: Vec<DVec3> = session
            .run("applying", |_| table.apply(document.set.positions().values()))
            .map_err(|failure| failure.in_file(pose))?;
        let refined = Mesh::from_parts(plan.connectivity(), positions.into());
        let Some(name) = pose.file_name() else {
            let message = format!("--apply {}: standard input has no name", pose.display());
            return Err(Failure::Usage(message));
        };
        let path = folder.join(name);
        let document = Document { set: refined.to_indexed(), ..Document::default() };
        session.write_stage(&path, &document)?;
        Ok(path.to_string_lossy().into_owned())
    }
}

fn first([first, _]: [StencilTable; 2]) -> StencilTable {
    first
}

fn second([_, second]: [StencilTable; 2]) -> StencilTable {
    second
}
