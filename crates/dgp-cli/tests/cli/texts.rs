//! Help, completions and manual pages: every command is in each of them.

use super::folder::{Dgp, error};

const COMMANDS: [&str; 32] = [
    "info",
    "check",
    "convert",
    "repair",
    "smooth",
    "subdivide",
    "evaluate",
    "stencils",
    "decimate",
    "remesh",
    "progressive",
    "fill",
    "param",
    "voronoi",
    "sample",
    "edit",
    "geodesic",
    "curvature",
    "spectrum",
    "partition",
    "compress",
    "laplacian",
    "heat",
    "correspond",
    "compare",
    "distance",
    "solve",
    "shape",
    "render",
    "demo",
    "completions",
    "manual",
];

#[test]
fn every_command_is_in_the_help_the_completions_and_the_manual() {
    let dgp = Dgp::new(&[]);
    for arguments in ["--help", "completions bash", "completions zsh", "completions fish", "manual"]
    {
        let output = dgp.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {}", error(&output));
        let text = String::from_utf8(output.stdout).unwrap();
        for command in COMMANDS {
            assert!(text.contains(command), "{arguments} lacks {command}:\n{text}");
        }
    }
}

#[test]
fn each_command_has_a_manual_page_with_its_options() {
    let dgp = Dgp::new(&[]);
    assert_eq!(dgp.run("manual -o pages").status.code(), Some(0));
    for command in COMMANDS {
        let page = dgp.folder().join(format!("pages/dgp-{command}.1"));
        let page = std::fs::read_to_string(page).unwrap();
        assert!(page.starts_with(".ie") && page.contains(".TH"), "{page}");
    }
    let page = String::from_utf8(dgp.run("manual edit").stdout).unwrap();
    assert!(page.contains("collapse") && page.contains("dgp"), "{page}");
    assert_eq!(dgp.run("manual melt").status.code(), Some(2));
}

#[test]
fn readme_and_book_name_every_command() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for file in ["README.md", "docs/book/command.md"] {
        let text = std::fs::read_to_string(root.join(file)).unwrap();
        for command in COMMANDS {
            assert!(text.contains(&format!("dgp {command}")), "{file} lacks dgp {command}");
        }
    }
}
