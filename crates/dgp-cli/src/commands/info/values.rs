//! Attributes of elements as JSON, whatever their type.

use dgp::{
    io::NumberList,
    mesh::{
        AttributeTable, AttributeValue, Color, DVec2, DVec3, Id, Label, Normal,
        measure::interpolate,
    },
};
use serde_json::{Map, Value, json};

/// The data at the point with these barycentric coordinates between three elements, by name.
///
/// Coordinates must not be negative. With the same element three times its own data come out.
pub(super) fn values<I: Id>(
    table: &AttributeTable<I>,
    ids: [I; 3],
    coordinates: [f64; 3],
) -> Map<String, Value> {
    let named = |name: &str| {
        let value = value(table, name, ids, coordinates);
        // What a type of the user's holds is not known here; its name is.
        let value = value.unwrap_or_else(|| table.type_name(name).unwrap_or_default().into());
        (name.to_owned(), value)
    };
    table.names().map(named).collect()
}

/// The value in the column `name` if it is of one of the types that files have.
fn value<I: Id>(table: &AttributeTable<I>, name: &str, ids: [I; 3], at: [f64; 3]) -> Option<Value> {
    macro_rules! first_of {
        ($($type:ty => $to_json:expr),* $(,)?) => {
            None
                $(.or_else(|| mixed::<I, $type>(table, name, ids, at).map($to_json)))*
        };
    }
    first_of! {
        f64 => |x| json!(x),
        f32 => |x| json!(x),
        bool => |x| json!(x),
        i8 => |x| json!(x),
        u8 => |x| json!(x),
        i16 => |x| json!(x),
        u16 => |x| json!(x),
        i32 => |x| json!(x),
        u32 => |x| json!(x),
        i64 => |x| json!(x),
        u64 => |x| json!(x),
        DVec2 => |p| json!(p.to_array()),
        DVec3 => |p| json!(p.to_array()),
        Normal => |n| json!(n.0.to_array()),
        Color => |c| json!(c.0),
        Label => |label| json!(label.as_str()),
        NumberList => |list| json!(list.0),
    }
}

fn mixed<I: Id, T: AttributeValue>(
    table: &AttributeTable<I>,
    name: &str,
    ids: [I; 3],
    coordinates: [f64; 3],
) -> Option<T> {
    let column = table.get::<T>(name)?;
    Some(interpolate(coordinates, ids.each_ref().map(|&id| &column[id])))
}
