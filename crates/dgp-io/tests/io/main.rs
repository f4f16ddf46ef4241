//! Files of every format, as their users see them.

mod files;
mod fixtures;
mod obj_off;
mod ply;
mod round_trip;
mod stl_xyz;
