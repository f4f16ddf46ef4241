//! What a file holds.

use dgp_mesh::{AttributeTable, AttributeValue, Id, IndexedFaceSet, Mesh, VertexId, VertexMap};

use crate::Error;

/// The name of the fourth coordinate of OBJ vertices (`f64` per vertex).
pub const WEIGHT: &str = "weight";
/// The name of color map indices of OFF faces (`i32` per face).
pub const COLOR_INDEX: &str = "color_index";

/// The name of the 16 bits that binary STL has for each facet, in which some programs keep colors
/// (`u16` per face).
pub const ATTRIBUTE_BYTES: &str = "attribute_bytes";

/// The contents of a file: faces that index vertices, their attributes, and what else there was.
///
/// A point cloud has no faces. See [`dgp_mesh::AttributeTable`] for the names of attributes.
///
/// ```
/// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng roof\nf 1 2 3\n";
/// let document = dgp_io::read_bytes(text, dgp_io::Format::Obj)?;
/// assert_eq!(document.set.face_count(), 1);
/// assert!(document.set.face_attributes.contains(dgp_mesh::GROUP));
/// # Ok::<(), dgp_io::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Vertices, faces and their attributes.
    pub set: IndexedFaceSet,
    /// Lines from vertex to vertex (OBJ `l`).
    pub polylines: Vec<Vec<VertexId>>,
    /// Vertices that are marks of their own (OBJ `p`).
    pub points: Vec<VertexId>,
    /// The comments, in order, without the sign that begins them.
    pub comments: Vec<String>,
    /// The notes of PLY headers (`obj_info`).
    pub notes: Vec<String>,
    /// The files that define the materials (OBJ `mtllib`).
    pub material_libraries: Vec<String>,
    /// What subdivision must know (OBJ `t`).
    pub tags: Vec<SubdivisionTag>,
    /// Elements that are neither vertices nor faces (PLY), such as edges.
    pub elements: Vec<ExtraElement>,
}

/// A tag of a subdivision surface, as OpenSubdiv writes it into OBJ files:
/// `t crease 2/1/0 4 7 2.5` is a crease of sharpness 2.5 between vertices 4 and 7.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SubdivisionTag {
    /// What it is: `crease`, `corner`, `interpolateboundary`, …
    pub name: String,
    /// Whole numbers, for `crease` and `corner` vertices counted from 0.
    pub integers: Vec<i64>,
    /// Numbers, for `crease` and `corner` the sharpness.
    pub floats: Vec<f64>,
    /// Words.
    pub strings: Vec<String>,
}

/// An element of a PLY file that is neither vertices nor faces, with all its properties.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtraElement {
    /// Its name, such as `edge`.
    pub name: String,
    /// Its properties.
    pub rows: AttributeTable<RowId>,
}

/// A row of an [`ExtraElement`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RowId(pub u32);

impl Id for RowId {
    const KIND: &'static str = "row";

    fn from_index(index: usize) -> Self {
        RowId(u32::try_from(index).expect("readers refuse more rows than ids can count"))
    }

    fn index(self) -> usize {
        self.0 as usize
    }
}

/// A list of numbers as an attribute: the list properties of PLY files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberList(pub Vec<f64>);

impl AttributeValue for NumberList {}

impl Document {
    /// An error if a table of attributes does not fit the elements it belongs to, or if a vertex that
    /// is named outside of the faces does not exist.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let set = &self.set;
        let lengths = [
            ("vertices", set.vertex_attributes.len(), set.vertex_count()),
            ("corners", set.corner_attributes.len(), set.faces().corners().len()),
            ("faces", set.face_attributes.len(), set.face_count()),
        ];
        for (element, found, expected) in lengths {
            if found != expected {
                return Err(Error::AttributeLength { element, found, expected });
            }
        }
        let vertex_count = set.vertex_count();
        let vertices = self.polylines.iter().flatten().chain(&self.points);
        match vertices.copied().find(|v| v.index() >= vertex_count) {
            Some(vertex) => Err(Error::NoSuchVertex { vertex, vertex_count }),
            None => Ok(()),
        }
    }
}

impl Document {
    /// Puts `set` in place of the faces there are; lines, points and tags follow their vertices.
    ///
    /// `vertices` tells what became of each vertex, as repairs and compactions report it. Lines are
    /// cut where a vertex was dropped, and points and tags of dropped vertices go: returns how many of
    /// all these were cut or went.
    pub fn follow(&mut self, set: IndexedFaceSet, vertices: &VertexMap<Option<VertexId>>) -> usize {
        let moved = |&v: &VertexId| vertices.get(v).copied().flatten();
        let mut lost = 0;
        let mut polylines = Vec::new();
        for line in &self.polylines {
            let parts = line.split(|v| moved(v).is_none());
            lost += usize::from(line.iter().any(|v| moved(v).is_none()));
            let parts = parts.map(|part| part.iter().filter_map(moved).collect::<Vec<_>>());
            polylines.extend(parts.filter(|part| part.len() > 1));
        }
        self.polylines = polylines;
        let before = self.points.len() + self.tags.len();
        self.points = self.points.iter().filter_map(moved).collect();
        self.tags.retain_mut(|tag| {
            if !["crease", "corner"].contains(&tag.name.as_str()) {
                return true;
            }
            let renumbered = tag.integers.iter().map(|&i| {
                let v =
                    usize::try_from(i).ok().filter(|&i| i < vertices.len()).map(VertexId::new)?;
                moved(&v).map(|v| v.index() as i64)
            });
            let renumbered: Option<Vec<i64>> = renumbered.collect();
            let stays = renumbered.is_some();
            tag.integers = renumbered.unwrap_or_default();
            stays
        });
        lost += before - self.points.len() - self.tags.len();
        self.set = set;
        lost
    }
}

impl From<IndexedFaceSet> for Document {
    fn from(set: IndexedFaceSet) -> Self {
        Document { set, ..Document::default() }
    }
}

impl From<&Mesh> for Document {
    /// The mesh with its data per vertex, corner and face.
    fn from(mesh: &Mesh) -> Self {
        mesh.to_indexed().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_points_and_tags_follow_their_vertices() {
        let v = VertexId::new;
        let mut document = Document {
            polylines: vec![vec![v(0), v(1), v(2), v(3), v(4)], vec![v(3), v(4)]],
            points: vec![v(1), v(2)],
            tags: vec![
                SubdivisionTag {
                    name: "crease".into(),
                    integers: vec![3, 4],
                    ..Default::default()
                },
                SubdivisionTag { name: "corner".into(), integers: vec![2], ..Default::default() },
                SubdivisionTag {
                    name: "interpolateboundary".into(),
                    integers: vec![2],
                    ..Default::default()
                },
            ],
            ..Document::default()
        };
        // Vertex 2 goes, the others move up.
        let vertices = vec![Some(v(0)), Some(v(1)), None, Some(v(2)), Some(v(3))].into();
        assert_eq!(document.follow(IndexedFaceSet::default(), &vertices), 3);
        assert_eq!(document.polylines, [vec![v(0), v(1)], vec![v(2), v(3)], vec![v(2), v(3)]]);
        assert_eq!(document.points, [v(1)]);
        let tags: Vec<_> = document.tags.iter().map(|tag| tag.integers.clone()).collect();
        assert_eq!(tags, [vec![2, 3], vec![2]]);
    }
}
