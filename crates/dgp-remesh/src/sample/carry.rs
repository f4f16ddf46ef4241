//! What the surface has at its elements, at points of it.

use dgp_mesh::{
    AttributeTable, CornerId, DVec3, Id, IndexedFaceSet, VertexId, VertexMap,
    measure::{Surface, face_vector_areas},
};

use super::SurfaceSample;

/// Which way points of a surface look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleNormal {
    /// As the face does they lie on.
    Face,
    /// Between the normals of the corners of the face, which are means of the faces around by area.
    #[default]
    Smooth,
}

/// The unit normal at each sample; zero where faces have no area or cancel.
///
/// # Panics
/// If a sample is on a face that the surface does not have.
pub fn sample_normals(
    surface: &impl Surface,
    samples: &[SurfaceSample],
    normal: SampleNormal,
) -> Vec<DVec3> {
    let areas = face_vector_areas(surface);
    if normal == SampleNormal::Face {
        return samples.iter().map(|sample| unit(areas[sample.face])).collect();
    }
    let mut sums = VertexMap::filled(surface.vertex_positions().len(), DVec3::ZERO);
    for (f, &area) in areas.iter() {
        for v in surface.polygon(f) {
            sums[v] += area;
        }
    }
    let between = |sample: &SurfaceSample| {
        let corners = surface.polygon(sample.face).zip(sample.barycentric);
        unit(corners.map(|(v, weight)| weight * unit(sums[v])).sum())
    };
    samples.iter().map(between).collect()
}

fn unit(v: DVec3) -> DVec3 {
    // Areas of small surfaces have lengths whose squares vanish.
    let size = v.abs().max_element();
    if size > 0.0 { (v / size).normalize_or_zero() } else { DVec3::ZERO }
}

/// The data of `set` at each sample: those of vertices and corners mixed by its weights, those of faces as they are. Of
/// columns with the same name those of corners come first, then those of vertices.
///
/// # Panics
/// If a sample is on a face that the set does not have, or that is no triangle.
pub fn sample_attributes(
    set: &IndexedFaceSet,
    samples: &[SurfaceSample],
) -> AttributeTable<VertexId> {
    let corners: Vec<[CornerId; 3]> = samples
        .iter()
        .map(|sample| {
            let first = set.faces().face_start(sample.face).index();
            [first, first + 1, first + 2].map(CornerId::new)
        })
        .collect();
    let weighted = |i: usize, elements: [CornerId; 3]| {
        let weights = samples[i].barycentric;
        [0, 1, 2].map(|k| (weights[k], elements[k]))
    };
    let count = samples.len();
    let mut table = mixed(&set.corner_attributes, count, |i| weighted(i, corners[i]));
    let from_vertices = mixed(&set.vertex_attributes, count, |i| {
        weighted(i, corners[i]).map(|(weight, c)| (weight, set.faces().vertex(c)))
    });
    let from_faces: AttributeTable<VertexId> =
        set.face_attributes.gather(count, |v: VertexId| Some(samples[v.index()].face));
    for other in [from_vertices, from_faces] {
        let there: Vec<String> = table.names().map(str::to_owned).collect();
        table.append(other, |name| !there.iter().any(|known| known == name));
    }
    table
}

/// `count` rows, each mixed from three of `values`.
pub(crate) fn mixed<I: Id>(
    values: &AttributeTable<I>,
    count: usize,
    parts: impl Fn(usize) -> [(f64, I); 3],
) -> AttributeTable<VertexId> {
    if values.names().next().is_none() {
        return AttributeTable::new(count);
    }
    let known = values.len();
    let source = |v: VertexId| (v.index() < known).then(|| I::from_index(v.index()));
    let mut table: AttributeTable<VertexId> = values.gather(known + count, source);
    for i in 0..count {
        let parts = parts(i).map(|(weight, element)| (weight, VertexId::new(element.index())));
        table.mix(VertexId::new(known + i), &parts);
    }
    table.gather(count, |v: VertexId| Some(VertexId::new(known + v.index())))
}
