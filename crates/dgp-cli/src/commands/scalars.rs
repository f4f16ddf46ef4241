//! Numbers at vertices as colors, pictures and lists.

use std::{fmt::Write, path::PathBuf};

use clap::Args;
use dgp::{
    mesh::{COLOR, Color, Mesh, VertexMap},
    view::{
        ColorMap, Error, Field, Model, Paint, Panel, Range, RenderOptions, Scalars, Scene, Style,
        render,
    },
};

use crate::{failure::Failure, session::Session};

/// A picture of the result.
#[derive(Clone, Debug, Args)]
pub(crate) struct Pictured {
    /// Draw the result into this PNG
    #[arg(long, value_name = "PNG")]
    pub(crate) picture: Option<PathBuf>,
}

impl Pictured {
    /// Draws one field, if a picture was asked for.
    pub(crate) fn draw(
        &self,
        session: &mut Session<'_>,
        mesh: &Mesh,
        values: VertexMap<f64>,
        label: &str,
    ) -> Result<(), Failure> {
        let fields = vec![(label.to_owned(), Field::Vertices(values))];
        self.draw_all(session, mesh, fields, ColorMap::CoolWarm)
    }

    /// Draws fields side by side, if a picture was asked for.
    pub(crate) fn draw_all(
        &self,
        session: &mut Session<'_>,
        mesh: &Mesh,
        fields: Vec<(String, Field<f64>)>,
        map: ColorMap,
    ) -> Result<(), Failure> {
        let Some(path) = &self.picture else { return Ok(()) };
        let range = if map == ColorMap::CoolWarm { Range::Symmetric } else { Range::Full };
        let panels = fields.into_iter().map(|(label, values)| {
            let scalars = Scalars { map, range, ..Scalars::new(values) };
            let style = Style { paint: Paint::Scalars(scalars), ..Style::default() };
            Panel::new(label, Model { style, ..Model::new(mesh) })
        });
        let scene = Scene { panels: panels.collect() };
        let png = session.run("drawing", |progress| {
            let (image, _) = render(&scene, &RenderOptions::default(), progress)?;
            Ok::<_, Error>(image.to_png())
        })?;
        session.store(path, &png)
    }
}

/// Gives vertices colors that show these numbers; `symmetric` puts 0 into the middle of the map.
pub(crate) fn color_vertices(
    mesh: &mut Mesh,
    values: &VertexMap<f64>,
    map: ColorMap,
    symmetric: bool,
) {
    let colors = vertex_colors(values, map, symmetric);
    mesh.attributes_mut().vertex.insert(COLOR, colors);
}

/// Colors that show these numbers; `symmetric` puts 0 into the middle of the map.
pub(crate) fn vertex_colors(
    values: &VertexMap<f64>,
    map: ColorMap,
    symmetric: bool,
) -> VertexMap<Color> {
    let mut sorted: Vec<f64> = values.values().iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    // All but 2 % at each end, so that an outlier does not hide the rest.
    let at = |part: f64| sorted.get((part * (sorted.len() as f64 - 1.0)) as usize).copied();
    let (mut low, mut high) = (at(0.02).unwrap_or(0.0), at(0.98).unwrap_or(1.0));
    if symmetric {
        high = low.abs().max(high.abs());
        low = -high;
    }
    values.map(|&x| {
        let part = if high > low { ((x - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        Color::from_rgba8(map.color(part).to_rgba8())
    })
}

/// Lines of numbers separated by commas under a line of names.
pub(crate) fn csv(names: &[&str], rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let mut text = names.join(",");
    text.push('\n');
    for row in rows {
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        writeln!(text, "{}", row.join(",")).expect("a string takes everything");
    }
    text
}
