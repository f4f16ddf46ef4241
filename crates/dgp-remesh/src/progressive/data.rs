//! Data of vertices at every level.
//!
//! A value is one to four numbers. Those of the vertex that a split changes and of the one that comes are kept as
//! positions are. Data of corners that are the same all around every vertex, such as texture coordinates without
//! seams, count as data of vertices.
//!
//! - Input: columns of numbers, vectors, normals, colors.
//! - Cost: that of positions.
//! - Guarantees: levels have the data that travel along with decimation, bit for bit.
//! - Reference: Hoppe, "Progressive meshes", SIGGRAPH 1996, section 3.

use dgp_mesh::{
    AttributeTable, AttributeValue, Color, DVec2, DVec3, Editor, HalfedgeId, Id, Mesh, Normal,
    VertexId,
};

use super::ProgressiveMesh;
use crate::decimate::quadric::Done;

/// A column of data.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) is_of_corners: bool,
}

/// The type of values, in the order of their numbers in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    F64,
    F32,
    Vector2,
    Vector3,
    Normal,
    Color,
    U8,
    I32,
    U32,
}

/// All kinds, each at its number.
pub(super) const KINDS: [Kind; 9] = [
    Kind::F64,
    Kind::F32,
    Kind::Vector2,
    Kind::Vector3,
    Kind::Normal,
    Kind::Color,
    Kind::U8,
    Kind::I32,
    Kind::U32,
];

/// A value as numbers, from which it comes back bit for bit.
trait Packed: AttributeValue {
    fn pack(&self, room: &mut [f64]);
    fn unpack(numbers: &[f64]) -> Self;
}

macro_rules! packed {
    ($($type:ty, $to:expr, $from:expr);* $(;)?) => {
        $(impl Packed for $type {
            fn pack(&self, room: &mut [f64]) {
                let to: fn(&Self, &mut [f64]) = $to;
                to(self, room);
            }

            fn unpack(numbers: &[f64]) -> Self {
                let from: fn(&[f64]) -> Self = $from;
                from(numbers)
            }
        })*
    };
}

packed! {
    f64, |x, room| room[0] = *x, |n| n[0];
    f32, |x, room| room[0] = f64::from(*x), |n| n[0] as f32;
    DVec2, |x, room| room.copy_from_slice(&x.to_array()), |n| DVec2::new(n[0], n[1]);
    DVec3, |x, room| room.copy_from_slice(&x.to_array()), |n| DVec3::new(n[0], n[1], n[2]);
    Normal, |x, room| room.copy_from_slice(&x.0.to_array()),
        |n| Normal(DVec3::new(n[0], n[1], n[2]));
    Color, |x, room| room.copy_from_slice(&x.0.map(f64::from)),
        |n| Color([n[0] as f32, n[1] as f32, n[2] as f32, n[3] as f32]);
    u8, |x, room| room[0] = f64::from(*x), |n| n[0] as u8;
    i32, |x, room| room[0] = f64::from(*x), |n| n[0] as i32;
    u32, |x, room| room[0] = f64::from(*x), |n| n[0] as u32;
}

/// Calls `$function::<type>($arguments)` for the type of `$kind`.
macro_rules! by_kind {
    ($kind:expr, $function:ident($($argument:expr),*)) => {
        match $kind {
            Kind::F64 => $function::<f64, _>($($argument),*),
            Kind::F32 => $function::<f32, _>($($argument),*),
            Kind::Vector2 => $function::<DVec2, _>($($argument),*),
            Kind::Vector3 => $function::<DVec3, _>($($argument),*),
            Kind::Normal => $function::<Normal, _>($($argument),*),
            Kind::Color => $function::<Color, _>($($argument),*),
            Kind::U8 => $function::<u8, _>($($argument),*),
            Kind::I32 => $function::<i32, _>($($argument),*),
            Kind::U32 => $function::<u32, _>($($argument),*),
        }
    };
}

impl Kind {
    /// How many numbers a value is.
    pub(super) fn width(self) -> usize {
        match self {
            Kind::F64 | Kind::F32 | Kind::U8 | Kind::I32 | Kind::U32 => 1,
            Kind::Vector2 => 2,
            Kind::Vector3 | Kind::Normal => 3,
            Kind::Color => 4,
        }
    }
}

/// The numbers of all columns.
pub(super) fn width(columns: &[Column]) -> usize {
    columns.iter().map(|column| column.kind.width()).sum()
}

fn is<T: AttributeValue, I: Id>(table: &AttributeTable<I>, name: &str) -> bool {
    table.get::<T>(name).is_some()
}

fn read<T: Packed, I: Id>(table: &AttributeTable<I>, name: &str, id: I, room: &mut [f64]) {
    if let Some(column) = table.get::<T>(name) {
        column[id].pack(room);
    }
}

fn write<T: Packed, I: Id>(
    table: &mut AttributeTable<I>,
    name: &str,
    values: &[f64],
    start: &dyn Fn(I) -> Option<usize>,
) {
    let len = table.len();
    let mut column = vec![T::default(); len];
    for (i, value) in column.iter_mut().enumerate() {
        if let Some(at) = start(I::from_index(i)) {
            *value = T::unpack(&values[at..]);
        }
    }
    table.insert(name, column);
}

