//! The rows of an element.

use dgp_mesh::{DVec3, parallel};

use super::{
    header::{Element, Property},
    number::{Number, Scalar, Values, with_type},
};
use crate::{
    RowId,
    error::{Cause, Fault},
    text::Cursor,
};

/// The rows of an element: as they stand in the file where all take the same number of bytes, else
/// column by column.
pub(super) enum Table<'a> {
    Fixed(Fixed<'a>),
    Columns(Vec<Column>),
}

/// Rows of the same number of bytes.
pub(super) struct Fixed<'a> {
    pub(super) rows: &'a [u8],
    pub(super) count: usize,
    pub(super) stride: usize,
    /// Where in a row the values of each property are, and how many there are if it is a list.
    pub(super) places: Vec<(usize, Option<usize>)>,
    pub(super) big: bool,
}

/// A number of each row, or a list of them.
#[derive(Clone, Debug)]
pub(super) enum Column {
    Scalars(Values),
    Lists(Lists),
}

/// Lists one after the other.
#[derive(Clone, Debug)]
pub(super) struct Lists {
    pub(super) ends: Vec<u32>,
    pub(super) values: Values,
}

impl Column {
    pub(super) fn new(property: &Property, scalar: Scalar) -> Self {
        let values = Values::new(scalar);
        match property.list {
            None => Column::Scalars(values),
            Some(_) => Column::Lists(Lists { ends: Vec::new(), values }),
        }
    }

    pub(super) fn append(&mut self, later: Column) {
        match (self, later) {
            (Column::Scalars(values), Column::Scalars(later)) => values.append(later),
            (Column::Lists(lists), Column::Lists(later)) => {
                let start = lists.values.len() as u32;
                lists.ends.extend(later.ends.iter().map(|end| start + end));
                lists.values.append(later.values);
            }
            _ => unreachable!("blocks of an element have columns of the same kinds"),
        }
    }

    /// Adds what the cursor is at, up to the end of a line or beyond as `number` goes.
    #[inline]
    pub(super) fn push_text<'a>(
        &mut self,
        cursor: &mut Cursor<'a>,
        property: &Property,
        number: impl Fn(&mut Cursor<'a>, Scalar) -> Result<f64, Fault>,
    ) -> Result<(), Fault> {
        let value = |cursor: &mut Cursor<'a>, values: &mut Values| {
            let x = number(cursor, property.scalar)?;
            if values.push(x) {
                return Ok(());
            }
            let problem =
                format!("{x} is no {}, as property `{}` must be", property.scalar, property.name);
            Err(Fault::header(cursor.at, problem))
        };
        match self {
            Column::Scalars(values) => value(cursor, values),
            Column::Lists(lists) => {
                let count = number(cursor, Scalar::U32)?;
                // Each number takes a digit and a blank.
                let possible = cursor.remaining() / 2;
                let count = list_length(count, possible, cursor.at, false)?;
                for _ in 0..count {
                    value(cursor, &mut lists.values)?;
                }
                lists.ends.push(lists.values.len() as u32);
                Ok(())
            }
        }
    }

    /// Adds what is at `at`, and moves it on.
    #[inline]
    fn push_bytes(
        &mut self,
        bytes: &[u8],
        at: &mut usize,
        property: &Property,
        big: bool,
    ) -> Result<(), Fault> {
        let size = property.scalar.size();
        let short = |at: usize, needed: usize| {
            let (what, found) = ("bytes".to_owned(), bytes.len());
            Fault::binary(at, Cause::CutShort { what, found, expected: at + needed })
        };
        match self {
            Column::Scalars(values) => {
                if bytes.len() - *at < size {
                    return Err(short(*at, size));
                }
                values.push_bytes(&bytes[*at..], big);
                *at += size;
            }
            Column::Lists(lists) => {
                let kind = property.list.unwrap_or(Scalar::U8);
                if bytes.len() - *at < kind.size() {
                    return Err(short(*at, kind.size()));
                }
                let count = with_type!(kind, T => T::read(&bytes[*at..], big).to_f64());
                let start = *at;
                *at += kind.size();
                let count = list_length(count, (bytes.len() - *at) / size, start, true)?;
                for _ in 0..count {
                    lists.values.push_bytes(&bytes[*at..], big);
                    *at += size;
                }
                lists.ends.push(lists.values.len() as u32);
            }
        }
        Ok(())
    }
}

fn list_length(count: f64, possible: usize, at: usize, binary: bool) -> Result<usize, Fault> {
    let cause = if count < 0.0 || count.fract() != 0.0 {
        Cause::Header { problem: format!("a list of {count} numbers") }
    } else if count > possible as f64 {
        let what = "numbers in a list".to_owned();
        Cause::TooMany { what, claimed: count as u64, possible: possible as u64 }
    } else {
        return Ok(count as usize);
    };
    Err(Fault { binary, ..Fault::new(at, cause) })
}

