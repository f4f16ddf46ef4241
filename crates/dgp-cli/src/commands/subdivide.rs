//! `dgp subdivide`: a coarse cage becomes a smooth surface.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    io::{Document, SubdivisionRules},
    mesh::{
        Mesh, NORMAL, Normal, Progress, Tolerance, VertexMap,
        measure::{NormalWeight, bounding_box, vertex_normals},
        topology::euler_characteristic,
    },
    subdiv::{
        self, AdaptiveOptions, BoundaryRule, ButterflyRule, Counts, Error, FaceVarying,
        LoopWeights, PhongOptions, RefinementOptions, SHARP, SHARPNESS, Scheme, Sharpness,
        SubdivisionOptions, Surface, phong_tessellate, refine_to_tolerance,
    },
};
use serde_json::{Value, json};

use super::{crease::Creasing, repair::tolerance};
use crate::{
    cli::{Common, Input, Output},
    commands::scalars::Pictured,
    failure::Failure,
    session::Session,
};

/// How often faces may be split where a tolerance says how often they are.
const ADAPTIVE_LEVELS: usize = 10;

/// Options of `dgp subdivide`.
///
/// Texture coordinates keep their seams; groups, colors and other data travel, but for texture
/// coordinates with seams after an odd number of levels of `sqrt3`, whose triangles lie across them: what is left out
/// is said. What is sharp still after the last level is written as tags of OBJ, so that the result can be
/// refined further.
#[derive(Debug, Args)]
pub(crate) struct Subdivide {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    pictured: Pictured,
    #[command(flatten)]
    refining: Refining,
    #[command(flatten)]
    creasing: Creasing,
}

/// How to refine.
#[derive(Clone, Debug, Args)]
struct Refining {
    /// How faces are split
    #[arg(long, value_enum, default_value_t = SchemeName::CatmullClark)]
    scheme: SchemeName,
    /// How often, 1 unless told; with --adaptive at most how often, 10 unless told. Phong tessellation cuts
    /// edges into 2^N
    #[arg(long, value_name = "N")]
    levels: Option<usize>,
    /// Move vertices onto the limit surface and give them its normals (Loop, Catmull–Clark; bilinear and
    /// butterfly are there)
    #[arg(long)]
    limit: bool,
    /// Split faces only until the limit surface is that flat: a length, or a percentage of the diagonal of
    /// the cage such as 0.1% (Loop, Catmull–Clark)
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance)]
    adaptive: Option<Tolerance>,
    /// How much neighbors count (Loop)
    #[arg(long, value_enum, default_value_t = WeightsName::Original)]
    loop_weights: WeightsName,
    /// How texture coordinates and other data of corners are refined
    #[arg(long, value_enum, default_value_t = FaceVaryingName::Linear)]
    face_varying: FaceVaryingName,
    /// How much normals bend triangles, 0 to 1 (Phong)
    #[arg(long, value_name = "X", default_value_t = 0.75)]
    alpha: f64,
    /// Refuse what would need more memory, in bytes or as 512M, 8G
    #[arg(long, value_name = "SIZE", default_value = "8G", value_parser = size)]
    memory_limit: u64,
}

/// How faces are split and where their vertices go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SchemeName {
    /// Triangles into four; smooth (Loop 1987)
    Loop,
    /// Polygons into quadrilaterals; smooth (Catmull and Clark 1978)
    CatmullClark,
    /// Polygons into quadrilaterals, without moving anything
    Bilinear,
    /// Triangles into three, edges flipped (Kobbelt 2000)
    Sqrt3,
    /// A smaller copy of each face, with faces between (Doo and Sabin 1978)
    DooSabin,
    /// Triangles into four through the vertices of the cage (Dyn, Levin and Gregory 1990)
    Butterfly,
    /// The same, smooth too where not six triangles meet (Zorin 1996)
    ModifiedButterfly,
    /// Triangles bent by the normals at their corners (Boubekeur and Alexa 2008)
    Phong,
}

/// How much neighbors count in Loop's scheme.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum WeightsName {
    /// As Loop has them
    Original,
    /// 3/(8d), 3/16 for three edges (Warren 1995)
    Warren,
    /// 3/(d(d + 2)): no special case
    Simple,
}

/// How data of corners are refined; all but `linear` for Loop and Catmull–Clark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FaceVaryingName {
    /// Within each face
    Linear,
    /// As positions are, with seams as smooth rims through the corners of charts
    Smooth,
    /// The same, corners of charts smooth too
    SmoothCorners,
    /// As smooth, but vertices stay where more than two charts meet
    SharpJunctions,
    /// As sharp-junctions, and where seams end or one of two charts has a corner
    SharpEnds,
    /// As positions are, but rims of charts stay straight
    SharpRims,
}

