//! What pictures must show, checked pixel by pixel.

use std::ops::ControlFlow;

use dgp_mesh::{
    CornerId, DVec2, DVec3, EdgeSet, FaceId, FaceList, FaceSet, IndexedFaceSet, Mesh, NORMAL,
    Normal, Progress, VertexId,
};
use dgp_view::{
    Arrows, BackFaces, Background, Checker, ColorBars, Error, Field, Fill, Framing, Image, Mark,
    Marked, Model, Paint, Panel, Placement, Projection, Range, RenderOptions, RenderReport,
    Scalars, Scene, Shape, Stroke, Style, Vectors, View, render,
};

const RED: dgp_mesh::Color = dgp_mesh::Color([1.0, 0.0, 0.0, 1.0]);
const GREEN: dgp_mesh::Color = dgp_mesh::Color([0.0, 1.0, 0.0, 1.0]);

/// A small picture of what is there and nothing else: no light, no shadow, no background.
fn plain(size: u32) -> RenderOptions {
    RenderOptions {
        width: size,
        height: size,
        samples: 1,
        view: View::Front,
        projection: Projection::Orthographic,
        background: Background::Transparent,
        margin: 0.0,
        occlusion: 0.0,
        shadow: 0.0,
        color_bars: ColorBars::Hidden,
        ..RenderOptions::default()
    }
}

fn unlit(paint: Paint) -> Style {
    Style { fill: Fill::Flat, paint, back_faces: BackFaces::LikeFront, ..Style::default() }
}

fn faces(points: &[[f64; 3]], faces: &[&[usize]]) -> IndexedFaceSet {
    let points: Vec<DVec3> = points.iter().map(|&p| DVec3::from_array(p)).collect();
    IndexedFaceSet::new(points, FaceList::from_indices(faces)).unwrap()
}

fn draw(shape: Shape<'_>, style: Style, options: &RenderOptions) -> (Image, RenderReport) {
    let scene = Scene::new(Model { style, ..Model::new(shape) });
    render(&scene, options, Progress::NONE).unwrap()
}

/// Rows of letters: `#` where something is seen.
fn cover(image: &Image) -> Vec<String> {
    let row =
        |y| (0..image.width()).map(|x| if image.pixel(x, y)[3] > 0 { '#' } else { '.' }).collect();
    (0..image.height()).map(row).collect()
}

/// A ball of triangles, `n` from pole to pole.
fn ball(n: usize) -> IndexedFaceSet {
    let mut points = Vec::new();
    for i in 0..=n {
        for j in 0..2 * n {
            let (a, b) = (i as f64 / n as f64, j as f64 / n as f64);
            let ((s, c), (sb, cb)) =
                ((a * std::f64::consts::PI).sin_cos(), (b * std::f64::consts::PI).sin_cos());
            points.push([s * cb, c, -s * sb]);
        }
    }
    let at = |i: usize, j: usize| i * 2 * n + j % (2 * n);
    let mut list: Vec<[usize; 3]> = Vec::new();
    for i in 0..n {
        for j in 0..2 * n {
            list.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            list.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let list: Vec<&[usize]> = list.iter().map(|f| &f[..]).collect();
    faces(&points, &list)
}

#[test]
fn a_triangle_covers_the_pixels_whose_centers_it_holds() {
    // A right triangle over an 8×8 picture: the diagonal passes through the centers of 8 pixels. It is
    // a lower left side of the triangle below it, which therefore does not own them.
    let upper = faces(&[[0.0, 8.0, 0.0], [0.0, 0.0, 0.0], [8.0, 8.0, 0.0]], &[&[0, 1, 2]]);
    let (image, report) = draw(Shape::Faces(&upper), Style::default(), &plain(8));
    let expected: Vec<String> = (0..8).map(|y| "#".repeat(8 - y) + &".".repeat(y)).collect();
    let without: Vec<String> = (0..8).map(|y| "#".repeat(7 - y) + &".".repeat(y + 1)).collect();
    let found = cover(&image);
    assert!(found == expected || found == without, "{found:#?}");
    assert_eq!(report.covered_pixels, found.concat().matches('#').count());
    assert_eq!(report.models[0].triangles, 1);
}

#[test]
fn triangles_that_share_an_edge_cover_each_sample_on_it_once() {
    let corners = [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]];
    for diagonal in [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]] {
        let both: Vec<usize> = diagonal
            .iter()
            .map(|f| {
                // Both corners of the square keep the frame the same.
                let set = faces(&corners, &[&f[..]]);
                let mut points = set.positions().values().to_vec();
                points.extend([DVec3::ZERO, DVec3::new(8.0, 8.0, 0.0)]);
                let list = FaceList::from_indices(&[f.to_vec(), vec![4, 4, 5]]);
                let set = IndexedFaceSet::new(points, list).unwrap();
                draw(Shape::Faces(&set), Style::default(), &plain(8)).1.covered_pixels
            })
            .collect();
        assert_eq!(both.iter().sum::<usize>(), 64, "{both:?}");
    }
}

