//! `dgp convert`: from one format to another.

use std::process::ExitCode;

use clap::Args;
use serde_json::json;

use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp convert`.
#[derive(Debug, Args)]
pub(crate) struct Convert {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
}

impl Convert {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("convert", common);
        let document = session.read(&self.input)?;
        session.write(&self.output, &document)?;
        let summary = format!(
            "{} → {}: {} vertices, {} faces",
            self.input.path.display(),
            self.output.path.display(),
            document.set.vertex_count(),
            document.set.face_count(),
        );
        session.finish(&summary, &json!({}))?;
        Ok(ExitCode::SUCCESS)
    }
}
