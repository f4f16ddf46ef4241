//! `dgp evaluate`: points of the limit surface, with tangents and normals, at any parameters.

use std::{fs, path::PathBuf, process::ExitCode};

use clap::Args;
use dgp::{
    io::Document,
    mesh::{
        DVec3, FaceId, FaceList, IndexedFaceSet, NORMAL, Normal, VertexId, VertexMap, parallel,
    },
    subdiv::{self, RefinementPlan, SurfacePoint},
};
use serde_json::json;

use super::{
    cage::{Cage, Planned},
    scalars::csv,
    subdivide::SchemeName,
};
use crate::{
    cli::{Common, Output},
    failure::Failure,
    session::Session,
};

/// The columns of a CSV file of points.
const COLUMNS: [&str; 15] = [
    "face", "u", "v", "x", "y", "z", "normal_x", "normal_y", "normal_z", "du_x", "du_y", "du_z",
    "dv_x", "dv_y", "dv_z",
];

/// Options of `dgp evaluate`.
///
/// (u, v) is (0, 0), (1, 0), (1, 1), (0, 1) at the corners of a quadrilateral and (0, 0), (1, 0), (0, 1) at those of a
/// triangle, in their order in the file. Points are written with their normals, derivatives (`du`, `dv`) and parameters: as
/// a point cloud, or as lines of numbers where OUTPUT ends in .csv.
#[derive(Debug, Args)]
pub(crate) struct Evaluate {
    #[command(flatten)]
    cage: Cage,
    #[command(flatten)]
    output: Output,
    /// Take N² points evenly within each face
    #[arg(long, value_name = "N", default_value_t = 1)]
    samples: usize,
    /// Take the points of a file in place of that: lines `face,u,v`, faces counted from 0
    #[arg(long, value_name = "CSV", conflicts_with = "samples")]
    at: Option<PathBuf>,
    /// Count faces after so many levels of refinement; Catmull–Clark needs 1 where the cage has faces that are
    /// no quadrilaterals
    #[arg(long, value_name = "N", default_value_t = 0)]
    levels: usize,
}

/// Where a point is asked for.
#[derive(Clone, Copy, Debug)]
struct Place {
    face: FaceId,
    at: [f64; 2],
}

impl Evaluate {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        if !matches!(self.cage.scheme, SchemeName::Loop | SchemeName::CatmullClark) {
            let name = self.cage.scheme.name();
            let message =
                format!("--scheme {name} cannot be evaluated; take loop or catmull-clark");
            return Err(Failure::Usage(message));
        }
        let mut session = Session::new("evaluate", common);
        let Planned { document, mesh, plan } = self.cage.plan(&mut session, self.levels)?;
        let path = &self.cage.input.path;
        let values = plan
            .refine(mesh.positions().values())
            .map_err(|error| Failure::from(error).in_file(path))?;
        let faces = plan.faces(self.levels);
        let places = self.places(&faces)?;
        let points = session
            .run("evaluating", |_| evaluate(&plan, &values, &places))
            .map_err(|failure| failure.in_file(path))?;
        let tangents =
            plan.limit_tangents(&values).map_err(|error| Failure::from(error).in_file(path))?;
        let normals: Vec<DVec3> =
            places.iter().zip(&points).map(|(p, x)| normal(p, x, &faces, &tangents)).collect();
        let without = normals.iter().filter(|n| **n == DVec3::ZERO).count();
        if without > 0 {
            session.warn(format!("{}: no normal at {without} points", path.display()));
        }
        self.write(&mut session, &document, &places, &points, normals)?;
        let summary = format!(
            "{} → {}: {} points on {} faces; {}",
            path.display(),
            self.output.path.display(),
            points.len(),
            faces.len(),
            session.spent(),
        );
        let report = json!({
            "scheme": self.cage.scheme.name(),
            "levels": self.levels,
            "faces": faces.len(),
            "points": points.len(),
            "without_normal": without,
        });
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Where points are asked for.
    fn places(&self, faces: &FaceList) -> Result<Vec<Place>, Failure> {
        let Some(path) = &self.at else {
            return Ok(even(faces, self.samples));
        };
        let text = fs::read_to_string(path)
            .map_err(|source| Failure::Text { path: path.clone(), source })?;
        let mut places = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let is_header = number == 1 && line.trim_start().starts_with(char::is_alphabetic);
            if is_header || line.trim().is_empty() {
                continue;
            }
            let words: Vec<&str> = line.split(',').map(str::trim).collect();
            let place = match words[..] {
                [face, u, v] => face.parse().ok().zip(u.parse().ok().zip(v.parse().ok())),
                _ => None,
            };
            let Some((face, (u, v))) = place else {
                let path = path.display();
                let message = format!("{path}, line {number}: `{line}` is not `face,u,v`");
                return Err(Failure::Usage(message));
            };
            let face = FaceId::new(face);
            Failure::need(face, faces.len()).map_err(|failure| failure.in_file(path))?;
            places.push(Place { face, at: [u, v] });
        }
        Ok(places)
    }

    fn write(
        &self,
        session: &mut Session<'_>,
        document: &Document,
        places: &[Place],
        points: &[SurfacePoint<DVec3>],
        normals: Vec<DVec3>,
    ) -> Result<(), Failure> {
        let path = &self.output.path;
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")) {
            let rows = places.iter().zip(points).zip(&normals).map(|((place, point), normal)| {
                let mut row = vec![place.face.index() as f64, place.at[0], place.at[1]];
                for p in [point.value, *normal, point.derivatives[0], point.derivatives[1]] {
                    row.extend(p.to_array());
                }
                row
            });
            let bytes = csv(&COLUMNS, rows).into_bytes();
            let described = json!({
                "path": path.to_string_lossy(), "format": "csv", "bytes": bytes.len(),
                "points": points.len(),
            });
            return session.write_bytes(path, &bytes, described);
        }
        let positions: Vec<DVec3> = points.iter().map(|point| point.value).collect();
        let mut set = IndexedFaceSet::new(positions, FaceList::new())?;
        let table = &mut set.vertex_attributes;
        let normals: Vec<Normal> = normals.into_iter().map(Normal).collect();
        table.insert(NORMAL, normals);
        let face: Vec<u32> = places.iter().map(|place| place.face.index() as u32).collect();
        table.insert("face", face);
        for (k, name) in ["u", "v"].into_iter().enumerate() {
            table.insert(name, places.iter().map(|place| place.at[k]).collect::<Vec<f64>>());
        }
        for (k, name) in ["du", "dv"].into_iter().enumerate() {
            let derivatives = points.iter().map(|point| point.derivatives[k]);
            table.insert(name, derivatives.collect::<Vec<DVec3>>());
        }
        let comments = document.comments.clone();
        session.write(&self.output, &Document { set, comments, ..Document::default() })
    }
}

