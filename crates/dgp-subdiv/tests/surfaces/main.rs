//! Subdivision surfaces, as their users see them.

mod adaptive;
mod carried;
mod data;
mod fans;
mod identities;
mod reference;
