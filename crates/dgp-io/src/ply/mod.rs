//! Stanford PLY: text and binary of both byte orders, any elements with any properties.
//!
//! | in the file | in the document |
//! |---|---|
//! | `vertex` `x y z` | positions |
//! | `nx ny nz` | `normal` of vertices and faces |
//! | `red green blue alpha`, also `diffuse_red` …, `r g b a` | `color` of vertices and faces; whole numbers are 0..255 (0..65535 for 16 bits) |
//! | `vertex` `s t`, `u v`, `texture_u texture_v`, `texture_s texture_t` | `uv` of vertices |
//! | `face` `vertex_indices`, `vertex_index` | faces |
//! | `face` `texcoord` | `uv` of corners |
//! | `tristrips` `vertex_indices` | faces, −1 begins a new strip |
//! | any other property | an attribute of the same name and type; lists are [`NumberList`](crate::NumberList) |
//! | any other element | an [`ExtraElement`](crate::ExtraElement) |
//!
//! Text is read in double precision even where the header says `float`: what is written there counts.
//!
//! - Input: any bytes.
//! - Cost: O(bytes), text in parallel.
//! - Reference: Turk, "The PLY polygon file format", 1994.

mod assemble;
mod header;
mod number;
mod property;
mod read;
mod rows;
mod strided;
mod table;
mod tristrips;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;
