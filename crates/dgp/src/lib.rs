//! Digital geometry processing: all crates of the workspace under one name.
//!
//! | to | look at |
//! |---|---|
//! | build, walk, edit and check meshes | [`mesh`] |
//! | make primitives, or something that looks like a scan | [`mesh::shapes`] |
//! | know lengths, areas, normals, volumes | [`mesh::measure`] |
//! | know components, holes, genus | [`mesh::topology`] |
//! | find shortest paths on edges | [`mesh::graph`] |
//! | list what is wrong with faces, and mend it | [`mesh::defects`], [`mesh::repair`] |
//! | read and write files | [`io`] |
//! | remove noise | [`laplace::smooth`] |
//! | draw pictures | [`view`] |
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
pub use dgp_view as view;
