//! A picture of a number per vertex: distances along edges, with lines of equal distance.
//!
//! `cargo run --release -p dgp --example scalar_picture`

use std::{env, error::Error, fs};

use dgp::{
    io,
    mesh::{
        Progress, VertexId,
        graph::{Until, dijkstra},
        measure::edge_lengths,
        shapes,
    },
    view::{
        Field, Mark, Marked, Model, Paint, Panel, RenderOptions, Scalars, Scene, Stroke, Style,
        render,
    },
};

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = shapes::torus(2.0, 0.8, 120, 60)?;
    let start = VertexId::new(0);
    let lengths = edge_lengths(&mesh);
    let found = dijkstra(&mesh, &lengths, &[start], Until::AllReached, Progress::NONE)?;
    let farthest = found.order.last().copied().ok_or("the torus has vertices")?;
    let path = found.path(&mesh, farthest).ok_or("the torus is connected")?;

    let distances = Scalars { isolines: 12, ..Scalars::new(Field::Vertices(found.distance)) };
    let on_path = path.iter().map(|&h| [mesh.from(h), mesh.to(h)]).collect();
    let far = Style {
        paint: Paint::Scalars(distances),
        marks: vec![Mark::new(Marked::Segments(on_path))],
        ..Style::default()
    };
    let wires = Style { wireframe: Stroke::THIN, ..Style::default() };
    let scene = Scene {
        panels: vec![
            Panel::new("the mesh", Model { style: wires, ..Model::new(&mesh) }),
            Panel::new("distance, and the longest way", Model { style: far, ..Model::new(&mesh) }),
        ],
    };
    let options = RenderOptions { width: 1000, height: 460, ..RenderOptions::default() };
    let (image, report) = render(&scene, &options, Progress::NONE)?;
    assert_eq!(report.models.len(), 2);

    let folder = env::temp_dir().join(format!("dgp-scalar-picture-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let file = folder.join("distance.png");
    io::write_whole(&file, &image.to_png())?;
    println!("{} edges to {farthest}; see {}", path.len(), file.display());
    if cfg!(test) {
        fs::remove_dir_all(&folder)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
