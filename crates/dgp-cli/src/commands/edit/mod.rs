//! `dgp edit`: single edits, one after the other.

mod step;

use std::{fmt::Write, process::ExitCode};

use clap::Args;
use dgp::mesh::{Compaction, Editor, FaceId, IdMap, Mesh, VertexId, reorder};
use serde_json::{Value, json};

use self::step::{Step, Steps};
use crate::{
    cli::{Common, Input, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp edit`.
///
/// Each edit either leaves a manifold or is refused; then nothing is written and the exit code is 1.
/// Numbers of vertices and faces stay what they are in the input until all edits are done, new elements
/// are numbered on from there, and the report tells which number each has in the output.
#[derive(Debug, Args)]
pub(crate) struct Edit {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    steps: Steps,
    /// At the end, remove vertices that are on no face
    #[arg(long)]
    remove_isolated: bool,
    /// At the end, turn every face over
    #[arg(long)]
    reverse: bool,
    /// At the end, number vertices and faces such that neighbors are close in memory
    #[arg(long)]
    reorder: bool,
}

impl Edit {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        if self.steps.0.is_empty() && !(self.remove_isolated || self.reverse || self.reorder) {
            let message = "no edit is given: `dgp edit --help` lists them";
            return Err(Failure::Usage(message.to_owned()));
        }
        let mut session = Session::new("edit", common);
        let mut document = session.read(&self.input)?;
        let mut mesh = session.mesh(&self.input, &document)?;
        let (edits, moved) = session
            .run("editing", |_| self.apply(&mut mesh))
            .map_err(|failure| failure.in_file(&self.input.path))?;
        let lost = document.follow(mesh.to_indexed(), &moved.vertices);
        if lost > 0 {
            session.warn(format!("{lost} lines and points ended at vertices that are gone"));
        }
        session.write(&self.output, &document)?;
        let mut summary = to_text(&edits);
        let _ = write!(
            summary,
            "{} → {}: {} vertices, {} faces",
            self.input.path.display(),
            self.output.path.display(),
            mesh.vertex_count(),
            mesh.face_count(),
        );
        let report = json!({
            "edits": edits,
            "old_to_new": {
                "vertices": new_numbers(&moved.vertices),
                "faces": new_numbers(&moved.faces),
            },
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Does everything, and tells what each edit did and where all elements went.
    fn apply(&self, mesh: &mut Mesh) -> Result<(Vec<Value>, Compaction), Failure> {
        let mut edits = Vec::new();
        let mut editor = Editor::new(mesh);
        for (i, step) in self.steps.0.iter().enumerate() {
            let done = done(&mut editor, step).map_err(|source| Failure::Edit {
                number: i + 1,
                edit: format!("{} {}", step.name, step.arguments),
                source: Box::new(source),
            })?;
            edits.push(done);
        }
        if self.remove_isolated {
            let count = editor.remove_isolated_vertices();
            edits.push(json!({"edit": "remove-isolated", "removed": count}));
        }
        let mut moved = editor.finish();
        if self.reverse {
            mesh.reverse();
            edits.push(json!({"edit": "reverse"}));
        }
        if self.reorder {
            let new = reorder(mesh);
            moved.vertices = moved.vertices.map(|v| v.map(|v| new.vertices[v]));
            moved.edges = moved.edges.map(|e| e.map(|e| new.edges[e]));
            moved.faces = moved.faces.map(|f| f.map(|f| new.faces[f]));
            edits.push(json!({"edit": "reorder"}));
        }
        Ok((edits, moved))
    }
}

/// Does one edit and tells what came and went, in the numbers in force while editing.
fn done(editor: &mut Editor<'_>, step: &Step) -> Result<Value, Failure> {
    let mesh = editor.mesh();
    let counts = (mesh.vertex_count(), mesh.edge_count(), mesh.face_count());
    let mut vertices = step.edit.vertices();
    vertices.retain(|&v| editor.has_vertex(v));
    let mut faces = step.edit.faces();
    faces.retain(|&f| editor.has_face(f));
    faces.extend(vertices.iter().flat_map(|&v| mesh.vertex_faces(v)));
    faces.sort_unstable();
    faces.dedup();

    let copies = step.edit.apply(editor)?;
    let mesh = editor.mesh();
    vertices.retain(|&v| !editor.has_vertex(v));
    faces.retain(|&f| !editor.has_face(f));
    let new_edges = mesh.edges().skip(counts.1).filter(|&e| editor.has_edge(e));
    let new_edges = new_edges.map(|e| mesh.edge_vertices(e).map(VertexId::index));
    Ok(json!({
        "edit": step.name,
        "arguments": step.arguments,
        "new_vertices": (counts.0..mesh.vertex_count()).collect::<Vec<_>>(),
        "new_edges": new_edges.collect::<Vec<_>>(),
        "new_faces": (counts.2..mesh.face_count()).collect::<Vec<_>>(),
        "removed_vertices": vertices.iter().map(|v| v.index()).collect::<Vec<_>>(),
        "removed_faces": faces.iter().map(|f: &FaceId| f.index()).collect::<Vec<_>>(),
        "copied_vertices": copies.iter().map(|(v, w)| [v.index(), w.index()]).collect::<Vec<_>>(),
    }))
}

/// The new number of each element, `null` for those removed; `null` if all are where they were.
fn new_numbers<I: dgp::mesh::Id>(map: &IdMap<I, Option<I>>) -> Value {
    if map.iter().all(|(old, &new)| new == Some(old)) {
        return Value::Null;
    }
    map.values().iter().map(|new| new.map(I::index)).collect()
}

/// A line for each edit.
fn to_text(edits: &[Value]) -> String {
    let mut text = String::new();
    for edit in edits {
        let word = |name: &str| edit[name].as_str().unwrap_or_default().to_owned();
        let _ = write!(text, "{} {}", word("edit"), word("arguments"));
        let names = ["new_vertices", "new_faces", "removed_vertices", "removed_faces"];
        for name in names {
            if edit[name].as_array().is_some_and(|list| !list.is_empty()) {
                let _ = write!(text, "; {} {}", name.replace('_', " "), edit[name]);
            }
        }
        text.push('\n');
    }
    text
}
