//! Progressive meshes as bytes that can be used while they arrive.
//!
//! ```text
//! "DGPPROG" 0x1a   version u32 = 2   base vertices u32   base faces u32   splits u32   checksum u32
//! block of the base:    bytes u32   checksum u32
//!   columns varint, each: type u8, of vertices 0 or corners 1 u8, bytes of its name varint, its name in UTF-8
//!   positions 3 × f64 …   corners 3 × varint …   values of all columns f64 …
//! blocks of splits:     splits u32   bytes u32   checksum u32
//!   vertex varint, faces varint (1 or 2), their corners 3 × varint each,
//!   count of corners that change hands varint, each as difference to the one before varint,
//!   position of the vertex afterwards 3 × f64, of the one that comes 3 × f64
//!   values of the vertex afterwards f64 …, of the one that comes f64 …
//! ```
//!
//! All little-endian; a varint has 7 bits a byte, the lowest first, and 128 says that another follows.
//! Checksums are CRC-32 (IEEE 802.3) of the bytes between. Files of version 1 have no columns and no values;
//! they are read.

use dgp_mesh::DVec3;

use super::{
    ProgressiveMesh, Split,
    data::{Column, KINDS, width},
};
use crate::Error;

const MAGIC: [u8; 8] = *b"DGPPROG\x1a";
const VERSION: u32 = 2;
/// The version without data, which is read but not written.
const PLAIN: u32 = 1;
const HEADER: usize = 28;
/// Splits of a block: as many as arrive together.
const BLOCK: usize = 512;

impl ProgressiveMesh {
    /// All levels as bytes; the coarse ones come first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut at_base = self.clone();
        at_base.set_level(0).expect("every mesh has a base");
        let mut header = MAGIC.to_vec();
        let [vertices, faces] = self.base;
        for number in [VERSION, vertices as u32, faces as u32, self.splits.len() as u32] {
            header.extend(number.to_le_bytes());
        }
        let sum = checksum(&header);
        header.extend(sum.to_le_bytes());

        let mut base = Vec::new();
        push_varint(&mut base, self.columns.len() as u32);
        for column in &self.columns {
            let kind = KINDS.iter().position(|&kind| kind == column.kind).unwrap_or_default();
            base.extend([kind as u8, u8::from(column.is_of_corners)]);
            push_varint(&mut base, column.name.len() as u32);
            base.extend(column.name.as_bytes());
        }
        at_base.positions().iter().for_each(|&p| push_position(&mut base, p));
        at_base.faces().iter().flatten().for_each(|&v| push_varint(&mut base, v));
        push_numbers(&mut base, &at_base.values[..width(&self.columns) * vertices]);
        let mut bytes = header;
        push_block(&mut bytes, &base);
        for first in (0..self.splits.len()).step_by(BLOCK) {
            let last = (first + BLOCK).min(self.splits.len());
            let mut block = Vec::new();
            for k in first..last {
                at_base.push_split(&mut block, k);
            }
            bytes.extend(((last - first) as u32).to_le_bytes());
            push_block(&mut bytes, &block);
        }
        bytes
    }

    /// Writes split `k`; the present level is `k`, and the next one afterwards.
    fn push_split(&mut self, block: &mut Vec<u8>, k: usize) {
        let split = self.splits[k];
        push_varint(block, split.vertex);
        push_varint(block, u32::from(split.faces));
        let faces = self.face_count..self.face_count + usize::from(split.faces);
        self.faces[faces].iter().flatten().for_each(|&v| push_varint(block, v));
        let moved = &self.moved[self.start(k)..split.end as usize];
        push_varint(block, moved.len() as u32);
        let mut before = 0;
        for &corner in moved {
            push_varint(block, corner - before);
            before = corner;
        }
        push_position(block, self.held[k]);
        push_position(block, self.positions[self.base[0] + k]);
        let width = width(&self.columns);
        push_numbers(block, &self.held_values[width * k..][..width]);
        push_numbers(block, &self.values[width * (self.base[0] + k)..][..width]);
        self.change(k, true);
        self.level += 1;
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote; the present level is the finest.
    ///
    /// Errors: [`Error::Damaged`], also if bytes are missing or left over.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let mut stream = ProgressiveStream::new();
        stream.push(bytes)?;
        stream.finish()
    }
}