/// The columns of `mesh` that levels can have, and the names of those they cannot.
pub(super) fn columns(mesh: &Mesh) -> (Vec<Column>, Vec<String>) {
    let data = mesh.attributes();
    let (mut columns, mut left_out) = (Vec::new(), Vec::new());
    for name in data.vertex.names() {
        let kind = KINDS.into_iter().find(|&kind| by_kind!(kind, is(&data.vertex, name)));
        match kind {
            Some(kind) => columns.push(Column { name: name.into(), kind, is_of_corners: false }),
            None => left_out.push(format!("{name} of vertices")),
        }
    }
    for name in data.corner.names() {
        let kind = KINDS.into_iter().find(|&kind| by_kind!(kind, is(&data.corner, name)));
        match kind.filter(|&kind| is_continuous(mesh, name, kind)) {
            Some(kind) => columns.push(Column { name: name.into(), kind, is_of_corners: true }),
            None => left_out.push(format!("{name} of corners")),
        }
    }
    left_out.extend(data.edge.names().map(|name| format!("{name} of edges")));
    left_out.extend(data.face.names().map(|name| format!("{name} of faces")));
    (columns, left_out)
}

/// Whether the column of corners is the same all around every vertex.
fn is_continuous(mesh: &Mesh, name: &str, kind: Kind) -> bool {
    let value = |h: HalfedgeId| {
        let mut numbers = [0.0; 4];
        let room = &mut numbers[..kind.width()];
        by_kind!(kind, read(&mesh.attributes().corner, name, h, room));
        numbers.map(f64::to_bits)
    };
    mesh.vertices().all(|v| {
        let mut corners = mesh.vertex_halfedges(v).filter(|&h| mesh.face(h).is_some());
        let first = corners.next().map(value);
        corners.all(|h| Some(value(h)) == first)
    })
}

/// The values at `v`, all columns one after the other.
fn values_at(mesh: &Mesh, columns: &[Column], v: VertexId, room: &mut Vec<f64>) {
    let data = mesh.attributes();
    let corner = mesh.vertex_halfedges(v).find(|&h| mesh.face(h).is_some());
    for column in columns {
        let mut numbers = [0.0; 4];
        let part = &mut numbers[..column.kind.width()];
        let name = column.name.as_str();
        match (column.is_of_corners, corner) {
            (false, _) => by_kind!(column.kind, read(&data.vertex, name, v, part)),
            (true, Some(h)) => by_kind!(column.kind, read(&data.corner, name, h, part)),
            (true, None) => {}
        }
        room.extend(&numbers[..column.kind.width()]);
    }
}

/// What the values are at the base, and what collapses change.
pub(super) struct Travelled {
    /// Of the vertices that each collapse takes away, and of those that stay, before it.
    pub(super) gone: Vec<f64>,
    pub(super) before: Vec<f64>,
    /// Of all vertices of the mesh; those at the base are as they are there.
    pub(super) at_base: Vec<f64>,
}

/// Has data travel along the collapses of `log`.
pub(super) fn travel(mesh: &Mesh, columns: &[Column], log: &[Done]) -> Travelled {
    let mut copy = mesh.clone();
    let mut editor = Editor::new(&mut copy);
    let (mut gone, mut before) = (Vec::new(), Vec::new());
    for done in log {
        let [from, to] = [done.from, done.to].map(|v| VertexId::new(v as usize));
        values_at(editor.mesh(), columns, from, &mut gone);
        values_at(editor.mesh(), columns, to, &mut before);
        let h = editor.mesh().halfedge_between(from, to).expect("an edge that was collapsed");
        editor.collapse_at(h, done.position).expect("a collapse that was done");
    }
    let mut at_base = Vec::new();
    for v in mesh.vertices() {
        values_at(editor.mesh(), columns, v, &mut at_base);
    }
    Travelled { gone, before, at_base }
}

impl ProgressiveMesh {
    /// The names of the columns of data that levels have.
    pub fn column_names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }

    /// What of the data of the mesh levels do not have: those of faces and edges, those of corners with seams,
    /// and types that are no numbers.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// Puts the data of the present level into `mesh`.
    pub(super) fn dress(&self, mesh: &mut Mesh) {
        let width = width(&self.columns);
        let count = mesh.halfedge_count();
        let corner_vertex: Vec<Option<usize>> = if self.columns.iter().any(|c| c.is_of_corners) {
            let vertex = |h: HalfedgeId| mesh.face(h).map(|_| width * mesh.from(h).index());
            (0..count).map(|h| vertex(HalfedgeId::new(h))).collect()
        } else {
            Vec::new()
        };
        let of_corner = |h: HalfedgeId| corner_vertex[h.index()];
        let of_vertex = |v: VertexId| Some(width * v.index());
        let data = mesh.attributes_mut();
        let mut first = 0;
        for column in &self.columns {
            let (values, name) = (&self.values[first..], column.name.as_str());
            if column.is_of_corners {
                by_kind!(column.kind, write(&mut data.corner, name, values, &of_corner));
            } else {
                by_kind!(column.kind, write(&mut data.vertex, name, values, &of_vertex));
            }
            first += column.kind.width();
        }
    }
}
