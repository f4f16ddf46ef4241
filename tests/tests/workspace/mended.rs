//! Real broken files become surfaces without defects, or are refused with the reason.

use dgp_io::read;
use dgp_mesh::{Progress, Severity, defects, topology::boundary_loops};
use dgp_remesh::{FillOptions, Patch, SurfaceRepairOptions, repair_surface};
use dgp_tests::data;

#[test]
fn broken_files_are_mended_or_refused() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    let options = SurfaceRepairOptions::default();
    let (mut mended, mut refused) = (0, 0);
    for path in data::files(&folder.join("broken")) {
        // What cannot be read is the matter of dgp-io, which says why.
        let Ok(document) = read(&path) else { continue };
        let name = path.display();
        let (mesh, report) = repair_surface(&document.set, &options, Progress::NONE)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        mesh.validate().unwrap();
        let set = mesh.to_indexed();
        let mut left = defects(&set, Progress::NONE).unwrap();
        left.add_self_intersections(&set, Progress::NONE).unwrap();
        let bad = left.of(Severity::Error).chain(left.of(Severity::Warning)).count();
        if report.is_sound() {
            assert_eq!(bad, 0, "{name}: {left}");
            let (_, again) = repair_surface(&set, &options, Progress::NONE).unwrap();
            assert!(again.is_unchanged(), "{name}: {:?} {:?}", again.faces.changes, again.steps());
            mended += 1;
        } else {
            assert!(!report.intersections.left.is_empty() && bad > 0, "{name}");
            refused += 1;
        }
    }
    println!("{mended} mended, {refused} refused");
    assert!(mended >= 40, "{mended} mended, {refused} refused");
}

#[test]
fn scans_come_out_closed() {
    let Some(folder) = data::shared() else {
        println!("skipped: there are no shared data");
        return;
    };
    let options = SurfaceRepairOptions {
        holes: Some(FillOptions { patch: Patch::Cover, ..FillOptions::default() }),
        ..SurfaceRepairOptions::default()
    };
    for name in ["plane_holes.obj", "bun_zipper.ply"] {
        let document = read(folder.join("open").join(name)).unwrap();
        let (mesh, report) = repair_surface(&document.set, &options, Progress::NONE).unwrap();
        mesh.validate().unwrap();
        assert!(
            report.is_sound() && boundary_loops(&mesh).is_empty(),
            "{name}: {:?}",
            report.steps()
        );
    }
}