/// Reads a progressive mesh from bytes as they arrive.
///
/// ```
/// use dgp_mesh::{Progress, shapes};
/// use dgp_remesh::{ProgressiveMesh, ProgressiveStream, QuadricOptions, Target};
///
/// let mesh = shapes::icosphere(4)?;
/// let options = QuadricOptions::default();
/// let bytes = ProgressiveMesh::new(&mesh, Target::Faces(20), &options, Progress::NONE)?.to_bytes();
/// let mut stream = ProgressiveStream::new();
/// stream.push(&bytes[..bytes.len() / 2])?;
/// assert!(stream.mesh().is_some_and(|mesh| mesh.face_count() > 500));
/// stream.push(&bytes[bytes.len() / 2..])?;
/// assert_eq!(stream.finish()?.face_count(), 5120);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ProgressiveStream {
    waiting: Vec<u8>,
    /// Bytes that were used.
    offset: u64,
    expected: Option<[usize; 3]>,
    version: u32,
    mesh: Option<ProgressiveMesh>,
}

impl ProgressiveStream {
    /// Nothing yet.
    pub fn new() -> Self {
        ProgressiveStream::default()
    }

    /// Takes the next bytes, as many as there are.
    ///
    /// Errors: [`Error::Damaged`]; what was there before stays.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.waiting.extend_from_slice(bytes);
        let mut used = 0;
        let result = loop {
            match self.step(used) {
                Ok(0) => break Ok(()),
                Ok(count) => {
                    used += count;
                    self.offset += count as u64;
                }
                Err(error) => break Err(error),
            }
        };
        self.waiting.drain(..used);
        result
    }

    /// The mesh at the finest level that has arrived, once the base has.
    pub fn mesh(&self) -> Option<&ProgressiveMesh> {
        self.mesh.as_ref()
    }

    /// The mesh, if all of it has arrived and nothing else.
    ///
    /// Errors: [`Error::Damaged`].
    pub fn finish(self) -> Result<ProgressiveMesh, Error> {
        let offset = self.offset;
        let damaged = |what: String| Err(Error::Damaged { offset, what });
        let (Some(mesh), Some([_, _, splits])) = (self.mesh, self.expected) else {
            return damaged("the file ends before the base is complete".to_owned());
        };
        if mesh.splits.len() < splits {
            let there = mesh.splits.len();
            return damaged(format!("the file ends after {there} of {splits} splits"));
        }
        if !self.waiting.is_empty() {
            return damaged("bytes follow the last split".to_owned());
        }
        Ok(mesh)
    }

    fn damaged(&self, what: &str) -> Error {
        Error::Damaged { offset: self.offset, what: what.to_owned() }
    }

    /// Uses the next header or block if it is complete; returns how many bytes that were.
    fn step(&mut self, used: usize) -> Result<usize, Error> {
        let rest = &self.waiting[used..];
        let word = |at: usize| {
            let bytes = rest.get(at..at + 4)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
        };
        let Some(expected) = self.expected else {
            let start = rest.len().min(MAGIC.len());
            if rest[..start] != MAGIC[..start] {
                return Err(self.damaged("this is no progressive mesh"));
            }
            if let Some(version) = word(8)
                && version != VERSION as usize
                && version != PLAIN as usize
            {
                let what =
                    format!("it has version {version}, but only {PLAIN} and {VERSION} are known");
                return Err(self.damaged(&what));
            }
            let (Some(vertices), Some(faces), Some(splits), Some(sum)) =
                (word(12), word(16), word(20), word(24))
            else {
                return Ok(0);
            };
            if checksum(&rest[..HEADER - 4]) as usize != sum {
                return Err(self.damaged("the checksum of the header is wrong"));
            }
            self.version = word(8).unwrap_or(0) as u32;
            self.expected = Some([vertices, faces, splits]);
            return Ok(HEADER);
        };
        let is_base = self.mesh.is_none();
        let there = self.mesh.as_ref().map_or(0, |mesh| mesh.splits.len());
        if !is_base && there == expected[2] {
            return Ok(0);
        }
        let head = if is_base { 8 } else { 12 };
        let (Some(size), Some(sum)) = (word(head - 8), word(head - 4)) else { return Ok(0) };
        let count = if is_base { 0 } else { word(0).unwrap_or(0) };
        let Some(block) = rest.get(head..head + size) else { return Ok(0) };
        if checksum(block) as usize != sum {
            return Err(self.damaged("the checksum of the block that starts here is wrong"));
        }
        let mut cursor = Cursor { bytes: block };
        if is_base {
            let mesh =
                base(&mut cursor, expected, self.version).filter(|_| cursor.bytes.is_empty());
            self.mesh = Some(mesh.ok_or_else(|| self.damaged("the base is inconsistent"))?);
        } else {
            if count == 0 || count > expected[2] - there {
                return Err(self.damaged("a block has more splits than are left, or none"));
            }
            let fits = match &mut self.mesh {
                Some(mesh) => (0..count).all(|_| split(&mut cursor, mesh).is_some()),
                None => false,
            };
            if !fits || !cursor.bytes.is_empty() {
                return Err(self.damaged("a split in the block that starts here is inconsistent"));
            }
        }
        Ok(head + size)
    }
}

