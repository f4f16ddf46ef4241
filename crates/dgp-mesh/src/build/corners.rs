//! Which corner of a face comes after which, by arithmetic where all faces have as many.

use crate::{FaceId, FaceList};

/// Where the faces are among the corners of a list.
pub(super) trait Corners: Sync {
    /// The face that has this corner.
    fn face(&self, corner: u32) -> FaceId;
    /// The corner before this one, around its face.
    fn preceding(&self, corner: u32) -> u32;
    /// The corner after this one, around its face.
    fn following(&self, corner: u32) -> u32;
}

/// Faces of `N` corners each.
pub(super) struct Every<const N: u32>;

impl<const N: u32> Corners for Every<N> {
    #[inline]
    fn face(&self, corner: u32) -> FaceId {
        FaceId::new((corner / N) as usize)
    }

    #[inline]
    fn preceding(&self, corner: u32) -> u32 {
        if corner.is_multiple_of(N) { corner + (N - 1) } else { corner - 1 }
    }

    #[inline]
    fn following(&self, corner: u32) -> u32 {
        if corner % N == N - 1 { corner - (N - 1) } else { corner + 1 }
    }
}

/// Faces of any numbers of corners.
pub(super) struct Mixed<'a> {
    faces: &'a FaceList,
    /// Of each corner.
    face: Vec<FaceId>,
}

impl<'a> Mixed<'a> {
    pub(super) fn new(faces: &'a FaceList) -> Self {
        let mut face = Vec::with_capacity(faces.corners().len());
        for (f, corners) in faces.iter() {
            face.resize(face.len() + corners.len(), f);
        }
        Mixed { faces, face }
    }

    fn start(&self, corner: u32) -> u32 {
        self.faces.face_start(self.face(corner)).index() as u32
    }

    fn end(&self, corner: u32) -> u32 {
        self.start(corner) + self.faces.degree(self.face(corner)) as u32
    }
}

impl Corners for Mixed<'_> {
    #[inline]
    fn face(&self, corner: u32) -> FaceId {
        self.face[corner as usize]
    }

    #[inline]
    fn preceding(&self, corner: u32) -> u32 {
        if corner == self.start(corner) { self.end(corner) - 1 } else { corner - 1 }
    }

    #[inline]
    fn following(&self, corner: u32) -> u32 {
        if corner + 1 == self.end(corner) { self.start(corner) } else { corner + 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_and_lists_agree() {
        fn check<const N: u32>() {
            let face: Vec<usize> = (0..N as usize).collect();
            let faces = FaceList::from_indices(&vec![face; 3]);
            let mixed = Mixed::new(&faces);
            for c in 0..3 * N {
                let every = Every::<N>;
                assert_eq!(every.face(c), mixed.face(c));
                assert_eq!(every.preceding(c), mixed.preceding(c));
                assert_eq!(every.following(c), mixed.following(c));
                assert_eq!(every.following(every.preceding(c)), c);
            }
        }
        check::<3>();
        check::<4>();
    }
}
