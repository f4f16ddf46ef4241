//! The edits of the command line: how each is named, parsed and done.
//!
//! Edits are options that may come any number of times and in any order, and the order counts. clap
//! keeps the values of each option apart, with their places on the command line; [`Steps`] puts them
//! in order again.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use dgp::mesh::{DVec3, Editor, FaceId, FaceSet, VertexId};

use super::super::info::query::halfedge;
use crate::{
    cli::{id, ids, numbers},
    failure::Failure,
};

/// The edits in the order in which they were given.
#[derive(Clone, Debug)]
pub(super) struct Steps(pub(super) Vec<Step>);

/// One edit.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// The option without its dashes.
    pub(super) name: &'static str,
    /// Its value as it was given.
    pub(super) arguments: String,
    pub(super) edit: Edit,
}

/// What to do.
#[derive(Clone, Debug)]
pub(super) enum Edit {
    Flip([VertexId; 2]),
    Split([VertexId; 2], f64),
    Insert([VertexId; 2], f64),
    Collapse([VertexId; 2], Option<f64>),
    SplitFace(FaceId, Option<DVec3>),
    Cut([VertexId; 2]),
    Merge([VertexId; 2]),
    MergeVertex(VertexId),
    AddVertex(DVec3),
    AddFace(Vec<VertexId>),
    RemoveFace(FaceId),
    RemoveFaces(Vec<FaceId>),
    RemoveVertex(VertexId),
}

/// How an edit is asked for.
struct Kind {
    name: &'static str,
    values: &'static str,
    help: &'static str,
    parse: fn(&str) -> Result<Edit, String>,
}

const KINDS: &[Kind] = &[
    Kind {
        name: "flip",
        values: "V,W",
        help: "Turn the edge V,W within its two faces",
        parse: |text| Ok(Edit::Flip(ids(text)?)),
    },
    Kind {
        name: "split",
        values: "V,W[,T]",
        help: "Put a vertex on an edge at the part T (0.5) of the way; triangles stay triangles",
        parse: |text| on_edge(text).map(|(ends, t)| Edit::Split(ends, t.unwrap_or(0.5))),
    },
    Kind {
        name: "insert",
        values: "V,W[,T]",
        help: "Put a vertex on an edge; its faces get a corner more",
        parse: |text| on_edge(text).map(|(ends, t)| Edit::Insert(ends, t.unwrap_or(0.5))),
    },
    Kind {
        name: "collapse",
        values: "V,W[,T]",
        help: "Move V into W, or both to the part T of the way; W stays",
        parse: |text| on_edge(text).map(|(ends, t)| Edit::Collapse(ends, t)),
    },
    Kind {
        name: "split-face",
        values: "F[,X,Y,Z]",
        help: "Put a vertex into a face, at its center unless told, and join it to all corners",
        parse: |text| match text.split_once(',') {
            None => Ok(Edit::SplitFace(id(text)?, None)),
            Some((face, point)) => Ok(Edit::SplitFace(id(face)?, Some(numbers(point)?.into()))),
        },
    },
    Kind {
        name: "cut",
        values: "V,W",
        help: "Join two corners of a face by a new edge",
        parse: |text| Ok(Edit::Cut(ids(text)?)),
    },
    Kind {
        name: "merge",
        values: "V,W",
        help: "Remove the edge V,W, making one face of two",
        parse: |text| Ok(Edit::Merge(ids(text)?)),
    },
    Kind {
        name: "merge-vertex",
        values: "V",
        help: "Remove a vertex, making one face of all around it",
        parse: |text| Ok(Edit::MergeVertex(id(text)?)),
    },
    Kind {
        name: "add-vertex",
        values: "X,Y,Z",
        help: "Add a vertex on no face",
        parse: |text| Ok(Edit::AddVertex(numbers(text)?.into())),
    },
    Kind {
        name: "add-face",
        values: "V,W,…",
        help: "Add a face on vertices at the boundary or on no face",
        parse: |text| text.split(',').map(id).collect::<Result<_, _>>().map(Edit::AddFace),
    },
    Kind {
        name: "remove-face",
        values: "F",
        help: "Remove a face; refused where a vertex would be left with two fans",
        parse: |text| Ok(Edit::RemoveFace(id(text)?)),
    },
    Kind {
        name: "remove-faces",
        values: "F,…",
        help: "Remove faces; a vertex left with several fans is doubled",
        parse: |text| text.split(',').map(id).collect::<Result<_, _>>().map(Edit::RemoveFaces),
    },
    Kind {
        name: "remove-vertex",
        values: "V",
        help: "Remove a vertex and the faces at it",
        parse: |text| Ok(Edit::RemoveVertex(id(text)?)),
    },
];