/// The base; `None` if it is not what the header says or names what is not there.
fn base(
    cursor: &mut Cursor<'_>,
    [vertices, faces, _]: [usize; 3],
    version: u32,
) -> Option<ProgressiveMesh> {
    let columns = if version == PLAIN { Vec::new() } else { columns(cursor)? };
    // Each vertex takes 24 bytes and each face 3 at least: no memory is asked for that cannot be filled.
    if cursor.bytes.len() < vertices.checked_mul(24)?.checked_add(faces.checked_mul(3)?)? {
        return None;
    }
    let positions = (0..vertices).map(|_| cursor.position()).collect::<Option<Vec<DVec3>>>()?;
    let faces = (0..faces).map(|_| cursor.face(vertices as u32)).collect::<Option<Vec<_>>>()?;
    let values = cursor.numbers(width(&columns).checked_mul(vertices)?)?;
    Some(ProgressiveMesh {
        positions,
        base: [vertices, faces.len()],
        face_count: faces.len(),
        faces,
        level: 0,
        splits: Vec::new(),
        moved: Vec::new(),
        held: Vec::new(),
        columns,
        values,
        held_values: Vec::new(),
        left_out: Vec::new(),
    })
}

/// The columns that the base tells of.
fn columns(cursor: &mut Cursor<'_>) -> Option<Vec<Column>> {
    let count = cursor.varint()?;
    let mut columns: Vec<Column> = Vec::new();
    for _ in 0..count {
        let [kind, place] = cursor.bytes(2)?.try_into().ok()?;
        let kind = *KINDS.get(usize::from(kind))?;
        let is_of_corners = [false, true].get(usize::from(place)).copied()?;
        let length = cursor.varint()? as usize;
        let name = std::str::from_utf8(cursor.bytes(length)?).ok()?.to_owned();
        if columns.iter().any(|c| c.name == name && c.is_of_corners == is_of_corners) {
            return None;
        }
        columns.push(Column { name, kind, is_of_corners });
    }
    Some(columns)
}