#[test]
fn what_is_nearer_hides_what_is_further_whatever_comes_first() {
    let near = [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]];
    let far = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    for (first, second, red) in [(near, far, 0), (far, near, 1)] {
        let set = faces(&[first, second].concat(), &[&[0, 1, 2], &[3, 4, 5]]);
        let mut colors = vec![GREEN; 2];
        colors[red] = RED;
        let paint = Paint::Colors(Field::Faces(colors.into()));
        let (image, _) = draw(Shape::Faces(&set), unlit(paint), &plain(16));
        assert_eq!(image.pixel(2, 12), [255, 0, 0, 255]);
        assert!(image.pixels().iter().all(|p| p[1] == 0), "nothing green is seen");
    }
}

#[test]
fn back_faces_have_their_own_color_or_none() {
    let front = faces(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[&[0, 1, 2]]);
    let back = faces(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[&[0, 2, 1]]);
    let style = |back_faces| Style { back_faces, ..unlit(Paint::Uniform(GREEN)) };
    for projection in [Projection::Orthographic, Projection::default()] {
        let options = RenderOptions { projection, ..plain(16) };
        let pixel = |set: &IndexedFaceSet, back_faces| {
            draw(Shape::Faces(set), style(back_faces), &options).0.pixel(3, 12)
        };
        assert_eq!(pixel(&front, BackFaces::Colored(RED)), [0, 255, 0, 255]);
        assert_eq!(pixel(&back, BackFaces::Colored(RED)), [255, 0, 0, 255]);
        assert_eq!(pixel(&back, BackFaces::LikeFront), [0, 255, 0, 255]);
        assert_eq!(pixel(&back, BackFaces::Hidden), [0; 4]);
        assert_eq!(pixel(&front, BackFaces::Hidden), [0, 255, 0, 255]);
    }
}

#[test]
fn colors_are_interpolated_and_numbers_run_through_the_map() {
    let square = faces(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]],
        &[&[0, 1, 2, 3]],
    );
    let values = Field::Vertices(vec![0.0, 1.0, 1.0, 0.0].into());
    let scalars = Scalars { range: Range::Between(0.25, 0.75), ..Scalars::new(values) };
    let ends = [scalars.map.color(0.0).to_rgba8(), scalars.map.color(1.0).to_rgba8()];
    let (image, report) = draw(Shape::Faces(&square), unlit(Paint::Scalars(scalars)), &plain(32));
    assert_eq!([image.pixel(0, 9), image.pixel(31, 20)], ends);
    assert_eq!(report.models[0].range, Some((0.25, 0.75)));
    let corner = Field::Corners(vec![RED, GREEN, GREEN, RED]);
    let (image, _) = draw(Shape::Faces(&square), unlit(Paint::Colors(corner)), &plain(32));
    let [r, g, ..] = image.pixel(16, 16);
    // Half the light of each is 188 of 255.
    assert!(r.abs_diff(188) < 4 && g.abs_diff(188) < 4, "{r} {g}");
}

