//! A polygon soup: faces that share nothing.

use glam::DVec3;

use crate::{
    AttributeTable, CornerId, CornerMap, Error, FaceId, FaceList, IndexedFaceSet, MAX_ELEMENTS,
    VertexId, weld_exact,
};

/// Polygons, each with corners of its own: what an STL file holds.
///
/// ```
/// use dgp_mesh::{DVec3, PolygonSoup};
///
/// let mut soup = PolygonSoup::new();
/// soup.push(&[DVec3::ZERO, DVec3::X, DVec3::Y])?;
/// soup.push(&[DVec3::Y, DVec3::X, DVec3::ONE])?;
/// assert_eq!((soup.to_separate().vertex_count(), soup.to_indexed().vertex_count()), (6, 4));
/// assert_eq!(PolygonSoup::from_indexed(&soup.to_indexed()), soup);
/// # Ok::<(), dgp_mesh::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonSoup {
    positions: CornerMap<DVec3>,
    /// Where the corners of each face begin, and where the last ones end.
    starts: Vec<u32>,
    /// Data per corner.
    pub corner_attributes: AttributeTable<CornerId>,
    /// Data per face.
    pub face_attributes: AttributeTable<FaceId>,
}

impl PolygonSoup {
    /// No faces.
    pub fn new() -> Self {
        PolygonSoup {
            positions: CornerMap::new(),
            starts: vec![0],
            corner_attributes: AttributeTable::new(0),
            face_attributes: AttributeTable::new(0),
        }
    }

    /// Adds a face whose data have default values; [`Error::TooMany`] if ids cannot count it.
    pub fn push(&mut self, face: &[DVec3]) -> Result<FaceId, Error> {
        let (faces, corners) = (self.starts.len(), self.positions.len() + face.len());
        let limits = [("faces", faces, MAX_ELEMENTS), ("corners", corners, FaceList::MAX_CORNERS)];
        for (kind, count, limit) in limits {
            if count > limit {
                return Err(Error::TooMany { kind, count, limit });
            }
        }
        for &position in face {
            self.positions.push(position);
        }
        self.starts.push(corners as u32);
        self.corner_attributes.resize(corners);
        self.face_attributes.resize(faces);
        Ok(FaceId::new(faces - 1))
    }

    /// The faces of `set` without the sharing.
    ///
    /// Data per vertex become data per corner, except where corners have data of the same name
    /// already. Vertices of no face are lost.
    pub fn from_indexed(set: &IndexedFaceSet) -> Self {
        let corners = set.faces().corners();
        let mut corner_attributes = set.corner_attributes.clone();
        let per_corner =
            set.vertex_attributes.gather(corners.len(), |c: CornerId| Some(corners[c.index()]));
        let own: Vec<String> = corner_attributes.names().map(str::to_owned).collect();
        corner_attributes.append(per_corner, |name| own.iter().all(|other| other != name));
        let mut starts = vec![0];
        starts.extend(set.faces().iter().scan(0, |end, (_, face)| {
            *end += face.len() as u32;
            Some(*end)
        }));
        PolygonSoup {
            positions: corners.iter().map(|&v| set.position(v)).collect::<Vec<_>>().into(),
            starts,
            corner_attributes,
            face_attributes: set.face_attributes.clone(),
        }
    }

    /// The faces with one vertex for all corners of equal coordinates, numbered as they appear.
    pub fn to_indexed(&self) -> IndexedFaceSet {
        let welding = weld_exact(self.positions.values());
        let at = |v: &VertexId| self.positions.values()[v.index()];
        self.with_vertices(welding.originals.values().iter().map(at).collect(), |corner| {
            welding.vertices[VertexId::new(corner)]
        })
    }

    /// The faces with a vertex for every corner.
    pub fn to_separate(&self) -> IndexedFaceSet {
        self.with_vertices(self.positions.values().to_vec(), VertexId::new)
    }

    fn with_vertices(
        &self,
        positions: Vec<DVec3>,
        vertex: impl Fn(usize) -> VertexId,
    ) -> IndexedFaceSet {
        let mut faces = FaceList::new();
        faces.reserve(self.face_count(), self.corner_count());
        let mut face = Vec::new();
        for bounds in self.starts.windows(2) {
            face.clear();
            face.extend((bounds[0] as usize..bounds[1] as usize).map(&vertex));
            faces.push(&face);
        }
        let mut set = IndexedFaceSet::from_valid(positions.into(), faces);
        set.corner_attributes = self.corner_attributes.clone();
        set.face_attributes = self.face_attributes.clone();
        set
    }

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many corners all faces have together.
    pub fn corner_count(&self) -> usize {
        self.positions.len()
    }

    /// Where the corners of face `f` are.
    pub fn face(&self, f: FaceId) -> &[DVec3] {
        let range = self.starts[f.index()] as usize..self.starts[f.index() + 1] as usize;
        &self.positions.values()[range]
    }

    /// Where each corner is.
    pub fn positions(&self) -> &CornerMap<DVec3> {
        &self.positions
    }

    /// All faces in order.
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = (FaceId, &[DVec3])> + ExactSizeIterator {
        (0..self.face_count()).map(|f| (FaceId::new(f), self.face(FaceId::new(f))))
    }
}

impl Default for PolygonSoup {
    fn default() -> Self {
        PolygonSoup::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indexing_a_soup_and_back_is_the_identity() {
        let mut soup = PolygonSoup::new();
        let (a, b, c, d) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE);
        for face in [&[a, b, c][..], &[], &[c, b, d, a], &[d], &[a, b, c]] {
            soup.push(face).unwrap();
        }
        soup.corner_attributes.insert("n", (0..11).collect::<Vec<i32>>());
        soup.face_attributes.insert("part", (0..5).collect::<Vec<u8>>());
        for set in [soup.to_indexed(), soup.to_separate()] {
            assert_eq!(PolygonSoup::from_indexed(&set), soup);
        }
        assert_eq!(soup.to_indexed().vertex_count(), 4);
    }

    #[test]
    fn data_per_vertex_become_data_per_corner() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut set =
            IndexedFaceSet::new(positions, FaceList::from_indices(&[[0, 1, 2], [2, 1, 0]]))
                .unwrap();
        set.vertex_attributes.insert("height", vec![1.0, 2.0, 3.0]);
        let soup = PolygonSoup::from_indexed(&set);
        let heights = soup.corner_attributes.get::<f64>("height").unwrap();
        assert_eq!(heights.values(), [1.0, 2.0, 3.0, 3.0, 2.0, 1.0]);
    }
}
