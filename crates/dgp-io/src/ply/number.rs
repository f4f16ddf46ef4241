//! The types of numbers in PLY files.

use std::fmt;

use dgp_mesh::VertexId;

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// The type of this name, in the old style or the new one.
    pub(super) fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Its name in the old style, which every program knows.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Scalar::I8 => "char",
            Scalar::U8 => "uchar",
            Scalar::I16 => "short",
            Scalar::U16 => "ushort",
            Scalar::I32 => "int",
            Scalar::U32 => "uint",
            Scalar::F32 => "float",
            Scalar::F64 => "double",
        }
    }

    /// How many bytes it takes.
    pub(super) const fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// Whether it is for whole numbers only.
    pub(super) const fn is_whole(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The value that stands for 1 where the numbers are fractions of a whole, as in colors.
    pub(super) const fn unit(self) -> f64 {
        match self {
            Scalar::F32 | Scalar::F64 => 1.0,
            Scalar::I16 | Scalar::U16 => 65535.0,
            Scalar::I8 | Scalar::U8 | Scalar::I32 | Scalar::U32 => 255.0,
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A Rust type that a [`Scalar`] names.
pub(super) trait Number: Copy + Default + Send + Sync + 'static {
    /// How many bytes it takes.
    const SIZE: usize = size_of::<Self>();

    /// The number at the beginning of `bytes`.
    fn read(bytes: &[u8], big: bool) -> Self;

    fn to_f64(self) -> f64;

    /// The same number in this type, if it has it.
    fn from_f64(x: f64) -> Option<Self>;

    /// The vertex of this number, if it is one of `count`.
    fn vertex(self, count: usize) -> Option<VertexId>;
}

/// The vertex of this number, if it is one of `count`.
#[inline]
pub(super) fn vertex(number: f64, count: usize) -> Option<VertexId> {
    // Whole numbers survive the way there and back; `fract` would be a call.
    (number >= 0.0 && number < count as f64 && number as usize as f64 == number)
        .then(|| VertexId::new(number as usize))
}

macro_rules! number {
    ($($type:ident),*) => {
        $(impl Number for $type {
            #[inline]
            fn read(bytes: &[u8], big: bool) -> Self {
                let bytes = *bytes.first_chunk().expect("rows were measured before they are read");
                if big { $type::from_be_bytes(bytes) } else { $type::from_le_bytes(bytes) }
            }

            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }

            #[inline]
            fn from_f64(x: f64) -> Option<Self> {
                let value = x as $type;
                (value as f64 == x).then_some(value)
            }

            #[inline]
            fn vertex(self, count: usize) -> Option<VertexId> {
                // Not by way of fractions: `fract` is a call where processors lack an instruction for it.
                usize::try_from(self).ok().filter(|&i| i < count).map(VertexId::new)
            }
        })*
    };
}

number!(i8, u8, i16, u16, i32, u32);

impl Number for f32 {
    #[inline]
    fn read(bytes: &[u8], big: bool) -> Self {
        f32::from_bits(u32::read(bytes, big))
    }

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn from_f64(x: f64) -> Option<Self> {
        Some(x as f32)
    }

    #[inline]
    fn vertex(self, count: usize) -> Option<VertexId> {
        vertex(self.into(), count)
    }
}

impl Number for f64 {
    #[inline]
    fn read(bytes: &[u8], big: bool) -> Self {
        let bytes = *bytes.first_chunk().expect("rows were measured before they are read");
        if big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline]
    fn from_f64(x: f64) -> Option<Self> {
        Some(x)
    }

    #[inline]
    fn vertex(self, count: usize) -> Option<VertexId> {
        vertex(self, count)
    }
}

/// The numbers of a column.
#[derive(Clone, Debug)]
pub(super) enum Values {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Runs `$body` with `$type` naming the Rust type of `$scalar`.
macro_rules! with_type {
    ($scalar:expr, $type:ident => $body:expr) => {
        match $scalar {
            Scalar::I8 => {
                type $type = i8;
                $body
            }
            Scalar::U8 => {
                type $type = u8;
                $body
            }
            Scalar::I16 => {
                type $type = i16;
                $body
            }
            Scalar::U16 => {
                type $type = u16;
                $body
            }
            Scalar::I32 => {
                type $type = i32;
                $body
            }
            Scalar::U32 => {
                type $type = u32;
                $body
            }
            Scalar::F32 => {
                type $type = f32;
                $body
            }
            Scalar::F64 => {
                type $type = f64;
                $body
            }
        }
    };
}
pub(super) use with_type;

/// Runs `$body` with `$vector` bound to the vector of `$values`.
macro_rules! with_values {
    ($values:expr, $vector:ident => $body:expr) => {
        match $values {
            Values::I8($vector) => $body,
            Values::U8($vector) => $body,
            Values::I16($vector) => $body,
            Values::U16($vector) => $body,
            Values::I32($vector) => $body,
            Values::U32($vector) => $body,
            Values::F32($vector) => $body,
            Values::F64($vector) => $body,
        }
    };
}
pub(super) use with_values;

macro_rules! from_vector {
    ($($type:ident $variant:ident),*) => {
        $(impl From<Vec<$type>> for Values {
            fn from(vector: Vec<$type>) -> Self {
                Values::$variant(vector)
            }
        })*
    };
}

from_vector!(i8 I8, u8 U8, i16 I16, u16 U16, i32 I32, u32 U32, f32 F32, f64 F64);

impl Values {
    pub(super) fn new(scalar: Scalar) -> Self {
        with_type!(scalar, T => Values::from(Vec::<T>::new()))
    }

    pub(super) fn len(&self) -> usize {
        with_values!(self, vector => vector.len())
    }

    #[inline]
    pub(super) fn get(&self, i: usize) -> f64 {
        with_values!(self, vector => vector[i].to_f64())
    }

    /// Adds a number; false if the type has no such number.
    #[inline]
    pub(super) fn push(&mut self, x: f64) -> bool {
        with_values!(self, vector => match Number::from_f64(x) {
            Some(value) => {
                vector.push(value);
                true
            }
            None => false,
        })
    }

    /// Adds the number at the beginning of `bytes`.
    #[inline]
    pub(super) fn push_bytes(&mut self, bytes: &[u8], big: bool) {
        with_values!(self, vector => vector.push(Number::read(bytes, big)));
    }

    /// Adds the numbers of which `bytes` are made.
    #[inline]
    pub(super) fn extend_bytes(&mut self, bytes: &[u8], big: bool) {
        fn extend<T: Number>(vector: &mut Vec<T>, bytes: &[u8], big: bool) {
            vector.extend(bytes.chunks_exact(T::SIZE).map(|number| T::read(number, big)));
        }
        with_values!(self, vector => extend(vector, bytes, big));
    }

    /// Adds the numbers of a column of the same type.
    pub(super) fn append(&mut self, later: Values) {
        match (self, later) {
            (Values::I8(a), Values::I8(mut b)) => a.append(&mut b),
            (Values::U8(a), Values::U8(mut b)) => a.append(&mut b),
            (Values::I16(a), Values::I16(mut b)) => a.append(&mut b),
            (Values::U16(a), Values::U16(mut b)) => a.append(&mut b),
            (Values::I32(a), Values::I32(mut b)) => a.append(&mut b),
            (Values::U32(a), Values::U32(mut b)) => a.append(&mut b),
            (Values::F32(a), Values::F32(mut b)) => a.append(&mut b),
            (Values::F64(a), Values::F64(mut b)) => a.append(&mut b),
            _ => unreachable!("blocks of an element have columns of the same types"),
        }
    }
}
