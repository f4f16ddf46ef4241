//! `dgp shape`: primitives to try things on.

use std::process::ExitCode;

use clap::{Args, ValueEnum};
use dgp::{
    io::Document,
    mesh::{IndexedFaceSet, Mesh, shapes},
};
use serde_json::json;

use crate::{
    cli::{Common, Output},
    failure::Failure,
    session::Session,
};

/// Options of `dgp shape`.
#[derive(Debug, Args)]
pub(crate) struct Shape {
    /// Which shape
    #[arg(value_enum, value_name = "SHAPE")]
    kind: Kind,
    /// Its sizes, in the order in which the list of shapes names them
    #[arg(value_name = "SIZE")]
    sizes: Vec<f64>,
    #[command(flatten)]
    output: Output,
    /// Move each coordinate by a random length of this standard deviation, in mean edge lengths
    #[arg(long, value_name = "X")]
    noise: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Four triangles
    Tetrahedron,
    /// Six squares
    Cube,
    /// Eight triangles
    Octahedron,
    /// Twelve pentagons
    Dodecahedron,
    /// Twenty triangles
    Icosahedron,
    /// Twelve pentagons and twenty hexagons: a football
    TruncatedIcosahedron,
    /// A B: twelve pentagons and 10 (T − 1) hexagons, T = A² + A B + B² (Goldberg 1937)
    Goldberg,
    /// A B: 20 T triangles on the unit sphere, the dual of a Goldberg polyhedron
    GeodesicSphere,
    /// LEVEL: an icosahedron on the unit sphere, its triangles cut in four so often
    Icosphere,
    /// MAJOR MINOR N M: radii, cells around the axis and around the tube
    Torus,
    /// NECK N M: two balls joined by a neck of this radius, cells around the axis and along it
    Dumbbell,
    /// LEVEL: a sphere with gentle bumps and no symmetry
    Blob,
    /// N M: the unit square, cells along x and y
    Grid,
    /// GENUS LEVEL: a closed surface with so many handles, its triangles cut in four so often
    Genus,
    /// PERIODS CELLS: a ball cut out of a gyroid, handles in all directions; cells per period
    Gyroid,
}

impl Shape {
    pub(crate) fn run(&self, common: &Common) -> Result<ExitCode, Failure> {
        let mut session = Session::new("shape", common);
        let set = session.run("building", |_| self.build(common.seed))?;
        let (vertices, faces) = (set.vertex_count(), set.face_count());
        session.write(&self.output, &Document::from(set))?;
        let summary = format!("{}: {vertices} vertices, {faces} faces", self.output.path.display());
        session.finish(&summary, &json!({"vertices": vertices, "faces": faces}))?;
        Ok(ExitCode::SUCCESS)
    }

    fn build(&self, seed: u64) -> Result<IndexedFaceSet, Failure> {
        let mesh = self.mesh()?;
        let mesh = match self.noise {
            Some(noise) => shapes::with_noise(mesh, noise, seed)?,
            None => mesh,
        };
        Ok(mesh.to_indexed())
    }

    fn mesh(&self) -> Result<Mesh, Failure> {
        let exact = |mesh: Mesh| self.sizes::<0>("no sizes").map(|_| mesh);
        Ok(match self.kind {
            Kind::Tetrahedron => exact(shapes::tetrahedron())?,
            Kind::Cube => exact(shapes::cube())?,
            Kind::Octahedron => exact(shapes::octahedron())?,
            Kind::Dodecahedron => exact(shapes::dodecahedron())?,
            Kind::Icosahedron => exact(shapes::icosahedron())?,
            Kind::TruncatedIcosahedron => exact(shapes::truncated_icosahedron())?,
            Kind::Goldberg => {
                let [a, b] = self.counts("A B")?;
                shapes::goldberg(a, b)?
            }
            Kind::GeodesicSphere => {
                let [a, b] = self.counts("A B")?;
                shapes::geodesic_sphere(a, b)?
            }
            Kind::Icosphere => {
                let [level] = self.counts("LEVEL")?;
                shapes::icosphere(level)?
            }
            Kind::Torus => {
                let [major, minor, n, m] = self.sizes("MAJOR MINOR N M")?;
                shapes::torus(major, minor, Self::count(n)?, Self::count(m)?)?
            }
            Kind::Dumbbell => {
                let [neck, n, m] = self.sizes("NECK N M")?;
                shapes::dumbbell(neck, Self::count(n)?, Self::count(m)?)?
            }
            Kind::Blob => {
                let [level] = self.counts("LEVEL")?;
                shapes::blob(level)?
            }
            Kind::Grid => {
                let [n, m] = self.counts("N M")?;
                shapes::grid(n, m)?
            }
            Kind::Genus => {
                let [genus, level] = self.counts("GENUS LEVEL")?;
                shapes::surface_of_genus(genus, level)?
            }
            Kind::Gyroid => {
                let [periods, cells] = self.counts("PERIODS CELLS")?;
                shapes::gyroid(periods, cells)?
            }
        })
    }

    /// So many sizes; `names` says which.
    fn sizes<const N: usize>(&self, names: &str) -> Result<[f64; N], Failure> {
        self.sizes.clone().try_into().map_err(|given: Vec<f64>| {
            let kind = self.kind.to_possible_value();
            let kind = kind.as_ref().map_or("it", |kind| kind.get_name());
            Failure::Usage(format!("{kind} takes {names}; {} sizes were given", given.len()))
        })
    }

    fn counts<const N: usize>(&self, names: &str) -> Result<[usize; N], Failure> {
        let mut counts = [0; N];
        for (count, size) in counts.iter_mut().zip(self.sizes::<N>(names)?) {
            *count = Self::count(size)?;
        }
        Ok(counts)
    }

    fn count(size: f64) -> Result<usize, Failure> {
        if size >= 0.0 && size.fract() == 0.0 && size < 2_f64.powi(32) {
            return Ok(size as usize);
        }
        Err(Failure::Usage(format!("{size} is no number of cells, levels or steps")))
    }
}