/// Reads a split and does it; `None` if it does not fit the level it is for, which then stays.
fn split(cursor: &mut Cursor<'_>, mesh: &mut ProgressiveMesh) -> Option<()> {
    let level = mesh.splits.len();
    mesh.set_level(level).ok()?;
    let new = mesh.vertex_count() as u32;
    let vertex = cursor.varint().filter(|&v| v < new)?;
    let count = cursor.varint().filter(|count| matches!(count, 1 | 2))?;
    let mut faces = [[0; 3]; 2];
    for face in &mut faces[..count as usize] {
        *face = cursor.face(new + 1).filter(|f| f.contains(&vertex) && f.contains(&new))?;
    }
    let moved_count = cursor.varint()? as usize;
    let mut moved = Vec::new();
    let mut corner = 0_u32;
    for k in 0..moved_count {
        let step = cursor.varint().filter(|&step| k == 0 || step > 0)?;
        corner = corner.checked_add(step)?;
        let face = mesh.faces().get(corner as usize / 3)?;
        if face[corner as usize % 3] != vertex {
            return None;
        }
        moved.push(corner);
    }
    let (after, position) = (cursor.position()?, cursor.position()?);
    let width = width(&mesh.columns);
    let (values_after, values) = (cursor.numbers(width)?, cursor.numbers(width)?);
    mesh.held_values.extend(values_after);
    mesh.values.extend(values);
    mesh.moved.extend(moved);
    mesh.held.push(after);
    mesh.positions.push(position);
    mesh.faces.extend(&faces[..count as usize]);
    mesh.splits.push(Split { vertex, faces: count as u8, end: mesh.moved.len() as u32 });
    mesh.set_level(level + 1).ok()
}

struct Cursor<'a> {
    bytes: &'a [u8],
}

impl<'a> Cursor<'a> {
    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (found, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(found)
    }

    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        let bytes = self.bytes(count.checked_mul(8)?)?;
        let numbers = bytes.chunks_exact(8).map(|b| b.try_into().map(f64::from_le_bytes));
        numbers.collect::<Result<_, _>>().ok()
    }

    fn varint(&mut self) -> Option<u32> {
        let mut value = 0_u64;
        for shift in (0..35).step_by(7) {
            let (&byte, rest) = self.bytes.split_first()?;
            self.bytes = rest;
            value |= u64::from(byte & 127) << shift;
            if byte & 128 == 0 {
                return u32::try_from(value).ok();
            }
        }
        None
    }

    /// Three different vertices below `limit`.
    fn face(&mut self, limit: u32) -> Option<[u32; 3]> {
        let [a, b, c] = [self.varint()?, self.varint()?, self.varint()?];
        (a < limit && b < limit && c < limit && a != b && b != c && c != a).then_some([a, b, c])
    }

    fn position(&mut self) -> Option<DVec3> {
        let mut coordinates = [0.0; 3];
        for x in &mut coordinates {
            let (bytes, rest) = self.bytes.split_first_chunk::<8>()?;
            self.bytes = rest;
            *x = f64::from_le_bytes(*bytes);
        }
        Some(DVec3::from_array(coordinates)).filter(|p| p.is_finite())
    }
}

fn push_block(bytes: &mut Vec<u8>, block: &[u8]) {
    bytes.extend((block.len() as u32).to_le_bytes());
    bytes.extend(checksum(block).to_le_bytes());
    bytes.extend(block);
}

fn push_position(bytes: &mut Vec<u8>, p: DVec3) {
    p.to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
}

fn push_numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
}

fn push_varint(bytes: &mut Vec<u8>, mut value: u32) {
    while value >= 128 {
        bytes.push((value & 127) as u8 | 128);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// CRC-32 with the polynomial of IEEE 802.3.
fn checksum(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for &byte in bytes {
        sum = (sum >> 8) ^ TABLE[((sum ^ u32::from(byte)) & 255) as usize];
    }
    !sum
}

const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut value = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            value = if value & 1 == 1 { value >> 1 ^ 0xedb8_8320 } else { value >> 1 };
            bit += 1;
        }
        table[byte] = value;
        byte += 1;
    }
    table
};
