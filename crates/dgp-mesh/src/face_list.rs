//! Faces as lists of vertices, one after the other.

use std::{fmt, iter, ops::Range};

use crate::{CornerId, Error, FaceId, MAX_ELEMENTS, VertexId};

/// The vertices of each face, counterclockwise seen from outside, in one array.
///
/// Where all faces have the same number of corners, as in a triangle mesh, nothing else is stored.
/// A list holds whatever a file holds: faces of any length and with repeated vertices.
///
/// ```
/// use dgp_mesh::{FaceId, FaceList, VertexId};
///
/// let v = VertexId::new;
/// let mut faces = FaceList::from_triangles(vec![[v(0), v(1), v(2)]]);
/// faces.push(&[v(0), v(2), v(3), v(4)]);
/// assert_eq!(faces.face(FaceId::new(1)).len(), 4);
/// ```
#[derive(Clone, PartialEq, Eq, Default)]
pub struct FaceList {
    corners: Vec<VertexId>,
    starts: Starts,
}

/// Where the corners of a face begin.
#[derive(Clone, Eq)]
enum Starts {
    /// Each face has this many corners, at least one.
    Every(u32),
    /// Those of face f are at `[f]..[f + 1]`.
    At(Vec<u32>),
}

impl FaceList {
    /// The largest number of corners a list can have and still become a mesh: 2³¹.
    pub const MAX_CORNERS: usize = 1 << 31;

    /// No faces.
    pub fn new() -> Self {
        FaceList::default()
    }

    /// A list of triangles.
    pub fn from_triangles(triangles: Vec<[VertexId; 3]>) -> Self {
        FaceList { corners: triangles.into_flattened(), starts: Starts::Every(3) }
    }

    /// A list of faces of `degree` corners each, given one after the other.
    ///
    /// # Panics
    /// If `degree` is zero or does not divide the number of corners.
    pub fn from_corners(corners: Vec<VertexId>, degree: usize) -> Self {
        assert!(degree > 0 && corners.len().is_multiple_of(degree), "faces of {degree} corners");
        FaceList { corners, starts: Starts::Every(degree as u32) }
    }

    /// A list of faces whose corners are given one after the other, and where each face ends.
    ///
    /// # Panics
    /// If `ends` decreases or does not end with the number of corners.
    pub fn from_ends(corners: Vec<VertexId>, ends: &[u32]) -> Self {
        assert_eq!(ends.last().map_or(0, |&end| end as usize), corners.len(), "ends of the faces");
        assert!(ends.is_sorted(), "faces end one after the other");
        let degree = ends.first().copied().unwrap_or(3);
        let uniform =
            ends.iter().zip(1_u64..).all(|(&end, f)| u64::from(end) == f * u64::from(degree));
        let starts = if degree > 0 && uniform {
            Starts::Every(degree)
        } else {
            Starts::At(iter::once(0).chain(ends.iter().copied()).collect())
        };
        FaceList { corners, starts }
    }

    /// A list from indices counted from 0, one slice a face.
    ///
    /// ```
    /// let quad_and_triangle = dgp_mesh::FaceList::from_indices(&[&[0, 1, 2, 3][..], &[3, 2, 4]]);
    /// ```
    pub fn from_indices<F: AsRef<[usize]>>(faces: &[F]) -> Self {
        let mut list = FaceList::new();
        let mut face = Vec::new();
        for indices in faces {
            face.clear();
            face.extend(indices.as_ref().iter().map(|&i| VertexId::new(i)));
            list.push(&face);
        }
        list
    }

    /// Makes room for that many more faces and corners.
    pub fn reserve(&mut self, faces: usize, corners: usize) {
        self.corners.reserve(corners);
        if let Starts::At(starts) = &mut self.starts {
            starts.reserve(faces);
        }
    }

    /// Adds a face and returns its id.
    pub fn push(&mut self, face: &[VertexId]) -> FaceId {
        let id = FaceId::new(self.len());
        if !face.is_empty() && self.is_empty() {
            self.starts = Starts::Every(face.len() as u32);
        }
        if let Starts::Every(degree) = self.starts
            && degree as usize != face.len()
        {
            self.starts = Starts::At((0..=self.len() as u32).map(|f| f * degree).collect());
        }
        self.corners.extend_from_slice(face);
        if let Starts::At(starts) = &mut self.starts {
            starts.push(self.corners.len() as u32);
        }
        id
    }

    /// How many faces there are.
    #[inline]
    pub fn len(&self) -> usize {
        match &self.starts {
            Starts::Every(degree) => self.corners.len() / *degree as usize,
            Starts::At(starts) => starts.len() - 1,
        }
    }

    /// Whether there are no faces.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of face `f`.
    #[inline]
    pub fn face(&self, f: FaceId) -> &[VertexId] {
        &self.corners[self.range(f)]
    }

    /// The vertices of face `f`, to be changed.
    pub fn face_mut(&mut self, f: FaceId) -> &mut [VertexId] {
        let range = self.range(f);
        &mut self.corners[range]
    }

    /// The corners of face `f`.
    pub fn face_corners(
        &self,
        f: FaceId,
    ) -> impl DoubleEndedIterator<Item = CornerId> + ExactSizeIterator + use<> {
        self.range(f).map(CornerId::new)
    }

    /// The first corner of face `f`.
    #[inline]
    pub fn face_start(&self, f: FaceId) -> CornerId {
        CornerId::new(self.range(f).start)
    }