/// N² points within each face: middles of squares, or of the triangles into which lines at N-ths cut it.
fn even(faces: &FaceList, samples: usize) -> Vec<Place> {
    let n = samples as f64;
    let mut places = Vec::new();
    for (face, corners) in faces.iter() {
        for (i, j) in (0..samples).flat_map(|i| (0..samples).map(move |j| (i, j))) {
            let at = |shift: f64| [(i as f64 + shift) / n, (j as f64 + shift) / n];
            if corners.len() > 3 {
                places.push(Place { face, at: at(0.5) });
            } else if i + j < samples {
                places.push(Place { face, at: at(1.0 / 3.0) });
                if i + j + 1 < samples {
                    places.push(Place { face, at: at(2.0 / 3.0) });
                }
            }
        }
    }
    places
}

fn evaluate(
    plan: &RefinementPlan,
    values: &[DVec3],
    places: &[Place],
) -> Result<Vec<SurfacePoint<DVec3>>, subdiv::Error> {
    let found: VertexMap<_> = parallel::map(places.len(), |i: VertexId| {
        let Place { face, at } = places[i.index()];
        plan.evaluate(values, face, at)
    });
    found.into_values().into_iter().collect()
}

/// The unit normal; from the limit's tangents where derivatives vanish at a corner; zero where there is none.
fn normal(
    place: &Place,
    point: &SurfacePoint<DVec3>,
    faces: &FaceList,
    [first, second]: &[Vec<DVec3>; 2],
) -> DVec3 {
    let cross = |u: DVec3, v: DVec3| {
        let normal = u.normalize_or_zero().cross(v.normalize_or_zero());
        normal.try_normalize().unwrap_or(DVec3::ZERO)
    };
    let [du, dv] = point.derivatives;
    let found = cross(du, dv);
    let corners = faces.face(place.face);
    let corner = match place.at {
        [0.0, 0.0] => Some(0),
        [1.0, 0.0] => Some(1),
        [0.0, 1.0] => Some(corners.len() - 1),
        [1.0, 1.0] => Some(2),
        _ => None,
    };
    match corner {
        Some(k) if found == DVec3::ZERO => {
            let v = corners[k].index();
            cross(first[v], second[v])
        }
        _ => found,
    }
}