/// A refined mesh, and what the report says of it.
struct Refined {
    mesh: Mesh,
    left_out: Vec<String>,
    details: Value,
}

impl Subdivide {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        self.refining.check()?;
        let mut session = Session::new("subdivide", common);
        let mut document = session.read(&self.input)?;
        let mut cage = session.mesh(&self.input, &document)?;
        let path = &self.input.path;
        let (sharpness, rules) =
            self.creasing.sharpness(&cage, &document).map_err(|failure| failure.in_file(path))?;
        let boundary = self.creasing.boundary(&rules);
        let had_sharpness = cage.attributes().vertex.contains(SHARPNESS);
        if !sharpness.is_smooth() {
            sharpness.to_attributes(&mut cage);
        }
        let refining = &self.refining;
        let Refined { mut mesh, left_out, details } = session
            .run("subdividing", |progress| refining.refine(&cage, &sharpness, boundary, progress))
            .map_err(|failure| failure.in_file(path))?;
        for warning in warnings(&document, &rules, &left_out, self.creasing.takes_tags()) {
            session.warn(format!("{}: {warning}", path.display()));
        }
        // What lies on the limit surface is no cage any more.
        let on_limit = refining.limit || refining.adaptive.is_some();
        let rules = if on_limit || !self.creasing.is_asked() {
            SubdivisionRules::default()
        } else {
            rules_left(&mesh, &rules)
        };
        if !had_sharpness {
            mesh.attributes_mut().vertex.remove(SHARPNESS);
        }
        if let Some(picture) = &self.pictured.picture {
            let levels = refining.levels();
            let png =
                session.run("drawing", |progress| picture_of(&cage, &mesh, levels, progress))?;
            session.store(picture, &png)?;
        }
        document = Document {
            set: mesh.to_indexed(),
            polylines: Vec::new(),
            points: Vec::new(),
            elements: Vec::new(),
            ..document
        };
        document.set_subdivision_rules(&rules);
        session.write(&self.output, &document)?;
        let [before, after] = [&cage, &mesh].map(counts);
        let euler = [&cage, &mesh].map(|mesh| euler_characteristic(mesh));
        let summary = format!(
            "{} → {}: {} vertices and {} faces → {} and {}, χ = {} → {}",
            path.display(),
            self.output.path.display(),
            before.vertices,
            before.faces,
            after.vertices,
            after.faces,
            euler[0],
            euler[1],
        );
        let mut report = json!({
            "scheme": refining.scheme.name(),
            "levels": refining.levels(),
            "cage": elements(&before),
            "refined": elements(&after),
            "euler_characteristic": euler,
            "sharp_edges": cage.edges().filter(|&e| sharpness.edge(e) > 0.0).count(),
            "sharp_vertices": cage.vertices().filter(|&v| sharpness.vertex(v) > 0.0).count(),
            "left_out": left_out,
        });
        if let (Value::Object(report), Value::Object(details)) = (&mut report, details) {
            report.extend(details);
        }
        session.finish(&summary, &report)?;
        Ok(ExitCode::SUCCESS)
    }
}

impl SchemeName {
    /// The scheme; none for Phong tessellation.
    pub(super) fn with(self, loop_weights: WeightsName) -> Option<Scheme> {
        Some(match self {
            SchemeName::Loop => Scheme::Loop(match loop_weights {
                WeightsName::Original => LoopWeights::Original,
                WeightsName::Warren => LoopWeights::Warren,
                WeightsName::Simple => LoopWeights::Simple,
            }),
            SchemeName::CatmullClark => Scheme::CatmullClark,
            SchemeName::Bilinear => Scheme::Bilinear,
            SchemeName::Sqrt3 => Scheme::Sqrt3,
            SchemeName::DooSabin => Scheme::DooSabin,
            SchemeName::Butterfly => Scheme::Butterfly(ButterflyRule::Original),
            SchemeName::ModifiedButterfly => Scheme::Butterfly(ButterflyRule::Modified),
            SchemeName::Phong => return None,
        })
    }