impl<'a> Table<'a> {
    /// The rows of `element` that begin at `at`, and where they end.
    pub(super) fn from_bytes(
        bytes: &'a [u8],
        at: usize,
        element: &Element,
        big: bool,
    ) -> Result<(Self, usize), Fault> {
        if let Some(fixed) = Fixed::find(bytes, at, element, big) {
            let end = at + fixed.rows.len();
            return Ok((Table::Fixed(fixed), end));
        }
        let properties = &element.properties;
        let mut columns: Vec<Column> =
            properties.iter().map(|property| Column::new(property, property.scalar)).collect();
        let mut end = at;
        for row in 0..element.count {
            for (column, property) in columns.iter_mut().zip(properties) {
                column
                    .push_bytes(bytes, &mut end, property, big)
                    .map_err(|fault| fault.within_number(element.kind(), row))?;
            }
        }
        Ok((Table::Columns(columns), end))
    }

    /// The numbers of property `p`, which is no list.
    pub(super) fn scalars(&self, p: usize, scalar: Scalar) -> Values {
        match self {
            Table::Fixed(fixed) => {
                with_type!(scalar, T => fixed.numbers::<T>(fixed.places[p].0).into())
            }
            Table::Columns(columns) => match &columns[p] {
                Column::Scalars(values) => values.clone(),
                Column::Lists(lists) => lists.values.clone(),
            },
        }
    }

    /// The lists of property `p`.
    pub(super) fn lists(&self, p: usize, scalar: Scalar) -> Lists {
        match self {
            Table::Fixed(fixed) => {
                let (at, len) = fixed.places[p];
                let len = len.unwrap_or(1);
                let values = with_type!(scalar, T => {
                    let row = |i: usize| &fixed.rows[i * fixed.stride + at..];
                    let size = scalar.size();
                    let value = |i: usize, k: usize| T::read(&row(i)[k * size..], fixed.big);
                    let values = (0..fixed.count).flat_map(|i| (0..len).map(move |k| (i, k)));
                    Values::from(values.map(|(i, k)| value(i, k)).collect::<Vec<T>>())
                });
                let ends = (1..=fixed.count).map(|i| (i * len) as u32).collect();
                Lists { ends, values }
            }
            Table::Columns(columns) => match &columns[p] {
                Column::Lists(lists) => lists.clone(),
                Column::Scalars(values) => {
                    Lists { ends: (1..=values.len() as u32).collect(), values: values.clone() }
                }
            },
        }
    }

    /// The vectors of three properties that are no lists.
    pub(super) fn triples(&self, p: [usize; 3], scalars: [Scalar; 3]) -> Vec<DVec3> {
        if let Table::Fixed(fixed) = self
            && scalars == [scalars[0]; 3]
        {
            let [x, y, z] = p.map(|p| fixed.places[p].0);
            return with_type!(scalars[0], T => fixed.map(|row, big| {
                let number = |at: usize| T::read(&row[at..], big).to_f64();
                DVec3::new(number(x), number(y), number(z))
            }));
        }
        let columns = [0, 1, 2].map(|k| self.scalars(p[k], scalars[k]));
        let vector = |v: RowId| DVec3::from_array([0, 1, 2].map(|k| columns[k].get(v.0 as usize)));
        parallel::map(columns[0].len(), vector).into_values()
    }
}

impl<'a> Fixed<'a> {
    /// The rows of `element`, if all have the lists of the first one's lengths and all are there.
    fn find(bytes: &'a [u8], start: usize, element: &Element, big: bool) -> Option<Self> {
        let mut places = Vec::with_capacity(element.properties.len());
        let mut lengths = Vec::new();
        let mut at = 0;
        for property in &element.properties {
            let mut len = None;
            if let Some(kind) = property.list
                && element.count > 0
            {
                let first = bytes.get(start + at..)?;
                if first.len() < kind.size() {
                    return None;
                }
                lengths.push((at, kind.size()));
                at += kind.size();
                let count = with_type!(kind, T => T::read(first, big).to_f64());
                if count < 0.0 || count > bytes.len() as f64 {
                    return None;
                }
                len = Some(count as usize);
            }
            places.push((at, len));
            at = len.unwrap_or(1).checked_mul(property.scalar.size())?.checked_add(at)?;
        }
        let stride = at;
        let rows = bytes.get(start..start.checked_add(stride.checked_mul(element.count)?)?)?;
        // Equal bytes of all lengths are equal lengths.
        let first = rows.get(..stride)?;
        let count = element.count;
        if !lengths.is_empty() {
            let same = parallel::map_blocks(count, parallel::BLOCK, |mut range| {
                range.all(|i| {
                    let row = &rows[i * stride..(i + 1) * stride];
                    lengths.iter().all(|&(at, size)| row[at..at + size] == first[at..at + size])
                })
            });
            if same.contains(&false) {
                return None;
            }
        }
        Some(Fixed { rows, count, stride, places, big })
    }

    /// `f` of each row, in parallel.
    fn map<T: Send>(&self, f: impl Fn(&[u8], bool) -> T + Sync + Send) -> Vec<T> {
        let (stride, big) = (self.stride, self.big);
        let value = |v: RowId| {
            let start = v.0 as usize * stride;
            f(&self.rows[start..start + stride], big)
        };
        parallel::map(self.count, value).into_values()
    }

    /// The numbers at byte `at` of each row.
    fn numbers<T: Number>(&self, at: usize) -> Vec<T> {
        self.map(|row, big| T::read(&row[at..], big))
    }
}
