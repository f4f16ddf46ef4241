//! Numbers as bytes.

use dgp_mesh::parallel;

use crate::{
    Encoding,
    error::{Cause, Fault},
};

/// Reads numbers of either byte order one after the other.
#[derive(Clone, Copy)]
pub(crate) struct ByteReader<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
    pub(crate) big: bool,
}

impl ByteReader<'_> {
    /// How many bytes are left.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let Some(&taken) = self.bytes[self.at..].first_chunk::<N>() else {
            let (what, found) = ("bytes".to_owned(), self.bytes.len());
            let cause = Cause::CutShort { what, found, expected: self.at + N };
            return Err(Fault::binary(self.at, cause));
        };
        self.at += N;
        Ok(taken)
    }

    #[inline]
    pub(crate) fn i32(&mut self) -> Result<i32, Fault> {
        let bytes = self.take()?;
        Ok(if self.big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    #[inline]
    pub(crate) fn f32(&mut self) -> Result<f32, Fault> {
        let bytes = self.take()?;
        Ok(if self.big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
    }
}

/// Writes numbers of either byte order one after the other.
pub(crate) struct ByteWriter {
    pub(crate) bytes: Vec<u8>,
    big: bool,
}

macro_rules! put {
    ($($type:ident),*) => {
        $(#[inline]
        pub(crate) fn $type(&mut self, x: $type) {
            self.bytes.extend_from_slice(&if self.big { x.to_be_bytes() } else { x.to_le_bytes() });
        })*
    };
}

impl ByteWriter {
    pub(crate) fn new(encoding: Encoding) -> Self {
        ByteWriter::onto(Vec::new(), encoding)
    }

    /// Adds to `bytes`.
    pub(crate) fn onto(bytes: Vec<u8>, encoding: Encoding) -> Self {
        ByteWriter { bytes, big: encoding == Encoding::BigEndian }
    }

    put!(i8, u8, i16, u16, i32, u32, f32, f64);
}

/// Whether a number of single precision holds `x` bit for bit.
#[inline]
pub(crate) fn is_f32(x: f64) -> bool {
    f64::from(x as f32).to_bits() == x.to_bits()
}

/// How many of the numbers of all values do not fit single precision bit for bit.
pub(crate) fn rounded<T: Sync, const N: usize>(
    values: &[T],
    numbers: impl Fn(&T) -> [f64; N] + Sync + Send,
) -> usize {
    let blocks = parallel::map_blocks(values.len(), parallel::BLOCK, |range| {
        let numbers = values[range].iter().flat_map(&numbers);
        numbers.map(|x| usize::from(!is_f32(x))).sum::<usize>()
    });
    blocks.into_iter().sum()
}

/// Whether single precision holds the numbers of all values bit for bit.
pub(crate) fn are_f32<T: Sync, const N: usize>(
    values: &[T],
    numbers: impl Fn(&T) -> [f64; N] + Sync + Send,
) -> bool {
    let blocks = parallel::map_blocks(values.len(), parallel::BLOCK, |range| {
        values[range].iter().all(|value| numbers(value).into_iter().all(is_f32))
    });
    !blocks.contains(&false)
}
