//! Writing binary rows of equal size, property by property.

use std::ops::Range;

use dgp_mesh::{FaceId, FaceList, VertexId};

use super::number::Scalar;

/// A place in each of some rows of equal size.
pub(super) struct Strided<'a> {
    pub(super) bytes: &'a mut [u8],
    pub(super) at: usize,
    pub(super) size: usize,
    pub(super) big: bool,
}

impl Strided<'_> {
    /// Writes a number into each row.
    #[inline]
    pub(super) fn fill(&mut self, scalar: Scalar, numbers: impl Iterator<Item = f64>) {
        match scalar {
            Scalar::I8 => self.put(numbers, |x| (x as i8).to_ne_bytes()),
            Scalar::U8 => self.put(numbers, |x| (x as u8).to_ne_bytes()),
            Scalar::I16 => self.put(numbers, |x| (x as i16).to_ne_bytes()),
            Scalar::U16 => self.put(numbers, |x| (x as u16).to_ne_bytes()),
            Scalar::I32 => self.put(numbers, |x| (x as i32).to_ne_bytes()),
            Scalar::U32 => self.put(numbers, |x| (x as u32).to_ne_bytes()),
            Scalar::F32 => self.put(numbers, |x| (x as f32).to_ne_bytes()),
            Scalar::F64 => self.put(numbers, f64::to_ne_bytes),
        }
    }

    /// Writes the native bytes of a number into each row.
    #[inline]
    fn put<const N: usize>(
        &mut self,
        numbers: impl Iterator<Item = f64>,
        bytes: impl Fn(f64) -> [u8; N],
    ) {
        let turn = self.big != cfg!(target_endian = "big");
        for (row, x) in self.bytes.chunks_exact_mut(self.size).zip(numbers) {
            let mut bytes = bytes(x);
            if turn {
                bytes.reverse();
            }
            row[self.at..self.at + N].copy_from_slice(&bytes);
        }
    }

    /// Writes the corners of faces of equal degree.
    pub(super) fn corners(&mut self, kind: Scalar, faces: &FaceList, range: Range<usize>) {
        let degree = faces.degree(FaceId::new(range.start));
        self.fill(kind, range.clone().map(|_| degree as f64));
        let corners = &faces.corners()[range.start * degree..range.end * degree];
        self.at += kind.size();
        match degree {
            3 => self.polygons(corners.as_chunks::<3>().0),
            4 => self.polygons(corners.as_chunks::<4>().0),
            _ => {
                let rows = self.bytes.chunks_exact_mut(self.size);
                for (row, face) in rows.zip(corners.chunks_exact(degree)) {
                    let (places, _) = row[self.at..self.at + 4 * degree].as_chunks_mut::<4>();
                    for (place, &v) in places.iter_mut().zip(face) {
                        *place = index(v, self.big);
                    }
                }
            }
        }
    }

    /// Writes the corners of faces whose degree is known here, so that loops over corners unroll.
    fn polygons<const N: usize>(&mut self, faces: &[[VertexId; N]]) {
        for (row, face) in self.bytes.chunks_exact_mut(self.size).zip(faces) {
            let indices = face.map(|v| index(v, self.big));
            row[self.at..self.at + 4 * N].copy_from_slice(indices.as_flattened());
        }
    }
}

#[inline]
fn index(v: VertexId, big: bool) -> [u8; 4] {
    let v = v.index() as u32;
    if big { v.to_be_bytes() } else { v.to_le_bytes() }
}
