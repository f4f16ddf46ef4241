//! What is timed.

/// One operation, by the names it has in our driver and the peers'.
pub(super) struct Case {
    /// The name in tables and in the ledger.
    pub(super) name: &'static str,
    /// What it is, for readers.
    pub(super) what: &'static str,
    pub(super) ours: &'static str,
    pub(super) openmesh: Option<&'static str>,
    pub(super) cgal: Option<&'static str>,
    /// Orders for which CHOLMOD does the same.
    pub(super) cholmod: &'static [&'static str],
    /// Operations by which OpenSubdiv does the same, and what to call each in tables.
    pub(super) opensubdiv: &'static [(&'static str, &'static str)],
    /// How cages are refined.
    pub(super) scheme: Option<&'static str>,
    /// The operation for which SciPy does the same.
    pub(super) scipy: Option<&'static str>,
    /// Whether every driver gets one thread instead of all there are.
    pub(super) one_thread: bool,
    /// Whether it also runs on the surface of many handles.
    pub(super) handles: bool,
    /// Inputs with more triangles are left out.
    pub(super) largest: usize,
    pub(super) data: Data,
    pub(super) figure: Figure,
}

/// What a cage is made of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Cage {
    Triangles,
    Quads,
}

/// What the drivers are given.
#[derive(Clone, Copy)]
pub(super) enum Data {
    /// A raw mesh.
    Raw,
    /// A raw mesh of triangles or of any faces that is to be refined.
    Cage(Cage),
    /// A raw mesh with faces turned over.
    Soup,
    /// A raw mesh with a hole.
    Holed,
    /// A file of this name.
    File(&'static str),
    /// A raw mesh, and the name of a file to write.
    Output(&'static str),
}

/// Which figure of a driver's answer counts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Figure {
    /// Milliseconds of wall time.
    Time,
    /// Numbers of the matrix factor, by this name.
    Entries(&'static str),
    /// A figure in bytes, told per triangle.
    Bytes(&'static str),
}

/// `operation` on raw meshes, ours beside OpenMesh and CGAL.
fn case(name: &'static str, what: &'static str, operation: &'static str) -> Case {
    Case {
        name,
        what,
        ours: operation,
        openmesh: Some(operation),
        cgal: Some(operation),
        cholmod: &[],
        opensubdiv: &[],
        scheme: None,
        scipy: None,
        one_thread: false,
        handles: false,
        largest: usize::MAX,
        data: Data::Raw,
        figure: Figure::Time,
    }
}

/// All cases, in the order of the tables.
pub(super) fn all() -> Vec<Case> {
    let mut cases = vec![
        case("build", "half-edges from indexed triangles", "build"),
        Case {
            figure: Figure::Bytes("mesh_bytes"),
            ..case("memory", "bytes per triangle that a built mesh holds", "memory")
        },
        Case {
            figure: Figure::Bytes("build_peak_bytes"),
            ..case("build-memory", "bytes per triangle at most while building", "memory")
        },
        case("rings", "sum of the neighbors' positions at every vertex", "rings"),
        case("normals", "a normal at every vertex", "normals"),
        Case { cgal: None, ..case("smooth", "ten steps of uniform smoothing", "smooth") },
        Case {
            openmesh: None,
            cgal: None,
            ..case("render", "a picture of 1200 × 900 pixels, four samples each", "render")
        },
        Case {
            openmesh: None,
            ..case("dijkstra", "distances along edges from a vertex", "dijkstra")
        },
        Case {
            openmesh: None,
            ..case("laplacian", "the matrix of cotangent weights", "laplacian")
        },
        Case {
            openmesh: None,
            cgal: None,
            cholmod: &["amd", "metis"],
            handles: true,
            ..case("cholesky", "order, factor and solve L + M with all threads", "cholesky")
        },
        Case {
            openmesh: None,
            cgal: None,
            cholmod: &["amd", "metis"],
            handles: true,
            one_thread: true,
            ..case("cholesky-1", "order, factor and solve L + M with 1 thread", "cholesky")
        },
        Case {
            openmesh: None,
            cgal: None,
            cholmod: &["amd", "metis"],
            handles: true,
            figure: Figure::Entries("factor_entries"),
            ..case("fill", "entries of the factor of L + M per triangle", "cholesky")
        },
        Case {
            openmesh: None,
            largest: 400_000,
            ..case("remesh", "five iterations of isotropic remeshing", "remesh")
        },
        Case {
            openmesh: None,
            data: Data::Soup,
            ..case("repair", "faces with one in a hundred turned over, made a mesh", "repair")
        },
    ];
    for (name, what) in [
        ("eigenpairs-50", "the 50 smallest eigenpairs of the cotangent Laplacian"),
        ("eigenpairs-100", "the 100 smallest eigenpairs of the cotangent Laplacian"),
        ("eigenpairs-300", "the 300 smallest eigenpairs of the cotangent Laplacian"),
    ] {
        let largest = 400_000;
        cases.push(Case {
            openmesh: None,
            cgal: None,
            scipy: Some(name),
            handles: true,
            largest,
            ..case(name, what, name)
        });
    }
    files(&mut cases);
    spatial(&mut cases);
    subdivision(&mut cases);
    holes(&mut cases);
    cases
}

/// Reading and writing in each format.
fn files(cases: &mut Vec<Case>) {
    for (read, write, file, binary) in [
        ("read-obj", "write-obj", "mesh.obj", false),
        ("read-ply", "write-ply", "mesh.ply", true),
        ("read-ply-ascii", "write-ply-ascii", "mesh-ascii.ply", false),
        ("read-stl", "write-stl", "mesh.stl", true),
        ("read-off", "write-off", "mesh.off", false),
    ] {
        cases.push(Case {
            openmesh: Some("read-triangles"),
            data: Data::File(file),
            ..case(read, "file to half-edge mesh", "read")
        });
        let operation = if binary { "write-binary" } else { "write-ascii" };
        cases.push(Case { data: Data::Output(file), ..case(write, "mesh to file", operation) });
    }
}

/// The hierarchy of triangles, built and asked.
fn spatial(cases: &mut Vec<Case>) {
    for (name, what, largest) in [
        ("tree-build", "hierarchy of triangles", usize::MAX),
        ("closest-near", "100 thousand nearest points near the surface", usize::MAX),
        ("closest-box", "10 thousand nearest points anywhere in the box", usize::MAX),
        ("ray-first", "first hits of 100 thousand rays", usize::MAX),
        ("ray-any", "whether 100 thousand rays hit", usize::MAX),
        ("segment-any", "whether 100 thousand segments hit", usize::MAX),
        ("box-faces", "faces in 10 thousand boxes", usize::MAX),
        ("self-intersections", "pairs of faces that meet, after noise", usize::MAX),
        ("hausdorff", "one-sided Hausdorff distance to 10⁻⁴ of the diagonal", 100_000),
    ] {
        cases.push(Case { openmesh: None, largest, ..case(name, what, name) });
    }
}

/// Refinement of cages.
fn subdivision(cases: &mut Vec<Case>) {
    let case = |name, what, scheme, cage, ours| Case {
        openmesh: None,
        cgal: None,
        scheme: Some(scheme),
        data: Data::Cage(cage),
        ..case(name, what, ours)
    };
    let subdivide = "subdivide";
    for (name, what, scheme, cage, openmesh, cgal) in [
        ("subdivide-loop", "Loop, mesh to mesh", "loop", Cage::Triangles, true, true),
        (
            "subdivide-catmull-clark",
            "Catmull–Clark, mesh to mesh",
            "catmull-clark",
            Cage::Quads,
            true,
            true,
        ),
        ("subdivide-sqrt3", "√3, mesh to mesh", "sqrt3", Cage::Triangles, true, true),
        (
            "subdivide-butterfly",
            "modified Butterfly, mesh to mesh",
            "butterfly",
            Cage::Triangles,
            true,
            false,
        ),
        ("subdivide-doo-sabin", "Doo–Sabin, mesh to mesh", "doo-sabin", Cage::Quads, false, true),
    ] {
        cases.push(Case {
            openmesh: openmesh.then_some(subdivide),
            cgal: cgal.then_some(subdivide),
            ..case(name, what, scheme, cage, subdivide)
        });
    }
    for (scheme, cage, plan, refine, stencils) in [
        ("loop", Cage::Triangles, "plan-loop", "refine-loop", "stencils-loop"),
        (
            "catmull-clark",
            Cage::Quads,
            "plan-catmull-clark",
            "refine-catmull-clark",
            "stencils-catmull-clark",
        ),
    ] {
        let what = "indexed faces to the connectivity and the positions of all levels";
        cases.push(Case {
            opensubdiv: &[("plan-refine", "OpenSubdiv")],
            ..case(plan, what, scheme, cage, "plan-refine")
        });
        cases.push(Case {
            opensubdiv: &[
                ("refine", "OpenSubdiv primvar refiner"),
                ("stencils", "OpenSubdiv stencils"),
                ("stencils-threads-32-bit", "OpenSubdiv stencils, threads, 32 bits"),
            ],
            ..case(refine, "positions again by a plan that is there", scheme, cage, "refine")
        });
        cases.push(Case {
            opensubdiv: &[
                ("stencils", "OpenSubdiv stencils"),
                ("stencils-threads-32-bit", "OpenSubdiv stencils, threads, 32 bits"),
            ],
            ..case(stencils, "positions again by a table that is there", scheme, cage, "stencils")
        });
    }
}

/// Holes filled.
fn holes(cases: &mut Vec<Case>) {
    for (name, what) in [
        ("fill-cover", "a hole filled with triangles between the corners of its rim"),
        ("fill-refined", "a hole filled with triangles as small as those around"),
        ("fill-fair", "a hole filled with a smooth surface"),
    ] {
        cases.push(Case { openmesh: None, data: Data::Holed, ..case(name, what, name) });
    }
}