#[test]
fn the_color_bar_ends_in_the_colors_of_the_ends() {
    let set = ball(4);
    let heights: Vec<f64> = set.positions().values().iter().map(|p| p.y).collect();
    let scalars = Scalars::new(Field::Vertices(heights.into()));
    let map = scalars.map;
    let style = Style { paint: Paint::Scalars(scalars), ..Style::default() };
    let options = RenderOptions {
        color_bars: ColorBars::Shown,
        background: Background::Plain(dgp_mesh::Color([1.0; 4])),
        ..plain(300)
    };
    let (image, _) = draw(Shape::Faces(&set), style, &options);
    let has = |t: f64| {
        let [r, g, b, _] = map.color(t).to_rgba8();
        let close =
            |p: &[u8; 4]| p[0].abs_diff(r) < 4 && p[1].abs_diff(g) < 4 && p[2].abs_diff(b) < 4;
        (200..300).find(|&x| (0..300).any(|y| close(&image.pixel(x, y))))
    };
    let (low, high) = (has(0.0).expect("the low end"), has(1.0).expect("the high end"));
    let row = |x: u32, t: f64| {
        let [r, ..] = map.color(t).to_rgba8();
        (0..300).find(|&y| image.pixel(x, y)[0].abs_diff(r) < 4)
    };
    assert_eq!(low, high, "both in the first column of the bar");
    assert!(row(high, 1.0) < row(low, 0.0), "the high end is above");
}

#[test]
fn concave_polygons_are_filled_inside_only() {
    // A plus sign, 12 corners, as one face.
    let plus: Vec<[f64; 3]> = [
        [1, 0],
        [2, 0],
        [2, 1],
        [3, 1],
        [3, 2],
        [2, 2],
        [2, 3],
        [1, 3],
        [1, 2],
        [0, 2],
        [0, 1],
        [1, 1],
    ]
    .map(|[x, y]: [i32; 2]| [f64::from(x), f64::from(y), 0.0])
    .to_vec();
    let set = faces(&plus, &[&(0..12).collect::<Vec<_>>()]);
    let (image, _) = draw(Shape::Faces(&set), Style::default(), &plain(30));
    let found = cover(&image);
    for (y, row) in found.iter().enumerate() {
        let middle = (10..20).contains(&y);
        let expected = if middle {
            "#".repeat(30)
        } else {
            ".".repeat(10) + &"#".repeat(10) + &".".repeat(10)
        };
        assert_eq!(row, &expected, "row {y}");
    }
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let set = ball(40);
    let heights: Vec<f64> = set.positions().values().iter().map(|p| p.y).collect();
    let scalars = Scalars { isolines: 10, ..Scalars::new(Field::Vertices(heights.into())) };
    let styles = [
        Style::default(),
        Style { paint: Paint::Scalars(scalars), boundary: Stroke::BOLD, ..Style::faceted() },
        Style::wireframe(),
    ];
    let panels =
        styles.map(|style| Panel::new("ball", Model { style, ..Model::new(&set) })).to_vec();
    let mut scene = Scene { panels };
    scene.panels.push(Panel::new("points", Model::new(set.positions().values())));
    let options = RenderOptions { width: 320, height: 240, ..RenderOptions::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&scene, &options, Progress::NONE).unwrap())
    };
    let one = with(1);
    for threads in [2, 8] {
        assert!(with(threads) == one, "{threads} threads");
    }
}

