//! The rows of an element.

use std::mem;

use dgp_mesh::{Cancelled, DVec3, FaceList, Progress, parallel};

use super::{
    header::{Element, Property},
    number::{Number, Scalar, Values, with_type},
    rows::Misnamed,
};
use crate::{
    RowId,
    error::{Cause, Fault, Stop, countable},
    pulse::Pulse,
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
    rows: &'a [u8],
    /// The byte at which they begin in the file.
    start: usize,
    pub(super) count: usize,
    stride: usize,
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

    pub(super) fn append(&mut self, later: Column) -> Result<(), dgp_mesh::Error> {
        match (self, later) {
            (Column::Scalars(values), Column::Scalars(later)) => values.append(later),
            (Column::Lists(lists), Column::Lists(later)) => {
                countable("numbers in lists", lists.values.len() + later.values.len())?;
                let start = lists.values.len() as u32;
                lists.ends.extend(later.ends.iter().map(|end| start + end));
                lists.values.append(later.values);
            }
            _ => unreachable!("blocks of an element have columns of the same kinds"),
        }
        Ok(())
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
                let count = list_length(count, possible.min(lists.room()), cursor.at, false)?;
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
                let possible = ((bytes.len() - *at) / size).min(lists.room());
                let count = list_length(count, possible, start, true)?;
                let end = *at + count * size;
                lists.values.extend_bytes(&bytes[*at..end], big);
                *at = end;
                lists.ends.push(lists.values.len() as u32);
            }
        }
        Ok(())
    }
}

impl Lists {
    /// How many more numbers can be counted.
    fn room(&self) -> usize {
        FaceList::MAX_CORNERS - self.values.len()
    }
}