impl Args for Steps {
    fn augment_args(command: Command) -> Command {
        KINDS.iter().fold(command, |command, kind| {
            let parse = |text: &str| {
                let (name, arguments) = (kind.name, text.to_owned());
                (kind.parse)(text).map(|edit| Step { name, arguments, edit })
            };
            let option = Arg::new(kind.name)
                .long(kind.name)
                .value_name(kind.values)
                .help(kind.help)
                .help_heading("Edits, done in the order in which they are given")
                .action(ArgAction::Append)
                .allow_hyphen_values(true)
                .value_parser(parse);
            command.arg(option)
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Steps {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut steps: Vec<(usize, Step)> = Vec::new();
        for kind in KINDS {
            let places = matches.indices_of(kind.name).into_iter().flatten();
            let values = matches.get_many::<Step>(kind.name).into_iter().flatten();
            steps.extend(places.zip(values.cloned()));
        }
        steps.sort_by_key(|&(place, _)| place);
        Ok(Steps(steps.into_iter().map(|(_, step)| step).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The ends of an edge and, maybe, how far along it.
fn on_edge(text: &str) -> Result<([VertexId; 2], Option<f64>), String> {
    if text.split(',').count() < 3 {
        return Ok((ids(text)?, None));
    }
    let (ends, part) = text.rsplit_once(',').ok_or("two vertices and a number are needed")?;
    let [part] = numbers(part)?;
    if !(0.0..=1.0).contains(&part) {
        return Err(format!("the part of the way is 0 to 1, not {part}"));
    }
    Ok((ids(ends)?, Some(part)))
}

impl Edit {
    /// Does it; returns the vertices that became several, each with its copy.
    pub(super) fn apply(
        &self,
        editor: &mut Editor<'_>,
    ) -> Result<Vec<(VertexId, VertexId)>, Failure> {
        let along = |editor: &Editor<'_>, [v, w]: [VertexId; 2], t: f64| {
            // The ends themselves where they are meant, so that none moves by rounding.
            let [p, q] = [v, w].map(|v| editor.mesh().position(v));
            if t == 1.0 { q } else { (1.0 - t) * p + t * q }
        };
        match self {
            &Edit::Flip(ends) => editor.flip(halfedge(editor.mesh(), ends)?.edge())?,
            &Edit::Split(ends, t) => {
                let e = halfedge(editor.mesh(), ends)?.edge();
                editor.split_edge_triangles(e, along(editor, ends, t))?;
            }
            &Edit::Insert(ends, t) => {
                let e = halfedge(editor.mesh(), ends)?.edge();
                editor.split_edge(e, along(editor, ends, t))?;
            }
            &Edit::Collapse(ends, None) => {
                editor.collapse(halfedge(editor.mesh(), ends)?)?;
            }
            &Edit::Collapse(ends, Some(t)) => {
                let h = halfedge(editor.mesh(), ends)?;
                editor.collapse_at(h, along(editor, ends, t))?;
            }
            &Edit::SplitFace(f, point) => {
                Failure::need(f, editor.mesh().face_count())?;
                let point = point.unwrap_or_else(|| editor.mesh().face_center(f));
                editor.split_face(f, point)?;
            }
            &Edit::Cut(ends) => {
                let mesh = editor.mesh();
                for v in ends {
                    Failure::need(v, mesh.vertex_count())?;
                }
                let f = mesh.common_faces(ends[0], ends[1]).next();
                let f = f.ok_or(Failure::NoCommonFace { vertices: ends })?;
                let corners = mesh.face_halfedges(f).filter(|&h| ends.contains(&mesh.from(h)));
                let [h, g] = corners.collect::<Vec<_>>()[..] else {
                    return Err(Failure::NoCommonFace { vertices: ends });
                };
                editor.split_face_by(h, g)?;
            }
            &Edit::Merge(ends) => {
                editor.merge_faces(halfedge(editor.mesh(), ends)?.edge())?;
            }
            &Edit::MergeVertex(v) => {
                editor.merge_vertex_faces(v)?;
            }
            &Edit::AddVertex(point) => {
                editor.add_vertex(point)?;
            }
            Edit::AddFace(vertices) => {
                editor.add_face(vertices)?;
            }
            &Edit::RemoveFace(f) => editor.remove_face(f)?,
            Edit::RemoveFaces(faces) => {
                let faces: FaceSet = faces.iter().copied().collect();
                return Ok(editor.remove_faces(&faces)?.copies);
            }
            &Edit::RemoveVertex(v) => return Ok(editor.remove_vertex(v)?.copies),
        }
        Ok(Vec::new())
    }

    /// The vertices it names, among which are all that it can remove.
    pub(super) fn vertices(&self) -> Vec<VertexId> {
        match self {
            Edit::Flip(ends)
            | Edit::Split(ends, _)
            | Edit::Insert(ends, _)
            | Edit::Collapse(ends, _)
            | Edit::Cut(ends)
            | Edit::Merge(ends) => ends.to_vec(),
            Edit::MergeVertex(v) | Edit::RemoveVertex(v) => vec![*v],
            Edit::AddFace(vertices) => vertices.clone(),
            Edit::SplitFace(..)
            | Edit::AddVertex(_)
            | Edit::RemoveFace(_)
            | Edit::RemoveFaces(_) => Vec::new(),
        }
    }

    /// The faces it names.
    pub(super) fn faces(&self) -> Vec<FaceId> {
        match self {
            Edit::SplitFace(f, _) | Edit::RemoveFace(f) => vec![*f],
            Edit::RemoveFaces(faces) => faces.clone(),
            _ => Vec::new(),
        }
    }
}
