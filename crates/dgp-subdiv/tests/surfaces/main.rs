//! Subdivision surfaces, as their users see them.

mod adaptive;
mod data;
mod identities;
mod reference;