#[test]
fn scaling_by_a_power_of_two_changes_nothing() {
    let set = ball(12);
    let options = RenderOptions { width: 120, height: 90, ..RenderOptions::default() };
    let style = || Style {
        wireframe: Stroke::THIN,
        arrows: vec![Arrows::new(Vectors::Vertices(set.positions().clone()))],
        ..Style::default()
    };
    let scaled = |factor: f64| {
        let points: Vec<DVec3> = set.positions().values().iter().map(|p| *p * factor).collect();
        let scaled = IndexedFaceSet::new(points, set.faces().clone()).unwrap();
        let mut model = Model { style: style(), ..Model::new(&scaled) };
        model.placement = Placement::at(DVec3::new(3.0, 0.0, 0.0) * factor);
        render(&Scene::new(model), &options, Progress::NONE).unwrap()
    };
    let expected = scaled(1.0);
    for power in [-960, -30, 1, 7, 1000] {
        assert!(scaled(2_f64.powi(power)) == expected, "2^{power}");
    }
}

#[test]
fn symmetric_scenes_give_symmetric_pictures() {
    let corners: Vec<[f64; 3]> =
        [[-3.0, -1.0, 0.0], [3.0, -1.0, 0.0], [1.7, 1.3, 0.5], [-1.7, 1.3, 0.5], [0.0, 2.0, 0.0]]
            .to_vec();
    let set = faces(&corners, &[&[0, 1, 2, 4, 3]]);
    for projection in [Projection::Orthographic, Projection::default()] {
        let options = RenderOptions { projection, samples: 3, ..plain(61) };
        let (image, _) = draw(Shape::Faces(&set), unlit(Paint::Uniform(RED)), &options);
        for (x, y) in (0..30).flat_map(|x| (0..61).map(move |y| (x, y))) {
            assert_eq!(image.pixel(x, y), image.pixel(60 - x, y), "{x} {y}");
        }
        let covered = cover(&image).concat().matches('#').count();
        assert!(covered > 61 * 20, "the picture is filled: {covered}");
    }
}

#[test]
fn nothing_at_all_still_gives_a_picture() {
    let nan = [DVec3::NAN, DVec3::new(0.0, f64::INFINITY, 1.0)];
    let one = [DVec3::splat(1e300)];
    let same = [DVec3::splat(-7.0); 3];
    let scene = Scene {
        panels: vec![
            Panel::default(),
            Panel::new("nowhere", Model::new(&nan[..])),
            Panel::new("one", Model::new(&one[..])),
            Panel::new("three", Model::new(&same[..])),
        ],
    };
    for projection in [Projection::Orthographic, Projection::default()] {
        let options =
            RenderOptions { projection, width: 200, height: 200, ..RenderOptions::default() };
        let (image, report) = render(&scene, &options, Progress::NONE).unwrap();
        assert_eq!(report.models[0].non_finite_vertices, 2);
        assert_eq!((report.models[0].lines_and_points, report.models[1].lines_and_points), (0, 1));
        assert!(report.covered_pixels > 0 && image.pixels().iter().all(|p| p[3] == 255));
    }
    let (image, _) = render(&Scene::default(), &plain(9), Progress::NONE).unwrap();
    assert!(image.pixels().iter().all(|p| *p == [0; 4]));
}

#[test]
fn what_cannot_be_drawn_is_skipped_and_counted() {
    let mut points = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [f64::NAN, 0.0, 0.0]];
    points.push([9.0, 9.0, f64::INFINITY]);
    let set = faces(&points, &[&[0, 1, 2], &[0, 1, 3], &[0, 0, 1], &[0, 1], &[], &[2, 1, 0, 4]]);
    let (image, report) = draw(Shape::Faces(&set), Style::default(), &plain(16));
    let counted = &report.models[0];
    assert_eq!(counted.non_finite_vertices, 2);
    assert_eq!(counted.triangles_without_area, 1);
    assert_eq!(counted.faces_of_fewer_than_three_vertices, 2);
    assert!(counted.triangles_at_non_finite_vertices >= 2);
    assert!(image.pixel(2, 13)[3] == 255, "the triangle fills the picture");
}

