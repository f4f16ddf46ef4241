//! `dgp partition`: cuts a surface into parts where little holds them together.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    laplace::spectral::{PartitionMethod, PartitionOptions, partition},
    mesh::{COLOR, Color},
    view::{ColorMap, Field},
};
use serde_json::json;

use crate::{
    cli::{Common, Input, OptionalOutput},
    commands::{
        scalars::Pictured,
        spectrum::{LaplacianName, Operator},
    },
    failure::Failure,
    session::Session,
};

/// Options of `dgp partition`.
///
/// The output has the vertex attribute `part` and a color for each part.
#[derive(Debug, Args)]
pub(crate) struct Partition {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    pictured: Pictured,
    /// How many parts
    #[arg(long, value_name = "K", default_value_t = 2)]
    parts: usize,
    /// How to cut
    #[arg(long, value_enum, default_value_t = Method::Clusters)]
    method: Method,
    /// Which Laplacian; cotangent weights of the mesh itself may be negative and are then refused
    #[arg(long, value_enum, default_value_t = LaplacianName::Intrinsic)]
    laplacian: LaplacianName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Parts as the shape has them: clusters of the spectral embedding
    Clusters,
    /// Parts of equal size: cut in two again and again at the Fiedler vector
    Bisection,
}

impl Partition {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("partition", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let operator = Operator { laplacian: self.laplacian };
        let method = match self.method {
            Method::Clusters => PartitionMethod::Clusters,
            Method::Bisection => PartitionMethod::Bisection,
        };
        let options = PartitionOptions { method, seed: common.seed, ..Default::default() };
        let cut = session
            .run("cutting", |progress| {
                let (laplacian, masses) = operator.of(&mesh, progress.part(0.0, 0.1))?;
                partition(&laplacian, &masses, self.parts, &options, progress.part(0.1, 1.0))
            })
            .map_err(|failure| failure.in_file(&self.input.path))?;

        // A color per face, since parts have nothing between them.
        let shown = mesh.map_faces(|f| {
            let parts: Vec<_> = mesh.face_vertices(f).map(|v| cut.part[v]).collect();
            let count = |part| parts.iter().filter(|&&other| other == part).count();
            let most = parts.iter().copied().max_by_key(|&part| count(part)).flatten();
            most.map_or(f64::NAN, f64::from)
        });
        let fields = vec![(format!("{} parts", cut.masses.len()), Field::Faces(shown))];
        self.pictured.draw_all(&mut session, &mesh, fields, ColorMap::Turbo)?;
        if let Some(output) = self.output.given() {
            let last = (cut.masses.len() - 1).max(1) as f64;
            let colors = cut.part.map(|part| {
                let color = part.map(|part| ColorMap::Turbo.color(f64::from(part) / last));
                color.map_or(Color::from_rgb8([150; 3]), |c| Color::from_rgba8(c.to_rgba8()))
            });
            let parts = cut.part.map(|part| part.map_or(-1, |part| part as i32));
            let data = &mut mesh.attributes_mut().vertex;
            data.insert("part", parts);
            data.insert(COLOR, colors);
            document.set = mesh.to_indexed();
            session.write(&output, &document)?;
        }
        let total: f64 = cut.masses.iter().sum();
        let shares: Vec<String> =
            cut.masses.iter().map(|mass| format!("{:.1}%", 100.0 * mass / total)).collect();
        let summary = format!(
            "{}: {} parts of {}, cut {:.6e}",
            self.input.path.display(),
            cut.masses.len(),
            shares.join(" "),
            cut.cut,
        );
        let report = json!({
            "laplacian": operator.name(),
            "parts": cut.masses.len(),
            "masses": cut.masses,
            "pieces": cut.pieces,
            "cut": cut.cut,
            "ratio_cut": cut.ratio_cut,
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }
}