    /// The name as on the command line.
    pub(super) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl Refining {
    fn levels(&self) -> usize {
        self.levels.unwrap_or(if self.adaptive.is_some() { ADAPTIVE_LEVELS } else { 1 })
    }

    /// The scheme; none for Phong tessellation.
    fn scheme(&self) -> Option<Scheme> {
        self.scheme.with(self.loop_weights)
    }

    /// Refuses options that the scheme has no use for.
    fn check(&self) -> Result<(), Failure> {
        let scheme = self.scheme();
        let has_limit = matches!(scheme, Some(Scheme::Bilinear | Scheme::Butterfly(_)));
        let is_smooth = scheme.is_some_and(Scheme::has_creases);
        let refuse = |what: &str, instead: &str| {
            let name = self.scheme.name();
            Err(Failure::Usage(format!("--scheme {name} {what}; take {instead}")))
        };
        if self.limit && !(is_smooth || has_limit) {
            return refuse("has no limit positions", "more --levels, loop or catmull-clark");
        }
        if self.adaptive.is_some() && !is_smooth {
            return refuse("cannot refine adaptively", "loop or catmull-clark");
        }
        if self.adaptive == Some(Tolerance::Exact) {
            return Err(Failure::Usage("--adaptive needs a tolerance above 0".to_owned()));
        }
        Ok(())
    }

    fn refine(
        &self,
        cage: &Mesh,
        sharpness: &Sharpness,
        boundary: BoundaryRule,
        progress: Progress<'_>,
    ) -> Result<Refined, Failure> {
        let (levels, memory_limit) = (self.levels(), self.memory_limit);
        let Some(scheme) = self.scheme() else {
            return self.bend(cage, sharpness, progress);
        };
        let refinement = RefinementOptions { scheme, levels, boundary, memory_limit };
        let face_varying = match self.face_varying {
            FaceVaryingName::Linear => FaceVarying::Linear,
            FaceVaryingName::Smooth => FaceVarying::Smooth,
            FaceVaryingName::SmoothCorners => FaceVarying::SmoothCorners,
            FaceVaryingName::SharpJunctions => FaceVarying::SharpJunctions,
            FaceVaryingName::SharpEnds => FaceVarying::SharpEnds,
            FaceVaryingName::SharpRims => FaceVarying::SharpRims,
        };
        if let Some(tolerance) = self.adaptive {
            let diagonal = bounding_box(cage).map_or(0.0, |b| b.diagonal());
            let tolerance = match tolerance {
                Tolerance::Distance(length) => length,
                Tolerance::OfDiagonal(part) => part * diagonal,
                Tolerance::Exact => 0.0,
            };
            let options = AdaptiveOptions { refinement, face_varying };
            let (mesh, report) =
                refine_to_tolerance(cage, sharpness, &options, tolerance, progress)?;
            let details = json!({
                "limit": true,
                "adaptive": {
                    "tolerance": tolerance,
                    "levels": report.levels,
                    "largest_deviation": report.largest_deviation,
                    "faces_beyond": report.faces_beyond,
                },
            });
            return Ok(Refined { mesh, left_out: Vec::new(), details });
        }
        let surface = match (self.limit, scheme) {
            (false, _) => Surface::Refined,
            (true, Scheme::Butterfly(_)) => Surface::Limit,
            (true, _) => Surface::LimitAndNormals,
        };
        let options = SubdivisionOptions { refinement, surface, face_varying };
        let (mesh, report) = subdiv::subdivide(cage, sharpness, &options, progress)?;
        let details = json!({"limit": self.limit, "predicted_bytes": report.predicted_bytes});
        Ok(Refined { mesh, left_out: report.left_out, details })
    }

    /// Phong tessellation, by the normals of the file or else those of the faces around.
    fn bend(
        &self,
        cage: &Mesh,
        sharpness: &Sharpness,
        progress: Progress<'_>,
    ) -> Result<Refined, Failure> {
        if !sharpness.is_smooth() {
            return Err(Error::NoCreases { scheme: "Phong tessellation" }.into());
        }
        let levels = self.levels();
        let segments = u32::try_from(levels).ok().and_then(|levels| 1_usize.checked_shl(levels));
        let segments = segments.filter(|&segments| segments > 0).unwrap_or(usize::MAX);
        let options = PhongOptions { segments, alpha: self.alpha, memory_limit: self.memory_limit };
        let given = cage.attributes().vertex.get::<Normal>(NORMAL);
        let normals: VertexMap<_> = match given {
            Some(normals) => normals.to_map().map(|normal| normal.0),
            None => vertex_normals(cage, NormalWeight::Angle),
        };
        let mesh = phong_tessellate(cage, &normals, &options, progress).map_err(|e| match e {
            // It has one level only, whatever the number of segments.
            Error::TooLarge { faces, bytes, limit, .. } => {
                Error::TooLarge { level: levels, faces, bytes, limit }
            }
            other => other,
        })?;
        let whole = RefinementOptions { levels: 0, memory_limit: u64::MAX, ..Default::default() };
        let bytes = whole.predict(counts(&mesh)).map(|(_, bytes)| bytes).ok();
        let source = if given.is_some() { "file" } else { "faces" };
        let details = json!({
            "limit": false,
            "predicted_bytes": bytes,
            "phong": {"segments": segments, "alpha": self.alpha, "normals": source},
        });
        Ok(Refined { mesh, left_out: Vec::new(), details })
    }
}

/// What the user should know of.
fn warnings(
    document: &Document,
    rules: &SubdivisionRules,
    left_out: &[String],
    takes_tags: bool,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let tags = document.tags.len();
    if takes_tags && !rules.others.is_empty() {
        warnings.push(format!("tags without effect here: {}", rules.others.join(", ")));
    } else if !takes_tags && tags > 0 {
        warnings.push(format!("{tags} tags are not applied; --creases does"));
    }
    let others = document.polylines.len() + document.points.len() + document.elements.len();
    if others > 0 {
        warnings.push(format!("{others} lines, points and other elements are left out"));
    }
    if !left_out.is_empty() {
        warnings.push(format!("left out: {}", left_out.join(", ")));
    }
    warnings
}

/// The tags of the result.
fn rules_left(mesh: &Mesh, rules: &SubdivisionRules) -> SubdivisionRules {
    let sharpness = Sharpness::from_attributes(mesh);
    let edges = mesh.edges().map(|e| (mesh.edge_vertices(e), sharpness.edge(e)));
    let vertices = mesh.vertices().map(|v| (v, sharpness.vertex(v)));
    SubdivisionRules {
        creases: edges.filter(|(_, s)| *s > 0.0).collect(),
        corners: vertices.filter(|(_, s)| *s > 0.0).collect(),
        boundary: rules.boundary,
        others: Vec::new(),
    }
}

fn counts(mesh: &Mesh) -> Counts {
    Counts {
        vertices: mesh.vertex_count() as u64,
        edges: mesh.edge_count() as u64,
        corners: mesh.faces().map(|f| mesh.degree(f) as u64).sum(),
        faces: mesh.face_count() as u64,
    }
}

fn elements(counts: &Counts) -> Value {
    let Counts { vertices, edges, faces, .. } = counts;
    json!({"vertices": vertices, "edges": edges, "faces": faces})
}

/// The cage and the result side by side, seen by one camera.
fn picture_of(
    cage: &Mesh,
    mesh: &Mesh,
    levels: usize,
    progress: Progress<'_>,
) -> Result<Vec<u8>, dgp::view::Error> {
    use dgp::view::{Framing, Model, Panel, RenderOptions, Scene, Stroke, Style, render};
    /// More faces than this make a wireframe black.
    const WIRED: usize = 20_000;
    let panel = |caption: String, mesh| {
        let style = Style { boundary: Stroke::BOLD, ..Style::faceted() };
        Panel::new(caption, Model { style, ..Model::new(mesh) })
    };
    let mut refined = panel(format!("level {levels}"), mesh);
    let smooth = Style::default();
    let wireframe = if mesh.face_count() > WIRED { Stroke::NONE } else { Stroke::THIN };
    refined.models[0].style = Style { wireframe, boundary: Stroke::BOLD, ..smooth };
    let scene = Scene { panels: vec![panel("cage".to_owned(), cage), refined] };
    let framing = Framing::Shared;
    let options = RenderOptions { width: 1200, height: 600, framing, ..RenderOptions::default() };
    Ok(render(&scene, &options, progress)?.0.to_png())
}

/// A number of bytes, with K, M, G or T for powers of 1024.
pub(super) fn size(text: &str) -> Result<u64, String> {
    let units = [('K', 10), ('M', 20), ('G', 30), ('T', 40)];
    let found = units.iter().find_map(|&(unit, shift)| Some((text.strip_suffix(unit)?, shift)));
    let (digits, shift) = found.unwrap_or((text, 0));
    let bytes = digits.parse::<u64>().ok().and_then(|n| n.checked_mul(1 << shift));
    bytes.ok_or_else(|| format!("`{text}` is no size; give bytes, or as 512M or 8G"))
}

/// The sharpness of `--crease-sharpness`.
pub(super) fn sharpness(text: &str) -> Result<f64, String> {
    let found = text.parse::<f64>().ok().filter(|s| (0.0..=SHARP).contains(s));
    found.ok_or_else(|| format!("`{text}` is no sharpness; give 0 (smooth) to 10 (sharp for ever)"))
}