#[test]
fn boundaries_and_marks_are_seen() {
    let square = faces(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]],
        &[&[0, 1, 2], &[0, 2, 3]],
    );
    let mesh = Mesh::new(&square).unwrap();
    let stroke = Stroke { color: RED, width: 4.0 };
    let diagonal = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).unwrap();
    let options = RenderOptions { margin: 0.1, ..plain(80) };
    let mark = |elements| vec![Mark { color: RED, width: 4.0, ..Mark::new(elements) }];
    let green = || unlit(Paint::Uniform(GREEN));
    for shape in [Shape::Faces(&square), Shape::Mesh(&mesh)] {
        let (image, report) = draw(shape, Style { boundary: stroke, ..green() }, &options);
        assert_eq!(report.models[0].lines_and_points, 4);
        assert_eq!(image.pixel(40, 8), [255, 0, 0, 255], "the upper side");
        assert_eq!(image.pixel(40, 40), [0, 255, 0, 255], "the diagonal is no boundary");
    }
    let edges: EdgeSet = [diagonal].into_iter().collect();
    let ends = mesh.edge_vertices(diagonal);
    for elements in [Marked::Edges(edges), Marked::Segments(vec![ends])] {
        let (image, _) =
            draw(Shape::Mesh(&mesh), Style { marks: mark(elements), ..green() }, &options);
        assert_eq!(image.pixel(40, 40), [255, 0, 0, 255]);
    }
    let upper: FaceSet = [FaceId::new(1)].into_iter().collect();
    let style = Style { marks: mark(Marked::Faces(upper)), ..green() };
    let (image, _) = draw(Shape::Mesh(&mesh), style, &options);
    assert_eq!([image.pixel(20, 20), image.pixel(60, 60)], [[255, 0, 0, 255], [0, 255, 0, 255]]);
}

#[test]
fn wireframes_show_sides_of_faces_and_not_those_of_their_pieces() {
    let square = faces(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]],
        &[&[0, 1, 2, 3]],
    );
    let options = RenderOptions { samples: 2, ..plain(80) };
    let wire = Stroke { color: RED, width: 2.0 };
    let style = Style { wireframe: wire, fill: Fill::Background, ..Style::default() };
    let (image, _) = draw(Shape::Faces(&square), style, &options);
    assert_eq!(image.pixel(0, 40), [255, 0, 0, 255]);
    assert!((10..70).all(|x| image.pixel(x, 79 - x)[3] == 0), "no diagonal");
    let bare = Style { wireframe: wire, fill: Fill::None, ..Style::default() };
    let (image, report) = draw(Shape::Faces(&square), bare, &options);
    assert_eq!(report.models[0].lines_and_points, 4);
    assert_eq!((image.pixel(40, 0)[3], image.pixel(40, 40)[3]), (255, 0));
}

#[test]
fn the_checkerboard_has_as_many_squares_as_asked_for() {
    let square = faces(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]],
        &[&[0, 1, 2, 3]],
    );
    let uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
    let checker =
        Checker { squares: 4.0, colors: [RED, GREEN], ..Checker::new(Field::Corners(uv.to_vec())) };
    let (image, _) = draw(Shape::Faces(&square), unlit(Paint::Checker(checker)), &plain(64));
    for (x, y) in (0..4).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let expected = if (x + 3 - y) % 2 == 0 { [255, 0, 0, 255] } else { [0, 255, 0, 255] };
        assert_eq!(image.pixel(16 * x + 8, 16 * y + 8), expected, "square {x} {y}");
    }
}

#[test]
fn what_is_behind_the_eye_is_cut_off() {
    // A floor that reaches from behind the eye to far before it.
    let floor = faces(
        &[[-1e3, -1.0, 1e3], [1e3, -1.0, 1e3], [1e3, -1.0, -1e3], [-1e3, -1.0, -1e3]],
        &[&[0, 1, 2, 3]],
    );
    let view = View::Eye { eye: DVec3::ZERO, target: -DVec3::Z };
    let options = RenderOptions { view, projection: Projection::default(), ..plain(40) };
    let (image, _) = draw(Shape::Faces(&floor), Style::default(), &options);
    let found = cover(&image);
    assert_eq!(found[..20].concat().matches('#').count(), 0, "nothing above the horizon");
    assert_eq!(found[21..].concat().matches('.').count(), 0, "floor up to the lower edge");
}