fn list_length(count: f64, possible: usize, at: usize, binary: bool) -> Result<usize, Fault> {
    // Whole numbers survive the way there and back; `fract` would be a call.
    let cause = if count < 0.0 || count as u64 as f64 != count {
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
        progress: Progress<'_>,
    ) -> Result<(Self, usize), Stop> {
        if let Some(fixed) = Fixed::find(bytes, at, element, big) {
            let end = at + fixed.rows.len();
            return Ok((Table::Fixed(fixed), end));
        }
        let properties = &element.properties;
        let mut columns: Vec<Column> =
            properties.iter().map(|property| Column::new(property, property.scalar)).collect();
        let mut end = at;
        let pulse = Pulse::new(element.count, progress);
        for row in (0..element.count).take_while(|&row| pulse.beat(row)) {
            for (column, property) in columns.iter_mut().zip(properties) {
                column
                    .push_bytes(bytes, &mut end, property, big)
                    .map_err(|fault| fault.within_number(element.kind(), row))?;
            }
        }
        pulse.end()?;
        Ok((Table::Columns(columns), end))
    }

    /// The numbers of property `p`, which is no list; they are gone afterwards.
    pub(super) fn take_scalars(
        &mut self,
        p: usize,
        scalar: Scalar,
        progress: Progress<'_>,
    ) -> Result<Values, Cancelled> {
        match self {
            Table::Fixed(fixed) => {
                let at = fixed.places[p].0;
                let pulse = Pulse::new(fixed.count, progress);
                let values = with_type!(scalar, T => {
                    Values::from(fixed.map(T::default(), &pulse, |_, row| T::read(&row[at..], fixed.big)))
                });
                pulse.end()?;
                Ok(values)
            }
            Table::Columns(columns) => {
                let (Column::Scalars(values) | Column::Lists(Lists { values, .. })) =
                    &mut columns[p];
                Ok(mem::replace(values, Values::new(scalar)))
            }
        }
    }

    /// The lists of property `p`; they are gone afterwards.
    pub(super) fn take_lists(&mut self, p: usize, scalar: Scalar) -> Lists {
        if let Table::Columns(columns) = self
            && let Column::Lists(lists) = &mut columns[p]
        {
            return Lists {
                ends: mem::take(&mut lists.ends),
                values: mem::replace(&mut lists.values, Values::new(scalar)),
            };
        }
        self.lists(p, scalar)
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

    /// The vectors of three properties that are no lists; they are gone afterwards.
    pub(super) fn triples(
        &mut self,
        p: [usize; 3],
        scalars: [Scalar; 3],
        progress: Progress<'_>,
    ) -> Result<Vec<DVec3>, Cancelled> {
        if let Table::Fixed(fixed) = self
            && scalars == [scalars[0]; 3]
        {
            let [x, y, z] = p.map(|p| fixed.places[p].0);
            let pulse = Pulse::new(fixed.count, progress);
            let vectors = with_type!(scalars[0], T => fixed.map(DVec3::ZERO, &pulse, |_, row| {
                let number = |at: usize| T::read(&row[at..], fixed.big).to_f64();
                DVec3::new(number(x), number(y), number(z))
            }));
            pulse.end()?;
            return Ok(vectors);
        }
        let mut column = |k: usize| self.take_scalars(p[k], scalars[k], progress);
        let columns = [column(0)?, column(1)?, column(2)?];
        let vector = |v: RowId| DVec3::from_array([0, 1, 2].map(|k| columns[k].get(v.0 as usize)));
        Ok(parallel::map(columns[0].len(), vector).into_values())
    }
}

/// Rows decoded in one go: a task that is called for each row takes longer to be called than to run.
const BATCH: usize = 16;

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
            // More numbers than can be counted are refused where lists are read one by one.
            if len.is_some_and(|len| len.saturating_mul(element.count) > FaceList::MAX_CORNERS) {
                return None;
            }
            at = len.unwrap_or(1).checked_mul(property.scalar.size())?.checked_add(at)?;
        }
        let stride = at;
        let rows = bytes.get(start..start.checked_add(stride.checked_mul(element.count)?)?)?;
        // Equal bytes of all lengths are equal lengths.
        let first = rows.get(..stride)?;
        let count = element.count;
        if !lengths.is_empty() {
            let same = parallel::map_blocks(count, parallel::BLOCK, |range| {
                let mut rows = rows[range.start * stride..range.end * stride].chunks_exact(stride);
                match lengths[..] {
                    // One byte is compared faster than a slice of one.
                    [(at, 1)] => rows.all(|row| row[at] == first[at]),
                    _ => rows.all(|row| {
                        lengths.iter().all(|&(at, size)| row[at..at + size] == first[at..at + size])
                    }),
                }
            });
            if same.contains(&false) {
                return None;
            }
        }
        Some(Fixed { rows, start, count, stride, places, big })
    }

    /// Row `i`.
    #[inline]
    pub(super) fn row(&self, i: usize) -> &[u8] {
        &self.rows[i * self.stride..(i + 1) * self.stride]
    }

    /// `f` of each row and its number, in parallel; rows that are not wanted any more are `blank`.
    pub(super) fn map<T: Copy + Send + Sync>(
        &self,
        blank: T,
        pulse: &Pulse<'_>,
        f: impl Fn(usize, &[u8]) -> T + Sync + Send,
    ) -> Vec<T> {
        let batch = |b: RowId| {
            let mut values = [blank; BATCH];
            let first = b.0 as usize * BATCH;
            if pulse.beat(first) {
                let end = (first + BATCH).min(self.count) * self.stride;
                let rows = self.rows[first * self.stride..end].chunks_exact(self.stride);
                for (k, (value, row)) in values.iter_mut().zip(rows).enumerate() {
                    *value = f(first + k, row);
                }
            }
            values
        };
        let batches = parallel::map(self.count.div_ceil(BATCH), batch);
        let mut values = batches.into_values().into_flattened();
        values.truncate(self.count);
        values
    }

    /// The fault of number `k` of list `p` in row `row`.
    pub(super) fn misnamed(&self, p: usize, scalar: Scalar, row: usize, k: usize) -> Misnamed {
        let at = row * self.stride + self.places[p].0 + k * scalar.size();
        let index = with_type!(scalar, T => T::read(&self.rows[at..], self.big).to_f64() as i64);
        Misnamed { row, byte: self.start + at, index }
    }
}
