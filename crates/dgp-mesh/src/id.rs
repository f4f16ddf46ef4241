//! Typed ids of the elements of a mesh.
//!
//! An id is an index that cannot be mixed with one of another kind. It holds index + 1 in a
//! `NonZeroU32`, so `Option<FaceId>` is four bytes as well and no id means "none". The half-edges of
//! edge `e` are `2e` and `2e + 1`: twin and edge are arithmetic and need no mesh.

use std::{fmt, num::NonZeroU32};

/// What the ids have in common, for [`IdMap`](crate::IdMap) and [`IdSet`](crate::IdSet).
pub trait Id: Copy + Eq + Ord + std::hash::Hash + fmt::Debug + Send + Sync + 'static {
    /// What the id names, as in "vertex".
    const KIND: &'static str;

    /// The id with this index.
    fn from_index(index: usize) -> Self;

    /// The index of this id in arrays.
    fn index(self) -> usize;
}

/// The largest number of elements of one kind a mesh can have.
pub const MAX_ELEMENTS: usize = u32::MAX as usize - 1;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $letter:literal, $kind:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub struct $name(NonZeroU32);

        impl $name {
            /// The id with this index.
            ///
            /// # Panics
            /// If `index` exceeds [`MAX_ELEMENTS`].
            #[inline]
            pub const fn new(index: usize) -> Self {
                assert!(index <= MAX_ELEMENTS, "more elements than an id can count");
                match NonZeroU32::new(index as u32 + 1) {
                    Some(value) => $name(value),
                    None => unreachable!(),
                }
            }

            /// The index of this id in arrays.
            #[inline]
            pub const fn index(self) -> usize {
                self.0.get() as usize - 1
            }
        }

        impl Id for $name {
            const KIND: &'static str = $kind;

            #[inline]
            fn from_index(index: usize) -> Self {
                Self::new(index)
            }

            #[inline]
            fn index(self) -> usize {
                self.index()
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($letter, "{}"), self.index())
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Debug::fmt(self, f)
            }
        }
    };
}

id!(
    /// A vertex; prints as `v12`.
    VertexId, "v", "vertex"
);
id!(
    /// An edge in one of its two directions; prints as `h12`.
    HalfedgeId, "h", "halfedge"
);
id!(
    /// An undirected edge; prints as `e12`.
    EdgeId, "e", "edge"
);
id!(
    /// A face; prints as `f12`.
    FaceId, "f", "face"
);
id!(
    /// A corner of an [`IndexedFaceSet`](crate::IndexedFaceSet): one vertex of one face, counted
    /// face after face; prints as `c12`. In a [`Mesh`](crate::Mesh) a corner is a half-edge.
    CornerId, "c", "corner"
);

impl HalfedgeId {
    /// The same edge, walked the other way.
    #[inline]
    pub const fn twin(self) -> HalfedgeId {
        // As `new` does, with one check that is the cheapest there is: walks do this at every step.
        match NonZeroU32::new(((self.0.get() - 1) ^ 1).wrapping_add(1)) {
            Some(value) => HalfedgeId(value),
            None => panic!("more elements than an id can count"),
        }
    }

    /// The edge this is a direction of.
    #[inline]
    pub const fn edge(self) -> EdgeId {
        EdgeId::new(self.index() >> 1)
    }
}

impl EdgeId {
    /// The first of its two directions.
    #[inline]
    pub const fn halfedge(self) -> HalfedgeId {
        HalfedgeId::new(self.index() << 1)
    }

    /// Both directions.
    #[inline]
    pub const fn halfedges(self) -> [HalfedgeId; 2] {
        [self.halfedge(), self.halfedge().twin()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_small_and_none_is_free() {
        assert_eq!(size_of::<VertexId>(), 4);
        assert_eq!(size_of::<Option<FaceId>>(), 4);
    }

    #[test]
    fn twins_share_an_edge() {
        let e = EdgeId::new(7);
        let [h, g] = e.halfedges();
        assert_eq!((h.twin(), g.twin()), (g, h));
        assert_eq!((h.edge(), g.edge()), (e, e));
    }

    #[test]
    fn ids_print_with_their_letter() {
        assert_eq!(
            format!("{} {:?} {}", VertexId::new(12), HalfedgeId::new(0), FaceId::new(3)),
            "v12 h0 f3"
        );
    }
}