#[test]
fn shared_framing_keeps_sizes() {
    let small = faces(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[&[0, 1, 2]]);
    let large = faces(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[&[0, 1, 2]]);
    let panels = vec![Panel::new("", Model::new(&small)), Panel::new("", Model::new(&large))];
    let scene = Scene { panels };
    let covered = |framing| {
        let options = RenderOptions { framing, width: 80, height: 40, ..plain(40) };
        let (image, _) = render(&scene, &options, Progress::NONE).unwrap();
        let rows = cover(&image);
        [0..40, 40..80]
            .map(|half| rows.iter().map(|r| r[half.clone()].matches('#').count()).sum::<usize>())
    };
    let [a, b] = covered(Framing::Each);
    assert_eq!(a, b);
    let [a, b] = covered(Framing::Shared);
    assert!((14..=18).contains(&(b / a)), "one sixteenth of the area: {a} {b}");
}

#[test]
fn points_with_normals_are_lit_by_them() {
    let points = vec![DVec3::ZERO, DVec3::X];
    let mut set = IndexedFaceSet::new(points, FaceList::new()).unwrap();
    let normals =
        [DVec3::new(-0.4, 0.6, 0.7), DVec3::new(0.1, -1.0, 0.1)].map(|n| Normal(n.normalize()));
    set.vertex_attributes.insert(NORMAL, normals.to_vec());
    let options = RenderOptions { margin: 0.3, ..plain(60) };
    let (image, report) = draw(Shape::Faces(&set), Style::default(), &options);
    assert_eq!(report.models[0].lines_and_points, 2);
    let [toward, away] = [image.pixel(18, 30), image.pixel(42, 30)];
    assert!(toward[3] == 255 && away[3] == 255, "{toward:?} {away:?}");
    assert!(toward[0] > away[0] + 40, "{toward:?} {away:?}");
}

#[test]
fn wrong_counts_options_and_sizes_are_refused() {
    let set = faces(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[&[0, 1, 2]]);
    let fail = |style: Style, options: &RenderOptions| {
        let scene = Scene::new(Model { style, ..Model::new(&set) });
        render(&scene, options, Progress::NONE).unwrap_err()
    };
    let colors = unlit(Paint::Colors(Field::Vertices(vec![RED; 4].into())));
    let error = fail(colors, &plain(8));
    assert!(matches!(error, Error::CountMismatch { count: 4, expected: 3, .. }), "{error}");
    let huge = RenderOptions { width: 60_000, height: 60_000, ..plain(8) };
    assert!(matches!(fail(Style::default(), &huge), Error::ImageSize { .. }));
    let long = RenderOptions { width: u32::MAX, height: 1, ..plain(8) };
    assert!(matches!(fail(Style::default(), &long), Error::InvalidOption { name: "width", .. }));
    let nothing = RenderOptions { width: 0, ..plain(8) };
    assert!(matches!(fail(Style::default(), &nothing), Error::ImageSize { total: 0, .. }));
    let edges =
        Style { marks: vec![Mark::new(Marked::Edges(EdgeSet::all(1)))], ..Style::default() };
    assert!(matches!(fail(edges, &plain(8)), Error::NoEdges { panel: 0, model: 0 }));
    let far = Style { marks: vec![Mark::new(Marked::Faces(FaceSet::all(2)))], ..Style::default() };
    assert!(matches!(fail(far, &plain(8)), Error::ElementOutOfRange { index: 1, count: 1, .. }));
    let segment = vec![[VertexId::new(0), VertexId::new(3)]];
    let far = Style { marks: vec![Mark::new(Marked::Segments(segment))], ..Style::default() };
    assert!(matches!(fail(far, &plain(8)), Error::ElementOutOfRange { index: 3, count: 3, .. }));
    for width in [-1.0, f64::NAN, 1e9] {
        let wide = Style { boundary: Stroke { width, ..Stroke::BOLD }, ..Style::default() };
        let error = fail(wide, &plain(8));
        assert!(matches!(error, Error::InvalidOption { name: "boundary.width", .. }), "{error}");
    }
    let view = View::From(DVec3::ZERO);
    let error = fail(Style::default(), &RenderOptions { view, ..plain(8) });
    assert!(matches!(error, Error::InvalidOption { name: "view", .. }), "{error}");
}