    /// The face that corner `c` belongs to, by binary search.
    pub fn corner_face(&self, c: CornerId) -> FaceId {
        match &self.starts {
            Starts::Every(degree) => FaceId::new(c.index() / *degree as usize),
            // Of faces without corners that start here too, the last start is the one with a corner.
            Starts::At(starts) => {
                FaceId::new(starts.partition_point(|&start| start as usize <= c.index()) - 1)
            }
        }
    }

    /// How many corners face `f` has.
    #[inline]
    pub fn degree(&self, f: FaceId) -> usize {
        self.range(f).len()
    }

    /// All faces in order.
    pub fn iter(
        &self,
    ) -> impl DoubleEndedIterator<Item = (FaceId, &[VertexId])> + ExactSizeIterator {
        (0..self.len()).map(|i| (FaceId::new(i), self.face(FaceId::new(i))))
    }

    /// The vertex at every corner, face after face: index it by [`CornerId::index`].
    #[inline]
    pub fn corners(&self) -> &[VertexId] {
        &self.corners
    }

    /// The vertex at every corner, to be changed.
    pub fn corners_mut(&mut self) -> &mut [VertexId] {
        &mut self.corners
    }

    /// The vertex at corner `c`.
    #[inline]
    pub fn vertex(&self, c: CornerId) -> VertexId {
        self.corners[c.index()]
    }

    /// The number of corners that all faces share, if they do.
    pub fn uniform_degree(&self) -> Option<usize> {
        match &self.starts {
            Starts::Every(degree) => Some(*degree as usize),
            Starts::At(starts) => {
                let degree = *starts.get(1)? as usize;
                let all = starts.windows(2).all(|pair| (pair[1] - pair[0]) as usize == degree);
                (all && degree > 0).then_some(degree)
            }
        }
    }

    /// Whether all faces are triangles.
    pub fn is_triangles(&self) -> bool {
        self.is_empty() || self.uniform_degree() == Some(3)
    }

    /// An error if a face names a vertex that is not among `vertex_count`, or if there are more
    /// elements than ids can count.
    pub fn validate(&self, vertex_count: usize) -> Result<(), Error> {
        let limits = [
            ("vertices", vertex_count, MAX_ELEMENTS),
            ("corners", self.corners.len(), FaceList::MAX_CORNERS),
        ];
        for (kind, count, limit) in limits {
            if count > limit {
                return Err(Error::TooMany { kind, count, limit });
            }
        }
        // Without a branch per corner; ids are ordered as their indices.
        let largest = self.corners.iter().copied().max();
        if largest.is_none_or(|v| v.index() < vertex_count) {
            return Ok(());
        }
        let bad = self.corners.iter().position(|v| v.index() >= vertex_count);
        let corner = CornerId::new(bad.expect("the largest vertex is out of range"));
        let (face, vertex) = (self.corner_face(corner), self.vertex(corner));
        Err(Error::VertexOutOfRange { face, vertex, vertex_count })
    }

    #[inline]
    fn range(&self, f: FaceId) -> Range<usize> {
        match &self.starts {
            Starts::Every(degree) => {
                let degree = *degree as usize;
                f.index() * degree..(f.index() + 1) * degree
            }
            Starts::At(starts) => starts[f.index()] as usize..starts[f.index() + 1] as usize,
        }
    }
}

impl Default for Starts {
    fn default() -> Self {
        Starts::Every(3)
    }
}

impl PartialEq for Starts {
    /// Whether faces begin at the same places, given that there are equally many corners.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Starts::Every(a), Starts::Every(b)) => a == b,
            (Starts::At(a), Starts::At(b)) => a == b,
            (Starts::Every(degree), Starts::At(starts))
            | (Starts::At(starts), Starts::Every(degree)) => {
                starts.iter().enumerate().all(|(f, &start)| start == f as u32 * degree)
            }
        }
    }
}

impl fmt::Debug for FaceList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_faces_keep_their_corners() {
        let list = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[2, 1, 3, 4], &[], &[7]]);
        let lengths: Vec<_> = list.iter().map(|(_, face)| face.len()).collect();
        assert_eq!(lengths, [3, 4, 0, 1]);
        assert_eq!(
            list.face_corners(FaceId::new(1)).map(CornerId::index).collect::<Vec<_>>(),
            [3, 4, 5, 6]
        );
        assert_eq!((list.uniform_degree(), list.is_triangles()), (None, false));
    }

    #[test]
    fn faces_may_be_given_by_their_ends() {
        let list = FaceList::from_indices::<&[usize]>(&[&[0, 1, 2], &[2, 1, 3, 4], &[], &[7]]);
        assert_eq!(FaceList::from_ends(list.corners().to_vec(), &[3, 7, 7, 8]), list);
        let triangles = FaceList::from_indices(&[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(FaceList::from_ends(triangles.corners().to_vec(), &[3, 6]), triangles);
        assert_eq!(FaceList::from_ends(Vec::new(), &[0]).len(), 1);
        assert_eq!(FaceList::from_ends(Vec::new(), &[]), FaceList::new());
    }

    #[test]
    fn a_first_face_without_corners_counts() {
        let list = FaceList::from_indices::<&[usize]>(&[&[], &[0, 1, 2]]);
        assert_eq!((list.len(), list.degree(FaceId::new(0))), (2, 0));
    }

    #[test]
    fn faces_that_name_missing_vertices_are_refused() {
        let list = FaceList::from_indices(&[[0, 1, 2], [1, 2, 9]]);
        assert!(list.validate(10).is_ok());
        let error = list.validate(9).unwrap_err();
        assert!(
            matches!(error, Error::VertexOutOfRange { face, .. } if face.index() == 1),
            "{error}"
        );
    }
}
