//! A property of the rows to be written.

use std::ops::Range;

use dgp_mesh::{DVec2, FaceId, FaceList};

use super::{number::Scalar, strided::Strided};
use crate::{
    NumberList,
    binary::{ByteWriter, are_f32, is_f32},
    print::Printer,
};

/// A number of each row, or a list of them.
pub(super) struct Property<'a> {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    /// Whether text shows the numbers in double precision, whatever the type.
    pub(super) wide: bool,
    pub(super) value: Value<'a>,
}

pub(super) type Lookup<'a, T> = Box<dyn Fn(usize) -> T + Send + Sync + 'a>;

/// Writes a number of each of some rows at its place in them.
pub(super) type Fill<'a> = Box<dyn Fn(&mut Strided<'_>, Range<usize>) + Send + Sync + 'a>;

pub(super) enum Value<'a> {
    Number(Lookup<'a, f64>, Fill<'a>),
    /// The vertices of faces.
    Corners(Scalar, &'a FaceList),
    List(Scalar, Lookup<'a, &'a [f64]>),
    /// Texture coordinates of the corners of faces.
    Uvs(Scalar, &'a FaceList, &'a [DVec2]),
}

impl Property<'_> {
    /// How many bytes it takes in each row, if in all the same.
    pub(super) fn size(&self) -> Option<usize> {
        match &self.value {
            Value::Number(..) => Some(self.scalar.size()),
            Value::Corners(kind, faces) => {
                faces.uniform_degree().map(|degree| kind.size() + degree * self.scalar.size())
            }
            Value::List(..) | Value::Uvs(..) => None,
        }
    }

    /// The type of the length of a list.
    pub(super) fn list(&self) -> Option<Scalar> {
        match self.value {
            Value::Number(..) => None,
            Value::Corners(kind, _) | Value::List(kind, _) | Value::Uvs(kind, ..) => Some(kind),
        }
    }
}

/// The type that holds the length of the longest list.
pub(super) fn length_type(longest: usize) -> Scalar {
    if longest <= 255 { Scalar::U8 } else { Scalar::U32 }
}

/// The smallest type of fractions that holds all numbers bit for bit.
pub(super) fn float_type<T: Sync, const N: usize>(
    values: &[T],
    numbers: impl Fn(&T) -> [f64; N] + Sync + Send,
) -> Scalar {
    if are_f32(values, numbers) { Scalar::F32 } else { Scalar::F64 }
}

/// The smallest type that holds all numbers of lists bit for bit.
pub(super) fn list_type(lists: &[NumberList]) -> Scalar {
    let all = |fits: &dyn Fn(f64) -> bool| lists.iter().flat_map(|list| &list.0).all(|&x| fits(x));
    let whole = |x: f64, low: f64, high: f64| {
        x.fract() == 0.0 && low <= x && x <= high && x.to_bits() != (-0.0_f64).to_bits()
    };
    let types = [
        (Scalar::U8, 0.0, f64::from(u8::MAX)),
        (Scalar::I32, f64::from(i32::MIN), f64::from(i32::MAX)),
        (Scalar::U32, 0.0, f64::from(u32::MAX)),
    ];
    let found = types.into_iter().find(|&(_, low, high)| all(&|x| whole(x, low, high)));
    match found {
        Some((scalar, ..)) => scalar,
        None if all(&is_f32) => Scalar::F32,
        None => Scalar::F64,
    }
}

impl Property<'_> {
    fn print_number(&self, printer: &mut Printer, x: f64) {
        match self.scalar {
            Scalar::F32 if !self.wide => printer.f32(x as f32),
            Scalar::F32 | Scalar::F64 => printer.f64(x),
            _ => printer.integer(x as i64),
        }
    }

    pub(super) fn print(&self, printer: &mut Printer, i: usize) {
        match &self.value {
            Value::Number(value, _) => self.print_number(printer, value(i)),
            Value::Corners(_, faces) => {
                let face = faces.face(FaceId::new(i));
                printer.integer(face.len() as i64);
                for v in face {
                    printer.byte(b' ');
                    printer.integer(v.index() as i64);
                }
            }
            Value::List(_, list) => {
                let list = list(i);
                printer.integer(list.len() as i64);
                for &x in list {
                    printer.byte(b' ');
                    self.print_number(printer, x);
                }
            }
            Value::Uvs(_, faces, uvs) => {
                let corners = faces.face_corners(FaceId::new(i));
                printer.integer(2 * corners.len() as i64);
                for x in corners.flat_map(|c| uvs[c.index()].to_array()) {
                    printer.byte(b' ');
                    self.print_number(printer, x);
                }
            }
        }
    }

    /// Writes it into rows of equal size.
    pub(super) fn fill(&self, rows: &mut Strided<'_>, range: Range<usize>) {
        match &self.value {
            Value::Number(_, fill) => fill(rows, range),
            Value::Corners(kind, faces) => rows.corners(*kind, faces, range),
            Value::List(..) | Value::Uvs(..) => unreachable!("lists have no size of their own"),
        }
    }

    #[inline]
    pub(super) fn put(&self, writer: &mut ByteWriter, i: usize) {
        match &self.value {
            Value::Number(value, _) => put(writer, self.scalar, value(i)),
            Value::Corners(kind, faces) => {
                let face = faces.face(FaceId::new(i));
                put(writer, *kind, face.len() as f64);
                for v in face {
                    writer.u32(v.index() as u32);
                }
            }
            Value::List(kind, list) => {
                let list = list(i);
                put(writer, *kind, list.len() as f64);
                for &x in list {
                    put(writer, self.scalar, x);
                }
            }
            Value::Uvs(kind, faces, uvs) => {
                let corners = faces.face_corners(FaceId::new(i));
                put(writer, *kind, 2.0 * corners.len() as f64);
                for x in corners.flat_map(|c| uvs[c.index()].to_array()) {
                    put(writer, self.scalar, x);
                }
            }
        }
    }
}

#[inline]
fn put(writer: &mut ByteWriter, scalar: Scalar, x: f64) {
    match scalar {
        Scalar::I8 => writer.i8(x as i8),
        Scalar::U8 => writer.u8(x as u8),
        Scalar::I16 => writer.i16(x as i16),
        Scalar::U16 => writer.u16(x as u16),
        Scalar::I32 => writer.i32(x as i32),
        Scalar::U32 => writer.u32(x as u32),
        Scalar::F32 => writer.f32(x as f32),
        Scalar::F64 => writer.f64(x),
    }
}