#[test]
fn it_stops_when_asked_to_at_every_report() {
    let set = ball(3);
    let scene = Scene::new(Model::new(&set));
    for limit in [0.0, 0.2, 0.5, 0.9] {
        let stop =
            |done| if done >= limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let result = render(&scene, &plain(16), Progress::new(&stop));
        assert!(matches!(result, Err(Error::Cancelled(_))), "at {limit}");
    }
}

#[test]
fn png_files_hold_the_pixels() {
    let set = ball(3);
    for background in [Background::Transparent, Background::Gradient] {
        let options = RenderOptions { background, ..plain(33) };
        let (image, _) = draw(Shape::Faces(&set), Style::default(), &options);
        let file = image.to_png();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let channels = info.color_type.samples();
        assert_eq!((info.width, info.height), (33, 33));
        for (pixel, read) in image.pixels().iter().zip(bytes.chunks(channels)) {
            assert_eq!(&pixel[..channels], read);
        }
    }
}

#[test]
fn corner_values_of_polygon_meshes_stay_at_their_corners() {
    let square = faces(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0], [16.0, 0.0, 0.0]],
        &[&[0, 1, 2, 3], &[1, 4, 2]],
    );
    let mut set = square.clone();
    let heights: Vec<f64> = (0..7)
        .map(|c| if set.faces().vertex(CornerId::new(c)).index() == 3 { 1.0 } else { 0.0 })
        .collect();
    set.corner_attributes.insert("height", heights.clone());
    let mesh = Mesh::new(&set).unwrap();
    let of_mesh = mesh.attributes().corner.get::<f64>("height").unwrap().values().to_vec();
    let paint = |values| {
        unlit(Paint::Scalars(Scalars {
            range: Range::Full,
            ..Scalars::new(Field::Corners(values))
        }))
    };
    let (one, _) = draw(Shape::Faces(&square), paint(heights), &plain(40));
    let (other, _) = draw(Shape::Mesh(&mesh), paint(of_mesh), &plain(40));
    assert!(one == other);
    assert_ne!(one.pixel(0, 11), one.pixel(30, 29), "the corner shows");
}

#[test]
fn polygons_of_many_corners_keep_their_notches() {
    // A square with a notch from above, whose walls have three thousand corners each.
    const STEPS: usize = 3000;
    let wall = |x: f64, i: usize| [x, 2.0 + 6.0 * i as f64 / STEPS as f64, 0.0];
    let mut points = vec![[0.0, 8.0, 0.0], [0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0]];
    points.extend((0..=STEPS).rev().map(|i| wall(5.0, i)));
    points.extend((0..=STEPS).map(|i| wall(3.0, i)));
    let polygon: Vec<usize> = (0..points.len()).collect();
    let set = faces(&points, &[&polygon]);
    let (image, _) = draw(Shape::Faces(&set), unlit(Paint::Uniform(GREEN)), &plain(32));
    let wall = "#".repeat(12) + &".".repeat(8) + &"#".repeat(12);
    let rows: Vec<String> =
        (0..32).map(|y| if y < 24 { wall.clone() } else { "#".repeat(32) }).collect();
    assert_eq!(cover(&image), rows);
}
