//! Digital geometry processing: all crates of the workspace under one name.
//!
//! | to | look at |
//! |---|---|
//! | build, walk and edit meshes | [`mesh::Mesh`], [`mesh::Connectivity`], [`mesh::Editor`] |
//! | let data travel with them | [`mesh::AttributeTable`] |
//! | keep faces that are no manifold | [`mesh::IndexedFaceSet`], [`mesh::PolygonSoup`], [`mesh::weld`] |
//! | cut polygons into triangles | [`mesh::triangulate()`], [`mesh::triangulate_faces`] |
//! | make primitives, or something that looks like a scan | [`mesh::shapes`] |
//! | know lengths, areas, normals, volumes | [`mesh::measure`] |
//! | know components, holes, genus | [`mesh::topology`] |
//! | find nearest points, hits of rays, what is inside, how far surfaces are apart | [`mesh::spatial`] |
//! | find shortest paths on edges | [`mesh::graph`] |
//! | list what is wrong with faces, and mend it | [`mesh::defects`], [`mesh::repair()`] |
//! | read and write files | [`io`] |
//! | know how surfaces bend | [`mesh::curvature`] |
//! | have the Laplacian of a mesh or a cloud | [`laplace::laplacian`], [`laplace::intrinsic`], [`laplace::kernel`] |
//! | remove noise, let heat or curvature flow | [`laplace::smooth`], [`laplace::flow`] |
//! | know the waves of a shape, cut, compress, match it | [`laplace::spectral`] |
//! | refine cages into smooth surfaces, with creases | [`subdiv`] |
//! | have fewer faces, levels of detail that stream, no holes, evenly spread points or vertices | [`remesh`] |
//! | lay surfaces out in the plane | [`param`] |
//! | solve sparse systems, find eigenpairs | [`sparse`] |
//! | draw pictures, plot curves | [`view`] |
//! | see how far a long computation is, and stop it | [`mesh::Progress`] |
//!
//! Programs to start from (`cargo run -p dgp --example NAME`):
//!
//! | `examples/` | what it does |
//! |---|---|
//! | `clean_scan.rs` | reads a scan, lists what is wrong, mends, smooths, writes it |
//! | `one_rings.rs` | builds a mesh by hand and walks around its vertices, faces and holes |
//! | `carry_attributes.rs` | edits a mesh whose data, one of them of a type of its own, follow |
//! | `scalar_picture.rs` | draws a number per vertex with lines of equal value, and a path |
//!
//! A scan, read, mended, smoothed and drawn:
//!
//! ```
//! use dgp::{io, laplace::smooth::{TaubinOptions, taubin}, mesh::{self, Progress, VertexSet}, view};
//!
//! # let scan = mesh::shapes::like_a_scan(&mesh::shapes::icosphere(3)?, 7)?;
//! # let folder = std::env::temp_dir().join(format!("dgp-doc-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # let path = folder.join("scan.ply");
//! # io::write(&path, &scan.into(), &io::WriteOptions::default(), Progress::NONE)?;
//! let scan = io::read(&path)?;
//! let (mut mesh, report) = mesh::repair(&scan.set, &mesh::RepairOptions::default(), Progress::NONE)?;
//! assert!(!report.changes.is_empty());
//!
//! let options = TaubinOptions::default();
//! let report = taubin(&mut mesh, &VertexSet::new(), &options, Progress::NONE)?;
//! assert_eq!(report.iterations, options.iterations);
//!
//! let png = view::picture(&mesh)?.to_png();
//! # assert!(png.len() > 1000);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use dgp_io as io;
pub use dgp_laplace as laplace;
pub use dgp_mesh as mesh;
pub use dgp_param as param;
pub use dgp_remesh as remesh;
pub use dgp_sparse as sparse;
pub use dgp_subdiv as subdiv;
pub use dgp_view as view;
